//! Points that leave the surface of their neighbours, among points in any order.
//!
//! # Method
//! 1. A coarse spline is subtracted from the heights ([`rough_fit`]).
//! 2. Each point is predicted by least squares from its neighbours on all sides ([`neighbours`]). The quieter
//!    quarter of the residuals tells the noise. A point within a few times the noise is no outlier.
//! 3. Each other point is predicted robustly ([`local`]), from all neighbours and from the neighbours on one
//!    side, for eight sides. A crease or a step leaves at least one side undisturbed. Predictions with a
//!    large scale are disturbed, and do not count. The point is an outlier where every other prediction is
//!    off: by more than a bound times its own scale, and by more than the stated error. The scale is at least
//!    the noise.
//! 4. Outliers are left out, and all is done again, until nothing is found. Last, each outlier is judged by
//!    the points that are left.
//!
//! [`neighbours`]: super::neighbours
//! [`local`]: super::local
//! [`rough_fit`]: super::rough_fit

use super::local::{Neighbour, Prediction, Robustness, predicted};
use super::neighbours::{Cells, SECTORS};
use super::rough_fit;
use super::system::Sample;
use crate::budget::{Budget, Stopped};

/// Points farther off than this many standard deviations of the noise are judged closely.
const SUSPECT: f64 = 5.0;

/// The quarter of a normal distribution's absolute values lies below this many standard deviations.
const QUARTER: f64 = 0.318_6;

/// The most rounds: each finds what an outlier beside hid.
const MOST_ROUNDS: usize = 8;

/// The largest leverage: a prediction far beyond its neighbours, as at an isolated corner, says little. The
/// fewest neighbours on one side beyond the coefficients.
const MOST_LEVERAGE: f64 = 2.0;
const LEAST_FREEDOM: usize = 6;

/// A prediction whose scale is more than this many times the least one excuses no point: other outliers, or
/// something else that disturbs it, make its scale large.
const MOST_SCALE: f64 = 10.0;

/// Points that a thread judges at a time.
const CHUNK: usize = 512;

/// The noise counts as at least this part of the stated error. Below that, the waves that a coarse spline
/// leaves of exact data would count as mistakes.
const LEAST_NOISE: f64 = 0.1;

/// Scales beyond which a residual makes an outlier, by the neighbours beyond the coefficients. Few of them
/// may fit by chance.
const fn bound(freedom: usize) -> f64 {
    match freedom {
        0..6 => 25.0,
        6..9 => 20.0,
        9..13 => 15.0,
        _ => 11.0,
    }
}

/// A point off the surface of its neighbours.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Off {
    pub index: usize,
    /// Its height above the surface of its neighbours, mm.
    pub off: f64,
}

/// The outliers among samples at the places of `cells`, by their index. Errors up to `allowed` (mm) make
/// none. The longer of `lengths` is 1.
///
/// # Errors
/// Only the budget's stop.
pub fn outliers(
    cells: &Cells,
    samples: &[Sample],
    lengths: [f64; 2],
    allowed: f64,
    budget: &Budget,
) -> Result<Vec<Off>, Stopped> {
    let mut samples = samples.to_vec();
    let mut judge = Judge {
        cells,
        heights: samples.iter().map(|sample| sample.height).collect(),
        allowed,
        noise: 0.0,
        is_kept: vec![true; samples.len()],
    };
    for _ in 0..MOST_ROUNDS {
        if let Some(rest) = rough_fit::rest(&samples, lengths, LEAST_NOISE * allowed, budget)? {
            judge.heights = rest;
        }
        let found = judge.round(budget)?;
        if found.is_empty() {
            break;
        }
        for k in found {
            judge.is_kept[k] = false;
            samples[k].weight = 0.0;
        }
    }
    let left_out: Vec<usize> = (0..samples.len()).filter(|k| !judge.is_kept[*k]).collect();
    Ok(judge.each(&left_out, budget, Judge::off)?.into_iter().flatten().collect())
}

struct Judge<'a> {
    cells: &'a Cells<'a>,
    heights: Vec<f64>,
    allowed: f64,
    noise: f64,
    is_kept: Vec<bool>,
}

impl Judge<'_> {
    /// Measures the noise, and finds outliers among the points that are kept.
    fn round(&mut self, budget: &Budget) -> Result<Vec<usize>, Stopped> {
        let kept: Vec<usize> = (0..self.heights.len()).filter(|k| self.is_kept[*k]).collect();
        let sizes = self.each(&kept, budget, |judge, k| {
            let plain = predicted(&judge.neighbours(k), Robustness::None, 0.0)?;
            Some(plain.off.abs() / (1.0 + plain.leverage).sqrt())
        })?;
        let mut known: Vec<f64> = sizes.iter().flatten().copied().collect();
        if known.is_empty() {
            return Ok(Vec::new());
        }
        let quarter = known.len() / 4;
        let quiet = *known.select_nth_unstable_by(quarter, f64::total_cmp).1;
        self.noise = (quiet / QUARTER).max(LEAST_NOISE * self.allowed);
        let is_suspect = |size: &Option<f64>| size.is_some_and(|size| size > SUSPECT * self.noise);
        let suspects: Vec<usize> =
            kept.iter().zip(&sizes).filter(|(_, size)| is_suspect(size)).map(|(k, _)| *k).collect();
        let found = self.each(&suspects, budget, Self::off)?;
        Ok(found.into_iter().flatten().map(|off| off.index).collect())
    }

    /// `judged` for each of the points, in their order.
    fn each<T: Send>(
        &self,
        points: &[usize],
        budget: &Budget,
        judged: impl Fn(&Self, usize) -> Option<T> + Sync,
    ) -> Result<Vec<Option<T>>, Stopped> {
        let chunks: Vec<&[usize]> = points.chunks(CHUNK).collect();
        let judged_one = |k: &usize| {
            budget.check()?;
            Ok(judged(self, *k))
        };
        let results = budget.in_order(chunks.len(), |c| {
            chunks[c].iter().map(judged_one).collect::<Result<Vec<_>, Stopped>>()
        })?;
        Ok(results.into_iter().flatten().collect())
    }

    fn neighbours(&self, k: usize) -> Vec<Neighbour> {
        let near = self.cells.around(k, &self.is_kept);
        near.into_iter()
            .map(|near| Neighbour { near, rise: self.heights[near.index] - self.heights[k] })
            .collect()
    }

    /// How far off point `k` is, by the prediction that fits it best; `None` where it is no outlier.
    fn off(&self, k: usize) -> Option<Off> {
        let all = self.neighbours(k);
        let whole = predicted(&all, Robustness::Full, self.noise)
            .filter(|whole| whole.leverage <= MOST_LEVERAGE && self.is_off(whole))?;
        let mut predictions = vec![whole];
        for first in 0..SECTORS {
            let is_side = |one: &&Neighbour| (one.near.sector + SECTORS - first) % SECTORS < SECTORS / 2;
            let side: Vec<Neighbour> = all.iter().filter(is_side).copied().collect();
            let of_side = predicted(&side, Robustness::Full, self.noise);
            predictions.extend(
                of_side.filter(|side| side.leverage <= MOST_LEVERAGE && side.freedom >= LEAST_FREEDOM),
            );
        }
        let quietest = predictions.iter().map(|one| one.scale).fold(f64::INFINITY, f64::min);
        let is_quiet = |one: &&Prediction| one.scale <= MOST_SCALE * quietest;
        let best = predictions.iter().filter(is_quiet).min_by(|a, b| ratio(a).total_cmp(&ratio(b)))?;
        self.is_off(best).then_some(Off { index: k, off: best.off })
    }

    fn is_off(&self, prediction: &Prediction) -> bool {
        ratio(prediction) > 1.0 && prediction.off.abs() > self.allowed
    }
}

/// How far off the point is, in multiples of what makes an outlier.
fn ratio(prediction: &Prediction) -> f64 {
    let Prediction { off, scale, leverage, freedom } = prediction;
    off.abs() / (bound(*freedom) * scale * (1.0 + leverage).sqrt())
}

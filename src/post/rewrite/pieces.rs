//! What is written for the points of a run: curves on the grid of the output that have been proved to be near enough.
//!
//! # Method
//! 1. The points are fitted with a tolerance that leaves some room for rounding.
//! 2. Each curve is rounded. The distance of what was rounded from the polyline, with all that a control may run for
//!    it, is compared with the tolerance.
//! 3. Where that fails the curve's points are fitted again, with a tolerance smaller by what was missing.
//! 4. What fails [`MAX_TRIES`] times stays as it is.

use nalgebra::Point3;

use crate::budget::{Budget, Stopped};
use crate::geometry::arc_fit::{Fit, FitError, fit_in_space};
use crate::geometry::curve::Curve;
use crate::geometry::following;
use crate::toolpath::program::Resolution;
use crate::toolpath::quantize::{self, Parabolas, Written};

/// How often the points of a curve are fitted again.
const MAX_TRIES: u8 = 3;

/// What is kept of the tolerance for rounding, in units of the last decimal: the centre of an arc is rarely moved by more.
/// Without it nearly all arcs that use their tolerance up would have to be fitted again.
const RESERVE_STEPS: f64 = 0.35;

/// A tolerance that was missed is made smaller by this part of itself at least, twice and three times that the next times.
const LEAST_CUT: f64 = 0.04;

/// The reserve is no larger than this part of the tolerance.
const LARGEST_RESERVE: f64 = 0.15;

/// A part of a run.
#[derive(Debug, Clone, PartialEq)]
pub struct Stretch {
    /// The block behind its last.
    pub end: usize,
    /// What is written for its blocks; nothing where they stay.
    pub curves: Vec<Written>,
    /// Upper bound for the distance of the curves, as a control may run them, from the polyline, mm, both ways.
    pub deviation_mm: f64,
}

impl Stretch {
    fn kept(end: usize) -> Self {
        Self { end, curves: Vec::new(), deviation_mm: 0.0 }
    }
}

/// How the points of runs are fitted.
pub struct Fitting<'a> {
    pub fit: &'a Fit,
    pub resolution: Resolution,
    /// Axes along which ends of curves can be written.
    pub is_writable: [bool; 3],
    pub budget: &'a Budget,
}

/// Points that may become one curve.
struct Open {
    from: usize,
    end: usize,
    curve: Curve,
    tolerance_mm: f64,
    tries: u8,
}

impl Fitting<'_> {
    /// Stretches from the first point on that end at `reach` or before, at least one.
    ///
    /// # Errors
    /// When the budget is spent. Points that cannot be fitted stay as they are.
    pub fn stretches(&self, points: &[Point3<f64>], reach: usize) -> Result<Vec<Stretch>, Stopped> {
        let reserve =
            (RESERVE_STEPS * self.resolution.step_mm()).min(LARGEST_RESERVE * self.fit.tolerance_mm);
        let mut open = Vec::new();
        if !self.open(points, 0..points.len() - 1, self.fit.tolerance_mm - reserve, 0, &mut open)? {
            return Ok(vec![Stretch::kept(points.len() - 1)]);
        }
        let within = open.iter().rev().take_while(|one| one.end <= reach).count();
        open.drain(..open.len() - within.max(1));
        let mut stretches = Vec::with_capacity(open.len());
        while let Some(one) = open.pop() {
            match self.rounded(&one, points) {
                Ok(stretch) => stretches.push(stretch),
                Err(missing_mm) => {
                    // Little may be missing again and again; where it is not known how much, it is half of the tolerance.
                    let least_mm = LEAST_CUT * f64::from(one.tries + 1) * one.tolerance_mm;
                    let tolerance_mm = one.tolerance_mm - missing_mm.clamp(least_mm, one.tolerance_mm / 2.0);
                    let is_open = one.tries < MAX_TRIES
                        && self.open(points, one.from..one.end, tolerance_mm, one.tries + 1, &mut open)?;
                    if !is_open {
                        stretches.push(Stretch::kept(one.end));
                    }
                }
            }
        }
        Ok(stretches)
    }

    /// Fits the points from the start to the end of `range`, both included, and puts the curves on `open`, the first on top;
    /// `false` where they cannot be fitted.
    fn open(
        &self,
        points: &[Point3<f64>],
        range: std::ops::Range<usize>,
        tolerance_mm: f64,
        tries: u8,
        open: &mut Vec<Open>,
    ) -> Result<bool, Stopped> {
        let request = Fit { tolerance_mm, ..*self.fit };
        let pieces = match fit_in_space(&points[range.start..=range.end], None, &request, self.budget) {
            Ok(pieces) => pieces,
            Err(FitError::Stopped(stopped)) => return Err(stopped),
            Err(_) => return Ok(false),
        };
        let ends = pieces.iter().map(|piece| range.start + piece.end);
        let froms = std::iter::once(range.start).chain(ends.clone());
        let is_whole = ends.clone().next_back() == Some(range.end)
            && froms.clone().zip(ends.clone()).all(|(a, b)| a < b);
        if is_whole {
            let parts = froms.zip(ends).zip(&pieces);
            let parts =
                parts.map(|((from, end), piece)| Open { from, end, curve: piece.curve, tolerance_mm, tries });
            let top = open.len();
            open.extend(parts);
            open[top..].reverse();
        }
        Ok(is_whole)
    }

    /// What is written for a curve, or by how much it is too far away, mm.
    fn rounded(&self, one: &Open, points: &[Point3<f64>]) -> Result<Stretch, f64> {
        let (blocks, points) = (one.end - one.from, &points[one.from..=one.end]);
        let joins = one.curve.start() == points[0] && one.curve.end() == points[blocks];
        if blocks == 1 || !joins || !self.can_write(&one.curve) {
            return Ok(Stretch::kept(one.end));
        }
        let rounded =
            quantize::round(&one.curve, self.resolution, Parabolas::AsLines).map_err(|_| f64::INFINITY)?;
        let curves = rounded.curves;
        if curves.is_empty() || curves.len() >= blocks {
            return Ok(Stretch::kept(one.end));
        }
        let deviation_mm = match curves.as_slice() {
            [only] => following::from_lines(&only.curve, points) + only.slack_mm,
            _ => following::from_lines(&one.curve, points) + rounded.displacement_mm,
        };
        if deviation_mm <= self.fit.tolerance_mm {
            Ok(Stretch { end: one.end, curves, deviation_mm })
        } else {
            Err(deviation_mm - self.fit.tolerance_mm)
        }
    }

    /// Whether its ends can be written, and are two.
    fn can_write(&self, curve: &Curve) -> bool {
        match curve {
            Curve::Line(_) => true,
            Curve::Arc(arc) => {
                let [a, b, _] = arc.plane().axes();
                let (start, end) = (arc.start(), arc.end());
                let is_full_turn = start[a] == end[a] && start[b] == end[b];
                self.is_writable[a] && self.is_writable[b] && !is_full_turn
            }
            Curve::Parabola(_) => false,
        }
    }
}

//! Fits curves to the end points of the blocks of a run, and rounds the curves to the decimals of the output.
//!
//! # Method
//! 1. Fit arcs and lines to the points, within slightly less than the tolerance, because rounding will move
//!    them.
//! 2. Round each curve. A rounded arc has slightly different radii at its two ends, so controls may run
//!    different paths for it. Bound the Frechet distance between each of these paths and the lines between
//!    the points.
//! 3. If the bound of a curve exceeds the tolerance, fit the points of this curve again within a smaller
//!    tolerance, and repeat step 2. After [`MAX_TRIES`] such tries, keep the blocks of these points.

use nalgebra::Point3;

use toolpathd_core::budget::{Budget, Stopped};
use toolpathd_core::geometry::arc_fit::{Fit, FitError, fit_in_space};
use toolpathd_core::geometry::curve::Curve;
use toolpathd_core::geometry::following;
use toolpathd_core::toolpath::program::Resolution;
use toolpathd_core::toolpath::quantize::{self, Curves, Written};

/// How often the points of a curve are fitted again. More tries rarely succeed and cost time.
const MAX_TRIES: u8 = 3;

/// The part of the tolerance that is reserved for rounding, in units of the last decimal. Rounding rarely
/// moves the centre of an arc by more. Without a reserve, nearly every arc that uses up its tolerance would
/// be fitted again.
const RESERVE_STEPS: f64 = 0.35;

/// Smallest relative cut of a missed tolerance at the first try; twice and three times as large at the next
/// tries. Without a smallest cut, an arc could miss its tolerance by little again and again.
const LEAST_CUT: f64 = 0.04;

/// Largest reserve as a part of the tolerance. A larger reserve would waste a tolerance that is near the
/// resolution.
const LARGEST_RESERVE: f64 = 0.15;

/// A part of a run.
#[derive(Debug, Clone, PartialEq)]
pub struct Stretch {
    /// The index after its last block.
    pub end: usize,
    /// The curves that replace its blocks; empty where the blocks stay.
    pub curves: Vec<Written>,
    /// Upper bound for the distance between the polyline and any path that a control may run for the curves,
    /// mm, both ways.
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
    /// What the control runs.
    pub curves: &'a Curves,
    /// The axes along which the end of a curve can be written.
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
    /// The stretches from the first point on that end at `reach` or before, but at least one stretch.
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
                Err(excess_mm) => {
                    // An unknown excess, which is infinite, halves the tolerance.
                    let least_mm = LEAST_CUT * f64::from(one.tries + 1) * one.tolerance_mm;
                    let tolerance_mm = one.tolerance_mm - excess_mm.clamp(least_mm, one.tolerance_mm / 2.0);
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

    /// Fits the points from the start to the end of `range`, both included, and puts the curves on `open`,
    /// the first curve on top. Returns `false` if the points cannot be fitted.
    fn open(
        &self,
        points: &[Point3<f64>],
        range: std::ops::Range<usize>,
        tolerance_mm: f64,
        tries: u8,
        open: &mut Vec<Open>,
    ) -> Result<bool, Stopped> {
        let request = Fit { tolerance_mm, ..*self.fit };
        let curves = match fit_in_space(&points[range.start..=range.end], None, &request, self.budget) {
            Ok(fitted) => fitted.curves,
            Err(FitError::Stopped(stopped)) => return Err(stopped),
            Err(_) => return Ok(false),
        };
        let ends = curves.iter().map(|fitted| range.start + fitted.end);
        let froms = std::iter::once(range.start).chain(ends.clone());
        let is_whole = ends.clone().next_back() == Some(range.end)
            && froms.clone().zip(ends.clone()).all(|(a, b)| a < b);
        if is_whole {
            let parts = froms.zip(ends).zip(&curves);
            let parts = parts.map(|((from, end), fitted)| Open {
                from,
                end,
                curve: fitted.curve,
                tolerance_mm,
                tries,
            });
            let top = open.len();
            open.extend(parts);
            open[top..].reverse();
        }
        Ok(is_whole)
    }

    /// The stretch of a curve; as an error, the distance in mm by which the rounded curve exceeds the
    /// tolerance.
    fn rounded(&self, one: &Open, points: &[Point3<f64>]) -> Result<Stretch, f64> {
        let (blocks, points) = (one.end - one.from, &points[one.from..=one.end]);
        let joins = one.curve.start() == points[0] && one.curve.end() == points[blocks];
        if blocks == 1 || !joins || !self.can_write(&one.curve) {
            return Ok(Stretch::kept(one.end));
        }
        let rounded = quantize::round(&one.curve, self.resolution, self.curves).map_err(|_| f64::INFINITY)?;
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

    /// Whether the ends of the curve can be written and do not coincide. Controls read a full circle in
    /// different ways, so none is written.
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

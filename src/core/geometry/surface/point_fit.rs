//! A smooth surface near measured points in any order: the smoothest bicubic spline z(x, y) whose error at
//! the points is as stated.
//!
//! # Method
//! 1. `frame`: the rectangle of the points in plan, along the rows of a turned grid.
//! 2. `outliers`: points off the surface of their neighbours are refused, or left out and reported. Points
//!    one above the other are refused.
//! 3. The plane of least squares is subtracted from the heights. Where it has no larger error than stated, it
//!    is the surface.
//! 4. `search`: else the heights are fitted by a uniform cubic tensor B-spline, which minimizes the mean of
//!    the squared vertical errors plus a weight times the energy of a thin plate (`system`). The net is
//!    refined until the closest fit has no larger error than stated; then the weight is raised until its
//!    error is nearly as large.
//! 5. `coverage`: the part of the rectangle without points near is reported.
//!
//! # Guarantees
//! * The surface is a NURBS with simple knots: its second derivatives are continuous, and x and y are linear
//!   in u and v.
//! * The stated figures are measured on the Bezier patches of the surface at the points that are kept, and
//!   are within the bound.
//! * The surface is a function of the points alone. The number of threads does not change it.
//! * Scaling or moving the points, with the bound, changes the surface by rounding only.
//!
//! # Degenerate input
//! Three points that are not on a line give their plane. Points on a line or at one place are refused.
//! Fewer than eleven points are not searched for outliers. An outlier is found where its neighbours tell the
//! surface better than the outlier is off: not between few points on a rough part, and of several outliers
//! side by side up to about four, or two at a corner. An isolated corner beyond all other points is not
//! judged.
//!
//! # Cost
//! For n points and N control points, on a net of about equally many rows and columns: O(n) for outliers,
//! O(n + N^2) for each weight (a banded factorization), about ten weights. N is at most
//! [`search::MOST_CONTROL_POINTS`], and follows from the surface and the bound, not from n. On one core of a
//! small machine, 100,000 points with noise take 2 to 3 s, of which the search for outliers takes 2 s.
//!
//! # Reference
//! P. Dierckx, "Curve and Surface Fitting with Splines", 1993, chapters 5 and 9 (smoothing with a bound for
//! the error); P. J. Green, B. W. Silverman, "Nonparametric Regression and Generalized Linear Models", 1994,
//! chapter 7 (the energy of a thin plate).

mod banded;
mod coverage;
mod frame;
mod local;
mod neighbours;
mod net;
mod outliers;
mod rough_fit;
pub mod search;
mod stacked;
mod system;
#[cfg(test)]
mod tests;
mod trend;

use nalgebra::{Point2, Point3};

use super::any_surface::AnySurface;
use super::nurbs::{Nurbs, NurbsError};
use super::{Jet, Surface};
use crate::budget::{Budget, Stopped};
pub use coverage::Extrapolated;
use coverage::extrapolated;
use frame::Frame;
use neighbours::Cells;
use net::Net;
use outliers::outliers;
use search::{Found, Spline, smoothest};
use trend::Trend;

/// The least width of the points in plan, as a part of their length. Narrower points count as a line.
pub const LEAST_WIDTH: f64 = 1e-4;

/// The largest part of the rectangle without points near. A surface of which more is extrapolated is a guess.
pub const MOST_EXTRAPOLATED: f64 = 0.5;

/// The most outliers, as a part of the points. More are no mistakes, but a surface that is no function of x
/// and y, or noise of another kind.
pub const MOST_OUTLIERS: f64 = 0.1;

/// An error within `Rms` may be this many times larger at single points before they count as outliers.
const RMS_TO_MAX: f64 = 3.0;

/// The least bound of the error, as a part of the largest coordinate or extent: rounding is larger than less.
const LEAST_BOUND: f64 = 1e-12;

/// The stated bound of the error: of vertical distances between the points and the surface, mm.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Error {
    /// The largest distance.
    Max(f64),
    /// The root of the mean of the squared distances.
    Rms(f64),
}

/// What happens to points off the surface of their neighbours.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum OutlierChoice {
    Refuse,
    LeaveOut,
    /// They are not looked for.
    Keep,
}

/// Points in any order, mm, and how closely a surface follows them.
#[derive(Debug, Clone, PartialEq)]
pub struct PointFit {
    pub points: Vec<Point3<f64>>,
    pub error: Error,
    pub outliers: OutlierChoice,
}

/// A point off the surface of its neighbours.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Outlier {
    /// Its place in the list of points.
    pub index: usize,
    pub point: Point3<f64>,
    /// Its height above the surface of its neighbours, mm.
    pub off_mm: f64,
}

/// A fitted surface with its figures.
#[derive(Debug, Clone, PartialEq)]
pub struct Fitted {
    pub nurbs: Nurbs,
    /// Points that the surface was fitted to.
    pub n_points: usize,
    /// The root of the mean of the squared vertical errors at these points, and the largest error; mm.
    pub rms_mm: f64,
    pub max_mm: f64,
    /// Outliers that were left out, in the order of the points.
    pub left_out: Vec<Outlier>,
    pub extrapolated: Option<Extrapolated>,
}

/// Why points give no surface.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PointFitError {
    #[error(transparent)]
    Stopped(#[from] Stopped),
    #[error("there are {found} points; a surface needs at least 3")]
    TooFew { found: usize },
    #[error("point {index} is not finite")]
    NotFinite { index: usize },
    #[error("the bound of the error is not above zero")]
    Bound,
    #[error(
        "all points are on one line in plan, within {width_mm} mm; a surface needs points beside the line"
    )]
    OnALine { width_mm: f64 },
    #[error(
        "points {} and {} are one above the other, {rise_mm:.4} mm apart; a surface over the plan has one height at each place",
        pair[0],
        pair[1]
    )]
    Stacked { pair: [usize; 2], rise_mm: f64 },
    #[error("{} of the points are off the surface of their neighbours", outliers.len())]
    Outliers { outliers: Vec<Outlier> },
    #[error(
        "{found} of {n_points} points are off the surface of their neighbours: too many for mistakes of a measurement"
    )]
    TooManyOutliers { found: usize, n_points: usize, first: Outlier },
    #[error(
        "no surface with up to {limit} control points has so small an error: the best has {best_mm:.6} mm, with the farthest point at x {:.4}, y {:.4}",
        at.x,
        at.y
    )]
    TooFar { best_mm: f64, index: usize, at: Point2<f64>, limit: usize },
    #[error(
        "{:.0} per cent of the rectangle around the points have no point near; the surface there would be a guess",
        100.0 * extrapolated.share
    )]
    MostlyExtrapolated { extrapolated: Extrapolated },
    #[error(transparent)]
    Nurbs(#[from] NurbsError),
}

impl PointFit {
    /// The smoothest surface with the stated error.
    ///
    /// # Errors
    /// One of [`PointFitError`].
    pub fn fitted(&self, budget: &Budget) -> Result<Fitted, PointFitError> {
        self.check()?;
        let points = &self.points;
        let plan: Vec<Point2<f64>> = points.iter().map(|p| p.xy()).collect();
        let frame = Frame::around(&plan);
        let width = frame.lengths[0].min(frame.lengths[1]);
        // Not a number is no width either.
        if width.is_nan() || width <= LEAST_WIDTH * frame.longest() {
            return Err(PointFitError::OnALine { width_mm: width });
        }
        let places: Vec<[f64; 2]> = plan.iter().map(|p| frame.place(p)).collect();
        let cells = Cells::new(&places, &frame);
        // Points that crowd in a corner are refused before each is compared with all beside it.
        let of_all = extrapolated(&cells, &frame, places.len(), budget)?;
        if let Some(extrapolated) = of_all.filter(|part| part.share > MOST_EXTRAPOLATED) {
            return Err(PointFitError::MostlyExtrapolated { extrapolated });
        }
        let left_out = self.outliers(&frame, &cells, &places, budget)?;
        let kept = kept(points.len(), &left_out);
        let rise = 2.0 * self.allowed();
        if let Some(stacked) = stacked::stacked(&kept, &places, points, cells.side(), rise).into_iter().next()
        {
            return Err(stacked.into());
        }
        let kept_places: Vec<[f64; 2]> = kept.iter().map(|k| places[*k]).collect();
        let kept_cells = Cells::new(&kept_places, &frame);
        let extrapolated = extrapolated(&kept_cells, &frame, kept.len(), budget)?;
        if let Some(extrapolated) = extrapolated.filter(|part| part.share > MOST_EXTRAPOLATED) {
            return Err(PointFitError::MostlyExtrapolated { extrapolated });
        }
        let surface = self.spline(&frame, &places, &kept, budget)?;
        let nurbs = nurbs(&frame, surface);
        let residuals = residuals(&nurbs, &frame, &kept, &places, points)?;
        let [rms_mm, max_mm] = [Error::Rms(0.0), Error::Max(0.0)].map(|error| error.of(&residuals));
        Ok(Fitted { nurbs, n_points: kept.len(), rms_mm, max_mm, left_out, extrapolated })
    }

    /// The outliers among the points alone, by their places in the list.
    #[cfg(test)]
    fn outlier_indices(&self) -> Vec<usize> {
        let frame = Frame::around(&self.points.iter().map(|p| p.xy()).collect::<Vec<_>>());
        let places: Vec<[f64; 2]> = self.points.iter().map(|p| frame.place(&p.xy())).collect();
        let cells = Cells::new(&places, &frame);
        let found = self.outliers(&frame, &cells, &places, &Budget::unlimited());
        found.unwrap().iter().map(|outlier| outlier.index).collect()
    }

    fn check(&self) -> Result<(), PointFitError> {
        if let Some(index) = self.points.iter().position(|p| !p.iter().all(|x| x.is_finite())) {
            return Err(PointFitError::NotFinite { index });
        }
        if self.points.len() < 3 {
            return Err(PointFitError::TooFew { found: self.points.len() });
        }
        let bound = self.error.bound();
        if !(bound.is_finite() && bound > 0.0) {
            return Err(PointFitError::Bound);
        }
        Ok(())
    }

    /// The error that a single point may have.
    fn allowed(&self) -> f64 {
        match self.error {
            Error::Max(bound) => bound,
            Error::Rms(bound) => RMS_TO_MAX * bound,
        }
    }

    /// The outliers that are left out.
    fn outliers(
        &self,
        frame: &Frame,
        cells: &Cells,
        places: &[[f64; 2]],
        budget: &Budget,
    ) -> Result<Vec<Outlier>, PointFitError> {
        let points = &self.points;
        let all: Vec<usize> = (0..points.len()).collect();
        let rise = 2.0 * self.allowed();
        let mut stacked = stacked::stacked(&all, places, points, cells.side(), rise);
        // A few may be outliers above points that were measured twice.
        if stacked.len() > 2 && stacked.len() as f64 > stacked::MOST * points.len() as f64 {
            return Err(stacked.swap_remove(0).into());
        }
        if self.outliers == OutlierChoice::Keep {
            return Ok(Vec::new());
        }
        // Heights from the first one, so that little is lost to rounding.
        let heights = points.iter().map(|p| p.z - points[0].z);
        let samples = frame.samples(places.iter().copied().zip(heights));
        let of = |off: outliers::Off| Outlier { index: off.index, point: points[off.index], off_mm: off.off };
        let found: Vec<Outlier> = outliers(cells, &samples, frame.unit_lengths(), self.allowed(), budget)?
            .into_iter()
            .map(of)
            .collect();
        match found.first() {
            Some(first) if found.len() as f64 > MOST_OUTLIERS * points.len() as f64 => {
                let (found, n_points) = (found.len(), points.len());
                Err(PointFitError::TooManyOutliers { found, n_points, first: *first })
            }
            Some(_) if self.outliers == OutlierChoice::Refuse => {
                Err(PointFitError::Outliers { outliers: found })
            }
            _ => Ok(found),
        }
    }

    /// The control points' heights above the plane z = 0, on their net.
    fn spline(
        &self,
        frame: &Frame,
        places: &[[f64; 2]],
        kept: &[usize],
        budget: &Budget,
    ) -> Result<Spline, PointFitError> {
        let length = frame.longest();
        let unit = |k: &usize| places[*k].map(|x| x / length);
        let trend = Trend::of(kept.iter().map(|k| (unit(k), self.points[*k].z)));
        let above: Vec<f64> = kept.iter().map(|k| trend.above(unit(k), self.points[*k].z)).collect();
        let largest = above.iter().fold(0.0f64, |most, x| most.max(x.abs()));
        let rounding = LEAST_BOUND * self.points.iter().map(|p| p.z.abs()).fold(0.0, f64::max);
        let lengths = frame.unit_lengths();
        let mut spline = if self.error.of(&above) <= self.error.bound() || largest <= rounding {
            let net = Net { cells: [1, 1] };
            Spline { net, control: vec![vec![0.0; net.size()[1]]; net.size()[0]] }
        } else {
            let samples = frame.samples(kept.iter().zip(&above).map(|(k, z)| (places[*k], z / largest)));
            let error = match self.error {
                Error::Max(bound) => Error::Max(bound / largest),
                Error::Rms(bound) => Error::Rms(bound / largest),
            };
            match smoothest(&samples, lengths, error, budget)? {
                Found::Spline(mut spline) => {
                    spline.control.iter_mut().flatten().for_each(|z| *z *= largest);
                    spline
                }
                Found::TooFar { error, worst } => {
                    let (index, limit) = (kept[worst], search::MOST_CONTROL_POINTS);
                    let at = self.points[index].xy();
                    return Err(PointFitError::TooFar { best_mm: error * largest, index, at, limit });
                }
            }
        };
        let cells = spline.net.cells;
        for (i, row) in spline.control.iter_mut().enumerate() {
            for (j, z) in row.iter_mut().enumerate() {
                let place = [(i, 0), (j, 1)].map(|(k, axis)| greville(k, cells[axis]) * lengths[axis]);
                *z += trend.at(place);
            }
        }
        Ok(spline)
    }
}

impl From<stacked::Pair> for PointFitError {
    fn from(stacked::Pair { pair, rise }: stacked::Pair) -> Self {
        Self::Stacked { pair, rise_mm: rise }
    }
}

/// The points that are not left out.
fn kept(n: usize, left_out: &[Outlier]) -> Vec<usize> {
    let mut is_kept = vec![true; n];
    left_out.iter().for_each(|outlier| is_kept[outlier.index] = false);
    (0..n).filter(|k| is_kept[*k]).collect()
}

/// The place of control point `k` along a side with `cells` cells, as a part of the side: with control points
/// there, heights that are linear in the place give a linear spline.
fn greville(k: usize, cells: usize) -> f64 {
    (k as f64 - 1.0) / cells as f64
}

fn nurbs(frame: &Frame, Spline { net, control }: Spline) -> Nurbs {
    let place = |k: usize, axis: usize| greville(k, net.cells[axis]) * frame.lengths[axis];
    let at = |i: usize, j: usize, z: f64| {
        let plan = frame.point([place(i, 0), place(j, 1)]);
        Point3::new(plan.x, plan.y, z)
    };
    let row = |(i, row): (usize, Vec<f64>)| row.into_iter().enumerate().map(|(j, z)| at(i, j, z)).collect();
    let knots = net.cells.map(|cells| {
        (0..cells + 2 * search::KNOTS_BEYOND + 1).map(|k| k as f64 - search::KNOTS_BEYOND as f64).collect()
    });
    let control_points = control.into_iter().enumerate().map(row).collect();
    Nurbs { degree: [3, 3], knots, control_points, weights: None }
}

/// The heights of the surface's patches above the points.
fn residuals(
    nurbs: &Nurbs,
    frame: &Frame,
    kept: &[usize],
    places: &[[f64; 2]],
    points: &[Point3<f64>],
) -> Result<Vec<f64>, PointFitError> {
    let surface: AnySurface = nurbs.surface()?;
    let spans = surface.spans();
    let jet = |k: &usize| -> Jet {
        let share = frame.share(places[*k]);
        surface.jet(share[0] * spans[0] as f64, share[1] * spans[1] as f64)
    };
    Ok(kept.iter().map(|k| jet(k).point.z - points[*k].z).collect())
}

//! Bounds the distance of the curves of a pass from the exact CL curve, for the curves as computed and as the
//! program states them.

use nalgebra::Point3;

use super::{Error, Job};
use crate::geometry::curve::Curve;
use crate::machining::offset_section::chord_height;
use crate::toolpath::quantize::{Grid, round};

/// The largest distance of a tip from its exact section, mm.
const ACCURACY_MM: f64 = 2e-10;

/// The rounding of a distance, as a share of the coordinates.
const ROUNDING: f64 = 1e-14;

/// A bound is sharp if it is at most the first number times the deviation found plus the second number of
/// steps of the last decimal.
const SHARP: [f64; 2] = [2.0, 1.5];

/// How far the exact CL curve may jump and bend at joints that are smooth only up to the rounding of their
/// data.
#[derive(Debug, Clone, Copy)]
pub(super) struct Seam {
    /// The largest jump, mm.
    pub(super) jump: f64,
    /// The largest distance of the curve from a chord across the joint, as a share of the chord: a quarter of
    /// the angle by which the curve bends, in radians.
    pub(super) bend: f64,
}

impl Seam {
    /// No jump and no bend.
    pub(super) const NONE: Self = Self { jump: 0.0, bend: 0.0 };
}

/// The distance between the exact CL curve and curves that stand for it, mm.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Deviation {
    /// The proved bound, both ways.
    pub(super) bound_mm: f64,
    /// The largest distance found between the CL points and the curves; the true deviation is no less.
    pub(super) found_mm: f64,
}

impl Deviation {
    pub(super) const NONE: Self = Self::within(0.0);

    /// A bound without a distance that was found.
    pub(super) const fn within(bound_mm: f64) -> Self {
        Self { bound_mm, found_mm: 0.0 }
    }

    /// The larger bound and the larger distance found.
    pub(super) fn or_more(&self, other: &Self) -> Self {
        Self { bound_mm: self.bound_mm.max(other.bound_mm), found_mm: self.found_mm.max(other.found_mm) }
    }

    fn and(&self, more_mm: f64) -> Self {
        Self { bound_mm: self.bound_mm + more_mm, ..*self }
    }

    /// Whether the bound is not much larger than the deviation found; `step_mm` is one step of the last
    /// decimal.
    pub(super) fn is_sharp(&self, step_mm: f64) -> bool {
        self.bound_mm <= SHARP[0] * self.found_mm + SHARP[1] * step_mm
    }
}

/// Bounds the distance, both ways, between the CL curve through `tips` and `curve`, as computed and as
/// written.
///
/// Between neighbouring tips the CL curve leaves their chord by at most `section_height` plus the part of
/// `seam`. A point of a chord is no farther from a line than the ends of the chord are. It may be farther
/// from an arc, by at most the height of the chord under a concentric arc; that arc's radius is smaller by
/// the largest distance of a tip. The curve and the tips have the same ends, and an arc turns about its
/// centre as the tips do. So the points of one path nearest to the other cover it whole, and the bound holds
/// both ways. A curve that is written in several pieces is bounded by its displacement from `curve`.
pub(super) fn of(
    job: &Job,
    curve: &Curve,
    tips: &[Point3<f64>],
    section_height: f64,
    seam: Seam,
) -> Result<Deviation, Error> {
    let chord = tips.windows(2).map(|pair| (pair[1] - pair[0]).norm()).fold(0.0, f64::max);
    let known =
        section_height + seam.jump + seam.bend * chord + ACCURACY_MM + ROUNDING * tips[0].coords.amax();
    let computed = from_tips(curve, tips, chord).and(known);
    let rounded = round(curve, job.resolution, &job.curves)?;
    let written = match &rounded.curves[..] {
        // The curve vanishes on the grid: its length, and the rounding of a point by half a step along each
        // axis, bound the deviation.
        [] => Deviation::within(curve.length() + job.resolution.step_mm()),
        [only] => from_tips(&only.curve, tips, chord).and(known + only.slack_mm),
        _ => computed.and(rounded.displacement_mm),
    };
    let grid = Grid::new(job.resolution);
    let mut deviation = computed.or_more(&written);
    for end in [tips[0], tips[tips.len() - 1]] {
        let moved = (grid.point(grid.round(&end)?) - end).norm();
        deviation = deviation.or_more(&Deviation { bound_mm: moved, found_mm: moved });
    }
    Ok(deviation)
}

/// The deviation of a curve from the chords of the tips; `chord` is the length of the longest chord, mm.
fn from_tips(curve: &Curve, tips: &[Point3<f64>], chord: f64) -> Deviation {
    let farthest = tips.iter().map(|tip| curve.distance_to(tip)).fold(0.0, f64::max);
    let under = |radius: f64| chord_height(chord, 1.0 / (radius - farthest).max(0.0));
    let height = match curve {
        Curve::Line(_) => 0.0,
        Curve::Arc(arc) => under(arc.radius()),
        Curve::Parabola(parabola) => under(1.0 / parabola.largest_curvature()),
    };
    Deviation { bound_mm: farthest + height, found_mm: farthest }
}

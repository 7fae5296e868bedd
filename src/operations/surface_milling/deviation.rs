//! How far curves leave the exact CL curve, as computed and as written.

use nalgebra::Point3;

use super::{Error, Job};
use crate::geometry::curve::Curve;
use crate::machining::offset_section::chord_height;
use crate::toolpath::quantize::{Grid, Parabolas, round};

/// How exactly a tip lies on its section, mm.
const ACCURACY_MM: f64 = 2e-10;

/// Rounding of a distance in parts of the coordinates.
const ROUNDING: f64 = 1e-14;

/// A bound is sharp within this factor of what was found and so many steps of the last decimal.
const SHARP: [f64; 2] = [2.0, 1.5];

/// What the exact CL curve may do where patches join that are smooth but for the rounding of their data.
#[derive(Debug, Clone, Copy)]
pub(super) struct Seam {
    /// It jumps by this at most, mm.
    pub(super) jump: f64,
    /// It leaves a chord across the joint by this part of the chord at most: a quarter of the angle in which
    /// it bends.
    pub(super) bend: f64,
}

impl Seam {
    /// The CL curve is the exact one everywhere.
    pub(super) const NONE: Self = Self { jump: 0.0, bend: 0.0 };
}

/// The distance between the exact CL curve and curves that stand for it, mm.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Deviation {
    /// Proved, both ways.
    pub(super) bound_mm: f64,
    /// Between the CL points and the curves: the true one is no less.
    pub(super) found_mm: f64,
}

impl Deviation {
    pub(super) const NONE: Self = Self::within(0.0);

    /// A bound, under which nothing was found.
    pub(super) const fn within(bound_mm: f64) -> Self {
        Self { bound_mm, found_mm: 0.0 }
    }

    /// The larger of each.
    pub(super) fn or_more(&self, other: &Self) -> Self {
        Self { bound_mm: self.bound_mm.max(other.bound_mm), found_mm: self.found_mm.max(other.found_mm) }
    }

    fn and(&self, more_mm: f64) -> Self {
        Self { bound_mm: self.bound_mm + more_mm, ..*self }
    }

    /// Whether the bound is not much larger than what was found, with steps of the last decimal of `step_mm`.
    pub(super) fn is_sharp(&self, step_mm: f64) -> bool {
        self.bound_mm <= SHARP[0] * self.found_mm + SHARP[1] * step_mm
    }
}

/// Bounds the distance, both ways, between the CL curve through `tips` and `curve`, as computed and as
/// written.
///
/// Between neighbouring tips the CL curve leaves their chord by at most `section_height`, and what `seam`
/// adds. A point of the chord is as far from a line as its ends, and from an arc, which lies as far away as
/// the tips at most, by the height of the chord under that arc more. Ends correspond to ends, and arcs go
/// round their centres as the tips do, so the nearest points of a path that stays in so narrow a band run
/// over all of the other: the bound holds both ways. What is written in several pieces is bounded by its
/// displacement from `curve`.
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
    let rounded = round(curve, job.resolution, Parabolas::AsLines)?;
    let written = match &rounded.curves[..] {
        // The element vanishes on the grid; what remains is its length, and half a step each way.
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

/// From the chords of the tips, of which the longest is known.
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

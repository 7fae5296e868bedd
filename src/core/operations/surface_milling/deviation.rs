//! Bounds the distance of the curves of a pass from the exact CL curve, for the curves as computed and as the
//! program states them.

use nalgebra::Point3;

use super::{Error, Job};
use crate::geometry::curve::Curve;
use crate::geometry::following;
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
    /// The proved bound, both ways and in order.
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
/// The distance is taken in order: two places that move along the CL curve and along `curve`, from start to
/// end and never back, are never farther apart.
///
/// Between neighbouring tips the CL curve leaves their chord by at most `section_height` plus the part of
/// `seam`. A curve that is written in several pieces is bounded by its displacement from `curve`.
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

/// The deviation of a curve from the chords of the tips, in order; `chord` is the length of the longest
/// chord, mm.
///
/// If the places nearest to the tips follow each other along the curve in the order of the tips, each chord
/// is compared with the curve between its own two places. A point of a chord is no farther from a line than
/// the ends of the chord are. It may be farther from an arc, by at most the height of the chord under a
/// concentric arc; that arc's radius is smaller by the largest distance of a tip. What the curve has before
/// the place of the first tip and beyond that of the last is no farther from these tips than its ends are. If
/// the places are not in order, [`following::from_lines`] bounds the distance in order.
fn from_tips(curve: &Curve, tips: &[Point3<f64>], chord: f64) -> Deviation {
    let farthest = tips.iter().map(|tip| curve.distance_to(tip)).fold(0.0, f64::max);
    let [first, last] = [tips[0], tips[tips.len() - 1]];
    let at_ends = (curve.start() - first).norm().max((curve.end() - last).norm());
    if !following::is_in_order(curve, tips) {
        let bound_mm = following::from_lines(curve, tips).max(at_ends);
        return Deviation { bound_mm, found_mm: farthest };
    }
    let under = |radius: f64| chord_height(chord, 1.0 / (radius - farthest).max(0.0));
    let height = match curve {
        Curve::Line(_) => 0.0,
        Curve::Arc(arc) => under(arc.radius()),
        Curve::Parabola(parabola) => under(1.0 / parabola.largest_curvature()),
    };
    Deviation { bound_mm: (farthest + height).max(at_ends), found_mm: farthest }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::geometry::curve::{Arc, Direction, Line};
    use crate::geometry::plane::Plane;

    /// Points of a curve of each, of the lines between the tips and of the curve, for [`in_order`].
    const SAMPLES: usize = 300;

    fn bound(curve: &Curve, tips: &[Point3<f64>]) -> f64 {
        let chord = tips.windows(2).map(|pair| (pair[1] - pair[0]).norm()).fold(0.0, f64::max);
        from_tips(curve, tips, chord).bound_mm
    }

    /// The distance in order between a curve and the lines between the tips, by dense samples.
    fn in_order(curve: &Curve, tips: &[Point3<f64>]) -> f64 {
        let each = SAMPLES / tips.len();
        let line = |pair: &[Point3<f64>], k: usize| pair[0] + (pair[1] - pair[0]) * (k as f64 / each as f64);
        let way = tips.windows(2).flat_map(|pair| (0..each).map(|k| line(pair, k)).collect::<Vec<_>>());
        let own: Vec<_> = (0..=SAMPLES).map(|k| curve.point_at(k as f64 / SAMPLES as f64)).collect();
        let mut row = vec![f64::INFINITY; own.len()];
        for (n, p) in way.chain(tips.last().copied()).enumerate() {
            let mut before = if n == 0 { 0.0 } else { f64::INFINITY };
            let mut next = Vec::with_capacity(own.len());
            for (j, q) in own.iter().enumerate() {
                let diagonal = if j > 0 { row[j - 1] } else { f64::INFINITY };
                before = before.min(row[j]).min(diagonal).max((p - q).norm());
                next.push(before);
            }
            row = next;
        }
        row[row.len() - 1]
    }

    /// A line or an arc of 10 mm, and tips beside it.
    fn pass(turn: f64, beside: &[f64]) -> (Curve, Vec<Point3<f64>>) {
        let n = beside.len() - 1;
        let (start, end) = (Point3::origin(), Point3::new(10.0, 0.0, 0.0));
        let curve = if turn == 0.0 {
            Curve::Line(Line { start, end })
        } else {
            let radius = 5.0 / (0.5 * turn).sin();
            let center = Point3::new(5.0, 0.0, -radius * (0.5 * turn).cos());
            Curve::Arc(Arc::new(Plane::Zx, Direction::Ccw, start, end, center).unwrap())
        };
        let tip = |k: usize| {
            let off = if k == 0 || k == n { 0.0 } else { beside[k] };
            curve.point_at(k as f64 / n as f64) + nalgebra::Vector3::z() * off
        };
        (curve, (0..=n).map(tip).collect())
    }

    #[test]
    fn tips_that_run_back_are_far_although_each_is_near() {
        for turn in [0.0, 0.4, 2.0] {
            let (curve, tips) = pass(turn, &[0.0; 21]);
            assert!(bound(&curve, &tips) < 0.07);
            // From 6.5 mm back to 3.5 mm: the middle is 1.5 mm away from both.
            let back = tips[..=13].iter().chain(tips[7..13].iter().rev()).chain(&tips[7..]);
            let found = bound(&curve, &back.copied().collect::<Vec<_>>());
            assert!((1.3..3.2).contains(&found), "{turn} {found}");
            let (mut swapped, n) = (tips.clone(), tips.len());
            swapped[3..6].copy_from_slice(&tips[n - 6..n - 3]);
            swapped[n - 6..n - 3].copy_from_slice(&tips[3..6]);
            assert!(bound(&curve, &swapped) > 2.0, "{turn}");
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(ProptestConfig::default().cases / 4) })]

        /// Tips beside a curve, in order, or with two stretches swapped, or a stretch reversed.
        #[test]
        fn no_tips_in_any_order_are_farther_than_the_bound(
            turn in prop_oneof![Just(0.0), 0.05..2.8f64], beside in prop::collection::vec(-0.01..0.01f64, 12..30),
            change in 0..3u8, place in 0.1..0.4f64,
        ) {
            let (curve, mut tips) = pass(turn, &beside);
            let (n, from) = (tips.len(), (place * tips.len() as f64) as usize);
            match change {
                0 => {}
                1 => (0..3).for_each(|k| tips.swap(from + k, n - 4 - from + k)),
                _ => tips[from..from + 4].reverse(),
            }
            let (bound, found) = (bound(&curve, &tips), in_order(&curve, &tips));
            // Samples are up to 0.1 mm apart.
            prop_assert!(bound >= found - 0.1, "{bound} {found}");
            if change == 0 {
                prop_assert!(bound <= 0.1);
            }
        }
    }
}

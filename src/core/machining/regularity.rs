//! Proves that a ball cutter of radius R can follow a surface.
//!
//! Two conditions must hold at every point of the surface:
//! 1. The normal points up: its z coordinate is positive.
//! 2. Every concave curvature is below 1 / R. Then the offset by R does not fold.
//!
//! # Method
//! Bound the normal and the principal curvatures over each patch from its control net ([`curvature`]). If
//! these bounds do not prove both conditions for the patch, halve the patch, and do the same with each half.
//!
//! # Guarantees
//! * `Ok` means that both conditions are proved for every point of the surface. It comes with a
//!   [`Regularity`]: bounds for the whole offset, and for the sections of the offset with planes at right
//!   angles to the chosen axis.
//! * The error `Overhang` means that condition 1 fails at some point, and the error `Folds` that condition 2
//!   fails. The same errors are returned if a condition is neither proved nor refuted after 42 halvings, or
//!   after 200,000 subpatches of one patch.
//!
//! # Cost
//! O(n) for n subpatches. The closer the largest concave curvature comes to 1 / R, the more subpatches are
//! needed.

use nalgebra::Point3;

use crate::budget::{Budget, Stopped};
use crate::geometry::surface::curvature;
use crate::geometry::surface::{BezierSurface, Jet, Patch, Surface};

/// Why a surface cannot be followed by the cutter.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum Irregular {
    #[error(transparent)]
    Stopped(#[from] Stopped),
    #[error("the surface is vertical, overhangs or has no normal near {at}")]
    Overhang { at: Point3<f64> },
    #[error("the offset surface folds near {at}")]
    Folds { at: Point3<f64> },
}

/// The proved bounds for a surface, and for the sections of its offset with planes at right angles to one
/// axis.
#[derive(Debug, Clone, PartialEq)]
pub struct Regularity {
    spans: [usize; 2],
    /// For each patch an upper bound of the curvature of the sections, 1/mm.
    section_curvatures: Vec<f64>,
    slopes: Vec<Slope>,
}

/// A class of places on the offset of a surface that are about equally steep across parallel planes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Slope {
    /// Distance of two planes, divided by the distance of the sections in them along the surface. It is 1
    /// where the surface does not rise across the planes, and less where the surface is steeper. A lower
    /// bound.
    pub share: f64,
    /// Largest concave curvature of the offset at places that are this steep or less steep, 1/mm; zero or
    /// more. An upper bound.
    pub concavity: f64,
}

/// Number of classes of steepness. Each covers an equal range of shares.
const SLOPE_CLASSES: usize = 64;

/// The proved bounds for a box that a ball can follow.
#[derive(Debug, Clone, Copy)]
struct Followed {
    section_curvature: f64,
    slope: Slope,
    /// Whether the slope's share is nearly the share at the box's centre.
    is_sharp: bool,
}

impl Regularity {
    /// The worst values of each class of steepness that occurs, the least steep class first.
    pub fn slopes(&self) -> &[Slope] {
        &self.slopes
    }

    /// The bound of the sections' curvature, 1/mm, over patch (i, j) and the patches around it.
    pub fn section_curvature_around(&self, i: usize, j: usize) -> f64 {
        let [nu, nv] = self.spans;
        let mut bound = 0.0f64;
        for i in i.saturating_sub(1)..=(i + 1).min(nu - 1) {
            for j in j.saturating_sub(1)..=(j + 1).min(nv - 1) {
                bound = bound.max(self.section_curvatures[i * nv + j]);
            }
        }
        bound
    }
}

/// Largest number of halvings of one patch. A box at this depth is two million times smaller than its patch.
/// If it is still undecided, it violates the condition, or holds it by less than a micrometre's part of the
/// cutter.
const DEPTH_LIMIT: u32 = 42;

/// A slope is sharp when its share is at least this part of the share at the box's centre. Scallops grow with
/// the inverse square of the share, so they are overestimated by about a tenth at most.
const SHARPNESS: f64 = 0.95;

/// The sharpness that is enough for a box less steep and less concave than other places of the surface: the
/// other places leave higher scallops.
const SHARPNESS_ELSEWHERE: f64 = 0.85;

/// Samples of a patch, each way, in the search for the steepest and the most concave place.
const SAMPLES: usize = 3;

/// Depth to which a patch is halved only to make slopes sharp.
const SHARP_DEPTH: u32 = 14;

/// Largest number of boxes of one patch. A fold or an overhang is found at a box's centre long before. Only a
/// surface that reaches the limit of a condition along a curve needs so many boxes.
const BOX_LIMIT: usize = 200_000;

/// Proves that a ball of `radius` mm can follow `surface`, whose normal points up at its first corner, and
/// bounds the curvature of the offset's sections by planes at right angles to `axis` (0 is x, 1 is y).
///
/// # Errors
/// The place where the proof fails, or the budget's stop.
pub fn prove(
    surface: &BezierSurface<impl Patch>,
    radius: f64,
    axis: usize,
    budget: &Budget,
) -> Result<Regularity, Irregular> {
    let worst = worst_slope(surface, radius, axis, budget)?;
    let mut proof = Proof { radius, axis, worst, boxes: 0, slopes: [None; SLOPE_CLASSES], budget };
    let mut section_curvatures = Vec::with_capacity(surface.patches().len());
    for patch in surface.patches() {
        match proof.of_patch(patch) {
            Ok(bound) => section_curvatures.push(bound),
            Err(Irregular::Folds { at }) => return Err(tightest(surface, at, budget)?),
            Err(other) => return Err(other),
        }
    }
    // A move up or down a slope passes places that are less steep. Their concavity counts here too.
    let mut concavity = 0.0f64;
    let from_level = proof.slopes.into_iter().rev().flatten();
    let slopes = from_level
        .map(|slope| {
            concavity = concavity.max(slope.concavity);
            Slope { concavity, ..slope }
        })
        .collect();
    Ok(Regularity { spans: surface.spans(), section_curvatures, slopes })
}

/// The error `Folds` at the most concave of 5 x 5 points of each patch, or at `at` if no point is concave.
fn tightest(
    surface: &BezierSurface<impl Patch>,
    at: Point3<f64>,
    budget: &Budget,
) -> Result<Irregular, Stopped> {
    let mut worst = (0.0, at);
    let [nu, nv] = surface.spans();
    for i in 0..nu {
        budget.check()?;
        for (j, k) in (0..nv).flat_map(|j| (0..25).map(move |k| (j, k))) {
            let jet = surface.patch(i, j).jet(f64::from(k / 5) / 4.0, f64::from(k % 5) / 4.0);
            let concave = curvature::most_concave_at(&jet);
            if jet.normal().z > 0.0 && concave > worst.0 {
                worst = (concave, jet.point);
            }
        }
    }
    Ok(Irregular::Folds { at: worst.1 })
}

/// The least share and the largest concavity among samples of the surface, which may be at different places.
fn worst_slope(
    surface: &BezierSurface<impl Patch>,
    radius: f64,
    axis: usize,
    budget: &Budget,
) -> Result<Slope, Stopped> {
    let mut worst = Slope { share: 1.0, concavity: 0.0 };
    let at = |k: usize| k as f64 / (SAMPLES - 1) as f64;
    for patch in surface.patches() {
        budget.check()?;
        for k in 0..SAMPLES * SAMPLES {
            let jet = patch.jet(at(k / SAMPLES), at(k % SAMPLES));
            worst.share = worst.share.min(share_at(&jet, axis));
            let concave = curvature::most_concave_at(&jet);
            let margin = 1.0 - radius * concave;
            if margin > 0.0 {
                worst.concavity = worst.concavity.max(concave / margin);
            }
        }
    }
    Ok(worst)
}

/// The share at a place: the length of the unit normal's component in the plane.
fn share_at(jet: &Jet, axis: usize) -> f64 {
    let normal = jet.normal();
    (1.0 - (normal[axis] / normal.norm()).powi(2)).sqrt()
}

struct Proof<'a> {
    radius: f64,
    axis: usize,
    worst: Slope,
    /// Boxes examined so far.
    boxes: usize,
    /// The least share and the largest concavity of each class of shares.
    slopes: [Option<Slope>; SLOPE_CLASSES],
    budget: &'a Budget,
}

impl Proof<'_> {
    /// Proves one patch. Returns the bound of the sections' curvature over it, 1/mm.
    fn of_patch(&mut self, patch: &impl Patch) -> Result<f64, Irregular> {
        let mut bound = 0.0f64;
        let mut stack = vec![(*patch, 0u32)];
        let limit = self.boxes + BOX_LIMIT;
        while let Some((part, depth)) = stack.pop() {
            self.boxes += 1;
            if self.boxes.is_multiple_of(1024) {
                self.budget.check()?;
            }
            let may_halve = depth < DEPTH_LIMIT && self.boxes < limit;
            match self.examine(&part) {
                Finding::Followed(followed) if followed.is_sharp || depth >= SHARP_DEPTH || !may_halve => {
                    bound = bound.max(followed.section_curvature);
                    self.note(followed.slope);
                }
                Finding::Followed(_) | Finding::Undecided(_) if may_halve => {
                    stack.extend(part.split_by_bend().map(|half| (half, depth + 1)));
                }
                Finding::Undecided(Doubt::Curvature) | Finding::Folds => {
                    return Err(Irregular::Folds { at: part.center().into() });
                }
                Finding::Followed(_) | Finding::Undecided(Doubt::Normal) | Finding::Overhang => {
                    return Err(Irregular::Overhang { at: part.center().into() });
                }
            }
        }
        Ok(bound)
    }

    fn note(&mut self, slope: Slope) {
        let class = ((slope.share * SLOPE_CLASSES as f64) as usize).min(SLOPE_CLASSES - 1);
        let known = self.slopes[class].get_or_insert(slope);
        known.share = known.share.min(slope.share);
        known.concavity = known.concavity.max(slope.concavity);
    }
}

enum Doubt {
    Normal,
    Curvature,
}

enum Finding {
    Followed(Followed),
    Undecided(Doubt),
    Overhang,
    Folds,
}

impl Proof<'_> {
    /// Decides one part. Condition 2 must be shown with at least half the margin 1 - R k, where k is the
    /// largest concave curvature at the centre of the part.
    fn examine(&self, part: &impl Patch) -> Finding {
        let Self { radius, axis, worst, .. } = *self;
        let derivatives = part.derivatives();
        let cross = derivatives.normal();
        let length = cross.center.norm();
        let at_center = part.jet(0.5, 0.5);
        let normal_at_center = at_center.normal();
        if normal_at_center.z <= 0.0 {
            return Finding::Overhang;
        }
        if cross.center.z <= cross.radius {
            return Finding::Undecided(Doubt::Normal);
        }
        let Some([low, high]) = curvature::bounds(&derivatives) else {
            return Finding::Undecided(Doubt::Curvature);
        };
        let true_high = curvature::most_concave_at(&at_center);
        if radius * true_high >= 1.0 {
            return Finding::Folds;
        }
        let margin = 1.0 - radius * high;
        if margin < 0.5 * (1.0 - radius * true_high) || margin <= 0.0 {
            return Finding::Undecided(Doubt::Curvature);
        }
        // The section's curvature is the normal curvature of the offset, divided by the length of the unit
        // normal's component in the plane.
        let mut in_plane = cross.center;
        in_plane[axis] = 0.0;
        let share = (in_plane.norm() - cross.radius) / (length + cross.radius);
        if share <= 0.0 {
            return Finding::Undecided(Doubt::Normal);
        }
        let offset_curvature = (high / margin).abs().max((low / (1.0 - radius * low)).abs());
        let concavity = (high / margin).max(0.0);
        let is_worst = share < worst.share || concavity > worst.concavity;
        let sharpness = if is_worst { SHARPNESS } else { SHARPNESS_ELSEWHERE };
        Finding::Followed(Followed {
            section_curvature: offset_curvature / share,
            slope: Slope { share, concavity },
            is_sharp: share >= sharpness * share_at(&at_center, axis),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::surface::point_grid::{Ends, PointGrid, Twist};

    fn grid(n: usize, half: f64, height: impl Fn(f64, f64) -> f64) -> BezierSurface {
        let at = |i: usize| half * (2.0 * i as f64 / (n - 1) as f64 - 1.0);
        let points = (0..n)
            .map(|i| (0..n).map(|j| Point3::new(at(i), at(j), height(at(i), at(j)))).collect())
            .collect();
        PointGrid { points, twist: Twist::Spline, ends: Ends::NotAKnot }.surface().unwrap()
    }

    #[test]
    fn a_trough_tighter_than_the_ball_folds_at_its_bottom() {
        let trough = grid(9, 4.0, |x, _| 0.4 * x * x);
        for axis in [0, 1] {
            match prove(&trough, 2.5, axis, &Budget::unlimited()) {
                Err(Irregular::Folds { at }) => assert!(at.x.abs() < 1e-9, "{at}"),
                other => panic!("{other:?}"),
            }
            // The radius of curvature at the bottom is 1.25.
            assert!(prove(&trough, 1.24, axis, &Budget::unlimited()).is_ok());
            assert!(prove(&trough, 1.26, axis, &Budget::unlimited()).is_err());
        }
    }

    #[test]
    fn curvature_bounds_are_above_the_true_curvature_and_close() {
        // A cylinder of radius 40 along y, convex: its offset's sections at constant y have radius 45.
        let dome = grid(41, 30.0, |x, _| (1600.0 - x * x).sqrt());
        let bound = prove(&dome, 5.0, 1, &Budget::unlimited()).unwrap();
        for i in 0..40 {
            let k = bound.section_curvature_around(i, 20);
            assert!((1.0 / 45.0 - 1e-4..1.5 / 45.0).contains(&k), "{k}");
        }
    }

    #[test]
    fn an_overhang_is_found() {
        let points = [(0.0, 0.0), (5.0, 1.0), (5.5, 6.0), (3.0, 9.0), (8.0, 12.0)];
        let grid = PointGrid {
            points: points
                .iter()
                .map(|&(x, z)| vec![Point3::new(x, 0.0, z), Point3::new(x, 9.0, z)])
                .collect(),
            twist: Twist::Spline,
            ends: Ends::Natural,
        };
        let result = prove(&grid.surface().unwrap(), 0.1, 1, &Budget::unlimited());
        assert!(matches!(result, Err(Irregular::Overhang { .. })), "{result:?}");
    }
}

//! Estimates the height of scallops: of the material that a ball cutter leaves between neighbouring passes in
//! parallel planes. The stepover of a job is chosen by it. What is left is proved by `leftover`.
//!
//! # Method
//! 1. Let a ball touch the surface anywhere. From its centre, follow the offset surface straight up or down
//!    its slope, to the nearest plane of a pass. The distance of the planes and the steepness of the slope
//!    ([`Slope`]) bound the length of this way.
//! 2. A second ball, which is a position of the cutter on that pass, has its centre at the end of the way.
//!    The largest concave curvature of the offset and the length of the way bound how much higher the second
//!    ball lies.
//! 3. The second ball removes the material above the touched point down to some height above this point.
//!    Compute this height from the results of steps 1 and 2. It is the bound.
//!
//! # Guarantees
//! The result is an upper bound for passes that follow the CL curves exactly. On a plane it is the exact
//! height. Places near an edge of the surface are not covered if the way of step 1 would leave the surface
//! there.

use crate::budget::{Budget, Stopped};
use crate::geometry::solve::bisect;
use crate::geometry::surface::{BezierSurface, Patch, curvature};
use crate::machining::regularity::Slope;

/// Sampled places along each parameter of a patch.
const SAMPLES: usize = 5;

/// The least share of a sampled slope. Steeper slopes count as this steep: no spacing of planes serves walls.
const LEAST_SHARE: f64 = 0.05;

/// A ball fits only just if its radius is more than this part of the concave radius of curvature. Nearer to
/// 1, the concavity of the offset grows without bound, and one tight place would decide the spacing of all
/// planes.
const FITS_PART: f64 = 0.9;

/// The stepover of a flat end on level ground, as a share of its diameter.
const FLAT_SHARE: f64 = 0.9;

/// Bisection steps for a spacing; 60 find it to the last bit.
const HALVINGS: usize = 60;

/// The largest scallop height that a ball of `radius` mm leaves between planes `spacing` mm apart, mm; `None`
/// if the passes are too far apart to meet.
pub(super) fn height(radius: f64, spacing: f64, slopes: &[Slope]) -> Option<f64> {
    slopes.iter().try_fold(0.0f64, |highest, slope| Some(highest.max(height_at(radius, spacing, slope)?)))
}

/// The largest spacing of planes with scallops no higher than `height_mm`, mm.
pub(super) fn spacing(radius: f64, height_mm: f64, slopes: &[Slope]) -> f64 {
    let is_low = |spacing: f64| height(radius, spacing, slopes).is_some_and(|left| left <= height_mm);
    bisect([0.0, 2.0 * radius], HALVINGS, is_low)[0]
}

/// The largest spacing of planes at which a flat end leaves stairs no higher than `height_mm`, mm. On a slope
/// whose normal has the sine n across the planes, stairs of width s are n s high. On level ground the spacing
/// is most of the diameter.
pub(super) fn spacing_of_flat_ends(radius: f64, height_mm: f64, slopes: &[Slope]) -> f64 {
    let steepest =
        slopes.iter().map(|slope| (1.0 - slope.share * slope.share).max(0.0).sqrt()).fold(0.0, f64::max);
    (height_mm / steepest).min(FLAT_SHARE * 2.0 * radius)
}

/// Slopes and concavities at sampled places, for a surface on which not all can be proved. Where a ball of
/// `radius` mm does not fit, or only just fits, the concavity counts as zero.
pub(super) fn sampled_slopes(
    surface: &BezierSurface<impl Patch>,
    radius: f64,
    axis: usize,
    budget: &Budget,
) -> Result<Vec<Slope>, Stopped> {
    let mut slopes = vec![Slope { share: 1.0, concavity: 0.0 }];
    for patch in surface.patches() {
        budget.check()?;
        for k in 0..SAMPLES * SAMPLES {
            let at = |k: usize| k as f64 / (SAMPLES - 1) as f64;
            let jet = patch.jet(at(k / SAMPLES), at(k % SAMPLES));
            let Some(normal) = jet.normal().try_normalize(0.0).filter(|n| n.z > 0.0) else { continue };
            let share = (1.0 - normal[axis] * normal[axis]).max(0.0).sqrt().max(LEAST_SHARE);
            let concave = curvature::most_concave_at(&jet);
            let fits = radius * concave < FITS_PART;
            let concavity = if fits { (concave / (1.0 - radius * concave)).max(0.0) } else { 0.0 };
            slopes.push(Slope { share, concavity });
        }
    }
    Ok(slopes)
}

/// The bound h for one slope; `None` if the passes are too far apart to meet.
///
/// Let s be the spacing and R the radius. A ball that touches the surface at P, with the unit normal n, has
/// its centre at O = P + R n. The way from O across the planes to the nearest pass is at most l = s / (2 q).
/// Here q is the slope's share. Let C be the centre of the ball there, and k the largest concave curvature of
/// the offset. Then |C - O| <= l and n . (C - O) <= k l^2 / 2. The ball about C reaches down to the height h
/// over P, where
///
/// (R - h)^2 + k l^2 (R - h) + l^2 = R^2.
fn height_at(radius: f64, spacing: f64, slope: &Slope) -> Option<f64> {
    let way = 0.5 * spacing / slope.share;
    if way >= radius {
        return None;
    }
    let half_sum = 0.5 * slope.concavity * way * way;
    // R - h is the positive root of the equation; this form of h avoids cancellation.
    let root = half_sum.hypot((radius * radius - way * way).sqrt());
    Some((way * way + 2.0 * radius * half_sum) / (radius + half_sum + root))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn on_a_plane_the_bound_is_the_height_of_the_cusp() {
        for (radius, spacing, slope) in [(5.0f64, 1.0f64, 0.0f64), (3.0, 0.2, 1.0), (10.0, 6.0, 0.7)] {
            let share = 1.0 / (1.0 + slope * slope).sqrt();
            let apart = spacing / share;
            let cusp = radius - (radius * radius - 0.25 * apart * apart).sqrt();
            let slopes = [Slope { share, concavity: 0.0 }];
            assert!((height(radius, spacing, &slopes).unwrap() - cusp).abs() < 1e-12);
            assert!((super::spacing(radius, cusp, &slopes) - spacing).abs() < 1e-9);
        }
    }

    #[test]
    fn in_a_trough_the_bound_is_not_below_the_height_of_the_cusp() {
        // A cylinder of radius 20 along the planes; the centres of the passes lie on a cylinder of radius 15.
        let (radius, trough) = (5.0f64, 20.0f64);
        for half_angle in [0.01f64, 0.03, 0.1] {
            let (center_x, center_z) = (15.0 * half_angle.sin(), -15.0 * half_angle.cos());
            let cusp_z = center_z - (radius * radius - center_x * center_x).sqrt();
            let cusp = trough + cusp_z;
            let spacing = 2.0 * 15.0 * half_angle;
            let left = height(radius, spacing, &[Slope { share: 1.0, concavity: 1.0 / 15.0 }]).unwrap();
            assert!(left >= cusp && left <= 1.05 * cusp, "{left} {cusp}");
        }
    }

    #[test]
    fn a_flat_end_leaves_stairs_on_slopes_and_nothing_on_level_ground() {
        let slope = |angle: f64| Slope { share: angle.cos(), concavity: 0.0 };
        assert!(
            (spacing_of_flat_ends(5.0, 0.02, &[slope(0.0), slope(0.5)]) - 0.02 / 0.5f64.sin()).abs() < 1e-12
        );
        assert!((spacing_of_flat_ends(5.0, 0.02, &[slope(0.0)]) - 9.0).abs() < 1e-12);
    }

    #[test]
    fn passes_that_do_not_meet_have_no_scallop_height() {
        let slopes = [Slope { share: 0.5, concavity: 0.0 }];
        assert_eq!(height(5.0, 5.0, &slopes), None);
        assert!(height(5.0, 4.999, &slopes).is_some());
        assert!(super::spacing(5.0, 100.0, &slopes) <= 5.0);
    }
}

//! The height of what a ball leaves between parallel passes.
//!
//! # Method
//! A point P of the surface with unit normal n has its ball centre O = P + R n on the offset. In the offset,
//! the way from O to the nearest of two sections whose planes are s apart is no longer than l = s / (2
//! share), straight up or down the slope across the planes (`share`: [`Slope`]). At its end lies a centre C
//! of a pass, with |C - O| <= l and n . (C - O) <= k l^2 / 2, where k is the largest concave curvature of the
//! offset. The ball about C reaches down to the height h over P for which (R - h)^2 + k l^2 (R - h) + l^2 =
//! R^2.
//!
//! # Guarantees
//! An upper bound, but for places so near to an edge of the surface that the way to the pass would leave it.
//! On a plane it is the height itself.

use crate::budget::{Budget, Stopped};
use crate::geometry::solve::bisect;
use crate::geometry::surface::{BezierSurface, Patch, curvature};
use crate::machining::regularity::Slope;

/// Places of a patch, each way, at which slopes are looked at.
const SAMPLES: usize = 5;

/// Slopes of the surface steeper than this across the planes are left out of what is sampled: no spacing of
/// planes serves walls.
const LEAST_SHARE: f64 = 0.05;

/// Passes of flat ends over level ground are this part of the diameter apart.
const FLAT_SHARE: f64 = 0.9;

/// Halvings in the search for a spacing: to the last bit.
const HALVINGS: usize = 60;

/// The largest height left between passes in planes `spacing` mm apart by a ball of `radius` mm, mm; `None`
/// where the passes are too far apart to meet.
pub(super) fn height(radius: f64, spacing: f64, slopes: &[Slope]) -> Option<f64> {
    slopes.iter().try_fold(0.0f64, |highest, slope| Some(highest.max(height_at(radius, spacing, slope)?)))
}

/// The largest spacing of planes that leaves no more than `height_mm`, mm.
pub(super) fn spacing(radius: f64, height_mm: f64, slopes: &[Slope]) -> f64 {
    let is_low = |spacing: f64| height(radius, spacing, slopes).is_some_and(|left| left <= height_mm);
    bisect([0.0, 2.0 * radius], HALVINGS, is_low)[0]
}

/// The largest spacing of planes at which a flat end leaves stairs no higher than `height_mm` on slopes
/// across the planes, mm: at a slope whose normal has the sine n across the planes, stairs of width s are n s
/// high. On level ground it is most of the diameter.
pub(super) fn spacing_of_flat_ends(radius: f64, height_mm: f64, slopes: &[Slope]) -> f64 {
    let steepest =
        slopes.iter().map(|slope| (1.0 - slope.share * slope.share).max(0.0).sqrt()).fold(0.0, f64::max);
    (height_mm / steepest).min(FLAT_SHARE * 2.0 * radius)
}

/// Slopes and concavities at places of a surface, where a proof of them all cannot be had; where a ball of
/// `radius` mm does not fit, as if it just did not.
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
            let fits = radius * concave < 0.9;
            let concavity = if fits { (concave / (1.0 - radius * concave)).max(0.0) } else { 0.0 };
            slopes.push(Slope { share, concavity });
        }
    }
    Ok(slopes)
}

fn height_at(radius: f64, spacing: f64, slope: &Slope) -> Option<f64> {
    let way = 0.5 * spacing / slope.share;
    if way >= radius {
        return None;
    }
    let half_sum = 0.5 * slope.concavity * way * way;
    // R - h is the positive root; this form of h does not cancel.
    let root = half_sum.hypot((radius * radius - way * way).sqrt());
    Some((way * way + 2.0 * radius * half_sum) / (radius + half_sum + root))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn on_a_plane_it_is_the_height_of_the_cusp() {
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
    fn in_a_trough_it_is_not_below_the_height_of_the_cusp() {
        // A cylinder of radius 20 along the planes; centres on one of 15, a way along it apart.
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
    fn passes_that_do_not_meet_leave_no_height() {
        let slopes = [Slope { share: 0.5, concavity: 0.0 }];
        assert_eq!(height(5.0, 5.0, &slopes), None);
        assert!(height(5.0, 4.999, &slopes).is_some());
        assert!(super::spacing(5.0, 100.0, &slopes) <= 5.0);
    }
}

//! Legs: the pieces of the basic curve with their projections on the xy plane.
//!
//! # Method
//! * A piece whose projection is straight (a line, or any piece in an upright plane) is projected to a line.
//!   The heights of the piece stay exact.
//! * A level arc is projected to an arc, and a cubic to a cubic.
//! * The projection of a tilted arc is a part of an ellipse, whose unit normal is no quotient of polynomials
//!   of a low degree. Cubics in the angle replace such an arc.

use nalgebra::{Point2, Point3, Vector2, Vector3};

use super::{NormalSweepError, TOLERANCE_MM};
use crate::geometry::profile::{Piece, Profile, Shape};
use crate::geometry::surface::any_surface::PATCH_LIMIT;

/// Heights and lengths in plan below this are rounding, mm.
const NOTHING_MM: f64 = 1e-9;

/// The share of the tolerance that a straight projection may leave its chord by. What it turns the normals
/// by is counted.
const STRAIGHT_SHARE: f64 = 0.1;

/// A piece of the basic curve, or a part of it.
pub(super) struct SweepLeg {
    pub(super) plan: Piece<2>,
    /// In space; it has the same control points as `plan` where that is no line.
    pub(super) space: Shape<3>,
}

/// The legs in order, and for each piece of the basic curve the index of its first leg. The drive curve
/// reaches at most `reach` mm to a side.
pub(super) fn legs(basic: &Profile<3>, reach: f64) -> Result<(Vec<SweepLeg>, Vec<usize>), NormalSweepError> {
    let mut legs = Vec::with_capacity(basic.pieces().len());
    let mut firsts = Vec::with_capacity(basic.pieces().len());
    for Piece { shape, place } in basic.pieces() {
        firsts.push(legs.len());
        let place = *place;
        let mut add = |plan: Shape<2>, space: Shape<3>| {
            legs.push(SweepLeg { plan: Piece { shape: plan, place }, space });
        };
        let [low, high] = shape.range(2);
        let is_level = high - low <= NOTHING_MM;
        let plan = shape.mapped(|p| p.xy());
        match shape {
            Shape::Line([from, to]) => add(chord(&plan, place)?, Shape::Line([*from, *to])),
            _ if !is_level && is_straight(&plan, reach) => {
                let line = chord(&plan, place)?;
                if turns_back(&plan) {
                    return Err(NormalSweepError::Upright { place });
                }
                add(line, *shape);
            }
            Shape::Arc { points, .. } if !is_level => {
                for cubic in cubics(points, reach)? {
                    add(Shape::Cubic(cubic.map(|p| p.xy())), Shape::Cubic(cubic));
                }
            }
            Shape::Arc { .. } | Shape::Cubic(_) => add(plan, *shape),
        }
        if legs.len() > PATCH_LIMIT {
            return Err(NormalSweepError::TooManyPatches);
        }
    }
    Ok((legs, firsts))
}

fn chord(plan: &Shape<2>, place: usize) -> Result<Shape<2>, NormalSweepError> {
    let [from, to] = [plan.start(), plan.end()];
    if (to - from).norm() <= NOTHING_MM {
        return Err(NormalSweepError::Upright { place });
    }
    Ok(Shape::Line([from, to]))
}

/// Whether the surface with the normals of the chord is within a share of the tolerance.
fn is_straight(plan: &Shape<2>, reach: f64) -> bool {
    let points: Vec<Point2<f64>> = plan.control_points().into_iter().map(|(p, _)| p).collect();
    let chord = plan.end() - plan.start();
    let length = chord.norm();
    if length <= NOTHING_MM {
        // Upright, unless the piece comes back to its start.
        return points.iter().all(|p| (p - plan.start()).norm() <= NOTHING_MM);
    }
    let aside = points.iter().map(|p| (p - plan.start()).perp(&chord).abs() / length).fold(0.0, f64::max);
    // The tangents of a curve turn by at most some six times its height by its length.
    aside * (1.0 + 6.0 * reach / length) <= STRAIGHT_SHARE * TOLERANCE_MM
}

fn turns_back(plan: &Shape<2>) -> bool {
    let points = plan.control_points();
    let chord = plan.end() - plan.start();
    let back = |pair: &[(Point2<f64>, f64)]| (pair[1].0 - pair[0].0).dot(&chord) < -NOTHING_MM * chord.norm();
    points.windows(2).any(back)
}

/// Cubics in the angle for a tilted arc, with its points and its derivatives at their ends.
///
/// Over an angle h, such a cubic leaves a circle of radius R by at most R h^4 / 384, and its derivative that
/// of the circle by at most R h^3 sqrt(3) / 216. In plan the circle advances by at least R c for each radian,
/// where c is the cosine of its tilt. So the unit normal in plan turns by at most pi / 2 times the quotient.
fn cubics([a, corner, c]: &[Point3<f64>; 3], reach: f64) -> Result<Vec<[Point3<f64>; 4]>, NormalSweepError> {
    let middle = nalgebra::center(a, c);
    let (half_chord, height) = (0.5 * (c - a).norm(), (corner - middle).norm());
    let half_sweep = height.atan2(half_chord);
    let center = corner + (middle - corner) / half_sweep.sin().powi(2);
    let along = a - center;
    let radius = along.norm();
    let across: Vector3<f64> = (corner - a).normalize() * radius;
    let level = (along.cross(&across) / (radius * radius)).z.abs();
    let error = |h: f64| radius * h.powi(4) / 384.0 + reach * h.powi(3) * 0.0126 / level;
    let mut n = 1;
    while error(2.0 * half_sweep / n as f64).partial_cmp(&TOLERANCE_MM).is_none_or(|order| order.is_gt()) {
        n *= 2;
        if n > PATCH_LIMIT {
            return Err(NormalSweepError::TooManyPatches);
        }
    }
    let h = 2.0 * half_sweep / n as f64;
    let at = |k: usize| match k {
        0 => *a,
        _ if k == n => *c,
        _ => {
            let (sin, cos) = (k as f64 * h).sin_cos();
            center + along * cos + across * sin
        }
    };
    let way = |k: usize| {
        let (sin, cos) = (k as f64 * h).sin_cos();
        (across * cos - along * sin) * (h / 3.0)
    };
    Ok((0..n).map(|k| [at(k), at(k) + way(k), at(k + 1) - way(k + 1), at(k + 1)]).collect())
}

/// The place of a point along a line, as a part of the line.
pub(super) fn share(p: &Point3<f64>, [from, to]: &[Point2<f64>; 2]) -> f64 {
    let chord: Vector2<f64> = to - from;
    (p.xy() - from).dot(&chord) / chord.norm_squared()
}

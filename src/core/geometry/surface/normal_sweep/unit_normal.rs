//! Approximates the unit normal along the projection of a cubic on the xy plane by cubics. The exact unit
//! normal is not a polynomial. So the plane cubic is divided into parts, and each part gets a cubic that has
//! the values and the derivatives of the unit normal at both ends of the part.
//!
//! The points of the swept surface lie beside the plane cubic along its unit normal. The drive curve of the
//! sweep gives their distances.
//!
//! # Method
//! A part is halved until Bernstein coefficients prove two things for it:
//! 1. The surface with the approximate normal is within [`TOLERANCE_MM`] of the surface with the exact unit
//!    normal. Each halving makes the difference about sixteen times smaller.
//! 2. The surface does not fold along the part. It would fold where a parallel curve (a curve at constant
//!    distance from the part) runs backward. The parallel curves at the least and at the largest distance of
//!    the drive curve are examined. If these two do not run backward, no parallel curve between them does.

use nalgebra::{Point3, Vector2};

use super::TOLERANCE_MM;
use crate::geometry::bernstein::{derived, dot, lowest, magnitude};

/// Most halvings of a cubic of the data: the smallest parts are a billionth of it.
const MOST_HALVINGS: usize = 30;

/// A part of the cubic, and the cubic that replaces its unit normal.
pub(super) struct CubicPart {
    /// In space; the normals belong to its projection on the xy plane.
    pub(super) points: [Point3<f64>; 4],
    pub(super) normals: [Vector2<f64>; 4],
}

/// Why the cubic has no parts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum NormalFault {
    /// The derivative vanishes.
    Cusp,
    /// The centre of curvature is nearer than the drive curve reaches. `reach` is positive to the left, mm.
    Fold { reach: f64, radius_mm: f64 },
    /// The cubic needs more parts than the surface has room for.
    TooMany,
}

/// Parts from the start to the end of the cubic, at most `room`. The drive curve reaches from `reach[0]` to
/// `reach[1]` mm to the left.
pub(super) fn parts(
    cubic: [Point3<f64>; 4],
    reach: [f64; 2],
    room: usize,
) -> Result<Vec<CubicPart>, NormalFault> {
    let farthest = reach[0].abs().max(reach[1].abs());
    let mut open = vec![(cubic, 0)];
    let mut parts = Vec::new();
    while let Some((points, halvings)) = open.pop() {
        let part = CubicPart::of(points, reach)?;
        let error = part.normal_error();
        let is_near = error.is_finite() && error * farthest <= TOLERANCE_MM;
        if is_near && !reach.iter().any(|x| part.may_run_backward(*x)) {
            parts.push(part);
            if parts.len() > room {
                return Err(NormalFault::TooMany);
            }
        } else if halvings == MOST_HALVINGS {
            return Err(if is_near { part.fold(reach) } else { NormalFault::Cusp });
        } else {
            let [low, high] = halves(points);
            open.extend([(high, halvings + 1), (low, halvings + 1)]);
        }
    }
    Ok(parts)
}

impl CubicPart {
    fn of(points: [Point3<f64>; 4], reach: [f64; 2]) -> Result<Self, NormalFault> {
        let [a, b, c, d] = points.map(|p| p.xy());
        let [from, by_from] = end_normal((b - a) * 3.0, ((c - b) - (b - a)) * 6.0, reach)?;
        let [to, by_to] = end_normal((d - c) * 3.0, ((d - c) - (c - b)) * 6.0, reach)?;
        Ok(Self { points, normals: [from, from + by_from / 3.0, to - by_to / 3.0, to] })
    }

    /// The fold at the start of this part, on the side to which the curve turns.
    fn fold(&self, [low, high]: [f64; 2]) -> NormalFault {
        let along = (self.points[1] - self.points[0]).xy();
        let curvature = -(self.normals[1] - self.normals[0]).dot(&along) / along.norm_squared();
        let reach = if curvature > 0.0 { high } else { low };
        NormalFault::Fold { reach, radius_mm: 1.0 / curvature.abs() }
    }

    fn derivative(&self) -> Vec<Vector2<f64>> {
        derived(&self.points.map(|p| p.coords.xy()))
    }

    /// An upper bound of the distance between the cubic q of the normals and the unit normal n; infinite
    /// where no bound is found.
    ///
    /// Let c' be the derivative of the plane cubic. The error q - n has a part along the curve, q . c' /
    /// |c'|, and a part along n. The part along n is at most | |q|^2 - 1 | plus the square of the part along
    /// the curve, if q . n is above zero, which is checked. The Bernstein coefficients of q . c', |q|^2 - 1
    /// and |c'|^2 bound both parts.
    fn normal_error(&self) -> f64 {
        let derivative = self.derivative();
        let left: Vec<_> = derivative.iter().map(|d| Vector2::new(-d.y, d.x)).collect();
        let slowest = lowest(&dot(&derivative, &derivative));
        if !(slowest > 0.0 && lowest(&dot(&left, &self.normals)) > 0.0) {
            return f64::INFINITY;
        }
        let along = magnitude(&dot(&derivative, &self.normals)) / slowest.sqrt();
        let squares: Vec<f64> = dot(&self.normals, &self.normals).iter().map(|c| c - 1.0).collect();
        along.hypot(magnitude(&squares) + along * along)
    }

    /// Whether the proof fails that the offset curve, `x` mm to the left, runs in the same direction as this
    /// one: that (c' + q' x) . c' is above zero. This is linear in x.
    fn may_run_backward(&self, x: f64) -> bool {
        let derivative = self.derivative();
        let beside = self.points.iter().zip(&self.normals).map(|(p, n)| p.coords.xy() + n * x);
        let beside = derived(&beside.collect::<Vec<_>>());
        // Zero, negative or NaN.
        lowest(&dot(&beside, &derivative)).partial_cmp(&0.0) != Some(std::cmp::Ordering::Greater)
    }
}

/// The unit normal to the left and its derivative at an end where the curve has these first two derivatives.
fn end_normal(
    first: Vector2<f64>,
    second: Vector2<f64>,
    reach: [f64; 2],
) -> Result<[Vector2<f64>; 2], NormalFault> {
    let speed = first.norm();
    let tangent = first.try_normalize(0.0).ok_or(NormalFault::Cusp)?;
    // dn / dt = -k |c'| t, where the curvature k is positive for a left turn.
    let turning = first.perp(&second) / (speed * speed);
    let curvature = turning / speed;
    if let Some(reach) = reach.into_iter().find(|x| curvature * x >= 1.0) {
        return Err(NormalFault::Fold { reach, radius_mm: 1.0 / curvature.abs() });
    }
    Ok([Vector2::new(-tangent.y, tangent.x), tangent * -turning])
}

/// The two halves, by the algorithm of de Casteljau.
fn halves([a, b, c, d]: [Point3<f64>; 4]) -> [[Point3<f64>; 4]; 2] {
    let middle = |p: &Point3<f64>, q: &Point3<f64>| nalgebra::center(p, q);
    let (ab, bc, cd) = (middle(&a, &b), middle(&b, &c), middle(&c, &d));
    let (abc, bcd) = (middle(&ab, &bc), middle(&bc, &cd));
    let at = middle(&abc, &bcd);
    [[a, ab, abc, at], [at, bcd, cd, d]]
}

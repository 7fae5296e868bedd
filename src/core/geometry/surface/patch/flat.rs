//! One flat patch with straight sides: a triangle, or a part of one.

use nalgebra::{Point3, Vector3};

use super::{DerivativeBounds, Patch, SquareBound, spreads_of};
use crate::geometry::surface::Jet;
use crate::geometry::surface::vector_ball::VectorBall;

/// Rounding error of a difference of corners, as a part of their magnitude, with that of the halvings.
const ROUNDING: f64 = 1e-14;

/// A bilinear patch in one plane, mm.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FlatPatch {
    /// The corners (0, 0), (0, 1), (1, 0), (1, 1).
    pub corners: [Vector3<f64>; 4],
    /// Whether the surface ends or turns sharply at the sides u = 0, u = 1, v = 0 and v = 1 of the patch from
    /// which this one was halved.
    pub sharp: [bool; 4],
}

impl FlatPatch {
    /// The triangle with these corners, and whether the surface ends or turns sharply at the sides after each
    /// of them. The first corner is the side u = 0; the normal is to the side from which the corners go round
    /// counterclockwise.
    pub fn triangle([a, b, c]: [Vector3<f64>; 3], [first, second, third]: [bool; 3]) -> Self {
        Self { corners: [a, a, b, c], sharp: [false, second, first, third] }
    }

    /// The patch halved where `u` (or else v) is a half.
    fn halves(&self, is_along_u: bool) -> [Self; 2] {
        let [a, b, c, d] = self.corners;
        let middle = |p: Vector3<f64>, q: Vector3<f64>| (p + q) * 0.5;
        let halves = if is_along_u {
            let [low, high] = [middle(a, c), middle(b, d)];
            [[a, b, low, high], [low, high, c, d]]
        } else {
            let [low, high] = [middle(a, b), middle(c, d)];
            [[a, low, c, high], [low, b, high, d]]
        };
        halves.map(|corners| Self { corners, ..*self })
    }
}

impl Patch for FlatPatch {
    /// Where a side is a point, the derivative along the side is that of the middle of the patch. So the
    /// corner of a triangle has a normal.
    fn jet(&self, u: f64, v: f64) -> Jet {
        let [a, b, c, d] = self.corners;
        let mix = |p: Vector3<f64>, q: Vector3<f64>, t: f64| p * (1.0 - t) + q * t;
        let or_middle = |own: Vector3<f64>, middle: Vector3<f64>| {
            if own == Vector3::zeros() { middle } else { own }
        };
        Jet {
            point: Point3::from(mix(mix(a, b, v), mix(c, d, v), u)),
            du: or_middle(mix(c - a, d - b, v), 0.5 * (c - a + d - b)),
            dv: or_middle(mix(b - a, d - c, u), 0.5 * (b - a + d - c)),
            duu: Vector3::zeros(),
            duv: d - c - b + a,
            dvv: Vector3::zeros(),
        }
    }

    fn center(&self) -> Vector3<f64> {
        let [a, b, c, d] = self.corners;
        (a + b + c + d) * 0.25
    }

    fn sharp_sides(&self) -> Option<[bool; 4]> {
        Some(self.sharp)
    }

    fn degree(&self) -> [usize; 2] {
        [1, 1]
    }

    fn control_points(&self) -> impl Iterator<Item = Vector3<f64>> {
        self.corners.into_iter()
    }

    fn corners(&self) -> [Vector3<f64>; 4] {
        self.corners
    }

    fn split_u(&self) -> [Self; 2] {
        self.halves(true)
    }

    fn split_v(&self) -> [Self; 2] {
        self.halves(false)
    }

    fn transposed(&self) -> Self {
        let ([a, b, c, d], [low_u, high_u, low_v, high_v]) = (self.corners, self.sharp);
        Self { corners: [a, c, b, d], sharp: [low_v, high_v, low_u, high_u] }
    }

    fn turned(&self) -> Self {
        let ([a, b, c, d], [low_u, high_u, low_v, high_v]) = (self.corners, self.sharp);
        Self { corners: [c, a, d, b], sharp: [low_v, high_v, high_u, low_u] }
    }

    /// A triangle has no patch beside it that continues it.
    fn continued(&self, _reach: f64) -> Option<Self> {
        None
    }

    fn derivatives(&self) -> DerivativeBounds {
        let [a, b, c, d] = self.corners;
        let rounding = ROUNDING * self.bounds().magnitude();
        let ball = |vectors: &[Vector3<f64>]| VectorBall::around(vectors.iter().copied(), rounding);
        DerivativeBounds {
            du: ball(&[c - a, d - b]),
            dv: ball(&[b - a, d - c]),
            duu: VectorBall::ZERO,
            duv: ball(&[d - c - b + a]),
            dvv: VectorBall::ZERO,
        }
    }

    fn bound_squares<const N: usize>(
        &self,
        origin: &Vector3<f64>,
        axes: &[Vector3<f64>; N],
        weights: &[f64; N],
    ) -> SquareBound {
        let mut sum = [[0.0; 3]; 3];
        for (axis, weight) in axes.iter().zip(weights) {
            let [a, b, c, d] = self.corners.map(|p| (p - origin).dot(axis));
            let square =
                [[a * a, a * b, b * b], [a * c, 0.5 * (a * d + b * c), b * d], [c * c, c * d, d * d]];
            for (row, own) in sum.iter_mut().zip(square) {
                row.iter_mut().zip(own).for_each(|(x, own)| *x += weight * own);
            }
        }
        let all = sum.as_flattened();
        let bend = |values: [f64; 3]| (values[0] - 2.0 * values[1] + values[2]).abs();
        let most = |bends: [f64; 3]| bends.into_iter().fold(0.0, f64::max);
        SquareBound {
            lowest: all.iter().copied().fold(f64::INFINITY, f64::min),
            highest: all.iter().copied().fold(f64::NEG_INFINITY, f64::max),
            magnitude: all.iter().map(|x| x.abs()).fold(0.0, f64::max),
            bends: [most([0, 1, 2].map(|k| bend(sum.map(|row| row[k])))), most(sum.map(bend))],
        }
    }

    fn spreads(&self, direction: &Vector3<f64>) -> [f64; 2] {
        spreads_of([1, 1], |a, b| self.corners[2 * a + b].dot(direction))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn triangle() -> FlatPatch {
        let corners = [[1.0, 2.0, 3.0], [4.0, 2.5, 3.5], [2.0, 6.0, 1.0]];
        FlatPatch::triangle(corners.map(Vector3::from), [false; 3])
    }

    #[test]
    fn every_part_of_a_triangle_has_its_normal() {
        let normal = triangle().jet(0.5, 0.5).normal().normalize();
        let mut parts = vec![triangle()];
        for k in 0..4 {
            parts = parts
                .iter()
                .flat_map(|part| if k % 2 == 0 { part.split_u() } else { part.split_v() })
                .collect();
        }
        for part in parts {
            for [u, v] in [[0.0, 0.0], [0.0, 1.0], [1.0, 0.3], [0.5, 0.5]] {
                assert!((part.jet(u, v).normal().normalize() - normal).norm() < 1e-12);
            }
        }
        assert!(normal.z > 0.0);
    }

    #[test]
    fn squares_are_bounded_by_their_coefficients() {
        let patch = triangle().split_u()[1];
        let (origin, axes) = (Vector3::new(2.0, 3.0, 2.0), [Vector3::x(), Vector3::y(), Vector3::z()]);
        for weights in [[1.0, 1.0, 1.0], [-0.5, 2.0, 0.25]] {
            let bound = patch.bound_squares(&origin, &axes, &weights);
            let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
            for k in 0..=400 {
                let off = patch.jet((k % 21) as f64 / 20.0, (k / 21) as f64 / 19.0).point.coords - origin;
                let sum: f64 = (0..3).map(|c| weights[c] * off[c] * off[c]).sum();
                (low, high) = (low.min(sum), high.max(sum));
            }
            assert!(bound.lowest <= low + 1e-12 && bound.highest >= high - 1e-12);
            assert!(bound.highest <= high + 3.0);
        }
    }
}

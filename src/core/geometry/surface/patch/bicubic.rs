//! One bicubic Bezier patch.

use nalgebra::{Point3, Vector3};

use super::{DerivativeBounds, Patch, SquareBound, spreads_of};
use crate::geometry::surface::Jet;
use crate::geometry::surface::vector_ball::VectorBall;

/// Rounding error of a difference of control points, as a part of their magnitude. It includes the halvings
/// (some ten ulps) and the sum of up to four terms times nine.
const ROUNDING: f64 = 1e-14;

/// A control net `net[a][b]`, a along u, over the unit square; mm.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BicubicPatch {
    pub net: [[Vector3<f64>; 4]; 4],
}

/// One coordinate of a control net.
type Net = [[f64; 4]; 4];

impl Patch for BicubicPatch {
    fn jet(&self, u: f64, v: f64) -> Jet {
        let (bu, bv) = (basis(u), basis(v));
        let mut sums = [Vector3::zeros(); 6];
        for (a, row) in self.net.iter().enumerate() {
            let mut along = [Vector3::zeros(); 3];
            for (order, sum) in along.iter_mut().enumerate() {
                let w = &bv[order];
                *sum = row[0] * w[0] + row[1] * w[1] + row[2] * w[2] + row[3] * w[3];
            }
            sums[0] += along[0] * bu[0][a];
            sums[1] += along[0] * bu[1][a];
            sums[2] += along[1] * bu[0][a];
            sums[3] += along[0] * bu[2][a];
            sums[4] += along[1] * bu[1][a];
            sums[5] += along[2] * bu[0][a];
        }
        let [point, du, dv, duu, duv, dvv] = sums;
        Jet { point: Point3::from(point), du, dv, duu, duv, dvv }
    }

    fn center(&self) -> Vector3<f64> {
        const W: [f64; 4] = [0.125, 0.375, 0.375, 0.125];
        let mut sum = Vector3::zeros();
        for (row, wu) in self.net.iter().zip(W) {
            sum += (row[0] * W[0] + row[1] * W[1] + row[2] * W[2] + row[3] * W[3]) * wu;
        }
        sum
    }

    fn split_u(&self) -> [Self; 2] {
        let (mut low, mut high) = (*self, *self);
        for b in 0..4 {
            let column = [self.net[0][b], self.net[1][b], self.net[2][b], self.net[3][b]];
            let (l, h) = halves(&column);
            for a in 0..4 {
                low.net[a][b] = l[a];
                high.net[a][b] = h[a];
            }
        }
        [low, high]
    }

    fn split_v(&self) -> [Self; 2] {
        let (mut low, mut high) = (*self, *self);
        for a in 0..4 {
            (low.net[a], high.net[a]) = halves(&self.net[a]);
        }
        [low, high]
    }

    fn degree(&self) -> [usize; 2] {
        [3, 3]
    }

    fn control_points(&self) -> impl Iterator<Item = Vector3<f64>> {
        self.net.as_flattened().iter().copied()
    }

    fn spreads(&self, direction: &Vector3<f64>) -> [f64; 2] {
        spreads_of([3, 3], |a, b| self.net[a][b].dot(direction))
    }

    fn corners(&self) -> [Vector3<f64>; 4] {
        [self.net[0][0], self.net[0][3], self.net[3][0], self.net[3][3]]
    }

    fn transposed(&self) -> Self {
        Self { net: std::array::from_fn(|b| std::array::from_fn(|a| self.net[a][b])) }
    }

    fn turned(&self) -> Self {
        Self { net: std::array::from_fn(|a| std::array::from_fn(|b| self.net[3 - b][a])) }
    }

    fn continued(&self, reach: f64) -> Option<Self> {
        let third = |b: usize| (self.net[3][b] - self.net[2][b]) * reach;
        let row = |a: usize| std::array::from_fn(|b| self.net[3][b] + third(b) * a as f64);
        Some(Self { net: std::array::from_fn(row) })
    }

    fn derivatives(&self) -> DerivativeBounds {
        let n = &self.net;
        let rounding = ROUNDING * self.bounds().magnitude();
        let ball = |vectors: &[Vector3<f64>]| VectorBall::around(vectors.iter().copied(), rounding);
        DerivativeBounds {
            du: ball(&std::array::from_fn::<_, 12, _>(|k| (n[k / 4 + 1][k % 4] - n[k / 4][k % 4]) * 3.0)),
            dv: ball(&std::array::from_fn::<_, 12, _>(|k| (n[k % 4][k / 4 + 1] - n[k % 4][k / 4]) * 3.0)),
            duu: ball(&std::array::from_fn::<_, 8, _>(|k| {
                let (a, b) = (k / 4, k % 4);
                (n[a][b] - n[a + 1][b] * 2.0 + n[a + 2][b]) * 6.0
            })),
            duv: ball(&std::array::from_fn::<_, 9, _>(|k| {
                let (a, b) = (k / 3, k % 3);
                (n[a + 1][b + 1] - n[a + 1][b] - n[a][b + 1] + n[a][b]) * 9.0
            })),
            dvv: ball(&std::array::from_fn::<_, 8, _>(|k| {
                let (b, a) = (k / 4, k % 4);
                (n[a][b] - n[a][b + 1] * 2.0 + n[a][b + 2]) * 6.0
            })),
        }
    }

    fn bound_squares<const N: usize>(
        &self,
        origin: &Vector3<f64>,
        axes: &[Vector3<f64>; N],
        weights: &[f64; N],
    ) -> SquareBound {
        let mut sum = [[0.0; 7]; 7];
        for (axis, weight) in axes.iter().zip(weights) {
            let coordinate: Net = self.net.map(|row| row.map(|p| (p - origin).dot(axis)));
            add_square(&mut sum, coordinate, *weight);
        }
        let mut bound = SquareBound {
            lowest: f64::INFINITY,
            highest: f64::NEG_INFINITY,
            magnitude: 0.0,
            bends: [0.0; 2],
        };
        for (row, cu) in sum.iter_mut().zip(BINOMIAL_6) {
            for (x, cv) in row.iter_mut().zip(BINOMIAL_6) {
                *x /= cu * cv;
                bound.lowest = bound.lowest.min(*x);
                bound.highest = bound.highest.max(*x);
                bound.magnitude = bound.magnitude.max(x.abs());
            }
        }
        let bend = |a: f64, b: f64, c: f64| (a - 2.0 * b + c).abs();
        for row in &sum {
            let bends = row.windows(3).map(|w| bend(w[0], w[1], w[2]));
            bound.bends[1] = bends.fold(bound.bends[1], f64::max);
        }
        for rows in sum.windows(3) {
            let bends = (0..7).map(|k| bend(rows[0][k], rows[1][k], rows[2][k]));
            bound.bends[0] = bends.fold(bound.bends[0], f64::max);
        }
        bound
    }
}

/// Adds `weight` times the square of a bicubic polynomial with the Bernstein coefficients `scaled`. The sum
/// holds Bernstein coefficients of degree (6, 6), each multiplied by its binomials.
fn add_square(sum: &mut [[f64; 7]; 7], mut scaled: Net, weight: f64) {
    for (row, cu) in scaled.iter_mut().zip(BINOMIAL_3) {
        for (x, cv) in row.iter_mut().zip(BINOMIAL_3) {
            *x *= cu * cv;
        }
    }
    for i in 0..4 {
        // The product of rows i and k counts twice where they differ.
        for k in i..4 {
            let weight = if i == k { weight } else { 2.0 * weight };
            let target = &mut sum[i + k];
            for (x, j) in scaled[i].iter().zip(0..) {
                for (y, l) in scaled[k].iter().zip(0..) {
                    target[j + l] += weight * x * y;
                }
            }
        }
    }
}

const BINOMIAL_3: [f64; 4] = [1.0, 3.0, 3.0, 1.0];
const BINOMIAL_6: [f64; 7] = [1.0, 6.0, 15.0, 20.0, 15.0, 6.0, 1.0];

/// Cubic Bernstein values and their first and second derivatives at `t`.
fn basis(t: f64) -> [[f64; 4]; 3] {
    let s = 1.0 - t;
    [
        [s * s * s, 3.0 * s * s * t, 3.0 * s * t * t, t * t * t],
        [-3.0 * s * s, 3.0 * s * (s - 2.0 * t), 3.0 * t * (2.0 * s - t), 3.0 * t * t],
        [6.0 * s, 6.0 * (t - 2.0 * s), 6.0 * (s - 2.0 * t), 6.0 * t],
    ]
}

/// de Casteljau's halves of a cubic.
fn halves(p: &[Vector3<f64>; 4]) -> ([Vector3<f64>; 4], [Vector3<f64>; 4]) {
    let p01 = (p[0] + p[1]) * 0.5;
    let p12 = (p[1] + p[2]) * 0.5;
    let p23 = (p[2] + p[3]) * 0.5;
    let p012 = (p01 + p12) * 0.5;
    let p123 = (p12 + p23) * 0.5;
    let mid = (p012 + p123) * 0.5;
    ([p[0], p01, p012, mid], [mid, p123, p23, p[3]])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// x = u, y = v, z = u^3 v^2 - 2 u v as a Bezier net by blossoming.
    fn sample_patch() -> BicubicPatch {
        let u3 = [0.0, 0.0, 0.0, 1.0];
        let v2 = [0.0, 0.0, 1.0 / 3.0, 1.0];
        let t = [0.0, 1.0 / 3.0, 2.0 / 3.0, 1.0];
        let mut net = [[Vector3::zeros(); 4]; 4];
        for a in 0..4 {
            for b in 0..4 {
                net[a][b] = Vector3::new(t[a], t[b], u3[a] * v2[b] - 2.0 * t[a] * t[b]);
            }
        }
        BicubicPatch { net }
    }

    #[test]
    fn the_jet_equals_the_derivatives_of_the_polynomial() {
        let (u, v) = (0.3, 0.8);
        let jet = sample_patch().jet(u, v);
        let expected = [
            (jet.point.z, u * u * u * v * v - 2.0 * u * v),
            (jet.du.z, 3.0 * u * u * v * v - 2.0 * v),
            (jet.dv.z, 2.0 * u * u * u * v - 2.0 * u),
            (jet.duu.z, 6.0 * u * v * v),
            (jet.duv.z, 6.0 * u * u * v - 2.0),
            (jet.dvv.z, 2.0 * u * u * u),
        ];
        for (got, want) in expected {
            assert!((got - want).abs() < 1e-14, "{got} {want}");
        }
        assert!((jet.du.x - 1.0).abs() < 1e-15 && jet.duu.x.abs() < 1e-14);
    }

    #[test]
    fn halves_have_the_points_of_the_patch() {
        let patch = sample_patch();
        for (u, v) in [(0.1, 0.9), (0.5, 0.25), (0.75, 0.6)] {
            let [low, high] = patch.split_u();
            let half = if u < 0.5 { low.jet(2.0 * u, v) } else { high.jet(2.0 * u - 1.0, v) };
            assert!((half.point - patch.jet(u, v).point).norm() < 1e-15);
            let [low, high] = patch.split_v();
            let half = if v < 0.5 { low.jet(u, 2.0 * v) } else { high.jet(u, 2.0 * v - 1.0) };
            assert!((half.point - patch.jet(u, v).point).norm() < 1e-15);
        }
        assert!((patch.center() - patch.jet(0.5, 0.5).point.coords).norm() < 1e-15);
    }
}

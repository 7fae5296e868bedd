//! One rational Bezier patch of any degree from 1 to [`MAX_DEGREE`] along u, and likewise along v.
//!
//! A control point (x, y, z) with the weight w is stored as (w x, w y, w z, w). Every weight is above zero,
//! so the points of a patch lie in the convex hull of its control points.
//!
//! Derivatives and squared coordinates are quotients of two polynomials. The Bernstein coefficients of the
//! dividend and of the divisor give bounds of the quotient over the patch.

mod product;
mod swept;

use nalgebra::{Point3, Vector3, Vector4};

use super::{DerivativeBounds, Patch, SquareBound, spreads_of};
pub use crate::geometry::bspline::MAX_DEGREE;
use crate::geometry::surface::Jet;
use crate::geometry::surface::vector_ball::{CenteredInterval, VectorBall};
use product::{BINOMIALS, PRODUCT_SIZE, Product};

const SIZE: usize = MAX_DEGREE + 1;

/// Rounding error of a difference, as a part of the magnitude of the coordinates. It includes the halvings, a
/// quotient, and the sum of up to four terms times 49.
const ROUNDING: f64 = 1e-13;

/// The least weight of a continued patch, as a part of its largest weight. A smaller weight would bring the
/// patch near infinity.
const LEAST_WEIGHT: f64 = 1e-6;

/// A homogeneous control net over the unit square, with room for N control points each way; mm. Entries
/// beyond the degree are zero. Patches are copied often, so a patch of low degree should have a small N.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RationalPatch<const N: usize = SIZE> {
    degree: [usize; 2],
    net: [[Vector4<f64>; N]; N],
}

impl<const N: usize> RationalPatch<N> {
    /// The patch of a degree from 1 to N - 1 each way. `point(a, b)`, a along u, is the control point times
    /// its weight, followed by the weight, which is above zero.
    pub fn from_fn(degree: [usize; 2], point: impl Fn(usize, usize) -> Vector4<f64>) -> Self {
        let mut net = [[Vector4::zeros(); N]; N];
        for (a, row) in net.iter_mut().enumerate().take(degree[0] + 1) {
            for (b, p) in row.iter_mut().enumerate().take(degree[1] + 1) {
                *p = point(a, b);
            }
        }
        Self { degree, net }
    }

    pub fn degree(&self) -> [usize; 2] {
        self.degree
    }

    /// The control point (a, b) times its weight, followed by the weight.
    pub fn homogeneous(&self, a: usize, b: usize) -> Vector4<f64> {
        self.net[a][b]
    }

    fn entries(&self) -> impl Iterator<Item = Vector4<f64>> + Clone {
        let [p, q] = self.degree;
        self.net.iter().take(p + 1).flat_map(move |row| row.iter().take(q + 1)).copied()
    }

    /// The value of the homogeneous polynomial and its derivatives by u, v, uu, uv, vv, in this order.
    fn homogeneous_jet(&self, u: f64, v: f64) -> [Vector4<f64>; 6] {
        let [p, q] = self.degree;
        let mut along_v = [[Vector4::zeros(); N]; 3];
        for (a, row) in self.net.iter().enumerate().take(p + 1) {
            let [value, first, second] = curve_jet(row, q, v);
            (along_v[0][a], along_v[1][a], along_v[2][a]) = (value, first, second);
        }
        let [value, du, duu] = curve_jet(&along_v[0], p, u);
        let [dv, duv, _] = curve_jet(&along_v[1], p, u);
        let [dvv, _, _] = curve_jet(&along_v[2], p, u);
        [value, du, dv, duu, duv, dvv]
    }

    /// The control net of the derivative by u, one degree lower. The derivative of a constant is zero.
    fn derived_u(&self) -> Self {
        let [p, q] = self.degree;
        match p {
            0 => Self::from_fn([0, q], |_, _| Vector4::zeros()),
            _ => Self::from_fn([p - 1, q], |a, b| (self.net[a + 1][b] - self.net[a][b]) * p as f64),
        }
    }

    fn derived_v(&self) -> Self {
        self.transposed().derived_u().transposed()
    }

    /// An interval that contains the weight polynomial of the net over the unit square.
    fn weights(&self, rounding: f64) -> CenteredInterval {
        CenteredInterval::around(self.entries().map(|h| h.w), rounding)
    }

    /// A ball that contains A' w - A w'. A and w are the vectors and weights of this net, A' and w' those of
    /// `derived`, one of its derivatives. The difference is bounded as a single polynomial: bounds of the two
    /// products would count twice the parts that cancel.
    fn numerator(&self, derived: &Self, rounding: f64) -> VectorBall {
        let ([m, n], [p, q]) = (derived.degree, self.degree);
        let mut sums = [[Vector3::zeros(); PRODUCT_SIZE]; PRODUCT_SIZE];
        for (i, j) in (0..=m).flat_map(|i| (0..=n).map(move |j| (i, j))) {
            let share = BINOMIALS[m][i] * BINOMIALS[n][j];
            let d = derived.net[i][j];
            for k in 0..=p {
                for l in 0..=q {
                    let h = self.net[k][l];
                    let term = d.xyz() * h.w - h.xyz() * d.w;
                    sums[i + k][j + l] += term * (share * BINOMIALS[p][k] * BINOMIALS[q][l]);
                }
            }
        }
        let (sums, binomials) = (&sums, [&BINOMIALS[m + p], &BINOMIALS[n + q]]);
        let places = (0..=m + p).flat_map(|a| (0..=n + q).map(move |b| (a, b)));
        VectorBall::around(places.map(|(a, b)| sums[a][b] / (binomials[0][a] * binomials[1][b])), rounding)
    }
}

impl<const N: usize> Patch for RationalPatch<N> {
    fn jet(&self, u: f64, v: f64) -> Jet {
        let jet = self.homogeneous_jet(u, v);
        let [point, du, dv, duu, duv, dvv] = jet.map(|h| h.xyz());
        let [w, wu, wv, wuu, wuv, wvv] = jet.map(|h| h.w);
        // The quotient rule, from S w = A.
        let point = point / w;
        let du = (du - point * wu) / w;
        let dv = (dv - point * wv) / w;
        let duu = (duu - du * (2.0 * wu) - point * wuu) / w;
        let duv = (duv - du * wv - dv * wu - point * wuv) / w;
        let dvv = (dvv - dv * (2.0 * wv) - point * wvv) / w;
        Jet { point: Point3::from(point), du, dv, duu, duv, dvv }
    }

    fn center(&self) -> Vector3<f64> {
        let [p, q] = self.degree;
        let mut along_v = [Vector4::zeros(); N];
        for (sum, row) in along_v.iter_mut().zip(&self.net).take(p + 1) {
            *sum = curve_jet(row, q, 0.5)[0];
        }
        in_space(&curve_jet(&along_v, p, 0.5)[0])
    }

    fn degree(&self) -> [usize; 2] {
        self.degree
    }

    fn control_points(&self) -> impl Iterator<Item = Vector3<f64>> {
        self.entries().map(|p| in_space(&p))
    }

    fn spreads(&self, direction: &Vector3<f64>) -> [f64; 2] {
        spreads_of(self.degree, |a, b| in_space(&self.net[a][b]).dot(direction))
    }

    fn corners(&self) -> [Vector3<f64>; 4] {
        let [p, q] = self.degree;
        [(0, 0), (0, q), (p, 0), (p, q)].map(|(a, b)| in_space(&self.net[a][b]))
    }

    fn split_u(&self) -> [Self; 2] {
        self.transposed().split_v().map(|half| half.transposed())
    }

    fn split_v(&self) -> [Self; 2] {
        let (mut low, mut high) = (*self, *self);
        for a in 0..=self.degree[0] {
            (low.net[a], high.net[a]) = halves(&self.net[a], self.degree[1]);
        }
        [low, high]
    }

    fn transposed(&self) -> Self {
        Self::from_fn([self.degree[1], self.degree[0]], |b, a| self.net[a][b])
    }

    fn turned(&self) -> Self {
        Self::from_fn([self.degree[1], self.degree[0]], |a, b| self.net[self.degree[0] - b][a])
    }

    fn continued(&self, reach: f64) -> Option<Self> {
        let p = self.degree[0];
        let side = (0..=self.degree[1]).map(|b| (self.net[p][b], self.net[p - 1][b]));
        // The patch goes straight on in space, too: a combination of two weighted points lies on the line
        // through the points. To subtract a multiple of `last` keeps the direction. With `growth` as the
        // multiple no weight grows; a growing weight would shorten the continuation.
        let growth = side.map(|(last, before)| 1.0 - before.w / last.w).fold(f64::NEG_INFINITY, f64::max);
        let patch = Self::from_fn(self.degree, |a, b| {
            let last = self.net[p][b];
            last + (last * (1.0 - growth) - self.net[p - 1][b]) * (reach * a as f64)
        });
        let largest = patch.entries().map(|h| h.w).fold(0.0, f64::max);
        patch.entries().all(|h| h.w > LEAST_WEIGHT * largest).then_some(patch)
    }

    fn derivatives(&self) -> DerivativeBounds {
        // With coordinates from the centre and weights near one, the terms that cancel in the quotient rule
        // are small.
        let center = self.center();
        let scale = 1.0 / self.net[0][0].w;
        let moved = Self::from_fn(self.degree, |a, b| {
            let h = self.net[a][b];
            (h.xyz() - center * h.w).push(h.w) * scale
        });
        let largest_weight = moved.entries().map(|h| h.w).fold(0.0, f64::max);
        let rounding = ROUNDING * largest_weight;
        let inverse = moved.weights(rounding).inverse();
        let quotient = |derived: &Self| {
            let rounding = rounding * largest_weight * self.bounds().magnitude();
            moved.numerator(derived, rounding).times(inverse).times(inverse)
        };
        let (by_u, by_v) = (moved.derived_u(), moved.derived_v());
        let (du, dv) = (quotient(&by_u), quotient(&by_v));
        let (wu, wv) = (by_u.weights(rounding), by_v.weights(rounding));
        // S' = (A' w - A w') / w^2. S'' = (A'' w - A w'') / w^2 minus the terms that `less` takes off: first
        // derivatives times derivatives of w, over w.
        let less = |second: VectorBall, first: VectorBall, weight: CenteredInterval| {
            second.minus(first.times(weight).times(inverse))
        };
        let (along_u, along_v) = (self.transposed().swept(), self.swept());
        let [mut du, mut dv] = [du, dv];
        let mut duu = less(less(quotient(&by_u.derived_u()), du, wu), du, wu);
        let mut duv = less(less(quotient(&by_u.derived_v()), du, wv), dv, wu);
        let mut dvv = less(less(quotient(&by_v.derived_v()), dv, wv), dv, wv);
        for (swept, first, second) in [(along_u, &mut du, &mut duu), (along_v, &mut dv, &mut dvv)] {
            let Some(swept) = swept else { continue };
            for (known, better) in [(first, swept.first), (second, swept.second), (&mut duv, swept.mixed)] {
                *known = if better.radius < known.radius { better } else { *known };
            }
        }
        DerivativeBounds { du, dv, duu, duv, dvv }
    }

    fn bound_squares<const K: usize>(
        &self,
        origin: &Vector3<f64>,
        axes: &[Vector3<f64>; K],
        weights: &[f64; K],
    ) -> SquareBound {
        let mut squares = Product::zero(self.degree);
        let mut magnitude: f64 = 0.0;
        for (axis, weight) in axes.iter().zip(weights) {
            let coordinate =
                |a: usize, b: usize| (self.net[a][b].xyz() - origin * self.net[a][b].w).dot(axis);
            squares.add_square(&coordinate, *weight);
            let farthest = self.control_points().map(|p| (p - origin).dot(axis).abs()).fold(0.0, f64::max);
            magnitude += weight.abs() * farthest * farthest;
        }
        let mut scale = Product::zero(self.degree);
        scale.add_square(&|a, b| self.net[a][b].w, 1.0);
        let quotients = squares.over(&scale);
        SquareBound {
            lowest: quotients.lowest(),
            highest: quotients.highest(),
            magnitude,
            bends: quotients.bends(),
        }
    }
}

fn in_space(h: &Vector4<f64>) -> Vector3<f64> {
    h.xyz() / h.w
}

/// Value, first and second derivative at `t` of the Bezier curve of degree `n` (at least 1), by the algorithm
/// of de Casteljau.
fn curve_jet<const N: usize>(points: &[Vector4<f64>; N], n: usize, t: f64) -> [Vector4<f64>; 3] {
    let mut p = *points;
    let between = |a: Vector4<f64>, b: Vector4<f64>| a * (1.0 - t) + b * t;
    let degree = n as f64;
    for level in (2..n).rev() {
        for k in 0..=level {
            p[k] = between(p[k], p[k + 1]);
        }
    }
    let second = match n {
        1 => Vector4::zeros(),
        _ => {
            let second = (p[2] - p[1] - (p[1] - p[0])) * (degree * (degree - 1.0));
            (p[0], p[1]) = (between(p[0], p[1]), between(p[1], p[2]));
            second
        }
    };
    [between(p[0], p[1]), (p[1] - p[0]) * degree, second]
}

/// The two halves of a curve of degree `n`, by the algorithm of de Casteljau.
fn halves<const N: usize>(points: &[Vector4<f64>; N], n: usize) -> ([Vector4<f64>; N], [Vector4<f64>; N]) {
    let (mut low, mut high) = (*points, *points);
    for (step, p) in low.iter_mut().enumerate().take(n + 1).skip(1) {
        for k in 0..=n - step {
            high[k] = (high[k] + high[k + 1]) * 0.5;
        }
        *p = high[0];
    }
    (low, high)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// A quarter of a cylinder of radius 10 mm about the y axis, from x = 0 to x = 10, 30 mm long.
    fn quarter_cylinder() -> RationalPatch<4> {
        let w = 0.5f64.sqrt();
        let arc = [(0.0, 10.0, 1.0), (10.0, 10.0, w), (10.0, 0.0, 1.0)];
        RationalPatch::from_fn([2, 1], |a, b| {
            let (x, z, w) = arc[a];
            Vector4::new(x * w, 30.0 * b as f64 * w, z * w, w)
        })
    }

    fn any_patch() -> impl Strategy<Value = RationalPatch> {
        let entries = prop::collection::vec((-1.0f64..1.0, -1.0f64..1.0, -1.0f64..1.0, 0.3f64..3.0), 64);
        (1usize..=7, 1usize..=7, entries).prop_map(|(p, q, entries)| {
            RationalPatch::from_fn([p, q], |a, b| {
                let (dx, dy, dz, w) = entries[a * 8 + b];
                Vector4::new((3.0 * a as f64 + dx) * w, (3.0 * b as f64 + dy) * w, dz * w, w)
            })
        })
    }

    #[test]
    fn a_quarter_cylinder_has_the_radius_and_curvature_of_a_circle() {
        let patch = quarter_cylinder();
        for k in 0..=20 {
            let jet = patch.jet(f64::from(k) / 20.0, 0.3);
            assert!((jet.point.x.hypot(jet.point.z) - 10.0).abs() < 1e-14);
            assert!((jet.point.y - 9.0).abs() < 1e-14);
            let normal = jet.normal().normalize();
            let curvature = normal.dot(&jet.duu) / jet.du.norm_squared();
            assert!((curvature.abs() - 0.1).abs() < 1e-14, "{curvature}");
        }
    }

    proptest! {
        #[test]
        fn derivatives_match_finite_differences(patch in any_patch(), u in 0.1f64..0.9, v in 0.1f64..0.9) {
            let h = 1e-5;
            let jet = patch.jet(u, v);
            let d = |a: f64, b: f64| patch.jet(u + a, v + b);
            let near = |x: Vector3<f64>, y: Vector3<f64>| (x - y).norm() < 1e-6 * (10.0 + x.norm());
            prop_assert!(near(jet.du, (d(h, 0.0).point - d(-h, 0.0).point) / (2.0 * h)));
            prop_assert!(near(jet.dv, (d(0.0, h).point - d(0.0, -h).point) / (2.0 * h)));
            prop_assert!(near(jet.duu, (d(h, 0.0).du - d(-h, 0.0).du) / (2.0 * h)));
            prop_assert!(near(jet.duv, (d(0.0, h).du - d(0.0, -h).du) / (2.0 * h)));
            prop_assert!(near(jet.dvv, (d(0.0, h).dv - d(0.0, -h).dv) / (2.0 * h)));
        }

        #[test]
        fn halves_and_turned_patches_keep_the_points(patch in any_patch(), u in 0.0f64..1.0, v in 0.0f64..1.0) {
            let point = patch.jet(u, v).point;
            let [low, high] = patch.split_u();
            let half = if u < 0.5 { low.jet(2.0 * u, v) } else { high.jet(2.0 * u - 1.0, v) };
            prop_assert!((half.point - point).norm() < 1e-12);
            let [low, high] = patch.split_v();
            let half = if v < 0.5 { low.jet(u, 2.0 * v) } else { high.jet(u, 2.0 * v - 1.0) };
            prop_assert!((half.point - point).norm() < 1e-12);
            prop_assert!((patch.transposed().jet(v, u).point - point).norm() < 1e-12);
            prop_assert!((patch.turned().jet(v, 1.0 - u).point - point).norm() < 1e-12);
            prop_assert!((patch.center() - patch.jet(0.5, 0.5).point.coords).norm() < 1e-12);
        }

        #[test]
        fn bounds_contain_the_values_at_every_point(patch in any_patch(), u in 0.0f64..1.0, v in 0.0f64..1.0) {
            let jet = patch.jet(u, v);
            let bounds = patch.derivatives();
            for (ball, value) in [
                (bounds.du, jet.du),
                (bounds.dv, jet.dv),
                (bounds.duu, jet.duu),
                (bounds.duv, jet.duv),
                (bounds.dvv, jet.dvv),
            ] {
                prop_assert!((value - ball.center).norm() <= ball.radius);
            }
            let (origin, weights) = (Vector3::new(1.0, 2.0, 3.0), [1.0, -0.5, 0.0]);
            let axes = [Vector3::x(), Vector3::y(), Vector3::z()];
            let d = jet.point.coords - origin;
            let square = d.x * d.x - 0.5 * d.y * d.y;
            let bound = patch.bound_squares(&origin, &axes, &weights);
            prop_assert!(bound.lowest <= square + 1e-13 * bound.magnitude);
        }

        #[test]
        fn a_continued_patch_runs_straight_on(patch in any_patch(), u in 0.0f64..1.0, v in 0.0f64..1.0) {
            if let Some(beyond) = patch.continued(0.2) {
                let (edge, point) = (patch.jet(1.0, v), beyond.jet(u, v).point);
                prop_assert!((beyond.jet(0.0, v).point - edge.point).norm() < 1e-12);
                let away = point - edge.point;
                prop_assert!(away.cross(&edge.du).norm() <= 1e-9 * edge.du.norm());
                prop_assert!(away.dot(&edge.du) >= -1e-9);
            }
        }
    }

    #[test]
    fn bounds_of_derivatives_are_tight_on_small_parts() {
        let mut part = quarter_cylinder();
        for _ in 0..8 {
            part = part.split_u()[0];
        }
        let (bounds, jet) = (part.derivatives(), part.jet(0.5, 0.5));
        assert!((bounds.du.center - jet.du).norm() + bounds.du.radius < 0.01 * jet.du.norm());
        assert!((bounds.duu.center - jet.duu).norm() + bounds.duu.radius < 0.02 * jet.duu.norm());
    }
}

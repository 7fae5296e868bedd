//! Nets: the control points of a Bezier polynomial, with a bound of their rounding errors. De Casteljau's
//! algorithm turns the net of a polynomial into the net of a part of it.
//!
//! Every step of the algorithm is a weighted mean, so no step enlarges earlier errors. The error bound of the
//! new net is the error bound of the given net plus the rounding errors of all steps.

use crate::geometry::interval::{Interval, outward};

/// The unit of rounding, enlarged to cover the squares that the bounds leave out.
pub(super) const UNIT: f64 = 0.501 * f64::EPSILON;

/// The control points of a polynomial in D coordinates over [0, 1].
#[derive(Clone, Copy)]
pub(super) struct Net<const N: usize, const D: usize> {
    points: [[f64; D]; N],
    /// The number of control points in use. The net of a derivative has fewer than `points` has room for.
    len: usize,
    /// An upper bound of the error of each coordinate of a control point.
    error: [f64; D],
}

/// The control points of a part of a polynomial. `error` bounds the error of each coordinate.
pub(super) struct NetPart<const N: usize, const D: usize> {
    points: [[f64; D]; N],
    len: usize,
    pub(super) error: [f64; D],
}

impl<const N: usize, const D: usize> Net<N, D> {
    /// The net with exactly these control points.
    #[inline(always)]
    pub(super) fn new(points: [[f64; D]; N]) -> Self {
        Self { points, len: N, error: [0.0; D] }
    }

    /// The net of these control points. Each coordinate has an error of at most `units` units of rounding of
    /// itself.
    #[inline(always)]
    pub(super) fn rounded(points: [[f64; D]; N], units: f64) -> Self {
        let net = Self::new(points);
        Self { error: net.magnitude().map(|most| units * UNIT * most), ..net }
    }

    /// The derivative, one degree lower, by a parameter that grows by `span` over the net. `span` is a
    /// rounded difference of two numbers.
    #[inline(always)]
    pub(super) fn derived(&self, span: f64) -> Self {
        let len = self.len.saturating_sub(1);
        let factor = len as f64 / span;
        let mut points = self.points;
        for (k, point) in points.iter_mut().enumerate().take(len) {
            *point = std::array::from_fn(|c| (self.points[k + 1][c] - self.points[k][c]) * factor);
        }
        let derived = Self { points, len, error: [0.0; D] };
        // The difference, the span, the factor and the product are each rounded once.
        let most = derived.magnitude();
        Self {
            error: std::array::from_fn(|c| 2.0 * factor * self.error[c] + 4.0 * UNIT * most[c]),
            ..derived
        }
    }

    /// The value at `u`, to rounding.
    #[inline(always)]
    pub(super) fn value(&self, u: f64) -> [f64; D] {
        let mut points = self.points;
        for width in (1..self.len).rev() {
            for k in 0..width {
                points[k] = between(&points[k], &points[k + 1], u);
            }
        }
        points[0]
    }

    /// The value at `u`, as a part of length zero.
    #[inline(always)]
    pub(super) fn at(&self, u: f64) -> NetPart<N, D> {
        NetPart { points: [self.value(u); N], len: 1, error: self.part_error() }
    }

    #[inline(always)]
    pub(super) fn part(&self, [u, v]: [f64; 2]) -> NetPart<N, D> {
        let steps = self.len.saturating_sub(1);
        // Row c holds blossom values. So far c of their arguments are v, and the others u.
        let mut rows = [self.points; N];
        for step in 0..steps {
            let width = steps - step;
            for k in 0..width {
                rows[step + 1][k] = between(&rows[step][k], &rows[step][k + 1], v);
            }
            for row in rows.iter_mut().take(step + 1) {
                for k in 0..width {
                    row[k] = between(&row[k], &row[k + 1], u);
                }
            }
        }
        NetPart { points: std::array::from_fn(|c| rows[c][0]), len: self.len, error: self.part_error() }
    }

    /// A bound of the error of a control point of any part.
    ///
    /// Let e be the unit of rounding, M the largest absolute value in the net, and L the largest difference
    /// between neighbouring control points. The rounding of one step a + (b - a) t is at most e (M + 2 L).
    /// The parameter t has an error of at most 3 e, which moves the result by at most 3 e L. So n steps
    /// together err by at most n e (M + 5 L).
    #[inline(always)]
    fn part_error(&self) -> [f64; D] {
        let steps = self.len.saturating_sub(1) as f64;
        let (most, largest_step) = (self.magnitude(), self.largest_step());
        std::array::from_fn(|c| self.error[c] + steps * UNIT * (most[c] + 5.0 * largest_step[c]))
    }

    /// A box that contains the polynomial over `range`.
    #[inline(always)]
    pub(super) fn hull(&self, range: [f64; 2]) -> [Interval; D] {
        self.part(range).hull()
    }

    /// The largest absolute value of each coordinate.
    #[inline(always)]
    fn magnitude(&self) -> [f64; D] {
        let mut most = [0.0; D];
        for p in self.points.iter().take(self.len) {
            most = std::array::from_fn(|c| larger(most[c], p[c].abs()));
        }
        most
    }

    #[inline(always)]
    fn largest_step(&self) -> [f64; D] {
        let mut most = [0.0; D];
        for k in 1..self.len {
            let step = |c: usize| (self.points[k][c] - self.points[k - 1][c]).abs();
            most = std::array::from_fn(|c| larger(most[c], step(c)));
        }
        most
    }
}

impl<const N: usize, const D: usize> NetPart<N, D> {
    #[inline(always)]
    pub(super) fn points(&self) -> impl Iterator<Item = &[f64; D]> {
        self.points.iter().take(self.len)
    }

    #[inline(always)]
    pub(super) fn hull(&self) -> [Interval; D] {
        let (mut low, mut high) = (self.points[0], self.points[0]);
        for p in self.points.iter().take(self.len).skip(1) {
            low = std::array::from_fn(|c| -larger(-low[c], -p[c]));
            high = std::array::from_fn(|c| larger(high[c], p[c]));
        }
        std::array::from_fn(|c| outward(low[c] - self.error[c], high[c] + self.error[c]))
    }
}

#[inline(always)]
fn between<const D: usize>(a: &[f64; D], b: &[f64; D], t: f64) -> [f64; D] {
    std::array::from_fn(|c| a[c] + (b[c] - a[c]) * t)
}

/// The larger of two finite numbers. It takes one instruction; `f64::max` takes several because of its rule
/// about NaN.
#[inline(always)]
fn larger(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

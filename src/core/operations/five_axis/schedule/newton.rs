//! The limits at one end of an interval in the Newton equations, and the length of a Newton step.
//!
//! A limit is c = 1 - f |g|^2 >= 0. Each component of g is a row times the state (b, b', b''). The factor f
//! is b for jerk and 1 for acceleration. A cap is c = 1 - b / cap >= 0.

use super::least_squares::Equation;
use super::rows::{State, dot};

/// The part of a limit that a step leaves. A smaller part allows longer steps, but leads closer to the
/// limits.
const LEFT: f64 = 0.05;

/// A pivot counts as 0 if eliminations have made it smaller than this part of its first value: such a rest is
/// rounding.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

/// Halvings of a step that passes a limit: 12 find the largest step to 1/4000.
const HALVINGS: usize = 12;

/// The sum of the limits, as functions of the state at one end of an interval.
pub struct Local {
    /// The upper triangle of the matrix of the limits of jerk and acceleration.
    curvature: [f64; 6],
    /// The curvature by b of the time and of the caps.
    by_b: f64,
    /// The derivative of the time by b.
    pub time: f64,
    /// The gradient of the sum of the logarithms of the limits.
    pub logs: State,
    /// The sum of the products of limits and multipliers.
    pub gap: f64,
    /// The smallest limit.
    pub least: f64,
}

impl Local {
    pub fn new() -> Self {
        Self { curvature: [0.0; 6], by_b: 0.0, time: 0.0, logs: [0.0; 3], gap: 0.0, least: f64::INFINITY }
    }

    /// Adds the limit with the rows `rows`. `by_b` is the derivative of f by b: 1 or 0.
    ///
    /// The second derivative of f |g|^2 is not positive definite. The matrix contains 2 f q q' instead, where
    /// q is the row plus the gradient of f times g / f.
    #[inline(always)]
    pub fn limit<const N: usize>(&mut self, rows: [&[f64; 3]; N], y: &State, f: f64, by_b: f64, l: f64) {
        let mut c = 1.0;
        let mut gradient = [0.0; 3];
        for p in rows {
            let g = dot(p, y);
            c -= f * g * g;
            let t = -2.0 * f * g;
            gradient[0] += t * p[0] - by_b * g * g;
            gradient[1] += t * p[1];
            gradient[2] += t * p[2];
            self.square(2.0 * l * f, &[p[0] + by_b * g / f, p[1], p[2]]);
        }
        let inverse = 1.0 / c;
        self.square(l * inverse, &gradient);
        for (sum, part) in self.logs.iter_mut().zip(gradient) {
            *sum += inverse * part;
        }
        self.gap += l * c;
        self.least = c.min(self.least);
    }

    /// Adds the limit of a value by a cap.
    pub fn cap(&mut self, value: f64, cap: f64, l: f64) {
        let c = 1.0 - value / cap;
        self.by_b += l / (c * cap * cap);
        self.logs[0] -= 1.0 / (c * cap);
        self.gap += l * c;
        self.least = c.min(self.least);
    }

    /// Adds the limit that a value stays above 0.
    pub fn positive(&mut self, value: f64, l: f64) {
        self.by_b += l / value;
        self.logs[0] += 1.0 / value;
        self.gap += l * value;
        self.least = value.min(self.least);
    }

    /// Adds the time weight / sqrt(b), with a part of its curvature.
    pub fn time(&mut self, b: f64, weight: f64, part: f64) {
        let slope = -0.5 * weight / (b * b.sqrt());
        self.time += slope;
        self.by_b -= part * 1.5 * slope / b;
    }

    /// The Newton equations by the state as least-squares equations: their sum of squares has the same matrix
    /// and the same gradients, of the time and of the logarithms.
    #[inline(always)]
    pub fn equations(&self) -> [Equation; 3] {
        let [q00, q01, q02, q11, q12, q22] = self.curvature;
        let gradient = |k: usize| [if k == 0 { self.time } else { 0.0 }, self.logs[k]];
        let scaled = |pivot: f64, whole: f64| if pivot > ROUNDING * whole { 1.0 / pivot.sqrt() } else { 0.0 };
        let times = |factor: f64, by: [f64; 2]| by.map(|own| -factor * own);
        // Cholesky's factors from b'' down to b, which has curvature of its own.
        let f = scaled(q22, 0.0);
        let (a0, a1, a2) = (q02 * f, q12 * f, q22 * f);
        let side_a = times(f, gradient(2));
        let g = scaled(q11 - a1 * a1, q11);
        let (b0, b1) = ((q01 - a0 * a1) * g, (q11 - a1 * a1) * g);
        let rest = |k: usize, by: f64| [0, 1].map(|n| gradient(k)[n] + by * side_a[n]);
        let side_b = times(g, rest(1, a1));
        let q00 = (q00 - a0 * a0 - b0 * b0).max(0.0) + self.by_b;
        let h = scaled(q00, 0.0);
        let side_c = times(h, [0, 1].map(|n| rest(0, a0)[n] + b0 * side_b[n]));
        [([a0, a1, a2], side_a), ([b0, b1, 0.0], side_b), ([q00 * h, 0.0, 0.0], side_c)]
    }

    /// Adds the square of the product with v, times a weight.
    #[inline(always)]
    fn square(&mut self, weight: f64, v: &[f64; 3]) {
        let [a, b, c] = v.map(|x| weight * x);
        let products = [a * v[0], a * v[1], a * v[2], b * v[1], b * v[2], c * v[2]];
        for (sum, product) in self.curvature.iter_mut().zip(products) {
            *sum += product;
        }
    }
}

/// The lengths of a step, as parts of the Newton step, that keep a part of each limit and multiplier.
pub struct Step {
    pub primal: f64,
    pub dual: f64,
    /// The product of limit and multiplier to which the step leads.
    pub mu: f64,
}

impl Step {
    /// Shortens the step for the limit with the values `g` and the factor `f`, each followed by its change.
    /// Returns the change of the multiplier.
    #[inline(always)]
    pub fn limit<const N: usize>(&mut self, g: [f64; N], dg: [f64; N], [f, df]: [f64; 2], l: f64) -> f64 {
        let (mut gg, mut gd, mut dd) = (0.0, 0.0, 0.0);
        for n in 0..N {
            gg += g[n] * g[n];
            gd += g[n] * dg[n];
            dd += dg[n] * dg[n];
        }
        let c = 1.0 - f * gg;
        let most = 1.0 - LEFT * c;
        let used = |part: f64| (f + part * df) * (gg + part * (2.0 * gd + part * dd));
        if used(self.primal) > most {
            let (mut low, mut high) = (0.0, self.primal);
            for _ in 0..HALVINGS {
                let middle = 0.5 * (low + high);
                *if used(middle) > most { &mut high } else { &mut low } = middle;
            }
            self.primal = low;
        }
        self.multiplier(c, -df * gg - 2.0 * f * gd, l)
    }

    /// Shortens the step for a linear limit. Returns the change of the multiplier.
    #[inline(always)]
    pub fn linear(&mut self, c: f64, change: f64, l: f64) -> f64 {
        let most = (1.0 - LEFT) * c;
        if most + self.primal * change < 0.0 {
            self.primal = -most / change;
        }
        self.multiplier(c, change, l)
    }

    #[inline(always)]
    fn multiplier(&mut self, c: f64, change: f64, l: f64) -> f64 {
        let dl = (self.mu - l * change) / c - l;
        let most = (1.0 - LEFT) * l;
        if most + self.dual * dl < 0.0 {
            self.dual = -most / dl;
        }
        dl
    }
}

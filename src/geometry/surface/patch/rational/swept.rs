//! Derivatives of patches whose weights do not change one way: swept surfaces, and arcs that are ruled or
//! turned.

use nalgebra::Vector3;

use super::{ROUNDING, RationalPatch, in_space};
use crate::geometry::surface::patch::Patch;
use crate::geometry::surface::vector_ball::VectorBall;

/// Sets that hold derivatives of a patch whose weights do not change along v: by v, twice by v, by both.
pub(super) struct Swept {
    pub(super) first: VectorBall,
    pub(super) second: VectorBall,
    pub(super) mixed: VectorBall,
}

impl<const N: usize> RationalPatch<N> {
    /// Where the weights do not change along v, the derivatives along v are combinations of differences of
    /// control points, without a quotient that hides that they hardly vary: on swept surfaces not at all.
    pub(super) fn swept(&self) -> Option<Swept> {
        let [p, q] = self.degree;
        let rows = &self.net[..=p];
        if rows.iter().any(|row| row[1..=q].iter().any(|h| h.w != row[0].w)) {
            return None;
        }
        let points = |a: usize, b: usize| in_space(&self.net[a][b]);
        let rounding = ROUNDING * self.bounds().magnitude();
        let first = |a: usize, b: usize| (points(a, b + 1) - points(a, b)) * q as f64;
        let second = |a: usize, b: usize| (first(a, b + 1) - first(a, b)) * (q - 1) as f64;
        let places = |n: usize| (0..=p).flat_map(move |a| (0..n).map(move |b| (a, b)));
        // How much the first differences change along u: by that times the change of the weighted basis, of
        // which no more than twice the degree comes and goes.
        let apart = places(q).map(|(a, b)| (first(a, b) - first(0, b)).norm()).fold(0.0, f64::max);
        let weights = rows.iter().map(|row| row[0].w);
        let [least, most] =
            weights.fold([f64::INFINITY, 0.0], |[least, most]: [f64; 2], w| [least.min(w), most.max(w)]);
        let change = 4.0 * p as f64 * (most / least).powi(2);
        Some(Swept {
            first: VectorBall::around(places(q).map(|(a, b)| first(a, b)), rounding),
            second: if q > 1 {
                VectorBall::around(places(q - 1).map(|(a, b)| second(a, b)), 4.0 * q as f64 * rounding)
            } else {
                VectorBall::ZERO
            },
            mixed: VectorBall { center: Vector3::zeros(), radius: change * (apart + q as f64 * rounding) },
        })
    }
}

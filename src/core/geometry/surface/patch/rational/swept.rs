//! Bounds of derivatives for patches whose weights do not change along v. Examples are an arc along u that is
//! swept along a line, and a cubic along v that is rotated about an axis.

use nalgebra::Vector3;

use super::{ROUNDING, RationalPatch, in_space};
use crate::geometry::surface::patch::Patch;
use crate::geometry::surface::vector_ball::VectorBall;

/// Sets that contain derivatives of a patch whose weights are constant along v: by v, twice by v, and by u
/// and v.
pub(super) struct Swept {
    pub(super) first: VectorBall,
    pub(super) second: VectorBall,
    pub(super) mixed: VectorBall,
}

impl<const N: usize> RationalPatch<N> {
    /// Bounds of derivatives if the weights are constant along v; `None` otherwise. The derivatives along v
    /// are then combinations of differences of control points. So these bounds are tighter than those of the
    /// quotient rule.
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
        // The mixed derivative is the sum of R_a'(u) times first differences, where R_a are the rational
        // basis functions along u. The R_a' add up to zero, so only the spread of the first differences along
        // u (`apart`) counts. The |R_a'| add up to at most 4 p (most / least)^2, because the |B_a'| of the
        // Bernstein basis add up to at most 2 p.
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

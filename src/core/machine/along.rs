//! The five axes along a path: their derivatives, and balls around their Taylor coefficients.
//!
//! # Degenerate input
//! At the pole the equations of the rotary axes are zero by zero. Where a path goes through the pole, the
//! part of the tool axis across the pole is a multiple of the way from the pole. Divided by the way, it tells
//! where the axes are and how they move there ([`Through`]).

use nalgebra::Vector3;

use super::orientation::Orientation;
use super::scalar::Scalar;
use super::series::Series;
use super::{AxisPositions, Ball, Machine, nearer};

/// How a path passes through the pole.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Through<V> {
    /// The part across the pole of the vector along the tool axis, divided by the way.
    pub across: V,
    /// The parameter of the path, from the pole on.
    pub way: f64,
}

impl Machine {
    /// The value and the first three derivatives of X, Y, Z (mm) and the two rotary axes (radians) by the
    /// parameter of a path. `tip` and `axis` hold the value and the first three derivatives of the tip and of
    /// a vector along the tool axis, of any length. `near` selects the branch and the number of full turns.
    /// On a path through the pole, `through` tells how.
    ///
    /// `None` at the pole, unless the path goes through it; at the end of reach, beyond it, and for numbers
    /// that are not finite.
    pub fn derivatives(
        &self,
        tip: &[Vector3<f64>; 4],
        axis: &[Vector3<f64>; 4],
        through: Option<&Through<[Vector3<f64>; 4]>>,
        near: &AxisPositions,
    ) -> Option<[[f64; 4]; 5]> {
        let along = |of: &[Vector3<f64>; 4]| {
            [0, 1, 2].map(|k| Series::from_derivatives([of[0][k], of[1][k], of[2][k], of[3][k]]))
        };
        let through = through
            .map(|through| (along(&through.across), Series::from_derivatives([through.way, 1.0, 0.0, 0.0])));
        let all = self.along(along(tip), along(axis), through, near, 0.0)?.map(Series::derivatives);
        all.iter().flatten().all(|d| d.is_finite()).then_some(all)
    }

    /// Balls around the Taylor coefficients of X, Y, Z (mm) and the two rotary axes (radians) over a range of
    /// the parameter of a path: the coefficient of order k is the derivative by k!. `tip` and `axis` hold
    /// such balls of the tip and of a vector along the tool axis. `near` selects the branch and the number of
    /// full turns. On a path through the pole, `through` tells how; its `way` leads from the pole to
    /// the middle of the range, whose half length is `half`.
    ///
    /// `None` where the range may touch the pole, unless the path goes through it, or the end of reach.
    pub fn coefficients<const N: usize>(
        &self,
        tip: [[Ball; N]; 3],
        axis: [[Ball; N]; 3],
        through: Option<(Through<[[Ball; N]; 3]>, f64)>,
        near: &AxisPositions,
    ) -> Option<[[Ball; N]; 5]> {
        let through = through.map(|(Through { across, way }, half)| {
            let way = std::array::from_fn(|k| match k {
                0 => Ball::new(way, half),
                1 => Ball::new(1.0, 0.0),
                _ => Ball::new(0.0, 0.0),
            });
            (across.map(Series), Series(way))
        });
        let seen = through.as_ref().map_or(axis, |(across, _)| across.map(|series| series.0));
        let start = self.pair.direction(&Vector3::from(seen.map(|balls| balls[0].center)));
        let all = self.along(tip.map(Series), axis.map(Series), through, near, start)?.map(|series| series.0);
        all.iter().flatten().all(|ball| ball.most().is_finite()).then_some(all)
    }

    /// The positions for a tip and a vector along the tool axis. Directions count from
    /// `start` on, see [`RotaryPair::solve_from`](super::orientation::RotaryPair::solve_from).
    fn along<S: Scalar>(
        &self,
        tip: [S; 3],
        axis: [S; 3],
        through: Option<([S; 3], S)>,
        near: &AxisPositions,
        start: f64,
    ) -> Option<[S; 5]> {
        let both = match through {
            Some(through) => self.pair.solve_through(axis, through, start)?,
            None => match self.pair.solve_from(axis, start) {
                Orientation::Two(both) => both,
                _ => return None,
            },
        };
        let rotary = nearer(both.map(|angles| self.in_order(angles)), near.rotary);
        let [x, y, z] = self.linear(tip, rotary);
        Some([x, y, z, rotary[0], rotary[1]])
    }
}

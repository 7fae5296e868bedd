//! The solid of a cutter with its shank, for the gouge proof.
//!
//! Let C be the point of the axis at the height of the centre of the rounded corner. For a ball cutter, C is
//! the centre of the ball. For a flat end, C is the middle of the bottom.
//!
//! The *core* of the cutter is a level disc about C, and everything straight above this disc. The radius of
//! the disc is that of the cutter's flat. The cutter consists of all points whose distance from the core is
//! at most the corner radius.
//!
//! The cutter is convex. So for any unit vector m that does not point up, a plane at right angles to m bounds
//! the cutter: no point of the cutter lies farther from C in the direction of m than [`Solid::reach`].

use nalgebra::Vector3;

/// Least horizontal component of m for which [`Solid::ball_around`] gives a ball. For a smaller one the ball
/// bounds no better than a plane.
const LEAST_SIDEWAYS: f64 = 0.02;

/// A cutter: a disc of radius `flat` mm, rounded by `corner` mm all around, with its shank.
#[derive(Debug, Clone, Copy)]
pub(in crate::machining) struct Solid {
    pub(in crate::machining) flat: f64,
    pub(in crate::machining) corner: f64,
}

/// A ball cutter that contains another cutter: its radius, and how far its centre lies above C, mm.
#[derive(Debug, Clone, Copy)]
pub(in crate::machining) struct BallAround {
    pub(in crate::machining) radius: f64,
    pub(in crate::machining) rise: f64,
}

impl Solid {
    pub(in crate::machining) fn radius(&self) -> f64 {
        self.flat + self.corner
    }

    /// How far the cutter reaches from C along a unit vector that does not point up, mm.
    pub(in crate::machining) fn reach(&self, m: &Vector3<f64>) -> f64 {
        self.flat * m.xy().norm() + self.corner
    }

    /// The point of the cutter that is farthest along `m`, seen from C.
    pub(in crate::machining) fn farthest(&self, m: &Vector3<f64>) -> Vector3<f64> {
        let sideways = m.xy().try_normalize(0.0).unwrap_or_default() * self.flat;
        Vector3::new(sideways.x, sideways.y, 0.0) + m * self.corner
    }

    /// How deep the point at `off` from C lies in the cutter, mm: its distance from the outside, negative
    /// outside.
    pub(in crate::machining) fn depth(&self, off: &Vector3<f64>) -> f64 {
        let out = off.xy().norm() - self.flat;
        match (out > 0.0, off.z < 0.0) {
            (true, true) => self.corner - out.hypot(off.z),
            (true, false) => self.corner - out,
            (false, true) => self.corner + off.z,
            (false, false) => self.corner + off.z.min(-out),
        }
    }

    /// As [`Solid::depth`], of the point `away` mm from the axis and `height` mm above the tip.
    pub(in crate::machining) fn depth_at(&self, away: f64, height: f64) -> f64 {
        self.depth(&Vector3::new(away, 0.0, height - self.corner))
    }

    /// The unit vector from the core to the point at `off` from C; `None` in the core.
    pub(in crate::machining) fn away_from_core(&self, off: &Vector3<f64>) -> Option<Vector3<f64>> {
        let distance = off.xy().norm();
        let share = if distance > self.flat { 1.0 - self.flat / distance } else { 0.0 };
        Vector3::new(off.x * share, off.y * share, off.z.min(0.0)).try_normalize(0.0)
    }

    /// A ball cutter that contains this cutter and touches it along the circle where its lower side faces
    /// along `m`. The ball's centre is the point of the axis from which the disc's edge lies in the direction
    /// of `m`. `None` where the ball would bound no better than a plane.
    pub(in crate::machining) fn ball_around(&self, m: &Vector3<f64>) -> Option<BallAround> {
        if self.flat == 0.0 {
            return Some(BallAround { radius: self.corner, rise: 0.0 });
        }
        let sideways = m.xy().norm();
        (sideways > LEAST_SIDEWAYS).then(|| BallAround {
            radius: self.corner + self.flat / sideways,
            rise: self.flat * -m.z / sideways,
        })
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        /// For every m, the reach of the cutter exceeds the place of a point along m by at least the point's
        /// depth. The same holds for the ball around the cutter.
        #[test]
        fn no_direction_bounds_a_point_below_its_depth(
            flat in 0.0f64..4.0, corner in 0.0f64..4.0, off in prop::array::uniform3(-6.0f64..6.0),
            m in prop::array::uniform3(-1.0f64..1.0),
        ) {
            let solid = Solid { flat, corner };
            let off = Vector3::from(off);
            let Some(m) = Vector3::new(m[0], m[1], -m[2].abs()).try_normalize(1e-3) else { return Ok(()) };
            let depth = solid.depth(&off);
            prop_assert!(solid.reach(&m) - m.dot(&off) >= depth - 1e-12);
            prop_assert!((m.dot(&solid.farthest(&m)) - solid.reach(&m)).abs() < 1e-12);
            if let Some(ball) = solid.ball_around(&m) {
                let core = Solid { flat: 0.0, corner: ball.radius };
                let from_center = off - Vector3::z() * ball.rise;
                prop_assert!(core.depth(&from_center) >= depth - 1e-9 * ball.radius);
                // Both reach equally far along m.
                prop_assert!((core.reach(&m) + m.z * ball.rise - solid.reach(&m)).abs() < 1e-9 * ball.radius);
            }
        }

        /// Outside the core, the direction from the core to the point gives the exact depth.
        #[test]
        fn the_direction_from_the_core_gives_the_exact_depth(
            flat in 0.0f64..4.0, corner in 0.0f64..4.0, off in prop::array::uniform3(-6.0f64..6.0),
        ) {
            let solid = Solid { flat, corner };
            let off = Vector3::from(off);
            if let Some(m) = solid.away_from_core(&off) {
                prop_assert!((solid.reach(&m) - m.dot(&off) - solid.depth(&off)).abs() < 1e-9);
            }
        }
    }
}

//! The arc at whose end the angle is the target.

use super::{LENGTHS, State, TIGHTEST_RIGHT, Tracker};
use crate::geometry::segment::Segment;

/// How near an arc comes to the target, radians.
const NEAR_TARGET: f64 = 0.005;

/// How much the angle may exceed the target within an arc, radians.
const WITHIN: f64 = 0.01;

/// Trials for the turn of an arc.
const TRIALS: usize = 8;

/// Halvings for the curvature along the wall.
const ROOM_TRIALS: usize = 12;

impl Tracker<'_, '_> {
    /// The next arc at the target angle.
    pub(super) fn arc(&mut self, state: State) -> Segment {
        let radius = self.router.conditions.radius_mm;
        let [_, shortest, longest] = LENGTHS.map(|part| part * radius);
        loop {
            let length = self.length_mm;
            let (curvature, angle) = self.curvature(state, length);
            let arc = state.arc(curvature, length);
            let within = self.router.angle_at(arc.at(0.5), arc.direction(0.5)).max(angle);
            if within > self.target + WITHIN && length > shortest {
                self.length_mm = (0.5 * length).max(shortest);
                continue;
            }
            if within > self.target - WITHIN {
                self.length_mm = (1.5 * length).min(longest);
            }
            self.curvature = curvature;
            return arc;
        }
    }

    /// The curvature with which an arc of this length ends at the target angle, as nearly as the tightest
    /// turns allow, and the angle at its end.
    fn curvature(&mut self, state: State, length_mm: f64) -> (f64, f64) {
        let most = 1.0 / length_mm;
        let mut low = (-1.0 / (TIGHTEST_RIGHT * self.router.conditions.radius_mm)).max(-most);
        let mut high = (1.0 / self.tight_mm).min(most);
        if !self.has_room(&state.arc(low, length_mm)) {
            let (mut outside, mut inside) = (low, high);
            for _ in 0..ROOM_TRIALS {
                let middle = 0.5 * (outside + inside);
                if self.has_room(&state.arc(middle, length_mm)) { inside = middle } else { outside = middle }
            }
            // The wall itself is followed exactly.
            let end = State::after(&state.arc(inside, length_mm));
            let angle = self.router.angle_at(end.at, end.along);
            if angle <= self.target {
                return (outside, angle);
            }
            low = inside;
        }
        let mut excess = |curvature: f64| {
            let end = State::after(&state.arc(curvature, length_mm));
            self.router.angle_at(end.at, end.along) - self.target
        };
        let mut at_low = excess(low);
        if at_low <= 0.0 {
            return (low, at_low + self.target);
        }
        let mut at_high = f64::NAN;
        let mut tried = self.curvature.clamp(low, high);
        for trial in 0..TRIALS {
            let own = excess(tried);
            if own.abs() <= NEAR_TARGET {
                return (tried, own + self.target);
            }
            if own > 0.0 {
                (low, at_low) = (tried, own)
            } else {
                (high, at_high) = (tried, own)
            }
            if at_high.is_nan() {
                if tried == high {
                    break;
                }
                tried = if trial < 2 { (tried + (own + NEAR_TARGET) / length_mm).min(high) } else { high };
            } else {
                let part = (at_low / (at_low - at_high)).clamp(0.1, 0.9);
                tried = low + (high - low) * part;
            }
        }
        let own = excess(high);
        (high, own + self.target)
    }
}

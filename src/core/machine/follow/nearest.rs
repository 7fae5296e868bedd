//! Angles that differ from a given one by full turns.

use std::f64::consts::{PI, TAU};

use crate::machine::rotary_axis::SLACK;

/// By how much more than half a turn an angle (radians) may be away and still count as nearest. At exactly
/// half a turn both directions are possible, and rounding must not exclude one of them.
const TIE: f64 = 1e-9;

/// The most numbers of turns from which a path is tried on an axis with a travel: enough for a travel of six
/// full turns. Time and memory grow with it, and with its square if both axes have such travels.
const MOST_STARTS: usize = 7;

/// The angle that equals `base` up to full turns and is at most half a turn away from `from`. At half a turn
/// there are two.
pub fn nearest(base: f64, from: f64) -> impl Iterator<Item = f64> {
    let turns = ((from - base) / TAU).floor();
    let angles = [base + TAU * turns, base + TAU * (turns + 1.0)];
    angles.into_iter().filter(move |angle| (angle - from).abs() <= PI + TIE)
}

/// Angles that equal `base` up to full turns, from which a path may start: all within the travel, or the
/// lowest, the highest and some between if there are many. Without a travel, the one nearest to `near`.
pub fn starts(travel: Option<[f64; 2]>, base: f64, near: f64) -> Vec<f64> {
    let Some([low, high]) = travel else {
        return nearest(base, near).take(1).collect();
    };
    let first = ((low - SLACK - base) / TAU).ceil();
    let last = ((high + SLACK - base) / TAU).floor();
    if first > last {
        return Vec::new();
    }
    let steps = (last - first).min(MOST_STARTS as f64 - 1.0);
    let turns = |k: usize| first + ((last - first) * k as f64 / steps.max(1.0)).round();
    let mut angles: Vec<f64> = (0..=steps as usize).map(|k| base + TAU * turns(k)).collect();
    if last - first > steps {
        let near = ((near - base) / TAU).round().clamp(first, last);
        angles.push(base + TAU * near);
    }
    angles
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_angle_is_at_most_half_a_turn_away() {
        assert_eq!(nearest(0.5, 7.0).collect::<Vec<_>>(), [0.5 + TAU]);
        assert_eq!(nearest(0.5, -20.0).collect::<Vec<_>>(), [0.5 - 3.0 * TAU]);
        assert_eq!(nearest(PI, 0.0).collect::<Vec<_>>(), [-PI, PI]);
        assert_eq!(nearest(f64::NAN, 0.0).count(), 0);
    }

    #[test]
    fn a_path_starts_from_every_turn_that_the_travel_allows() {
        assert_eq!(starts(Some([-TAU, TAU]), 0.0, 0.0), [-TAU, 0.0, TAU]);
        assert_eq!(starts(Some([-TAU, TAU]), 1.0, 0.0), [1.0 - TAU, 1.0]);
        assert_eq!(starts(Some([0.1, 0.2]), 1.0, 0.0), [0.0; 0]);
        assert_eq!(starts(None, 1.0, 20.0), [1.0 + 3.0 * TAU]);
        assert_eq!(starts(Some([-3.0 * TAU, 3.0 * TAU]), 0.0, 0.0).len(), 7);
    }

    #[test]
    fn a_long_travel_is_entered_at_both_ends_and_near_the_start() {
        let travel = [-1000.5 * TAU, 1000.5 * TAU];
        let angles = starts(Some(travel), 0.0, 5.0 * TAU);
        assert!(angles.len() <= MOST_STARTS + 1, "{angles:?}");
        for turns in [-1000.0, 5.0, 1000.0] {
            assert!(angles.contains(&(turns * TAU)), "{turns} {angles:?}");
        }
    }
}

//! Points at which a way has a real corner.
//!
//! Seen over a few tolerances, or two points where these are farther apart, a smooth way turns about as much at one point as
//! at the next. At a corner it turns much more than on either side.

use nalgebra::Vector2;

/// The length over which a turn is seen, in tolerances; and at least so many points, at most so many.
const SIGHT_TOLERANCES: f64 = 5.0;
const SIGHT_POINTS: (usize, usize) = (2, 64);

/// A corner turns by this, radians, and by this many times what the way turns beside it.
const LEAST_TURN: f64 = 0.2;
const TIMES: f64 = 3.0;

/// The corners among the inner points, in order.
pub fn corners(points: &[Vector2<f64>], tolerance: f64) -> Vec<usize> {
    let n = points.len();
    let sight = |k: usize| sight(points, k, tolerance);
    let mut corners: Vec<usize> = Vec::new();
    let mut turns: Vec<f64> = Vec::with_capacity(n);
    turns.extend((0..n).map(|k| turn(points, k, sight(k))));
    for k in 1..n.saturating_sub(1) {
        let (here, width) = (turns[k].abs(), sight(k));
        if here < LEAST_TURN {
            continue;
        }
        // The sharpest within sight stands for those about it.
        let about = k.saturating_sub(width)..(k + width + 1).min(n);
        if about.clone().any(|j| turns[j].abs() > here || (j < k && turns[j].abs() == here)) {
            continue;
        }
        let beside = |j: Option<usize>| j.filter(|j| *j < n).map_or(0.0, |j| turns[j].abs());
        let others = beside(k.checked_sub(2 * width)).max(beside(k.checked_add(2 * width)));
        if here > TIMES * others {
            corners.push(k);
        }
    }
    corners
}

/// How many points before and after a point its turn is seen over.
fn sight(points: &[Vector2<f64>], k: usize, tolerance: f64) -> usize {
    let (least, most) = SIGHT_POINTS;
    let far = |width: &usize| {
        let [a, b] = [k.saturating_sub(*width), (k + width).min(points.len() - 1)];
        let near = (points[k] - points[a]).norm().min((points[b] - points[k]).norm());
        near >= SIGHT_TOLERANCES * tolerance
    };
    (least..most).find(far).unwrap_or(most)
}

/// The turn at a point from the way before it to the way after it, radians; 0 near the ends.
fn turn(points: &[Vector2<f64>], k: usize, width: usize) -> f64 {
    if k < width || k + width >= points.len() {
        return 0.0;
    }
    let [before, after] = [points[k] - points[k - width], points[k + width] - points[k]];
    before.perp(&after).atan2(before.dot(&after))
}

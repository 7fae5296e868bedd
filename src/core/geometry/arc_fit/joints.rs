//! Makes nodes on and beside the points of the polyline to which elements are fitted. A node is a place where
//! two elements may meet.
//!
//! Points may have errors. Elements that meet only on such points have to follow the errors, and so a chain
//! needs more elements. To avoid this, some of the points get further nodes to their left and to their right,
//! on a line across the polyline. All nodes of a point lie within the tolerance of the point.

use nalgebra::Vector2;

use super::Fit;
use super::optimal::Node;

/// Points with nodes beside them, for each element of the known chain.
const POINTS_AN_ELEMENT: usize = 24;

/// The distance of the farthest node from its point, as a part of the tolerance.
const FARTHEST: f64 = 0.97;

/// The direction at a point is measured between points at least `SIGHT_TOLERANCES` tolerances apart, or at
/// most `SIGHT_POINTS` points away on each side: closer points would show their errors.
const SIGHT_TOLERANCES: f64 = 30.0;
const SIGHT_POINTS: usize = 64;

/// Nodes at some of the points and beside them, `side` on each side. The known chain has `count` elements. If
/// the start is `pinned`, it is the only node of the first point. Closed points get no node beside the last
/// point.
pub fn nodes(
    points: &[Vector2<f64>],
    pinned: Option<Vector2<f64>>,
    request: &Fit,
    (count, side): (usize, i32),
) -> Vec<Node> {
    let (n, tolerance) = (points.len(), request.tolerance_mm);
    let stride = (n / (POINTS_AN_ELEMENT * count)).max(1);
    let mut nodes = Vec::new();
    for index in 0..n {
        let is_end = index == n - 1;
        if !is_end && !index.is_multiple_of(stride) {
            continue;
        }
        if let Some(at) = pinned.filter(|_| index == 0) {
            nodes.push(Node { index, at });
            continue;
        }
        nodes.push(Node { index, at: points[index] });
        if is_end && request.is_closed {
            continue;
        }
        let Some(across) = across(points, index, tolerance) else { continue };
        let beside = (-side..=side).filter(|k| *k != 0).map(|k| {
            let offset = FARTHEST * tolerance * f64::from(k) / f64::from(side);
            Node { index, at: points[index] + across * offset }
        });
        nodes.extend(beside);
    }
    nodes
}

/// The unit vector to the left of the polyline at a point; `None` if the points about it coincide.
fn across(points: &[Vector2<f64>], index: usize, tolerance: f64) -> Option<Vector2<f64>> {
    let (mut before, mut after) = (index, index);
    for _ in 0..SIGHT_POINTS {
        before = before.saturating_sub(1);
        after = (after + 1).min(points.len() - 1);
        if (points[after] - points[before]).norm() >= SIGHT_TOLERANCES * tolerance {
            break;
        }
    }
    let along = (points[after] - points[before]).try_normalize(0.0)?;
    Some(Vector2::new(-along.y, along.x))
}

//! Finds the points at which a polyline has a real corner. The small turns of a polyline that follows a
//! smooth curve are not corners.
//!
//! The polyline turns by some angle at each inner point. A point is a corner if its angle is at least
//! [`LEAST_TURN`], and more than [`TIMES`] times the largest angle at the [`BESIDE`] points before it and the
//! [`BESIDE`] points after it. With [`Measure::Points`] the points are samples of a curve, so the angle grows
//! with the length of the lines. For the comparison, the angle at each point is then divided by the mean
//! length of the two lines that meet there.

use nalgebra::Vector2;

use super::Measure;

/// A corner turns by at least `LEAST_TURN` radians, and by more than `TIMES` the turn that the points nearby
/// let expect.
const LEAST_TURN: f64 = 0.035;
const TIMES: f64 = 3.0;

/// Points on each side that a turn is compared with.
const BESIDE: usize = 5;

/// The indices of the corners among the inner points, in order.
pub fn corners(points: &[Vector2<f64>], measure: Measure) -> Vec<usize> {
    let vertices: Vec<Vertex> =
        points.windows(3).map(|three| Vertex::of([three[0], three[1], three[2]])).collect();
    let is_corner = |k: &usize| {
        let here = vertices[*k];
        let others =
            || (k.saturating_sub(BESIDE)..(k + 1 + BESIDE).min(vertices.len())).filter(|other| other != k);
        let expected = match measure {
            Measure::Points => {
                others().map(|other| vertices[other].turn / vertices[other].length).fold(0.0, f64::max)
                    * here.length
            }
            Measure::Polyline => others().map(|other| vertices[other].turn).fold(0.0, f64::max),
        };
        here.turn >= LEAST_TURN && here.turn > TIMES * expected
    };
    (0..vertices.len()).filter(is_corner).map(|k| k + 1).collect()
}

/// The turn of the polyline at one point.
#[derive(Debug, Clone, Copy)]
struct Vertex {
    /// The angle between the lines before and after the point, radians, not negative.
    turn: f64,
    /// Half of the lines before and after the point, mm.
    length: f64,
}

impl Vertex {
    fn of([a, b, c]: [Vector2<f64>; 3]) -> Self {
        let (before, after) = (b - a, c - b);
        let turn = before.perp(&after).atan2(before.dot(&after)).abs();
        Self { turn, length: 0.5 * (before.norm() + after.norm()) }
    }
}

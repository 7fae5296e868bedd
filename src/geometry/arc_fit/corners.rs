//! Points at which a way has a real corner.
//!
//! A smooth way turns about as much at one point as at the next; at a corner it turns much more than anywhere
//! beside it. Where the points are samples, a longer step may turn more by as much as the way is curved
//! beside it.

use nalgebra::Vector2;

use super::Measure;

/// A corner turns by this, radians, and by this many times what it would if the way were curved as beside it.
const LEAST_TURN: f64 = 0.035;
const TIMES: f64 = 3.0;

/// Points on each side that are looked at.
const BESIDE: usize = 5;

/// The corners among the inner points, in order.
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

/// How a way bends at a point.
#[derive(Debug, Clone, Copy)]
struct Vertex {
    /// Radians.
    turn: f64,
    /// Of the way that bends so, half of the lines before and after, mm.
    length: f64,
}

impl Vertex {
    fn of([a, b, c]: [Vector2<f64>; 3]) -> Self {
        let (before, after) = (b - a, c - b);
        let turn = before.perp(&after).atan2(before.dot(&after)).abs();
        Self { turn, length: 0.5 * (before.norm() + after.norm()) }
    }
}

//! Fits one full circle to points whose last point equals the first.
//!
//! # Method
//! 1. The circle of least weighted squares is computed, by Kasa's linear equations. At first all weights are
//!    equal. If the circle passes within the tolerance of all points, the search ends with it. With
//!    [`Measure::Polyline`], the lines between the points count too.
//! 2. Otherwise the weight of each point is multiplied by the distance of the point from the circle (Lawson),
//!    and step 1 is repeated, up to [`ROUNDS`] times in all. From round to round, the largest distance
//!    approaches the least possible one.
//!
//! There is no result in three cases: no circle keeps the tolerance, the points do not go around the circle
//! once and in order, or two neighbouring points are more than 30 degrees apart as seen from the centre.

use nalgebra::{Matrix3, Vector2, Vector3};

use super::Measure;
use super::candidate::Rule;
use super::chord_frame::from_line;

/// Rounds of weighting. After some ten rounds the deviation is within a few percent of the least.
const ROUNDS: usize = 40;

/// The largest angle between neighbouring points of a circle, radians. Points farther apart may as well be
/// corners of a polygon.
const WIDEST_GAP: f64 = std::f64::consts::PI / 6.0;

/// How far the turn of points about a centre may differ from one turn, radians. The points are closed, so
/// that they turn by a whole number of turns but for rounding.
const ONE_TURN: f64 = 1e-6;

/// A circle and the sense in which the points pass it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FullCircle {
    pub center: Vector2<f64>,
    pub radius: f64,
    pub is_ccw: bool,
}

/// The full circle that keeps the rule on points whose last point equals the first; `None` if none was found.
pub fn full_turn(points: &[Vector2<f64>], rule: &Rule) -> Option<FullCircle> {
    let tolerance = rule.tolerance_mm;
    let mut weights = vec![1.0; points.len()];
    for _ in 0..ROUNDS {
        let (center, radius) = circle(points, &weights)?;
        if deviation(points, center, radius, rule.measure) <= tolerance {
            return sense(points, center, radius, tolerance).map(|is_ccw| FullCircle {
                center,
                radius,
                is_ccw,
            });
        }
        let off = |p: &Vector2<f64>| ((p - center).norm() - radius).abs();
        let (worst, mut sum) = (points.iter().map(off).fold(0.0, f64::max), 0.0);
        for (weight, p) in weights.iter_mut().zip(points) {
            *weight *= off(p) / worst;
            sum += *weight;
        }
        let mean = sum / points.len() as f64;
        weights.iter_mut().for_each(|weight| *weight /= mean);
    }
    None
}

/// The largest distance of a point from a circle, mm. With the measure of a polyline it includes the
/// distances of the lines between the points.
pub fn deviation(points: &[Vector2<f64>], center: Vector2<f64>, radius: f64, measure: Measure) -> f64 {
    let worst = points.iter().map(|p| ((p - center).norm() - radius).abs()).fold(0.0, f64::max);
    if measure == Measure::Points {
        return worst;
    }
    points.windows(2).map(|pair| radius - from_line(center, pair[0], pair[1])).fold(worst, f64::max)
}

/// The centre and the radius of the circle of least weighted squares.
fn circle(points: &[Vector2<f64>], weights: &[f64]) -> Option<(Vector2<f64>, f64)> {
    let middle = points.iter().sum::<Vector2<f64>>() / points.len() as f64;
    let (mut matrix, mut right) = (Matrix3::zeros(), Vector3::zeros());
    for (p, weight) in points.iter().zip(weights) {
        let d = p - middle;
        let row = Vector3::new(d.x, d.y, 1.0);
        matrix += row * row.transpose() * *weight;
        right += row * d.norm_squared() * *weight;
    }
    let solved = matrix.cholesky()?.solve(&right);
    let center = solved.xy() * 0.5;
    let radius = (solved.z + center.norm_squared()).sqrt();
    radius.is_finite().then_some((middle + center, radius))
}

/// Whether the points pass the circle counterclockwise; `None` if they do not pass it once and in order.
fn sense(points: &[Vector2<f64>], center: Vector2<f64>, radius: f64, tolerance: f64) -> Option<bool> {
    let (mut turned, mut goes_back) = (0.0f64, [false; 2]);
    // For each sense: the first place on the circle within the tolerance of the points so far. A later point
    // whose places all lie before it goes back.
    let mut first = [f64::NEG_INFINITY; 2];
    for pair in points.windows(2) {
        let [a, b] = [pair[0] - center, pair[1] - center];
        let step = a.perp(&b).atan2(a.dot(&b));
        if step.abs() > WIDEST_GAP {
            return None;
        }
        turned += step;
        let off = b.norm() - radius;
        let half_width = ((tolerance - off) * (tolerance + off)).max(0.0).sqrt() / radius;
        for (k, way) in [turned, -turned].into_iter().enumerate() {
            first[k] = first[k].max(way - half_width);
            goes_back[k] |= way + half_width < first[k];
        }
    }
    let is_once = (turned.abs() - std::f64::consts::TAU).abs() < ONE_TURN;
    let is_ccw = turned > 0.0;
    (is_once && !goes_back[usize::from(!is_ccw)]).then_some(is_ccw)
}

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
use super::chord_frame::{from_line, nearest_on_line};

/// Rounds of weighting. After some ten rounds the deviation is within a few percent of the least.
const ROUNDS: usize = 40;

/// The largest angle between neighbouring points of a circle, radians. Points farther apart may as well be
/// corners of a polygon.
const WIDEST_GAP: f64 = std::f64::consts::PI / 6.0;

/// How far the turn of points about a centre may differ from one turn, radians. The points are closed, so
/// that they turn by a whole number of turns but for rounding.
const ONE_TURN: f64 = 1e-6;

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Circle {
    pub center: Vector2<f64>,
    pub radius: f64,
}

impl Circle {
    /// The place on the circle nearest to a point other than the centre.
    pub fn nearest_place(&self, p: Vector2<f64>) -> Vector2<f64> {
        self.center + (p - self.center).normalize() * self.radius
    }
}

/// A circle and the sense in which the points pass it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FullCircle {
    pub center: Vector2<f64>,
    pub radius: f64,
    pub is_ccw: bool,
}

/// The full circle that keeps the rule on points whose last point equals the first; `None` if none was found.
pub fn full_turn(points: &[Vector2<f64>], rule: &Rule) -> Option<FullCircle> {
    let Circle { center, radius } = near(points, rule)?;
    sense(points, center, radius, rule).map(|is_ccw| FullCircle { center, radius, is_ccw })
}

/// A circle within the rule's tolerance of all points, and of the lines between them if they count; `None` if
/// none was found.
fn near(points: &[Vector2<f64>], rule: &Rule) -> Option<Circle> {
    let by = |with_lines: bool| weighted(points, rule, with_lines).find(|(_, off)| *off <= rule.tolerance_mm);
    let found = by(false).or_else(|| by(true).filter(|_| rule.measure == Measure::Polyline));
    found.map(|(circle, _)| circle)
}

/// As [`near`], the nearest circle that was found.
pub fn nearest(points: &[Vector2<f64>], rule: &Rule) -> Option<Circle> {
    near(points, rule)?;
    let all = weighted(points, rule, rule.measure == Measure::Polyline);
    let least = all.min_by(|a, b| a.1.total_cmp(&b.1));
    least.filter(|(_, off)| *off <= rule.tolerance_mm).map(|(circle, _)| circle)
}

/// The circle of each round, with its deviation, mm. With lines, the place of each line that is nearest to
/// the centre has a weight, too.
fn weighted<'a>(
    points: &'a [Vector2<f64>],
    rule: &'a Rule,
    with_lines: bool,
) -> impl Iterator<Item = (Circle, f64)> + 'a {
    let mut places = points.to_vec();
    if with_lines {
        places.extend(points.windows(2).map(|pair| 0.5 * (pair[0] + pair[1])));
    }
    let mut weights = vec![1.0; places.len()];
    let round = move || {
        let mut circle = circle(&places, &weights)?;
        if with_lines {
            for (place, pair) in places[points.len()..].iter_mut().zip(points.windows(2)) {
                *place = nearest_on_line(circle.center, pair[0], pair[1]);
            }
            circle.radius = middle_radius(&places, circle.center);
        }
        reweigh(&mut weights, &places, &circle);
        Some((circle, deviation(points, &circle, rule.measure)))
    };
    std::iter::from_fn(round).take(ROUNDS)
}

/// Multiplies the weight of each place by its distance from the circle. The weights keep the mean 1.
fn reweigh(weights: &mut [f64], places: &[Vector2<f64>], circle: &Circle) {
    let off = |p: &Vector2<f64>| ((p - circle.center).norm() - circle.radius).abs();
    let (worst, mut sum) = (places.iter().map(off).fold(0.0, f64::max), 0.0);
    for (weight, p) in weights.iter_mut().zip(places) {
        *weight *= off(p) / worst;
        sum += *weight;
    }
    let mean = sum / places.len() as f64;
    weights.iter_mut().for_each(|weight| *weight /= mean);
}

/// The radius halfway between the nearest and the farthest place.
fn middle_radius(places: &[Vector2<f64>], center: Vector2<f64>) -> f64 {
    let distances = places.iter().map(|p| (p - center).norm());
    let (least, most) = distances.fold((f64::INFINITY, 0.0f64), |(a, b), d| (a.min(d), b.max(d)));
    0.5 * (least + most)
}

/// The largest distance of a point from a circle, mm. With the measure of a polyline it includes the
/// distances of the lines between the points.
fn deviation(points: &[Vector2<f64>], circle: &Circle, measure: Measure) -> f64 {
    let Circle { center, radius } = *circle;
    let worst = points.iter().map(|p| ((p - center).norm() - radius).abs()).fold(0.0, f64::max);
    if measure == Measure::Points {
        return worst;
    }
    points.windows(2).map(|pair| radius - from_line(center, pair[0], pair[1])).fold(worst, f64::max)
}

/// The centre and the radius of the circle of least weighted squares.
fn circle(points: &[Vector2<f64>], weights: &[f64]) -> Option<Circle> {
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
    radius.is_finite().then_some(Circle { center: middle + center, radius })
}

/// Whether the points pass the circle counterclockwise; `None` if they do not pass it once and in order.
fn sense(points: &[Vector2<f64>], center: Vector2<f64>, radius: f64, rule: &Rule) -> Option<bool> {
    let tolerance = rule.tolerance_mm;
    let (mut turned, mut goes_back) = (0.0f64, [false; 2]);
    // For each sense: the first place on the circle within the tolerance of the points so far. A later point
    // whose places all lie before it goes back.
    let mut first = [f64::NEG_INFINITY; 2];
    for pair in points.windows(2) {
        let [a, b] = [pair[0] - center, pair[1] - center];
        let step = a.perp(&b).atan2(a.dot(&b));
        if rule.measure == Measure::Points && step.abs() > WIDEST_GAP {
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

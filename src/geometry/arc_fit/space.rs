//! Arcs, helices and lines through points in space: a plain stand-in, each piece as long as it greedily can be.
//!
//! # Method
//! The points are parted where the path turns by more than a right angle, and in each part [`super::greedy`] runs in the
//! plane asked for, or in that along whose normal the part is thinnest. An arc whose deviation from the
//! polyline is too large becomes the lines between its points.
//!
//! # Guarantees
//! Pieces end at points of the polyline and lie within the tolerance of it, both ways.
//!
//! # Cost
//! As that of [`super::greedy`].

use std::f64::consts::PI;

use nalgebra::{Point3, Vector3};

use super::{Shape, Shapes, center, greedy};
use crate::budget::{Budget, Stopped};
use crate::geometry::curve::{Arc, Curve, Direction, Line};
use crate::geometry::plane::Plane;

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fit {
    pub tolerance_mm: f64,
    pub method: Method,
    pub continuity: Continuity,
    pub joints: Joints,
    pub measure: Measure,
    pub is_closed: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Method {
    Greedy,
    Biarc,
    Optimal,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Continuity {
    Position,
    Tangent,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Joints {
    OnPoints,
    Free,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Measure {
    Points,
    Polyline,
}

#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum FitError {
    #[error(transparent)]
    Stopped(#[from] Stopped),
    #[error("fewer than two points make no path")]
    TooFewPoints,
}

/// A curve and the index of the point at which it ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Piece {
    pub end: usize,
    pub curve: Curve,
}

/// Consecutive pieces from the first point to the last.
///
/// # Errors
/// When the budget is spent.
pub fn fit_in_space(
    points: &[Point3<f64>],
    plane: Option<Plane>,
    request: &Fit,
    budget: &Budget,
) -> Result<Vec<Piece>, FitError> {
    budget.check()?;
    if points.len() < 2 {
        return Err(FitError::TooFewPoints);
    }
    let mut pieces = Vec::new();
    let mut from = 0;
    while from + 1 < points.len() {
        let turns = |k: &usize| (points[k + 1] - points[*k]).dot(&(points[*k] - points[k - 1])) < 0.0;
        let to = (from + 1..points.len() - 1).find(turns).unwrap_or(points.len() - 1);
        let part = &points[from..=to];
        let plane = plane.unwrap_or_else(|| thinnest(part));
        fit_part(part, plane, request.tolerance_mm, |end, curve| {
            pieces.push(Piece { end: from + end, curve })
        });
        from = to;
    }
    Ok(pieces)
}

/// Upper bound for the Hausdorff distance of `curve` and the polyline through `points`, mm, infinite where it
/// cannot be told.
pub fn polyline_deviation(curve: &Curve, points: &[Point3<f64>]) -> f64 {
    match curve {
        Curve::Line(line) => points.iter().map(|p| line.distance_to(p)).fold(0.0, f64::max),
        Curve::Arc(arc) => arc_deviation(arc, points),
        Curve::Parabola(_) => f64::INFINITY,
    }
}

fn thinnest(points: &[Point3<f64>]) -> Plane {
    let thickness = |plane: &Plane| {
        let n = plane.axes()[2];
        let (least, most) = points.iter().fold((f64::MAX, f64::MIN), |(a, b), p| (a.min(p[n]), b.max(p[n])));
        most - least
    };
    Plane::ALL.into_iter().min_by(|a, b| thickness(a).total_cmp(&thickness(b))).unwrap_or(Plane::Xy)
}

fn fit_part(points: &[Point3<f64>], plane: Plane, tolerance: f64, mut take: impl FnMut(usize, Curve)) {
    let flat: Vec<_> = points.iter().map(|p| plane.to_local(p).xy()).collect();
    let mut from = 0;
    for element in greedy(&flat, tolerance, Shapes::ArcsAndLines) {
        let (start, end) = (points[from], points[element.end]);
        let curve = match element.shape {
            Shape::Line => Some(Curve::Line(Line { start, end })),
            Shape::Arc { bulge } => {
                let c = center(flat[from], flat[element.end], bulge);
                let direction = if bulge > 0.0 { Direction::Cw } else { Direction::Ccw };
                let c = plane.to_workpiece(&Vector3::new(c.x, c.y, plane.to_local(&start).z));
                Arc::with_center_near(plane, direction, start, end, c).ok().map(Curve::Arc)
            }
        };
        match curve.filter(|curve| polyline_deviation(curve, &points[from..=element.end]) <= tolerance) {
            Some(curve) => take(element.end, curve),
            None => (from..element.end).for_each(|k| {
                take(k + 1, Curve::Line(Line { start: points[k], end: points[k + 1] }));
            }),
        }
        from = element.end;
    }
}

fn arc_deviation(arc: &Arc, points: &[Point3<f64>]) -> f64 {
    let plane = arc.plane();
    let c = plane.to_local(&arc.center());
    let local: Vec<_> = points.iter().map(|p| plane.to_local(p) - c).collect();
    let (mut worst, mut before) = (0.0f64, 0.0);
    for (k, p) in local.iter().enumerate() {
        let t = match k {
            0 => 0.0,
            _ if k + 1 == local.len() => 1.0,
            _ => match arc.fraction_of_angle(p.y.atan2(p.x)) {
                Some(t) if t >= before => t,
                _ => return f64::INFINITY,
            },
        };
        let turned = (t - before) * arc.sweep();
        if turned > PI / 2.0 {
            return f64::INFINITY;
        }
        before = t;
        let radial = (p.xy().norm() - arc.radius()).abs();
        worst = worst.max(radial.hypot(p.z - arc.rise() * t));
        if let Some(q) = k.checked_sub(1).map(|k| local[k]) {
            let along = (p - q).xy();
            let foot = (-q.xy().dot(&along) / along.norm_squared()).clamp(0.0, 1.0);
            let chord = if foot.is_nan() { arc.radius() } else { (q.xy() + along * foot).norm() };
            // The height along a chord runs ahead of that along the arc by the tangent's third order.
            let ahead = arc.rise().abs() / arc.sweep() * turned.powi(3) / 12.0;
            worst = worst.max((arc.radius() - chord).abs().hypot(ahead) + (p.z - arc.rise() * t).abs());
        }
    }
    worst
}

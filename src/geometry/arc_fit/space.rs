//! Points in space: the planes of their arcs, and elements as curves.
//!
//! Arcs lie in a coordinate plane, or are helices about its normal. Unless the plane is given, a way is divided into stretches
//! that keep one coordinate, which lie in a plane with all their points, and the rest, whose arcs are helices over the xy plane.

use nalgebra::{Point3, Vector2, Vector3};

use super::{Element, Fit, Fitted, Joints, Measure, Points, Shape, center, fit, span, turn};
use crate::budget::{Budget, Stopped};
use crate::geometry::curve::{Arc, ArcError, Curve, Direction, Line};
use crate::geometry::plane::Plane;

/// Coordinates that differ by less, mm, differ by the rounding of whoever computed them.
const LEVEL_MM: f64 = 1e-9;

/// Fewer points than these that keep a coordinate may do so by chance.
const LEAST_STRETCH: usize = 4;

/// A curve of the result, which ends for the point with index `end`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Piece {
    pub end: usize,
    pub curve: Curve,
}

#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum FitError {
    #[error(transparent)]
    Stopped(#[from] Stopped),
    #[error("all points are the same")]
    OnePlace,
    #[error(transparent)]
    Arc(#[from] ArcError),
}

/// Fits curves to points, all arcs in `plane` if one is given; coincident neighbours count once.
///
/// # Errors
/// When there are no two different points, or the budget runs out.
pub fn fit_in_space(
    points: &[Point3<f64>],
    plane: Option<Plane>,
    request: &Fit,
    budget: &Budget,
) -> Result<Vec<Piece>, FitError> {
    let distinct: Vec<usize> = (0..points.len()).filter(|&k| k == 0 || points[k] != points[k - 1]).collect();
    if distinct.len() < 2 {
        return Err(FitError::OnePlace);
    }
    let ends: Vec<Point3<f64>> = distinct.iter().map(|&k| points[k]).collect();
    let divided = stretches(&ends);
    let whole = |plane: Plane| vec![Stretch { plane, is_level: false, end: ends.len() - 1 }];
    let mut pieces = match plane {
        Some(plane) => fit_stretches(&ends, &whole(plane), request, budget)?,
        None => fit_stretches(&ends, &divided, request, budget)?,
    };
    if plane.is_none() && divided.len() > 1 {
        // Points of a slow climb keep a height here and there by their rounding.
        let helices = fit_stretches(&ends, &whole(Plane::Xy), request, budget)?;
        if helices.len() < pieces.len() {
            pieces = helices;
        }
    }
    // What follows a point as its repetition belongs to it.
    let last = |end: usize| distinct.get(end + 1).map_or(points.len(), |next| *next) - 1;
    Ok(pieces.into_iter().map(|piece| Piece { end: last(piece.end), ..piece }).collect())
}

fn fit_stretches(
    points: &[Point3<f64>],
    stretches: &[Stretch],
    request: &Fit,
    budget: &Budget,
) -> Result<Vec<Piece>, FitError> {
    // Where the plane changes, elements meet on a point.
    let request = match stretches {
        [_] => *request,
        _ => Fit { joints: Joints::OnPoints, is_closed: false, ..*request },
    };
    let mut pieces = Vec::new();
    let mut begin = 0;
    for stretch in stretches {
        let fitted = fit_stretch(&points[begin..=stretch.end], stretch.plane, &request, budget)?;
        pieces.extend(fitted.into_iter().map(|piece| Piece { end: begin + piece.end, ..piece }));
        begin = stretch.end;
    }
    Ok(pieces)
}

/// The points up to `end`, from where the stretch before ended, have their arcs in `plane`, and lie in it if it is level.
struct Stretch {
    plane: Plane,
    is_level: bool,
    end: usize,
}

fn stretches(points: &[Point3<f64>]) -> Vec<Stretch> {
    let last = points.len() - 1;
    let mut stretches: Vec<Stretch> = Vec::new();
    let mut begin = 0;
    while begin < last {
        let level_end = |plane: Plane| {
            let normal = plane.axes()[2];
            let is_level = |p: &&Point3<f64>| (p[normal] - points[begin][normal]).abs() <= LEVEL_MM;
            begin + points[begin..].iter().take_while(is_level).count() - 1
        };
        let mut longest = Stretch { plane: Plane::Xy, is_level: true, end: level_end(Plane::Xy) };
        for plane in [Plane::Zx, Plane::Yz] {
            let end = level_end(plane);
            if end > longest.end {
                longest = Stretch { plane, end, ..longest };
            }
        }
        if longest.end - begin + 1 >= LEAST_STRETCH || (begin == 0 && longest.end == last) {
            begin = longest.end;
            stretches.push(longest);
            continue;
        }
        begin += 1;
        match stretches.last_mut() {
            Some(loose) if !loose.is_level => loose.end = begin,
            _ => stretches.push(Stretch { plane: Plane::Xy, is_level: false, end: begin }),
        }
    }
    stretches
}

/// The elements of one stretch as curves; their ends count from its first point.
fn fit_stretch(
    points: &[Point3<f64>],
    plane: Plane,
    request: &Fit,
    budget: &Budget,
) -> Result<Vec<Piece>, FitError> {
    let local: Vec<Vector3<f64>> = points.iter().map(|p| plane.to_local(p)).collect();
    let flat: Vec<Vector2<f64>> = local.iter().map(Vector3::xy).collect();
    let is_level = local.iter().all(|p| (p.z - local[0].z).abs() <= LEVEL_MM);
    let heights: Vec<f64> = if is_level { Vec::new() } else { local.iter().map(|p| p.z).collect() };
    let Fitted { start, elements } = fit(Points { flat: &flat, heights: &heights }, request, budget)?;
    let (mut from, mut height) = (start, local[0].z);
    elements
        .into_iter()
        .map(|element| {
            let at = |p: Vector2<f64>, height: f64| plane.to_workpiece(&Vector3::new(p.x, p.y, height));
            let end_height = height_of(&element, &local);
            let [start, end] = [at(from, height), at(element.to, end_height)];
            let arc = |is_ccw: bool, center: Vector2<f64>| {
                let direction = if is_ccw { Direction::Ccw } else { Direction::Cw };
                Arc::new(plane, direction, start, end, at(center, height)).map(Curve::Arc)
            };
            let curve = match element.shape {
                Shape::Line => Ok(Curve::Line(Line { start, end })),
                Shape::Arc { bulge } => arc(bulge < 0.0, center(from, element.to, bulge)),
                Shape::Turn { center, is_ccw } => arc(is_ccw, center),
            }?;
            (from, height) = (element.to, end_height);
            Ok(Piece { end: element.end, curve })
        })
        .collect()
}

/// The height at which an element ends: that of its point, or, where biarcs meet between two points, between theirs.
fn height_of(element: &Element, local: &[Vector3<f64>]) -> f64 {
    let at = local[element.end];
    let Some(next) = local.get(element.end + 1).filter(|_| element.to != at.xy()) else { return at.z };
    let [passed, left] = [at, *next].map(|p| (element.to - p.xy()).norm());
    at.z + (next.z - at.z) * passed / (passed + left)
}

/// Bound of the distance both ways between a line or an arc and the lines through the points that it stands for, mm; infinite
/// where the curve passes them out of order, or leads round the other way.
pub fn polyline_deviation(curve: &Curve, points: &[Point3<f64>]) -> f64 {
    deviation(curve, points, Measure::Polyline)
}

/// The largest distance of the points, and by the measure of the polyline of their lines, from a line or an arc that stands for
/// them, mm; infinite where it passes them out of order, or leads round the other way.
pub fn deviation(curve: &Curve, points: &[Point3<f64>], measure: Measure) -> f64 {
    let arc = match curve {
        Curve::Line(line) => return along_line(line, points),
        Curve::Arc(arc) => arc,
        Curve::Parabola(_) => return f64::INFINITY,
    };
    let local = |p: &Point3<f64>| arc.plane().to_local(p);
    let flat: Vec<Vector2<f64>> = points.iter().map(|p| local(p).xy()).collect();
    if arc.start() == arc.end() {
        return turn::deviation(&flat, local(&arc.center()).xy(), arc.radius(), measure);
    }
    let heights: Vec<f64> = points.iter().map(|p| local(p).z).collect();
    let ends = [arc.start(), arc.end()].map(|p| local(&p).xy());
    span::deviation(Points { flat: &flat, heights: &heights }, ends, bulge(arc), measure)
}

/// As [`deviation`], in the plane of the line and each point.
fn along_line(line: &Line, points: &[Point3<f64>]) -> f64 {
    let length = line.length();
    let along = (line.end - line.start) / length;
    let flat: Vec<Vector2<f64>> = points
        .iter()
        .map(|p| {
            let d = p - line.start;
            let x = along.dot(&d);
            Vector2::new(x, (d - along * x).norm())
        })
        .collect();
    let ends = [Vector2::zeros(), Vector2::new(length, 0.0)];
    span::deviation(Points { flat: &flat, heights: &[] }, ends, 0.0, Measure::Points)
}

/// tan(sweep / 4), positive for an arc that turns clockwise.
fn bulge(arc: &Arc) -> f64 {
    let size = (arc.sweep() / 4.0).tan();
    if arc.direction() == Direction::Cw { size } else { -size }
}

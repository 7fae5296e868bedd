//! Fits lines, arcs and helices to points in space.
//!
//! If the caller gives a coordinate plane, all arcs are parallel to it, and the axes of all helices are
//! normal to it. Otherwise the points are divided into stretches of neighbouring points:
//! * If all points of a stretch have the same x, y or z, it gets lines and arcs in the plane of the other two
//!   coordinates. Such a stretch has at least four points, or all points of the input.
//! * Any other stretch gets lines, and helices whose axes run along z.
//!
//! If there are several stretches, a second fit treats all points as one stretch with helices. The fit with
//! fewer curves is the result.

use nalgebra::{Point2, Point3, Vector2, Vector3};

use super::{Continuity, Element, Fit, Fitted, Joints, Method, NotProved, Points, Shape, fit};
use crate::budget::{Budget, Stopped};
use crate::geometry::curve::{Arc, Curve, Direction, Line};
use crate::geometry::plane::Plane;
use crate::geometry::segment::Segment;

/// Coordinates that differ by less count as equal, mm: the program that computed them may have rounded.
const LEVEL_MM: f64 = 1e-9;

/// The least number of points for a stretch that keeps a coordinate. Fewer points may keep it by chance.
const LEAST_STRETCH: usize = 4;

/// One curve of the result. It ends at the place that stands for the point with index `end`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FittedCurve {
    pub end: usize,
    pub curve: Curve,
}

/// The curves for all points, in order.
#[derive(Debug, Clone, PartialEq)]
pub struct FittedCurves {
    pub curves: Vec<FittedCurve>,
    /// See [`Fitted::not_proved`].
    pub not_proved: Option<NotProved>,
}

#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum FitError {
    #[error(transparent)]
    Stopped(#[from] Stopped),
    #[error("all points coincide; at least two different points are needed")]
    OnePlace,
}

/// Fits curves to points. All arcs lie in `plane` if one is given. Neighbours that coincide count once.
///
/// # Errors
/// When there are no two different points, or the budget runs out.
pub fn fit_in_space(
    points: &[Point3<f64>],
    plane: Option<Plane>,
    request: &Fit,
    budget: &Budget,
) -> Result<FittedCurves, FitError> {
    let distinct: Vec<usize> = (0..points.len()).filter(|&k| k == 0 || points[k] != points[k - 1]).collect();
    if distinct.len() < 2 {
        return Err(FitError::OnePlace);
    }
    let ends: Vec<Point3<f64>> = distinct.iter().map(|&k| points[k]).collect();
    let divided = stretches(&ends);
    let whole = |plane: Plane| vec![PlanarRun { plane, is_level: false, end: ends.len() - 1 }];
    let mut pieces = match plane {
        Some(plane) => fit_stretches(&ends, &whole(plane), request, budget)?,
        None => fit_stretches(&ends, &divided, request, budget)?,
    };
    if plane.is_none() && divided.len() > 1 {
        // Rounding lets a few points of a slow climb keep their height, and so divides a helix. One stretch
        // of helices may need fewer curves.
        let helices = fit_stretches(&ends, &whole(Plane::Xy), request, budget)?;
        if helices.curves.len() < pieces.curves.len() {
            pieces = helices;
        }
    }
    // A point that repeats the point before it belongs to the same curve.
    let last = |end: usize| distinct.get(end + 1).map_or(points.len(), |next| *next) - 1;
    for piece in &mut pieces.curves {
        piece.end = last(piece.end);
    }
    Ok(pieces)
}

fn fit_stretches(
    points: &[Point3<f64>],
    stretches: &[PlanarRun],
    request: &Fit,
    budget: &Budget,
) -> Result<FittedCurves, FitError> {
    // Elements of different planes meet on points.
    let request = match stretches {
        [_] => *request,
        _ => Fit { joints: Joints::OnPoints, is_closed: false, ..*request },
    };
    let mut curves = Vec::new();
    let mut begin = 0;
    let mut not_proved = None;
    for stretch in stretches {
        let fitted = fit_stretch(&points[begin..=stretch.end], stretch.plane, &request, budget)?;
        not_proved = not_proved.or(fitted.not_proved);
        curves.extend(fitted.curves.into_iter().map(|piece| FittedCurve { end: begin + piece.end, ..piece }));
        begin = stretch.end;
    }
    if stretches.len() > 1 && is_searched(&request) {
        not_proved = Some(NotProved::InSpace);
    }
    Ok(FittedCurves { curves, not_proved })
}

/// A stretch: the points from the end of the stretch before up to `end`. Its arcs lie in `plane`. If it is
/// level, all its points lie in a plane parallel to `plane`.
struct PlanarRun {
    plane: Plane,
    is_level: bool,
    end: usize,
}

fn stretches(points: &[Point3<f64>]) -> Vec<PlanarRun> {
    let last = points.len() - 1;
    let mut stretches: Vec<PlanarRun> = Vec::new();
    let mut begin = 0;
    while begin < last {
        let level_end = |plane: Plane| {
            let normal = plane.axes()[2];
            let is_level = |p: &&Point3<f64>| (p[normal] - points[begin][normal]).abs() <= LEVEL_MM;
            begin + points[begin..].iter().take_while(is_level).count() - 1
        };
        let mut longest = PlanarRun { plane: Plane::Xy, is_level: true, end: level_end(Plane::Xy) };
        for plane in [Plane::Zx, Plane::Yz] {
            let end = level_end(plane);
            if end > longest.end {
                longest = PlanarRun { plane, end, ..longest };
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
            _ => stretches.push(PlanarRun { plane: Plane::Xy, is_level: false, end: begin }),
        }
    }
    stretches
}

/// The elements of one stretch as curves. The index `end` of each counts from the first point of the stretch.
fn fit_stretch(
    points: &[Point3<f64>],
    plane: Plane,
    request: &Fit,
    budget: &Budget,
) -> Result<FittedCurves, FitError> {
    let local: Vec<Vector3<f64>> = points.iter().map(|p| plane.to_local(p)).collect();
    let flat: Vec<Vector2<f64>> = local.iter().map(Vector3::xy).collect();
    let is_level = local.iter().all(|p| (p.z - local[0].z).abs() <= LEVEL_MM);
    let heights: Vec<f64> = if is_level { Vec::new() } else { local.iter().map(|p| p.z).collect() };
    let Fitted { start, elements, not_proved } =
        fit(Points { flat: &flat, heights: &heights }, request, budget)?;
    let (mut from, mut height) = (start, local[0].z);
    let curves = elements
        .into_iter()
        .map(|element| {
            let at = |p: Vector2<f64>, height: f64| plane.to_workpiece(&Vector3::new(p.x, p.y, height));
            let end_height = height_of(&element, &local);
            let to = element.to().coords;
            let [start, end] = [at(from, height), at(to, end_height)];
            let arc = |is_ccw: bool, center: Point2<f64>| {
                let direction = if is_ccw { Direction::Ccw } else { Direction::Cw };
                Arc::new(plane, direction, start, end, at(center.coords, height)).map(Curve::Arc)
            };
            let line = Curve::Line(Line { start, end });
            // An arc can be so short that rounding makes its two radii differ. A line replaces it.
            let curve = match element.shape {
                Shape::Segment(Segment::Line { .. }) => line,
                Shape::Segment(Segment::Arc(own)) => arc(own.turn() > 0.0, own.center()).unwrap_or(line),
                Shape::FullCircle { center, is_ccw, .. } => arc(is_ccw, center).unwrap_or(line),
            };
            (from, height) = (to, end_height);
            FittedCurve { end: element.end, curve }
        })
        .collect();
    let in_space = (!is_level && is_searched(request)).then_some(NotProved::InSpace);
    Ok(FittedCurves { curves, not_proved: in_space.or(not_proved) })
}

/// Whether the fewest elements are searched for.
fn is_searched(request: &Fit) -> bool {
    request.method == Method::Optimal && request.continuity == Continuity::Position
}

/// The height at which an element ends, mm: that of its point. If a biarc's two arcs meet between two points,
/// a height between theirs.
fn height_of(element: &Element, local: &[Vector3<f64>]) -> f64 {
    let at = local[element.end];
    let to = element.to().coords;
    let Some(next) = local.get(element.end + 1).filter(|_| to != at.xy()) else { return at.z };
    let [passed, left] = [at, *next].map(|p| (to - p.xy()).norm());
    at.z + (next.z - at.z) * passed / (passed + left)
}

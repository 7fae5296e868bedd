//! Computes a lower bound of the distance between a part of a patch and a piece of the path of a ball's
//! centre.
//!
//! # Method
//! 1. Write the squared distance of a surface point from the piece as a function of the part's parameters.
//!    For a line or a point, this is a polynomial, or for a rational patch a quotient of two polynomials. For
//!    an arc it is neither. There, use a function of that kind that is at most the squared distance.
//! 2. The least Bernstein coefficient is a lower bound of the function. Its root is the result.

use nalgebra::Vector3;

use super::piece::{PathPiece, PieceCurve};
use crate::geometry::curve::{Arc, Direction, Line};
use crate::geometry::surface::Patch;
use crate::geometry::surface::patch::SquareBound;

/// Rounding of a squared distance, as a share of its largest term.
const ROUNDING: f64 = 1e-13;

/// Parts nearer to the axis of an arc than this share of its radius are measured as if they were this far
/// from it. Every distance c > 0 gives a true bound; at the axis, where all points of the arc are equally
/// near, none gives a good one.
const NEAREST_SHARE: f64 = 1e-3;

/// How near a part is to a piece.
pub(super) struct Nearness {
    /// A lower bound of the distance, mm. The caller adds the rounding of the coordinates.
    pub(super) lowest_distance: f64,
    /// Whether the distance bends more along u than along v.
    pub(super) varies_along_u: bool,
}

/// The nearness of a part to a piece that is raised by `rise` mm.
pub(super) fn nearness(piece: &PathPiece, rise: f64, part: &impl Patch) -> Nearness {
    let up = Vector3::z() * rise;
    let squared = match &piece.track {
        PieceCurve::Line(line) => to_line(&Line { start: line.start + up, end: line.end + up }, part),
        PieceCurve::Arc(arc) if rise == 0.0 => to_arc(arc, part),
        PieceCurve::Arc(arc) => to_arc(&arc.translated(&up), part),
    };
    let [bend_u, bend_v] = squared.bends;
    let lowest = squared.lowest - ROUNDING * squared.magnitude;
    Nearness { lowest_distance: lowest.max(0.0).sqrt(), varies_along_u: bend_u >= bend_v }
}

fn to_point(part: &impl Patch, point: &Vector3<f64>) -> SquareBound {
    part.bound_squares(point, &[Vector3::x(), Vector3::y(), Vector3::z()], &[1.0; 3])
}

fn to_line(line: &Line, part: &impl Patch) -> SquareBound {
    let (start, end) = (line.start.coords, line.end.coords);
    let Some(along) = (end - start).try_normalize(0.0) else { return to_point(part, &start) };
    if part.is_ahead(&start, &-along) {
        return to_point(part, &start);
    }
    if part.is_ahead(&end, &along) {
        return to_point(part, &end);
    }
    let across = along.cross(&Vector3::ith(along.iamin(), 1.0)).normalize();
    part.bound_squares(&start, &[across, along.cross(&across)], &[1.0; 2])
}

/// The squared distance to a circle contains a square root. Let r be the radius of the circle and c any
/// positive number. For a surface point, let h be its height over the plane of the circle, and q its squared
/// distance from the circle's axis. Then
///
/// distance^2 = q + r^2 - 2 r sqrt(q) + h^2 >= q (c - r) / c + r (r - c) + h^2,
///
/// because sqrt(q) <= (q + c^2) / (2 c). Both sides are equal where q = c^2. c^2 is the value of q at the
/// part's centre. Along the line of contact q is nearly constant, so little is lost there.
fn to_arc(arc: &Arc, part: &impl Patch) -> SquareBound {
    let center = arc.center().coords;
    let axes = arc.plane().axes().map(|c| Vector3::ith(c, 1.0));
    let (start, end) = (arc.start().coords, arc.end().coords);
    // A part is beyond an end of the arc if it lies behind the radius to that end, and on that end's side of
    // the bisector of both ends. The arc turns by at most 90 degrees, so its nearest point is then that end.
    let sense = if arc.direction() == Direction::Ccw { 1.0 } else { -1.0 };
    let forward = |p: &Vector3<f64>| axes[2].cross(&(p - center)) * sense;
    let to_end = end - start;
    let is_beyond = |direction: Vector3<f64>, side: Vector3<f64>| {
        part.is_ahead(&center, &direction) && part.is_ahead(&center, &side)
    };
    if is_beyond(-forward(&start), -to_end) {
        return to_point(part, &start);
    }
    if is_beyond(forward(&end), to_end) {
        return to_point(part, &end);
    }
    let r = arc.radius();
    let at_center = part.center() - center;
    let c = at_center.dot(&axes[0]).hypot(at_center.dot(&axes[1]));
    let c = c.max(NEAREST_SHARE * r);
    let weight = (c - r) / c;
    let mut squared = part.bound_squares(&center, &axes, &[weight, weight, 1.0]);
    squared.lowest += r * (r - c);
    squared.magnitude += r * (r - c).abs();
    squared
}

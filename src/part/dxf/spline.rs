//! Splines in DXF: control points with knots and weights, or points that the curve passes through.

use nalgebra::Point2;
use toolpathd_core::geometry::bspline::MAX_DEGREE;
use toolpathd_core::geometry::plane_curve::nurbs::{Nurbs, SHORTEST_SPAN};

use super::fields::Fields;
use super::reasons;
use super::shape::{Content, Shape, Tangents, is_flat, magnitude};
use crate::fault::Unreadable;

/// The bit of the flags of closed splines.
const CLOSED: i64 = 1;

/// Reads a SPLINE. Where it has control points, these give the curve, and its fit points are ignored. Knots
/// nearer to each other than a part in 1e9 of the domain are rounded copies of one knot.
///
/// # Errors
/// When a group is broken, or there are fewer points, knots or weights than the entity states.
pub fn read(fields: &Fields) -> Result<Content, Unreadable> {
    let [control, fit] = [points_of(fields, 10)?, points_of(fields, 11)?];
    let [mut knots, weights] = [numbers(fields, 40)?, numbers(fields, 41)?];
    for (code, found, what) in
        [(72, knots.len(), "knots"), (73, control.len(), "control points"), (74, fit.len(), "fit points")]
    {
        let stated = fields.integer(code)?;
        if stated > found as i64 {
            let detail = format!("a spline of {stated} {what} has only {found}");
            return Err(Unreadable::at(fields.place(), detail));
        }
    }
    if control.is_empty() {
        return through(fields, fit);
    }
    let degree = usize::try_from(fields.integer(71)?).unwrap_or(0);
    if degree > MAX_DEGREE {
        return Ok(Content::LeftOut(reasons::DEGREE));
    }
    let (control_points, is_flat) = in_plane(&control);
    if !is_flat {
        return Ok(Content::LeftOut(reasons::NOT_FLAT));
    }
    join_knots(&mut knots);
    let weights = (!weights.is_empty()).then_some(weights);
    let control_points = control_points.into_iter().map(Point2::from).collect();
    Ok(Content::Curve(Shape::Nurbs(Box::new(Nurbs { degree, knots, control_points, weights }))))
}

/// The curve through fit points. Tangents count if both are given and the spline is not marked as closed.
fn through(fields: &Fields, fit: Vec<[f64; 3]>) -> Result<Content, Unreadable> {
    let (mut points, is_flat) = in_plane(&fit);
    points.dedup();
    let is_closed = fields.integer(70)? & CLOSED != 0;
    if let (true, [first, _, .., last]) = (is_closed, points.as_slice())
        && first != last
    {
        points.push(*first);
    }
    let tangents = match (points.as_slice(), is_closed) {
        ([first, _, _, .., last], true) if first == last => Tangents::Closed,
        _ => match (points_of(fields, 12)?.first(), points_of(fields, 13)?.first()) {
            (Some(start), Some(end)) if is_direction(start) && is_direction(end) => {
                Tangents::Given([start, end].map(|v| [v[0], v[1]]))
            }
            _ => Tangents::Free,
        },
    };
    Ok(if points.len() < 2 {
        Content::LeftOut(reasons::FEW_POINTS)
    } else if !is_flat {
        Content::LeftOut(reasons::NOT_FLAT)
    } else {
        Content::Curve(Shape::Through { points, tangents })
    })
}

fn is_direction(v: &[f64; 3]) -> bool {
    v[0] != 0.0 || v[1] != 0.0
}

/// x and y of points, and whether their heights are equal.
fn in_plane(points: &[[f64; 3]]) -> (Vec<[f64; 2]>, bool) {
    let flat: Vec<[f64; 2]> = points.iter().map(|[x, y, _]| [*x, *y]).collect();
    let largest = magnitude(flat.iter().copied());
    (flat, is_flat(points.iter().map(|p| p[2]), largest))
}

/// The points whose x has this code.
fn points_of(fields: &Fields, code: i32) -> Result<Vec<[f64; 3]>, Unreadable> {
    let mut points: Vec<[f64; 3]> = Vec::new();
    let mut lacks_y = None;
    for group in &fields.groups {
        if group.code == code {
            if lacks_y.is_some() {
                break;
            }
            points.push([group.real()?, 0.0, 0.0]);
            lacks_y = Some(group.place);
        } else if (group.code == code + 10 || group.code == code + 20)
            && let Some(point) = points.last_mut()
        {
            point[if group.code == code + 10 { 1 } else { 2 }] = group.real()?;
            if group.code == code + 10 {
                lacks_y = None;
            }
        }
    }
    match lacks_y {
        Some(place) => Err(Unreadable::at(place, "a point has no y")),
        None => Ok(points),
    }
}

fn numbers(fields: &Fields, code: i32) -> Result<Vec<f64>, Unreadable> {
    fields.groups.iter().filter(|group| group.code == code).map(|group| group.real()).collect()
}

/// Makes rounded copies of a knot equal to it.
fn join_knots(knots: &mut [f64]) {
    let (Some(first), Some(last)) = (knots.first(), knots.last()) else { return };
    let nearest = SHORTEST_SPAN * (last - first).abs();
    for k in 1..knots.len() {
        if (knots[k] - knots[k - 1]).abs() <= nearest {
            knots[k] = knots[k - 1];
        }
    }
}

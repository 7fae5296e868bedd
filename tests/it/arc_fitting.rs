//! Tests of fitting arcs and lines. They judge fits by geometry of their own, not by the library's.
//!
//! This file holds what the tests share: the elements of a fit as [`Way`]s, and the verdict on a fit.

mod brute;
mod claims;
pub mod inputs;
mod laws;
mod noise;
mod plain;
mod table1;
mod way;

use nalgebra::Vector2;
use toolpathd_core::budget::Budget;
use toolpathd_core::geometry::arc_fit::{Fit, Fitted, Points, Shape, fit};
use toolpathd_core::geometry::segment::Segment;

use way::{Way, order_deviation};

/// Allowance for rounding when a fit is judged, mm. Coordinates are up to some tens of mm.
const ROUNDING_MM: f64 = 1e-9;

/// Fits points in a plane.
fn fitted(points: &[Vector2<f64>], request: &Fit) -> Fitted {
    fit(Points { flat: points, heights: &[] }, request, &Budget::unlimited()).unwrap()
}

/// The elements of a fit as ways, each with the indices of its first and last point.
fn ways(found: &Fitted) -> Vec<(Way, [usize; 2])> {
    let mut first = 0;
    let each = found.elements.iter().map(|element| {
        let way = match element.shape {
            Shape::Segment(Segment::Line { start, end }) => Way::line(start.coords, end.coords),
            Shape::Segment(Segment::Arc(arc)) => Way::arc(arc.start().coords, arc.end().coords, arc.turn()),
            Shape::FullCircle { at, center, is_ccw } => Way::turn(center.coords, at.coords, is_ccw),
        };
        let range = [first, element.end];
        first = element.end;
        (way, range)
    });
    each.collect()
}

/// Returns the number of elements of a fit that is right, or else what is wrong with it.
///
/// A fit is right if its chain starts near the first point and ends at the last, leaves no point out, and
/// each element passes its points in order within the tolerance (mm).
fn judge(points: &[Vector2<f64>], found: &Fitted, tolerance: f64) -> Result<usize, String> {
    let most = tolerance + ROUNDING_MM;
    let is_whole = found.elements.last().map(|element| element.end) == Some(points.len() - 1);
    if !is_whole || (found.start - points[0]).norm() > most {
        return Err(format!("{found:?} does not lead from {} to the last point", points[0]));
    }
    for (way, [first, last]) in ways(found) {
        let off = if first < last { order_deviation(&way, &points[first..=last]) } else { f64::INFINITY };
        if off > most {
            return Err(format!("{way:?} is {off} mm off the points {:?}", &points[first..=last]));
        }
    }
    Ok(found.elements.len())
}

/// The least number of elements in a chain over `n` points. `is_possible` says whether one element may join
/// two points.
fn least(n: usize, is_possible: impl Fn([usize; 2]) -> bool) -> usize {
    let mut counts = vec![0];
    for to in 1..n {
        let before = (0..to).filter(|from| is_possible([*from, to])).map(|from| counts[from]);
        counts.push(1 + before.min().unwrap());
    }
    counts[n - 1]
}

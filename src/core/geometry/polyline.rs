//! Polylines as fewer segments.

use nalgebra::{Point2, Vector2};

use super::arc_fit::{self, Fit, Joints, Measure, Method, Points, Shape};
use super::segment::Segment;
use crate::budget::{Budget, Stopped};

/// Arcs and lines through some of the points of a polyline. They are within `within_mm` of its lines, and its
/// lines are within `within_mm` of them. Points that repeat the one before are left out.
///
/// # Errors
/// When the budget ends.
pub fn as_arcs(points: &[Point2<f64>], within_mm: f64, budget: &Budget) -> Result<Vec<Segment>, Stopped> {
    let mut flat: Vec<Vector2<f64>> = points.iter().map(|p| p.coords).collect();
    flat.dedup();
    if flat.len() < 2 {
        return Ok(Vec::new());
    }
    let request = Fit {
        method: Method::Greedy,
        joints: Joints::OnPoints,
        measure: Measure::Polyline,
        ..Fit::within(within_mm)
    };
    let fitted = arc_fit::fit(Points { flat: &flat, heights: &[] }, &request, budget)?;
    // An open chain has no full circles.
    let segment = |element: arc_fit::Element| match element.shape {
        Shape::Segment(segment) => segment,
        Shape::FullCircle { at, .. } => Segment::Line { start: at, end: at },
    };
    Ok(fitted.elements.into_iter().map(segment).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_fine_polygon_becomes_a_few_arcs_near_it() {
        let corner = |k: usize| {
            let angle = std::f64::consts::TAU * k as f64 / 10_000.0;
            Point2::new(50.0 * angle.cos(), 50.0 * angle.sin())
        };
        let mut points: Vec<_> = (0..10_000).map(corner).collect();
        points.push(points[0]);
        let elements = as_arcs(&points, 5e-4, &Budget::unlimited()).unwrap();
        assert!(elements.len() < 10, "{}", elements.len());
        for pair in elements.windows(2) {
            assert_eq!(pair[0].end(), pair[1].start());
        }
        assert_eq!(elements[0].start(), elements[elements.len() - 1].end());
        for element in &elements {
            for t in [0.0, 0.3, 0.7] {
                assert!((element.at(t).coords.norm() - 50.0).abs() < 6e-4);
            }
        }
    }
}

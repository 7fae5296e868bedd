//! The method of the paper: dual cubic B-splines on uniform knots.
//!
//! # Method
//! 1. Each axis between two others moves toward the point that divides the great circle between its
//!    neighbours as its tip divides the way between theirs (1, 2).
//! 2. The bottom points are the tips, the top points are the tips plus the axes times the distance of the top
//!    (3, 4). Each polyline gives a B-spline: two points at a quarter of every leg, moved outward by a
//!    correction (12 to 17) that is at most the tolerance (18 to 21), are its control points, with both ends.
//! 3. The knots are uniform (10, 11) and shared. The axis is the direction from the bottom to the top (22).
//!
//! # Guarantees
//! None. The clamp bounds the correction and not the error: the report states what was proved.
//!
//! # Cost
//! O(n) for n poses.
//!
//! # Differences from the paper
//! * (2) has the lengths exchanged. The axis divides the great circle as the tip divides the way. It has no
//!   bound of its own: here an axis moves by at most its tolerance. Neighbours are taken as given, so that a
//!   reversed path gives the reversed rails.
//! * (3) misses the distance of the top.
//! * (12) points inward: the correction goes the other way. With theta as the interior angle, (13) is
//!   13/48 L tan(phi/2) for the turn phi. It is computed from the cross product, so that it vanishes on
//!   lines.
//! * If the axis never turns, each top point is its bottom point moved along the axis. The corrections of top
//!   and bottom are clamped by different tolerances, and the difference would lean the axis.
//! * (6) starts with degree 0, and the last interval is closed.
//!
//! # Reference
//! K. Ahn, S. Jee, *Five-Axis Tool Path Smoothing based on Cubic B-Spline Curves*, 2020, equations 1 to 22.

use nalgebra::Vector3;

use super::deviation::{Deviation, of_span};
use super::leg::Leg;
use super::rail::{Fitted, Piece, Point6, Rail, Source, Span, join, tip, top};
use super::{Continuity, Rails};
use crate::budget::{Budget, Stopped};
use crate::geometry::bspline;
use crate::toolpath::tool_axes::angle_between;

/// (13) for one unit of length: 2 (0.0208 + 0.25 (0.4792 - 0.0208)) with 1/48 for 0.0208.
const CORRECTION: f64 = 13.0 / 48.0;

pub fn rails(stations: &[Point6], tolerance: Deviation, budget: &Budget) -> Result<Rails, Stopped> {
    let given = stations;
    let legs: Vec<Leg> = given.windows(2).map(|pair| Leg::new(pair[0], pair[1])).collect();
    let height = top(&given[0]).norm();
    let axes = spaced_axes(given, &legs, tolerance.axis);
    let bottoms: Vec<Vector3<f64>> = given.iter().map(tip).collect();
    let tops: Vec<Vector3<f64>> = bottoms.iter().zip(&axes).map(|(tip, axis)| tip + axis).collect();
    let bottom = control_points(&bottoms, tolerance.tip_mm);
    let top = control_points(&tops, height * tolerance.axis);
    let turns = legs.iter().any(Leg::turns);
    let across = |(bottom, top): (&Vector3<f64>, &Vector3<f64>)| if turns { top - bottom } else { axes[0] };
    let control: Vec<Point6> = bottom.iter().zip(&top).map(|pair| join(*pair.0, across(pair))).collect();

    let n = control.len();
    let last = (n - 3) as f64;
    let knots: Vec<f64> = (0..n + 4).map(|k| (k as f64 - 3.0).clamp(0.0, last)).collect();
    let mut spans = Vec::with_capacity(n - 3);
    let mut deviation = Deviation::NONE;
    for (k, span) in bspline::spans(&knots, 3, n).enumerate() {
        budget.check()?;
        let bezier: [Point6; 4] = std::array::from_fn(|row| {
            (0..4).map(|column| control[span.first + column] * span.extraction[(row, column)]).sum()
        });
        let span = Span::bezier(span.ends, bezier);
        let near = [(k.max(1) - 1) / 2, ((k + 2) / 2).min(legs.len() - 1)];
        deviation = deviation.max(of_span(&span, &legs[near[0]..=near[1]], Deviation::NONE));
        spans.push(Fitted { span, source: Source::Run(near) });
    }
    Ok(Rails {
        rail: Rail { pieces: vec![Piece::new(spans)] },
        deviation,
        n_blends: 0,
        continuity: Continuity::C2,
    })
}

/// The vectors to the tops after the axes are spaced as their tips are (2), each moved by at most `most`
/// radians.
fn spaced_axes(given: &[Point6], legs: &[Leg], most: f64) -> Vec<Vector3<f64>> {
    let mut axes: Vec<Vector3<f64>> = given.iter().map(top).collect();
    for k in 1..given.len() - 1 {
        let (before, after) = (legs[k - 1].length, legs[k].length);
        if before + after <= 0.0 {
            continue;
        }
        let own = top(&given[k]);
        let way = Leg::new(given[k - 1], given[k + 1]);
        let wanted = way.top_at(before / (before + after));
        let angle = angle_between(&own, &wanted);
        let move_to = Leg::new(join(Vector3::zeros(), own), join(Vector3::zeros(), wanted));
        axes[k] = if angle > most { move_to.top_at(most / angle) } else { wanted };
    }
    axes
}

/// The ends of a polyline and two points in each of its legs, corrected by at most `most` mm.
fn control_points(points: &[Vector3<f64>], most: f64) -> Vec<Vector3<f64>> {
    let last = points.len() - 1;
    // The unit normal of the plane of a corner and the tangent of half its turn.
    let corner = |k: usize| -> Option<(Vector3<f64>, f64)> {
        let [a, b] = [points[k] - points[k - 1], points[k + 1] - points[k]].map(|v| v.try_normalize(0.0));
        let (a, b) = (a?, b?);
        let normal = a.cross(&b);
        let tangent = normal.norm() / (1.0 + a.dot(&b));
        Some((normal.try_normalize(0.0)?, tangent)).filter(|_| tangent.is_finite())
    };
    let mut control = vec![points[0]];
    for k in 0..last {
        let along = points[k + 1] - points[k];
        for (part, nearest) in [(0.25, k.max(1)), (0.75, (k + 1).min(last.max(2) - 1))] {
            let outward = (last > 1).then(|| corner(nearest)).flatten().and_then(|(normal, tangent)| {
                let direction = along.try_normalize(0.0)?.cross(&normal);
                Some(direction * (CORRECTION * along.norm() * tangent).min(most))
            });
            control.push(points[k] + along * part + outward.unwrap_or_default());
        }
    }
    control.push(points[last]);
    control
}

#[cfg(test)]
mod tests {
    use super::*;

    fn circle(n: usize, radius: f64, step: f64) -> Vec<Point6> {
        let at = |k: usize| {
            let (sin, cos) = (k as f64 * step).sin_cos();
            join(Vector3::new(radius * cos, radius * sin, 0.0), Vector3::z() * 50.0)
        };
        (0..n).map(at).collect()
    }

    #[test]
    fn at_even_spacing_and_turn_the_curve_passes_the_inner_junctions() {
        let stations = circle(12, 20.0, 0.05);
        let tolerance = Deviation { tip_mm: 1.0, axis: 0.1 };
        let rails = rails(&stations, tolerance, &Budget::unlimited()).unwrap();
        let spans = &rails.rail.pieces[0].spans;
        for (k, station) in stations.iter().enumerate().take(10).skip(2) {
            // The middle of the span about the junction.
            let at = spans[2 * k - 1].jet(0.5 * (spans[2 * k - 1].from + spans[2 * k - 1].to))[0];
            assert!((tip(&at) - tip(station)).norm() < 1e-12, "{k}");
        }
    }

    #[test]
    fn a_right_angle_is_cut_far_outside_the_tolerance_and_the_report_says_so() {
        let at = |x: f64, y: f64| join(Vector3::new(x, y, 0.0), Vector3::z() * 50.0);
        let stations = [at(0.0, 0.0), at(10.0, 0.0), at(20.0, 0.0), at(20.0, 10.0), at(20.0, 20.0)];
        let tolerance = Deviation { tip_mm: 0.005, axis: 0.01 };
        let rails = rails(&stations, tolerance, &Budget::unlimited()).unwrap();
        // 0.2708 L cos(theta / 2) with L = 10 and theta = 90 degrees is the distance from the corner.
        let spans = &rails.rail.pieces[0].spans;
        let middle = &spans[2 * 2 - 1];
        let nearest = middle.jet(0.5 * (middle.from + middle.to))[0];
        let distance = (tip(&nearest) - Vector3::new(20.0, 0.0, 0.0)).norm();
        assert!((distance - 1.915).abs() < 0.01, "{distance}");
        assert!(rails.deviation.tip_mm > 1.0, "{:?}", rails.deviation);
    }
}

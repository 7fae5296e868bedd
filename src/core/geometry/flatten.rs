//! Finds points on a curve such that the chords between neighbouring points stay near the curve.

use std::f64::consts::FRAC_PI_3;

use nalgebra::Point3;

use crate::geometry::curve::{Arc, Curve};

/// The part by which chords are shorter than the tolerance allows: rounding must not push one over it.
const ROUNDING: f64 = 1e-9;

/// Why a curve is not flattened.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum FlattenError {
    #[error("the chord tolerance {tolerance_mm} mm is not a distance above zero")]
    BadTolerance { tolerance_mm: f64 },
    #[error("the curve needs more than {limit} points")]
    TooManyPoints { limit: usize },
}

/// Points on `curve`, its exact ends first and last, whose chords stay within `chord_tolerance_mm` of it.
///
/// They are evenly spaced by length, and by the parameter on a parabola. A full circle has at least three
/// chords. Cost O(sqrt(size / tolerance)) points, at most `limit`.
///
/// # Errors
/// When the tolerance is not above zero, or more than `limit` points are needed.
pub fn flatten(
    curve: &Curve,
    chord_tolerance_mm: f64,
    limit: usize,
) -> Result<Vec<Point3<f64>>, FlattenError> {
    if !(chord_tolerance_mm.is_finite() && chord_tolerance_mm > 0.0) {
        return Err(FlattenError::BadTolerance { tolerance_mm: chord_tolerance_mm });
    }
    let chords = n_chords(curve, chord_tolerance_mm);
    if chords >= limit as f64 {
        return Err(FlattenError::TooManyPoints { limit });
    }
    let n = chords as usize;
    let at = |t: f64| match curve {
        Curve::Line(line) => line.point_at(t),
        Curve::Arc(arc) => arc.point_at(t),
        Curve::Parabola(parabola) => parabola.at(t),
    };
    let mut points: Vec<_> = (0..n).map(|k| at(k as f64 / chords)).collect();
    points.push(curve.end());
    Ok(points)
}

/// The number of chords that stay within a tolerance above zero. Cost O(1).
pub fn n_chords(curve: &Curve, tolerance_mm: f64) -> f64 {
    match curve {
        Curve::Line(_) => 1.0,
        Curve::Arc(arc) => (arc.sweep() / (2.0 * half_angle(arc, tolerance_mm))).ceil().max(1.0),
        Curve::Parabola(parabola) => {
            let height = parabola.bend().norm() / 4.0;
            (height / tolerance_mm * (1.0 + ROUNDING)).sqrt().ceil().max(1.0)
        }
    }
}

/// Half the angle that one chord may span, radians.
///
/// A chord of a circle leaves it by r (1 - cos a) = 2 r sin^2(a / 2). On a helix a point and the chord's
/// point at the same fraction also differ along the circle, by at most 0.065 r a^3; together at most 1.01 r
/// a^2 / 2 for a up to 60 degrees.
fn half_angle(arc: &Arc, tolerance_mm: f64) -> f64 {
    let ratio = tolerance_mm / (2.0 * arc.radius());
    let angle =
        if arc.rise() == 0.0 { 2.0 * ratio.min(1.0).sqrt().asin() } else { 2.0 * (ratio / 1.01).sqrt() };
    (angle * (1.0 - ROUNDING)).min(FRAC_PI_3)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::curve::{Direction, Line, Parabola};
    use crate::geometry::plane::Plane;

    fn arc(radius: f64, rise: f64) -> Curve {
        let (s, e) = (Point3::new(radius, 0.0, 0.0), Point3::new(0.0, -radius, rise));
        Curve::Arc(Arc::new(Plane::Xy, Direction::Ccw, s, e, Point3::origin()).unwrap())
    }

    #[test]
    fn chords_stay_within_the_tolerance_and_are_not_more_than_needed() {
        for (radius, rise) in [(0.01, 0.0), (1.0, 0.0), (5.0, 3.0), (5.0, 300.0), (1e4, 0.0)] {
            for tolerance in [1.0, 0.1, 0.01, 0.001] {
                let curve = arc(radius, rise);
                let points = flatten(&curve, tolerance, 100_000).unwrap();
                assert_eq!((points[0], points[points.len() - 1]), (curve.start(), curve.end()));
                let n = points.len() - 1;
                for (k, pair) in points.windows(2).enumerate() {
                    let chord = Line { start: pair[0], end: pair[1] };
                    for i in 0..=20 {
                        let t = (k as f64 + f64::from(i) / 20.0) / n as f64;
                        assert!(chord.distance_to(&curve.point_at(t)) <= tolerance * (1.0 + 1e-6));
                    }
                }
                let least = 1.5 * std::f64::consts::PI / (8.0 * tolerance / radius).sqrt();
                assert!(n as f64 <= (1.02 * least).ceil().max(5.0), "{n} {least}");
            }
        }
    }

    #[test]
    fn chords_of_a_parabola_stay_within_the_tolerance_too() {
        for (control, end) in [([5.0, 8.0, 1.0], [10.0, 0.0, 3.0]), ([30.0, 0.1, 0.0], [10.0, 0.0, 0.0])] {
            let parabola = Parabola::new(Point3::origin(), control.into(), end.into()).unwrap();
            for tolerance in [1.0, 0.1, 0.01, 0.001] {
                let points = flatten(&Curve::Parabola(parabola), tolerance, 100_000).unwrap();
                assert_eq!((points[0], points[points.len() - 1]), (parabola.start(), parabola.end()));
                let n = points.len() - 1;
                for (k, pair) in points.windows(2).enumerate() {
                    let chord = Line { start: pair[0], end: pair[1] };
                    for i in 0..=20 {
                        let t = (k as f64 + f64::from(i) / 20.0) / n as f64;
                        assert!(chord.distance_to(&parabola.at(t)) <= tolerance);
                    }
                }
                assert_eq!(n as f64, (parabola.bend().norm() / (4.0 * tolerance)).sqrt().ceil());
            }
        }
    }

    #[test]
    fn limits_and_bad_tolerances_are_errors() {
        let curve = arc(10.0, 0.0);
        for tolerance_mm in [0.0, -1.0, f64::INFINITY] {
            assert_eq!(flatten(&curve, tolerance_mm, 10), Err(FlattenError::BadTolerance { tolerance_mm }));
        }
        assert!(matches!(flatten(&curve, f64::NAN, 10), Err(FlattenError::BadTolerance { .. })));
        assert_eq!(flatten(&curve, 1e-300, 10), Err(FlattenError::TooManyPoints { limit: 10 }));
        let line = Curve::Line(Line { start: Point3::origin(), end: Point3::origin() });
        assert_eq!(flatten(&line, 1.0, 2).map(|points| points.len()), Ok(2));
    }
}

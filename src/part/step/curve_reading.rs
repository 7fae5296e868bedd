//! Curves of a file.

use std::f64::consts::TAU;

use nalgebra::Point3;

use super::basis;
use super::curve::Curve;
use super::instance::{Attributes, Instance};
use super::placement::Geometry;
use super::refusal::Refusal;
use super::spline_curve::SplineCurve;
use super::text::Value;
use crate::fault::Unreadable;

/// How deep curves refer to curves.
const DEEPEST: usize = 8;

/// The largest quotient of two weights of a spline.
const MAX_WEIGHT_RATIO: f64 = 1e9;

impl Geometry<'_> {
    /// A curve, without the ends of a trimmed curve.
    ///
    /// # Errors
    /// The file is broken, or the curve is of a kind that is left out.
    pub fn curve(&self, number: u32) -> Result<Curve, Refusal> {
        self.curve_below(number, 0)
    }

    fn curve_below(&self, number: u32, depth: usize) -> Result<Curve, Refusal> {
        let instance = self.source.get(number)?;
        if depth > DEEPEST {
            return Err(instance.fault("curves refer to curves in a circle, or too deep").into());
        }
        let part = instance.attributes();
        let positive = |k: usize| self.length(&instance, part, k);
        match instance.kind() {
            "LINE" => Ok(Curve::Line {
                origin: self.point(part.reference(1)?)?,
                along: self.vector(part.reference(2)?)?,
            }),
            "CIRCLE" => Ok(Curve::Circle { frame: self.frame(part.reference(1)?)?, radius_mm: positive(2)? }),
            "ELLIPSE" => {
                let semi_axes_mm = [positive(2)?, positive(3)?];
                Ok(Curve::Ellipse { frame: self.frame(part.reference(1)?)?, semi_axes_mm })
            }
            "HYPERBOLA" => {
                let semi_axes_mm = [positive(2)?, positive(3)?];
                Ok(Curve::Hyperbola { frame: self.frame(part.reference(1)?)?, semi_axes_mm })
            }
            "PARABOLA" => {
                Ok(Curve::Parabola { frame: self.frame(part.reference(1)?)?, focal_mm: positive(2)? })
            }
            "POLYLINE" => {
                let mut points = self.points(&part.references(1)?)?;
                points.dedup();
                if points.len() < 2 {
                    return Err(instance.fault("a polyline has at least 2 points").into());
                }
                Ok(Curve::Polyline(points))
            }
            "TRIMMED_CURVE" | "SURFACE_CURVE" | "SEAM_CURVE" | "INTERSECTION_CURVE" => {
                self.curve_below(part.reference(1)?, depth + 1)
            }
            "B_SPLINE_CURVE_WITH_KNOTS" | "UNIFORM_CURVE" | "QUASI_UNIFORM_CURVE" | "BEZIER_CURVE" => {
                self.spline(&instance)
            }
            _ if instance.has("B_SPLINE_CURVE") => self.spline(&instance),
            _ if instance.has("SURFACE_CURVE") || instance.has("INTERSECTION_CURVE") => {
                self.curve_below(instance.part("SURFACE_CURVE")?.reference(0)?, depth + 1)
            }
            _ => {
                let reason = "curves of this kind are not read";
                Err(Refusal::shape(&instance.name(), reason, instance.place()))
            }
        }
    }

    /// The growing range of the parameter of a trimmed circle or ellipse; `None` for other curves.
    ///
    /// # Errors
    /// The file is broken, or the curve is of a kind that is left out.
    pub fn trimmed_range(&self, number: u32) -> Result<Option<[f64; 2]>, Refusal> {
        let instance = self.source.get(number)?;
        if instance.kind() != "TRIMMED_CURVE" {
            return Ok(None);
        }
        let part = instance.attributes();
        let curve = self.curve(part.reference(1)?)?;
        if !matches!(curve, Curve::Circle { .. } | Curve::Ellipse { .. }) {
            return Ok(None);
        }
        let end = |k: usize| -> Result<Option<f64>, Unreadable> {
            for value in part.list(k)? {
                match value {
                    Value::Reference(point) => return Ok(Some(curve.nearest(&self.point(*point)?))),
                    Value::Typed(name, values) if name == "PARAMETER_VALUE" => match values.as_slice() {
                        [Value::Real(angle)] => return Ok(Some(angle * self.units.radians)),
                        [Value::Integer(angle)] => return Ok(Some(*angle as f64 * self.units.radians)),
                        _ => {}
                    },
                    _ => {}
                }
            }
            Ok(None)
        };
        let (Some(first), Some(second)) = (end(2)?, end(3)?) else { return Ok(None) };
        let (from, to) = if part.truth(4)? { (first, second) } else { (second, first) };
        let turn = (to - from).rem_euclid(TAU);
        Ok(Some([from, from + if turn > 0.0 { turn } else { TAU }]))
    }

    /// A length above zero, mm.
    pub fn length(&self, instance: &Instance, part: Attributes, k: usize) -> Result<f64, Unreadable> {
        let length = part.real(k)? * self.units.mm;
        if length > 0.0 && length.is_finite() {
            return Ok(length);
        }
        Err(instance.fault(format!("attribute {} must be a length above zero", k + 1)))
    }

    fn spline(&self, instance: &Instance) -> Result<Curve, Refusal> {
        let (part, first) = if instance.is_complex() {
            (instance.part("B_SPLINE_CURVE")?, 0)
        } else {
            (instance.attributes(), 1)
        };
        let degree = degree(instance, part, first)?;
        let points = self.points(&part.references(first + 1)?)?;
        let along = KnotPlace { instance, curve_or_surface: "CURVE", along: 0, after: first + 5 };
        let knots = along.knots(degree, points.len())?;
        check(instance, degree, &knots, points.len())?;
        let weights = if instance.has("RATIONAL_B_SPLINE_CURVE") {
            let weights = instance.part("RATIONAL_B_SPLINE_CURVE")?.reals(0)?;
            check_weights(instance, &weights, points.len())?;
            Some(weights)
        } else {
            None
        };
        if let Some(polyline) = as_polyline(degree, &knots, &points, weights.is_some()) {
            return Ok(polyline);
        }
        Ok(Curve::Spline(SplineCurve::new(degree, knots, points, weights)))
    }
}

/// A spline of degree 1 between two points as a line.
fn as_polyline(degree: usize, knots: &[f64], points: &[Point3<f64>], is_rational: bool) -> Option<Curve> {
    let is_line = degree == 1 && points.len() == 2 && !is_rational && knots[0] == knots[1];
    let along = is_line.then(|| (points[1] - points[0]).try_normalize(f64::MIN_POSITIVE))??;
    Some(Curve::Line { origin: points[0], along })
}

/// The degree of a spline.
///
/// # Errors
/// The degree is not from 1 to [`basis::MAX_DEGREE`].
pub fn degree(instance: &Instance, part: Attributes, k: usize) -> Result<usize, Unreadable> {
    let degree = part.integer(k)?;
    usize::try_from(degree).ok().filter(|degree| (1..=basis::MAX_DEGREE).contains(degree)).ok_or_else(|| {
        instance.fault(format!("the degree is {degree}; from 1 to {} is read", basis::MAX_DEGREE))
    })
}

/// # Errors
/// The knots do not fit the control points.
pub fn check(instance: &Instance, degree: usize, knots: &[f64], points: usize) -> Result<(), Unreadable> {
    if basis::is_valid(degree, knots, points) {
        return Ok(());
    }
    let detail = format!(
        "{} knots do not fit {points} control points of degree {degree}, or do not grow, or make a gap",
        knots.len()
    );
    Err(instance.fault(detail))
}

/// # Errors
/// There are not as many weights as control points, or a weight is not above zero.
pub fn check_weights(instance: &Instance, weights: &[f64], points: usize) -> Result<(), Unreadable> {
    if weights.len() != points {
        return Err(instance.fault(format!("{} weights do not fit {points} control points", weights.len())));
    }
    let largest = weights.iter().copied().fold(0.0, f64::max);
    match weights.iter().all(|weight| weight * MAX_WEIGHT_RATIO >= largest && *weight > 0.0) {
        true => Ok(()),
        false => Err(instance.fault("a weight is not above zero, or far below the others")),
    }
}

/// Where the knots of one direction stand.
pub struct KnotPlace<'a> {
    pub instance: &'a Instance,
    /// The last word of the names of the entities.
    pub curve_or_surface: &'a str,
    /// 0 for a curve and for u, 1 for v.
    pub along: usize,
    /// The place of the first attribute after those of every spline, in an instance of one part.
    pub after: usize,
}

impl KnotPlace<'_> {
    /// The knots for control points of a degree, each as often as it counts.
    ///
    /// # Errors
    /// The attributes are broken, or the kind of the spline is unknown.
    pub fn knots(&self, degree: usize, points: usize) -> Result<Vec<f64>, Unreadable> {
        let kind = |name: &str| self.instance.has(&format!("{name}{}", self.curve_or_surface));
        let spline = format!("B_SPLINE_{}_WITH_KNOTS", self.curve_or_surface);
        if self.instance.has(&spline) {
            let (part, first) = if self.instance.is_complex() {
                (self.instance.part(&spline)?, 0)
            } else {
                (self.instance.attributes(), self.after)
            };
            let n_directions = if self.curve_or_surface == "CURVE" { 1 } else { 2 };
            let counts = part.integers(first + self.along)?;
            let knots = part.reals(first + n_directions + self.along)?;
            return self.repeated(&counts, &knots, points + degree + 1);
        }
        let n_spans = points.saturating_sub(degree);
        if kind("UNIFORM_") {
            return Ok((0..points + degree + 1).map(|k| k as f64 - degree as f64).collect());
        }
        if kind("QUASI_UNIFORM_") {
            return Ok(clamped(degree, (1..n_spans).map(|k| (k as f64, 1)), n_spans as f64));
        }
        if kind("BEZIER_") && points % degree == 1 % degree && points > degree {
            let n_spans = (points - 1) / degree;
            return Ok(clamped(degree, (1..n_spans).map(|k| (k as f64, degree)), n_spans as f64));
        }
        Err(self.instance.fault("the spline has no knots, or its control points do not fit its kind"))
    }

    fn repeated(&self, counts: &[i64], knots: &[f64], n: usize) -> Result<Vec<f64>, Unreadable> {
        let fits = counts.len() == knots.len()
            && counts.iter().all(|count| *count > 0)
            && counts.iter().try_fold(0i64, |sum, count| sum.checked_add(*count)) == i64::try_from(n).ok();
        if !fits {
            let detail = format!("the counts of the knots must be above zero, and {n} in all");
            return Err(self.instance.fault(detail));
        }
        let repeat = |(count, knot): (&i64, &f64)| std::iter::repeat_n(*knot, *count as usize);
        Ok(counts.iter().zip(knots).flat_map(repeat).collect())
    }
}

/// Knots from 0 to `last` with degree + 1 equal ones at both ends.
fn clamped(degree: usize, inner: impl Iterator<Item = (f64, usize)>, last: f64) -> Vec<f64> {
    let mut knots = vec![0.0; degree + 1];
    knots.extend(inner.flat_map(|(knot, count)| std::iter::repeat_n(knot, count)));
    knots.extend(vec![last; degree + 1]);
    knots
}

//! Checks knot vectors, and computes the Bezier control points of B-spline curves and surfaces.
//!
//! A span is the interval between two neighbouring knots. Over each span, a B-spline of degree p is one
//! polynomial, and each of its p + 1 Bezier control points is a weighted mean of p + 1 control points of the
//! B-spline. The weights depend on the knots only. [`spans`] computes one matrix of weights for each span of
//! nonzero length, in O(p^4) a span. At each end, the knot vector may have p + 1 equal knots (a clamped end)
//! or not. [`check_knots`] refuses a knot vector that breaks the caller's rules ([`KnotRules`]).
//!
//! # Reference
//! L. Ramshaw, "Blossoms are polar forms", Computer Aided Geometric Design 6, 1989.

use nalgebra::DMatrix;

/// The highest degree of a curve, and of a surface along one direction.
pub const MAX_DEGREE: usize = 7;

/// The largest quotient of two weights: with a larger one the smaller weights do nothing but harm.
pub const MAX_WEIGHT_RATIO: f64 = 1e6;

/// The rules for a knot vector, which depend on its use.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct KnotRules {
    /// The highest multiplicity of a knot inside the domain.
    pub multiplicity: usize,
    /// The shortest span, as a part of the domain.
    pub shortest_span: f64,
}

/// Why numbers are not a valid knot vector.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum KnotError {
    #[error("there are {found} knots; {points} control points of degree {degree} need {}", points + degree + 1)]
    Count { found: usize, points: usize, degree: usize },
    #[error("knot {index} is smaller than the knot before it, or is not finite")]
    Decrease { index: usize },
    #[error(
        "knot {index} occurs {multiplicity} times; inside the domain a knot may occur at most {most} times"
    )]
    Multiplicity { index: usize, multiplicity: usize, most: usize },
    #[error("the first and the last parameter of the domain are equal")]
    EmptyDomain,
    #[error(
        "knot {index} is too close to the knot before it: different knots must be at least {shortest} times the length of the domain apart; make the two knots equal, or move them apart"
    )]
    SpanTooShort { index: usize, shortest: f64 },
}

/// A knot span. Its Bezier control points are `extraction` times the curve's control points from `first` on.
#[derive(Debug, Clone, PartialEq)]
pub struct Span {
    pub first: usize,
    /// The knots at its ends, growing.
    pub ends: [f64; 2],
    pub extraction: DMatrix<f64>,
}

/// The spans with a length, of a knot vector that [`check_knots`] accepts.
pub fn spans(knots: &[f64], degree: usize, points: usize) -> impl Iterator<Item = Span> + '_ {
    let has_length = |i: &usize| knots[i + 1] > knots[*i];
    (degree..points).filter(has_length).map(move |i| Span {
        first: i - degree,
        ends: [knots[i], knots[i + 1]],
        extraction: DMatrix::from_fn(degree + 1, degree + 1, |row, column| {
            blossom(knots, degree, i, row, column)
        }),
    })
}

/// Checks that `knots` are a valid knot vector for `points` control points, more than `degree`. The degree is
/// from 1 to [`MAX_DEGREE`].
///
/// # Errors
/// The first of [`KnotError`] that applies.
pub fn check_knots(knots: &[f64], degree: usize, points: usize, rules: KnotRules) -> Result<(), KnotError> {
    if knots.len() != points + degree + 1 {
        return Err(KnotError::Count { found: knots.len(), points, degree });
    }
    let is_wrong = |k: &usize| !knots[*k].is_finite() || (*k > 0 && knots[*k] < knots[k - 1]);
    if let Some(index) = (0..knots.len()).find(is_wrong) {
        return Err(KnotError::Decrease { index });
    }
    let length = knots[points] - knots[degree];
    if !(length > 0.0 && length.is_finite()) {
        return Err(KnotError::EmptyDomain);
    }
    let shortest = rules.shortest_span;
    let is_short = |k: &usize| (f64::MIN_POSITIVE..shortest * length).contains(&(knots[*k] - knots[k - 1]));
    if let Some(index) = (degree + 1..=points).find(is_short) {
        return Err(KnotError::SpanTooShort { index, shortest });
    }
    for (index, multiplicity) in inner_knots(knots, degree, points) {
        if multiplicity > rules.multiplicity {
            return Err(KnotError::Multiplicity { index, multiplicity, most: rules.multiplicity });
        }
    }
    Ok(())
}

/// The distinct knots inside the domain: for each the index of its first occurrence and its multiplicity.
pub fn inner_knots(knots: &[f64], degree: usize, points: usize) -> Vec<(usize, usize)> {
    let mut inner: Vec<(usize, usize)> = Vec::new();
    for (index, knot) in knots.iter().enumerate() {
        if *knot <= knots[degree] || *knot >= knots[points] {
            continue;
        }
        match inner.last_mut() {
            Some((first, multiplicity)) if knots[*first] == *knot => *multiplicity += 1,
            _ => inner.push((index, 1)),
        }
    }
    inner
}

/// The share of control point `span - degree + column` in the blossom's value with the span's end as an
/// argument `row` times, and its start `degree - row` times.
fn blossom(knots: &[f64], degree: usize, span: usize, row: usize, column: usize) -> f64 {
    let mut values = [0.0; MAX_DEGREE + 1];
    values[column] = 1.0;
    for step in 1..=degree {
        let argument = if step <= row { knots[span + 1] } else { knots[span] };
        for k in 0..=degree - step {
            let (low, high) = (knots[span - degree + k + step], knots[span + 1 + k]);
            let t = (argument - low) / (high - low);
            values[k] = values[k] * (1.0 - t) + values[k + 1] * t;
        }
    }
    values[0]
}

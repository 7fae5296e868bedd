//! Checks knot vectors, and computes the Bezier control points of B-spline curves and surfaces.
//!
//! A span is the interval between two neighbouring knots. Over each span, a B-spline of degree p is one
//! polynomial, and each of its p + 1 Bezier control points is a weighted mean of p + 1 control points of the
//! B-spline. The weights depend on the knots only. [`spans`] computes one matrix of weights for each span of
//! nonzero length, in O(p^4) a span. At each end, the knot vector may have p + 1 equal knots (a clamped end)
//! or not. [`check_knots`] refuses a knot vector that breaks the caller's rules ([`KnotRules`]).
//!
//! A control point acts between its knot and the knot p + 1 places behind. Where all of that lies outside the
//! domain, the control point has no effect; such a knot vector is refused, because the caller means something
//! else than the curve that would be drawn.
//!
//! # Reference
//! L. Ramshaw, "Blossoms are polar forms", Computer Aided Geometric Design 6, 1989.

use nalgebra::DMatrix;

/// The highest degree of a curve, and of a surface along one direction.
pub const MAX_DEGREE: usize = 7;

/// The largest quotient of two weights: with a larger one the smaller weights do nothing but harm.
pub const MAX_WEIGHT_RATIO: f64 = 1e6;

/// The least share that a control point must have somewhere in the curve or surface. A control point with a
/// smaller share, 1 km away, moves the curve by less than a nanometre. A larger limit would refuse ordinary
/// data: with uniform knots of degree 7 that are not clamped, and weights of the largest quotient, the first
/// control point has a share of 2e-10.
pub const LEAST_SHARE: f64 = 1e-12;

/// The rules for a knot vector, which depend on its use.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct KnotRules {
    /// The highest multiplicity of a knot inside the domain.
    pub multiplicity: usize,
    /// The shortest span, as a part of the domain.
    pub shortest_span: f64,
}

/// An end of the domain.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum End {
    Start,
    Finish,
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
    /// The knot `index` repeats an end of the domain. `points` control points at that end have no effect, the
    /// first of them with the number `first`.
    #[error("knot {index} repeats an end of the domain too often: {}", without_effect(*end, *first, *points, *most))]
    NoEffect { index: usize, end: End, first: usize, points: usize, most: usize },
}

impl KnotError {
    /// The knot at fault; `None` where the fault is of all knots.
    pub fn index(self) -> Option<usize> {
        match self {
            Self::Count { .. } | Self::EmptyDomain => None,
            Self::Decrease { index }
            | Self::Multiplicity { index, .. }
            | Self::SpanTooShort { index, .. }
            | Self::NoEffect { index, .. } => Some(index),
        }
    }
}

/// Says which control points have no effect, and what to do.
fn without_effect(end: End, first: usize, points: usize, most: usize) -> String {
    let side = match end {
        End::Start => "first",
        End::Finish => "last",
    };
    let (idle, them, knots) = match points {
        1 => (format!("control point {first} along these knots has"), "it", format!("the {side} knot")),
        _ => (
            format!("control points {first} to {} along these knots have", first + points - 1),
            "them",
            format!("the {side} {points} knots"),
        ),
    };
    format!(
        "{idle} no effect; leave {them} and {knots} out, so that an end knot occurs at most degree + 1 times, here {most}"
    )
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
    let is_short = |k: &usize| knots[*k] > knots[k - 1] && knots[*k] - knots[k - 1] < shortest * length;
    if let Some(index) = (degree + 1..=points).find(is_short) {
        return Err(KnotError::SpanTooShort { index, shortest });
    }
    for (index, multiplicity) in inner_knots(knots, degree, points) {
        if multiplicity > rules.multiplicity {
            return Err(KnotError::Multiplicity { index, multiplicity, most: rules.multiplicity });
        }
    }
    idle_end(knots, degree, points).map_or(Ok(()), Err)
}

/// The control points without effect at an end of the domain. A control point acts between its knot and the
/// knot degree + 1 places behind. Inside the domain, no control point of a knot vector without knots of a
/// multiplicity above degree + 1 is without effect.
fn idle_end(knots: &[f64], degree: usize, points: usize) -> Option<KnotError> {
    let most = degree + 1;
    let before = (0..points).take_while(|k| knots[k + degree + 1] <= knots[degree]).count();
    if before > 0 {
        return Some(KnotError::NoEffect { index: most, end: End::Start, first: 0, points: before, most });
    }
    let behind = (0..points).rev().take_while(|k| knots[*k] >= knots[points]).count();
    let first = points - behind;
    (behind > 0).then_some(KnotError::NoEffect {
        index: points,
        end: End::Finish,
        first,
        points: behind,
        most,
    })
}

/// The largest share of each control point in the Bezier control points of all spans, where all weights are
/// equal.
pub fn shares(spans: &[Span], points: usize) -> Vec<f64> {
    let mut shares = vec![0.0; points];
    for span in spans {
        for (share, column) in shares[span.first..].iter_mut().zip(span.extraction.column_iter()) {
            *share = column.iter().copied().fold(*share, f64::max);
        }
    }
    shares
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

#[cfg(test)]
mod tests;

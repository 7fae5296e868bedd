//! Rational B-spline surfaces, as Bezier patches. Each pair of a knot span along u and a knot span along v
//! makes one patch.
//!
//! # Guarantees
//! The patches equal the surface, up to rounding. In both directions, each end may be clamped or not. An end
//! is clamped if its knot occurs p + 1 times, where p is the degree in that direction.
//!
//! # Degenerate input
//! A surface can have a sharp edge at a knot inside the domain that occurs p times; [`joints`](super::joints)
//! finds such edges. A knot inside the domain that occurs more than p times could make a gap, and is refused.
//! So is a control point without effect: one whose knots lie outside the domain, and one whose share in the
//! surface is below [`LEAST_SHARE`].
//!
//! # Cost
//! O(p^2 q^2) for each patch of degree p along u and q along v.

use nalgebra::{Point3, Vector4};

use super::any_surface::{AnySurface, HIGH_DEGREE_PATCH_LIMIT, PATCH_LIMIT};
use super::bezier::BezierSurface;
use super::patch::RationalPatch;
use super::patch::raise::raised;
use crate::geometry::bspline::{
    KnotError, KnotRules, LEAST_SHARE, MAX_DEGREE, MAX_WEIGHT_RATIO, Span, check_knots, inner_knots, shares,
    spans,
};

/// The shortest knot span, as a part of the domain. A shorter span is a mistake in the data, or two knots
/// that should be equal.
pub const SHORTEST_SPAN: f64 = 1e-6;

/// Control points `control_points[i][j]`, i along u, in space (not multiplied by the weights), mm. The knot
/// vectors have length n + degree + 1 in each direction.
#[derive(Debug, Clone, PartialEq)]
pub struct Nurbs {
    pub degree: [usize; 2],
    pub knots: [Vec<f64>; 2],
    pub control_points: Vec<Vec<Point3<f64>>>,
    /// `None` makes all weights 1.
    pub weights: Option<Vec<Vec<f64>>>,
}

/// Why the data make no surface. `along` is 0 for u and 1 for v.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum NurbsError {
    #[error("the degree is {degree}; degrees from 1 to {MAX_DEGREE} are supported")]
    Degree { along: usize, degree: usize },
    #[error("there are {points} control points along this direction; degree {degree} needs at least {}", degree + 1)]
    TooFewPoints { along: usize, points: usize, degree: usize },
    #[error("row {row} has {found} control points where row 0 has {expected}")]
    Ragged { row: usize, found: usize, expected: usize },
    #[error("control point [{i}][{j}] is not finite")]
    PointNotFinite { i: usize, j: usize },
    #[error("there are {found} knots; {points} control points of degree {degree} need {}", points + degree + 1)]
    KnotCount { along: usize, found: usize, points: usize, degree: usize },
    #[error("knot {index} is smaller than the knot before it, or is not finite")]
    KnotsDecrease { along: usize, index: usize },
    #[error(
        "knot {index} occurs {multiplicity} times; inside the domain a knot may occur at most {degree} times"
    )]
    KnotMultiplicity { along: usize, index: usize, multiplicity: usize, degree: usize },
    #[error("the first and the last parameter of the domain are equal")]
    EmptyDomain { along: usize },
    #[error(
        "knot {index} is too close to the knot before it: different knots must be at least {SHORTEST_SPAN} times the length of the domain apart; make the two knots equal, or move them apart"
    )]
    SpanTooShort { along: usize, index: usize },
    #[error("{error}")]
    KnotWithoutEffect { along: usize, index: usize, error: KnotError },
    #[error(
        "control point [{i}][{j}] has no effect: its share in the surface is below {LEAST_SHARE:e}; leave its row or column out, move the knots outside the domain nearer to the domain, or send weights that are nearer to each other"
    )]
    PointWithoutEffect { i: usize, j: usize },
    #[error("there are {found} rows of weights for {expected} rows of control points")]
    WeightRows { found: usize, expected: usize },
    #[error("row {row} has {found} weights for {expected} control points")]
    WeightColumns { row: usize, found: usize, expected: usize },
    #[error("weight {weight} is not a finite number above zero")]
    Weight { i: usize, j: usize, weight: f64 },
    #[error("the surface has {patches} patches; at most {limit} of this degree are supported")]
    TooManyPatches { patches: usize, limit: usize },
    #[error(
        "weight {weight} is more than {MAX_WEIGHT_RATIO} times smaller than the largest weight, {largest}"
    )]
    WeightRatio { i: usize, j: usize, weight: f64, largest: f64 },
}

impl Nurbs {
    /// The surface as Bezier patches.
    ///
    /// # Errors
    /// One of [`NurbsError`].
    pub fn surface(&self) -> Result<AnySurface, NurbsError> {
        let size = self.checked_size()?;
        self.check_weights(size)?;
        for (along, knots) in self.knots.iter().enumerate() {
            let rules = KnotRules { multiplicity: self.degree[along], shortest_span: SHORTEST_SPAN };
            check_knots(knots, self.degree[along], size[along], rules)
                .map_err(|error| NurbsError::of_knots(error, along))?;
        }
        let spans = [0, 1].map(|along| -> Vec<Span> {
            spans(&self.knots[along], self.degree[along], size[along]).collect()
        });
        let at = |i: usize, j: usize| [&spans[0][i], &spans[1][j]];
        let counts = [spans[0].len(), spans[1].len()];
        let (patches, is_high) = (counts[0] * counts[1], self.degree.iter().any(|degree| *degree > 3));
        let limit = if is_high { HIGH_DEGREE_PATCH_LIMIT } else { PATCH_LIMIT };
        if patches > limit {
            return Err(NurbsError::TooManyPatches { patches, limit });
        }
        if let Some([i, j]) = self.point_without_effect(&spans, size) {
            return Err(NurbsError::PointWithoutEffect { i, j });
        }
        Ok(if is_high {
            AnySurface::HighDegree(BezierSurface::from_fn(counts, |i, j| self.patch(at(i, j))))
        } else if self.has_equal_weights() {
            AnySurface::Bicubic(BezierSurface::from_fn(counts, |i, j| raised(&self.patch(at(i, j)))))
        } else {
            AnySurface::Rational(BezierSurface::from_fn(counts, |i, j| self.patch(at(i, j))))
        })
    }

    /// The joints between patches where a knot of high multiplicity permits an edge. Each joint is given by
    /// the number of patches before it, along u and along v. Meaningful only if [`Nurbs::surface`] succeeds.
    pub fn loose_joints(&self) -> [Vec<usize>; 2] {
        let size = [self.control_points.len(), self.control_points.first().map_or(0, Vec::len)];
        [0, 1].map(|along| {
            let inner =
                inner_knots(&self.knots[along], self.degree[along], size[along]).into_iter().enumerate();
            let loose = inner.filter(|(_, (_, multiplicity))| *multiplicity >= self.degree[along]);
            loose.map(|(k, _)| k + 1).collect()
        })
    }

    /// The first control point whose share in the surface is nowhere [`LEAST_SHARE`].
    fn point_without_effect(&self, spans: &[Vec<Span>; 2], size: [usize; 2]) -> Option<[usize; 2]> {
        let along = [0, 1].map(|k| shares(&spans[k], size[k]));
        let largest = self.weights.iter().flatten().flatten().copied().reduce(f64::max).unwrap_or(1.0);
        let places = || (0..size[0]).flat_map(|i| (0..size[1]).map(move |j| [i, j]));
        // No sum of weights is larger than the largest weight, so the share is no smaller than this bound.
        let has_bound =
            |[i, j]: [usize; 2]| along[0][i] * along[1][j] * self.weight(i, j) >= LEAST_SHARE * largest;
        if places().all(has_bound) {
            return None;
        }
        let mut shares = vec![vec![0.0; size[1]]; size[0]];
        for u in &spans[0] {
            for v in &spans[1] {
                self.raise_shares([u, v], &mut shares);
            }
        }
        places().find(|[i, j]| shares[*i][*j] < LEAST_SHARE)
    }

    /// Raises each control point's share to its largest share in a Bezier control point of the patch. A
    /// control point has nowhere on the patch a larger share.
    fn raise_shares(&self, [u, v]: [&Span; 2], shares: &mut [Vec<f64>]) {
        let widths = self.degree.map(|degree| degree + 1);
        let cells = || (0..widths[0]).flat_map(|k| (0..widths[1]).map(move |l| [k, l]));
        for [a, b] in cells() {
            let part = |[k, l]: [usize; 2]| {
                self.weight(u.first + k, v.first + l) * u.extraction[(a, k)] * v.extraction[(b, l)]
            };
            let sum: f64 = cells().map(part).sum();
            for [k, l] in cells() {
                let share = &mut shares[u.first + k][v.first + l];
                *share = f64::max(*share, part([k, l]) / sum);
            }
        }
    }

    fn weight(&self, i: usize, j: usize) -> f64 {
        self.weights.as_ref().map_or(1.0, |weights| weights[i][j])
    }

    /// The control point times its weight, followed by the weight.
    fn homogeneous(&self, i: usize, j: usize) -> Vector4<f64> {
        let weight = self.weight(i, j);
        (self.control_points[i][j].coords * weight).push(weight)
    }

    fn has_equal_weights(&self) -> bool {
        let mut weights = self.weights.iter().flatten().flatten();
        let first = weights.next();
        weights.all(|weight| Some(weight) == first)
    }

    fn patch<const N: usize>(&self, spans: [&Span; 2]) -> RationalPatch<N> {
        let [u, v] = spans;
        RationalPatch::from_fn(self.degree, |a, b| {
            let mut sum = Vector4::zeros();
            for k in 0..=self.degree[0] {
                for l in 0..=self.degree[1] {
                    let share = u.extraction[(a, k)] * v.extraction[(b, l)];
                    if share != 0.0 {
                        sum += self.homogeneous(u.first + k, v.first + l) * share;
                    }
                }
            }
            sum
        })
    }

    fn checked_size(&self) -> Result<[usize; 2], NurbsError> {
        let size = [self.control_points.len(), self.control_points.first().map_or(0, Vec::len)];
        for (along, (&degree, &points)) in self.degree.iter().zip(&size).enumerate() {
            if !(1..=MAX_DEGREE).contains(&degree) {
                return Err(NurbsError::Degree { along, degree });
            }
            if points <= degree {
                return Err(NurbsError::TooFewPoints { along, points, degree });
            }
        }
        for (i, row) in self.control_points.iter().enumerate() {
            if row.len() != size[1] {
                return Err(NurbsError::Ragged { row: i, found: row.len(), expected: size[1] });
            }
            if let Some(j) = row.iter().position(|p| !p.iter().all(|x| x.is_finite())) {
                return Err(NurbsError::PointNotFinite { i, j });
            }
        }
        Ok(size)
    }

    fn check_weights(&self, [rows, columns]: [usize; 2]) -> Result<(), NurbsError> {
        let Some(weights) = &self.weights else { return Ok(()) };
        if weights.len() != rows {
            return Err(NurbsError::WeightRows { found: weights.len(), expected: rows });
        }
        let largest = weights.iter().flatten().copied().fold(0.0, f64::max);
        for (i, row) in weights.iter().enumerate() {
            if row.len() != columns {
                return Err(NurbsError::WeightColumns { row: i, found: row.len(), expected: columns });
            }
            for (j, &weight) in row.iter().enumerate() {
                if !(weight.is_finite() && weight > 0.0) {
                    return Err(NurbsError::Weight { i, j, weight });
                }
                if weight * MAX_WEIGHT_RATIO < largest {
                    return Err(NurbsError::WeightRatio { i, j, weight, largest });
                }
            }
        }
        Ok(())
    }
}

impl NurbsError {
    fn of_knots(error: KnotError, along: usize) -> Self {
        match error {
            KnotError::Count { found, points, degree } => Self::KnotCount { along, found, points, degree },
            KnotError::Decrease { index } => Self::KnotsDecrease { along, index },
            KnotError::Multiplicity { index, multiplicity, most } => {
                Self::KnotMultiplicity { along, index, multiplicity, degree: most }
            }
            KnotError::EmptyDomain => Self::EmptyDomain { along },
            KnotError::SpanTooShort { index, shortest: _ } => Self::SpanTooShort { along, index },
            KnotError::NoEffect { index, .. } => Self::KnotWithoutEffect { along, index, error },
        }
    }
}

#[cfg(test)]
mod tests;

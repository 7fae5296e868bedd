//! Basis functions of B-splines, and the part of a B-spline between two parameters.

use nalgebra::Vector4;

/// The highest degree that is read. Kernels write degrees up to 25.
pub const MAX_DEGREE: usize = 25;

/// Checks the knots of `points` control points of one direction.
pub fn is_valid(degree: usize, knots: &[f64], points: usize) -> bool {
    (1..=MAX_DEGREE).contains(&degree)
        && points > degree
        && knots.len() == points + degree + 1
        && knots.windows(2).all(|pair| pair[0] <= pair[1])
        && knots[degree] < knots[points]
        && inner_multiplicity(degree, knots, points) <= degree
}

/// The highest multiplicity of a knot inside the domain.
fn inner_multiplicity(degree: usize, knots: &[f64], points: usize) -> usize {
    let inner: Vec<f64> =
        knots.iter().copied().filter(|t| *t > knots[degree] && *t < knots[points]).collect();
    inner.chunk_by(|a, b| a == b).map(<[f64]>::len).max().unwrap_or(0)
}

/// The index i of the span with `knots[i] <= t < knots[i + 1]`; the last span at the end of the domain.
pub fn span(degree: usize, knots: &[f64], t: f64) -> usize {
    let points = knots.len() - degree - 1;
    let behind = knots[degree + 1..points].partition_point(|knot| *knot <= t);
    let mut i = degree + behind;
    while i > degree && knots[i] == knots[i + 1] {
        i -= 1;
    }
    i
}

/// The values and the first derivatives of the degree + 1 basis functions that act in the span `i`.
pub fn functions(
    degree: usize,
    knots: &[f64],
    i: usize,
    t: f64,
) -> ([f64; MAX_DEGREE + 1], [f64; MAX_DEGREE + 1]) {
    let mut values = [0.0; MAX_DEGREE + 1];
    let mut slopes = [0.0; MAX_DEGREE + 1];
    values[0] = 1.0;
    for p in 1..=degree {
        let mut carried = 0.0;
        for k in 0..p {
            let (low, high) = (knots[i + 1 + k - p], knots[i + 1 + k]);
            let share = values[k] / (high - low);
            values[k] = carried + (high - t) * share;
            carried = (t - low) * share;
            if p == degree {
                let slope = p as f64 * share;
                slopes[k] -= slope;
                slopes[k + 1] += slope;
            }
        }
        values[p] = carried;
    }
    (values, slopes)
}

/// The distinct knots of the domain, from its start to its end.
pub fn breaks(degree: usize, knots: &[f64]) -> Vec<f64> {
    let points = knots.len() - degree - 1;
    let mut breaks = knots[degree..=points].to_vec();
    breaks.dedup();
    breaks
}

/// The control points and knots over [from, to] of the domain, clamped at both ends.
pub fn part(
    degree: usize,
    knots: &[f64],
    points: &[Vector4<f64>],
    [from, to]: [f64; 2],
) -> (Vec<f64>, Vec<Vector4<f64>>) {
    let (knots, points) = insert(degree, knots, points, from);
    let (knots, points) = insert(degree, &knots, &points, to);
    // The place after the last knot at the start, and the place of the first knot at the end.
    let start = knots.partition_point(|knot| *knot <= from);
    let end = knots.partition_point(|knot| *knot < to);
    let mut inner = vec![from; degree + 1];
    inner.extend(knots[start..end].iter().copied());
    inner.extend(vec![to; degree + 1]);
    let n = inner.len() - degree - 1;
    (inner, points[start - 1 - degree..][..n].to_vec())
}

/// Inserts the knot `t` until it occurs at least degree times.
fn insert(degree: usize, knots: &[f64], points: &[Vector4<f64>], t: f64) -> (Vec<f64>, Vec<Vector4<f64>>) {
    let (mut knots, mut points) = (knots.to_vec(), points.to_vec());
    let occurs = knots.iter().filter(|knot| **knot == t).count();
    for multiplicity in occurs..degree {
        let k = knots.partition_point(|knot| *knot <= t) - 1;
        let inserted = |i: usize| {
            if i + degree <= k {
                return points[i];
            }
            if i > k - multiplicity {
                return points[i - 1];
            }
            let share = (t - knots[i]) / (knots[i + degree] - knots[i]);
            points[i - 1] * (1.0 - share) + points[i] * share
        };
        points = (0..=points.len()).map(inserted).collect();
        knots.insert(k + 1, t);
    }
    (knots, points)
}

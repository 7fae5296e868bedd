//! The first derivatives of a cubic spline that passes through given values, one derivative at each value.
//! The spline has two continuous derivatives. The values are numbers or vectors of any dimension.
//!
//! The first derivatives are the solution of a system of linear equations, one for each value. At each inner
//! value, the equation says that the second derivative is the same just before and just after it. At each
//! end, it states the end condition ([`EndCondition`]). The system is tridiagonal and is solved in O(n) for n
//! values. If there are too few values for not-a-knot or Bessel ends, the result is the derivatives of the
//! polynomial through all values.
//!
//! # Reference
//! C. de Boor, *A Practical Guide to Splines*, Springer, 1978, chapter IV.

use nalgebra::SVector;

/// The end condition of a spline, for both ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum EndCondition<const D: usize> {
    /// The second derivative is zero.
    Natural,
    /// The first two spans are one cubic, and so are the last two. With fewer than four values: the
    /// interpolating polynomial.
    NotAKnot,
    /// The first derivatives are given.
    Clamped(SVector<f64, D>, SVector<f64, D>),
    /// The first derivative is that of the parabola through the three values nearest the end.
    Bessel,
    /// The last value is the first, and the first and second derivatives are the same at both. With fewer
    /// than four values: as not-a-knot.
    Periodic,
}

/// The first derivatives of the spline through at least two `values`, at these values. The parameter grows by
/// one from value to value.
pub fn derivatives<const D: usize>(
    values: &[SVector<f64, D>],
    ends: EndCondition<D>,
) -> Vec<SVector<f64, D>> {
    derivatives_over(&vec![1.0; values.len().saturating_sub(1)], values, ends)
}

/// The first derivatives of the spline through at least two `values`, at these values. The parameter grows by
/// `steps[i]`, above zero, from value i to the next; there is one step fewer than values.
pub fn derivatives_over<const D: usize>(
    steps: &[f64],
    values: &[SVector<f64, D>],
    ends: EndCondition<D>,
) -> Vec<SVector<f64, D>> {
    let n = values.len();
    let last = n - 1;
    let ends =
        if n < LEAST_PERIODIC && ends == EndCondition::Periodic { EndCondition::NotAKnot } else { ends };
    let slope = |i: usize| (values[i + 1] - values[i]) / steps[i];
    if n == 2 && matches!(ends, EndCondition::NotAKnot | EndCondition::Bessel) {
        return vec![slope(0); 2];
    }
    // The derivative at an end, of the parabola through the three values nearest to it.
    let first_bessel = || parabola_end([steps[0], steps[1]], [slope(0), slope(1)]);
    let last_bessel = || parabola_end([steps[last - 1], steps[last - 2]], [slope(last - 1), slope(last - 2)]);
    if n == 3 && matches!(ends, EndCondition::NotAKnot) {
        let middle = (slope(0) * steps[1] + slope(1) * steps[0]) / (steps[0] + steps[1]);
        return vec![first_bessel(), middle, last_bessel()];
    }
    if ends == EndCondition::Periodic {
        return periodic(steps, &(0..last).map(slope).collect::<Vec<_>>());
    }
    let mut rows = Vec::with_capacity(n);
    let mut right = Vec::with_capacity(n);
    let mut push = |row: [f64; 3], value: SVector<f64, D>| {
        rows.push(Row { below: row[0], diagonal: row[1], above: row[2] });
        right.push(value);
    };
    match ends {
        EndCondition::Natural => push([0.0, 2.0, 1.0], slope(0) * 3.0),
        EndCondition::NotAKnot => {
            let ([a, b], [p, q]) = ([steps[0], steps[1]], [slope(0), slope(1)]);
            push([0.0, b, a + b], not_a_knot([a, b], [p, q]));
        }
        EndCondition::Clamped(first, _) => push([0.0, 1.0, 0.0], first),
        EndCondition::Bessel | EndCondition::Periodic => push([0.0, 1.0, 0.0], first_bessel()),
    }
    for i in 1..last {
        let (a, b) = (steps[i - 1], steps[i]);
        push([b, 2.0 * (a + b), a], (slope(i - 1) * b + slope(i) * a) * 3.0);
    }
    match ends {
        EndCondition::Natural => push([1.0, 2.0, 0.0], slope(last - 1) * 3.0),
        EndCondition::NotAKnot => {
            let (a, b) = (steps[last - 1], steps[last - 2]);
            push([a + b, b, 0.0], not_a_knot([a, b], [slope(last - 1), slope(last - 2)]));
        }
        EndCondition::Clamped(_, end) => push([0.0, 1.0, 0.0], end),
        EndCondition::Bessel | EndCondition::Periodic => push([0.0, 1.0, 0.0], last_bessel()),
    }
    solve(&mut rows, &mut right);
    right
}

/// The derivatives of the periodic spline with the slopes `slopes` over the steps.
///
/// Each value, the first too, has the row of an inner value. The two entries that lie outside the three
/// diagonals are a product of two vectors; so two systems without them give the solution (Sherman and
/// Morrison).
fn periodic<const D: usize>(steps: &[f64], slopes: &[SVector<f64, D>]) -> Vec<SVector<f64, D>> {
    let n = steps.len();
    let around = |i: usize| ((i + n - 1) % n, i);
    let mut rows = Vec::with_capacity(n);
    let mut right = Vec::with_capacity(n);
    for i in 0..n {
        let (before, after) = around(i);
        let (a, b) = (steps[before], steps[after]);
        rows.push(Row { below: b, diagonal: 2.0 * (a + b), above: a });
        right.push((slopes[before] * b + slopes[after] * a) * 3.0);
    }
    // The entries in the corners: of the last value in the first row, and of the first value in the last row.
    let (first, last) = (rows[0].below, rows[n - 1].above);
    let shift = -rows[0].diagonal;
    rows[0].diagonal -= shift;
    rows[n - 1].diagonal -= first * last / shift;
    let mut corner = vec![SVector::<f64, 1>::zeros(); n];
    corner[0][0] = shift;
    corner[n - 1][0] = last;
    solve(&mut rows.clone(), &mut corner);
    solve(&mut rows, &mut right);
    let part =
        (right[0] + right[n - 1] * (first / shift)) / (1.0 + corner[0][0] + corner[n - 1][0] * first / shift);
    right.iter_mut().zip(&corner).for_each(|(m, z)| *m -= part * z[0]);
    right.push(right[0]);
    right
}

/// The derivative at the end of the parabola with the slopes `p` and `q` over the steps `a` and `b`; those
/// nearest the end come first.
fn parabola_end<const D: usize>([a, b]: [f64; 2], [p, q]: [SVector<f64, D>; 2]) -> SVector<f64, D> {
    p + (p - q) * (a / (a + b))
}

/// The right side of the row b m0 + (a + b) m1. The row says that the spans of the steps `a` and `b` are one
/// cubic; `a` is nearest the end, `p` and `q` are the slopes over the steps.
fn not_a_knot<const D: usize>([a, b]: [f64; 2], [p, q]: [SVector<f64, D>; 2]) -> SVector<f64, D> {
    (p * (b * (3.0 * a + 2.0 * b)) + q * (a * a)) / (a + b)
}

/// Fewest values of a periodic spline, the first counted twice. Two different values make no curve.
const LEAST_PERIODIC: usize = 4;

/// One row of the system: below m[i - 1] + diagonal m[i] + above m[i + 1].
#[derive(Clone)]
struct Row {
    below: f64,
    diagonal: f64,
    above: f64,
}

/// Replaces the right sides by the solution, by Gaussian elimination without an exchange of rows. It never
/// divides by zero: in each row, the diagonal coefficient is larger than the sum of the others. A not-a-knot
/// end is an exception, but the divisors there stay above zero too.
fn solve<const D: usize>(rows: &mut [Row], right: &mut [SVector<f64, D>]) {
    let last = right.len() - 1;
    for i in 1..=last {
        let factor = rows[i].below / rows[i - 1].diagonal;
        rows[i].diagonal -= factor * rows[i - 1].above;
        let previous = right[i - 1];
        right[i] -= previous * factor;
    }
    right[last] /= rows[last].diagonal;
    for i in (0..last).rev() {
        let next = right[i + 1];
        right[i] = (right[i] - next * rows[i].above) / rows[i].diagonal;
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;

    use super::*;

    fn sampled(n: usize, f: impl Fn(f64) -> f64) -> Vec<Vector3<f64>> {
        (0..n).map(|i| Vector3::new(f(i as f64), 0.0, 1.0)).collect()
    }

    /// Uneven parameters, the steps between them, and the values of `f` at them.
    fn uneven(n: usize, f: impl Fn(f64) -> f64) -> (Vec<f64>, Vec<f64>, Vec<Vector3<f64>>) {
        let t: Vec<f64> = (0..n).map(|i| i as f64 + 0.4 * (2.1 * i as f64).sin()).collect();
        let values = t.iter().map(|t| Vector3::new(f(*t), *t, 1.0)).collect();
        (t.clone(), t.windows(2).map(|t| t[1] - t[0]).collect(), values)
    }

    #[test]
    fn not_a_knot_reproduces_cubics() {
        let cubic = |t: f64| 1.0 - 2.0 * t + 0.5 * t * t - 0.1 * t * t * t;
        let slope = |t: f64| -2.0 + t - 0.3 * t * t;
        for n in 4..9 {
            for (i, m) in derivatives(&sampled(n, cubic), EndCondition::NotAKnot).iter().enumerate() {
                assert!((m.x - slope(i as f64)).abs() < 1e-12, "n {n} i {i}: {}", m.x);
            }
            let (t, steps, values) = uneven(n, cubic);
            for (t, m) in t.iter().zip(derivatives_over(&steps, &values, EndCondition::NotAKnot)) {
                assert!((m.x - slope(*t)).abs() < 1e-12 && (m.y - 1.0).abs() < 1e-12, "n {n} t {t}: {}", m.x);
            }
        }
    }

    #[test]
    fn few_values_give_the_interpolating_polynomial() {
        let m = derivatives(&sampled(3, |t| t * t), EndCondition::NotAKnot);
        assert!((0..3).all(|i| (m[i].x - 2.0 * i as f64).abs() < 1e-14));
        let (t, steps, values) = uneven(3, |t| t * t);
        let m = derivatives_over(&steps, &values, EndCondition::NotAKnot);
        assert!((0..3).all(|i| (m[i].x - 2.0 * t[i]).abs() < 1e-13));
        let m = derivatives(&sampled(2, |t| 3.0 * t), EndCondition::NotAKnot);
        assert!(m.iter().all(|m| (m.x - 3.0).abs() < 1e-15));
        let m = derivatives(&sampled(2, |t| 3.0 * t), EndCondition::Natural);
        assert!(m.iter().all(|m| (m.x - 3.0).abs() < 1e-15));
    }

    #[test]
    fn clamped_ends_reproduce_cubics_and_bessel_ends_parabolas() {
        let cubic = |t: f64| t * t * t;
        let ends = EndCondition::Clamped(Vector3::zeros(), Vector3::new(75.0, 0.0, 0.0));
        let m = derivatives(&sampled(6, cubic), ends);
        assert!((0..6).all(|i| (m[i].x - 3.0 * (i * i) as f64).abs() < 1e-12));
        let m = derivatives(&sampled(6, |t| t * t), EndCondition::Bessel);
        assert!((0..6).all(|i| (m[i].x - 2.0 * i as f64).abs() < 1e-12));
        let (t, steps, values) = uneven(6, |t| t * t);
        let m = derivatives_over(&steps, &values, EndCondition::Bessel);
        assert!((0..6).all(|i| (m[i].x - 2.0 * t[i]).abs() < 1e-12));
    }

    #[test]
    fn a_periodic_spline_has_two_derivatives_across_its_seam() {
        for n in [4, 5, 9, 30] {
            let (t, steps, mut values) = uneven(n, |t| t);
            let around = std::f64::consts::TAU / (t[n - 1] - t[0]);
            values.iter_mut().zip(&t).for_each(|(v, place)| {
                let angle = around * (place - t[0]);
                *v = Vector3::new(angle.cos(), angle.sin(), 0.0);
            });
            values[n - 1] = values[0];
            let m = derivatives_over(&steps, &values, EndCondition::Periodic);
            assert_eq!(m.len(), n);
            let second = |i: usize, at_end: bool| {
                let h = steps[i];
                let rise = (values[i + 1] - values[i]) * (6.0 / (h * h));
                let (one, two) = if at_end { (2.0, 4.0) } else { (4.0, 2.0) };
                let sum = (m[i] * one + m[i + 1] * two) / h;
                if at_end { sum - rise } else { rise - sum }
            };
            for i in 0..n - 1 {
                let before = (i + n - 2) % (n - 1);
                assert!((second(before, true) - second(i, false)).norm() < 1e-11, "n {n} i {i}");
            }
            assert_eq!(m[0], m[n - 1]);
        }
        let m = derivatives(&sampled(3, |t| t * (2.0 - t)), EndCondition::Periodic);
        assert!((m[1].x).abs() < 1e-14);
    }

    #[test]
    fn natural_ends_have_no_second_derivative() {
        let (_, steps, values) = uneven(7, |t| (0.7 * t).sin());
        let m = derivatives_over(&steps, &values, EndCondition::Natural);
        let second = (values[1] - values[0]) * (6.0 / steps[0]) - m[0] * 4.0 - m[1] * 2.0;
        assert!(second.norm() < 1e-12);
        let second = (values[6] - values[5]) * (6.0 / steps[5]) - m[6] * 4.0 - m[5] * 2.0;
        assert!(second.norm() < 1e-12);
    }
}

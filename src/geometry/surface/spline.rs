//! Derivatives of the C2 cubic spline through equally spaced values.

use nalgebra::Vector3;

/// How the spline ends, the same at both ends.
#[derive(Debug, Clone, Copy)]
pub(super) enum EndCondition {
    /// Second derivative zero.
    Natural,
    /// The first two and the last two spans are one cubic; with fewer than four values the interpolating
    /// polynomial.
    NotAKnot,
    /// Given first derivatives.
    Clamped(Vector3<f64>, Vector3<f64>),
    /// First derivative of the parabola through the three values nearest the end.
    Bessel,
}

/// First derivatives, by the parameter that grows by one from value to value, of the spline through
/// `values`, two at least. One tridiagonal solution: O(n).
pub(super) fn derivatives(values: &[Vector3<f64>], ends: EndCondition) -> Vec<Vector3<f64>> {
    let n = values.len();
    let last = n - 1;
    if n == 2 && matches!(ends, EndCondition::NotAKnot | EndCondition::Bessel) {
        return vec![values[1] - values[0]; 2];
    }
    if n == 3 && matches!(ends, EndCondition::NotAKnot) {
        let (first, middle) = (parabola_end(values[0], values[1], values[2]), (values[2] - values[0]) * 0.5);
        return vec![first, middle, -parabola_end(values[2], values[1], values[0])];
    }
    // Rows: diagonal[i] m[i] + (m[i-1] and m[i+1] with weight 1, at the ends `outer`) = right[i].
    let mut diagonal = vec![4.0; n];
    let mut right: Vec<Vector3<f64>> = Vec::with_capacity(n);
    right.push(Vector3::zeros());
    right.extend((1..last).map(|i| (values[i + 1] - values[i - 1]) * 3.0));
    right.push(Vector3::zeros());
    let outer = match ends {
        EndCondition::Natural => {
            (diagonal[0], diagonal[last]) = (2.0, 2.0);
            right[0] = (values[1] - values[0]) * 3.0;
            right[last] = (values[last] - values[last - 1]) * 3.0;
            1.0
        }
        EndCondition::NotAKnot => {
            (diagonal[0], diagonal[last]) = (1.0, 1.0);
            right[0] = (values[2] + values[1] * 4.0 - values[0] * 5.0) * 0.5;
            right[last] = (values[last] * 5.0 - values[last - 1] * 4.0 - values[last - 2]) * 0.5;
            2.0
        }
        EndCondition::Clamped(first, end) => {
            (diagonal[0], diagonal[last]) = (1.0, 1.0);
            (right[0], right[last]) = (first, end);
            0.0
        }
        EndCondition::Bessel => {
            (diagonal[0], diagonal[last]) = (1.0, 1.0);
            right[0] = parabola_end(values[0], values[1], values[2]);
            right[last] = -parabola_end(values[last], values[last - 1], values[last - 2]);
            0.0
        }
    };
    solve(&mut diagonal, outer, &mut right);
    right
}

/// Derivative at the first of three equally spaced values of the parabola through them.
fn parabola_end(p0: Vector3<f64>, p1: Vector3<f64>, p2: Vector3<f64>) -> Vector3<f64> {
    (p1 * 4.0 - p0 * 3.0 - p2) * 0.5
}

/// Elimination without pivoting, stable because the rows are diagonally dominant but for the not-a-knot end,
/// whose pivot after one step is 4 - 2 = 2.
fn solve(diagonal: &mut [f64], outer: f64, right: &mut [Vector3<f64>]) {
    let last = right.len() - 1;
    for i in 1..=last {
        let above = if i == 1 { outer } else { 1.0 };
        let lower = if i == last { outer } else { 1.0 };
        let factor = lower / diagonal[i - 1];
        diagonal[i] -= factor * above;
        let previous = right[i - 1];
        right[i] -= previous * factor;
    }
    right[last] /= diagonal[last];
    for i in (0..last).rev() {
        let above = if i == 0 { outer } else { 1.0 };
        let next = right[i + 1];
        right[i] = (right[i] - next * above) / diagonal[i];
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sampled(n: usize, f: impl Fn(f64) -> f64) -> Vec<Vector3<f64>> {
        (0..n).map(|i| Vector3::new(f(i as f64), 0.0, 1.0)).collect()
    }

    #[test]
    fn not_a_knot_reproduces_cubics() {
        let cubic = |t: f64| 1.0 - 2.0 * t + 0.5 * t * t - 0.1 * t * t * t;
        for n in 4..9 {
            for (i, m) in derivatives(&sampled(n, cubic), EndCondition::NotAKnot).iter().enumerate() {
                let t = i as f64;
                assert!((m.x - (-2.0 + t - 0.3 * t * t)).abs() < 1e-12, "n {n} i {i}: {}", m.x);
            }
        }
    }

    #[test]
    fn few_values_give_the_interpolating_polynomial() {
        let m = derivatives(&sampled(3, |t| t * t), EndCondition::NotAKnot);
        assert!((0..3).all(|i| (m[i].x - 2.0 * i as f64).abs() < 1e-14));
        let m = derivatives(&sampled(2, |t| 3.0 * t), EndCondition::NotAKnot);
        assert!(m.iter().all(|m| (m.x - 3.0).abs() < 1e-15));
        let m = derivatives(&sampled(2, |t| 3.0 * t), EndCondition::Natural);
        assert!(m.iter().all(|m| (m.x - 3.0).abs() < 1e-15));
    }

    #[test]
    fn clamped_and_bessel_reproduce_what_they_can() {
        let cubic = |t: f64| t * t * t;
        let ends = EndCondition::Clamped(Vector3::zeros(), Vector3::new(75.0, 0.0, 0.0));
        let m = derivatives(&sampled(6, cubic), ends);
        assert!((0..6).all(|i| (m[i].x - 3.0 * (i * i) as f64).abs() < 1e-12));
        let m = derivatives(&sampled(6, |t| t * t), EndCondition::Bessel);
        assert!((0..6).all(|i| (m[i].x - 2.0 * i as f64).abs() < 1e-12));
    }

    #[test]
    fn natural_ends_have_no_second_derivative() {
        let values = sampled(7, |t| (0.7 * t).sin());
        let m = derivatives(&values, EndCondition::Natural);
        let second = (values[1] - values[0]) * 6.0 - m[0] * 4.0 - m[1] * 2.0;
        assert!(second.norm() < 1e-12);
    }
}

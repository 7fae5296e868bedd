//! Lengths of cubics, and the parameter at which a cubic has reached a given length.
//!
//! # Method
//! * The length is the integral of the speed over the parameter. An interval of parameters is integrated by
//!   the Gauss-Legendre rule of eight points. If the sum over its two halves differs from the result for the
//!   interval by more than rounding, each half is integrated in the same way.
//! * The parameter at a given length is found by Newton's method. An interval that contains the parameter
//!   shrinks at every step. If a step would leave this interval, the middle of the interval is taken instead.

use nalgebra::{Point3, Vector3};

use crate::geometry::bernstein::derived;

/// Nodes of the rule on [-1, 1] with their weights. Each node also stands for its mirror image below zero.
const RULE: [(f64, f64); 4] = [
    (0.183_434_642_495_649_8, 0.362_683_783_378_362),
    (0.525_532_409_916_329, 0.313_706_645_877_887_3),
    (0.796_666_477_413_626_7, 0.222_381_034_453_374_5),
    (0.960_289_856_497_536_3, 0.101_228_536_290_376_3),
];

/// How much the sum of two halves may differ from the whole, as a part of the length of the curve. The
/// difference that remains is rounding.
const AGREEMENT: f64 = 1e-14;

/// Most halvings of an integral. The speed has a corner at a cusp; there the halving ends at this limit.
const MOST_HALVINGS: usize = 24;

/// Most steps towards a place. Bisection alone needs fifty.
const MOST_STEPS: usize = 64;

/// The length of a cubic, with an error of some 1e-12 mm; mm.
pub(super) fn of_cubic(points: &[Point3<f64>; 4]) -> f64 {
    let derivative = derived(&points.map(|p| p.coords));
    integral(&derivative, 1.0)
}

/// The parameter at a fraction of the length. `length` is the length of the whole cubic, mm.
pub(super) fn place_on_cubic(points: &[Point3<f64>; 4], length: f64, fraction: f64) -> f64 {
    let derivative = derived(&points.map(|p| p.coords));
    let wanted = fraction * length;
    let ([mut low, mut high], mut t) = ([0.0, 1.0], fraction);
    for _ in 0..MOST_STEPS {
        let excess = integral(&derivative, t) - wanted;
        if excess.abs() <= 4.0 * AGREEMENT * length {
            break;
        }
        if excess > 0.0 {
            high = t
        } else {
            low = t
        }
        let next = t - excess / speed(&derivative, t);
        t = if next > low && next < high { next } else { 0.5 * (low + high) };
    }
    t
}

/// The length from parameter 0 to `end`, mm.
fn integral(derivative: &[Vector3<f64>], end: f64) -> f64 {
    let whole = rule(derivative, [0.0, end]);
    let mut open = vec![([0.0, end], whole, 0)];
    let mut sum = 0.0;
    while let Some(([from, to], known, halvings)) = open.pop() {
        let middle = 0.5 * (from + to);
        let halves = [[from, middle], [middle, to]].map(|range| (range, rule(derivative, range)));
        let better = halves[0].1 + halves[1].1;
        if (better - known).abs() <= AGREEMENT * whole || halvings == MOST_HALVINGS {
            sum += better;
        } else {
            open.extend(halves.map(|(range, length)| (range, length, halvings + 1)));
        }
    }
    sum
}

fn rule(derivative: &[Vector3<f64>], [from, to]: [f64; 2]) -> f64 {
    let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
    let pair = |(node, weight): &(f64, f64)| {
        weight * (speed(derivative, middle - half * node) + speed(derivative, middle + half * node))
    };
    half * RULE.iter().map(pair).sum::<f64>()
}

fn speed(derivative: &[Vector3<f64>], t: f64) -> f64 {
    let s = 1.0 - t;
    (derivative[0] * (s * s) + derivative[1] * (2.0 * s * t) + derivative[2] * (t * t)).norm()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_length_of_a_parabola_matches_the_closed_form() {
        // (t, t^2) for t from 0 to 2, raised to degree 3.
        let points = [[0.0, 0.0], [2.0 / 3.0, 0.0], [4.0 / 3.0, 4.0 / 3.0], [2.0, 4.0]]
            .map(|[x, y]| Point3::new(x, y, 1.0));
        let up_to = |t: f64| 0.5 * t * (1.0 + 4.0 * t * t).sqrt() + 0.25 * (2.0 * t).asinh();
        let length = of_cubic(&points);
        assert!((length - up_to(2.0)).abs() < 1e-13, "{length}");
        for fraction in [0.01, 0.3, 0.5, 0.9] {
            let t = 2.0 * place_on_cubic(&points, length, fraction);
            assert!((up_to(t) - fraction * length).abs() < 1e-12, "{fraction}");
        }
    }

    #[test]
    fn the_length_of_a_cubic_with_a_cusp_is_found() {
        // A line to x = 0.75 and back: the speed is 3 |1 - 2 t|.
        let points = [0.0, 1.0, 1.0, 0.0].map(|x| Point3::new(x, 0.0, 0.0));
        assert!((of_cubic(&points) - 1.5).abs() < 1e-9);
        assert!((place_on_cubic(&points, 1.5, 0.5) - 0.5).abs() < 1e-3);
    }
}

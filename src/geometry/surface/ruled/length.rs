//! Lengths of cubics, and places by length.
//!
//! # Method
//! The speed is integrated by Gauss and Legendre's rule of eight points, over halves until both agree with
//! the whole. Places are found by Newton's method, kept between bounds by halving.

use nalgebra::{Point3, Vector3};

use crate::geometry::bernstein::derived;

/// Nodes of the rule on [-1, 1], of which there is one on each side, and their weights.
const RULE: [(f64, f64); 4] = [
    (0.183_434_642_495_649_8, 0.362_683_783_378_362),
    (0.525_532_409_916_329, 0.313_706_645_877_887_3),
    (0.796_666_477_413_626_7, 0.222_381_034_453_374_5),
    (0.960_289_856_497_536_3, 0.101_228_536_290_376_3),
];

/// What halves may differ from the whole by, in parts of the length: rounding.
const AGREEMENT: f64 = 1e-14;

/// Halvings of an integral; the speed has a corner at a cusp, where they end.
const MOST_HALVINGS: usize = 24;

/// Steps towards a place; halving alone needs fifty.
const MOST_STEPS: usize = 64;

/// mm.
pub(super) fn of_cubic(points: &[Point3<f64>; 4]) -> f64 {
    let derivative = derived(&points.map(|p| p.coords));
    integral(&derivative, 1.0)
}

/// The parameter at a fraction of the length, which is known.
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

/// The length from 0 to `end`.
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
    fn a_parabola_has_its_length() {
        // (t, t^2) for t from 0 to 2, of degree raised to 3.
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
    fn a_cusp_ends() {
        // There and back again: |1 - 2 t| times 3 over the unit interval.
        let points = [0.0, 1.0, 1.0, 0.0].map(|x| Point3::new(x, 0.0, 0.0));
        assert!((of_cubic(&points) - 1.5).abs() < 1e-9);
        assert!((place_on_cubic(&points, 1.5, 0.5) - 0.5).abs() < 1e-3);
    }
}

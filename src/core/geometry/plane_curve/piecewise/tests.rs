use std::f64::consts::FRAC_1_SQRT_2;

use proptest::prelude::*;

use super::*;
use crate::geometry::plane_curve::weights::WeightError;
use exact::Exact;

/// Numbers with twice the digits, to test the bounds of rounding.
mod exact {
    use std::ops::{Add, Div, Mul, Sub};

    #[derive(Debug, Clone, Copy)]
    pub struct Exact(pub f64, pub f64);

    fn normal(a: f64, b: f64) -> Exact {
        let sum = a + b;
        Exact(sum, b - (sum - a))
    }

    impl Exact {
        /// Whether `lo <= self <= hi`.
        pub fn is_between(self, lo: f64, hi: f64) -> bool {
            let sign = |x: Exact| if x.0 == 0.0 { x.1 } else { x.0 };
            sign(self - Exact(lo, 0.0)) >= 0.0 && sign(Exact(hi, 0.0) - self) >= 0.0
        }
    }

    impl Add for Exact {
        type Output = Self;

        fn add(self, other: Self) -> Self {
            let sum = self.0 + other.0;
            let part = sum - self.0;
            let rest = (self.0 - (sum - part)) + (other.0 - part);
            normal(sum, rest + self.1 + other.1)
        }
    }

    impl Sub for Exact {
        type Output = Self;

        fn sub(self, other: Self) -> Self {
            self + Exact(-other.0, -other.1)
        }
    }

    impl Mul for Exact {
        type Output = Self;

        fn mul(self, other: Self) -> Self {
            let product = self.0 * other.0;
            let rest = self.0.mul_add(other.0, -product);
            normal(product, rest + self.0 * other.1 + self.1 * other.0)
        }
    }

    impl Div for Exact {
        type Output = Self;

        fn div(self, other: Self) -> Self {
            let first = Exact(self.0 / other.0, 0.0);
            let rest = self - first * other;
            first + Exact(rest.0 / other.0, 0.0)
        }
    }
}

/// The point and the first and second derivative of one piece at `t`, from differences of the net and
/// Bernstein sums.
fn exact_jet(bezier: &Bezier, [t0, t1]: [f64; 2], t: f64) -> [[Exact; 2]; 3] {
    let number = |x: f64| Exact(x, 0.0);
    let span = number(t1) - number(t0);
    let u = (number(t) - number(t0)) / span;
    let weight = |k: usize| number(bezier.weights().map_or(1.0, |w| w[k]));
    let nets = [0, 1, 2].map(|c| {
        let entry = |k: usize| match c {
            2 => weight(k),
            _ => number(bezier.points()[k][c]) * weight(k),
        };
        (0..=bezier.degree()).map(entry).collect::<Vec<_>>()
    });
    let derived = |net: &Vec<Exact>| -> Vec<Exact> {
        let n = number(net.len() as f64 - 1.0);
        let steps = net.windows(2).map(|p| (p[1] - p[0]) * n / span);
        if net.len() == 1 { vec![number(0.0)] } else { steps.collect() }
    };
    let value = |net: &Vec<Exact>| {
        let mut p = net.clone();
        while p.len() > 1 {
            p = p.windows(2).map(|p| p[0] + (p[1] - p[0]) * u).collect();
        }
        p[0]
    };
    let [x, y, w] = nets.map(|net| {
        let first = derived(&net);
        [value(&net), value(&first), value(&derived(&first))]
    });
    let quotient = |a: [Exact; 3]| {
        let point = a[0] / w[0];
        let first = (a[1] - point * w[1]) / w[0];
        [point, first, (a[2] - number(2.0) * first * w[1] - point * w[2]) / w[0]]
    };
    let (x, y) = (quotient(x), quotient(y));
    [[x[0], y[0]], [x[1], y[1]], [x[2], y[2]]]
}

fn any_bezier() -> impl Strategy<Value = Bezier> {
    let entries = prop::collection::vec((-100.0f64..100.0, -1.0f64..1.0, 0.2f64..3.0), 2..=8);
    (entries, any::<bool>()).prop_map(|(entries, is_rational)| {
        let points: Vec<_> = entries.iter().map(|(x, y, _)| Point2::new(*x, 1000.0 + y)).collect();
        let weights: Vec<_> = entries.iter().map(|(_, _, w)| *w).collect();
        let bezier =
            if is_rational { Bezier::rational(&points, &weights) } else { Bezier::polynomial(&points) };
        bezier.unwrap()
    })
}

fn one_piece(bezier: Bezier, start: f64, end: f64) -> Piecewise {
    Piecewise::new(start, [(bezier, end)]).unwrap()
}

fn parts(enclosure: &Enclosure) -> [[Interval; 2]; 3] {
    [enclosure.point, enclosure.first, enclosure.second]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn enclosures_contain_the_exact_curve(
        bezier in any_bezier(), start in -3.0f64..3.0, span in 0.01f64..100.0,
        a in 0.0f64..1.0, shrink in 0i32..60, inside in 0.0f64..1.0,
    ) {
        let curve = one_piece(bezier, start, start + span);
        let end = curve.domain()[1];
        let from = (start + a * span).min(end);
        let to = (from + (end - from) * 0.5f64.powi(shrink)).clamp(from, end);
        let t = (from + inside * (to - from)).clamp(from, to);
        for (from, to) in [(from, to), (t, t)] {
            let exact = exact_jet(&bezier, [start, end], t);
            let enclosure = curve.enclose(from, to);
            for (interval, value) in parts(&enclosure).iter().flatten().zip(exact.iter().flatten()) {
                prop_assert!(value.is_between(interval.lo(), interval.hi()), "{interval:?} {value:?}");
            }
        }
        let (here, point) = (curve.enclose(t, t).point, curve.point(t));
        prop_assert!((0..2).all(|c| here[c].contains(point[c])), "{here:?} {point}");
        let tight = here.map(|x| x.width());
        let units = if bezier.weights().is_some() { 300.0 } else { 50.0 };
        prop_assert!(tight.iter().all(|x| *x <= units * f64::EPSILON * 1000.0), "{tight:?}");
    }

    #[test]
    fn points_and_derivatives_match_the_exact_curve(bezier in any_bezier(), t in 2.0f64..5.0) {
        let curve = one_piece(bezier, 2.0, 5.0);
        let exact = exact_jet(&bezier, [2.0, 5.0], t);
        let (point, first) = (curve.point(t), curve.derivative(t));
        for c in 0..2 {
            prop_assert!((point[c] - exact[0][c].0).abs() < 1e-12, "{point} {exact:?}");
            prop_assert!((first[c] - exact[1][c].0).abs() < 1e-10, "{first} {exact:?}");
        }
    }
}

/// A quarter circle of radius 5 about (2, 1).
fn quarter_circle() -> Bezier {
    let points = [(7.0, 1.0), (7.0, 6.0), (2.0, 6.0)].map(|(x, y)| Point2::new(x, y));
    Bezier::rational(&points, &[1.0, FRAC_1_SQRT_2, 1.0]).unwrap()
}

#[test]
fn a_rational_quarter_circle_keeps_its_radius() {
    let curve = one_piece(quarter_circle(), 0.0, 1.0);
    let center = Point2::new(2.0, 1.0);
    for k in 0..=1000 {
        let t = f64::from(k) / 1000.0;
        let p = curve.point(t);
        assert!(((p - center).norm() - 5.0).abs() < 4e-15, "{t}");
        assert!((p - center).dot(&curve.derivative(t)).abs() < 1e-13);
        let [x, y] = curve.enclose(t, t).point;
        assert!(x.contains(p.x) && y.contains(p.y) && x.width().max(y.width()) < 3e-14);
    }
    assert_eq!(curve.point(1.0), Point2::new(2.0, 6.0));
}

/// How much wider than the curve its enclosures are, over ranges of 2^-1 to 2^-7 about 0.4, as a part of the
/// range.
fn excess(curve: &Piecewise, part: usize) -> Vec<f64> {
    let excess = |k: i32| {
        let half = 0.5f64.powi(k + 1);
        let (from, to) = ((0.4 - half).max(0.0), 0.4 + half);
        let at = |i: usize| {
            let t = from + (to - from) * (i as f64 / 200.0);
            parts(&curve.enclose(t, t))[part][1]
        };
        let samples = (0..=200).map(at).reduce(Interval::hull).unwrap();
        (parts(&curve.enclose(from, to))[part][1].width() - samples.width()).max(0.0) / (to - from)
    };
    (1..=7).map(excess).collect()
}

#[test]
fn the_excess_of_enclosures_shrinks_with_the_square_of_the_range() {
    let points =
        [(0.0, 0.0), (1.0, 3.0), (2.0, -4.0), (3.0, 2.0), (4.0, 1.0)].map(|(x, y)| Point2::new(x, y));
    let quintic = one_piece(Bezier::polynomial(&points).unwrap(), 0.0, 1.0);
    let circle = one_piece(quarter_circle(), 0.0, 1.0);
    for (curve, part, name) in [
        (&quintic, 0, "point"),
        (&quintic, 1, "first"),
        (&quintic, 2, "second"),
        (&circle, 0, "point of the circle"),
        (&circle, 1, "first of the circle"),
    ] {
        let excess = excess(curve, part);
        assert!(excess[6] < 0.05 * excess[1] + 1e-3, "{name}: {excess:?}");
    }
    // The excess of the second derivative shrinks with the range, so its quotient by the range is constant.
    let second = excess(&circle, 2);
    assert!(second[6] < 1.2 * second[1], "{second:?}");
}

fn line(from: [f64; 2], to: [f64; 2]) -> Bezier {
    Bezier::polynomial(&[Point2::from(from), Point2::from(to)]).unwrap()
}

#[test]
fn a_chain_has_the_points_and_derivatives_of_its_pieces() {
    let pieces =
        [(line([0.0, 0.0], [7.0, 1.0]), 1.0), (quarter_circle(), 4.0), (line([2.0, 6.0], [2.0, 9.0]), 4.5)];
    let chain = Piecewise::new(-1.0, pieces).unwrap();
    assert_eq!(chain.domain(), [-1.0, 4.5]);
    assert_eq!(chain.breaks(), [1.0, 4.0]);
    assert_eq!(chain.point(0.0), Point2::new(3.5, 0.5));
    assert_eq!(chain.point(1.0), Point2::new(7.0, 1.0));
    assert_eq!(chain.point(4.0), Point2::new(2.0, 6.0));
    assert_eq!([chain.point(4.5), chain.point(-1.0)], [Point2::new(2.0, 9.0), Point2::origin()]);
    assert_eq!([chain.point(9.0), chain.point(-9.0)], [Point2::new(2.0, 9.0), Point2::origin()]);
    assert_eq!(chain.derivative(4.0), Vector2::new(0.0, 6.0));
    assert_eq!(chain.derivative(4.5), Vector2::new(0.0, 6.0));
    let again: Vec<_> = chain.pieces().map(|(bezier, [_, end])| (bezier, end)).collect();
    assert_eq!(again, pieces);
    // A range that ends at a break belongs to one side, even if rounding puts an end past the break.
    for (from, to, slope) in
        [(0.9, 1.0, 3.5), (1.0f64.next_down(), 1.0, 3.5), (4.0, 4.1, 0.0), (4.0, 4.0, 0.0)]
    {
        let first = chain.enclose(from, to).first[0];
        assert!(first.contains(slope) && first.width() < 1e-13, "{first:?}");
    }
    let first = chain.enclose(0.5, 1.0 + 4e-16).first[0];
    assert!(first.contains(3.5) && first.width() < 1e-13, "{first:?}");
    let ends = chain.enclose(4.0f64.next_down(), 4.5).point[1];
    assert!((ends.lo() - 6.0).abs() < 1e-13 && (ends.hi() - 9.0).abs() < 1e-13, "{ends:?}");
}

#[test]
fn every_parameter_finds_its_piece() {
    // With steps from 1e-9 to 1, most stretches are empty, and one is crowded.
    let steps: Vec<f64> =
        (0..400).map(|k| if k % 7 == 0 { 1.0 } else { 10f64.powi(-(k / 3 % 10)) }).collect();
    let mut at = 0.0;
    let pieces: Vec<_> = steps
        .iter()
        .map(|step| {
            let from = at;
            at += step;
            (line([from, 0.0], [at, 0.0]), at)
        })
        .collect();
    let chain = Piecewise::new(0.0, pieces.clone()).unwrap();
    for (k, (_, end)) in pieces.iter().enumerate() {
        assert_eq!(chain.piece_at(*end), (k + 1).min(399));
        assert_eq!(chain.piece_at(end.next_down()), k);
    }
}

/// A reversal has a sine of zero and is a corner nevertheless.
#[test]
fn a_corner_is_a_jump_of_the_tangent() {
    let points = [[0.0, 0.0], [1.0, 0.0], [2.0, 0.001], [3.0, 0.002], [1.0, 0.0]];
    let pieces = points.windows(2).enumerate().map(|(k, p)| (line(p[0], p[1]), (k + 1) as f64));
    let chain = Piecewise::new(0.0, pieces).unwrap();
    let corners = |sine: f64| -> Vec<f64> {
        chain.breaks().iter().copied().filter(|t| chain.has_corner(*t, sine)).collect()
    };
    assert_eq!(corners(1e-2), [3.0]);
    assert_eq!(corners(1e-4), [1.0, 3.0]);
}

#[test]
fn broken_chains_are_refused_with_the_index_of_the_fault() {
    let unit = line([0.0, 0.0], [1.0, 0.0]);
    let next = |x: f64| line([x, 0.0], [2.0, 0.0]);
    assert_eq!(Piecewise::new(0.0, []), Err(PiecewiseError::Empty));
    assert_eq!(Piecewise::new(0.0, [(unit, 0.0)]), Err(PiecewiseError::Parameter { index: 1 }));
    assert_eq!(Piecewise::new(f64::NAN, [(unit, 1.0)]), Err(PiecewiseError::Parameter { index: 0 }));
    assert_eq!(Piecewise::new(0.0, [(unit, f64::NAN)]), Err(PiecewiseError::Parameter { index: 1 }));
    assert_eq!(Piecewise::new(0.0, [(unit, f64::INFINITY)]), Err(PiecewiseError::Parameter { index: 1 }));
    let gap = Piecewise::new(0.0, [(unit, 1.0), (next(1.5), 2.0)]);
    assert_eq!(gap, Err(PiecewiseError::Gap { index: 1, gap_mm: 0.5 }));
    let near = Piecewise::new(0.0, [(unit, 1.0), (next(1.0 + 1e-14), 2.0)]).unwrap();
    assert_eq!(near.point(1.0).x, 1.0);
    let far = Point2::new(0.0, 1e61);
    assert_eq!(Bezier::polynomial(&[far, far]), Err(BezierError::Point { index: 0 }));
    assert_eq!(Bezier::polynomial(&[far]), Err(BezierError::Degree { points: 1 }));
    let p = [Point2::origin(); 2];
    let fault = |weights: &[f64]| Bezier::rational(&p, weights).unwrap_err();
    assert_eq!(fault(&[1.0]), BezierError::Weights(WeightError::Count { found: 1, expected: 2 }));
    assert_eq!(fault(&[1.0, -1.0]), BezierError::Weights(WeightError::Range { index: 1, weight: -1.0 }));
    let ratio = WeightError::Ratio { index: 0, weight: 1e-7, largest: 1.0 };
    assert_eq!(fault(&[1e-7, 1.0]), BezierError::Weights(ratio));
}

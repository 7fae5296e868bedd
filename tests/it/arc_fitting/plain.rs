//! Finds the least number of elements over many points by a second, plain implementation. The fit must find
//! the same number.
//!
//! The plain implementation tries every pair of points. Only pairs with more than [`LONGER`] times as many
//! points between them as the longest possible element are left out. The arcs between the two points differ
//! in one number, the angle by which they turn. The arcs that pass a third point within the tolerance form a
//! range of this angle. At the ends of the range, an arc touches the circle about the third point whose
//! radius is the tolerance. These arcs are roots of a quadratic equation.
//!
//! The fit leaves out many more pairs. The comparison shows that these pairs do not change the number.

use nalgebra::Vector2;
use toolpathd_core::geometry::arc_fit::{Fit, Joints, LARGEST_RADIUS_MM, Method};

use super::inputs::{Random, polar, walk};
use super::way::{WIDEST, Way};
use super::{fitted, judge, least};

/// Allowance for rounding of distances, mm.
const ROUNDING_MM: f64 = 1e-10;

/// A deviation that is nearer to the tolerance than this, mm, leaves undecided whether an element is
/// possible.
const UNDECIDED_MM: f64 = 1e-8;

/// Steps of the sweep on each side of a chord, to find an arc that passes the points in order.
const ORDERS: usize = 24;

/// Spans of more points than this multiple of the longest possible span so far are not tried.
const LONGER: f64 = 2.0;

/// Points of the longest possible span before any is found.
const LEAST_LONGEST: usize = 24;

/// Whether an element from the first point to the last passes all points in order within the tolerance.
fn is_possible(points: &[Vector2<f64>], tolerance: f64) -> bool {
    let [from, to] = [points[0], points[points.len() - 1]];
    if points.len() == 2 || from == to {
        return points.len() == 2;
    }
    let line = Way::line(from, to);
    if points.iter().all(|p| line.distance(*p) <= tolerance) && line.passes(points, tolerance) {
        return true;
    }
    let half = 0.5 * (to - from).norm();
    let flattest = 2.0 * (half / LARGEST_RADIUS_MM).asin();
    [[-WIDEST, -flattest], [flattest, WIDEST]].into_iter().any(|side| {
        let range = points[1..points.len() - 1]
            .iter()
            .try_fold(side, |range, p| narrowed(range, [from, to], *p, tolerance));
        range.is_some_and(|[low, high]| {
            let arc = |k: usize| Way::arc(from, to, low + (high - low) * k as f64 / ORDERS as f64);
            [ORDERS / 2]
                .into_iter()
                .chain(0..=ORDERS)
                .map(arc)
                .any(|arc| arc.winds(points) && arc.passes(points, tolerance + ROUNDING_MM))
        })
    })
}

/// The part of a range of sweeps whose arcs pass within the tolerance of the point `p`. On one side of a
/// chord the part is one range again. `None` if no arc passes near.
fn narrowed(
    [low, high]: [f64; 2],
    [from, to]: [Vector2<f64>; 2],
    p: Vector2<f64>,
    tolerance: f64,
) -> Option<[f64; 2]> {
    let is_near = |sweep: f64| Way::arc(from, to, sweep).distance(p) <= tolerance + ROUNDING_MM;
    if is_near(low) && is_near(high) {
        return Some([low, high]);
    }
    let mut borders: Vec<f64> =
        touching([from, to], p, tolerance).into_iter().filter(|s| low < *s && *s < high).collect();
    borders.extend([low, high]);
    borders.sort_by(f64::total_cmp);
    let near: Vec<_> = borders.windows(2).filter(|pair| is_near(0.5 * (pair[0] + pair[1]))).collect();
    Some([near.first()?[0], near.last()?[1]])
}

/// The sweeps of the four arcs through both places whose circles touch the circle of radius `e` about `p`.
fn touching([from, to]: [Vector2<f64>; 2], p: Vector2<f64>, e: f64) -> [f64; 4] {
    let half = 0.5 * (to - from);
    let (l, d) = (half.norm(), p - from - half);
    let (x, y) = (d.dot(&half) / l, half.perp(&d) / l);
    // With the centre c above the chord, |p - c| = r +- e and r^2 = l^2 + c^2: (k - 2 y c)^2 = 4 e^2 (l^2 +
    // c^2).
    let k = x * x + y * y - l * l - e * e;
    let [a, b, rest] = [4.0 * (y * y - e * e), -4.0 * k * y, k * k - 4.0 * e * e * l * l];
    let root = (b * b - 4.0 * a * rest).max(0.0).sqrt();
    let q = -0.5 * (b + root.copysign(b));
    let sweeps = [q / a, rest / q].map(|c| {
        // A circle has two arcs over the chord. The short arc turns counterclockwise if the centre is to the
        // left.
        let short = 2.0 * l.atan2(c.abs()) * c.signum();
        [short, short - 2.0 * std::f64::consts::PI * c.signum()]
    });
    [sweeps[0][0], sweeps[0][1], sweeps[1][0], sweeps[1][1]]
}

/// The least number of elements. Spans far longer than the longest possible span are not tried.
fn count(points: &[Vector2<f64>], tolerance: f64) -> usize {
    let (n, mut longest) = (points.len(), LEAST_LONGEST);
    let mut rows: Vec<Vec<bool>> = Vec::new();
    for from in 0..n {
        let mut row = vec![false];
        while from + row.len() < n && row.len() as f64 <= LONGER * longest as f64 {
            let length = row.len();
            row.push(is_possible(&points[from..=from + length], tolerance));
            longest = longest.max(if row[length] { length } else { 0 });
        }
        rows.push(row);
    }
    least(n, |[from, to]| rows[from].get(to - from) == Some(&true))
}

/// Fails unless the fit has the least number of elements. Returns this number and that of the greedy method.
fn compared(name: &str, points: &[Vector2<f64>], tolerance: f64) -> [usize; 2] {
    let request = Fit { joints: Joints::OnPoints, ..Fit::within(tolerance) };
    let found = judge(points, &fitted(points, &request), tolerance).unwrap();
    let greedy = fitted(points, &Fit { method: Method::Greedy, ..request });
    let greedy = judge(points, &greedy, tolerance).unwrap();
    println!("{name} within {tolerance}: {found} elements, {greedy} greedy");
    if count(points, tolerance) != found {
        let [most, least] = [tolerance - UNDECIDED_MM, tolerance + UNDECIDED_MM].map(|e| count(points, e));
        assert!(
            (least..=most).contains(&found),
            "{name} within {tolerance} mm: the fit has {found} elements, not {least}..={most}"
        );
    }
    [found, greedy]
}

const N: usize = 1000;

fn sampled(curve: impl Fn(f64) -> Vector2<f64>) -> Vec<Vector2<f64>> {
    (0..N).map(|k| curve(k as f64 / (N - 1) as f64)).collect()
}

#[test]
fn the_fit_of_a_sine_has_the_least_number_of_elements() {
    let points = sampled(|t| Vector2::new(6.0 * t, (6.0 * t).sin()));
    for tolerance in [3e-5, 2e-6] {
        compared("sine", &points, tolerance);
    }
}

#[test]
fn the_fit_of_a_rounded_sine_has_the_least_number_and_fewer_than_the_greedy_method() {
    let points = sampled(|t| Vector2::new(6.0 * t, (6.0 * t).sin()).map(|c| (c * 1e3).round() / 1e3));
    let [found, greedy] = compared("rounded sine", &points, 5.2e-4);
    assert!(found < greedy, "{found} elements, {greedy} by the greedy method");
}

#[test]
fn the_fit_of_a_spiral_has_the_least_number_of_elements() {
    let points = sampled(|t| polar(1.0 + 2.0 * t, 12.0 * t));
    for tolerance in [1e-4, 1e-5] {
        compared("spiral", &points, tolerance);
    }
}

#[test]
fn the_fit_of_a_noisy_circle_has_the_least_number_and_fewer_than_the_greedy_method() {
    let mut random = Random::stream(2);
    // The elements are long: more points would take too long, because all pairs are tried.
    let n = N / 2;
    let points: Vec<_> =
        (0..n).map(|k| polar(20.0 + random.between(-2e-3, 2e-3), 6.0 * k as f64 / n as f64)).collect();
    for tolerance in [1.9e-3, 2.05e-3] {
        let [found, greedy] = compared("noisy circle", &points, tolerance);
        assert!(found < greedy, "{found} elements, {greedy} by the greedy method");
    }
}

#[test]
fn the_fit_of_a_random_walk_has_the_least_number_of_elements() {
    let mut random = Random::stream(3);
    for (turn, tolerance) in [(0.05, 0.05), (0.3, 0.2), (3.0, 0.8)] {
        compared("walk", &walk(N, 1.0, turn, &mut random), tolerance);
    }
}

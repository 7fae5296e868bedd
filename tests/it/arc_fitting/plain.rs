//! The least number of elements over many points by a plain second implementation: the arcs near a point end
//! at those that touch the circle about it, which are the roots of a quadratic equation, and every pair of
//! points is tried. What the fitting leaves out by bounds, fans and witnesses must not have mattered.

use nalgebra::Vector2;
use toolpathd::geometry::arc_fit::{Fit, Joints, LARGEST_RADIUS_MM, Method};

use super::inputs::{Random, polar, walk};
use super::way::{WIDEST, Way};
use super::{fitted, judge, least};

/// Rounding of distances, mm.
const ROUNDING_MM: f64 = 1e-10;

/// Deviations this near to the tolerance decide nothing, mm.
const UNDECIDED_MM: f64 = 1e-8;

/// Arcs of each side tried for one that passes the points in order.
const ORDERS: usize = 24;

/// Rows of pairs end where spans are so many times as long as the longest one so far.
const LONGER: f64 = 2.0;
const LEAST_LONGEST: usize = 24;

/// Whether an element from the first point to the last passes all within the tolerance and in order.
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

/// The sweeps of a range on one side of the chord whose arcs are near a point; these are one range again.
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

/// The sweeps of the arcs of all circles through both places that touch the circle about `p`.
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
        // The circle's two arcs: counterclockwise where the centre is to the left of a short one.
        let short = 2.0 * l.atan2(c.abs()) * c.signum();
        [short, short - 2.0 * std::f64::consts::PI * c.signum()]
    });
    [sweeps[0][0], sweeps[0][1], sweeps[1][0], sweeps[1][1]]
}

/// The least number of elements, of all spans that are not longer than the longest possible ones by far.
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

/// Fails unless the fit takes the least number; gives it, with that of the greedy one.
fn compared(name: &str, points: &[Vector2<f64>], tolerance: f64) -> [usize; 2] {
    let request = Fit { joints: Joints::OnPoints, ..Fit::within(tolerance) };
    let found = judge(points, &fitted(points, &request), tolerance).unwrap();
    let greedy = fitted(points, &Fit { method: Method::Greedy, ..request });
    let greedy = judge(points, &greedy, tolerance).unwrap();
    println!("{name} within {tolerance}: {found} elements, {greedy} greedy");
    if count(points, tolerance) != found {
        let [most, least] = [tolerance - UNDECIDED_MM, tolerance + UNDECIDED_MM].map(|e| count(points, e));
        assert!((least..=most).contains(&found), "{name} within {tolerance}: {found}, not {least}..={most}");
    }
    [found, greedy]
}

const N: usize = 1000;

fn sampled(curve: impl Fn(f64) -> Vector2<f64>) -> Vec<Vector2<f64>> {
    (0..N).map(|k| curve(k as f64 / (N - 1) as f64)).collect()
}

#[test]
fn a_sine_takes_the_least_number() {
    let points = sampled(|t| Vector2::new(6.0 * t, (6.0 * t).sin()));
    for tolerance in [3e-5, 2e-6] {
        compared("sine", &points, tolerance);
    }
}

#[test]
fn a_rounded_sine_takes_the_least_number_and_fewer_than_greedy() {
    let points = sampled(|t| Vector2::new(6.0 * t, (6.0 * t).sin()).map(|c| (c * 1e3).round() / 1e3));
    let [found, greedy] = compared("rounded sine", &points, 5.2e-4);
    assert!(found < greedy);
}

#[test]
fn a_spiral_takes_the_least_number() {
    let points = sampled(|t| polar(1.0 + 2.0 * t, 12.0 * t));
    for tolerance in [1e-4, 1e-5] {
        compared("spiral", &points, tolerance);
    }
}

#[test]
fn a_noisy_circle_takes_the_least_number_and_fewer_than_greedy() {
    let mut random = Random::stream(2);
    // Long elements: all pairs of more points take too long.
    let n = N / 2;
    let points: Vec<_> =
        (0..n).map(|k| polar(20.0 + random.between(-2e-3, 2e-3), 6.0 * k as f64 / n as f64)).collect();
    for tolerance in [1.9e-3, 2.05e-3] {
        let [found, greedy] = compared("noisy circle", &points, tolerance);
        assert!(found < greedy);
    }
}

#[test]
fn random_walks_take_the_least_number() {
    let mut random = Random::stream(3);
    for (turn, tolerance) in [(0.05, 0.05), (0.3, 0.2), (3.0, 0.8)] {
        compared("walk", &walk(N, 1.0, turn, &mut random), tolerance);
    }
}

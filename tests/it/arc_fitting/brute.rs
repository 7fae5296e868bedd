//! Finds the least number of elements by brute force. [`Fit`] with joints on the points must find the same
//! number.
//!
//! 1. For every pair of points, the line and many arcs between the two points are tried. A search between
//!    neighbouring arcs finds the arcs that come nearest to the points between.
//! 2. Dynamic programming finds the shortest chain of pairs between which an element is possible.

use nalgebra::Vector2;
use toolpathd_core::geometry::arc_fit::{Fit, Joints, LARGEST_RADIUS_MM, Measure};

use super::inputs::{KINDS, Random, few};
use super::way::{WIDEST, Way, order_deviation};
use super::{fitted, judge, least};

/// Sampled sweeps on each side of a chord. A search for the least deviation starts from each local minimum.
const SWEEPS: usize = 60;

/// Sweeps tried in each range of sweeps within the tolerance, to find an arc that passes the points in order.
const ORDERS: usize = 48;

/// Least radius of an arc in a fit to a polyline, as a multiple of the tolerance. The fit has the same limit.
const LEAST_RADIUS_TOLERANCES: f64 = 2.0;

/// A deviation that is nearer to the tolerance than this, mm, leaves undecided whether an element is
/// possible.
const UNDECIDED_MM: f64 = 1e-6;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Verdict {
    Possible,
    Undecided,
    Impossible,
}

/// The candidates over one chord: a line, and arcs on both sides.
struct Pair<'a> {
    points: &'a [Vector2<f64>],
    /// On each side, sweeps (rad) by rising size, each with the largest distance of a point from its arc
    /// (mm).
    sides: [Vec<(f64, f64)>; 2],
}

impl<'a> Pair<'a> {
    fn new(points: &'a [Vector2<f64>]) -> Self {
        let [from, to] = [points[0], points[points.len() - 1]];
        let mut pair = Self { points, sides: [Vec::new(), Vec::new()] };
        if from == to {
            return pair;
        }
        let flattest = 2.0 * (0.5 * (to - from).norm() / LARGEST_RADIUS_MM).asin();
        pair.sides = [-1.0, 1.0].map(|side| {
            let sweep = |k: usize| side * (flattest + (WIDEST - flattest) * k as f64 / SWEEPS as f64);
            let at = |sweep: f64| (sweep, pair.distance(sweep));
            let mut samples: Vec<_> = (0..=SWEEPS).map(|k| at(sweep(k))).collect();
            let lows = |k: &usize| {
                let beside =
                    [k.wrapping_sub(1), k + 1].map(|j| samples.get(j).map_or(f64::INFINITY, |s| s.1));
                beside.iter().all(|d| samples[*k].1 <= *d)
            };
            let least: Vec<_> = (0..=SWEEPS)
                .filter(lows)
                .map(|k| {
                    let range = [k.saturating_sub(1), (k + 1).min(SWEEPS)].map(|j| samples[j].0);
                    golden(range, |sweep| pair.distance(sweep))
                })
                .collect();
            samples.extend(least);
            samples.sort_by(|a, b| a.0.abs().total_cmp(&b.0.abs()));
            samples
        });
        pair
    }

    fn way(&self, sweep: f64) -> Way {
        let [from, to] = [self.points[0], self.points[self.points.len() - 1]];
        if sweep == 0.0 { Way::line(from, to) } else { Way::arc(from, to, sweep) }
    }

    fn distance(&self, sweep: f64) -> f64 {
        let way = self.way(sweep);
        self.points.iter().map(|p| way.distance(*p)).fold(0.0, f64::max)
    }

    /// The deviation of the element with this sweep by the measure, mm. It is infinite for an arc that is too
    /// small at this `tolerance` to replace lines.
    fn off(&self, sweep: f64, measure: Measure, tolerance: f64) -> f64 {
        let way = self.way(sweep);
        match (measure, way) {
            (Measure::Polyline, Way::Arc { radius, .. }) if radius < LEAST_RADIUS_TOLERANCES * tolerance => {
                f64::INFINITY
            }
            (Measure::Polyline, _) => order_deviation(&way, self.points).max(way.dip(self.points)),
            (Measure::Points, _) => order_deviation(&way, self.points),
        }
    }

    /// Whether some element over the chord passes the points in order within the tolerance. By the measure
    /// [`Measure::Polyline`], the lines between the points must be near the element too.
    fn verdict(&self, tolerance: f64, measure: Measure) -> Verdict {
        if self.points.len() == 2 {
            return Verdict::Possible;
        }
        if self.sides[0].is_empty() {
            return Verdict::Impossible;
        }
        let [surely, maybe] = [tolerance - UNDECIDED_MM, tolerance + UNDECIDED_MM];
        let off = |sweep: f64| self.off(sweep, measure, tolerance);
        let mut best = if self.distance(0.0) <= maybe { off(0.0) } else { f64::INFINITY };
        for range in self.sides.iter().flat_map(|side| self.ranges(side, maybe)) {
            if best <= surely {
                return Verdict::Possible;
            }
            let place = |k: f64| range[0] + (range[1] - range[0]) * k / ORDERS as f64;
            let mut nearest = (0.0, f64::INFINITY);
            for k in 0..=ORDERS {
                let here = off(place(k as f64));
                if here < nearest.1 {
                    nearest = (k as f64, here);
                }
                if here <= surely {
                    return Verdict::Possible;
                }
            }
            let beside = [(nearest.0 - 1.0).max(0.0), (nearest.0 + 1.0).min(ORDERS as f64)].map(place);
            best = best.min(nearest.1).min(golden(beside, off).1);
        }
        match best {
            best if best <= surely => Verdict::Possible,
            best if best <= maybe => Verdict::Undecided,
            _ => Verdict::Impossible,
        }
    }

    /// The ranges of sweeps whose arcs have every point within `tolerance` (mm). Samples find the ranges, and
    /// bisection between samples finds their ends.
    fn ranges(&self, side: &[(f64, f64)], tolerance: f64) -> Vec<[f64; 2]> {
        let border = |mut out: f64, mut within: f64| {
            for _ in 0..50 {
                let middle = 0.5 * (out + within);
                (out, within) =
                    if self.distance(middle) <= tolerance { (out, middle) } else { (middle, within) };
            }
            within
        };
        let mut ranges: Vec<[f64; 2]> = Vec::new();
        for (k, &(sweep, off)) in side.iter().enumerate() {
            if off > tolerance {
                continue;
            }
            match k.checked_sub(1).map(|j| side[j]) {
                Some((_, before)) if before <= tolerance => {}
                Some((out, _)) => ranges.push([border(out, sweep); 2]),
                None => ranges.push([sweep; 2]),
            }
            let end = match side.get(k + 1) {
                Some(&(out, after)) if after > tolerance => border(out, sweep),
                _ => sweep,
            };
            ranges.last_mut().unwrap()[1] = end;
        }
        ranges
    }
}

/// Golden-section search: the place in a range at which a function is least, and its value there.
fn golden([mut low, mut high]: [f64; 2], f: impl Fn(f64) -> f64) -> (f64, f64) {
    let ratio = 0.5 * (5f64.sqrt() - 1.0);
    let (mut a, mut b) = (high - ratio * (high - low), low + ratio * (high - low));
    let (mut at_a, mut at_b) = (f(a), f(b));
    for _ in 0..36 {
        if at_a <= at_b {
            (high, b, at_b) = (b, a, at_a);
            a = high - ratio * (high - low);
            at_a = f(a);
        } else {
            (low, a, at_a) = (a, b, at_b);
            b = low + ratio * (high - low);
            at_b = f(b);
        }
    }
    if at_a <= at_b { (a, at_a) } else { (b, at_b) }
}

/// The chord of every pair of points. Row `from` begins with the chord to the next point.
fn pairs(points: &[Vector2<f64>]) -> Vec<Vec<Pair<'_>>> {
    let n = points.len();
    (0..n).map(|from| (from + 1..n).map(|to| Pair::new(&points[from..=to])).collect()).collect()
}

/// The least number of elements if undecided pairs count as possible, and the least number if they count as
/// impossible.
fn allowed(pairs: &[Vec<Pair>], tolerance: f64, measure: Measure) -> [usize; 2] {
    let verdict = |pair: &Pair| pair.verdict(tolerance, measure);
    let verdicts: Vec<Vec<Verdict>> = pairs.iter().map(|row| row.iter().map(verdict).collect()).collect();
    [Verdict::Impossible, Verdict::Undecided].map(|refused| {
        least(pairs.len(), |[from, to]| {
            let verdict = verdicts[from][to - from - 1];
            verdict != Verdict::Impossible && verdict != refused
        })
    })
}

/// Inputs of each kind of points.
const INPUTS: usize = 20;

#[test]
fn a_fit_of_few_points_has_as_few_elements_as_brute_force_finds() {
    let mut random = Random::stream(1);
    let (mut compared, mut undecided, mut wrong) = (0, 0, Vec::new());
    for kind in KINDS {
        for _ in 0..INPUTS {
            let noise = [0.003, 0.03, 0.3][random.below(3)];
            let points = few(kind, noise, &mut random);
            let pairs = pairs(&points);
            for part in [0.513, 1.071, 2.137] {
                for measure in [Measure::Points, Measure::Polyline] {
                    let request = Fit { joints: Joints::OnPoints, measure, ..Fit::within(part * noise) };
                    let tolerance = request.tolerance_mm;
                    let [least, most] = allowed(&pairs, tolerance, measure);
                    let count = judge(&points, &fitted(&points, &request), tolerance);
                    compared += 1;
                    undecided += usize::from(least < most);
                    if !count.as_ref().is_ok_and(|count| (least..=most).contains(count)) {
                        wrong.push(format!(
                            "{kind:?} {measure:?} within {tolerance}: {count:?} elements, brute force {least}..={most}\n{points:?}"
                        ));
                    }
                }
            }
        }
    }
    assert!(undecided * 50 < compared, "{undecided} of {compared} comparisons are undecided");
    assert!(wrong.is_empty(), "{} of {compared} fits are wrong:\n{}", wrong.len(), wrong.join("\n"));
}

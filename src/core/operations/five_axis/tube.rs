//! Rails of few spans and least jerk inside the tolerance tube, for data with noise or rounding.
//!
//! # Method
//! A run of stations gets a B-spline of degree 5 on single knots, so that four derivatives are continuous.
//! Its parameter grows by the length of the legs.
//! 1. Among all splines that stay within the tolerance of the stations, the one of the least integral of the
//!    squared third derivative is found (`least_jerk`).
//! 2. The spline is proved against the legs. Where it leaves the tolerance, there are more knots, placed so
//!    that all spans miss alike, and step 1 begins anew.
//!
//! # Guarantees
//! * At equal parameters the tip of the spline is within `tip_mm` of the legs. So the legs are within the
//!   same distance of the spline.
//! * The axis of the spline is within the tolerance of the axis that the path has at the nearest place.
//! * Both bounds are proved for every span.
//! * The ends of the run are hit exactly.
//!
//! # Degenerate input
//! A run for which no spline is found gets none; the caller interpolates it.
//!
//! # Cost
//! O(n log n) for n stations in each round; `MOST_ROUNDS` limits the rounds.
//!
//! # Reference
//! C. de Boor, *A Practical Guide to Splines*, Springer, 2001, chapter XIV, for the smoothing spline.

mod least_jerk;
#[cfg(test)]
mod tests;

use super::deviation::{Deviation, of_span};
use super::leg::Leg;
use super::rail::{Fitted, Point6, Source, Span, tip};
use crate::budget::{Budget, Stopped};
use least_jerk::{FitPoint, Problem};

/// Rounds of placing knots, at most.
const MOST_ROUNDS: usize = 60;

/// What a span misses by counts with this factor, and within these bounds, when knots are placed: a round may
/// double the knots at a place.
const AHEAD: f64 = 1.1;
const LEAST: f64 = 0.2;
const MOST: f64 = 64.0;

/// The spline is searched within this part of the tolerance. Between its fit points it may use the rest.
const AIM: f64 = 0.96;

/// No span is shorter than this part of the shortest leg it touches.
const SHORTEST: f64 = 0.2;

/// Targets of a leg for each span on it.
const TARGETS: f64 = 4.0;
const MOST_TARGETS: usize = 64;

/// The spline of a run, with the bound of its deviation.
pub struct Tube {
    pub spans: Vec<Fitted>,
    pub deviation: Deviation,
}

/// The spline for the legs of a path from `first` up to `last`; none if none is found within the tolerance.
pub fn fit(
    path: &[Leg],
    [first, last]: [usize; 2],
    within: Deviation,
    budget: &Budget,
) -> Result<Option<Tube>, Stopped> {
    let legs = &path[first..last];
    let joints = joints(legs);
    let whole = joints[joints.len() - 1];
    let mut knots = vec![0.0, whole];
    for _ in 0..MOST_ROUNDS {
        budget.check()?;
        let problem = Problem {
            knots: &knots,
            fit_points: fit_points(legs, &joints, &knots),
            ends: [legs[0].start, legs[legs.len() - 1].end],
            radii: [AIM * within.tip_mm, AIM * within.axis * super::rail::top(&legs[0].start).norm()],
        };
        let Some(spline) = problem.solve_with_few(budget)? else { return Ok(None) };
        let mut excess: Vec<f64> = problem.excess(&spline);
        let mut deviation = Deviation::NONE;
        if excess.iter().all(|excess| *excess <= 1.0 / AIM) {
            for (own, span) in excess.iter_mut().zip(&spline) {
                let found = proved(span, path, [first, last], &joints, within);
                *own = found.of(within);
                deviation = deviation.max(found);
            }
        }
        let worst = excess.iter().copied().fold(0.0, f64::max);
        if worst <= 1.0 {
            let spans = spline.into_iter().map(|span| {
                let legs = touched(&span, &joints).map(|leg| leg + first);
                Fitted { span, source: Source::Run(legs) }
            });
            return Ok(Some(Tube { spans: spans.collect(), deviation }));
        }
        let Some(finer) = finer(&knots, &excess, legs, &joints) else { return Ok(None) };
        knots = finer;
    }
    Ok(None)
}

/// The parameters of the stations.
fn joints(legs: &[Leg]) -> Vec<f64> {
    let mut sum = 0.0;
    let ends = legs.iter().map(|leg| {
        sum += leg.length;
        sum
    });
    std::iter::once(0.0).chain(ends).collect()
}

/// Places that the spline has to be near to, in order, without its ends.
fn fit_points(legs: &[Leg], joints: &[f64], knots: &[f64]) -> Vec<FitPoint> {
    // The number of spans before a parameter, with their fractions.
    let spans_before = |u: f64| {
        let k = knots.partition_point(|knot| *knot <= u).clamp(1, knots.len() - 1) - 1;
        k as f64 + (u - knots[k]) / (knots[k + 1] - knots[k])
    };
    let mut fit_points = Vec::new();
    for (leg, ends) in legs.iter().zip(joints.windows(2)) {
        let spans = spans_before(ends[1]) - spans_before(ends[0]);
        let count = ((TARGETS * spans).ceil() as usize).clamp(1, MOST_TARGETS);
        for n in 1..=count {
            let part = n as f64 / count as f64;
            fit_points.push(FitPoint { u: ends[0] + part * (ends[1] - ends[0]), at: leg.at(part) });
        }
    }
    fit_points.pop();
    fit_points
}

/// The first and the last leg that a span touches.
fn touched(span: &Span, joints: &[f64]) -> [usize; 2] {
    let last = joints.len() - 2;
    let first = joints.partition_point(|u| *u <= span.from).saturating_sub(1).min(last);
    let end = joints.partition_point(|u| *u < span.to).saturating_sub(1).min(last);
    [first, end.max(first)]
}

/// The bound of the deviation of a span from the legs at the same parameters.
fn proved(span: &Span, path: &[Leg], run: [usize; 2], joints: &[f64], enough: Deviation) -> Deviation {
    let legs = &path[run[0]..run[1]];
    let [first, last] = touched(span, joints);
    let mut all = Deviation::NONE;
    let mut rest = span.clone();
    for k in first..=last {
        let part = if k < last {
            let [part, after] = rest.split(joints[k + 1]);
            rest = after;
            part
        } else {
            rest.clone()
        };
        if part.length() <= 0.0 {
            continue;
        }
        let leg = &legs[k];
        let place = |u: f64| ((u - joints[k]) / (joints[k + 1] - joints[k])).clamp(0.0, 1.0);
        let axis = of_span(&part, &[*leg], enough).axis;
        let tip_mm = apart(&part, [leg.at(place(part.from)), leg.at(place(part.to))], HALVINGS);
        // The tip may be ahead or behind by its deviation: the nearest place then is beside the leg.
        all = all.max(Deviation { tip_mm, axis: axis + beside(path, run[0] + k, tip_mm) });
    }
    all
}

/// How far the axis of the path turns within a distance before or after a leg, radians.
fn beside(legs: &[Leg], k: usize, distance_mm: f64) -> f64 {
    let turned = |legs: &mut dyn Iterator<Item = &Leg>| {
        let (mut left, mut sum) = (distance_mm, 0.0);
        for leg in legs {
            sum += leg.angle * (left / leg.length).min(1.0);
            left -= leg.length;
            if left <= 0.0 {
                break;
            }
        }
        sum
    };
    turned(&mut legs[k + 1..].iter()).max(turned(&mut legs[..k].iter().rev()))
}

/// Halvings of a part for the bound of its distance.
const HALVINGS: usize = 3;

/// Bound of the distance of the tip from a line at equal parameters, mm.
fn apart(part: &Span, ends: [Point6; 2], halvings: usize) -> f64 {
    let line = Span::line(part.from, part.to, ends[0], ends[1]);
    let apart = part.control.iter().zip(&line.control).map(|(a, b)| (tip(a) - tip(b)).norm());
    let bound = apart.clone().fold(0.0, f64::max);
    let seen = (tip(&part.start()) - tip(&ends[0])).norm().max((tip(&part.end()) - tip(&ends[1])).norm());
    if halvings == 0 || bound <= 1.01 * seen {
        return bound;
    }
    let middle = (ends[0] + ends[1]) * 0.5;
    let [one, other] = part.halves();
    apart_of_halves([&one, &other], [ends[0], middle, ends[1]], halvings - 1).min(bound)
}

fn apart_of_halves(halves: [&Span; 2], ends: [Point6; 3], halvings: usize) -> f64 {
    apart(halves[0], [ends[0], ends[1]], halvings).max(apart(halves[1], [ends[1], ends[2]], halvings))
}

/// More knots, placed so that all spans miss alike; none where a span becomes too short. The error of a span
/// shrinks with the sixth power of its length.
fn finer(knots: &[f64], excess: &[f64], legs: &[Leg], joints: &[f64]) -> Option<Vec<f64>> {
    let shares: Vec<f64> =
        excess.iter().map(|own| (AHEAD * own).clamp(LEAST, MOST).powf(1.0 / 6.0)).collect();
    let sum: f64 = shares.iter().sum();
    let count = (sum.ceil() as usize).clamp(excess.len() + 1, 2 * excess.len() + 1);
    let mut finer = vec![knots[0]];
    let (mut k, mut before) = (0, 0.0);
    for n in 1..count {
        let wanted = sum * n as f64 / count as f64;
        while before + shares[k] < wanted && k + 1 < shares.len() {
            before += shares[k];
            k += 1;
        }
        let part = ((wanted - before) / shares[k]).clamp(0.0, 1.0);
        finer.push(knots[k] + part * (knots[k + 1] - knots[k]));
    }
    finer.push(knots[knots.len() - 1]);
    let is_long = |pair: &[f64]| {
        let span = Span::line(pair[0], pair[1], Point6::zeros(), Point6::zeros());
        let [first, last] = touched(&span, joints);
        let shortest = legs[first..=last].iter().map(|leg| leg.length).fold(f64::INFINITY, f64::min);
        pair[1] - pair[0] >= SHORTEST * shortest
    };
    finer.windows(2).all(is_long).then_some(finer)
}

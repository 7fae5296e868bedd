//! Proves that a motion keeps its limits at every place of a piece.
//!
//! # Method
//! 1. In each interval of the motion and on each span, balls enclose the Taylor coefficients of tip and axis.
//!    The kinematics of the machine turns them into balls around the coefficients of all axes
//!    ([`Machine::coefficients`]).
//! 2. These bound the use of the limits over the interval ([`Schedule::slowdown_for`]).
//! 3. An interval whose bound is far above what is used in the middle of any interval is halved.
//!
//! # Guarantees
//! No limit is exceeded after the motion is slowed by the factor of the proof. On a span that goes straight
//! through a pole, the part of the axis across the pole is divided by the way from it (`passage`), and the
//! proof covers the pole. Where the axis passes a pole otherwise, rotary axes turn without bound and nothing
//! is proved; there the limits are checked at single places, and the proof is not complete.
//!
//! # Cost
//! Constant for each interval; up to `DEEPEST` halvings at a pole.
//!
//! # Reference
//! R. E. Moore, R. B. Kearfott, M. J. Cloud, *Introduction to Interval Analysis*, SIAM, 2009, for Taylor
//! coefficients over ranges.

use nalgebra::Point3;

use super::{Axes, Path, STILL};
use crate::budget::{Budget, Stopped};
use crate::machine::{AxisPositions, Ball, Inverse, Machine, Through};
use crate::operations::five_axis::rail::{Point6, tip, top};
use crate::operations::five_axis::schedule::{Course, Expansion, Schedule};
use crate::operations::five_axis::stations::pose;

/// A bound is near enough if it is at most this multiple of what is used.
const NEAR: f64 = 1.001;

/// The same after some halvings: beside a pole, balls shrink slowly.
const NEAR_IF_HALVED: f64 = 1.01;
const HALVED: u32 = 6;

/// Stations are added where the motion would have to be slowed by more than this factor.
const TIGHT: f64 = 1.003;

/// The most halvings of an interval. At a pole, nothing is proved over a millionth of an interval.
const DEEPEST: u32 = 20;

/// Orders 0 to 4.
const ORDERS: usize = 5;

/// What the limits need over a whole piece.
#[derive(Debug, Clone, PartialEq)]
pub struct Proof {
    /// The factor by which the motion has to be slowed to keep all limits; below 1, limits are left to spare.
    pub slowdown: f64,
    /// The intervals between stations that need more than `TIGHT`, in order.
    pub tight: Vec<usize>,
    /// The first place around which nothing is proved.
    pub gap: Option<Point3<f64>>,
}

impl Path<'_> {
    /// # Errors
    /// When the budget ends.
    pub fn proof(&self, schedule: &Schedule, axes: &Axes, budget: &Budget) -> Result<Proof, Stopped> {
        let mut proof = Proof { slowdown: 0.0, tight: Vec::new(), gap: None };
        let mut most_used = 0.0_f64;
        let (mut span, mut station) = (0, 0);
        let mut open = Vec::new();
        for (k, interval) in self.divided(schedule) {
            budget.check()?;
            let middle = 0.5 * (interval[0] + interval[1]);
            while self.piece.spans[span].to < middle && span + 1 < self.piece.spans.len() {
                span += 1;
            }
            while station + 2 < self.stations.len() && self.stations[station + 1].0 < middle {
                station += 1;
            }
            let mut needed = 0.0_f64;
            open.push((interval, 0));
            while let Some((range, depth)) = open.pop() {
                let of_span = &self.piece.spans[span];
                let expansions = self.expansions(span, range, self.stations[station].1, axes);
                if let Some((coordinates, paced)) = &expansions {
                    let found = schedule.slowdown_for(
                        k,
                        &Course {
                            range,
                            coordinates,
                            limits: &axes.limits,
                            tip: axes.tip.as_ref(),
                            paced,
                            feed: self.piece.feeds[span],
                        },
                    );
                    most_used = most_used.max(found.at_middle);
                    needed = needed.max(found.at_middle);
                    let near = if depth < HALVED { NEAR } else { NEAR_IF_HALVED };
                    if found.bound <= near * most_used.max(1.0) {
                        proof.slowdown = proof.slowdown.max(found.bound);
                        continue;
                    }
                }
                if depth < DEEPEST {
                    let middle = 0.5 * (range[0] + range[1]);
                    open.extend([([middle, range[1]], depth + 1), ([range[0], middle], depth + 1)]);
                } else {
                    let at = tip(&of_span.jet(range[0])[0]);
                    proof.gap.get_or_insert(Point3::from(at));
                }
            }
            if needed > TIGHT && proof.tight.last() != Some(&station) {
                proof.tight.push(station);
            }
        }
        proof.slowdown = proof.slowdown.max(most_used);
        Ok(proof)
    }

    /// The intervals of the motion, each divided at the ends of spans inside it.
    fn divided(&self, schedule: &Schedule) -> Vec<(usize, [f64; 2])> {
        let spans = &self.piece.spans;
        let mut ends = spans[..spans.len() - 1].iter().map(|span| span.to).peekable();
        let mut divided = Vec::with_capacity(spans.len());
        for (k, [mut from, to]) in schedule.intervals().enumerate() {
            while let Some(end) = ends.next_if(|end| *end < to) {
                if end > from {
                    divided.push((k, [from, end]));
                    from = end;
                }
            }
            divided.push((k, [from, to]));
        }
        divided
    }

    /// All coordinates and the point that moves at the feed, over a range inside a span. `None` where the
    /// range may touch the pole.
    pub(super) fn expansions(
        &self,
        span: usize,
        range: [f64; 2],
        joints: Option<AxisPositions>,
        axes: &Axes,
    ) -> Option<(Vec<Expansion>, [Expansion; 3])> {
        let (w, middle) = (0.5 * (range[1] - range[0]), 0.5 * (range[0] + range[1]));
        let about: [Point6; ORDERS + 1] = self.piece.spans[span].taylor(middle);
        let polynomial = |k: usize| of_polynomial(about.map(|c| c[k]), w);
        let paced = [0, 1, 2].map(|k| polynomial(if self.rests { k + 3 } else { k }));
        let tips = (0..3).map(polynomial);
        let (Some(machine), Some(joints)) = (self.machine, joints) else {
            return Some((tips.collect(), paced));
        };
        let mut all: Vec<Expansion> = if axes.limits.len() > 5 { tips.collect() } else { Vec::new() };
        let balls = [0, 1, 2, 3, 4, 5].map(|k| balls(about.map(|c| c[k]), w));
        let [x, y, z, i, j, l] = balls;
        let through = self.passages[span].as_ref().map(|passage| {
            let (across, way) = passage.taylor(middle);
            (Through { across: across.map(|about| self::balls(about, w)), way }, w)
        });
        match machine.coefficients([x, y, z], [i, j, l], through, &joints) {
            Some(own) => all.extend(own.map(of_balls)),
            None => all.extend(resting_on_pole(machine, &about, &balls[3..], joints, w)?),
        }
        Some((all, paced))
    }
}

/// The axes of a machine while the tool axis rests on the pole: the linear axes are an affine function of the
/// tip. `None` if the axis does not rest there.
fn resting_on_pole(
    machine: &Machine,
    about: &[Point6; ORDERS + 1],
    tops: &[[Ball; ORDERS]],
    joints: AxisPositions,
    w: f64,
) -> Option<[Expansion; 5]> {
    let turn = tops.iter().map(|top| top[1].most()).fold(0.0, f64::max) / top(&about[0]).norm();
    if turn > STILL || !matches!(machine.inverse(&pose(&about[0])), Inverse::Pole { .. }) {
        return None;
    }
    let at = |p| machine.at(&Point3::from(p), joints.rotary).linear_mm;
    let origin = at(nalgebra::Vector3::zeros());
    let linear = about.map(|c| at(tip(&c)));
    let still = Expansion::default();
    let axis = |k: usize| of_polynomial(linear.map(|c| c[k] - origin[k]), w);
    Some([axis(0), axis(1), axis(2), still, still])
}

/// A polynomial with these coefficients in the middle of a range of the half length `w`.
fn of_polynomial([_, c1, c2, c3, c4, c5]: [f64; ORDERS + 1], w: f64) -> Expansion {
    Expansion { middle: [c1, c2, c3, c4], error: 5.0 * c5.abs() * w }
}

fn of_balls([_, c1, c2, c3, c4]: [Ball; ORDERS]) -> Expansion {
    Expansion { middle: [c1.center, c2.center, c3.center, c4.center], error: c4.radius }
}

/// Balls around the Taylor coefficients at all places of a range of the half length `w`, from those in the
/// middle.
fn balls(about: [f64; ORDERS + 1], w: f64) -> [Ball; ORDERS] {
    /// The binomial coefficients "n of k" for k from 0 to 5.
    const BINOMIALS: [[f64; ORDERS + 1]; ORDERS] = [
        [1.0, 1.0, 1.0, 1.0, 1.0, 1.0],
        [0.0, 1.0, 2.0, 3.0, 4.0, 5.0],
        [0.0, 0.0, 1.0, 3.0, 6.0, 10.0],
        [0.0, 0.0, 0.0, 1.0, 4.0, 10.0],
        [0.0, 0.0, 0.0, 0.0, 1.0, 5.0],
    ];
    std::array::from_fn(|n| {
        let moved = |far: f64, k: usize| (far + BINOMIALS[n][k] * about[k].abs()) * w;
        Ball::new(about[n], (n + 1..=ORDERS).rev().fold(0.0, moved))
    })
}

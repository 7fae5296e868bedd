//! Lowers limits beside intervals in which the motion exceeds them between nodes.
//!
//! # Method
//! 1. Evaluate speed, acceleration and jerk at the inner points [`PLACES`] of each interval. The derivatives
//!    of the path come from the quintic between the nodes.
//! 2. Where a limit is exceeded, divide it by the excess at both ends of the interval.

use super::rows::Rows;
use super::station::{Limits, Station, TipLimits, between};

/// Where the limits are evaluated, as parts of an interval.
const PLACES: [f64; 3] = [0.25, 0.5, 0.75];

/// An excess below this factor is left to the caller: removing it costs a second search.
const IGNORED: f64 = 1.004;

/// Tightens `rows`; returns the largest excess of the squared speed, as a factor, or `None` without any
/// above [`IGNORED`].
pub fn tighten(
    rows: &mut Rows,
    nodes: &[Station],
    states: &[[f64; 2]],
    limits: &[Limits],
    tip: Option<&TipLimits>,
) -> Option<f64> {
    let last = rows.lengths.len();
    let mut factors = vec![[1.0f64; 3]; last];
    let mut most = 1.0f64;
    for k in 1..last.saturating_sub(1) {
        let h = rows.lengths[k];
        let [b, slope] = states[k];
        let second = (states[k + 1][1] - slope) / h;
        for part in PLACES {
            let x = part * h;
            let node = between(&nodes[k], &nodes[k + 1], nodes[k].u + x);
            let state = [b + x * (slope + 0.5 * x * second), slope + x * second, second];
            for (factor, used) in factors[k].iter_mut().zip(used(&node, state, limits, tip)) {
                *factor = factor.max(used);
            }
        }
        let [speed, acceleration, jerk] = factors[k];
        if speed.max(acceleration).max(jerk) > IGNORED {
            most = most.max(speed * speed).max(acceleration).max(jerk.powf(2.0 / 3.0));
        }
    }
    if most == 1.0 {
        return None;
    }
    for k in 1..last - 1 {
        let [speed, acceleration, jerk] = factors[k];
        for end in 0..2 {
            rows.lower_speed(k + end, speed);
            // Two intervals meet at a node: the larger factor counts.
            let beside = if end == 0 { k - 1 } else { k + 1 };
            if acceleration > factors[beside][1] || (acceleration == factors[beside][1] && end == 0) {
                rows.lower_acceleration(k + end, acceleration);
            }
            rows.lower_jerk(k, end, jerk);
        }
    }
    Some(most)
}

/// Speed, acceleration and jerk as parts of their limits, the largest of all coordinates and the tip.
fn used(
    node: &Station,
    [b, slope, second]: [f64; 3],
    limits: &[Limits],
    tip: Option<&TipLimits>,
) -> [f64; 3] {
    let speed = b.max(0.0).sqrt();
    let mut most = [speed / node.speed_cap, 0.0, 0.0];
    let (mut tip_acceleration, mut tip_jerk) = (0.0, 0.0);
    for (k, (d, l)) in node.coordinates.iter().zip(limits).enumerate() {
        let acceleration = d.second * b + 0.5 * d.first * slope;
        let jerk = speed * (d.third[0] * b + 1.5 * d.second * slope + 0.5 * d.first * second);
        most[0] = most[0].max(speed * d.first.abs() / l.speed);
        most[1] = most[1].max(acceleration.abs() / l.acceleration);
        most[2] = most[2].max(jerk.abs() / l.jerk);
        if k < 3 {
            tip_acceleration += acceleration * acceleration;
            tip_jerk += jerk * jerk;
        }
    }
    if let Some(tip) = tip {
        most[1] = most[1].max(tip_acceleration.sqrt() / tip.acceleration);
        most[2] = most[2].max(tip_jerk.sqrt() / tip.jerk);
    }
    most
}

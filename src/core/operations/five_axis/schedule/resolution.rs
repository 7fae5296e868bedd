//! How many parts an interval between two stations needs, so that limits kept at nodes hold between them.
//!
//! # Method
//! Acceleration and jerk are products of a derivative of the path and of the motion. Within an interval, the
//! derivatives of the path leave the straight line between their values at the ends. This departure times the
//! largest possible motion estimates the excess. Division into n parts makes the departure n^2 times smaller.
//!
//! Where stations are far denser than the path needs, most are left out: those at which the derivatives are
//! hardly other than those between the stations that stay.

use std::borrow::Cow;

use super::station::{Derivatives, Limits, Station, between};

/// The estimated excess of a limit between nodes, as a part of the limit. The measured excess is smaller in
/// most cases. A smaller part adds nodes: four times smaller, twice as many where the path bends sharply.
const EXCESS: f64 = 0.01;

/// The most parts of an interval. It bounds the cost for paths that the stations do not resolve.
const MOST: f64 = 4.0;

/// The number of parts; `middle` is halfway between the stations.
pub fn parts(from: &Station, middle: &Station, to: &Station, limits: &[Limits]) -> usize {
    let motion = [largest_motion(from, limits), largest_motion(to, limits)];
    let square = motion[0][0].max(motion[1][0]);
    let slope = motion[0][1].max(motion[1][1]);
    let mut most = 0.0f64;
    for (k, l) in limits.iter().enumerate() {
        let (a, m, b) = (&from.coordinates[k], &middle.coordinates[k], &to.coordinates[k]);
        let away = |f: &dyn Fn(&Derivatives) -> f64| (f(m) - 0.5 * (f(a) + f(b))).abs();
        let (first, second) = (away(&|d| d.first), away(&|d| d.second));
        let third = (m.third[0] - 0.5 * (a.third[1] + b.third[0])).abs();
        most = most.max(excess([first, second, third], [square, slope], l));
    }
    (most / EXCESS).sqrt().ceil().clamp(1.0, MOST) as usize
}

/// A path with at most this number of stations keeps all stations.
const KEPT: usize = 4000;

/// The most stations between two that stay: a power of two.
const LONGEST_BLOCK: usize = 64;

/// The estimated excess at a station that is left out.
const LEFT_OUT: f64 = 2e-3;

/// The stations that the motion needs of very many.
pub fn needed<'a>(stations: &'a [Station], limits: &[Limits]) -> Cow<'a, [Station]> {
    if stations.len() <= KEPT {
        return Cow::Borrowed(stations);
    }
    let last = stations.len() - 1;
    let mut kept = Vec::new();
    let mut from = 0;
    while from < last {
        let mut length = LONGEST_BLOCK.min(last - from);
        while length > 1 && !is_smooth(&stations[from..=from + length], limits) {
            length = (length / 2).next_power_of_two();
        }
        kept.push(stations[from].clone());
        from += length;
    }
    kept.push(stations[last].clone());
    Cow::Owned(kept)
}

/// Whether the stations between the first and the last one are what the two say.
fn is_smooth(stations: &[Station], limits: &[Limits]) -> bool {
    let (from, to) = (&stations[0], &stations[stations.len() - 1]);
    let motion = [largest_motion(from, limits), largest_motion(to, limits)];
    let square = motion[0][0].max(motion[1][0]);
    let slope = motion[0][1].max(motion[1][1]);
    stations[1..stations.len() - 1].iter().all(|own| {
        let guess = between(from, to, own.u);
        let cap = (own.speed_cap / guess.speed_cap - 1.0).abs() <= LEFT_OUT;
        cap && limits.iter().enumerate().all(|(k, l)| {
            let (a, b) = (&own.coordinates[k], &guess.coordinates[k]);
            let third = a.third.iter().zip(&b.third).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            let away = [(a.first - b.first).abs(), (a.second - b.second).abs(), third];
            excess(away, [square, slope], l) <= LEFT_OUT
        })
    })
}

/// By which part acceleration or jerk may exceed its limit if the three derivatives of a coordinate differ by
/// these amounts from what the search knows. The motion has at most this square of the speed and this slope.
fn excess([first, second, third]: [f64; 3], [square, slope]: [f64; 2], l: &Limits) -> f64 {
    let acceleration = second * square + 0.5 * first * slope;
    let jerk = third * square.powf(1.5) + 1.5 * second * slope * square.sqrt();
    (acceleration / l.acceleration).max(jerk / l.jerk)
}

/// The largest b and b' that the limits may allow at a station: b at constant speed, b' at rest.
fn largest_motion(at: &Station, limits: &[Limits]) -> [f64; 2] {
    let mut square = at.speed_cap * at.speed_cap;
    let mut slope = f64::INFINITY;
    for (d, l) in at.coordinates.iter().zip(limits) {
        let third = d.third[0].abs().max(d.third[1].abs());
        let most = |limit: f64, by: f64| if by > 0.0 { limit / by } else { f64::INFINITY };
        square = square
            .min(most(l.speed, d.first.abs()).powi(2))
            .min(most(l.acceleration, d.second.abs()))
            .min(most(l.jerk, third).powf(2.0 / 3.0));
        slope = slope.min(2.0 * most(l.acceleration, d.first.abs()));
    }
    [square, slope]
}

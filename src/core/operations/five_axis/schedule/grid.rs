//! The nodes of the schedule: the stations, and more of them toward the ends, where the motion is slow.
//!
//! # Method
//! 1. Estimate the length over which the motion reaches its speed cap, from the limits at the end.
//! 2. Place the first node at a small part of this length. From there to the middle of the path, divide the
//!    intervals between stations where they are longer than [`STEP`] of the distance from the end.
//! 3. At a node between stations, take the derivatives from the quintic that has the three given derivatives
//!    at both stations.
//!
//! # Guarantees
//! Each station is a node, or of very many each that the motion needs. The derivatives are exact if each
//! coordinate is a polynomial of degree 6 or less between two stations.

use super::resolution;
use super::station::{Limits, Station, TipLimits, between};

/// The longest interval, as a part of its distance from the end. Smaller parts give faster starts: 0.1
/// loses 1 % of the time to reach full speed, and adds some 100 nodes to a path.
const STEP: f64 = 0.1;

/// The first interval at most, as a part of the length over which the motion gains speed. The jerk of the
/// path is constant in this interval. A larger part cannot follow limits that change.
const FIRST: f64 = 0.1;

/// The first interval at least, as a part of the same length. Without a limit of jerk, the motion loses 1 %
/// of the time to reach full speed at 1e-4. A smaller part adds nodes.
const FIRST_AT_LEAST: f64 = 1e-4;

/// The first interval is at least this part of the path. From there, some 160 intervals reach the middle.
/// Without this least part, the intervals of an end that gains no speed would never get there.
const FIRST_OF_PATH: f64 = 1e-7;

/// A place is left out if it is nearer to a station or to another place than this part of the longest
/// interval there. Beside an interval that is much shorter, limits of jerk at its ends would hold the motion
/// down.
const NEAREST: f64 = 0.3;

/// The nodes of `stations`, which are at least two.
pub fn nodes(stations: &[Station], limits: &[Limits], tip: Option<&TipLimits>) -> Vec<Station> {
    let stations = &*resolution::needed(stations, limits);
    let (Some(first), Some(last)) = (stations.first(), stations.last()) else {
        return Vec::new();
    };
    let length = last.u - first.u;
    let middle = first.u + 0.5 * length;
    let mut ahead: Vec<f64> = stations.iter().map(|s| s.u - first.u).filter(|&d| d < 0.5 * length).collect();
    ahead.push(0.5 * length);
    let mut behind: Vec<f64> =
        stations.iter().rev().map(|s| last.u - s.u).filter(|&d| d < 0.5 * length).collect();
    behind.push(0.5 * length);
    let ahead = graded(&ahead, first_interval(first, limits, tip, length));
    let behind = graded(&behind, first_interval(last, limits, tip, length));
    let mut places: Vec<f64> = ahead.iter().map(|d| first.u + d).collect();
    places.extend(behind.iter().rev().map(|d| last.u - d));
    places.push(middle);
    places.extend(stations.iter().map(|s| s.u));
    places.sort_by(f64::total_cmp);
    let nodes = at_places(stations, &places);
    resolved(&nodes, limits)
}

/// The nodes, and more of them where the path bends sharply.
fn resolved(nodes: &[Station], limits: &[Limits]) -> Vec<Station> {
    let mut more = Vec::with_capacity(nodes.len());
    for pair in nodes.windows(2) {
        let [from, to] = pair else { continue };
        more.push(from.clone());
        let middle = between(from, to, 0.5 * (from.u + to.u));
        let parts = resolution::parts(from, &middle, to, limits);
        for part in 1..parts {
            let u = from.u + (to.u - from.u) * part as f64 / parts as f64;
            if u > from.u && u < to.u {
                more.push(between(from, to, u));
            }
        }
    }
    more.extend(nodes.last().cloned());
    more
}

/// The stations, and nodes at the `places` between them that are not too near to others.
fn at_places(stations: &[Station], places: &[f64]) -> Vec<Station> {
    let mut nodes: Vec<Station> = Vec::with_capacity(places.len());
    let mut places = places.iter().peekable();
    let ends = [stations[0].u, stations[stations.len() - 1].u];
    for pair in stations.windows(2) {
        let [from, to] = pair else { continue };
        nodes.push(from.clone());
        let mut before = from.u;
        while let Some(u) = places.next_if(|&&u| u < to.u) {
            let apart = NEAREST * STEP * (u - ends[0]).min(ends[1] - u);
            if u - before > apart && to.u - u > apart {
                nodes.push(between(from, to, *u));
                before = *u;
            }
        }
    }
    nodes.extend(stations.last().cloned());
    nodes
}

/// Divides the distances from an end where they are far apart.
fn graded(distances: &[f64], first: f64) -> Vec<f64> {
    let mut places = vec![0.0];
    let mut at = 0.0;
    for &to in distances {
        // The distance grows by `STEP` each time: no more than this many steps fit into all numbers.
        for _ in 0..20_000 {
            let step = if at == 0.0 { first } else { STEP * at };
            if to - at <= 1.5 * step {
                break;
            }
            at += step;
            places.push(at);
        }
        if to > at {
            at = to;
            places.push(at);
        }
    }
    places
}

/// The length of the interval at an end of the path.
fn first_interval(end: &Station, limits: &[Limits], tip: Option<&TipLimits>, length: f64) -> f64 {
    let mut speed = end.speed_cap;
    let mut acceleration = f64::INFINITY;
    let mut jerk = f64::INFINITY;
    for (d, l) in end.coordinates.iter().zip(limits) {
        let first = d.first.abs();
        if first > 0.0 {
            speed = speed.min(l.speed / first);
            acceleration = acceleration.min(l.acceleration / first);
            jerk = jerk.min(l.jerk / first);
        }
    }
    if let Some(tip) = tip {
        let first = end.coordinates.iter().take(3).map(|d| d.first * d.first).sum::<f64>().sqrt();
        if first > 0.0 {
            acceleration = acceleration.min(tip.acceleration / first);
            jerk = jerk.min(tip.jerk / first);
        }
    }
    // Jerk alone gains the speed v over sqrt(v^3 / j), acceleration alone over v^2 / 2a.
    let gain = (speed.powi(3) / jerk).sqrt().max(0.5 * speed * speed / acceleration);
    let gain = if gain.is_finite() { gain.min(0.25 * length) } else { 0.25 * length };
    // The acceleration has grown to its limit here.
    let full = acceleration.powi(3) / (6.0 * jerk * jerk);
    let full = if full.is_nan() { 0.0 } else { full };
    (FIRST * full).clamp(FIRST_AT_LEAST * gain, FIRST * gain).max(FIRST_OF_PATH * length)
}

//! A lower bound of the time of any motion along a piece within the limits.
//!
//! # Method
//! 1. From one station to the next no motion is faster than the feed over the chord of the tip, or than an
//!    axis at its largest speed over the difference of its positions.
//! 2. At a station, the limits of acceleration of two axes together bound the square of the speed. From one
//!    station to the next, the square of the speed of an axis grows by at most twice its acceleration times
//!    its way. Passes from both ends of the path apply this to all stations.
//! 3. From a rest to a station, no motion is faster than the [`SCurve`] of an axis; from rest to rest none is
//!    faster than its fastest motion. The sum of a curve at each end and of the times between them counts, at
//!    the stations where it is largest.
//!
//! # Guarantees
//! But for rounding, no motion within the limits is faster. Ways and speeds between stations come from bounds
//! over ranges, as in the proof. Jerk counts at the ends alone: where it holds the motion down elsewhere, the
//! bound is too low.
//!
//! # Cost
//! O(n) for n stations.

use nalgebra::Vector3;

use super::s_curve::{INSTANT_S, SCurve, rest_to_rest};
use super::{Axes, Path};
use crate::budget::{Budget, Stopped};
use crate::operations::five_axis::rail::{tip, top};
use crate::operations::five_axis::schedule::{Expansion, Limits, Station};

/// Stations between two checks of the budget.
const BETWEEN_CHECKS: usize = 256;

/// The stations from each end at which curves are tried.
const TRIED: usize = 64;

/// What rounding may add to a bound, as a part of it.
const ROUNDING: f64 = 1e-9;

/// What rounding may add to the difference of two positions of an axis, mm or radians, and as a part of both.
const ONE_PLACE: f64 = 1e-11;

/// Where all stand at a station: the coordinates, the tip, and the point that moves at the feed at most.
struct Standing {
    coordinates: Vec<f64>,
    tip: Vector3<f64>,
    paced: Vector3<f64>,
}

/// What bounds the motion from one station to the next.
struct Interval {
    /// The least time, s.
    seconds: f64,
    /// The way of each coordinate to and fro, at most.
    ways: Vec<f64>,
    /// The speed of each coordinate, by its limit and by the feed.
    speeds: Vec<f64>,
    feed: f64,
}

impl Standing {
    /// How far a coordinate is from here to another place, at least.
    fn distance(&self, other: &Self, k: usize) -> f64 {
        let [a, b] = [self.coordinates[k], other.coordinates[k]];
        ((b - a).abs() - ONE_PLACE * (1.0 + a.abs() + b.abs())).max(0.0)
    }
}

impl Path<'_> {
    /// No motion along the piece from rest to rest takes less, s.
    ///
    /// # Errors
    /// When the budget ends.
    pub fn least_time_s(&self, stations: &[Station], axes: &Axes, budget: &Budget) -> Result<f64, Stopped> {
        let places = self.places(axes);
        let mut intervals = self.intervals(&places, axes, budget)?;
        bound_by_acceleration(&mut intervals, &places, stations, axes);
        let forward: (Vec<&Standing>, Vec<&Interval>) = (places.iter().collect(), intervals.iter().collect());
        let backward = (places.iter().rev().collect(), intervals.iter().rev().collect());
        let whole: f64 = intervals.iter().map(|own| own.seconds).sum();
        let starts = gains(&forward, axes);
        let last = places.len() - 1;
        let ends: Vec<(usize, f64)> =
            gains(&backward, axes).into_iter().map(|(k, s)| (last - k, s)).collect();
        let mut most = whole.max(from_rest_to_rest(&forward, axes));
        for (from, start) in starts {
            let end =
                ends.iter().filter(|(to, _)| *to >= from).fold(0.0_f64, |most, (_, end)| most.max(*end));
            most = most.max(whole + start + end);
        }
        for (_, end) in ends {
            most = most.max(whole + end);
        }
        Ok((most * (1.0 - ROUNDING) - 4.0 * INSTANT_S).max(0.0))
    }

    fn places(&self, axes: &Axes) -> Vec<Standing> {
        let place = |(u, joints): &_| {
            let at = self.piece.spans[self.piece.index_at(*u)].jet(*u)[0];
            let mut coordinates: Vec<f64> = Vec::with_capacity(axes.limits.len());
            if axes.limits.len() != 5 {
                coordinates.extend(tip(&at).iter());
            }
            if let Some(joints) = joints {
                let super::AxisPositions { linear_mm, rotary } = *joints;
                coordinates.extend(linear_mm.iter().chain(&rotary));
            }
            Standing { coordinates, tip: tip(&at), paced: if self.rests { top(&at) } else { tip(&at) } }
        };
        self.stations.iter().map(place).collect()
    }

    fn intervals(&self, places: &[Standing], axes: &Axes, budget: &Budget) -> Result<Vec<Interval>, Stopped> {
        let mut span = 0;
        let mut intervals = Vec::with_capacity(places.len());
        for (k, (pair, ends)) in places.windows(2).zip(self.stations.windows(2)).enumerate() {
            if k.is_multiple_of(BETWEEN_CHECKS) {
                budget.check()?;
            }
            let range = [ends[0].0, ends[1].0];
            let half = 0.5 * (range[1] - range[0]);
            while self.piece.spans[span].to <= range[0] && span + 1 < self.piece.spans.len() {
                span += 1;
            }
            let feed = self.piece.feeds[span];
            let mut seconds = (pair[1].paced - pair[0].paced).norm() / feed;
            let (mut ways, mut speeds) = (Vec::new(), Vec::new());
            let found = self.expansions(span, range, ends[0].1, axes);
            for (k, limits) in axes.limits.iter().enumerate() {
                let [way, by_feed] = found.as_ref().map_or([f64::INFINITY; 2], |(coordinates, paced)| {
                    let [middle, by] = rate(&coordinates[k], half);
                    [2.0 * half * (middle + by), feed * (middle + by) / slowest(paced, half)]
                });
                let speed = if by_feed.is_nan() { limits.speed } else { limits.speed.min(by_feed) };
                let moved = pair[0].distance(&pair[1], k);
                seconds = seconds.max(moved / limits.speed);
                ways.push(way);
                speeds.push(speed);
            }
            intervals.push(Interval { seconds, ways, speeds, feed });
        }
        Ok(intervals)
    }
}

/// The size of the first derivative in the middle of a range of the half length `half`, and how far it
/// differs from this anywhere in the range, at most.
fn rate(Expansion { middle: [c1, c2, c3, c4], error }: &Expansion, half: f64) -> [f64; 2] {
    [c1.abs(), half * (2.0 * c2.abs() + half * (3.0 * c3.abs() + 4.0 * half * (c4.abs() + error)))]
}

/// The least size of the first derivative of a vector.
fn slowest(vector: &[Expansion; 3], half: f64) -> f64 {
    let rates = vector.map(|own| rate(&own, half));
    let norm = |n: usize| rates.iter().map(|own| own[n] * own[n]).sum::<f64>().sqrt();
    (norm(0) - norm(1)).max(0.0)
}

/// Raises the least times by what accelerations allow.
fn bound_by_acceleration(intervals: &mut [Interval], places: &[Standing], stations: &[Station], axes: &Axes) {
    let limited: Vec<usize> =
        (0..axes.limits.len()).filter(|&k| axes.limits[k].acceleration.is_finite()).collect();
    let mut squares: Vec<f64> = stations.iter().map(|station| ceiling(station, axes, &limited)).collect();
    let last = squares.len() - 1;
    (squares[0], squares[last]) = (0.0, 0.0);
    let rate = |j: usize, k: usize| stations[j].coordinates[k].first.powi(2);
    let grown = |square: f64, from: usize, to: usize| {
        let by_axis = limited.iter().map(|&k| {
            let more = 2.0 * axes.limits[k].acceleration * intervals[from.min(to)].ways[k];
            (rate(from, k) * square + more) / rate(to, k)
        });
        // An axis that stands still at the station bounds nothing.
        by_axis.filter(|square| !square.is_nan()).fold(f64::INFINITY, f64::min)
    };
    for j in 0..last {
        squares[j + 1] = squares[j + 1].min(grown(squares[j], j, j + 1));
    }
    for j in (0..last).rev() {
        squares[j] = squares[j].min(grown(squares[j + 1], j + 1, j));
    }
    for (j, interval) in intervals.iter_mut().enumerate() {
        for &k in &limited {
            let most = 0.5 * (rate(j, k) * squares[j] + rate(j + 1, k) * squares[j + 1])
                + axes.limits[k].acceleration * interval.ways[k];
            let moved = places[j].distance(&places[j + 1], k);
            if most > 0.0 && most.is_finite() {
                interval.seconds = interval.seconds.max(moved / most.sqrt());
            }
        }
    }
}

/// The most square of du/dt at a station, by speeds and accelerations.
fn ceiling(station: &Station, axes: &Axes, limited: &[usize]) -> f64 {
    let mut most = station.speed_cap.powi(2);
    for (own, limits) in station.coordinates.iter().zip(&axes.limits) {
        most = most.min((limits.speed / own.first).powi(2));
    }
    for (n, &i) in limited.iter().enumerate() {
        for &k in &limited[..n] {
            let [a, b] = [&station.coordinates[i], &station.coordinates[k]];
            let [of_a, of_b] = [axes.limits[i].acceleration, axes.limits[k].acceleration];
            let square = (of_a * b.first.abs() + of_b * a.first.abs())
                / (a.second * b.first - b.second * a.first).abs();
            most = if square.is_nan() { most } else { most.min(square) };
        }
    }
    if let Some(limits) = axes.tip {
        let vector = |of: &dyn Fn(usize) -> f64| Vector3::new(of(0), of(1), of(2));
        let first = vector(&|k| station.coordinates[k].first);
        let second = vector(&|k| station.coordinates[k].second);
        let across = first.cross(&second).norm() / first.norm();
        let square = limits.acceleration / across;
        most = if square.is_nan() { most } else { most.min(square) };
    }
    most
}

/// The limits of each axis, and the limits of the tip. The speed of each is the largest that the feed and the
/// limits of all axes together allow anywhere in `intervals`.
fn paced_limits(intervals: &[&Interval], axes: &Axes) -> (Vec<Limits>, Option<Limits>) {
    let fastest = |k: usize| intervals.iter().map(|own| own.speeds[k]).fold(0.0, f64::max);
    let limits = axes.limits.iter().enumerate().map(|(k, own)| Limits { speed: fastest(k), ..*own });
    let feed = intervals.iter().map(|own| own.feed).fold(0.0, f64::max);
    let of_tip = axes.tip.map(|own| Limits { speed: feed, acceleration: own.acceleration, jerk: own.jerk });
    (limits.collect(), of_tip)
}

/// By how much the curves of the axes from rest at the first place exceed the times of the intervals, at some
/// of the places after it, s.
fn gains((places, intervals): &(Vec<&Standing>, Vec<&Interval>), axes: &Axes) -> Vec<(usize, f64)> {
    let (limits, of_tip) = paced_limits(intervals, axes);
    let curve = |limits: &Limits| limits.speed.is_finite().then(|| SCurve::new(limits));
    let curves: Vec<Option<SCurve>> = limits.iter().map(curve).collect();
    let of_tip = of_tip.as_ref().and_then(curve);
    let mut caps = vec![0.0_f64; curves.len()];
    let (mut feed, mut before) = (0.0_f64, 0.0);
    let (mut found, mut next) = (Vec::new(), 1);
    for (j, interval) in intervals.iter().enumerate().map(|(j, own)| (j + 1, own)) {
        before += interval.seconds;
        caps.iter_mut().zip(&interval.speeds).for_each(|(cap, speed)| *cap = cap.max(*speed));
        feed = feed.max(interval.feed);
        if j < next && j < intervals.len() {
            continue;
        }
        let part = (found.len() + 2) as f64 / TRIED as f64;
        next = (j + 1).max((part * part * intervals.len() as f64) as usize);
        let mut seconds = 0.0_f64;
        for (k, curve) in curves.iter().enumerate() {
            let distance = places[0].distance(places[j], k);
            seconds = seconds.max(curve.as_ref().map_or(0.0, |curve| curve.time_to(distance, caps[k])));
        }
        let distance = (places[j].tip - places[0].tip).norm();
        seconds = seconds.max(of_tip.as_ref().map_or(0.0, |curve| curve.time_to(distance, feed)));
        found.push((j, seconds - before));
    }
    found
}

/// The least time over which an axis gets from the first place to the last, s.
fn from_rest_to_rest((places, intervals): &(Vec<&Standing>, Vec<&Interval>), axes: &Axes) -> f64 {
    let (limits, of_tip) = paced_limits(intervals, axes);
    let (first, last) = (places[0], places[places.len() - 1]);
    let time = |distance: f64, limits: &Limits| {
        if limits.speed.is_finite() { rest_to_rest(distance, limits) } else { 0.0 }
    };
    let axes = limits.iter().enumerate();
    let most = axes.map(|(k, own)| time(first.distance(last, k), own)).fold(0.0, f64::max);
    most.max(of_tip.map_or(0.0, |own| time((last.tip - first.tip).norm(), &own)))
}

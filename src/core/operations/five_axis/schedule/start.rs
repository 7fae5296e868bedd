//! A slow motion within all limits, from which the search starts.
//!
//! # Method
//! 1. At each node, take the largest squared speed that the cap allows, and that the curvature allows at
//!    constant speed. Translate it to a distance r: b = k r^(4/3) is the law of a constant jerk from rest.
//! 2. Lower r until it differs by no more than the distance between two nodes. It is 0 at both ends.
//! 3. Replace r by its mean over a window with a width in proportion to r. The second derivative of r is then
//!    bounded by a multiple of 1/r, so that jerk is bounded by a multiple of k^(3/2).
//! 4. Multiply b by a factor for which every limit is kept with room to spare.

use super::rows::{Rows, dot, largest};

/// Half of the window, as a part of r. A larger part is smoother, but slower beside a low cap.
const WINDOW: f64 = 0.3;

/// The part of each limit that the start uses at most. A larger part starts too close to the limits: the
/// search then turns away from them first.
const USED: f64 = 0.5;

/// The control values of the start.
pub fn slow(rows: &Rows) -> Vec<f64> {
    let last = rows.lengths.len();
    let mut places = vec![0.0];
    for h in &rows.lengths {
        places.push(places[places.len() - 1] + h);
    }
    let length = places[last];
    let constant: Vec<f64> = (0..=last).map(|j| constant_speed(rows, j)).collect();
    let most = constant.iter().fold(0.0f64, |most, &b| most.max(b));
    // From rest, a jerk j of u gives b = (9/2 j)^(2/3) r^(4/3). The row p is q' by twice the limit.
    let p = (0..last).map(|k| largest(&column(rows, k), rows.jerk_axes)).fold(0.0f64, f64::max);
    let by_jerk = (9.0 / (4.0 * p)).powf(2.0 / 3.0);
    let k = by_jerk.min(most / (0.5 * length).powf(4.0 / 3.0));
    let mut r: Vec<f64> = (0..=last)
        .map(|j| {
            let a: Vec<f64> = rows.acceleration_at(j).iter().map(|p| p[1]).collect();
            // Acceleration is q' b' / 2 with b' = 4/3 k r^(1/3).
            let by_acceleration = (0.75 / (k * largest(&a, rows.acceleration_axes))).powi(3);
            (constant[j] / k).powf(0.75).min(by_acceleration)
        })
        .collect();
    (r[0], r[last]) = (0.0, 0.0);
    for j in 1..=last {
        r[j] = r[j].min(r[j - 1] + rows.lengths[j - 1]);
    }
    for j in (0..last).rev() {
        r[j] = r[j].min(r[j + 1] + rows.lengths[j]);
    }
    let mut m = smooth(&places, &r);
    for m in &mut m {
        *m = k * m.powf(4.0 / 3.0);
    }
    (m[0], m[last - 1]) = (0.0, 0.0);
    let factor = room(rows, &m);
    m.iter_mut().for_each(|m| *m *= factor);
    m
}

/// The rows of b'' of jerk at the start of an interval.
fn column(rows: &Rows, interval: usize) -> Vec<f64> {
    rows.jerk_at(interval, 0).iter().map(|p| p[2]).collect()
}

/// The most b at a node, if the speed is constant.
fn constant_speed(rows: &Rows, node: usize) -> f64 {
    let last = rows.lengths.len();
    let a: Vec<f64> = rows.acceleration_at(node).iter().map(|p| p[0]).collect();
    let mut cap = rows.cap[node].min(1.0 / largest(&a, rows.acceleration_axes));
    let before = (node > 0).then(|| (node - 1, 1));
    let after = (node < last).then_some((node, 0));
    for (interval, end) in before.into_iter().chain(after) {
        let j: Vec<f64> = rows.jerk_at(interval, end).iter().map(|p| p[0]).collect();
        cap = cap.min(largest(&j, rows.jerk_axes).powf(-2.0 / 3.0));
    }
    cap
}

/// The means of r around the middle of each interval.
fn smooth(places: &[f64], r: &[f64]) -> Vec<f64> {
    let mut integral = vec![0.0];
    for k in 0..places.len() - 1 {
        integral.push(integral[k] + 0.5 * (r[k] + r[k + 1]) * (places[k + 1] - places[k]));
    }
    let last = places.len() - 2;
    let up_to = |interval: usize, x: f64| {
        let h = places[interval + 1] - places[interval];
        let d = x - places[interval];
        integral[interval] + d * (r[interval] + 0.5 * d * (r[interval + 1] - r[interval]) / h)
    };
    let (mut left, mut right) = (0, 0);
    let mut means = Vec::with_capacity(last + 1);
    for k in 0..=last {
        let middle = 0.5 * (places[k] + places[k + 1]);
        let half = WINDOW * 0.5 * (r[k] + r[k + 1]);
        let (from, to) = (middle - half, middle + half);
        // The ends of the window move forward, as r changes by no more than the distance.
        while left < last && places[left + 1] < from {
            left += 1;
        }
        while right < last && places[right + 1] < to {
            right += 1;
        }
        let mean = (up_to(right, to) - up_to(left, from)) / (to - from);
        means.push(if mean.is_finite() && mean > 0.0 { mean } else { 0.5 * (r[k] + r[k + 1]) });
    }
    means
}

/// The factor that brings all limits down to [`USED`].
fn room(rows: &Rows, m: &[f64]) -> f64 {
    let last = rows.lengths.len();
    let mut states = Vec::new();
    rows.states(m, &mut states);
    let (mut cap, mut acceleration, mut jerk) = (0.0f64, 0.0f64, 0.0f64);
    for (j, &[b, slope]) in states.iter().enumerate().take(last).skip(1) {
        cap = cap.max(b / rows.cap[j]);
        let a: Vec<f64> = rows.acceleration_at(j).iter().map(|p| p[0] * b + p[1] * slope).collect();
        acceleration = acceleration.max(largest(&a, rows.acceleration_axes));
    }
    for k in 1..last - 1 {
        cap = cap.max(m[k] / rows.middle_cap(k));
        let second = (states[k + 1][1] - states[k][1]) / rows.lengths[k];
        for end in 0..2 {
            let [b, slope] = states[k + end];
            let j: Vec<f64> = rows.jerk_at(k, end).iter().map(|p| dot(p, &[b, slope, second])).collect();
            jerk = jerk.max(largest(&j, rows.jerk_axes) * b.sqrt());
        }
    }
    (USED / cap).min(USED / acceleration).min((USED / jerk).powf(2.0 / 3.0)).min(1.0)
}

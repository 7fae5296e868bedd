//! The limits as functions of the control values of the squared speed b.
//!
//! Interval k between the nodes k and k + 1 has the control values b(k), m(k), b(k + 1) of a parabola in
//! Bernstein form. The unknowns are the middle ones, m. Because b' is continuous, they determine b and b' at
//! the nodes. The first and the last interval have the law of a constant jerk of u from rest instead: b
//! grows with the power 4/3 of the distance. Their m is 0 and does not count.

use super::station::{Limits, Station, TipLimits};

/// Crossing the whole path takes at least this long, s: it bounds the speed where no limit does.
const SHORTEST: f64 = 1e-6;

/// b, b' and b'' at one end of an interval.
pub type State = [f64; 3];

/// The limits, divided by their values, so that each limit is 1.
pub struct Rows {
    /// Lengths of the intervals.
    pub lengths: Vec<f64>,
    /// At each node: b and b' as combinations of m before and after the node.
    pub maps: Vec<[[f64; 2]; 2]>,
    /// The most b, at each node; the limits in the first and last interval are included.
    pub cap: Vec<f64>,
    /// The part of 1 / sqrt(b) at each node in the time.
    pub weight: Vec<f64>,
    /// For each interval its start, then its end; for each the axes, then the tip. Jerk is a row times the
    /// state times sqrt(b).
    pub jerk: Vec<[f64; 3]>,
    pub jerk_axes: usize,
    pub jerk_tip: bool,
    /// For each node the axes, then the tip. Acceleration is a row times b and b'.
    pub acceleration: Vec<[f64; 2]>,
    pub acceleration_axes: usize,
    pub acceleration_tip: bool,
}

impl Rows {
    pub fn new(nodes: &[Station], limits: &[Limits], tip: Option<&TipLimits>) -> Self {
        let lengths: Vec<f64> = nodes.windows(2).map(|pair| pair[1].u - pair[0].u).collect();
        let last = lengths.len();
        let mut maps = vec![[[0.0; 2]; 2]; last + 1];
        for j in 2..last.saturating_sub(1) {
            let (before, after) = (lengths[j - 1], lengths[j]);
            let sum = before + after;
            maps[j] = [[after / sum, before / sum], [-2.0 / sum, 2.0 / sum]];
        }
        // At the ends of the laws from rest, b' = 4 b / 3 h.
        if last >= 3 {
            let b = 1.0 / (1.0 + 2.0 * lengths[1] / (3.0 * lengths[0]));
            maps[1] = [[0.0, b], [0.0, 4.0 * b / (3.0 * lengths[0])]];
            let b = 1.0 / (1.0 + 2.0 * lengths[last - 2] / (3.0 * lengths[last - 1]));
            maps[last - 1] = [[b, 0.0], [-4.0 * b / (3.0 * lengths[last - 1]), 0.0]];
        }
        let mut weight: Vec<f64> = vec![0.0; last + 1];
        for (j, weight) in weight.iter_mut().enumerate().take(last).skip(1) {
            // The laws from rest take 3 h / sqrt(b).
            let part = |k: usize| if k == 0 || k + 1 == last { 3.0 } else { 0.5 } * lengths[k];
            *weight = part(j - 1) + part(j);
        }
        let jerk_axes: Vec<usize> = (0..limits.len()).filter(|&k| limits[k].jerk.is_finite()).collect();
        let acc_axes: Vec<usize> =
            (0..limits.len()).filter(|&k| limits[k].acceleration.is_finite()).collect();
        let tip_jerk = tip.map(|t| t.jerk).filter(|x| x.is_finite());
        let tip_acc = tip.map(|t| t.acceleration).filter(|x| x.is_finite());
        let jerk_row = |node: &Station, side: usize, axis: usize, limit: f64| {
            let d = node.coordinates[axis];
            [d.third[side] / limit, 1.5 * d.second / limit, 0.5 * d.first / limit]
        };
        let acc_row = |node: &Station, axis: usize, limit: f64| {
            let d = node.coordinates[axis];
            [d.second / limit, 0.5 * d.first / limit]
        };
        let corner = |node: &Station, side: usize| -> Vec<[f64; 3]> {
            let axes = jerk_axes.iter().map(|&k| jerk_row(node, side, k, limits[k].jerk));
            let tip = tip_jerk.into_iter().flat_map(|limit| (0..3).map(move |k| (k, limit)));
            axes.chain(tip.map(|(k, limit)| jerk_row(node, side, k, limit))).collect()
        };
        let jerk = (0..last)
            .flat_map(|k| [(k, 1), (k + 1, 0)])
            .flat_map(|(j, side)| corner(&nodes[j], side))
            .collect();
        let acceleration = nodes
            .iter()
            .flat_map(|node| {
                let axes = acc_axes.iter().map(|&k| acc_row(node, k, limits[k].acceleration));
                let tip = tip_acc.into_iter().flat_map(|limit| (0..3).map(move |k| acc_row(node, k, limit)));
                axes.chain(tip).collect::<Vec<_>>()
            })
            .collect();
        let length: f64 = lengths.iter().sum();
        let cap = nodes.iter().map(|node| speed_cap(node, limits).min(length / SHORTEST).powi(2)).collect();
        let mut rows = Self {
            lengths,
            maps,
            cap,
            weight,
            jerk,
            jerk_axes: jerk_axes.len(),
            jerk_tip: tip_jerk.is_some(),
            acceleration,
            acceleration_axes: acc_axes.len(),
            acceleration_tip: tip_acc.is_some(),
        };
        if last >= 3 {
            rows.cap[1] = rows.cap[1].min(rows.rest_cap(0, 0));
            rows.cap[last - 1] = rows.cap[last - 1].min(rows.rest_cap(last - 1, last));
        }
        rows
    }

    /// The number of rows of jerk at one end of an interval.
    pub fn jerk_rows(&self) -> usize {
        self.jerk_axes + if self.jerk_tip { 3 } else { 0 }
    }

    /// The number of rows of acceleration at a node.
    pub fn acceleration_rows(&self) -> usize {
        self.acceleration_axes + if self.acceleration_tip { 3 } else { 0 }
    }

    /// The rows of jerk at the start (`end` 0) or the end (1) of an interval.
    pub fn jerk_at(&self, interval: usize, end: usize) -> &[[f64; 3]] {
        let n = self.jerk_rows();
        let from = (2 * interval + end) * n;
        &self.jerk[from..from + n]
    }

    pub fn acceleration_at(&self, node: usize) -> &[[f64; 2]] {
        let n = self.acceleration_rows();
        &self.acceleration[node * n..node * n + n]
    }

    /// Divides the limits of speed at a node by `factor`.
    pub fn lower_speed(&mut self, node: usize, factor: f64) {
        self.cap[node] /= factor * factor;
    }

    /// Divides the limits of acceleration at a node by `factor`.
    pub fn lower_acceleration(&mut self, node: usize, factor: f64) {
        let n = self.acceleration_rows();
        self.acceleration[node * n..node * n + n].iter_mut().flatten().for_each(|x| *x *= factor);
    }

    /// Divides the limits of jerk at the start (`end` 0) or the end (1) of an interval by `factor`.
    pub fn lower_jerk(&mut self, interval: usize, end: usize, factor: f64) {
        let n = self.jerk_rows();
        let from = (2 * interval + end) * n;
        self.jerk[from..from + n].iter_mut().flatten().for_each(|x| *x *= factor);
    }

    /// The most of the middle control value: it keeps the square of the speed below the line between the
    /// caps at both nodes.
    pub fn middle_cap(&self, interval: usize) -> f64 {
        0.5 * (self.cap[interval] + self.cap[interval + 1])
    }

    /// The most b at the inner end of the first or last interval, from the limits in this interval. `rest` is
    /// the node at rest.
    fn rest_cap(&self, interval: usize, rest: usize) -> f64 {
        let h = self.lengths[interval];
        let sign = if rest == interval { 1.0 } else { -1.0 };
        let end = usize::from(rest == interval);
        let inner = interval + end;
        let mut cap = f64::INFINITY;
        // At the rest, jerk is q' times the jerk of u, which is 2/9 b^(3/2) / h^2.
        let at_rest = self.jerk_at(interval, 1 - end).iter().map(|p| p[2] * 4.0 / 9.0 / (h * h));
        let inner_state = [1.0, sign * 4.0 / (3.0 * h), 4.0 / (9.0 * h * h)];
        let at_inner = self.jerk_at(interval, end).iter().map(|p| dot(p, &inner_state));
        let jerks = |values: Vec<f64>| largest(&values, self.jerk_axes);
        let jerk = jerks(at_rest.collect()).max(jerks(at_inner.collect()));
        if jerk > 0.0 {
            cap = cap.min(jerk.powf(-2.0 / 3.0));
        }
        let values: Vec<f64> =
            self.acceleration_at(inner).iter().map(|p| p[0] + p[1] * inner_state[1]).collect();
        let acceleration = largest(&values, self.acceleration_axes);
        if acceleration > 0.0 { cap.min(1.0 / acceleration) } else { cap }
    }

    /// b and b' at each node.
    pub fn states(&self, m: &[f64], into: &mut Vec<[f64; 2]>) {
        into.clear();
        into.push([0.0; 2]);
        for j in 1..self.lengths.len() {
            let [b, slope] = self.maps[j];
            let (before, after) = (m[j - 1], m[j]);
            into.push([b[0] * before + b[1] * after, slope[0] * before + slope[1] * after]);
        }
        into.push([0.0; 2]);
    }
}

/// The largest of the values of the axes and of the norm of the values of the tip.
pub fn largest(values: &[f64], axes: usize) -> f64 {
    let (axes, tip) = values.split_at(axes);
    let tip = tip.iter().fold(0.0, |sum, x| sum + x * x).sqrt();
    axes.iter().fold(tip, |most, x| most.max(x.abs()))
}

pub fn dot(p: &[f64; 3], y: &State) -> f64 {
    p[0] * y[0] + p[1] * y[1] + p[2] * y[2]
}

/// The most du/dt by the cap of the station and the speeds of the axes.
fn speed_cap(node: &Station, limits: &[Limits]) -> f64 {
    node.coordinates.iter().zip(limits).fold(node.speed_cap, |cap, (d, l)| {
        if d.first == 0.0 { cap } else { cap.min(l.speed / d.first.abs()) }
    })
}

//! The motion along the path as a function of time.
//!
//! # Method
//! With b = (du/dt)^2 a parabola, the acceleration b'/2 is linear in u: u is a sum of hyperbolic or circular
//! functions of time. The time over an interval h is 2 artanh(z) / sqrt(a) with a = b''/2 and
//! z = sqrt(a) h / (sqrt(b) at the start + sqrt(b) at the end). In the first and last interval u grows with
//! the third power of time.

/// A motion along a path from rest to rest.
#[derive(Debug, Clone, PartialEq)]
pub struct Schedule {
    /// The parameter at the nodes.
    places: Vec<f64>,
    /// b = (du/dt)^2 and its derivative by u at the nodes.
    states: Vec<[f64; 2]>,
    /// Time at the nodes, s, before slowing.
    times: Vec<f64>,
    /// The factor of [`Schedule::slowed`].
    slowness: f64,
}

/// The motion in a part of an interval.
pub(super) enum Part {
    /// In the first or last interval.
    Rest(Ranges),
    /// Elsewhere: the coefficients of the square of the speed, a parabola, about the middle.
    Moving([f64; 3]),
}

/// The least and the most of the derivatives of u by time.
pub(super) struct Ranges {
    pub speed: [f64; 2],
    pub acceleration: [f64; 2],
    pub jerk: [f64; 2],
}

/// u and its first three derivatives by time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Motion {
    pub u: f64,
    pub speed: f64,
    pub acceleration: f64,
    pub jerk: f64,
}

impl Schedule {
    /// `states` are b and b' at the `places`, of which there are none or at least four.
    pub(super) fn new(places: Vec<f64>, states: Vec<[f64; 2]>) -> Self {
        let mut schedule = Self { times: vec![0.0], places, states, slowness: 1.0 };
        let mut at = 0.0;
        for k in 1..schedule.places.len() {
            at += schedule.interval_time(k - 1);
            schedule.times.push(at);
        }
        schedule
    }

    /// Seconds from rest to rest.
    pub fn duration_s(&self) -> f64 {
        self.times.last().map_or(0.0, |t| t * self.slowness)
    }

    /// The same motion, `factor` times as slow: speed falls by the factor, acceleration by its square, jerk
    /// by its cube. A factor below 1 makes the motion faster.
    pub fn slowed(mut self, factor: f64) -> Self {
        self.slowness *= factor;
        self
    }

    /// The time at which the motion is at the parameter `u`, s.
    pub fn time_at(&self, u: f64) -> f64 {
        let last = self.places.len().saturating_sub(1);
        let (Some(&first), Some(&end)) = (self.places.first(), self.places.last()) else { return 0.0 };
        if last < 3 || u.is_nan() || u <= first {
            return 0.0;
        }
        if u >= end {
            return self.duration_s();
        }
        let k = self.places.partition_point(|&at| at <= u).clamp(1, last) - 1;
        let h = self.places[k + 1] - self.places[k];
        let x = u - self.places[k];
        let span = self.times[k + 1] - self.times[k];
        let within = if k == 0 {
            span * (x / h).cbrt()
        } else if k + 1 == last {
            span * (1.0 - ((h - x) / h).cbrt())
        } else {
            let [b, slope] = self.states[k];
            let a = 0.5 * (self.states[k + 1][1] - slope) / h;
            crossing(x, b, (b + x * (slope + a * x)).max(0.0), a)
        };
        (self.times[k] + within) * self.slowness
    }

    /// The intervals of the parameter in each of which the motion follows one formula.
    pub fn intervals(&self) -> impl Iterator<Item = [f64; 2]> {
        self.places.windows(2).map(|pair| [pair[0], pair[1]])
    }

    /// The motion over a part of the interval `k`.
    pub(super) fn part(&self, k: usize, range: [f64; 2]) -> Part {
        let x = range.map(|u| u - self.places[k]);
        if k == 0 || k + 2 == self.places.len() {
            Part::Rest(self.rest_ranges(k, x))
        } else {
            Part::Moving(self.parabola(k, 0.5 * (x[0] + x[1])))
        }
    }

    /// The ranges over the part `x` of the first or last interval.
    fn rest_ranges(&self, k: usize, [from, to]: [f64; 2]) -> Ranges {
        let h = self.places[k + 1] - self.places[k];
        let span = self.times[k + 1] - self.times[k];
        let j = 6.0 * h / span.powi(3);
        let time = |d: f64| span * (d / h).cbrt();
        let (near, far) = if k == 0 { (time(from), time(to)) } else { (time(h - to), time(h - from)) };
        let acceleration = if k == 0 { [j * near, j * far] } else { [-j * far, -j * near] };
        let f = 1.0 / self.slowness;
        Ranges {
            speed: [near, far].map(|t| 0.5 * j * t * t * f),
            acceleration: acceleration.map(|a| a * f * f),
            jerk: [j * f * f * f; 2],
        }
    }

    /// The coefficients of the square of the speed in another interval about the place `x`.
    fn parabola(&self, k: usize, x: f64) -> [f64; 3] {
        let h = self.places[k + 1] - self.places[k];
        let [b, slope] = self.states[k];
        let a = 0.5 * (self.states[k + 1][1] - slope) / h;
        [b + x * (slope + a * x), slope + 2.0 * a * x, a].map(|c| c / (self.slowness * self.slowness))
    }

    fn interval_time(&self, k: usize) -> f64 {
        let h = self.places[k + 1] - self.places[k];
        if k == 0 {
            return 3.0 * h / self.states[1][0].sqrt();
        }
        if k + 2 == self.places.len() {
            return 3.0 * h / self.states[k][0].sqrt();
        }
        let [b, slope] = self.states[k];
        let [b_end, slope_end] = self.states[k + 1];
        crossing(h, b, b_end, 0.5 * (slope_end - slope) / h)
    }

    /// The motion at the time `t`, s; at rest before the start and after the end.
    pub fn at(&self, t: f64) -> Motion {
        let last = self.places.len().saturating_sub(1);
        let t = t / self.slowness;
        let f = 1.0 / self.slowness;
        if last < 3 || t.is_nan() || t <= 0.0 {
            let u = self.places.first().copied().unwrap_or(0.0);
            return Motion { u, speed: 0.0, acceleration: 0.0, jerk: 0.0 };
        }
        if t >= self.times[last] {
            return Motion { u: self.places[last], speed: 0.0, acceleration: 0.0, jerk: 0.0 };
        }
        let k = self.times.partition_point(|&at| at <= t).clamp(1, last) - 1;
        let (from, to) = (self.places[k], self.places[k + 1]);
        let h = to - from;
        let x = t - self.times[k];
        let span = self.times[k + 1] - self.times[k];
        let [u, speed, acceleration, jerk] = if k == 0 {
            let j = 6.0 * h / span.powi(3);
            [from + j * x.powi(3) / 6.0, 0.5 * j * x * x, j * x, j]
        } else if k + 1 == last {
            let (j, x) = (6.0 * h / span.powi(3), span - x);
            [to - j * x.powi(3) / 6.0, 0.5 * j * x * x, -j * x, j]
        } else {
            let [b, slope] = self.states[k];
            let a = 0.5 * (self.states[k + 1][1] - slope) / h;
            let (v, g) = (b.sqrt(), 0.5 * slope);
            let (s, c) = sine_and_cosine(a, x);
            // (c - 1) / a, with the half angle to keep its digits.
            let half = sine_and_cosine(a, 0.5 * x).0;
            let u = (from + v * s + g * 2.0 * half * half).clamp(from, to);
            let speed = v * c + g * s;
            [u, speed, v * a * s + g * c, a * speed]
        };
        Motion { u, speed: speed * f, acceleration: acceleration * f * f, jerk: jerk * f * f * f }
    }
}

/// Below this square of the argument, functions are computed by series: four terms are exact to rounding, and
/// the closed forms lose digits.
const SERIES: f64 = 1e-4;

/// The time over the length h, where b goes from `b` to `b_end` with b'' = 2 a.
fn crossing(h: f64, b: f64, b_end: f64, a: f64) -> f64 {
    let x = h / (b.sqrt() + b_end.sqrt());
    let z = a * x * x;
    if z.abs() < SERIES {
        2.0 * x * (1.0 + z * (1.0 / 3.0 + z * (0.2 + z / 7.0)))
    } else if z > 0.0 {
        2.0 * x * z.sqrt().atanh() / z.sqrt()
    } else {
        2.0 * x * (-z).sqrt().atan() / (-z).sqrt()
    }
}

/// sinh(w t) / w and cosh(w t) for w^2 = a; sine and cosine for negative a.
fn sine_and_cosine(a: f64, t: f64) -> (f64, f64) {
    let z = a * t * t;
    if z.abs() < SERIES {
        (
            t * (1.0 + z / 6.0 * (1.0 + z / 20.0 * (1.0 + z / 42.0))),
            1.0 + 0.5 * z * (1.0 + z / 12.0 * (1.0 + z / 30.0)),
        )
    } else if z > 0.0 {
        (t * z.sqrt().sinh() / z.sqrt(), z.sqrt().cosh())
    } else {
        (t * (-z).sqrt().sin() / (-z).sqrt(), (-z).sqrt().cos())
    }
}

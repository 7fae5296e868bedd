//! The fastest motions of one coordinate from rest, within limits of speed, acceleration and jerk.
//!
//! # Guarantees
//! With the largest jerk j and the largest speed V, a motion from rest has at the time t an acceleration of
//! at most j t. At the speed v its acceleration is at most the root of 2 j (V - v): a larger one cannot fall
//! to 0 before the speed exceeds V. [`SCurve`] has the largest acceleration that these two inequalities and
//! its own limit allow, so no other motion from rest is faster or farther at any time.

use crate::operations::five_axis::schedule::Limits;

/// Bisections of a time or of a speed. They find it to rounding.
const BISECTIONS: usize = 50;

/// Infinite limits count as so large that they are reached after this time, s. Times are then too long by
/// twice this at most.
pub const INSTANT_S: f64 = 1e-9;

/// The motion from rest that is as far as possible at every time: its speed rises along the letter S and
/// stays.
pub struct SCurve {
    limits: Limits,
    /// How long the acceleration rises, and then falls, s.
    jerk_s: f64,
    /// How long the acceleration is constant between both, s.
    constant_s: f64,
}

/// The limits with finite numbers; the speed is finite.
fn finite(limits: &Limits) -> Limits {
    let acceleration = limits.acceleration.min(limits.speed / INSTANT_S);
    Limits { acceleration, jerk: limits.jerk.min(acceleration / INSTANT_S), ..*limits }
}

/// How long the jerk and the constant acceleration last that lead from rest to the speed, s.
fn phases(Limits { speed, acceleration, jerk }: &Limits) -> [f64; 2] {
    let jerk_s = (acceleration / jerk).min((speed / jerk).sqrt());
    [jerk_s, (speed / (jerk * jerk_s) - jerk_s).max(0.0)]
}

impl SCurve {
    /// The curve to a finite speed.
    pub fn new(limits: &Limits) -> Self {
        let limits = finite(limits);
        let [jerk_s, constant_s] = phases(&limits);
        Self { limits, jerk_s, constant_s }
    }

    /// The least time after which a coordinate can be `distance` away from where it rested, if its speed
    /// stays below `cap` until then, s.
    pub fn time_to(&self, distance: f64, cap: f64) -> f64 {
        if !(distance > 0.0 && cap > 0.0) {
            return 0.0;
        }
        let (mut low, mut high) = (0.0, 2.0 * self.jerk_s + self.constant_s);
        for _ in 0..BISECTIONS {
            let middle = 0.5 * (low + high);
            let [speed, way] = self.at(middle);
            if speed < cap && way < distance { low = middle } else { high = middle }
        }
        low + (distance - self.at(low)[1]).max(0.0) / cap.min(self.limits.speed)
    }

    /// Speed and way before the speed is full.
    fn at(&self, t: f64) -> [f64; 2] {
        let &Self { limits: Limits { speed, jerk, .. }, jerk_s, constant_s } = self;
        let whole = 2.0 * jerk_s + constant_s;
        if t <= jerk_s {
            [0.5 * jerk * t * t, jerk * t * t * t / 6.0]
        } else if t <= jerk_s + constant_s {
            let (x, first) = (t - jerk_s, 0.5 * jerk * jerk_s * jerk_s);
            let acceleration = jerk * jerk_s;
            [first + acceleration * x, first * jerk_s / 3.0 + x * (first + 0.5 * acceleration * x)]
        } else {
            // The curve is symmetric about its middle.
            let left = whole - t;
            let lacking = jerk * left * left;
            [speed - 0.5 * lacking, speed * (0.5 * whole - left) + lacking * left / 6.0]
        }
    }
}

/// The least time over a distance from rest to rest, s, with a finite speed.
pub fn rest_to_rest(distance: f64, limits: &Limits) -> f64 {
    let limits = finite(limits);
    // The way to a speed and back is the speed times the time to it.
    let time_to = |speed: f64| {
        let [jerk_s, constant_s] = phases(&Limits { speed, ..limits });
        2.0 * jerk_s + constant_s
    };
    let way = limits.speed * time_to(limits.speed);
    if way <= distance {
        return time_to(limits.speed) + distance / limits.speed;
    }
    let (mut low, mut high) = (0.0, limits.speed);
    for _ in 0..BISECTIONS {
        let speed = 0.5 * (low + high);
        if speed * time_to(speed) < distance { low = speed } else { high = speed }
    }
    2.0 * time_to(low)
}

#[cfg(test)]
mod tests {
    use super::*;

    const LIMITS: Limits = Limits { speed: 50.0, acceleration: 3000.0, jerk: 50_000.0 };

    /// Small steps of time with the largest legal jerk.
    fn stepped(limits: &Limits, distance: f64, cap: f64) -> f64 {
        let (mut t, mut a, mut v, mut x, dt) = (0.0, 0.0_f64, 0.0_f64, 0.0, 1e-6);
        while x < distance {
            a = (a + limits.jerk * dt)
                .min(limits.acceleration)
                .min((2.0 * limits.jerk * (limits.speed - v).max(0.0)).sqrt());
            v += a * dt;
            x += v.min(cap) * dt;
            t += dt;
        }
        t
    }

    #[test]
    fn the_curve_is_that_of_small_steps() {
        let slow = Limits { acceleration: 500.0, ..LIMITS };
        for limits in [LIMITS, slow] {
            for distance in [0.01, 0.3, 1.0, 5.0, 30.0] {
                for cap in [10.0, 49.0, 1e9] {
                    let found = SCurve::new(&limits).time_to(distance, cap);
                    let stepped = stepped(&limits, distance, cap);
                    assert!((found - stepped).abs() < 2e-5 + 1e-4 * stepped, "{limits:?} {distance} {cap}");
                }
            }
        }
    }

    #[test]
    fn a_long_way_takes_the_full_speed_and_both_ramps() {
        // Ramps of 2 sqrt(v / j) that cover half of their time at full speed.
        let ramp = 2.0 * (50.0_f64 / 50_000.0).sqrt();
        assert!((rest_to_rest(100.0, &LIMITS) - (2.0 + ramp)).abs() < 1e-9);
        // A short way: four phases of the same jerk over j t^3 / 32.
        assert!((rest_to_rest(0.05, &LIMITS) - (32.0_f64 * 0.05 / 50_000.0).cbrt()).abs() < 1e-9);
    }

    #[test]
    fn infinite_limits_take_no_time() {
        let free = Limits { speed: 50.0, acceleration: f64::INFINITY, jerk: f64::INFINITY };
        assert!((rest_to_rest(100.0, &free) - 2.0).abs() < 1e-6);
        assert!((SCurve::new(&free).time_to(100.0, 25.0) - 4.0).abs() < 1e-6);
        let no_jerk = Limits { acceleration: 1000.0, ..free };
        assert!((rest_to_rest(1.0, &no_jerk) - 2.0 * (1.0_f64 / 1000.0).sqrt()).abs() < 1e-6);
    }
}

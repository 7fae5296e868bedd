//! Bounds of the use of the limits over a range of the parameter, from bounds of the derivatives of the path.
//!
//! # Method
//! 1. Bound speed, acceleration and jerk of u in each interval: b is a parabola, so that its Bernstein form
//!    bounds it; b' is linear and b'' constant. In the first and last interval all are monotonic.
//! 2. Multiply and add the ranges of path and motion, by interval arithmetic.
//!
//! # Guarantees
//! But for rounding, no limit is exceeded in the range after [`Schedule::slowed`] by the result. The bound
//! approaches the true use in proportion to the length of the range: halve long ranges.

use super::profile::{Ranges, Schedule};
use super::station::{Limits, TipLimits};

/// The ranges of the derivatives of one coordinate, each as its least and its most.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DerivativeBounds {
    pub first: [f64; 2],
    pub second: [f64; 2],
    pub third: [f64; 2],
}

impl Schedule {
    /// The factor by which the motion has to be slowed to keep all limits for `range` of the parameter; below
    /// 1, limits are left to spare. `speed_cap` is the most du/dt in the range. `bounds` and `limits` have
    /// one entry for each coordinate.
    pub fn slowdown_for(
        &self,
        range: [f64; 2],
        bounds: &[DerivativeBounds],
        speed_cap: f64,
        limits: &[Limits],
        tip: Option<&TipLimits>,
    ) -> f64 {
        let mut factor = 0.0f64;
        for motion in self.ranges(range) {
            factor = factor.max(motion.speed[1] / speed_cap);
            let (mut tip_acceleration, mut tip_jerk) = (0.0, 0.0);
            for (k, (d, l)) in bounds.iter().zip(limits).enumerate() {
                let [speed, acceleration, jerk] = used(d, &motion);
                let needed = (speed / l.speed).max((acceleration / l.acceleration).sqrt());
                factor = factor.max(needed).max((jerk / l.jerk).cbrt());
                if k < 3 {
                    tip_acceleration += acceleration * acceleration;
                    tip_jerk += jerk * jerk;
                }
            }
            if let Some(tip) = tip {
                factor = factor.max((tip_acceleration.sqrt() / tip.acceleration).sqrt());
                factor = factor.max((tip_jerk.sqrt() / tip.jerk).cbrt());
            }
        }
        factor
    }
}

/// The largest speed, acceleration and jerk of a coordinate.
fn used(d: &DerivativeBounds, motion: &Ranges) -> [f64; 3] {
    let Ranges { speed, acceleration, jerk } = *motion;
    let square = [speed[0] * speed[0], speed[1] * speed[1]];
    let cube = [square[0] * speed[0], square[1] * speed[1]];
    let mixed = product(speed, acceleration);
    [
        product(d.first, speed),
        sum(product(d.second, square), product(d.first, acceleration)),
        sum(
            sum(product(d.third, cube), product(d.first, jerk)),
            product(d.second, [3.0 * mixed[0], 3.0 * mixed[1]]),
        ),
    ]
    .map(|[low, high]| high.max(-low))
}

fn product([a, b]: [f64; 2], [c, d]: [f64; 2]) -> [f64; 2] {
    let all = [a * c, a * d, b * c, b * d];
    [all.iter().copied().fold(f64::INFINITY, f64::min), all.iter().copied().fold(f64::NEG_INFINITY, f64::max)]
}

fn sum(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0] + b[0], a[1] + b[1]]
}

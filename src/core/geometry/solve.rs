//! Numerical searches for functions of one number: a root, the place of the largest value, and the bisection
//! of a range.

use std::convert::Infallible;

/// Halvings after which no range of floating point numbers can be halved again.
pub const TO_ROUNDING: usize = 2_200;

/// Bisects a range: `holds` is true at its first place and false at its last place. Returns a part of the
/// range with the same property, after `halvings` halvings, or earlier if the range cannot be halved again.
///
/// # Errors
/// The error of `holds`.
pub fn try_bisect<E>(
    [mut inside, mut outside]: [f64; 2],
    halvings: usize,
    mut holds: impl FnMut(f64) -> Result<bool, E>,
) -> Result<[f64; 2], E> {
    for _ in 0..halvings {
        let middle = 0.5 * (inside + outside);
        if middle == inside || middle == outside {
            break;
        }
        *if holds(middle)? { &mut inside } else { &mut outside } = middle;
    }
    Ok([inside, outside])
}

/// As [`try_bisect`], for a `holds` that cannot fail.
pub fn bisect(range: [f64; 2], halvings: usize, mut holds: impl FnMut(f64) -> bool) -> [f64; 2] {
    let Ok(halved) = try_bisect(range, halvings, |x| Ok::<_, Infallible>(holds(x)));
    halved
}

/// The most steps in the search for a root; it takes five to ten.
const STEPS: usize = 60;

/// The root in `range` of a function that falls, to rounding. Without a root, the end of the range that is
/// nearest to it. The method is regula falsi, in the Illinois variant.
pub fn falling_root(range: [f64; 2], f: impl Fn(f64) -> f64) -> f64 {
    highest_place(range, 0.0, f)
}

/// A place in `range` at which a function with the falling derivative `f` is largest, or smaller than there
/// by at most `accuracy`.
pub fn highest_place([mut low, mut high]: [f64; 2], accuracy: f64, f: impl Fn(f64) -> f64) -> f64 {
    let (mut above, mut below) = (f(low), f(high));
    if above <= 0.0 {
        return low;
    }
    if below >= 0.0 {
        return high;
    }
    let mut side = 0;
    for _ in 0..STEPS {
        let trial = (low * below - high * above) / (below - above);
        if trial <= low || trial >= high {
            break;
        }
        let value = f(trial);
        if value.abs() * (high - low) <= accuracy {
            return trial;
        }
        // The value at the end that stays is halved, so that both ends move.
        if value > 0.0 {
            (low, above) = (trial, value);
            below *= if side == 1 { 0.5 } else { 1.0 };
            side = 1;
        } else {
            (high, below) = (trial, value);
            above *= if side == -1 { 0.5 } else { 1.0 };
            side = -1;
        }
    }
    if above < -below { low } else { high }
}

/// Steps in the search for a largest value: more would find nothing beyond rounding.
const SECTIONS: usize = 60;

/// The place where a function is largest in a range in which it has one maximum, by golden section search.
pub fn largest_place([mut low, mut high]: [f64; 2], f: impl Fn(f64) -> f64) -> f64 {
    const GOLDEN: f64 = 0.618_033_988_749_894_9;
    for _ in 0..SECTIONS {
        let (a, b) = (high - GOLDEN * (high - low), low + GOLDEN * (high - low));
        if f(a) < f(b) {
            low = a;
        } else {
            high = b;
        }
    }
    0.5 * (low + high)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn roots_are_found_to_rounding_and_kept_in_the_range() {
        assert!((falling_root([0.0, 2.0], |x| 2.0 - x * x) - 2f64.sqrt()).abs() < 1e-15);
        assert_eq!(falling_root([0.0, 1.0], |x| 2.0 - x), 1.0);
        assert_eq!(falling_root([3.0, 5.0], |x| 2.0 - x), 3.0);
        assert!((falling_root([-1.0, 1e9], |x| (0.5 - x).cbrt()) - 0.5).abs() < 1e-6);
    }

    #[test]
    fn bisection_ends_beside_the_limit_of_what_holds() {
        let [inside, outside] = bisect([0.0, 4.0], TO_ROUNDING, |x| x * x < 2.0);
        assert!(inside * inside < 2.0 && outside * outside >= 2.0 && outside == inside.next_up());
        assert_eq!(bisect([8.0, 0.0], 3, |x| x > 5.0), [6.0, 5.0]);
        assert_eq!(try_bisect([0.0, 1.0], 1, |_| Err("stopped")), Err("stopped"));
    }

    #[test]
    fn maxima_are_found_inside_and_at_ends() {
        assert!((largest_place([0.0, 4.0], |x| 3.0 - (x - 1.0).powi(2)) - 1.0).abs() < 1e-7);
        assert!((largest_place([0.0, 4.0], |x| x) - 4.0).abs() < 1e-11);
    }
}

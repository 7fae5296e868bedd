//! Roots and largest values of functions of one number.

/// Steps in the search for a root; it takes five to ten.
const STEPS: usize = 60;

/// The root in `range` of a function that falls, or the end of the range that is nearest to it, by regula falsi (the Illinois
/// variant), to rounding.
pub fn falling_root([mut low, mut high]: [f64; 2], f: impl Fn(f64) -> f64) -> f64 {
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
        if value == 0.0 {
            return trial;
        }
        // The end that stays counts half, so that both ends move.
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

/// Steps in the search for a largest value: as far as rounding lets it be told.
const SECTIONS: usize = 60;

/// Where a function is largest in a range in which it has one top, by golden sections.
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
    fn tops_are_found_inside_and_at_ends() {
        assert!((largest_place([0.0, 4.0], |x| 3.0 - (x - 1.0).powi(2)) - 1.0).abs() < 1e-7);
        assert!((largest_place([0.0, 4.0], |x| x) - 4.0).abs() < 1e-11);
    }
}

//! Numbers of a drawing: round numbers for scales and ticks, and coordinates as text.

/// 1, 2 or 5 times a power of ten.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct RoundNumber {
    mantissa: u8,
    exponent: i32,
}

impl RoundNumber {
    pub const ONE: RoundNumber = RoundNumber { mantissa: 1, exponent: 0 };

    pub fn power_of_ten(exponent: i32) -> Self {
        Self { mantissa: 1, exponent }
    }

    /// The least round number not below `value`, which is above zero.
    pub fn at_least(value: f64) -> Self {
        let mut round = Self::power_of_ten(value.log10().floor() as i32);
        while round.value() < value {
            round = round.next();
        }
        round
    }

    pub fn value(self) -> f64 {
        self.times(1.0)
    }

    /// `count` times this number, rounded once, to the nearest floating-point number.
    pub fn times(self, count: f64) -> f64 {
        let power = 10f64.powi(self.exponent.abs());
        let product = count * f64::from(self.mantissa);
        if self.exponent < 0 { product / power } else { product * power }
    }

    pub fn next(self) -> Self {
        match self.mantissa {
            1 => Self { mantissa: 2, ..self },
            2 => Self { mantissa: 5, ..self },
            _ => Self::power_of_ten(self.exponent + 1),
        }
    }

    pub fn previous(self) -> Self {
        match self.mantissa {
            5 => Self { mantissa: 2, ..self },
            2 => Self { mantissa: 1, ..self },
            _ => Self { mantissa: 5, exponent: self.exponent - 1 },
        }
    }

    /// The number of decimals that this number needs.
    pub fn decimals(self) -> usize {
        usize::try_from(-self.exponent).unwrap_or(0)
    }

    /// The number as the scale of a drawing: `2:1`, `1:50`.
    pub fn as_scale(self) -> String {
        let reciprocal = match self.mantissa {
            1 => Self::power_of_ten(-self.exponent),
            mantissa => Self { mantissa: 10 / mantissa, exponent: -self.exponent - 1 },
        };
        if self.exponent < 0 { format!("1:{}", reciprocal.value()) } else { format!("{}:1", self.value()) }
    }
}

/// `value` with at most two decimals, without an exponent and without a negative zero.
pub fn fixed(value: f64) -> String {
    let hundredths = hundredths(value);
    let sign = if hundredths < 0 { "-" } else { "" };
    let (whole, rest) = (hundredths.unsigned_abs() / 100, hundredths.unsigned_abs() % 100);
    match (rest, rest % 10) {
        (0, _) => format!("{sign}{whole}"),
        (_, 0) => format!("{sign}{whole}.{}", rest / 10),
        _ => format!("{sign}{whole}.{rest:02}"),
    }
}

/// `value` in hundredths, as it is written. A hundredth of a millimetre of paper is finer than any printer.
pub fn hundredths(value: f64) -> i64 {
    (value * 100.0).round() as i64
}

/// `value` with `decimals`, without a negative zero.
pub fn with_decimals(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    let is_zero = text.bytes().all(|byte| matches!(byte, b'-' | b'0' | b'.'));
    if is_zero { text.trim_start_matches('-').to_owned() } else { text }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn round_numbers_follow_each_other() {
        let mut round = RoundNumber::power_of_ten(-2);
        let mut values = Vec::new();
        for _ in 0..10 {
            values.push(round.value());
            assert_eq!(round.next().previous(), round);
            round = round.next();
        }
        assert_eq!(values, [0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0]);
        for (value, expected) in [(0.011, 0.02), (0.02, 0.02), (3.0, 5.0), (5.1, 10.0), (1000.0, 1000.0)] {
            assert_eq!(RoundNumber::at_least(value).value(), expected);
        }
    }

    #[test]
    fn scales_are_named_as_on_a_drawing() {
        let mut scale = RoundNumber::power_of_ten(2);
        let mut names = Vec::new();
        for _ in 0..11 {
            names.push(scale.as_scale());
            scale = scale.previous();
        }
        assert_eq!(
            names,
            ["100:1", "50:1", "20:1", "10:1", "5:1", "2:1", "1:1", "1:2", "1:5", "1:10", "1:20"]
        );
    }

    #[test]
    fn coordinates_are_short_and_plain() {
        for (value, text) in [
            (0.0, "0"),
            (-0.0, "0"),
            (-0.004, "0"),
            (0.006, "0.01"),
            (-0.05, "-0.05"),
            (12.5, "12.5"),
            (12.499, "12.5"),
            (-100.0, "-100"),
            (1e9, "1000000000"),
        ] {
            assert_eq!(fixed(value), text);
        }
        assert_eq!(with_decimals(-0.0004, 3), "0.000");
        assert_eq!(with_decimals(-0.0006, 3), "-0.001");
    }
}

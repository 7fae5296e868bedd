//! Numbers as they are written, for languages in which the form of a number counts.

/// A number, its parts as text.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Number<'a> {
    pub sign: Option<char>,
    /// The digits before the point.
    pub whole: &'a str,
    /// The digits behind the point; none where no point is written.
    pub fraction: Option<&'a str>,
    pub value: f64,
}

impl<'a> Number<'a> {
    /// The number at the start of `text`, and the text behind the number. `None` where `text` does not begin
    /// with a number.
    pub fn at_start(text: &'a str) -> Option<(Self, &'a str)> {
        let sign = text.chars().next().filter(|c| matches!(c, '+' | '-'));
        let (whole, mut rest) = digits(text.strip_prefix(['+', '-']).unwrap_or(text));
        let mut fraction = None;
        if let Some(behind) = rest.strip_prefix('.') {
            let split = digits(behind);
            (fraction, rest) = (Some(split.0), split.1);
        }
        let value: f64 = text[..text.len() - rest.len()].parse().ok()?;
        value.is_finite().then_some((Self { sign, whole, fraction, value }, rest))
    }

    /// The number, if it is all of `text`.
    pub fn whole_of(text: &'a str) -> Option<Self> {
        Self::at_start(text).filter(|(_, rest)| rest.is_empty()).map(|(number, _)| number)
    }

    pub fn decimals(self) -> usize {
        self.fraction.unwrap_or_default().len()
    }

    /// Whether the number has at most this many digits before the point, and behind it.
    pub fn fits(self, most_whole: usize, most_decimals: u8) -> bool {
        self.whole.len() <= most_whole && self.decimals() <= usize::from(most_decimals)
    }

    /// The number, if it is written with nothing but digits.
    pub fn count(self) -> Option<u32> {
        if self.sign.is_some() || self.fraction.is_some() {
            return None;
        }
        self.whole.parse().ok()
    }
}

/// The digits at the start of `text`, and the text behind them.
fn digits(text: &str) -> (&str, &str) {
    text.split_at(text.bytes().take_while(u8::is_ascii_digit).count())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_has_one_sign_one_point_and_a_digit() {
        let (number, rest) = Number::at_start("-12.50X").unwrap();
        assert_eq!((number.sign, number.whole, number.fraction), (Some('-'), "12", Some("50")));
        assert_eq!((number.value, number.decimals(), rest), (-12.5, 2, "X"));
        assert_eq!(Number::whole_of(".5").map(|number| number.value), Some(0.5));
        assert_eq!(Number::whole_of("+5.").map(|number| number.value), Some(5.0));
        for text in ["", "-", ".", "+.", "--1", "X", "1.2.3", "1-2", "1e5", " 1", "é", "inf", "NaN"] {
            assert_eq!(Number::whole_of(text), None, "{text}");
        }
        assert_eq!(Number::whole_of(&"9".repeat(400)), None);
    }

    #[test]
    fn a_count_is_digits_alone() {
        let count = |text| Number::whole_of(text).unwrap().count();
        assert_eq!(
            (count("12"), count("+12"), count("12."), count("4294967296")),
            (Some(12), None, None, None)
        );
    }
}

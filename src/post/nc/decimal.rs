//! Numbers of a program as exact decimals.

/// Decimals of a millionth, the finest number that is read.
const DECIMALS: u8 = 6;

/// Largest coordinate, in millionths of a unit: ten kilometres in mm. The sum of two such coordinates fits an
/// `i64`, and neighbouring coordinates stay different as `f64`.
const MAX_COORDINATE: i64 = 10_000_000_000_000;

/// Digits before the point. With six digits behind the point they fit an `i64`.
const MAX_WHOLE_DIGITS: usize = 12;

/// Millionths in one unit of the last decimal, by decimals.
pub const SCALES: [i64; DECIMALS as usize + 1] = [1_000_000, 100_000, 10_000, 1000, 100, 10, 1];

/// A number as it is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Decimal {
    /// Its value in millionths.
    pub millionths: i64,
    /// How many digits stand behind the point, zeros beyond the sixth left out.
    pub decimals: u8,
    pub has_point: bool,
}

impl Decimal {
    /// Reads the number at the start of `bytes`: a sign, digits, a point, digits. Returns the length of its
    /// text, which is zero where there is no digit, and its value. The value is `None` without a digit, with
    /// more than twelve digits before the point, or where the number is no multiple of a millionth.
    #[inline]
    pub fn at_start(bytes: &[u8]) -> (usize, Option<Self>) {
        let (is_negative, mut rest) = match bytes {
            [sign @ (b'-' | b'+'), rest @ ..] => (*sign == b'-', rest),
            rest => (false, rest),
        };
        let (mut value, mut whole) = (0i64, 0);
        while let [digit @ b'0'..=b'9', behind @ ..] = rest {
            value = value.wrapping_mul(10).wrapping_add(i64::from(digit - b'0'));
            (whole, rest) = (whole + 1, behind);
        }
        let (mut has_point, mut fraction, mut is_exact) = (false, 0, true);
        if let [b'.', behind @ ..] = rest {
            (has_point, rest) = (true, behind);
            while let [digit @ b'0'..=b'9', behind @ ..] = rest {
                if fraction < usize::from(DECIMALS) {
                    value = value.wrapping_mul(10).wrapping_add(i64::from(digit - b'0'));
                } else {
                    is_exact &= *digit == b'0';
                }
                (fraction, rest) = (fraction + 1, behind);
            }
        }
        let length = bytes.len() - rest.len();
        if whole + fraction == 0 {
            return (0, None);
        }
        if whole > MAX_WHOLE_DIGITS || !is_exact {
            return (length, None);
        }
        let decimals = fraction.min(usize::from(DECIMALS));
        let millionths = value * SCALES[decimals];
        let millionths = if is_negative { -millionths } else { millionths };
        (length, Some(Self { millionths, decimals: decimals as u8, has_point }))
    }

    /// The number as a coordinate in millionths of a unit of the program, and its decimals. With `increment`
    /// given, a number without a point counts units of that decimal. `None` beyond ten kilometres.
    pub fn coordinate(self, increment: Option<u8>) -> Option<(i64, u8)> {
        let (millionths, decimals) = match increment {
            Some(decimals) if !self.has_point => (self.millionths / 10i64.pow(u32::from(decimals)), decimals),
            _ => (self.millionths, self.decimals),
        };
        is_coordinate(millionths).then_some((millionths, decimals))
    }

    /// The number of a G or M word, in tenths.
    pub fn tenths(self) -> Option<i32> {
        let is_code = self.millionths >= 0 && self.millionths % 100_000 == 0;
        is_code.then(|| i32::try_from(self.millionths / 100_000).ok()).flatten()
    }
}

/// Whether a sum of coordinates, in millionths, is small enough for a coordinate.
pub fn is_coordinate(millionths: i64) -> bool {
    millionths.abs() <= MAX_COORDINATE
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Option<Decimal> {
        let (length, value) = Decimal::at_start(text.as_bytes());
        assert_eq!(length, text.len(), "{text}");
        value
    }

    #[test]
    fn every_usual_spelling_is_read() {
        let cases = [
            ("10", 10_000_000, 0),
            ("10.", 10_000_000, 0),
            (".5", 500_000, 1),
            ("-0", 0, 0),
            ("+3", 3_000_000, 0),
            ("-.470", -470_000, 3),
            ("007.123456000", 7_123_456, 6),
            ("999999999999.999999", 999_999_999_999_999_999, 6),
        ];
        for (text, millionths, decimals) in cases {
            let number = read(text).unwrap();
            assert_eq!((number.millionths, number.decimals), (millionths, decimals), "{text}");
            assert_eq!(number.has_point, text.contains('.'), "{text}");
        }
    }

    #[test]
    fn a_number_that_millionths_cannot_hold_is_none() {
        for text in ["", "1.0000001", "1234567890123", "0000000000001", ".00000010"] {
            assert_eq!(read(text), None, "{text}");
        }
    }

    #[test]
    fn a_number_has_one_sign_one_point_and_a_digit() {
        for (text, length) in
            [("10", 2), ("10.", 3), (".5", 2), ("-0Y", 2), ("+3.20 ", 5), ("1.2.3", 3), ("1-2", 1)]
        {
            assert_eq!(Decimal::at_start(text.as_bytes()).0, length, "{text}");
        }
        for text in ["", "-", ".", "-.", "#1", "[1]", "- 5", "--1", "X"] {
            assert_eq!(Decimal::at_start(text.as_bytes()), (0, None), "{text}");
        }
    }

    #[test]
    fn a_number_without_a_point_counts_least_increments_where_the_control_does() {
        let coordinate = |text: &str| read(text).unwrap().coordinate(Some(3));
        assert_eq!(coordinate("10"), Some((10_000, 3)));
        assert_eq!(coordinate("10."), Some((10_000_000, 0)));
        let huge = read("999999999999").unwrap();
        assert_eq!(huge.coordinate(None), None);
        assert!(huge.coordinate(Some(3)).is_none());
    }

    #[test]
    fn codes_are_whole_tenths_from_zero() {
        let tenths = |text: &str| read(text).unwrap().tenths();
        assert_eq!((tenths("01"), tenths("59.1"), tenths("-0")), (Some(10), Some(591), Some(0)));
        assert_eq!((tenths("1.05"), tenths("-1"), tenths("999999999")), (None, None, None));
    }
}

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
    /// Reads the number at the start of `bytes`: a sign, digits, a point, digits. Returns the length of its text,
    /// which is zero where there is no digit, and its value. The value is `None` without a digit, with more than
    /// twelve digits before the point, or where the number is no multiple of a millionth.
    #[inline]
    pub fn at_start(bytes: &[u8]) -> (usize, Option<Self>) {
        let digit = |at: usize| bytes.get(at).filter(|c| c.is_ascii_digit()).map(|c| i64::from(c - b'0'));
        let sign = usize::from(matches!(bytes.first(), Some(b'+' | b'-')));
        let (mut at, mut value) = (sign, 0i64);
        while let Some(digit) = digit(at) {
            value = value.wrapping_mul(10).wrapping_add(digit);
            at += 1;
        }
        let (whole, has_point, mut is_exact) = (at - sign, bytes.get(at) == Some(&b'.'), true);
        let point = at;
        at += usize::from(has_point);
        if has_point {
            while let Some(digit) = digit(at) {
                if at - point <= usize::from(DECIMALS) {
                    value = value.wrapping_mul(10).wrapping_add(digit);
                } else {
                    is_exact &= digit == 0;
                }
                at += 1;
            }
        }
        let behind = at - point - usize::from(has_point);
        if whole + behind == 0 {
            return (0, None);
        }
        if whole > MAX_WHOLE_DIGITS || !is_exact {
            return (at, None);
        }
        let decimals = behind.min(usize::from(DECIMALS));
        let millionths = value * SCALES[decimals];
        let millionths = if bytes[0] == b'-' { -millionths } else { millionths };
        (at, Some(Self { millionths, decimals: decimals as u8, has_point }))
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

//! Numbers of a program as exact decimals.

/// Decimals of a millionth.
pub const DECIMALS: u8 = 6;

/// No coordinate that is understood is larger, in millionths: ten kilometres in mm, and far from where a sum of two could
/// not be held or two neighbours would be one double.
const MAX_COORDINATE: i64 = 10_000_000_000_000;

/// Digits before the point; with six behind it they fit an integer.
const MAX_WHOLE_DIGITS: usize = 12;

/// A number as it is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Number {
    /// Its value in millionths.
    pub millionths: i64,
    /// How many digits stand behind the point.
    pub decimals: u8,
    pub has_point: bool,
}

impl Number {
    /// The number at the start of `bytes`, behind blanks, and where it ends; none where there is no plain one, or one
    /// that millionths cannot hold.
    pub fn read(bytes: &[u8]) -> Option<(Self, usize)> {
        let mut at = blanks(bytes);
        let is_negative = bytes.get(at) == Some(&b'-');
        at += usize::from(is_negative || bytes.get(at) == Some(&b'+'));
        let (whole, digits) = digits(&bytes[at..]);
        if digits > MAX_WHOLE_DIGITS {
            return None;
        }
        at += digits;
        let mut number = Self { millionths: whole * 1_000_000, decimals: 0, has_point: false };
        let mut count = 0;
        if bytes.get(at) == Some(&b'.') {
            at += 1;
            number.has_point = true;
            count = number.take_fraction(&bytes[at..])?;
            at += count;
        }
        if digits + count == 0 {
            return None;
        }
        if is_negative {
            number.millionths = -number.millionths;
        }
        Some((number, at))
    }

    /// As a coordinate in millionths of a unit of the program and its decimals. Where `increment` is given, a number
    /// without a point counts units of that decimal.
    pub fn coordinate(self, increment: Option<u8>) -> Option<(i64, u8)> {
        let (millionths, decimals) = match increment {
            Some(decimals) if !self.has_point => (self.millionths / 10i64.pow(u32::from(decimals)), decimals),
            _ => (self.millionths, self.decimals),
        };
        is_coordinate(millionths).then_some((millionths, decimals))
    }

    /// As the number of a G or M word, in tenths.
    pub fn tenths(self) -> Option<i32> {
        let is_code = self.millionths >= 0 && self.millionths % 100_000 == 0;
        is_code.then(|| i32::try_from(self.millionths / 100_000).ok()).flatten()
    }

    /// Takes the digits behind the point and returns how many there are; beyond the sixth there may only be zeros.
    fn take_fraction(&mut self, bytes: &[u8]) -> Option<usize> {
        let kept = &bytes[..bytes.len().min(usize::from(DECIMALS))];
        let (value, mut count) = digits(kept);
        self.decimals = u8::try_from(count).ok()?;
        self.millionths += value * 10i64.pow(u32::from(DECIMALS - self.decimals));
        if count == usize::from(DECIMALS) {
            count += bytes[count..].iter().take_while(|&&c| c == b'0').count();
        }
        let is_finer = bytes.get(count).is_some_and(u8::is_ascii_digit);
        (!is_finer).then_some(count)
    }
}

/// Whether a sum of coordinates, in millionths, is one.
pub fn is_coordinate(millionths: i64) -> bool {
    millionths.abs() <= MAX_COORDINATE
}

/// How many bytes at the start of `bytes` are blanks.
pub fn blanks(bytes: &[u8]) -> usize {
    bytes.iter().position(|&c| c != b' ' && c != b'\t').unwrap_or(bytes.len())
}

/// The value and the count of the digits at the start of `bytes`; of the first eighteen the value, if there are more.
fn digits(bytes: &[u8]) -> (i64, usize) {
    let (mut value, mut count) = (0i64, 0);
    for c in bytes.iter().take_while(|c| c.is_ascii_digit()) {
        if count < 18 {
            value = value * 10 + i64::from(c - b'0');
        }
        count += 1;
    }
    (value, count)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_usual_spelling_is_read() {
        let cases = [
            ("10", 10_000_000, 0),
            ("10.", 10_000_000, 0),
            (".5", 500_000, 1),
            ("-0", 0, 0),
            (" 5", 5_000_000, 0),
            ("+3", 3_000_000, 0),
            ("-.470Y", -470_000, 3),
            ("\t007.123456000", 7_123_456, 6),
        ];
        for (text, millionths, decimals) in cases {
            let (number, end) = Number::read(text.as_bytes()).unwrap();
            assert_eq!((number.millionths, number.decimals), (millionths, decimals), "{text}");
            assert_eq!(end, text.trim_end_matches('Y').len(), "{text}");
        }
    }

    #[test]
    fn what_is_no_plain_number_is_none() {
        for text in ["", "-", ".", "#1", "[1]", "- 5", "X", "1.0000001", "1234567890123", "--1"] {
            assert_eq!(Number::read(text.as_bytes()), None, "{text}");
        }
        // The rest of these begins no word, which is for the line to say.
        assert_eq!(Number::read(b"1e5").map(|(_, end)| end), Some(1));
        assert_eq!(Number::read(b"1.2.3").map(|(_, end)| end), Some(3));
    }

    #[test]
    fn without_a_point_least_increments_are_counted_where_they_are() {
        let read = |text: &str| Number::read(text.as_bytes()).unwrap().0.coordinate(Some(3));
        assert_eq!(read("10"), Some((10_000, 3)));
        assert_eq!(read("10."), Some((10_000_000, 0)));
        let huge = Number::read(b"999999999999").unwrap().0;
        assert_eq!(huge.coordinate(None), None);
        assert!(huge.coordinate(Some(3)).is_none());
    }
}

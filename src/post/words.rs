//! Writes numbers, words and comments as text.

use std::fmt::Write;

use super::WriteError;
use super::dialect::Numbers;
use toolpathd_core::geometry::curve::Direction;
use toolpathd_core::geometry::plane::Plane;
use toolpathd_core::toolpath::program::Units;
use toolpathd_core::toolpath::units::FeedRate;

/// The letters of the axes, and of the offsets of centres and control points along the axes.
pub const AXES: [char; 3] = ['X', 'Y', 'Z'];
pub const OFFSETS: [char; 3] = ['I', 'J', 'K'];

/// Relative error that a feed word should keep. The word gets the fewest decimals that keep it.
const FEED_AGREEMENT: f64 = 5e-5;

/// Largest relative error of a feed word that may be larger than the feed. A feed that all decimals of the
/// control state no better is rounded down, because a slower feed harms neither tool nor part.
const LARGEST_FEED_ERROR: f64 = 5e-4;

/// Largest feed, in units of the program per minute. A larger feed is refused.
const MAX_FEED: f64 = 1e9;

/// The word that selects a plane.
pub fn plane(plane: Plane) -> &'static str {
    match plane {
        Plane::Xy => "G17",
        Plane::Zx => "G18",
        Plane::Yz => "G19",
    }
}

/// The word of motion for an arc.
pub fn arc(direction: Direction) -> &'static str {
    match direction {
        Direction::Cw => "G2",
        Direction::Ccw => "G3",
    }
}

/// The offsets of a centre along the plane's axes, each with its axis, in the order I, J, K.
pub fn center_offsets(plane: Plane, center: [i64; 2]) -> [(usize, i64); 2] {
    let [first, second, _] = plane.axes();
    let mut offsets = [(first, center[0]), (second, center[1])];
    offsets.sort_unstable();
    offsets
}

/// A feed in units of the program per minute: `digits` times ten to the power of minus `decimals`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FeedWord {
    pub digits: i64,
    pub decimals: u8,
}

impl FeedWord {
    /// The feed in units of the program per minute.
    pub fn value(self) -> f64 {
        self.digits as f64 / 10f64.powi(i32::from(self.decimals))
    }
}

/// The feed word for `rate`, in the units of the program. Where the decimals of the control state the feed
/// badly, the word is slower.
///
/// # Errors
/// When the feed is below the smallest number that the control reads, or too large for nine digits.
pub fn feed(rate: FeedRate, units: Units, numbers: &Numbers) -> Result<FeedWord, WriteError> {
    let (value, most) = (rate.mm_per_min() / units.mm(), numbers.feed_decimals(units));
    let word = per_minute(value, most).or_else(|| per_minute_at_most(value, most));
    word.ok_or(WriteError::Feed { mm_per_min: rate.mm_per_min() })
}

/// The word for a value by the minute with `most` decimals at most. `None` where the decimals state the value
/// badly, and where the value is too large.
pub fn per_minute(value: f64, most: u8) -> Option<FeedWord> {
    let with = |decimals: u8| FeedWord {
        digits: (value * 10f64.powi(i32::from(decimals))).round() as i64,
        decimals,
    };
    let agrees = |word: &FeedWord, part: f64| (word.value() - value).abs() <= part * value;
    (0..=most)
        .filter(|_| value <= MAX_FEED)
        .map(with)
        .find(|word| agrees(word, FEED_AGREEMENT))
        .or_else(|| Some(with(most)).filter(|word| value <= MAX_FEED && agrees(word, LARGEST_FEED_ERROR)))
}

/// The word for at most a value by the minute, with `most` decimals at most: 0.2 % less, or as little less as
/// the decimals allow. `None` where it is too small or too large.
pub fn per_minute_at_most(value: f64, most: u8) -> Option<FeedWord> {
    const LESS: f64 = 0.002;
    let with = |decimals: u8| FeedWord {
        digits: (value * 10f64.powi(i32::from(decimals))).floor() as i64,
        decimals,
    };
    if value > MAX_FEED {
        return None;
    }
    let near = (0..=most).map(with).find(|word| word.value() >= (1.0 - LESS) * value);
    near.or_else(|| Some(with(most)).filter(|word| word.digits > 0))
}

/// A spindle speed as digits and decimals. A whole number stays whole; other speeds are rounded to the
/// decimals that the control reads.
///
/// # Errors
/// When the speed is no number, rounds to zero or is above the largest speed that the control reads.
pub fn spindle(rpm: f64, numbers: &Numbers) -> Result<FeedWord, WriteError> {
    if !(rpm > 0.0 && rpm <= f64::from(numbers.max_spindle_rpm)) {
        return Err(WriteError::SpindleSpeed { rpm });
    }
    let decimals = if rpm == rpm.round() { 0 } else { numbers.spindle_decimals };
    let digits = (rpm * 10f64.powi(i32::from(decimals))).round() as i64;
    if digits == 0 { Err(WriteError::SpindleSpeed { rpm }) } else { Ok(FeedWord { digits, decimals }) }
}

/// Appends `digits` times ten to the power of minus `decimals`, always with that many decimals, without an
/// exponent and never as minus zero.
pub fn push_fixed(text: &mut String, digits: i64, decimals: u8) {
    let sign = if digits < 0 { "-" } else { "" };
    let scale = 10u64.pow(u32::from(decimals));
    let (whole, fraction) = (digits.unsigned_abs() / scale, digits.unsigned_abs() % scale);
    // Writing into a string does not fail.
    let _ = if decimals > 0 {
        write!(text, "{sign}{whole}.{fraction:0width$}", width = usize::from(decimals))
    } else {
        write!(text, "{sign}{whole}")
    };
}

/// The number alone; see [`push_fixed`].
pub fn fixed(digits: i64, decimals: u8) -> String {
    let mut text = String::new();
    push_fixed(&mut text, digits, decimals);
    text
}

/// Signs that no control takes for the end of a comment or for a command within a comment.
const KEPT: &str = "._-/+,=#'";

/// User text as it may stand in a comment: capitals, digits, space and [`KEPT`], no longer than `limit`.
/// Letters of other scripts are transliterated. Any other character becomes a space, and several spaces
/// become one.
pub fn cleaned(text: &str, limit: usize) -> String {
    let mut clean = String::new();
    let ascii = deunicode::deunicode_with_tofu(text, " ");
    for c in ascii.chars() {
        if clean.len() >= limit {
            break;
        }
        match c.to_ascii_uppercase() {
            c if c.is_ascii_uppercase() || c.is_ascii_digit() || KEPT.contains(c) => clean.push(c),
            _ if clean.is_empty() || clean.ends_with(' ') => {}
            _ => clean.push(' '),
        }
    }
    clean.truncate(clean.trim_end().len());
    clean
}

/// User text as [`cleaned`] makes it, no longer than `limit`. A longer text ends behind a whole word; a word
/// that is longer alone is cut, but within no number.
pub fn shortened(text: &str, limit: usize) -> String {
    let mut clean = cleaned(text, limit + 1);
    if clean.len() > limit {
        let kept = clean.rfind(' ').unwrap_or_else(|| outside_number(&clean, limit));
        clean.truncate(kept);
    }
    clean
}

/// The last place up to `limit` at which a word can be cut within no number; 0 if there is none.
fn outside_number(word: &str, limit: usize) -> usize {
    let is_number = |c: char| c.is_ascii_digit() || "+-.".contains(c);
    word[..limit].trim_end_matches(is_number).len()
}

/// The words with which comments begin that LinuxCNC obeys, in any of its versions. The interpreter skips
/// blanks, and reads small letters as capitals. A word too many here costs no more than a label.
const ACTIVE: [&str; 10] =
    ["MSG", "PRINT", "DEBUG", "LOG", "PROBEOPEN", "PROBECLOSE", "PYRUN", "PYRELOAD", "ABORT", "SYSTEM"];

/// Whether a text in capitals begins as a comment that a control may obey.
pub fn begins_like_a_command(text: &str) -> bool {
    let packed = text.replace(' ', "");
    let is_python = packed.starts_with("PY,") || text.split(' ').next() == Some("PY");
    is_python || ACTIVE.iter().any(|word| packed.starts_with(word))
}

/// Clean text in lines of at most `limit` characters, broken between words where possible, else within no
/// number where possible.
pub fn lines(text: &str, limit: usize) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for mut word in text.split(' ') {
        match lines.last_mut() {
            Some(line) if line.len() + 1 + word.len() <= limit => {
                line.push(' ');
                line.push_str(word);
                continue;
            }
            _ => {}
        }
        while word.len() > limit {
            let cut = Some(outside_number(word, limit)).filter(|cut| *cut > 0).unwrap_or(limit.max(1));
            let (part, rest) = word.split_at(cut);
            lines.push(part.to_owned());
            word = rest;
        }
        lines.push(word.to_owned());
    }
    lines
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::dialects::fanuc::FANUC;
    use crate::dialects::heidenhain::HEIDENHAIN;
    use crate::dialects::linuxcnc::LINUXCNC;

    #[test]
    fn fixed_numbers_keep_their_decimals_and_have_no_minus_zero() {
        let cases = [(0, 3, "0.000"), (-5, 3, "-0.005"), (10_500, 3, "10.500"), (-1_234_567, 4, "-123.4567")];
        for (digits, decimals, text) in cases {
            assert_eq!(fixed(digits, decimals), text);
        }
        assert_eq!(fixed(800, 0), "800");
        assert_eq!(fixed(i64::MIN, 6), "-9223372036854.775808");
    }

    #[test]
    fn a_feed_has_the_fewest_decimals_that_keep_its_value() {
        let word = |mm_per_min, units| {
            let word =
                feed(FeedRate::from_mm_per_min(mm_per_min).unwrap(), units, &LINUXCNC.numbers).unwrap();
            fixed(word.digits, word.decimals)
        };
        assert_eq!(word(800.0, Units::Mm), "800");
        assert_eq!(word(333.333, Units::Mm), "333.33");
        assert_eq!(word(1000.0, Units::Inch), "39.37");
        assert_eq!(word(0.05, Units::Mm), "0.05");
        let slow =
            feed(FeedRate::from_mm_per_min(0.028_37).unwrap(), Units::Mm, &HEIDENHAIN.numbers).unwrap();
        assert_eq!(fixed(slow.digits, slow.decimals), "0.028");
        let tiny = feed(FeedRate::from_mm_per_min(1e-9).unwrap(), Units::Mm, &LINUXCNC.numbers);
        assert_eq!(tiny, Err(WriteError::Feed { mm_per_min: 1e-9 }));
        assert!(feed(FeedRate::from_mm_per_min(1e300).unwrap(), Units::Mm, &LINUXCNC.numbers).is_err());
    }

    #[test]
    fn a_spindle_speed_is_whole_if_the_value_or_the_control_is() {
        let (free, whole) = (LINUXCNC.numbers, FANUC.numbers);
        assert_eq!(spindle(12_000.0, &free), Ok(FeedWord { digits: 12_000, decimals: 0 }));
        assert_eq!(spindle(12.5, &free), Ok(FeedWord { digits: 12_500, decimals: 3 }));
        assert_eq!(spindle(12.7, &whole), Ok(FeedWord { digits: 13, decimals: 0 }));
        for rpm in [0.0, -1.0, 1e-9, 1e9, f64::NAN, f64::INFINITY] {
            assert!(spindle(rpm, &free).is_err() && spindle(rpm, &whole).is_err());
        }
        assert!(spindle(100_000.0, &whole).is_err() && spindle(0.4, &whole).is_err());
    }

    #[test]
    fn user_text_cannot_leave_its_comment() {
        assert_eq!(cleaned("die) G0 Z-99 (msg,%\nx", 100), "DIE G0 Z-99 MSG, X");
        assert_eq!(cleaned("Füßchen\u{2028}é", 100), "FUSSCHEN E");
        assert_eq!(cleaned("Müller Ж 木 50+/=#", 100), "MULLER ZH MU 50+/=#");
        assert_eq!(cleaned(" \n ", 100), "");
        assert_eq!(cleaned(&"(".repeat(10_000), 100), "");
    }

    #[test]
    fn a_shortened_text_ends_behind_a_word_and_within_no_number() {
        assert_eq!(shortened("range 10.125 to 20.250", 22), "RANGE 10.125 TO 20.250");
        for limit in 16..22 {
            assert_eq!(shortened("range 10.125 to 20.250", limit), "RANGE 10.125 TO".to_owned(), "{limit}");
        }
        assert_eq!(shortened("part12345-678.9 x", 10), "PART");
        assert_eq!(shortened("plateholder", 5), "PLATE");
        assert_eq!(shortened("1234567", 5), "");
    }

    #[test]
    fn active_comments_are_told_by_their_first_letters() {
        for name in [
            "LOG,A",
            "LOGOPEN X",
            "L O G",
            "DEBUG 5",
            "PROBEOPEN A.TXT",
            "PRINT",
            "MSG HI",
            "PY",
            "PYRUN X",
            "ABORT",
        ] {
            assert!(begins_like_a_command(name), "{name}");
        }
        for name in ["DIE 7", "PYRAMID", "A LOG", "PROBE", "7 MSG", ""] {
            assert!(!begins_like_a_command(name), "{name}");
        }
    }

    proptest! {
        #[test]
        fn cleaned_text_has_only_allowed_characters(text in "(?s).{0,300}", limit in 0usize..200) {
            let clean = cleaned(&text, limit);
            prop_assert!(clean.len() <= limit);
            prop_assert!(clean.bytes().all(|c| c.is_ascii_uppercase() || c.is_ascii_digit() || b" ._-/+,=#'".contains(&c)));
            prop_assert_eq!(clean.trim(), &clean);
        }

        #[test]
        fn fixed_numbers_read_back(digits in any::<i64>(), decimals in 0u8..=6) {
            let text = fixed(digits, decimals);
            let read: i128 = text.replace('.', "").parse().unwrap();
            prop_assert_eq!(read, i128::from(digits));
            prop_assert!(!text.contains('e'));
        }
    }
}

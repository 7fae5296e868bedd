//! What a reader has assumed, and what it has left alone.

use std::collections::BTreeMap;

/// Something that a caller should know before it trusts the figures of a program.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Note {
    #[error("no G20 and no G21 stands before line {line}: lengths there count as {units}")]
    UnitsAssumed { line: usize, units: &'static str },
    #[error(
        "{count} numbers have no decimal point, the first in line {line}: they count as least increments, so that 10 is {ten_mm} mm"
    )]
    LeastIncrements { count: usize, line: usize, ten_mm: f64 },
    #[error("{count} numbers have no decimal point, the first in line {line}: they count as whole units")]
    WholeUnits { count: usize, line: usize },
    #[error("{word} in line {line} is a pause of {seconds} s ({minutes:.1} minutes)")]
    LongDwell { line: usize, word: String, seconds: f64, minutes: f64 },
    #[error("controls of this dialect disagree on {word} in line {line}: it counts as {seconds} s")]
    DwellAssumed { line: usize, word: String, seconds: f64 },
    #[error(
        "line {line} selects {offset}, whose zero is not given: places are in coordinates of the active work offset, and the bounds join them as if their zeros were one"
    )]
    UnrelatedOffset { line: usize, offset: String },
    #[error(
        "line {line} sets a place that was not known before: places from there on are in coordinates of their own"
    )]
    UnrelatedPlace { line: usize },
    #[error(
        "cutter compensation from line {line} on counts as wear: the path is that of the cutter's centre"
    )]
    CompensationAsWear { line: usize },
    #[error(
        "cutter compensation from line {line} on is computed for a radius of {radius_mm} mm, the value of the offset with its D; it begins at right angles to the second block, and goes round outside corners along the tangents"
    )]
    CompensationComputed { line: usize, radius_mm: f64 },
    #[error("the factor in line {line} has no point: it counts as thousandths, {factor}")]
    ScaleAssumed { line: usize, factor: f64 },
    #[error(
        "pecks from line {line} on come down to {mm} mm above the last peck, which a setting of the control decides"
    )]
    PeckClearance { line: usize, mm: f64 },
    #[error("the main program ends with M99 in line {line} and runs again and again: one run is read")]
    RunsAgain { line: usize },
    #[error(
        "the two radii of {count} arcs differ, the first in line {line}: exact arcs stand for them, up to {most_mm:.4} mm away"
    )]
    ArcsMoved { count: usize, line: usize, most_mm: f64 },
    #[error(
        "neither G90.1 nor G91.1 stands before the arc of line {line}: the distance of its centre is the one that fits"
    )]
    CentersAssumed { line: usize },
    #[error(
        "no code for the unit of lengths stands before line {line}: lengths there count as {units}, the unit of the control"
    )]
    BasicUnits { line: usize, units: &'static str },
    #[error(
        "line {line} leaves the plane G17 with a tool: its length is taken to stay along Z, which a setting of the control decides"
    )]
    LengthAxisAssumed { line: usize },
    #[error(
        "the incremental way in line {line} runs the change of the zero before it, too, as the control does unless its setting 42440 says otherwise"
    )]
    ShiftTraversed { line: usize },
    #[error(
        "the feeds of the cycle in line {line} count tenths of an inch per minute, as F does in this program"
    )]
    TenthsOfInch { line: usize },
    #[error("tap and spindle of the cycle in line {line} are taken to follow the feed")]
    Tapping { line: usize },
    #[error(
        "the scaling of line {line} counts along all three axes, which old controls may limit to the plane"
    )]
    ScalesAllAxes { line: usize },
}

/// Words that were left alone, by their text.
#[derive(Debug, Clone, Default)]
pub struct LeftAlone {
    words: BTreeMap<String, LeftWord>,
    pub total: usize,
}

/// How often one word was left alone.
#[derive(Debug, Clone, PartialEq)]
pub struct LeftWord {
    pub word: String,
    pub count: usize,
    /// The line where it stands first, counted from 1.
    pub line: usize,
}

/// Words that are told apart.
const MAX_WORDS: usize = 200;

impl LeftAlone {
    pub fn add(&mut self, word: &str, line: usize) {
        self.total += 1;
        let is_known = self.words.contains_key(word);
        let word = if is_known || self.words.len() < MAX_WORDS { word } else { "others" };
        let own = self.words.entry(word.to_owned()).or_insert_with(|| LeftWord {
            word: word.to_owned(),
            count: 0,
            line,
        });
        own.count += 1;
    }

    /// The words, in the order of their texts.
    pub fn into_words(self) -> Vec<LeftWord> {
        self.words.into_values().collect()
    }
}

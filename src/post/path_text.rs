//! Reads the path of a tool with five axes from text that other programs wrote: CL data and NC programs.
//!
//! [`cl::read`] reads APT CL data. [`nc::read`] reads NC programs in the words of Fanuc, LinuxCNC, Siemens
//! and Heidenhain. Both are made for text of any origin: each word is read, or left alone and told, or
//! refused with its line. [`cl::WORDS`] and [`nc::TABLES`] say which.

pub mod cl;
pub mod nc;
pub mod table;
pub(super) mod tokens;

mod trail;
mod way;

use std::ops::RangeInclusive;

use nalgebra::{Unit, UnitVector3, Vector3};

use toolpathd_core::machine::Straying;
use toolpathd_core::toolpath::cutting::Coolant;
use toolpathd_core::toolpath::pose::Waypoint;
use toolpathd_core::toolpath::units::FeedRate;

/// A vector that is shorter is no direction.
const SHORTEST_VECTOR: f64 = 1e-6;

/// The feeds that are read, mm/min: those that a request may ask for.
const FEEDS_MM_PER_MIN: RangeInclusive<f64> = 1e-3..=1e6;

/// Coordinates are smaller than this, mm.
const LARGEST_MM: f64 = 1e6;

/// Numbers of tools are at most this: those that a request may name.
const LARGEST_TOOL: f64 = 99_999.0;

/// What the readers need besides the text.
#[derive(Debug, Clone, Copy)]
pub struct ReadSettings {
    /// The feed of motions for which the text states none.
    pub feed: Option<FeedRate>,
    /// The most poses.
    pub limit: usize,
    /// How far the straight ways between poses may leave an arc of the text.
    pub chords: Straying,
}

/// What a text says.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct PathText {
    pub path: Vec<Waypoint>,
    pub tool: Option<Said<u32>>,
    /// Of a spindle that turns clockwise.
    pub spindle_rpm: Option<Said<f64>>,
    /// The first coolant with which the tool cuts.
    pub coolant: Option<Said<Coolant>>,
    /// The number of a work offset from G54 to G59.
    pub work_offset: Option<u8>,
    pub name: Option<String>,
    /// The comments before the first motion.
    pub comments: Vec<String>,
    pub left_alone: Vec<LeftWord>,
}

/// A value with the line that states it, from 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Said<T> {
    pub value: T,
    pub line: usize,
}

/// A word that changes nothing of the answer.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LeftWord {
    pub word: String,
    /// How often it stands in the text.
    pub count: usize,
    /// Where it stands first, from 1.
    pub line: usize,
}

/// The spindle at one place of a text.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
enum TextSpindle {
    #[default]
    Off,
    /// Clockwise, 1/min. `None` where no speed is known.
    On(Option<f64>),
}

impl TextSpindle {
    fn rpm(self) -> Option<f64> {
        match self {
            Self::Off => None,
            Self::On(rpm) => rpm,
        }
    }
}

/// A line that cannot be read.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("line {line}: {fault}")]
pub struct PathTextError {
    /// From 1.
    pub line: usize,
    pub fault: PathFault,
}

/// Why a line is refused.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PathFault {
    #[error("{word} is refused: {advice}")]
    Refused { word: String, advice: &'static str },
    #[error(
        "{0:?} is no known word; leave it out where it moves nothing, else write the motion in known words"
    )]
    Unknown(String),
    #[error("{0:?} has no meaning in this line; leave it out, or name the code to which it belongs")]
    Unused(String),
    #[error("{0} is written twice in this line; write it once")]
    Twice(String),
    #[error("two words of this line exclude each other; write them in lines of their own")]
    Conflict,
    #[error("{0:?} is no number")]
    BadNumber(String),
    #[error("{0} needs a number")]
    NoNumber(String),
    #[error("an argument is blank; write its value, or leave the comma out")]
    Blank,
    #[error("a comment or a text has no end; close it in its line")]
    OpenComment,
    #[error(
        "{word} has no decimal point, but a number of line {line} ends with one: some controls count {word} in thousandths; write the point in both"
    )]
    NoPoint { word: String, line: usize },
    #[error("a coordinate is larger than a million mm, or no number")]
    Coordinate,
    #[error("{0} numbers where a point has three, or six with the tool axis")]
    Count(usize),
    #[error("the tool axis has no length")]
    NoAxis,
    #[error("no feed is known here")]
    NoFeed,
    #[error("under G93 every cut needs its own F: one by the minutes that the block takes")]
    NoBlockTime,
    #[error("the feed {0} is no feed")]
    BadFeed(f64),
    #[error("a feed by turns of the spindle needs a spindle speed before it")]
    NoSpindle,
    #[error("the text has more than {0} poses; divide it")]
    TooMany(usize),
    #[error(
        "this block needs more than {most} poses to stay within the tolerance; write it as several blocks, or send a larger tolerance"
    )]
    TooFine { most: usize },
    #[error(
        "the block takes {seconds} s for {way_mm} mm, which is faster than {most} mm/min; write a smaller F"
    )]
    TooFast { seconds: f64, way_mm: f64, most: f64 },
    #[error("the line moves axes, but no word of motion is in force; write G0, G1, G2 or G3")]
    NoMotion,
    #[error(
        "the place or the angles before this motion are not known; state X, Y, Z and the angles in a rapid before it"
    )]
    NoStart,
    #[error(
        "this motion cuts without tip control, and other motions have it; send each kind as a request of its own"
    )]
    OutsideTip,
    #[error("the arc has no centre; write its offsets from the start, or its radius")]
    NoCenter,
    #[error(
        "the radii at both ends of the arc differ by {mismatch_mm:.4} mm; write its centre with more decimals"
    )]
    Radii { mismatch_mm: f64 },
    #[error("the arc reaches no such end; write its end on the circle")]
    ArcEnd,
    #[error("the direction from which the circle is entered is not known; write INDIRV along the circle")]
    NoDirection,
    #[error("the machine has no axis {0}")]
    NoSuchAxis(char),
    #[error("the angles of rotary axes need a machine")]
    NoMachine,
    #[error(
        "tool {second} follows {}; send the motions of each tool as a request of its own",
        first.map_or_else(|| "motions of an unnamed tool".to_owned(), |first| format!("tool {first}"))
    )]
    SecondTool { first: Option<u32>, second: u32 },
    #[error(
        "the spindle changes between cuts, and an answer has one speed; send each part as a request of its own"
    )]
    SpindleChanges,
    #[error("the work offset changes between motions; send each part as a request of its own")]
    OffsetChanges,
    #[error("the shift of coordinates is in force under tip control; write coordinates of the work offset")]
    Shifted,
    #[error(
        "{word} stops between motions, where an answer has no stop; send both parts as requests of their own"
    )]
    Stops { word: &'static str },
    #[error(
        "{word} takes the tool off the path, and motions follow; send both parts as requests of their own"
    )]
    Leaves { word: String },
}

/// A fault, with its line where it is another than the one that is being read.
#[derive(Debug)]
struct Fault {
    line: Option<usize>,
    fault: PathFault,
}

impl Fault {
    fn at(self, line: usize) -> PathTextError {
        PathTextError { line: self.line.unwrap_or(line), fault: self.fault }
    }
}

impl From<PathFault> for Fault {
    fn from(fault: PathFault) -> Self {
        Self { line: None, fault }
    }
}

fn direction(vector: Vector3<f64>) -> Result<UnitVector3<f64>, PathFault> {
    Unit::try_new(vector, SHORTEST_VECTOR)
        .filter(|unit| unit.iter().all(|x| x.is_finite()))
        .ok_or(PathFault::NoAxis)
}

fn feed(mm_per_min: f64) -> Result<FeedRate, PathFault> {
    let is_legal = FEEDS_MM_PER_MIN.contains(&mm_per_min);
    FeedRate::from_mm_per_min(mm_per_min).filter(|_| is_legal).ok_or(PathFault::BadFeed(mm_per_min))
}

fn coordinate(mm: f64) -> Result<f64, PathFault> {
    if mm.abs() <= LARGEST_MM { Ok(mm) } else { Err(PathFault::Coordinate) }
}

/// The number of a tool. Zero is no tool.
fn tool_number(value: f64) -> Result<u32, PathFault> {
    if value.fract() == 0.0 && (0.0..=LARGEST_TOOL).contains(&value) {
        Ok(value as u32)
    } else {
        Err(PathFault::BadNumber(value.to_string()))
    }
}

fn refusal(word: &str, row: &table::Row) -> PathFault {
    PathFault::Refused { word: word.to_owned(), advice: row.says }
}

#[cfg(test)]
mod tests;

//! Reads the path of a tool with five axes from text that other programs wrote: CL data and NC programs.
//!
//! [`cl::read`] reads APT CL data. [`nc::read`] reads NC programs in the words of Fanuc, Siemens and
//! Heidenhain. Both are made for text of any origin: what moves nothing is skipped, and what would move the
//! tool in a way that is not read is refused with its line.

pub mod cl;
pub mod nc;
pub(super) mod tokens;

use std::ops::RangeInclusive;

use nalgebra::{Unit, UnitVector3, Vector3};

use toolpathd_core::toolpath::units::FeedRate;

/// A vector that is shorter is no direction.
const SHORTEST_VECTOR: f64 = 1e-6;

/// The feeds that are read, mm/min: those that a request may ask for.
const FEEDS_MM_PER_MIN: RangeInclusive<f64> = 1e-3..=1e6;

/// Coordinates are smaller than this, mm.
const LARGEST_MM: f64 = 1e6;

/// What the readers need besides the text.
#[derive(Debug, Clone, Copy)]
pub struct ReadSettings {
    /// The feed of motions for which the text states none.
    pub feed: Option<FeedRate>,
    /// The most poses.
    pub limit: usize,
}

/// A line that cannot be read.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("line {line}: {fault}")]
pub struct PathTextError {
    /// From 1.
    pub line: usize,
    pub fault: PathFault,
}

#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PathFault {
    #[error("{0:?} is not read; write the motion as straight lines with a tool axis")]
    NotRead(String),
    #[error("{0:?} is no number")]
    BadNumber(String),
    #[error("a coordinate is larger than a million mm, or no number")]
    Coordinate,
    #[error("{0} numbers where a point has three, or six with the tool axis")]
    Count(usize),
    #[error("the tool axis has no length")]
    NoAxis,
    #[error("no feed is known here")]
    NoFeed,
    #[error("the feed {0} is no feed")]
    BadFeed(f64),
    #[error("a feed by turns of the spindle needs a spindle speed before it")]
    NoSpindle,
    #[error("the text has more than {0} poses; divide it")]
    TooMany(usize),
    #[error("arcs are not read; write lines")]
    Arc,
    #[error("coordinates relative to the place before are not read; write absolute ones")]
    Relative,
    #[error("the machine has no axis {0}")]
    NoSuchAxis(char),
    #[error("the angles of rotary axes need a machine")]
    NoMachine,
    #[error("variables and macros are not read")]
    Variables,
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

//! The blocks of a run that are still to be written, with their text and their end points.

use std::ops::Range;

use nalgebra::Point3;

use super::block::Block;
use super::modes::{Feed, Modes, default_decimals};
use crate::dialect::Dialect;
use crate::nc::{Distance, FeedMode, Motion, SCALES, is_coordinate};
use toolpathd_core::toolpath::program::{Resolution, Units};

/// Largest relative difference of the speeds that the blocks of a run imply under G93. A larger value joins
/// blocks of visibly different speeds; a smaller value ends runs at the rounding of feeds.
const SPEED_AGREEMENT: f64 = 0.01;

/// Most bytes of the text of a run that is not written yet. Blocks alone never reach it; remarks may.
const MAX_TEXT: usize = 1024 * 1024;

/// One block of a run. Places within the block are counted from the start of its text.
#[derive(Debug, Clone, PartialEq)]
pub struct Placed {
    /// The range of the block in the run's text, with the remarks behind it and all line ends.
    pub text: Range<usize>,
    /// The length of its own line, with its line end.
    pub length: usize,
    pub has_comment: bool,
    /// The N word; empty where there is none.
    pub number: Range<usize>,
    /// The start of the first word after the N word.
    pub first: usize,
    pub has_g1: bool,
    /// The F word; empty where there is none.
    pub feed: Range<usize>,
    /// The feed under G93, in inverse minutes.
    pub rate: f64,
}

/// The part of a run that is not written yet, at most a window. Memory is kept between runs.
#[derive(Debug, Default)]
pub struct OpenRun {
    pub text: Vec<u8>,
    pub blocks: Vec<Placed>,
    /// The start and the end of each block, in millionths of a unit of the program. An unknown axis counts
    /// from 0.
    pub units: Vec<[i64; 3]>,
    /// The same points in mm.
    pub points: Vec<Point3<f64>>,
    /// Axes whose position is known in the program's coordinates.
    pub is_known: [bool; 3],
    /// Blanks stand between the words of some block.
    pub is_spaced: bool,
    /// Earlier blocks of the run have been written already.
    pub is_continued: bool,
    decimals: [u8; 2],
    speeds: [f64; 2],
}

/// How the numbers of a run are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Style {
    pub resolution: Resolution,
    /// Zeros at the end of a number are written.
    pub is_padded: bool,
}

/// A block that may be the next of a run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Step {
    to: [i64; 3],
    decimals: [u8; 2],
    feed: Option<Feed>,
    /// Under G93: the feed, and the speed that the feed implies.
    rate: Option<[f64; 2]>,
}

impl OpenRun {
    /// Whether the run has not begun yet. A run whose blocks have all been written counts as begun.
    pub fn is_empty(&self) -> bool {
        self.units.is_empty()
    }

    /// The step of `block` under `modes`, after the last block of the run or as the first block. `None` if
    /// the start or the end is unknown, or if G93 needs a feed and the block has none.
    pub fn step(&self, block: &Block, modes: &Modes, dialect: &Dialect) -> Option<Step> {
        let from = self.units.last().copied().unwrap_or_else(|| modes.at.map(Option::unwrap_or_default));
        let (mut to, mut decimals) = (from, [u8::MAX, 0]);
        let increment = modes.increment(dialect);
        for axis in 0..3 {
            let Some(word) = block.axes[axis] else { continue };
            let (value, written) = word.coordinate(increment)?;
            to[axis] = match modes.distance? {
                Distance::Absolute => modes.at[axis].and(Some(value))?,
                Distance::Incremental => from[axis] + value,
            };
            decimals = [decimals[0].min(written), decimals[1].max(written)];
        }
        let feed = block.feed.as_ref().map(|(number, _)| Feed::of(*number, dialect));
        let mut step = Step { to, decimals, feed, rate: None };
        if modes.feed_mode == Some(FeedMode::InverseTime) {
            let (number, _) = block.feed.as_ref().filter(|(n, _)| increment.is_none() || n.has_point)?;
            let rate = number.millionths as f64 / 1e6;
            let length = (point(to, modes.units) - point(from, modes.units)).norm();
            step.rate = Some([rate, rate * length]).filter(|[_, speed]| *speed > 0.0);
            step.rate?;
        }
        to.into_iter().all(is_coordinate).then_some(step)
    }

    /// Whether `step` belongs to the same run: it has the modal feed, or no feed. Under G93 it has the speed
    /// of the other blocks.
    pub fn continues(&self, step: &Step, modes: &Modes) -> bool {
        match step.rate {
            Some([_, speed]) => {
                let [least, most] = self.speeds;
                speed.max(most) <= (1.0 + SPEED_AGREEMENT) * speed.min(least)
            }
            None => step.feed.is_none() || step.feed == modes.feed,
        }
    }

    /// Takes the next block with its line `text`, and changes `modes` to the state after the block.
    pub fn push(&mut self, text: &[u8], block: &Block, step: &Step, modes: &mut Modes) {
        if self.is_empty() {
            self.begin(modes);
        }
        let start = self.text.len();
        self.text.extend_from_slice(text);
        self.blocks.push(Placed {
            text: start..self.text.len(),
            length: text.len(),
            has_comment: block.has_comment,
            number: block.number.clone(),
            first: block.first,
            has_g1: block.g.has(10),
            feed: block.feed.as_ref().map_or(0..0, |(_, place)| place.clone()),
            rate: step.rate.map_or(0.0, |[rate, _]| rate),
        });
        for axis in 0..3 {
            if block.axes[axis].is_some() && modes.at[axis].is_some() {
                modes.at[axis] = Some(step.to[axis]);
            }
        }
        modes.motion = Some(Motion::Line);
        modes.feed = step.feed.or(modes.feed);
        self.units.push(step.to);
        self.points.push(point(step.to, modes.units));
        self.is_spaced |= block.is_spaced;
        let [least, most] = step.decimals;
        self.decimals = [self.decimals[0].min(least), self.decimals[1].max(most)];
        if let Some([_, speed]) = step.rate {
            self.speeds = [self.speeds[0].min(speed), self.speeds[1].max(speed)];
        }
    }

    /// Takes a line without words, which stands behind the last block.
    pub fn push_remark(&mut self, text: &[u8]) {
        self.text.extend_from_slice(text);
        if let Some(last) = self.blocks.last_mut() {
            last.text.end = self.text.len();
        }
    }

    /// Whether the run has room for a line of this length.
    pub fn has_room(&self, length: usize) -> bool {
        self.text.len() + length <= MAX_TEXT
    }

    /// The line of a block with its line end.
    pub fn line(&self, block: &Placed) -> &[u8] {
        &self.text[block.text.start..block.text.start + block.length]
    }

    /// The remarks behind a block, with their line ends.
    pub fn remarks(&self, block: &Placed) -> &[u8] {
        &self.text[block.text.start + block.length..block.text.end]
    }

    /// The N words of the first `count` blocks.
    pub fn number_words(&self, count: usize) -> impl Iterator<Item = &[u8]> {
        self.blocks[..count].iter().map(|block| &self.line(block)[block.number.clone()])
    }

    /// Forgets the first `count` blocks.
    pub fn drain(&mut self, count: usize) {
        self.is_continued = true;
        let cut = self.blocks.get(count).map_or(self.text.len(), |block| block.text.start);
        self.text.drain(..cut);
        self.blocks.drain(..count);
        self.units.drain(..count);
        self.points.drain(..count);
        for block in &mut self.blocks {
            block.text = block.text.start - cut..block.text.end - cut;
        }
    }

    /// Forgets the run and keeps its memory.
    pub fn clear(&mut self) {
        self.text.clear();
        self.blocks.clear();
        self.units.clear();
        self.points.clear();
        self.is_continued = false;
    }

    /// How the numbers of the run are written; `None` if its points need more decimals than the dialect has.
    /// They have as many decimals as the most precise number of the run, at least the dialect's default, and
    /// more if the points need more. Zeros at the end are written if all numbers of the run have that many
    /// decimals.
    pub fn style(&self, units: Units, dialect: &Dialect) -> Option<Style> {
        let [least, most] = self.decimals;
        let usual = default_decimals(Some(units), dialect);
        let wanted = most.clamp(usual, dialect.max_decimals);
        let decimals = (wanted..=dialect.max_decimals).find(|decimals| self.lies_on(*decimals))?;
        Some(Style {
            resolution: Resolution { units, decimals },
            is_padded: least == most && most == decimals,
        })
    }

    fn begin(&mut self, modes: &Modes) {
        self.is_known = modes.at.map(|at| at.is_some());
        self.is_spaced = false;
        self.decimals = [u8::MAX, 0];
        self.speeds = [f64::INFINITY, 0.0];
        let at = modes.at.map(Option::unwrap_or_default);
        self.units.push(at);
        self.points.push(point(at, modes.units));
    }

    fn lies_on(&self, decimals: u8) -> bool {
        let step = step(decimals);
        self.units.iter().flatten().all(|at| at % step == 0)
    }
}

/// Millionths in one unit of the last decimal.
pub fn step(decimals: u8) -> i64 {
    SCALES[usize::from(decimals)]
}

/// The point in mm, exactly as the grid of the output computes it.
fn point(millionths: [i64; 3], units: Option<Units>) -> Point3<f64> {
    let mm = units.unwrap_or_default().mm();
    Point3::from(millionths.map(|at| at as f64 / 1e6 * mm))
}

//! The blocks of a run that are not yet written, with their text and the points they go to.

use std::ops::Range;

use nalgebra::Point3;

use super::block::Block;
use super::modes::{Distance, Feed, FeedMode, Modes, Motion, default_decimals};
use super::number::{DECIMALS, is_coordinate};
use crate::post::dialect::Dialect;
use crate::toolpath::program::{Resolution, Units};

/// Under G93 blocks of a run have implied speeds that differ by this part at most.
const SPEED_AGREEMENT: f64 = 0.01;

/// One block of a run; places are those of bytes in the run's text.
#[derive(Debug, Clone, PartialEq)]
pub struct Placed {
    /// With its line end.
    pub text: Range<usize>,
    pub number: Range<usize>,
    pub first: usize,
    pub has_g1: bool,
    /// Of the F word; empty where there is none.
    pub feed: Range<usize>,
    /// Under G93, in inverse minutes.
    pub rate: f64,
}

/// A part of a run of at most a window; memory is kept between runs.
#[derive(Debug, Default)]
pub struct Run {
    pub text: Vec<u8>,
    pub blocks: Vec<Placed>,
    /// Where it starts and where each block ends, in millionths of a unit of the program, an axis that is not known from 0.
    pub units: Vec<[i64; 3]>,
    /// The same, mm.
    pub points: Vec<Point3<f64>>,
    /// Whether the position is known in the program's coordinates.
    pub is_known: [bool; 3],
    /// Whether blanks stand between the words of some block.
    pub is_spaced: bool,
    /// Whether blocks of it have been written already.
    pub is_continued: bool,
    decimals: [u8; 2],
    speeds: [f64; 2],
}

/// How the numbers of a run are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Style {
    pub resolution: Resolution,
    /// Whether zeros at the end are written.
    pub is_padded: bool,
}

/// A block that may be the next of a run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Step {
    to: [i64; 3],
    decimals: [u8; 2],
    feed: Option<Feed>,
    /// Under G93: the feed, and the speed it implies.
    rate: Option<[f64; 2]>,
}

impl Run {
    /// Whether it has not begun; when all its blocks have been written, it has.
    pub fn is_empty(&self) -> bool {
        self.units.is_empty()
    }

    /// The step that `block` would be under `modes`, behind what there is or as the first; none where it goes to, or comes
    /// from, what is not known, or lacks the feed it needs.
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

    /// Whether `step` is a block of the same run: it repeats the feed that holds, or says none; under G93 its speed is that
    /// of the others.
    pub fn continues(&self, step: &Step, modes: &Modes) -> bool {
        match step.rate {
            Some([_, speed]) => {
                let [least, most] = self.speeds;
                speed.max(most) <= (1.0 + SPEED_AGREEMENT) * speed.min(least)
            }
            None => step.feed.is_none() || step.feed == modes.feed,
        }
    }

    /// Takes the next block, whose line is `text`, and brings `modes` behind it.
    pub fn push(&mut self, text: &[u8], block: &Block, step: &Step, modes: &mut Modes) {
        if self.is_empty() {
            self.begin(modes);
        }
        let base = self.text.len();
        let moved = |range: &Range<usize>| base + range.start..base + range.end;
        self.text.extend_from_slice(text);
        self.blocks.push(Placed {
            text: base..self.text.len(),
            number: moved(&block.number),
            first: base + block.first,
            has_g1: block.has_g1,
            feed: block.feed.as_ref().map_or(base..base, |(_, range)| moved(range)),
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

    /// Forgets the first `count` blocks.
    pub fn drain(&mut self, count: usize) {
        self.is_continued = true;
        let cut = self.blocks.get(count).map_or(self.text.len(), |block| block.text.start);
        self.text.drain(..cut);
        self.blocks.drain(..count);
        self.units.drain(..count);
        self.points.drain(..count);
        for block in &mut self.blocks {
            for range in [&mut block.text, &mut block.number, &mut block.feed] {
                *range = range.start - cut..range.end - cut;
            }
            block.first -= cut;
        }
    }

    /// Forgets everything but the memory it had.
    pub fn clear(&mut self) {
        self.text.clear();
        self.blocks.clear();
        self.units.clear();
        self.points.clear();
        self.is_continued = false;
    }

    /// How its numbers are written; none where the dialect has not as many decimals as its points need.
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

/// Millionths in one unit of the last of so many decimals.
pub fn step(decimals: u8) -> i64 {
    10i64.pow(u32::from(DECIMALS - decimals))
}

/// The point, mm, exactly as the grid of the output computes it.
fn point(millionths: [i64; 3], units: Option<Units>) -> Point3<f64> {
    let mm = units.unwrap_or_default().mm();
    Point3::from(millionths.map(|at| at as f64 / 1e6 * mm))
}

//! The blocks of a program, with integer coordinates.

use super::words::FeedWord;
use super::{MAX_BLOCKS, WriteError};
use toolpathd_core::geometry::curve::Direction;
use toolpathd_core::geometry::plane::Plane;
use toolpathd_core::toolpath::path::Role;

/// One block of motion or dwell. Positions are absolute, in units of the last decimal.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Block {
    /// Moves the axes that have a value.
    Rapid {
        to: [Option<i64>; 3],
    },
    Line {
        to: [i64; 3],
        feed: FeedWord,
        role: Role,
    },
    /// `center` counts from the start along the plane's first and second axis.
    Arc {
        plane: Plane,
        direction: Direction,
        to: [i64; 3],
        center: [i64; 2],
        feed: FeedWord,
    },
    /// A helix about Z. It turns by `angle`, in ten-thousandths of a degree, from where the tool is, and
    /// so ends beside `to` by a rounding.
    Helix {
        direction: Direction,
        to: [i64; 3],
        center: [i64; 2],
        angle: i64,
        feed: FeedWord,
    },
    /// Stays at the height of its start. `control`, the Bezier control point, counts from the start.
    Parabola {
        to: [i64; 2],
        control: [i64; 2],
        feed: FeedWord,
    },
    Dwell {
        milliseconds: u64,
    },
    /// Begins a canned cycle, by its index.
    BeginCycle {
        index: u32,
    },
    /// One hole of the canned cycle: across, and then all that the cycle does there.
    Hole {
        to: [i64; 2],
        index: u32,
    },
    EndCycle,
    /// A rapid to or from the place where the machine rests between programs.
    Park {
        to: [Option<i64>; 3],
    },
    /// Turns the rotary axes alone, as a rapid.
    Rotate {
        angles: [i64; 2],
    },
    /// Moves the axes that have a value as a rapid. From this block on, X, Y and Z state the place of the
    /// tool tip, also while the tool leans. Where the axes stand in these coordinates is not known
    /// before.
    BeginTipControl {
        to: [Option<i64>; 3],
        axis: AxisWords,
    },
    /// A straight motion with the axis at its end.
    Posed {
        to: [i64; 3],
        axis: AxisWords,
        feed: BlockFeed,
    },
    /// Begins rails where the tip is: `second` is the second point of the tool.
    BeginRails {
        second: [i64; 3],
        feed: FeedWord,
    },
    /// One rail, by its index.
    Rail {
        index: u32,
    },
    /// Ends rails: the next blocks state vectors.
    EndRails,
    /// Ends the modes of leaning tools.
    EndPosed,
}

impl Block {
    /// Whether the block moves or pauses. The others begin or end modes.
    pub fn acts(&self) -> bool {
        !matches!(self, Self::BeginCycle { .. } | Self::EndCycle | Self::EndPosed | Self::EndRails)
    }
}

/// The tool axis as it is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AxisWords {
    /// The angles of both rotary axes, in units of the last decimal of a degree.
    Angles([i64; 2]),
    /// The vector of the tool axis, in units of its last decimal.
    Vector([i64; 3]),
}

/// How fast a motion with an axis runs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BlockFeed {
    Rapid,
    /// The feed of the tip.
    PerMinute(FeedWord),
    /// One by the minutes that the block takes.
    InverseTime(FeedWord),
    /// The feed of a turn about a resting tip.
    DegreesPerMinute(FeedWord),
}

/// The blocks of a program, at most [`MAX_BLOCKS`].
#[derive(Default)]
pub struct Blocks {
    blocks: Vec<Block>,
}

impl Blocks {
    pub fn len(&self) -> usize {
        self.blocks.len()
    }

    pub fn push(&mut self, block: Block) -> Result<(), WriteError> {
        if self.blocks.len() >= MAX_BLOCKS {
            return Err(WriteError::TooManyBlocks { limit: MAX_BLOCKS });
        }
        self.blocks.push(block);
        Ok(())
    }

    /// Adds a pause of at most `most_s`, unless it rounds to no time.
    pub fn dwell(&mut self, seconds: f64, most_s: f64) -> Result<(), WriteError> {
        if seconds > most_s {
            return Err(WriteError::Dwell { seconds, most_s });
        }
        let milliseconds = (seconds * 1000.0).round() as u64;
        if milliseconds > 0 { self.push(Block::Dwell { milliseconds }) } else { Ok(()) }
    }

    pub fn finish(self) -> Vec<Block> {
        self.blocks
    }
}

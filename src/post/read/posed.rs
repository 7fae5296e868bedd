//! Motions that state the tool axis, as every reader yields them.

use crate::toolpath::units::FeedRate;

/// The letters of rotary axes.
pub const ROTARY: [char; 3] = ['A', 'B', 'C'];

/// What the control does with the tip.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum TipMode {
    /// Coordinates are those of the linear axes.
    #[default]
    Off,
    Angles,
    Vectors,
}

/// How long a motion takes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Pace {
    Rapid,
    Feed(FeedRate),
    Seconds(f64),
    /// The axis turns at this many degrees per minute, and the tip rests.
    DegreesPerMinute(f64),
}

/// One motion. Coordinates in mm, angles of A, B and C in degrees, where they are known.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Posed {
    pub from: [Option<f64>; 3],
    pub to: [Option<f64>; 3],
    pub angles: [Option<f64>; 3],
    pub vector: Option<[f64; 3]>,
    pub mode: TipMode,
    pub pace: Pace,
}

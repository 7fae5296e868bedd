//! Motions that state the tool axis, as every reader yields them.

use toolpathd_core::toolpath::units::FeedRate;

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

/// How fast a motion goes, or how long it takes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum PosedFeed {
    Rapid,
    Feed(FeedRate),
    Seconds(f64),
    /// The axis turns at this many degrees per minute, and the tip rests.
    DegreesPerMinute(f64),
}

/// One motion along polynomials of a parameter from 0 to 1, mm.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RailStep {
    pub from: [f64; 3],
    pub to: [f64; 3],
    /// The second point at the start and at the end.
    pub second_from: [f64; 3],
    pub second: [f64; 3],
    /// The coefficients of the powers 2 to 5 of the tip and of the second point.
    pub powers: [[[f64; 3]; 4]; 2],
    pub rate: FeedRate,
}

/// One motion. Coordinates in mm, angles of A, B and C in degrees, where they are known.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Posed {
    pub from: [Option<f64>; 3],
    pub to: [Option<f64>; 3],
    pub angles: [Option<f64>; 3],
    pub vector: Option<[f64; 3]>,
    pub mode: TipMode,
    pub feed: PosedFeed,
}

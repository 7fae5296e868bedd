//! The modal state: what the words of a block set for later blocks.

use toolpathd_core::geometry::curve::Direction;
use toolpathd_core::geometry::plane::Plane;
use toolpathd_core::toolpath::program::Units;

/// The motion of G0 to G3.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Motion {
    Rapid,
    Line,
    Arc(Direction),
}

/// From where coordinates, or the centres of arcs, are counted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Distance {
    Absolute,
    Incremental,
}

/// What an F word counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FeedMode {
    InverseTime,
    PerMinute,
    PerTurn,
}

/// Modes under which a block of motion does more than its words say, or goes elsewhere.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u16)]
pub enum Modifier {
    CutterCompensation = 1,
    Rotation = 2,
    Scaling = 4,
    Mirror = 8,
    Polar = 16,
    Diameter = 32,
    Cylinder = 64,
    ToolCenterPoint = 128,
    ExactStop = 256,
    ModalMacro = 512,
}

/// The modal state before a block; none where a mode is not known. `P` holds a coordinate and `F` a feed:
/// millimetres for a reader that wants curves, exact decimals for a rewriter that wants text.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Modal<P, F> {
    pub motion: Option<Motion>,
    pub plane: Option<Plane>,
    pub units: Option<Units>,
    pub distance: Option<Distance>,
    pub centers: Option<Distance>,
    pub feed_mode: Option<FeedMode>,
    pub feed: Option<F>,
    pub at: [Option<P>; 3],
    /// The bits of every [`Modifier`] in force.
    pub modifiers: u16,
}

impl<P: Copy + PartialEq, F: Copy + PartialEq> Modal<P, F> {
    /// Nothing is known; modifiers are taken to be off.
    pub const UNKNOWN: Self = Self {
        motion: None,
        plane: None,
        units: None,
        distance: None,
        centers: None,
        feed_mode: None,
        feed: None,
        at: [None; 3],
        modifiers: 0,
    };

    /// The state in which a program starts unless its first blocks say otherwise: XY, mm, absolute
    /// coordinates, incremental centres, feeds by the minute.
    pub const START: Self = Self {
        plane: Some(Plane::Xy),
        units: Some(Units::Mm),
        distance: Some(Distance::Absolute),
        centers: Some(Distance::Incremental),
        feed_mode: Some(FeedMode::PerMinute),
        ..Self::UNKNOWN
    };

    /// The state that is known if either of two states may hold. A modifier of either state counts as in
    /// force.
    pub fn common_with(&self, other: &Self) -> Self {
        fn both<T: PartialEq>(one: Option<T>, other: Option<T>) -> Option<T> {
            one.filter(|one| Some(one) == other.as_ref())
        }
        Self {
            motion: both(self.motion, other.motion),
            plane: both(self.plane, other.plane),
            units: both(self.units, other.units),
            distance: both(self.distance, other.distance),
            centers: both(self.centers, other.centers),
            feed_mode: both(self.feed_mode, other.feed_mode),
            feed: both(self.feed, other.feed),
            at: std::array::from_fn(|k| both(self.at[k], other.at[k])),
            modifiers: self.modifiers | other.modifiers,
        }
    }
}

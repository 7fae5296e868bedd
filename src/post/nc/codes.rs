//! What G and M words do to the modal state.

use super::modal::{Distance, FeedMode, Modal, Modifier, Motion};
use toolpathd_core::geometry::curve::Direction;
use toolpathd_core::geometry::plane::Plane;
use toolpathd_core::toolpath::program::Units;

/// G words of one line, and M words of one line, that are read: one of each modal group. A longer list is
/// refused.
const MAX_CODES: usize = 16;

/// The numbers of the G words, or of the M words, of one line, in tenths.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Codes {
    tenths: [i32; MAX_CODES],
    count: usize,
}

impl Codes {
    pub fn all(&self) -> &[i32] {
        &self.tenths[..self.count]
    }

    pub fn has(&self, tenths: i32) -> bool {
        self.all().contains(&tenths)
    }

    /// None where the list is full.
    pub fn push(&mut self, tenths: i32) -> Option<()> {
        *self.tenths.get_mut(self.count)? = tenths;
        self.count += 1;
        Some(())
    }
}

/// What one G word does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Effect {
    Motion(Motion),
    Plane(Plane),
    Units(Units),
    Distance(Distance),
    Centers(Distance),
    FeedMode(FeedMode),
    Begins(Modifier, PositionEffect),
    Ends(Modifier, PositionEffect),
    Position(PositionEffect),
    /// G80 ends the mode of motion.
    NoMotion,
    /// Another program runs, and may leave other modes. The words of the block are its parameters.
    Leaves,
    /// Neither modes nor the position change.
    Nothing,
    Unknown,
}

/// What a G or M word does to the known position and to the axis words of its block.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PositionEffect {
    Kept,
    /// The position is lost, then the axis words say where to go.
    Shifted,
    /// The axis words say where to go, but not in the program's coordinates: the position is lost.
    Elsewhere,
    /// The axis words are parameters of the code, and the position is lost.
    Taken,
    /// The axis words are parameters of the code, and nothing moves.
    Idle,
}

/// What the G word with this number, in tenths, does.
pub fn effect(tenths: i32) -> Effect {
    use {Distance::*, FeedMode::*, Modifier::*, PositionEffect::*};
    match tenths {
        0 => Effect::Motion(Motion::Rapid),
        10 => Effect::Motion(Motion::Line),
        20 => Effect::Motion(Motion::Arc(Direction::Cw)),
        30 => Effect::Motion(Motion::Arc(Direction::Ccw)),
        800 => Effect::NoMotion,
        170 => Effect::Plane(Plane::Xy),
        180 => Effect::Plane(Plane::Zx),
        190 => Effect::Plane(Plane::Yz),
        200 => Effect::Units(Units::Inch),
        210 => Effect::Units(Units::Mm),
        900 => Effect::Distance(Absolute),
        910 => Effect::Distance(Incremental),
        901 => Effect::Centers(Absolute),
        911 => Effect::Centers(Incremental),
        930 => Effect::FeedMode(InverseTime),
        940 => Effect::FeedMode(PerMinute),
        950 => Effect::FeedMode(PerTurn),
        70 => Effect::Begins(Diameter, Shifted),
        80 => Effect::Ends(Diameter, Shifted),
        71 | 1070 => Effect::Begins(Cylinder, Taken),
        121 | 1120 => Effect::Begins(Polar, Taken),
        131 | 1130 => Effect::Ends(Polar, Taken),
        150 => Effect::Ends(Polar, Shifted),
        160 => Effect::Begins(Polar, Elsewhere),
        400 => Effect::Ends(CutterCompensation, Kept),
        410 | 411 | 420 | 421 => Effect::Begins(CutterCompensation, Kept),
        434 | 435 | 2340 => Effect::Begins(ToolCenterPoint, Shifted),
        490 => Effect::Ends(ToolCenterPoint, Shifted),
        500 => Effect::Ends(Scaling, Shifted),
        510 => Effect::Begins(Scaling, Taken),
        501 => Effect::Ends(Mirror, Taken),
        511 => Effect::Begins(Mirror, Taken),
        610 => Effect::Begins(ExactStop, Kept),
        611 | 620 | 630 | 640 => Effect::Ends(ExactStop, Kept),
        650 => Effect::Leaves,
        660 | 661 => Effect::Begins(ModalMacro, Taken),
        670 => Effect::Ends(ModalMacro, Shifted),
        680..=684 | 2540 => Effect::Begins(Rotation, Taken),
        690 | 691 | 2550 => Effect::Ends(Rotation, Shifted),
        // The axis words of G43.1 and G43.2 are length offsets.
        100 | 280 | 281 | 300 | 301 | 431 | 432 | 520 | 920..=923 => Effect::Position(Taken),
        530 | 531 => Effect::Position(Elsewhere),
        430 | 440 | 540..=599 => Effect::Position(Shifted),
        40 => Effect::Position(Idle),
        90 | 960 | 970 | 980 | 990 | 1870 => Effect::Nothing,
        _ => Effect::Unknown,
    }
}

/// The modal group of a G word: two words of one group exclude each other. A code without a listed group
/// excludes only itself.
pub fn modal_group(tenths: i32) -> i32 {
    match tenths {
        0..=39 | 51 | 730 | 740 | 760 | 800..=890 => 1,
        170..=199 => 2,
        200..=219 => 3,
        430 | 434 | 435 | 490 => 4,
        930 | 940 => 7,
        540..=599 => 5,
        610..=649 => 6,
        980 | 990 => 10,
        alone => 100 + alone,
    }
}

/// What one M word does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Function {
    /// Neither modes nor the position change.
    Inert,
    ToolChange,
    /// The program ends, and the control returns to its start modes.
    Ends,
    /// Another program runs, or another part of this program.
    Leaves,
    /// The modes of an earlier block return, modifiers among them.
    Restores,
    Unknown,
}

/// What the M word with this number, in tenths, does.
pub fn function(tenths: i32) -> Function {
    match tenths {
        0 | 10 | 30 | 40 | 50 | 70 | 80 | 90 | 100 | 110 | 190 | 480 | 490..=539 | 880 | 890 => {
            Function::Inert
        }
        60 => Function::ToolChange,
        20 | 300 => Function::Ends,
        970 | 980 | 990 | 1980 => Function::Leaves,
        720 | 730 => Function::Restores,
        _ => Function::Unknown,
    }
}

impl<P, F> Modal<P, F> {
    /// Sets the mode that a G word names. Position and feed stay.
    pub fn apply(&mut self, effect: Effect) {
        match effect {
            Effect::Motion(motion) => self.motion = Some(motion),
            Effect::Plane(plane) => self.plane = Some(plane),
            Effect::Units(units) => self.units = Some(units),
            Effect::Distance(distance) => self.distance = Some(distance),
            Effect::Centers(distance) => self.centers = Some(distance),
            Effect::FeedMode(mode) => self.feed_mode = Some(mode),
            Effect::Begins(modifier, _) => self.modifiers |= modifier as u16,
            Effect::Ends(modifier, _) => self.modifiers &= !(modifier as u16),
            Effect::NoMotion => self.motion = None,
            Effect::Position(_) | Effect::Nothing | Effect::Leaves | Effect::Unknown => {}
        }
    }
}

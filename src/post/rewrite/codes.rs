//! What G words do to the state that decides whether and how a run may be rewritten.

use super::modes::{Bar, Distance, FeedMode, Motion};
use crate::geometry::curve::Direction;
use crate::geometry::plane::Plane;
use crate::toolpath::program::Units;

/// What one G word does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Effect {
    Motion(Motion),
    Plane(Plane),
    Units(Units),
    Distance(Distance),
    Centers(Distance),
    FeedMode(FeedMode),
    Begins(Bar, Place),
    Ends(Bar, Place),
    Place(Place),
    /// A mode of motion ends, G80: it is not known which holds then.
    NoMotion,
    Nothing,
    Unknown,
}

/// What becomes of the known position and of the axis words of the block.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Place {
    Kept,
    /// The position is lost, then the axis words say where to go.
    Shifted,
    /// The axis words say where to go, but not in the program's coordinates: the position is lost.
    Elsewhere,
    /// The axis words say something else, and the position is lost.
    Taken,
    /// The axis words say something else, and nothing moves.
    Idle,
}

/// What the G word with this number does.
pub fn effect(tenths: i32) -> Effect {
    use Effect::*;
    match tenths {
        0 => Motion(super::modes::Motion::Rapid),
        10 => Motion(super::modes::Motion::Line),
        20 => Motion(super::modes::Motion::Arc(Direction::Cw)),
        30 => Motion(super::modes::Motion::Arc(Direction::Ccw)),
        40 => Place(self::Place::Idle),
        70 => Begins(Bar::Diameter, self::Place::Shifted),
        80 => Ends(Bar::Diameter, self::Place::Shifted),
        71 | 1070 => Begins(Bar::Cylinder, self::Place::Taken),
        100 | 280 | 281 | 300 | 301 | 520 | 920..=923 => Place(self::Place::Taken),
        530 | 531 => Place(self::Place::Elsewhere),
        121 | 1120 => Begins(Bar::Polar, self::Place::Taken),
        131 | 1130 => Ends(Bar::Polar, self::Place::Taken),
        150 => Ends(Bar::Polar, self::Place::Shifted),
        160 => Begins(Bar::Polar, self::Place::Elsewhere),
        170 => Plane(crate::geometry::plane::Plane::Xy),
        180 => Plane(crate::geometry::plane::Plane::Zx),
        190 => Plane(crate::geometry::plane::Plane::Yz),
        200 => Units(crate::toolpath::program::Units::Inch),
        210 => Units(crate::toolpath::program::Units::Mm),
        400 => Ends(Bar::Compensation, self::Place::Kept),
        410 | 411 | 420 | 421 => Begins(Bar::Compensation, self::Place::Kept),
        434 | 435 | 2340 => Begins(Bar::ToolPoint, self::Place::Shifted),
        490 => Ends(Bar::ToolPoint, self::Place::Shifted),
        // Offsets, not places, are what the axis words of the second and third say.
        431 | 432 => Place(self::Place::Taken),
        430 | 440 | 540..=599 => Place(self::Place::Shifted),
        500 => Ends(Bar::Scaling, self::Place::Shifted),
        510 => Begins(Bar::Scaling, self::Place::Taken),
        501 => Ends(Bar::Mirror, self::Place::Taken),
        511 => Begins(Bar::Mirror, self::Place::Taken),
        610 => Begins(Bar::ExactStop, self::Place::Kept),
        611 | 620 | 630 | 640 => Ends(Bar::ExactStop, self::Place::Kept),
        660 | 661 => Begins(Bar::Macro, self::Place::Taken),
        670 => Ends(Bar::Macro, self::Place::Shifted),
        680 | 681..=684 | 2540 => Begins(Bar::Rotation, self::Place::Taken),
        690 | 691 | 2550 => Ends(Bar::Rotation, self::Place::Shifted),
        800 => NoMotion,
        900 => Distance(super::modes::Distance::Absolute),
        910 => Distance(super::modes::Distance::Incremental),
        901 => Centers(super::modes::Distance::Absolute),
        911 => Centers(super::modes::Distance::Incremental),
        930 => FeedMode(super::modes::FeedMode::InverseTime),
        940 => FeedMode(super::modes::FeedMode::PerMinute),
        950 => FeedMode(super::modes::FeedMode::PerTurn),
        90 | 960 | 970 | 980 | 990 => Nothing,
        _ => Unknown,
    }
}

/// What an M word does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Function {
    /// Neither modes nor positions change.
    Inert,
    ToolChange,
    /// The program ends, and the control with its modes begins anew.
    Ends,
    /// Another program runs, or another part of this one.
    Leaves,
    /// The modes of an earlier place come back, compensations among them.
    Restores,
    Unknown,
}

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

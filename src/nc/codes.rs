//! What G codes mean on each control.

use toolpathd_core::geometry::curve::Direction;
use toolpathd_core::geometry::plane::Plane;

use super::control::{Control, Family};
use super::frames::EXTENDED;

/// The motion in force.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Motion {
    Rapid,
    Line,
    Arc(Direction),
}

/// What a feed counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FeedMode {
    PerMinute,
    InverseTime,
    PerTurn,
}

/// The side of the contour on which the tool goes, seen along its way and against the normal of the plane.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Side {
    Left,
    Right,
}

impl Side {
    pub fn other(self) -> Self {
        match self {
            Side::Left => Side::Right,
            Side::Right => Side::Left,
        }
    }
}

/// What one G code means.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Meaning {
    Motion(Motion),
    Parabola,
    Cycle(u8),
    CycleEnd,
    Dwell,
    SetData,
    Home,
    Plane(Plane),
    /// Whether lengths are in inches.
    Units(bool),
    /// Whether the length of the tool counts.
    Length(bool),
    Machine,
    WorkOffset(u32),
    /// The work offset that P names.
    ExtendedOffset,
    /// Okuma: the work offset that H names.
    OffsetByH,
    Local,
    SetPlace,
    UnsetPlace {
        keeps: bool,
    },
    RestorePlace,
    /// Whether coordinates are absolute.
    Distance(bool),
    Centers(bool),
    FeedMode(FeedMode),
    /// Whether a cycle returns to its initial height.
    Return(bool),
    /// Cutter compensation begins on this side.
    Compensation(Side),
    CompensationEnd,
    /// The coordinates turn in the plane.
    Turn,
    TurnEnd,
    /// The plane is tilted.
    Tilt,
    /// The tool turns to the tilted plane.
    AlongPlane,
    Scale,
    ScaleEnd,
    /// Axes are mirrored from here on, or no longer.
    Mirror(bool),
    Polar,
    PolarEnd,
    Call,
    /// Known to the control, and without influence on the path.
    LeftAlone,
    /// Ends what this reader refuses to begin.
    Nothing,
    NotRead,
    Unknown,
}

/// G codes, in tenths, that LinuxCNC knows; `interp_array.cc`.
const LINUXCNC: &[i32] = &[
    0, 10, 20, 30, 40, 50, 51, 52, 53, 70, 80, 100, 170, 171, 180, 181, 190, 191, 200, 210, 280, 281, 300,
    301, 330, 331, 382, 383, 384, 385, 400, 410, 411, 420, 421, 430, 431, 432, 490, 520, 530, 540, 550, 560,
    570, 580, 590, 591, 592, 593, 610, 611, 640, 700, 710, 711, 712, 720, 721, 722, 730, 740, 760, 800, 810,
    820, 830, 840, 850, 860, 870, 880, 890, 900, 901, 910, 911, 920, 921, 922, 923, 930, 940, 950, 960, 970,
    980, 990,
];

/// G codes, in tenths, that GRBL 1.1 knows; `gcode.c`.
const GRBL: &[i32] = &[
    0, 10, 20, 30, 40, 100, 170, 180, 190, 200, 210, 280, 281, 300, 301, 382, 383, 384, 385, 400, 431, 490,
    530, 540, 550, 560, 570, 580, 590, 610, 800, 900, 910, 911, 920, 921, 930, 940,
];

/// What a G code means on `control`.
pub fn meaning(tenths: i32, control: &Control) -> Meaning {
    let is = |family| control.is(family);
    let fanuc = is(Family::Fanuc);
    let named = |name: &str| control.name == name;
    if is(Family::LinuxCnc) && !LINUXCNC.contains(&tenths) || is(Family::Grbl) && !GRBL.contains(&tenths) {
        return Meaning::Unknown;
    }
    match tenths {
        0 => Meaning::Motion(Motion::Rapid),
        10 => Meaning::Motion(Motion::Line),
        20 => Meaning::Motion(Motion::Arc(Direction::Cw)),
        30 => Meaning::Motion(Motion::Arc(Direction::Ccw)),
        40 => Meaning::Dwell,
        51 if is(Family::LinuxCnc) => Meaning::Parabola,
        // Look-ahead and contour control.
        50 | 51 | 80 if fanuc => Meaning::LeftAlone,
        100 => Meaning::SetData,
        150 if named("okuma") => Meaning::OffsetByH,
        680 if fanuc || is(Family::Mach) => Meaning::Turn,
        690 => Meaning::TurnEnd,
        682 | 531 if fanuc && !named("haas") && !named("okuma") => {
            if tenths == 682 {
                Meaning::Tilt
            } else {
                Meaning::AlongPlane
            }
        }
        510 if fanuc => Meaning::Scale,
        500 => Meaning::ScaleEnd,
        511 if fanuc && !named("haas") => Meaning::Mirror(true),
        1010 if named("haas") => Meaning::Mirror(true),
        1000 if named("haas") => Meaning::Mirror(false),
        501 => Meaning::Mirror(false),
        160 if fanuc => Meaning::Polar,
        150 => Meaning::PolarEnd,
        110 | 131 | 130 | 670 | 401 | 230 => Meaning::Nothing,
        170 => Meaning::Plane(Plane::Xy),
        180 => Meaning::Plane(Plane::Zx),
        190 => Meaning::Plane(Plane::Yz),
        200 | 210 => Meaning::Units(tenths == 200),
        280 | 300 => Meaning::Home,
        281 | 301 => Meaning::LeftAlone,
        400 => Meaning::CompensationEnd,
        410 | 411 => Meaning::Compensation(Side::Left),
        420 | 421 => Meaning::Compensation(Side::Right),
        430 | 440 | 431 | 432 => Meaning::Length(true),
        540 | 550 | 560..=569 if named("okuma") && tenths != 560 => Meaning::Unknown,
        560 if named("okuma") => Meaning::Length(true),
        490 => Meaning::Length(false),
        520 => Meaning::Local,
        530 if named("okuma") => Meaning::Length(false),
        530 => Meaning::Machine,
        541 if fanuc || is(Family::Mach) => Meaning::ExtendedOffset,
        1540 if named("haas") => Meaning::ExtendedOffset,
        1100..=1290 if named("haas") && tenths % 10 == 0 => {
            Meaning::WorkOffset(EXTENDED + (tenths / 10 - 109) as u32)
        }
        540 | 550 | 560 | 570 | 580 | 590 => Meaning::WorkOffset((tenths / 10 - 53) as u32),
        591..=593 => Meaning::WorkOffset((tenths - 590 + 6) as u32),
        90 | 610 | 611 | 620 | 630 | 640 | 970 | 1870 | 1030 => Meaning::LeftAlone,
        650 => Meaning::Call,
        730 | 740 | 760 | 810 | 820 | 830 | 840 | 850 | 860 | 890 => match (tenths, control.family) {
            // Threads are turned.
            (760, Family::LinuxCnc) => Meaning::NotRead,
            _ => Meaning::Cycle((tenths / 10) as u8),
        },
        800 => Meaning::CycleEnd,
        900 | 910 => Meaning::Distance(tenths == 900),
        901 | 911 => Meaning::Centers(tenths == 901),
        920 => Meaning::SetPlace,
        921 => Meaning::UnsetPlace { keeps: false },
        922 => Meaning::UnsetPlace { keeps: true },
        923 => Meaning::RestorePlace,
        930 => Meaning::FeedMode(FeedMode::InverseTime),
        940 => Meaning::FeedMode(FeedMode::PerMinute),
        950 => Meaning::FeedMode(FeedMode::PerTurn),
        980 | 990 => Meaning::Return(tenths == 980),
        80 if is(Family::LinuxCnc) => Meaning::NotRead,
        52 | 53 | 70 | 71 | 120 | 121 | 131..=139 | 160 | 220 | 270 | 290 | 310 | 330..=339 | 382..=385 => {
            Meaning::NotRead
        }
        50 | 434 | 435 | 510 | 511 | 660 | 661 | 680..=684 | 700..=729 | 870 | 880 | 960 | 2340 | 2540 => {
            Meaning::NotRead
        }
        _ => Meaning::Unknown,
    }
}

/// The modal group of a meaning; two codes of one group exclude each other on controls that check it.
pub fn group(meaning: Meaning, control: &Control) -> Option<u8> {
    match meaning {
        Meaning::Motion(_) | Meaning::Cycle(_) | Meaning::Parabola => Some(1),
        Meaning::CycleEnd if control.is(Family::Grbl) => Some(1),
        Meaning::Plane(_) => Some(2),
        Meaning::Units(_) => Some(3),
        Meaning::Distance(_) => Some(4),
        Meaning::Centers(_) => Some(5),
        Meaning::FeedMode(_) => Some(6),
        Meaning::WorkOffset(_) | Meaning::ExtendedOffset => Some(7),
        Meaning::Length(_) => Some(8),
        Meaning::Return(_) => Some(9),
        Meaning::Turn | Meaning::TurnEnd | Meaning::Tilt => Some(11),
        Meaning::Scale | Meaning::ScaleEnd => Some(12),
        Meaning::Mirror(_) => Some(13),
        Meaning::Polar | Meaning::PolarEnd => Some(14),
        Meaning::Compensation(_) | Meaning::CompensationEnd => Some(10),
        Meaning::Dwell
        | Meaning::SetData
        | Meaning::Home
        | Meaning::Machine
        | Meaning::Local
        | Meaning::SetPlace
        | Meaning::UnsetPlace { .. }
        | Meaning::RestorePlace => Some(0),
        _ => None,
    }
}

/// What an M code means.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Function {
    Stop,
    End,
    Spindle(bool),
    Coolant,
    ToolChange,
    SetTool,
    Call,
    LocalCall,
    Return,
    LeftAlone,
    NotRead,
    Unknown,
}

/// What an M code means on `control`.
pub fn function(tenths: i32, control: &Control) -> Function {
    let strict = |known: bool| if known { Function::LeftAlone } else { Function::Unknown };
    if tenths % 10 != 0 {
        return Function::Unknown;
    }
    let number = tenths / 10;
    match (number, control.family) {
        (6, Family::Grbl) => Function::Unknown,
        (98 | 99 | 60, Family::Grbl) => Function::Unknown,
        (0 | 1 | 60, _) => Function::Stop,
        (2 | 30, _) => Function::End,
        (3..=5, _) => Function::Spindle(number != 5),
        (7..=9, _) => Function::Coolant,
        (6, _) => Function::ToolChange,
        (61, Family::LinuxCnc) => Function::SetTool,
        (98, _) => Function::Call,
        (97, _) if control.name == "haas" => Function::LocalCall,
        (99, _) => Function::Return,
        (96 | 97 | 198, Family::Fanuc) => Function::NotRead,
        (19 | 48..=53 | 62..=68 | 100..=199, Family::LinuxCnc) => Function::LeftAlone,
        (56, Family::Grbl) => Function::LeftAlone,
        _ => strict(!control.is_strict),
    }
}

/// The modal group of an M code; two codes of one group exclude each other on controls that check it.
pub fn function_group(tenths: i32) -> Option<u8> {
    match tenths / 10 {
        0 | 1 | 2 | 30 | 60 => Some(4),
        62..=68 => Some(5),
        6 | 61 => Some(6),
        3..=5 | 19 => Some(7),
        7..=9 => Some(8),
        48..=53 => Some(9),
        100..=199 => Some(10),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_same_code_differs_between_controls() {
        let of = |tenths, name| meaning(tenths, Control::named(name).unwrap());
        assert_eq!((of(51, "linuxcnc"), of(51, "fanuc")), (Meaning::Parabola, Meaning::LeftAlone));
        assert_eq!((of(810, "grbl"), of(810, "haas")), (Meaning::Unknown, Meaning::Cycle(81)));
        assert_eq!((of(1110, "haas"), of(1110, "fanuc")), (Meaning::WorkOffset(102), Meaning::Unknown));
        assert_eq!((of(760, "linuxcnc"), of(760, "fanuc")), (Meaning::NotRead, Meaning::Cycle(76)));
        assert_eq!((of(560, "okuma"), of(560, "mazak")), (Meaning::Length(true), Meaning::WorkOffset(3)));
        assert_eq!((of(680, "haas"), of(682, "haas")), (Meaning::Turn, Meaning::NotRead));
        assert_eq!((of(1010, "haas"), of(511, "fanuc")), (Meaning::Mirror(true), Meaning::Mirror(true)));
        assert_eq!(function(60, Control::named("grbl").unwrap()), Function::Unknown);
        assert_eq!(function(1230, Control::named("fanuc").unwrap()), Function::LeftAlone);
    }
}

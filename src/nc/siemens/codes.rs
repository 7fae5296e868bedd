//! What G codes and words without a value mean.

use toolpathd_core::geometry::curve::Direction;
use toolpathd_core::geometry::plane::Plane;

use crate::codes::FeedMode;
use crate::machine::Side;

/// The number of the settable zero that G500 selects: none.
pub const NO_OFFSET: u32 = 500;

/// The motion in force.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Motion {
    Rapid,
    Line,
    Arc(Direction),
    /// CIP: an arc through a point.
    ThroughPoint,
    /// CT: an arc that goes on from the path before.
    Tangent,
}

/// A word that changes the programmable frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FrameWord {
    Shift,
    Turn,
    Scale,
    Mirror,
}

/// What the coordinates of a pole count from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PoleFrom {
    Tool,
    Zero,
    Pole,
}

/// What a code means.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Meaning {
    Motion(Motion),
    Dwell,
    /// G74 or G75.
    Home,
    Plane(Plane),
    Units {
        in_inches: bool,
        /// The unit of feeds changes, too.
        of_feeds: bool,
    },
    /// Whether coordinates are absolute.
    Distance(bool),
    /// A type of feed; `None` leaves the type.
    Feed(Option<FeedMode>),
    Offset(u32),
    /// Coordinates of this block are those of the machine.
    OnMachine,
    Frame {
        word: FrameWord,
        /// The word adds to the frame before.
        adds: bool,
    },
    Pole(PoleFrom),
    /// G25 and G26: limits, whose axis words are no places.
    Limits,
    Compensation(Side),
    CompensationEnd,
    /// A transformation of the axes, which is refused.
    Transformation,
    TransformationEnd,
    LeftAlone,
    /// How a compensated path begins and turns corners: it matters where the path is computed.
    Approach,
    NotRead,
    Unknown,
}

/// What a G code means.
pub fn code(number: u32) -> Meaning {
    use Meaning::*;
    match number {
        0 => Motion(self::Motion::Rapid),
        1 => Motion(self::Motion::Line),
        2 => Motion(self::Motion::Arc(Direction::Cw)),
        3 => Motion(self::Motion::Arc(Direction::Ccw)),
        4 => Dwell,
        9 | 60 | 62 | 64 | 601..=603 | 621 | 641..=645 => LeftAlone,
        450 | 460..=462 | 290 => LeftAlone,
        451..=453 => Approach,
        17 => Plane(self::Plane::Xy),
        18 => Plane(self::Plane::Zx),
        19 => Plane(self::Plane::Yz),
        25 | 26 => Limits,
        40 => CompensationEnd,
        41 => Compensation(Side::Left),
        42 => Compensation(Side::Right),
        53 | 153 => OnMachine,
        54..=57 => Offset(number - 53),
        500 => Offset(NO_OFFSET),
        505..=599 => Offset(number),
        70 | 71 => Units { in_inches: number == 70, of_feeds: false },
        700 | 710 => Units { in_inches: number == 700, of_feeds: true },
        74 | 75 => Home,
        90 | 91 => Distance(number == 90),
        93 => Feed(Some(FeedMode::InverseTime)),
        94 | 971 => Feed(Some(FeedMode::PerMinute)),
        95 | 97 => Feed(Some(FeedMode::PerTurn)),
        972 | 973 => Feed(None),
        110 => Pole(PoleFrom::Tool),
        111 => Pole(PoleFrom::Zero),
        112 => Pole(PoleFrom::Pole),
        5
        | 7
        | 33..=35
        | 58
        | 59
        | 63
        | 96
        | 140..=143
        | 147
        | 148
        | 151
        | 247
        | 248
        | 291
        | 331
        | 332
        | 335
        | 336
        | 340
        | 341
        | 347
        | 348
        | 710..=799
        | 931
        | 942
        | 952
        | 961
        | 962
        | 810..=829 => NotRead,
        _ => Unknown,
    }
}

/// Words without a value, and calls such as `FGROUP(X,Y)`, that cannot change the path.
const LEFT_ALONE: &[&str] = &[
    "ACTBLOCNO",
    "BRISK",
    "BRISKA",
    "CDOF",
    "CDOF2",
    "CFC",
    "CFCIN",
    "CFIN",
    "CFTCP",
    "COMPCAD",
    "COMPCURV",
    "COMPOF",
    "COMPON",
    "COMPSURF",
    "CP",
    "CPRECOF",
    "CPRECON",
    "CUT2D",
    "CUT2DF",
    "CYCLE832",
    "DIAMOF",
    "DISPLOF",
    "DISPLON",
    "DRIVE",
    "DRIVEA",
    "DYNFINISH",
    "DYNNORM",
    "DYNPOS",
    "DYNPREC",
    "DYNROUGH",
    "DYNSEMIFIN",
    "EXTERN",
    "FENDNORM",
    "FFWOF",
    "FFWON",
    "FGROUP",
    "FIFOCTRL",
    "FNORM",
    "GROUP_BEGIN",
    "GROUP_END",
    "MSG",
    "NORM",
    "PAROTOF",
    "POTD_OFF",
    "RTLIOF",
    "RTLION",
    "SBLOF",
    "SBLON",
    "SETMS",
    "SOFT",
    "SOFTA",
    "SPATH",
    "SPCOF",
    "SPCON",
    "STARTFIFO",
    "STOLFOF",
    "STOPFIFO",
    "STOPRE",
    "TOFRAMEOF",
    "TOROTOF",
    "UPATH",
    "WALIMOF",
    "WALIMON",
    "WORKPIECE",
];

/// Words with a value behind an equals sign that cannot change the path.
const LEFT_VALUES: &[&str] = &[
    "ACC", "ACCLIMA", "ADIS", "ADISPOS", "ATOL", "CTOL", "FGREF", "JERKLIM", "JERKLIMA", "LIMS", "OTOL",
    "SPOS", "SPOSA", "STOLF", "VELOLIM", "VELOLIMA",
];

/// Whether a word takes a value and cannot change the path.
pub fn is_left_value(name: &str) -> bool {
    LEFT_VALUES.contains(&name)
}

/// Names of values that blocks use.
pub const VALUES: &[&str] =
    &["ANG", "AP", "AR", "CHF", "CHR", "CR", "FP", "FRC", "FRCM", "RND", "RNDM", "RP", "RPL", "TURN"];

/// Words of the language that this reader does not read.
const NOT_READ: &[&str] = &[
    "DISC",
    "ASPLINE",
    "BSPLINE",
    "CSPLINE",
    "POLY",
    "POLYPATH",
    "OEMIPO1",
    "OEMIPO2",
    "INVCW",
    "INVCCW",
    "DIAMON",
    "DIAM90",
    "PTP",
    "PTPG0",
    "G0PTP",
    "ROTS",
    "AROTS",
    "CROTS",
    "TOFRAME",
    "TOROT",
    "PAROT",
    "SETINT",
    "ASUP",
    "POS",
    "POSA",
    "POSP",
    "FLIN",
    "FCUB",
    "FPO",
    "FB",
    "FZ",
    "OVR",
    "OVRA",
    "OVRRAP",
    "MEAS",
    "MEAW",
    "MEASA",
    "COUPON",
    "COUPOF",
    "TRAILON",
    "TRAILOF",
    "LEADON",
    "EGON",
    "GEOAX",
    "TANG",
    "TANGON",
    "SAVE",
    "EXTCALL",
    "ISOCALL",
    "PCALL",
    "INIT",
    "START",
    "WAITM",
    "WAITE",
    "CUT3DC",
    "CUT3DF",
    "CUT3DFF",
    "CUT3DFS",
    "CUT3DCC",
    "OFFN",
    "TOFFON",
    "TOFFOF",
    "TOFFL",
    "TOFFR",
    "DISR",
    "DISCL",
    "RETTOOL",
    "GETSELT",
    "CTRANS",
    "TCARR",
    "TCOABS",
    "TCOFR",
    "TMOF",
    "TMON",
    "STOPREOF",
    "REDEF",
    "UNDEF",
    "ACTFRAME",
    "CSCALE",
    "CMIRROR",
    "CROT",
    "NEWCONF",
    "GOTOS",
    "GETD",
    "RELEASE",
    "GET",
    "STARTFIFOX",
    "SYNACT",
    "WHEN",
    "WHENEVER",
    "EVERY",
    "DO",
    "ID",
    "IDS",
    "FROM",
    "CANCEL",
    "POLF",
    "LIFTFAST",
    "MASLON",
];

/// Whether a word belongs to the language, and this reader does not read it.
pub fn is_not_read(name: &str) -> bool {
    let is_family =
        ["CYCLE", "POCKET", "SLOT", "LONGHOLE", "HOLES", "ORI"].iter().any(|start| name.starts_with(start));
    NOT_READ.contains(&name) || is_family
}

/// What a word without a value means. `None` for a word that is no word of the language.
pub fn word(name: &str) -> Option<Meaning> {
    use Meaning::*;
    let frame = |word, adds| Some(Frame { word, adds });
    match name {
        "CIP" => Some(Motion(self::Motion::ThroughPoint)),
        "CT" => Some(Motion(self::Motion::Tangent)),
        "SUPA" => Some(OnMachine),
        "TRANS" => frame(FrameWord::Shift, false),
        "ATRANS" => frame(FrameWord::Shift, true),
        "ROT" => frame(FrameWord::Turn, false),
        "AROT" => frame(FrameWord::Turn, true),
        "SCALE" => frame(FrameWord::Scale, false),
        "ASCALE" => frame(FrameWord::Scale, true),
        "MIRROR" => frame(FrameWord::Mirror, false),
        "AMIRROR" => frame(FrameWord::Mirror, true),
        "TRAORI" | "TRANSMIT" | "TRACYL" | "TRAANG" | "TRACON" | "TRAFOON" => Some(Transformation),
        "TRAFOOF" => Some(TransformationEnd),
        "KONT" | "KONTC" | "KONTT" | "CDON" => Some(Approach),
        _ if LEFT_ALONE.contains(&name) => Some(LeftAlone),
        _ if is_not_read(name) => Some(NotRead),
        _ => None,
    }
}

/// The group of a meaning of which a block may have one.
pub fn group(meaning: Meaning) -> Option<u8> {
    match meaning {
        Meaning::Motion(_) => Some(1),
        Meaning::Dwell | Meaning::Home | Meaning::Frame { .. } | Meaning::Pole(_) | Meaning::Limits => {
            Some(2)
        }
        Meaning::OnMachine => Some(3),
        Meaning::Plane(_) => Some(6),
        Meaning::Offset(_) => Some(8),
        Meaning::Units { .. } => Some(13),
        Meaning::Distance(_) => Some(14),
        Meaning::Feed(_) => Some(15),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn offsets_begin_at_g54_and_go_on_at_g505() {
        assert_eq!([code(54), code(57), code(505)], [1, 4, 505].map(Meaning::Offset));
        assert_eq!((code(58), code(504), code(600)), (Meaning::NotRead, Meaning::Unknown, Meaning::Unknown));
        assert_eq!(word("POCKET3"), Some(Meaning::NotRead));
        assert_eq!(word("PART_ONE"), None);
    }
}

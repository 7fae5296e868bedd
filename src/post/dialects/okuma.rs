//! Okuma OSP, milling. Nothing has read programs of this dialect but the reader that checks each of them.
//!
//! * G15 H selects a work offset by its number, from 1: G54 is written as `G15 H1`.
//! * G56 H selects the length of the tool, in the block of the first motion along Z.
//! * A dwell counts seconds, as F.
//! * There is no G28 and no G53.
//! * F has up to three decimals. No manual at hand states how many the control reads; public post-processors
//!   for OSP write two decimals in mm and three in inches.

use crate::dialect::{
    Abilities, ArcRule, Curves, Dialect, Dwell, FiveAxisWords, Frame, Iso, Numbers, Point, ProgramNumber, Syntax, Verification,
};
use toolpathd_core::toolpath::program::SafeHome;

pub const OKUMA: Dialect = Dialect {
    name: "okuma",
    description: "Okuma OSP, milling (unverified)",
    verification: Verification::Unverified,
    file_extension: "min",
    line_end: "\n",
    max_line_length: 120,
    max_program_number: Some(9999),
    default_decimals_mm: 3,
    default_decimals_inch: 4,
    max_decimals: 4,
    numbers: Numbers { point: Point::Always, max_digits: 8, max_whole_digits: 8, max_feed_decimals: 3, feeds_in_tenths_of_inch: false, spindle_decimals: 0, max_spindle_rpm: 99_999 },
    // Alarm B 2252, code 3: the usual tolerance of the end is 20 micrometres.
    curves: Curves { accepts: ArcRule::fixed(0.02), ..Curves::ARCS },
    abilities: Abilities { safe_homes: &[SafeHome::None], cycles: &[], ..Abilities::USUAL },
    rests_at_mm: None,
    smoothing: None,
    five_axes: FiveAxisWords { angle_decimals: 4, has_positions: false, ..FiveAxisWords::NONE },
    syntax: Syntax::Iso(Iso {
        program_number: Some(ProgramNumber { letter: 'O', digits: 4 }),
        dwell: Dwell::FeedWord,
        work_offset: "G15 H",
        length_offset: "G56 H{offset}",
        reference_point: &[],
        machine_zero: &[],
        start: &[
            Frame::Header,
            Frame::ByUnits { mm: "G21", inch: "G20" },
            Frame::Text("G17 G90 G40 G80 G94"),
            Frame::WorkOffset,
            Frame::ToolChange,
            Frame::SpindleOn,
            Frame::CoolantOn,
            Frame::LengthOffsetInFirstMotionAlongZ,
        ],
        end: &[Frame::Text("M5"), Frame::Text("M9"), Frame::Text("M2")],
        ..Iso::USUAL
    }),
};

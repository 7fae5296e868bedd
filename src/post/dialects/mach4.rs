//! Mach3 and Mach4. Nothing has read programs of this dialect but the reader that checks each of them.
//!
//! * G91.1 makes the offsets of centres incremental, as they are written: a setting could say otherwise.
//! * How far the control may cut corners is one of its settings.
//! * Editions of the manual disagree on a P without a point, so a dwell has one.

use super::fanuc::WORDS;
use crate::dialect::{
    Abilities, Curves, Dialect, Dwell, FiveAxisWords, Frame, Iso, Numbers, Point, Syntax, Verification,
};

pub const MACH4: Dialect = Dialect {
    name: "mach4",
    description: "Mach3 and Mach4, milling (unverified)",
    verification: Verification::Unverified,
    file_extension: "tap",
    line_end: "\n",
    max_line_length: 120,
    max_program_number: None,
    default_decimals_mm: 3,
    default_decimals_inch: 4,
    max_decimals: 6,
    numbers: Numbers { point: Point::WhereNeeded, max_digits: 15, max_whole_digits: 15, max_feed_decimals: 6, feeds_in_tenths_of_inch: false, spindle_decimals: 0, max_spindle_rpm: 1_000_000 },
    curves: Curves::ARCS,
    abilities: Abilities::USUAL,
    rests_at_mm: None,
    smoothing: None,
    five_axes: FiveAxisWords { angle_decimals: 4, has_positions: true, ..FiveAxisWords::NONE },
    syntax: Syntax::Iso(Iso {
        program_number: None,
        dwell: Dwell::Seconds,
        further_g: &[911],
        start: &[
            Frame::Header,
            Frame::ByUnits { mm: "G17 G21 G90 G40 G49 G80 G94", inch: "G17 G20 G90 G40 G49 G80 G94" },
            Frame::Text("G91.1"),
            Frame::WorkOffset,
            Frame::SafeHome,
            Frame::ToolChange,
            Frame::LengthOffset,
            Frame::SpindleOn,
            Frame::CoolantOn,
        ],
        ..WORDS
    }),
};

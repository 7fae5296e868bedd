//! GRBL 1.1, and grblHAL in the words that GRBL has too.
//!
//! * GRBL knows no tool: T, M6 and G43 are not written. The tool stands in the header.
//! * It reads at most 79 characters of a line. Blanks and comments do not count, but here they do.
//! * M7 exists only where it was compiled in, so mist is refused.
//! * An arc whose radii differ by more than 0.005 mm and 0.1 %, or by more than 0.5 mm, is an error 33. An
//!   arc that rounding would make so is divided, or written as lines.
//! * M30 resets the work offset to G54 and motion to G1, which harms no program that starts as these do.

use crate::dialect::{
    Abilities, ArcRule, BlockNumbers, Point, Comment, Curves, Dialect, FiveAxisWords, Frame, Iso, Numbers, Syntax, Verification,
};
use toolpathd_core::toolpath::cutting::Coolant;

pub const GRBL: Dialect = Dialect {
    name: "grbl",
    description: "GRBL 1.1 and grblHAL",
    verification: Verification::RelatedInterpreter,
    file_extension: "gcode",
    line_end: "\n",
    max_line_length: 79,
    max_program_number: None,
    default_decimals_mm: 3,
    default_decimals_inch: 4,
    max_decimals: 5,
    // A float of 32 bits holds seven digits; an eighth is read without harm.
    numbers: Numbers { point: Point::WhereNeeded, max_digits: 8, max_whole_digits: 8, max_feed_decimals: 6, feeds_in_tenths_of_inch: false, spindle_decimals: 0, max_spindle_rpm: 1_000_000 },
    // The largest radius is the usual one: centres farther away would lose a thousandth in 32 bits.
    // Radii are computed in 32 bits: 0.004 mm leaves room for their rounding.
    curves: Curves { radius_mismatch_mm: 0.004, accepts: ARC_RULE, ..Curves::ARCS },
    abilities: Abilities { coolants: &[Coolant::Off, Coolant::Flood], length_offsets: None, cycles: &[], ..Abilities::USUAL },
    rests_at_mm: None,
    smoothing: None,
    five_axes: FiveAxisWords::NONE,
    syntax: Syntax::Iso(Iso {
        tool_change: "",
        length_offset: "",
        comment: Comment { open: "(", separator: " = ", close: ")" },
        block_numbers: BlockNumbers { step: 10, max: 9_999_990 },
        start: &[
            Frame::Header,
            Frame::ByUnits { mm: "G17 G21 G90 G40 G49 G80 G94", inch: "G17 G20 G90 G40 G49 G80 G94" },
            Frame::WorkOffset,
            Frame::SafeHome,
            Frame::SpindleOn,
            Frame::CoolantOn,
        ],
        ..Iso::USUAL
    }),
};

/// GRBL 1.1, `gcode.c`: error 33 above 0.5 mm, and above both 0.005 mm and 0.1 % of the radius.
const ARC_RULE: ArcRule =
    ArcRule { mismatch_mm: 0.005, mismatch_part: 0.001, most_mismatch_mm: 0.5, turn: None };

//! Fanuc 0i and 30i, milling.
//!
//! * Every coordinate and every feed has a decimal point. Without a point, the control counts in least
//!   increments: X10 would be ten micrometres.
//! * G43 stands in the block of the first motion along Z. In a block of its own, G43 might move the axis.
//! * The F of a helix is the speed along the helix. The control reads F in this way only if bit 5 (HTG) of
//!   parameter 1403 is set. Without this bit, it cuts the helix too fast.
//! * The two radii of an arc (at its start and at its end) differ by at most one unit of the last decimal.
//!   Parameter 3410 has to allow that difference.
//! * Parabolas become lines, because this control has no block for parabolas.
//! * The program does not set how far the control may cut corners. A parameter of the control sets that, or
//!   G5.1 (contour control).

use crate::dialect::{
    Abilities, Curves, Dialect, Dwell, FANUC_INVERSE_TIME, FiveAxisWords, Frame, Iso, Numbers, Point, ProgramNumber, SmoothingForm, SmoothingWords, Syntax,
    TipControl, Turns, Verification,
};
use toolpathd_core::toolpath::program::SmoothingMode;

pub const FANUC: Dialect = Dialect {
    name: "fanuc",
    description: "Fanuc 0i and 30i/31i/32i, milling",
    verification: Verification::RelatedInterpreter,
    file_extension: "nc",
    line_end: "\n",
    // The longest block has some 90 characters. Longer comments would leave the control's screen.
    max_line_length: 120,
    max_program_number: Some(9999),
    // As in the increment system IS-B. IS-C has one decimal more in mm.
    default_decimals_mm: 3,
    default_decimals_inch: 4,
    max_decimals: 4,
    numbers: Numbers { point: Point::Always, max_digits: 8, max_whole_digits: 8, max_feed_decimals: 6, feeds_in_tenths_of_inch: false, spindle_decimals: 0, max_spindle_rpm: 99_999 },
    // What parameter 3410 allows is not known: the usual rule stands.
    curves: Curves::ARCS,
    abilities: Abilities::USUAL,
    rests_at_mm: None,
    smoothing: Some(SmoothingWords {
        form: SmoothingForm::ContourControl,
        // A parameter of the control has the tolerance.
        takes_tolerance: false,
        needs_tolerance: false,
        takes_degrees: false,
        modes: &[SmoothingMode::Roughing, SmoothingMode::SemiFinishing, SmoothingMode::Finishing],
        usual_mode: None,
        own: &[50, 51, 80],
    }),
    five_axes: FiveAxisWords {
        // IS-C. A control with IS-B rounds to three decimals.
        angle_decimals: 4,
        angles: Some(TipControl { words: Some("G43.4 H{offset}"), ..TIP_CONTROL }),
        vectors: Some(TipControl { words: Some("G43.5 H{offset}"), ..TIP_CONTROL }),
        has_positions: true,
        switches_kinematics: false,
        rails: None,
        turns: Turns::InverseTime { most: FANUC_INVERSE_TIME },
    },
    syntax: Syntax::Iso(WORDS),
};

pub const TIP_CONTROL: TipControl = TipControl { before: &[], words: None, off: "G49", vector: ["I", "J", "K"] };

/// The words of this and similar controls. The separator of comments is no colon: in ISO code a colon is the
/// letter O.
pub const WORDS: Iso = Iso {
    tape_mark: Some("%"),
    program_number: Some(ProgramNumber { letter: 'O', digits: 4 }),
    dwell: Dwell::Milliseconds,
    start: &[
        Frame::Header,
        // The control wants G20 or G21 in a block of its own, before all other codes.
        Frame::ByUnits { mm: "G21", inch: "G20" },
        Frame::Text("G17 G90 G40 G49 G80 G94"),
        Frame::WorkOffset,
        Frame::SafeHome,
        // M6 moves to the tool change position by itself.
        Frame::ToolChange,
        Frame::SpindleOn,
        Frame::CoolantOn,
        Frame::Smoothing,
        Frame::LengthOffsetInFirstMotionAlongZ,
    ],
    ..Iso::USUAL
};

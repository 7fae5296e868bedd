//! Fanuc 0i and 30i, milling.
//!
//! * Every coordinate and feed has a decimal point. Without a point the control counts least increments: X10
//!   is ten micrometres. S, H, T and the P of a dwell are written without a point. A number has at most eight
//!   digits.
//! * G20 or G21 stands in a block of its own, before all other codes.
//! * G43 stands in the block of the first motion along Z. If G43 stood in a block of its own, it might move
//!   the axis by the length offset.
//! * The program does not set how closely the control follows corners: this control has no G64 with a
//!   tolerance. Its parameters or G5.1 set that.
//! * The F of a helix is the speed along the helix. The control reads F in this way only if bit 5 (HTG) of
//!   parameter 1403 is set. Otherwise F is the speed along the circle that the helix projects to, and the
//!   helix is cut too fast.
//! * Parabolas become lines, because this control has no block for parabolas. Its G5.1 is contour control.
//! * T M6 moves to the tool change position by itself. G28 is written only if the job asks for G28.
//!
//! A program has 3 decimals in mm and 4 in inches, as in the increment system IS-B. IS-C has one decimal more
//! in mm. The radii at the two ends of an arc differ by at most one unit of the last decimal; parameter 3410
//! has to allow that difference.

use crate::post::dialect::{
    BlockNumbers, Comment, Dialect, Dwell, Frame, Numbers, Parabolas, Point, ProgramNumber,
};

pub const FANUC: Dialect = Dialect {
    name: "fanuc",
    description: "Fanuc 0i and 30i/31i/32i, milling",
    file_extension: "nc",
    // The separator is no colon: in ISO code a colon is the letter O.
    comment: Comment { open: "(", separator: " = ", close: ")" },
    line_end: "\n",
    // The longest block has some 90 characters. Longer comments would leave the control's screen.
    max_line_length: 120,
    tape_mark: Some("%"),
    program_number: Some(ProgramNumber { letter: 'O', digits: 4, max: 9999 }),
    default_decimals_mm: 3,
    default_decimals_inch: 4,
    max_decimals: 4,
    numbers: Numbers { point: Point::Always, max_digits: 8, spindle_decimals: 0, max_spindle_rpm: 99_999 },
    block_numbers: BlockNumbers { step: 10, max: 99_990 },
    dwell: Dwell::Milliseconds,
    parabolas: Parabolas::AsLines,
    start: &[
        Frame::Header,
        Frame::ByUnits { mm: "G21", inch: "G20" },
        Frame::Text("G17 G90 G40 G49 G80 G94"),
        Frame::WorkOffset,
        Frame::SafeHome,
        Frame::ToolChange,
        Frame::SpindleOn,
        Frame::CoolantOn,
        Frame::LengthOffsetInFirstMotionAlongZ,
    ],
    end: &[Frame::SafeHome, Frame::Text("M5"), Frame::Text("M9"), Frame::Text("M30")],
};

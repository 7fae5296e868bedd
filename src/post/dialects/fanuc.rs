//! Fanuc 0i and 30i, milling.
//!
//! * Every coordinate and feed has a decimal point. Without a point the control counts least increments: X10
//!   is ten micrometres. A number has at most eight digits. S, H, T and the P of a dwell have no point.
//! * G20 or G21 stands in a block of its own, before all other codes.
//! * G43 stands in the block of the first motion along Z. In a block of its own, G43 may move the axis by the
//!   offset.
//! * No G64 with a tolerance is written: parameters of the machine, or G5.1, set how closely the control
//!   follows corners.
//! * The F of a helix counts along the helix. That needs parameter 1403 bit 5 (HTG) on the control. Without
//!   the bit the helix is cut too fast, by the ratio of its length to the length of its circle.
//! * Parabolas become lines: G5.1 is contour control on this control.
//! * T M6 goes to the change position by itself. G28 is written only where the job asks for G28.
//!
//! The decimals are those of the increment system IS-B, 3 with mm and 4 with inches. IS-C has one decimal
//! more with mm. The radii of an arc differ by less than one unit of the last decimal; parameter 3410 has to
//! allow that difference.

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

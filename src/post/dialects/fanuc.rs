//! Fanuc 0i and 30i, milling.
//!
//! * Every coordinate and feed has its decimal point: without one the control counts in its least increment, and X10
//!   is ten micrometres. A number has at most eight digits; S, H, T and the P of a dwell have no point.
//! * G20 or G21 stands in a block of its own, before everything else.
//! * G43 stands in the block of the first motion along Z: alone it may move the axis by the offset.
//! * There is no G64 with a tolerance: how closely corners are followed is set on the machine, by parameters or G5.1.
//! * The F of a helix is taken along the helix, which is parameter 1403 bit 5 (HTG) on the control; without it the
//!   helix is cut faster than written, by its length over that of its circle.
//! * Parabolas are lines: G5.1 is contour control here.
//! * T M6 goes to the change position by itself: no G28 is written unless the program asks for it.
//!
//! Decimals are those of the increment system IS-B, 3 with mm and 4 with inches; IS-C has one more with mm. The radii of
//! arcs differ by less than one unit of the last decimal, which parameter 3410 has to allow.

use crate::post::dialect::{
    BlockNumbers, Comment, Dialect, Dwell, Frame, Numbers, Parabolas, Point, ProgramNumber,
};

pub const FANUC: Dialect = Dialect {
    name: "fanuc",
    description: "Fanuc 0i and 30i/31i/32i, milling",
    file_extension: "nc",
    // A colon is the letter O in ISO code.
    comment: Comment { open: "(", separator: " = ", close: ")" },
    line_end: "\n",
    // The longest block has some 90 characters; comments are kept to what its screens show.
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

//! LinuxCNC.
//!
//! The control blends with `G64 P Q0`: it may leave the written path at joints by one unit of the last decimal
//! and joins no blocks. Exact path mode, G61, would leave the path nowhere but stop at every joint that
//! rounding has kinked; without either word a control keeps its speed and cuts corners as far as it likes.
//!
//! A parabola at one height is `G5.1 X Y I J`, with the Bezier control point from the start: X, Y, I and J of a quadratic
//! spline. The interpreter wants G17, no Z, and the G word with both offsets on every block; the feed is modal as
//! elsewhere. It is no mode: a block without a G word behind it is run as the last G0 to G3 says, so that word is written
//! again. The control runs such a block as 24 arcs, and what these leave of it is part of the rounding that the header
//! states.
//!
//! M30 alone ends the program; a pair of percent signs would be the other way and is not needed.

use crate::post::dialect::{BlockNumbers, Comment, Dialect, Dwell, Frame, Numbers, Parabolas, Point};

pub const LINUXCNC: Dialect = Dialect {
    name: "linuxcnc",
    description: "LinuxCNC 2.8 and later",
    file_extension: "ngc",
    comment: Comment { open: "(", separator: ": ", close: ")" },
    line_end: "\n",
    // The interpreter reads 255 characters with the line end.
    max_line_length: 240,
    tape_mark: None,
    program_number: None,
    default_decimals_mm: 3,
    default_decimals_inch: 4,
    max_decimals: 6,
    numbers: Numbers {
        point: Point::WhereNeeded,
        // What a double holds exactly.
        max_digits: 15,
        spindle_decimals: 3,
        max_spindle_rpm: 1_000_000,
    },
    block_numbers: BlockNumbers { step: 10, max: 99_990 },
    dwell: Dwell::Seconds,
    parabolas: Parabolas::InXy,
    start: &[
        Frame::Header,
        Frame::ByUnits { mm: "G17 G21 G90 G40 G49 G80 G94", inch: "G17 G20 G90 G40 G49 G80 G94" },
        Frame::Blending { before: "G64 P", after: " Q0" },
        Frame::WorkOffset,
        Frame::SafeHome,
        Frame::ToolChange,
        Frame::LengthOffset,
        Frame::SpindleOn,
        Frame::CoolantOn,
    ],
    end: &[Frame::SafeHome, Frame::Text("M5"), Frame::Text("M9"), Frame::Text("M30")],
};

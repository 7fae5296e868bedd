//! LinuxCNC.
//!
//! The control blends with `G64 P Q0`: it may leave the written path at joints by one unit of the last
//! decimal, and joins no blocks. Exact path mode, G61, would keep the path exactly, but stop at every joint
//! that rounding has kinked. Without G64 or G61 the control keeps its speed and cuts corners by any distance.
//!
//! A parabola at one height is `G5.1 X Y I J`, a quadratic spline: I and J go from the start to the Bezier
//! control point. The interpreter needs G17, no Z, and G5.1 with both offsets on every block. The feed is
//! modal. G5.1 is not modal: the control runs a next block without a G word as the last G0 to G3 says, so the
//! next block repeats its G word. The control runs a parabola as 24 arcs. The rounding in the header includes
//! the distance of these arcs from the parabola.
//!
//! M30 alone ends the program. Percent signs at both ends would serve as well and are left out.

use crate::post::dialect::{BlockNumbers, Comment, Dialect, Dwell, Frame, Numbers, Parabolas, Point};

pub const LINUXCNC: Dialect = Dialect {
    name: "linuxcnc",
    description: "LinuxCNC 2.8 and later",
    file_extension: "ngc",
    comment: Comment { open: "(", separator: ": ", close: ")" },
    line_end: "\n",
    // The interpreter reads at most 255 characters with the line end.
    max_line_length: 240,
    tape_mark: None,
    program_number: None,
    default_decimals_mm: 3,
    default_decimals_inch: 4,
    max_decimals: 6,
    numbers: Numbers {
        point: Point::WhereNeeded,
        // An f64 holds any number of 15 digits without loss.
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

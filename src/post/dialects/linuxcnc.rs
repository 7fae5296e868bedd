//! LinuxCNC.
//!
//! * G64 lets the control round corners, so that it does not slow down at them. The word P limits the
//!   deviation from the written path to one unit of the last decimal. Without P, the control could cut a
//!   corner by any distance. In exact path mode (G61), it would stop at every small angle that rounding has
//!   made.
//! * A parabola in a plane of constant Z is written as a quadratic spline: `G5.1 X Y I J`. I and J lead from
//!   the start to the Bezier control point. The control runs the parabola as 24 arcs. The bound of the
//!   deviation in the program's header includes the distance of these arcs from the parabola.
//! * Tip control is M428, ended by M429, on machines whose configuration switches kinematics with these
//!   codes.
//! * The program ends with M30, without percent signs.

use super::fanuc::TIP_CONTROL;
use toolpathd_core::geometry::arc_fit::LARGEST_RADIUS_MM;
use crate::dialect::{
    Abilities, ArcRule, Comment, Curves, Dialect, FiveAxisWords, Frame, Iso, Numbers, Point, Parabolas, SmoothingForm, SmoothingWords, Syntax, TipControl, Turns, Verification,
};

pub const LINUXCNC: Dialect = Dialect {
    name: "linuxcnc",
    description: "LinuxCNC 2.8 and later",
    verification: Verification::Interpreter,
    file_extension: "ngc",
    line_end: "\n",
    // The interpreter reads at most 255 characters with the line end.
    max_line_length: 240,
    max_program_number: None,
    default_decimals_mm: 3,
    default_decimals_inch: 4,
    max_decimals: 6,
    numbers: Numbers {
        point: Point::WhereNeeded,
        // An f64 holds any number of 15 digits without loss.
        max_digits: 15, max_whole_digits: 15,
        max_feed_decimals: 6,
        feeds_in_tenths_of_inch: false,
        spindle_decimals: 3,
        max_spindle_rpm: 1_000_000,
    },
    // G5.1 needs G17, no Z word, and I and J in every block. It is not modal: a block behind it without a G
    // word would run as the last of G0 to G3.
    // The interpreter has no largest radius.
    curves: Curves { parabolas: Parabolas::InXy, largest_radius_mm: LARGEST_RADIUS_MM, accepts: ARC_RULE, ..Curves::ARCS },
    abilities: Abilities::USUAL,
    // A ten-thousandth of a degree would move a point 200 mm beside the axis by a third of a micrometre.
    rests_at_mm: None,
    smoothing: Some(SmoothingWords {
        form: SmoothingForm::Blending,
        takes_tolerance: true,
        needs_tolerance: true,
        takes_degrees: false,
        modes: &[],
        usual_mode: None,
        own: &[610, 611, 640],
    }),
    five_axes: FiveAxisWords {
        angle_decimals: 5,
        // Remapped codes of the sample configurations with `sparm=identityfirst`: 1 and 0 of
        // `motion.switchkins-type`. `motion.tooloffset.z` tells the kinematics the length that G43 selects.
        angles: Some(TipControl { before: &["M428"], off: "M429", ..TIP_CONTROL }),
        switches_kinematics: true,
        has_positions: true,
        // The interpreter has no limit: a tenth of a millisecond, which is below the period of its servo
        // thread.
        turns: Turns::InverseTime { most: 600_000 },
        ..FiveAxisWords::NONE
    },
    syntax: Syntax::Iso(Iso {
        comment: Comment { open: "(", separator: ": ", close: ")" },
        start: &[
            Frame::Header,
            Frame::ByUnits { mm: "G17 G21 G90 G40 G49 G80 G94", inch: "G17 G20 G90 G40 G49 G80 G94" },
            // Q0 forbids the control to merge blocks.
            Frame::Blending { before: "G64 P", after: " Q0" },
            Frame::WorkOffset,
            Frame::SafeHome,
            Frame::ToolChange,
            Frame::LengthOffset,
            Frame::SpindleOn,
            Frame::CoolantOn,
        ],
        ..Iso::USUAL
    }),
};

/// The interpreter (`interp_arc.cc`) refuses a difference of the radii above both 0.0011 inch and 0.1 % of
/// the radius, and above a hundred times that length. A machine may set another length. Written
/// arcs differ by far less ([`Curves::radius_mismatch_mm`]).
const ARC_RULE: ArcRule =
    ArcRule { mismatch_mm: 0.027_94, mismatch_part: 0.001, most_mismatch_mm: 2.794, turn: None };

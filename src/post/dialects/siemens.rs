//! Siemens Sinumerik 840D sl and its relatives, milling, in the control's own language.
//!
//! * G710 and G700 select the units of coordinates and of feeds. G70 and G71 would leave feeds alone.
//! * D selects a cutting edge of the tool, and so its length: `length_offset` of the request, or 1.
//! * The move to zero of the machine's coordinates has D0, so that the length of the tool does not count.
//! * G54 to G57 are the work offsets; G58 and G59 are something else on this control.
//! * Under TRAORI coordinates are those of the tip. ORIVECT turns the axis on the great circle. A3, B3 and C3
//!   state the vector from the tip to the holder.
//! * Rails are polynomials of degree 5 (POLY) of the tip and of a second point on the axis (XH, YH, ZH) under
//!   ORICURVE. POLYPATH says that polynomials move both. BSPLINE stops at degree 3, and the manual of
//!   SINUMERIK ONE (*NC programming*, 12/2019, p. 684) excludes polynomials of XH, YH and ZH under it.
//! * An arc states its centre. The control runs the arc about a centre of its own, which near half a turn may
//!   lie far from the stated one. Such an arc is divided, or written as lines.
//! * Under G93, F is 1 divided by the minutes that the block takes, also under TRAORI.

use crate::dialect::{
    Abilities, ArcRule, BlockNumbers, Comment, Curves, Dialect, Dwell, FiveAxisWords, Frame, Iso, LengthOffsets, Numbers, Point, SmoothingForm, SmoothingWords, Syntax,
    TipControl, Turns, Verification,
};
use toolpathd_core::toolpath::program::{SafeHome, SmoothingMode};

pub const SIEMENS: Dialect = Dialect {
    name: "siemens",
    description: "Siemens Sinumerik 840D sl, 828D and One, milling",
    verification: Verification::Reader,
    file_extension: "mpf",
    line_end: "\n",
    // A block of polynomials is long.
    max_line_length: 500,
    max_program_number: None,
    default_decimals_mm: 3,
    default_decimals_inch: 4,
    max_decimals: 6,
    numbers: Numbers { point: Point::WhereNeeded, max_digits: 15, max_whole_digits: 15, max_feed_decimals: 6, feeds_in_tenths_of_inch: false, spindle_decimals: 3, max_spindle_rpm: 999_999 },
    curves: Curves { radius_mismatch_mm: ARC_RULE.mismatch_mm, accepts: ARC_RULE, ..Curves::ARCS },
    abilities: Abilities {
        work_offsets: &[54, 55, 56, 57],
        safe_homes: &[SafeHome::None, SafeHome::G53],
        // Each tool has its own cutting edges, of which the first is the usual one.
        length_offsets: Some(LengthOffsets { letter: 'D', usual: Some(1), most: 32_000 }),
        ..Abilities::USUAL
    },
    rests_at_mm: None,
    smoothing: Some(SmoothingWords {
        form: SmoothingForm::Cycle832,
        takes_tolerance: true,
        needs_tolerance: true,
        takes_degrees: true,
        modes: &[SmoothingMode::Roughing, SmoothingMode::SemiFinishing, SmoothingMode::Finishing],
        usual_mode: Some(SmoothingMode::Finishing),
        own: &[600, 640, 6410, 6420, 6430, 6440, 6450],
    }),
    five_axes: FiveAxisWords {
        angle_decimals: 5,
        angles: Some(TipControl { before: &["TRAORI", "ORIWKS", "ORIAXES"], ..TIP_CONTROL }),
        vectors: Some(TipControl { before: &["TRAORI", "ORIWKS", "ORIVECT"], ..TIP_CONTROL }),
        has_positions: true,
        switches_kinematics: false,
        rails: Some(TipControl {
            before: &["TRAORI", "ORIWKS", "ORIVECT", "POLYPATH(\"AXES\",\"VECT\")"],
            ..TIP_CONTROL
        }),
        // The range of F in the older manuals ends at 99 999.99.
        turns: Turns::InverseTime { most: 99_999 },
    },
    syntax: Syntax::Siemens(Iso {
        comment: Comment { open: "; ", separator: " = ", close: "" },
        block_numbers: BlockNumbers { step: 10, max: 9_999_990 },
        dwell: Dwell::FeedWord,
        tool_change: "T{tool} M6",
        length_offset: "D{offset}",
        reference_point: &[],
        machine_zero: &["G0 SUPA {Z0} D0"],
        start: &[
            Frame::Header,
            Frame::ByUnits { mm: "G17 G710 G90 G40 G94", inch: "G17 G700 G90 G40 G94" },
            // Rounding begins no farther from a corner, and leaves the path by no more.
            Frame::Blending { before: "G641 ADIS=", after: "" },
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

/// Alarm 14040 (SINUMERIK 840D sl, *Diagnostics Manual*) stops an arc whose radii differ by more than machine
/// data 21000 (CIRCLE_ERROR_CONST, usually 0.01 mm), for larger radii by more than the part of machine data
/// 21010 (CIRCLE_ERROR_FACTOR, usually 0.001). The control computes a centre of its own from the radius at
/// the start. The alarm also stops an arc whose own centre is turned by sqrt(0.001) radians or more.
const ARC_RULE: ArcRule = ArcRule {
    mismatch_mm: 0.01,
    mismatch_part: 0.001,
    most_mismatch_mm: f64::INFINITY,
    // Rounded down.
    turn: Some(0.031_622),
};

const TIP_CONTROL: TipControl =
    TipControl { before: &[], words: None, off: "TRAFOOF", vector: ["A3=", "B3=", "C3="] };

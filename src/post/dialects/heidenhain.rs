//! Heidenhain Klartext (conversational): iTNC 530, TNC 620, TNC 640, TNC7.
//!
//! * Arcs lie in any of the three planes: CC states the centre, C the end. DR+ turns as G3 does.
//! * CP states a helix about Z by the angle that it turns (IPA, in ten-thousandths of a degree) and its
//!   rise (IZ). It ends beside the point of the toolpath by what rounding has moved; the next block states
//!   X and Y.
//! * In a program in inches, F counts tenths of an inch per minute.
//! * The feed of a turn about a resting tip is in degrees per minute.
//! * G54 to G59 are the rows 1 to 6 of the table of presets.
//! * The move to zero of the machine's coordinates is `M91`; there is no move to a reference point.

use crate::dialect::{
    Abilities, ArcRule, Arcs, Curves, Dialect, FiveAxisWords, Numbers, Point, SmoothingForm, SmoothingWords, Syntax, TipControl, Turns, Verification,
};
use toolpathd_core::toolpath::cutting::Coolant;
use toolpathd_core::toolpath::cycle::CycleKind;
use toolpathd_core::toolpath::program::{SafeHome, SmoothingMode};

pub const HEIDENHAIN: Dialect = Dialect {
    name: "heidenhain",
    description: "Heidenhain iTNC 530, TNC 620, TNC 640 and TNC7, Klartext",
    verification: Verification::Reader,
    file_extension: "h",
    line_end: "\n",
    max_line_length: 120,
    max_program_number: Some(99_999_999),
    default_decimals_mm: 3,
    default_decimals_inch: 4,
    max_decimals: 4,
    numbers: Numbers { point: Point::WhereNeeded, max_digits: 9, max_whole_digits: 5, max_feed_decimals: 3, feeds_in_tenths_of_inch: true, spindle_decimals: 0, max_spindle_rpm: 99_999 },
    // The largest radius of CR is 99.9999 m (iTNC 530, *User's Manual*, 340 49x-05, p. 207). C has the same
    // range of coordinates. Rounding may enlarge a written radius by a hundredth.
    curves: Curves { arcs: Arcs::WithHelicesAboutZ, largest_radius_mm: 98_900.0, accepts: ARC_RULE, ..Curves::ARCS },
    abilities: Abilities {
        safe_homes: &[SafeHome::None, SafeHome::G53],
        coolants: &[Coolant::Off, Coolant::Flood],
        length_offsets: None,
        cycles: &[CycleKind::Drill, CycleKind::Peck, CycleKind::Ream],
        max_dwell_s: 3600.0,
        max_tool: 32_767,
        ..Abilities::USUAL
    },
    rests_at_mm: None,
    smoothing: Some(SmoothingWords {
        form: SmoothingForm::Cycle32,
        takes_tolerance: true,
        needs_tolerance: true,
        takes_degrees: true,
        modes: &[SmoothingMode::Roughing, SmoothingMode::Finishing],
        usual_mode: None,
        own: &[],
    }),
    five_axes: FiveAxisWords {
        angle_decimals: 4,
        angles: Some(TipControl { before: &["FUNCTION TCPM F TCP AXIS POS PATHCTRL AXIS"], ..TIP_CONTROL }),
        vectors: Some(TipControl { before: &["FUNCTION TCPM F TCP AXIS SPAT PATHCTRL VECTOR"], ..TIP_CONTROL }),
        has_positions: false,
        switches_kinematics: false,
        rails: None,
        turns: Turns::DegreesPerMinute,
    },
    syntax: Syntax::Klartext,
};

/// The ends may lie beside the circle by 0.016 mm (TNC 320, *User's Manual*, 340 55x-03, p. 155: the machine
/// parameter circleDeviation).
const ARC_RULE: ArcRule = ArcRule::fixed(0.016);

const TIP_CONTROL: TipControl =
    TipControl { before: &[], words: None, off: "FUNCTION RESET TCPM", vector: ["TX", "TY", "TZ"] };

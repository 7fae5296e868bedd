//! Deckel FP-2, as one paper prints it.
//!
//! The only source is Fig. 4-4 of Y. H. Koo, D. J. Lee, S. Namgung, M. S. Kang, *A Study on the Construction
//! of CAD/CAM System for Machining of Sculptured Surface of Die*, 1989: two programs of G0 and G1 in mm. What
//! they do not show is not written: arcs become lines, and inches, dwells, coolant, work offsets, comments
//! and leaning tools are refused.

use crate::dialect::{
    Abilities, Arcs, Curves, Dialect, FiveAxisWords, Numbers, Point, Syntax, Verification,
};
use toolpathd_core::toolpath::cutting::Coolant;
use toolpathd_core::toolpath::program::{SafeHome, Units};

pub const DECKEL: Dialect = Dialect {
    name: "deckel",
    description: "Deckel FP-2, as printed by Koo and others (1989)",
    verification: Verification::Reader,
    file_extension: "dkl",
    line_end: "\n",
    max_line_length: 80,
    max_program_number: Some(9999),
    // The least increment of the paper is a micrometre.
    default_decimals_mm: 3,
    default_decimals_inch: 3,
    max_decimals: 3,
    numbers: Numbers { point: Point::WhereNeeded, max_digits: 8, max_whole_digits: 8, max_feed_decimals: 3, feeds_in_tenths_of_inch: false, spindle_decimals: 0, max_spindle_rpm: 99_999 },
    curves: Curves { arcs: Arcs::AsLines, ..Curves::ARCS },
    abilities: Abilities {
        units: &[Units::Mm],
        work_offsets: &[],
        safe_homes: &[SafeHome::None],
        coolants: &[Coolant::Off],
        length_offsets: None,
        needs_tool: true,
        has_dwells: false,
        cycles: &[],
        has_comments: false,
        ..Abilities::USUAL
    },
    rests_at_mm: Some([0.0, 0.0, 100.0]),
    smoothing: None,
    five_axes: FiveAxisWords::NONE,
    syntax: Syntax::Deckel,
};

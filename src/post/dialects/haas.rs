//! Haas, Next Generation Control, milling.
//!
//! The words are those of Fanuc, with these differences:
//! * A program number has five digits.
//! * Tip control is G234, in a block of G0 and without G43. It knows angles, no vectors.

use super::fanuc::{FANUC, TIP_CONTROL, WORDS};
use crate::dialect::{Dialect, FANUC_INVERSE_TIME, FiveAxisWords, Iso, ProgramNumber, SmoothingForm, SmoothingWords, Syntax, TipControl, Turns};
use toolpathd_core::toolpath::program::SmoothingMode;

pub const HAAS: Dialect = Dialect {
    name: "haas",
    description: "Haas Next Generation Control, milling",
    max_program_number: Some(99_999),
    smoothing: Some(SmoothingWords {
        form: SmoothingForm::G187,
        takes_tolerance: true,
        needs_tolerance: false,
        takes_degrees: false,
        modes: &[SmoothingMode::Roughing, SmoothingMode::SemiFinishing, SmoothingMode::Finishing],
        usual_mode: Some(SmoothingMode::Finishing),
        own: &[1870],
    }),
    five_axes: FiveAxisWords {
        angle_decimals: 3,
        angles: Some(TipControl { words: Some("G234 H{offset}"), ..TIP_CONTROL }),
        vectors: None,
        has_positions: true,
        switches_kinematics: false,
        rails: None,
        turns: Turns::InverseTime { most: FANUC_INVERSE_TIME },
    },
    syntax: Syntax::Iso(Iso { program_number: Some(ProgramNumber { letter: 'O', digits: 5 }), ..WORDS }),
    ..FANUC
};

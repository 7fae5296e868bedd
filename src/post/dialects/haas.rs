//! Haas, Next Generation Control, milling.
//!
//! The words are those of Fanuc, with these differences:
//! * A program number has five digits.
//! * Tip control is G234, in a block of G0 and without G43. It knows angles, no vectors.

use super::fanuc::{FANUC, TIP_CONTROL, WORDS};
use crate::dialect::{Dialect, FiveAxisWords, Iso, ProgramNumber, Syntax, TipControl, Turns};

pub const HAAS: Dialect = Dialect {
    name: "haas",
    description: "Haas Next Generation Control, milling",
    max_program_number: Some(99_999),
    five_axes: FiveAxisWords {
        angle_decimals: 3,
        angles: Some(TipControl { words: Some("G234 H{offset}"), ..TIP_CONTROL }),
        vectors: None,
        has_positions: true,
        rails: None,
        turns: Turns::InverseTime,
    },
    syntax: Syntax::Iso(Iso { program_number: Some(ProgramNumber { letter: 'O', digits: 5 }), ..WORDS }),
    ..FANUC
};

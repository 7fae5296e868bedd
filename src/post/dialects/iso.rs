//! The words of ISO 6983 that most controls share, for a control without a dialect of its own. Nothing has
//! read programs of this dialect but the reader that checks each of them.

use super::fanuc::{FANUC, WORDS};
use crate::dialect::{Dialect, Dwell, FiveAxisWords, Iso, Syntax, Verification};

pub const ISO: Dialect = Dialect {
    name: "iso",
    description: "ISO 6983, the words that most controls share (unverified)",
    verification: Verification::Unverified,
    file_extension: "iso",
    five_axes: FiveAxisWords { angle_decimals: 4, has_positions: true, ..FiveAxisWords::NONE },
    // The unit of P differs between controls, but a number with a point is in seconds on most of them.
    syntax: Syntax::Iso(Iso { dwell: Dwell::Seconds, ..WORDS }),
    // The words of Fanuc for it are not those of every control.
    smoothing: None,
    ..FANUC
};

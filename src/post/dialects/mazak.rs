//! Mazak in its EIA/ISO language. Nothing has read programs of this dialect but the reader that checks each
//! of them. The words are those of Fanuc.

use super::fanuc::FANUC;
use crate::dialect::{Curves, Dialect, Verification};

pub const MAZAK: Dialect = Dialect {
    name: "mazak",
    description: "Mazak, EIA/ISO, milling (unverified)",
    verification: Verification::Unverified,
    file_extension: "eia",
    // I and J run to 99,999.999 mm (*VORTEX i*, *Programming Manual EIA/ISO*, table 3-1). Rounding may
    // enlarge a written radius by a hundredth.
    curves: Curves { largest_radius_mm: 98_900.0, ..Curves::ARCS },
    // The words differ between its generations.
    smoothing: None,
    ..FANUC
};

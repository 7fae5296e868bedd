//! Mazak in its EIA/ISO language. Nothing has read programs of this dialect but the reader that checks each
//! of them. The words are those of Fanuc.

use super::fanuc::FANUC;
use crate::dialect::{Dialect, Verification};

pub const MAZAK: Dialect = Dialect {
    name: "mazak",
    description: "Mazak, EIA/ISO, milling (unverified)",
    verification: Verification::Unverified,
    file_extension: "eia",
    // The words differ between its generations.
    smoothing: None,
    ..FANUC
};

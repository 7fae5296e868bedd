//! Canned cycles in toolpaths of requests.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use crate::config::Limits;
use crate::http::decode::tagged::Kind;
use crate::http::dto::check::Range;
use crate::http::dto::point::PlanePoint;
use crate::http::dto::schema::{array_of, reference, schema_of};
use toolpathd_core::toolpath::cycle::{CycleKind, ReturnTo, n_moves_of_hole};

/// A canned cycle: holes along Z, one after the other. The tool goes across at its height, then down to the
/// retract plane as a rapid, and then makes the hole. A dialect that has the cycle writes its word; which
/// has which, `/v1/dialects` says. In all other dialects, and where the tool leans or turns, the program has
/// the moves. Only in requests: the toolpath of an answer has the moves.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct CycleMove {
    #[serde(rename = "kind", skip_serializing)]
    #[schema(ignore)]
    _kind: Kind,
    /// How the holes are made.
    pub cycle: CycleKind,
    /// The places of the holes, in mm, in the order in which they are made.
    #[schema(value_type = HolePlaces)]
    pub places: Vec<PlanePoint>,
    /// Height of the material, in mm.
    #[schema(minimum = -1_000_000, maximum = 1_000_000)]
    pub top_z_mm: f64,
    /// Height from which the tool drills, in mm: at `top_z_mm` or above. The tool has to be at this height or
    /// above it where the cycle starts.
    #[schema(minimum = -1_000_000, maximum = 1_000_000)]
    pub retract_z_mm: f64,
    /// Height of the tip at the bottom of the holes, in mm: below `top_z_mm`.
    #[schema(minimum = -1_000_000, maximum = 1_000_000)]
    pub bottom_z_mm: f64,
    /// Depth of a peck, in mm. `chip_break` and `peck` need it; no other cycle takes it. The control chooses
    /// how far the tool goes back between pecks; written as moves it is 0.5 mm.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(minimum = 0.001, maximum = 1_000_000)]
    pub peck_mm: Option<f64>,
    /// Pause at the bottom, in s. `drill` and `ream` take it. Default: none.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(minimum = 0, maximum = 3600)]
    pub dwell_s: Option<f64>,
    /// Feed, in mm/min. Default: the feed of plunges of `cutting`.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(minimum = 0.001, maximum = 1_000_000)]
    pub feed_mm_per_min: Option<f64>,
    /// Where the tool goes after each hole.
    #[serde(default)]
    #[schema(default = "retract_plane")]
    pub return_to: ReturnTo,
}

schema_of!(HolePlaces of PlanePoint, "Places in the plane, in mm.", {
    array_of(reference::<PlanePoint>(), 1, Limits::DEFAULT.moves)
});

impl CycleMove {
    /// The number of moves for which the cycle stands, at most.
    pub fn n_moves(&self) -> usize {
        // A peck that is refused makes no moves.
        let peck_mm = self.peck_mm.filter(|peck| Range::POSITIVE.holds(*peck));
        let of_hole = n_moves_of_hole(self.retract_z_mm - self.bottom_z_mm, peck_mm);
        // A count beyond all numbers is the largest.
        (of_hole * self.places.len() as f64) as usize
    }
}

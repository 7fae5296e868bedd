//! The move that is a canned cycle.

use serde::Deserialize;
use utoipa::ToSchema;

use crate::config::Limits;
use crate::http::decode::tagged::Kind;
use crate::http::dto::check::Range;
use crate::http::dto::point::PlanePoint;
use crate::http::dto::schema::{array_of, reference, schema_of};
use toolpathd_core::toolpath::cycle::{CycleKind, Hole, ReturnTo};
use toolpathd_core::toolpath::units::FeedRate;

/// A canned cycle: holes along Z, one after the other. The tool goes across to a hole as a rapid at the
/// height where it is, then down to the retract plane as a rapid, and then makes the hole. Between holes it
/// goes across at the height that `return_to` chooses. A dialect that has the cycle writes its word; which
/// has which, `/v1/dialects` says. All other dialects write the moves, and so does every dialect where the
/// request has a `machine`, and where rounding leaves nothing of a peck. The tool has to be straight up.
#[derive(Debug, Clone, PartialEq, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct CycleMove {
    #[serde(rename = "kind")]
    #[schema(ignore)]
    _kind: Kind,
    /// How the holes are made. `drill`: to the bottom at feed, and back as a rapid (G81; G82 with `dwell_s`).
    /// `chip_break`: in pecks, after each of which the tool goes back by a little (G73). `peck`: in pecks,
    /// after each of which the tool goes back to the retract plane (G83). `ream`: to the bottom and back to
    /// the retract plane, both at feed (G85; G89 with `dwell_s`).
    pub cycle: CycleKind,
    /// The places of the holes, in mm, in the order in which they are made.
    #[schema(value_type = HolePlaces)]
    pub places: Vec<PlanePoint>,
    /// Height of the material, in mm.
    #[schema(minimum = -1_000_000, maximum = 1_000_000)]
    pub top_z_mm: f64,
    /// Height from which the tool drills, in mm: above `top_z_mm`, because the tool comes down there as a
    /// rapid. The tool has to be at this height or above it where the cycle starts.
    #[schema(minimum = -1_000_000, maximum = 1_000_000)]
    pub retract_z_mm: f64,
    /// Height of the tip at the bottom of the holes, in mm: below `top_z_mm`.
    #[schema(minimum = -1_000_000, maximum = 1_000_000)]
    pub bottom_z_mm: f64,
    /// Depth of a peck, in mm. `chip_break` and `peck` need it; no other cycle takes it. A peck that reaches
    /// from `top_z_mm` to `bottom_z_mm` makes the cycle a `drill`. After a peck with a full retract, a rapid
    /// comes back to a little above the depth that was drilled; how far is a setting of the control, and for
    /// `heidenhain` the distance of the retract plane from the material. In written moves it is 0.5 mm, and
    /// pecks count from the retract plane.
    #[schema(minimum = 0.001, maximum = 1_000_000)]
    pub peck_mm: Option<f64>,
    /// Pause at the bottom, in s. `drill` and `ream` take it, in dialects with `dwells`. Default: none.
    #[schema(minimum = 0, maximum = 3600)]
    pub dwell_s: Option<f64>,
    /// Feed, in mm/min. Default: the feed of plunges of `cutting`.
    #[schema(minimum = 0.001, maximum = 1_000_000)]
    pub feed_mm_per_min: Option<f64>,
    /// Where the tool goes after each hole, and at which height it goes across to the next. `retract_plane`:
    /// `retract_z_mm` (G99). `start`: the height at which it was before the cycle (G98), for example above
    /// clamps.
    #[serde(default)]
    #[schema(default = "retract_plane")]
    pub return_to: ReturnTo,
}

schema_of!(HolePlaces of PlanePoint, "Places in the plane, in mm.", {
    array_of(reference::<PlanePoint>(), 1, Limits::DEFAULT.moves / 3)
});

impl CycleMove {
    /// The number of moves for which the cycle stands, at most.
    pub fn n_moves(&self) -> usize {
        // A peck or a height that is refused makes no pecks.
        let has_heights = [self.retract_z_mm, self.bottom_z_mm].iter().all(|z| Range::COORDINATE.holds(*z));
        let peck_mm = self.peck_mm.filter(|peck| has_heights && Range::POSITIVE.holds(*peck));
        let hole = Hole { peck_mm, ..self.hole(FeedRate::DEFAULT_RAPID) };
        // A count beyond all numbers is the largest.
        hole.n_moves(self.places.len()) as usize
    }

    pub fn hole(&self, rate: FeedRate) -> Hole {
        Hole {
            kind: self.cycle,
            top_z_mm: self.top_z_mm,
            retract_z_mm: self.retract_z_mm,
            bottom_z_mm: self.bottom_z_mm,
            peck_mm: self.peck_mm,
            dwell_s: self.dwell_s.unwrap_or_default(),
            rate,
            return_to: self.return_to,
        }
    }
}

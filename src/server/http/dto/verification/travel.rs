//! Where the tip may go, and how rapids run, in requests to verify.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use crate::http::dto::point::Point;

/// The box in which the tip may move.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(as = TipTravel)]
pub struct Travel {
    /// The least coordinates, in mm.
    pub(super) min: Point,
    /// The largest coordinates, in mm.
    pub(super) max: Point,
}

/// How a control runs a rapid along several axes: along a straight line, or with all axes at the same speed
/// until each has arrived. With `dog_leg` both ways are verified.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
#[schema(as = RapidWays)]
pub enum Rapids {
    Straight,
    DogLeg,
}

//! What is legal in a pocket's outlines and heights and yet often a mistake.

use super::{Warning, WarningCode, member};
use crate::http::pointer::Pointer;
use toolpathd_core::operations::pocketing::Doubt;

impl Warning {
    /// The warning of `count` bulges of more than a half circle, the first of them at `at`.
    pub fn bulge_over_half_circle(at: &Pointer, count: usize) -> Self {
        let more = match count {
            1 => String::new(),
            2 => " (and one more)".to_owned(),
            count => format!(" (and {} more)", count - 1),
        };
        let detail = format!(
            "a bulge beyond 1{more} makes an arc of more than a half circle: check that a bulge was meant, not a radius, which is sent as `{{\"to\": [x, y], \"radius_mm\": 8}}`"
        );
        Self::new(WarningCode::BulgeOverHalfCircle, detail).about(at)
    }
}

impl From<&Doubt> for Warning {
    fn from(doubt: &Doubt) -> Self {
        let (code, at, advice) = match doubt {
            Doubt::IslandOutside { region, index } => (
                WarningCode::IslandOutside,
                region
                    .map_or_else(|| member("/region"), |k| member("/regions").index(k))
                    .field("islands")
                    .index(*index),
                "check its coordinates, or leave it out",
            ),
            Doubt::IslandCut { region, index, .. } => (
                WarningCode::IslandCut,
                member("/regions").index(*region).field("islands").index(*index),
                "check the coordinates of both, or give the island to both regions",
            ),
            Doubt::RegionBeyondPart { .. } => {
                (WarningCode::RegionBeyondPart, member("/region/boundary"), "check the coordinates of both")
            }
            Doubt::StockBelowPart { .. } => (
                WarningCode::StockBelowPart,
                member("/top_z_mm"),
                "check both heights, or leave `top_z_mm` out",
            ),
        };
        Self::new(code, format!("{doubt}; {advice}")).about(&at)
    }
}

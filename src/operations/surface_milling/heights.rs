//! The heights of rapids, chosen from the part or checked against it.

use super::{CuttingRequest, Error};
use crate::toolpath::tool::Cutting;
use crate::toolpath::units::FeedRate;

/// Default distance of the clearance plane from the top of the part, mm.
const CLEARANCE_ABOVE_TOP_MM: f64 = 20.0;

/// Default distance of the retract plane from the top of the part, mm.
const RETRACT_ABOVE_TOP_MM: f64 = 2.0;

/// The conditions with every default filled in; `top_mm` is the height of the part.
pub(super) fn resolve(request: &CuttingRequest, top_mm: f64) -> Result<Cutting, Error> {
    let CuttingRequest { feed, plunge_feed, rapid_feed, spindle_rpm, coolant, clearance_z_mm, retract_z_mm } =
        *request;
    let above_top = |field, value: Option<f64>, default: f64| match value {
        Some(value_mm) if value_mm < top_mm - super::TOP_ACCURACY_MM => {
            Err(Error::HeightBelowTop { field, value_mm, top_mm })
        }
        Some(value_mm) => Ok(value_mm),
        None => Ok(top_mm + default),
    };
    let retract_z_mm = above_top("retract_z_mm", retract_z_mm, RETRACT_ABOVE_TOP_MM)?;
    let default_clearance = CLEARANCE_ABOVE_TOP_MM.max(retract_z_mm - top_mm);
    let clearance_z_mm = above_top("clearance_z_mm", clearance_z_mm, default_clearance)?;
    if clearance_z_mm < retract_z_mm {
        return Err(Error::ClearanceBelowRetract { clearance_mm: clearance_z_mm, retract_mm: retract_z_mm });
    }
    // Half of a positive feed is a feed, unless it is the smallest number there is.
    let plunge_feed = plunge_feed.or(FeedRate::from_mm_per_min(0.5 * feed.mm_per_min())).unwrap_or(feed);
    Ok(Cutting { feed, plunge_feed, rapid_feed, spindle_rpm, coolant, clearance_z_mm, retract_z_mm })
}

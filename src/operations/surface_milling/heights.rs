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
    let rapid_feed = rapid_feed.unwrap_or(FeedRate::DEFAULT_RAPID);
    Ok(Cutting { feed, plunge_feed, rapid_feed, spindle_rpm, coolant, clearance_z_mm, retract_z_mm })
}

#[cfg(test)]
mod tests {
    use super::*;

    const TOP: f64 = 10.0;

    fn request() -> CuttingRequest {
        CuttingRequest::at_feed(FeedRate::from_mm_per_min(800.0).unwrap())
    }

    #[test]
    fn defaults_are_chosen_from_the_part() {
        let cutting = resolve(&request(), TOP).unwrap();
        assert_eq!((cutting.retract_z_mm, cutting.clearance_z_mm), (12.0, 30.0));
        assert_eq!(cutting.plunge_feed.mm_per_min(), 400.0);
        assert_eq!(cutting.rapid_feed.mm_per_min(), 10_000.0);
    }

    #[test]
    fn a_high_retract_plane_lifts_the_clearance_plane() {
        let cutting = resolve(&CuttingRequest { retract_z_mm: Some(50.0), ..request() }, TOP).unwrap();
        assert_eq!((cutting.retract_z_mm, cutting.clearance_z_mm), (50.0, 50.0));
    }

    #[test]
    fn heights_below_the_part_or_each_other_are_refused() {
        for field in ["retract_z_mm", "clearance_z_mm"] {
            let mut request = request();
            let height =
                if field == "retract_z_mm" { &mut request.retract_z_mm } else { &mut request.clearance_z_mm };
            *height = Some(9.0);
            assert_eq!(
                resolve(&request, TOP),
                Err(Error::HeightBelowTop { field, value_mm: 9.0, top_mm: TOP })
            );
        }
        let crossed = CuttingRequest { retract_z_mm: Some(15.0), clearance_z_mm: Some(11.0), ..request() };
        let expected = Error::ClearanceBelowRetract { clearance_mm: 11.0, retract_mm: 15.0 };
        assert_eq!(resolve(&crossed, TOP), Err(expected));
    }
}

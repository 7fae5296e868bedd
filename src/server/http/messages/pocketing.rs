//! Clearing of pockets.

use super::{Warning, WarningCode, in_plane, member, too_large};
use crate::http::error::{ApiError, Code, FieldCode};
use crate::http::pointer::Pointer;
use toolpathd_core::geometry::height_field::HeightFieldError;
use toolpathd_core::geometry::region::{OutlineError, RegionError};
use toolpathd_core::operations::pocketing::{self, PocketError};
use toolpathd_core::toolpath::PathError;
use toolpathd_core::toolpath::units::rounded_up;

impl From<&pocketing::Warning> for Warning {
    fn from(warning: &pocketing::Warning) -> Self {
        use pocketing::Warning as Of;
        let (code, detail) = match *warning {
            Of::PlacesNotReached { .. } => (WarningCode::PlacesNotReached, warning.to_string()),
            Of::IslandsByLabelling { gouge_mm } => (
                WarningCode::RoughingPathGouges,
                format!(
                    "`islands_by` is `labelling`: islands are as coarse as the grid, and the path cuts up to {:.4} mm into the part; send `slicing` for exact islands",
                    rounded_up(gouge_mm)
                ),
            ),
            Of::EntryElsewhere { count, of, z_mm } => {
                let detail = format!(
                    "on {count} of {of} levels, first at Z {z_mm:.3} mm, the cutter does not come down at `entry.at`: the place is outside there, has no room for an entry, or needs none because the material is gone"
                );
                return Self::new(WarningCode::EntryElsewhere, detail).about(&member("/entry/at"));
            }
            Of::NarrowForClearance { .. } => (WarningCode::NarrowForClearance, warning.to_string()),
            Of::LoadNotBounded => (
                WarningCode::LoadNotBounded,
                "`choose_by` is `paper_time`: slots are cut at the full feed, unless `cutting.slot_feed_mm_per_min` is sent"
                    .to_owned(),
            ),
            Of::StepoverNarrowed => (
                WarningCode::StepoverNarrowed,
                "`stepover_mm` is larger than the cutter's radius: rings lie closer where they would leave material"
                    .to_owned(),
            ),
        };
        Self::new(code, detail)
    }
}

impl From<PocketError> for ApiError {
    fn from(error: PocketError) -> Self {
        let fact = error.to_string();
        match error {
            PocketError::Stopped(stopped) => stopped.into(),
            PocketError::Heights(heights) => heights.into(),
            PocketError::Quantize(quantize) => quantize.into(),
            PocketError::Region(error) => region(&member("/region"), &error, fact),
            PocketError::Outline { island, error } => outline(&member("/region"), island, error, fact),
            PocketError::OfRegions { regions, error } => of_regions(&regions, *error, fact),
            PocketError::Cleared { index, island, error } => {
                let island_told = island.map_or_else(String::new, |k| format!(", island {k}"));
                let detail = format!("`cleared` {index}{island_told}: {error}");
                outline(&member("/cleared").index(index), island, error, detail)
            }
            PocketError::ClearedEmpty { index } => {
                let detail = format!("`cleared` {index} is empty: its islands fill it; leave it out");
                illegal(&member("/cleared").index(index), detail)
            }
            PocketError::FloorNotBelowTop { .. } => illegal(&member("/floor_z_mm"), fact),
            PocketError::Surface(source) => source.into(),
            PocketError::Relief(error) => match error {
                HeightFieldError::Stopped(stopped) => stopped.into(),
                HeightFieldError::Overhang { at } => Self::new(Code::Overhang, fact).at(at.into()),
                HeightFieldError::TooMany { .. } => {
                    too_large("/surface", format!("{fact}; send a smaller part of it"))
                }
            },
            PocketError::OutlinesTooFine { .. } => too_fine("/region", &fact),
            PocketError::TooManyCells { .. } => {
                too_large("/cell_mm", format!("{fact}; send a larger `cell_mm`"))
            }
            PocketError::NothingToCut => Self::new(Code::NothingToCut, fact),
            PocketError::ToolTooLarge { at, .. } => Self::new(Code::ToolTooLarge, fact)
                .blaming(&member("/tool/diameter_mm"), FieldCode::OutOfRange)
                .at(in_plane(at)),
            PocketError::NoEntry { at, least_mm, largest_mm } => {
                let detail = format!(
                    "near {at} neither a helix of {least_mm} mm nor a ramp fits, and `entry.plunge` is `false`; allow the plunge, or send a tool of at most {largest_mm:.3} mm"
                );
                Self::new(Code::NoEntry, detail)
                    .blaming(&member("/entry/plunge"), FieldCode::Conflict)
                    .at(in_plane(at))
            }
            PocketError::EntryOutside { at, by_mm } => {
                let detail = format!(
                    "`entry.at` is {by_mm:.3} mm outside of where the cutter's centre may come down; walls and islands need the cutter's radius, `allowance_mm` and `clearance_side_mm`"
                );
                illegal(&member("/entry/at"), detail).at(in_plane(at))
            }
            PocketError::EntryTooNarrow { at, room_mm, least_mm } => {
                let detail = format!(
                    "at `entry.at` a helix has room for {room_mm:.3} mm and needs {least_mm} mm, and `entry.plunge` is `false`; move the place, allow the plunge, or drill a hole"
                );
                illegal(&member("/entry/at"), detail).at(in_plane(at))
            }
            PocketError::TooMuchWork { .. } => too_large("/stepover_mm", fact),
            PocketError::NoneValid { .. } => Self::new(Code::NoValidPattern, fact),
            PocketError::Path(PathError::TooManyMoves { .. }) => {
                let advice =
                    "send a larger `stepover_mm` or `stepdown_max_mm`, or a steeper or wider `entry`";
                too_large("/stepover_mm", format!("{fact}: {advice}"))
                    .blaming(&member("/entry"), FieldCode::LimitExceeded)
            }
            PocketError::Path(_) => Self::new(Code::InternalError, fact),
        }
    }
}

/// The failure of a request with an illegal value at `at`.
fn illegal(at: &Pointer, detail: String) -> ApiError {
    ApiError::new(Code::InvalidRequest, detail).blaming(at, FieldCode::OutOfRange)
}

/// The failure of the region at `at`.
fn region(at: &Pointer, error: &RegionError, fact: String) -> ApiError {
    match error {
        RegionError::TooMany { .. } => too_large(at.as_str(), fact),
        RegionError::Tangled { at: place } => illegal(at, fact).at(in_plane(*place)),
        _ => illegal(at, fact),
    }
}

/// The failure of outlines with too many elements, of the region at `path`.
fn too_fine(path: &str, fact: &str) -> ApiError {
    let advice = "send fewer vertices, or fit arcs to them with `/v1/arcs/fit`";
    too_large(path, format!("{fact}; {advice}"))
}

/// The failure of one of several regions, or of some that are cut as one. `fact` names them; the first is to
/// blame.
fn of_regions(regions: &[usize], error: PocketError, fact: String) -> ApiError {
    let at = regions.iter().min().map_or_else(|| member("/regions"), |k| member("/regions").index(*k));
    let names = fact.strip_suffix(error.to_string().as_str()).unwrap_or_default().to_owned();
    let failed = match error {
        PocketError::Region(error) => return region(&at, &error, fact),
        PocketError::Outline { island, error } => return outline(&at, island, error, fact),
        PocketError::OutlinesTooFine { .. } => return too_fine(at.as_str(), &fact),
        PocketError::Stopped(stopped) => return stopped.into(),
        error => ApiError::from(error),
    };
    // The names of the regions, and then the detail that one region alone would have.
    let detail = format!("{names}{}", failed.detail());
    failed.saying(detail).blaming(&at, FieldCode::Conflict)
}

/// The failure of the boundary, or of an island, of the region at `region`.
fn outline(region: &Pointer, island: Option<usize>, error: OutlineError, detail: String) -> ApiError {
    let at = match island {
        None => region.field("boundary"),
        Some(k) => region.field("islands").index(k),
    };
    let failed = illegal(&at, detail);
    if let OutlineError::Crosses { at } = error { failed.at(in_plane(at)) } else { failed }
}

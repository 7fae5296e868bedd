//! Problem documents for the failures of pockets.

use nalgebra::Point2;

use crate::http::error::{ApiError, Code, FieldCode};
use crate::http::pointer::Pointer;
use toolpathd_core::geometry::height_field::HeightFieldError;
use toolpathd_core::geometry::region::{OutlineError, RegionError};
use toolpathd_core::operations::pocketing::PocketError;
use toolpathd_core::toolpath::PathError;

fn place(at: Point2<f64>) -> [f64; 3] {
    [at.x, at.y, 0.0]
}

impl From<PocketError> for ApiError {
    fn from(error: PocketError) -> Self {
        let detail = error.to_string();
        let root = Pointer::root();
        let region = root.field("region");
        match error {
            PocketError::Stopped(stopped) => stopped.into(),
            PocketError::Heights(heights) => heights.into(),
            PocketError::Quantize(quantize) => quantize.into(),
            PocketError::Region(error) => {
                let failed = Self::new(Code::InvalidRequest, detail).blaming(&region, FieldCode::OutOfRange);
                match error {
                    RegionError::Tangled { at } => failed.at(place(at)),
                    RegionError::TooMany { .. } => Self::new(Code::LimitExceeded, error.to_string())
                        .blaming(&region, FieldCode::LimitExceeded),
                    _ => failed,
                }
            }
            PocketError::Outline { island, error } => {
                let at = match island {
                    None => region.field("boundary"),
                    Some(k) => region.field("islands").index(k),
                };
                let failed = Self::new(Code::InvalidRequest, detail).blaming(&at, FieldCode::OutOfRange);
                if let OutlineError::Crosses { at } = error { failed.at(place(at)) } else { failed }
            }
            PocketError::Cleared { index, island, error } => {
                let at = root.field("cleared").index(index);
                let at = match island {
                    None => at.field("boundary"),
                    Some(k) => at.field("islands").index(k),
                };
                let failed = Self::new(Code::InvalidRequest, detail).blaming(&at, FieldCode::OutOfRange);
                if let OutlineError::Crosses { at } = error { failed.at(place(at)) } else { failed }
            }
            PocketError::ClearedEmpty { index } => Self::new(Code::InvalidRequest, detail)
                .blaming(&root.field("cleared").index(index), FieldCode::OutOfRange),
            PocketError::FloorNotBelowTop { .. } => Self::new(Code::InvalidRequest, detail)
                .blaming(&root.field("floor_z_mm"), FieldCode::OutOfRange),
            PocketError::Surface(source) => source.into(),
            PocketError::Relief(error) => match error {
                HeightFieldError::Stopped(stopped) => stopped.into(),
                HeightFieldError::Overhang { at } => Self::new(Code::Overhang, detail).at(at.into()),
                HeightFieldError::TooMany { .. } => Self::new(Code::LimitExceeded, detail)
                    .blaming(&root.field("surface"), FieldCode::LimitExceeded),
            },
            PocketError::OutlinesTooFine { .. } => {
                Self::new(Code::LimitExceeded, detail).blaming(&region, FieldCode::LimitExceeded)
            }
            PocketError::TooManyCells { .. } => Self::new(Code::LimitExceeded, detail)
                .blaming(&root.field("cell_mm"), FieldCode::LimitExceeded),
            PocketError::NothingToCut => Self::new(Code::NothingToCut, detail),
            PocketError::ToolTooLarge { at, .. } => Self::new(Code::ToolTooLarge, detail)
                .blaming(&root.field("tool").field("diameter_mm"), FieldCode::OutOfRange)
                .at(place(at)),
            PocketError::NoEntry { at, .. } => Self::new(Code::NoEntry, detail)
                .blaming(&root.field("entry").field("plunge"), FieldCode::Conflict)
                .at(place(at)),
            PocketError::TooMuchWork { .. } => Self::new(Code::LimitExceeded, detail)
                .blaming(&root.field("stepover_mm"), FieldCode::LimitExceeded),
            PocketError::NoneValid { .. } => Self::new(Code::NoValidPattern, detail),
            PocketError::Path(PathError::TooManyMoves { .. }) => {
                let advice =
                    "send a larger `stepover_mm` or `stepdown_max_mm`, or a steeper or wider `entry`";
                Self::new(Code::LimitExceeded, format!("{detail}: {advice}"))
                    .blaming(&root.field("stepover_mm"), FieldCode::LimitExceeded)
                    .blaming(&root.field("entry"), FieldCode::LimitExceeded)
            }
            PocketError::Path(_) => Self::new(Code::InternalError, detail),
        }
    }
}

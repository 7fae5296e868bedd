//! How the text of a program was read, for a receipt.

use serde::Serialize;
use utoipa::ToSchema;

use super::{Compensation, ProgramReading, WithoutPoint, WorkZero};
use crate::http::dto::point::Coordinates;
use crate::http::dto::point::Point;
use crate::http::error::ApiError;
use toolpathd_core::toolpath::program::Units;
use toolpathd_nc::control::{self, RadiusRule};
use toolpathd_nc::frames::EXTENDED;
use toolpathd_nc::machine::Correction;

/// How the text of the program was read: every setting of the request that the text does not say, with its
/// default where the request did not name it.
#[derive(Debug, Clone, Serialize, ToSchema)]
#[schema(as = ReceiptProgram)]
pub struct ReadPremises {
    /// Name of the control's dialect.
    dialect: &'static str,
    /// Unit of lengths before the first G20 or G21.
    units: Units,
    /// What a length without a decimal point means.
    without_point: WithoutPoint,
    /// Where the tip stands before the first block, in mm. Absent where it is not known.
    #[serde(skip_serializing_if = "Option::is_none")]
    start: Option<Point>,
    /// The zeros of the work offsets.
    offsets: Vec<WorkZero>,
    /// Whether blocks behind a slash are left out.
    block_delete: bool,
    /// What G41 and G42 mean.
    compensation: Compensation,
    /// The wear that the control is set to, in mm: none.
    wear_mm: f64,
    /// How arcs of two radii are taken.
    arcs: ArcModel,
}

/// How far the two radii of an arc may differ. An arc of two radii runs about a centre that is moved until
/// the radii are equal.
#[derive(Debug, Clone, Serialize, ToSchema)]
#[schema(as = ReceiptArcs)]
struct ArcModel {
    /// Difference that is always allowed, in mm.
    radii_differ_mm: f64,
    /// Difference that is allowed as a ratio to the radius.
    radii_differ_share: f64,
    /// Difference above which every arc is refused, in mm.
    radii_differ_most_mm: f64,
}

impl ProgramReading {
    /// How the text is read.
    ///
    /// # Errors
    /// As [`ProgramReading::control`].
    pub fn premises(&self) -> Result<ReadPremises, ApiError> {
        let control = self.control()?;
        let job = self.read_job(control);
        let RadiusRule { mm, mm_in_inches, relative, most_mm } = control.radius;
        let start = match job.start {
            [Some(x), Some(y), Some(z)] => Some(Coordinates([x, y, z])),
            _ => None,
        };
        let offset = |(number, zero): &(u32, [f64; 3])| WorkZero {
            name: offset_name(*number),
            zero: Coordinates(*zero),
        };
        Ok(ReadPremises {
            dialect: control.name,
            units: if job.in_inches { Units::Inch } else { Units::Mm },
            without_point: match job.without_point.unwrap_or(control.without_point) {
                control::WithoutPoint::Increments => WithoutPoint::Increments,
                control::WithoutPoint::Units => WithoutPoint::Units,
            },
            start,
            offsets: job.offsets.iter().map(offset).collect(),
            block_delete: job.skips_optional,
            compensation: match job.correction {
                Correction::Refused => Compensation::Refuse,
                Correction::Wear => Compensation::Wear,
                Correction::Computed(_) => Compensation::Compute,
            },
            wear_mm: 0.0,
            arcs: ArcModel {
                radii_differ_mm: if job.in_inches { mm_in_inches } else { mm },
                radii_differ_share: relative,
                radii_differ_most_mm: most_mm,
            },
        })
    }
}

/// The name of a work offset, as requests have it.
fn offset_name(number: u32) -> String {
    match number {
        1..=6 => format!("G{}", 53 + number),
        7..=9 => format!("G59.{}", number - 6),
        _ => format!("G54.1 P{}", number - EXTENDED),
    }
}

#[cfg(test)]
mod tests {
    use super::super::offset_number;
    use super::*;

    #[test]
    fn names_of_work_offsets_are_read_back() {
        for number in (1..=9).chain([EXTENDED + 1, EXTENDED + 300]) {
            assert_eq!(offset_number(&offset_name(number)), Some(number));
        }
    }
}

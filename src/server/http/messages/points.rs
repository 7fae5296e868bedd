//! Mistakes in measured points, and what was put right in them.

use super::{Warning, WarningCode};
use crate::http::error::FieldCode;
use toolpathd_core::geometry::point_judge::{Change, Fault};

/// Most rows that a warning names; it counts the others.
const MOST_NAMED: usize = 5;

/// The code and the sentence of a fault. Its place is the pointer's.
pub fn point_fault(fault: &Fault) -> (FieldCode, String) {
    let axis_name = |axis: usize| ["x", "y", "z"].get(axis).copied().unwrap_or("z");
    match *fault {
        Fault::AllSame => {
            (FieldCode::Coincident, "all points are the same: send points of a surface".to_owned())
        }
        Fault::Missing { axis, value, .. } => (
            FieldCode::MissingValue,
            format!(
                "{} is {value}, which stands for a missing value: send the measured value, or leave out the whole row or column",
                axis_name(axis)
            ),
        ),
        Fault::Repeated { is_columns, number, of } => {
            let name = line(is_columns);
            (FieldCode::Coincident, format!("{name} {number} repeats {name} {of}: leave one of them out"))
        }
        Fault::Doubled { of: [i, j], .. } => (
            FieldCode::Coincident,
            format!("the point repeats the point {i}/{j}: send each point once, or send `outliers: accept`"),
        ),
        Fault::ExchangedAxes { axis } => {
            let name = axis_name(axis);
            (
                FieldCode::ExchangedAxes,
                format!(
                    "{name} and z look exchanged: seen from above the points fold over each other, and along {name} they do not. Send [x, y, z] with z upwards, or send `outliers: accept`"
                ),
            )
        }
        Fault::Backward { is_columns, number } => {
            let name = line(is_columns);
            (
                FieldCode::ReversedRow,
                format!(
                    "{name} {number} runs the other way than most: reverse the {name} together with its `end_tangents`, so that all run alike"
                ),
            )
        }
        Fault::OutOfOrder { is_columns, number } => {
            let name = line(is_columns);
            (
                FieldCode::OutOfOrder,
                format!(
                    "{name} {number} does not follow the {name} before: send the {name}s in the order in which they lie on the surface, or send `outliers: accept`"
                ),
            )
        }
        Fault::Outlier { off_mm, usual_mm, .. } => (
            FieldCode::Outlier,
            format!(
                "the point is {off_mm:.4} mm off the surface of its neighbours, where {usual_mm:.4} mm is usual: correct the point, or send `outliers: accept`"
            ),
        ),
    }
}

impl From<&Change> for Warning {
    fn from(change: &Change) -> Self {
        let (fact, is_columns, numbers) = match change {
            Change::Reversed { is_columns, numbers } => {
                ("ran the other way than the others; the service reversed", *is_columns, numbers)
            }
            Change::Sorted { is_columns, numbers } => {
                ("did not stand in the order in which they lie; the service sorted", *is_columns, numbers)
            }
            Change::PointsSorted { is_columns, numbers } => {
                ("held points out of order; the service sorted the points of", *is_columns, numbers)
            }
        };
        let named: Vec<String> = numbers.iter().take(MOST_NAMED).map(usize::to_string).collect();
        let more = match numbers.len().saturating_sub(MOST_NAMED) {
            0 => String::new(),
            more => format!(" and {more} more"),
        };
        let lines = format!("{}{}", line(is_columns), if numbers.len() == 1 { "" } else { "s" });
        let them = if numbers.len() == 1 { "it" } else { "them" };
        let detail = format!("`surface.points`: {lines} {}{more} {fact} {them}", named.join(", "));
        Self::new(WarningCode::PointsReordered, detail)
    }
}

impl Warning {
    /// The warning of ends that close without the caller's word. `closed` holds u and v.
    pub fn ends_periodic([u, v]: [bool; 2]) -> Self {
        let along = match (u, v) {
            (true, true) => "u and v",
            (true, false) => "u",
            _ => "v",
        };
        let detail = format!(
            "the points are closed along {along}, and the surface closes smoothly there; send `ends: not_a_knot` where the seam is a sharp edge"
        );
        Self::new(WarningCode::EndsPeriodic, detail)
    }
}

fn line(is_columns: bool) -> &'static str {
    if is_columns { "column" } else { "row" }
}

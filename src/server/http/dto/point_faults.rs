//! Mistakes in measured points and heights, as violations of a request.

use serde::Deserialize;
use utoipa::ToSchema;

use crate::http::dto::check::Violations;
use crate::http::messages;
use crate::http::pointer::Pointer;
use toolpathd_core::geometry::point_judge::Fault;

/// What to do with points that look like mistakes.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum Outliers {
    #[default]
    Refuse,
    Accept,
}

/// Adds a violation for each fault of the points or heights at `at`.
pub fn add(at: &Pointer, faults: &[Fault], violations: &mut Violations) {
    for fault in faults {
        let (code, detail) = messages::point_fault(fault);
        let at = match *fault {
            Fault::AllSame | Fault::ExchangedAxes { .. } => at.clone(),
            Fault::Missing { place: [i, j], .. }
            | Fault::Doubled { place: [i, j], .. }
            | Fault::Outlier { place: [i, j], .. } => at.index(i).index(j),
            Fault::Repeated { is_columns: true, number, .. }
            | Fault::Backward { is_columns: true, number }
            | Fault::OutOfOrder { is_columns: true, number } => at.index(0).index(number),
            Fault::Repeated { number, .. }
            | Fault::Backward { number, .. }
            | Fault::OutOfOrder { number, .. } => at.index(number),
        };
        violations.add(&at, code, detail);
    }
}

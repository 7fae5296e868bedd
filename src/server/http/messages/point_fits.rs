//! What a caller reads of surfaces that are fitted to points.

use super::WarningCode;
use crate::http::error::{FieldCode, FieldError};
use crate::http::pointer::Pointer;
use toolpathd_core::geometry::point_judge::Fault;
use toolpathd_core::geometry::surface::point_fit::{Extrapolated, Fitted, Outlier, PointFitError};

/// Most outliers that a warning lists; it counts all.
const MOST_LISTED: usize = 10;

/// What is told of a fitted surface. `sent` holds the places of the fitted points in the request.
pub fn fitted_points(fitted: &Fitted, sent: &[usize]) -> Vec<(WarningCode, String)> {
    let Fitted { nurbs, n_points, rms_mm, max_mm, left_out, extrapolated } = fitted;
    let points = &nurbs.control_points;
    let size = [points.len(), points.first().map_or(0, Vec::len)];
    let figures = format!(
        "the surface runs near {n_points} points, not through them: root mean square of the vertical errors {rms_mm:.6} mm, largest {max_mm:.6} mm, with {} x {} control points",
        size[0], size[1]
    );
    let mut told = vec![(WarningCode::PointsFitted, figures)];
    if !left_out.is_empty() {
        let listed: Vec<String> = left_out.iter().take(MOST_LISTED).map(|one| described(one, sent)).collect();
        let more = left_out.len().saturating_sub(MOST_LISTED);
        let more = if more > 0 { format!(", and {more} more") } else { String::new() };
        let detail = format!(
            "{} points are off the surface of their neighbours, and are left out: {}{more}",
            left_out.len(),
            listed.join(", ")
        );
        told.push((WarningCode::OutliersLeftOut, detail));
    }
    if let Some(Extrapolated { share, at: [x, y], distance_mm }) = extrapolated {
        let detail = format!(
            "{:.1} % of the rectangle around the points have no point near, and the surface there is a continuation: at x {x:.3}, y {y:.3} the nearest point is {distance_mm:.3} mm away; mill within a `boundary`, or send points there",
            100.0 * share
        );
        told.push((WarningCode::SurfaceExtrapolated, detail));
    }
    told
}

fn described(outlier: &Outlier, sent: &[usize]) -> String {
    let Outlier { index, point, off_mm } = outlier;
    format!("point {} at x {:.3}, y {:.3} by {off_mm:.4} mm", sent[*index], point.x, point.y)
}

/// The sentence about a number that stands for a missing value.
pub fn missing_point(fault: &Fault) -> String {
    let value = if let Fault::Missing { value, .. } = fault { *value } else { 0.0 };
    format!(
        "{value} stands for a missing value: leave the point out, or send `outliers: leave_out`; with `outliers: accept` it counts as a value"
    )
}

/// What is wrong with points that give no surface. `at` is the place of the surface, and `sent` holds the
/// places of the points in the request.
pub fn point_fit_faults(at: &Pointer, error: &PointFitError, sent: &[usize]) -> Vec<FieldError> {
    let points = at.field("points");
    let fact = error.to_string();
    let (at, code, detail) = match error {
        PointFitError::Outliers { outliers } => {
            return outliers.iter().map(|outlier| refused(&points, outlier, sent)).collect();
        }
        // The caller ends the request.
        PointFitError::Stopped(_) => return Vec::new(),
        PointFitError::TooManyOutliers { first, .. } => {
            let advice = "allow a larger error in `fit`, or send `outliers: accept` if they are right";
            (points.index(sent[first.index]), FieldCode::Outlier, format!("{fact}; {advice}"))
        }
        PointFitError::Stacked { pair: [low, high], rise_mm } => {
            let detail = format!(
                "the point is above point {}, by {rise_mm:.4} mm; a fitted surface has one height over each place: send the points of one side of the part",
                sent[*low]
            );
            (points.index(sent[*high]), FieldCode::Conflict, detail)
        }
        PointFitError::TooFar { .. } => {
            let advice = "allow a larger error, or send points without steps and sharp edges";
            (at.field("fit"), FieldCode::OutOfRange, format!("{fact}; {advice}"))
        }
        PointFitError::NotFinite { index } => (points.index(sent[*index]), FieldCode::TooLarge, fact),
        PointFitError::TooFew { .. } => (points, FieldCode::TooFewPoints, fact),
        PointFitError::OnALine { .. } | PointFitError::MostlyExtrapolated { .. } => {
            (points, FieldCode::Unsupported, fact)
        }
        PointFitError::Bound => (at.field("fit"), FieldCode::OutOfRange, fact),
        PointFitError::Nurbs(_) => (points, FieldCode::LimitExceeded, fact),
    };
    vec![FieldError::new(&at, code, detail)]
}

fn refused(points: &Pointer, Outlier { index, off_mm, .. }: &Outlier, sent: &[usize]) -> FieldError {
    let detail = format!(
        "the point is {off_mm:.4} mm off the surface of its neighbours: measure it again, leave it out, or send `outliers: leave_out`; with `outliers: accept` it counts as all others"
    );
    FieldError::new(&points.index(sent[*index]), FieldCode::Outlier, detail)
}

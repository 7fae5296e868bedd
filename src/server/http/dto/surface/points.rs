//! The surface kind `points` in requests: measured points in any order, near which a smooth surface runs.

use nalgebra::Point3;
use serde::Deserialize;
use utoipa::ToSchema;

use super::Nurbs;
use crate::config::Limits;
use crate::http::decode::files::FileReading;
use crate::http::decode::object;
use crate::http::decode::tagged::Kind;
use crate::http::dto::check::{Range, Violations};
use crate::http::dto::point::Point;
use crate::http::dto::schema::{array_of, reference, schema_of};
use crate::http::error::FieldCode;
use crate::http::messages::{self, WarningCode};
use crate::http::pointer::Pointer;
use toolpathd_core::geometry::point_judge::missing_values;
use toolpathd_core::geometry::surface::point_fit::{Error, OutlierChoice, PointFit, PointFitError};

/// Measured points in any order, near which a smooth surface z(x, y) runs: the smoothest bicubic spline with
/// the stated error. For noisy points; `point_grid` passes through its points.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(as = SurfacePoints)]
pub struct Points {
    #[serde(rename = "kind")]
    #[schema(ignore)]
    _kind: Kind,
    /// Points in mm, at least 3, in any order. The surface covers their rectangle in plan, which runs along
    /// the rows of a turned grid, and along x and y otherwise. Where it has no points near, the surface is an
    /// extrapolation (warning `surface_extrapolated`); more than half of it is refused.
    #[schema(value_type = PointList)]
    points: Vec<Point>,
    /// The error of the surface at the points: `max_mm` or `rms_mm`. The surface is as smooth as this error
    /// permits.
    #[serde(deserialize_with = "object::required")]
    fit: FitError,
    /// What to do with points off the surface of their neighbours, and with numbers that stand for missing
    /// values, such as -9999. `refuse`: they are refused with their pointers. `leave_out`: the surface runs
    /// near the other points, and the answer warns (`outliers_left_out`). `accept`: they count as all others.
    #[serde(default)]
    #[schema(default = "refuse")]
    outliers: FitOutliers,
}

/// The error of a surface at points: the largest one or the root mean square. One of both is required.
#[derive(Debug, Clone, Copy, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(as = PointFitError)]
pub struct FitError {
    /// The largest vertical distance of a point from the surface, in mm.
    #[schema(minimum = 1e-6, maximum = 10)]
    max_mm: Option<f64>,
    /// The root of the mean of the squared vertical distances, in mm.
    #[schema(minimum = 1e-6, maximum = 10)]
    rms_mm: Option<f64>,
}

/// What to do with points that look like mistakes.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum FitOutliers {
    #[default]
    Refuse,
    LeaveOut,
    Accept,
}

schema_of!(PointList of Point, "Points in mm, in any order.", {
    array_of(reference::<Point>(), LEAST, Limits::DEFAULT.surface_points)
});

/// Fewest points of a surface.
const LEAST: usize = 3;

/// Legal errors, mm.
const ERRORS: Range = Range { min: 1e-6, max: 10.0 };

impl Points {
    pub fn points(&self) -> impl Iterator<Item = &Point> {
        self.points.iter()
    }

    pub fn check(&self, at: &Pointer, limits: &Limits, violations: &mut Violations) {
        let Self { _kind: _, points, fit, outliers: _ } = self;
        let at_points = at.field("points");
        if violations.count_of_points(&at_points, points.len(), LEAST, limits.surface_points) {
            points.iter().enumerate().for_each(|(k, point)| point.check_in(&at_points, k, violations));
        }
        let at_fit = at.field("fit");
        let FitError { max_mm, rms_mm } = *fit;
        violations.optional(&at_fit.field("max_mm"), max_mm, ERRORS, "mm");
        violations.optional(&at_fit.field("rms_mm"), rms_mm, ERRORS, "mm");
        if max_mm.is_some() == rms_mm.is_some() {
            let code = if max_mm.is_some() { FieldCode::Conflict } else { FieldCode::MissingField };
            violations.add(&at_fit, code, "send either `max_mm` or `rms_mm`");
        }
    }

    /// The surface near the points; `None` with violations where there is none.
    pub fn fitted(&self, at: &Pointer, reading: &mut FileReading) -> Option<Nurbs> {
        let before = reading.violations.total();
        self.check(at, reading.limits, &mut reading.violations);
        if reading.violations.total() > before {
            return None;
        }
        let kept = self.kept(at, reading)?;
        let points = kept.iter().map(|k| Point3::from(self.points[*k])).collect();
        let outliers = match self.outliers {
            FitOutliers::Refuse => OutlierChoice::Refuse,
            FitOutliers::LeaveOut => OutlierChoice::LeaveOut,
            FitOutliers::Accept => OutlierChoice::Keep,
        };
        let error = match self.fit {
            FitError { max_mm: Some(bound), .. } => Error::Max(bound),
            FitError { rms_mm, .. } => Error::Rms(rms_mm.unwrap_or_default()),
        };
        match (PointFit { points, error, outliers }).fitted(reading.budget) {
            Ok(fitted) => {
                for (code, detail) in messages::fitted_points(&fitted, &kept) {
                    reading.warn(at, code, detail);
                }
                Some(Nurbs::scaled(&fitted.nurbs, 1.0))
            }
            Err(PointFitError::Stopped(stopped)) => {
                reading.stop(stopped);
                None
            }
            Err(error) => {
                for fault in messages::point_fit_faults(at, &error, &kept) {
                    reading.violations.add_made(|| fault);
                }
                None
            }
        }
    }

    /// The places of the points whose numbers are values; `None` with violations where others are refused.
    fn kept(&self, at: &Pointer, reading: &mut FileReading) -> Option<Vec<usize>> {
        let all: Vec<usize> = (0..self.points.len()).collect();
        if self.outliers == FitOutliers::Accept {
            return Some(all);
        }
        let points: Vec<Point3<f64>> = self.points.iter().copied().map(Point3::from).collect();
        let missing = missing_values(&points);
        if missing.is_empty() {
            return Some(all);
        }
        if self.outliers == FitOutliers::Refuse {
            for (k, fault) in &missing {
                let (code, _) = messages::point_fault(fault);
                reading.violations.add(&at.field("points").index(*k), code, messages::missing_point(fault));
            }
            return None;
        }
        let is_missing: std::collections::BTreeSet<usize> = missing.iter().map(|(k, _)| *k).collect();
        let detail = format!(
            "{} points hold a number that stands for a missing value, and are left out",
            is_missing.len()
        );
        reading.warn(at, WarningCode::OutliersLeftOut, detail);
        Some(all.into_iter().filter(|k| !is_missing.contains(k)).collect())
    }
}

//! Counts what the largest radius of a control costs.

use nalgebra::Point3;

use super::Job;
use crate::budget::{Budget, Stopped};
use crate::geometry::arc_fit::{Fit, FitError, FittedCurve, LARGEST_RADIUS_MM, Method, fit_in_space};

/// Pairs of elements between two checks of the budget.
const PAIRS_BETWEEN_CHECKS: usize = 64;

/// The number of joints of `pieces` that arcs without the control's largest radius would not need: one arc
/// replaces the points of all elements between two of the other joints. Zero where the control runs all arcs
/// that a fit makes.
///
/// # Errors
/// When the budget ends.
pub(super) fn needless_joints(
    pieces: &[FittedCurve],
    points: &[Point3<f64>],
    job: &Job,
    budget: &Budget,
) -> Result<usize, Stopped> {
    if job.curves.largest_radius_mm >= LARGEST_RADIUS_MM || job.fit.method == Method::Biarc {
        return Ok(0);
    }
    let request = Fit { method: Method::Greedy, is_closed: false, ..job.fit };
    let (mut needless, mut start, mut end) = (0, 0, 0);
    for (k, piece) in pieces.iter().enumerate() {
        if k.is_multiple_of(PAIRS_BETWEEN_CHECKS) {
            budget.check()?;
        }
        if k > 0 {
            match fit_in_space(&points[start..=piece.end], job.plane, &request, budget) {
                Ok(fitted) if fitted.curves.len() == 1 => needless += 1,
                Err(FitError::Stopped(stopped)) => return Err(stopped),
                Ok(_) | Err(FitError::OnePlace) => start = end,
            }
        }
        end = piece.end;
    }
    Ok(needless)
}

#[cfg(test)]
mod tests {
    use super::super::{Plan, Warning, plan};
    use super::*;
    use crate::toolpath::quantize::Curves;

    /// Points on an arc of a radius, from -half to half about its top, fitted for a control that runs arcs up
    /// to `largest_radius_mm`.
    fn fitted(radius: f64, half: f64, n: u32, largest_radius_mm: f64) -> Plan {
        let at = |k: u32| {
            let x = half * (2.0 * f64::from(k) / f64::from(n - 1) - 1.0);
            Point3::new(x, (radius * radius - x * x).sqrt() - radius, 0.0)
        };
        let mut job = Job::new((0..n).map(at).collect(), 1e-3);
        job.curves = Curves { largest_radius_mm, ..Curves::ARCS };
        plan(&job, &Budget::unlimited()).unwrap()
    }

    fn limits(warnings: &[Warning]) -> Vec<Warning> {
        warnings.iter().filter(|w| matches!(w, Warning::RadiusLimited { .. })).cloned().collect()
    }

    #[test]
    fn a_flat_arc_is_one_arc_where_the_control_has_no_limit() {
        for (radius, half, n) in [(15_000.0, 100.0, 5), (60_000.0, 400.0, 40), (9e5, 2_000.0, 100)] {
            let Plan { report, warnings, .. } = fitted(radius, half, n, LARGEST_RADIUS_MM);
            assert_eq!((report.n_arcs, report.n_lines), (1, 0), "{radius}");
            assert!(report.deviation_max_mm <= 1e-3);
            assert_eq!(limits(&warnings), []);
        }
    }

    #[test]
    fn the_cost_of_a_largest_radius_is_told() {
        let Plan { report, warnings, .. } = fitted(15_000.0, 100.0, 5, 10_000.0);
        assert_eq!((report.n_arcs, report.n_lines), (0, 4));
        let told = Warning::RadiusLimited { largest_radius_mm: 10_000.0, n_joints: 3 };
        assert_eq!(limits(&warnings), [told]);
        // An arc that the control runs costs nothing.
        assert_eq!(limits(&fitted(9_000.0, 100.0, 5, 10_000.0).warnings), []);
    }
}

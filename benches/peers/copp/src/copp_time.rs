//! The time that copp's TOPP3 finds for a path.

use copp::robot::Robot;
use copp::solver::topp2_ra::{ReachSet2OptionsBuilder, Topp2ProblemBuilder, topp2_ra};
use copp::solver::topp3_socp::{ClarabelOptionsBuilder, Topp3ProblemBuilder, s_to_t_topp3, topp3_socp};
use nalgebra::DMatrix;

use crate::paths::{Case, Jet};

/// The most intervals. Finer grids take minutes, and copp's solver then fails on some paths.
const FINEST: usize = 8_000;

/// The time, and the number of intervals at which it moved by less than 0.1 %. If the time still moves on the
/// finest grid, or copp fails on a finer one, the least time of all grids, and 0.
pub fn refined(case: &Case) -> Result<(f64, usize), String> {
    let mut intervals = 500;
    let mut before = time(case, intervals)?;
    let mut least = before;
    while intervals < FINEST {
        intervals *= 2;
        let Ok(now) = time(case, intervals) else { break };
        if (now - before).abs() < 1e-3 * now {
            return Ok((now, intervals));
        }
        before = now;
        least = least.min(now);
    }
    Ok((least, 0))
}

/// The time of copp on a grid of equal intervals. copp linearizes its limits again until the time stays the
/// same.
fn time(case: &Case, intervals: usize) -> Result<f64, String> {
    let text = |error: &dyn std::fmt::Display| format!("copp: {error}");
    let n = intervals + 1;
    let s: Vec<f64> = (0..n).map(|k| case.length * k as f64 / intervals as f64).collect();
    let q: Vec<Vec<Jet>> = s.iter().map(|&u| case.coordinates(u)).collect();
    let axes: Vec<usize> = (0..case.limits.len()).filter(|&k| case.limits[k].jerk.is_finite()).collect();
    // Each axis is divided by its limit of jerk.
    let matrix = |order: usize, factor: f64| {
        DMatrix::from_fn(axes.len(), n, |a, k| factor * q[k][axes[a]].0[order] / case.limits[axes[a]].jerk)
    };
    let (q0, q1, q2, q3) = (matrix(0, 1.0), matrix(1, 1.0), matrix(2, 2.0), matrix(3, 6.0));
    let bound =
        |f: &dyn Fn(usize) -> f64| axes.iter().map(|&a| f(a) / case.limits[a].jerk).collect::<Vec<_>>();
    let speed = bound(&|a| case.limits[a].speed);
    let acceleration = bound(&|a| case.limits[a].acceleration);
    let jerk = bound(&|a| case.limits[a].jerk);
    let minus = |v: &[f64]| v.iter().map(|x| -x).collect::<Vec<_>>();
    let cap: Vec<f64> = s.iter().map(|&u| case.station(u).speed_cap.powi(2)).collect();
    let mut robot = Robot::with_capacity(axes.len(), n);
    (|| -> Result<(), copp::diag::ConstraintError> {
        robot
            .with_s(s.as_slice())?
            .with_q(&q0.as_view(), &q1.as_view(), &q2.as_view(), Some(&q3.as_view()), 0)?
            .with_axial_velocity((speed.as_slice(), n), (minus(&speed).as_slice(), n), 0)?
            .with_axial_acceleration((acceleration.as_slice(), n), (minus(&acceleration).as_slice(), n), 0)?
            .with_axial_jerk((jerk.as_slice(), n), (minus(&jerk).as_slice(), n), 0)?;
        robot.constraints.with_constraint_1order(cap.as_slice(), 0)?;
        Ok(())
    })()
    .map_err(|e| text(&e))?;
    let problem = Topp2ProblemBuilder::new(&robot, (0, n - 1), (0.0, 0.0)).build().map_err(|e| text(&e))?;
    let options = ReachSet2OptionsBuilder::new().build().map_err(|e| text(&e))?;
    let mut a = topp2_ra(&problem, &options).map_err(|e| text(&e))?;
    let options = ClarabelOptionsBuilder::new().allow_almost_solved(true).build().map_err(|e| text(&e))?;
    let mut best = f64::INFINITY;
    for _ in 0..12 {
        let problem = Topp3ProblemBuilder::new(&mut robot, 0, &a, (0.0, 0.0), (0.0, 0.0))
            .build_with_linearization()
            .map_err(|e| text(&e))?;
        let profile = match topp3_socp(&problem, &options) {
            Ok(profile) => profile,
            Err(_) if best.is_finite() => break,
            Err(error) => return Err(text(&error)),
        };
        let (time, _) = s_to_t_topp3(&s, profile.as_parts(), 0.0).map_err(|e| text(&e))?;
        a = profile.a;
        let still = time > best * (1.0 - 1e-5);
        best = best.min(time);
        if still {
            break;
        }
    }
    Ok(best)
}

//! How near to a pole the rails may come.

use nalgebra::UnitVector3;

use crate::operations::five_axis::leg::Leg;
use crate::operations::five_axis::path::Path;
use crate::operations::five_axis::rail::top;
use crate::toolpath::tool_axes::angle_between;

/// The part of the distance between a leg and a pole by which the axis of the rails may come nearer.
const NEARER: f64 = 0.3;

/// A leg that is nearer to a pole lies on it, radians.
const LEAST_APART: f64 = 1e-9;

/// How far the axis of the rails may be from each leg, radians: where the leg passes a pole, a part of the
/// distance to it, so that no spline comes much nearer to the pole than the path. Legs to the pole itself
/// have room.
pub fn rooms(path: &Path, poles: &[UnitVector3<f64>]) -> Vec<f64> {
    let room = |k: usize| {
        let is_led = path.on_pole[k] || path.on_pole[k + 1];
        let leg = path.leg(k);
        let apart = poles.iter().map(|pole| distance(&leg, pole)).fold(f64::INFINITY, f64::min);
        if is_led || apart <= LEAST_APART { f64::INFINITY } else { NEARER * apart }
    };
    (0..path.paces.len()).map(room).collect()
}

/// The least angle between the axis along a leg and a pole, radians.
fn distance(leg: &Leg, pole: &UnitVector3<f64>) -> f64 {
    let [start, end] = [top(&leg.start), top(&leg.end)];
    let to_ends = angle_between(&start, pole).min(angle_between(&end, pole));
    let normal = start.cross(&end);
    let is_between = normal.cross(&start).dot(pole) > 0.0 && end.cross(&normal).dot(pole) > 0.0;
    if !is_between {
        return to_ends;
    }
    (normal.dot(pole) / normal.norm()).abs().clamp(0.0, 1.0).asin().min(to_ends)
}

//! The moves of a toolpath as curves of the tip.

use nalgebra::Point3;

use super::findings::Place;
use super::{Job, Rapids};
use crate::geometry::curve::{Curve, Line};
use crate::toolpath::Move;

/// A move with the ways on which the control may run it.
#[derive(Debug, Clone)]
pub(super) struct Motion {
    pub(super) place: Place,
    pub(super) is_rapid: bool,
    pub(super) curves: Vec<Curve>,
}

impl Motion {
    /// The length of the move, mm.
    pub(super) fn length(&self) -> f64 {
        self.curves.first().map_or(0.0, Curve::length)
    }
}

/// All moves that have a length.
pub(super) fn motions(job: &Job) -> Vec<Motion> {
    let mut motions = Vec::new();
    let mut number = 0;
    for (pass, of_pass) in job.toolpath.passes().iter().enumerate() {
        for (index, step) in of_pass.moves().iter().enumerate() {
            let place = Place { pass, index, number };
            number += 1;
            match step {
                Move::Rapid { line } => {
                    motions.push(Motion { place, is_rapid: true, curves: rapid(line, job.rapids) });
                }
                Move::Feed { along, .. } => {
                    motions.push(Motion { place, is_rapid: false, curves: vec![*along] });
                }
                Move::Turn { .. } | Move::Dwell { .. } => {}
            }
        }
    }
    motions
}

/// The straight line of a rapid, and its dog-leg where that is another way.
fn rapid(line: &Line, rapids: Rapids) -> Vec<Curve> {
    let mut curves = vec![Curve::Line(*line)];
    if rapids == Rapids::DogLeg {
        let legs = dog_leg(line);
        if legs.len() > 1 {
            curves.extend(legs.into_iter().map(Curve::Line));
        }
    }
    curves
}

/// The way of a rapid whose axes all run at one speed until each of them has arrived.
fn dog_leg(line: &Line) -> Vec<Line> {
    let way = line.end - line.start;
    let mut lengths = [way.x.abs(), way.y.abs(), way.z.abs()];
    lengths.sort_unstable_by(f64::total_cmp);
    let at = |run: f64| {
        let axis = |k: usize| line.start[k] + way[k].clamp(-run, run);
        Point3::new(axis(0), axis(1), axis(2))
    };
    let mut points = vec![line.start];
    points.extend(lengths.into_iter().filter(|run| *run > 0.0).map(at));
    points.dedup();
    if let Some(last) = points.last_mut() {
        *last = line.end;
    }
    points.windows(2).map(|ends| Line { start: ends[0], end: ends[1] }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_axis_of_a_dog_leg_runs_until_it_has_arrived() {
        let line = Line { start: Point3::new(0.0, 0.0, 10.0), end: Point3::new(30.0, -5.0, 0.0) };
        let points: Vec<Point3<f64>> = dog_leg(&line).iter().map(|leg| leg.end).collect();
        let expected = [[5.0, -5.0, 5.0], [10.0, -5.0, 0.0], [30.0, -5.0, 0.0]].map(Point3::from);
        assert_eq!(points, expected);
        let straight = Line { start: Point3::origin(), end: Point3::new(3.0, 3.0, 0.0) };
        assert_eq!(dog_leg(&straight), [straight]);
    }
}

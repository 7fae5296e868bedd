//! The moves of a toolpath as curves of the tip.

use nalgebra::{Point3, Vector3};

use super::findings::MoveNumber;
use super::{Job, Rapids};
use crate::geometry::curve::{Curve, Line};
use crate::toolpath::Move;

/// A move with the ways on which the control may run it.
#[derive(Debug, Clone)]
pub(super) struct Motion {
    pub(super) place: MoveNumber,
    pub(super) is_rapid: bool,
    /// One or more ways of one or more curves each.
    pub(super) ways: Vec<Vec<Curve>>,
}

impl Motion {
    /// The length of the move, mm.
    pub(super) fn length(&self) -> f64 {
        self.along().map_or(0.0, Curve::length)
    }

    /// The curve of the toolpath.
    pub(super) fn along(&self) -> Option<&Curve> {
        self.ways.first().and_then(|way| way.first())
    }

    /// All curves on which the tip may run.
    pub(super) fn curves(&self) -> impl Iterator<Item = &Curve> {
        self.ways.iter().flatten()
    }
}

/// All moves that have a length. Where the tool comes to a place on a way that is not known, and where it
/// stands before the first move, the place alone counts as a rapid.
pub(super) fn motions(job: &Job) -> Vec<Motion> {
    let mut motions = Vec::new();
    let mut number = 0;
    for (pass, of_pass) in job.toolpath.passes().iter().enumerate() {
        let first = (pass == 0).then(|| job.toolpath.start());
        if let Some(at) = of_pass.start().or(first) {
            let place = MoveNumber { pass, index: 0, number };
            let stands = Curve::Line(Line { start: at, end: at });
            motions.push(Motion { place, is_rapid: true, ways: vec![vec![stands]] });
        }
        for (index, step) in of_pass.moves().iter().enumerate() {
            let place = MoveNumber { pass, index, number };
            number += 1;
            match step {
                Move::Rapid { line } => {
                    motions.push(Motion { place, is_rapid: true, ways: rapid(line, job.rapids) });
                }
                Move::Feed { along, .. } => {
                    motions.push(Motion { place, is_rapid: false, ways: vec![vec![*along]] });
                }
                Move::Turn { .. } | Move::Dwell { .. } => {}
            }
        }
    }
    motions
}

/// The straight line of a rapid, and its dog-leg where that is another way.
fn rapid(line: &Line, rapids: Rapids) -> Vec<Vec<Curve>> {
    let mut ways = vec![vec![Curve::Line(*line)]];
    if rapids == Rapids::DogLeg {
        let legs = dog_leg(line);
        if legs.len() > 1 {
            ways.push(legs.into_iter().map(Curve::Line).collect());
        }
    }
    ways
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

/// The place of a curve that is farthest along an axis, in the direction of `sign`.
pub(super) fn farthest(curve: &Curve, axis: usize, sign: f64) -> Point3<f64> {
    let direction = Vector3::ith(axis, sign);
    let mut places = vec![curve.start(), curve.end()];
    match curve {
        Curve::Line(_) => {}
        Curve::Arc(arc) => {
            let local = arc.plane().to_local(&Point3::from(direction));
            places.extend(arc.fraction_of_angle(local.y.atan2(local.x)).map(|t| arc.point_at(t)));
        }
        Curve::Parabola(_) => {
            places.extend((1..PLACES).map(|k| curve.point_at(f64::from(k) / f64::from(PLACES))))
        }
    }
    let along = |p: &Point3<f64>| p.coords.dot(&direction);
    places.into_iter().max_by(|one, other| along(one).total_cmp(&along(other))).unwrap_or(curve.start())
}

/// Places that are looked at on a parabola.
const PLACES: i32 = 64;

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

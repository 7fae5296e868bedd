//! Shifts a path that crosses the disc about a pole once, so that it goes through the pole.
//!
//! The axis at the place nearest to the pole moves onto it. On both sides the shift fades away with two
//! continuous derivatives, over a way that is long beside the disc: so the path stays as straight as it is,
//! and the angle that is free at the pole hardly changes.

use nalgebra::Vector3;

use super::{Disc, Stretch, way};
use crate::operations::five_axis::leg::Leg;
use crate::operations::five_axis::path::Path;
use crate::operations::five_axis::rail::top;
use crate::toolpath::pose::Pace;
use crate::toolpath::tool_axes::angle_between;

/// The way on which a shift fades away, in radii of the disc: at the most, and at the least. On less, the
/// path is led through the pole as if it did not cross the disc straight.
const WIDEST: f64 = 40.0;
const NARROWEST: f64 = 4.0;

/// A given pose within this part of the way from the nearest place is brought to the pole itself.
const NEAR: f64 = 0.03;

/// Places on each side at which the shift is made.
const PLACES: usize = 8;

/// A shift of a stretch of the path.
pub struct Crossing {
    /// The place on the pole, and how long the shift is on both sides of it, as shares of the stretch.
    center: f64,
    half: f64,
    /// Where the axis is seen there.
    from: [f64; 2],
}

impl Crossing {
    /// The shares of the stretch at which there are to be poses.
    pub fn shares(&self) -> Vec<f64> {
        let at = |k: usize| self.half * k as f64 / PLACES as f64;
        let both = (1..PLACES).flat_map(|k| [self.center - at(k), self.center + at(k)]);
        std::iter::once(self.center).chain(both).filter(|share| (0.0..=1.0).contains(share)).collect()
    }

    /// The share of the pole.
    pub fn center(&self) -> f64 {
        self.center
    }

    /// An axis at a share of the stretch, after the shift.
    pub fn shifted(&self, share: f64, given: [f64; 2]) -> [f64; 2] {
        if share == self.center {
            return [0.0; 2];
        }
        let part = ((share - self.center) / self.half).abs().min(1.0);
        let fade = (1.0 - part * part).powi(3);
        [given[0] - fade * self.from[0], given[1] - fade * self.from[1]]
    }
}

impl Disc<'_> {
    /// Widens the stretches in which the path crosses the disc once.
    pub(super) fn widen(&self, path: &Path, stretches: &mut [Stretch]) {
        let mut ways = vec![0.0];
        for k in 0..path.paces.len() {
            ways.push(ways[k] + way(&path.leg(k)));
        }
        for k in 0..stretches.len() {
            let before = k.checked_sub(1).map(|k| stretches[k].ends[1]);
            let after = stretches.get(k + 1).map(|stretch| stretch.ends[0]);
            if let Some(wide) = self.widened(path, &ways, &stretches[k], [before, after]) {
                stretches[k] = wide;
            }
        }
    }

    /// The stretch with a shift, between the stretches beside it. `ways` are those from the start to the
    /// stations.
    fn widened(
        &self,
        path: &Path,
        ways: &[f64],
        stretch: &Stretch,
        beside: [Option<(usize, f64)>; 2],
    ) -> Option<Stretch> {
        let (_, goes_through) = self.directions(path, stretch);
        if !goes_through || !self.crosses_once(path, stretch) {
            return None;
        }
        let way_at = |(leg, part): (usize, f64)| ways[leg] + part * (ways[leg + 1] - ways[leg]);
        let nearest = self.nearest(path, stretch)?;
        let [first, last] = stretch.ends.map(|(leg, _)| leg);
        let is_rapid = |k: &usize| path.paces[*k] == Pace::Rapid;
        let begins = (0..first).rev().find(is_rapid).map_or(0, |k| k + 1);
        let ends = (last..path.paces.len()).find(is_rapid).unwrap_or(path.paces.len());
        let low = beside[0].map_or(ways[begins], |place| way_at(place).max(ways[begins]));
        let high = beside[1].map_or(ways[ends], |place| way_at(place).min(ways[ends]));
        let radius = self.radius * top(&path.stations[0]).norm();
        let half = |center: f64| (center - low).min(high - center).min(WIDEST * radius);
        let mut center = way_at(nearest);
        let mut from = nearest;
        // A pose beside the nearest place takes its part.
        for station in [nearest.0, nearest.0 + 1] {
            if (ways[station] - center).abs() <= NEAR * half(center) && station > begins && station < ends {
                (center, from) = (ways[station], (station, 0.0));
                break;
            }
        }
        let half = half(center);
        if half < NARROWEST * radius {
            return None;
        }
        let place = |way: f64| {
            let leg = (ways.partition_point(|at| *at <= way).max(1) - 1).min(ways.len() - 2);
            (leg, ((way - ways[leg]) / (ways[leg + 1] - ways[leg])).clamp(0.0, 1.0))
        };
        let axis = top(&path.leg(from.0).at(from.1)).normalize();
        let ends = [place(center - half), place(center + half)];
        let length = way_at(ends[1]) - way_at(ends[0]);
        let crossing = Crossing {
            center: (center - way_at(ends[0])) / length,
            half: half / length,
            from: self.seen(&axis),
        };
        Some(Stretch { ends, is_inside: [false; 2], crossing: Some(crossing) })
    }

    /// Whether the axis never goes back on its way across the disc.
    fn crosses_once(&self, path: &Path, stretch: &Stretch) -> bool {
        let [(first, from), (last, to)] = stretch.ends;
        let axis = |leg: usize, part: f64| top(&path.leg(leg).at(part));
        let across = axis(last, to) - axis(first, from);
        let inner = (first + 1..=last).map(|k| top(&path.stations[k]));
        let places: Vec<Vector3<f64>> =
            std::iter::once(axis(first, from)).chain(inner).chain([axis(last, to)]).collect();
        places.windows(2).all(|pair| (pair[1] - pair[0]).dot(&across) >= 0.0)
    }

    /// The place of a stretch at which the axis is nearest to the pole.
    fn nearest(&self, path: &Path, stretch: &Stretch) -> Option<(usize, f64)> {
        let [(first, from), (last, to)] = stretch.ends;
        let distance = |place: &(usize, f64)| angle_between(&top(&path.leg(place.0).at(place.1)), self.pole);
        (first..=last)
            .map(|k| {
                let ends = [if k == first { from } else { 0.0 }, if k == last { to } else { 1.0 }];
                (k, self.nearest_part(&path.leg(k)).clamp(ends[0], ends[1]))
            })
            .min_by(|a, b| distance(a).total_cmp(&distance(b)))
    }

    /// The part of a leg, or of the great circle that continues it, at which the axis is nearest to the pole.
    fn nearest_part(&self, leg: &Leg) -> f64 {
        let start = top(&leg.start).normalize();
        let normal = start.cross(&top(&leg.end));
        if normal.norm() == 0.0 {
            return 0.0;
        }
        let across = normal.normalize().cross(&start);
        self.pole.dot(&across).atan2(self.pole.dot(&start)) / leg.angle
    }
}

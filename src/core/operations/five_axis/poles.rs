//! Leads a path through the poles that it passes closely, or rests on them, within the tolerance of the axis.
//!
//! At a pole the angle of one rotary axis is free, and beside it this axis turns by up to half a turn on a
//! short way. A path that is as near to the pole as its tolerance does not need that turn.
//!
//! # Method
//! Seen along the pole, the tool axis is a point of the plane, and the poses within a radius of the pole form
//! stretches of the path. In each stretch:
//! * A path that crosses the disc once is shifted so that it goes through the pole (`crossing`). The shift
//!   fades away on both sides, on a way that is long beside the disc.
//! * Any other path that leaves the disc on the side opposite to where it entered goes through the pole,
//!   too. Both directions may differ by up to a right angle; the way turns by this angle, evenly in both
//!   outer thirds.
//! * A path that leaves it on the same side stays at the distance of the radius from the pole and turns by
//!   less than a right angle.
//! * Where the travel of an axis ends at the pole, no path goes through it: it stays at the distance of the
//!   radius and turns by up to half a turn.
//! * A path that begins or ends in the disc begins or ends on the pole.
//! * A path that stays in the disc stays on the pole.
//!
//! The largest radius is taken for which no axis moves by more than is allowed.
//!
//! # Guarantees
//! Tips stay. No axis moves by more than the stated deviation, which is at most [`SHARE`] of the tolerance.
//!
//! # Cost
//! O(n) for n poses.

mod crossing;
mod places;
mod room;

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use nalgebra::{Point3, UnitVector3, Vector2, Vector3};

use super::leg::Leg;
use super::path::Path;
use super::rail::{Point6, join, tip, top};
use crate::toolpath::pose::{Pace, SAME_AXIS};
use crate::toolpath::tool_axes::angle_between;
use crossing::Crossing;
use places::{Node, add, add_center, center, places};
pub use room::rooms;

/// The part of the tolerance of the axis that a path may move.
const SHARE: f64 = 0.5;

/// The radii of the disc, as parts of the tolerance. With the last one, no axis can move by more than
/// `SHARE`: by the diameter.
const RADII: [f64; 4] = [0.6, 0.45, 0.35, 0.25];

/// The part of the radius on both sides of the pole in which the way through it is straight.
const STRAIGHT: f64 = 1.0 / 3.0;

/// Between two poses in the disc the way turns by at most this angle, radians: ten degrees.
const LARGEST_TURN: f64 = PI / 18.0;

/// Parts of a leg nearer to its ends count as its ends.
const SAME_PART: f64 = 1e-6;

/// A tip that turns by less goes straight on, radians.
const STRAIGHT_ON: f64 = 0.01;

/// Angles in the plane differ from those on the sphere by less than this part of the cube of the radius.
const FLAT: f64 = 1.0;

/// Between places of a stretch, an axis moves by at most this multiple of what it moves at the places.
const BETWEEN: f64 = 1.01;

/// How paths are led.
#[derive(Debug, Clone, Copy)]
pub struct Way {
    /// Whether a path may go through a pole.
    pub may_cross: bool,
    /// Whether limits are to be proved. Otherwise a path that lies on the pole and leaves it straight stays
    /// as it is: the free angle has one value there, but derivatives only where the path leaves the pole
    /// evenly.
    pub has_limits: bool,
}

/// Moves the axes beside poles. A path that `may_cross` goes through poles; otherwise it goes around them,
/// which takes up to half a turn of the free axis. All that has moved the axes, the cleaning too, takes at
/// most [`SHARE`] of the tolerance.
pub fn lead(path: &mut Path, poles: &[UnitVector3<f64>], tolerance: f64, way: Way) {
    for pole in poles {
        let allowed = SHARE * tolerance - path.moved.axis;
        let found = RADII.iter().find_map(|radius| {
            let disc = Disc::new(pole, radius * tolerance, way);
            let (led, own) = disc.led(path)?;
            (own <= allowed).then_some((led, own))
        });
        if let Some((led, own)) = found {
            *path = led;
            path.moved.axis += own;
        }
    }
}

/// The disc about a pole.
struct Disc<'a> {
    pole: &'a UnitVector3<f64>,
    across: [Vector3<f64>; 2],
    /// Radians.
    radius: f64,
    way: Way,
}

/// A stretch of the path in the disc: the leg and its part at both ends. An end inside the disc is one of the
/// path.
struct Stretch {
    ends: [(usize, f64); 2],
    is_inside: [bool; 2],
    /// Set where the path is shifted.
    crossing: Option<Crossing>,
}

impl<'a> Disc<'a> {
    fn new(pole: &'a UnitVector3<f64>, radius: f64, way: Way) -> Self {
        let first = pole.cross(&if pole.x.abs() < 0.7 { Vector3::x() } else { Vector3::y() }).normalize();
        Self { pole, across: [first, pole.cross(&first)], radius, way }
    }

    /// The path led through the pole, and how far an axis has moved; none if no stretch is in the disc.
    fn led(&self, path: &Path) -> Option<(Path, f64)> {
        let mut stretches = self.stretches(path);
        if stretches.is_empty() {
            return None;
        }
        self.widen(path, &mut stretches);
        let mut led = Path {
            n_poses: path.n_poses,
            stations: Vec::new(),
            paces: Vec::new(),
            on_pole: Vec::new(),
            rooms: Vec::new(),
            passed: path.passed,
            moved: path.moved,
        };
        for stretch in &stretches {
            let goes_through = stretch.crossing.is_some() || self.directions(path, stretch).1;
            match (goes_through, stretch.is_inside) {
                (true, _) => led.passed.through += 1,
                (false, [false, false]) => led.passed.around += 1,
                _ => continue,
            }
            let (leg, part) = stretch.ends[0];
            led.passed.at.get_or_insert(Point3::from(tip(&path.leg(leg).at(part))));
        }
        let mut moved = 0.0_f64;
        let mut next = 0;
        for stretch in &stretches {
            let [(first, _), (last, end)] = stretch.ends;
            // The stations before the stretch.
            while next <= first {
                led.push(path.stations[next], path.on_pole[next], path.paces.get(next.wrapping_sub(1)));
                next += 1;
            }
            for (place, to) in self.ways(path, stretch) {
                let from = path.leg(place.leg).at(place.part);
                moved = moved.max(angle_between(&top(&from), &top(&to)));
                let on_pole = angle_between(&top(&to), self.pole) == 0.0;
                let is_station = place.part <= SAME_PART && place.leg == next.wrapping_sub(1);
                if is_station {
                    led.stations.pop();
                    led.on_pole.pop();
                    led.stations.push(to);
                    led.on_pole.push(on_pole);
                } else {
                    let arrives = if place.part <= SAME_PART { place.leg - 1 } else { place.leg };
                    led.push(to, on_pole, path.paces.get(arrives));
                }
            }
            next = if end >= 1.0 - SAME_PART { last + 2 } else { last + 1 };
        }
        while next < path.stations.len() {
            led.push(path.stations[next], path.on_pole[next], path.paces.get(next - 1));
            next += 1;
        }
        Some((led, BETWEEN * moved + FLAT * self.radius.powi(3)))
    }

    /// The parts of the path in the disc that are not rapids.
    fn stretches(&self, path: &Path) -> Vec<Stretch> {
        let mut stretches: Vec<Stretch> = Vec::new();
        let mut goes_on = false;
        for (k, pace) in path.paces.iter().enumerate() {
            let leg = path.leg(k);
            let Some([from, to]) = self.inside(&leg).filter(|_| *pace != Pace::Rapid) else {
                goes_on = false;
                continue;
            };
            let is_end = [
                k == 0 || path.paces[k - 1] == Pace::Rapid,
                path.paces.get(k + 1).is_none_or(|pace| *pace == Pace::Rapid),
            ];
            let is_inside = [is_end[0] && from <= SAME_PART, is_end[1] && to >= 1.0 - SAME_PART];
            match stretches.last_mut() {
                Some(last) if goes_on && from <= SAME_PART => {
                    last.ends[1] = (k, to);
                    last.is_inside[1] = is_inside[1];
                }
                _ => stretches.push(Stretch { ends: [(k, from), (k, to)], is_inside, crossing: None }),
            }
            goes_on = to >= 1.0 - SAME_PART;
        }
        stretches.retain(|stretch| {
            let stays = !self.way.has_limits && self.leaves_exactly(path, stretch);
            stretch.ends[0] != stretch.ends[1] && !stays
        });
        stretches
    }

    /// Whether a stretch at an end of the path lies on the pole, but for a leg that leaves it straight.
    fn leaves_exactly(&self, path: &Path, stretch: &Stretch) -> bool {
        let [(first, _), (last, _)] = stretch.ends;
        let mut on_pole = match stretch.is_inside {
            [false, false] => return false,
            [true, false] => first..=last,
            [false, true] => first + 1..=last + 1,
            [true, true] => first..=last + 1,
        };
        on_pole.all(|k| angle_between(&top(&path.stations[k]), self.pole) <= SAME_AXIS)
    }

    /// The part of a leg that is in the disc.
    fn inside(&self, leg: &Leg) -> Option<[f64; 2]> {
        let start = top(&leg.start).normalize();
        let normal = start.cross(&top(&leg.end));
        if leg.angle <= SAME_PART || normal.norm() == 0.0 {
            return (angle_between(&start, self.pole) <= self.radius).then_some([0.0, 1.0]);
        }
        let normal = normal.normalize();
        let aside = normal.dot(self.pole).clamp(-1.0, 1.0).asin();
        if aside.abs() >= self.radius {
            return None;
        }
        let nearest = self.pole.dot(&normal.cross(&start)).atan2(self.pole.dot(&start));
        let half = (self.radius.cos() / aside.cos()).clamp(-1.0, 1.0).acos();
        let snapped = |part: f64| match part {
            _ if part < SAME_PART => 0.0,
            _ if part > 1.0 - SAME_PART => 1.0,
            part => part,
        };
        let ends = [nearest - half, nearest + half].map(|angle| snapped(angle / leg.angle));
        (ends[0] < ends[1]).then_some(ends)
    }

    /// The directions of the ends of a stretch as seen from the pole, and whether the path goes on through
    /// the pole rather than around it.
    fn directions(&self, path: &Path, stretch: &Stretch) -> ([f64; 2], bool) {
        let ends = stretch.ends.map(|(leg, part)| {
            let [x, y] = self.seen(&top(&path.leg(leg).at(part)));
            y.atan2(x)
        });
        let is_opposite = turn(ends[0], ends[1]).abs() > FRAC_PI_2;
        (ends, self.way.may_cross && stretch.is_inside == [false; 2] && is_opposite)
    }

    /// The places of a stretch with the poses there.
    fn ways(&self, path: &Path, stretch: &Stretch) -> Vec<(Node, Point6)> {
        let mut places = places(path, stretch.ends);
        if let Some(crossing) = &stretch.crossing {
            add_center(&mut places, crossing.center());
            add(&mut places, &crossing.shares());
            let mut ways = self.posed(path, places, |place, given| crossing.shifted(place.share, given));
            self.straighten(&mut ways, crossing.center());
            return ways;
        }
        let ([leaves, meets], goes_through) = self.directions(path, stretch);
        let beside = turn(leaves, meets);
        let through = turn(leaves + PI, meets);
        if goes_through {
            add(&mut places, &[0.5]);
            center(&mut places);
            let parts = (0.5 * through.abs() / LARGEST_TURN).ceil().max(1.0) as usize;
            let outer = |k: usize| 0.5 * (1.0 - STRAIGHT) * (k as f64 / parts as f64);
            let shares: Vec<f64> = (1..=parts).flat_map(|k| [outer(k), 1.0 - outer(k)]).collect();
            add(&mut places, &shares);
        } else if stretch.is_inside == [false; 2] {
            let parts = (beside.abs() / LARGEST_TURN).ceil().max(1.0) as usize;
            let shares: Vec<f64> = (1..parts).map(|k| k as f64 / parts as f64).collect();
            add(&mut places, &shares);
        }
        self.posed(path, places, |Node { share, .. }, _| {
            let (angle, distance) = match stretch.is_inside {
                [true, true] => (0.0, 0.0),
                [true, false] => (meets, share * self.radius),
                [false, true] => (leaves, (1.0 - share) * self.radius),
                _ if goes_through => {
                    let place = 2.0 * share - 1.0;
                    let outer = ((place.abs() - STRAIGHT) / (1.0 - STRAIGHT)).max(0.0);
                    (leaves + PI + through * 0.5 * (1.0 + place.signum() * outer), place * self.radius)
                }
                _ => (leaves + beside * share, self.radius),
            };
            let (sin, cos) = angle.sin_cos();
            [cos * distance.sin(), sin * distance.sin()]
        })
    }

    /// Brings the poses beside the pole on one line through it where the tip rests or turns: there the path
    /// is not smooth by itself, and the free angle would have to jump.
    fn straighten(&self, ways: &mut [(Node, Point6)], center: f64) {
        let Some(k) = ways.iter().position(|(place, _)| place.share == center) else { return };
        if k == 0 || k + 1 == ways.len() {
            return;
        }
        let [before, after] = [Leg::new(ways[k - 1].1, ways[k].1), Leg::new(ways[k].1, ways[k + 1].1)];
        let is_straight = !before.is_rotation()
            && !after.is_rotation()
            && angle_between(&before.direction(), &after.direction()) <= STRAIGHT_ON;
        if is_straight {
            return;
        }
        let height = top(&ways[k].1).norm();
        let seen = [k - 1, k + 1].map(|k| Vector2::from(self.seen(&(top(&ways[k].1) / height))));
        let Some(along) = (seen[1] - seen[0]).try_normalize(0.0) else { return };
        for (k, distance) in [(k - 1, -seen[0].norm()), (k + 1, seen[1].norm())] {
            let axis = self.axis((along * distance).into());
            ways[k].1 = join(tip(&ways[k].1), axis * height);
        }
    }

    /// The places with poses whose axes are given in the plane, from those that they have.
    fn posed(
        &self,
        path: &Path,
        places: Vec<Node>,
        seen: impl Fn(&Node, [f64; 2]) -> [f64; 2],
    ) -> Vec<(Node, Point6)> {
        let height = top(&path.stations[0]).norm();
        places
            .into_iter()
            .map(|place| {
                let given = path.leg(place.leg).at(place.part);
                let axis = self.axis(seen(&place, self.seen(&top(&given).normalize())));
                (place, join(tip(&given), axis * height))
            })
            .collect()
    }

    /// The axis that is seen in a place of the plane.
    fn axis(&self, [x, y]: [f64; 2]) -> Vector3<f64> {
        let along = (1.0 - x * x - y * y).max(0.0).sqrt();
        self.pole.into_inner() * along + self.across[0] * x + self.across[1] * y
    }

    /// The axis in the plane.
    fn seen(&self, axis: &Vector3<f64>) -> [f64; 2] {
        self.across.map(|across| across.dot(axis))
    }
}

/// The way of the tip and the top along a leg, mm.
fn way(leg: &Leg) -> f64 {
    leg.length + top(&leg.start).norm() * leg.angle
}

/// The turn from one direction to another, radians, from -pi to pi.
fn turn(from: f64, to: f64) -> f64 {
    (to - from + PI).rem_euclid(TAU) - PI
}

impl Path {
    /// Adds a station, unless it repeats the one before: a turn in the disc may have become none.
    fn push(&mut self, station: Point6, on_pole: bool, pace: Option<&Pace>) {
        if let Some(last) = self.stations.last() {
            let leg = Leg::new(*last, station);
            if leg.is_rotation() && leg.angle <= SAME_AXIS {
                return;
            }
            self.paces.extend(pace);
        }
        self.stations.push(station);
        self.on_pole.push(on_pole);
    }
}

//! Bounds the distance between an arc and every path that a control may run for the block of the arc.
//!
//! The block states rounded ends and a rounded centre. A control moves about the rounded centre. Its radius
//! lies between the distances of the two rounded ends from the rounded centre.
//!
//! # Method
//! 1. Compare each point of the control's path with the point of the arc in the same direction from the arc's
//!    centre. Closed formulas bound the distance of all such pairs of points.
//! 2. For a helix, also compare points at equal fractions of the turn. The smaller bound of steps 1 and 2
//!    counts.
//!
//! # Guarantees
//! The result is an upper bound of the Frechet distance. There is no result in three cases:
//! * Seen from its centre, an end of the path is turned by more than half a radian from the same end of the
//!   arc.
//! * The path turns the other way than the arc, or by a whole turn more or less.
//! * The distance of the two centres is more than half of the smallest radius of path and arc.

use std::f64::consts::{PI, TAU};

use nalgebra::{Vector2, Vector3};

use crate::geometry::curve::{Arc, Direction};

/// Number of intervals between the fractions at which helices are compared. With 32 intervals the remainder
/// is below 0.5 % of the turn's square times the distance of the centres.
const INTERVALS: u32 = 32;

/// Sweeps belong to the same turn if they differ by less, radians. They differ by rounding, or else by a
/// whole turn.
const SAME_TURN: f64 = 1e-6;

/// Largest angle, radians, by which rounding may turn an end about the centre. An end that turns farther
/// belongs to another arc.
const MAX_TURN: f64 = 0.5;

/// An arc in its plane: coordinates are (first, second, normal), mm.
pub struct Circular {
    pub center: Vector2<f64>,
    pub start: Vector3<f64>,
    pub end: Vector3<f64>,
    pub radius: f64,
    pub sweep: f64,
    /// +1 counterclockwise, -1 clockwise.
    pub sense: f64,
}

impl Circular {
    pub fn of(arc: &Arc) -> Self {
        let local = |p| arc.plane().to_local(&p);
        Self {
            center: local(arc.center()).xy(),
            start: local(arc.start()),
            end: local(arc.end()),
            radius: arc.radius(),
            sweep: arc.sweep(),
            sense: sense(arc.direction()),
        }
    }
}

pub fn sense(direction: Direction) -> f64 {
    match direction {
        Direction::Ccw => 1.0,
        Direction::Cw => -1.0,
    }
}

/// The paths that a control may run for a block.
pub struct Family {
    /// The centre as written, in coordinates of the plane: (first, second), mm.
    pub center: Vector2<f64>,
    pub start: Vector3<f64>,
    pub end: Vector3<f64>,
    /// The vectors from the centre to the start and to the end, mm. They are not computed as differences of
    /// rounded coordinates.
    pub to_start: Vector2<f64>,
    pub to_end: Vector2<f64>,
    pub sweep: f64,
    pub sense: f64,
}

impl Family {
    /// The family that holds only `arc` itself.
    pub fn of(arc: &Circular) -> Self {
        Self {
            center: arc.center,
            start: arc.start,
            end: arc.end,
            to_start: arc.start.xy() - arc.center,
            to_end: arc.end.xy() - arc.center,
            sweep: arc.sweep,
            sense: arc.sense,
        }
    }
}

/// An upper bound of the distance between `family` and `arc`, mm; `None` where their turns differ too much.
pub fn distance(family: &Family, arc: &Circular) -> Option<f64> {
    let between = Between::new(family, arc)?;
    let by_angle = between.by_angle();
    let is_flat = family.start.z == family.end.z && arc.start.z == arc.end.z;
    let bound = if is_flat { by_angle } else { by_angle.min(between.by_fraction()) };
    let largest = arc.start.amax().max(arc.end.amax()).max(arc.center.amax()).max(arc.radius);
    Some(bound + 64.0 * f64::EPSILON * largest)
}

struct Between<'a> {
    family: &'a Family,
    arc: &'a Circular,
    /// From the arc's centre to the family's.
    shift: Vector2<f64>,
    radii: [f64; 2],
    /// How far the family's ends are turned ahead of the arc's, each seen from its own centre, radians.
    ahead: [f64; 2],
}

impl<'a> Between<'a> {
    fn new(family: &'a Family, arc: &'a Circular) -> Option<Self> {
        let (from, to) = ((arc.start.xy() - arc.center), (arc.end.xy() - arc.center));
        let ahead =
            [family.sense * angle(&from, &family.to_start), family.sense * angle(&to, &family.to_end)];
        let (r0, r1) = (family.to_start.norm(), family.to_end.norm());
        let shift = family.center - arc.center;
        let is_same_turn = (family.sweep - (arc.sweep + ahead[1] - ahead[0])).abs() < SAME_TURN
            && ahead.iter().all(|turn| turn.abs() <= MAX_TURN)
            && family.sense == arc.sense;
        let radii = [r0.min(r1), r0.max(r1)];
        (is_same_turn && 2.0 * shift.norm() < radii[0].min(arc.radius)).then_some(Self {
            family,
            arc,
            shift,
            radii,
            ahead,
        })
    }

    /// The bound by angle. On a helix it includes the difference of the heights. The distance from the arc's
    /// circle is largest or least for the largest or the smallest radius about the family's centre. The
    /// family may begin or end beyond an end of the arc, by a small angle. The point there is compared with
    /// that end, and the bound includes the chord of the angle.
    fn by_angle(&self) -> f64 {
        let (family, arc) = (self.family, self.arc);
        let [least, most] = self.extremes_along_shift();
        let uneven = ((arc.end.xy() - arc.center).norm() - arc.radius).abs();
        let radial =
            self.radial(self.radii[1], most).max(-self.radial(self.radii[0], least)).max(0.0) + uneven;
        // The angle, seen from the arc's centre, between an end of the arc and the family's end at either
        // radius.
        let turned = |own: &Vector3<f64>, to_end: &Vector2<f64>| {
            let own = own.xy() - arc.center;
            let at = |r: f64| angle(&own, &(self.shift + to_end * (r / to_end.norm()))).abs();
            at(self.radii[0]).max(at(self.radii[1]))
        };
        let turn = turned(&arc.start, &family.to_start).max(turned(&arc.end, &family.to_end));
        let tangential = 2.0 * ((arc.radius + radial) * arc.radius).sqrt() * (turn / 2.0).sin();
        let rise = (arc.end.z - arc.start.z).abs();
        let lag = self.ahead[0].abs().max(self.ahead[1].abs())
            + (self.shift.norm() / self.radii[0].min(arc.radius)).asin();
        let at_ends = (family.start.z - arc.start.z).abs().max((family.end.z - arc.end.z).abs());
        radial.hypot(tangential).hypot(at_ends + rise * lag / arc.sweep)
    }

    /// Signed distance from the arc's circle of a point at radius `r` about the family's centre. `along` is
    /// the component of the point's unit direction along the shift, times the shift's length. The formula
    /// subtracts no two large numbers but the radii.
    fn radial(&self, r: f64, along: f64) -> f64 {
        let reach = (r * r + 2.0 * r * along + self.shift.norm_squared()).max(0.0).sqrt();
        let radius = self.arc.radius;
        ((r - radius) * (r + radius) + 2.0 * r * along + self.shift.norm_squared()) / (reach + radius)
    }

    /// The least and the largest component along the shift of the family's directions, times the shift's
    /// length.
    fn extremes_along_shift(&self) -> [f64; 2] {
        let family = self.family;
        let ends = [&family.to_start, &family.to_end].map(|v| v.dot(&self.shift) / v.norm());
        let is_passed = |direction: Vector2<f64>| {
            let ahead = family.sense * angle(&family.to_start, &direction);
            ahead.rem_euclid(TAU) <= family.sweep
        };
        let size = self.shift.norm();
        let most = if is_passed(self.shift) { size } else { ends[0].max(ends[1]) };
        let least = if is_passed(-self.shift) { -size } else { ends[0].min(ends[1]) };
        [least, most]
    }

    /// The bound by fraction, at 33 fractions. A bound of the second derivative shows by how much the
    /// distance can grow between two fractions.
    fn by_fraction(&self) -> f64 {
        let (family, arc) = (self.family, self.arc);
        let from = arc.start.xy() - arc.center;
        let own = from.y.atan2(from.x);
        let largest_ahead = self.ahead[0].abs().max(self.ahead[1].abs());
        let mut bound: f64 = 0.0;
        for r in self.radii {
            let mut largest: f64 = 0.0;
            for k in 0..=INTERVALS {
                let t = f64::from(k) / f64::from(INTERVALS);
                let turned = own + arc.sense * arc.sweep * t;
                let ahead = arc.sense * (self.ahead[0] + (self.ahead[1] - self.ahead[0]) * t);
                let apart = self.shift + unit(turned + ahead) * r - unit(turned) * arc.radius;
                let (z0, z1) = (family.start.z - arc.start.z, family.end.z - arc.end.z);
                largest = largest.max(apart.norm().hypot(z0 + (z1 - z0) * t));
            }
            let bend = (r * family.sweep.powi(2) - arc.radius * arc.sweep.powi(2)).abs()
                + arc.radius * arc.sweep.powi(2) * largest_ahead;
            bound = bound.max(largest + bend / (8.0 * f64::from(INTERVALS * INTERVALS)));
        }
        bound + ((arc.end.xy() - arc.center).norm() - arc.radius).abs()
    }
}

/// The angle from one vector to another, radians, in -pi..=pi.
pub fn angle(from: &Vector2<f64>, to: &Vector2<f64>) -> f64 {
    from.perp(to).atan2(from.dot(to)).clamp(-PI, PI)
}

fn unit(angle: f64) -> Vector2<f64> {
    Vector2::new(angle.cos(), angle.sin())
}

//! Whether a part stays outside a round body that holds the lower side of the cutter: exact where cutter and
//! surface are both round.
//!
//! # Method
//! Two spheroids about the axis touch the cutter along the circle of one slope and hold all of its lower
//! side. *The ball*: its centre sees the edge of the flat at that slope. *The flattened one*, for the rounded
//! corner of a bull nose: with r the radius of the flat, q the squared distance from the axis and h the
//! height over the corner's centre, the squared distance from the edge of the flat is q + r^2 - 2 r sqrt(q) +
//! h^2. The root is concave, so sqrt(q) <= (q + c^2) / (2 c) for every c > 0, with equality at q = c^2. Hence
//! no point lies in the corner where q (c - r) / c + h^2 is at least the squared corner radius and r (c - r);
//! c is the distance of the contact from the axis. On steep places it bends as the corner itself does.
//!
//! *A straight move*: with 2 m the vector of the move and x the coordinate along it from the middle, the
//! squared distance from the nearest centre is at least d^2 + x^2 k / (1 + k) - k m^2 for every k >= 0, where
//! d is the distance from the line of the centres. It is exact at
//! |x| = (1 + k) |m|.
//!
//! Over a part, such a sum of squares is a polynomial or a quotient of two; its least Bernstein coefficient
//! bounds it. Where the cutter fits a fillet, every point of an arc is as far from the centre as the others:
//! no other bound sees that on more than tiny parts.

use nalgebra::Vector3;

use super::lift_bound::{AxisMove, Level};
use super::side::Side;
use super::tree::SubPatch;
use crate::geometry::surface::Jet;
use crate::geometry::surface::patch::Patch;
use crate::machining::cutter::{Cutter, LowerPoint};

/// Contacts with a smaller slope have a ball as good as a plane.
const LEAST_SLOPE: f64 = 0.02;

/// A flattened spheroid with less weight in plan is as good as a plane.
const LEAST_WEIGHT: f64 = 1e-3;

/// The round bodies about a cutter that touches where its slope is known.
#[derive(Debug, Clone, Copy)]
pub(super) struct RoundBodies {
    spheroids: [Option<Spheroid>; 2],
    side: Side,
    /// The horizontal unit vector along the cutter at the place where it touches.
    along: Vector3<f64>,
}

/// All places where `weight` times the squared distance from the axis, plus the squared height over the
/// centre, is less than `squared`.
#[derive(Debug, Clone, Copy)]
struct Spheroid {
    squared: f64,
    weight: f64,
    /// Height of the centre over the tip, mm.
    rise: f64,
}

/// Where a body is on its way: its centre in the middle of it, and half the way.
struct Way {
    center: Vector3<f64>,
    half: Vector3<f64>,
    /// The direction of view, level and of unit length, if the body is a cylinder along it.
    seen_along: Option<Vector3<f64>>,
}

impl RoundBodies {
    /// `lower` is the point of the cutter that touches the surface, `jet` the point and the derivatives of
    /// the surface there.
    pub(super) fn around(cutter: &Cutter, lower: &LowerPoint, jet: &Jet) -> Self {
        let along = Vector3::new(-lower.away().y, lower.away().x, 0.0);
        Self { spheroids: Spheroid::around(cutter, lower), side: Side::new(cutter, lower, jet), along }
    }

    /// Whether no point of a part lifts the tip over the level, for any position of the track. A `false` may
    /// mean that this is not known.
    pub(super) fn keep_below<P: Patch>(&self, part: &SubPatch<P>, track: &AxisMove, level: &Level) -> bool {
        let tip = Vector3::new(track.center.x, track.center.y, level.level);
        let half = Vector3::new(track.way.x, track.way.y, level.slope) * track.reach;
        let way = |rise: f64, seen_along| Way { center: tip + Vector3::z() * rise, half, seen_along };
        let part_along = part.outward.map(|outward| Vector3::new(-outward.y, outward.x, 0.0));
        let way_along = (track.reach > 0.0).then(|| Vector3::new(track.way.x, track.way.y, 0.0));
        [part_along, way_along]
            .into_iter()
            .flatten()
            .any(|along| self.side.keeps_below(part, [tip, half], along))
            || self.side.ball_keeps_below(part, [tip, half])
            || self.spheroids.iter().flatten().any(|spheroid| {
                spheroid.keeps_below(part, &way(spheroid.rise, Some(self.along)))
                    || spheroid.keeps_below(part, &way(spheroid.rise, None))
            })
    }
}

impl Spheroid {
    /// Those that touch the cutter where its slope is that at `lower`, unless they are as good as a plane.
    fn around(cutter: &Cutter, lower: &LowerPoint) -> [Option<Self>; 2] {
        let (flat, corner, slope) = (cutter.flat_radius(), cutter.corner_radius(), lower.slope());
        let ball = |radius: f64, rise: f64| Self { squared: radius * radius, weight: 1.0, rise };
        if flat == 0.0 {
            return [Some(ball(corner, corner)), None];
        }
        // Seen from the centre, the edge of the flat lies as steep below as the slope.
        let is_steep = slope > LEAST_SLOPE && slope.is_finite();
        let ball = is_steep.then(|| ball(corner + flat * 1f64.hypot(slope) / slope, corner + flat / slope));
        let beyond = lower.distance() - flat;
        let weight = beyond / lower.distance();
        let flattened = Self { squared: corner * corner + flat * beyond, weight, rise: corner };
        [ball, (corner > 0.0 && weight > LEAST_WEIGHT).then_some(flattened)]
    }

    /// Whether the body, or its cylinder along the direction of view, is clear of a part on all of the way.
    fn keeps_below<P: Patch>(&self, part: &SubPatch<P>, way: &Way) -> bool {
        // Beside the centre it is the shank that counts.
        if part.bounds.max.z > way.center.z - way.half.z.abs() {
            return false;
        }
        // Scaled so, the spheroid is a ball.
        let root = self.weight.sqrt();
        let scale = Vector3::new(root, root, 1.0);
        let scaled = |v: Vector3<f64>| v.component_mul(&scale);
        let seen = |v: Vector3<f64>| way.seen_along.map_or(v, |along| v - along * along.dot(&v));
        let half = scaled(seen(way.half));
        let length = half.norm();
        let (first, share, more) = if length > 0.0 {
            let first = half / length;
            let off = first.dot(&scaled(part.middle() - way.center)).abs();
            let k = (off / length - 1.0).max(0.0);
            (first, k / (1.0 + k), k * length * length)
        } else {
            (Vector3::z(), 1.0, 0.0)
        };
        let needed = self.squared + more;
        match way.seen_along {
            Some(along) => {
                let axes = [first, along.cross(&first)].map(scaled);
                part.is_beyond(&way.center, &axes, &[share, 1.0], needed)
            }
            None => {
                let level = Vector3::new(-first.y, first.x, 0.0).try_normalize(0.0).unwrap_or(Vector3::x());
                let axes = [first, level, first.cross(&level)].map(scaled);
                part.is_beyond(&way.center, &axes, &[share, 1.0, 1.0], needed)
            }
        }
    }
}

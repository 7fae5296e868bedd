//! Proves that a part of the surface is clear of the cutter: that it does not meet a round body that contains
//! the lower side of the cutter.
//!
//! # Method
//! 1. Choose bodies of revolution about the cutter's axis: a ball, and for a bull nose also a flattened
//!    spheroid. Each body contains the lower side of the cutter. Each body touches the lower side where this
//!    side is as steep as at a known contact.
//! 2. For each body, bound from below the squared distance of the part's points from the body's centre. For a
//!    spheroid, lengths are first scaled so that it becomes a ball. The squared distance is a polynomial of
//!    the part's parameters, or a quotient of two polynomials, and its least Bernstein coefficient is the
//!    bound.
//! 3. If the bound shows for one body that all points of the part lie outside it, the part is clear of the
//!    cutter.
//!
//! If the cutter moves along a straight line, the bodies move with it. A similar bound then holds for the
//! whole move.
//!
//! # Guarantees
//! * If a part reaches above the centre of a body, this body proves nothing about the part, because the part
//!   may touch the shank.
//! * The proof succeeds without a margin where both cutter and surface are round, as in a fillet that the
//!   cutter fits.

use nalgebra::Vector3;

use super::lift_bound::{AxisMove, Threshold};
use super::side::Side;
use super::tree::SubPatch;
use crate::geometry::surface::Jet;
use crate::geometry::surface::patch::Patch;
use crate::machining::cutter::{Cutter, LowerPoint};

/// Least slope of a contact for which the ball is used. For a smaller slope the ball bounds no better than a
/// plane.
const LEAST_SLOPE: f64 = 0.02;

/// Least weight of a flattened spheroid. With less weight it bounds no better than a plane.
const LEAST_WEIGHT: f64 = 1e-3;

/// The round bodies that contain a cutter and touch it at the slope of a known contact.
#[derive(Debug, Clone, Copy)]
pub(super) struct RoundBodies {
    spheroids: [Option<Spheroid>; 2],
    side: Side,
    /// The horizontal unit vector that is tangent to the cutter at the contact.
    along: Vector3<f64>,
}

/// All points for which `weight` times the squared distance from the axis, plus the squared height over the
/// centre, is less than `squared` mm^2.
#[derive(Debug, Clone, Copy)]
struct Spheroid {
    squared: f64,
    weight: f64,
    /// Height of the centre over the tip, mm.
    rise: f64,
}

/// A straight move of a body: the body's centre in the middle of the move, and half the vector of the move.
struct Way {
    center: Vector3<f64>,
    half: Vector3<f64>,
    /// A level unit vector, if the body is replaced by its cylinder along that vector.
    seen_along: Option<Vector3<f64>>,
}

impl RoundBodies {
    /// `lower` is the point of the cutter that touches the surface, `jet` the point and the derivatives of
    /// the surface there.
    pub(super) fn around(cutter: &Cutter, lower: &LowerPoint, jet: &Jet) -> Self {
        let along = Vector3::new(-lower.away().y, lower.away().x, 0.0);
        Self { spheroids: Spheroid::around(cutter, lower), side: Side::new(cutter, lower, jet), along }
    }

    /// Whether it is proved that no point of a part lifts the tip over the level, for any position of the
    /// track.
    pub(super) fn keep_below<P: Patch>(
        &self,
        part: &SubPatch<P>,
        track: &AxisMove,
        level: &Threshold,
    ) -> bool {
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
    /// The ball and the flattened spheroid that touch the cutter at the slope of `lower`; `None` for a body
    /// that bounds no better than a plane.
    ///
    /// Let r be the radius of the flat and s that of the rounded corner. The centres of the corner's arcs lie
    /// on a circle of radius r about the axis. For a surface point, let q be its squared distance from the
    /// axis, and h its height over the circle. Then the squared distance of the point from the circle is
    ///
    /// q + r^2 - 2 r sqrt(q) + h^2.
    ///
    /// For every c > 0, sqrt(q) <= (q + c^2) / (2 c). So a point is outside the corner if
    ///
    /// q (c - r) / c + h^2 >= s^2 + r (c - r).
    ///
    /// The points for which this fails form the spheroid. It touches the corner at the distance c from the
    /// axis, so c is the distance of the contact.
    fn around(cutter: &Cutter, lower: &LowerPoint) -> [Option<Self>; 2] {
        let (flat, corner, slope) = (cutter.flat_radius(), cutter.corner_radius(), lower.slope());
        let ball = |radius: f64, rise: f64| Self { squared: radius * radius, weight: 1.0, rise };
        if flat == 0.0 {
            return [Some(ball(corner, corner)), None];
        }
        // The line from the ball's centre to the edge of the flat is at right angles to the cutter at this
        // slope.
        let is_steep = slope > LEAST_SLOPE && slope.is_finite();
        let ball = is_steep.then(|| ball(corner + flat * 1f64.hypot(slope) / slope, corner + flat / slope));
        let beyond = lower.distance() - flat;
        let weight = beyond / lower.distance();
        let flattened = Self { squared: corner * corner + flat * beyond, weight, rise: corner };
        [ball, (corner > 0.0 && weight > LEAST_WEIGHT).then_some(flattened)]
    }

    /// Whether a part is proved to be clear of the body, or of its cylinder, during the whole move.
    ///
    /// The body's centre follows a chord of half length m. Take a point at the distance d from the line of
    /// the chord, and let x be its coordinate along this line, from the middle of the chord. For every k >= 0
    /// its squared distance from the chord is at least
    ///
    /// d^2 + x^2 k / (1 + k) - k m^2.
    ///
    /// The bound is exact at |x| = (1 + k) m.
    fn keeps_below<P: Patch>(&self, part: &SubPatch<P>, way: &Way) -> bool {
        // A part that reaches above the centre may meet the shank, which the body does not contain.
        if part.bounds.max.z > way.center.z - way.half.z.abs() {
            return false;
        }
        // In coordinates scaled by `scale` the spheroid is a ball.
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

//! An arc in the plane. Its ends, centre, radius and turn agree with each other, because only the
//! constructors of this file set them.

use nalgebra::{Point2, Rotation2, Vector2};

use super::{Foot, Segment, left};

/// How far the ends of an arc may lie beside its circle, mm and as a part of the radius. The ends of rounded
/// and joined arcs lie beside it by up to 1e-3 mm; more means that the caller gave the wrong circle.
const BESIDE_MM: f64 = 1e-2;
const BESIDE_PART: f64 = 1e-6;

/// An arc of at most one turn; mm.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlaneArc {
    start: Point2<f64>,
    end: Point2<f64>,
    center: Point2<f64>,
    radius: f64,
    turn: f64,
}

impl PlaneArc {
    /// The arc with this bulge, as in [`Segment::bulging`]; `None` if there is no such arc.
    pub fn with_bulge(start: Point2<f64>, end: Point2<f64>, bulge: f64) -> Option<Self> {
        if start == end {
            return None;
        }
        let center = Point2::from(center(start.coords, end.coords, bulge));
        Self::about(center, (start - center).norm(), [start, end], -4.0 * bulge.atan())
    }

    /// The arc about a centre, as in [`Segment::about`]; `None` if there is no such arc.
    pub fn about(
        center: Point2<f64>,
        radius: f64,
        [start, end]: [Point2<f64>; 2],
        turn: f64,
    ) -> Option<Self> {
        let is_arc = radius > 0.0 && radius.is_finite() && turn != 0.0 && turn.is_finite();
        debug_assert!(
            !is_arc
                || [start, end]
                    .iter()
                    .all(|p| { ((p - center).norm() - radius).abs() <= BESIDE_MM + BESIDE_PART * radius }),
            "{start} and {end} are not on the circle of radius {radius} about {center}"
        );
        is_arc.then_some(Self { start, end, center, radius, turn })
    }

    pub fn start(&self) -> Point2<f64> {
        self.start
    }

    pub fn end(&self) -> Point2<f64> {
        self.end
    }

    pub fn center(&self) -> Point2<f64> {
        self.center
    }

    /// Above zero, mm.
    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// The angle that the arc turns, positive to the left, radians; not zero.
    pub fn turn(&self) -> f64 {
        self.turn
    }

    /// The vector from the centre to the fraction `t` of the length.
    pub(super) fn spoke(&self, t: f64) -> Vector2<f64> {
        Rotation2::new(self.turn * t) * (self.start - self.center)
    }

    /// The arc on the same circle between two other places on it, which turns by `turn` radians; without a
    /// turn, the line.
    pub fn between(&self, ends: [Point2<f64>; 2], turn: f64) -> Segment {
        Segment::about(self.center, self.radius, ends, turn)
    }

    pub(super) fn reversed(&self) -> Self {
        Self { start: self.end, end: self.start, turn: -self.turn, ..*self }
    }

    /// Whether the ray from the centre along `spoke` meets the arc.
    pub fn covers(&self, spoke: Vector2<f64>) -> bool {
        let sense = self.turn.signum();
        let is_after_start = sense * (self.start - self.center).perp(&spoke) >= 0.0;
        let is_before_end = sense * spoke.perp(&(self.end - self.center)) >= 0.0;
        if self.turn.abs() > std::f64::consts::PI {
            is_after_start || is_before_end
        } else {
            is_after_start && is_before_end
        }
    }

    /// The angle that the arc has turned where its circle meets a spoke, radians: from 0 to a full turn.
    pub fn angle_to(&self, spoke: Vector2<f64>) -> f64 {
        let start = self.start - self.center;
        let angle = self.turn.signum() * start.perp(&spoke).atan2(start.dot(&spoke));
        angle.rem_euclid(std::f64::consts::TAU)
    }

    pub(super) fn foot(&self, p: Point2<f64>) -> Foot {
        let spoke = p - self.center;
        let length = spoke.norm();
        let sense = self.turn.signum();
        let out = if length > 0.0 { spoke / length } else { Vector2::x() };
        // Angles are measured from the middle of the arc, so that they jump as far from the arc as possible.
        let middle = Rotation2::new(self.turn / 2.0) * (self.start - self.center);
        let angle = middle.perp(&spoke).atan2(middle.dot(&spoke));
        Foot {
            u: 0.5 + angle / self.turn,
            distance: sense * (self.radius - length),
            tangent: left(out) * sense,
        }
    }
}

/// The centre of the arc from `from` to `to` with this bulge, mm; not finite if the bulge is 0.
pub fn center(from: Vector2<f64>, to: Vector2<f64>, bulge: f64) -> Vector2<f64> {
    let half = (to - from) * 0.5;
    from + half + left(half) * ((bulge * bulge - 1.0) / (2.0 * bulge))
}

//! A line or an arc in the plane, with both ends: what outlines, offsets, regions and fits consist of.
//!
//! The foot of a point is the place nearest to the point, on the segment or on the line or circle that
//! continues the segment. The signed distance of a point is positive if the point lies to the left of the
//! segment, as seen from the start of the segment toward its end.

mod distance;
mod plane_arc;

use nalgebra::{Point2, Rotation2, Vector2};

pub use distance::{circle_meets, circles_meet, lines_meet};
pub use plane_arc::{PlaneArc, center};

/// A line or an arc; mm. A line may have no length: such a line is a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Segment {
    Line { start: Point2<f64>, end: Point2<f64> },
    Arc(PlaneArc),
}

/// The foot of a point on a curve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Foot {
    /// The place of the foot: 0 at the start, 1 at the end, and beyond these on the curve continued.
    pub u: f64,
    /// The signed distance of the point, positive to the left of the curve, mm.
    pub distance: f64,
    /// The unit tangent at the foot.
    pub tangent: Vector2<f64>,
}

/// The vector turned to the left by a quarter turn.
pub fn left(v: Vector2<f64>) -> Vector2<f64> {
    Vector2::new(-v.y, v.x)
}

impl Segment {
    /// The arc with this bulge. The size of the bulge is tan(|turn| / 4); it is positive for an arc to the
    /// left of its chord, which turns to the right. If no arc has this bulge, as for 0, the line.
    pub fn bulging(start: Point2<f64>, end: Point2<f64>, bulge: f64) -> Self {
        PlaneArc::with_bulge(start, end, bulge).map_or(Self::Line { start, end }, Self::Arc)
    }

    /// The arc between two places that turns by `turn` radians, positive to the left; without a turn, the
    /// line.
    pub fn turning(start: Point2<f64>, end: Point2<f64>, turn: f64) -> Self {
        Self::bulging(start, end, -(turn / 4.0).tan())
    }

    /// The arc about a centre that turns by `turn` radians, positive to the left. The ends have to lie on the
    /// circle. Where the radius or the turn is zero, the line.
    pub fn about(center: Point2<f64>, radius: f64, [start, end]: [Point2<f64>; 2], turn: f64) -> Self {
        PlaneArc::about(center, radius, [start, end], turn).map_or(Self::Line { start, end }, Self::Arc)
    }

    pub fn start(&self) -> Point2<f64> {
        match self {
            Self::Line { start, .. } => *start,
            Self::Arc(arc) => arc.start(),
        }
    }

    pub fn end(&self) -> Point2<f64> {
        match self {
            Self::Line { end, .. } => *end,
            Self::Arc(arc) => arc.end(),
        }
    }

    /// The length, mm.
    pub fn length(&self) -> f64 {
        match self {
            Self::Line { start, end } => (end - start).norm(),
            Self::Arc(arc) => arc.radius() * arc.turn().abs(),
        }
    }

    /// The angle that an arc turns, positive to the left, radians; zero for a line.
    pub fn turn(&self) -> f64 {
        if let Self::Arc(arc) = self { arc.turn() } else { 0.0 }
    }

    /// The signed curvature, 1/mm: positive if the segment turns to the left.
    pub fn curvature(&self) -> f64 {
        if let Self::Arc(arc) = self { arc.turn().signum() / arc.radius() } else { 0.0 }
    }

    /// The place at the fraction `t` of the length.
    pub fn at(&self, t: f64) -> Point2<f64> {
        match self {
            _ if t <= 0.0 => self.start(),
            _ if t >= 1.0 => self.end(),
            Self::Line { start, end } => start + (end - start) * t,
            Self::Arc(arc) => arc.center() + arc.spoke(t),
        }
    }

    /// The unit tangent at the fraction `t` of the length; along x if a line has no length.
    pub fn direction(&self, t: f64) -> Vector2<f64> {
        match self {
            Self::Line { start, end } => unit(end - start),
            Self::Arc(arc) => unit(left(arc.spoke(t)) * arc.turn().signum()),
        }
    }

    /// The unit tangents at the start and at the end; along x if a line has no length.
    pub fn tangents(&self) -> [Vector2<f64>; 2] {
        match self {
            Self::Line { start, end } => [unit(end - start); 2],
            Self::Arc(arc) => {
                [arc.start(), arc.end()].map(|p| unit(left(p - arc.center()) * arc.turn().signum()))
            }
        }
    }

    /// The part between two fractions of the length.
    #[must_use]
    pub fn part(&self, from: f64, to: f64) -> Self {
        let ends = [self.at(from), self.at(to)];
        match self {
            Self::Line { .. } => Self::Line { start: ends[0], end: ends[1] },
            Self::Arc(arc) => arc.between(ends, arc.turn() * (to - from)),
        }
    }

    /// The lowest and the highest coordinates, mm: exact but for rounding.
    pub fn bounding_box(&self) -> [Point2<f64>; 2] {
        let (start, end) = (self.start(), self.end());
        let (mut low, mut high) = (start.inf(&end), start.sup(&end));
        if let Self::Arc(arc) = self {
            for axis in [Vector2::x(), -Vector2::x(), Vector2::y(), -Vector2::y()] {
                if arc.covers(axis) {
                    let extreme = arc.center() + axis * arc.radius();
                    (low, high) = (low.inf(&extreme), high.sup(&extreme));
                }
            }
        }
        [low, high]
    }

    /// The same line or arc in the other direction.
    #[must_use]
    pub fn reversed(&self) -> Self {
        match self {
            Self::Line { start, end } => Self::Line { start: *end, end: *start },
            Self::Arc(arc) => Self::Arc(arc.reversed()),
        }
    }

    /// The same line or arc with x negated.
    #[must_use]
    pub fn mirrored(&self) -> Self {
        self.moved(|p| Point2::new(-p.x, p.y), -1.0)
    }

    /// The line or arc turned about the origin.
    #[must_use]
    pub fn rotated(&self, rotation: &Rotation2<f64>) -> Self {
        self.moved(|p| rotation * p, 1.0)
    }

    /// The segment moved by a map that keeps lengths. `sense` is -1 if the map mirrors, else 1.
    fn moved(&self, map: impl Fn(Point2<f64>) -> Point2<f64>, sense: f64) -> Self {
        let ends = [map(self.start()), map(self.end())];
        match self {
            Self::Line { .. } => Self::Line { start: ends[0], end: ends[1] },
            Self::Arc(arc) => Self::about(map(arc.center()), arc.radius(), ends, sense * arc.turn()),
        }
    }

    /// The middle, and the radius of the disc about it that holds the segment, mm.
    pub fn disc(&self) -> (Point2<f64>, f64) {
        let middle = self.at(0.5);
        (middle, (middle - self.start()).norm().max((middle - self.end()).norm()))
    }

    /// The foot of `p`.
    pub fn foot(&self, p: Point2<f64>) -> Foot {
        match self {
            Self::Line { start, end } => {
                let along = end - start;
                let length = along.norm();
                let tangent = if length > 0.0 { along / length } else { Vector2::x() };
                let from = p - start;
                let u = if length > 0.0 { from.dot(&tangent) / length } else { 0.0 };
                Foot { u, distance: tangent.perp(&from), tangent }
            }
            Self::Arc(arc) => arc.foot(p),
        }
    }

    /// A bound of the coordinates, mm. Their rounding grows in proportion to it.
    pub fn magnitude(&self) -> f64 {
        let of = |p: Point2<f64>| p.x.abs().max(p.y.abs());
        let ends = of(self.start()).max(of(self.end()));
        if let Self::Arc(arc) = self { ends + 2.0 * arc.radius() } else { ends }
    }
}

/// The unit vector of a direction; along x if the vector is zero.
fn unit(along: Vector2<f64>) -> Vector2<f64> {
    along.try_normalize(0.0).unwrap_or_else(Vector2::x)
}

#[cfg(test)]
mod tests;

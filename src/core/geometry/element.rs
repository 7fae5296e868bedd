//! Elements of an interpolation: a line, an arc or a parabola between two points of the plane.
//!
//! The foot of a point is the place nearest to the point, on the element or on the line, circle or parabola
//! that continues the element. The signed distance of a point is positive if the point lies to the left of
//! the element, as seen from the start of the element toward its end.

use std::f64::consts::PI;

use nalgebra::{Point2, Rotation2, Vector2};

use super::arc_fit;
use super::interval::Interval;

/// Steps of Newton's method to a foot on a parabola. With a good guess it takes two to five.
const FOOT_STEPS: usize = 30;

/// One element with both ends; mm.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Element {
    Line {
        start: Point2<f64>,
        end: Point2<f64>,
    },
    Arc(PlaneArc),
    /// A quadratic Bezier curve.
    Parabola {
        start: Point2<f64>,
        control: Point2<f64>,
        end: Point2<f64>,
    },
}

/// An arc in the plane of less than a full turn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlaneArc {
    pub start: Point2<f64>,
    pub end: Point2<f64>,
    pub center: Point2<f64>,
    pub radius: f64,
    /// The angle that the arc turns, positive to the left, radians.
    pub turn: f64,
}

/// The foot of a point on an element.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Foot {
    /// The place of the foot: 0 at the start, 1 at the end, and beyond these on the line, circle or parabola
    /// continued.
    pub u: f64,
    /// The signed distance of the point, positive to the left of the element, mm.
    pub distance: f64,
    /// The unit tangent at the foot.
    pub tangent: Vector2<f64>,
    /// How far the point lies ahead of the foot along the tangent, mm: zero unless the search for the foot
    /// did not converge.
    pub slip: f64,
}

impl PlaneArc {
    /// The arc with this bulge: tan(|turn| / 4), positive if the arc lies to the left of its chord, and so
    /// turns to the right. `None` if there is no such arc.
    pub fn with_bulge(start: Point2<f64>, end: Point2<f64>, bulge: f64) -> Option<Self> {
        let center = Point2::from(arc_fit::center(start.coords, end.coords, bulge));
        let radius = (start - center).norm();
        let is_arc = bulge != 0.0 && radius.is_finite() && radius > 0.0 && start != end;
        is_arc.then(|| Self { start, end, center, radius, turn: -4.0 * bulge.atan() })
    }

    /// The signed curvature, 1/mm: positive if the arc turns to the left.
    pub fn curvature(&self) -> f64 {
        self.turn.signum() / self.radius
    }

    fn foot(&self, p: Point2<f64>) -> Foot {
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
            tangent: Vector2::new(-out.y, out.x) * sense,
            slip: 0.0,
        }
    }
}

impl Element {
    pub fn start(&self) -> Point2<f64> {
        match self {
            Self::Line { start, .. } | Self::Parabola { start, .. } => *start,
            Self::Arc(arc) => arc.start,
        }
    }

    pub fn end(&self) -> Point2<f64> {
        match self {
            Self::Line { end, .. } | Self::Parabola { end, .. } => *end,
            Self::Arc(arc) => arc.end,
        }
    }

    /// The length of the element, mm. A parabola is measured along its chord.
    pub fn length(&self) -> f64 {
        match self {
            Self::Arc(arc) => arc.radius * arc.turn.abs(),
            line => (line.end() - line.start()).norm(),
        }
    }

    /// The angle that an arc turns, positive to the left, radians; else zero.
    pub fn turn(&self) -> f64 {
        if let Self::Arc(arc) = self { arc.turn } else { 0.0 }
    }

    /// The place at the fraction `t` of the element's length. For a parabola, the place lies on the chord.
    pub fn at(&self, t: f64) -> Point2<f64> {
        match self {
            _ if t <= 0.0 => self.start(),
            _ if t >= 1.0 => self.end(),
            Self::Arc(arc) => arc.center + Rotation2::new(arc.turn * t) * (arc.start - arc.center),
            line => line.start() + (line.end() - line.start()) * t,
        }
    }

    /// The unit tangent at the fraction `t` of the element's length. For a parabola, the result is the
    /// direction of the chord. If the line, the chord or the arc's radius is zero, the result points along x.
    pub fn direction(&self, t: f64) -> Vector2<f64> {
        let along = match self {
            Self::Arc(arc) => {
                let spoke = Rotation2::new(arc.turn * t) * (arc.start - arc.center);
                Vector2::new(-spoke.y, spoke.x) * arc.turn.signum()
            }
            line => line.end() - line.start(),
        };
        along.try_normalize(0.0).unwrap_or_else(Vector2::x)
    }

    /// The part of the element between two fractions of its length. For a parabola, the result is a line: a
    /// part of the chord.
    #[must_use]
    pub fn part(&self, from: f64, to: f64) -> Self {
        let (start, end) = (self.at(from), self.at(to));
        match self {
            Self::Arc(arc) => Self::Arc(PlaneArc { start, end, turn: arc.turn * (to - from), ..*arc }),
            _ => Self::Line { start, end },
        }
    }

    /// The same line or arc in the other direction.
    #[must_use]
    pub fn reversed(&self) -> Self {
        match self {
            Self::Line { start, end } => Self::Line { start: *end, end: *start },
            Self::Arc(arc) => Self::Arc(PlaneArc { start: arc.end, end: arc.start, turn: -arc.turn, ..*arc }),
            Self::Parabola { start, control, end } => {
                Self::Parabola { start: *end, control: *control, end: *start }
            }
        }
    }

    /// The same line or arc with x negated.
    #[must_use]
    pub fn mirrored(&self) -> Self {
        let mirrored = |p: Point2<f64>| Point2::new(-p.x, p.y);
        let [start, end] = [self.start(), self.end()].map(mirrored);
        match self {
            Self::Line { .. } => Self::Line { start, end },
            Self::Arc(arc) => {
                Self::Arc(PlaneArc { start, end, center: mirrored(arc.center), turn: -arc.turn, ..*arc })
            }
            Self::Parabola { control, .. } => Self::Parabola { start, control: mirrored(*control), end },
        }
    }

    /// The middle of a line or an arc, and the radius of the disc about it that holds the element, mm.
    pub fn disc(&self) -> (Point2<f64>, f64) {
        let middle = self.at(0.5);
        (middle, (middle - self.start()).norm().max((middle - self.end()).norm()))
    }

    /// The parabola through three points, with the middle point at the parameter 1/2.
    pub fn parabola_through([start, middle, end]: [Point2<f64>; 3]) -> Self {
        let control = middle + ((middle - start) + (middle - end)) * 0.5;
        Self::Parabola { start, control, end }
    }

    /// The foot of `p`; on a parabola the foot that the search finds from the guess `near`, from 0 to 1.
    pub fn foot(&self, p: Point2<f64>, near: f64) -> Foot {
        match self {
            Self::Line { start, end } => {
                let along = end - start;
                let length = along.norm();
                let tangent = if length > 0.0 { along / length } else { Vector2::x() };
                let from = p - start;
                let u = if length > 0.0 { from.dot(&tangent) / length } else { 0.0 };
                Foot { u, distance: tangent.perp(&from), tangent, slip: 0.0 }
            }
            Self::Arc(arc) => arc.foot(p),
            Self::Parabola { start, control, end } => parabola_foot([*start, *control, *end], p, near),
        }
    }

    /// Encloses the signed curvature between two places on the element, 1/mm.
    pub fn curvature(&self, from: f64, to: f64) -> Interval {
        match self {
            Self::Line { .. } => Interval::ZERO,
            Self::Arc(arc) => Interval::point(arc.curvature()),
            Self::Parabola { start, control, end } => {
                let (first, second) = (2.0 * (control - start), 2.0 * ((start - control) + (end - control)));
                let cross = first.perp(&second);
                // The speed is the distance of a fixed point from a point on a line, so it is least at the
                // fixed point's foot or at an end.
                let speed = |u: f64| (first + second * u).norm();
                let slowest = -first.dot(&second) / second.norm_squared();
                let slowest = if slowest.is_finite() { slowest.clamp(from, to) } else { from };
                let [least, most] = [speed(slowest), speed(from).max(speed(to))];
                if least > 0.0 {
                    let curvature = Interval::between(cross / least.powi(3), cross / most.powi(3));
                    curvature + Interval::around(0.0, 1e-13 * curvature.mag())
                } else {
                    Interval::ENTIRE
                }
            }
        }
    }

    /// Encloses the length of the element for each unit of `u`, mm: on the element, and beyond its ends as
    /// far as the feet at these two values of `u`.
    pub fn speed(&self, feet: [f64; 2]) -> Interval {
        match self {
            Self::Line { start, end } => Interval::point((end - start).norm()),
            Self::Arc(arc) => Interval::point(arc.radius * arc.turn.abs()),
            // The speed of a parabola may fall to zero in a hairpin. Beyond the ends it grows: twice the
            // largest speed between the ends is enough for `u` from -0.5 to 1.5. The speed is a convex
            // function of `u`, so farther out it is largest at the feet.
            Self::Parabola { start, control, end } => {
                let legs = [control - start, end - control];
                let near = 4.0 * legs[0].norm().max(legs[1].norm());
                let far = feet.map(|u| 2.0 * (legs[0] * (1.0 - u) + legs[1] * u).norm());
                Interval::between(0.0, near.max(far[0]).max(far[1]))
            }
        }
    }

    /// y at x; `None` if the element is not the graph of a function there.
    pub fn graph_at(&self, x: f64) -> Option<f64> {
        match self {
            Self::Line { start, end } => {
                let s = (x - start.x) / (end.x - start.x);
                Some(start.y * (1.0 - s) + end.y * s).filter(|y| y.is_finite())
            }
            Self::Arc(arc) => {
                let across = x - arc.center.x;
                let rise = (arc.radius - across) * (arc.radius + across);
                (self.is_graph() && rise >= 0.0).then(|| arc.center.y - arc.turn.signum() * rise.sqrt())
            }
            Self::Parabola { start, control, end } => {
                let s = (x - start.x) / (end.x - start.x);
                let [a, b] = [start.y + (control.y - start.y) * s, control.y + (end.y - control.y) * s];
                Some(a + (b - a) * s).filter(|y| y.is_finite())
            }
        }
    }

    /// Encloses the second derivative of y by x between two places; the element has to be the graph of a
    /// function.
    pub fn graph_bend(&self, from: f64, to: f64) -> Interval {
        match self {
            Self::Line { .. } => Interval::ZERO,
            Self::Arc(arc) => {
                let across = Interval::between(from, to) + Interval::point(-arc.center.x);
                let radius = Interval::point(arc.radius);
                let rise = radius.sqr() - across.sqr();
                if rise.lo() <= 0.0 {
                    return Interval::ENTIRE;
                }
                (radius.sqr().div(rise * rise.sqrt())) * arc.turn.signum()
            }
            Self::Parabola { start, control, end } => {
                let width = end.x - start.x;
                let bend = 2.0 * ((start.y - control.y) + (end.y - control.y)) / (width * width);
                // The heights of the control points are exact up to their rounding.
                let height = start.y.abs().max(control.y.abs()).max(end.y.abs());
                Interval::around(bend, 16.0 * f64::EPSILON * height / (width * width))
            }
        }
    }

    /// Whether x grows all along the element.
    fn is_graph(&self) -> bool {
        match self {
            Self::Line { start, end } | Self::Parabola { start, end, .. } => start.x < end.x,
            Self::Arc(arc) => {
                // The tangent points to the right at both ends, and turns by less than half a turn in
                // between.
                let sense = arc.turn.signum();
                let heads_right = |p: Point2<f64>| (arc.center.y - p.y) * sense > 0.0;
                arc.turn.abs() < PI && heads_right(arc.start) && heads_right(arc.end)
            }
        }
    }

    /// The size of the element's coordinates, mm, which its rounding is proportional to.
    pub fn magnitude(&self) -> f64 {
        let of = |p: &Point2<f64>| p.x.abs().max(p.y.abs());
        match self {
            Self::Line { start, end } => of(start).max(of(end)),
            Self::Arc(arc) => of(&arc.start).max(of(&arc.end)) + 2.0 * arc.radius,
            Self::Parabola { start, control, end } => of(start).max(of(end)).max(of(control)),
        }
    }
}

/// The foot on a parabola, by Newton's method on the squared distance.
fn parabola_foot([start, control, end]: [Point2<f64>; 3], p: Point2<f64>, near: f64) -> Foot {
    let (first, second) = (2.0 * (control - start), (start - control) + (end - control));
    let at = |u: f64| start + first * u + second * (u * u);
    let speed = |u: f64| first + second * (2.0 * u);
    let mut u = near;
    for _ in 0..FOOT_STEPS {
        let (away, along) = (at(u) - p, speed(u));
        let slope = along.norm_squared() + 2.0 * away.dot(&second);
        // If the distance is not convex, the step of the Gauss-Newton method still descends.
        let slope = if slope > 0.0 { slope } else { along.norm_squared() };
        let step = away.dot(&along) / slope;
        if !step.is_finite() {
            break;
        }
        u -= step.clamp(-0.5, 0.5);
        if step.abs() <= 1e-15 {
            break;
        }
    }
    let along = speed(u);
    let length = along.norm();
    let tangent = if length > 0.0 { along / length } else { Vector2::x() };
    let away = p - at(u);
    Foot { u, distance: tangent.perp(&away), tangent, slip: away.dot(&tangent).abs() }
}

#[cfg(test)]
mod tests;

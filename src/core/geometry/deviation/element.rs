//! An element of an interpolation: a line, an arc or a parabola between two points of the plane.
//!
//! As for a segment, the foot of a point may lie on the curve that continues the element.

use std::f64::consts::PI;

use nalgebra::{Point2, Vector2};

use crate::geometry::interval::Interval;
use crate::geometry::segment::{Foot, Segment};

/// Steps of Newton's method to a foot on a parabola. With a good guess it takes two to five.
const FOOT_STEPS: usize = 30;

/// The longest step of Newton's method, in the parameter of the parabola. From a bad guess, a longer step may
/// lead to the foot on the other branch.
const LONGEST_STEP: f64 = 0.5;

/// A step this short is rounding: the parameters of feet are about 1.
const SHORTEST_STEP: f64 = 1e-15;

/// The rounding of a parabola's curvature, as a part of it: some dozen operations, with room to spare.
const CURVATURE_ROUNDING: f64 = 1e-13;

/// The rounding of a parabola's second derivative, as a part of the heights of its control points.
const BEND_ROUNDING: f64 = 16.0 * f64::EPSILON;

/// One element with both ends; mm.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Element {
    Segment(Segment),
    /// A quadratic Bezier curve.
    Parabola {
        start: Point2<f64>,
        control: Point2<f64>,
        end: Point2<f64>,
    },
}

impl From<Segment> for Element {
    fn from(segment: Segment) -> Self {
        Self::Segment(segment)
    }
}

impl Element {
    /// The parabola through three points, with the middle point at the parameter 1/2.
    pub fn parabola_through([start, middle, end]: [Point2<f64>; 3]) -> Self {
        let control = middle + ((middle - start) + (middle - end)) * 0.5;
        Self::Parabola { start, control, end }
    }

    pub fn start(&self) -> Point2<f64> {
        match self {
            Self::Segment(segment) => segment.start(),
            Self::Parabola { start, .. } => *start,
        }
    }

    pub fn end(&self) -> Point2<f64> {
        match self {
            Self::Segment(segment) => segment.end(),
            Self::Parabola { end, .. } => *end,
        }
    }

    /// The foot of `p`; on a parabola the foot that the search finds from the guess `near`, from 0 to 1. With
    /// it comes how far `p` lies ahead of the foot along the tangent, mm: zero unless the search did not
    /// converge.
    pub fn foot(&self, p: Point2<f64>, near: f64) -> (Foot, f64) {
        match self {
            Self::Segment(segment) => (segment.foot(p), 0.0),
            Self::Parabola { start, control, end } => parabola_foot([*start, *control, *end], p, near),
        }
    }

    /// Encloses the signed curvature between two places on the element, 1/mm.
    pub fn curvature(&self, from: f64, to: f64) -> Interval {
        match self {
            Self::Segment(segment) => Interval::point(segment.curvature()),
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
                    curvature + Interval::around(0.0, CURVATURE_ROUNDING * curvature.mag())
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
            Self::Segment(segment) => Interval::point(segment.length()),
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
            Self::Segment(Segment::Line { start, end }) => {
                let s = (x - start.x) / (end.x - start.x);
                Some(start.y * (1.0 - s) + end.y * s).filter(|y| y.is_finite())
            }
            Self::Segment(Segment::Arc(arc)) => {
                let across = x - arc.center().x;
                let rise = (arc.radius() - across) * (arc.radius() + across);
                // x grows all along the arc if the tangent points to the right at both ends, and turns by
                // less than half a turn in between.
                let sense = arc.turn().signum();
                let heads_right = |p: Point2<f64>| (arc.center().y - p.y) * sense > 0.0;
                let is_graph = arc.turn().abs() < PI && heads_right(arc.start()) && heads_right(arc.end());
                (is_graph && rise >= 0.0).then(|| arc.center().y - sense * rise.sqrt())
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
            Self::Segment(Segment::Line { .. }) => Interval::ZERO,
            Self::Segment(Segment::Arc(arc)) => {
                let across = Interval::between(from, to) + Interval::point(-arc.center().x);
                let radius = Interval::point(arc.radius());
                let rise = radius.sqr() - across.sqr();
                if rise.lo() <= 0.0 {
                    return Interval::ENTIRE;
                }
                (radius.sqr().div(rise * rise.sqrt())) * arc.turn().signum()
            }
            Self::Parabola { start, control, end } => {
                let width = end.x - start.x;
                let bend = 2.0 * ((start.y - control.y) + (end.y - control.y)) / (width * width);
                // The heights of the control points are exact up to their rounding.
                let height = start.y.abs().max(control.y.abs()).max(end.y.abs());
                Interval::around(bend, BEND_ROUNDING * height / (width * width))
            }
        }
    }

    /// The size of the element's coordinates, mm, which its rounding is proportional to.
    pub fn magnitude(&self) -> f64 {
        match self {
            Self::Segment(segment) => segment.magnitude(),
            Self::Parabola { start, control, end } => {
                [start, control, end].iter().flat_map(|p| p.iter()).fold(0.0, |most, x| x.abs().max(most))
            }
        }
    }
}

/// The foot on a parabola, by Newton's method on the squared distance, and how far the point lies ahead of
/// it.
fn parabola_foot([start, control, end]: [Point2<f64>; 3], p: Point2<f64>, near: f64) -> (Foot, f64) {
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
        u -= step.clamp(-LONGEST_STEP, LONGEST_STEP);
        if step.abs() <= SHORTEST_STEP {
            break;
        }
    }
    let along = speed(u);
    let length = along.norm();
    let tangent = if length > 0.0 { along / length } else { Vector2::x() };
    let away = p - at(u);
    (Foot { u, distance: tangent.perp(&away), tangent }, away.dot(&tangent).abs())
}

#[cfg(test)]
mod tests;

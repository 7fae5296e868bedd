//! Two ways to measure the signed distance of a curve from an element: along the normal of the element
//! ([`Normal`]), and along y ([`Vertical`]). Both give an interval for the distance at one parameter of the
//! curve. Between two parameters, both give an interval for the distance, and one for its second derivative
//! if that has a bound.

use nalgebra::{Point2, Vector2};

use super::{Element, Ends};
use crate::geometry::interval::Interval;
use crate::geometry::plane_curve::{Enclosure, PlaneCurve};
use crate::geometry::segment::Segment;

/// Rounding of a foot and its distance, as a part of the largest coordinate: a few dozen operations.
const ROUNDING: f64 = 64.0 * f64::EPSILON;

/// What the sine of a cone is widened by for rounding: a part of it, and a sine of a few units of rounding,
/// for tangents that agree.
const SINE_PART: f64 = 1e-12;
const SINE_LEAST: f64 = 1e-15;

/// Feet this far beyond an end of the element count as at the end, in units of `u`.
const END_ROUNDING: f64 = 1e-12;

/// The distance at one parameter of the curve.
#[derive(Debug, Clone, Copy)]
pub struct Reading {
    pub t: f64,
    /// How far the curve lies to the left of the element, or above, mm.
    pub distance: Interval,
    /// Lower bound of the distance from the element, ends included, mm.
    pub away: f64,
    /// The place of the foot on the element, from 0 to 1.
    pub u: f64,
    /// Whether the search for the foot converged, to rounding.
    is_foot: bool,
    /// The element's unit tangent at the foot.
    tangent: Vector2<f64>,
}

/// A way to measure the deviation.
pub trait Gauge {
    fn read(&self, t: f64) -> Reading {
        self.read_near(t, 0.5)
    }

    /// The reading at `t`. The search for the foot starts at `u`.
    fn read_near(&self, t: f64, u: f64) -> Reading;

    /// Encloses the second derivative of the distance between two readings; `None` if it has no bound.
    fn bend(&self, a: &Reading, b: &Reading) -> Option<Interval>;

    /// Encloses the distance between two readings without any derivatives.
    fn reach(&self, a: &Reading, b: &Reading) -> Interval;
}

/// Measures the distance to the foot.
pub struct Normal<'a, C> {
    pub curve: &'a C,
    pub element: &'a Element,
    pub from: f64,
    pub to: f64,
    pub ends: Ends,
}

impl<C: PlaneCurve> Gauge for Normal<'_, C> {
    fn read(&self, t: f64) -> Reading {
        self.read_near(t, (t - self.from) / (self.to - self.from))
    }

    fn read_near(&self, t: f64, u: f64) -> Reading {
        let [x, y] = self.curve.enclose(t, t).point;
        let p = Point2::new(x.mid(), y.mid());
        let (foot, slip) = self.element.foot(p, u);
        let rounding = ROUNDING * (self.element.magnitude() + p.x.abs() + p.y.abs());
        let slack = x.width() + y.width() + rounding + slip;
        let distance = Interval::around(foot.distance, slack);
        let out = match (self.ends, self.element) {
            (Ends::OnCurve, Element::Segment(Segment::Line { .. })) => {
                (beyond(foot.u) - END_ROUNDING).max(0.0) * self.element.speed([foot.u; 2]).lo()
            }
            _ => 0.0,
        };
        let away = if out > 0.0 { (distance.mig().hypot(out) - slack).max(0.0) } else { distance.mig() };
        let is_foot = slip <= rounding;
        Reading { t, distance, away, u: foot.u, is_foot, tangent: foot.tangent }
    }

    /// Let N and T be the unit normal and tangent at the foot, k the signed curvature of the element there,
    /// and d the distance of a moving point C. Then d' = N C' and d'' = N C'' - k / (1 - k d) (T C')^2. The
    /// foot moves forward while T C' > 0 and k d < 1. So it stays between the feet of the two readings, and
    /// N, T and k are enclosed by their values between these feet.
    fn bend(&self, a: &Reading, b: &Reading) -> Option<Interval> {
        if self.ends == Ends::OnCurve && beyond(a.u).max(beyond(b.u)) > END_ROUNDING {
            return None;
        }
        if !(a.is_foot && b.is_foot) {
            return None;
        }
        let Enclosure { first, second, .. } = self.curve.enclose(a.t, b.t);
        let sum = a.tangent + b.tangent;
        let length = sum.norm();
        // If the tangents are too far apart, the cone of directions is too wide to be of use.
        if length < 1.5 || !second[0].is_bounded() || !second[1].is_bounded() {
            return None;
        }
        let along = sum / length;
        let half_way = 0.5 * (a.tangent - b.tangent).norm();
        let cone = Cone { along, sine: half_way * (1.0 + SINE_PART) + SINE_LEAST };
        let speed = cone.along(first);
        if speed.lo() <= 0.0 {
            return None;
        }
        let bend = cone.across(second);
        let curvature = match self.element {
            Element::Segment(Segment::Line { .. }) => return Some(bend),
            _ if b.u < a.u => return None,
            element => element.curvature(a.u, b.u),
        };
        // While the foot runs between the two feet, the distance is at most that of the readings plus the way
        // that the curve's point moves.
        let way = (speed.hi() + cone.across(first).mag()) * (b.t - a.t);
        let distance = a.distance.hull(b.distance) + Interval::around(0.0, way);
        let room = Interval::point(1.0) - curvature * distance;
        if room.lo() <= 0.0 {
            return None;
        }
        Some(bend - curvature.div(room) * speed.sqr())
    }

    /// The distance changes no faster than the point moves. Near an end the foot may leave the element by as
    /// much as the point moves. On a curved element the foot may jump: the length between the two feet is
    /// then added.
    fn reach(&self, a: &Reading, b: &Reading) -> Interval {
        let Enclosure { point: [x, y], .. } = self.curve.enclose(a.t, b.t);
        if !x.is_bounded() || !y.is_bounded() {
            return Interval::ENTIRE;
        }
        let way = x.width().hypot(y.width());
        let distance = a.distance + Interval::around(0.0, way);
        let speed = self.element.speed([a.u, b.u]);
        let jump = match self.element {
            Element::Segment(Segment::Line { .. }) => 0.0,
            Element::Segment(Segment::Arc(_)) | Element::Parabola { .. } => (b.u - a.u).abs() * speed.hi(),
        };
        let is_inside = |u: f64| u.min(1.0 - u) * speed.lo() > way;
        if jump == 0.0 && (self.ends == Ends::Beside || is_inside(a.u)) {
            return distance;
        }
        let out = if self.ends == Ends::Beside { 0.0 } else { beyond(a.u) * speed.hi() + way };
        distance + Interval::around(0.0, jump.max(out))
    }
}

/// How far a foot lies beyond the ends of its element, in units of `u`.
fn beyond(u: f64) -> f64 {
    (-u).max(u - 1.0).max(0.0)
}

/// Measures the difference of heights.
pub struct Vertical<'a, C> {
    pub curve: &'a C,
    pub element: &'a Element,
}

impl<C: PlaneCurve> Gauge for Vertical<'_, C> {
    fn read_near(&self, t: f64, u: f64) -> Reading {
        let y = self.curve.enclose(t, t).point[1];
        let distance = match self.element.graph_at(t) {
            Some(height) => y - Interval::around(height, ROUNDING * self.element.magnitude()),
            // Where the element has no height, the distance is infinite.
            None => Interval::point(f64::INFINITY),
        };
        Reading { t, distance, away: distance.mig(), u, is_foot: true, tangent: Vector2::x() }
    }

    fn bend(&self, a: &Reading, b: &Reading) -> Option<Interval> {
        let second = self.curve.enclose(a.t, b.t).second[1];
        Some(second - self.element.graph_bend(a.t, b.t))
    }

    fn reach(&self, a: &Reading, b: &Reading) -> Interval {
        let y = self.curve.enclose(a.t, b.t).point[1];
        let (Some(from), Some(to)) = (self.element.graph_at(a.t), self.element.graph_at(b.t)) else {
            return Interval::ENTIRE;
        };
        let rounding = Interval::around(0.0, ROUNDING * self.element.magnitude());
        let width = b.t - a.t;
        let bulge = 0.126 * self.element.graph_bend(a.t, b.t).mag() * width * width;
        y - (Interval::between(from, to) + rounding + Interval::around(0.0, bulge))
    }
}

/// The directions whose angle with `along` has at most the sine `sine`.
struct Cone {
    along: Vector2<f64>,
    sine: f64,
}

impl Cone {
    /// Encloses the scalar product of a direction in the cone and a vector in the box.
    fn along(&self, v: [Interval; 2]) -> Interval {
        let (t, n) = self.turned(v);
        t * self.cosine() + n * Interval::between(-self.sine, self.sine)
    }

    /// As [`Self::along`], with the direction turned to the left by a quarter turn.
    fn across(&self, v: [Interval; 2]) -> Interval {
        let (t, n) = self.turned(v);
        n * self.cosine() + t * Interval::between(-self.sine, self.sine)
    }

    fn cosine(&self) -> Interval {
        // sqrt(1 - s^2) >= 1 - s^2.
        Interval::between((1.0 - self.sine * self.sine).next_down(), 1.0)
    }

    fn turned(&self, [x, y]: [Interval; 2]) -> (Interval, Interval) {
        let (c, s) = (self.along.x, self.along.y);
        (x * c + y * s, y * c - x * s)
    }
}

//! Reads the distance of a curve from an element, along the normal or along y, and encloses it between
//! readings.

use nalgebra::{Point2, Vector2};

use super::Ends;
use crate::geometry::element::Element;
use crate::geometry::interval::Interval;
use crate::geometry::plane_curve::{Enclosure, PlaneCurve};

/// Rounding of a foot and its distance, in parts of the largest coordinate: a few dozen operations.
const ROUNDING: f64 = 64.0 * f64::EPSILON;

/// Feet at the ends of an element are there up to this.
const END_ROUNDING: f64 = 1e-12;

/// What is known at one parameter.
#[derive(Debug, Clone, Copy)]
pub struct Reading {
    pub t: f64,
    /// How far the curve lies to the left of the element, or above, mm.
    pub distance: Interval,
    /// How far it lies from the element at least, its ends included, mm.
    pub away: f64,
    /// Where the foot is.
    pub u: f64,
    /// Whether it is a foot, to rounding.
    is_foot: bool,
    /// The element's tangent there.
    tangent: Vector2<f64>,
}

/// A way to measure.
pub trait Gauge {
    fn read(&self, t: f64) -> Reading {
        self.read_near(t, 0.5)
    }

    /// The reading at `t`, whose foot is somewhere about `u`.
    fn read_near(&self, t: f64, u: f64) -> Reading;

    /// Encloses the second derivative of the distance between two readings; `None` where there is none.
    fn bend(&self, a: &Reading, b: &Reading) -> Option<Interval>;

    /// Encloses the distance between two readings without any derivatives.
    fn reach(&self, a: &Reading, b: &Reading) -> Interval;
}

/// Distances to the foot.
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
        let foot = self.element.foot(p, u);
        let rounding = ROUNDING * (self.element.magnitude() + p.x.abs() + p.y.abs());
        let slack = x.width() + y.width() + rounding + foot.slip;
        let distance = Interval::around(foot.distance, slack);
        let out = match (self.ends, self.element) {
            (Ends::OnCurve, Element::Line { .. }) => {
                (beyond(foot.u) - END_ROUNDING).max(0.0) * self.element.speed().lo()
            }
            _ => 0.0,
        };
        let away = if out > 0.0 { (distance.mig().hypot(out) - slack).max(0.0) } else { distance.mig() };
        let is_foot = foot.slip <= rounding;
        Reading { t, distance, away, u: foot.u, is_foot, tangent: foot.tangent }
    }

    /// With the unit normal N and tangent T at the foot, and the signed curvature k of the element there, the
    /// distance d of a moving point C has d' = N C' and d'' = N C'' - k / (1 - k d) (T C')^2. The foot moves
    /// on while T C' > 0 and k d < 1; then it stays between those of the two readings, and N, T and k are
    /// enclosed by what they are there.
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
        // Beyond a right angle between the two, the cone is not worth the trouble.
        if length < 1.5 || !second[0].is_bounded() || !second[1].is_bounded() {
            return None;
        }
        let along = sum / length;
        let cone = Cone { along, sine: (0.5 * (a.tangent - b.tangent).norm()) * (1.0 + 1e-12) + 1e-15 };
        let speed = cone.along(first);
        if speed.lo() <= 0.0 {
            return None;
        }
        let bend = cone.across(second);
        let curvature = match self.element {
            Element::Line { .. } => return Some(bend),
            _ if b.u < a.u => return None,
            element => element.curvature(a.u, b.u),
        };
        // While the foot runs between the two it is no farther away than the readings and the way between.
        let way = (speed.hi() + cone.across(first).mag()) * (b.t - a.t);
        let distance = a.distance.hull(b.distance) + Interval::around(0.0, way);
        let room = Interval::point(1.0) - curvature * distance;
        if room.lo() <= 0.0 {
            return None;
        }
        Some(bend - curvature.div(room) * speed.sqr())
    }

    /// The distance changes no faster than the point moves; near an end the foot may run out of the element
    /// by as much, and on a bent element it may jump: what lies between the feet counts from one of them.
    fn reach(&self, a: &Reading, b: &Reading) -> Interval {
        let Enclosure { point: [x, y], .. } = self.curve.enclose(a.t, b.t);
        if !x.is_bounded() || !y.is_bounded() {
            return Interval::ENTIRE;
        }
        let way = x.width().hypot(y.width());
        let distance = a.distance + Interval::around(0.0, way);
        let speed = self.element.speed();
        let jump = match self.element {
            Element::Line { .. } => 0.0,
            Element::Arc(_) | Element::Parabola { .. } => (b.u - a.u).abs() * speed.hi(),
        };
        let is_inside = |u: f64| u.min(1.0 - u) * speed.lo() > way;
        if jump == 0.0 && (self.ends == Ends::Beside || is_inside(a.u)) {
            return distance;
        }
        let out = if self.ends == Ends::Beside { 0.0 } else { beyond(a.u) * speed.hi() + way };
        distance + Interval::around(0.0, jump.max(out))
    }
}

/// How far a foot lies out of its element.
fn beyond(u: f64) -> f64 {
    (-u).max(u - 1.0).max(0.0)
}

/// Differences of heights.
pub struct Vertical<'a, C> {
    pub curve: &'a C,
    pub element: &'a Element,
}

impl<C: PlaneCurve> Gauge for Vertical<'_, C> {
    fn read_near(&self, t: f64, u: f64) -> Reading {
        let y = self.curve.enclose(t, t).point[1];
        let distance = match self.element.graph_at(t) {
            Some(height) => y - Interval::around(height, ROUNDING * self.element.magnitude()),
            // Nothing is near an element that is not there.
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

/// Directions near one: those whose angle with it has at most this sine.
struct Cone {
    along: Vector2<f64>,
    sine: f64,
}

impl Cone {
    /// Encloses the product of a direction in the cone and a vector in the box.
    fn along(&self, v: [Interval; 2]) -> Interval {
        let (t, n) = self.turned(v);
        t * self.cosine() + n * Interval::between(-self.sine, self.sine)
    }

    /// As `along`, of the direction a quarter turn to the left of it.
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

//! All arcs, or all parabolas, over one chord. One number, the *bow*, tells them apart.
//!
//! # Method
//! Through each point beside the chord passes exactly one of these elements. So each point of a curve has a
//! bow: that of the element through it. At the two ends of the curve, which are those of the chord, the bow
//! is that of the element along the curve's tangent.
//!
//! As the bow grows, the signed distances of all points of the curve from the element fall. The best bow is
//! the one at which the largest deviations to the two sides use up the same share of the band. It is found as
//! the root of a falling function. If the band has no room on one side, the best bow is the least or the
//! largest bow of the curve's points.

use nalgebra::{Point2, Vector2};

use crate::geometry::deviation::Element;
use crate::geometry::segment::{PlaneArc, Segment};

/// A family of elements over a chord.
#[derive(Debug, Clone, Copy)]
pub enum Bow {
    /// Arcs; the bow is the bulge, tan(turn / 4).
    Arcs { start: Point2<f64>, end: Point2<f64> },
    /// Parabolas with this axis, a unit vector to the left of the chord. The bow is the distance of the
    /// control point from the middle of the chord, mm.
    Parabolas { start: Point2<f64>, end: Point2<f64>, axis: Vector2<f64> },
}

impl Bow {
    /// The element with a bow; `None` if there is no such arc.
    pub fn element(&self, bow: f64) -> Option<Element> {
        match *self {
            Self::Arcs { start, end } => {
                PlaneArc::with_bulge(start, end, bow).map(|arc| Segment::Arc(arc).into())
            }
            Self::Parabolas { start, end, axis } => {
                let control = nalgebra::center(&start, &end) + axis * bow;
                Some(Element::Parabola { start, control, end })
            }
        }
    }

    /// A function that tells how far a point lies to the left of the element with a bow, mm. For parabolas
    /// the distance has a small relative error, for points nearer to the parabola than a small share of the
    /// chord.
    pub fn distance(&self, bow: f64) -> impl Fn(Point2<f64>) -> f64 + use<> {
        let bows = *self;
        let arc = self.element(bow);
        move |p| match (bows, arc) {
            (_, Some(Element::Segment(Segment::Arc(arc)))) => {
                arc.turn().signum() * (arc.radius() - (p - arc.center()).norm())
            }
            (Self::Parabolas { start, end, axis }, _) => {
                let (chord, from) = (end - start, p - start);
                let length = axis.perp(&chord);
                let u = axis.perp(&from) / length;
                let slope = (chord.dot(&axis) + 2.0 * (1.0 - 2.0 * u) * bow) / length;
                let away = (from - chord * u).dot(&axis) - 2.0 * u * (1.0 - u) * bow;
                away / (1.0 + slope * slope).sqrt()
            }
            (Self::Arcs { start, end }, _) => (end - start).normalize().perp(&(p - start)),
        }
    }

    /// The change of bow that moves the middle of an element by `mm` millimetres; for arcs to first order.
    pub fn rise(&self, mm: f64) -> f64 {
        match *self {
            Self::Arcs { start, end } => 2.0 * mm / (end - start).norm(),
            Self::Parabolas { .. } => 2.0 * mm,
        }
    }

    /// The bow of the element through `p`. If there are several arcs, the one that turns least counts. Not
    /// finite if there is no such element.
    pub fn through(&self, p: Point2<f64>) -> f64 {
        match *self {
            Self::Arcs { start, end } => bulge_through(p, start, end),
            Self::Parabolas { start, end, axis } => {
                let (chord, from) = (end - start, p - start);
                let u = axis.perp(&from) / axis.perp(&chord);
                (from - chord * u).dot(&axis) / (2.0 * u * (1.0 - u))
            }
        }
    }

    /// The bows of the two elements that run along the tangent of a curve at its start and at its end.
    pub fn along(&self, [first, last]: [Vector2<f64>; 2]) -> [f64; 2] {
        match *self {
            Self::Arcs { start, end } => {
                let chord = end - start;
                [tan_half(chord, first), tan_half(last, chord)]
            }
            Self::Parabolas { start, end, axis } => {
                let chord = end - start;
                [first, -last].map(|tangent| {
                    let pace = axis.perp(&tangent) / axis.perp(&chord);
                    (tangent - chord * pace).dot(&axis) / (2.0 * pace.abs())
                })
            }
        }
    }
}

/// tan(angle / 2) for the angle from one direction to another, positive to the left.
fn tan_half(from: Vector2<f64>, to: Vector2<f64>) -> f64 {
    from.perp(&to) / (from.norm() * to.norm() + from.dot(&to))
}

/// The bulge of the arc over a chord and through `p`; of the two arcs, the one that turns least.
fn bulge_through(p: Point2<f64>, start: Point2<f64>, end: Point2<f64>) -> f64 {
    let chord = end - start;
    let half = 0.5 * chord.norm();
    let along = chord / (2.0 * half);
    let from = p - start;
    let (x, y) = (from.dot(&along) - half, along.perp(&from));
    let from_end = (x - half).hypot(y);
    // From any point of the arc, the chord is seen under an angle of pi less half the arc's turn. This gives
    // tan(turn / 2), and from that tan(turn / 4) follows.
    let k = x * x + y * y - half * half;
    2.0 * half * y / ((from.norm() * from_end) - k)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The points of an element and its end tangents all have the element's own bow.
    #[test]
    fn an_element_has_its_own_bow_everywhere() {
        let (start, end) = (Point2::new(1.0, 2.0), Point2::new(5.0, 3.5));
        let across = Vector2::new(-1.5, 4.0).normalize();
        let families = [
            Bow::Arcs { start, end },
            Bow::Parabolas { start, end, axis: across },
            Bow::Parabolas { start, end, axis: Vector2::y() },
        ];
        for family in families {
            for bow in [-0.7, -0.1, 0.2, 0.9] {
                let (points, tangents) = match family.element(bow).unwrap() {
                    Element::Parabola { start, control, end } => {
                        let at = |u: f64| start.lerp(&control, u).lerp(&control.lerp(&end, u), u);
                        ([0.1, 0.5, 0.8].map(at), [control - start, end - control])
                    }
                    Element::Segment(arc) => ([0.1, 0.5, 0.8].map(|t| arc.at(t)), arc.tangents()),
                };
                for found in points.map(|p| family.through(p)).into_iter().chain(family.along(tangents)) {
                    assert!((found - bow).abs() < 1e-12, "{family:?} {bow} {found}");
                }
            }
        }
    }
}

//! Lines and arcs of a contour in the plane, beside which a cutter goes at the distance of its radius.

use std::f64::consts::{PI, TAU};

use nalgebra::Vector2;
use toolpathd_core::geometry::curve::{Arc, Curve, Direction};
use toolpathd_core::geometry::plane::Plane;

use crate::fault::Fault;
use crate::offset_curve::{OffsetCurve, left_of};

/// Least radius of an offset arc, mm. Below it ends and centre cannot be told apart.
const LEAST_RADIUS_MM: f64 = 1e-6;

/// Part of a turn by which an offset arc may run backwards: rounding of intersections.
const SAME_ANGLE: f64 = 1e-9;

/// Part of the square of a radius by which a chord may miss its circle: rounding of the contour.
const SAME_CHORD: f64 = 1e-12;

/// A line or an arc of a contour with the curve beside it.
#[derive(Debug, Clone, Copy)]
pub struct Contour {
    /// Directions at the start and at the end, of length 1.
    pub begins: Vector2<f64>,
    pub leaves: Vector2<f64>,
    /// A place of the offset line, or the centre of the offset arc.
    from: Vector2<f64>,
    turn: Option<Turn>,
    /// Radius of the offset arc, mm; zero for a line.
    pub radius_mm: f64,
}

/// How an arc turns: the sense (1 counterclockwise), the angles of its ends from its centre.
#[derive(Debug, Clone, Copy)]
struct Turn {
    sense: f64,
    start: f64,
    sweep: f64,
}

/// The direction across `way`, to the left or to the right.
pub fn normal(way: Vector2<f64>, is_left: bool) -> Vector2<f64> {
    if is_left { left_of(way) } else { -left_of(way) }
}

impl Contour {
    /// The contour of a curve with a cutter of `radius_mm` beside it.
    ///
    /// # Errors
    /// Where the cutter does not fit into an arc, and where the curve is neither a line nor an arc.
    pub fn new(curve: &Curve, plane: Plane, is_left: bool, radius_mm: f64) -> Result<Self, Fault> {
        let local = |at| plane.to_local(&at).xy();
        match curve {
            Curve::Line(line) => {
                let (start, end) = (local(line.start), local(line.end));
                let way = (end - start).normalize();
                let from = start + normal(way, is_left) * radius_mm;
                Ok(Self { begins: way, leaves: way, from, turn: None, radius_mm: 0.0 })
            }
            Curve::Arc(arc) if arc.plane() == plane => Self::of_arc(arc, plane, is_left, radius_mm),
            _ => Err(Fault::NotRead),
        }
    }

    fn of_arc(arc: &Arc, plane: Plane, is_left: bool, radius_mm: f64) -> Result<Self, Fault> {
        let local = |at| plane.to_local(&at).xy();
        let center = local(arc.center());
        let [start, end] = [arc.start(), arc.end()].map(|at| local(at) - center);
        let is_ccw = arc.direction() == Direction::Ccw;
        // On the left of a counterclockwise arc lies its centre.
        let offset = if is_ccw == is_left { arc.radius() - radius_mm } else { arc.radius() + radius_mm };
        if offset < LEAST_RADIUS_MM {
            return Err(Fault::CutterTooLarge);
        }
        let sense = if is_ccw { 1.0 } else { -1.0 };
        let turn = Turn { sense, start: start.y.atan2(start.x), sweep: arc.sweep() };
        let across = |radius: Vector2<f64>| normal(radius.normalize(), is_ccw);
        Ok(Self {
            begins: across(start),
            leaves: across(end),
            from: center,
            turn: Some(turn),
            radius_mm: offset,
        })
    }

    /// The line or the circle beside it.
    fn offset(&self) -> OffsetCurve {
        match self.turn {
            None => OffsetCurve::Line { at: self.from, along: self.begins },
            Some(_) => OffsetCurve::Circle { center: self.from, radius_mm: self.radius_mm },
        }
    }

    /// The angle that the offset arc sweeps between two of its places; `None` where it would run backwards or
    /// leave the arc by more than half a turn.
    pub fn swept(&self, start: Vector2<f64>, end: Vector2<f64>) -> Option<f64> {
        let turn = self.turn?;
        let angle = |place: Vector2<f64>| {
            let seen = place - self.from;
            turn.sense * (seen.y.atan2(seen.x) - turn.start)
        };
        let near = |angle: f64, about: f64| about + (angle - about + PI).rem_euclid(TAU) - PI;
        let swept = near(angle(end), turn.sweep) - near(angle(start), 0.0);
        (swept >= -SAME_ANGLE).then_some(swept.max(0.0))
    }
}

/// The crossing of two offset curves that is nearest to the corner; `None` where they do not cross.
pub fn crossing(first: &Contour, second: &Contour, corner: Vector2<f64>) -> Option<Vector2<f64>> {
    let places = first.offset().crossings(second.offset(), SAME_CHORD);
    places.into_iter().min_by(|a, b| (a - corner).norm().total_cmp(&(b - corner).norm()))
}

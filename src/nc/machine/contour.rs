//! Lines and arcs of a contour in the plane, beside which a cutter goes at the distance of its radius.

use std::f64::consts::{PI, TAU};

use nalgebra::Vector2;
use toolpathd_core::geometry::curve::{Arc, Curve, Direction};
use toolpathd_core::geometry::plane::Plane;

use crate::fault::Fault;

/// Least radius of an offset arc, mm. Below it ends and centre cannot be told apart.
const LEAST_RADIUS_MM: f64 = 1e-6;

/// Part of a turn by which an offset arc may run backwards: rounding of intersections.
const SAME_ANGLE: f64 = 1e-9;

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
    if is_left { Vector2::new(-way.y, way.x) } else { Vector2::new(way.y, -way.x) }
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
    let found = match (first.turn, second.turn) {
        (None, None) => {
            let across = first.begins.perp(&second.begins);
            let along = (second.from - first.from).perp(&second.begins) / across;
            return along.is_finite().then(|| first.from + first.begins * along);
        }
        (None, Some(_)) => of_line_and_circle(first, second),
        (Some(_), None) => of_line_and_circle(second, first),
        (Some(_), Some(_)) => of_circles(first, second),
    }?;
    let [a, b] = found;
    Some(if (a - corner).norm() <= (b - corner).norm() { a } else { b })
}

fn of_line_and_circle(line: &Contour, circle: &Contour) -> Option<[Vector2<f64>; 2]> {
    let way = line.begins;
    let foot = line.from + way * (circle.from - line.from).dot(&way);
    let distance = (foot - circle.from).norm();
    let half = half_chord(circle.radius_mm, distance)?;
    Some([foot - way * half, foot + way * half])
}

fn of_circles(first: &Contour, second: &Contour) -> Option<[Vector2<f64>; 2]> {
    let apart = second.from - first.from;
    let distance = apart.norm();
    if distance < LEAST_RADIUS_MM {
        return None;
    }
    let way = apart / distance;
    let (r, s) = (first.radius_mm, second.radius_mm);
    let along = (distance + (r - s) * (r + s) / distance) / 2.0;
    let half = half_chord(r, along.abs())?;
    let foot = first.from + way * along;
    let across = Vector2::new(-way.y, way.x) * half;
    Some([foot - across, foot + across])
}

/// Half the chord of a circle at a distance from its centre. A chord that misses the circle by rounding has
/// the length zero.
fn half_chord(radius: f64, distance: f64) -> Option<f64> {
    let square = (radius - distance) * (radius + distance);
    (square >= -1e-12 * radius * radius).then(|| square.max(0.0).sqrt())
}

//! Ways of lines and arcs that continue each other.

use std::f64::consts::TAU;

use nalgebra::{Point2, Vector2};

use super::super::chain::ROUNDING_MM;
use crate::geometry::segment::{Segment, left};

/// The sides of a motion: the left and the right.
const SIDES: [f64; 2] = [1.0, -1.0];

/// A smaller turn between two lines stays a corner, radians.
const CORNER: f64 = 0.2;

/// A corner that turns more has no room for an arc, radians: the lines nearly run back.
const STEEPEST: f64 = 2.9;

/// A turn that is this near to a whole one is none, radians.
const WHOLE_TURN: f64 = 1e-7;

/// A place of the cutter's centre with a direction of motion, which has the length 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pose {
    pub at: Point2<f64>,
    pub along: Vector2<f64>,
}

impl Pose {
    /// Turns below this are none, radians: an arc of two cutter radii leaves its chord by a quarter of a
    /// millionth of the cutter's radius there, and the centre of a flatter arc is far away and inexact.
    pub const LEAST_TURN: f64 = 1e-6;

    pub fn before(element: &Segment) -> Self {
        Self { at: element.start(), along: element.direction(0.0) }
    }

    pub fn after(element: &Segment) -> Self {
        Self { at: element.end(), along: element.direction(1.0) }
    }

    /// The centre of the circle of a turn; its radius is positive for a turn to the left, mm.
    pub fn center(&self, radius_mm: f64) -> Point2<f64> {
        self.at + left(self.along) * radius_mm
    }

    /// The arc that begins here; its curvature is positive to the left, 1/mm.
    pub fn arc(&self, curvature: f64, length_mm: f64) -> Segment {
        let turn = curvature * length_mm;
        if turn.abs() < Self::LEAST_TURN {
            return Segment::Line { start: self.at, end: self.at + self.along * length_mm };
        }
        let center = self.center(1.0 / curvature);
        let (sin, cos) = turn.sin_cos();
        let spoke = self.at - center;
        let end = center + Vector2::new(spoke.x * cos - spoke.y * sin, spoke.x * sin + spoke.y * cos);
        Segment::about(center, 1.0 / curvature.abs(), [self.at, end], turn)
    }

    /// The arc that ends here and turns by `turn` radians, at a radius that is positive to the left, mm.
    pub fn lead(&self, radius_mm: f64, turn: f64) -> Segment {
        let center = self.center(radius_mm);
        let spoke = self.at - center;
        let turn = turn * radius_mm.signum();
        let (sin, cos) = (-turn).sin_cos();
        let start = center + Vector2::new(spoke.x * cos - spoke.y * sin, spoke.x * sin + spoke.y * cos);
        Segment::about(center, radius_mm.abs(), [start, self.at], turn)
    }
}

pub fn length(way: &[Segment]) -> f64 {
    way.iter().map(Segment::length).sum()
}

/// The ways along two arcs and the line that touches both, the shortest first.
pub fn direct<const N: usize>(ends: [Pose; 2], radii_mm: [f64; N]) -> Vec<Vec<Segment>> {
    let mut ways = through(ends, &[], radii_mm);
    ways.sort_by(|a, b| length(a).total_cmp(&length(b)));
    ways
}

/// The ways along an arc, through `stops`, and along another arc.
pub fn through<const N: usize>(
    ends: [Pose; 2],
    stops: &[Point2<f64>],
    radii_mm: [f64; N],
) -> Vec<Vec<Segment>> {
    let mut ways = Vec::new();
    for radius in radii_mm {
        for first in SIDES {
            for last in SIDES {
                ways.extend(way(ends, stops, [first * radius, last * radius]));
            }
        }
    }
    ways
}

/// The way with arcs of these radii, which are positive to the left, mm; `None` if a circle is in the way of
/// another or of a stop.
fn way(ends: [Pose; 2], stops: &[Point2<f64>], radii_mm: [f64; 2]) -> Option<Vec<Segment>> {
    let [from, to] = ends;
    let mut circles = vec![(from.center(radii_mm[0]), radii_mm[0])];
    circles.extend(stops.iter().map(|stop| (*stop, 0.0)));
    circles.push((to.center(radii_mm[1]), radii_mm[1]));
    let lines: Vec<[Point2<f64>; 2]> =
        circles.windows(2).map(|pair| tangent(pair[0], pair[1])).collect::<Option<_>>()?;
    let (first, last) = (lines.first()?[0], lines.last()?[1]);
    let mut way = vec![arc(circles[0], [from.at, first])];
    way.extend(rounded(&lines, radii_mm[0].abs())?);
    way.push(arc(circles[circles.len() - 1], [last, to.at]));
    way.retain(|element| element.length() > ROUNDING_MM);
    Some(way)
}

/// The ends of the line that leaves one circle and comes to another. Radii are positive for turns to the
/// left.
fn tangent((first, out): (Point2<f64>, f64), (second, back): (Point2<f64>, f64)) -> Option<[Point2<f64>; 2]> {
    let apart = second - first;
    let along = apart.try_normalize(ROUNDING_MM)?;
    let aside = (out - back) / apart.norm();
    if aside.abs() > 1.0 {
        return None;
    }
    let direction = along * (1.0 - aside * aside).sqrt() + left(along) * aside;
    Some([first - left(direction) * out, second - left(direction) * back])
}

fn arc((center, radius): (Point2<f64>, f64), [start, end]: [Point2<f64>; 2]) -> Segment {
    let (a, b) = (start - center, end - center);
    let sense = radius.signum();
    let turn = (sense * a.perp(&b).atan2(a.dot(&b))).rem_euclid(TAU);
    let turn = if turn > TAU - WHOLE_TURN { turn - TAU } else { turn };
    Segment::about(center, radius.abs(), [start, end], sense * turn)
}

/// Lines that follow each other, with arcs in their corners of at most this radius.
fn rounded(lines: &[[Point2<f64>; 2]], radius_mm: f64) -> Option<Vec<Segment>> {
    let mut way = Vec::new();
    let mut start = lines.first()?[0];
    for pair in lines.windows(2) {
        let corner = pair[0][1];
        let (before, after) = (corner - pair[0][0], pair[1][1] - corner);
        let (Some(a), Some(b)) = (before.try_normalize(ROUNDING_MM), after.try_normalize(ROUNDING_MM)) else {
            continue;
        };
        let turn = a.perp(&b).atan2(a.dot(&b));
        if turn.abs() < CORNER {
            way.push(Segment::Line { start, end: corner });
            start = corner;
            continue;
        }
        if turn.abs() > STEEPEST {
            return None;
        }
        // Half of each line is for the corner at its other end.
        let most = 0.5 * before.norm().min(after.norm());
        let tangent = (0.5 * turn.abs()).tan();
        let cut = most.min(radius_mm * tangent);
        let [leave, meet] = [corner - a * cut, corner + b * cut];
        way.push(Segment::Line { start, end: leave });
        let radius = cut / tangent;
        let center = leave + left(a) * (radius * turn.signum());
        way.push(Segment::about(center, radius, [leave, meet], turn));
        start = meet;
    }
    way.push(Segment::Line { start, end: lines.last()?[1] });
    Some(way)
}

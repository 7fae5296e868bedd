//! Writes the path data of one class of moves in one view, without details below the resolution of the
//! drawing.
//!
//! # Method
//! 1. A curve that differs from its chord by at most [`CHORD_MM`] is drawn as its chord.
//! 2. Consecutive lines become one stroke as long as the stroke passes the ends of all these lines within
//!    [`THIN_MM`]. Seen from its start, the stroke can have any direction in a cone. Each further line
//!    narrows the cone.
//!
//! # Guarantees
//! The drawing differs from the exact curves by less than 0.02 mm of paper. This is more than the sum of
//! [`THIN_MM`], [`CHORD_MM`] and the rounding of coordinates to 0.01 mm.
//!
//! # Cost
//! O(1) for a line or a curve.
//!
//! # Reference
//! J. Sklansky, V. Gonzalez, *Fast polygonal approximation of digitized curves*, Pattern Recognition 12,
//! 1980.

use std::f64::consts::FRAC_PI_2;
use std::fmt::Write;

use nalgebra::{Point2, Vector2};

use super::ink::Ink;
use super::number::{fixed, hundredths};

/// How far a point may lie from the stroke that replaces it, mm of paper.
const THIN_MM: f64 = 0.008;
/// How far a chord may lie from its curve, mm of paper.
pub const CHORD_MM: f64 = 0.004;

/// A part of a circle of at most a quarter turn, mm of paper.
#[derive(Debug, Clone, Copy)]
pub struct Turn {
    pub start: Point2<f64>,
    pub end: Point2<f64>,
    pub center: Point2<f64>,
    pub radius: f64,
    /// Radians; positive in both directions of rotation.
    pub angle: f64,
    /// The direction of rotation as seen on paper.
    pub clockwise: bool,
}

/// The stroke that is not written yet.
#[derive(Debug, Clone, Copy)]
struct OpenStroke {
    anchor: Point2<f64>,
    last: Point2<f64>,
    cone: Option<Cone>,
}

/// The directions from the anchor of all strokes that pass the points so far within the tolerance. `low` and
/// `high` are angles from `first`, radians.
#[derive(Debug, Clone, Copy)]
struct Cone {
    first: Vector2<f64>,
    low: f64,
    high: f64,
}

/// Writes the path data of one class in one view.
#[derive(Debug)]
pub struct Pen {
    data: String,
    run: Option<OpenStroke>,
    /// The written end of the path data, in hundredths of a millimetre.
    at: Option<[i64; 2]>,
    ink: Option<Ink>,
}

impl Pen {
    /// A pen. With a raster, it leaves out strokes whose cells of `raster_mm` are all inked. A stroke then
    /// takes time in proportion to the number of its cells.
    pub fn new(raster_mm: Option<f64>) -> Self {
        Self { data: String::new(), run: None, at: None, ink: raster_mm.map(Ink::new) }
    }

    /// The length of the path data so far, bytes.
    pub fn bytes(&self) -> usize {
        self.data.len()
    }

    /// Draws a line. A line that starts at the end of the last stroke continues its run.
    pub fn line(&mut self, from: Point2<f64>, to: Point2<f64>) {
        let Some(run) = self.run.filter(|run| run.last == from) else {
            self.end_run();
            self.run = Some(OpenStroke::new(from, to));
            return;
        };
        self.run = Some(run.through(to).unwrap_or_else(|| {
            self.write_line(run.anchor, run.last);
            OpenStroke::new(run.last, to)
        }));
    }

    /// Draws a part of a circle. Draws its chord instead where the difference cannot be seen.
    pub fn turn(&mut self, turn: &Turn) {
        if turn.radius * (1.0 - (0.5 * turn.angle).cos()) <= CHORD_MM {
            return self.line(turn.start, turn.end);
        }
        self.end_run();
        self.write_turn(turn);
    }

    /// Draws a quadratic Bezier curve. Draws its chord instead where the difference cannot be seen.
    pub fn quadratic(&mut self, points: [Point2<f64>; 3]) {
        let [start, control, end] = points;
        if ((start - control) + (end - control)).norm() <= 4.0 * CHORD_MM {
            return self.line(start, end);
        }
        self.end_run();
        self.write_quadratic(points);
    }

    /// The path data.
    pub fn finish(mut self) -> String {
        self.end_run();
        self.data
    }

    fn end_run(&mut self) {
        if let Some(run) = self.run.take() {
            self.write_line(run.anchor, run.last);
        }
    }

    fn write_line(&mut self, from: Point2<f64>, to: Point2<f64>) {
        let along = to - from;
        if self.ink.as_mut().is_some_and(|ink| ink.covers(along.norm(), |t| from + along * t)) {
            return;
        }
        let continues = self.move_to(from);
        if written(to) != written(from) {
            self.push('L', to);
        } else if !continues {
            // A dot; the round ends of strokes make it visible.
            self.data.push_str("h0");
        }
    }

    fn write_turn(&mut self, turn: &Turn) {
        let arm = turn.start - turn.center;
        let sense = if turn.clockwise { 1.0 } else { -1.0 };
        let point = |t: f64| {
            // The y axis of paper points down, so a growing angle turns clockwise.
            turn.center + nalgebra::Rotation2::new(sense * turn.angle * t) * arm
        };
        if self.ink.as_mut().is_some_and(|ink| ink.covers(turn.angle * turn.radius, point)) {
            return;
        }
        self.move_to(turn.start);
        let radius = fixed(turn.radius);
        // Writing to a string cannot fail.
        let _ = write!(self.data, "A{radius} {radius} 0 0 {} ", u8::from(turn.clockwise));
        self.push_point(turn.end);
    }

    fn write_quadratic(&mut self, [start, control, end]: [Point2<f64>; 3]) {
        let (first, second) = (control - start, end - control);
        let point = |t: f64| start + first * (2.0 * t * (1.0 - t)) + (end - start) * (t * t);
        // An upper bound of the curve's speed: points at parameters a distance t apart are at most t times
        // this apart.
        let longest = 2.0 * first.norm().max(second.norm());
        if self.ink.as_mut().is_some_and(|ink| ink.covers(longest, point)) {
            return;
        }
        self.move_to(start);
        self.push('Q', control);
        self.data.push(' ');
        self.push_point(end);
    }

    /// Starts a stroke at `from`. `true` if the stroke continues the path data.
    fn move_to(&mut self, from: Point2<f64>) -> bool {
        let continues = self.at == Some(written(from));
        if !continues {
            self.push('M', from);
        }
        continues
    }

    fn push(&mut self, command: char, to: Point2<f64>) {
        self.data.push(command);
        self.push_point(to);
    }

    fn push_point(&mut self, to: Point2<f64>) {
        self.data.push_str(&fixed(to.x));
        self.data.push(' ');
        self.data.push_str(&fixed(to.y));
        self.at = Some(written(to));
    }
}

impl OpenStroke {
    fn new(anchor: Point2<f64>, to: Point2<f64>) -> Self {
        let arm = to - anchor;
        let distance = arm.norm();
        // While `to` is this near to the anchor, a stroke in any direction passes it within the tolerance.
        let cone = (distance > THIN_MM).then(|| Cone::around(arm, distance));
        Self { anchor, last: to, cone }
    }

    /// The run continued to `to`; `None` if one stroke cannot replace it. It can if `to` lies in the cone and
    /// is not nearer to the anchor than the last point.
    fn through(&self, to: Point2<f64>) -> Option<OpenStroke> {
        let Some(cone) = self.cone else { return Some(OpenStroke::new(self.anchor, to)) };
        let (reach, arm) = ((self.last - self.anchor).norm(), to - self.anchor);
        let distance = arm.norm();
        let angle = cone.first.perp(&arm).atan2(cone.first.dot(&arm));
        if distance < reach || angle < cone.low || angle > cone.high {
            return None;
        }
        let half = half_angle(distance);
        let cone = Cone { low: cone.low.max(angle - half), high: cone.high.min(angle + half), ..cone };
        Some(OpenStroke { last: to, cone: Some(cone), ..*self })
    }
}

impl Cone {
    fn around(arm: Vector2<f64>, distance: f64) -> Self {
        let half = half_angle(distance);
        Self { first: arm, low: -half, high: half }
    }
}

/// Half the angle of the tolerance, seen from the anchor at this distance, radians.
fn half_angle(distance: f64) -> f64 {
    (THIN_MM / distance).min(1.0).asin().min(FRAC_PI_2)
}

/// The coordinates of a point as written, in hundredths of a millimetre.
fn written(point: Point2<f64>) -> [i64; 2] {
    [hundredths(point.x), hundredths(point.y)]
}

//! One view: projects points and curves of the workpiece to strokes on paper.

use std::f64::consts::{FRAC_PI_2, PI};

use nalgebra::{Point2, Point3};

use super::pen::{CHORD_MM, Pen, Turn};
use toolpathd_core::geometry::curve::{Arc, Curve, Direction};
use toolpathd_core::geometry::flatten::flatten;
use toolpathd_core::geometry::plane::Plane;
use toolpathd_core::toolpath::measure::Bounds;

/// The largest sweep of a piece: a quarter turn. The excess keeps rounding from adding a piece.
const PIECE: f64 = FRAC_PI_2 * (1.0 + 1e-9);

/// Most chords of a helix. A full turn as wide as the sheet takes some 400.
const MAX_CHORDS: usize = 10_000;

/// A parallel projection along an axis, onto a frame on the sheet. Paper's y grows downward.
#[derive(Debug, Clone)]
pub struct View {
    pub id: &'static str,
    pub name: &'static str,
    /// The axes of the workpiece that point to the right and upward.
    pub axes: [usize; 2],
    /// Left, top, width and height, mm of paper.
    pub frame: [f64; 4],
    scale: f64,
    /// The coordinates of the middle of the bounds. The middle of the frame shows this point.
    middle: [f64; 2],
}

/// How a view sees a plane.
enum Facing {
    Front,
    /// The view sees the back of the plane, so the direction of rotation is reversed.
    Back,
    /// The view sees the plane edge-on; the number is the local axis of the plane that stays visible.
    Edge(usize),
}

impl View {
    pub fn new(
        id: &'static str,
        name: &'static str,
        axes: [usize; 2],
        frame: [f64; 4],
        bounds: &Bounds,
        scale: f64,
    ) -> Self {
        let middle = axes.map(|axis| 0.5 * (bounds.min[axis] + bounds.max[axis]));
        Self { id, name, axes, frame, scale, middle }
    }

    /// The place of a point of the workpiece on paper, mm.
    pub fn project(&self, p: &Point3<f64>) -> Point2<f64> {
        let [left, top, width, height] = self.frame;
        let [right, up] = self.axes;
        Point2::new(
            left + 0.5 * width + (p[right] - self.middle[0]) * self.scale,
            top + 0.5 * height - (p[up] - self.middle[1]) * self.scale,
        )
    }

    /// The range of values that the frame shows along its `side` (0: to the right, 1: upward), mm of the
    /// workpiece.
    pub fn span(&self, side: usize) -> [f64; 2] {
        let half = 0.5 * self.frame[2 + side] / self.scale;
        [self.middle[side] - half, self.middle[side] + half]
    }

    /// Millimetres of paper for one millimetre of the workpiece.
    pub fn scale(&self) -> f64 {
        self.scale
    }

    /// Draws a curve with `pen`.
    pub fn trace(&self, curve: &Curve, pen: &mut Pen) {
        match curve {
            Curve::Line(line) => pen.line(self.project(&line.start), self.project(&line.end)),
            Curve::Arc(arc) => self.trace_arc(arc, pen),
            // A parallel projection of a Bezier curve is the Bezier curve of the projected control points.
            Curve::Parabola(parabola) => pen
                .quadratic([parabola.start(), parabola.control(), parabola.end()].map(|p| self.project(&p))),
        }
    }

    fn trace_arc(&self, arc: &Arc, pen: &mut Pen) {
        match self.facing(arc.plane()) {
            Facing::Front => self.trace_round(arc, arc.direction() == Direction::Cw, pen),
            Facing::Back => self.trace_round(arc, arc.direction() == Direction::Ccw, pen),
            Facing::Edge(local) if arc.rise() == 0.0 => {
                let extremes = [0.0, PI].map(|angle| arc.fraction_of_angle(angle + FRAC_PI_2 * local as f64));
                let mut fractions: Vec<f64> = extremes.into_iter().flatten().chain([0.0, 1.0]).collect();
                fractions.sort_by(f64::total_cmp);
                self.trace_chords(fractions.into_iter().map(|t| arc.point_at(t)), pen);
            }
            Facing::Edge(_) => {
                let chords = flatten(&Curve::Arc(*arc), CHORD_MM / self.scale, MAX_CHORDS);
                let points = chords.unwrap_or_else(|_| vec![arc.start(), arc.end()]);
                self.trace_chords(points.into_iter(), pen);
            }
        }
    }

    /// Draws an arc in a view that faces its plane. A helix looks like an arc there.
    fn trace_round(&self, arc: &Arc, clockwise: bool, pen: &mut Pen) {
        let pieces = (arc.sweep() / PIECE).ceil().max(1.0);
        let at = |piece: f64| self.project(&arc.point_at(piece / pieces));
        for k in 0..pieces as usize {
            pen.turn(&Turn {
                start: at(k as f64),
                end: at(k as f64 + 1.0),
                center: self.project(&arc.center()),
                radius: arc.radius() * self.scale,
                angle: arc.sweep() / pieces,
                clockwise,
            });
        }
    }

    fn trace_chords(&self, points: impl Iterator<Item = Point3<f64>>, pen: &mut Pen) {
        let mut points = points.map(|point| self.project(&point));
        let Some(mut from) = points.next() else { return };
        for to in points {
            pen.line(from, to);
            from = to;
        }
    }

    fn facing(&self, plane: Plane) -> Facing {
        let [first, second, normal] = plane.axes();
        if self.axes == [first, second] {
            Facing::Front
        } else if self.axes == [second, first] {
            Facing::Back
        } else {
            let seen = if self.axes[0] == normal { self.axes[1] } else { self.axes[0] };
            Facing::Edge(usize::from(seen == second))
        }
    }
}

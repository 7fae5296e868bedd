//! Rounds curves to the decimals of the output. The rounded curves are those that a program will state. A
//! *step* is one unit of the last decimal.
//!
//! The rounded ends of an arc are in general not equally far from its rounded centre. These two distances are
//! the *radii* of the arc. A control may run the arc at either radius, or at one between them.
//!
//! # Method
//! 1. Round each end point of each curve by itself. Two curves that meet in a point still meet after
//!    rounding.
//! 2. For an arc, choose the best of nine centres whose coordinates can be written (`candidate`). For a
//!    parabola, round the three control points (`parabola`).
//! 3. If the rounded arc or parabola does not give the guarantees below, divide the given curve in two, and
//!    treat each half from item 1 on, as often as needed.
//! 4. Write lines in place of a curve that is flatter than half a step, or that the control cannot run.
//!
//! # Guarantees
//! * Every path that a control may run for a written curve has a Frechet distance of at most
//!   [`MAX_DISPLACEMENT_STEPS`] steps from the part of the given curve that it replaces. Each written curve
//!   states its own bound of this distance.
//! * The two radii of a written arc differ by at most [`MAX_MISMATCH_STEPS`] steps, and by no more than
//!   [`Curves::radius_mismatch_mm`]. Ends and centre keep the rules of the control ([`Curves::accepts`]).
//! * A control that runs an arc about a centre of its own is one of those controls: its path, too, keeps the
//!   bound of the distance.
//! * A full circle is written only if the given curve is a full circle. A line whose ends round to the same
//!   point is left out.
//!
//! A given curve that needs more than [`MAX_PIECES`] written curves is refused.
//!
//! # Cost
//! O(1) for nearly every curve. An arc of a radius above [`Curves::largest_radius_mm`] needs O(sqrt(radius /
//! step)) lines.

mod biarcs;
pub(super) mod bound;
mod candidate;
mod curves;
mod parabola;

use nalgebra::Point3;

pub use self::curves::{Arcs, Curves, Parabolas};
use super::program::Resolution;
use crate::geometry::curve::{Arc, Curve, Line};

/// Largest distance between a written curve and its source, in units of the last decimal.
pub const MAX_DISPLACEMENT_STEPS: f64 = 1.5;

/// The largest difference of the radii at a written arc's ends, in units of the last decimal. The best of the
/// nine centres is within it for nearly all arcs; the others are split.
pub const MAX_MISMATCH_STEPS: f64 = 1.0;

/// Arcs flatter than this, in units of the last decimal, are written as lines: rounding could turn them over,
/// or into a full circle.
pub const MIN_SAGITTA_STEPS: f64 = 0.5;

/// Arcs of smaller radius, mm, are written as lines. LinuxCNC refuses radii under 0.00005 inch (0.00127 mm)
/// as zero, and other controls lose as much in rounding.
const LEAST_RADIUS_MM: f64 = 0.0013;

/// Largest number of curves written for one curve. The chords of a full circle of radius 1 km at three
/// decimals are half as many.
pub const MAX_PIECES: usize = 200_000;

/// Largest coordinate, in steps. Up to it the products of two coordinates fit their integers.
const MAX_UNITS: f64 = 1e15;

/// Largest bound that is accepted, in steps. The rest is for lengths that were themselves computed with
/// rounding.
const ACCEPTED_STEPS: f64 = MAX_DISPLACEMENT_STEPS - 0.01;

/// One curve as it will be written.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Written {
    /// The exact curve: its ends lie on the grid, as does a parabola's control point, and an arc's centre is
    /// the point nearest to the written one from which both ends are equally far.
    pub curve: Curve,
    /// The end in units of the last decimal.
    pub end_units: [i64; 3],
    pub form: Form,
    /// Difference of the written radii at the two ends, mm.
    pub radius_mismatch_mm: f64,
    /// Upper bound of the distance between `curve` and any path that a control may run for the block, mm,
    /// both ways. For an arc this is any path about the written centre, with a radius anywhere between those
    /// at the ends. For a parabola it is the arcs that the control runs instead.
    pub slack_mm: f64,
    /// Upper bound of the distance of the source from `curve`, and from any path that a control may run for
    /// the block, mm, both ways and in order.
    pub displacement_mm: f64,
}

/// The words of a block besides the end of its curve: a point along two axes, in units of the last decimal
/// from the start.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Form {
    Line,
    /// The centre, along the first and the second axis of the arc's plane.
    Arc {
        center: [i64; 2],
    },
    /// The Bezier control point, along x and y.
    Parabola {
        control: [i64; 2],
    },
}

/// Why a curve cannot be written.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum QuantizeError {
    #[error("{value_mm} mm is too large for the number of decimals; use fewer decimals")]
    OutOfRange { value_mm: f64 },
    #[error("a curve needs more than {limit} blocks with this number of decimals; use fewer decimals")]
    TooManyPieces { limit: usize },
}

/// The points whose coordinates can be written.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Grid {
    unit_mm: f64,
    per_unit: f64,
}

impl Grid {
    pub fn new(resolution: Resolution) -> Self {
        Self { unit_mm: resolution.units.mm(), per_unit: 10f64.powi(i32::from(resolution.decimals)) }
    }

    /// One unit of the last decimal, mm.
    pub fn step_mm(&self) -> f64 {
        self.unit_mm / self.per_unit
    }

    /// One unit of the program, mm.
    pub fn unit_mm(&self) -> f64 {
        self.unit_mm
    }

    /// The nearest number of steps.
    ///
    /// # Errors
    /// When the number would be too large, or is not a number.
    pub fn units(&self, value_mm: f64) -> Result<i64, QuantizeError> {
        let units = (value_mm / self.unit_mm * self.per_unit).round();
        if units.abs() <= MAX_UNITS { Ok(units as i64) } else { Err(QuantizeError::OutOfRange { value_mm }) }
    }

    /// The nearest point of the grid, in steps.
    ///
    /// # Errors
    /// As [`Grid::units`].
    pub fn round(&self, p: &Point3<f64>) -> Result<[i64; 3], QuantizeError> {
        Ok([self.units(p.x)?, self.units(p.y)?, self.units(p.z)?])
    }

    /// A number of steps in mm.
    pub fn mm(&self, units: i64) -> f64 {
        units as f64 / self.per_unit * self.unit_mm
    }

    /// The point of the grid, mm.
    pub fn point(&self, units: [i64; 3]) -> Point3<f64> {
        Point3::from(units.map(|k| self.mm(k)))
    }
}

/// The curves that will be written for one curve.
#[derive(Debug, Clone, PartialEq)]
pub struct Rounded {
    /// In order; none where the curve vanishes on the grid.
    pub curves: Vec<Written>,
    /// Upper bound of the distance of the source from every path that a control may run for it, mm, both
    /// ways. It covers the curves, and the distance of parts that vanish from the point to which they vanish.
    pub displacement_mm: f64,
}

/// The curves that will be written for `curve`, in order; none where it vanishes on the grid.
///
/// # Errors
/// When a coordinate has no place on the grid, or too many pieces are needed.
pub fn quantize(
    curve: &Curve,
    resolution: Resolution,
    curves: &Curves,
) -> Result<Vec<Written>, QuantizeError> {
    round(curve, resolution, curves).map(|rounded| rounded.curves)
}

/// As [`quantize`], with the bound for the whole curve.
///
/// # Errors
/// As [`quantize`].
pub fn round(curve: &Curve, resolution: Resolution, curves: &Curves) -> Result<Rounded, QuantizeError> {
    let mut output = Output {
        grid: Grid::new(resolution),
        runs: curves,
        curves: Vec::with_capacity(1),
        displacement_mm: 0.0,
    };
    match curve {
        Curve::Line(line) => output.line(&line.start, &line.end, 0.0)?,
        Curve::Arc(arc) => output.arc(arc)?,
        Curve::Parabola(source) => parabola::write(&mut output, source)?,
    }
    Ok(Rounded { curves: output.curves, displacement_mm: output.displacement_mm })
}

impl Written {
    /// Whether the radius is so small that a control may take it for zero.
    fn is_too_small(&self) -> bool {
        match &self.curve {
            Curve::Arc(arc) => arc.radius() - self.radius_mismatch_mm < LEAST_RADIUS_MM,
            Curve::Line(_) | Curve::Parabola(_) => false,
        }
    }
}

/// A part of the source arc between two fractions of its length.
#[derive(Clone, Copy)]
struct ArcPart<'a> {
    arc: &'a Arc,
    from: f64,
    to: f64,
}

impl ArcPart<'_> {
    fn start(&self) -> Point3<f64> {
        self.arc.point_at(self.from)
    }

    fn end(&self) -> Point3<f64> {
        self.arc.point_at(self.to)
    }

    fn sweep(&self) -> f64 {
        self.arc.sweep() * (self.to - self.from)
    }

    fn is_full_turn(&self) -> bool {
        let [a, b, _] = self.arc.plane().axes();
        let (s, e) = (self.arc.start(), self.arc.end());
        self.from == 0.0 && self.to == 1.0 && s[a] == e[a] && s[b] == e[b]
    }

    /// Height of the arc over its chord, mm.
    fn sagitta(&self) -> f64 {
        2.0 * self.arc.radius() * (self.sweep() / 4.0).sin().powi(2)
    }

    /// Bound of the distance from the piece to its chord, mm, compared at equal fractions; for sweeps up to
    /// half a turn.
    ///
    /// Along the chord the point of the arc runs ahead by r |sin(u a) - u sin a| <= r a^3 (u - u^3) / 6 <=
    /// 0.0642 r a^3, where a is half the sweep and u is in 0..=1.
    fn chord_distance(&self) -> f64 {
        self.sagitta().hypot(0.0642 * self.arc.radius() * (self.sweep() / 2.0).powi(3))
    }
}

/// The curves written so far for one curve.
struct Output<'a> {
    grid: Grid,
    /// What the control runs.
    runs: &'a Curves,
    curves: Vec<Written>,
    displacement_mm: f64,
}

impl Output<'_> {
    fn arc(&mut self, arc: &Arc) -> Result<(), QuantizeError> {
        let step = self.grid.step_mm();
        let mut open = vec![ArcPart { arc, from: 0.0, to: 1.0 }];
        while let Some(piece) = open.pop() {
            if self.curves.len() + open.len() >= MAX_PIECES {
                return Err(QuantizeError::TooManyPieces { limit: MAX_PIECES });
            }
            if piece.sweep() <= std::f64::consts::PI && piece.sagitta() < MIN_SAGITTA_STEPS * step {
                self.line(&piece.start(), &piece.end(), piece.chord_distance())?;
            } else if !self.runs.run(arc, step) || arc.radius() < LEAST_RADIUS_MM {
                self.chords(&piece)?;
            } else {
                match candidate::best(&piece, &self.grid, self.runs)? {
                    Some(block) if block.is_too_small() => self.chords(&piece)?,
                    Some(block) => self.push(block),
                    None => {
                        let middle = (piece.from + piece.to) / 2.0;
                        open.push(ArcPart { from: middle, ..piece });
                        open.push(ArcPart { to: middle, ..piece });
                    }
                }
            }
        }
        Ok(())
    }

    /// Writes lines along a piece. Before its ends are rounded, each line is no farther from the piece than
    /// half a step.
    fn chords(&mut self, piece: &ArcPart) -> Result<(), QuantizeError> {
        let sagitta = MIN_SAGITTA_STEPS * self.grid.step_mm();
        // At most half a turn each.
        let part = (sagitta / (2.0 * piece.arc.radius())).min(0.5);
        let half_angle = 2.0 * part.sqrt().asin();
        let count = (piece.sweep() / (2.0 * half_angle)).ceil().max(1.0);
        if count > MAX_PIECES as f64 {
            return Err(QuantizeError::TooManyPieces { limit: MAX_PIECES });
        }
        let at =
            |k: f64| if k == count { piece.to } else { piece.from + (piece.to - piece.from) * (k / count) };
        for k in 0..count as usize {
            let chord = ArcPart { from: at(k as f64), to: at(k as f64 + 1.0), ..*piece };
            self.line(&chord.start(), &chord.end(), chord.chord_distance())?;
        }
        Ok(())
    }

    /// Writes the line between the rounded points, or nothing where they coincide. `added_mm` is the distance
    /// from the source to the line between the points before rounding.
    fn line(&mut self, start: &Point3<f64>, end: &Point3<f64>, added_mm: f64) -> Result<(), QuantizeError> {
        let (from, to) = (self.grid.round(start)?, self.grid.round(end)?);
        let line = Line { start: self.grid.point(from), end: self.grid.point(to) };
        let displacement_mm = (line.start - start).norm().max((line.end - end).norm()) + added_mm;
        if from == to {
            self.displacement_mm = self.displacement_mm.max(displacement_mm);
            return Ok(());
        }
        self.push(Written {
            curve: Curve::Line(line),
            end_units: to,
            form: Form::Line,
            radius_mismatch_mm: 0.0,
            slack_mm: 0.0,
            displacement_mm,
        });
        Ok(())
    }

    fn push(&mut self, written: Written) {
        self.displacement_mm = self.displacement_mm.max(written.displacement_mm);
        self.curves.push(written);
    }
}

#[cfg(test)]
mod tests;

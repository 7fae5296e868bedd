//! Writes a parabola as one spline block or several, or as lines. It becomes lines if it is almost straight,
//! if its height changes along it, or if the control has no spline blocks.
//!
//! # Method
//! 1. Round each of the three control points by itself. No point of the parabola moves farther than the
//!    control point that moves most.
//! 2. Bound the distance between the rounded parabola and the path that the control runs for the block. This
//!    path may consist of arcs (`biarcs`).
//! 3. Add the largest distance by which step 1 moved a control point, and the bound of step 2. If the sum
//!    exceeds [`ACCEPTED_STEPS`] units of the last decimal, divide the parabola before rounding in two, and
//!    do all steps for each half.

use nalgebra::Vector2;

use super::{
    ACCEPTED_STEPS, Form, Grid, MAX_PIECES, MIN_SAGITTA_STEPS, Output, Parabolas, QuantizeError, Written,
    biarcs,
};
use crate::geometry::curve::{Curve, Parabola};

/// Writes `parabola`.
pub fn write(output: &mut Output, parabola: &Parabola) -> Result<(), QuantizeError> {
    let grid = output.grid;
    let heights = [parabola.start().z, parabola.control().z, parabola.end().z];
    let [from, between, to] = heights.map(|z| grid.units(z));
    let is_block = output.runs.parabolas == Parabolas::InXy && from? == between? && from? == to?;
    let mut open = vec![[0.0, 1.0]];
    while let Some([from, to]) = open.pop() {
        if output.curves.len() + open.len() >= MAX_PIECES {
            return Err(QuantizeError::TooManyPieces { limit: MAX_PIECES });
        }
        let piece = parabola.part(from, to);
        if let Some(distance_mm) = flat(&piece, MIN_SAGITTA_STEPS * grid.step_mm()) {
            output.line(&piece.start(), &piece.end(), distance_mm)?;
        } else if !is_block {
            chords(output, &piece)?;
        } else {
            match block(&piece, &grid)? {
                Attempt::Written(written) => output.push(written),
                Attempt::TooStraight => chords(output, &piece)?,
                Attempt::TooFar => {
                    let middle = (from + to) / 2.0;
                    open.push([middle, to]);
                    open.push([from, middle]);
                }
            }
        }
    }
    Ok(())
}

/// Bound of the distance between a parabola and its chord, mm, both ways and in order; `None` unless it is
/// below `limit_mm`.
fn flat(parabola: &Parabola, limit_mm: f64) -> Option<f64> {
    let (to_control, chord) = (parabola.control() - parabola.start(), parabola.end() - parabola.start());
    let along = chord.try_normalize(0.0).map(|along| (along, to_control.dot(&along)));
    if let Some((direction, along)) = along.filter(|(_, along)| (0.0..=chord.norm()).contains(along)) {
        // The parabola does not turn back along its chord, and its height is half that of the control point.
        let height = (to_control - direction * along).norm() / 2.0;
        return Some(height).filter(|height| *height < limit_mm);
    }
    // At equal fractions of their lengths, a curve and its chord are no farther apart than half the curve's
    // length.
    let half = (to_control.norm() + (parabola.end() - parabola.control()).norm()) / 2.0;
    Some(half).filter(|half| *half < limit_mm)
}

/// Writes lines along a parabola. Before its ends are rounded, each line is no farther from the parabola than
/// half a step.
fn chords(output: &mut Output, parabola: &Parabola) -> Result<(), QuantizeError> {
    let height = parabola.bend().norm() / 4.0;
    let count = (height / (MIN_SAGITTA_STEPS * output.grid.step_mm())).sqrt().ceil().max(1.0);
    if output.curves.len() as f64 + count > MAX_PIECES as f64 {
        return Err(QuantizeError::TooManyPieces { limit: MAX_PIECES });
    }
    for k in 0..count as usize {
        let at = |k: usize| parabola.at(k as f64 / count);
        output.line(&at(k), &at(k + 1), height / (count * count))?;
    }
    Ok(())
}

/// The outcome of writing a parabola as one block.
enum Attempt {
    Written(Written),
    TooFar,
    /// A control may fail on the block, and dividing the parabola makes its parts straighter still.
    TooStraight,
}

fn block(piece: &Parabola, grid: &Grid) -> Result<Attempt, QuantizeError> {
    let source = [piece.start(), piece.control(), piece.end()];
    let [start, control, end] = source.map(|p| grid.round(&p));
    let units = [start?, control?, end?];
    let points = units.map(|units| grid.point(units));
    let moved = points.iter().zip(&source).map(|(p, q)| (p - q).norm()).fold(0.0, f64::max);
    let offset = |to: [i64; 3]| [to[0] - units[0][0], to[1] - units[0][1]];
    let mm = |to: [i64; 3]| Vector2::from(offset(to).map(|units| grid.mm(units)));
    let reach = points.iter().map(|p| p.coords.amax()).fold(0.0, f64::max);
    let slack_mm = match biarcs::distance(&mm(units[1]), &mm(units[2]), reach, grid.unit_mm()) {
        Ok(slack_mm) => slack_mm,
        Err(biarcs::NotRun::TooStraight) => return Ok(Attempt::TooStraight),
        Err(biarcs::NotRun::TurnsTooFar) => return Ok(Attempt::TooFar),
    };
    let displacement_mm = moved + slack_mm;
    let [start, control, end] = points;
    let Ok(curve) = Parabola::new(start, control, end) else { return Ok(Attempt::TooFar) };
    if displacement_mm > ACCEPTED_STEPS * grid.step_mm() {
        return Ok(Attempt::TooFar);
    }
    Ok(Attempt::Written(Written {
        curve: Curve::Parabola(curve),
        end_units: units[2],
        form: Form::Parabola { control: offset(units[1]) },
        radius_mismatch_mm: 0.0,
        slack_mm,
        displacement_mm,
    }))
}

//! A pass of a toolpath.

use nalgebra::Point3;

use super::{Cycle, Move, Rail, ToolAxes};

/// A connected run of moves, optionally on a level.
#[derive(Debug, Clone, PartialEq)]
pub struct Pass {
    pub(super) level: Option<u32>,
    /// Where the pass starts, if it does not start where the pass before ends.
    pub(super) start: Option<Point3<f64>>,
    pub(super) moves: Vec<Move>,
    pub(super) axes: ToolAxes,
    pub(super) rails: Vec<Rail>,
    pub(super) cycles: Vec<Cycle>,
    pub(super) rotary: Option<RotaryPositions>,
}

/// The positions of the two rotary axes of a machine along a pass, radians. They may count turns. During a
/// move both turn in step with the length of the way.
#[derive(Debug, Clone, PartialEq)]
pub struct RotaryPositions {
    pub start: [f64; 2],
    /// At the end of each move.
    pub ends: Vec<[f64; 2]>,
}

impl Pass {
    pub fn level(&self) -> Option<u32> {
        self.level
    }

    pub fn moves(&self) -> &[Move] {
        &self.moves
    }

    /// Where the tip stands before the first move of the pass, if that is not where the pass before ended:
    /// the tool came there on a way that is not known.
    pub fn start(&self) -> Option<Point3<f64>> {
        self.start
    }

    /// The tool axis. Where it differs from the axis at the end of the pass before, the tool turns about its
    /// resting tip between the passes.
    pub fn axes(&self) -> &ToolAxes {
        &self.axes
    }

    /// Polynomials that stand for moves of the pass, in order and without overlap. Most passes have none.
    pub fn rails(&self) -> &[Rail] {
        &self.rails
    }

    /// Canned cycles that stand for moves of the pass, in order and without overlap.
    pub fn cycles(&self) -> &[Cycle] {
        &self.cycles
    }

    /// The moves for which no canned cycle stands.
    pub fn moves_outside_cycles(&self) -> impl Iterator<Item = &Move> {
        let mut cycles = self.cycles.iter().peekable();
        let mut is_outside = move |k: usize| {
            while cycles.next_if(|cycle| cycle.moves.end <= k).is_some() {}
            cycles.peek().is_none_or(|cycle| k < cycle.moves.start)
        };
        self.moves.iter().enumerate().filter(move |(k, _)| is_outside(*k)).map(|(_, step)| step)
    }

    /// The positions of the rotary axes, where the toolpath was made for a machine.
    pub fn rotary(&self) -> Option<&RotaryPositions> {
        self.rotary.as_ref()
    }
}

//! The moves that a toolpath in a request may hold: every kind of move that answers hold, and canned cycles.
//! Answers never hold a canned cycle, so their moves are another type.

use super::cycle_move::CycleMove;
use crate::http::decode::tagged::by_kind;
use crate::http::dto::moves::{ArcMove, DwellMove, LineMove, ParabolaMove, RapidMove, TurnMove};
use crate::http::dto::point::Coordinates;

by_kind! {
    /// One move of the tool's tip; `kind` says which. The move starts where the move before ended.
    #[derive(Debug, Clone, PartialEq)]
    SentMove {
        "rapid" => Rapid(RapidMove),
        "line" => Line(LineMove),
        "arc" => Arc(ArcMove),
        "parabola" => Parabola(ParabolaMove),
        "turn" => Turn(TurnMove),
        "dwell" => Dwell(DwellMove),
        "cycle" => Cycle(CycleMove),
    }
}

impl SentMove {
    /// The number of moves of the toolpath, at most.
    pub fn count(&self) -> usize {
        if let Self::Cycle(cycle) = self { cycle.n_moves() } else { 1 }
    }

    /// The tool axis at its end, where the move states it.
    pub fn axis(&self) -> Option<Coordinates<3>> {
        match self {
            Self::Rapid(RapidMove { axis, .. })
            | Self::Line(LineMove { axis, .. })
            | Self::Arc(ArcMove { axis, .. })
            | Self::Parabola(ParabolaMove { axis, .. }) => *axis,
            Self::Turn(TurnMove { axis, .. }) => Some(*axis),
            Self::Dwell(_) | Self::Cycle(_) => None,
        }
    }
}

//! What was sent of a program that was not sent to its end.

use serde::Serialize;
use utoipa::ToSchema;

use crate::dnc::{Left, Outcome};

/// What the control was left with.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum ControlState {
    /// The control has nothing of the program.
    Nothing,
    /// The control has the whole program.
    WholeProgram,
    /// The control has whole blocks, and after them the end mark `%`.
    BlocksAndEndMark,
    /// The control has whole blocks and waits for more. Reset the control.
    Blocks,
    /// The control may have a part of a block. Reset the control before the next program.
    HalfBlock,
    /// GRBL was reset after a feed hold. Its buffers are empty.
    Reset,
    /// GRBL was told to hold and to reset, but did not confirm. Look at the machine.
    ResetUnconfirmed,
    /// Something else has reset GRBL. Home the machine before the next program.
    Restarted,
}

impl From<Left> for ControlState {
    fn from(left: Left) -> Self {
        match left {
            Left::Nothing => Self::Nothing,
            Left::Whole => Self::WholeProgram,
            Left::Blocks { has_end_mark: true, .. } => Self::BlocksAndEndMark,
            Left::Blocks { has_end_mark: false, .. } => Self::Blocks,
            Left::HalfBlock { .. } => Self::HalfBlock,
            Left::Reset { is_confirmed: true } => Self::Reset,
            Left::Reset { is_confirmed: false } => Self::ResetUnconfirmed,
            Left::Restarted => Self::Restarted,
        }
    }
}

/// What was sent of a program before the sending ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, ToSchema)]
pub struct SentPart {
    /// Number of whole lines of the program that were sent for certain; with GRBL, that GRBL has answered.
    #[schema(minimum = 0)]
    n_lines: usize,
    /// Number of characters that were sent for certain, with leader and `%`.
    #[schema(minimum = 0)]
    n_characters: usize,
    /// What the control was left with: `nothing` of the program, the `whole_program`, whole blocks with the
    /// end mark `%` after them (`blocks_and_end_mark`), whole `blocks` after which the control waits for
    /// more, or perhaps a part of a block (`half_block`). With `blocks` and `half_block`, reset the control
    /// before the next program. `reset`: GRBL was reset after a feed hold. `reset_unconfirmed`: GRBL was told
    /// to hold and to reset, but did not confirm; look at the machine. `restarted`: something else has reset
    /// GRBL; home the machine.
    control: ControlState,
}

impl From<&Outcome> for SentPart {
    fn from(outcome: &Outcome) -> Self {
        Self {
            n_lines: outcome.progress.n_lines,
            n_characters: outcome.progress.n_characters,
            control: outcome.left.into(),
        }
    }
}

//! Calls of programs that a block does not name at its start: MCALL of a program, and CALL with a text.
//!
//! # Method
//! A program that MCALL names runs behind each block that moves, at the level of calls where MCALL stands.
//! Its own moves do not call it. Whether the moves of other programs do is not certain, and refused.

use std::ops::Range;

use super::Execution;
use super::text::{blanks, comment_start, name_at};
use super::values::Value;
use crate::block::Line;
use crate::fault::Fault;

/// A program that runs behind each block that moves.
#[derive(Debug, Clone)]
pub struct ModalProgram {
    within: Range<usize>,
    arguments: Vec<Option<Value>>,
    /// The number of calls under way where MCALL stands.
    depth: usize,
    /// The program runs.
    is_running: bool,
}

impl<'a> Execution<'a, '_> {
    /// MCALL with a program of the text.
    pub(super) fn begin_modal_program(
        &mut self,
        line: Line<'a>,
        name: &str,
        arguments: Vec<Option<Value>>,
        [at, end]: [usize; 2],
    ) {
        let Some(within) = self.text.program(name) else {
            return self.stop(line.refusal(at, end, Fault::NotRead));
        };
        self.mill.modal_cycle = None;
        let depth = self.calls.len();
        self.modal_program = Some(ModalProgram { within, arguments, depth, is_running: false });
    }

    /// Calls the modal program behind a block that has moved.
    pub(super) fn run_modal_program(&mut self, line: Line<'a>) {
        let depth = self.calls.len();
        let Some(modal) = &mut self.modal_program else { return };
        if modal.is_running && depth > modal.depth {
            return;
        }
        if depth != modal.depth {
            return self.stop(line.refused(Fault::ModalInCall));
        }
        modal.is_running = true;
        let (within, arguments) = (modal.within.clone(), modal.arguments.clone());
        self.mill.finish_corner();
        self.mill.settle(line);
        self.enter(line, within, arguments, 1);
    }

    /// A call has ended: the modal program that has run waits for the next move.
    pub(super) fn leave_modal_program(&mut self) {
        let depth = self.calls.len();
        if let Some(modal) = self.modal_program.as_mut().filter(|modal| modal.depth >= depth) {
            modal.is_running = false;
        }
    }

    /// `CALL "NAME"`: the name is a text, which may have folders before it.
    pub(super) fn call_by_text(&mut self, line: Line<'a>, at: usize, end: usize) {
        let last = comment_start(line.text);
        let Some((value, behind)) = self.read(line, end, |reader| reader.value()) else { return };
        let rest = blanks(line.text, behind);
        if rest < last {
            // A call of a part of a program, from a label to another.
            return self.stop(line.refusal(rest, last, Fault::NotRead));
        }
        let Value::Text(name) = value else {
            return self.stop(line.refusal(at, behind, Fault::NoProgram));
        };
        let name = name.trim().to_ascii_uppercase();
        let name = name.rsplit(['/', '\\']).next().unwrap_or_default();
        let name = name.strip_suffix(".SPF").or(name.strip_suffix(".MPF")).unwrap_or(name);
        match self.text.program(name) {
            Some(within) if name_at(name.as_bytes(), 0).is_some() => {
                self.enter(line, within, Vec::new(), 1);
            }
            _ => self.stop(line.refusal(at, behind, Fault::NoProgram)),
        }
    }
}

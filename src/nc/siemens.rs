//! Programs of SINUMERIK 840D and 828D for milling: what the control would do with the text.
//!
//! # Method
//! 1. `text` divides the text into programs and lines, and finds labels and the ends of loops.
//! 2. This module runs lines: calls, returns and repeated sections. `branches` holds jumps and loops, `calls`
//!    definitions and calls.
//! 3. `words` reads the words of a block, `codes` says what they mean, `expression` and `values` compute.
//! 4. `mill` holds the modal state and moves the machine, with `conditions`, `zeros`, `motion`, `arcs`,
//!    `corner` and `cycles`.
//!
//! # Guarantees
//! Every run ends: blocks, repeated sections, pecks and calls are counted, and each count has a limit.
//!
//! # Reference
//! Siemens, *SINUMERIK 840D sl / 828D*: Programming Manuals *Fundamentals*, *Job Planning* and *Cycles*.

mod arcs;
mod block;
mod branches;
mod calls;
mod codes;
mod conditions;
mod corner;
mod corner_geometry;
mod cycles;
mod drilling;
mod expression;
mod indirect;
mod mill;
mod motion;
mod operators;
mod patterns;
mod text;
mod values;
mod words;
mod zeros;

use std::collections::HashMap;
use std::ops::Range;

use toolpathd_core::budget::{Budget, Stopped};

use super::Ran;
use super::block::Line;
use super::fault::{Fault, Refusal};
use super::flow::MAX_BLOCKS;
use super::machine::Machine;
use block::Tool;
use calls::Call;
use codes::Motion;
use corner::Pending;
use cycles::Cycle;
use indirect::ModalProgram;
use mill::Next;
use text::{Text, comment_start, front, is_tape_mark};
use values::Variables;

/// Blocks between two checks of the budget.
const BLOCKS_BETWEEN_CHECKS: usize = 1024;

/// Longest block, bytes; the control takes 512. Longer blocks in a loop would take very long.
const MAX_LINE: usize = 4096;

/// A line with as many bytes takes as long as two blocks.
const LONG_LINE: usize = 128;

/// A control on its way through a program.
struct Mill<'a, 'm> {
    machine: &'m mut Machine<'a>,
    motion: Option<Motion>,
    is_absolute: bool,
    /// The unit of feeds; G70 and G71 leave it alone.
    feeds_in_inches: bool,
    has_units: bool,
    /// The pole in coordinates of the program, along the axes of the plane; `None` where it is not known.
    pole: Option<[f64; 2]>,
    /// The last polar angle in degrees, and the last polar radius, mm.
    polar: [Option<f64>; 2],
    called_tool: Option<Tool>,
    /// T changes the tool, because the text has no M6.
    t_changes: bool,
    edge: Option<u32>,
    /// How far the zero has moved since a block named the axis, mm of the program: an incremental way runs
    /// it, too. `None` where the zero has turned, or has changed its scale.
    owed: [Option<f64>; 3],
    pending: Option<Pending<'a>>,
    /// RNDM, in units of the program, and the feed of FRCM.
    rounding: f64,
    corner_feed: Option<f64>,
    /// The direction in the plane in which the last path block arrived.
    tangent: Option<[f64; 2]>,
    modal_cycle: Option<Cycle>,
    /// Zeros that the program has written, until a block selects them.
    written_zeros: Vec<(u32, [Option<f64>; 3])>,
    has_selected: bool,
    has_moved: bool,
    /// The last block has moved.
    moves: bool,
    is_transformed: bool,
    /// Pecks and holes of patterns so far, which are limited as blocks are.
    n_repeated: usize,
}

/// A program on its way.
struct Execution<'a, 'm> {
    mill: Mill<'a, 'm>,
    text: Text<'a>,
    variables: Variables,
    /// The index of the line that runs next.
    next: usize,
    /// The lines of the program that runs.
    within: Range<usize>,
    calls: Vec<Call>,
    modal_program: Option<ModalProgram>,
    repeats: Vec<Repeat>,
    /// The end values of FOR loops, by their lines.
    loop_ends: HashMap<usize, f64>,
    n_blocks: usize,
    /// Blocks so far, where long lines count as several.
    work: usize,
    has_ended: bool,
    skips_optional: bool,
}

/// A section that REPEAT runs again.
struct Repeat {
    lines: Range<usize>,
    /// How often the section begins again.
    again: u32,
    back: usize,
    n_calls: usize,
}

/// Runs a program to its end, or to where no sense can be made of it.
///
/// # Errors
/// When the budget ends.
pub fn run<'a>(
    machine: &mut Machine<'a>,
    text: &'a [u8],
    skips_optional: bool,
    budget: &Budget,
) -> Result<Ran, Stopped> {
    let text = Text::new(text);
    let n_lines = text.len();
    let within = text.main();
    let run = Execution {
        mill: Mill::new(machine, !text.has_m6),
        text,
        variables: Variables::new(),
        next: within.start,
        within,
        calls: Vec::new(),
        modal_program: None,
        repeats: Vec::new(),
        loop_ends: HashMap::new(),
        n_blocks: 0,
        work: 0,
        has_ended: false,
        skips_optional,
    };
    Ok(Ran { n_lines, n_blocks: run.run_to_end(budget)? })
}

impl<'a> Execution<'a, '_> {
    /// The number of blocks that have run.
    fn run_to_end(mut self, budget: &Budget) -> Result<usize, Stopped> {
        let total = self.text.len();
        while !self.has_ended && !self.mill.machine.is_full() && !self.mill.has_too_many() {
            if self.n_blocks.is_multiple_of(BLOCKS_BETWEEN_CHECKS) {
                budget.check()?;
                budget.progress("reading", self.next.min(total), total);
            }
            self.n_blocks += 1;
            self.work += 1;
            if self.work > MAX_BLOCKS {
                let line = self.line(self.next.min(total.saturating_sub(1)));
                self.stop(line.refused(Fault::Endless(MAX_BLOCKS)));
                break;
            }
            if self.repeat_section() {
                continue;
            }
            if self.next >= self.within.end {
                self.end_program();
                continue;
            }
            let index = self.next;
            self.next += 1;
            self.step(index);
        }
        let line = self.line(self.next.saturating_sub(1));
        self.mill.finish_corner();
        self.mill.settle(line);
        Ok(self.n_blocks)
    }

    fn line(&self, index: usize) -> Line<'a> {
        Line { number: index + 1, text: self.text.line(index) }
    }

    /// Refuses what makes all that follows meaningless.
    fn stop(&mut self, refusal: Refusal) {
        self.mill.machine.refuse(refusal);
        self.has_ended = true;
    }

    /// Refuses a part of a line, unless its cause has been refused before. Nothing can follow.
    fn stop_at(&mut self, line: Line<'a>, start: usize, end: usize, fault: Fault) {
        if self.variables.has_met_lost() {
            self.has_ended = true;
        } else {
            self.stop(line.refusal(start, end, fault));
        }
    }

    /// At the end of a section that repeats: back to its start, or on behind it. A jump out of the section
    /// ends it.
    fn repeat_section(&mut self) -> bool {
        let (next, n_calls) = (self.next, self.calls.len());
        let Some(repeat) = self.repeats.last_mut().filter(|repeat| repeat.n_calls == n_calls) else {
            return false;
        };
        if next == repeat.lines.end {
            if repeat.again > 0 {
                repeat.again -= 1;
                self.next = repeat.lines.start;
            } else {
                self.next = repeat.back;
                self.repeats.pop();
            }
            return true;
        }
        if !repeat.lines.contains(&next) {
            self.repeats.pop();
            return true;
        }
        false
    }

    fn step(&mut self, index: usize) {
        let line = self.line(index);
        let front = front(line.text);
        let is_skipped = front.is_optional && self.skips_optional;
        let last = comment_start(line.text);
        if last > MAX_LINE {
            return self.stop(line.refusal(front.end, last, Fault::LongBlock(MAX_LINE)));
        }
        if is_skipped || front.end >= last {
            return;
        }
        if is_tape_mark(line.text) {
            return self.mill.machine.left.add("%", line.number);
        }
        self.work += last / LONG_LINE;
        self.variables.begin_block();
        if self.branch(line, index, front.end) || self.call_or_define(line, index, front.end) {
            return;
        }
        let block = words::scan(line, front.end, &mut self.variables, &mut self.mill.machine.left);
        let next = self.mill.run(line, &block);
        self.mill.trace(line.number);
        if next == Next::End && self.mill.moves && self.modal_program.is_some() {
            self.stop(line.refused(Fault::NotRead));
        } else if next == Next::End {
            self.end_program();
        } else if self.mill.moves {
            self.run_modal_program(line);
        }
    }
}

#[cfg(test)]
mod tests;

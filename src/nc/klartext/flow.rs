//! Runs a program block by block: calls, returns, repeats and the end.
//!
//! # Guarantees
//! Every run ends: the number of executed blocks is limited, and calls and repeats have a deepest level.
//!
//! # Cost
//! O(n) for n executed blocks.

use toolpathd_core::budget::{Budget, Stopped};

use super::cursor::{Broken, Cursor};
use super::parameters::Parameters;
use super::path::Path;
use super::script::{Block, Script};
use super::{Call, Execution, Repeat};
use crate::Ran;
use crate::fault::{Fault, Refusal};
use crate::flow::MAX_BLOCKS;
use crate::machine::Machine;

/// Steps between two checks of the budget.
const STEPS_BETWEEN_CHECKS: usize = 1024;

/// Bytes of a block that count as one more step.
const BYTES_PER_STEP: usize = 256;

/// Deepest nesting of calls, and of repeats. Controls allow 20 or 30 levels of calls.
const MAX_CALLS: usize = 32;

impl<'a, 'm> Execution<'a, 'm> {
    /// A program before its first block.
    pub fn new(machine: &'m mut Machine<'a>, script: Script<'a>, skips_optional: bool) -> Self {
        Self {
            machine,
            script,
            parameters: Parameters::default(),
            next: 0,
            index: 0,
            program: 0,
            calls: Vec::new(),
            repeats: Vec::new(),
            n_blocks: 0,
            n_steps: 0,
            has_ended: false,
            skips_optional,
            path: Path::default(),
            pole: None,
            side: None,
            auto_feed: None,
            has_cycle_feed: false,
            is_per_turn: false,
            transforms: Vec::new(),
            shift: None,
            cycle: None,
            is_modal_call: false,
            parts: Vec::new(),
            points: Vec::new(),
        }
    }

    /// Runs from the first block to the end.
    pub fn run_to_end(mut self, budget: &Budget) -> Result<Ran, Stopped> {
        let total = self.script.len();
        self.begin();
        let mut next_check = 0;
        while !self.has_ended && !self.machine.is_full() {
            if self.n_steps >= next_check {
                next_check = self.n_steps + STEPS_BETWEEN_CHECKS;
                budget.check()?;
                budget.progress("reading", self.next.min(total), total);
            }
            if self.next >= self.script.programs.get(self.program).map_or(total, |program| program.end) {
                self.reach_end_of_text();
                break;
            }
            self.index = self.next;
            self.next += 1;
            let block = self.script.block(self.index);
            self.n_blocks += 1;
            let can_run = self.spend(&block, 1 + block.n_bytes / BYTES_PER_STEP);
            if can_run && !block.text.is_empty() && !(block.is_optional && self.skips_optional) {
                self.step(&block);
                self.machine.trace(block.line().number);
            }
        }
        self.drop_approach();
        self.settle();
        Ok(Ran { n_lines: self.script.n_lines(), n_blocks: self.n_blocks })
    }

    /// Refuses blocks outside of programs, and begins the first program.
    fn begin(&mut self) {
        for index in self.script.strays.clone() {
            let block = self.script.block(index);
            let is_first = self.script.programs.first().is_none_or(|program| index < program.begin);
            let fault = if is_first { Fault::Lacks("BEGIN PGM") } else { Fault::UnusedWord };
            self.refuse_block(&block, fault);
        }
        match self.script.programs.first() {
            Some(program) => self.next = program.begin,
            None => self.has_ended = true,
        }
    }

    /// Counts steps. False where there are too many, which ends the run.
    pub fn spend(&mut self, block: &Block<'a>, n_steps: usize) -> bool {
        let had_ended = self.n_steps > MAX_BLOCKS;
        self.n_steps += n_steps;
        let is_over = self.n_steps > MAX_BLOCKS;
        if is_over && !had_ended {
            self.stop(block.refused(Fault::Endless(MAX_BLOCKS)));
        }
        !is_over
    }

    /// Refuses what makes all that follows meaningless.
    pub fn stop(&mut self, refusal: Refusal) {
        self.machine.refuse(refusal);
        self.has_ended = true;
    }

    /// Refuses bytes of a block.
    pub fn refuse(&mut self, block: &Block<'a>, [start, end]: [usize; 2], fault: Fault) {
        self.machine.refuse(block.refusal(start, end, fault));
    }

    /// Refuses a value, unless an earlier refusal is the reason.
    pub fn refuse_broken(&mut self, block: &Block<'a>, broken: Broken) {
        if let Some(fault) = broken.fault {
            self.refuse(block, [broken.start, broken.end], fault);
        }
    }

    /// Refuses a whole block.
    pub fn refuse_block(&mut self, block: &Block<'a>, fault: Fault) {
        self.machine.refuse(block.refused(fault));
    }

    /// Refuses what stands behind the last word of a block that is read.
    pub fn expect_end(&mut self, block: &Block<'a>, cursor: &mut Cursor<'_>) {
        if !cursor.is_done() {
            let span = [cursor.at, cursor.word_end()];
            self.refuse(block, span, Fault::UnusedWord);
        }
    }

    fn reach_end_of_text(&mut self) {
        self.settle();
        let last = (0..self.next).rev().map(|index| self.script.block(index)).find(|b| !b.text.is_empty());
        if let Some(block) = last {
            self.stop(block.refused(Fault::Lacks("END PGM")));
        }
        self.has_ended = true;
    }

    /// END PGM: back to the calling program, or the end.
    pub fn end_program(&mut self) {
        match self.calls.last() {
            None => self.has_ended = true,
            Some(call) if call.program.is_none() => {
                let refusal = call.line.refused(Fault::Lacks("LBL 0"));
                self.stop(refusal);
            }
            Some(_) => self.go_back(),
        }
    }

    /// M2 and M30. A called program may not have them.
    pub fn end_all(&mut self, block: &Block<'a>, span: [usize; 2]) {
        if self.calls.iter().any(|call| call.program.is_some()) {
            self.refuse(block, span, Fault::Conflict);
        }
        self.has_ended = true;
    }

    /// LBL 0: back to the call of the subprogram. Without a call it is nothing.
    pub fn end_subprogram(&mut self) {
        if self.calls.last().is_some_and(|call| call.program.is_none()) {
            self.go_back();
        }
    }

    fn go_back(&mut self) {
        let Some(call) = self.calls.pop() else { return };
        self.next = call.back;
        self.repeats.truncate(call.n_repeats);
        if let Some((program, in_inches)) = call.program {
            self.program = program;
            self.parameters.leave();
            self.machine.set_units(in_inches);
        }
    }

    fn can_call(&mut self, block: &Block<'a>) -> bool {
        let can = self.calls.len() < MAX_CALLS;
        if !can {
            self.stop(block.refused(Fault::DeepCalls(MAX_CALLS)));
        }
        can
    }

    /// Calls the subprogram behind a label.
    pub fn call_label(&mut self, block: &Block<'a>, target: usize) {
        if self.can_call(block) {
            let n_repeats = self.repeats.len();
            self.calls.push(Call { back: self.next, line: block.line(), program: None, n_repeats });
            self.next = target + 1;
        }
    }

    /// Calls another program of the text.
    pub fn call_program(&mut self, block: &Block<'a>, name: &str) {
        let program = match self.script.program(name) {
            Ok(program) => program,
            Err(fault) => return self.stop(block.refused(fault)),
        };
        if self.can_call(block) {
            let put_aside = (self.program, self.machine.in_inches());
            let n_repeats = self.repeats.len();
            let line = block.line();
            self.calls.push(Call { back: self.next, line, program: Some(put_aside), n_repeats });
            self.parameters.enter();
            // A call of a program ends the compensation.
            self.side = None;
            self.machine.end_compensation();
            self.program = program;
            self.next = self.script.programs[program].begin;
        }
    }

    /// Repeats the part from a label to this block.
    pub fn repeat(&mut self, block: &Block<'a>, label: usize, times: u32) {
        let floor = self.calls.last().map_or(0, |call| call.n_repeats);
        let own = self.repeats[floor..].iter().position(|repeat| repeat.index == self.index);
        let Some(place) = own.map(|place| place + floor) else {
            if self.repeats.len() >= MAX_CALLS * MAX_CALLS {
                return self.stop(block.refused(Fault::DeepCalls(MAX_CALLS * MAX_CALLS)));
            }
            self.repeats.push(Repeat { index: self.index, label, again: times, was_left: false });
            self.next = label + 1;
            return;
        };
        let repeat = &mut self.repeats[place];
        if repeat.was_left {
            return self.stop(block.refused(Fault::NotRead));
        }
        repeat.again -= 1;
        if repeat.again == 0 {
            self.repeats.remove(place);
        } else {
            self.next = repeat.label + 1;
        }
    }

    /// Goes to a block of the same program.
    pub fn jump(&mut self, target: usize) {
        let floor = self.calls.last().map_or(0, |call| call.n_repeats);
        for repeat in &mut self.repeats[floor..] {
            let part = repeat.label.min(repeat.index)..=repeat.label.max(repeat.index);
            repeat.was_left |= part.contains(&self.index) && !part.contains(&target);
        }
        self.next = target + 1;
    }
}

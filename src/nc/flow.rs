//! Runs a program block by block: calls, returns, loops, branches and jumps.
//!
//! # Guarantees
//! * Every run ends: the number of executed blocks is limited, skipped blocks count too, and calls have a
//!   deepest level.
//! * A jump or a condition whose value only the machine knows is refused.
//!
//! # Cost
//! O(n) for n executed and skipped blocks.

mod fanuc;
mod modes;
mod o_words;

use toolpathd_core::budget::{Budget, Stopped};

use super::Ran;
use super::block::{Block, Line};
use super::control::{Family, Language};
use super::expression::{Reader, Variable};
use super::fault::{Fault, Refusal};
use super::machine::{Machine, Modes, Next};
use super::source::Source;
use super::statement::{Statement, statement};
use super::variables::{Value, Variables};
use o_words::Loop;

/// Most blocks of one run, executed or skipped. As many take a few seconds.
pub const MAX_BLOCKS: usize = 5_000_000;

/// Blocks between two checks of the budget.
const BLOCKS_BETWEEN_CHECKS: usize = 1024;

/// Deepest nesting of calls. Controls allow between four and fifteen.
const MAX_CALLS: usize = 16;

/// A program on its way.
pub struct Execution<'a, 'm> {
    pub machine: &'m mut Machine<'a>,
    pub source: Source<'a>,
    variables: Variables,
    language: Language,
    /// The index of the line that runs next.
    next: usize,
    calls: Vec<Call>,
    loops: Vec<Loop>,
    n_blocks: usize,
    n_tape_marks: usize,
    has_ended: bool,
    skips_optional: bool,
    scanned: Block,
    /// What the main program has saved.
    saved: Option<Modes>,
}

/// A call under way.
struct Call {
    /// The line after the call.
    back: usize,
    /// The first line of what was called, and how often it runs again.
    start: usize,
    again: u32,
    line: usize,
    has_variables: bool,
    n_loops: usize,
    /// What the called program has saved, and whether its end restores that.
    saved: Option<Modes>,
    restores: bool,
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
    let run = Execution::new(machine, text, skips_optional);
    let n_lines = run.source.len();
    Ok(Ran { n_lines, n_blocks: run.run_to_end(budget)? })
}

impl<'a, 'm> Execution<'a, 'm> {
    fn new(machine: &'m mut Machine<'a>, text: &'a [u8], skips_optional: bool) -> Self {
        let language = machine.control.language;
        Self {
            machine,
            source: Source::new(text, language),
            variables: Variables::new(language),
            language,
            next: 0,
            calls: Vec::new(),
            loops: Vec::new(),
            n_blocks: 0,
            n_tape_marks: 0,
            has_ended: false,
            skips_optional,
            scanned: Block::default(),
            saved: None,
        }
    }

    /// The number of blocks that have run.
    fn run_to_end(mut self, budget: &Budget) -> Result<usize, Stopped> {
        let total = self.source.len();
        while !self.has_ended && !self.machine.is_full() {
            if self.n_blocks.is_multiple_of(BLOCKS_BETWEEN_CHECKS) {
                budget.check()?;
                budget.progress("reading", self.next.min(total), total);
            }
            if self.next >= total {
                self.reach_end_of_text();
                break;
            }
            let index = self.next;
            self.next += 1;
            if self.count_block(index) {
                self.step(index);
            }
        }
        Ok(self.n_blocks)
    }

    /// Counts a block. False where there are too many, which ends the run.
    fn count_block(&mut self, index: usize) -> bool {
        self.n_blocks += 1;
        if self.n_blocks > MAX_BLOCKS {
            self.stop(self.line(index).refused(Fault::Endless(MAX_BLOCKS)));
            return false;
        }
        true
    }

    fn line(&self, index: usize) -> Line<'a> {
        Line { number: index + 1, text: self.source.line(index) }
    }

    /// Refuses what makes all that follows meaningless.
    fn stop(&mut self, refusal: Refusal) {
        self.machine.refuse(refusal);
        self.has_ended = true;
    }

    fn reach_end_of_text(&mut self) {
        if let Some(call) = self.calls.last() {
            let line = self.line(call.line);
            self.stop(line.refused(Fault::OpenCall));
        } else if self.machine.control.needs_end && self.n_tape_marks < 2 {
            let last = (0..self.source.len()).rev().find(|k| !self.source.line(*k).trim_ascii().is_empty());
            let line = self.line(last.unwrap_or(0));
            self.stop(line.refused(Fault::NoEnd));
        }
        self.has_ended = true;
    }

    fn step(&mut self, index: usize) {
        let line = self.line(index);
        match statement(line.text, self.language) {
            Statement::Words(from) => self.run_words(line, index, from),
            Statement::ProgramNumber => self.meet_program_number(line, index),
            Statement::UnknownO(at) => {
                let fault =
                    if self.language == Language::LinuxCnc { Fault::NoProgram } else { Fault::NoWord };
                self.stop(line.refusal(at, line.text.len(), fault));
            }
            Statement::Oword(label, keyword, at) => self.o_word(line, index, label, keyword, at),
            of_fanuc => self.fanuc(line, index, of_fanuc),
        }
    }

    /// A program number begins the main program, or ends the program before it.
    fn meet_program_number(&mut self, line: Line<'a>, index: usize) {
        if self.machine.control.is(Family::Grbl) {
            self.machine.refuse(line.refused(Fault::UnusedWord));
            return;
        }
        let is_start = self.calls.last().is_some_and(|call| call.start == index);
        let is_first = (0..index).all(|k| self.is_without_words(k));
        if is_start || is_first {
            return;
        }
        match self.calls.last() {
            Some(call) => {
                let line = self.line(call.line);
                self.stop(line.refused(Fault::OpenCall));
            }
            None => self.reach_end_of_text(),
        }
    }

    /// Whether a line has no words: comments and percent signs alone.
    fn is_without_words(&self, index: usize) -> bool {
        let line = self.source.line(index).trim_ascii();
        line.is_empty() || matches!(line[0], b'%' | b'(' | b';')
    }

    fn run_words(&mut self, line: Line<'a>, index: usize, from: usize) {
        let mut block = std::mem::take(&mut self.scanned);
        block.clear();
        let (machine, variables) = (&mut *self.machine, &self.variables);
        let mut refusals = 0;
        block.scan(line, from, (variables, self.language), &mut |refusal| {
            refusals += 1;
            machine.refuse(refusal);
        });
        if block.has_tape_mark {
            self.n_tape_marks += 1;
            // Behind the second mark, or behind one that does not begin the text, nothing is read.
            let begins = self.n_tape_marks == 1 && (0..index).all(|k| self.is_without_words(k));
            if !begins {
                self.n_tape_marks = 2;
                self.next = self.source.len();
            }
        } else if block.is_optional && self.skips_optional {
            // The block does not run.
        } else if self.keep_modes(line, &block) {
            self.machine.trace(line.number);
        } else {
            let next = self.machine.run(line, &mut block);
            self.machine.trace(line.number);
            self.assign(line, &block);
            self.go(line, index, &block, next);
        }
        self.scanned = block;
    }

    fn assign(&mut self, line: Line<'a>, block: &Block) {
        for (variable, value, [start, end]) in &block.assignments {
            let result = match variable {
                Variable::Numbered(number) => self.variables.set_numbered(*number, *value),
                Variable::Named(name) => {
                    self.variables.set_named(name, value.unwrap_or(0.0));
                    Ok(())
                }
            };
            if let Err(fault) = result {
                self.machine.refuse(line.refusal(*start, *end, fault));
            }
            if matches!(variable, Variable::Numbered(3001 | 3002 | 3006)) {
                self.machine.left.add("clocks and messages", line.number);
            }
        }
    }

    fn go(&mut self, line: Line<'a>, index: usize, block: &Block, next: Next) {
        match next {
            Next::Block => {}
            Next::End | Next::Stop => self.has_ended = true,
            Next::Call { program, times, is_local } => {
                let start = if is_local {
                    self.source.numbered(program, index)
                } else {
                    self.source.program(program)
                };
                // Eight digits are four of repeats and four of the program.
                let (start, times) = match start {
                    None if !is_local && program > 9999 => {
                        (self.source.program(program % 10_000), (program / 10_000).max(times))
                    }
                    start => (start, times),
                };
                self.call(line, index, start, times, None);
            }
            Next::Macro { program, times } => {
                let start = self.source.program(program);
                let arguments = block
                    .unused()
                    .filter_map(|(letter, slot)| argument(letter).map(|number| (number, slot.value)));
                let arguments: Vec<(u32, f64)> = arguments.collect();
                self.call(line, index, start, times, Some(arguments));
            }
            Next::Return { label } => self.go_back(line, index, label),
        }
    }

    /// Calls what begins at line `start`.
    fn call(
        &mut self,
        line: Line<'a>,
        index: usize,
        start: Option<usize>,
        times: u32,
        arguments: Option<Vec<(u32, f64)>>,
    ) {
        let Some(start) = start else { return self.stop(line.refused(Fault::NoProgram)) };
        if self.calls.len() >= MAX_CALLS {
            return self.stop(line.refused(Fault::DeepCalls(MAX_CALLS)));
        }
        if times == 0 {
            return;
        }
        let has_variables = arguments.is_some();
        if let Some(arguments) = arguments {
            self.variables.enter(arguments);
        }
        let n_loops = self.loops.len();
        let (back, again) = (self.next, times - 1);
        let (saved, restores) = (None, false);
        self.calls.push(Call { back, start, again, line: index, has_variables, n_loops, saved, restores });
        self.next = start;
    }

    /// M99: back to the caller, or to a block.
    fn go_back(&mut self, line: Line<'a>, index: usize, label: Option<u32>) {
        let Some(call) = self.calls.last_mut() else {
            match label {
                Some(number) => self.goto(line, index, number),
                None => {
                    self.machine.notes.push(super::notes::Note::RunsAgain { line: line.number });
                    self.has_ended = true;
                }
            }
            return;
        };
        if call.again > 0 && label.is_none() {
            call.again -= 1;
            self.next = call.start;
            self.loops.truncate(call.n_loops);
            self.end_level(line);
            return;
        }
        let (back, at) = (call.back, call.line);
        self.end_call(line);
        self.next = back;
        if let Some(number) = label {
            self.goto(line, at, number);
        }
    }

    /// Ends the level of one run of a call: restores the modes where M73 has asked for it.
    fn end_level(&mut self, line: Line<'a>) {
        let Some(call) = self.calls.last_mut() else { return };
        let restores = std::mem::take(&mut call.restores);
        if let Some(modes) = call.saved.take().filter(|_| restores) {
            self.machine.restore_modes(line, &modes);
        }
    }

    fn end_call(&mut self, line: Line<'a>) {
        self.end_level(line);
        if let Some(call) = self.calls.pop() {
            self.loops.truncate(call.n_loops);
            if call.has_variables {
                self.variables.leave();
            }
        }
    }

    /// Goes to the block with this number in the program of line `index`.
    fn goto(&mut self, line: Line<'a>, index: usize, number: u32) {
        match self.source.numbered(number, index) {
            Some(target) => self.next = target,
            None => self.stop(line.refused(Fault::NoLabel)),
        }
    }

    /// A value of the line from byte `at` on, and the byte behind it.
    fn value(&self, line: Line<'a>, at: usize) -> Result<(Value, usize), Fault> {
        let mut reader = Reader { line: line.text, at, variables: &self.variables, language: self.language };
        let value = reader.value()?.value;
        Ok((value, reader.at))
    }

    /// The truth of the condition in brackets at byte `at`, and the byte behind it. A fault ends the run.
    fn condition(&mut self, line: Line<'a>, at: usize) -> Option<(bool, usize)> {
        let mut reader = Reader { line: line.text, at, variables: &self.variables, language: self.language };
        match reader.brackets(0) {
            Ok(value) => Some((value.is_some_and(|value| value != 0.0), reader.at)),
            Err(fault) => {
                self.stop(line.refusal(at, line.text.len(), fault));
                None
            }
        }
    }
}

/// The local variable to which an argument of G65 goes, by its letter.
fn argument(letter: u8) -> Option<u32> {
    let letters = b"ABCIJKDEFHMQRSTUVWXYZ";
    let numbers = [1, 2, 3, 4, 5, 6, 7, 8, 9, 11, 13, 17, 18, 19, 20, 21, 22, 23, 24, 25, 26];
    letters.iter().position(|own| *own == letter).map(|k| numbers[k])
}

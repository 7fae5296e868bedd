//! IF, WHILE, DO, END and GOTO of custom macro B.

use super::o_words::{Loop, LoopKind};
use super::{Execution, Fault, Line, Statement};
use crate::statement::{number_of_do, statement};

impl<'a> Execution<'a, '_> {
    pub(super) fn fanuc(&mut self, line: Line<'a>, index: usize, what: Statement) {
        match what {
            Statement::If(at) => self.branch(line, index, at),
            Statement::Goto(at) => self.goto_value(line, index, at),
            Statement::While(at) => self.begin_while(line, index, at),
            Statement::End(number) => self.end_while(line, index, number),
            _ => {}
        }
    }

    fn branch(&mut self, line: Line<'a>, index: usize, at: usize) {
        let Some((is_true, end)) = self.condition(line, at) else { return };
        let rest = crate::source::blanks(line.text, end);
        let is_word = |word| crate::source::starts_with_word(&line.text[rest..], word);
        if is_word("GOTO") {
            if is_true {
                self.goto_value(line, index, rest + 4);
            }
        } else if is_word("THEN") {
            if is_true {
                self.run_words(line, index, rest + 4);
            }
        } else {
            self.stop(line.refusal(rest, line.text.len(), Fault::BadExpression));
        }
    }

    fn goto_value(&mut self, line: Line<'a>, index: usize, at: usize) {
        match self.value(line, at) {
            Ok((Some(number), _)) if number >= 0.0 && number.fract() == 0.0 && number < 1e9 => {
                // A jump may leave loops. END finds its loop again if it does not.
                self.goto(line, index, number as u32);
            }
            Ok(_) => self.stop(line.refusal(at, line.text.len(), Fault::NoLabel)),
            Err(fault) => self.stop(line.refusal(at, line.text.len(), fault)),
        }
    }

    fn begin_while(&mut self, line: Line<'a>, index: usize, at: Option<usize>) {
        let Some(number) = number_of_do(line.text, at.unwrap_or(0)) else {
            return self.stop(line.refused(Fault::OpenLoop));
        };
        let holds = match at {
            Some(at) => match self.condition(line, at) {
                Some((is_true, _)) => is_true,
                None => return,
            },
            None => true,
        };
        let first = self.calls.last().map_or(0, |call| call.n_loops);
        let label = number.to_string();
        // The loop and those that it holds begin anew.
        if let Some(k) = self.loops[first..].iter().position(|own| own.label == label) {
            self.loops.truncate(first + k);
        }
        if holds {
            self.loops.push(Loop { label, start: index, kind: LoopKind::While });
            return;
        }
        let end = self.find(index + 1, |what| *what == Statement::End(number));
        match end {
            Some(end) => self.next = end + 1,
            None => self.stop(line.refused(Fault::OpenLoop)),
        }
    }

    fn end_while(&mut self, line: Line<'a>, index: usize, number: u32) {
        let label = number.to_string();
        let first = self.calls.last().map_or(0, |call| call.n_loops);
        match self.loops[first..].iter().rev().find(|own| own.label == label && own.start < index) {
            Some(own) => self.next = own.start,
            None => self.stop(line.refused(Fault::OpenLoop)),
        }
    }

    /// The first line from `from` on that is `wanted`. Skipped lines count as blocks.
    pub(super) fn find(&mut self, from: usize, wanted: impl Fn(&Statement) -> bool) -> Option<usize> {
        for index in from..self.source.len() {
            if !self.count_block(index) {
                return None;
            }
            if wanted(&statement(self.source.line(index), self.language)) {
                return Some(index);
            }
        }
        None
    }
}

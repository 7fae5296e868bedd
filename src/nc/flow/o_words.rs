//! The O words of LinuxCNC: subroutines, loops and branches.

use super::{Execution, Fault, Line, Statement};
use crate::statement::{Keyword, is_bare};

/// A loop under way.
#[derive(Debug, Clone, PartialEq)]
pub struct Loop {
    pub label: String,
    /// The line where it begins.
    pub start: usize,
    pub kind: LoopKind,
}

/// How a loop ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LoopKind {
    /// Its condition stands at its start.
    While,
    /// Its condition stands at its end.
    Do,
    /// It runs as often as this once more.
    Repeat(u64),
}

/// Most values of a call.
const MAX_ARGUMENTS: u32 = 30;

impl<'a> Execution<'a, '_> {
    pub(super) fn o_word(
        &mut self,
        line: Line<'a>,
        index: usize,
        label: String,
        keyword: Keyword,
        at: usize,
    ) {
        let is_current = |own: Option<&Loop>| own.is_some_and(|own| own.label == label);
        let takes_value = matches!(
            keyword,
            Keyword::EndSub
                | Keyword::Return
                | Keyword::Call
                | Keyword::While
                | Keyword::Repeat
                | Keyword::If
                | Keyword::ElseIf
        );
        if !takes_value && !self.ends_at(line, at) {
            return;
        }
        match keyword {
            Keyword::Sub => self.skip(line, index, &label, &[Keyword::EndSub], true),
            Keyword::EndSub | Keyword::Return => {
                if self.calls.is_empty() {
                    return self.stop(line.refused(Fault::OpenLoop));
                }
                if self.give_back(line, at) {
                    self.go_back(line, index, None);
                }
            }
            Keyword::Call => self.call_sub(line, index, &label, at),
            Keyword::Do => self.loops.push(Loop { label, start: index, kind: LoopKind::Do }),
            Keyword::While => self.meet_while(line, index, label, at),
            Keyword::EndWhile if is_current(self.loops.last()) => {
                self.next = self.loops.last().map_or(index, |own| own.start);
            }
            Keyword::Repeat => self.begin_repeat(line, index, label, at),
            Keyword::EndRepeat if is_current(self.loops.last()) => self.end_repeat(),
            Keyword::Break => self.leave_loop(line, index, &label),
            Keyword::Continue => self.continue_loop(line, index, &label),
            Keyword::If => self.choose(line, index, &label, at),
            // The branch before has run.
            Keyword::ElseIf | Keyword::Else => self.skip(line, index, &label, &[Keyword::EndIf], true),
            Keyword::EndIf => {}
            Keyword::EndWhile | Keyword::EndRepeat => self.stop(line.refused(Fault::OpenLoop)),
        }
    }

    /// Whether nothing but a comment stands from byte `at` on. What stands there is refused.
    fn ends_at(&mut self, line: Line<'a>, at: usize) -> bool {
        let ends = is_bare(&line.text[at..]);
        if !ends {
            let start = crate::source::blanks(line.text, at);
            self.stop(line.refusal(start, line.text.len(), Fault::UnusedWord));
        }
        ends
    }

    /// The truth of the condition that ends a line. A fault ends the run.
    fn last_condition(&mut self, line: Line<'a>, at: usize) -> Option<bool> {
        let (holds, end) = self.condition(line, at)?;
        self.ends_at(line, end).then_some(holds)
    }

    /// Goes to the next line of `label` with one of these keywords, or behind it.
    fn skip(&mut self, line: Line<'a>, index: usize, label: &str, keywords: &[Keyword], behind: bool) {
        let found = self.find(index + 1, |what| match what {
            Statement::Oword(own, keyword, _) => own == label && keywords.contains(keyword),
            _ => false,
        });
        match found {
            Some(found) => self.next = found + usize::from(behind),
            None => self.stop(line.refused(Fault::OpenLoop)),
        }
    }

    fn call_sub(&mut self, line: Line<'a>, index: usize, label: &str, mut at: usize) {
        let mut arguments = Vec::new();
        for number in 1..=MAX_ARGUMENTS {
            let start = crate::source::blanks(line.text, at);
            if line.text.get(start) != Some(&b'[') {
                break;
            }
            match self.value(line, start) {
                Ok((value, end)) => {
                    arguments.push((number, value.unwrap_or(0.0)));
                    at = end;
                }
                Err(fault) => return self.stop(line.refusal(start, line.text.len(), fault)),
            }
        }
        if !self.ends_at(line, at) {
            return;
        }
        let start = self.source.sub(label);
        self.call(line, index, start, 1, Some(arguments));
        if start.is_some() && !self.has_ended {
            self.next += 1;
        }
    }

    /// The value in brackets behind the end of a subroutine goes to the caller. False where it has none,
    /// which is refused.
    fn give_back(&mut self, line: Line<'a>, at: usize) -> bool {
        let start = crate::source::blanks(line.text, at);
        let has_value = line.text.get(start) == Some(&b'[');
        let (mut value, mut end) = (0.0, at);
        if has_value {
            match self.value(line, start) {
                Ok((found, behind)) => (value, end) = (found.unwrap_or(0.0), behind),
                Err(fault) => {
                    self.stop(line.refusal(start, line.text.len(), fault));
                    return false;
                }
            }
        }
        if !self.ends_at(line, end) {
            return false;
        }
        self.variables.set_named("_value", value);
        self.variables.set_named("_value_returned", f64::from(u8::from(has_value)));
        true
    }

    fn meet_while(&mut self, line: Line<'a>, index: usize, label: String, at: usize) {
        let Some(holds) = self.last_condition(line, at) else { return };
        match self.loops.last().filter(|own| own.label == label).map(|own| (own.kind, own.start)) {
            Some((LoopKind::Do, start)) if holds => self.next = start + 1,
            Some((LoopKind::Do, _)) => {
                self.loops.pop();
            }
            current => {
                if current.is_some() {
                    self.loops.pop();
                }
                if holds {
                    self.loops.push(Loop { label, start: index, kind: LoopKind::While });
                } else {
                    self.skip(line, index, &label, &[Keyword::EndWhile], true);
                }
            }
        }
    }

    fn begin_repeat(&mut self, line: Line<'a>, index: usize, label: String, at: usize) {
        match self.value(line, at) {
            Ok((Some(times), end)) if times.abs() < 1e15 => {
                if !self.ends_at(line, end) {
                    return;
                }
                let times = times.round();
                if times >= 1.0 {
                    let kind = LoopKind::Repeat(times as u64 - 1);
                    self.loops.push(Loop { label, start: index, kind });
                } else {
                    self.skip(line, index, &label, &[Keyword::EndRepeat], true);
                }
            }
            Ok(_) => self.stop(line.refusal(at, line.text.len(), Fault::BadExpression)),
            Err(fault) => self.stop(line.refusal(at, line.text.len(), fault)),
        }
    }

    fn end_repeat(&mut self) {
        match self.loops.last_mut() {
            Some(Loop { kind: LoopKind::Repeat(again), start, .. }) if *again > 0 => {
                *again -= 1;
                self.next = *start + 1;
            }
            _ => {
                self.loops.pop();
            }
        }
    }

    /// The keywords at which the loop with this label ends.
    fn end_of(&self, label: &str) -> Option<&'static [Keyword]> {
        let own = self.loops.iter().rev().find(|own| own.label == label)?;
        Some(match own.kind {
            LoopKind::While => &[Keyword::EndWhile],
            LoopKind::Do => &[Keyword::While],
            LoopKind::Repeat(_) => &[Keyword::EndRepeat],
        })
    }

    fn leave_loop(&mut self, line: Line<'a>, index: usize, label: &str) {
        let Some(ends) = self.end_of(label) else { return self.stop(line.refused(Fault::OpenLoop)) };
        while self.loops.pop().is_some_and(|own| own.label != label) {}
        self.skip(line, index, label, ends, true);
    }

    fn continue_loop(&mut self, line: Line<'a>, index: usize, label: &str) {
        let Some(ends) = self.end_of(label) else { return self.stop(line.refused(Fault::OpenLoop)) };
        while self.loops.last().is_some_and(|own| own.label != label) {
            self.loops.pop();
        }
        self.skip(line, index, label, ends, false);
    }

    /// Runs the first branch whose condition holds.
    fn choose(&mut self, line: Line<'a>, index: usize, label: &str, at: usize) {
        let (mut line, mut index, mut at) = (line, index, at);
        loop {
            let Some(holds) = self.last_condition(line, at) else { return };
            if holds {
                return;
            }
            self.skip(line, index, label, &[Keyword::ElseIf, Keyword::Else, Keyword::EndIf], false);
            if self.has_ended {
                return;
            }
            index = self.next;
            line = self.line(index);
            self.next += 1;
            match crate::statement::statement(line.text, self.language) {
                Statement::Oword(_, Keyword::ElseIf, rest) => at = rest,
                _ => return,
            }
        }
    }
}

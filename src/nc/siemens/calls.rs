//! Definitions, calls of programs and cycles, and their ends.

use std::ops::Range;

use super::Execution;
use super::cycles::cycle;
use super::text::{blanks, comment_start, front, name_at};
use super::values::{Kind, Value, Variable};
use crate::block::Line;
use crate::fault::Fault;

/// Deepest nesting of calls, as on the control.
const MAX_CALLS: usize = 16;

/// Most parameters of one call.
const MAX_ARGUMENTS: usize = 64;

/// A call under way.
pub struct Call {
    /// The line after the call, and the lines of the program that calls.
    back: usize,
    within: Range<usize>,
    /// How often the program runs again.
    again: u32,
    arguments: Vec<Option<Value>>,
}

/// The parameters of a call.
type Arguments = Vec<Option<Value>>;

impl<'a> Execution<'a, '_> {
    /// Runs a block that defines or calls, and begins at byte `at`. False for other blocks.
    pub(super) fn call_or_define(&mut self, line: Line<'a>, index: usize, at: usize) -> bool {
        let last = comment_start(line.text);
        if line.text[at..].len() >= 7 && line.text[at..at + 7].eq_ignore_ascii_case(b"$P_UIFR") {
            self.write_zero(line, at + 7);
            return true;
        }
        if matches!(line.text[at], b'L' | b'l') && name_at(line.text, at).is_none() {
            let digits = line.text[at + 1..].iter().take_while(|c| c.is_ascii_digit()).count();
            let name = format!("L{}", String::from_utf8_lossy(&line.text[at + 1..at + 1 + digits]));
            self.call(line, &name, at, at + 1 + digits);
            return true;
        }
        let Some((name, end)) = name_at(line.text, at) else { return false };
        if self.variables.is_defined(&name) {
            return false;
        }
        match name.as_str() {
            "DEF" => self.define(line, end),
            "PROC" => self.meet_proc(line, index, end),
            "EXTERN" => self.mill.machine.left.add("EXTERN", line.number),
            "RET" if blanks(line.text, end) >= last => self.end_program(),
            "RET" => self.stop(line.refusal(at, last, Fault::NotRead)),
            "SETAL" => self.stop(line.refusal(at, last, Fault::Alarm)),
            "MCALL" => self.meet_mcall(line, end),
            "CALL" => self.call_by_text(line, at, end),
            "HOLES1" | "HOLES2" | "CYCLE801" | "CYCLE802" => self.pattern(line, &name, at, end),
            "CYCLE800" => self.swivel(line, at, end),
            _ if self.text.program(&name).is_some() => self.call(line, &name, at, end),
            _ => return self.run_cycle(line, &name, at, end),
        }
        true
    }

    /// The parameters in parentheses behind a name, which end the line unless `goes_on`.
    fn arguments(&mut self, line: Line<'a>, at: usize, goes_on: bool) -> Option<(Arguments, usize)> {
        let (arguments, end) = self.read(line, at, |reader| {
            let mut arguments: Arguments = Vec::new();
            if !reader.take(b'(') || reader.take(b')') {
                return Ok(arguments);
            }
            loop {
                reader.skip_blanks();
                let is_absent = matches!(reader.peek(), Some(b',' | b')'));
                arguments.push(if is_absent { None } else { Some(reader.value()?) });
                if reader.take(b')') {
                    return Ok(arguments);
                }
                if !reader.take(b',') || arguments.len() >= MAX_ARGUMENTS {
                    return Err(Fault::BadExpression);
                }
            }
        })?;
        let (rest, last) = (blanks(line.text, end), comment_start(line.text));
        if rest < last && !goes_on {
            self.stop(line.refusal(rest, last, Fault::UnusedWord));
            return None;
        }
        Some((arguments, end))
    }

    /// Calls a program of the text, or refuses its name.
    fn call(&mut self, line: Line<'a>, name: &str, at: usize, end: usize) {
        let Some(within) = self.text.program(name) else {
            return self.stop(line.refusal(at, end, Fault::NoProgram));
        };
        let Some((arguments, end)) = self.arguments(line, end, true) else { return };
        let Some((times, end)) = self.times(line, end) else { return };
        let (rest, last) = (blanks(line.text, end), comment_start(line.text));
        if rest < last {
            return self.stop(line.refusal(rest, last, Fault::UnusedWord));
        }
        if times == 0 {
            return;
        }
        self.enter(line, within, arguments, times);
    }

    /// Begins a program that is called.
    pub(super) fn enter(&mut self, line: Line<'a>, within: Range<usize>, arguments: Arguments, times: u32) {
        if self.calls.len() >= MAX_CALLS {
            return self.stop(line.refused(Fault::DeepCalls(MAX_CALLS)));
        }
        if !arguments.is_empty() && !self.has_proc(&within) {
            return self.stop(line.refused(Fault::BadExpression));
        }
        let start = within.start;
        let before = std::mem::replace(&mut self.within, within);
        self.calls.push(Call { back: self.next, within: before, again: times - 1, arguments });
        self.variables.enter();
        self.next = start;
    }

    /// Whether a program begins with PROC. The lines before it count as work.
    fn has_proc(&mut self, within: &Range<usize>) -> bool {
        let mut lines = within.clone().map(|index| self.text.line(index));
        let first = lines.find(|line| front(line).end < comment_start(line));
        self.work += within.len() - lines.len();
        first.is_some_and(|line| name_at(line, front(line).end).is_some_and(|(name, _)| name == "PROC"))
    }

    /// The end of a program: of the whole run, or back to the caller.
    pub(super) fn end_program(&mut self) {
        let start = self.within.start;
        let n_calls = self.calls.len();
        self.repeats.retain(|repeat| repeat.n_calls < n_calls);
        let Some(call) = self.calls.last_mut() else {
            self.has_ended = true;
            return;
        };
        self.variables.leave();
        if call.again > 0 {
            call.again -= 1;
            self.variables.enter();
            self.next = start;
        } else if let Some(call) = self.calls.pop() {
            self.next = call.back;
            self.within = call.within;
            self.leave_modal_program();
        }
    }

    /// PROC: the parameters of the call become variables.
    fn meet_proc(&mut self, line: Line<'a>, index: usize, at: usize) {
        let at = blanks(line.text, at);
        let last = comment_start(line.text);
        let Some((_, end)) = name_at(line.text, blanks(line.text, at)) else {
            return self.stop(line.refusal(at, last, Fault::BadExpression));
        };
        let is_first = (self.within.start..index)
            .all(|own| front(self.text.line(own)).end >= comment_start(self.text.line(own)));
        if !is_first {
            return self.stop(line.refused(Fault::BadExpression));
        }
        let arguments = self.calls.last().map(|call| call.arguments.clone()).unwrap_or_default();
        let read = self.read(line, end, |reader| {
            let mut parameters: Vec<(Kind, String, Option<Value>)> = Vec::new();
            if !reader.take(b'(') || reader.take(b')') {
                return Ok(parameters);
            }
            loop {
                let kind = reader.name().ok_or(Fault::BadExpression)?;
                // VAR gives values back, AXIS and FRAME are no numbers.
                let kind = Kind::named(&kind).ok_or(Fault::NotRead)?;
                if reader.peek() == Some(b'[') {
                    reader.index(0)?;
                }
                let name = reader.name().ok_or(Fault::BadExpression)?;
                if reader.peek() == Some(b'[') {
                    return Err(Fault::NotRead);
                }
                let usual = if reader.take(b'=') { Some(reader.value()?) } else { None };
                parameters.push((kind, name, usual));
                if reader.take(b')') {
                    return Ok(parameters);
                }
                if !reader.take(b',') || parameters.len() >= MAX_ARGUMENTS {
                    return Err(Fault::BadExpression);
                }
            }
        });
        let Some((parameters, end)) = read else { return };
        if arguments.len() > parameters.len() {
            return self.stop(line.refused(Fault::BadExpression));
        }
        for (k, (kind, name, usual)) in parameters.into_iter().enumerate() {
            let value = arguments.get(k).cloned().flatten().or(usual);
            if let Err(fault) = self.define_one(&name, kind, None, value.into_iter().collect()) {
                return self.stop(line.refusal(at, last, fault));
            }
        }
        let mut at = blanks(line.text, end);
        while at < last {
            match name_at(line.text, at) {
                Some((name, end))
                    if matches!(name.as_str(), "DISPLOF" | "DISPLON" | "SBLOF" | "SBLON" | "ACTBLOCNO") =>
                {
                    self.mill.machine.left.add(&name, line.number);
                    at = blanks(line.text, end);
                }
                // SAVE restores what the program changes.
                _ => return self.stop(line.refusal(at, last, Fault::NotRead)),
            }
        }
        self.variables.begin_block();
    }

    fn define_one(
        &mut self,
        name: &str,
        kind: Kind,
        count: Option<usize>,
        values: Vec<Value>,
    ) -> Result<(), Fault> {
        // Fields take time as blocks do.
        self.work += count.unwrap_or(1);
        self.variables.define(name, kind, count)?;
        if values.len() > count.unwrap_or(1) {
            return Err(Fault::BadExpression);
        }
        for (k, value) in values.into_iter().enumerate() {
            let index = count.map(|_| k);
            self.variables.set(&Variable::Named(name.to_owned(), index), value)?;
        }
        Ok(())
    }

    /// DEF: variables of this program, with values and fields of one dimension.
    fn define(&mut self, line: Line<'a>, at: usize) {
        let at = blanks(line.text, at);
        let last = comment_start(line.text);
        let read = self.read(line, at, |reader| {
            let kind = reader.name().ok_or(Fault::BadExpression)?;
            let kind = Kind::named(&kind).ok_or(Fault::NotRead)?;
            if kind == Kind::Text && reader.peek() == Some(b'[') {
                reader.index(0)?;
            }
            let mut found: Vec<(String, Option<usize>, Vec<Value>)> = Vec::new();
            loop {
                let name = reader.name().ok_or(Fault::BadExpression)?;
                let count = if reader.peek() == Some(b'[') { Some(reader.index(0)?) } else { None };
                let mut values = Vec::new();
                if reader.take(b'=') {
                    let is_list = count.is_some() && reader.take(b'(');
                    values.push(reader.value()?);
                    while is_list && reader.take(b',') {
                        values.push(reader.value()?);
                    }
                    if is_list && !reader.take(b')') {
                        return Err(Fault::BadExpression);
                    }
                    if count.is_some() && !is_list {
                        return Err(Fault::NotRead);
                    }
                }
                found.push((name, count, values));
                if !reader.take(b',') {
                    break;
                }
            }
            if reader.is_at_end() { Ok((kind, found)) } else { Err(Fault::BadExpression) }
        });
        let Some(((kind, found), _)) = read else { return };
        for (name, count, values) in found {
            if let Err(fault) = self.define_one(&name, kind, count, values) {
                return self.stop(line.refusal(at, last, fault));
            }
        }
    }

    /// MCALL: a cycle runs behind each block that moves, until MCALL alone.
    fn meet_mcall(&mut self, line: Line<'a>, at: usize) {
        let (at, last) = (blanks(line.text, at), comment_start(line.text));
        if at >= last {
            (self.mill.modal_cycle, self.modal_program) = (None, None);
            return;
        }
        let Some((name, end)) = name_at(line.text, at) else {
            return self.stop(line.refusal(at, last, Fault::NotRead));
        };
        let Some((arguments, end)) = self.arguments(line, end, false) else { return };
        match cycle(&name, &arguments, [at, end]) {
            Some(Ok(cycle)) => (self.mill.modal_cycle, self.modal_program) = (Some(cycle), None),
            Some(Err(fault)) => self.stop(line.refusal(at, last, fault)),
            None => self.begin_modal_program(line, &name, arguments, [at, end]),
        }
    }

    /// Runs a drilling cycle. False for other names.
    fn run_cycle(&mut self, line: Line<'a>, name: &str, at: usize, end: usize) -> bool {
        if cycle(name, &[], [at, end]).is_none() {
            return false;
        }
        let Some((arguments, end)) = self.arguments(line, end, false) else { return true };
        match cycle(name, &arguments, [at, end]) {
            Some(Ok(cycle)) => self.mill.run_cycle(line, &cycle),
            Some(Err(fault)) => self.stop(line.refusal(at, end, fault)),
            None => return false,
        }
        true
    }

    /// The numbers among parameters; absent ones are zero.
    fn numbers(&mut self, line: Line<'a>, at: usize, arguments: &[Option<Value>]) -> Option<Vec<f64>> {
        let number = |argument: &Option<Value>| argument.as_ref().map_or(Ok(0.0), Value::number);
        match arguments.iter().map(number).collect() {
            Ok(numbers) => Some(numbers),
            Err(fault) => {
                self.stop(line.refusal(at, comment_start(line.text), fault));
                None
            }
        }
    }

    fn pattern(&mut self, line: Line<'a>, name: &str, at: usize, end: usize) {
        let Some((arguments, end)) = self.arguments(line, end, false) else { return };
        if self.modal_program.is_some() {
            return self.stop(line.refusal(at, end, Fault::NotRead));
        }
        self.mill.run_pattern(line, name, &arguments, [at, end]);
    }

    /// CYCLE800 without any angle or shift ends a tilted plane. Others are refused.
    fn swivel(&mut self, line: Line<'a>, at: usize, end: usize) {
        let Some((mut arguments, end)) = self.arguments(line, end, false) else { return };
        if let Some(name) = arguments.get_mut(1) {
            // The name of the swivel data.
            *name = None;
        }
        let Some(numbers) = self.numbers(line, at, &arguments) else { return };
        let tilts = numbers.iter().skip(4).take(9).any(|value| *value != 0.0);
        if tilts || !self.mill.machine.placement.is_plain() {
            self.mill.machine.refuse(line.refusal(at, end, Fault::NotRead));
            return self.mill.lose_place();
        }
        self.mill.settle(line);
        self.mill.machine.left.add("CYCLE800", line.number);
        if numbers.first().is_some_and(|retraction| *retraction != 0.0) {
            // The control retracts axes first.
            self.mill.lose_place();
        }
    }

    /// $P_UIFR: the zero of a settable offset, which counts once a block selects it.
    fn write_zero(&mut self, line: Line<'a>, at: usize) {
        let unit = self.mill.machine.unit_mm();
        let read = self.read(line, at, |reader| {
            let is_known = |number: f64| number.fract() == 0.0 && (1.0..=99.0).contains(&number);
            if !reader.take(b'[') {
                return Err(Fault::NotRead);
            }
            let number = reader.number().ok().filter(|number| is_known(*number)).ok_or(Fault::NotRead)?;
            let mut zeros = [None; 3];
            if reader.take(b',') {
                let axis = read_axis(reader)?;
                let is_shift = reader.take(b',') && reader.take_name("TR");
                if !(is_shift && reader.take(b']') && reader.take(b'=')) {
                    return Err(Fault::NotRead);
                }
                zeros[axis] = Some(reader.number()? * unit);
            } else {
                let is_shift = reader.take(b']') && reader.take(b'=') && reader.take_name("CTRANS");
                if !(is_shift && reader.take(b'(')) {
                    return Err(Fault::NotRead);
                }
                zeros = [Some(0.0); 3];
                while !reader.take(b')') {
                    let axis = read_axis(reader)?;
                    if !reader.take(b',') {
                        return Err(Fault::BadExpression);
                    }
                    zeros[axis] = Some(reader.number()? * unit);
                    reader.take(b',');
                }
            }
            if reader.is_at_end() { Ok((number as u32, zeros)) } else { Err(Fault::NotRead) }
        });
        let Some(((number, zeros), _)) = read else { return };
        self.mill.assume_units(line);
        let number = if number <= 4 { number } else { 500 + number };
        let written = &mut self.mill.written_zeros;
        match written.iter_mut().find(|(own, _)| *own == number) {
            Some((_, own)) => *own = [0, 1, 2].map(|k| zeros[k].or(own[k])),
            None => written.push((number, zeros)),
        }
    }
}

fn read_axis(reader: &mut super::expression::Reader<'_, '_>) -> Result<usize, Fault> {
    reader.skip_blanks();
    let axis = match reader.peek().map(|letter| letter.to_ascii_uppercase()) {
        Some(letter @ b'X'..=b'Z') if name_at(reader.text, reader.at).is_none() => letter - b'X',
        _ => return Err(Fault::NotRead),
    };
    reader.at += 1;
    Ok(usize::from(axis))
}

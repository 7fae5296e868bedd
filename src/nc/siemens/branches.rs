//! Jumps, branches, loops and repeated sections.

use super::expression::Reader;
use super::text::{Label, blanks, comment_start, front, name_at};
use super::values::{Value, Variable};
use super::{Execution, Repeat};
use crate::block::Line;
use crate::fault::Fault;

/// Deepest nesting of repeated sections.
const MAX_REPEATS: usize = 16;

/// Where a jump looks for its label.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Way {
    Forward,
    Backward,
    Both,
    /// As `Both`, and on with the next block where there is no such label.
    IfFound,
}

impl<'a> Execution<'a, '_> {
    /// Runs a block of jumps, branches or loops that begins at byte `at`. False for other blocks.
    pub(super) fn branch(&mut self, line: Line<'a>, index: usize, at: usize) -> bool {
        let Some((name, end)) = name_at(line.text, at) else { return false };
        if self.variables.is_defined(&name) {
            return false;
        }
        match name.as_str() {
            "IF" => self.meet_if(line, index, end),
            "WHILE" | "UNTIL" => {
                if let Some(partner) = self.partner(line, index)
                    && self.condition(line, end) == Some(false)
                {
                    self.next = partner + 1;
                }
            }
            "FOR" => self.begin_for(line, index, end),
            "ENDFOR" => self.end_for(line, index),
            "ELSE" | "ENDWHILE" | "ENDLOOP" | "ENDIF" | "LOOP" => {
                if self.is_more(line, end) {
                    return true;
                }
                let Some(partner) = self.partner(line, index) else { return true };
                match name.as_str() {
                    "ELSE" => self.next = partner + 1,
                    "ENDWHILE" | "ENDLOOP" => self.next = partner,
                    _ => {}
                }
            }
            "REPEAT" if blanks(line.text, end) >= comment_start(line.text) => {
                self.partner(line, index);
            }
            "REPEAT" | "REPEATB" => self.begin_repeat(line, index, end, name == "REPEATB"),
            "CASE" => self.case(line, index, end),
            _ => match way(&name) {
                Some(way) => self.jump(line, index, end, way),
                None => return false,
            },
        }
        true
    }

    /// Refuses words behind a keyword that takes none.
    fn is_more(&mut self, line: Line<'a>, end: usize) -> bool {
        let (at, last) = (blanks(line.text, end), comment_start(line.text));
        if at < last {
            self.stop(line.refusal(at, last, Fault::UnusedWord));
        }
        at < last
    }

    fn partner(&mut self, line: Line<'a>, index: usize) -> Option<usize> {
        let partner = self.text.partner(index);
        if partner.is_none() {
            self.stop(line.refused(Fault::OpenLoop));
        }
        partner
    }

    /// Reads from byte `at` by `read`, to the byte behind. A fault ends the run.
    pub(super) fn read<T>(
        &mut self,
        line: Line<'a>,
        at: usize,
        read: impl FnOnce(&mut Reader<'_, '_>) -> Result<T, Fault>,
    ) -> Option<(T, usize)> {
        let text = &line.text[..comment_start(line.text)];
        let mut reader = Reader { text, at: at.min(text.len()), variables: &self.variables };
        let result = read(&mut reader);
        let reached = reader.at;
        match result {
            Ok(value) => Some((value, reached)),
            Err(fault) => {
                self.stop_at(line, blanks(line.text, at), text.len(), fault);
                None
            }
        }
    }

    /// The truth of a condition that reaches to the end of its line.
    fn condition(&mut self, line: Line<'a>, at: usize) -> Option<bool> {
        let (value, end) = self.read(line, at, |reader| reader.number())?;
        if self.is_more(line, end) { None } else { Some(value != 0.0) }
    }

    fn meet_if(&mut self, line: Line<'a>, index: usize, at: usize) {
        let Some((value, end)) = self.read(line, at, |reader| reader.number()) else { return };
        let jump =
            name_at(line.text, blanks(line.text, end)).and_then(|(name, end)| Some((way(&name)?, end)));
        match jump {
            Some((way, end)) if value != 0.0 => self.jump(line, index, end, way),
            Some(_) => {}
            None => {
                if self.is_more(line, end) {
                    return;
                }
                if let Some(partner) = self.partner(line, index)
                    && value == 0.0
                {
                    self.next = partner + 1;
                }
            }
        }
    }

    /// The variable, the start and the end of the FOR of a line.
    fn loop_values(&mut self, line: Line<'a>, at: usize) -> Option<(Variable, f64, f64)> {
        let (values, end) = self.read(line, at, |reader| {
            let variable = read_variable(reader)?;
            if !reader.take(b'=') {
                return Err(Fault::BadExpression);
            }
            let start = reader.number()?;
            if !reader.take_name("TO") {
                return Err(Fault::BadExpression);
            }
            Ok((variable, start, reader.number()?))
        })?;
        if self.is_more(line, end) { None } else { Some(values) }
    }

    fn begin_for(&mut self, line: Line<'a>, index: usize, at: usize) {
        let Some(partner) = self.partner(line, index) else { return };
        let Some((variable, start, end)) = self.loop_values(line, at) else { return };
        if let Err(fault) = self.variables.set(&variable, Value::Number(start)) {
            return self.stop_at(line, at, line.text.len(), fault);
        }
        self.loop_ends.insert(index, end);
        if start > end {
            self.next = partner + 1;
        }
    }

    fn end_for(&mut self, line: Line<'a>, index: usize) {
        let Some(start) = self.partner(line, index) else { return };
        let head = self.line(start);
        let at = front(head.text).end + "FOR".len();
        // The end value counts as it is now; a change since the start of the loop is refused.
        let text = &head.text[..comment_start(head.text)];
        let mut reader = Reader { text, at, variables: &self.variables };
        let variable = read_variable(&mut reader);
        let now = variable.and_then(|variable| {
            let value = self.variables.value(&variable)?.number()?;
            Ok((variable, value + 1.0))
        });
        let (variable, value) = match now {
            Ok(now) => now,
            Err(fault) => return self.stop_at(head, at, text.len(), fault),
        };
        let Some(end) = self.loop_end(head, at) else { return };
        if self.loop_ends.get(&start).is_some_and(|before| *before != end) {
            return self.stop_at(head, at, text.len(), Fault::NotRead);
        }
        if let Err(fault) = self.variables.set(&variable, Value::Number(value)) {
            return self.stop_at(head, at, text.len(), fault);
        }
        if value <= end {
            self.next = start + 1;
        }
    }

    /// The end value of the FOR of a line.
    fn loop_end(&mut self, line: Line<'a>, at: usize) -> Option<f64> {
        let upper = line.text.to_ascii_uppercase();
        let is_apart = |k: usize| upper.get(k).is_none_or(|c| !c.is_ascii_alphabetic() && *c != b'_');
        let to = (at..upper.len())
            .find(|k| upper[*k..].starts_with(b"TO") && is_apart(k.wrapping_sub(1)) && is_apart(k + 2));
        let to = to.map_or(line.text.len(), |to| to + 2);
        self.read(line, to, |reader| reader.number()).map(|(value, _)| value)
    }

    fn label(&mut self, line: Line<'a>, at: usize) -> Option<(Label, usize)> {
        let start = blanks(line.text, at);
        if let Some((name, end)) = name_at(line.text, start) {
            return Some((Label::Name(name), end));
        }
        if matches!(line.text.get(start), Some(b'N' | b'n' | b':')) {
            let digits = line.text[start + 1..].iter().take_while(|c| c.is_ascii_digit()).count();
            let end = start + 1 + digits;
            let number = std::str::from_utf8(&line.text[start + 1..end]).unwrap_or_default().parse();
            if let Ok(number) = number {
                return Some((Label::Number(number), end));
            }
        }
        // A label in a variable, or none.
        self.stop(line.refusal(start.min(line.text.len()), line.text.len(), Fault::NoLabel));
        None
    }

    fn jump(&mut self, line: Line<'a>, index: usize, at: usize, way: Way) {
        let Some((label, end)) = self.label(line, at) else { return };
        if self.is_more(line, end) {
            return;
        }
        self.go_to(line, index, &label, way);
    }

    fn go_to(&mut self, line: Line<'a>, index: usize, label: &Label, way: Way) {
        let lines = self.text.labeled(label, &self.within);
        let split = lines.partition_point(|own| *own <= index);
        let (behind, ahead) = (lines[..split].last().copied(), lines[split..].first().copied());
        let target = match way {
            Way::Forward => ahead,
            Way::Backward => behind,
            Way::Both | Way::IfFound => ahead.or(behind),
        };
        match target {
            Some(target) => self.next = target,
            None if way == Way::IfFound => {}
            None => self.stop(line.refused(Fault::NoLabel)),
        }
    }

    /// CASE value OF constant GOTOF label ... DEFAULT GOTOF label.
    fn case(&mut self, line: Line<'a>, index: usize, at: usize) {
        let Some((value, mut at)) = self.read(line, at, |reader| {
            let value = reader.number()?;
            if reader.take_name("OF") { Ok(value) } else { Err(Fault::BadExpression) }
        }) else {
            return;
        };
        let mut target: Option<(Label, Way)> = None;
        let last = comment_start(line.text);
        while blanks(line.text, at) < last {
            let choice = self.read(line, at, |reader| {
                let case = if reader.take_name("DEFAULT") { None } else { Some(reader.number()?) };
                let way = reader.name().and_then(|name| way(&name)).ok_or(Fault::BadExpression)?;
                Ok((case, way))
            });
            let Some(((case, way), end)) = choice else { return };
            let Some((label, end)) = self.label(line, end) else { return };
            at = end;
            if target.is_none() && case.is_none_or(|case| case == value) {
                target = Some((label, way));
            }
        }
        if let Some((label, way)) = target {
            self.go_to(line, index, &label, way);
        }
    }

    /// REPEAT and REPEATB with a label: runs a section before or behind again.
    fn begin_repeat(&mut self, line: Line<'a>, index: usize, at: usize, is_block: bool) {
        let Some((first, mut end)) = self.label(line, at) else { return };
        let mut last = None;
        if let Some((name, behind)) = name_at(line.text, blanks(line.text, end)).filter(|_| !is_block) {
            (last, end) = (Some(Label::Name(name)), behind);
        }
        let Some((times, end)) = self.times(line, end) else { return };
        if self.is_more(line, end) {
            return;
        }
        let Some(lines) = self.section(index, &first, last.as_ref(), is_block) else {
            return self.stop(line.refused(Fault::NoLabel));
        };
        if self.repeats.len() >= MAX_REPEATS || lines.contains(&index) {
            return self.stop(line.refused(Fault::DeepCalls(MAX_REPEATS)));
        }
        if times > 0 {
            let (back, n_calls) = (self.next, self.calls.len());
            self.next = lines.start;
            self.repeats.push(Repeat { lines, again: times - 1, back, n_calls });
        }
    }

    /// The lines of a section: one block, from label to label, to ENDLABEL, or up to the REPEAT.
    fn section(
        &self,
        index: usize,
        first: &Label,
        last: Option<&Label>,
        is_block: bool,
    ) -> Option<std::ops::Range<usize>> {
        let labeled = |label: &Label| self.text.labeled(label, &self.within);
        let starts = labeled(first);
        // The label before counts; without one, that behind.
        let split = starts.partition_point(|own| *own < index);
        let start = starts[..split].last().or(starts[split..].first()).copied()?;
        if is_block {
            return Some(start..start + 1);
        }
        let behind = |label: &Label| {
            let lines = labeled(label);
            lines.get(lines.partition_point(|own| *own < start)).copied()
        };
        match last {
            Some(label) => behind(label).map(|end| start..end + 1),
            None => match behind(&Label::Name("ENDLABEL".to_owned())) {
                Some(end) if end < index || start > index => Some(start..end + 1),
                _ if start < index => Some(start..index),
                _ => None,
            },
        }
    }

    /// P3 or P=expression; 1 without it.
    pub(super) fn times(&mut self, line: Line<'a>, at: usize) -> Option<(u32, usize)> {
        let start = blanks(line.text, at);
        if !matches!(line.text.get(start), Some(b'P' | b'p')) {
            return Some((1, at));
        }
        let (value, end) =
            self.read(
                line,
                start + 1,
                |reader| {
                    if reader.take(b'=') { reader.number() } else { reader.literal() }
                },
            )?;
        if value.fract() == 0.0 && (0.0..=f64::from(i32::MAX)).contains(&value) {
            return Some((value as u32, end));
        }
        self.stop(line.refusal(start, end, Fault::OutOfRange(value)));
        None
    }
}

/// The variable that an expression would set.
fn read_variable(reader: &mut Reader<'_, '_>) -> Result<Variable, Fault> {
    reader.skip_blanks();
    match reader.name() {
        Some(name) => reader.variable(name, 0),
        None if matches!(reader.peek(), Some(b'R' | b'r')) => reader.parameter(0),
        None => Err(Fault::BadExpression),
    }
}

fn way(name: &str) -> Option<Way> {
    Some(match name {
        "GOTOF" => Way::Forward,
        "GOTOB" => Way::Backward,
        "GOTO" => Way::Both,
        "GOTOC" => Way::IfFound,
        _ => return None,
    })
}

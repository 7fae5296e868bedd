//! CYCL DEF: cycles with numbers in the older form, and cycles with Q parameters.

use super::Execution;
use super::cursor::{Broken, Cursor};
use super::drilling::{Cycle, Drilling, RAPID, Values};
use super::parameters::Key;
use super::script::Block;
use super::words::Sort;
use crate::fault::Fault;
use crate::notes::Note;
use crate::placement::Coordinate;

/// The parameters that a cycle needs, and those that controls of some age do not have.
type Names = (&'static [u16], &'static [u16]);

impl<'a> Execution<'a, '_> {
    /// `CYCL DEF 200 ...` or `CYCL DEF 7.1 ...`.
    pub(super) fn define_cycle(&mut self, block: &Block<'a>, cursor: &mut Cursor<'_>) {
        cursor.skip_blanks();
        let start = cursor.at;
        let Some(number) = cursor.whole() else {
            return self.refuse(block, [start, cursor.word_end()], Fault::NoNumber);
        };
        if cursor.peek() == Some(b'.') {
            cursor.at += 1;
            let part = cursor.whole();
            let span = [start, cursor.at];
            match part {
                Some(0) => self.begin_older(block, number, span),
                Some(part) => self.go_on_older(block, cursor, (number, part), span),
                None => self.refuse(block, span, Fault::NoNumber),
            }
            return;
        }
        let span = [start, cursor.at];
        if let Some(values) = self.cycle_values(block, cursor, number, span) {
            self.put_in_cycle(block, number, values);
        }
    }

    /// `CYCL DEF 7.0 DATUM SHIFT`: the first block of a cycle of the older form.
    fn begin_older(&mut self, block: &Block<'a>, number: u32, span: [usize; 2]) {
        self.parts = vec![(number, 0.0)];
        match number {
            7..=11 | 26 => {}
            1 | 2 | 12 | 17 => {
                self.cycle = Some(Cycle::Refused);
                self.is_modal_call = false;
            }
            13 | 32 | 19 => self.machine.left.add(&format!("CYCL DEF {number}"), block.line().number),
            _ => {
                self.cycle = Some(Cycle::Refused);
                self.refuse(block, span, Fault::NotRead);
            }
        }
    }

    /// A later block of a cycle of the older form.
    fn go_on_older(
        &mut self,
        block: &Block<'a>,
        cursor: &mut Cursor<'_>,
        (number, part): (u32, u32),
        span: [usize; 2],
    ) {
        if self.parts.first().map(|(number, _)| *number) != Some(number) {
            return self.refuse(block, span, Fault::Lacks("the first block of the cycle"));
        }
        match number {
            7 => self.shift_datum(block, cursor),
            8 => self.mirror(block, cursor),
            9 => {
                if let Some((seconds, span)) = self.last_value(block, cursor) {
                    self.pause(block, seconds, span);
                }
            }
            10 => self.rotate(block, cursor),
            11 => self.scale(block, cursor),
            12 => self.name_program(block, cursor),
            26 => self.scale_axes(block, cursor),
            19 => self.reset_tilting(block, cursor),
            1 | 2 | 17 => {
                if let Some((value, _)) = self.last_value(block, cursor)
                    && self.parts.len() < 8
                {
                    self.parts.push((part, value));
                    self.put_in_older(block, number);
                }
            }
            // The first block has left it alone, or refused it.
            _ => {}
        }
    }

    /// The value at the end of a block, behind a name in any language.
    fn last_value(&mut self, block: &Block<'a>, cursor: &mut Cursor<'_>) -> Option<(f64, [usize; 2])> {
        let text = cursor.text;
        let mut at = text.len();
        let mut back = |is_part: &dyn Fn(u8) -> bool| {
            while at > cursor.at && is_part(text[at - 1]) {
                at -= 1;
            }
            at
        };
        back(&|c| c.is_ascii_digit() || matches!(c, b'.' | b','));
        let digits = back(&|_| false);
        let named = text[cursor.at..digits].iter().rev().take_while(|c| c.is_ascii_alphabetic()).count();
        let letters = &text[digits - named..digits];
        let kind = [b"QL".as_slice(), b"QR", b"Q"].into_iter().find(|kind| letters.ends_with(kind));
        let mut start = digits - kind.map_or(0, <[u8]>::len);
        if start > cursor.at && matches!(text[start - 1], b'+' | b'-') {
            start -= 1;
        }
        let name = &text[cursor.at..start];
        if name.iter().any(|c| c.is_ascii_digit() || matches!(c, b'+' | b'-')) {
            self.refuse(block, [cursor.at, text.len()], Fault::UnusedWord);
            return None;
        }
        let mut tail = Cursor { at: start, ..*cursor };
        match tail.value(&self.parameters) {
            Ok(value) => Some((value, [start, tail.at])),
            Err(broken) => {
                self.refuse_broken(block, broken);
                None
            }
        }
    }

    /// `CYCL DEF 12.1 PGM name`.
    fn name_program(&mut self, block: &Block<'a>, cursor: &mut Cursor<'_>) {
        cursor.phrase("PGM");
        match cursor.name() {
            Some(name) => {
                self.expect_end(block, cursor);
                self.cycle = Some(Cycle::Program(name));
            }
            None => self.refuse_block(block, Fault::NoProgram),
        }
    }

    /// Cycle 19: a plane that is not tilted.
    fn reset_tilting(&mut self, block: &Block<'a>, cursor: &mut Cursor<'_>) {
        let states_angles = !cursor.is_done() && matches!(cursor.peek(), Some(b'A' | b'B' | b'C'));
        let words = self.scan(block, cursor, &[Sort::Axis, Sort::Feed, Sort::Function]);
        let is_moved = words.axes.iter().any(|axis| !matches!(axis, None | Some(Coordinate::Absolute(0.0))));
        if is_moved {
            self.refuse_block(block, Fault::NotRead);
        }
        self.parameters.is_level = states_angles && !is_moved && !words.is_broken;
    }

    /// Reads the Q parameters of a cycle definition and sets them. Returns their values, or `None` where a
    /// value is refused.
    fn cycle_values(
        &mut self,
        block: &Block<'a>,
        cursor: &mut Cursor<'_>,
        number: u32,
        span: [usize; 2],
    ) -> Option<Values> {
        let Some((needed, others)) = names(number) else {
            self.refuse(block, span, Fault::NotRead);
            self.cycle = Some(Cycle::Refused);
            return None;
        };
        let mut values = Values::new();
        let mut is_broken = false;
        // The name of the cycle is no part of it, whatever its language.
        while !cursor.is_done() && !is_parameter(*cursor) {
            cursor.at = cursor.word_end();
        }
        while !cursor.is_done() && !self.machine.is_full() {
            let start = cursor.at;
            match self.cycle_value(cursor) {
                Ok((own, value)) if needed.contains(&own) || others.contains(&own) => {
                    let is_twice = values.insert(own, value).is_some();
                    if is_twice {
                        self.refuse(block, [start, cursor.at], Fault::Twice);
                        is_broken = true;
                    }
                }
                Ok(_) => {
                    self.refuse(block, [start, cursor.at], Fault::UnusedWord);
                    is_broken = true;
                }
                Err(broken) => {
                    cursor.at = cursor.word_end().max(broken.end).max(start + 1);
                    self.refuse_broken(block, Broken { start, end: cursor.at, ..broken });
                    is_broken = true;
                }
            }
        }
        if let Some(missing) = needed.iter().find(|own| !values.contains_key(own)).filter(|_| !is_broken) {
            self.refuse(block, span, Fault::LacksParameter(*missing));
            is_broken = true;
        }
        for (own, value) in &values {
            // All of these numbers are legal.
            let _ = self.parameters.set(Key::of_cycle(*own), Ok(*value));
        }
        if is_broken {
            self.cycle = Some(Cycle::Refused);
        }
        (!is_broken).then_some(values)
    }

    /// `Q200=+2`. A feed may be FMAX or FAUTO.
    fn cycle_value(&mut self, cursor: &mut Cursor<'_>) -> Result<(u16, f64), Broken> {
        let start = cursor.at;
        let fault = |cursor: &Cursor<'_>, fault| Broken { fault: Some(fault), start, end: cursor.word_end() };
        if !cursor.letters("Q") {
            return Err(fault(cursor, Fault::NoWord));
        }
        let number = cursor.whole().and_then(|number| u16::try_from(number).ok());
        let Some(number) = number.filter(|_| cursor.take(b'=')) else {
            return Err(fault(cursor, Fault::NoWord));
        };
        cursor.skip_blanks();
        if number == 208 && (cursor.phrase("FMAX") || cursor.phrase("MAX")) {
            return Ok((number, RAPID));
        }
        if matches!(number, 206 | 208) && (cursor.phrase("FAUTO") || cursor.phrase("AUTO")) {
            // In mm/min already.
            let unit = if self.machine.in_inches() { 2.54 } else { 1.0 };
            return self.auto_feed.map(|feed| (number, feed / unit)).ok_or(fault(cursor, Fault::NoFeed));
        }
        let value = cursor.value(&self.parameters)?;
        Ok((number, value))
    }

    fn put_in_cycle(&mut self, block: &Block<'a>, number: u32, values: Values) {
        match number {
            247 => self.select_preset(block, values.get(&339).copied().unwrap_or(-1.0)),
            220 | 221 => self.run_pattern(block, number, &values),
            _ => {
                self.is_modal_call = false;
                let in_inches = self.machine.in_inches();
                self.note_feeds(block);
                if number == 203 {
                    self.note_stop(block, &values);
                }
                self.cycle = Some(match Drilling::new(number, values, in_inches) {
                    Ok(drilling) => Cycle::Hole(Box::new(drilling)),
                    Err(fault) => {
                        self.refuse_block(block, fault);
                        Cycle::Refused
                    }
                });
            }
        }
    }

    /// Tells in which unit the feeds of cycles count.
    fn note_feeds(&mut self, block: &Block<'a>) {
        if self.machine.in_inches() {
            self.machine.note_first(Note::TenthsOfInch { line: block.line().number });
        }
    }

    /// Tells where the rapid down the hole of cycle 203 ends, which the manuals leave open.
    fn note_stop(&mut self, block: &Block<'a>, values: &Values) {
        let own = |number: u16| values.get(&number).copied().unwrap_or(0.0);
        if own(202) < -own(201) {
            let mm = own(200) * self.machine.unit_mm();
            self.machine.note_first(Note::PeckClearance { line: block.line().number, mm });
        }
    }

    /// Puts a cycle of the older form in force, once its last block is read.
    fn put_in_older(&mut self, block: &Block<'a>, number: u32) {
        let needed = match number {
            1 => 5,
            2 => 4,
            _ => 3,
        };
        if self.parts.len() != needed + 1 {
            return;
        }
        let is_in_order = self.parts[1..].iter().zip(1..).all(|((part, _), own)| *part == own);
        let values: Vec<f64> = self.parts[1..].iter().map(|(_, value)| *value).collect();
        self.note_feeds(block);
        let made = if is_in_order {
            Drilling::older(number, &values, self.machine.in_inches())
        } else {
            Err(Fault::Conflict)
        };
        match made {
            Ok(drilling) => self.cycle = Some(Cycle::Hole(Box::new(drilling))),
            Err(fault) => self.refuse_block(block, fault),
        }
    }
}

/// Whether a parameter of a cycle stands here.
fn is_parameter(mut cursor: Cursor<'_>) -> bool {
    cursor.letters("Q") && cursor.whole().is_some() && cursor.take(b'=')
}

/// The parameters of a cycle that is read.
fn names(number: u32) -> Option<Names> {
    Some(match number {
        200 => (&[200, 201, 206, 202, 203, 204], &[210, 211, 395]),
        201 => (&[200, 201, 206, 211, 208, 203, 204], &[]),
        202 => (&[200, 201, 206, 211, 208, 203, 204, 214], &[336]),
        203 => (&[200, 201, 206, 202, 203, 204, 208], &[210, 212, 213, 205, 211, 256, 395]),
        205 => (&[200, 201, 206, 202, 203, 204, 258, 259], &[212, 205, 257, 256, 211, 379, 253, 208, 395]),
        206 => (&[200, 201, 206, 211, 203, 204], &[]),
        207 => (&[200, 201, 239, 203, 204], &[]),
        209 => (&[200, 201, 239, 203, 204, 257, 256], &[336, 403]),
        220 => (&[216, 217, 244, 245, 246, 247, 241, 200, 203, 204, 301], &[365]),
        221 => (&[225, 226, 237, 238, 242, 243, 224, 200, 203, 204, 301], &[]),
        240 => (&[200, 343, 201, 344, 206, 211, 203, 204], &[342, 253]),
        247 => (&[339], &[]),
        _ => return None,
    })
}

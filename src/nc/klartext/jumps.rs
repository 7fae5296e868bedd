//! What a program computes and where it goes: formulas, FN functions, labels, calls and jumps.

use super::Execution;
use super::cursor::{Broken, Cursor};
use super::formula::Formula;
use super::parameters::Key;
use super::script::Block;
use crate::fault::Fault;

/// Part of two values by which they may differ through rounding alone.
const ROUNDING: f64 = 1e-9;

/// Most repeats that one call may state.
const MAX_REPEATS: f64 = 65_534.0;

impl<'a> Execution<'a, '_> {
    /// `Q1 = formula`.
    pub(super) fn assign(&mut self, block: &Block<'a>, cursor: &mut Cursor<'_>) {
        let start = cursor.at;
        let Some(key) = cursor.parameter() else {
            let end = cursor.word_end();
            return self.refuse(block, [start, end], Fault::NotRead);
        };
        let span = [start, cursor.at];
        if !cursor.take(b'=') {
            return self.refuse_block(block, Fault::BadExpression);
        }
        let mut formula = Formula { cursor: *cursor, parameters: &self.parameters };
        let value = formula.read();
        self.store(block, key, span, value);
    }

    fn store(&mut self, block: &Block<'a>, key: Key, span: [usize; 2], value: Result<f64, Broken>) {
        if let Err(broken) = value {
            self.refuse_broken(block, broken);
        }
        if let Err(fault) = self.parameters.set(key, value.map_err(|_| ())) {
            self.refuse(block, span, fault);
        }
    }

    /// `FN 0: Q1 = +5` and the other functions with numbers.
    pub(super) fn function_by_number(&mut self, block: &Block<'a>, cursor: &mut Cursor<'_>) {
        let start = cursor.at;
        cursor.skip_blanks();
        let number = cursor.whole();
        let span = [start, cursor.at];
        cursor.take(b':');
        match number {
            Some(number @ (0..=8 | 13)) => self.assign_by_number(block, cursor, number),
            Some(9..=12) => self.branch(block, cursor),
            Some(14) => self.stop(block.refused(Fault::Alarm)),
            Some(number @ (15 | 16 | 38)) => {
                self.machine.left.add(&format!("FN {number}"), block.line().number);
            }
            Some(18) => self.read_system(block, cursor),
            Some(17 | 19 | 20 | 26..=29 | 37) => self.refuse_block(block, Fault::NotRead),
            _ => self.refuse(block, span, Fault::UnknownCode),
        }
    }

    fn assign_by_number(&mut self, block: &Block<'a>, cursor: &mut Cursor<'_>, number: u32) {
        cursor.skip_blanks();
        let start = cursor.at;
        let Some(key) = cursor.parameter() else {
            let end = cursor.word_end();
            return self.refuse(block, [start, end], Fault::BadExpression);
        };
        let span = [start, cursor.at];
        if !cursor.take(b'=') {
            return self.refuse_block(block, Fault::BadExpression);
        }
        let value = Formula { cursor: *cursor, parameters: &self.parameters }.assigned(number);
        self.store(block, key, span, value);
    }

    /// FN 18: a parameter takes a value that only the control knows.
    fn read_system(&mut self, block: &Block<'a>, cursor: &mut Cursor<'_>) {
        let key = if cursor.phrase("SYSREAD") { cursor.parameter() } else { None };
        match key {
            Some(key) => {
                self.parameters.forget(key);
                self.machine.left.add("FN 18", block.line().number);
            }
            None => self.refuse_block(block, Fault::BadExpression),
        }
    }

    /// `IF a EQU b GOTO LBL n`. Without a certain condition nothing can follow.
    pub(super) fn branch(&mut self, block: &Block<'a>, cursor: &mut Cursor<'_>) {
        if !cursor.phrase("IF") {
            return self.stop(block.refused(Fault::BadExpression));
        }
        let is_true = match self.condition(cursor) {
            Ok(is_true) => is_true,
            Err(broken) => {
                self.refuse_broken(block, broken);
                self.has_ended = true;
                return;
            }
        };
        cursor.phrase("THEN");
        if !cursor.phrase("GOTO LBL") {
            return self.stop(block.refused(Fault::BadExpression));
        }
        let target = self.label(block, cursor);
        self.expect_end(block, cursor);
        if let (true, Some(target)) = (is_true, target) {
            self.jump(target);
        }
    }

    fn condition(&self, cursor: &mut Cursor<'_>) -> Result<bool, Broken> {
        let side = |cursor: &mut Cursor<'_>| {
            let mut formula = Formula { cursor: *cursor, parameters: &self.parameters };
            let value = formula.sum(0);
            cursor.at = formula.cursor.at;
            value
        };
        let a = side(cursor)?;
        cursor.skip_blanks();
        let start = cursor.at;
        let table = ["EQU", "NE", "GT", "LT", ">=", "<=", "<>", "!=", "==", ">", "<", "="];
        let Some(operator) = table.into_iter().find(|word| cursor.letters(word)) else {
            return Err(Broken { fault: Some(Fault::BadExpression), start, end: cursor.word_end() });
        };
        let b = side(cursor)?;
        let is_equal = a == b;
        if !is_equal && (a - b).abs() <= ROUNDING * (1.0 + a.abs().max(b.abs())) {
            // Which of the two is larger depends on how the control has rounded on the way.
            let fault = Fault::NoValue("both sides are equal but for rounding");
            return Err(Broken { fault: Some(fault), start, end: cursor.at });
        }
        Ok(match operator {
            "EQU" | "==" | "=" => is_equal,
            "NE" | "<>" | "!=" => !is_equal,
            "GT" | ">" => a > b,
            ">=" => a >= b,
            "<=" => a <= b,
            _ => a < b,
        })
    }

    /// The block of the label that is named here. A label that is not certain ends the run.
    fn label(&mut self, block: &Block<'a>, cursor: &mut Cursor<'_>) -> Option<usize> {
        cursor.skip_blanks();
        let start = cursor.at;
        let label = match cursor.peek() {
            Some(b'"' | b'0'..=b'9') => cursor.name(),
            Some(b'Q') => match cursor.value(&self.parameters) {
                Ok(number) => Some(number.to_string()),
                Err(broken) => {
                    self.refuse_broken(block, broken);
                    self.has_ended = true;
                    return None;
                }
            },
            _ => None,
        };
        let found = label.map_or(Err(Fault::NoLabel), |label| self.script.label(self.program, &label));
        match found {
            Ok(target) => Some(target),
            Err(fault) => {
                let end = cursor.word_end();
                self.stop(block.refusal(start, end, fault));
                None
            }
        }
    }

    /// `LBL n`.
    pub(super) fn meet_label(&mut self, block: &Block<'a>, cursor: &mut Cursor<'_>) {
        match cursor.name() {
            Some(label) => {
                self.expect_end(block, cursor);
                if label == "0" {
                    self.end_subprogram();
                }
            }
            None => self.refuse_block(block, Fault::NoLabel),
        }
    }

    /// `CALL LBL n`, with REP or without, and `CALL PGM name`.
    pub(super) fn call(&mut self, block: &Block<'a>, cursor: &mut Cursor<'_>) {
        if cursor.phrase("CALL PGM") {
            self.drop_approach();
            self.settle();
            match cursor.name() {
                Some(name) => {
                    self.expect_end(block, cursor);
                    self.call_program(block, &name);
                }
                None => self.stop(block.refused(Fault::NoProgram)),
            }
        } else if cursor.phrase("CALL LBL") {
            self.call_or_repeat(block, cursor);
        } else {
            self.stop(block.refused(Fault::NotRead));
        }
    }

    fn call_or_repeat(&mut self, block: &Block<'a>, cursor: &mut Cursor<'_>) {
        let Some(target) = self.label(block, cursor) else { return };
        cursor.skip_blanks();
        let start = cursor.at;
        let mut times = None;
        if cursor.letters("REP") && !cursor.is_done() {
            let value = match cursor.value(&self.parameters) {
                Ok(times) => times,
                Err(broken) => {
                    self.refuse_broken(block, broken);
                    self.has_ended = true;
                    return;
                }
            };
            times = Some(value);
            // Older controls show `REP 5/5`: repeats, and those that are left.
            if cursor.take(b'/') {
                cursor.whole();
            }
        }
        let span = [start, cursor.at];
        self.expect_end(block, cursor);
        match times {
            None => self.call_label(block, target),
            Some(times) if (1.0..=MAX_REPEATS).contains(&times) && times.fract() == 0.0 => {
                self.repeat(block, target, times as u32);
            }
            Some(times) => self.stop(block.refusal(span[0], span[1], Fault::OutOfRange(times))),
        }
    }
}

//! Calls, returns and the end of a program.

use super::{Block, Code, Fault, Function, Line, Machine, Next, WithoutPoint, WordValue};

/// G words that may stand beside G65, in tenths: motions, planes, units, and absolute or incremental.
const BESIDE_CALLS: [i32; 11] = [0, 10, 20, 30, 170, 180, 190, 200, 210, 900, 910];

impl Machine<'_> {
    /// G65: calls a macro. All other words are its arguments, which are used where the call is made; they do
    /// nothing else.
    pub(super) fn macro_call(&mut self, line: Line<'_>, block: &mut Block, call: Code) -> Next {
        // A word of M would be argument 13. Other G words than these would act beside the call.
        let acts = |code: &Code| code.tenths != call.tenths && !BESIDE_CALLS.contains(&code.tenths);
        if let Some(other) = block.m.first().or(block.g.iter().find(|code| acts(code))).copied() {
            self.refuse_code(line, other, Fault::Conflict);
            return Next::Stop;
        }
        let (program, times) = (block.take(b'P'), block.take(b'L'));
        let Some(program) = program else {
            self.refuse(line.refused(Fault::Missing('P')));
            return Next::Stop;
        };
        for (_, slot) in block.unused() {
            let is_ambiguous = slot.lacks_point && slot.value != 0.0 && self.control.points_matter;
            if is_ambiguous && self.setting.without_point == WithoutPoint::Increments {
                self.refuse_word(line, slot, Fault::NoPoint);
            }
        }
        self.called(line, program, times)
            .map_or(Next::Stop, |(program, times)| Next::Macro { program, times })
    }

    pub(super) fn called(
        &mut self,
        line: Line<'_>,
        program: WordValue,
        times: Option<WordValue>,
    ) -> Option<(u32, u32)> {
        let whole = |slot: WordValue| {
            let is_whole = (0.0..=99_999_999.0).contains(&slot.value) && slot.value.fract() == 0.0;
            is_whole.then_some(slot.value as u32)
        };
        let mut of = |slot: WordValue| {
            let number = whole(slot);
            if number.is_none() {
                self.refuse_word(line, slot, Fault::OutOfRange(slot.value));
            }
            number
        };
        Some((of(program)?, times.map_or(Some(1), &mut of)?))
    }

    /// Ends, calls and returns, after everything else in the block.
    pub(super) fn leave_or_go(
        &mut self,
        line: Line<'_>,
        block: &mut Block,
        functions: &[(Code, Function)],
    ) -> Next {
        let mut next = Next::Block;
        for (code, function) in functions {
            next = match function {
                Function::End => Next::End,
                Function::Call | Function::LocalCall => {
                    let (program, times) = (block.take(b'P'), block.take(b'L'));
                    let Some(program) = program else {
                        self.refuse_code(line, *code, Fault::Missing('P'));
                        return Next::Stop;
                    };
                    let is_local = *function == Function::LocalCall;
                    match self.called(line, program, times) {
                        Some((program, times)) => Next::Call { program, times, is_local },
                        None => Next::Stop,
                    }
                }
                Function::Return => match block.take(b'P') {
                    None => Next::Return { label: None },
                    Some(slot) => match self.called(line, slot, None) {
                        Some((label, _)) => Next::Return { label: Some(label) },
                        None => Next::Stop,
                    },
                },
                _ => continue,
            };
        }
        next
    }
}

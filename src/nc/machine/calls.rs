//! Calls, returns and the end of a program.

use super::{Block, Code, Fault, Function, Line, Machine, Next, WithoutPoint, WordValue};

impl Machine<'_> {
    /// G65: calls a macro. Its arguments are used where the call is made.
    pub(super) fn macro_call(&mut self, line: Line<'_>, block: &mut Block) -> Next {
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

//! `TOOL CALL`: the tool and the speed of the spindle.

use super::super::number::Number;
use super::super::{Step, TipMode};
use super::Reader;
use crate::nc::{Fault, WordFault};

/// The control has no tool of a larger number.
const MAX_TOOL: u32 = 32_767;

impl Reader<'_> {
    /// `CALL 3 Z S12000`, or `CALL Z S12000` for the speed alone.
    pub(super) fn tool_call(&mut self, tail: &str) -> Result<Option<Step>, Fault> {
        if self.mode != TipMode::Off {
            return Err(Fault::UnderTipControl);
        }
        let mut words = tail.split_ascii_whitespace().peekable();
        if words.next() != Some("CALL") {
            return Err(Fault::UnknownBlock);
        }
        // Without a number, the block changes the speed alone.
        let tool = match words.next_if(|word| *word != "Z") {
            Some(tool) => {
                let tool = Number::whole_of(tool).and_then(Number::count);
                Some(tool.ok_or(Fault::Word("TOOL CALL", WordFault::Number))?)
            }
            None => None,
        };
        if words.next() != Some("Z") || tool.is_none() && words.peek().is_none() {
            return Err(Fault::UnknownBlock);
        }
        if tool.is_some_and(|tool| tool > MAX_TOOL) {
            return Err(Fault::Word("TOOL CALL", WordFault::Range));
        }
        if let Some(word) = words.next() {
            let speed = word.strip_prefix('S').ok_or(Fault::UnknownBlock)?;
            let speed = Number::whole_of(speed).ok_or(Fault::Word("S", WordFault::Number))?;
            let numbers = &self.dialect.numbers;
            if speed.sign.is_some() || speed.decimals() > usize::from(numbers.spindle_decimals) {
                return Err(Fault::Word("S", WordFault::Form));
            }
            if !(speed.value > 0.0 && speed.value <= f64::from(numbers.max_spindle_rpm)) {
                return Err(Fault::Word("S", WordFault::Range));
            }
            self.state.speed_rpm = Some(speed.value);
        }
        if words.next().is_some() {
            return Err(Fault::UnknownBlock);
        }
        if let Some(tool) = tool {
            // Number 0 stands for no tool.
            self.has_tool = tool > 0;
            self.at[2] = None;
            if self.is_strict && self.state.tool.is_some() {
                // The change may run a program of its own.
                (self.at, self.feed) = ([None; 3], None);
            }
            self.state.change_tool(Some(tool));
        }
        Ok(None)
    }
}

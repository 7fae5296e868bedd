//! M70 to M73 of LinuxCNC: a program saves its modal state, and restores it.
//!
//! # Method
//! Each level of calls has a state of its own. M70 saves, M71 forgets, M72 restores. M73 saves, and the end
//! of the subprogram restores.

use super::{Block, Execution, Family, Fault, Line};

/// M70, M71, M72 and M73 in tenths.
const CODES: std::ops::RangeInclusive<i32> = 700..=739;

impl<'a> Execution<'a, '_> {
    /// Runs a block of M70 to M73. False for other blocks.
    pub(super) fn keep_modes(&mut self, line: Line<'a>, block: &Block) -> bool {
        let code = block.m.iter().copied().find(|code| CODES.contains(&code.tenths));
        let Some(code) = code.filter(|_| self.machine.control.is(Family::LinuxCnc)) else { return false };
        let has_words = block.unused().any(|(letter, _)| letter != b'N');
        let is_alone = block.g.is_empty() && block.m.len() == 1 && block.assignments.is_empty();
        if has_words || !is_alone {
            // The order in which the words of such a block take effect matters.
            self.machine.refuse(line.refusal(code.start, code.end, Fault::Conflict));
            return true;
        }
        let modes = self.machine.modes();
        let (saved, restores) = match self.calls.last_mut() {
            Some(call) => (&mut call.saved, Some(&mut call.restores)),
            None => (&mut self.saved, None),
        };
        match code.tenths {
            700 | 730 => {
                *saved = Some(modes);
                if let Some(restores) = restores {
                    *restores |= code.tenths == 730;
                }
            }
            710 => *saved = None,
            720 => match *saved {
                Some(modes) => self.machine.restore_modes(line, &modes),
                None => self.machine.refuse(line.refusal(code.start, code.end, Fault::NothingSaved)),
            },
            _ => self.machine.refuse(line.refusal(code.start, code.end, Fault::UnknownCode)),
        }
        true
    }
}

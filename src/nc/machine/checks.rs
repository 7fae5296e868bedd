//! Codes and words that are refused, or left alone and counted.

use super::{AXES, Block, Code, Fault, Function, Line, Machine, Meaning, Next, function_group, group};

impl Machine<'_> {
    /// Refuses codes that are unknown, not read, or exclude each other.
    pub(super) fn check_codes(&mut self, line: Line<'_>, block: &Block, meanings: &[(Code, Meaning)]) {
        let mut groups: Vec<u8> = Vec::new();
        for (code, meaning) in meanings {
            match meaning {
                Meaning::Unknown => self.refuse_code(line, *code, Fault::UnknownCode),
                Meaning::NotRead => self.refuse_code(line, *code, Fault::NotRead),
                _ => {}
            }
            let is_repeated = block.g.iter().filter(|other| other.tenths == code.tenths).count() > 1;
            let Some(group) = group(*meaning, self.control) else {
                if is_repeated && self.control.is_strict {
                    self.refuse_code(line, *code, Fault::Conflict);
                }
                continue;
            };
            // Fanuc and its kind let the last code of a group count; two different moves stay unclear.
            if groups.contains(&group) && (self.control.is_strict || matches!(group, 0 | 1 | 3 | 4)) {
                self.refuse_code(line, *code, Fault::Conflict);
            }
            groups.push(group);
        }
        if self.control.is_strict && groups.contains(&0) && groups.contains(&1) && block.has(&AXES) {
            let takes = |meaning: &Meaning| {
                matches!(meaning, Meaning::SetData | Meaning::Home | Meaning::Local | Meaning::SetPlace)
            };
            if let Some((code, _)) = meanings.iter().find(|(_, meaning)| takes(meaning)) {
                self.refuse_code(line, *code, Fault::Conflict);
            }
        }
    }

    /// Counts codes that are left alone, and refuses M codes that are unknown or exclude each other. Whether
    /// there were any that are left alone.
    pub(super) fn leave_codes(
        &mut self,
        line: Line<'_>,
        meanings: &[(Code, Meaning)],
        functions: &[(Code, Function)],
    ) -> bool {
        let mut leaves = false;
        for (code, meaning) in meanings {
            if *meaning == Meaning::LeftAlone {
                self.leave_code(line, 'G', code.tenths);
                leaves = true;
            }
        }
        let mut groups: Vec<u8> = Vec::new();
        for (code, function) in functions {
            let group = function_group(code.tenths).filter(|_| self.control.is_strict);
            if let Some(group) = group {
                if groups.contains(&group) {
                    self.refuse_code(line, *code, Fault::Conflict);
                }
                groups.push(group);
            }
            match function {
                Function::LeftAlone => {
                    self.leave_code(line, 'M', code.tenths);
                    leaves = true;
                }
                Function::NotRead => self.refuse_code(line, *code, Fault::NotRead),
                Function::Unknown => self.refuse_code(line, *code, Fault::UnknownCode),
                _ => {}
            }
        }
        leaves
    }

    /// Words that nothing has used are refused, or left alone beside a code that is left alone.
    pub(super) fn check_unused(&mut self, line: Line<'_>, block: &Block, leaves: bool, next: Next) {
        if let Next::Macro { .. } = next {
            return;
        }
        for (letter, slot) in block.unused() {
            match letter {
                b'A' | b'B' | b'C' if slot.value == 0.0 => {
                    self.left.add(&format!("{}0", char::from(letter)), line.number);
                }
                b'A' | b'B' | b'C' | b'U' | b'V' | b'W' => self.refuse_word(line, slot, Fault::OtherAxis),
                // On LinuxCNC and GRBL no code that is left alone takes the centre of an arc.
                b'I' | b'J' | b'K' if self.control.is_strict => {
                    self.refuse_word(line, slot, Fault::UnusedWord);
                }
                _ if leaves && !AXES.contains(&letter) => {
                    self.left.add(&char::from(letter).to_string(), line.number);
                }
                // Fanuc and its kind ignore numbers of offsets without a code that uses them.
                b'D' | b'H' if !self.control.is_strict => {
                    self.left.add(&char::from(letter).to_string(), line.number);
                }
                _ => self.refuse_word(line, slot, Fault::UnusedWord),
            }
        }
    }
}

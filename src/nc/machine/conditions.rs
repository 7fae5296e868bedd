//! Feeds, speeds, tools and pauses.

use super::{
    Block, Code, DwellTime, Family, Fault, FeedMode, Function, LONG_DWELL_S, Line, MAX_DWELL_S, Machine,
    Meaning, Note, WordValue,
};

impl Machine<'_> {
    pub(super) fn take_feed_and_speed(
        &mut self,
        line: Line<'_>,
        block: &mut Block,
        meanings: &[(Code, Meaning)],
        unit_before_mm: f64,
    ) {
        let is_dwell = meanings.iter().any(|(_, meaning)| *meaning == Meaning::Dwell);
        let feed_is_time = is_dwell && self.control.dwell_letters.contains(&b'F');
        if self.feed_mode == FeedMode::InverseTime {
            self.feed = None;
        }
        if let Some(slot) = block.peek(b'F').filter(|_| !feed_is_time) {
            block.use_up(b"F");
            if slot.value < 0.0 {
                self.refuse_word(line, slot, Fault::OutOfRange(slot.value));
            }
            let unit = match self.feed_mode {
                FeedMode::InverseTime => 1.0,
                // LinuxCNC takes F before a G20 or G21 of the same block.
                _ if self.control.is(Family::LinuxCnc) => unit_before_mm,
                _ => self.unit_mm(),
            };
            self.feed = Some(slot.value * unit);
        }
        // On Fanuc `G92 S` limits the speed.
        let limits = !self.control.is_strict && block.has_g(920);
        if let Some(slot) = block.take(b'S') {
            if slot.value < 0.0 {
                self.refuse_word(line, slot, Fault::OutOfRange(slot.value));
            } else if limits {
                self.left.add("S", line.number);
            } else {
                self.speed = Some(slot.value);
            }
        }
    }

    pub(super) fn change_tool(&mut self, line: Line<'_>, block: &mut Block, functions: &[(Code, Function)]) {
        let has = |wanted| functions.iter().find(|(_, function)| *function == wanted).map(|(code, _)| *code);
        if let Some(slot) = block.take(b'T') {
            if slot.value < 0.0 || slot.value > 99_999_999.0 || slot.value.fract() != 0.0 {
                self.refuse_word(line, slot, Fault::OutOfRange(slot.value));
            } else {
                self.called_tool = Some(slot.value as u32);
            }
        }
        if let Some(code) = has(Function::SetTool) {
            match block.take(b'Q') {
                Some(slot) => self.tool = Some(slot.value as u32),
                None => self.refuse_code(line, code, Fault::Missing('Q')),
            }
        }
        if let Some(code) = has(Function::ToolChange) {
            let Some(number) = self.called_tool else {
                if self.control.is(Family::LinuxCnc) {
                    self.refuse_code(line, code, Fault::Missing('T'));
                }
                self.left.add("M6", line.number);
                return;
            };
            self.put_in_tool(line, Some(number), None);
        }
    }

    /// Changes the tool, which has a number or a name.
    pub(crate) fn put_in_tool(&mut self, line: Line<'_>, number: Option<u32>, name: Option<String>) {
        self.exclude_compensation(line);
        self.tool = number;
        self.record.change_tool(number, name, line.number);
        // Another tool has another length, and machines change tools at a height of their own.
        self.at[2] = None;
        self.cycle = None;
    }

    pub(super) fn dwell(&mut self, line: Line<'_>, block: &mut Block) {
        let letter = self.control.dwell_letters.iter().find(|letter| block.has(&[**letter]));
        let Some(letter) = letter.copied() else {
            self.refuse(line.refused(Fault::Missing(char::from(self.control.dwell_letters[0]))));
            return;
        };
        let Some(slot) = block.take(letter) else { return };
        if let Some(seconds) = self.dwell_s(line, slot, letter) {
            self.pause(line, slot, seconds);
        }
    }

    /// The seconds of the time of a dwell.
    pub(super) fn dwell_s(&mut self, line: Line<'_>, slot: WordValue, letter: u8) -> Option<f64> {
        let by_letter = letter != b'P';
        let factor = match self.control.dwell {
            DwellTime::Milliseconds if by_letter => {
                let before = self.points;
                let factor = self.increment(line, slot);
                self.points = before;
                if factor == 1.0 { 1.0 } else { 1e-3 }
            }
            DwellTime::Milliseconds if !slot.lacks_point && slot.value.fract() != 0.0 => {
                self.refuse_word(line, slot, Fault::OutOfRange(slot.value));
                return None;
            }
            DwellTime::Milliseconds => 1e-3,
            DwellTime::ByPoint if slot.lacks_point => 1e-3,
            DwellTime::ByPoint | DwellTime::Seconds => 1.0,
        };
        let seconds = slot.value * factor;
        if !(0.0..=MAX_DWELL_S).contains(&seconds) {
            self.refuse_word(line, slot, Fault::OutOfRange(slot.value));
            return None;
        }
        Some(seconds)
    }

    pub(crate) fn pause(&mut self, line: Line<'_>, slot: WordValue, seconds: f64) {
        let word = || String::from_utf8_lossy(&line.text[slot.start..slot.end]).into_owned();
        if self.control.dwell_is_unsure && slot.lacks_point && slot.value != 0.0 {
            self.note(Note::DwellAssumed { line: line.number, word: word(), seconds });
        }
        if seconds > LONG_DWELL_S {
            let minutes = seconds / 60.0;
            self.note(Note::LongDwell { line: line.number, word: word(), seconds, minutes });
        }
        let dwelt = match self.pause_compensated(seconds, line) {
            Ok(false) => self.record.dwell(seconds, line.number),
            result => result.map(|_| ()),
        };
        if let Err(error) = dwelt {
            self.refuse_path(line, error);
        }
    }
}

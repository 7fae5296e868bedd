//! Lengths of tools, work offsets, shifts, and the ways to places of the machine.

use super::{AXES, At, Block, Code, Family, Fault, Line, Machine, Meaning, Note, WordValue};
use crate::frames::{EXTENDED, name};
use crate::placement::Coordinate;

impl Machine<'_> {
    /// G43, G44 and G49. Another length puts the tip to a height that is not known.
    pub(super) fn select_lengths(&mut self, line: Line<'_>, block: &mut Block, meanings: &[(Code, Meaning)]) {
        for (code, meaning) in meanings {
            let Meaning::Length(is_on) = meaning else { continue };
            let is_dynamic = code.tenths == 431 || code.tenths == 432;
            let number = match block.peek(b'H') {
                _ if !is_on => Some(0),
                // G43.1 has lengths of its own instead of a number.
                _ if is_dynamic => None,
                Some(slot) => {
                    block.use_up(b"H");
                    if slot.value < 0.0 || slot.value.fract() != 0.0 {
                        self.refuse_word(line, slot, Fault::OutOfRange(slot.value));
                    }
                    Some(slot.value as i64)
                }
                None if self.control.is(Family::LinuxCnc) => self.tool().map(i64::from),
                // G44 counts the other way.
                None => None,
            };
            let number = if code.tenths == 440 { number.map(|number| -number) } else { number };
            if number.is_none() || number != self.length {
                self.at[2] = None;
            }
            self.length = number;
            if is_dynamic {
                block.use_up(&AXES);
            }
        }
    }

    /// G54 to G59.3, G54.1 and G154.
    pub(super) fn select_offsets(&mut self, line: Line<'_>, block: &mut Block, meanings: &[(Code, Meaning)]) {
        for (code, meaning) in meanings {
            let number = match meaning {
                Meaning::WorkOffset(number) => *number,
                Meaning::ExtendedOffset | Meaning::OffsetByH => {
                    let (letter, first) =
                        if *meaning == Meaning::OffsetByH { (b'H', 0) } else { (b'P', EXTENDED) };
                    match block.take(letter) {
                        None => {
                            self.refuse_code(line, *code, Fault::Missing(char::from(letter)));
                            continue;
                        }
                        Some(slot) if (1.0..=300.0).contains(&slot.value) && slot.value.fract() == 0.0 => {
                            first + slot.value as u32
                        }
                        Some(slot) => {
                            self.refuse_word(line, slot, Fault::OutOfRange(slot.value));
                            continue;
                        }
                    }
                }
                _ => continue,
            };
            self.select_offset(line, number);
        }
    }

    /// A work offset comes into force, with its turn.
    pub(super) fn select_offset(&mut self, line: Line<'_>, number: u32) {
        let before = self.frames.frame();
        self.frames.select(number, &mut self.at);
        if before != self.frames.frame() && self.record.has_moves() {
            self.note(Note::UnrelatedOffset { line: line.number, offset: name(number) });
        }
        self.turn_with_offset(line);
    }

    /// Refuses a shift by G52, G92 or G10 L20 where a turn of the work offset is in force: the turn would
    /// take the shift along.
    fn excludes_turn(&mut self, line: Line<'_>) -> bool {
        let is_turned = self.frames.degrees() != 0.0;
        if is_turned {
            self.refuse(line.refused(Fault::ShiftInTurn));
        }
        is_turned
    }

    /// The lengths of the axis words of a block, mm.
    fn axis_lengths(&mut self, line: Line<'_>, block: &mut Block) -> [Option<f64>; 3] {
        let slots: [Option<WordValue>; 3] = AXES.map(|letter| block.take(letter));
        slots.map(|slot| slot.map(|slot| self.length_mm(line, slot)))
    }

    /// G10. Other data than work offsets is left alone.
    pub(super) fn set_data(&mut self, line: Line<'_>, block: &mut Block) {
        let Some(kind) = block.take(b'L') else {
            self.refuse(line.refused(Fault::Missing('L')));
            return;
        };
        let number = block.take(b'P').map(|slot| slot.value);
        let is_known = [0.0, 1.0, 2.0, 10.0, 11.0, 20.0].contains(&kind.value);
        if self.control.is(Family::LinuxCnc) && !is_known {
            block.use_up(b"XYZRIJKQABCD");
            return self.refuse_word(line, kind, Fault::OutOfRange(kind.value));
        }
        let follows_linuxcnc = self.control.is_strict || self.control.is(Family::Mach);
        let is_offset = kind.value == 2.0 || kind.value == 20.0;
        if !is_offset {
            self.left.add(&format!("G10 L{}", kind.value), line.number);
            block.use_up(b"XYZRIJKQABCD");
            if self.length != Some(0) {
                self.at[2] = None;
                self.length = None;
            }
            return;
        }
        let turn = block.take(b'R');
        if let Some(slot) = turn {
            let is_linuxcnc = self.control.is(Family::LinuxCnc);
            if is_linuxcnc && kind.value == 20.0 {
                self.refuse_word(line, slot, Fault::UnusedWord);
            } else if !is_linuxcnc && slot.value != 0.0 {
                self.refuse_word(line, slot, Fault::NotRead);
            }
        }
        if kind.value == 20.0 && self.excludes_turn(line) {
            block.use_up(&AXES);
            return;
        }
        let extended = kind.value == 20.0 && !follows_linuxcnc;
        let last = if self.control.is(Family::LinuxCnc) { 9.0 } else { 300.0 };
        let number = match number {
            Some(number) if number.fract() != 0.0 || !(0.0..=last).contains(&number) => None,
            Some(0.0) if follows_linuxcnc => Some(self.frames.active()),
            // P0 moves the zeros of all work offsets.
            Some(0.0) | None => None,
            Some(number) if extended => Some(EXTENDED + number as u32),
            Some(number) => Some(number as u32),
        };
        let Some(number) = number else {
            self.refuse(line.refused(Fault::UnknownOffset));
            return;
        };
        let lengths = self.axis_lengths(line, block);
        let before = self.frames.frame();
        for (axis, length) in lengths.into_iter().enumerate() {
            let Some(mm) = length else { continue };
            if kind.value == 20.0 && follows_linuxcnc {
                self.frames.place_zero_by_tool(number, axis, mm, &mut self.at);
            } else if !self.is_absolute && !follows_linuxcnc {
                // Adds to a zero that is not known.
                self.refuse(line.refused(Fault::UnknownOffset));
                return;
            } else {
                self.frames.place_zero(number, axis, mm, &mut self.at);
            }
        }
        self.note_frames(line, before);
        if let Some(slot) = turn.filter(|_| self.control.is(Family::LinuxCnc)) {
            self.frames.turn(number, slot.value);
            self.turn_with_offset(line);
        }
    }

    fn note_frames(&mut self, line: Line<'_>, before: [u32; 3]) {
        if before != self.frames.frame() && self.record.has_moves() {
            self.note(Note::UnrelatedPlace { line: line.number });
        }
    }

    /// G52: a zero beside the work offset's.
    pub(super) fn shift_locally(&mut self, line: Line<'_>, block: &mut Block) {
        if self.lacks_axes(line, block) || self.excludes_turn(line) {
            block.use_up(&AXES);
            return;
        }
        for (axis, length) in self.axis_lengths(line, block).into_iter().enumerate() {
            if let Some(mm) = length {
                self.frames.shift_locally(axis, mm);
            }
        }
    }

    /// Whether a block names no axis, which strict controls refuse where a code needs one.
    fn lacks_axes(&mut self, line: Line<'_>, block: &Block) -> bool {
        let lacks = self.control.is_strict && !block.has(&AXES);
        if lacks {
            self.refuse(line.refused(Fault::NoAxis));
        }
        lacks
    }

    /// G92: the coordinates of where the tool stands.
    pub(super) fn set_place(&mut self, line: Line<'_>, block: &mut Block) {
        if self.lacks_axes(line, block) || self.excludes_turn(line) {
            block.use_up(&AXES);
            return;
        }
        let before = self.frames.frame();
        for (axis, length) in self.axis_lengths(line, block).into_iter().enumerate() {
            if let Some(mm) = length {
                self.frames.set(axis, mm, &mut self.at);
            }
        }
        self.note_frames(line, before);
    }

    /// G92.1, G92.2 and G92.3.
    pub(super) fn unset_place(&mut self, meaning: Meaning, axes: [bool; 3]) {
        match meaning {
            Meaning::UnsetPlace { keeps } => self.frames.unset(axes, keeps, &mut self.at),
            _ => self.frames.restore(),
        }
    }

    /// G28 and G30: by way of the given place to a place of the machine.
    pub(super) fn go_home(&mut self, line: Line<'_>, block: &mut Block) {
        block.use_up(b"P");
        let has_axes = block.has(&AXES);
        let named = AXES.map(|letter| !has_axes || block.has(&[letter]));
        let way = self.target(line, block);
        self.rapid(line, way);
        for axis in (0..3).filter(|axis| named[*axis]) {
            self.at[axis] = None;
        }
        self.record.n_rapids_not_counted += 1;
    }

    /// The place that a block under G53 names.
    pub(super) fn machine_target(&mut self, line: Line<'_>, block: &mut Block) -> At {
        let lengths = self.axis_lengths(line, block);
        let mut to = self.at;
        for axis in 0..3 {
            if let Some(mm) = lengths[axis] {
                to[axis] = self.frames.of_machine(axis, mm);
            }
        }
        to
    }

    /// The place that the axis words of a block name; the place of the tool along other axes.
    pub(super) fn target(&mut self, line: Line<'_>, block: &mut Block) -> At {
        let words = AXES.map(|letter| block.take(letter));
        self.target_of(line, words)
    }

    /// The place that axis words name.
    pub(super) fn target_of(&mut self, line: Line<'_>, words: [Option<WordValue>; 3]) -> At {
        if let Some(to) = self.polar_target(line, words) {
            return to;
        }
        let lengths = words.map(|word| word.map(|slot| self.length_mm(line, slot)));
        let is_absolute = self.is_absolute;
        self.placed(lengths.map(|length| {
            length.map(|mm| if is_absolute { Coordinate::Absolute(mm) } else { Coordinate::Relative(mm) })
        }))
    }

    /// The place that coordinates of the program name; along other axes the tool keeps its coordinates of
    /// the program.
    pub(crate) fn placed(&self, coordinates: [Option<Coordinate>; 3]) -> At {
        if coordinates == [None; 3] {
            return self.at;
        }
        let shifts = [0, 1, 2].map(|axis| self.frames.shift(axis));
        let is_plain = self.placement.is_plain();
        let in_program = if is_plain {
            self.at
        } else {
            self.placement.back(&[0, 1, 2].map(|k| self.at[k].map(|at| at - shifts[k])))
        };
        let to = [0, 1, 2].map(|k| match coordinates[k] {
            None => in_program[k],
            Some(Coordinate::Relative(mm)) => in_program[k].map(|at| at + mm),
            Some(Coordinate::Absolute(mm)) if is_plain => Some(mm + shifts[k]),
            Some(Coordinate::Absolute(mm)) => Some(mm),
        });
        if is_plain {
            return to;
        }
        let to = self.placement.place(&to);
        [0, 1, 2].map(|k| to[k].map(|at| at + shifts[k]))
    }
}

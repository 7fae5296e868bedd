//! What a block is, by its first words.
//!
//! # Guarantees
//! A block that is not known here is refused. What cannot move the tool is left alone and counted.

use super::Execution;
use super::cursor::Cursor;
use super::script::Block;
use super::words::Sort;
use crate::block::WordValue;
use crate::fault::Fault;

/// Longest pause, s: a day.
const MAX_DWELL_S: f64 = 86_400.0;

/// Blocks that cannot move the tool, by their first words.
const LEFT_ALONE: [&str; 9] = [
    "BLK FORM",
    "FUNCTION MODE MILL",
    "FUNCTION PROG PATH IS CONTOUR",
    "FUNCTION PROG PATH OFF",
    "FUNCTION FEED DWELL",
    "FUNCTION FEED RESET",
    "FUNCTION S-PULSE",
    "FUNCTION COUNT",
    "FUNCTION RESET TCPM",
];

/// Blocks that move the tool, or change where or how it moves, and are not read.
const MOVING: [&str; 22] = [
    "LN", "SPL", "FL", "FLT", "FC", "FCT", "FPOL", "FLP", "FSELECT", "FUNCTION", "PLANE", "SEL", "CONTOUR",
    "TCH", "TRANS", "PRESET", "TABDATA", "DECLARE", "SECTION", "CORRDATA", "POLARKIN", "PATTERN",
];

impl<'a> Execution<'a, '_> {
    /// Runs a block.
    pub(super) fn step(&mut self, block: &Block<'a>) {
        if self.shift.is_some() {
            self.end_shift(block);
        }
        let mut cursor = Cursor::new(&block.text);
        let keyword = cursor.keyword();
        let after = Cursor { at: cursor.at + keyword.len(), ..cursor };
        if self.runs_in_path(block, cursor, after, keyword) {
            return;
        }
        self.drop_approach();
        self.settle();
        match keyword {
            b"BEGIN" if cursor.phrase("BEGIN PGM") => self.begin_program(block, &mut cursor),
            b"END" if cursor.phrase("END PGM") => self.end_program(),
            b"TOOL" if cursor.phrase("TOOL CALL") => self.call_tool(block, &mut cursor),
            b"TOOL" if cursor.phrase("TOOL DEF") => self.define_tool(block, &mut cursor),
            b"CYCL" if cursor.phrase("CYCL DEF") => self.define_cycle(block, &mut cursor),
            b"CYCL" if cursor.phrase("CYCL CALL") => self.call_cycles(block, &mut cursor),
            b"PATTERN" if cursor.phrase("PATTERN DEF") => self.define_pattern(block, &mut cursor),
            b"TRANS" if cursor.phrase("TRANS DATUM AXIS") => self.shift_datum(block, &mut cursor),
            b"TRANS" if cursor.phrase("TRANS DATUM RESET") => self.reset_shift(block, &mut cursor),
            b"FUNCTION" if cursor.phrase("FUNCTION DWELL TIME") => self.dwell_words(block, &mut cursor),
            b"PLANE" if cursor.phrase("PLANE RESET") => self.reset_plane(block, &mut cursor, false),
            b"PLANE" if self.is_plane_level(&mut cursor) => self.reset_plane(block, &mut cursor, true),
            b"STOP" | b"M" => {
                let at = if keyword == b"STOP" { after.at } else { cursor.at };
                self.functions_alone(block, Cursor { at, ..cursor });
            }
            _ => self.leave_or_refuse(block, cursor, keyword),
        }
    }

    /// Blocks that move, and those that may stand between two that do. False for all others.
    fn runs_in_path(
        &mut self,
        block: &Block<'a>,
        mut cursor: Cursor<'_>,
        mut after: Cursor<'_>,
        keyword: &[u8],
    ) -> bool {
        match keyword {
            b"L" | b"LP" => self.straight(block, &mut after, keyword == b"LP"),
            b"X" | b"Y" | b"Z" | b"IX" | b"IY" | b"IZ" => self.straight(block, &mut cursor, false),
            b"C" | b"CR" | b"CT" | b"CP" | b"CTP" => self.circle(block, &mut after, keyword),
            b"APPR" => self.approach(block, &mut after),
            b"DEP" => self.depart(block, &mut after),
            b"CC" => self.set_pole(block, &mut after),
            b"RND" | b"RNDR" => {
                after.at = cursor.at + 3;
                self.set_corner(block, &mut after, true);
            }
            b"CHF" => self.set_corner(block, &mut after, false),
            b"LBL" => self.meet_label(block, &mut after),
            b"CALL" => self.call(block, &mut cursor),
            b"FN" => self.function_by_number(block, &mut after),
            b"IF" => self.branch(block, &mut cursor),
            b"Q" | b"QL" | b"QR" | b"QS" => self.assign(block, &mut cursor),
            _ => return false,
        }
        true
    }

    /// `BEGIN PGM name MM`, or INCH.
    fn begin_program(&mut self, block: &Block<'a>, cursor: &mut Cursor<'_>) {
        // The name may have blanks.
        let text = cursor.text.trim_ascii_end();
        let unit = text.iter().rposition(|c| *c == b' ').map_or(0, |at| at + 1);
        cursor.at = unit.max(cursor.at);
        match (cursor.phrase("MM"), cursor.phrase("INCH")) {
            (true, false) => self.machine.set_units(false),
            (false, true) => self.machine.set_units(true),
            _ => return self.refuse_block(block, Fault::Lacks("MM or INCH")),
        }
        self.expect_end(block, cursor);
    }

    /// A block of M functions alone, or STOP.
    fn functions_alone(&mut self, block: &Block<'a>, mut cursor: Cursor<'_>) {
        let words = self.scan(block, &mut cursor, &[Sort::Function]);
        if cursor.text.starts_with(b"STOP") {
            self.machine.left.add("STOP", block.line().number);
        }
        let functions = self.begin_functions(block, &words);
        self.end_functions(block, &functions, false);
    }

    /// `FUNCTION DWELL TIME5`.
    fn dwell_words(&mut self, block: &Block<'a>, cursor: &mut Cursor<'_>) {
        let start = cursor.at;
        match cursor.value(&self.parameters) {
            Ok(seconds) => {
                self.pause(block, seconds, [start, cursor.at]);
                self.expect_end(block, cursor);
            }
            Err(broken) => self.refuse_broken(block, broken),
        }
    }

    /// A pause that the bytes `start..end` of a block state.
    pub(super) fn pause(&mut self, block: &Block<'a>, seconds: f64, [start, end]: [usize; 2]) {
        if !(0.0..=MAX_DWELL_S).contains(&seconds) {
            return self.refuse(block, [start, end], Fault::OutOfRange(seconds));
        }
        let (line, [start, end]) = block.place(start, end);
        let end = end.max(start);
        self.machine.pause(line, WordValue { value: seconds, start, end, lacks_point: false }, seconds);
    }

    /// `PLANE RESET`: the plane of the program is not tilted. Where rotary axes turn, the place is lost.
    fn reset_plane(&mut self, block: &Block<'a>, cursor: &mut Cursor<'_>, states_angles: bool) {
        self.parameters.is_level = states_angles;
        let rest = &cursor.text[cursor.at..];
        let has = |word: &[u8]| rest.windows(word.len()).any(|part| part == word);
        if has(b"MOVE") || has(b"TURN") {
            self.machine.at = [None; 3];
            self.forget_tangent();
        }
        self.machine.left.add("PLANE RESET", block.line().number);
    }

    /// Takes `PLANE SPATIAL SPA+0 SPB+0 SPC+0`, which tilts nothing.
    fn is_plane_level(&self, cursor: &mut Cursor<'_>) -> bool {
        let mut probe = *cursor;
        let is_level = probe.phrase("PLANE SPATIAL")
            && ["SPA", "SPB", "SPC"].iter().all(|name| {
                probe.skip_blanks();
                probe.letters(name) && probe.value(&self.parameters) == Ok(0.0)
            });
        cursor.at = if is_level { probe.at } else { cursor.at };
        is_level
    }

    fn leave_or_refuse(&mut self, block: &Block<'a>, mut cursor: Cursor<'_>, keyword: &[u8]) {
        if let Some(words) = LEFT_ALONE.into_iter().find(|words| cursor.phrase(words)) {
            let is_open = words == "BLK FORM" || words.contains("DWELL");
            if !is_open && !words.contains("PULSE") && !words.contains("COUNT") {
                self.expect_end(block, &mut cursor);
            }
            return self.machine.left.add(words, block.line().number);
        }
        let is_known = MOVING.iter().any(|word| word.as_bytes() == keyword);
        if is_known {
            self.refuse_block(block, Fault::NotRead);
        } else {
            let end = cursor.word_end();
            self.refuse(block, [cursor.at, end], Fault::NoWord);
        }
        self.lose_place();
    }
}

//! One block of letters, codes and names: what each word sets, in the order in which controls run them.

use std::borrow::Cow;

use super::super::table::{Row, Treatment};
use super::super::tokens::{Block, Word};
use super::super::{Fault, PathFault, Said, refusal, tool_number};
use super::Reader;
use super::words::{name_of, row_of};
use crate::nc::{Effect, effect, modal_group};
use toolpathd_core::toolpath::cutting::Coolant;
use toolpathd_core::toolpath::program::Units;

/// What one block says of its motion, in the units of the program.
#[derive(Debug, Default)]
pub(super) struct Line {
    pub at: [Option<f64>; 3],
    /// Of A, B and C, degrees.
    pub angles: [Option<f64>; 3],
    pub vector: [Option<f64>; 3],
    pub ijk: [Option<f64>; 3],
    pub radius: Option<f64>,
    pub has_feed: bool,
    pub is_rapid: bool,
    /// The word by which the coordinates are no place of the path.
    leaves: Option<String>,
    stops: Option<&'static str>,
    ends: bool,
    ends_spindle: bool,
    ends_coolant: bool,
    changes_tool: bool,
    begins_spindle: bool,
    begins_program: bool,
}

/// The parts of a block that its codes decide before the other words are read.
struct Codes<'a> {
    rows: Vec<(Cow<'a, str>, &'static Row)>,
}

impl Codes<'_> {
    fn takes(&self, word: &str) -> bool {
        self.rows.iter().any(|(_, row)| row.takes(word))
    }

    fn has(&self, name: &str) -> bool {
        self.rows.iter().any(|(own, _)| own == name)
    }
}

impl Reader<'_> {
    pub(super) fn block(&mut self, block: &Block, text: &str) -> Result<(), Fault> {
        let words = of_the_first_spindle(&block.words)?;
        let mut words = &*words;
        let is_klartext_line = words[0].value.is_none() && (words[0].name == "L" || words[0].name == "LN");
        if is_klartext_line {
            self.modal.apply(effect(10));
            words = &words[1..];
        } else if words[0].value.is_none() && self.statement(words, text)? {
            return Ok(());
        }
        let codes = self.codes(words)?;
        let mut line = Line::default();
        let mut seen = 0u32;
        for (k, (word, (name, row))) in words.iter().zip(&codes.rows).enumerate() {
            // The value of a letter that is an expression stands in the next word.
            let next = codes.rows.get(k + 1).filter(|_| word.value.is_none() && name.len() == 1);
            if let Some((next, row)) = next
                && row.treatment == Treatment::Refused
                && !next.starts_with(|c: char| c.is_ascii_alphabetic())
            {
                return Err(refusal(next, row).into());
            }
            if let (&[letter @ b'A'..=b'Z'], false) = (name.as_bytes(), name == "G" || name == "M") {
                let bit = 1 << (letter - b'A');
                if seen & bit != 0 {
                    return Err(PathFault::Twice(name.to_string()).into());
                }
                seen |= bit;
            }
            // Without arguments the call ends a turn of the plane.
            if name == "CYCLE800" && !text[word.place.clone()].ends_with("()") {
                return Err(refusal(name, row).into());
            }
            if name == "CYCLE800" || codes.takes(name) {
                continue;
            }
            if name == "T" && word.value.is_none() {
                self.named_tool(&text[word.place.clone()], &mut line);
                continue;
            }
            match row.treatment {
                Treatment::Refused => return Err(refusal(name, row).into()),
                Treatment::LeftAlone => {
                    self.trail.left_alone(name);
                    line.left_alone(name);
                }
                Treatment::Read => self.word(word, name, is_klartext_line, &mut line)?,
            }
        }
        self.run(words, &codes, line)
    }

    /// The rows of all words of a block.
    fn codes<'a>(&self, words: &'a [Word<'_>]) -> Result<Codes<'a>, PathFault> {
        let is_spline = |name: &str| name == "G5" || name == "G5.1";
        let has_place = words.iter().any(|word| ["X", "Y", "Z"].contains(&word.name.as_ref()));
        let mut rows: Vec<(Cow<'_, str>, &'static Row)> = Vec::with_capacity(words.len());
        let mut groups = 0u128;
        for word in words {
            let name = name_of(word);
            let row = match name.as_ref() {
                name if has_place && is_spline(name) => row_of(&format!("{name} X")),
                name => row_of(name),
            };
            // A refused word may have words of its own behind it.
            let row = row.ok_or_else(|| {
                let refused = rows.iter().find(|(_, row)| row.treatment == Treatment::Refused);
                refused.map_or(PathFault::Unknown(name.to_string()), |(own, row)| refusal(own, row))
            })?;
            if let ("G", Some(value)) = (word.name.as_ref(), word.value) {
                let tenths = (value * 10.0).round() as i32;
                let group = modal_group(tenths);
                // Cycles end beside a word of motion.
                if group < 100 && tenths != 800 && row.treatment == Treatment::Read {
                    if groups & 1 << group != 0 {
                        return Err(PathFault::Conflict);
                    }
                    groups |= 1 << group;
                }
            }
            rows.push((name, row));
        }
        Ok(Codes { rows })
    }

    /// A word that is read. What has an order among the words of its block is only noted.
    fn word(&mut self, word: &Word, name: &str, is_klartext: bool, line: &mut Line) -> Result<(), PathFault> {
        let Some(value) = word.value else {
            match name {
                "TRAORI" => self.set_tip(true)?,
                "TRAFOOF" => self.set_tip(false)?,
                "FMAX" => line.is_rapid = true,
                "ORIWKS" | "ORIVECT" => (self.turns_on_circle, self.has_second_point) = (true, false),
                "ORIAXES" => (self.turns_on_circle, self.has_second_point) = (false, false),
                "ORICURVE" => (self.has_second_point, self.second) = (true, None),
                "POLYPATH" => {}
                // Alone in its line, such a word only ends a mode.
                "TRANS" | "ROT" | "SCALE" | "MIRROR" | "ATRANS" | "AROT" => {}
                name => return Err(PathFault::NoNumber(name.to_owned())),
            }
            return Ok(());
        };
        match name {
            "X" => line.at[0] = Some(value),
            "Y" => line.at[1] = Some(value),
            "Z" => line.at[2] = Some(value),
            "A" => line.angles[0] = Some(value),
            "B" => line.angles[1] = Some(value),
            "C" => line.angles[2] = Some(value),
            "I" => line.ijk[0] = Some(value),
            "J" => line.ijk[1] = Some(value),
            "K" => line.ijk[2] = Some(value),
            "TX" | "A3" => line.vector[0] = Some(value),
            "TY" | "B3" => line.vector[1] = Some(value),
            "TZ" | "C3" => line.vector[2] = Some(value),
            "R" if is_klartext && value == 0.0 => {}
            "R" | "CR" => line.radius = Some(value),
            "F" => {
                self.modal.feed = Some(value);
                line.has_feed = true;
            }
            "S" if value > 0.0 => self.spindle_rpm = Some(value),
            "S" => return Err(PathFault::BadNumber(format!("S{value}"))),
            "T" => {
                self.selected = Some(Said { value: Some(tool_number(value)?), line: self.trail.line });
                line.changes_tool |= !self.survey.has_m6;
            }
            "N" | "H" => {}
            "O" => line.begins_program = true,
            "M2" | "M30" | "M17" => line.ends = true,
            "M3" => line.begins_spindle = true,
            "M13" => {
                line.begins_spindle = true;
                self.trail.coolant(Coolant::Flood, "M13");
            }
            "M5" => line.ends_spindle = true,
            "M6" => line.changes_tool = true,
            "M7" => self.trail.coolant(Coolant::Mist, "M7"),
            "M8" => self.trail.coolant(Coolant::Flood, "M8"),
            "M9" => line.ends_coolant = true,
            "M128" | "M428" => self.set_tip(true)?,
            "M129" | "M429" => self.set_tip(false)?,
            _ if word.name == "G" => self.code((value * 10.0).round() as i32)?,
            name => return Err(PathFault::Unused(name.to_owned())),
        }
        Ok(())
    }

    /// A G code that is read.
    fn code(&mut self, tenths: i32) -> Result<(), PathFault> {
        let own = match tenths {
            700 | 7000 => Effect::Units(Units::Inch),
            710 | 7100 => Effect::Units(Units::Mm),
            other => effect(other),
        };
        let before = self.modal;
        self.modal.apply(own);
        match own {
            Effect::Units(_) if self.modal.units != before.units => self.modal.feed = None,
            Effect::FeedMode(_) if self.modal.feed_mode != before.feed_mode => self.modal.feed = None,
            _ => {}
        }
        match tenths {
            434 | 435 | 2340 => {
                self.modal.modifiers = before.modifiers;
                self.set_tip(true)?;
                self.axis_is_ijk = tenths == 435;
                self.modal.at[2] = None;
            }
            490 => {
                self.modal.modifiers = before.modifiers;
                self.set_tip(false)?;
                self.modal.at[2] = None;
            }
            430 => self.modal.at[2] = None,
            540 | 550 | 560 | 570 | 580 | 590 => self.offset(tenths as u32 / 10)?,
            _ => {}
        }
        Ok(())
    }

    fn offset(&mut self, number: u32) -> Result<(), PathFault> {
        if self.trail.work_offset(number)? {
            self.modal.at = [None; 3];
        }
        Ok(())
    }

    /// Runs a block whose words have been read.
    fn run(&mut self, words: &[Word], codes: &Codes, line: Line) -> Result<(), Fault> {
        let value = |name: &str| words.iter().find(|word| word.name == name).and_then(|word| word.value);
        for (name, row) in &codes.rows {
            if row.treatment == Treatment::LeftAlone && row.words.starts_with("G54.1") {
                let number = value("P").unwrap_or_default() as u32;
                let place = name.bytes().fold(1000, |sum, c| sum * 31 % 1_000_000 + u32::from(c));
                self.offset(place + number)?;
            }
        }
        if line.begins_program && !self.trail.is_empty() {
            let advice = "a second program follows; end the first with M30";
            return Err(PathFault::Refused { word: "O".to_owned(), advice }.into());
        }
        if line.changes_tool {
            let tool = self.selected.ok_or_else(|| PathFault::NoNumber("the T of M6".to_owned()))?;
            self.change_tool(tool.value);
        }
        if let Some(number) = value("H") {
            self.length_offset(number, codes)?;
        }
        self.spindle_is_on |= line.begins_spindle;
        self.set_spindle();
        if codes.has("G52") {
            self.local(value)?;
        } else if codes.has("G80") && !["G0", "G1", "G2", "G3"].iter().any(|name| codes.has(name)) {
            self.modal.motion = None;
        }
        if let Some(word) = &line.leaves {
            self.leave(word.clone(), words);
        } else {
            if let Some(turns) = value("P").filter(|_| codes.has("G2") || codes.has("G3"))
                && turns != 1.0
            {
                let advice = "write an arc for each turn";
                return Err(PathFault::Refused { word: "P".to_owned(), advice }.into());
            }
            self.go(&line)?;
        }
        if line.ends_spindle {
            self.spindle_is_on = false;
            self.set_spindle();
        }
        if line.ends_coolant {
            self.trail.coolant(Coolant::Off, "M9");
        }
        if let Some(word) = line.stops {
            self.trail.bar(PathFault::Stops { word });
        }
        self.has_ended |= line.ends;
        Ok(())
    }

    /// `T="NAME"`. A name that is a number is that number.
    fn named_tool(&mut self, word: &str, line: &mut Line) {
        let name = word.split('"').nth(1).unwrap_or_default();
        let number = name.trim().parse().ok().and_then(|value| tool_number(value).ok());
        if number.is_none() {
            self.trail.left_alone("T");
        }
        self.selected = Some(Said { value: number, line: self.trail.line });
        line.changes_tool |= !self.survey.has_m6;
    }

    /// The H of a length offset, which no other offset may follow on the path. Without a code of an offset
    /// in force, H is a word for the machine.
    fn length_offset(&mut self, number: f64, codes: &Codes) -> Result<(), PathFault> {
        let begins = ["G43", "G43.4", "G43.5", "G234"].iter().any(|name| codes.has(name));
        match self.length_offset {
            None if !begins => self.trail.left_alone("H"),
            Some(own) if own != number && !self.trail.is_empty() => {
                let advice =
                    "another length offset moves the tip; send the motions of each as a request of its own";
                return Err(PathFault::Refused { word: format!("H{number}"), advice });
            }
            _ => self.length_offset = Some(number),
        }
        Ok(())
    }

    /// G52: moves the origin of the coordinates that follow.
    fn local(&mut self, value: impl Fn(&str) -> Option<f64>) -> Result<(), PathFault> {
        if ["A", "B", "C"].iter().any(|name| value(name).is_some()) {
            let advice = "move X, Y and Z only";
            return Err(PathFault::Refused { word: "G52".to_owned(), advice });
        }
        let unit_mm = self.unit_mm();
        for (shift, name) in self.shift.iter_mut().zip(["X", "Y", "Z"]) {
            *shift = value(name).map_or(*shift, |value| value * unit_mm);
        }
        if self.keeps_tip() && self.shift != [0.0; 3] { Err(PathFault::Shifted) } else { Ok(()) }
    }

    /// The words take the axes to places that are not known.
    fn leave(&mut self, word: String, words: &[Word]) {
        self.trail.bar(PathFault::Leaves { word });
        self.modal.at = [None; 3];
        for name in ['A', 'B', 'C'] {
            let moves = words.iter().any(|word| word.name.len() == 1 && word.name.starts_with(name));
            let axis =
                self.machine.and_then(|machine| machine.rotary().iter().position(|axis| axis.name == name));
            if let (true, Some(k)) = (moves, axis) {
                self.angles[k] = None;
            }
        }
    }

    pub(super) fn unit_mm(&self) -> f64 {
        self.modal.units.unwrap_or_default().mm()
    }
}

/// The words of a block in which `M1=3` is M3 of the first spindle, and `S1=500` its speed.
///
/// # Errors
/// Words of other spindles.
fn of_the_first_spindle<'a>(words: &'a [Word<'a>]) -> Result<Cow<'a, [Word<'a>]>, PathFault> {
    let spindle = |word: &Word| {
        let number = word.name.strip_prefix(['M', 'S'])?;
        (!number.is_empty() && word.value.is_some()).then(|| number.parse::<u32>().ok()).flatten()
    };
    if let Some(other) = words.iter().find(|word| spindle(word).is_some_and(|number| number != 1)) {
        let word = format!("{}={}", other.name, other.value.unwrap_or_default());
        let advice = "only the first spindle turns the tool; leave the words of others out";
        return Err(PathFault::Refused { word, advice });
    }
    if words.iter().all(|word| spindle(word).is_none()) {
        return Ok(Cow::Borrowed(words));
    }
    let plain = |word: &Word<'a>| match spindle(word) {
        Some(_) => Word { name: word.name[..1].to_owned().into(), ..word.clone() },
        None => word.clone(),
    };
    Ok(Cow::Owned(words.iter().map(plain).collect()))
}

impl Line {
    /// What a word that is left alone does to the motions around it.
    fn left_alone(&mut self, name: &str) {
        match name {
            "G28" | "G30" | "G53" | "G153" | "M91" | "M92" | "SUPA" => self.leaves = Some(name.to_owned()),
            "M0" => self.stops = Some("M0"),
            "M60" => self.stops = Some("M60"),
            _ => {}
        }
    }
}

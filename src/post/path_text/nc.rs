//! NC programs with five axes: the tip with angles or vectors, or the positions of all axes.
//!
//! | control | keeps the tip from | tool axis |
//! |---|---|---|
//! | Fanuc, Haas, Mazak | G43.4, G234 to G49 | A B C angles |
//! | Fanuc | G43.5 to G49 | I J K vector |
//! | LinuxCNC | M428 to M429 | A B C angles |
//! | Siemens | TRAORI to TRAFOOF | A3 B3 C3 vector, A B C angles, or a second point under ORICURVE |
//! | Heidenhain | M128, TCPM to M129 | TX TY TZ vector in LN blocks, or A B C angles |
//!
//! In a program that never keeps the tip, coordinates are the positions of the linear axes of the machine.
//! Where it does, only blocks that keep the tip are part of the path. Rapids before and behind them place the
//! axes; a cut without tip control is refused, and so is a second stretch.
//!
//! * A coordinate that a block leaves out stays as it was. The path begins where all three are known. A
//!   rotary axis that no block has named stands at zero.
//! * Where a word changes what coordinates mean, they are unknown until they are stated again, and a cut from
//!   or to an unknown place is refused.
//! * F counts mm or inches by the minute (G94) or by the turn (G95), or one by the minutes of the block
//!   (G93).
//! * [`TABLES`] lists every word. A word that it lacks is refused.

mod block;
mod motion;
mod polynomial;
mod statement;
mod words;

use nalgebra::{UnitVector3, Vector3};

use super::tokens::{self, Block, Point, Word};
use super::trail::Trail;
use super::{Fault, PathFault, PathText, PathTextError, ReadSettings, Said, TextSpindle};
use crate::nc::{Modal, Modifier};
use toolpathd_core::machine::Machine;
pub use words::TABLES;

/// Reads a program. `top_mm` is the distance of the point whose speed is the feed where the tip rests.
///
/// # Errors
/// The first line that cannot be read.
pub fn read(
    text: &str,
    machine: Option<&Machine>,
    top_mm: f64,
    reading: ReadSettings,
) -> Result<PathText, PathTextError> {
    let text = text.trim_start_matches('\u{feff}');
    let mut reader = Reader {
        reading,
        machine,
        top_mm,
        survey: Survey::of(text),
        trail: Trail::new(reading.limit),
        modal: Modal::START,
        shift: [0.0; 3],
        angles: [Some(0.0); 2],
        is_stated: [false; 2],
        vector: None,
        axis_is_ijk: false,
        spindle_rpm: None,
        spindle_is_on: false,
        selected: None,
        length_offset: None,
        turns_on_circle: false,
        has_spatial_angles: false,
        has_second_point: false,
        second: None,
        has_begun: false,
        has_ended: false,
        continues: false,
        point_at_end: None,
        point_missing: None,
    };
    for (k, line) in text.lines().enumerate() {
        reader.trail.line = k + 1;
        reader.line(line).map_err(|fault| fault.at(k + 1))?;
    }
    Ok(reader.finish())
}

/// What has to be known of a whole program before its first line is read.
#[derive(Debug, Clone, Copy, Default)]
struct Survey {
    is_klartext: bool,
    keeps_tip: bool,
    /// M6 changes tools, and T alone selects one.
    has_m6: bool,
    /// The control counts numbers without a point in whole units: it is known to be another than Fanuc.
    counts_units: bool,
}

impl Survey {
    fn of(text: &str) -> Self {
        let capitals = text.to_ascii_uppercase();
        let is_klartext = capitals.contains("BEGIN PGM");
        let mut survey = Self { is_klartext, counts_units: is_klartext, ..Self::default() };
        let marks = ["M", "43.4", "43.5", "234", "TRAORI"];
        for line in capitals.lines().filter(|line| marks.iter().any(|mark| line.contains(mark))) {
            let Ok(block) = tokens::block(line, survey.is_klartext) else { continue };
            survey.keeps_tip |= block.words.iter().any(begins_tip);
            survey.counts_units |= block.words.iter().any(is_of_another_control);
            survey.has_m6 |= block.words.iter().any(|word| word.name == "M" && word.value == Some(6.0));
        }
        survey
    }
}

/// Whether from this word on coordinates are those of the tip.
fn begins_tip(word: &Word) -> bool {
    match word.name.as_ref() {
        "G" => [43.4, 43.5, 234.0].iter().any(|code| word.value == Some(*code)),
        "M" => word.value == Some(128.0) || word.value == Some(428.0),
        name => name == "TRAORI" || name == "TCPM",
    }
}

/// Whether only LinuxCNC or Siemens has this word.
fn is_of_another_control(word: &Word) -> bool {
    word.name == "TRAORI" || word.name == "M" && [Some(428.0), Some(429.0)].contains(&word.value)
}

struct Reader<'a> {
    reading: ReadSettings,
    machine: Option<&'a Machine>,
    top_mm: f64,
    survey: Survey,
    trail: Trail,
    /// The places are those of the work offset, mm; the feed is in the units of the program.
    modal: Modal<f64, f64>,
    /// What G52 adds to coordinates, mm.
    shift: [f64; 3],
    /// Of the machine's rotary axes, radians. `None` where a word has moved an axis to an unknown angle.
    angles: [Option<f64>; 2],
    /// Which of the angles the program has stated.
    is_stated: [bool; 2],
    vector: Option<UnitVector3<f64>>,
    /// I, J and K are the tool axis.
    axis_is_ijk: bool,
    spindle_rpm: Option<f64>,
    spindle_is_on: bool,
    /// The tool of the next M6, with its line: its number, or none for a name.
    selected: Option<Said<Option<u32>>>,
    /// The number of the length offset in force.
    length_offset: Option<f64>,
    /// Under tip control the axis turns on the great circle, and the angles do not turn in step.
    turns_on_circle: bool,
    /// Whether A, B and C are angles of the tool in space, not positions of axes.
    has_spatial_angles: bool,
    /// Whether a second point states the axis, and that point, mm.
    has_second_point: bool,
    second: Option<Vector3<f64>>,
    has_begun: bool,
    has_ended: bool,
    /// The next line holds more parameters of a cycle that was left alone.
    continues: bool,
    /// The line of the first coordinate whose point stands at its end.
    point_at_end: Option<usize>,
    /// The first coordinate without a point, and its line.
    point_missing: Option<(String, usize)>,
}

impl Reader<'_> {
    fn line(&mut self, text: &str) -> Result<(), Fault> {
        if !self.has_ended && !self.continues && polynomial::is_curve(text) {
            self.has_begun = true;
            return self.curve(text);
        }
        let block = tokens::block(text, self.survey.is_klartext)?;
        if std::mem::replace(&mut self.continues, block.continues) {
            return Ok(());
        }
        if self.has_ended {
            if !block.words.is_empty() {
                self.trail.left_alone("behind the end");
            }
            return Ok(());
        }
        let begins_program = block.words.iter().any(|word| word.name == "O");
        for comment in &block.comments {
            if begins_program { self.trail.name(comment) } else { self.trail.comment(comment) }
        }
        if !block.words.is_empty() {
            if block.is_optional {
                return Err(words::row_of("/")
                    .map_or(PathFault::Conflict, |row| super::refusal("/", row))
                    .into());
            }
            self.points(&block)?;
            self.block(&block, text)?;
        }
        // The first mark begins the tape, and the second ends it.
        self.has_ended |= block.has_tape_mark && self.has_begun;
        self.has_begun |= block.has_tape_mark || !block.words.is_empty();
        Ok(())
    }

    /// Refuses a program whose numbers without a point may count thousandths: one that writes the point even
    /// where no decimals follow.
    fn points(&mut self, block: &Block) -> Result<(), Fault> {
        if self.survey.counts_units {
            return Ok(());
        }
        let is_coordinate = |word: &&Word| "XYZABCIJKR".contains(word.name.as_ref());
        for word in block.words.iter().filter(is_coordinate) {
            match (word.point, word.value) {
                (Point::AtEnd, _) => self.point_at_end = self.point_at_end.or(Some(self.trail.line)),
                (Point::None, Some(value)) if value != 0.0 && self.point_missing.is_none() => {
                    self.point_missing = Some((format!("{}{value}", word.name), self.trail.line));
                }
                _ => {}
            }
        }
        match (&self.point_missing, self.point_at_end) {
            (Some((word, missing)), Some(line)) => {
                let fault = PathFault::NoPoint { word: word.clone(), line };
                Err(Fault { line: Some(*missing), fault })
            }
            _ => Ok(()),
        }
    }

    fn keeps_tip(&self) -> bool {
        self.modal.modifiers & Modifier::ToolCenterPoint as u16 != 0
    }

    /// Tip control begins or ends. Coordinates keep their meaning only where no axis leans.
    fn set_tip(&mut self, keeps: bool) -> Result<(), PathFault> {
        if keeps && self.shift != [0.0; 3] {
            return Err(PathFault::Shifted);
        }
        if keeps != self.keeps_tip() && self.angles != [Some(0.0); 2] {
            self.modal.at = [None; 3];
        }
        if keeps {
            self.modal.modifiers |= Modifier::ToolCenterPoint as u16;
        } else {
            self.modal.modifiers &= !(Modifier::ToolCenterPoint as u16);
            self.axis_is_ijk = false;
            (self.has_spatial_angles, self.has_second_point) = (false, false);
        }
        Ok(())
    }

    fn set_spindle(&mut self) {
        let spindle = if self.spindle_is_on { TextSpindle::On(self.spindle_rpm) } else { TextSpindle::Off };
        self.trail.spindle(spindle);
    }

    /// The selected tool goes into the spindle, at a place that the program does not name. A name is no
    /// number that the answer could call.
    fn change_tool(&mut self, number: Option<u32>) {
        let Some(number) = number else {
            let advice = "send the motions of each tool as a request of its own";
            self.trail.bar(PathFault::Refused { word: "a tool with a name".to_owned(), advice });
            self.modal.at = [None; 3];
            return;
        };
        if !self.trail.is_empty() && self.trail.has_tool(number) {
            self.trail.left_alone("M6");
        }
        self.trail.tool(number);
        self.modal.at = [None; 3];
    }

    fn finish(self) -> PathText {
        let mut trail = self.trail;
        if let Some(Said { value: Some(number), line }) = self.selected.filter(|_| self.survey.has_m6)
            && !trail.has_tool(number)
        {
            trail.left_alone_at("T", line);
        }
        if self.spindle_rpm.is_some() && !trail.has_spindle() {
            trail.left_alone("S");
        }
        trail.finish()
    }
}

#[cfg(test)]
mod tests;

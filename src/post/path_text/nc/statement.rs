//! Lines that begin with a name without a number: the statements of Klartext, and calls of Siemens.

use super::super::table::Treatment;
use super::super::tokens::Word;
use super::super::{Fault, PathFault, refusal, tool_number};
use super::Reader;
use super::words::row_of;
use crate::nc::Effect;
use toolpathd_core::toolpath::program::Units;

impl Reader<'_> {
    /// Reads a line that a statement begins. `false` where its words are to be read one by one.
    pub(super) fn statement(&mut self, words: &[Word], text: &str) -> Result<bool, Fault> {
        let first = words[0].name.as_ref();
        let second = words.get(1);
        let pair = second.map_or_else(String::new, |second| format!("{first} {}", second.name));
        let numbered = second.and_then(|word| word.value).map(|value| format!("{pair} {}", value.trunc()));
        let known = |name: &str| row_of(name).map(|row| (name.to_owned(), row));
        let found = numbered.and_then(|name| known(&name)).or_else(|| known(&pair));
        let is_call = text[words[0].place.clone()].ends_with(')');
        let Some((name, row)) = found else {
            if first == "STOP" {
                self.trail.left_alone("STOP");
                self.trail.bar(PathFault::Stops { word: "STOP" });
                return Ok(true);
            }
            // A shift or a turn with words moves the coordinates; alone it ends the others.
            let moves = ["TRANS", "ROT", "SCALE", "MIRROR", "ATRANS", "AROT"].contains(&first);
            if moves && (words.len() > 1 || is_call) {
                let advice = "write coordinates of the work offset";
                return Err(PathFault::Refused { word: first.to_owned(), advice }.into());
            }
            return Ok(false);
        };
        match row.treatment {
            Treatment::Refused => return Err(refusal(&name, row).into()),
            Treatment::LeftAlone => self.trail.left_alone(&name),
            Treatment::Read => match name.as_str() {
                "BEGIN PGM" => self.begin(words, text),
                "END PGM" => self.has_ended = true,
                "FUNCTION TCPM" => self.tip_control(words)?,
                "FUNCTION RESET" => self.set_tip(false)?,
                _ => self.call(&words[1..])?,
            },
        }
        Ok(true)
    }

    /// `FUNCTION TCPM F TCP AXIS POS PATHCTRL AXIS`. With AXIS SPAT, A, B and C are no positions of axes.
    fn tip_control(&mut self, words: &[Word]) -> Result<(), PathFault> {
        let has = |first: &str, second: &str| {
            words.windows(2).any(|pair| pair[0].name == first && pair[1].name == second)
        };
        self.has_spatial_angles = has("AXIS", "SPAT");
        self.turns_on_circle = has("PATHCTRL", "VECTOR");
        self.set_tip(true)
    }

    /// `BEGIN PGM name MM`.
    fn begin(&mut self, words: &[Word], text: &str) {
        let Some(unit) = words.last() else { return };
        let from = words[1].place.start + "PGM".len();
        self.trail.name(text.get(from..unit.place.start).unwrap_or_default());
        let units = if unit.name == "INCH" { Units::Inch } else { Units::Mm };
        self.modal.apply(Effect::Units(units));
    }

    /// `TOOL CALL 3 Z S12000 F500`.
    fn call(&mut self, words: &[Word]) -> Result<(), PathFault> {
        match words[0].value {
            Some(number) => {
                let number = tool_number(number)?;
                self.change_tool(Some(number));
            }
            None => self.trail.left_alone("TOOL CALL"),
        }
        for word in &words[1..] {
            match (word.name.as_ref(), word.value) {
                ("Z", None) => {}
                ("S", Some(rpm)) if rpm > 0.0 => self.spindle_rpm = Some(rpm),
                ("F", Some(feed)) => self.modal.feed = Some(feed),
                ("DL" | "DR", Some(_)) => self.trail.left_alone("TOOL CALL"),
                (name, _) => return Err(PathFault::Unused(name.to_owned())),
            }
        }
        self.set_spindle();
        Ok(())
    }
}

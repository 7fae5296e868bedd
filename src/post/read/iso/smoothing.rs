//! Words that choose how closely the control keeps the path, each in a block of its own.

use super::Reader;
use super::control::SmoothingWord;
use super::words::Words;
use super::{BLENDING, PARABOLA};
use crate::nc::Fault;
use toolpathd_core::toolpath::program::{Smoothing, SmoothingMode};

const EXACT: i32 = 610;
const HAAS: i32 = 1870;

impl SmoothingWord {
    /// Whether a code is of this word and of no other.
    pub(super) fn takes(self, code: i32) -> bool {
        match self {
            Self::None | Self::Blending => false,
            Self::ContourControl => code == PARABOLA,
            Self::G187 => code == HAAS,
        }
    }
}

impl Reader {
    /// Reads the block of a word for smoothing. False where the block is another.
    pub(super) fn smoothed(&mut self, words: &Words) -> Result<bool, Fault> {
        let word = self.control.smoothing;
        let is_one = words.g.has(BLENDING) || words.g.all().iter().any(|&code| word.takes(code));
        if words.g.has(EXACT) {
            self.smoothing = None;
        }
        if !is_one {
            return Ok(false);
        }
        let is_alone = words.g.all().len() == 1 && words.m.all().is_empty();
        if !is_alone || words.first_of("XYZABCIJKFHST").is_some() {
            return Err(Fault::Conflict);
        }
        let unused = |letters| words.first_of(letters).map_or(Ok(()), |letter| Err(Fault::Unused(letter)));
        self.smoothing = match word {
            SmoothingWord::None | SmoothingWord::Blending => {
                unused("ER")?;
                let tolerance_mm = words.get('P').map(|p| self.unit_mm().map(|unit_mm| p * unit_mm));
                let tolerance_mm = tolerance_mm.transpose()?;
                let of_path = |_| Smoothing { tolerance_mm, tolerance_deg: None, mode: None };
                // Without Q0 the control merges blocks, too.
                let is_read = word == SmoothingWord::Blending && words.get('Q') == Some(0.0);
                tolerance_mm.filter(|_| is_read).map(of_path)
            }
            SmoothingWord::ContourControl => {
                unused("EP")?;
                let mode = match words.get('R') {
                    None => None,
                    Some(1.0) => Some(SmoothingMode::Roughing),
                    Some(5.0) => Some(SmoothingMode::SemiFinishing),
                    Some(10.0) => Some(SmoothingMode::Finishing),
                    Some(_) => return Err(Fault::BadNumber('R')),
                };
                match words.get('Q').ok_or(Fault::Missing('Q'))? {
                    1.0 => Some(Smoothing { tolerance_mm: None, tolerance_deg: None, mode }),
                    0.0 if mode.is_none() => None,
                    _ => return Err(Fault::BadNumber('Q')),
                }
            }
            SmoothingWord::G187 => {
                unused("QR")?;
                let mode = match words.get('P') {
                    None => None,
                    Some(1.0) => Some(SmoothingMode::Roughing),
                    Some(2.0) => Some(SmoothingMode::SemiFinishing),
                    Some(3.0) => Some(SmoothingMode::Finishing),
                    Some(_) => return Err(Fault::BadNumber('P')),
                };
                let tolerance_mm = words.get('E').map(|e| self.unit_mm().map(|unit_mm| e * unit_mm));
                let tolerance_mm = tolerance_mm.transpose()?;
                let is_off = mode.is_none() && tolerance_mm.is_none();
                (!is_off).then_some(Smoothing { tolerance_mm, tolerance_deg: None, mode })
            }
        };
        Ok(true)
    }

    /// # Errors
    /// When contour control is on. It would hold for the next program.
    pub(super) fn check_smoothing_off(&self) -> Result<(), Fault> {
        let is_on = self.control.smoothing == SmoothingWord::ContourControl && self.smoothing.is_some();
        if is_on { Err(Fault::Conflict) } else { Ok(()) }
    }
}

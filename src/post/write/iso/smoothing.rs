//! The words for a control's own smoothing.

use super::Writer;
use crate::WriteError;
use crate::dialect::SmoothingForm;
use crate::smoothing::{in_force, tolerance};
use crate::words::{FeedWord, fixed};
use toolpathd_core::toolpath::program::{Smoothing, SmoothingMode};

impl Writer<'_> {
    /// The smoothing that the job asks for, if it does. `behind` stands behind a tolerance.
    pub(super) fn smoothing(&mut self, behind: &str) -> Result<(), WriteError> {
        let job = self.job;
        let (Some(words), Some(_), Some(asked)) =
            (job.dialect.smoothing, job.program.smoothing, in_force(job))
        else {
            return Ok(());
        };
        let Smoothing { tolerance_mm, tolerance_deg, mode } = asked;
        let resolution = job.program.resolution;
        let most = job.dialect.max_decimals;
        let path = tolerance_mm.map(|mm| written(mm / resolution.units.mm(), resolution.decimals, most));
        let path = path.transpose()?;
        match words.form {
            SmoothingForm::Blending => {
                if let Some(FeedWord { digits, decimals }) = path {
                    self.lines.number("G64 P", digits, decimals);
                    self.lines.glue(behind);
                }
            }
            SmoothingForm::Cycle832 => {
                let mode = match mode {
                    Some(SmoothingMode::Roughing) => "ROUGH",
                    Some(SmoothingMode::SemiFinishing) => "SEMIFIN",
                    Some(SmoothingMode::Finishing) | None => "FINISH",
                };
                let path = path.map_or(String::new(), text);
                // Without a tolerance of angles, the last number is a version of the cycle.
                let (ori, last) = match tolerance_deg {
                    Some(degrees) => {
                        ("_ORI", text(written(degrees, 1, job.dialect.five_axes.angle_decimals)?))
                    }
                    None => ("", "1".to_owned()),
                };
                self.lines.word(&format!("CYCLE832({path},{ori}_{mode},{last})"));
            }
            SmoothingForm::ContourControl => {
                self.lines.word("G5.1 Q1");
                match mode {
                    Some(SmoothingMode::Roughing) => self.lines.word("R1"),
                    Some(SmoothingMode::SemiFinishing) => self.lines.word("R5"),
                    Some(SmoothingMode::Finishing) => self.lines.word("R10"),
                    None => {}
                }
            }
            SmoothingForm::G187 => {
                self.lines.word(match mode {
                    Some(SmoothingMode::Roughing) => "G187 P1",
                    Some(SmoothingMode::SemiFinishing) => "G187 P2",
                    Some(SmoothingMode::Finishing) | None => "G187 P3",
                });
                if let Some(FeedWord { digits, decimals }) = path {
                    self.lines.number("E", digits, decimals);
                }
            }
            // No dialect of ISO words has this cycle.
            SmoothingForm::Cycle32 => return Err(WriteError::Differs { line: 0, what: "smoothing" }),
        }
        Ok(())
    }
}

fn text(FeedWord { digits, decimals }: FeedWord) -> String {
    fixed(digits, decimals)
}

/// # Errors
/// When nothing is left of the tolerance.
fn written(value: f64, usual: u8, most: u8) -> Result<FeedWord, WriteError> {
    let word = tolerance(value, usual, most);
    if word.digits == 0 { Err(WriteError::SmallTolerance { tolerance: value }) } else { Ok(word) }
}

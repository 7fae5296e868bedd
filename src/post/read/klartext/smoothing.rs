//! Cycle 32, the smoothing of the control: `CYCL DEF 32.0 TOLERANCE`, then the tolerance of the path,
//! then, if it is stated, the mode and the tolerance of the rotary axes.

use super::super::number::Number;
use super::{Expected, Reader};
use crate::nc::{Fault, WordFault};
use toolpathd_core::toolpath::program::{Smoothing, SmoothingMode};

/// The form of the second and of the third block.
pub const TOLERANCE: &str = "n CYCL DEF 32.1 T0.01";
const MODE: &str = "n CYCL DEF 32.2 HSC-MODE:0 TA0.5";

impl Reader<'_> {
    pub(super) fn tolerance(&mut self, block: &str) -> Result<(), Fault> {
        let text = block.strip_prefix("CYCL DEF 32.1 T").ok_or(Fault::Frame(TOLERANCE))?;
        let tolerance_mm = Some(positive("T", text)? * self.units.mm());
        self.smoothing = Some(Smoothing { tolerance_mm, tolerance_deg: None, mode: None });
        (self.expects, self.has_open_tolerance) = (Expected::Block, true);
        Ok(())
    }

    /// HSC-MODE 0 is for finishing and 1 for roughing.
    pub(super) fn smoothing_mode(&mut self, block: &str) -> Result<(), Fault> {
        let text = block.strip_prefix("CYCL DEF 32.2 HSC-MODE:").ok_or(Fault::Frame(MODE))?;
        let (mode, angle) = match text.split_once(" TA") {
            Some((mode, angle)) => (mode, Some(positive("TA", angle)?)),
            None => (text, None),
        };
        let mode = match mode {
            "0" => SmoothingMode::Finishing,
            "1" => SmoothingMode::Roughing,
            _ => return Err(Fault::Word("HSC-MODE", WordFault::Range)),
        };
        let tolerance_mm = self.smoothing.and_then(|smoothing| smoothing.tolerance_mm);
        self.smoothing = Some(Smoothing { tolerance_mm, tolerance_deg: angle, mode: Some(mode) });
        Ok(())
    }
}

fn positive(name: &'static str, text: &str) -> Result<f64, Fault> {
    let number = Number::whole_of(text).ok_or(Fault::Word(name, WordFault::Number))?;
    if number.sign.is_some() || !number.fits(4, 4) {
        return Err(Fault::Word(name, WordFault::Form));
    }
    if number.value > 0.0 { Ok(number.value) } else { Err(Fault::Word(name, WordFault::Range)) }
}

//! The words for the control's own smoothing.

use super::Writer;
use crate::WriteError;
use crate::dialect::Dialect;
use crate::smoothing::{in_force, tolerance};
use toolpathd_core::toolpath::program::{Smoothing, SmoothingMode};

impl Writer<'_> {
    /// Cycle 32, which holds to the end of the program.
    pub(super) fn smoothing(&mut self) -> Result<(), WriteError> {
        let Some(smoothing) = in_force(self.job) else { return Ok(()) };
        let Smoothing { tolerance_mm, tolerance_deg, mode } = smoothing;
        let resolution = self.job.program.resolution;
        let Dialect { max_decimals, five_axes, .. } = *self.job.dialect;
        let Some(value) = tolerance_mm.map(|mm| mm / resolution.units.mm()) else { return Ok(()) };
        let path = tolerance(value, resolution.decimals, max_decimals);
        if path.digits == 0 {
            return Err(WriteError::SmallTolerance { tolerance: value });
        }
        self.lines.line("CYCL DEF 32.0 TOLERANCE")?;
        self.lines.number("CYCL DEF 32.1 T", path.digits, path.decimals);
        self.lines.end()?;
        if mode.is_none() && tolerance_deg.is_none() {
            return Ok(());
        }
        let is_rough = mode == Some(SmoothingMode::Roughing);
        self.lines.word(if is_rough { "CYCL DEF 32.2 HSC-MODE:1" } else { "CYCL DEF 32.2 HSC-MODE:0" });
        if let Some(degrees) = tolerance_deg {
            let angle = tolerance(degrees, 1, five_axes.angle_decimals);
            if angle.digits == 0 {
                return Err(WriteError::SmallTolerance { tolerance: degrees });
            }
            self.lines.number("TA", angle.digits, angle.decimals);
        }
        self.lines.end()
    }
}

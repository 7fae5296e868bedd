//! Canned cycles 200 (drilling) and 201 (reaming), which M99 runs.

use super::Writer;
use crate::WriteError;
use crate::cycles::CycleWords;
use toolpathd_core::toolpath::cycle::CycleKind;

/// Decimals of a pause, s.
const DWELL_DECIMALS: u8 = 3;

impl Writer<'_> {
    /// Defines the cycle. The lines behind the first belong to its block.
    pub(super) fn define(&mut self, words: &CycleWords) -> Result<(), WriteError> {
        let decimals = self.job.program.resolution.decimals;
        let depth = words.bottom - words.top;
        let peck = if words.peck > 0 { words.peck } else { -depth };
        let dwell = (i64::try_from(words.dwell_ms).unwrap_or(i64::MAX), DWELL_DECIMALS);
        let feed = (words.feed.digits, words.feed.decimals);
        let clearance = ("Q200=", (words.retract - words.top, decimals), "SET-UP CLEARANCE");
        let depth = ("Q201=", (depth, decimals), "DEPTH");
        let plunge = ("Q206=", feed, "FEED RATE FOR PLNGNG");
        let surface = ("Q203=", (words.top, decimals), "SURFACE COORDINATE");
        let second = ("Q204=", (words.returns - words.top, decimals), "2ND SET-UP CLEARANCE");
        let pause = ("Q211=", dwell, "DWELL TIME AT DEPTH");
        if words.kind == CycleKind::Ream {
            let back = ("Q208=", feed, "RETRACTION FEED RATE");
            self.lines.line("CYCL DEF 201 REAMING ~")?;
            self.parameters(&[clearance, depth, plunge, pause, back, surface, second])
        } else {
            let peck = ("Q202=", (peck, decimals), "PLUNGING DEPTH");
            let at_top = ("Q210=", (0, 0), "DWELL TIME AT TOP");
            self.lines.line("CYCL DEF 200 DRILLING ~")?;
            self.parameters(&[clearance, depth, plunge, peck, at_top, surface, second, pause])
        }
    }

    fn parameters(&mut self, all: &[(&str, (i64, u8), &str)]) -> Result<(), WriteError> {
        for (k, (word, (digits, decimals), name)) in all.iter().enumerate() {
            self.signed(&format!("  {word}"), *digits, *decimals);
            self.lines.word("; ");
            self.lines.glue(name);
            if k + 1 < all.len() {
                self.lines.word("~");
            }
            self.lines.end_unnumbered()?;
        }
        Ok(())
    }
}

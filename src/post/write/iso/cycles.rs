//! Canned cycles: G81 and its like for ISO words, `MCALL CYCLE81` and its like for Siemens.

use super::Writer;
use crate::WriteError;
use crate::cycles::CycleWords;
use crate::dialect::{Dwell, Syntax};
use crate::words::fixed;
use toolpathd_core::geometry::plane::Plane;
use toolpathd_core::toolpath::cycle::{CycleKind, ReturnTo};

impl Writer<'_> {
    /// A cycle of Siemens runs behind each block that moves, until `MCALL` stands alone.
    pub(super) fn begin_cycle(&mut self, index: u32) -> Result<(), WriteError> {
        if !self.is_siemens() {
            return Ok(());
        }
        let words = self.part.lowered.cycles[index as usize];
        self.plane(Plane::Xy);
        if words.kind != CycleKind::Ream {
            // That cycle states its feed.
            self.feed = None;
            self.feed(words.feed);
        }
        self.lines.end()?;
        let call = self.siemens_call(&words);
        self.lines.word(&format!("MCALL {call}"));
        Ok(())
    }

    pub(super) fn hole(&mut self, [x, y]: [i64; 2], index: u32) -> Result<(), WriteError> {
        let words = self.part.lowered.cycles[index as usize];
        let is_first = self.cycle.replace(index) != Some(index);
        if is_first && !self.is_siemens() {
            self.first_hole([x, y], &words)?;
        } else {
            if self.is_siemens() {
                // Whether the cycle restores the mode of motion is not certain.
                self.motion = None;
                self.motion("G0");
            }
            self.axis(0, x);
            self.axis(1, y);
        }
        self.at[2] = Some(words.returns);
        Ok(())
    }

    pub(super) fn end_cycle(&mut self) {
        self.lines.word(if self.is_siemens() { "MCALL" } else { "G80" });
        (self.cycle, self.motion, self.feed) = (None, None, None);
    }

    /// The block with all words of the cycle.
    fn first_hole(&mut self, [x, y]: [i64; 2], words: &CycleWords) -> Result<(), WriteError> {
        self.plane(Plane::Xy);
        self.lines.word(match words.return_to {
            ReturnTo::Start => "G98",
            ReturnTo::RetractPlane => "G99",
        });
        let pauses = words.dwell_ms > 0;
        self.lines.word(match (words.kind, pauses) {
            (CycleKind::Drill, false) => "G81",
            (CycleKind::Drill, true) => "G82",
            (CycleKind::ChipBreak, _) => "G73",
            (CycleKind::Peck, _) => "G83",
            (CycleKind::Ream, false) => "G85",
            (CycleKind::Ream, true) => "G89",
        });
        self.axis(0, x);
        self.axis(1, y);
        self.axis(2, words.bottom);
        self.coordinate('R', words.retract);
        if words.peck > 0 {
            self.coordinate('Q', words.peck);
        }
        if pauses {
            let digits = i64::try_from(words.dwell_ms).unwrap_or(i64::MAX);
            match self.iso.dwell {
                Dwell::Seconds => self.lines.number("P", digits, 3),
                Dwell::Milliseconds => self.lines.number("P", digits, 0),
                // No such control has cycles.
                Dwell::FeedWord => return Err(WriteError::Differs { line: 0, what: "kind" }),
            }
        }
        self.feed = None;
        self.feed(words.feed);
        Ok(())
    }

    /// `CYCLE81(RTP,RFP,SDIS,DP)` and its like: return plane, height of the material, the distance of the
    /// retract plane from it, and the bottom. A parameter that is left out takes no part.
    fn siemens_call(&self, words: &CycleWords) -> String {
        let decimals = self.job.program.resolution.decimals;
        let [returns, top, above, bottom, peck] =
            [words.returns, words.top, words.retract - words.top, words.bottom, words.peck]
                .map(|units| fixed(units, decimals));
        let hole = format!("{returns},{top},{above},{bottom}");
        let dwell = fixed(i64::try_from(words.dwell_ms).unwrap_or(i64::MAX), 3);
        let feed = fixed(words.feed.digits, words.feed.decimals);
        match words.kind {
            CycleKind::Drill if words.dwell_ms == 0 => format!("CYCLE81({hole})"),
            CycleKind::Drill => format!("CYCLE82({hole},,{dwell})"),
            // The parameters of CYCLE83 behind the bottom. FDPR: the depth of the first peck. DAM = 0: all
            // other pecks are as deep. DTB and DTS = 0: the tool does not pause. FRF = 1: the first peck has
            // the feed of the others. VARI = 0: the tool goes back by a little after each peck; VARI = 1: it
            // goes back to the retract plane.
            CycleKind::ChipBreak => format!("CYCLE83({hole},,,{peck},0,0,0,1,0)"),
            CycleKind::Peck => format!("CYCLE83({hole},,,{peck},0,0,0,1,1)"),
            CycleKind::Ream => format!("CYCLE85({hole},,{dwell},{feed},{feed})"),
        }
    }

    fn is_siemens(&self) -> bool {
        matches!(self.job.dialect.syntax, Syntax::Siemens(_))
    }
}

//! Canned cycles: `MCALL CYCLE81(...)` and its like run behind each block that moves, until `MCALL` stands
//! alone.
//!
//! # Reference
//! SINUMERIK 840D sl, *Programming Manual Cycles*: CYCLE81, CYCLE82, CYCLE83, CYCLE85. RTP, RFP and DP are
//! heights, SDIS is the distance of the height from which the tool drills from RFP.

use super::super::hole::Cycle;
use super::super::number::Number;
use super::words::Words;
use super::{Reader, Step};
use crate::nc::{Fault, FeedMode, Motion, WordFault};
use toolpathd_core::geometry::plane::Plane;
use toolpathd_core::toolpath::cycle::CycleKind;
use toolpathd_core::toolpath::units::FeedRate;

const CALL: &str = "MCALL";

impl Reader<'_> {
    /// `call` is what stands behind MCALL.
    pub(super) fn modal_call(&mut self, call: &str, words: &Words) -> Result<(), Fault> {
        if !words.is_empty()
            || words.keyword.is_some()
            || words.rounding.is_some()
            || words.smoothing.is_some()
        {
            return Err(Fault::Conflict);
        }
        if call.is_empty() {
            (self.cycle, self.modal.feed) = (None, None);
            return Ok(());
        }
        let wrong = || Fault::Word(CALL, WordFault::Form);
        let (name, arguments) =
            call.strip_suffix(')').and_then(|call| call.split_once('(')).ok_or_else(wrong)?;
        let arguments: Vec<Option<f64>> = arguments
            .split(',')
            .map(|text| match text {
                "" => Ok(None),
                text => Number::whole_of(text).map(|number| Some(number.value)).ok_or_else(wrong),
            })
            .collect::<Result<_, _>>()?;
        let &[Some(returns), Some(top), Some(above), Some(bottom), ref others @ ..] = &arguments[..] else {
            return Err(wrong());
        };
        let unit_mm = self.unit_mm()?;
        if above < 0.0 || self.plane()? != Plane::Xy || self.modal.feed_mode != Some(FeedMode::PerMinute) {
            return Err(Fault::Conflict);
        }
        let in_force = || self.modal.feed.ok_or(Fault::NoFeed);
        let own = |feed: f64| FeedRate::from_mm_per_min(feed * unit_mm).ok_or_else(wrong);
        let (kind, dwell_s, peck, rate) = match (name, others) {
            ("CYCLE81", []) => (CycleKind::Drill, 0.0, None, in_force()?),
            ("CYCLE82", &[None, Some(dwell)]) => (CycleKind::Drill, dwell, None, in_force()?),
            // Every further peck is as deep as the first, nothing pauses, and the first is not slower.
            (
                "CYCLE83",
                &[None, None, Some(peck), Some(0.0), Some(0.0), Some(0.0), Some(1.0), Some(goes_up)],
            ) => {
                let kind = match goes_up {
                    0.0 => CycleKind::ChipBreak,
                    1.0 => CycleKind::Peck,
                    _ => return Err(wrong()),
                };
                (kind, 0.0, Some(peck * unit_mm), in_force()?)
            }
            ("CYCLE85", &[None, Some(dwell), Some(down), Some(up)]) if down == up => {
                (CycleKind::Ream, dwell, None, own(down)?)
            }
            _ => return Err(wrong()),
        };
        let cycle = Cycle {
            kind,
            top_mm: Some(top * unit_mm),
            retract_mm: (top + above) * unit_mm,
            bottom_mm: bottom * unit_mm,
            peck_mm: peck,
            dwell_s,
            rate,
            returns_mm: returns * unit_mm,
        };
        self.cycle = Some(cycle);
        Ok(())
    }

    /// A block that moves while a cycle is in force.
    pub(super) fn hole(&mut self, words: &Words) -> Result<Option<Step>, Fault> {
        let Some(cycle) = self.cycle else { return Ok(None) };
        let has_others = words.first_of("ZIJKABCFSTD").is_some() || words.has_vector() || !words.m.is_empty();
        let is_rapid = self.modal.motion == Some(Motion::Rapid) && words.g.iter().all(|code| *code == 0);
        if has_others || !is_rapid || self.has_tip_control {
            return Err(Fault::Conflict);
        }
        let unit_mm = self.unit_mm()?;
        let to = ['X', 'Y'].map(|letter| words.get(letter).map(|to| to * unit_mm));
        let hole = cycle.hole(&mut self.modal.at, to)?;
        // Whether the cycle restores the mode of motion is not certain.
        self.modal.motion = None;
        Ok(Some(Step::Hole(hole)))
    }
}

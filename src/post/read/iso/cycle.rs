//! Canned cycles along Z: G73, G81, G82, G83, G85 and G89, with G98 or G99.
//!
//! The block that begins a cycle states all of it, with the place of its first hole. The blocks behind it
//! state X and Y alone, until a word of motion or G80 ends the cycle.
//!
//! # Reference
//! LinuxCNC, *G-Codes* (G73 to G89, G98, G99); FANUC B-62764EN, 13.1; Haas mill operator's manual, canned
//! cycles. Where R is above the initial level, controls differ, so such a cycle is refused.

use super::super::hole::Cycle;
use super::control::Dwell;
use super::words::Words;
use super::{Reader, Step};
use crate::nc::{Distance, Fault, FeedMode};
use toolpathd_core::geometry::plane::Plane;
use toolpathd_core::toolpath::cycle::CycleKind;

/// The codes, with the kind and whether the tool pauses at the bottom.
const CYCLES: [(i32, CycleKind, bool); 6] = [
    (730, CycleKind::ChipBreak, false),
    (810, CycleKind::Drill, false),
    (820, CycleKind::Drill, true),
    (830, CycleKind::Peck, false),
    (850, CycleKind::Ream, false),
    (890, CycleKind::Ream, true),
];
const TO_INITIAL: i32 = 980;
const TO_RETRACT: i32 = 990;

/// Whether a code is read as one of a cycle.
pub fn takes(code: i32) -> bool {
    code == TO_INITIAL || code == TO_RETRACT || CYCLES.iter().any(|(own, ..)| *own == code)
}

/// Whether a block begins a cycle.
pub fn begins(words: &Words) -> bool {
    words.g.all().iter().any(|&code| takes(code))
}

impl Reader {
    /// The block that begins a cycle, with the first hole.
    pub(super) fn begin_cycle(&mut self, words: &Words) -> Result<Step, Fault> {
        let g = &words.g;
        let code = CYCLES.iter().find(|(code, ..)| g.has(*code)).ok_or(Fault::Missing('G'))?;
        let &(_, kind, pauses) = code;
        let is_high = match (g.has(TO_INITIAL), g.has(TO_RETRACT)) {
            (true, false) => true,
            (false, true) => false,
            _ => return Err(Fault::NoMode("G98 or G99")),
        };
        let others = g.all().iter().any(|&code| !takes(code) && code != 170);
        if others || !words.m.all().is_empty() {
            return Err(Fault::Conflict);
        }
        if let Some(letter) = words.first_of("ABCEHIJKST") {
            return Err(Fault::Unused(letter));
        }
        let unit_mm = self.unit_mm()?;
        let own = |letter| words.get(letter).ok_or(Fault::Missing(letter));
        let only_with = |letter, is_own: bool| match (words.get(letter), is_own) {
            (Some(_), false) => Err(Fault::Unused(letter)),
            (None, true) => Err(Fault::Missing(letter)),
            (value, _) => Ok(value),
        };
        let per_s = if self.control.dwell == Dwell::Milliseconds { 1000.0 } else { 1.0 };
        own('F')?;
        let retract_mm = own('R')? * unit_mm;
        let cycle = Cycle {
            kind,
            top_mm: None,
            retract_mm,
            bottom_mm: own('Z')? * unit_mm,
            peck_mm: only_with('Q', kind.pecks())?.map(|q| q * unit_mm),
            dwell_s: only_with('P', pauses)?.unwrap_or_default() / per_s,
            rate: self.modal.feed.ok_or(Fault::NoFeed)?,
            returns_mm: retract_mm,
        };
        if self.plane()? != Plane::Xy || self.modal.feed_mode != Some(FeedMode::PerMinute) {
            return Err(Fault::Conflict);
        }
        let initial_mm = self.modal.at[2].ok_or(Fault::UnknownStart)?;
        self.modal.motion = None;
        self.cycle = Some(if is_high { Cycle { returns_mm: initial_mm, ..cycle } } else { cycle });
        self.hole(words)
    }

    /// The next hole of the cycle in force.
    pub(super) fn next_hole(&mut self, words: &Words) -> Result<Step, Fault> {
        match words.first_of("ZABCEFHIJKPQRST") {
            Some(letter) => Err(Fault::Unused(letter)),
            None if words.g.all().is_empty() && words.m.all().is_empty() => self.hole(words),
            None => Err(Fault::Conflict),
        }
    }

    fn hole(&mut self, words: &Words) -> Result<Step, Fault> {
        let cycle = self.cycle.ok_or(Fault::NoMotion)?;
        if self.modal.distance != Some(Distance::Absolute) {
            return Err(Fault::Relative);
        }
        self.leaning.check_off()?;
        let unit_mm = self.unit_mm()?;
        let to = ['X', 'Y'].map(|letter| words.get(letter).map(|to| to * unit_mm));
        cycle.hole(&mut self.modal.at, to).map(Step::Hole)
    }
}

//! Canned cycles: 200 (drilling, in pecks too) and 201 (reaming). M99 runs the cycle that was defined last.
//!
//! # Reference
//! HEIDENHAIN, *User's Manual Cycle Programming* TNC 640: cycles 200 and 201. Q200 is the distance of the
//! height from which the tool drills from the surface (Q203), Q201 the depth, and Q204 the distance of the
//! height at which the tool ends, if that is higher.

use super::super::hole::Cycle;
use super::super::number::Number;
use super::words::{Speed, Words};
use super::{Expected, Reader, Step, TipMode};
use crate::nc::{Fault, WordFault};
use toolpathd_core::toolpath::cycle::CycleKind;
use toolpathd_core::toolpath::program::Units;
use toolpathd_core::toolpath::units::FeedRate;

/// Numbers of the parameters, in the order of their lines, with the names that the control shows.
type Parameters = &'static [(u16, &'static str)];

pub const DRILLING: Parameters = &[
    (200, "SET-UP CLEARANCE"),
    (201, "DEPTH"),
    (206, "FEED RATE FOR PLNGNG"),
    (202, "PLUNGING DEPTH"),
    (210, "DWELL TIME AT TOP"),
    (203, "SURFACE COORDINATE"),
    (204, "2ND SET-UP CLEARANCE"),
    (211, "DWELL TIME AT DEPTH"),
];

pub const REAMING: Parameters = &[
    (200, "SET-UP CLEARANCE"),
    (201, "DEPTH"),
    (206, "FEED RATE FOR PLNGNG"),
    (211, "DWELL TIME AT DEPTH"),
    (208, "RETRACTION FEED RATE"),
    (203, "SURFACE COORDINATE"),
    (204, "2ND SET-UP CLEARANCE"),
];

pub const PARAMETER: &str = "  Q200=+number ; SET-UP CLEARANCE ~";

/// A definition under way.
#[derive(Debug)]
pub struct Definition {
    parameters: Parameters,
    values: Vec<f64>,
}

impl Definition {
    fn get(&self, number: u16) -> Option<f64> {
        let place = self.parameters.iter().position(|(own, _)| *own == number)?;
        self.values.get(place).copied()
    }
}

impl Reader<'_> {
    pub(super) fn define(&mut self, parameters: Parameters) {
        self.definition = Some(Definition { parameters, values: Vec::new() });
        (self.cycle, self.expects) = (None, Expected::Parameter);
    }

    /// A line with one parameter of the definition.
    pub(super) fn parameter(&mut self, line: &str) -> Result<(), Fault> {
        let wrong = Fault::Frame(PARAMETER);
        let Some(mut definition) = self.definition.take() else { return Err(wrong) };
        let Some(&(number, name)) = definition.parameters.get(definition.values.len()) else {
            return Err(wrong);
        };
        let is_last = definition.values.len() + 1 == definition.parameters.len();
        let tail = format!(" ; {name}{}", if is_last { "" } else { " ~" });
        let text = line.strip_prefix(&format!("  Q{number}=")).and_then(|text| text.strip_suffix(&tail));
        let value = text.and_then(Number::whole_of).filter(|value| value.sign.is_some()).ok_or(wrong)?;
        if !value.fits(5, self.dialect.max_decimals) {
            return Err(Fault::Word("Q", WordFault::Form));
        }
        definition.values.push(value.value);
        if is_last {
            (self.cycle, self.expects) = (Some(self.defined(&definition)?), Expected::Block);
        } else {
            self.definition = Some(definition);
        }
        Ok(())
    }

    fn defined(&self, definition: &Definition) -> Result<Cycle, Fault> {
        let range = Fault::Word("Q", WordFault::Range);
        let own = |number| definition.get(number).ok_or(range);
        let (clearance, depth, feed, top) = (own(200)?, own(201)?, own(206)?, own(203)?);
        let (second, dwell_s) = (own(204)?, own(211)?);
        let goes_down = clearance >= 0.0 && depth < 0.0 && second >= 0.0;
        // Q206 of a program in inches has units that are not certain.
        if !goes_down || self.units != Units::Mm {
            return Err(range);
        }
        let (kind, peck_mm) = match (definition.get(202), definition.get(208)) {
            (Some(peck), None) if peck == -depth => (CycleKind::Drill, None),
            // After each peck a rapid goes down the hole to Q200 above what was drilled.
            (Some(peck), None) if peck < -depth && clearance > 0.0 => (CycleKind::Peck, Some(peck)),
            (None, Some(up)) if up == feed => (CycleKind::Ream, None),
            _ => return Err(range),
        };
        if definition.get(210).is_some_and(|top| top != 0.0) {
            return Err(range);
        }
        let rate = FeedRate::from_mm_per_min(feed).ok_or(range)?;
        let (retract_mm, bottom_mm) = (top + clearance, top + depth);
        let returns_mm = top + second.max(clearance);
        Ok(Cycle { kind, top_mm: Some(top), retract_mm, bottom_mm, peck_mm, dwell_s, rate, returns_mm })
    }

    /// `L X+10 Y+20 R0 FMAX M99`: across, and the cycle there.
    pub(super) fn hole(&mut self, words: &Words) -> Result<Step, Fault> {
        let cycle = self.cycle.ok_or(Fault::Cycle)?;
        let has_others = ["Z", "A", "B", "C"].iter().any(|name| words.get(name).is_some());
        if has_others || words.speed != Some(Speed::Rapid) || self.mode != TipMode::Off {
            return Err(Fault::Conflict);
        }
        let hole = cycle.hole(&mut self.at, [words.get("X"), words.get("Y")])?;
        // Whether the feed stays in force behind a cycle is not certain.
        self.feed = None;
        Ok(Step::Hole(hole))
    }
}

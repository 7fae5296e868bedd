//! Canned cycles in a toolpath of a request.

use super::cycle_move::CycleMove;
use super::{Reader, check_point};
use crate::http::dto::check::Range;
use crate::http::dto::point::Coordinates;
use crate::http::error::FieldCode;
use crate::http::pointer::Pointer;
use toolpathd_core::toolpath::Role;

/// The longest pause at the bottom of a hole, s.
const DWELL_S: Range = Range { min: 0.0, max: 3600.0 };

impl Reader<'_> {
    pub(super) fn cycle(&mut self, sent: &CycleMove, at: impl Fn() -> Pointer) {
        let before = self.violations.total();
        self.check_places(sent, &at);
        self.check_heights(sent, &at);
        self.check_of_kind(sent, &at);
        let rate = self.feed(sent.feed_mm_per_min, Role::Plunge, &at);
        let hole = sent.hole(rate);
        if self.violations.total() == before {
            let places = sent.places.iter().map(|&place| place.into()).collect();
            let added = self.builder.cycle(hole, places);
            self.blame(added, at);
        }
        // After a violation the tool stays where the cycle starts: high enough for all that follows.
    }

    fn check_places(&mut self, sent: &CycleMove, at: &impl Fn() -> Pointer) {
        if sent.places.is_empty() {
            let detail = "send the place of at least one hole";
            self.violations.add(&at().field("places"), FieldCode::TooFewPoints, detail);
        }
        for (k, &Coordinates([x, y])) in sent.places.iter().enumerate() {
            check_point(&Coordinates([x, y, 0.0]), || at().field("places").index(k), self.violations);
        }
    }

    fn check_heights(&mut self, sent: &CycleMove, at: &impl Fn() -> Pointer) {
        let &CycleMove { top_z_mm, retract_z_mm, bottom_z_mm, .. } = sent;
        let before = self.violations.total();
        for (field, height) in
            [("top_z_mm", top_z_mm), ("retract_z_mm", retract_z_mm), ("bottom_z_mm", bottom_z_mm)]
        {
            if !Range::COORDINATE.holds(height) {
                self.violations.number(&at().field(field), height, Range::COORDINATE, "mm");
            }
        }
        if self.violations.total() > before {
            return;
        }
        if bottom_z_mm >= top_z_mm {
            let detail = format!(
                "`bottom_z_mm` is {bottom_z_mm} mm, and the material begins at z = {top_z_mm} mm: send a height below that"
            );
            self.violations.add(&at().field("bottom_z_mm"), FieldCode::OutOfRange, detail);
        }
        if retract_z_mm <= top_z_mm {
            let detail = format!(
                "`retract_z_mm` is {retract_z_mm} mm, and the tool comes down there as a rapid, but the material begins at z = {top_z_mm} mm: send a height above that"
            );
            self.violations.add(&at().field("retract_z_mm"), FieldCode::HeightBelowTop, detail);
        }
        let start_z_mm = self.builder.at().z;
        if start_z_mm < retract_z_mm {
            let detail = format!(
                "the tool is at z = {start_z_mm} mm where the cycle starts, below `retract_z_mm` = {retract_z_mm} mm: send a rapid up before the cycle, or a lower retract plane"
            );
            self.violations.add(&at().field("retract_z_mm"), FieldCode::Conflict, detail);
        }
    }

    /// Checks the members that only some cycles take.
    fn check_of_kind(&mut self, sent: &CycleMove, at: &impl Fn() -> Pointer) {
        let pecks = sent.cycle.pecks();
        let peck = || at().field("peck_mm");
        match sent.peck_mm {
            None if pecks => {
                let detail = "this cycle drills in pecks: send the depth of a peck";
                self.violations.add(&peck(), FieldCode::MissingField, detail);
            }
            Some(_) if !pecks => {
                let detail =
                    "this cycle has no pecks: leave `peck_mm` out, or send the cycle `peck` or `chip_break`";
                self.violations.add(&peck(), FieldCode::Conflict, detail);
            }
            Some(depth) if !Range::POSITIVE.holds(depth) => {
                self.violations.number(&peck(), depth, Range::POSITIVE, "mm");
            }
            _ => {}
        }
        let Some(seconds) = sent.dwell_s else { return };
        let dwell = at().field("dwell_s");
        if pecks && seconds > 0.0 {
            let detail = "a cycle with pecks has no pause at the bottom: leave `dwell_s` out";
            self.violations.add(&dwell, FieldCode::Conflict, detail);
        } else {
            self.violations.number(&dwell, seconds, DWELL_S, "s");
        }
    }
}

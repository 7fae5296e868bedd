//! The moves of drilling cycles.
//!
//! # Method
//! 1. Rapid along the normal to the safety clearance above the reference plane.
//! 2. To the depth as the cycle says, and back to the retraction plane.

use super::Mill;
use super::cycles::{Cycle, Heights, Kind};
use crate::block::Line;
use crate::codes::FeedMode;
use crate::fault::Fault;
use crate::notes::Note;
use crate::placement::Coordinate;

/// Most pecks of one hole. More would be an error of the program.
const MAX_PECKS: usize = 100_000;

/// The way back by which CYCLE83 breaks chips, unless _VRT says another, mm.
const CHIP_BREAK_MM: f64 = 1.0;

impl<'a> Mill<'a, '_> {
    /// Runs a cycle where the tool stands.
    pub fn run_cycle(&mut self, line: Line<'a>, cycle: &Cycle) {
        self.machine.exclude_compensation(line);
        if self.machine.is_full() {
            return;
        }
        self.settle(line);
        self.tangent = None;
        let n_refusals = self.machine.refusals.len();
        self.make_hole(line, cycle);
        if self.machine.refusals.len() > n_refusals {
            // The next hole would be refused for the same reason.
            self.modal_cycle = None;
            self.lose_place();
        }
    }

    fn make_hole(&mut self, line: Line<'a>, cycle: &Cycle) {
        let Some(heights) = self.heights(line, cycle) else { return };
        self.fall(line, heights.start);
        let at = self.machine.at;
        if self.machine.ends(line, &at).is_none() {
            return;
        }
        match cycle.kind {
            Kind::Drill => {
                self.feed_to(line, heights.depth);
                self.pause_by(line, cycle, cycle.value(5));
            }
            Kind::Pecks => self.peck(line, cycle, heights),
            Kind::RigidTap => self.tap_rigidly(line, cycle, heights),
            Kind::Tap => self.tap(line, cycle, heights),
            Kind::Ream => self.ream(line, cycle, heights),
            Kind::Bore => return self.bore(line, cycle, heights),
            Kind::BoreAndStop => {
                self.feed_to(line, heights.depth);
                if let Some(index) = cycle.dwell_index() {
                    self.pause_by(line, cycle, cycle.value(index));
                }
            }
        }
        self.fall(line, heights.retraction);
    }

    /// A rapid along the normal to a height of the program.
    fn fall(&mut self, line: Line<'a>, height: f64) {
        let to = self.at_height(height);
        self.machine.rapid(line, to);
    }

    fn feed_to(&mut self, line: Line<'a>, height: f64) {
        let to = self.at_height(height);
        self.machine.line(line, to);
    }

    fn at_height(&mut self, height: f64) -> crate::machine::At {
        let normal = self.machine.plane.axes()[2];
        let mut coordinates = [None; 3];
        coordinates[normal] = Some(Coordinate::Absolute(height));
        self.owed[normal] = Some(0.0);
        self.machine.placed(coordinates)
    }

    /// CYCLE83.
    fn peck(&mut self, line: Line<'a>, cycle: &Cycle, heights: Heights) {
        if !self.is_along_normal(line, cycle, 12) {
            return;
        }
        let Some(depths) = self.pecks(line, cycle, heights) else { return };
        if !self.count(line, depths.len()) {
            return;
        }
        let unit = self.machine.unit_mm();
        let removes_chips = cycle.value(11) == 1.0;
        if !removes_chips && cycle.value(11) != 0.0 {
            return self.refuse_parameter(line, cycle, "VARI");
        }
        let factor = if cycle.value(10) == 0.0 { 1.0 } else { cycle.value(10) };
        if !(0.001..=1.0).contains(&factor) {
            return self.refuse_parameter(line, cycle, "FRF");
        }
        let back = if cycle.value(14) > 0.0 { cycle.value(14) * unit } else { CHIP_BREAK_MM };
        let clearance = self.peck_clearance(line, cycle, heights);
        let (feed, last) = (self.machine.feed, depths.len() - 1);
        for (k, depth) in depths.into_iter().enumerate() {
            if self.machine.is_full() {
                return;
            }
            self.machine.feed = if k == 0 { feed.map(|feed| feed * factor) } else { feed };
            self.feed_to(line, depth);
            self.machine.feed = feed;
            let at_end = if cycle.value(15) == 0.0 { 8 } else { 15 };
            self.pause_by(line, cycle, cycle.value(if k == last { at_end } else { 8 }));
            if k == last {
                break;
            }
            if removes_chips {
                self.fall(line, heights.start);
                self.pause_by(line, cycle, cycle.value(9));
                self.fall(line, (depth + clearance).min(heights.start));
            } else {
                self.feed_to(line, (depth + back).min(heights.start));
            }
        }
    }

    /// How far above the last peck the rapid down the hole ends, mm.
    fn peck_clearance(&mut self, line: Line<'a>, cycle: &Cycle, heights: Heights) -> f64 {
        if cycle.value(16) > 0.0 {
            return cycle.value(16) * self.machine.unit_mm();
        }
        let depth = heights.reference - heights.depth;
        let mm = if depth <= 30.0 { 0.6 } else { (depth / 50.0).min(7.0) };
        if cycle.value(11) == 1.0 {
            self.machine.note_first(Note::PeckClearance { line: line.number, mm });
        }
        mm
    }

    /// The depths of the pecks in coordinates of the program, mm.
    fn pecks(&mut self, line: Line<'a>, cycle: &Cycle, heights: Heights) -> Option<Vec<f64>> {
        let unit = self.machine.unit_mm();
        let first = match (cycle.parameters.get(5).copied().flatten(), cycle.value(6) * unit) {
            (_, relative) if relative != 0.0 => Some(relative.abs()),
            (Some(absolute), _) => Some(heights.reference - absolute * unit),
            _ => None,
        };
        let whole = heights.reference - heights.depth;
        let Some(first) = first.filter(|first| *first > 0.0 && *first <= whole) else {
            self.refuse_parameter(line, cycle, "FDEP");
            return None;
        };
        let (degression, least) = (cycle.value(7), cycle.value(13).abs() * unit);
        // What follows a first stroke below the degression is not certain.
        if degression < -1.0 || degression < 0.0 && least == 0.0 || degression * unit > first {
            self.refuse_parameter(line, cycle, "_DAM");
            return None;
        }
        let mut depths = Vec::new();
        let (mut done, mut stroke) = (0.0, first);
        while whole - done > 1e-9 {
            if depths.len() >= MAX_PECKS {
                self.refuse_parameter(line, cycle, "FDEP");
                return None;
            }
            let rest = whole - done;
            done += if rest - stroke <= 1e-9 { rest } else { stroke };
            depths.push(heights.reference - done);
            stroke = next_stroke(stroke, degression * if degression > 0.0 { unit } else { 1.0 }, least);
            let rest = whole - done;
            // The last two strokes of the least size share what is left.
            if degression > 0.0 && stroke <= degression * unit && rest > stroke && rest < 2.0 * stroke {
                stroke = rest / 2.0;
            }
        }
        if let Some(last) = depths.last_mut() {
            *last = heights.depth;
        }
        Some(depths)
    }

    /// CYCLE84.
    fn tap_rigidly(&mut self, line: Line<'a>, cycle: &Cycle, heights: Heights) {
        if !self.is_along_normal(line, cycle, 12) {
            return;
        }
        if cycle.value(15) != 0.0 {
            return self.refuse_parameter(line, cycle, "_VARI");
        }
        let Some(pitch_mm) = self.pitch(line, cycle, [7, 8, 13]) else { return };
        let down = cycle.value(10);
        let up = if cycle.value(11) == 0.0 { down } else { cycle.value(11) };
        if !(down > 0.0 && up > 0.0) {
            return self.refuse_parameter(line, cycle, "SST");
        }
        self.at_pitch(line, pitch_mm, down, |mill| mill.feed_to(line, heights.depth));
        self.pause_by(line, cycle, cycle.value(5));
        self.at_pitch(line, pitch_mm, up, |mill| mill.feed_to(line, heights.start));
        self.machine.is_turning = matches!(cycle.value(6), 3.0 | 4.0);
    }

    /// Moves with a feed that follows the spindle.
    fn at_pitch(&mut self, line: Line<'a>, pitch_mm: f64, speed: f64, moves: impl FnOnce(&mut Self)) {
        let machine = &mut self.machine;
        let before = (machine.feed_mode, machine.feed, machine.speed, machine.is_turning);
        machine.feed_mode = FeedMode::PerMinute;
        (machine.feed, machine.speed, machine.is_turning) = (Some(pitch_mm * speed), Some(speed), true);
        machine.note_first(Note::Tapping { line: line.number });
        moves(self);
        let machine = &mut self.machine;
        (machine.feed_mode, machine.feed, machine.speed, machine.is_turning) = before;
    }

    /// CYCLE840.
    fn tap(&mut self, line: Line<'a>, cycle: &Cycle, heights: Heights) {
        if !self.is_along_normal(line, cycle, 11) {
            return;
        }
        match cycle.value(8) {
            0.0 => {
                let Some(pitch_mm) = self.pitch(line, cycle, [9, 10, 12]) else { return };
                let Some(speed) = self.machine.speed.filter(|speed| *speed > 0.0) else {
                    return self.machine.refuse_state(line, Fault::NoSpindleSpeed);
                };
                self.at_pitch(line, pitch_mm, speed, |mill| {
                    mill.feed_to(line, heights.depth);
                    mill.feed_to(line, heights.start);
                });
            }
            1.0 | 3.0 => {
                self.feed_to(line, heights.depth);
                self.pause_by(line, cycle, cycle.value(5));
                self.feed_to(line, heights.start);
            }
            _ => self.refuse_parameter(line, cycle, "ENC"),
        }
    }

    /// CYCLE85 has feeds of its own, CYCLE89 that of the program.
    fn ream(&mut self, line: Line<'a>, cycle: &Cycle, heights: Heights) {
        let before = self.machine.feed;
        let feeds = if cycle.name == "CYCLE85" {
            let feeds = [6, 7].map(|index| cycle.value(index) * self.feed_unit());
            if feeds.iter().any(|feed| *feed <= 0.0) {
                return self.refuse_parameter(line, cycle, "FFR");
            }
            feeds.map(Some)
        } else {
            [before; 2]
        };
        self.machine.feed = feeds[0];
        self.feed_to(line, heights.depth);
        self.pause_by(line, cycle, cycle.value(5));
        self.machine.feed = feeds[1];
        self.feed_to(line, heights.start);
        // Which feed is in force behind a cycle with feeds of its own is not certain.
        self.machine.feed = before.filter(|_| cycle.name != "CYCLE85");
    }

    /// CYCLE86: away from the wall by RPA, RPO and RPAP, out, and back over the hole.
    fn bore(&mut self, line: Line<'a>, cycle: &Cycle, heights: Heights) {
        self.feed_to(line, heights.depth);
        self.pause_by(line, cycle, cycle.value(5));
        let [a, b, n] = self.machine.plane.axes();
        let hole = self.machine.at;
        let unit = self.machine.unit_mm();
        let mut by = [0.0; 3];
        for (axis, index) in [(a, 7), (b, 8), (n, 9)] {
            by[axis] = cycle.value(index) * unit;
        }
        let by = self.way(by);
        let away = [0, 1, 2].map(|k| hole[k].map(|at| at + by[k]));
        self.machine.rapid(line, away);
        self.fall(line, heights.start);
        let mut up = self.at_height(heights.retraction);
        (up[a], up[b]) = (hole[a], hole[b]);
        self.machine.rapid(line, up);
    }
}

/// The stroke behind another, mm: less by an amount, or times the factor of a negative degression.
fn next_stroke(stroke: f64, degression: f64, least: f64) -> f64 {
    if degression > 0.0 {
        (stroke - degression).max(degression.min(stroke)).max(least)
    } else if degression < 0.0 {
        (stroke * -degression).max(least.min(stroke))
    } else {
        stroke
    }
}

//! The moves of cycles for holes, where the tool stands.

use super::Execution;
use super::drilling::{Chips, Cycle, Drilling};
use super::parameters::Key;
use super::script::Block;
use crate::codes::FeedMode;
use crate::fault::Fault;
use crate::machine::{At, Machine};
use crate::notes::Note;
use crate::placement::Coordinate;

impl<'a> Execution<'a, '_> {
    /// Runs the cycle in force where the tool stands. `span` is where the call stands in the block.
    pub(super) fn call_cycle(&mut self, block: &Block<'a>, span: [usize; 2]) {
        match self.cycle.clone() {
            None if span == [0, 0] => self.refuse_block(block, Fault::Lacks("CYCL DEF")),
            None => self.refuse(block, span, Fault::Lacks("CYCL DEF")),
            Some(Cycle::Refused) => {
                self.machine.refuse_state(block.line(), Fault::Lacks("CYCL DEF"));
                self.lose_place();
            }
            Some(Cycle::Program(name)) => self.call_program(block, &name),
            Some(Cycle::Hole(drilling)) => self.make_hole(block, &drilling, 0.0),
        }
    }

    /// The drilling cycle in force. Refuses a block without one.
    pub(super) fn drilling(&mut self, block: &Block<'a>) -> Option<Drilling> {
        match &self.cycle {
            Some(Cycle::Hole(drilling)) => return Some((**drilling).clone()),
            Some(Cycle::Refused) => self.machine.refuse_state(block.line(), Fault::Lacks("CYCL DEF")),
            _ => self.refuse_block(block, Fault::Lacks("CYCL DEF")),
        }
        self.lose_place();
        None
    }

    /// The height of a coordinate along the tool axis.
    pub(super) fn height(&self, mm: f64) -> Option<f64> {
        let n = self.machine.plane.axes()[2];
        let mut along = [None; 3];
        along[n] = Some(Coordinate::Absolute(mm));
        self.machine.placed(along)[n]
    }

    /// Makes a hole where the tool stands, with the surface raised by `raised_mm`.
    pub(super) fn make_hole(&mut self, block: &Block<'a>, drilling: &Drilling, raised_mm: f64) {
        self.machine.exclude_compensation(block.line());
        if self.has_changed(drilling, &[]) {
            return self.refuse_block(block, Fault::ChangedCycle);
        }
        self.drill(block, drilling, raised_mm);
    }

    /// Whether a parameter of a cycle, other than `replaced`, has changed since its definition.
    pub(super) fn has_changed(&self, drilling: &Drilling, replaced: &[u16]) -> bool {
        let values = drilling.values.iter().filter(|(own, _)| !replaced.contains(own));
        let is_now =
            |own: u16, value: f64| self.parameters.get(Key::of_cycle(own)).is_ok_and(|now| now == value);
        values.into_iter().any(|(own, value)| !is_now(*own, *value))
    }

    /// Drills where the tool stands.
    pub(super) fn drill(&mut self, block: &Block<'a>, drilling: &Drilling, raised_mm: f64) {
        let n = self.machine.plane.axes()[2];
        let factor = self.machine.placement.factor(n);
        if drilling.depth == 0.0 {
            return;
        }
        if factor <= 0.0 {
            return self.refuse_block(block, Fault::NotRead);
        }
        let surface = match drilling.surface {
            Some(surface) => self.height(surface + raised_mm),
            None => self.machine.at[n].map(|at| at - factor * drilling.clearance),
        };
        let Some(surface) = surface else {
            return self.machine.refuse_state(block.line(), Fault::UnknownStart(['X', 'Y', 'Z'][n]));
        };
        self.forget_tangent();
        if drilling.is_tapping {
            self.machine.note_first(Note::Tapping { line: block.line().number });
        }
        let height = |mm: f64| surface + factor * mm;
        let own_mode = if self.is_per_turn { FeedMode::PerTurn } else { FeedMode::PerMinute };
        self.set_feed((drilling.rate.0, Some(drilling.rate.1)));
        self.rapid_to(block, height(drilling.clearance));
        let from = self.infeed(block, drilling, &height);
        self.plunge(block, drilling, [from, drilling.depth], &height);
        self.cycle_pause(block, drilling.bottom_s);
        self.go_out(block, drilling, height(drilling.clearance));
        if drilling.second > drilling.clearance {
            self.rapid_to(block, height(drilling.second));
        }
        self.set_feed((own_mode, None));
        self.has_cycle_feed = true;
    }

    /// All infeeds but the last. Returns the depth that they have reached.
    fn infeed(&mut self, block: &Block<'a>, drilling: &Drilling, height: &dyn Fn(f64) -> f64) -> f64 {
        let (mut reached, mut infeed, mut n_breaks) = (0.0, drilling.infeed, 0.0);
        while reached + infeed < drilling.depth - 1e-9 && !self.machine.is_full() && self.spend(block, 1) {
            let bottom = reached + infeed;
            self.plunge(block, drilling, [reached, bottom], height);
            if n_breaks < drilling.chips.n_infeeds {
                n_breaks += 1.0;
                self.rapid_to(block, height((drilling.chips.back - bottom).min(drilling.clearance)));
            } else {
                n_breaks = 0.0;
                self.go_out(block, drilling, height(drilling.clearance));
                self.set_feed((drilling.rate.0, Some(drilling.rate.1)));
                self.cycle_pause(block, drilling.top_s);
                self.rapid_to(block, height((drilling.stop - bottom).min(drilling.clearance)));
            }
            reached = bottom;
            infeed = (infeed - drilling.decrement).max(drilling.least);
        }
        reached
    }

    /// Feeds from one depth to another, and breaks chips on the way.
    fn plunge(
        &mut self,
        block: &Block<'a>,
        drilling: &Drilling,
        [from, to]: [f64; 2],
        height: &dyn Fn(f64) -> f64,
    ) {
        let Chips { every, back, in_thread, .. } = drilling.chips;
        let mut bottom = from + every;
        while every > 0.0 && bottom < to - 1e-9 && !self.machine.is_full() && self.spend(block, 1) {
            self.cut_to(block, height(-bottom));
            let up = if in_thread && back == 0.0 { f64::INFINITY } else { back - bottom };
            let up = height(up.min(drilling.clearance));
            if in_thread {
                self.cut_to(block, up);
            } else {
                self.rapid_to(block, up);
            }
            bottom += every;
        }
        self.cut_to(block, height(-to));
    }

    /// To a height out of the hole.
    fn go_out(&mut self, block: &Block<'a>, drilling: &Drilling, height: f64) {
        match drilling.out {
            Some(rate) => {
                self.set_feed((rate.0, Some(rate.1)));
                self.cut_to(block, height);
            }
            None => self.rapid_to(block, height),
        }
    }

    fn cycle_pause(&mut self, block: &Block<'a>, seconds: f64) {
        if seconds > 0.0 {
            self.pause(block, seconds, [0, block.text.len()]);
        }
    }

    fn along(&self, height: f64) -> At {
        let Machine { mut at, plane, .. } = *self.machine;
        at[plane.axes()[2]] = Some(height);
        at
    }

    pub(super) fn rapid_to(&mut self, block: &Block<'a>, height: f64) {
        let to = self.along(height);
        self.machine.rapid(block.line(), to);
    }

    fn cut_to(&mut self, block: &Block<'a>, height: f64) {
        let to = self.along(height);
        self.machine.line(block.line(), to);
    }
}

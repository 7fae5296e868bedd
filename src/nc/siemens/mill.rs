//! The modal state of SINUMERIK beside that of the machine, and what the words of a block do.
//!
//! # Method
//! 1. Words that a block cannot hold together are refused.
//! 2. Plane, units, feed, spindle, tool and zeros come into force before the block moves.
//! 3. A corner that the block before rounds needs the way of this block; see `corner`.
//! 4. A cycle that MCALL has made modal runs behind each block that moves.

use toolpathd_core::geometry::plane::Plane;

use super::Mill;
use super::block::{Block, From, Given};
use super::codes::{Meaning, Motion, group};
use crate::block::Line;
use crate::fault::Fault;
use crate::flow::MAX_BLOCKS;
use crate::frames::name;
use crate::machine::{Machine, Radius};
use crate::notes::Note;
use crate::placement::{Coordinate, Placement};

/// What a block asks of the flow of the program.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Next {
    Block,
    /// M2, M30, M17.
    End,
}

impl<'a, 'm> Mill<'a, 'm> {
    pub fn new(machine: &'m mut Machine<'a>, t_changes: bool) -> Self {
        let feeds_in_inches = machine.in_inches();
        Self {
            machine,
            motion: None,
            is_absolute: true,
            feeds_in_inches,
            has_units: false,
            pole: Some([0.0; 2]),
            polar: [None; 2],
            called_tool: None,
            t_changes,
            edge: None,
            owed: [Some(0.0); 3],
            pending: None,
            rounding: 0.0,
            corner_feed: None,
            tangent: None,
            modal_cycle: None,
            written_zeros: Vec::new(),
            has_selected: false,
            has_moved: false,
            moves: false,
            is_transformed: false,
            n_repeated: 0,
        }
    }

    /// Counts pecks or holes. False where there are too many.
    pub(super) fn count(&mut self, line: Line<'a>, n: usize) -> bool {
        self.n_repeated += n;
        let is_legal = !self.has_too_many();
        if !is_legal {
            self.machine.refuse(line.refused(Fault::Endless(MAX_BLOCKS)));
        }
        is_legal
    }

    /// Whether cycles have repeated too often for the run to go on.
    pub fn has_too_many(&self) -> bool {
        self.n_repeated > MAX_BLOCKS
    }

    /// Whether the length of the tool is in force.
    pub(super) fn has_length(&self) -> bool {
        self.edge.is_some_and(|edge| edge > 0)
    }

    pub(super) fn refuse(&mut self, line: Line<'a>, [start, end]: [usize; 2], fault: Fault) {
        self.machine.refuse(line.refusal(start, end, fault));
    }

    /// Nothing is known of the place any more: the block that moves the tool is refused.
    pub fn lose_place(&mut self) {
        self.pending = None;
        self.tangent = None;
        self.machine.at = [None; 3];
    }

    /// Runs the words of a block.
    pub fn run(&mut self, line: Line<'a>, block: &Block) -> Next {
        self.moves = false;
        self.check(line, block);
        for refusal in &block.refusals {
            self.machine.refuse(refusal.clone());
        }
        if block.is_void {
            self.lose_place();
        }
        self.set_modes(line, block);
        self.take_feed_and_speed(line, block);
        self.take_functions(block);
        self.change_tool(line, block);
        self.select_zeros(line, block);
        if !block.is_void {
            self.act(line, block);
        }
        let ends = block.functions.iter().any(|(number, _)| matches!(number, 2 | 17 | 30));
        if ends {
            self.finish_corner();
        }
        for (number, _) in &block.functions {
            if !matches!(number, 0..=6 | 17 | 30) {
                self.machine.left.add(&format!("M{number}"), line.number);
            }
        }
        if ends { Next::End } else { Next::Block }
    }

    /// Records the modal state behind a block. An arc through a point and a tangent arc are no motion that
    /// other controls have.
    pub(super) fn trace(&mut self, line: usize) {
        self.machine.is_absolute = self.is_absolute;
        self.machine.motion = match self.motion {
            Some(Motion::Rapid) => Some(crate::codes::Motion::Rapid),
            Some(Motion::Line) => Some(crate::codes::Motion::Line),
            Some(Motion::Arc(direction)) => Some(crate::codes::Motion::Arc(direction)),
            Some(Motion::ThroughPoint | Motion::Tangent) | None => None,
        };
        self.machine.trace(line);
    }

    /// Refuses codes that exclude each other, and words that no code of the block uses.
    fn check(&mut self, line: Line<'a>, block: &Block) {
        let mut groups: Vec<u8> = Vec::new();
        for (meaning, span) in &block.codes {
            let Some(group) = group(*meaning) else { continue };
            if groups.contains(&group) {
                self.refuse(line, *span, Fault::Conflict);
            }
            groups.push(group);
        }
        self.is_transformed |= block.has(Meaning::Transformation);
        if !self.is_transformed {
            for span in &block.others {
                self.refuse(line, *span, Fault::OtherAxis);
            }
        }
        let is_of = |given: &Given, fault| line.refusal(given.start, given.end, fault);
        let mut unused: Vec<Given> = Vec::new();
        if !block.has(Meaning::Home) {
            unused.extend(block.machine_axes.iter().flatten());
            unused.extend(block.value("FP"));
        }
        if !block.codes.iter().any(|(meaning, _)| matches!(meaning, Meaning::Frame { .. })) {
            unused.extend(block.value("RPL"));
        }
        unused.extend(block.letters.get(&b'P'));
        for given in unused {
            self.machine.refuse(is_of(&given, Fault::UnusedWord));
        }
        // AC and IC stand before polar coordinates alone.
        let is_polar = |name: &str| matches!(name, "AP" | "RP");
        let is_wrong = |name: &str, given: &Given| {
            given.from == From::Circle || given.from != From::Mode && !is_polar(name)
        };
        if let Some((_, given)) = block.values.iter().find(|(name, given)| is_wrong(name, given)) {
            self.machine.refuse(is_of(given, Fault::BadExpression));
        }
    }

    fn set_modes(&mut self, line: Line<'a>, block: &Block) {
        for (meaning, span) in &block.codes {
            match meaning {
                Meaning::Motion(motion) => self.motion = Some(*motion),
                Meaning::Plane(plane) => self.set_plane(line, *plane),
                Meaning::Units { in_inches, of_feeds } => {
                    self.machine.set_units(*in_inches);
                    self.has_units = true;
                    if *of_feeds {
                        self.feeds_in_inches = *in_inches;
                    }
                }
                Meaning::Distance(is_absolute) => self.is_absolute = *is_absolute,
                Meaning::Feed(Some(mode)) if *mode != self.machine.feed_mode => {
                    self.settle(line);
                    self.machine.feed_mode = *mode;
                    self.machine.feed = None;
                }
                Meaning::Compensation(side) => {
                    self.settle(line);
                    let edge = block.letters.get(&b'D').map(|given| given.value).or(self.edge.map(f64::from));
                    if edge == Some(0.0) && self.machine.computes_compensation() {
                        // The radius comes with a later D.
                        self.refuse(line, *span, Fault::Conflict);
                    } else {
                        self.machine.begin_compensation(line, *span, *side, Radius::OfTool);
                    }
                }
                Meaning::Approach if self.machine.computes_compensation() => {
                    self.refuse(line, *span, Fault::NotRead);
                }
                Meaning::Approach => {
                    let word = String::from_utf8_lossy(&line.text[span[0]..span[1]]).trim().to_owned();
                    self.machine.left.add(&word, line.number);
                }
                Meaning::CompensationEnd => {
                    self.settle(line);
                    self.machine.end_compensation();
                }
                Meaning::TransformationEnd => self.is_transformed = false,
                _ => {}
            }
        }
    }

    fn set_plane(&mut self, line: Line<'a>, plane: Plane) {
        if plane == self.machine.plane {
            return;
        }
        self.settle(line);
        self.machine.exclude_compensation(line);
        self.machine.plane = plane;
        (self.pole, self.tangent, self.polar) = (None, None, [None; 2]);
        let has_tool = self.machine.tool().is_some() || self.has_length();
        if plane != Plane::Xy && has_tool {
            self.machine.note_first(Note::LengthAxisAssumed { line: line.number });
        }
    }

    /// Tells, once, in which unit lengths count that no code has set.
    pub(super) fn assume_units(&mut self, line: Line<'a>) {
        if !self.has_units {
            self.has_units = true;
            let units = if self.machine.in_inches() { "inches" } else { "mm" };
            self.machine.note(Note::BasicUnits { line: line.number, units });
        }
    }

    fn select_zeros(&mut self, line: Line<'a>, block: &Block) {
        let offset = block.codes.iter().find_map(|(meaning, _)| match meaning {
            Meaning::Offset(number) => Some(*number),
            _ => None,
        });
        let Some(number) = offset else { return };
        self.settle(line);
        let before = self.machine.frames.frame();
        let shifts = [0, 1, 2].map(|axis| self.machine.frames.shift(axis));
        if let Some(k) = self.written_zeros.iter().position(|(own, _)| *own == number) {
            let (_, zeros) = self.written_zeros.remove(k);
            for (axis, mm) in zeros.into_iter().enumerate().filter_map(|(axis, mm)| Some((axis, mm?))) {
                self.machine.frames.place_zero(number, axis, mm, &mut self.machine.at);
            }
        }
        self.machine.frames.select(number, &mut self.machine.at);
        if !self.has_selected && self.has_moved {
            // What was in force before is a setting of the control.
            self.machine.at = [None; 3];
        }
        let is_unrelated = before != self.machine.frames.frame() || !self.has_selected && self.has_moved;
        if is_unrelated && self.machine.record.has_moves() {
            self.machine.note(Note::UnrelatedOffset { line: line.number, offset: name(number) });
        }
        self.has_selected = true;
        let frames = self.machine.frames.frame();
        let by = [0, 1, 2].map(|k| self.machine.frames.shift(k) - shifts[k]);
        if before != frames || by != [0.0; 3] {
            // In coordinates of the program, which a frame may turn.
            let [from, to] = [[0.0; 3], by].map(|shift| Placement::shifted(shift.into()));
            let [from, to] = [from, to].map(|shift| shift.of(&self.machine.placement));
            let is_known = before == frames;
            self.change_zero([true; 3], to.shift_since(&from).filter(|_| is_known));
        }
    }

    /// The zero of the program has moved along the axes: by a shift, mm of the program, or otherwise.
    pub(super) fn change_zero(&mut self, axes: [bool; 3], by: Option<[f64; 3]>) {
        for axis in (0..3).filter(|axis| axes[*axis]) {
            self.owed[axis] = self.owed[axis].zip(by).map(|(owed, by)| owed + by[axis]);
        }
        self.tangent = None;
        if self.pole != Some([0.0; 2]) {
            self.pole = None;
        }
        self.polar = [None; 2];
    }

    /// What the axis words of a block do.
    fn act(&mut self, line: Line<'a>, block: &Block) {
        self.set_rounding(line, block);
        let action = block.codes.iter().find(|(meaning, _)| {
            use Meaning::*;
            matches!(meaning, Dwell | Home | Limits | Frame { .. } | Pole(_) | Transformation)
        });
        if let Some((meaning, span)) = action {
            let used: &[&str] = if matches!(meaning, Meaning::Pole(_)) { &["AP", "RP"] } else { &[] };
            self.refuse_values(line, block, used);
            for given in block.centers.iter().chain(&block.middles).flatten() {
                self.refuse(line, [given.start, given.end], Fault::UnusedWord);
            }
            match meaning {
                Meaning::Dwell => return self.dwell(line, block, *span),
                Meaning::Home => return self.go_home(line, block),
                Meaning::Limits => {
                    self.machine.left.add("G25 and G26", line.number);
                    return;
                }
                Meaning::Frame { word, adds } => return self.set_frame(line, block, *word, *adds, *span),
                Meaning::Pole(from) => return self.set_pole(line, block, *from),
                Meaning::Transformation => return self.lose_place(),
                _ => {}
            }
        }
        self.moves = self.move_by(line, block);
        self.has_moved |= self.moves;
        if self.moves
            && let Some(cycle) = self.modal_cycle.clone()
        {
            self.settle(line);
            self.run_cycle(line, &cycle);
        }
    }

    /// G74 and G75: the named axes go to places of the machine.
    fn go_home(&mut self, line: Line<'a>, block: &Block) {
        self.settle(line);
        let named = [0, 1, 2].map(|k| block.axes[k].is_some() || block.machine_axes[k].is_some());
        if named == [false; 3] && block.others.is_empty() {
            self.machine.refuse(line.refused(Fault::NoAxis));
        }
        for axis in (0..3).filter(|axis| named[*axis]) {
            self.machine.at[axis] = None;
        }
        self.tangent = None;
        self.has_moved = true;
        self.machine.record.n_rapids_not_counted += 1;
    }

    /// Coordinates of the program in the work offset, by a placement or as they are.
    pub(super) fn set_placement(&mut self, placement: Placement) {
        let before = std::mem::replace(&mut self.machine.placement, placement);
        let differs = |k: usize| {
            let corners = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
            corners.iter().any(|p| before.back(&p.map(Some))[k] != placement.back(&p.map(Some))[k])
        };
        self.change_zero([0, 1, 2].map(differs), placement.shift_since(&before));
    }

    /// One coordinate of a block, mm.
    pub(super) fn coordinate(&mut self, line: Line<'a>, given: &Given) -> Coordinate {
        self.assume_units(line);
        let mm = given.value * self.machine.unit_mm();
        let is_absolute = match given.from {
            From::Zero => true,
            From::Tool => false,
            From::Mode | From::Circle => self.is_absolute,
        };
        if is_absolute { Coordinate::Absolute(mm) } else { Coordinate::Relative(mm) }
    }
}

//! What the axis words of a block do: rapids, lines, and the ends of arcs.

use super::Mill;
use super::block::{Block, From, Given};
use super::codes::{Meaning, Motion};
use super::corner::{Corner, Kind, Shape};
use crate::block::Line;
use crate::fault::Fault;
use crate::machine::At;
use crate::notes::Note;
use crate::placement::{Coordinate, sine_and_cosine};

impl<'a> Mill<'a, '_> {
    /// Moves as the words of the block say. Whether the block moves.
    pub(super) fn move_by(&mut self, line: Line<'a>, block: &Block) -> bool {
        let is_polar = block.value("AP").is_some() || block.value("RP").is_some();
        let is_arc = matches!(self.motion, Some(Motion::Arc(_)));
        let in_plane = self.machine.plane.axes();
        let has_center = in_plane[..2].iter().any(|axis| block.centers[*axis].is_some());
        let moves = block.has_axes() || is_polar || is_arc && (has_center || block.value("AR").is_some());
        let motion = self.motion.filter(|_| moves);
        self.refuse_unused(line, block, motion);
        if !moves {
            if let Some(given) = block.value("ANG") {
                self.refuse(line, [given.start, given.end], Fault::NotRead);
                self.lose_place();
                return true;
            }
            if block.has(Meaning::OnMachine) {
                self.machine.left.add("G53, G153 or SUPA", line.number);
            }
            return false;
        }
        let Some(motion) = motion else {
            self.machine.refuse_state(line, Fault::NoMotion);
            self.lose_place();
            return true;
        };
        if block.has(Meaning::OnMachine) {
            self.move_on_machine(line, block, motion);
            return true;
        }
        let has_shifted = self.owed != [Some(0.0); 3];
        let Some(to) = self.target(line, block, is_polar) else {
            self.lose_place();
            return true;
        };
        match motion {
            Motion::Rapid => self.rapid(line, to),
            Motion::Line => self.cut(line, to, Shape::Line, block),
            Motion::Arc(direction) => self.arc(line, block, to, direction),
            Motion::ThroughPoint => self.arc_through_point(line, block, to, has_shifted),
            Motion::Tangent => self.tangent_arc(line, block, to),
        }
        true
    }

    /// Refuses words that the motion does not use.
    fn refuse_unused(&mut self, line: Line<'a>, block: &Block, motion: Option<Motion>) {
        let used: &[&str] = match motion {
            None => &["ANG"],
            Some(Motion::Line) => &["AP", "RP", "RND", "CHF", "CHR", "FRC", "ANG"],
            Some(Motion::Rapid) => &["AP", "RP"],
            Some(Motion::Arc(_)) => &["AP", "RP", "CR", "AR", "TURN", "RND", "CHF", "CHR", "FRC"],
            Some(_) => &["AP", "RP", "RND", "CHF", "CHR", "FRC"],
        };
        self.refuse_values(line, block, used);
        let mut unused: Vec<Given> = Vec::new();
        if !matches!(motion, Some(Motion::Arc(_))) {
            unused.extend(block.centers.iter().flatten());
        }
        if motion != Some(Motion::ThroughPoint) {
            unused.extend(block.middles.iter().flatten());
        }
        for given in unused {
            self.refuse(line, [given.start, given.end], Fault::UnusedWord);
        }
    }

    /// Refuses values that are not among the used ones.
    pub(super) fn refuse_values(&mut self, line: Line<'a>, block: &Block, used: &[&str]) {
        let is_unused = |name: &str| !used.contains(&name) && !["RNDM", "FRCM", "FP", "RPL"].contains(&name);
        let mut unused: Vec<Given> =
            block.values.iter().filter(|(name, _)| is_unused(name)).map(|(_, given)| *given).collect();
        unused.sort_by_key(|given| given.start);
        for given in unused {
            self.refuse(line, [given.start, given.end], Fault::UnusedWord);
        }
    }

    /// The place that the words of a block name. A refusal has been made where there is none.
    fn target(&mut self, line: Line<'a>, block: &Block, is_polar: bool) -> Option<At> {
        let mut coordinates = [None; 3];
        for (axis, coordinate) in coordinates.iter_mut().enumerate() {
            if let Some(given) = &block.axes[axis] {
                *coordinate = Some(self.coordinate(line, given));
            }
        }
        if is_polar {
            let [a, b, _] = self.machine.plane.axes();
            if let Some(given) = block.axes[a].or(block.axes[b]) {
                self.refuse(line, [given.start, given.end], Fault::Conflict);
                return None;
            }
            if let Some(given) = block.value("ANG") {
                self.refuse(line, [given.start, given.end], Fault::Conflict);
                return None;
            }
            let [x, y] = self.polar_coordinates(line, block)?;
            (coordinates[a], coordinates[b]) = (Some(x), Some(y));
        }
        if let Some(given) = block.value("ANG") {
            self.complete_by_angle(line, block, &given, &mut coordinates)?;
        }
        for (axis, coordinate) in coordinates.iter_mut().enumerate() {
            match (*coordinate, self.owed[axis]) {
                (Some(Coordinate::Relative(_)), None) => {
                    let span =
                        block.axes[axis].map_or([0, line.text.len()], |given| [given.start, given.end]);
                    self.refuse(line, span, Fault::IncrementOfNewZero);
                    return None;
                }
                (Some(Coordinate::Relative(mm)), Some(owed)) => {
                    if owed != 0.0 {
                        self.machine.note_first(Note::ShiftTraversed { line: line.number });
                    }
                    *coordinate = Some(Coordinate::Relative(mm + owed));
                }
                (None, _) => continue,
                _ => {}
            }
            self.owed[axis] = Some(0.0);
        }
        Some(self.machine.placed(coordinates))
    }

    /// ANG: the line leads to one coordinate of its end at an angle from the first axis of the plane.
    fn complete_by_angle(
        &mut self,
        line: Line<'a>,
        block: &Block,
        given: &Given,
        coordinates: &mut [Option<Coordinate>; 3],
    ) -> Option<()> {
        let [a, b, _] = self.machine.plane.axes();
        let (own, other) = match (coordinates[a], coordinates[b]) {
            (Some(_), None) => (a, b),
            (None, Some(_)) => (b, a),
            // Two lines that meet where their angles say.
            _ => {
                self.refuse(line, [given.start, given.end], Fault::NotRead);
                return None;
            }
        };
        let at = self.in_program();
        let (Some(from), Some(beside)) = (at[own], at[other]) else {
            self.machine.refuse_state(line, Fault::UnknownStart(['X', 'Y', 'Z'][own]));
            return None;
        };
        let way = match coordinates[own] {
            Some(Coordinate::Absolute(mm)) => mm - from,
            Some(Coordinate::Relative(mm)) if self.owed[own] == Some(0.0) => mm,
            _ => {
                let span = block.axes[own].map_or([given.start, given.end], |word| [word.start, word.end]);
                self.refuse(line, span, Fault::IncrementOfNewZero);
                return None;
            }
        };
        let (sin, cos) = sine_and_cosine(given.value);
        let (along, across) = if own == a { (cos, sin) } else { (sin, cos) };
        let length = way / along;
        // Against its angle no line leads to the coordinate.
        if !(length > 0.0 && length.is_finite()) {
            self.refuse(line, [given.start, given.end], Fault::OutOfRange(given.value));
            return None;
        }
        coordinates[other] = Some(Coordinate::Absolute(beside + length * across));
        Some(())
    }

    fn move_on_machine(&mut self, line: Line<'a>, block: &Block, motion: Motion) {
        let is_straight = matches!(motion, Motion::Rapid | Motion::Line);
        let is_relative =
            |given: &Given| given.from == From::Tool || given.from == From::Mode && !self.is_absolute;
        let is_legal = is_straight
            && !block.axes.iter().flatten().any(is_relative)
            && ["AP", "RP", "RND", "CHF", "CHR", "ANG"].iter().all(|name| block.value(name).is_none());
        if !is_legal {
            self.machine.refuse(line.refused(Fault::Conflict));
            return self.lose_place();
        }
        self.settle(line);
        let [_, _, normal] = self.machine.plane.axes();
        let mut to = self.machine.at;
        for (axis, place) in to.iter_mut().enumerate() {
            let Some(given) = &block.axes[axis] else { continue };
            self.assume_units(line);
            let mm = given.value * self.machine.unit_mm();
            // Whether an incremental way behind this block counts from here is not certain.
            self.owed[axis] = None;
            // Without a known length the height of the tip is not known.
            let has_length = axis != normal || self.has_length();
            *place = self.machine.frames.of_machine(axis, mm).filter(|_| has_length);
        }
        if motion == Motion::Rapid {
            self.machine.rapid(line, to);
        } else {
            self.machine.line(line, to);
        }
        self.tangent = None;
    }

    fn rapid(&mut self, line: Line<'a>, to: At) {
        let [a, b, _] = self.machine.plane.axes();
        let is_along_normal = to[a] == self.machine.at[a] && to[b] == self.machine.at[b];
        if is_along_normal {
            self.finish_corner();
        }
        self.settle(line);
        self.machine.rapid(line, to);
        self.tangent = None;
    }

    /// A cut, behind the corner that the block before may have left open.
    pub(super) fn cut(&mut self, line: Line<'a>, to: At, shape: Shape, block: &Block) {
        let corner = self.corner(line, block);
        self.follow(line, to, shape, corner);
    }

    /// RNDM and FRCM hold until they are zero.
    pub(super) fn set_rounding(&mut self, line: Line<'a>, block: &Block) {
        for (name, is_feed) in [("RNDM", false), ("FRCM", true)] {
            let Some(given) = block.value(name) else { continue };
            if given.value < 0.0 || given.from != From::Mode {
                self.refuse(line, [given.start, given.end], Fault::OutOfRange(given.value));
            } else if is_feed {
                self.corner_feed = Some(given.value * self.feed_unit()).filter(|feed| *feed > 0.0);
            } else {
                self.assume_units(line);
                self.rounding = given.value * self.machine.unit_mm();
            }
        }
    }

    /// What the block asks of the corner at its end.
    fn corner(&mut self, line: Line<'a>, block: &Block) -> Option<Corner> {
        let mut found: Option<(Kind, Given)> = None;
        for (name, kind) in [
            ("RND", Kind::Round as fn(f64) -> Kind),
            ("CHF", Kind::Width as fn(f64) -> Kind),
            ("CHR", Kind::Leg as fn(f64) -> Kind),
        ] {
            let Some(given) = block.value(name) else { continue };
            let mm = given.value * self.machine.unit_mm();
            if given.value < 0.0 || given.from != From::Mode {
                self.refuse(line, [given.start, given.end], Fault::OutOfRange(given.value));
            } else if found.is_some() {
                self.refuse(line, [given.start, given.end], Fault::Conflict);
            } else {
                found = Some((kind(mm), given));
            }
        }
        let own_feed = block.value("FRC").map(|given| given.value * self.feed_unit());
        let feed = own_feed.filter(|feed| *feed > 0.0).or(self.corner_feed);
        match found {
            // A zero stands for no corner in this block.
            Some((_, given)) if given.value == 0.0 => None,
            Some((kind, given)) => Some(Corner { kind, feed, span: Some([given.start, given.end]) }),
            None if self.rounding > 0.0 => {
                Some(Corner { kind: Kind::Round(self.rounding), feed, span: None })
            }
            None => None,
        }
    }
}

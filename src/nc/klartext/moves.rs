//! Straight blocks: L and LP, with what every block that moves has: feed, compensation and M words.

use super::Execution;
use super::cursor::Cursor;
use super::functions::Functions;
use super::path::{Path, Way};
use super::script::Block;
use super::words::{Feed, Sort, Words};
use crate::codes::FeedMode;
use crate::fault::Fault;
use crate::machine::{At, Radius};
use crate::placement::Coordinate;

const STRAIGHT: [Sort; 4] = [Sort::Axis, Sort::Side, Sort::Feed, Sort::Function];
const POLAR: [Sort; 6] =
    [Sort::Axis, Sort::PolarRadius, Sort::PolarAngle, Sort::Side, Sort::Feed, Sort::Function];

impl<'a> Execution<'a, '_> {
    /// A straight block.
    pub(super) fn straight(&mut self, block: &Block<'a>, cursor: &mut Cursor<'_>, is_polar: bool) {
        let Some((words, functions)) =
            self.begin_move(block, cursor, if is_polar { &POLAR } else { &STRAIGHT })
        else {
            return;
        };
        let to = if is_polar {
            self.has_no_machine_zero(block, &functions).then(|| self.polar_end(block, &words)).flatten()
        } else {
            self.straight_end(block, &words, &functions)
        };
        let moves = is_polar || words.axes != [None; 3];
        match to {
            Some(to) if moves => {
                let way = if words.feed == Some(Feed::Rapid) { Way::Rapid } else { Way::Line };
                let element = self.element(block, to, way);
                self.advance(block, element);
            }
            Some(_) => self.retract(block, &words, &functions),
            None => self.lose_place(),
        }
        self.end_functions(block, &functions, moves);
    }

    /// Reads the words of a block that moves, and lets take effect what does so before the move. `None`
    /// where a word is refused.
    pub(super) fn begin_move(
        &mut self,
        block: &Block<'a>,
        cursor: &mut Cursor<'_>,
        allowed: &[Sort],
    ) -> Option<(Words, Functions)> {
        if self.path.corner.is_none() {
            self.settle();
        }
        let words = self.scan(block, cursor, allowed);
        let functions = self.begin_functions(block, &words);
        if let Some((mode, feed)) = self.rate_of(words.feed) {
            self.set_feed((mode, Some(feed)));
        }
        if words.feed.is_none() && self.has_cycle_feed && words.moves() {
            self.machine.refuse_state(block.line(), Fault::FeedBehindCycle);
        }
        if words.is_broken {
            self.lose_place();
            self.end_functions(block, &functions, false);
            return None;
        }
        if let Some((side, [start, end])) = words.side
            && side != self.side
        {
            let before = std::mem::replace(&mut self.side, side);
            let (line, span) = block.place(start, end);
            if before.is_some() && side.is_some() {
                // A block without compensation has to stand between the two.
                self.refuse(block, [start, end], Fault::Conflict);
            }
            if self.path.approach.is_some() {
                self.refuse(block, [start, end], Fault::Conflict);
                self.path = Path::default();
            }
            if self.path.corner.is_some() && self.machine.computes_compensation() {
                self.refuse(block, [start, end], Fault::CornerBetweenSides);
                self.path = Path::default();
            }
            self.machine.end_compensation();
            if let Some(side) = side {
                self.machine.begin_compensation(line, span, side, Radius::OfTool);
            }
        }
        Some((words, functions))
    }

    /// The end of a straight block in coordinates, of the program or of the machine.
    fn straight_end(&mut self, block: &Block<'a>, words: &Words, functions: &Functions) -> Option<At> {
        let Some((number, span)) = functions.machine_zero else {
            return Some(self.machine.placed(words.axes));
        };
        let is_relative = words.axes.iter().any(|axis| matches!(axis, Some(Coordinate::Relative(_))));
        if is_relative {
            self.refuse(block, span, Fault::Conflict);
            return None;
        }
        // Under M91 controls leave out the length of the tool, and under M92 the zero is a setting.
        let normal = self.machine.plane.axes()[2];
        let mut to = self.machine.at;
        for (axis, place) in to.iter_mut().enumerate() {
            if let Some(Coordinate::Absolute(mm)) = words.axes[axis] {
                let is_known = number == 91 && axis != normal;
                *place = if is_known { self.machine.frames.of_machine(axis, mm) } else { None };
            }
        }
        Some(to)
    }

    /// M140 MB MAX: up to the end of the axis.
    fn retract(&mut self, block: &Block<'a>, words: &Words, functions: &Functions) {
        if functions.retract.is_some() && words.retracts {
            self.settle();
            let mut to = self.machine.at;
            to[self.machine.plane.axes()[2]] = None;
            self.machine.rapid(block.line(), to);
            self.forget_tangent();
        }
    }

    /// Refuses a rapid where only a cut is read.
    pub(super) fn is_cut(&mut self, block: &Block<'a>, words: &Words) -> bool {
        let is_cut = words.feed != Some(Feed::Rapid);
        if !is_cut {
            self.refuse_block(block, Fault::Conflict);
        }
        is_cut
    }

    /// Refuses M91 and M92 where the block is not straight.
    pub(super) fn has_no_machine_zero(&mut self, block: &Block<'a>, functions: &Functions) -> bool {
        if let Some((_, span)) = functions.machine_zero {
            self.refuse(block, span, Fault::Conflict);
        }
        functions.machine_zero.is_none()
    }

    /// Puts a feed in force behind something that has a feed of its own.
    pub(super) fn set_feed(&mut self, (feed_mode, feed): (FeedMode, Option<f64>)) {
        (self.machine.feed_mode, self.machine.feed) = (feed_mode, feed);
        self.has_cycle_feed &= feed.is_none();
    }
}

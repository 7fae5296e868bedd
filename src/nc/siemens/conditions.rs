//! Feeds, speeds, tools and pauses.

use super::Mill;
use super::block::{Block, Tool};
use super::codes::Meaning;
use crate::block::{Line, WordValue};
use crate::codes::FeedMode;
use crate::fault::Fault;

/// Longest pause, s: a day.
const MAX_PAUSE_S: f64 = 86_400.0;

/// Highest number of a cutting edge.
const MAX_EDGE: f64 = 32_000.0;

impl<'a> Mill<'a, '_> {
    pub(super) fn take_feed_and_speed(&mut self, line: Line<'a>, block: &Block) {
        let is_dwell = block.has(Meaning::Dwell);
        if self.machine.feed_mode == FeedMode::InverseTime {
            self.machine.feed = None;
        }
        let [feed, speed] = [b'F', b'S'].map(|letter| block.letters.get(&letter).copied());
        for given in [feed, speed].into_iter().flatten() {
            if given.value < 0.0 {
                self.refuse(line, [given.start, given.end], Fault::OutOfRange(given.value));
            }
        }
        if let Some(given) = feed.filter(|_| !is_dwell) {
            self.machine.feed = Some(given.value * self.feed_unit());
        }
        if let Some(given) = speed.filter(|_| !is_dwell && !block.has(Meaning::Limits)) {
            self.machine.speed = Some(given.value);
        }
    }

    /// What a feed of the program is multiplied by.
    pub(super) fn feed_unit(&self) -> f64 {
        let counts_ways = self.machine.feed_mode != FeedMode::InverseTime;
        if counts_ways && self.feeds_in_inches { 25.4 } else { 1.0 }
    }

    pub(super) fn take_functions(&mut self, block: &Block) {
        for (number, _) in &block.functions {
            if matches!(number, 3..=5) {
                self.machine.is_turning = *number != 5;
            }
        }
    }

    pub(super) fn change_tool(&mut self, line: Line<'a>, block: &Block) {
        if block.tool.is_some() {
            self.called_tool.clone_from(&block.tool);
        }
        let has_m6 = block.functions.iter().any(|(number, _)| *number == 6);
        if has_m6 || self.t_changes && block.tool.is_some() {
            self.settle(line);
            match self.called_tool.clone() {
                Some(Tool::Number(number)) => self.machine.put_in_tool(line, Some(number), None),
                Some(Tool::Name(name)) => self.machine.put_in_tool(line, None, Some(name)),
                None => {
                    self.machine.left.add("M6", line.number);
                    return;
                }
            }
            self.lose_length();
            self.edge = None;
        }
        if let Some(given) = block.letters.get(&b'D').copied() {
            if !(given.value.fract() == 0.0 && (0.0..=MAX_EDGE).contains(&given.value)) {
                return self.refuse(line, [given.start, given.end], Fault::OutOfRange(given.value));
            }
            let edge = Some(given.value as u32);
            if edge != self.edge {
                self.settle(line);
                if self.edge.is_some() {
                    self.machine.exclude_compensation(line);
                }
                self.lose_length();
            }
            self.edge = edge;
        }
    }

    /// Another length of the tool puts its tip to a height that is not known.
    fn lose_length(&mut self) {
        let normal = self.machine.plane.axes()[2];
        self.machine.at[normal] = None;
        self.tangent = None;
    }

    /// G4: seconds by F, turns of the spindle by S.
    pub(super) fn dwell(&mut self, line: Line<'a>, block: &Block, span: [usize; 2]) {
        self.refuse_axes(line, block);
        let [feed, speed] = [b'F', b'S'].map(|letter| block.letters.get(&letter).copied());
        let (given, seconds) = match (feed, speed) {
            (Some(given), None) => (given, given.value),
            (None, Some(given)) => match self.machine.speed.filter(|speed| *speed > 0.0) {
                Some(speed) => (given, given.value * 60.0 / speed),
                None => return self.machine.refuse_state(line, Fault::NoSpindleSpeed),
            },
            _ => return self.refuse(line, span, Fault::Missing('F')),
        };
        self.settle(line);
        self.pause(line, [given.start, given.end], seconds);
    }

    pub(super) fn pause(&mut self, line: Line<'a>, [start, end]: [usize; 2], seconds: f64) {
        if !(0.0..=MAX_PAUSE_S).contains(&seconds) {
            return self.refuse(line, [start, end], Fault::OutOfRange(seconds));
        }
        let word = WordValue { value: seconds, start, end, lacks_point: false };
        self.machine.pause(line, word, seconds);
    }

    /// Refuses words of places beside a code that takes none.
    fn refuse_axes(&mut self, line: Line<'a>, block: &Block) {
        for given in block.axes.iter().flatten() {
            self.machine.refuse(line.refusal(given.start, given.end, Fault::UnusedWord));
        }
    }
}

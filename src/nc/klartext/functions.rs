//! M functions.

use super::Execution;
use super::script::Block;
use super::words::Words;
use crate::codes::FeedMode;
use crate::fault::Fault;

/// What the M functions of a block ask for behind its move.
#[derive(Debug, Default)]
pub struct Functions {
    /// M91 or M92.
    pub machine_zero: Option<(u32, [usize; 2])>,
    /// M140.
    pub retract: Option<[usize; 2]>,
    /// M99 or M89, and whether it is M89.
    call: Option<([usize; 2], bool)>,
    changes_tool: bool,
    ends: Option<[usize; 2]>,
}

impl<'a> Execution<'a, '_> {
    /// Lets M functions take effect that act at the start of a block, and tells the others.
    pub(super) fn begin_functions(&mut self, block: &Block<'a>, words: &Words) -> Functions {
        let mut functions = Functions::default();
        for (number, span) in words.functions.iter().copied() {
            match number {
                2 | 30 => functions.ends = Some(span),
                3 | 4 | 13 | 14 => self.machine.is_turning = true,
                5 => self.machine.is_turning = false,
                6 => functions.changes_tool = true,
                89 => functions.call = Some((span, true)),
                99 => functions.call = Some((span, false)),
                91 | 92 => functions.machine_zero = Some((number, span)),
                136 if self.machine.in_inches() => self.refuse(block, span, Fault::UnsureFeed),
                136 | 137 => self.count_feed_per_turn(number == 136),
                140 if words.retracts && words.axes == [None; 3] => functions.retract = Some(span),
                // Feeds, corners, datums, filters, tilting and handwheels that change the path or its feed.
                97 | 98 | 103 | 104 | 112 | 114 | 118 | 124 | 128 | 130 | 140 | 142..=144 | 197 => {
                    self.refuse(block, span, Fault::NotRead);
                }
                _ if number > 9999 => self.refuse(block, span, Fault::UnknownCode),
                _ => {}
            }
            if !matches!(number, 2..=5 | 13 | 14 | 30 | 89 | 91 | 92 | 99 | 136 | 137 | 140) {
                self.machine.left.add(&format!("M{number}"), block.line().number);
            }
        }
        functions
    }

    fn count_feed_per_turn(&mut self, is_per_turn: bool) {
        if self.is_per_turn != is_per_turn {
            self.is_per_turn = is_per_turn;
            let mode = if is_per_turn { FeedMode::PerTurn } else { FeedMode::PerMinute };
            (self.machine.feed_mode, self.machine.feed) = (mode, None);
        }
    }

    /// Lets M functions take effect that act at the end of a block. `moves` tells whether the block moves.
    pub(super) fn end_functions(&mut self, block: &Block<'a>, functions: &Functions, moves: bool) {
        if let (Some((number, _)), false) = (functions.machine_zero, moves) {
            self.machine.left.add(&format!("M{number}"), block.line().number);
        }
        if let Some((span, is_modal)) = functions.call {
            self.settle();
            self.is_modal_call = is_modal;
            self.call_cycle(block, span);
        } else if self.is_modal_call && moves {
            self.settle();
            self.call_cycle(block, [0, 0]);
        }
        if functions.changes_tool {
            self.settle();
            // Machines change tools at a height of their own.
            self.machine.at[2] = None;
            self.machine.at[self.machine.plane.axes()[2]] = None;
            self.forget_tangent();
        }
        if let Some(span) = functions.ends {
            self.settle();
            self.end_all(block, span);
        }
    }
}

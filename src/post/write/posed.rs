//! The words of blocks that state the tool axis.

use super::Writer;
use crate::post::WriteError;
use crate::post::block::{AxisWords, BlockFeed};
use crate::post::posed::VECTOR_DECIMALS;
use crate::post::words::OFFSETS;

impl Writer<'_> {
    /// The code after which coordinates are those of the tip, with the length offset.
    pub(super) fn begin_tip_control(&mut self, axis: AxisWords) -> Result<(), WriteError> {
        self.motion("G0");
        self.owes_length_offset = false;
        self.has_tip_control = true;
        let codes = self.job.dialect.tip_control;
        let code = match axis {
            AxisWords::Angles(_) => codes.angles,
            AxisWords::Vector(_) => codes.vectors,
        };
        self.word(&format!("{} H{}", code.ok_or(WriteError::AxisOutput)?, self.tool().1));
        Ok(())
    }

    pub(super) fn end_posed(&mut self) {
        if std::mem::take(&mut self.has_tip_control) {
            self.word("G49");
        }
        self.feed_mode(false);
    }

    pub(super) fn posed(&mut self, to: [i64; 3], axis: AxisWords, feed: BlockFeed) {
        match feed {
            BlockFeed::Rapid => {
                self.motion("G0");
                self.place(to, axis);
            }
            BlockFeed::PerMinute(feed) => {
                self.feed_mode(false);
                self.motion("G1");
                self.place(to, axis);
                self.feed(feed);
            }
            BlockFeed::InverseTime(feed) => {
                self.feed_mode(true);
                self.motion("G1");
                self.place(to, axis);
                // Under G93 every block states its own time.
                self.feed = None;
                self.feed(feed);
            }
        }
    }

    /// Selects feeds by inverse time (G93) or by the minute (G94).
    fn feed_mode(&mut self, is_inverse_time: bool) {
        if self.is_inverse_time != is_inverse_time {
            self.word(if is_inverse_time { "G93" } else { "G94" });
            self.is_inverse_time = is_inverse_time;
            self.feed = None;
        }
    }

    pub(super) fn place(&mut self, to: [i64; 3], axis: AxisWords) {
        for (axis, to) in to.into_iter().enumerate() {
            self.axis_if_changed(axis, to);
        }
        self.axis_words(axis);
    }

    /// The words of the tool axis. Angles are modal, vectors are not.
    pub(super) fn axis_words(&mut self, axis: AxisWords) {
        match axis {
            AxisWords::Vector(parts) => {
                for (letter, part) in OFFSETS.into_iter().zip(parts) {
                    self.number(letter.encode_utf8(&mut [0; 4]), part, VECTOR_DECIMALS);
                }
            }
            AxisWords::Angles(angles) => {
                let names = self.job.rotary_names();
                let mut words: Vec<(char, usize)> = names.into_iter().zip(0..).collect();
                words.sort_unstable();
                for (letter, k) in words {
                    if self.angles[k] != Some(angles[k]) {
                        let decimals = self.job.dialect.angle_decimals;
                        self.number(letter.encode_utf8(&mut [0; 4]), angles[k], decimals);
                        self.angles[k] = Some(angles[k]);
                    }
                }
            }
        }
    }
}

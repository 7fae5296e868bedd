//! The words of blocks that state the tool axis.

use super::Writer;
use crate::WriteError;
use crate::block::{AxisWords, BlockFeed};
use crate::dialect::{AxisOutput, TipControl};
use crate::posed::VECTOR_DECIMALS;

impl Writer<'_> {
    /// Writes the words that begin tip control, with the length offset.
    pub(super) fn begin_tip_control(&mut self, axis: AxisWords) -> Result<(), WriteError> {
        let TipControl { before, words, off, .. } = self.tip_control(axis).ok_or(WriteError::AxisOutput)?;
        for text in before {
            self.template(text);
            self.lines.end()?;
        }
        self.motion("G0");
        self.owes_length_offset = false;
        self.tip_control_off = Some(off);
        if let Some(words) = words {
            self.template(words);
        }
        Ok(())
    }

    fn tip_control(&self, axis: AxisWords) -> Option<TipControl> {
        let words = self.job.dialect.five_axes;
        match axis {
            AxisWords::Angles(_) => words.angles,
            AxisWords::Vector(_)
                if self.job.five_axes.is_some_and(|five| five.output == AxisOutput::Rails) =>
            {
                words.rails
            }
            AxisWords::Vector(_) => words.vectors,
        }
    }

    pub(super) fn end_posed(&mut self) -> Result<(), WriteError> {
        if let Some(off) = self.tip_control_off.take() {
            self.lines.line(off)?;
        }
        self.feed_mode(false);
        Ok(())
    }

    pub(super) fn posed(&mut self, to: [i64; 3], axis: AxisWords, feed: BlockFeed) -> Result<(), WriteError> {
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
            // No dialect of ISO words has such a feed.
            BlockFeed::DegreesPerMinute(_) => return Err(WriteError::AxisOutput),
        }
        Ok(())
    }

    /// Selects feeds by inverse time (G93) or by the minute (G94).
    pub(super) fn feed_mode(&mut self, is_inverse_time: bool) {
        if self.is_inverse_time != is_inverse_time {
            self.lines.word(if is_inverse_time { "G93" } else { "G94" });
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
                let Some(TipControl { vector, .. }) = self.tip_control(axis) else { return };
                for (word, part) in vector.into_iter().zip(parts) {
                    self.lines.number(word, part, VECTOR_DECIMALS);
                }
            }
            AxisWords::Angles(angles) => {
                for (letter, k) in self.job.rotary_words() {
                    if self.angles[k] != Some(angles[k]) {
                        let decimals = self.job.dialect.five_axes.angle_decimals;
                        self.lines.number(letter.encode_utf8(&mut [0; 4]), angles[k], decimals);
                        self.angles[k] = Some(angles[k]);
                    }
                }
            }
        }
    }
}

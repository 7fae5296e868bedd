//! Motions that state the tool axis: by the angles of rotary axes, or as a vector.

use super::super::posed::{Posed, PosedFeed, ROTARY, TipMode};
use super::super::{Fault, Step};
use super::Reader;
use super::control::Control;
use super::words::Words;
use crate::nc::{FeedMode, Motion};

const NO_OFFSET: i32 = 490;

/// What is known of the tool axis.
#[derive(Debug, Clone, Copy, Default)]
pub struct Leaning {
    mode: TipMode,
    angles: [Option<f64>; 3],
}

impl Leaning {
    /// Returns whether coordinates are those of another point behind the code.
    pub fn apply(&mut self, code: i32, control: &Control) -> bool {
        let before = self.mode;
        if Some(code) == control.angles {
            self.mode = TipMode::Angles;
        } else if Some(code) == control.vectors {
            self.mode = TipMode::Vectors;
        } else if code == NO_OFFSET && control.kinematics.is_none() {
            self.mode = TipMode::Off;
        }
        self.mode != before
    }

    /// The same for the M codes of a block, which may hold no other word.
    pub fn switch(&mut self, words: &Words, control: &Control) -> Result<bool, Fault> {
        let Some([tip, axes]) = control.kinematics else { return Ok(false) };
        if !words.m.has(tip) && !words.m.has(axes) {
            return Ok(false);
        }
        let is_alone = words.m.all().len() == 1 && words.g.all().is_empty();
        if !is_alone || words.first_of("XYZABCIJKFHST").is_some() {
            return Err(Fault::Conflict);
        }
        let mode = if words.m.has(tip) { TipMode::Angles } else { TipMode::Off };
        Ok(std::mem::replace(&mut self.mode, mode) != mode)
    }

    /// # Errors
    /// When tip control is on. The machine's own coordinates and the end of a program need it off.
    pub fn check_off(&self) -> Result<(), Fault> {
        if self.mode == TipMode::Off { Ok(()) } else { Err(Fault::UnderTipControl) }
    }

    /// Whether a block of motion has a tool axis.
    pub fn is_in_force(&self, words: &Words) -> bool {
        self.mode != TipMode::Off
            || self.angles.iter().any(Option::is_some)
            || words.first_of("ABC").is_some()
    }
}

impl Reader {
    /// A straight motion with the tool axis at its end.
    pub(super) fn posed(
        &mut self,
        words: &Words,
        motion: Motion,
        from: [Option<f64>; 3],
    ) -> Result<Step, Fault> {
        if !matches!(motion, Motion::Rapid | Motion::Line) {
            return Err(Fault::Conflict);
        }
        let has_vectors = self.leaning.mode == TipMode::Vectors;
        if let Some(letter) = words.first_of(if has_vectors { "ABC" } else { "IJK" }) {
            return Err(Fault::Unused(letter));
        }
        let vector = if has_vectors {
            let part = |letter| words.get(letter).ok_or(Fault::Missing(letter));
            Some([part('I')?, part('J')?, part('K')?])
        } else {
            None
        };
        for (angle, letter) in self.leaning.angles.iter_mut().zip(ROTARY) {
            *angle = words.get(letter).or(*angle);
        }
        let feed = match (motion, self.modal.feed_mode) {
            (Motion::Rapid, _) => PosedFeed::Rapid,
            (_, Some(FeedMode::InverseTime)) => {
                let feed = words.get('F').filter(|f| *f > 0.0).ok_or(Fault::NoFeed)?;
                if feed > self.control.most_inverse_time {
                    return Err(Fault::BadNumber('F'));
                }
                PosedFeed::Seconds(60.0 / feed)
            }
            _ => PosedFeed::Feed(self.modal.feed.ok_or(Fault::NoFeed)?),
        };
        if feed != PosedFeed::Rapid && from.iter().any(Option::is_none) {
            return Err(Fault::UnknownStart);
        }
        let Leaning { mode, angles } = self.leaning;
        Ok(Step::Posed(Posed { from, to: self.modal.at, angles, vector, mode, feed }))
    }
}

//! Blocks of motion.

use super::super::cut::Cut;
use super::super::{Posed, PosedFeed, ROTARY, Step, TipMode};
use super::Reader;
use super::words::Words;
use crate::nc::{Fault, FeedMode, Motion, WordFault};

/// The letters of a position, and of the offsets from the start of an arc to its centre.
const LINEAR: [char; 3] = ['X', 'Y', 'Z'];
const OFFSETS: [&str; 3] = ["I", "J", "K"];

/// The largest F under G93.
const MOST_INVERSE_TIME: f64 = 99_999.99;

impl Reader<'_> {
    /// The motion of a block; none where the block has no coordinates.
    pub(super) fn motion(&mut self, words: &Words) -> Result<Option<Step>, Fault> {
        let mode = self.mode();
        let is_inverse = self.modal.feed_mode == Some(FeedMode::InverseTime);
        let has_motion = words.first_of("XYZIJKABC").is_some() || words.has_vector();
        let is_rapid = self.modal.motion == Some(Motion::Rapid);
        if is_inverse && (!has_motion || is_rapid) && words.get('F').is_some() {
            return Err(Fault::Word("F", WordFault::Unused));
        }
        if !has_motion {
            return Ok(None);
        }
        if self.is_on_rails {
            // Each block under ORICURVE states the second point.
            return Err(Fault::Word("XH", WordFault::Missing));
        }
        let motion = self.modal.motion.ok_or(Fault::NoMotion)?;
        self.modal.distance.ok_or(Fault::NoMode("G90"))?;
        if (words.get('Z').is_some() || self.has_tip_control) && self.edge == 0 {
            return Err(Fault::NoEdge);
        }
        if let Some(hole) = self.hole(words)? {
            return Ok(Some(hole));
        }
        if words.has_vector() && mode? != TipMode::Vectors {
            return Err(Fault::NoTipControl);
        }
        if let (Motion::Rapid | Motion::Line, Some(letter)) = (motion, words.first_of("IJK")) {
            return Err(Fault::Word(letter, WordFault::Unused));
        }
        let from = self.moved(words)?;
        let is_posed = mode? != TipMode::Off
            || self.angles.iter().any(Option::is_some)
            || words.first_of("ABC").is_some();
        if is_posed {
            return self.posed(words, motion, mode?, from).map(Some);
        }
        if motion == Motion::Rapid {
            return Ok(Some(Step::Rapid { from, to: self.modal.at }));
        }
        if self.has_lost_axis {
            return Err(Fault::UnknownStart);
        }
        if is_inverse {
            // The step of a cut without an axis has no time.
            return Err(Fault::Conflict);
        }
        let cut = Cut::between(from, self.modal.at, self.modal.feed.ok_or(Fault::NoFeed)?)?;
        let Motion::Arc(direction) = motion else { return Ok(Some(cut.line())) };
        let plane = self.plane()?;
        let [a, b, normal] = plane.axes();
        let offsets = words.three(['I', 'J', 'K']);
        if offsets[normal].is_some() {
            return Err(Fault::Word(OFFSETS[normal], WordFault::Unused));
        }
        if offsets[a].is_none() && offsets[b].is_none() {
            return Err(Fault::MissingCenter);
        }
        let mut center = cut.start();
        for axis in [a, b] {
            center[axis] += offsets[axis].unwrap_or_default() * self.unit_mm()?;
        }
        cut.arc(plane, direction, center, &self.arcs).map(Some)
    }

    /// How the axis is told. An error where tip control is on, but neither of its two ways is selected, or
    /// where nothing states the frame of a vector.
    fn mode(&self) -> Result<TipMode, Fault> {
        match (self.has_tip_control, self.orientation) {
            (false, _) => Ok(TipMode::Off),
            (true, None) => Err(Fault::NoMode("ORIAXES or ORIVECT")),
            (true, Some(TipMode::Vectors)) if !self.is_in_workpiece => Err(Fault::NoMode("ORIWKS")),
            (true, Some(mode)) => Ok(mode),
        }
    }

    /// A straight motion with the tool axis at its end.
    fn posed(
        &mut self,
        words: &Words,
        motion: Motion,
        mode: TipMode,
        from: [Option<f64>; 3],
    ) -> Result<Step, Fault> {
        if !matches!(motion, Motion::Rapid | Motion::Line) {
            return Err(Fault::Conflict);
        }
        let (turns, is_known) = if mode == TipMode::Vectors {
            if let Some(letter) = words.first_of("ABC") {
                return Err(Fault::Word(letter, WordFault::Unused));
            }
            let vector = words.whole_vector()?;
            let before = self.vector.replace(vector);
            (self.angles, self.has_lost_axis) = ([None; 3], true);
            (before != Some(vector), before.is_some())
        } else {
            let (before, turned) = (self.angles, words.three(ROTARY));
            self.angles = [0, 1, 2].map(|k| turned[k].or(before[k]));
            let begins = (0..3).any(|k| before[k].is_none() && turned[k].is_some());
            (self.angles != before, !begins && before.iter().any(Option::is_some))
        };
        let feed = if motion == Motion::Rapid {
            PosedFeed::Rapid
        } else if from.iter().any(Option::is_none) || !is_known {
            return Err(Fault::UnknownStart);
        } else {
            let rests = from == self.modal.at;
            self.posed_feed(words, turns && (rests || mode == TipMode::Off))?
        };
        let (to, angles, vector) = (self.modal.at, self.angles, self.vector);
        Ok(Step::Posed(Posed { from, to, angles, vector, mode, feed }))
    }

    /// The feed of a feed block. `needs_time` tells that no feed by the minute has a known meaning.
    fn posed_feed(&self, words: &Words, needs_time: bool) -> Result<PosedFeed, Fault> {
        match self.modal.feed_mode {
            Some(FeedMode::InverseTime) => {
                let feed = words.get('F').ok_or(Fault::NoFeed)?;
                if feed > MOST_INVERSE_TIME {
                    return Err(Fault::Word("F", WordFault::Range));
                }
                Ok(PosedFeed::Seconds(60.0 / feed))
            }
            _ if needs_time => Err(Fault::Conflict),
            _ => Ok(PosedFeed::Feed(self.modal.feed.ok_or(Fault::NoFeed)?)),
        }
    }

    /// Goes to the coordinates of a block, and returns where the block starts.
    fn moved(&mut self, words: &Words) -> Result<[Option<f64>; 3], Fault> {
        let (from, unit_mm) = (self.modal.at, self.unit_mm()?);
        let to = words.three(LINEAR);
        self.modal.at = [0, 1, 2].map(|axis| to[axis].map(|value| value * unit_mm).or(from[axis]));
        Ok(from)
    }
}

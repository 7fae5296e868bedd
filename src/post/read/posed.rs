//! Motions that state the tool axis: by the angles of rotary axes, or as a vector.

use super::words::Words;
use super::{Fault, FeedMode, Motion, Reader};
use crate::toolpath::units::FeedRate;

/// The codes after which coordinates are those of the tip: with angles, and with vectors.
pub const ANGLES: i32 = 434;
pub const VECTORS: i32 = 435;
const NO_OFFSET: i32 = 490;

/// The letters of rotary axes.
pub const ROTARY: [char; 3] = ['A', 'B', 'C'];

/// What the control does with the tip.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum TipMode {
    /// Coordinates are those of the linear axes.
    #[default]
    Off,
    Angles,
    Vectors,
}

/// How long a motion takes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Pace {
    Rapid,
    Feed(FeedRate),
    Seconds(f64),
}

/// One motion. Coordinates in mm, angles of A, B and C in degrees, where they are known.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Posed {
    pub from: [Option<f64>; 3],
    pub to: [Option<f64>; 3],
    pub angles: [Option<f64>; 3],
    pub vector: Option<[f64; 3]>,
    pub mode: TipMode,
    pub pace: Pace,
}

/// What is known of the tool axis.
#[derive(Debug, Clone, Copy, Default)]
pub struct Leaning {
    mode: TipMode,
    angles: [Option<f64>; 3],
}

impl Leaning {
    pub fn apply(&mut self, code: i32) {
        match code {
            ANGLES => self.mode = TipMode::Angles,
            VECTORS => self.mode = TipMode::Vectors,
            NO_OFFSET => self.mode = TipMode::Off,
            _ => {}
        }
    }

    /// Whether a block of motion has a tool axis.
    pub fn is_in_force(&self, words: &Words) -> bool {
        self.mode != TipMode::Off
            || self.angles.iter().any(Option::is_some)
            || words.first_of("ABC").is_some()
    }
}

impl Reader<'_> {
    /// A straight motion with the tool axis at its end.
    pub(super) fn posed(
        &mut self,
        words: &Words,
        motion: Motion,
        from: [Option<f64>; 3],
    ) -> Result<super::Step, Fault> {
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
        let pace = match (motion, self.modal.feed_mode) {
            (Motion::Rapid, _) => Pace::Rapid,
            (_, Some(FeedMode::InverseTime)) => {
                Pace::Seconds(60.0 / words.get('F').filter(|f| *f > 0.0).ok_or(Fault::NoFeed)?)
            }
            _ => Pace::Feed(self.modal.feed.ok_or(Fault::NoFeed)?),
        };
        if pace != Pace::Rapid && from.iter().any(Option::is_none) {
            return Err(Fault::UnknownStart);
        }
        let Leaning { mode, angles } = self.leaning;
        Ok(super::Step::Posed(Posed { from, to: self.modal.at, angles, vector, mode, pace }))
    }
}

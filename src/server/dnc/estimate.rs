//! How long a program takes on its line, and the feed above which the line is too slow for the machine.

use std::time::Duration;

use super::grbl;
use super::settings::{Flow, Settings};
use super::tape::{Tape, TapeError};

/// Length of the moves for which the feed is told, in mm. Programs of free-form surfaces commonly have moves
/// of this length.
pub const MOVE_MM: f64 = 0.1;

/// What is known of a sending before it begins.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimate {
    pub n_characters: usize,
    pub n_lines: usize,
    pub characters_per_s: f64,
    /// Time at the full speed of the line, without waiting for the control.
    pub time: Duration,
    /// Blocks a second, at the average length of the program's blocks.
    pub blocks_per_s: f64,
    /// The feed at which a machine runs moves of [`MOVE_MM`] as fast as their blocks arrive, in mm/min. Above
    /// it the control starves.
    pub starving_feed: f64,
}

impl Estimate {
    /// # Errors
    /// When the line cannot carry the program.
    pub fn of(program: &[u8], settings: &Settings) -> Result<Self, TapeError> {
        let (n_characters, n_blocks, n_lines) = match settings.flow {
            Flow::Grbl => {
                let program = grbl::program(program)?;
                (program.text().len(), program.blocks().len(), program.n_lines())
            }
            Flow::None | Flow::XonXoff | Flow::RtsCts => {
                let tape = Tape::new(program, settings)?;
                (tape.bytes().len(), tape.n_lines(), tape.n_lines())
            }
        };
        let characters_per_s = settings.characters_per_s();
        let seconds = n_characters as f64 / characters_per_s;
        let blocks_per_s = n_blocks as f64 / seconds;
        Ok(Self {
            n_characters,
            n_lines,
            characters_per_s,
            time: Duration::from_secs_f64(seconds),
            blocks_per_s,
            starving_feed: blocks_per_s * MOVE_MM * 60.0,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn at_9600_baud_in_7e2_short_blocks_starve_above_262_mm_per_min() {
        // 20 characters a block, with its line end; no marks and no leader.
        let program = "G1X100.123Y-100.123\n".repeat(1000);
        let settings =
            Settings { leader: Some(0), marks: super::super::settings::Marks::AsIs, ..Settings::default() };
        let estimate = Estimate::of(program.as_bytes(), &settings).expect("a program");
        assert_eq!((estimate.n_characters, estimate.n_lines), (20_000, 1000));
        assert_eq!(estimate.time.as_millis(), 22_916);
        assert_eq!((estimate.blocks_per_s.round(), estimate.starving_feed.round()), (44.0, 262.0));
    }
}

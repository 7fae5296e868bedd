//! What a program asks of the machine besides motion, against what the job asks for.
//!
//! # Method
//! A cut and a dwell need all of it: tool, length offset, work offset, spindle and coolant. A rapid along Z
//! needs the tool and both offsets, and any other rapid the tool and the work offset. A rapid to or from the
//! place where the machine rests comes before the tool is called, or after it is put away, and needs nothing.

use super::super::block::{Block, BlockFeed};
use super::super::read::{MachineState, Reader, Spindle};
use super::super::{ProgramJob, WriteError, words};
use super::first_false;
use toolpathd_core::toolpath::cutting::Coolant;
use toolpathd_core::toolpath::program::SafeHome;

/// Largest difference of a written and a read speed of the spindle, as a part of the speed: the rounding of a
/// number.
const SPEED_AGREEMENT: f64 = 1e-12;

/// What a block needs of the machine.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Needs {
    Nothing,
    Tool,
    LengthOffset,
    Everything,
}

impl Needs {
    fn of(block: &Block) -> Self {
        match block {
            Block::Park { .. }
            | Block::EndRails
            | Block::EndPosed
            | Block::BeginCycle { .. }
            | Block::EndCycle => Self::Nothing,
            Block::Rotate { .. } | Block::Rapid { to: [_, _, None] } => Self::Tool,
            Block::BeginTipControl { .. }
            | Block::Rapid { .. }
            | Block::Posed { feed: BlockFeed::Rapid, .. } => Self::LengthOffset,
            Block::Line { .. }
            | Block::Arc { .. }
            | Block::Helix { .. }
            | Block::Parabola { .. }
            | Block::Posed { .. }
            | Block::BeginRails { .. }
            | Block::Rail { .. }
            | Block::Hole { .. }
            | Block::Dwell { .. } => Self::Everything,
        }
    }
}

/// The name of what differs at a block; `None` where nothing does. Before the block, the tool has moved
/// `homes` times to the machine's end of Z.
///
/// # Errors
/// When the speed of the spindle cannot be written.
pub fn difference(
    read: &Reader,
    block: &Block,
    job: &ProgramJob,
    homes: u32,
) -> Result<Option<&'static str>, WriteError> {
    let needs = Needs::of(block);
    if needs == Needs::Nothing {
        return Ok(None);
    }
    let (state, calls, (number, offset)) = (read.state(), read.calls(), job.tool_numbers());
    let is_own_change = !job.program.custom.tool_change.is_empty();
    let step_mm = 10f64.powi(-i32::from(job.dialect.max_decimals));
    let is_radius = |read: f64| job.tool.is_some_and(|tool| (read - tool.radius_mm).abs() <= 0.5 * step_mm);
    let rpm = job.cutting.spindle_rpm.map(|rpm| words::spindle(rpm, &job.dialect.numbers)).transpose()?;
    let turns = match rpm.map(words::FeedWord::value) {
        None => state.spindle == Spindle::Off,
        Some(rpm) => {
            let is_speed = |read: f64| (read - rpm).abs() <= SPEED_AGREEMENT * rpm;
            state.spindle == Spindle::Clockwise && state.speed_rpm.is_some_and(is_speed)
        }
    };
    let of_tool = [
        (state.bad_changes == 0, "tool change"),
        (is_own_change || !calls.tools || state.tool == Some(number), "tool"),
        (state.tool_radius_mm.is_none_or(is_radius), "radius of the tool"),
        (state.homes == homes, "safe home"),
        (state.work_offset == job.program.work_offset.map(u32::from), "work offset"),
    ];
    let of_length = [(!calls.length_offsets || state.length_offset == Some(offset), "length offset")];
    let of_cut = [(turns, "spindle"), (state.coolant == job.cutting.coolant, "coolant")];
    let of_length = &of_length[..usize::from(needs >= Needs::LengthOffset)];
    let of_cut = &of_cut[..if needs == Needs::Everything { of_cut.len() } else { 0 }];
    Ok(first_false(&of_tool).or_else(|| first_false(of_length)).or_else(|| first_false(of_cut)))
}

/// How often the tool moves to the machine's end of Z before it is changed or the work offset is, and again
/// before the end.
pub fn homes(job: &ProgramJob) -> u32 {
    u32::from(job.program.safe_home != SafeHome::None)
}

/// The name of what differs at the end of the program, where nothing may be on, and the tool has moved
/// `homes` times to the machine's end of Z; `None` where nothing does.
pub fn difference_at_end(state: &MachineState, homes: u32) -> Option<&'static str> {
    first_false(&[
        (state.spindle == Spindle::Off, "spindle"),
        (state.coolant == Coolant::Off, "coolant"),
        (state.homes == homes, "safe home"),
    ])
}

//! What the words of a block ask of the machine besides motion.

use super::super::state::{FIRST_WORK_OFFSET, Spindle, count};
use super::words::Words;
use super::{HOME, MACHINE_COORDINATES, Reader, Step, WORK_OFFSETS};
use crate::nc::{Distance, Fault, Modal, Motion};
use toolpathd_core::geometry::plane::Plane;
use toolpathd_core::toolpath::cutting::Coolant;

const TOOL_CHANGE: i32 = 60;
const NO_LENGTH_OFFSET: i32 = 490;

impl Reader {
    /// Notes what a block asks of the machine besides motion. Where the plane is another one than XY, a
    /// length offset does not count along Z on every control.
    pub(super) fn ask(&mut self, words: &Words) {
        let (state, Words { g, m, .. }) = (&mut self.state, words);
        let number = |letter| words.get(letter).and_then(count);
        if m.has(TOOL_CHANGE) {
            if self.is_strict && state.tool.is_some() {
                // The change may run a program of its own, which leaves other modes.
                self.modal = Modal::UNKNOWN;
                (state.work_offset, state.length_offset) = (None, None);
            }
            state.change_tool(number('T'));
        }
        if let Some(speed) = words.get('S') {
            state.speed_rpm = Some(speed);
        }
        for code in m.all() {
            match code {
                30 => state.spindle = Spindle::Clockwise,
                50 => state.spindle = Spindle::Off,
                70 => state.coolant = Coolant::Mist,
                80 => state.coolant = Coolant::Flood,
                90 => state.coolant = Coolant::Off,
                _ => {}
            }
        }
        for &code in g.all() {
            if Some(code) == self.control.work_offset {
                let first = FIRST_WORK_OFFSET - 1;
                state.work_offset = number('H').filter(|row| *row > 0).map(|row| row.saturating_add(first));
            } else if self.control.takes_offset(code) {
                let is_along_z = self.modal.plane == Some(Plane::Xy);
                state.length_offset = number('H').filter(|_| is_along_z);
            } else if WORK_OFFSETS.contains(&code) {
                state.work_offset = Some(code.unsigned_abs() / 10);
            } else if code == NO_LENGTH_OFFSET {
                state.length_offset = None;
            }
        }
    }

    /// The move to the machine's end of Z: by G28 as a step of no length, or as a rapid to zero of the
    /// machine's coordinates.
    pub(super) fn home(&mut self, words: &Words) -> Result<Option<Step>, Fault> {
        self.leaning.check_off()?;
        let is_relative = self.modal.distance == Some(Distance::Incremental);
        let is_rapid = self.modal.motion == Some(Motion::Rapid);
        // The last of the two codes counts.
        let last = words.g.all().iter().rfind(|code| [HOME, MACHINE_COORDINATES].contains(code));
        let is_known = if last == Some(&HOME) { is_relative } else { !is_relative && is_rapid };
        if !is_known || words.get('Z') != Some(0.0) || words.first_of("XYIJKABC").is_some() {
            return Err(Fault::Conflict);
        }
        self.modal.at[2] = None;
        self.state.homes += 1;
        Ok(None)
    }
}

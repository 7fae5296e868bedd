//! What a program has asked of the machine besides motion: the tool, the spindle, the coolant, the offsets.

use toolpathd_core::toolpath::cutting::Coolant;

/// The sense in which the spindle turns.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Spindle {
    #[default]
    Off,
    Clockwise,
}

/// What the blocks so far have asked of the machine. A shop's own lines may ask for anything: behind them,
/// nothing counts as asked for.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct MachineState {
    /// The number of the tool that was called. 0 stands for no tool.
    pub tool: Option<u32>,
    /// The radius of the tool, mm, where the program states the radius.
    pub tool_radius_mm: Option<f64>,
    pub spindle: Spindle,
    /// The speed of the spindle, 1/min.
    pub speed_rpm: Option<f64>,
    pub coolant: Coolant,
    /// The work offset by its G code: 54 for the first of the control.
    pub work_offset: Option<u32>,
    /// The number of the length offset that is in force along Z.
    pub length_offset: Option<u32>,
    /// How often the tool has moved to the machine's end of Z.
    pub homes: u32,
    /// How often the tool was changed while the spindle turned or coolant flowed, or without its number.
    pub bad_changes: u32,
}

impl MachineState {
    /// Changes the tool to the one that the block names.
    pub fn change_tool(&mut self, tool: Option<u32>) {
        let runs = self.spindle != Spindle::Off || self.coolant != Coolant::Off;
        self.bad_changes += u32::from(runs || tool.is_none());
        self.tool = tool;
    }

    /// The state after a shop's own lines, which the reader skips. The counts `homes` and `bad_changes` stay.
    /// All other fields return to their defaults, as at the start of a program.
    pub fn behind_own_lines(self) -> Self {
        Self { homes: self.homes, bad_changes: self.bad_changes, ..Self::default() }
    }
}

/// What programs of a control can ask for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Calls {
    /// A tool by its number.
    pub tools: bool,
    /// A length offset by its number.
    pub length_offsets: bool,
}

/// The code of the first work offset.
pub const FIRST_WORK_OFFSET: u32 = 54;

/// The whole number from 0 on that a word states.
pub fn count(value: f64) -> Option<u32> {
    (value.fract() == 0.0 && (0.0..=f64::from(u32::MAX)).contains(&value)).then_some(value as u32)
}

//! What stands between two operations of a program.

use super::{Writer, split_end};
use crate::WriteError;
use crate::dialect::Frame;
use crate::sequence::Part;
use toolpathd_core::geometry::plane::Plane;
use toolpathd_core::toolpath::cutting::{Coolant, Cutting};

impl<'a> Writer<'a> {
    /// Ends an operation and begins the next one.
    pub(super) fn operation(&mut self, part: &'a Part<'a>) -> Result<(), WriteError> {
        let (change, before) = (part.change, self.job.cutting);
        if change.leaves() {
            let is_due = |frame: &&Frame| change.tool || !matches!(frame, Frame::Text(_));
            split_end(self.iso).1.iter().filter(is_due).try_for_each(|frame| self.frame(*frame))?;
            if change.tool {
                // Behind the change, the modes of the start select it.
                self.plane = Plane::Xy;
            } else {
                // The length of the tool counts along the normal of the plane.
                self.plane(Plane::Xy);
                self.lines.end()?;
            }
            (self.at, self.motion, self.feed) = ([None; 3], None, None);
        }
        (self.job, self.part) = (&part.operation.job, part);
        self.remarks()?;
        for frame in self.iso.start {
            let is_due = match frame {
                Frame::SpindleOn | Frame::CoolantOn => change.tool,
                // The way to the machine's end of Z may have ended the length offset.
                Frame::LengthOffset | Frame::LengthOffsetInFirstMotionAlongZ | Frame::Smoothing => {
                    change.leaves()
                }
                // Behind a tool change the modes are set again. The end of an operation ends its smoothing.
                Frame::Blending { .. } => {
                    change.leaves() && !change.tool && self.job.program.smoothing.is_some()
                }
                Frame::WorkOffset => change.work_offset && !change.tool,
                Frame::ToolChange if change.tool => {
                    self.template(self.iso.tool_change);
                    self.lines.end()?;
                    self.modes()?;
                    false
                }
                Frame::ToolChange
                | Frame::Header
                | Frame::Text(_)
                | Frame::ByUnits { .. }
                | Frame::SmoothingOff
                | Frame::SafeHome => false,
            };
            if is_due {
                self.frame(*frame)?;
            }
        }
        if change.tool { Ok(()) } else { self.conditions(before) }
    }

    /// Writes the spindle speed and the coolant of the operation, each only if it differs from its value in
    /// `before`. `before` holds the conditions of the operation before.
    fn conditions(&mut self, before: &Cutting) -> Result<(), WriteError> {
        let Cutting { spindle_rpm, coolant, .. } = *self.job.cutting;
        if spindle_rpm != before.spindle_rpm {
            match (before.spindle_rpm, spindle_rpm) {
                (_, None) => self.lines.line("M5")?,
                (None, Some(_)) => self.frame(Frame::SpindleOn)?,
                // The spindle turns already.
                (Some(_), Some(rpm)) => {
                    self.speed(rpm)?;
                    self.lines.end()?;
                }
            }
        }
        if coolant == before.coolant {
            return Ok(());
        }
        if before.coolant != Coolant::Off {
            self.lines.line("M9")?;
        }
        self.frame(Frame::CoolantOn)
    }
}

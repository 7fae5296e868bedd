//! Modal states that a program saves and restores: M70 to M73 of LinuxCNC.

use toolpathd_core::geometry::plane::Plane;

use super::{Fault, FeedMode, Line, Machine};

/// What M72 restores. The motion in force is no part of it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Modes {
    units: Option<bool>,
    plane: Plane,
    is_absolute: bool,
    centers: Option<bool>,
    feed_mode: FeedMode,
    feed: Option<f64>,
    speed: Option<f64>,
    is_turning: bool,
    returns_high: bool,
    work_offset: u32,
    length: Option<i64>,
    is_compensating: bool,
}

impl Machine<'_> {
    /// The modal state now.
    pub(crate) fn modes(&self) -> Modes {
        Modes {
            units: self.units,
            plane: self.plane,
            is_absolute: self.is_absolute,
            centers: self.centers,
            feed_mode: self.feed_mode,
            feed: self.feed,
            speed: self.speed,
            is_turning: self.is_turning,
            returns_high: self.returns_high,
            work_offset: self.frames.active(),
            length: self.length,
            is_compensating: self.is_compensating(),
        }
    }

    /// Restores a modal state. Cutter compensation that was or is in force is refused.
    pub(crate) fn restore_modes(&mut self, line: Line<'_>, modes: &Modes) {
        if modes.is_compensating || self.is_compensating() {
            return self.refuse(line.refused(Fault::InCompensation));
        }
        self.units = modes.units;
        self.plane = modes.plane;
        self.is_absolute = modes.is_absolute;
        self.centers = modes.centers;
        (self.feed_mode, self.feed) = (modes.feed_mode, modes.feed);
        (self.speed, self.is_turning) = (modes.speed, modes.is_turning);
        self.returns_high = modes.returns_high;
        if modes.work_offset != self.frames.active() {
            self.select_offset(line, modes.work_offset);
        }
        if modes.length != self.length {
            self.at[2] = None;
        }
        self.length = modes.length;
    }
}

//! When cutter compensation begins and ends, and by which radius.

use nalgebra::{Point3, Vector3};
use toolpathd_core::geometry::curve::Curve;
use toolpathd_core::geometry::plane::Plane;
use toolpathd_core::toolpath::path::PathError;
use toolpathd_core::toolpath::units::FeedRate;

use super::compensation::{Between, Compensation, Corners, Drive, Failure, MAX_BETWEEN, SAME_PLACE_MM, Step};
use super::{Block, Code, Correction, Cutter, Family, Fault, Line, Machine, Meaning, Note, Side, WordValue};
use crate::fault::Refusal;

/// Largest radius, mm.
const MAX_RADIUS_MM: f64 = 10_000.0;

impl Machine<'_> {
    /// G40, G41 and G42, and what excludes compensation.
    pub(super) fn compensate(&mut self, line: Line<'_>, block: &mut Block, meanings: &[(Code, Meaning)]) {
        if block.has(b"D") && !self.control.is_strict {
            self.radius_number = block.peek(b'D');
        }
        for (code, meaning) in meanings {
            match meaning {
                Meaning::CompensationEnd => self.end_compensation(),
                Meaning::Compensation(side) => {
                    let word = block.take(b'D');
                    let is_dynamic = code.tenths == 411 || code.tenths == 421;
                    let given = word.or(self.radius_number.filter(|_| !self.control.is_strict));
                    let number = match given {
                        Some(slot) if is_dynamic && self.control.is(Family::LinuxCnc) => {
                            let radius_mm = slot.value * self.unit_mm() / 2.0;
                            Radius::Stated(radius_mm)
                        }
                        Some(slot) => Radius::Numbered(slot),
                        None => Radius::OfTool,
                    };
                    self.begin_compensation(line, [code.start, code.end], *side, number);
                }
                _ => {}
            }
        }
        if !self.is_compensating() {
            return;
        }
        for (code, meaning) in meanings {
            let excludes = match meaning {
                Meaning::Plane(_) => self.compensation_plane() != Some(self.plane),
                Meaning::SetData
                | Meaning::Home
                | Meaning::Machine
                | Meaning::Local
                | Meaning::SetPlace
                | Meaning::UnsetPlace { .. }
                | Meaning::RestorePlace
                | Meaning::Cycle(_)
                | Meaning::Turn
                | Meaning::TurnEnd
                | Meaning::Tilt
                | Meaning::AlongPlane
                | Meaning::Scale
                | Meaning::ScaleEnd
                | Meaning::Mirror(_)
                | Meaning::Polar
                | Meaning::PolarEnd
                | Meaning::Parabola
                | Meaning::Length(_)
                | Meaning::WorkOffset(_)
                | Meaning::ExtendedOffset
                | Meaning::OffsetByH => true,
                _ => false,
            };
            if excludes {
                self.refuse_code(line, *code, Fault::InCompensation);
            }
        }
    }

    pub(crate) fn computes_compensation(&self) -> bool {
        matches!(self.setting.correction, Correction::Computed(_))
    }

    /// The radius that the caller gives for a tool, if the path of the centre is computed.
    pub(crate) fn given_radius(&self, number: Option<u32>) -> Option<Option<f64>> {
        match self.setting.correction {
            Correction::Computed(cutters) => Some(radius_among(cutters, number)),
            _ => None,
        }
    }

    /// Refuses what the control does not run under compensation, such as a cycle, and ends the compensation.
    pub(crate) fn exclude_compensation(&mut self, line: Line<'_>) {
        if self.compensation.take().is_some() {
            self.refuse(line.refused(Fault::InCompensation));
        }
    }

    /// Compensation begins on a side. `span` is where its word stands in the line.
    pub(crate) fn begin_compensation(
        &mut self,
        line: Line<'_>,
        [start, end]: [usize; 2],
        side: Side,
        radius: Radius,
    ) {
        let cutters = match self.setting.correction {
            Correction::Refused => return self.refuse(line.refusal(start, end, Fault::Compensation)),
            Correction::Wear => {
                return self.note_first(Note::CompensationAsWear { line: line.number });
            }
            Correction::Computed(cutters) => cutters,
        };
        let of = |number: Option<u32>| radius_among(cutters, number);
        let radius_mm = match radius {
            Radius::Stated(radius_mm) => Some(radius_mm),
            Radius::Numbered(slot) if slot.value == 0.0 => Some(0.0),
            // The number of an offset is that of its tool, unless the tool is known.
            Radius::Numbered(slot) if self.control.is(Family::LinuxCnc) || self.tool().is_none() => {
                (slot.value > 0.0 && slot.value.fract() == 0.0).then(|| of(Some(slot.value as u32))).flatten()
            }
            Radius::Numbered(_) | Radius::OfTool => of(self.tool()),
        };
        let needs_number = self.control.is(Family::Fanuc) || self.control.is(Family::Mach);
        if radius == Radius::OfTool && needs_number {
            return self.refuse(line.refusal(start, end, Fault::Missing('D')));
        }
        let Some(radius_mm) = radius_mm.filter(|radius| (0.0..=MAX_RADIUS_MM).contains(radius)) else {
            return self.refuse(line.refusal(start, end, Fault::UnknownRadius));
        };
        let is_linuxcnc = self.control.is(Family::LinuxCnc);
        if is_linuxcnc && self.plane == Plane::Yz {
            return self.refuse(line.refusal(start, end, Fault::Conflict));
        }
        if self.is_compensating() {
            if is_linuxcnc || !self.continues(side, radius_mm) {
                self.refuse(line.refusal(start, end, Fault::InCompensation));
            }
            return;
        }
        if radius_mm > 0.0 {
            self.start_compensation(line, side, radius_mm);
        }
    }
}

impl Machine<'_> {
    pub(crate) fn is_compensating(&self) -> bool {
        self.compensation.is_some()
    }

    /// The side on which the tool goes where it lies, behind mirrors.
    pub(crate) fn compensation_side(&self) -> Option<Side> {
        self.compensation.as_ref().map(|own| own.side)
    }

    pub(super) fn compensation_plane(&self) -> Option<Plane> {
        self.compensation.as_ref().map(|own| own.plane)
    }

    /// Whether the compensation in force is one of this side and radius.
    pub(super) fn continues(&self, side: Side, radius_mm: f64) -> bool {
        let side = self.side_placed(side);
        self.compensation.as_ref().is_some_and(|own| own.side == side && own.radius_mm == radius_mm)
    }

    /// The radius of the tool in the spindle, by which an approach keeps off its contour. `None` has been
    /// refused. A path of the centre has no radius.
    pub(crate) fn approach_radius(&mut self, line: Line<'_>, [start, end]: [usize; 2]) -> Option<f64> {
        let fault = match self.setting.correction {
            Correction::Refused => Fault::Compensation,
            Correction::Wear => {
                self.note_first(Note::CompensationAsWear { line: line.number });
                return Some(0.0);
            }
            Correction::Computed(cutters) => {
                let own = radius_among(cutters, self.tool());
                match own.filter(|radius| (0.0..=MAX_RADIUS_MM).contains(radius)) {
                    Some(radius_mm) => return Some(radius_mm),
                    None => Fault::UnknownRadius,
                }
            }
        };
        self.refuse(line.refusal(start, end, fault));
        None
    }

    /// Compensation begins where the tool stands already beside the start of the next block.
    pub(crate) fn compensate_from_here(&mut self, line: Line<'_>, side: Side, radius_mm: f64) {
        self.start_compensation(line, side, radius_mm);
        if let Some(compensation) = &mut self.compensation {
            compensation.is_beside = true;
        }
    }

    /// The place of the tool becomes the one beside the contour, where compensation has ended.
    pub(crate) fn stand_beside(&mut self) {
        if let Some(shift) = self.displaced.take() {
            self.at = [0, 1, 2].map(|k| self.at[k].map(|at| at + shift[k]));
        }
    }

    /// The side where the contour lies: a mirror exchanges the sides.
    pub(crate) fn side_placed(&self, side: Side) -> Side {
        match self.placement.in_plane(self.plane) {
            Some((_, true)) => side.other(),
            _ => side,
        }
    }

    /// Compensation by `radius_mm` begins with the next block.
    pub(crate) fn start_compensation(&mut self, line: Line<'_>, side: Side, radius_mm: f64) {
        let side = self.side_placed(side);
        let place = Self::place(&self.at);
        let tip = match place {
            Ok(place) => place + self.displaced.take().unwrap_or_default(),
            Err(axis) => return self.refuse_state(line, Fault::UnknownStart(axis)),
        };
        self.compensation =
            Some(Compensation { side, radius_mm, plane: self.plane, tip, waiting: None, is_beside: false });
        if self.control.is(Family::Fanuc) {
            self.note_first(Note::CompensationComputed { line: line.number, radius_mm });
        }
    }

    /// Compensation ends: the block that waits ends at right angles to its end. The next move begins there.
    pub(crate) fn end_compensation(&mut self) {
        let Some(mut compensation) = self.compensation.take() else { return };
        if let Err(failure) = compensation.finish(&mut self.record) {
            self.refuse_failure(failure);
        }
        let shift = Self::place(&self.at).map_or_else(|_| Vector3::zeros(), |at| compensation.tip - at);
        self.displaced = (shift.norm() > SAME_PLACE_MM).then_some(shift);
    }

    /// The ends of a straight move after compensation: it begins beside the contour. On most controls a move
    /// along the normal stays beside it.
    pub(super) fn displace(&mut self, start: Point3<f64>, end: Point3<f64>) -> [Point3<f64>; 2] {
        let Some(shift) = self.displaced.take() else { return [start, end] };
        let [a, b, _] = self.plane.axes();
        let is_along = start[a] == end[a] && start[b] == end[b];
        if is_along && !self.control.is(Family::LinuxCnc) {
            self.displaced = Some(shift);
            [start + shift, end + shift]
        } else {
            [start + shift, end]
        }
    }

    /// Gives a move to the compensation in force.
    pub(super) fn follow(&mut self, curve: Curve, feed: Option<(FeedRate, Option<f64>)>, line: Line<'_>) {
        let drive = feed.map_or(Drive::Rapid, |(rate, speed)| Drive::Feed(rate, speed));
        let step = Step { curve, drive, line: line.number };
        let Some(mut compensation) = self.compensation.take() else { return };
        let corners = Corners::of(self.control.family);
        match compensation.add(step, corners, &mut self.record) {
            Ok(()) => self.compensation = Some(compensation),
            // What follows would be refused for the same reason.
            Err(failure) => self.refuse_failure(failure),
        }
    }

    /// A pause while compensation is in force. False where there is none.
    pub(super) fn pause_compensated(&mut self, seconds: f64, line: Line<'_>) -> Result<bool, PathError> {
        let Some(compensation) = &mut self.compensation else { return Ok(false) };
        match &mut compensation.waiting {
            Some(waiting) if waiting.between.len() < MAX_BETWEEN => {
                waiting.between.push(Between::Pause(seconds, line.number));
                Ok(true)
            }
            Some(_) => Err(PathError::TooManyMoves { limit: MAX_BETWEEN }),
            None => Ok(false),
        }
    }

    fn refuse_failure(&mut self, (line, fault): Failure) {
        self.refuse(Refusal { line, column: 1, word: String::new(), fault });
    }
}

/// The radius of a tool: its own, else the one of all tools.
fn radius_among(cutters: &[Cutter], number: Option<u32>) -> Option<f64> {
    let own = cutters.iter().find(|cutter| cutter.number.is_some() && cutter.number == number);
    own.or(cutters.iter().find(|cutter| cutter.number.is_none())).map(|cutter| cutter.radius_mm)
}

/// Where the radius of a compensation comes from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Radius {
    /// The tool in the spindle.
    OfTool,
    /// The offset with this number.
    Numbered(WordValue),
    /// The program states the radius, mm.
    Stated(f64),
}

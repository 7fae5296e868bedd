//! When cutter compensation begins and ends, and by which radius.

use super::{Block, Code, Correction, Family, Fault, Line, Machine, Meaning, Note, Side, WordValue};

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
                            Radius::Stated(radius_mm, slot)
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
                if !self.notes.iter().any(|note| matches!(note, Note::CompensationAsWear { .. })) {
                    self.note(Note::CompensationAsWear { line: line.number });
                }
                return;
            }
            Correction::Computed(cutters) => cutters,
        };
        let of = |number: Option<u32>| {
            let own = cutters.iter().find(|cutter| cutter.number.is_some() && cutter.number == number);
            own.or(cutters.iter().find(|cutter| cutter.number.is_none())).map(|cutter| cutter.radius_mm)
        };
        let radius_mm = match radius {
            Radius::Stated(radius_mm, _) => Some(radius_mm),
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
        if is_linuxcnc && self.plane == toolpathd_core::geometry::plane::Plane::Yz {
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

/// Where the radius of a compensation comes from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Radius {
    /// The tool in the spindle.
    OfTool,
    /// The offset with this number.
    Numbered(WordValue),
    /// The program states the radius, mm.
    Stated(f64, WordValue),
}

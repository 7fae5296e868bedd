//! Canned cycles along the normal of the plane: G73, G74, G76, G81 to G86 and G89.
//!
//! # Method
//! 1. Rapid in the plane to the hole, then along the normal to R. LinuxCNC rises to R first where the tool
//!    stands below it.
//! 2. Feed to the bottom, in pecks for G73 and G83. A peck of G83 ends with a rapid to R and a rapid down the
//!    hole to the clearance above the last peck.
//! 3. Pause where the cycle has one.
//! 4. Back to R or to the initial height, by feed or rapid as the cycle says.

use super::{AXES, At, Block, Code, Family, Fault, Line, Machine, Note, WordValue};
use crate::placement::Coordinate;

/// Most pecks of one hole, and most holes of one block. More would be an error of the program.
const MAX_PECKS: f64 = 100_000.0;

/// What is left of the depth below this is rounding, mm.
const LEAST_PECK_MM: f64 = 1e-6;

/// A cycle in force, with the words that stay in force.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cycle {
    number: u8,
    /// The height where the cycle began, along the normal.
    initial: Option<f64>,
    /// The words R and Z, mm, and whether they are absolute.
    plane_r: Option<f64>,
    bottom: Option<f64>,
    peck: Option<f64>,
    dwell_s: Option<f64>,
    is_fresh: bool,
}

impl Machine<'_> {
    pub(super) fn has_cycle(&self) -> bool {
        self.cycle.is_some()
    }

    pub(crate) fn cycle_number(&self) -> Option<u8> {
        self.cycle.map(|cycle| cycle.number)
    }

    /// A cycle comes into force. On LinuxCNC its words have to be stated again when the code changes.
    pub(super) fn begin_cycle(&mut self, line: Line<'_>, number: u8, _: Code) {
        let normal = self.plane.axes()[2];
        let before = self.cycle;
        let initial = before.map_or(self.at[normal], |cycle| cycle.initial);
        let keeps = before.filter(|before| !self.control.is(Family::LinuxCnc) || before.number == number);
        self.cycle = Some(match keeps {
            Some(cycle) => Cycle { number, initial, ..cycle },
            None => Cycle {
                number,
                initial,
                plane_r: None,
                bottom: None,
                peck: None,
                dwell_s: self.last_cycle_dwell_s,
                is_fresh: true,
            },
        });
        if matches!(number, 73 | 83) {
            self.note_first(Note::PeckClearance { line: line.number, mm: self.control.peck_clearance_mm });
        }
        if matches!(number, 74 | 84) {
            self.note_first(Note::Tapping { line: line.number });
        }
    }

    /// Runs the cycle in force at the places that a block names.
    pub(super) fn drill(&mut self, line: Line<'_>, block: &mut Block) {
        let Some(mut cycle) = self.cycle else { return };
        let [a, b, n] = self.plane.axes();
        let mut words = [None; 3];
        for axis in [a, b] {
            words[axis] = block.take(AXES[axis]);
        }
        let mut length =
            |machine: &mut Self, letter: u8| block.take(letter).map(|slot| machine.length_mm(line, slot));
        let bottom = length(self, AXES[n]);
        let plane_r = length(self, b'R');
        let peck_slot = block.take(b'Q');
        cycle.bottom = bottom.or(cycle.bottom);
        cycle.plane_r = plane_r.or(cycle.plane_r);
        if let Some(slot) = peck_slot {
            cycle.peck = Some(self.length_mm(line, slot));
            if cycle.number == 76 {
                // The shift away from the wall before the way out; its direction is a parameter.
                self.left.add("Q of G76", line.number);
            }
        }
        if let Some(slot) = block.take(b'P') {
            cycle.dwell_s = self.dwell_s(line, slot, b'P');
        } else if cycle.is_fresh && self.control.is(Family::LinuxCnc) && matches!(cycle.number, 82 | 86 | 89)
        {
            self.refuse(line.refused(Fault::Missing('P')));
        }
        if self.control.is(Family::LinuxCnc) {
            // Its interpreter keeps P when the cycle ends.
            self.last_cycle_dwell_s = cycle.dwell_s;
        }
        let repeats = self.repeats(line, block);
        cycle.is_fresh = false;
        self.cycle = Some(cycle);
        if cycle.number == 76 {
            for letter in [b'I', b'J'] {
                if block.take(letter).is_some() {
                    self.left.add(&format!("{} of G76", char::from(letter)), line.number);
                }
            }
        }
        if n != 2 && !self.placement.keeps_direction(n) {
            self.refuse(line.refused(Fault::TiltedCycle));
            return;
        }
        let Some(hole) = self.hole(line, cycle, n) else { return };
        for _ in 0..repeats {
            let to = self.target_of(line, words);
            if self.is_full() {
                return;
            }
            self.make_hole(line, cycle, n, to, hole);
        }
    }

    /// K of Fanuc, L of the others; 1 without it.
    fn repeats(&mut self, line: Line<'_>, block: &mut Block) -> usize {
        let letter = match self.control.family {
            Family::Fanuc if block.has(b"K") => b'K',
            _ => b'L',
        };
        match block.take(letter) {
            None => 1,
            Some(slot) if (0.0..=MAX_PECKS).contains(&slot.value) && slot.value.fract() == 0.0 => {
                slot.value as usize
            }
            Some(slot) => {
                self.refuse_word(line, slot, Fault::OutOfRange(slot.value));
                0
            }
        }
    }

    /// The heights of R and of the bottom. Faults are refused.
    fn hole(&mut self, line: Line<'_>, cycle: Cycle, n: usize) -> Option<Hole> {
        let missing = |letter: u8| Fault::Missing(char::from(letter));
        let (Some(r), Some(z)) = (cycle.plane_r, cycle.bottom) else {
            self.refuse(line.refused(missing(if cycle.plane_r.is_none() { b'R' } else { AXES[n] })));
            return None;
        };
        let needs_peck = matches!(cycle.number, 73 | 83);
        if needs_peck && cycle.peck.is_none() {
            self.refuse(line.refused(missing(b'Q')));
            return None;
        }
        let (r, z) = if self.is_absolute {
            let height = |mm: f64| {
                let mut along = [None; 3];
                along[n] = Some(Coordinate::Absolute(mm));
                self.placed(along)[n]
            };
            (height(r), height(z))
        } else {
            let factor = self.placement.factor(n);
            let (r, z) = (r * factor, z * factor);
            let r = cycle.initial.map(|from| from + r);
            (r, r.map(|r| r + z))
        };
        let (Some(r), Some(bottom)) = (r, z) else {
            self.refuse_state(line, Fault::UnknownStart(char::from(AXES[n])));
            return None;
        };
        if bottom > r {
            self.refuse(line.refused(Fault::CycleUpward));
            return None;
        }
        let peck = cycle.peck.unwrap_or(0.0).abs();
        if needs_peck && !(peck > 0.0 && (r - bottom) / peck <= MAX_PECKS) {
            self.refuse(line.refused(Fault::OutOfRange(peck)));
            return None;
        }
        Some(Hole { r, bottom, peck })
    }

    fn make_hole(&mut self, line: Line<'_>, cycle: Cycle, n: usize, to: At, hole: Hole) {
        let Hole { r, bottom, peck } = hole;
        let linuxcnc = self.control.is(Family::LinuxCnc);
        let along = |at: At, height: f64| {
            let mut at = at;
            at[n] = Some(height);
            at
        };
        if linuxcnc && cycle.initial.is_some_and(|height| height < r) {
            self.rapid(line, along(self.at, r));
        }
        // The hole lies where the block says, at the height to which the tool has risen.
        let mut over = to;
        over[n] = self.at[n];
        self.rapid(line, over);
        self.rapid(line, along(self.at, r));
        let clearance = self.control.peck_clearance_mm;
        let mut depth = r;
        if peck > 0.0 && matches!(cycle.number, 73 | 83) {
            depth -= peck;
            while depth > bottom + LEAST_PECK_MM {
                self.line(line, along(self.at, depth));
                if cycle.number == 83 {
                    self.rapid(line, along(self.at, r));
                }
                self.rapid(line, along(self.at, (depth + clearance).min(r)));
                depth -= peck;
            }
        }
        self.line(line, along(self.at, bottom));
        if matches!(cycle.number, 76 | 82 | 84 | 86 | 89 | 74)
            && let Some(seconds) = cycle.dwell_s.filter(|seconds| *seconds > 0.0)
        {
            let whole = WordValue { value: seconds, start: 0, end: line.text.len(), lacks_point: false };
            self.pause(line, whole, seconds);
        }
        let high = match cycle.initial {
            Some(initial) if linuxcnc => Some(initial.max(r)),
            initial => initial,
        };
        let clear = if self.returns_high { high } else { Some(r) };
        let feeds_out = matches!(cycle.number, 74 | 84 | 85 | 89);
        if let (true, Some(clear)) = (linuxcnc && feeds_out && cycle.number != 85, clear) {
            self.line(line, along(self.at, clear));
        } else if feeds_out {
            self.line(line, along(self.at, r));
        }
        let mut up = self.at;
        up[n] = clear;
        self.rapid(line, up);
    }
}

/// The heights of a hole along the normal, mm.
#[derive(Clone, Copy)]
struct Hole {
    r: f64,
    bottom: f64,
    peck: f64,
}

//! Work offsets and shifts: where the zero of the program lies.
//!
//! Coordinates of the answer are those of a *frame* for each axis. Two zeros are related only if they lie in
//! the same frame. A zero that is not known begins a frame of its own, and the place of the tool is not known
//! in it.

use std::collections::BTreeMap;

/// The number of G54 among work offsets; G59 has 6, G59.1 to G59.3 have 7 to 9.
pub const G54: u32 = 1;
/// What is added to P of G54.1 and G154.
pub const EXTENDED: u32 = 100;

/// A place along one axis, in mm, in a frame.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Zero {
    frame: u32,
    mm: f64,
}

/// The zeros of all work offsets, with the shifts of G52 and G92.
#[derive(Debug, Clone)]
pub struct Frames {
    zeros: BTreeMap<u32, [Option<Zero>; 3]>,
    machine: [Option<Zero>; 3],
    active: u32,
    /// The frame of each axis now.
    frame: [u32; 3],
    last_frame: u32,
    local: [f64; 3],
    set: [f64; 3],
    /// The shifts of G92 that G92.3 brings back.
    suspended: [f64; 3],
    /// G92 was given where the place was not known.
    is_lost: [bool; 3],
    /// The turns of work offsets about their zeros in the plane of X and Y, degrees.
    turns: BTreeMap<u32, f64>,
}

impl Frames {
    /// With work offsets in coordinates of the machine, mm.
    pub fn new(given: &[(u32, [f64; 3])]) -> Self {
        let mut frames = Self {
            zeros: BTreeMap::new(),
            machine: [None; 3],
            active: G54,
            frame: [0; 3],
            last_frame: 0,
            local: [0.0; 3],
            set: [0.0; 3],
            suspended: [0.0; 3],
            is_lost: [false; 3],
            turns: BTreeMap::new(),
        };
        let base = given.iter().find(|(number, _)| *number == G54).or(given.first());
        if let Some((_, base)) = base {
            for (number, zero) in given {
                frames
                    .zeros
                    .insert(*number, [0, 1, 2].map(|k| Some(Zero { frame: 0, mm: zero[k] - base[k] })));
            }
            frames.machine = [0, 1, 2].map(|k| Some(Zero { frame: 0, mm: -base[k] }));
            if !given.iter().any(|(number, _)| *number == G54) {
                for k in 0..3 {
                    frames.begin_frame(G54, k);
                }
            }
        } else {
            frames.zeros.insert(G54, [Some(Zero { frame: 0, mm: 0.0 }); 3]);
        }
        frames
    }

    pub fn active(&self) -> u32 {
        self.active
    }

    /// A work offset turns about its zero.
    pub fn turn(&mut self, number: u32, degrees: f64) {
        self.turns.insert(number, degrees);
    }

    /// The turn of the work offset in force, degrees.
    pub fn degrees(&self) -> f64 {
        self.turns.get(&self.active).copied().unwrap_or(0.0)
    }

    /// Whether G52 or G92 shifts the zero, or may do so again by G92.3.
    pub fn is_shifted(&self) -> bool {
        [self.local, self.set, self.suspended].iter().flatten().any(|mm| *mm != 0.0)
    }

    /// How many frames there have been.
    pub fn frame(&self) -> [u32; 3] {
        self.frame
    }

    fn begin_frame(&mut self, number: u32, axis: usize) {
        self.last_frame += 1;
        self.frame[axis] = self.last_frame;
        let own = self.zeros.entry(number).or_default();
        own[axis] = Some(Zero { frame: self.last_frame, mm: 0.0 });
    }

    fn zero(&self, axis: usize) -> f64 {
        self.zeros.get(&self.active).and_then(|zeros| zeros[axis]).map_or(0.0, |zero| zero.mm)
    }

    /// What is added to a coordinate of the program, mm.
    pub fn shift(&self, axis: usize) -> f64 {
        self.zero(axis) + self.local[axis] + self.set[axis]
    }

    /// Selects a work offset. `at` is lost along the axes whose frame changes.
    pub fn select(&mut self, number: u32, at: &mut [Option<f64>; 3]) {
        self.active = number;
        for axis in 0..3 {
            match self.zeros.get(&number).and_then(|zeros| zeros[axis]) {
                Some(zero) if zero.frame == self.frame[axis] => {}
                Some(zero) => {
                    self.frame[axis] = zero.frame;
                    at[axis] = None;
                }
                None => {
                    self.begin_frame(number, axis);
                    at[axis] = None;
                }
            }
        }
    }

    /// The place of a coordinate of the machine along an axis, if it is known.
    pub fn of_machine(&self, axis: usize, mm: f64) -> Option<f64> {
        self.machine[axis].filter(|zero| zero.frame == self.frame[axis]).map(|zero| zero.mm + mm)
    }

    /// G52: the zero lies at `mm` in the work offset.
    pub fn shift_locally(&mut self, axis: usize, mm: f64) {
        self.local[axis] = mm;
    }

    /// G92: where the tool stands has the coordinate `mm`.
    pub fn set(&mut self, axis: usize, mm: f64, at: &mut [Option<f64>; 3]) {
        match at[axis] {
            Some(place) => {
                self.set[axis] = place - mm - self.zero(axis) - self.local[axis];
                self.suspended[axis] = self.set[axis];
            }
            None => {
                self.begin_frame(self.active, axis);
                (self.local[axis], self.set[axis]) = (0.0, 0.0);
                self.is_lost[axis] = true;
                at[axis] = Some(mm);
            }
        }
    }

    /// G92.1 and G92.2: the shifts of G92 and G52 end along `axes`.
    pub fn unset(&mut self, axes: [bool; 3], keeps: bool, at: &mut [Option<f64>; 3]) {
        for axis in (0..3).filter(|k| axes[*k]) {
            if !keeps {
                self.suspended[axis] = 0.0;
            }
            (self.local[axis], self.set[axis]) = (0.0, 0.0);
            if self.is_lost[axis] {
                self.is_lost[axis] = false;
                self.begin_frame(self.active, axis);
                at[axis] = None;
            }
        }
    }

    /// G92.3: the last shifts of G92 hold again.
    pub fn restore(&mut self) {
        self.set = self.suspended;
    }

    /// G10 L2: the zero of a work offset, in coordinates of the machine. The place of the tool is lost where
    /// the active zero moves by an amount that is not known.
    pub fn place_zero(&mut self, number: u32, axis: usize, mm: f64, at: &mut [Option<f64>; 3]) {
        let zero = self.machine[axis].map(|machine| Zero { mm: machine.mm + mm, ..machine });
        self.zeros.entry(number).or_default()[axis] = zero;
        if number == self.active {
            self.select(number, at);
        }
    }

    /// G10 L20: where the tool stands has the coordinate `mm` in a work offset.
    pub fn place_zero_by_tool(&mut self, number: u32, axis: usize, mm: f64, at: &mut [Option<f64>; 3]) {
        let shifts = self.local[axis] + self.set[axis];
        match at[axis] {
            Some(place) => {
                let zero = Zero { frame: self.frame[axis], mm: place - mm - shifts };
                self.zeros.entry(number).or_default()[axis] = Some(zero);
            }
            None if number == self.active => {
                self.begin_frame(number, axis);
                at[axis] = Some(mm + shifts);
            }
            None => {
                self.zeros.entry(number).or_default()[axis] = None;
            }
        }
    }
}

/// The name of a work offset.
pub fn name(number: u32) -> String {
    match number {
        1..=6 => format!("G{}", 53 + number),
        7..=9 => format!("G59.{}", number - 6),
        // A SINUMERIK control numbers its settable offsets from G500 to G599.
        500..=599 => format!("G{number}"),
        _ => format!("G54.1 P{}", number.saturating_sub(EXTENDED)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn given_offsets_relate_zeros_and_unknown_ones_lose_the_place() {
        let mut at = [Some(1.0), Some(2.0), Some(3.0)];
        let mut frames = Frames::new(&[(1, [-100.0, -50.0, -20.0]), (2, [-90.0, -50.0, -20.0])]);
        frames.select(2, &mut at);
        assert_eq!((frames.shift(0), at[0], frames.of_machine(2, 0.0)), (10.0, Some(1.0), Some(20.0)));
        frames.select(3, &mut at);
        assert_eq!((at, frames.of_machine(0, 0.0)), ([None; 3], None));
    }

    #[test]
    fn a_set_place_is_known_whether_or_not_it_was_before() {
        let mut at = [Some(5.0), None, None];
        let mut frames = Frames::new(&[]);
        frames.set(0, 2.0, &mut at);
        frames.set(1, 7.0, &mut at);
        assert_eq!((frames.shift(0), at), (3.0, [Some(5.0), Some(7.0), None]));
        frames.unset([true; 3], false, &mut at);
        assert_eq!((frames.shift(0), at), (0.0, [Some(5.0), None, None]));
    }
}

//! Programmable frames and poles: TRANS, ROT, SCALE, MIRROR and their kind, and G110 to G112.

use nalgebra::{Point3, Vector3};
use toolpathd_core::geometry::plane::Plane;

use super::Mill;
use super::block::{Block, From, Given};
use super::codes::{FrameWord, PoleFrom};
use crate::block::Line;
use crate::fault::Fault;
use crate::placement::{Coordinate, Placement, sine_and_cosine};

impl<'a> Mill<'a, '_> {
    /// A word without A takes the place of the whole frame; one with A adds to the frame in force.
    pub(super) fn set_frame(
        &mut self,
        line: Line<'a>,
        block: &Block,
        word: FrameWord,
        adds: bool,
        span: [usize; 2],
    ) {
        self.settle(line);
        let has_words = block.has_axes() || block.value("RPL").is_some();
        let is_wrong = |given: &&Given| given.from != From::Mode;
        if let Some(given) = block.axes.iter().flatten().find(is_wrong) {
            return self.refuse(line, [given.start, given.end], Fault::BadExpression);
        }
        if let Some(given) = block.value("RPL").filter(|_| word != FrameWord::Turn) {
            return self.refuse(line, [given.start, given.end], Fault::UnusedWord);
        }
        if adds && !has_words {
            return self.refuse(line, span, Fault::NoAxis);
        }
        let own = if !has_words {
            Some(Placement::plain())
        } else {
            let values = block.axes.map(|given| given.map(|given| given.value));
            match word {
                FrameWord::Shift => {
                    self.assume_units(line);
                    let unit = self.machine.unit_mm();
                    Some(Placement::shifted(Vector3::from(values.map(|v| v.unwrap_or(0.0) * unit))))
                }
                FrameWord::Turn => self.turn(line, block, values),
                FrameWord::Scale => {
                    let factors = values.map(|value| value.unwrap_or(1.0));
                    let scaled = Placement::scaled(Point3::origin(), factors);
                    let is_legal = factors.iter().all(|factor| *factor > 0.0);
                    if !is_legal || scaled.is_none() {
                        self.machine.refuse(line.refused(Fault::OutOfRange(factors[0])));
                    }
                    scaled.filter(|_| is_legal)
                }
                FrameWord::Mirror => {
                    // It would exchange the sides of the contour. The value does not count.
                    self.machine.exclude_compensation(line);
                    let factors = values.map(|value| if value.is_some() { -1.0 } else { 1.0 });
                    Placement::scaled(Point3::origin(), factors)
                }
            }
        };
        match own {
            Some(own) if adds => {
                let placement = self.machine.placement.of(&own);
                self.set_placement(placement);
            }
            Some(own) => self.set_placement(own),
            None => self.lose_place(),
        }
    }

    /// A turn about the normal Z. Turns about other axes tilt the plane.
    fn turn(&mut self, line: Line<'a>, block: &Block, values: [Option<f64>; 3]) -> Option<Placement> {
        let in_plane = block.value("RPL");
        let tilts = |given: &Given| given.value != 0.0;
        let wrong = match in_plane {
            Some(given) if block.has_axes() => Some((given, Fault::Conflict)),
            Some(given) if self.machine.plane != Plane::Xy && given.value != 0.0 => {
                Some((given, Fault::NotRead))
            }
            _ => block.axes[..2].iter().flatten().find(|given| tilts(given)).map(|g| (*g, Fault::NotRead)),
        };
        if let Some((given, fault)) = wrong {
            self.refuse(line, [given.start, given.end], fault);
            return None;
        }
        let degrees = in_plane.map(|given| given.value).or(values[2]).unwrap_or(0.0);
        Some(Placement::turned(Plane::Xy, Point3::origin(), degrees))
    }

    /// G110, G111 and G112: the pole of polar coordinates.
    pub(super) fn set_pole(&mut self, line: Line<'a>, block: &Block, from: PoleFrom) {
        let [a, b, n] = self.machine.plane.axes();
        if let Some(given) = block.axes[n] {
            return self.refuse(line, [given.start, given.end], Fault::UnusedWord);
        }
        let origin = match from {
            PoleFrom::Zero => Some([0.0; 2]),
            PoleFrom::Pole => self.pole,
            PoleFrom::Tool => {
                let at = self.in_program();
                at[a].zip(at[b]).map(|(x, y)| [x, y])
            }
        };
        let unit = self.machine.unit_mm();
        let polar = [block.value("AP"), block.value("RP")];
        let by = match polar {
            [None, None] => [a, b].map(|axis| block.axes[axis].map_or(0.0, |given| given.value * unit)),
            [Some(angle), Some(radius)] if !block.has_axes() => {
                let (sin, cos) = angle.value.to_radians().sin_cos();
                [radius.value * unit * cos, radius.value * unit * sin]
            }
            _ => return self.machine.refuse(line.refused(Fault::Conflict)),
        };
        let mut words = block.axes.iter().chain(&polar).flatten();
        if let Some(given) = words.find(|given| given.from != From::Mode) {
            return self.refuse(line, [given.start, given.end], Fault::BadExpression);
        }
        if block.has_axes() || polar[1].is_some() {
            self.assume_units(line);
        }
        self.pole = origin.map(|origin| [origin[0] + by[0], origin[1] + by[1]]);
        self.polar = [None; 2];
        if self.pole.is_none() {
            self.machine.refuse_state(line, Fault::NoPole);
        }
    }

    /// Where the tool stands, in coordinates of the program.
    pub(super) fn in_program(&self) -> crate::machine::At {
        let shifts = [0, 1, 2].map(|axis| self.machine.frames.shift(axis));
        let at = self.machine.at;
        self.machine.placement.back(&[0, 1, 2].map(|k| at[k].map(|at| at - shifts[k])))
    }

    /// The place that polar coordinates name in the plane, as coordinates of the program. A refusal has been
    /// made where there is none.
    pub(super) fn polar_coordinates(&mut self, line: Line<'a>, block: &Block) -> Option<[Coordinate; 2]> {
        let (angle, radius) = (block.value("AP"), block.value("RP"));
        for given in [angle, radius].into_iter().flatten() {
            let is_absolute = given.from == From::Zero || given.from == From::Mode && self.is_absolute;
            if !is_absolute {
                // The manuals do not agree on what an incremental angle counts from.
                self.refuse(line, [given.start, given.end], Fault::NotRead);
                return None;
            }
        }
        self.assume_units(line);
        let unit = self.machine.unit_mm();
        let angle = angle.map(|given| given.value).or(self.polar[0]);
        let radius = radius.map(|given| given.value * unit).or(self.polar[1]);
        let (Some(degrees), Some(mm)) = (angle, radius) else {
            self.machine.refuse_state(line, Fault::NoPole);
            return None;
        };
        let Some(pole) = self.pole else {
            self.machine.refuse_state(line, Fault::NoPole);
            return None;
        };
        self.polar = [angle, radius];
        let (sin, cos) = sine_and_cosine(degrees);
        Some([Coordinate::Absolute(pole[0] + mm * cos), Coordinate::Absolute(pole[1] + mm * sin)])
    }
}

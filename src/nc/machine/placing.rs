//! Turns, scales, mirrors and polar coordinates of a program: G68, G51, G51.1 and G16, with their ends.
//!
//! # Method
//! A coordinate is mirrored first, then scaled, then turned. The centre of a turn is given in coordinates
//! that are mirrored and scaled.

use nalgebra::Point3;
use toolpathd_core::geometry::plane::Plane;

use super::{
    AXES, At, Block, Code, Family, Fault, Line, Machine, Meaning, Note, OFFSETS, WithoutPoint, WordValue,
};
use crate::placement::{Coordinate, Placement, sine_and_cosine};

/// What stands between the coordinates of a program and those of its work offset.
#[derive(Debug, Clone, Copy)]
pub struct Placing {
    turn: Placement,
    scale: Placement,
    /// The coordinate about which each axis is mirrored, mm.
    mirrors: [Option<f64>; 3],
    polar: Option<Polar>,
    /// G68.2 is in force, with a plane that is level.
    has_plane: bool,
}

/// Polar coordinates in force: the pole, and the last radius and angle.
#[derive(Debug, Clone, Copy)]
struct Polar {
    /// In coordinates of the program along the axes of the plane, mm.
    pole: [f64; 2],
    radius_mm: f64,
    degrees: f64,
}

impl Placing {
    pub fn plain() -> Self {
        Self {
            turn: Placement::plain(),
            scale: Placement::plain(),
            mirrors: [None; 3],
            polar: None,
            has_plane: false,
        }
    }

    /// Mirrors and scales alone.
    fn without_turn(&self) -> Placement {
        let factors = self.mirrors.map(|mirror| if mirror.is_some() { -1.0 } else { 1.0 });
        let about = Point3::from(self.mirrors.map(Option::unwrap_or_default));
        let mirror = Placement::scaled(about, factors).unwrap_or(Placement::plain());
        self.scale.of(&mirror)
    }
}

impl Machine<'_> {
    /// Runs the code of a block that changes where coordinates lie. Whether there was one that has taken the
    /// axis words.
    pub(super) fn place_coordinates(
        &mut self,
        line: Line<'_>,
        block: &mut Block,
        meanings: &[(Code, Meaning)],
    ) -> bool {
        for (code, meaning) in meanings {
            match meaning {
                Meaning::Turn => self.begin_turn(line, block, *code),
                Meaning::Scale => self.begin_scale(line, block, *code),
                Meaning::Mirror(is_on) => self.mirror(line, block, *code, *is_on),
                Meaning::Tilt => self.begin_plane(line, block, *code),
                Meaning::AlongPlane => {
                    self.face_plane(line, *code);
                    continue;
                }
                Meaning::TurnEnd => {
                    (self.placing.turn, self.placing.has_plane) = (Placement::plain(), false);
                }
                Meaning::ScaleEnd => self.placing.scale = Placement::plain(),
                Meaning::Polar => self.begin_polar(line, *code),
                Meaning::PolarEnd => self.placing.polar = None,
                _ => continue,
            }
            self.placement = self.placing.turn.of(&self.placing.without_turn());
            if matches!(meaning, Meaning::Turn | Meaning::Tilt | Meaning::Scale | Meaning::Mirror(_)) {
                return true;
            }
        }
        false
    }

    /// The coordinates of the program where the tool stands, mm.
    fn place_in_program(&self) -> At {
        self.placement.back(&[0, 1, 2].map(|k| self.at[k].map(|at| at - self.frames.shift(k))))
    }

    /// The axis words as a centre; the place of the tool along axes without a word.
    fn center(
        &mut self,
        line: Line<'_>,
        block: &mut Block,
        code: Code,
        axes: &[usize],
    ) -> Option<Point3<f64>> {
        let words = AXES.map(|letter| block.take(letter));
        if !self.is_absolute && words.iter().any(Option::is_some) {
            self.refuse_code(line, code, Fault::IncrementalCenter);
            return None;
        }
        let stands = self.place_in_program();
        let mut center = Point3::origin();
        for axis in axes {
            center[*axis] = match (words[*axis], stands[*axis]) {
                (Some(slot), _) => self.length_mm(line, slot),
                (None, Some(at)) => at,
                (None, None) => {
                    self.refuse_state(line, Fault::UnknownStart(char::from(AXES[*axis])));
                    return None;
                }
            };
        }
        Some(center)
    }

    /// G68: X, Y and R. Without a centre the coordinates turn about the tool.
    fn begin_turn(&mut self, line: Line<'_>, block: &mut Block, code: Code) {
        let [a, b, n] = self.plane.axes();
        let angle = block.take(b'R');
        if self.placing.has_plane {
            block.use_up(b"XYZIJK");
            return self.refuse_code(line, code, Fault::Conflict);
        }
        if block.has(&[AXES[n]]) || block.has(&OFFSETS) {
            // Turns in space.
            block.use_up(b"XYZIJK");
            return self.refuse_code(line, code, Fault::NotRead);
        }
        let Some(angle) = angle else {
            block.use_up(b"XYZ");
            return self.refuse_code(line, code, Fault::Missing('R'));
        };
        if !self.is_absolute {
            // A parameter decides whether R adds to the turn before.
            block.use_up(b"XYZ");
            return self.refuse_word(line, angle, Fault::AtMachine);
        }
        let Some(center) = self.center(line, block, code, &[a, b]) else { return };
        let degrees = angle.value * self.degree_of(line, angle);
        let about = self.placing.without_turn().place(&[0, 1, 2].map(|k| Some(center[k])));
        let about = Point3::from(about.map(Option::unwrap_or_default));
        self.placing.turn = Placement::turned(self.plane, about, degrees);
    }

    /// G68.2 with angles of zero: the zero moves to X, Y and Z. With another angle the plane is tilted.
    fn begin_plane(&mut self, line: Line<'_>, block: &mut Block, code: Code) {
        let words = AXES.map(|letter| block.take(letter));
        let angles = OFFSETS.map(|letter| block.take(letter));
        let others = [b'P', b'Q', b'R'].map(|letter| block.take(letter));
        let tilts = angles.iter().chain(&others).flatten().any(|slot| slot.value != 0.0);
        let is_placed = self.placing.has_plane || !self.placement.is_plain();
        if tilts || is_placed {
            return self.refuse_code(line, code, if tilts { Fault::Tilted } else { Fault::Conflict });
        }
        if !self.is_absolute && words.iter().flatten().any(|slot| slot.value != 0.0) {
            return self.refuse_code(line, code, Fault::IncrementalCenter);
        }
        let shift = words.map(|slot| slot.map_or(0.0, |slot| self.length_mm(line, slot)));
        self.placing.turn = Placement::shifted(shift.into());
        self.placing.has_plane = true;
    }

    /// G53.1: the tool is turned to the plane of G68.2. To a level plane it stands upright already.
    fn face_plane(&mut self, line: Line<'_>, code: Code) {
        if self.placing.has_plane {
            self.leave_code(line, 'G', code.tenths);
        } else {
            self.refuse_code(line, code, Fault::Tilted);
        }
    }

    /// The coordinates turn with the work offset in force.
    pub(super) fn turn_with_offset(&mut self, line: Line<'_>) {
        if !self.control.is(Family::LinuxCnc) {
            return;
        }
        let degrees = self.frames.degrees();
        if degrees != 0.0 && self.frames.is_shifted() {
            return self.refuse(line.refused(Fault::ShiftInTurn));
        }
        self.placing.turn = Placement::turned(Plane::Xy, Point3::origin(), degrees);
        self.placement = self.placing.turn.of(&self.placing.without_turn());
    }

    /// What the number of an angle is multiplied by: least increments are thousandths of a degree.
    fn degree_of(&mut self, line: Line<'_>, slot: WordValue) -> f64 {
        if self.increment(line, slot) == 1.0 { 1.0 } else { 1e-3 }
    }

    /// G51: the centre with P, or with a factor for each axis in I, J and K.
    fn begin_scale(&mut self, line: Line<'_>, block: &mut Block, code: Code) {
        let (common, own) = (block.take(b'P'), OFFSETS.map(|letter| block.take(letter)));
        if common.is_none() && own == [None; 3] {
            block.use_up(&AXES);
            return self.refuse_code(line, code, Fault::Missing('P'));
        }
        let Some(center) = self.center(line, block, code, &[0, 1, 2]) else { return };
        let factors = own.map(|slot| slot.or(common).map_or(1.0, |slot| self.scale_factor(line, slot)));
        match Placement::scaled(center, factors) {
            Some(scale) => self.placing.scale = scale,
            None => self.refuse_code(line, code, Fault::OutOfRange(factors[0])),
        }
    }

    /// A factor without a point counts thousandths where lengths count increments.
    fn scale_factor(&mut self, line: Line<'_>, slot: WordValue) -> f64 {
        let counts = slot.lacks_point
            && self.control.points_matter
            && self.control.scales_by_thousandths
            && self.setting.without_point == WithoutPoint::Increments;
        if !counts {
            return slot.value;
        }
        let factor = slot.value * 1e-3;
        self.note(Note::ScaleAssumed { line: line.number, factor });
        factor
    }

    /// G51.1 and G50.1: the axes that a block names are mirrored at their coordinate, or no longer.
    fn mirror(&mut self, line: Line<'_>, block: &mut Block, code: Code, is_on: bool) {
        let words = AXES.map(|letter| block.take(letter));
        if is_on && words == [None; 3] {
            return self.refuse_code(line, code, Fault::NoAxis);
        }
        if is_on && !self.is_absolute {
            return self.refuse_code(line, code, Fault::IncrementalCenter);
        }
        for axis in 0..3 {
            match words[axis] {
                Some(slot) if is_on => {
                    let mm = self.length_mm(line, slot);
                    self.placing.mirrors[axis] = Some(mm);
                }
                None if is_on => {}
                Some(_) => self.placing.mirrors[axis] = None,
                None if words == [None; 3] => self.placing.mirrors[axis] = None,
                None => {}
            }
        }
    }

    /// G16: the zero of the program is the pole; under G91 where the tool stands.
    fn begin_polar(&mut self, line: Line<'_>, code: Code) {
        let [a, b, _] = self.plane.axes();
        let mut pole = [0.0; 2];
        if !self.is_absolute {
            let stands = self.place_in_program();
            let (Some(first), Some(second)) = (stands[a], stands[b]) else {
                return self.refuse_code(line, code, Fault::UnknownStart(char::from(AXES[a])));
            };
            pole = [first, second];
        }
        self.placing.polar = Some(Polar { pole, radius_mm: 0.0, degrees: 0.0 });
    }

    /// LinuxCNC: the block has a radius and an angle instead of X and Y.
    pub(super) fn use_polar_words(&mut self, line: Line<'_>, block: &Block) {
        self.polar_words = block.polar;
        let [radius, angle] = block.polar;
        if let Some(word) = radius.or(angle)
            && (block.has(b"XY") || self.plane != Plane::Xy)
        {
            self.refuse_word(line, word, Fault::Conflict);
        }
    }

    pub(super) fn has_polar_words(&self) -> bool {
        self.polar_words != [None; 2]
    }

    /// The coordinates of the program that radius and angle about its zero name, mm. Without one of them the
    /// tool keeps its own; under G91 they add to its own.
    fn polar_place(&mut self, line: Line<'_>) -> Option<[f64; 2]> {
        let [radius, angle] = self.polar_words;
        let word = radius.or(angle)?;
        let stands = self.place_in_program();
        let (x, y) = match (stands[0], stands[1]) {
            (Some(x), Some(y)) => (x, y),
            _ if self.is_absolute && radius.is_some() && angle.is_some() => (0.0, 0.0),
            (x, _) => {
                let axis = if x.is_none() { 'X' } else { 'Y' };
                self.refuse_state(line, Fault::UnknownStart(axis));
                return None;
            }
        };
        let needs_angle = !self.is_absolute || angle.is_none();
        if needs_angle && x == 0.0 && y == 0.0 {
            self.refuse_word(line, word, Fault::NoValue("the tool stands at the pole"));
            return None;
        }
        let far = radius.map(|slot| self.length_mm(line, slot));
        let turned = angle.map(|slot| slot.value.to_radians());
        let (own_far, own_turned) = (x.hypot(y), y.atan2(x));
        let (far, turned) = if self.is_absolute {
            (far.unwrap_or(own_far), turned.unwrap_or(own_turned))
        } else {
            (own_far + far.unwrap_or(0.0), own_turned + turned.unwrap_or(0.0))
        };
        Some([far * turned.cos(), far * turned.sin()])
    }

    /// The place that polar words name; `None` where polar coordinates are not in force.
    pub(super) fn polar_target(&mut self, line: Line<'_>, words: [Option<WordValue>; 3]) -> Option<At> {
        let [a, b, n] = self.plane.axes();
        let is_absolute = self.is_absolute;
        let mut coordinates = [None; 3];
        coordinates[n] = words[n].map(|slot| {
            let mm = self.length_mm(line, slot);
            if is_absolute { Coordinate::Absolute(mm) } else { Coordinate::Relative(mm) }
        });
        if self.has_polar_words() {
            if let Some([x, y]) = self.polar_place(line) {
                coordinates[0] = Some(Coordinate::Absolute(x));
                coordinates[1] = Some(Coordinate::Absolute(y));
            }
            return Some(self.placed(coordinates));
        }
        let mut polar = self.placing.polar?;
        let (radius, angle) = (words[a], words[b]);
        if let Some(slot) = radius {
            polar.radius_mm = self.length_mm(line, slot);
            if !self.is_absolute {
                self.refuse_word(line, slot, Fault::IncrementalCenter);
            }
        }
        if let Some(slot) = angle {
            let degrees = slot.value * self.degree_of(line, slot);
            polar.degrees = if self.is_absolute { degrees } else { polar.degrees + degrees };
        }
        self.placing.polar = Some(polar);
        if radius.is_some() || angle.is_some() {
            let (sin, cos) = sine_and_cosine(polar.degrees);
            coordinates[a] = Some(Coordinate::Absolute(polar.pole[0] + polar.radius_mm * cos));
            coordinates[b] = Some(Coordinate::Absolute(polar.pole[1] + polar.radius_mm * sin));
        }
        Some(self.placed(coordinates))
    }
}

//! The datum: cycles 7 (shift), 8 (mirror image), 10 (rotation), 11 and 26 (scaling) and 247 (preset).
//!
//! # Method
//! The cycles act in the order of their definitions: the first is the outermost. A definition replaces the
//! earlier one of its kind. Where it matters whether the replacement takes the place of the earlier one or
//! the last place, it is refused.

use nalgebra::{Point3, Vector3};

use super::Execution;
use super::cursor::Cursor;
use super::script::Block;
use super::words::Sort;
use crate::fault::Fault;
use crate::notes::Note;
use crate::placement::{Coordinate, Placement};

/// The last row of the table of presets.
const MAX_PRESET: f64 = 65_535.0;

/// What one kind of cycle does.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Transform {
    /// mm
    Shift([f64; 3]),
    Mirror([bool; 3]),
    /// Degrees.
    Rotation(f64),
    Scaling(f64),
    /// Factors of the axes, and the centre in mm.
    AxisScaling([f64; 3], [f64; 3]),
}

impl Transform {
    fn is_nothing(&self) -> bool {
        match self {
            Self::Shift(shift) => *shift == [0.0; 3],
            Self::Mirror(axes) => *axes == [false; 3],
            Self::Rotation(degrees) => *degrees == 0.0,
            Self::Scaling(factor) => *factor == 1.0,
            Self::AxisScaling(factors, _) => *factors == [1.0; 3],
        }
    }

    fn is_kind_of(&self, other: &Self) -> bool {
        std::mem::discriminant(self) == std::mem::discriminant(other)
    }
}

/// Legal factors of scalings.
const FACTORS: std::ops::RangeInclusive<f64> = 0.000_001..=99.999_999;

impl<'a> Execution<'a, '_> {
    /// Puts a transform in force.
    fn transform(&mut self, block: &Block<'a>, transform: Transform) {
        let place = self.transforms.iter().position(|other| other.is_kind_of(&transform));
        let mut moved = self.transforms.clone();
        if let Some(place) = place {
            moved.remove(place);
        }
        let mut replaced = self.transforms.clone();
        if !transform.is_nothing() {
            moved.push(transform);
        } else if place.is_none() {
            return;
        }
        match place {
            Some(place) => replaced[place] = transform,
            None => replaced.push(transform),
        }
        match (self.placement_of(&moved), self.placement_of(&replaced)) {
            (Some(last), Some(first)) if are_near(&last, &first) => {
                self.transforms = moved;
                self.machine.placement = last;
            }
            (Some(_), Some(_)) => self.refuse_block(block, Fault::NotRead),
            _ => self.refuse_block(block, Fault::NotFinite),
        }
        self.lose_pole();
    }

    fn placement_of(&self, transforms: &[Transform]) -> Option<Placement> {
        let plane = self.machine.plane;
        transforms.iter().try_fold(Placement::plain(), |whole, transform| {
            let own = match transform {
                Transform::Shift(shift) => Placement::shifted(Vector3::from(*shift)),
                Transform::Mirror(axes) => {
                    let factors = axes.map(|is_mirrored| if is_mirrored { -1.0 } else { 1.0 });
                    Placement::scaled(Point3::origin(), factors)?
                }
                Transform::Rotation(degrees) => Placement::turned(plane, Point3::origin(), *degrees),
                Transform::Scaling(factor) => Placement::scaled(Point3::origin(), [*factor; 3])?,
                Transform::AxisScaling(factors, center) => {
                    Placement::scaled(Point3::from(*center), *factors)?
                }
            };
            Some(whole.of(&own))
        })
    }

    /// Poles and directions of the program count no more.
    pub(super) fn lose_pole(&mut self) {
        self.pole = None;
        self.forget_tangent();
    }

    /// `CYCL DEF 7.1 X+10` and `TRANS DATUM AXIS X+10`. The shift comes into force with the next block that
    /// does not go on with it.
    pub(super) fn shift_datum(&mut self, block: &Block<'a>, cursor: &mut Cursor<'_>) {
        let in_force = self.transforms.iter().find_map(|transform| match transform {
            Transform::Shift(shift) => Some(*shift),
            _ => None,
        });
        let pending = self.shift.take().map(|(_, shift)| shift);
        let mut shift = pending.or(in_force).unwrap_or_default();
        let words = self.scan(block, cursor, &[Sort::Axis, Sort::Function]);
        if let Some((_, span)) = words.functions.first() {
            self.refuse(block, *span, Fault::UnusedWord);
        }
        for (axis, coordinate) in words.axes.into_iter().enumerate() {
            match coordinate {
                Some(Coordinate::Absolute(mm)) => shift[axis] = mm,
                Some(Coordinate::Relative(mm)) => shift[axis] += mm,
                None => {}
            }
        }
        self.shift = Some((block.clone(), shift));
    }

    /// Puts a shift in force whose definition has ended before this block.
    pub(super) fn end_shift(&mut self, block: &Block<'a>) {
        let mut cursor = Cursor::new(&block.text);
        let goes_on =
            cursor.phrase("CYCL DEF") && cursor.take(b'7') && cursor.take(b'.') && !cursor.take(b'0');
        if !goes_on && let Some((definition, shift)) = self.shift.take() {
            self.transform(&definition, Transform::Shift(shift));
        }
    }

    pub(super) fn reset_shift(&mut self, block: &Block<'a>, cursor: &mut Cursor<'_>) {
        self.expect_end(block, cursor);
        self.transform(block, Transform::Shift([0.0; 3]));
    }

    /// `CYCL DEF 8.1 X Y`.
    pub(super) fn mirror(&mut self, block: &Block<'a>, cursor: &mut Cursor<'_>) {
        let mut axes = [false; 3];
        while !cursor.is_done() {
            let axis = b"XYZ".iter().position(|letter| cursor.peek() == Some(*letter));
            let is_alone = cursor.word_end() == cursor.at + 1;
            let normal = self.machine.plane.axes()[2];
            match axis.filter(|axis| is_alone && *axis != normal) {
                Some(axis) => axes[axis] = true,
                None => {
                    let span = [cursor.at, cursor.word_end()];
                    return self.refuse(block, span, Fault::UnusedWord);
                }
            }
            cursor.at += 1;
        }
        // It would exchange the sides of the contour.
        self.machine.exclude_compensation(block.line());
        self.transform(block, Transform::Mirror(axes));
    }

    /// `CYCL DEF 10.1 ROT+30`, or IROT.
    pub(super) fn rotate(&mut self, block: &Block<'a>, cursor: &mut Cursor<'_>) {
        cursor.skip_blanks();
        let is_relative = cursor.letters("I");
        let before = self.transforms.iter().find_map(|transform| match transform {
            Transform::Rotation(degrees) if is_relative => Some(*degrees),
            _ => None,
        });
        if let Some(degrees) = self.value_behind(block, cursor, "ROT") {
            self.transform(block, Transform::Rotation(before.unwrap_or(0.0) + degrees));
        }
    }

    /// `CYCL DEF 11.1 SCL 0.995`.
    pub(super) fn scale(&mut self, block: &Block<'a>, cursor: &mut Cursor<'_>) {
        if let Some(factor) = self.value_behind(block, cursor, "SCL") {
            if !FACTORS.contains(&factor) {
                return self.refuse_block(block, Fault::OutOfRange(factor));
            }
            if factor != 1.0 {
                self.machine.note_first(Note::ScalesAllAxes { line: block.line().number });
            }
            self.transform(block, Transform::Scaling(factor));
        }
    }

    /// The value behind a word that has to stand here.
    fn value_behind(
        &mut self,
        block: &Block<'a>,
        cursor: &mut Cursor<'_>,
        word: &'static str,
    ) -> Option<f64> {
        cursor.skip_blanks();
        if !cursor.letters(word) {
            self.refuse_block(block, Fault::Lacks(word));
            return None;
        }
        match cursor.value(&self.parameters) {
            Ok(value) => {
                self.expect_end(block, cursor);
                Some(value)
            }
            Err(broken) => {
                self.refuse_broken(block, broken);
                None
            }
        }
    }

    /// `CYCL DEF 26.1 X1.4 Y0.6 CCX+15 CCY+20`.
    pub(super) fn scale_axes(&mut self, block: &Block<'a>, cursor: &mut Cursor<'_>) {
        let (mut factors, mut center) = ([1.0; 3], [0.0; 3]);
        while !cursor.is_done() {
            let start = cursor.at;
            let is_center = cursor.letters("CC");
            let axis = b"XYZ".iter().position(|letter| cursor.peek() == Some(*letter));
            let Some(axis) = axis else {
                return self.refuse(block, [start, cursor.word_end()], Fault::UnusedWord);
            };
            cursor.at += 1;
            match cursor.value(&self.parameters) {
                Ok(value) if is_center => center[axis] = value * self.machine.unit_mm(),
                Ok(value) if !FACTORS.contains(&value) => {
                    return self.refuse(block, [start, cursor.at], Fault::OutOfRange(value));
                }
                Ok(value) => factors[axis] = value,
                Err(broken) => return self.refuse_broken(block, broken),
            }
        }
        self.transform(block, Transform::AxisScaling(factors, center));
    }

    /// Cycle 247: a row of the table of presets. It ends shifts, turns and scalings.
    pub(super) fn select_preset(&mut self, block: &Block<'a>, row: f64) {
        if !(0.0..=MAX_PRESET).contains(&row) || row.fract() != 0.0 {
            return self.refuse_block(block, Fault::OutOfRange(row));
        }
        self.transforms.clear();
        self.machine.placement = Placement::plain();
        self.lose_pole();
        let before = self.machine.frames.frame();
        self.machine.frames.select(row as u32, &mut self.machine.at);
        if before != self.machine.frames.frame() && self.machine.record.has_moves() {
            let offset = format!("preset {row}");
            self.machine.note(Note::UnrelatedOffset { line: block.line().number, offset });
        }
    }
}

/// Whether two placements are one but for rounding.
fn are_near(a: &Placement, b: &Placement) -> bool {
    let corners = [[0.0, 0.0, 0.0], [1e3, 0.0, 0.0], [0.0, 1e3, 0.0], [0.0, 0.0, 1e3]];
    corners.iter().all(|corner| {
        let [a, b] = [a, b].map(|placement| placement.place(&corner.map(Some)));
        a.iter().zip(b).all(|(a, b)| (a.unwrap_or_default() - b.unwrap_or_default()).abs() <= 1e-9)
    })
}

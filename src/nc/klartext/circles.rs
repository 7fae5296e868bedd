//! Circles and helices: C, CR, CT, CP and CTP.

use nalgebra::{Point3, Vector2};
use toolpathd_core::geometry::curve::Direction;
use toolpathd_core::geometry::plane::Plane;

use super::Execution;
use super::cursor::Cursor;
use super::path::{NO_WAY_MM, Turn, Way};
use super::polar::CirclePole;
use super::script::Block;
use super::words::{Sort, Words};
use crate::fault::Fault;
use crate::machine::At;
use crate::placement::Coordinate;

/// Largest incremental angle of a helix, degrees. The control takes five digits before the point.
const MAX_ANGLE: f64 = 99_999.999_9;

/// Parts of a turn that count as none: rounding of the quotient.
const ANGLE_ROUNDING: f64 = 1e-9;

const ABOUT_POLE: [Sort; 5] = [Sort::Axis, Sort::Turn, Sort::Side, Sort::Feed, Sort::Function];
const BY_RADIUS: [Sort; 6] = [Sort::Axis, Sort::Radius, Sort::Turn, Sort::Side, Sort::Feed, Sort::Function];
const TANGENT: [Sort; 4] = [Sort::Axis, Sort::Side, Sort::Feed, Sort::Function];
const TANGENT_POLAR: [Sort; 5] =
    [Sort::PolarRadius, Sort::PolarAngle, Sort::Side, Sort::Feed, Sort::Function];
const HELIX: [Sort; 6] = [Sort::Axis, Sort::PolarAngle, Sort::Turn, Sort::Side, Sort::Feed, Sort::Function];

/// An arc with its end, or `None` where it was refused.
type Found = Option<(At, Turn)>;

/// What finds the end of an arc, and its turn.
type Shape<'a, 'm> = fn(&mut Execution<'a, 'm>, &Block<'a>, &Words) -> Found;

impl<'a, 'm> Execution<'a, 'm> {
    /// A block of a circle, by its first word.
    pub(super) fn circle(&mut self, block: &Block<'a>, cursor: &mut Cursor<'_>, name: &[u8]) {
        let (allowed, shape): (&[Sort], Shape<'a, 'm>) = match name {
            b"C" => (&ABOUT_POLE, Self::arc_about_pole),
            b"CR" => (&BY_RADIUS, Self::arc_by_radius),
            b"CT" => (&TANGENT, Self::arc_by_tangent),
            b"CTP" => (&TANGENT_POLAR, Self::arc_by_tangent),
            _ => (&HELIX, Self::helix),
        };
        let Some((words, functions)) = self.begin_move(block, cursor, allowed) else { return };
        let can_run = self.has_no_machine_zero(block, &functions) && self.is_cut(block, &words);
        match can_run.then(|| shape(self, block, &words)).flatten() {
            Some((to, turn)) => {
                let element = self.element(block, to, Way::Arc(turn));
                self.advance(block, element);
            }
            None => self.lose_place(),
        }
        self.end_functions(block, &functions, true);
    }

    fn sense_of(&mut self, block: &Block<'a>, words: &Words, plane: Plane) -> Option<Direction> {
        match words.turn {
            Some(direction) => Some(self.sense(plane, direction)),
            None => {
                self.refuse_block(block, Fault::Lacks("DR"));
                None
            }
        }
    }

    /// The end of an arc in Cartesian coordinates. It keeps the height along the normal of its plane.
    fn flat_end(&mut self, block: &Block<'a>, words: &Words, plane: Plane) -> Option<At> {
        let [a, b, n] = plane.axes();
        if words.axes[a].is_none() && words.axes[b].is_none() {
            self.refuse_block(block, Fault::NoAxis);
            return None;
        }
        let to = self.machine.placed(words.axes);
        if words.axes[n].is_some() && to[n] != self.machine.at[n] {
            self.refuse_block(block, Fault::NotRead);
            return None;
        }
        Some(to)
    }

    fn arc_about_pole(&mut self, block: &Block<'a>, words: &Words) -> Found {
        let (CirclePole { plane, .. }, center) = self.known_pole(block)?;
        let direction = self.sense_of(block, words, plane)?;
        let to = self.flat_end(block, words, plane)?;
        self.known_ends(block, &to)?;
        Some((to, Turn { plane, center: center.into(), direction, turns: 1 }))
    }

    /// CR: a positive radius makes the shorter arc, a negative one the longer.
    fn arc_by_radius(&mut self, block: &Block<'a>, words: &Words) -> Found {
        let plane = self.machine.plane;
        let direction = self.sense_of(block, words, plane)?;
        let Some((radius, span)) = words.radius else {
            self.refuse_block(block, Fault::Missing('R'));
            return None;
        };
        let to = self.flat_end(block, words, plane)?;
        let ends = self.known_ends(block, &to)?;
        let (line, span) = block.place(span[0], span[1]);
        let (_, center, _) = self.machine.center_by_radius(line, span, ends, direction, radius)?;
        let center = plane.to_local(&center).xy().into();
        Some((to, Turn { plane, center, direction, turns: 1 }))
    }

    /// CT and CTP: an arc that goes on in the direction of the last element.
    fn arc_by_tangent(&mut self, block: &Block<'a>, words: &Words) -> Found {
        let plane = self.machine.plane;
        let is_polar = words.polar_radius.is_some() || words.polar_angle.is_some();
        let to = if is_polar { self.polar_end(block, words)? } else { self.flat_end(block, words, plane)? };
        let ends = self.known_ends(block, &to)?;
        let [from, end] = flat(ends, plane);
        let n = plane.axes()[2];
        if to[n] != self.machine.at[n] {
            self.refuse_block(block, Fault::NotRead);
            return None;
        }
        // Behind RND or CHF the arc begins in the direction of the rounding or the chamfer. Their place
        // depends on the arc.
        let Some(along) = self.tangent().filter(|_| self.path.corner.is_none()) else {
            self.machine.refuse_state(block.line(), Fault::Lacks("an element before it"));
            return None;
        };
        let (left, chord) = (Vector2::new(-along.y, along.x), end - from);
        let beside = left.dot(&chord);
        if chord.norm() <= NO_WAY_MM || beside.abs() <= 1e-9 * chord.norm() {
            self.refuse_block(block, Fault::NoCenter);
            return None;
        }
        let center = from + left * (chord.norm_squared() / (2.0 * beside));
        let direction = if beside > 0.0 { Direction::Ccw } else { Direction::Cw };
        Some((to, Turn { plane, center: center.into(), direction, turns: 1 }))
    }

    /// CP: an arc about the pole to an angle, or by an angle of one turn or more, and along the normal.
    fn helix(&mut self, block: &Block<'a>, words: &Words) -> Found {
        let (pole, center) = self.known_pole(block)?;
        let direction = self.sense_of(block, words, pole.plane)?;
        let [a, b, n] = pole.plane.axes();
        if words.axes[a].is_some() || words.axes[b].is_some() {
            self.refuse_block(block, Fault::Conflict);
            return None;
        }
        let mut to = self.machine.placed([0, 1, 2].map(|axis| words.axes[axis].filter(|_| axis == n)));
        let ends = self.known_ends(block, &to)?;
        let [from, _] = flat(ends, pole.plane);
        let Some([radius, angle]) = self.polar_place(pole, center) else {
            self.refuse_block(block, Fault::NoCenter);
            return None;
        };
        let Angle { end_degrees, turns, is_closed } = self.helix_angle(block, words, angle)?;
        let arm = self.arm(pole.plane, end_degrees);
        let end = center + arm * ((from - center).norm() / arm.norm().max(f64::MIN_POSITIVE));
        let end = if is_closed { from } else { end };
        (to[a], to[b]) = (Some(end.x), Some(end.y));
        self.pole = Some(CirclePole { last: Some([radius, end_degrees]), ..pole });
        Some((to, Turn { plane: pole.plane, center: center.into(), direction, turns }))
    }

    /// Where a helix that begins at `from_degrees` ends, and how often it turns.
    fn helix_angle(&mut self, block: &Block<'a>, words: &Words, from_degrees: f64) -> Option<Angle> {
        match words.polar_angle {
            Some(Coordinate::Absolute(end_degrees)) => {
                Some(Angle { end_degrees, turns: 1, is_closed: false })
            }
            Some(Coordinate::Relative(degrees)) => {
                // The manuals ask for one sign of IPA and DR.
                let agrees = (words.turn == Some(Direction::Ccw)) == (degrees > 0.0);
                if !agrees || degrees == 0.0 || degrees.abs() > MAX_ANGLE {
                    self.refuse_block(block, Fault::OutOfRange(degrees));
                    return None;
                }
                let turns = (degrees.abs() / 360.0 - ANGLE_ROUNDING).ceil().max(1.0) as usize;
                let is_closed = degrees % 360.0 == 0.0;
                Some(Angle { end_degrees: from_degrees + degrees, turns, is_closed })
            }
            None => {
                self.refuse_block(block, Fault::Lacks("PA"));
                None
            }
        }
    }
}

/// Where a helix ends.
struct Angle {
    end_degrees: f64,
    /// Turns, the last of which may be a part of one.
    turns: usize,
    /// It ends above its start.
    is_closed: bool,
}

fn flat(ends: [Point3<f64>; 2], plane: Plane) -> [Vector2<f64>; 2] {
    ends.map(|point| plane.to_local(&point).xy())
}

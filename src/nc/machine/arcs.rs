//! Arcs and helices: by the distance of the centre or by a radius, with whole turns.
//!
//! # Method
//! 1. The end comes from the axis words. Without axis words in the plane the arc is a full circle.
//! 2. The centre comes from I, J and K, or from R: of the two centres at that distance from both ends, a
//!    positive R takes the one with the shorter arc.
//! 3. The two radii of a centre may differ by as much as the control accepts.
//! 4. An exact arc, or two, stand for an arc whose radii differ; [`near_arc`] bounds the distance.
//! 5. With P the arc makes P - 1 more turns. Each turn rises by its part of the whole angle.

use std::f64::consts::TAU;

use nalgebra::{Point3, Vector2, Vector3};
use toolpathd_core::geometry::curve::{Arc, ArcError, Curve, Direction};
use toolpathd_core::toolpath::near_arc::near_arc;

use super::{AXES, At, Block, Centers, Family, Fault, Line, Machine, Note, OFFSETS, WordValue};
use crate::control::RadiusRule;
use crate::placement::Coordinate;

/// Ends that are nearer in the plane are equal: incremental coordinates add up with rounding. Far below every
/// unit of a program.
const SAME_PLACE_MM: f64 = 1e-9;

/// Most turns of one block.
const MAX_TURNS: f64 = 10_000.0;

impl Machine<'_> {
    pub(super) fn arc(&mut self, line: Line<'_>, block: &mut Block, direction: Direction) {
        let [a, b, n] = self.plane.axes();
        let in_plane = [AXES[a], AXES[b]];
        if self.control.is(Family::Grbl) && !block.has(&in_plane) {
            block.use_up(b"IJKR");
            self.refuse(line.refused(Fault::Missing(char::from(in_plane[0]))));
            block.use_up(&AXES);
            return;
        }
        let to = self.target(line, block);
        let offsets: [Option<WordValue>; 3] = OFFSETS.map(|letter| block.peek(letter));
        let radius = block.take(b'R');
        let turns = self.turns(line, block);
        let ends = self.ends(line, &to);
        let has_center = offsets[a].is_some() || offsets[b].is_some();
        let Some(direction) = self.sense_placed(line, direction) else {
            block.use_up(&OFFSETS);
            self.at = to;
            return;
        };
        let given = match radius {
            Some(slot) => {
                if self.ignores_overridden() {
                    for letter in OFFSETS.iter().filter(|letter| block.has(&[**letter])) {
                        self.left.add(&char::from(*letter).to_string(), line.number);
                    }
                    block.use_up(&OFFSETS);
                }
                let radius_mm = self.length_mm(line, slot);
                let span = [slot.start, slot.end];
                ends.and_then(|ends| self.center_by_radius(line, span, ends, direction, radius_mm))
            }
            None if has_center => {
                block.use_up(&[OFFSETS[a], OFFSETS[b]]);
                if !self.control.is_strict {
                    block.use_up(&[OFFSETS[n]]);
                }
                let lengths = [a, b].map(|k| offsets[k].map(|slot| self.length_mm(line, slot)));
                ends.and_then(|ends| self.center_by_distance(line, ends, lengths, direction))
            }
            None => {
                self.refuse(line.refused(Fault::NoCenter));
                None
            }
        };
        if let Some((ends, center, allowed_mm)) = given {
            self.turn(line, ends, center, direction, turns, allowed_mm);
        }
        self.at = to;
    }

    /// An arc to `to` about a point, along the axes of the plane in coordinates of the answer, mm. The sense
    /// is that of the program. The arc makes `turns`, the last of which may be a part of one.
    pub(crate) fn arc_about(
        &mut self,
        line: Line<'_>,
        to: At,
        [first, second]: [f64; 2],
        direction: Direction,
        turns: usize,
    ) {
        let [a, b, _] = self.plane.axes();
        let direction = self.sense_placed(line, direction);
        if let (Some(direction), Some(ends)) = (direction, self.ends(line, &to)) {
            let mut center = ends[0];
            (center[a], center[b]) = (first, second);
            match mismatch(&center, &ends, [a, b], self.control.radius, self.in_inches()) {
                Ok(allowed_mm) => self.turn(line, ends, center, direction, turns, allowed_mm),
                Err(error) => self.refuse(line.refused(Fault::Arc(error))),
            }
        }
        self.at = to;
    }

    /// The sense of an arc where it lies. Refuses one that a scaling makes an ellipse.
    fn sense_placed(&mut self, line: Line<'_>, direction: Direction) -> Option<Direction> {
        match self.placement.in_plane(self.plane) {
            Some((_, false)) => Some(direction),
            Some((_, true)) => Some(match direction {
                Direction::Cw => Direction::Ccw,
                Direction::Ccw => Direction::Cw,
            }),
            None => {
                self.refuse(line.refused(Fault::Ellipse));
                None
            }
        }
    }

    /// P of an arc; 1 without it.
    fn turns(&mut self, line: Line<'_>, block: &mut Block) -> usize {
        if !self.control.is(Family::LinuxCnc) {
            return 1;
        }
        match block.take(b'P') {
            None => 1,
            Some(slot) if (1.0..=MAX_TURNS).contains(&slot.value) && slot.value.fract() == 0.0 => {
                slot.value as usize
            }
            Some(slot) => {
                self.refuse_word(line, slot, Fault::OutOfRange(slot.value));
                1
            }
        }
    }

    /// The centre at a distance from both ends.
    pub(crate) fn center_by_radius(
        &mut self,
        line: Line<'_>,
        [word, word_end]: [usize; 2],
        ends: [Point3<f64>; 2],
        direction: Direction,
        radius_mm: f64,
    ) -> Option<Given> {
        let [s, e] = ends.map(|p| self.plane.to_local(&p));
        let chord = (e - s).xy();
        let chord_mm = chord.norm();
        if chord_mm <= SAME_PLACE_MM {
            self.refuse(line.refusal(word, word_end, Fault::ClosedRadius));
            return None;
        }
        // Rounding of the ends may put them a little farther apart than the diameter.
        let rule = self.control.radius;
        let slack_mm = if self.in_inches() { rule.mm_in_inches } else { rule.mm } / 2.0;
        let radius = radius_mm.abs() * self.placement.in_plane(self.plane).map_or(1.0, |(factor, _)| factor);
        if chord_mm / 2.0 - radius > slack_mm {
            let fault = Fault::SmallRadius { chord_mm, radius_mm: radius };
            self.refuse(line.refusal(word, word_end, fault));
            return None;
        }
        let height = (radius * radius - chord_mm * chord_mm / 4.0).max(0.0).sqrt();
        let left = Vector2::new(-chord.y, chord.x) / chord_mm;
        let is_left = (direction == Direction::Ccw) == (radius_mm > 0.0);
        let middle = (s + e).xy() / 2.0 + left * if is_left { height } else { -height };
        Some((ends, self.plane.to_workpiece(&Vector3::new(middle.x, middle.y, s.z)), 0.0))
    }

    /// The centre at distances from the start or from zero. In a zero of the program a missing word is an
    /// error; from the start it is zero.
    fn center_by_distance(
        &mut self,
        line: Line<'_>,
        ends: [Point3<f64>; 2],
        lengths: [Option<f64>; 2],
        _: Direction,
    ) -> Option<Given> {
        let [a, b, n] = self.plane.axes();
        let from_start = {
            let mut offset = Vector3::zeros();
            (offset[a], offset[b]) = (lengths[0].unwrap_or(0.0), lengths[1].unwrap_or(0.0));
            let offset = self.placement.direction(offset);
            let mut center = ends[0];
            center[a] += offset[a];
            center[b] += offset[b];
            center
        };
        let absolute = {
            let mut center = [None; 3];
            for (axis, length) in [(a, lengths[0]), (b, lengths[1])] {
                center[axis] = Some(Coordinate::Absolute(length.unwrap_or(0.0)));
            }
            let center = self.placed(center).map(Option::unwrap_or_default);
            let mut center = Point3::from(center);
            center[n] = ends[0][n];
            center
        };
        let rule = self.control.radius;
        let is_inch = self.in_inches();
        let fits = |center: &Point3<f64>| mismatch(center, &ends, [a, b], rule, is_inch);
        let center = match (self.centers, self.control.centers) {
            (Some(true), _) if lengths.contains(&None) && self.control.is_strict => {
                let missing = if lengths[0].is_none() { OFFSETS[a] } else { OFFSETS[b] };
                self.refuse(line.refused(Fault::Missing(char::from(missing))));
                return None;
            }
            (Some(true), _) => absolute,
            (Some(false), _) | (None, Centers::Start) => from_start,
            (None, Centers::Unsure) if (absolute - from_start).norm() <= SAME_PLACE_MM => from_start,
            (None, Centers::Unsure) => match (fits(&from_start).is_ok(), fits(&absolute).is_ok()) {
                (true, true) => {
                    self.refuse(line.refused(Fault::UnsureCenter));
                    return None;
                }
                (_, is_absolute) => {
                    self.note_first(Note::CentersAssumed { line: line.number });
                    if is_absolute { absolute } else { from_start }
                }
            },
        };
        match fits(&center) {
            Ok(allowed_mm) => Some((ends, center, allowed_mm)),
            Err(error) => {
                self.refuse(line.refused(Fault::Arc(error)));
                None
            }
        }
    }

    /// Cuts the arc, turn by turn.
    fn turn(
        &mut self,
        line: Line<'_>,
        [start, mut end]: [Point3<f64>; 2],
        center: Point3<f64>,
        direction: Direction,
        turns: usize,
        allowed_mm: f64,
    ) {
        let [a, b, n] = self.plane.axes();
        if (end[a] - start[a]).abs() <= SAME_PLACE_MM && (end[b] - start[b]).abs() <= SAME_PLACE_MM {
            (end[a], end[b]) = (start[a], start[b]);
        }
        let about = (self.plane, direction);
        // The last turn alone, without the height of the others.
        let flat_end = {
            let mut flat = end;
            flat[n] = start[n];
            flat
        };
        let last = if allowed_mm > 0.0 {
            near_arc(about, start, flat_end, center, allowed_mm).map(|near| (near.arcs, near.moved_mm))
        } else {
            Arc::with_center_near(self.plane, direction, start, flat_end, center).map(|arc| (vec![arc], 0.0))
        };
        let (arcs, moved_mm) = match last {
            Ok(last) => last,
            Err(error) => return self.refuse(line.refused(Fault::Arc(error))),
        };
        if moved_mm > 0.0 {
            let (count, first, most) = self.moved_arcs;
            let first = if count == 0 { line.number } else { first };
            self.moved_arcs = (count + 1, first, f64::max(most, moved_mm));
        }
        let swept: f64 = arcs.iter().map(Arc::sweep).sum();
        let whole = swept + TAU * (turns - 1) as f64;
        let rise = end[n] - start[n];
        let mut pieces: Vec<(Point3<f64>, Point3<f64>, f64)> =
            (1..turns).map(|_| (start, arcs[0].center(), TAU)).collect();
        pieces.extend(arcs.iter().map(|arc| (arc.end(), arc.center(), arc.sweep())));
        let mut curves = Vec::new();
        let (mut at, mut turned) = (start, 0.0);
        let n_pieces = pieces.len();
        for (k, (mut to, mut about_center, sweep)) in pieces.into_iter().enumerate() {
            turned += sweep;
            to[n] = if k + 1 == n_pieces { end[n] } else { start[n] + rise * turned / whole };
            about_center[n] = at[n];
            match Arc::new(self.plane, direction, at, to, about_center) {
                Ok(arc) => curves.push(arc),
                Err(error) => return self.refuse(line.refused(Fault::Arc(error))),
            }
            at = to;
        }
        let length = curves.iter().map(Arc::length).sum();
        let Some(rate) = self.rate(line, length) else { return };
        for arc in curves {
            self.cut(line, Curve::Arc(arc), rate);
        }
    }
}

/// The ends of an arc, its centre, and how far an exact arc may be from it, mm.
type Given = ([Point3<f64>; 2], Point3<f64>, f64);

/// How far an exact arc may lie from the arc about `center`.
///
/// # Errors
/// When the control refuses the difference of the radii.
fn mismatch(
    center: &Point3<f64>,
    ends: &[Point3<f64>; 2],
    [a, b]: [usize; 2],
    rule: RadiusRule,
    is_inch: bool,
) -> Result<f64, ArcError> {
    let [start_mm, end_mm] = ends.map(|p| (p[a] - center[a]).hypot(p[b] - center[b]));
    if start_mm == 0.0 {
        return Err(ArcError::ZeroRadius);
    }
    let allowed_mm = rule.allowed_mm(start_mm.max(end_mm), is_inch);
    if (start_mm - end_mm).abs() <= allowed_mm {
        // A control may follow either radius, and an exact arc may lie as far away once more.
        Ok(2.0 * allowed_mm)
    } else {
        Err(ArcError::RadiusMismatch { start_mm, end_mm })
    }
}

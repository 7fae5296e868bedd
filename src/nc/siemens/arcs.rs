//! Arcs: by centre, radius, opening angle, pole, a point on the way, or the direction of the path before.
//!
//! # Method
//! Every form gives the centre in coordinates of the answer. `machine` checks both radii and cuts the arc.

use nalgebra::{Point3, Vector2, Vector3};
use toolpathd_core::geometry::curve::Direction;
use toolpathd_core::geometry::plane::Plane;

use super::Mill;
use super::block::{Block, From, Given};
use super::corner::Shape;
use crate::block::Line;
use crate::fault::Fault;
use crate::machine::At;
use crate::placement::Coordinate;

/// Most additional turns of TURN.
const MAX_TURNS: f64 = 999.0;

/// Ends in the plane that are nearer are one place, mm.
const SAME_PLACE_MM: f64 = 1e-9;

/// Sines below which three points lie on a line, or a chord goes on in the direction of the path.
const STRAIGHT: f64 = 1e-7;

impl<'a> Mill<'a, '_> {
    /// G2 and G3.
    pub(super) fn arc(&mut self, line: Line<'a>, block: &Block, to: At, direction: Direction) {
        let turns = self.turns(line, block);
        let [a, b, n] = self.machine.plane.axes();
        if let Some(given) = block.centers[n] {
            return self.refuse(line, [given.start, given.end], Fault::UnusedWord);
        }
        let has_center = block.centers[a].is_some() || block.centers[b].is_some();
        let is_polar = block.value("AP").is_some() || block.value("RP").is_some();
        let (radius, angle) = (block.value("CR"), block.value("AR"));
        let n_forms = [has_center && angle.is_none(), radius.is_some(), angle.is_some()];
        let n_forms = n_forms.iter().filter(|is_given| **is_given).count();
        if n_forms > 1 {
            self.machine.refuse(line.refused(Fault::Conflict));
            return self.lose_place();
        }
        let Some(ends) = self.machine.ends(line, &to) else {
            self.pending = None;
            self.machine.at = to;
            return;
        };
        let has_end = is_polar || block.axes[a].is_some() || block.axes[b].is_some();
        let mut to = to;
        let center = match (radius, angle) {
            (Some(given), _) => self.center_of_radius(line, ends, &given, direction),
            (_, Some(given)) if has_center && !has_end => {
                let center = self.center_of_distances(line, block);
                if let Some(center) = center {
                    (to[a], to[b]) = self.turned_end(ends[0], center, &given, direction);
                }
                center.filter(|_| self.is_opening(line, &given))
            }
            (_, Some(given)) if has_end && !has_center => self.center_of_angle(line, ends, &given, direction),
            (_, Some(given)) => {
                self.refuse(line, [given.start, given.end], Fault::Conflict);
                None
            }
            _ if has_center => self.center_of_distances(line, block),
            _ if is_polar => self.center_at_pole(line),
            _ => {
                self.machine.refuse(line.refused(Fault::NoCenter));
                None
            }
        };
        match center {
            Some(center) => self.cut(line, to, Shape::Arc { center, direction, turns }, block),
            None => self.lose_place(),
        }
    }

    /// TURN counts full turns beside the part of one.
    fn turns(&mut self, line: Line<'a>, block: &Block) -> usize {
        match block.value("TURN") {
            None => 1,
            Some(given) if given.value.fract() == 0.0 && (0.0..=MAX_TURNS).contains(&given.value) => {
                given.value as usize + 1
            }
            Some(given) => {
                self.refuse(line, [given.start, given.end], Fault::OutOfRange(given.value));
                1
            }
        }
    }

    /// I, J and K count from the start of the arc, and from the zero with AC.
    fn center_of_distances(&mut self, line: Line<'a>, block: &Block) -> Option<[f64; 2]> {
        let [a, b, _] = self.machine.plane.axes();
        self.assume_units(line);
        let unit = self.machine.unit_mm();
        let mut coordinates = [None; 3];
        for axis in [a, b] {
            let given = block.centers[axis];
            let mm = given.map_or(0.0, |given| given.value * unit);
            let is_absolute = given.is_some_and(|given| given.from == From::Zero);
            coordinates[axis] =
                Some(if is_absolute { Coordinate::Absolute(mm) } else { Coordinate::Relative(mm) });
        }
        let center = self.machine.placed(coordinates);
        center[a].zip(center[b]).map(|(x, y)| [x, y])
    }

    fn center_at_pole(&mut self, line: Line<'a>) -> Option<[f64; 2]> {
        let [a, b, _] = self.machine.plane.axes();
        let Some(pole) = self.pole else {
            self.machine.refuse_state(line, Fault::NoPole);
            return None;
        };
        let mut coordinates = [None; 3];
        coordinates[a] = Some(Coordinate::Absolute(pole[0]));
        coordinates[b] = Some(Coordinate::Absolute(pole[1]));
        let center = self.machine.placed(coordinates);
        center[a].zip(center[b]).map(|(x, y)| [x, y])
    }

    /// The points of the plane.
    fn in_plane(&self, points: [Point3<f64>; 2]) -> [Vector2<f64>; 2] {
        let [a, b, _] = self.machine.plane.axes();
        points.map(|p| Vector2::new(p[a], p[b]))
    }

    /// The centre at a signed height above the chord, to the left of an arc that runs counterclockwise.
    fn above(&self, [start, end]: [Vector2<f64>; 2], height: f64, direction: Direction) -> [f64; 2] {
        let chord = end - start;
        let left = Vector2::new(-chord.y, chord.x) / chord.norm();
        let height = if self.runs(direction) == Direction::Ccw { height } else { -height };
        ((start + end) / 2.0 + left * height).into()
    }

    /// CR: a negative radius makes the longer arc.
    fn center_of_radius(
        &mut self,
        line: Line<'a>,
        ends: [Point3<f64>; 2],
        given: &Given,
        direction: Direction,
    ) -> Option<[f64; 2]> {
        self.assume_units(line);
        let span = [given.start, given.end];
        let ends = self.in_plane(ends);
        let chord_mm = (ends[1] - ends[0]).norm();
        if chord_mm <= SAME_PLACE_MM {
            self.refuse(line, span, Fault::ClosedRadius);
            return None;
        }
        let factor = self.machine.placement.in_plane(self.machine.plane).map_or(1.0, |(factor, _)| factor);
        let radius_mm = given.value.abs() * self.machine.unit_mm() * factor;
        // Rounding of the ends may put them a little farther apart than the diameter.
        if chord_mm / 2.0 - radius_mm > self.machine.control.radius.mm / 2.0 {
            self.refuse(line, span, Fault::SmallRadius { chord_mm, radius_mm });
            return None;
        }
        let height = (radius_mm * radius_mm - chord_mm * chord_mm / 4.0).max(0.0).sqrt();
        Some(self.above(ends, if given.value < 0.0 { -height } else { height }, direction))
    }

    fn is_opening(&mut self, line: Line<'a>, given: &Given) -> bool {
        let is_legal = given.value > 0.0 && given.value < 360.0;
        if !is_legal {
            self.refuse(line, [given.start, given.end], Fault::OutOfRange(given.value));
        }
        is_legal
    }

    /// AR with the end: the angle of the whole arc.
    fn center_of_angle(
        &mut self,
        line: Line<'a>,
        ends: [Point3<f64>; 2],
        given: &Given,
        direction: Direction,
    ) -> Option<[f64; 2]> {
        let ends = self.in_plane(ends);
        let chord_mm = (ends[1] - ends[0]).norm();
        if chord_mm <= SAME_PLACE_MM {
            self.refuse(line, [given.start, given.end], Fault::ClosedRadius);
            return None;
        }
        if !self.is_opening(line, given) {
            return None;
        }
        let height =
            if given.value == 180.0 { 0.0 } else { chord_mm / 2.0 / (given.value / 2.0).to_radians().tan() };
        Some(self.above(ends, height, direction))
    }

    /// AR with the centre: where the arc ends.
    fn turned_end(
        &self,
        start: Point3<f64>,
        center: [f64; 2],
        given: &Given,
        direction: Direction,
    ) -> (Option<f64>, Option<f64>) {
        let [start, _] = self.in_plane([start, start]);
        let center = Vector2::from(center);
        let sign = if self.runs(direction) == Direction::Ccw { 1.0 } else { -1.0 };
        let (sin, cos) = (sign * given.value.to_radians()).sin_cos();
        let from = start - center;
        let end = center + Vector2::new(from.x * cos - from.y * sin, from.x * sin + from.y * cos);
        (Some(end.x), Some(end.y))
    }

    /// CT: the arc that goes on in the direction of the path before.
    pub(super) fn tangent_arc(&mut self, line: Line<'a>, block: &Block, to: At) {
        let Some(ends) = self.machine.ends(line, &to) else { return self.lose_place() };
        // A cut whose corner is open would end elsewhere.
        self.settle(line);
        let Some([x, y]) = self.tangent else {
            self.machine.refuse_state(line, Fault::NoTangent);
            return self.lose_place();
        };
        let (direction, [start, end]) = (Vector2::new(x, y), self.in_plane(ends));
        let chord = end - start;
        let left = Vector2::new(-direction.y, direction.x);
        let across = left.dot(&chord);
        if chord.norm() <= SAME_PLACE_MM || across.abs() <= STRAIGHT * chord.norm() {
            if direction.dot(&chord) > 0.0 {
                return self.cut(line, to, Shape::Line, block);
            }
            self.machine.refuse(line.refused(Fault::NoTangent));
            return self.lose_place();
        }
        let center = start + left * (chord.norm_squared() / (2.0 * across));
        // The map of senses is its own inverse.
        let direction = self.runs(if across > 0.0 { Direction::Ccw } else { Direction::Cw });
        self.cut(line, to, Shape::Arc { center: center.into(), direction, turns: 1 }, block);
    }

    /// CIP: the arc through a point, in one of the three planes.
    pub(super) fn arc_through_point(&mut self, line: Line<'a>, block: &Block, to: At, has_shifted: bool) {
        let mut coordinates = [None; 3];
        for (axis, coordinate) in coordinates.iter_mut().enumerate() {
            if let Some(given) = &block.middles[axis] {
                *coordinate = Some(self.coordinate(line, given));
                // The end has taken the change of a zero; whether the point does so, too, is not certain.
                if has_shifted && matches!(coordinate, Some(Coordinate::Relative(_))) {
                    self.refuse(line, [given.start, given.end], Fault::IncrementOfNewZero);
                    return self.lose_place();
                }
            }
        }
        if coordinates == [None; 3] {
            self.machine.refuse(line.refused(Fault::NoCenter));
            return self.lose_place();
        }
        let middle = self.machine.placed(coordinates);
        let (Some([start, end]), Some([_, middle])) =
            (self.machine.ends(line, &to), self.machine.ends(line, &middle))
        else {
            return self.lose_place();
        };
        self.settle(line);
        let own = self.machine.plane;
        let planes = [own, Plane::Xy, Plane::Zx, Plane::Yz];
        let lies_in = |plane: &&Plane| {
            let n = plane.axes()[2];
            (start[n] - middle[n]).abs() <= SAME_PLACE_MM && (start[n] - end[n]).abs() <= SAME_PLACE_MM
        };
        let Some(plane) = planes.iter().find(lies_in).copied() else {
            self.machine.refuse(line.refused(Fault::TiltedArc));
            return self.lose_place();
        };
        let [a, b, _] = plane.axes();
        let [start, middle, end] = [start, middle, end].map(|p| Vector2::new(p[a], p[b]));
        let Some((center, is_left)) = circle(start, middle, end) else {
            self.machine.refuse(line.refused(Fault::NoCenter));
            return self.lose_place();
        };
        self.machine.plane = plane;
        let direction = self.runs(if is_left { Direction::Ccw } else { Direction::Cw });
        self.cut(line, to, Shape::Arc { center, direction, turns: 1 }, block);
        if plane != own {
            self.settle(line);
            self.machine.plane = own;
            self.tangent = None;
        }
    }

    /// A vector of the program in coordinates of the answer, mm.
    pub(super) fn way(&self, vector: [f64; 3]) -> Vector3<f64> {
        self.machine.placement.direction(Vector3::from(vector))
    }
}

/// The centre of the circle through three points, and whether they follow each other counterclockwise.
/// `None` for points on a line.
fn circle(start: Vector2<f64>, middle: Vector2<f64>, end: Vector2<f64>) -> Option<([f64; 2], bool)> {
    let (u, v) = (middle - start, end - start);
    let area = u.perp(&v);
    let is_flat = area.abs() <= STRAIGHT * u.norm() * v.norm();
    if is_flat || u.norm() <= SAME_PLACE_MM || v.norm() <= SAME_PLACE_MM {
        return None;
    }
    let (uu, vv) = (u.norm_squared(), v.norm_squared());
    let by = Vector2::new(v.y * uu - u.y * vv, u.x * vv - v.x * uu) / (2.0 * area);
    Some(((start + by).into(), area > 0.0))
}

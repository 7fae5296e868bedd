//! The pole, and ends in polar coordinates.
//!
//! # Method
//! CC states the pole, which is also the centre of C and CP. An angle counts from the first axis of the plane
//! of the pole: X, Y or Z in the planes XY, YZ and ZX. What is incremental counts from where the tool stands.

use nalgebra::{Vector2, Vector3};
use toolpathd_core::geometry::plane::Plane;

use super::Execution;
use super::cursor::Cursor;
use super::path::{NO_WAY_MM, in_plane};
use super::script::Block;
use super::words::{Sort, Words};
use crate::fault::Fault;
use crate::machine::At;
use crate::placement::{Coordinate, sine_and_cosine};

/// Differences of radii that count as none, mm: well below every unit of a program.
const SAME_RADIUS_MM: f64 = 1e-6;

/// A pole. A change of the datum ends it.
#[derive(Debug, Clone, Copy)]
pub struct CirclePole {
    pub plane: Plane,
    /// Along the axes of the plane, in coordinates of the answer.
    pub at: [Option<f64>; 2],
    /// The radius in mm and the angle in degrees that the last polar block has reached.
    pub last: Option<[f64; 2]>,
}

impl<'a> Execution<'a, '_> {
    /// `CC`: along two axes, or where the tool stands.
    pub(super) fn set_pole(&mut self, block: &Block<'a>, cursor: &mut Cursor<'_>) {
        let words = self.scan(block, cursor, &[Sort::Axis]);
        self.pole = None;
        if words.is_broken {
            return;
        }
        let plane = match words.axes.map(|axis| axis.is_some()) {
            [false, false, false] => self.machine.plane,
            [true, true, false] => Plane::Xy,
            [true, false, true] => Plane::Zx,
            [false, true, true] => Plane::Yz,
            // Whether the other coordinate is that of the last pole or of the tool is not certain.
            _ => return self.refuse_block(block, Fault::Lacks("the other coordinate of the pole")),
        };
        let [a, b, _] = plane.axes();
        let at = self.machine.placed(words.axes);
        self.pole = Some(CirclePole { plane, at: [at[a], at[b]], last: None });
    }

    /// The pole in force, with its place. Refuses a block without one.
    pub(super) fn known_pole(&mut self, block: &Block<'a>) -> Option<(CirclePole, Vector2<f64>)> {
        let Some(pole) = self.pole else {
            self.machine.refuse_state(block.line(), Fault::Lacks("CC"));
            return None;
        };
        let [Some(a), Some(b)] = pole.at else {
            self.machine.refuse_state(block.line(), Fault::Lacks("a pole whose place is known"));
            return None;
        };
        Some((pole, Vector2::new(a, b)))
    }

    /// The end that PR and PA state, or one of them.
    pub(super) fn polar_end(&mut self, block: &Block<'a>, words: &Words) -> Option<At> {
        let (pole, center) = self.known_pole(block)?;
        let actual = self.polar_place(pole, center);
        let [radius, angle] = match (self.polar_radius(pole, actual, words), self.polar_angle(actual, words))
        {
            (Some(radius), Some(angle)) => [radius, angle],
            (None, _) => return self.lacks_polar(block, "PR"),
            (_, None) => return self.lacks_polar(block, "PA"),
        };
        let [a, b, n] = pole.plane.axes();
        if words.axes[a].is_some() || words.axes[b].is_some() {
            self.refuse_block(block, Fault::Conflict);
            return None;
        }
        let mut along = [None; 3];
        along[n] = words.axes[n];
        let mut to = self.machine.placed(along);
        let arm = radius * self.arm(pole.plane, angle);
        (to[a], to[b]) = (Some(center.x + arm.x), Some(center.y + arm.y));
        self.pole = Some(CirclePole { last: Some([radius, angle]), ..pole });
        Some(to)
    }

    fn lacks_polar(&mut self, block: &Block<'a>, word: &'static str) -> Option<At> {
        self.machine.refuse_state(block.line(), Fault::Lacks(word));
        None
    }

    /// Without PR the radius stays, if the tool still stands at the radius of the last polar block.
    fn polar_radius(&self, pole: CirclePole, actual: Option<[f64; 2]>, words: &Words) -> Option<f64> {
        match words.polar_radius {
            Some(Coordinate::Absolute(mm)) => Some(mm),
            Some(Coordinate::Relative(mm)) => actual.map(|[radius, _]| radius + mm),
            None => {
                let [radius, _] = pole.last?;
                actual.filter(|[now, _]| (now - radius.abs()).abs() <= SAME_RADIUS_MM).map(|_| radius)
            }
        }
    }

    fn polar_angle(&self, actual: Option<[f64; 2]>, words: &Words) -> Option<f64> {
        match words.polar_angle {
            Some(Coordinate::Absolute(degrees)) => Some(degrees),
            Some(Coordinate::Relative(degrees)) => actual.map(|[_, angle]| angle + degrees),
            None => actual.map(|[_, angle]| angle),
        }
    }

    /// A vector of length one at an angle of the program, in coordinates of the answer.
    pub(super) fn arm(&self, plane: Plane, degrees: f64) -> Vector2<f64> {
        let (sin, cos) = sine_and_cosine(degrees);
        let [a, b, _] = plane.axes();
        let mut arm = Vector3::zeros();
        (arm[a], arm[b]) = (cos, sin);
        let arm = self.machine.placement.direction(arm);
        Vector2::new(arm[a], arm[b])
    }

    /// The radius in mm and the angle in degrees at which the tool stands about a pole, in coordinates of
    /// the program. `None` where they are not known, or the tool stands on the pole.
    pub(super) fn polar_place(&self, pole: CirclePole, center: Vector2<f64>) -> Option<[f64; 2]> {
        let [a, b, _] = pole.plane.axes();
        let at = in_plane(&self.machine.at, pole.plane)?;
        let back = |place: Vector2<f64>| {
            let mut point = [Some(0.0); 3];
            (point[a], point[b]) = (Some(place.x), Some(place.y));
            in_plane(&self.machine.placement.back(&point), pole.plane)
        };
        let arm = back(at)? - back(center)?;
        let radius = arm.norm();
        (radius > NO_WAY_MM).then(|| [radius, arm.y.atan2(arm.x).to_degrees()])
    }
}

//! A helix about Z as a block that states its angle: where the tool really ends.
//!
//! A control that is told the angle turns about the written centre from where the tool is. The angle is
//! rounded, and the radius stays that of the start. So the tool ends beside the point of the toolpath, by
//! less than the radii differ and the angle is rounded.

use std::f64::consts::TAU;

use nalgebra::{Point2, Rotation2, Vector2};
use toolpathd_core::geometry::curve::Direction;

/// Units of the angle in one degree.
pub const PER_DEGREE: f64 = 1e4;

/// The angle of a whole turn.
const TURN: i64 = 3_600_000;

/// A helix from where the tool is.
pub struct Turn {
    /// In ten-thousandths of a degree, above zero.
    pub angle: i64,
    /// Where the tool ends, mm.
    pub end: Point2<f64>,
    /// Upper bound for the distance from the helix that starts and ends on the grid, mm.
    pub apart_mm: f64,
}

/// The helix about `center` between `ends`, which are on the grid, from `at`, where the tool is.
pub fn turn(at: Point2<f64>, ends: [Point2<f64>; 2], center: Point2<f64>, direction: Direction) -> Turn {
    let [start, end] = ends;
    let sense = if direction == Direction::Ccw { 1.0 } else { -1.0 };
    let closes = start == end;
    let between = |from: Point2<f64>| {
        let (from, to): (Vector2<f64>, Vector2<f64>) = (from - center, end - center);
        if closes { TAU } else { (sense * from.perp(&to).atan2(from.dot(&to))).rem_euclid(TAU) }
    };
    let units = (between(at).to_degrees() * PER_DEGREE).round() as i64;
    let angle = if closes { TURN } else { units.clamp(1, TURN - 1) };
    let turned = (angle as f64 / PER_DEGREE).to_radians();
    let spoke = at - center;
    let apart_mm = (at - start).norm() + spoke.norm() * (turned - between(start)).abs();
    let end = if closes { at } else { center + Rotation2::new(sense * turned) * spoke };
    Turn { angle, end, apart_mm }
}

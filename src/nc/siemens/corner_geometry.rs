//! Roundings and chamfers between two paths of the plane.

use std::f64::consts::TAU;

use nalgebra::Vector2;

use crate::offset_curve::{OffsetCurve, left_of};

/// Ways that are shorter are none, mm.
const NO_WAY_MM: f64 = 1e-9;

/// Shortest rest of an arc beside a rounding, mm.
const LEAST_ARC_MM: f64 = 1e-6;

/// Sines of angles below which two directions count as one.
const NO_TURN: f64 = 1e-9;

/// A line or an arc in the plane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Path {
    pub start: Vector2<f64>,
    pub end: Vector2<f64>,
    /// The centre, and whether the arc runs counterclockwise.
    pub arc: Option<(Vector2<f64>, bool)>,
}

/// Where a corner begins and ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CornerCut {
    pub first: Vector2<f64>,
    pub second: Vector2<f64>,
    /// The centre of a rounding, and whether it runs counterclockwise.
    pub center: Option<(Vector2<f64>, bool)>,
}

impl Path {
    /// The direction at a point of the path; `None` for a path without length.
    pub fn direction_at(&self, point: &Vector2<f64>) -> Option<Vector2<f64>> {
        let along = match self.arc {
            None => self.end - self.start,
            Some((center, true)) => left_of(point - center),
            Some((center, false)) => -left_of(point - center),
        };
        along.try_normalize(NO_WAY_MM)
    }

    /// The point of the whole line or circle that is nearest to `point`.
    fn foot(&self, point: &Vector2<f64>) -> Option<Vector2<f64>> {
        match self.arc {
            None => {
                let direction = self.direction_at(&self.start)?;
                Some(self.start + direction * (point - self.start).dot(&direction))
            }
            Some((center, _)) => {
                Some(center + (point - center).try_normalize(NO_WAY_MM)? * (self.end - center).norm())
            }
        }
    }

    /// Whether a point of the line or circle lies on the path.
    fn holds(&self, point: &Vector2<f64>) -> bool {
        match self.arc {
            None => {
                let way = self.end - self.start;
                let along = (point - self.start).dot(&way) / way.norm();
                (-NO_WAY_MM..=way.norm() + NO_WAY_MM).contains(&along)
            }
            Some((center, is_left)) => {
                let turned = |to: &Vector2<f64>| {
                    let (from, to) = (self.start - center, to - center);
                    let angle = from.perp(&to).atan2(from.dot(&to));
                    (if is_left { angle } else { -angle }).rem_euclid(TAU)
                };
                let is_circle = (self.start - self.end).norm() <= NO_WAY_MM;
                is_circle || turned(point) <= turned(&self.end)
            }
        }
    }

    /// The line or circle at `mm` to the left: a point with a direction, or a centre with a radius.
    fn moved_left(&self, mm: f64) -> Option<OffsetCurve> {
        match self.arc {
            None => {
                let direction = self.direction_at(&self.start)?;
                Some(OffsetCurve::Line { at: self.start + left_of(direction) * mm, along: direction })
            }
            Some((center, is_left)) => {
                let radius = (self.end - center).norm() + if is_left { -mm } else { mm };
                (radius > NO_WAY_MM).then_some(OffsetCurve::Circle { center, radius_mm: radius })
            }
        }
    }
}

/// The sine of the turn at the corner; `None` where the paths go on in one direction.
///
/// # Errors
/// When the path turns back on itself, or one of the paths has no length.
fn turn(before: &Path, after: &Path) -> Result<Option<f64>, ()> {
    let first = before.direction_at(&before.end).ok_or(())?;
    let second = after.direction_at(&after.start).ok_or(())?;
    let sine = first.perp(&second);
    match (sine.abs() <= NO_TURN, first.dot(&second) > 0.0) {
        (true, true) => Ok(None),
        (true, false) => Err(()),
        _ => Ok(Some(sine)),
    }
}

/// The rounding of a corner by a radius; `None` where nothing is to round.
///
/// # Errors
/// When it does not fit.
pub fn rounding(before: &Path, after: &Path, radius: f64) -> Result<Option<CornerCut>, ()> {
    let Some(sine) = turn(before, after)? else { return Ok(None) };
    let is_left = sine > 0.0;
    let mm = if is_left { radius } else { -radius };
    let (a, b) = (before.moved_left(mm).ok_or(())?, after.moved_left(mm).ok_or(())?);
    let corner = before.end;
    let mut joints: Vec<(f64, CornerCut)> = Vec::new();
    for center in a.crossings(b, 0.0) {
        let (Some(first), Some(second)) = (before.foot(&center), after.foot(&center)) else { continue };
        // An arc of which nothing is left would be a full circle.
        let vanishes = before.arc.is_some() && (first - before.start).norm() <= LEAST_ARC_MM
            || after.arc.is_some() && (second - after.end).norm() <= LEAST_ARC_MM;
        if before.holds(&first) && after.holds(&second) && !vanishes {
            let joint = CornerCut { first, second, center: Some((center, is_left)) };
            joints.push(((center - corner).norm(), joint));
        }
    }
    let nearest = joints.into_iter().min_by(|a, b| a.0.total_cmp(&b.0));
    nearest.map(|(_, joint)| Some(joint)).ok_or(())
}

/// The chamfer of a corner of two lines: of a width, or of legs; `None` where nothing is to cut off.
///
/// # Errors
/// When it does not fit, or a path is an arc.
pub fn chamfer(before: &Path, after: &Path, mm: f64, is_width: bool) -> Result<Option<CornerCut>, ()> {
    if before.arc.is_some() || after.arc.is_some() {
        return Err(());
    }
    if turn(before, after)?.is_none() {
        return Ok(None);
    }
    let first = before.direction_at(&before.end).ok_or(())?;
    let second = after.direction_at(&after.start).ok_or(())?;
    // Legs of length 1 have this width.
    let width = (first + second).norm();
    let leg = if is_width { mm / width } else { mm };
    let (first, second) = (before.end - first * leg, after.start + second * leg);
    if before.holds(&first) && after.holds(&second) {
        Ok(Some(CornerCut { first, second, center: None }))
    } else {
        Err(())
    }
}

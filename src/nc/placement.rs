//! Where a program's coordinates lie in the work offset: shifted, turned, scaled or mirrored.
//!
//! # Method
//! A point `p` of the program lies at `linear * p + shift`. A coordinate that is not known leaves unknown
//! only what depends on it.

use nalgebra::{Matrix3, Point3, Vector3};
use toolpathd_core::geometry::plane::Plane;

/// A place of the tool, mm; `None` along an axis where it is not known.
pub type At = [Option<f64>; 3];

/// Parts of the largest entry that count as zero: sines and cosines of right angles.
const NOTHING: f64 = 1e-15;

/// An invertible map of coordinates that leaves angles in the plane alone.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Placement {
    linear: Matrix3<f64>,
    inverse: Matrix3<f64>,
    shift: Vector3<f64>,
}

/// One coordinate that a block states, mm.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Coordinate {
    /// Counted from the zero of the program.
    Absolute(f64),
    /// Counted from where the tool stands.
    Relative(f64),
}

impl Placement {
    /// Coordinates as they are.
    pub fn plain() -> Self {
        Self { linear: Matrix3::identity(), inverse: Matrix3::identity(), shift: Vector3::zeros() }
    }

    /// A shift, mm.
    pub fn shifted(shift: Vector3<f64>) -> Self {
        Self { shift, ..Self::plain() }
    }

    /// A turn of `degrees` about `center`, counterclockwise as seen against the normal of the plane.
    pub fn turned(plane: Plane, center: Point3<f64>, degrees: f64) -> Self {
        let [a, b, _] = plane.axes();
        let (sin, cos) = sine_and_cosine(degrees);
        let mut linear = Matrix3::identity();
        (linear[(a, a)], linear[(a, b)], linear[(b, a)], linear[(b, b)]) = (cos, -sin, sin, cos);
        let shift = center.coords - linear * center.coords;
        Self { linear, inverse: linear.transpose(), shift }
    }

    /// Lengths times `factors` along the axes, about `center`; a negative factor mirrors. `None` where a
    /// factor is zero or not finite.
    pub fn scaled(center: Point3<f64>, factors: [f64; 3]) -> Option<Self> {
        let is_legal = |factor: f64| factor.is_finite() && (1e-6..=1e6).contains(&factor.abs());
        if !factors.iter().all(|factor| is_legal(*factor)) {
            return None;
        }
        let linear = Matrix3::from_diagonal(&Vector3::from(factors));
        let inverse = Matrix3::from_diagonal(&Vector3::from(factors.map(|factor| 1.0 / factor)));
        let shift = center.coords - linear * center.coords;
        Some(Self { linear, inverse, shift })
    }

    /// This map applied to what `inner` gives.
    pub fn of(&self, inner: &Self) -> Self {
        Self {
            linear: self.linear * inner.linear,
            inverse: inner.inverse * self.inverse,
            shift: self.linear * inner.shift + self.shift,
        }
    }

    /// By how much the zero lies elsewhere than in `before`, in coordinates of the program, mm. `None` where
    /// the two maps differ by more than a shift.
    pub fn shift_since(&self, before: &Self) -> Option<[f64; 3]> {
        let is_shift = self.linear == before.linear;
        is_shift.then(|| (self.inverse * (self.shift - before.shift)).into())
    }

    pub fn is_plain(&self) -> bool {
        *self == Self::plain()
    }

    /// Where a point of the program lies.
    pub fn place(&self, at: &At) -> At {
        apply(&self.linear, at, &self.shift)
    }

    /// The point of the program that lies at `at`.
    pub fn back(&self, at: &At) -> At {
        apply(&self.inverse, &[0, 1, 2].map(|k| at[k].map(|value| value - self.shift[k])), &Vector3::zeros())
    }

    /// What a difference of two points becomes.
    pub fn direction(&self, vector: Vector3<f64>) -> Vector3<f64> {
        self.linear * vector
    }

    /// What a length along an axis becomes along that axis: with a sign, where the axis stays its own.
    pub fn factor(&self, axis: usize) -> f64 {
        self.linear[(axis, axis)]
    }

    /// Whether the direction of an axis stays what it is.
    pub fn keeps_direction(&self, axis: usize) -> bool {
        let is_own = |k: usize| self.linear[(k, axis)] == 0.0 && self.linear[(axis, k)] == 0.0;
        (0..3).filter(|k| *k != axis).all(is_own) && self.factor(axis) > 0.0
    }

    /// What lengths in the plane are multiplied by, and whether the sense of arcs changes. `None` where the
    /// two directions of the plane have different factors, so that circles become ellipses.
    pub fn in_plane(&self, plane: Plane) -> Option<(f64, bool)> {
        let [a, b, _] = plane.axes();
        let column = |j: usize| nalgebra::Vector2::new(self.linear[(a, j)], self.linear[(b, j)]);
        let (first, second) = (column(a), column(b));
        let factor = first.norm();
        let is_even = (factor - second.norm()).abs() <= 1e-12 * factor;
        is_even.then(|| (factor, first.perp(&second) < 0.0))
    }
}

/// Sine and cosine of an angle. Those of quarter turns are exact.
pub fn sine_and_cosine(degrees: f64) -> (f64, f64) {
    match degrees.rem_euclid(360.0) {
        0.0 => (0.0, 1.0),
        90.0 => (1.0, 0.0),
        180.0 => (0.0, -1.0),
        270.0 => (-1.0, 0.0),
        angle => angle.to_radians().sin_cos(),
    }
}

fn apply(linear: &Matrix3<f64>, at: &At, shift: &Vector3<f64>) -> At {
    [0, 1, 2].map(|k| {
        let mut sum = shift[k];
        for (j, value) in at.iter().enumerate() {
            if linear[(k, j)].abs() > NOTHING {
                sum += linear[(k, j)] * (*value)?;
            }
        }
        Some(sum)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn turns_and_mirrors_go_there_and_back() {
        let turn = Placement::turned(Plane::Xy, Point3::new(10.0, 0.0, 0.0), 90.0);
        assert_eq!(turn.place(&[Some(12.0), Some(1.0), Some(5.0)]), [Some(9.0), Some(2.0), Some(5.0)]);
        let mirror = Placement::scaled(Point3::origin(), [-1.0, 1.0, 1.0]).unwrap();
        let both = mirror.of(&turn);
        let at = [Some(3.0), Some(-4.0), Some(0.5)];
        let there = both.place(&at);
        assert_eq!(there, mirror.place(&turn.place(&at)));
        assert_eq!((both.back(&there), both.in_plane(Plane::Xy)), (at, Some((1.0, true))));
        assert_eq!(Placement::scaled(Point3::origin(), [1.0, 0.0, 1.0]), None);
        let stretched = Placement::scaled(Point3::origin(), [2.0, 1.0, 1.0]).unwrap();
        assert_eq!(
            (stretched.in_plane(Plane::Xy), stretched.in_plane(Plane::Yz)),
            (None, Some((1.0, false)))
        );
    }

    #[test]
    fn what_is_not_known_spreads_no_farther_than_it_must() {
        let turn = Placement::turned(Plane::Xy, Point3::origin(), 30.0);
        let there = turn.place(&[Some(1.0), None, Some(5.0)]);
        assert_eq!((there[0], there[1], there[2]), (None, None, Some(5.0)));
    }
}

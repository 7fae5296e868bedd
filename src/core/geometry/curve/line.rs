//! A straight line between two points.

use nalgebra::{Point3, Vector3};

/// The line from `start` to `end`, mm; its length may be zero.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Line {
    pub start: Point3<f64>,
    pub end: Point3<f64>,
}

impl Line {
    /// The length, mm.
    pub fn length(&self) -> f64 {
        (self.end - self.start).norm()
    }

    /// The vector from the start to the end, for both ends.
    pub fn tangents(&self) -> [Vector3<f64>; 2] {
        [self.end - self.start; 2]
    }

    /// The point at the fraction `t` of the length.
    pub fn point_at(&self, t: f64) -> Point3<f64> {
        self.start + (self.end - self.start) * t
    }

    /// The distance from `p` to the line between its ends, mm.
    pub fn distance_to(&self, p: &Point3<f64>) -> f64 {
        (p - self.nearest_to(p)).norm()
    }

    /// The point between the ends that is nearest to `p`.
    pub fn nearest_to(&self, p: &Point3<f64>) -> Point3<f64> {
        let along = self.end - self.start;
        let squared = along.norm_squared();
        let t = if squared > 0.0 { ((p - self.start).dot(&along) / squared).clamp(0.0, 1.0) } else { 0.0 };
        self.point_at(t)
    }

    /// The largest scalar product of `direction` with a point between the ends.
    pub fn support(&self, direction: &Vector3<f64>) -> f64 {
        self.start.coords.dot(direction).max(self.end.coords.dot(direction))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn beyond_an_end_the_distance_is_that_of_the_end() {
        let line = Line { start: Point3::origin(), end: Point3::new(10.0, 0.0, 0.0) };
        assert_eq!(line.distance_to(&Point3::new(5.0, 3.0, 4.0)), 5.0);
        assert_eq!(line.distance_to(&Point3::new(-3.0, 4.0, 0.0)), 5.0);
        let point = Line { start: line.start, end: line.start };
        assert_eq!(point.distance_to(&Point3::new(0.0, 3.0, 4.0)), 5.0);
    }
}

//! Curves that a tool follows in one motion: a line, an arc, a helix, or a part of a parabola.
//!
//! # Example
//! A quarter turn of a helix: radius 5 mm, 2 mm up.
//!
//! ```
//! use std::f64::consts::PI;
//! use nalgebra::Point3;
//! use toolpathd_core::geometry::curve::{Arc, Curve, Direction};
//! use toolpathd_core::geometry::plane::Plane;
//!
//! let [start, end] = [Point3::new(5.0, 0.0, 0.0), Point3::new(0.0, 5.0, 2.0)];
//! let helix = Curve::Arc(Arc::new(Plane::Xy, Direction::Ccw, start, end, Point3::origin()).unwrap());
//! assert!((helix.length() - f64::hypot(2.5 * PI, 2.0)).abs() < 1e-12);
//!
//! let middle = helix.point_at(0.5);
//! assert!((middle - Point3::new(12.5_f64.sqrt(), 12.5_f64.sqrt(), 1.0)).norm() < 1e-12);
//! ```

pub mod arc;
pub mod line;
pub mod parabola;

pub use arc::{Arc, ArcError, Direction};
pub use line::Line;
pub use parabola::{Parabola, ParabolaError};

use nalgebra::{Point3, Vector3};

/// One motion as geometry, with both ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Curve {
    Line(Line),
    Arc(Arc),
    Parabola(Parabola),
}

impl Curve {
    pub fn start(&self) -> Point3<f64> {
        match self {
            Curve::Line(line) => line.start,
            Curve::Arc(arc) => arc.start(),
            Curve::Parabola(parabola) => parabola.start(),
        }
    }

    pub fn end(&self) -> Point3<f64> {
        match self {
            Curve::Line(line) => line.end,
            Curve::Arc(arc) => arc.end(),
            Curve::Parabola(parabola) => parabola.end(),
        }
    }

    /// The length, mm; for an arc whose ends differ along its normal, that of the helix.
    pub fn length(&self) -> f64 {
        match self {
            Curve::Line(line) => line.length(),
            Curve::Arc(arc) => arc.length(),
            Curve::Parabola(parabola) => parabola.length(),
        }
    }

    /// Vectors along the curve at its start and its end, of any length; zero if the curve has no length.
    pub fn tangents(&self) -> [Vector3<f64>; 2] {
        match self {
            Curve::Line(line) => line.tangents(),
            Curve::Arc(arc) => arc.tangents(),
            Curve::Parabola(parabola) => parabola.tangents(),
        }
    }

    /// The point at the fraction `t` of the length, from 0 to 1.
    pub fn point_at(&self, t: f64) -> Point3<f64> {
        match self {
            Curve::Line(line) => line.point_at(t),
            Curve::Arc(arc) => arc.point_at(t),
            Curve::Parabola(parabola) => parabola.point_at(t),
        }
    }

    /// The distance from `p` to the nearest point of the curve, mm; for a helix an upper bound.
    pub fn distance_to(&self, p: &Point3<f64>) -> f64 {
        match self {
            Curve::Line(line) => line.distance_to(p),
            Curve::Arc(arc) => arc.distance_to(p),
            Curve::Parabola(parabola) => parabola.distance_to(p),
        }
    }

    /// The largest scalar product of `direction`, a vector of any length, with a point of the curve; mm for a
    /// unit vector.
    pub fn support(&self, direction: &Vector3<f64>) -> f64 {
        match self {
            Curve::Line(line) => line.support(direction),
            Curve::Arc(arc) => arc.support(direction),
            Curve::Parabola(parabola) => parabola.support(direction),
        }
    }
}

//! A grid of measured points, to be joined by a smooth surface.

use nalgebra::{Point3, Vector3};

/// How the mixed derivatives at the grid's points are chosen.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Twist {
    /// Those of the tensor-product cubic spline: the surface is C2.
    #[default]
    Spline,
    /// Zero, Koo et al. (1989) eq. 6: the surface is C1 across patches.
    Zero,
}

/// Boundary tangents for clamped ends, one vector for each boundary point: derivatives by the uniform
/// parameter that grows by one from point to point.
#[derive(Debug, Clone, PartialEq)]
pub struct EndTangents {
    /// Along the boundaries i = 0 and i = last; one vector for each j.
    pub u0: Vec<Vector3<f64>>,
    pub u1: Vec<Vector3<f64>>,
    /// Along the boundaries j = 0 and j = last; one vector for each i.
    pub v0: Vec<Vector3<f64>>,
    pub v1: Vec<Vector3<f64>>,
}

/// The end conditions of the cubic splines along both directions.
#[derive(Debug, Clone, PartialEq, Default)]
pub enum Ends {
    #[default]
    Natural,
    NotAKnot,
    Clamped(EndTangents),
    Bessel,
}

/// Points `points[i][j]`, i along u, with uniform parameters; mm.
#[derive(Debug, Clone, PartialEq)]
pub struct PointGrid {
    pub points: Vec<Vec<Point3<f64>>>,
    pub twist: Twist,
    pub ends: Ends,
}

/// Why a grid makes no surface.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum GridError {
    #[error("the grid has {rows} rows; at least 2 are needed")]
    TooFewRows { rows: usize },
    #[error("row {row} has {points} points; at least 2 are needed")]
    TooFewPoints { row: usize, points: usize },
    #[error("row {row} has {points} points where row 0 has {expected}")]
    Ragged { row: usize, points: usize, expected: usize },
    #[error("point [{i}][{j}] is not finite")]
    NotFinite { i: usize, j: usize },
    #[error("end tangents along {side} number {given}; there are {expected} boundary points")]
    EndTangents { side: &'static str, given: usize, expected: usize },
}

//! A smooth surface through a grid of measured points.
//!
//! # Method
//! 1. A cubic spline runs through every row of points (along v) and through every column (along u). These
//!    splines give the derivatives along u and v at every point.
//! 2. The twist is the mixed second derivative at a point. With [`Twist::Spline`], further cubic splines
//!    along v run through the derivatives along u, and their derivatives are the twists. With [`Twist::Zero`]
//!    every twist is zero.
//! 3. Each pair of neighbouring rows and columns makes a bicubic patch, from the points, derivatives and
//!    twists at its corners.
//!
//! # Guarantees
//! With [`Twist::Spline`] the surface has continuous second derivatives. With [`Twist::Zero`] only its first
//! derivatives are continuous. Points that coincide are accepted, even if the surface has no normal there.
//!
//! A direction is closed where its first and last points coincide, along the whole edge ([`CLOSED_MM`]).
//! Splines along it close smoothly, with two continuous derivatives across the seam, if the ends are
//! [`Ends::Periodic`]; and also with [`Ends::Usual`], if they bend no more at the seam than elsewhere.
//!
//! # Reference
//! Y. H. Koo, D. J. Lee, S. Namgung, M. S. Kang, "A Study on the Construction of CAD/CAM System for Machining
//! of Sculptured Surface of Die", 1989, section 3.1, eq. 1-7. The paper has only [`Twist::Zero`] (eq. 6), and
//! does not print the end conditions of its splines.

#[cfg(test)]
mod tests;

use nalgebra::{Point3, Vector3};

use super::bezier::BezierSurface;
use super::hermite::{self, Corner};
use crate::geometry::spline::{self, derivatives};

type EndCondition = spline::EndCondition<3>;

/// How the mixed derivatives at the points of the grid are chosen.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "wire", derive(serde::Deserialize, utoipa::ToSchema), serde(rename_all = "snake_case"))]
pub enum Twist {
    /// The mixed derivatives of the tensor-product cubic spline: the surface is C2.
    #[default]
    Spline,
    /// Zero, Koo et al. (1989) eq. 6: the surface is C1 across patches.
    Zero,
}

/// Boundary tangents for clamped ends, one vector for each boundary point. They are derivatives by the
/// uniform parameter, which grows by one from point to point; mm.
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
    /// For callers who did not choose the ends: periodic in a closed direction that bends no more at its seam
    /// than elsewhere, else the same as `NotAKnot`. Too few points for not-a-knot ends then give the
    /// interpolating polynomial without a warning.
    #[default]
    Usual,
    Natural,
    NotAKnot,
    Clamped(EndTangents),
    Bessel,
    /// Periodic in closed directions, at least one; the same as `Usual` in the other direction.
    Periodic,
}

/// Largest distance of the first and the last point of a row or column in a closed direction, mm. Surfaces of
/// programs coincide to their last decimal; the last point is kept, so the seam has a step of at most this.
pub const CLOSED_MM: f64 = 1e-6;

/// Least number of rows of a closed direction, the first counted twice.
const LEAST_CLOSED: usize = 4;

/// Bends at a seam, as cosines, may differ by rounding and noise from the sharpest bend elsewhere.
const SAME_BEND: f64 = 0.05;

/// Points `points[i][j]`, i along u, with uniform parameters; mm.
#[derive(Debug, Clone, PartialEq)]
pub struct PointGrid {
    pub points: Vec<Vec<Point3<f64>>>,
    pub twist: Twist,
    pub ends: Ends,
}

/// An edge of the surface: where u or v is at its start (0) or at its end (1).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Edge {
    U0,
    U1,
    V0,
    V1,
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
    #[error(
        "there are {given} end tangents along {edge:?} for {expected} boundary points; each boundary point needs one end tangent"
    )]
    EndTangents { edge: Edge, given: usize, expected: usize },
    #[error(
        "neither the first and last rows nor the first and last columns coincide: periodic ends need a closed grid"
    )]
    NotClosed,
    #[error("an end tangent along {edge:?} is not finite")]
    EndTangentNotFinite { edge: Edge },
}

impl PointGrid {
    /// The surface through the points.
    ///
    /// # Errors
    /// When the grid is smaller than 2 x 2 or ragged, a point is not finite, or end tangents are too few or
    /// too many.
    pub fn surface(&self) -> Result<BezierSurface, GridError> {
        let [rows, columns] = self.checked_size()?;
        let points: Vec<Vec<Vector3<f64>>> =
            self.points.iter().map(|row| row.iter().map(|p| p.coords).collect()).collect();
        let [along_u, along_v] = self.end_conditions();
        let du = transposed(&rowwise(&transposed(&points), &along_u));
        let dv = rowwise(&points, &along_v);
        let duv = match self.twist {
            Twist::Zero => vec![vec![Vector3::zeros(); columns]; rows],
            Twist::Spline => rowwise(&du, &self.twist_conditions(rows)),
        };
        Ok(hermite::surface([rows, columns], |i, j| Corner {
            point: points[i][j],
            du: du[i][j],
            dv: dv[i][j],
            duv: duv[i][j],
        }))
    }

    /// Numbers of points along u and v.
    fn checked_size(&self) -> Result<[usize; 2], GridError> {
        let rows = self.points.len();
        if rows < 2 {
            return Err(GridError::TooFewRows { rows });
        }
        let expected = self.points[0].len();
        for (row, line) in self.points.iter().enumerate() {
            let points = line.len();
            if points != expected {
                return Err(GridError::Ragged { row, points, expected });
            }
            if points < 2 {
                return Err(GridError::TooFewPoints { row, points });
            }
            if let Some(j) = line.iter().position(|p| !p.iter().all(|x| x.is_finite())) {
                return Err(GridError::NotFinite { i: row, j });
            }
        }
        if let Ends::Clamped(tangents) = &self.ends {
            let EndTangents { u0, u1, v0, v1 } = tangents;
            let along_u = [(Edge::U0, u0, expected), (Edge::U1, u1, expected)];
            for (edge, given, expected) in
                along_u.into_iter().chain([(Edge::V0, v0, rows), (Edge::V1, v1, rows)])
            {
                if given.len() != expected {
                    return Err(GridError::EndTangents { edge, given: given.len(), expected });
                }
                if !given.iter().flat_map(|t| t.iter()).all(|x| x.is_finite()) {
                    return Err(GridError::EndTangentNotFinite { edge });
                }
            }
        }
        if self.ends == Ends::Periodic && self.closed() == [false; 2] {
            return Err(GridError::NotClosed);
        }
        Ok([rows, expected])
    }

    /// Whether the grid is closed along u, where its first and last rows coincide, and along v, where its
    /// first and last columns do. Not for fewer than four rows or columns.
    pub fn closed(&self) -> [bool; 2] {
        let is_same = |a: &Point3<f64>, b: &Point3<f64>| (a - b).norm() <= CLOSED_MM;
        let rows = &self.points;
        let along_u = match rows.as_slice() {
            [first, .., last] if rows.len() >= LEAST_CLOSED => {
                first.iter().zip(last).all(|(a, b)| is_same(a, b))
            }
            _ => false,
        };
        let is_ring = |row: &Vec<Point3<f64>>| match row.as_slice() {
            [first, .., last] => row.len() >= LEAST_CLOSED && is_same(first, last),
            _ => false,
        };
        [along_u, rows.iter().all(is_ring)]
    }

    /// The directions whose splines are periodic.
    pub fn periodic(&self) -> [bool; 2] {
        let closed = self.closed();
        match self.ends {
            Ends::Periodic => closed,
            Ends::Usual => {
                let columns = || transposed(&self.points);
                [closed[0] && bends_on(&columns()), closed[1] && bends_on(&self.points)]
            }
            _ => [false; 2],
        }
    }

    /// The directions with fewer than the four points that `not_a_knot` needs, each with its number of
    /// points. Empty for other ends.
    pub fn reduced_ends(&self) -> Vec<(&'static str, usize)> {
        if self.ends != Ends::NotAKnot {
            return Vec::new();
        }
        let counts = [("u", self.points.len()), ("v", self.points.first().map_or(0, Vec::len))];
        counts.into_iter().filter(|(_, n)| *n < 4).collect()
    }

    /// The end conditions of the splines along u (by the index j) and along v (by the index i).
    fn end_conditions(&self) -> [Box<dyn Fn(usize) -> EndCondition + '_>; 2] {
        let of = |is_periodic: bool| -> Box<dyn Fn(usize) -> EndCondition + '_> {
            Box::new(move |_| if is_periodic { EndCondition::Periodic } else { EndCondition::NotAKnot })
        };
        match &self.ends {
            Ends::Natural => [Box::new(|_| EndCondition::Natural), Box::new(|_| EndCondition::Natural)],
            Ends::Usual | Ends::NotAKnot | Ends::Periodic => self.periodic().map(of),
            Ends::Bessel => [Box::new(|_| EndCondition::Bessel), Box::new(|_| EndCondition::Bessel)],
            Ends::Clamped(t) => [
                Box::new(|j| EndCondition::Clamped(t.u0[j], t.u1[j])),
                Box::new(|i| EndCondition::Clamped(t.v0[i], t.v1[i])),
            ],
        }
    }

    /// The end conditions for the splines along v through the derivatives Su. Clamped ends need the
    /// derivative along u of the given v tangents; a not-a-knot spline through the v tangents gives it. Then
    /// both orders of differentiation agree, and the surface is C2.
    fn twist_conditions(&self, rows: usize) -> Box<dyn Fn(usize) -> EndCondition + '_> {
        match &self.ends {
            Ends::Clamped(t) => {
                debug_assert_eq!(t.v0.len(), rows);
                let first = derivatives(&t.v0, EndCondition::NotAKnot);
                let last = derivatives(&t.v1, EndCondition::NotAKnot);
                Box::new(move |i| EndCondition::Clamped(first[i], last[i]))
            }
            _ => {
                let [_, along_v] = self.end_conditions();
                along_v
            }
        }
    }
}

/// Whether most closed rows bend no more at their seam than at their other points.
fn bends_on(rows: &[Vec<Point3<f64>>]) -> bool {
    let cosine = |a: Vector3<f64>, b: Vector3<f64>| {
        let lengths = a.norm() * b.norm();
        if lengths > 0.0 { a.dot(&b) / lengths } else { 1.0 }
    };
    let is_smooth = |row: &&Vec<Point3<f64>>| {
        let last = row.len() - 1;
        let seam = cosine(row[last] - row[last - 1], row[1] - row[0]);
        let bends = row.windows(3).map(|three| cosine(three[1] - three[0], three[2] - three[1]));
        seam >= bends.fold(1.0, f64::min) - SAME_BEND
    };
    2 * rows.iter().filter(is_smooth).count() > rows.len()
}

fn rowwise(values: &[Vec<Vector3<f64>>], ends: &dyn Fn(usize) -> EndCondition) -> Vec<Vec<Vector3<f64>>> {
    values.iter().enumerate().map(|(i, row)| derivatives(row, ends(i))).collect()
}

fn transposed<T: Copy>(values: &[Vec<T>]) -> Vec<Vec<T>> {
    (0..values[0].len()).map(|j| values.iter().map(|row| row[j]).collect()).collect()
}

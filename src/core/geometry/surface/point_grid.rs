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
//! # Reference
//! Y. H. Koo, D. J. Lee, S. Namgung, M. S. Kang, "A Study on the Construction of CAD/CAM System for Machining
//! of Sculptured Surface of Die", 1989, section 3.1, eq. 1-7. The paper has only [`Twist::Zero`] (eq. 6), and
//! does not print the end conditions of its splines.

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
    /// The same as `NotAKnot`, for callers who did not choose the ends. Too few points for not-a-knot ends
    /// then give the interpolating polynomial without a warning.
    #[default]
    Usual,
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
        Ok([rows, expected])
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
        match &self.ends {
            Ends::Natural => [Box::new(|_| EndCondition::Natural), Box::new(|_| EndCondition::Natural)],
            Ends::Usual | Ends::NotAKnot => {
                [Box::new(|_| EndCondition::NotAKnot), Box::new(|_| EndCondition::NotAKnot)]
            }
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

fn rowwise(values: &[Vec<Vector3<f64>>], ends: &dyn Fn(usize) -> EndCondition) -> Vec<Vec<Vector3<f64>>> {
    values.iter().enumerate().map(|(i, row)| derivatives(row, ends(i))).collect()
}

fn transposed(values: &[Vec<Vector3<f64>>]) -> Vec<Vec<Vector3<f64>>> {
    (0..values[0].len()).map(|j| values.iter().map(|row| row[j]).collect()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::surface::{Jet, Patch, Surface};
    use std::f64::consts::PI;

    fn wave(x: f64, y: f64) -> f64 {
        10.0 * (PI * x / 40.0).sin() * (PI * y / 40.0).cos()
    }

    fn wave_grid(n: usize, twist: Twist, ends: Ends) -> PointGrid {
        let at = |i: usize| 80.0 * i as f64 / (n - 1) as f64;
        let points =
            (0..n).map(|i| (0..n).map(|j| Point3::new(at(i), at(j), wave(at(i), at(j)))).collect()).collect();
        PointGrid { points, twist, ends }
    }

    fn largest_error(grid: &PointGrid) -> f64 {
        let surface = grid.surface().unwrap();
        let n = surface.spans()[0] as f64;
        let m = 400;
        let mut worst = 0.0f64;
        for a in 0..=m {
            for b in 0..=m {
                let p = surface.jet(n * a as f64 / m as f64, n * b as f64 / m as f64).point;
                worst = worst.max((p.z - wave(p.x, p.y)).abs());
            }
        }
        worst
    }

    /// Published fit errors of this surface, mm, for each twist and end condition.
    #[test]
    fn fit_errors_of_the_wave_match_the_published_figures() {
        for (n, twist, ends, known) in [
            (9, Twist::Zero, Ends::Natural, 0.333),
            (9, Twist::Spline, Ends::Natural, 0.328),
            (9, Twist::Spline, Ends::NotAKnot, 0.099),
            (60, Twist::Zero, Ends::Natural, 5.6e-3),
            (60, Twist::Spline, Ends::Natural, 5.6e-3),
            (60, Twist::Spline, Ends::NotAKnot, 3.6e-5),
        ] {
            let error = largest_error(&wave_grid(n, twist, ends.clone()));
            assert!((error / known - 1.0).abs() < 0.03, "{n} {twist:?} {ends:?}: {error}");
        }
    }

    fn clamped_ends(n: usize) -> Ends {
        let h = 80.0 / (n - 1) as f64;
        let w = PI / 40.0;
        let at = |i: usize| h * i as f64;
        let du = |x: f64, y: f64| Vector3::new(h, 0.0, h * 10.0 * w * (w * x).cos() * (w * y).cos());
        let dv = |x: f64, y: f64| Vector3::new(0.0, h, -h * 10.0 * w * (w * x).sin() * (w * y).sin());
        Ends::Clamped(EndTangents {
            u0: (0..n).map(|j| du(0.0, at(j))).collect(),
            u1: (0..n).map(|j| du(80.0, at(j))).collect(),
            v0: (0..n).map(|i| dv(at(i), 0.0)).collect(),
            v1: (0..n).map(|i| dv(at(i), 80.0)).collect(),
        })
    }

    #[test]
    fn true_end_tangents_beat_every_guess() {
        let error = largest_error(&wave_grid(9, Twist::Spline, clamped_ends(9)));
        assert!(error < 0.03, "{error}");
    }

    #[test]
    fn spline_twist_is_c2_and_zero_twist_c1_across_patches() {
        let jumps = |grid: &PointGrid| {
            let surface = grid.surface().unwrap();
            let [mut first, mut second] = [0.0f64; 2];
            let mut compare = |a: Jet, b: Jet| {
                first = first.max((a.du - b.du).norm()).max((a.dv - b.dv).norm());
                second = second.max((a.duu - b.duu).norm()).max((a.duv - b.duv).norm());
                second = second.max((a.dvv - b.dvv).norm());
            };
            for i in 1..surface.spans()[0] {
                for k in 0..40 {
                    let (j, t) = (k / 5, (k % 5) as f64 / 4.0);
                    compare(surface.patch(i - 1, j).jet(1.0, t), surface.patch(i, j).jet(0.0, t));
                    compare(surface.patch(j, i - 1).jet(t, 1.0), surface.patch(j, i).jet(t, 0.0));
                }
            }
            [first, second]
        };
        for ends in [Ends::Natural, Ends::NotAKnot, Ends::Bessel, clamped_ends(9)] {
            let [first, second] = jumps(&wave_grid(9, Twist::Spline, ends));
            assert!(first < 1e-12 && second < 1e-10, "{first} {second}");
        }
        let [first, second] = jumps(&wave_grid(9, Twist::Zero, Ends::Natural));
        assert!(first < 1e-12 && second > 0.1, "{first} {second}");
    }

    #[test]
    fn the_surface_passes_through_its_points() {
        let grid = wave_grid(7, Twist::Spline, Ends::Bessel);
        let surface = grid.surface().unwrap();
        for (i, row) in grid.points.iter().enumerate() {
            for (j, p) in row.iter().enumerate() {
                assert!((surface.jet(i as f64, j as f64).point - p).norm() < 1e-12);
            }
        }
    }

    #[test]
    fn a_broken_grid_is_refused_with_the_place_of_its_fault() {
        let p = Point3::origin();
        let grid =
            |points: Vec<Vec<Point3<f64>>>| PointGrid { points, twist: Twist::Spline, ends: Ends::Natural };
        assert_eq!(grid(vec![vec![p, p]]).surface(), Err(GridError::TooFewRows { rows: 1 }));
        assert_eq!(
            grid(vec![vec![p], vec![p]]).surface(),
            Err(GridError::TooFewPoints { row: 0, points: 1 })
        );
        assert_eq!(
            grid(vec![vec![p, p], vec![p, p, p]]).surface(),
            Err(GridError::Ragged { row: 1, points: 3, expected: 2 })
        );
        let bad = Point3::new(0.0, f64::NAN, 0.0);
        assert_eq!(grid(vec![vec![p, p], vec![p, bad]]).surface(), Err(GridError::NotFinite { i: 1, j: 1 }));
        let tangents = EndTangents { u0: vec![], u1: vec![], v0: vec![], v1: vec![] };
        let mut clamped = grid(vec![vec![p, p], vec![p, p]]);
        clamped.ends = Ends::Clamped(tangents);
        assert_eq!(clamped.surface(), Err(GridError::EndTangents { edge: Edge::U0, given: 0, expected: 2 }));
    }
}

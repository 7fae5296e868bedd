//! Ferguson's surface: points on a grid. Each point has a tangent along u, a tangent along v, and a twist
//! (the mixed second derivative).
//!
//! # Guarantees
//! The surface passes through its points with the given tangents. First derivatives are continuous across
//! patches, because neighbouring patches have the same data at their common corners.
//!
//! # Reference
//! J. C. Ferguson, "Multivariable Curve Interpolation", Journal of the ACM 11, 1964.

use std::fmt;

use nalgebra::{Point3, Vector3};

use super::bezier::BezierSurface;
use super::hermite::{self, Corner};

/// Points `points[i][j]`, i along u, with their derivatives; mm. The parameters u and v grow by one from
/// point to point.
#[derive(Debug, Clone, PartialEq)]
pub struct Ferguson {
    pub points: Vec<Vec<Point3<f64>>>,
    pub tangents_u: Vec<Vec<Vector3<f64>>>,
    pub tangents_v: Vec<Vec<Vector3<f64>>>,
    /// Mixed derivatives. `None` makes them zero, as in Ferguson's own patch.
    pub twists: Option<Vec<Vec<Vector3<f64>>>>,
}

/// One of the grids of the data.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Grid {
    Points,
    TangentsU,
    TangentsV,
    Twists,
}

impl fmt::Display for Grid {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Points => "the grid of points",
            Self::TangentsU => "the grid of tangents along u",
            Self::TangentsV => "the grid of tangents along v",
            Self::Twists => "the grid of twists",
        })
    }
}

/// Why the data make no surface.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum FergusonError {
    #[error("{grid} has {found} rows; {expected} are needed")]
    Rows { grid: Grid, found: usize, expected: usize },
    #[error("row {row} of {grid} has {found} entries; {expected} are needed")]
    Columns { grid: Grid, row: usize, found: usize, expected: usize },
    #[error("entry [{row}][{column}] of {grid} is not finite")]
    NotFinite { grid: Grid, row: usize, column: usize },
}

impl Ferguson {
    /// The surface with these points and derivatives.
    ///
    /// # Errors
    /// When there are fewer than 2 x 2 points, the grids differ in size, or a number is not finite.
    pub fn surface(&self) -> Result<BezierSurface, FergusonError> {
        let rows = self.points.len().max(2);
        let columns = self.points.first().map_or(2, Vec::len).max(2);
        let size = [rows, columns];
        check(Grid::Points, &self.points, size, |p| p.iter().all(|x| x.is_finite()))?;
        let vectors = [(Grid::TangentsU, &self.tangents_u), (Grid::TangentsV, &self.tangents_v)];
        let twists = self.twists.as_ref().map(|twists| (Grid::Twists, twists));
        for (grid, vectors) in vectors.into_iter().chain(twists) {
            check(grid, vectors, size, |v| v.iter().all(|x| x.is_finite()))?;
        }
        Ok(hermite::surface(size, |i, j| Corner {
            point: self.points[i][j].coords,
            du: self.tangents_u[i][j],
            dv: self.tangents_v[i][j],
            duv: self.twists.as_ref().map_or(Vector3::zeros(), |twists| twists[i][j]),
        }))
    }
}

fn check<T>(
    grid: Grid,
    values: &[Vec<T>],
    [rows, columns]: [usize; 2],
    is_finite: impl Fn(&T) -> bool,
) -> Result<(), FergusonError> {
    if values.len() != rows {
        return Err(FergusonError::Rows { grid, found: values.len(), expected: rows });
    }
    for (row, entries) in values.iter().enumerate() {
        if entries.len() != columns {
            return Err(FergusonError::Columns { grid, row, found: entries.len(), expected: columns });
        }
        if let Some(column) = entries.iter().position(|entry| !is_finite(entry)) {
            return Err(FergusonError::NotFinite { grid, row, column });
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::surface::{Patch, Surface};

    /// z = x^2 y on a grid of unit squares, with its own derivatives.
    fn exact() -> Ferguson {
        let grid = |f: &dyn Fn(f64, f64) -> [f64; 3]| -> Vec<Vec<[f64; 3]>> {
            (0..3).map(|i| (0..4).map(|j| f(i as f64, j as f64)).collect()).collect()
        };
        let vectors = |grid: Vec<Vec<[f64; 3]>>| {
            grid.into_iter().map(|row| row.into_iter().map(Vector3::from).collect()).collect::<Vec<Vec<_>>>()
        };
        Ferguson {
            points: (0..3)
                .map(|i| (0..4).map(|j| Point3::new(i as f64, j as f64, (i * i * j) as f64)).collect())
                .collect(),
            tangents_u: vectors(grid(&|x, y| [1.0, 0.0, 2.0 * x * y])),
            tangents_v: vectors(grid(&|x, _| [0.0, 1.0, x * x])),
            twists: Some(vectors(grid(&|x, _| [0.0, 0.0, 2.0 * x]))),
        }
    }

    #[test]
    fn a_cubic_surface_is_reproduced_exactly() {
        let surface = exact().surface().unwrap();
        for (u, v) in [(0.3, 0.1), (1.7, 2.4), (2.0, 3.0)] {
            let p = surface.jet(u, v).point;
            assert!((p - Point3::new(u, v, u * u * v)).norm() < 1e-14, "{p}");
        }
    }

    #[test]
    fn missing_twists_count_as_zero() {
        let mut data = exact();
        data.twists = None;
        let surface = data.surface().unwrap();
        assert!(surface.patch(1, 1).jet(0.0, 0.0).duv.norm() < 1e-12);
        assert!((surface.jet(1.0, 1.0).du - Vector3::new(1.0, 0.0, 2.0)).norm() < 1e-12);
    }

    #[test]
    fn a_broken_grid_is_refused_with_the_place_of_its_fault() {
        let mut data = exact();
        data.tangents_v[1].pop();
        let expected = FergusonError::Columns { grid: Grid::TangentsV, row: 1, found: 3, expected: 4 };
        assert_eq!(data.surface(), Err(expected));
        let mut data = exact();
        data.twists = Some(vec![]);
        assert_eq!(data.surface(), Err(FergusonError::Rows { grid: Grid::Twists, found: 0, expected: 3 }));
        let mut data = exact();
        data.points[2][3].y = f64::NAN;
        assert_eq!(data.surface(), Err(FergusonError::NotFinite { grid: Grid::Points, row: 2, column: 3 }));
        let mut data = exact();
        data.points.truncate(1);
        assert_eq!(data.surface(), Err(FergusonError::Rows { grid: Grid::Points, found: 1, expected: 2 }));
    }
}

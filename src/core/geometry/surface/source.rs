//! The kinds of data that surfaces are made from.

use nalgebra::Point3;

use super::any_surface::AnySurface;
use super::ferguson::{Ferguson, FergusonError};
use super::net_grid::{NetGrid, NetGridError};
use super::normal_sweep::{NormalSweep, NormalSweepError};
use super::nurbs::{Nurbs, NurbsError};
use super::parallel_sweep::{ParallelSweep, ParallelSweepError};
use super::point_grid::{GridError, PointGrid};
use super::ruled::{Ruled, RuledError};

/// The data of a surface, one variant for each kind.
///
/// # Example
/// Four points of z = x y make this surface exactly.
///
/// ```
/// use nalgebra::{Point3, Vector2};
/// use toolpathd_core::geometry::surface::Surface;
/// use toolpathd_core::geometry::surface::any_surface::AnySurface;
/// use toolpathd_core::geometry::surface::point_grid::{Ends, PointGrid, Twist};
/// use toolpathd_core::geometry::surface::source::Source;
///
/// let points = [0.0, 1.0].map(|x| [0.0, 1.0].map(|y| Point3::new(x, y, x * y)).to_vec()).to_vec();
/// let grid = PointGrid { points, twist: Twist::Spline, ends: Ends::Usual };
/// let source = Source::PointGrid(grid);
/// let AnySurface::Bicubic(surface) = source.surface().unwrap() else { panic!("cubic splines") };
/// let jet = surface.jet(0.5, 0.25);
/// assert!((jet.point - Point3::new(0.5, 0.25, 0.125)).norm() < 1e-15);
/// assert!((jet.gradient() - Vector2::new(0.25, 0.5)).norm() < 1e-15);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub enum Source {
    PointGrid(PointGrid),
    Ferguson(Ferguson),
    NetGrid(NetGrid),
    Nurbs(Nurbs),
    ParallelSweep(ParallelSweep),
    NormalSweep(NormalSweep),
    Ruled(Ruled),
}

/// Why the data make no surface.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum SourceError {
    #[error(transparent)]
    PointGrid(#[from] GridError),
    #[error(transparent)]
    Ferguson(#[from] FergusonError),
    #[error(transparent)]
    NetGrid(#[from] NetGridError),
    #[error(transparent)]
    Nurbs(#[from] NurbsError),
    #[error(transparent)]
    ParallelSweep(#[from] ParallelSweepError),
    #[error(transparent)]
    NormalSweep(#[from] NormalSweepError),
    #[error(transparent)]
    Ruled(#[from] RuledError),
}

impl Source {
    /// The surface of the data.
    ///
    /// # Errors
    /// When the data make no surface.
    pub fn surface(&self) -> Result<AnySurface, SourceError> {
        Ok(match self {
            Self::PointGrid(grid) => AnySurface::Bicubic(grid.surface()?),
            Self::Ferguson(ferguson) => AnySurface::Bicubic(ferguson.surface()?),
            Self::NetGrid(grid) => AnySurface::Bicubic(grid.surface()?),
            Self::Nurbs(nurbs) => nurbs.surface()?,
            Self::ParallelSweep(sweep) => sweep.surface()?,
            Self::NormalSweep(sweep) => sweep.surface()?,
            Self::Ruled(ruled) => ruled.surface()?,
        })
    }

    /// The points that the surface passes through; `None` for kinds of data without such points.
    pub fn nodes(&self) -> Option<&[Vec<Point3<f64>>]> {
        match self {
            Self::PointGrid(grid) => Some(&grid.points),
            Self::Ferguson(ferguson) => Some(&ferguson.points),
            Self::NetGrid(_)
            | Self::Nurbs(_)
            | Self::ParallelSweep(_)
            | Self::NormalSweep(_)
            | Self::Ruled(_) => None,
        }
    }

    /// The directions with fewer than the four points that `not_a_knot` needs, each with its number of
    /// points.
    pub fn reduced_ends(&self) -> Vec<(&'static str, usize)> {
        match self {
            Self::PointGrid(grid) => grid.reduced_ends(),
            Self::Ferguson(_)
            | Self::NetGrid(_)
            | Self::Nurbs(_)
            | Self::ParallelSweep(_)
            | Self::NormalSweep(_)
            | Self::Ruled(_) => Vec::new(),
        }
    }

    /// The joints that the kind of data does not make smooth by itself. Each joint is given by the number of
    /// patches before it, along u and along v.
    pub fn loose_joints(&self) -> [Vec<usize>; 2] {
        match self {
            Self::PointGrid(_) | Self::Ferguson(_) => [Vec::new(), Vec::new()],
            Self::NetGrid(NetGrid { nets }) => {
                [(1..nets.len()).collect(), (1..nets.first().map_or(0, Vec::len)).collect()]
            }
            Self::Nurbs(nurbs) => nurbs.loose_joints(),
            Self::ParallelSweep(sweep) => sweep.loose_joints(),
            Self::NormalSweep(sweep) => sweep.loose_joints(),
            Self::Ruled(ruled) => ruled.loose_joints(),
        }
    }
}

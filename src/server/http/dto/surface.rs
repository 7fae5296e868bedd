//! Surfaces in requests. Each kind has a file of its own.

mod bezier_patches;
mod ferguson;
mod file;
mod grid;
mod normal_sweep;
pub mod nurbs;
mod parallel_sweep;
mod point_grid;
mod ruled;
mod section_text;

use nalgebra::Point3;

use super::check::Violations;
use super::point::Point;
use crate::config::Limits;
use crate::http::decode::files::FileReading;
use crate::http::decode::tagged::by_kind;
use crate::http::error::FieldCode;
use crate::http::messages::Warning;
use crate::http::pointer::Pointer;
pub use bezier_patches::BezierPatches;
pub use ferguson::Ferguson;
pub use file::SurfaceFile;
pub use normal_sweep::NormalSweep;
pub use nurbs::Nurbs;
pub use parallel_sweep::ParallelSweep;
pub use point_grid::PointGrid;
pub use ruled::Ruled;
pub use section_text::{Room, SectionText};
use toolpathd_core::geometry::surface::source::Source;

by_kind! {
    /// The surface of the part, given in one of several kinds; `kind` says which. The cutter works on the +z
    /// side of the surface, whatever the order of the surface's parameters.
    #[derive(Debug)]
    Surface {
        "point_grid" => PointGrid(PointGrid),
        "ferguson" => Ferguson(Ferguson),
        "bezier_patches" => BezierPatches(BezierPatches),
        "nurbs" => Nurbs(Nurbs),
        "parallel_sweep" => ParallelSweep(ParallelSweep),
        "normal_sweep" => NormalSweep(NormalSweep),
        "ruled" => Ruled(Ruled),
        "file" => File(SurfaceFile),
    }
}

impl Surface {
    /// Puts the surface that a file holds in the place of the reference to the file.
    pub fn read_file(&mut self, at: &Pointer, reading: &mut FileReading) {
        if let Self::File(file) = self
            && let Some(surface) = file.surface(at, reading)
        {
            reading.moved(at.clone(), at.clone(), Some(file.file_name()));
            *self = surface;
        }
    }

    /// Puts right in the data what is unambiguous, and tells what.
    pub fn put_right(&mut self, limits: &Limits) -> Vec<Warning> {
        match self {
            Self::PointGrid(grid) => grid.put_right(limits),
            _ => Vec::new(),
        }
    }

    /// Collects the violations of the surface at `at`.
    pub fn check(&self, at: &Pointer, limits: &Limits, violations: &mut Violations) {
        match self {
            Self::PointGrid(grid) => grid.check(at, limits, violations),
            Self::Ferguson(ferguson) => ferguson.check(at, limits, violations),
            Self::BezierPatches(patches) => patches.check(at, limits, violations),
            Self::Nurbs(nurbs) => nurbs.check(at, limits, violations),
            Self::ParallelSweep(sweep) => sweep.check(at, limits, violations),
            Self::NormalSweep(sweep) => sweep.check(at, limits, violations),
            Self::Ruled(ruled) => ruled.check(at, limits, violations),
            Self::File(_) => {
                violations.add(at, FieldCode::Unsupported, "no file is read here: send the surface itself");
            }
        }
    }

    /// Two corners of a box: around the given points of the surface, or, for sweeps and ruled surfaces,
    /// around the places that their curves reach.
    pub fn bounds(&self) -> (Point3<f64>, Point3<f64>) {
        match self {
            Self::PointGrid(grid) => bounds(grid.points()),
            Self::Ferguson(ferguson) => bounds(ferguson.points()),
            Self::BezierPatches(patches) => bounds(patches.points()),
            Self::Nurbs(nurbs) => bounds(nurbs.points()),
            Self::ParallelSweep(sweep) => sweep.bounds(),
            Self::NormalSweep(sweep) => sweep.bounds(),
            Self::Ruled(ruled) => ruled.bounds(),
            Self::File(_) => bounds(std::iter::empty()),
        }
    }
}

fn bounds<'a>(points: impl Iterator<Item = &'a Point>) -> (Point3<f64>, Point3<f64>) {
    let empty = (Point3::from([f64::INFINITY; 3]), Point3::from([f64::NEG_INFINITY; 3]));
    points.fold(empty, |(low, high), &point| {
        let point: Point3<f64> = point.into();
        (low.inf(&point), high.sup(&point))
    })
}

/// Converts a surface that has been checked.
impl From<Surface> for Source {
    fn from(surface: Surface) -> Self {
        match surface {
            Surface::PointGrid(grid) => Self::PointGrid(grid.into()),
            Surface::Ferguson(ferguson) => Self::Ferguson(ferguson.into()),
            Surface::BezierPatches(patches) => Self::NetGrid(patches.into()),
            Surface::Nurbs(nurbs) => Self::Nurbs(nurbs.into()),
            Surface::ParallelSweep(sweep) => Self::ParallelSweep(sweep.into()),
            Surface::NormalSweep(sweep) => Self::NormalSweep(sweep.into()),
            Surface::Ruled(ruled) => Self::Ruled(ruled.into()),
            // Checks refuse a file that was not read.
            Surface::File(_) => Self::PointGrid(PointGrid::of_points(Vec::new()).into()),
        }
    }
}

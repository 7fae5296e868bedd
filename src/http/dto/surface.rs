//! Surfaces as they are sent, a file for each kind.

mod bezier_patches;
mod failure;
mod ferguson;
mod grid;
mod grid_order;
mod normal_sweep;
pub mod nurbs;
mod parallel_sweep;
mod point_grid;
mod ruled;
mod section_text;

use nalgebra::Point3;
use serde::{Deserialize, Deserializer};
use serde_json::value::RawValue;
use utoipa::ToSchema;

use super::check::Violations;
use super::point::Point;
use super::tagged;
use crate::config::Limits;
use crate::geometry::surface::source::Source;
use crate::http::pointer::Pointer;
pub use bezier_patches::BezierPatches;
pub use ferguson::Ferguson;
pub use normal_sweep::NormalSweep;
pub use nurbs::Nurbs;
pub use parallel_sweep::ParallelSweep;
pub use point_grid::PointGrid;
pub use ruled::Ruled;

/// A surface, told apart by `kind`. The cutter is on its +z side, whatever the order of its parameters.
#[derive(Debug, ToSchema)]
#[serde(untagged)]
pub enum Surface {
    PointGrid(PointGrid),
    Ferguson(Ferguson),
    BezierPatches(BezierPatches),
    Nurbs(Nurbs),
    ParallelSweep(ParallelSweep),
    NormalSweep(NormalSweep),
    Ruled(Ruled),
}

const KINDS: [&str; 7] =
    ["point_grid", "ferguson", "bezier_patches", "nurbs", "parallel_sweep", "normal_sweep", "ruled"];

impl<'de> Deserialize<'de> for Surface {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let object = <&RawValue>::deserialize(deserializer)?;
        match tagged::kind_of::<D::Error>(object)?.as_str() {
            "point_grid" => tagged::decode(object).map(Self::PointGrid),
            "ferguson" => tagged::decode(object).map(Self::Ferguson),
            "bezier_patches" => tagged::decode(object).map(Self::BezierPatches),
            "nurbs" => tagged::decode(object).map(Self::Nurbs),
            "parallel_sweep" => tagged::decode(object).map(Self::ParallelSweep),
            "normal_sweep" => tagged::decode(object).map(Self::NormalSweep),
            "ruled" => tagged::decode(object).map(Self::Ruled),
            other => Err(tagged::unknown(other, &[], &KINDS)),
        }
    }
}

impl Surface {
    /// Collects what is wrong with the surface at `at`.
    pub fn check(&self, at: &Pointer, limits: &Limits, violations: &mut Violations) {
        match self {
            Self::PointGrid(grid) => grid.check(at, limits, violations),
            Self::Ferguson(ferguson) => ferguson.check(at, limits, violations),
            Self::BezierPatches(patches) => patches.check(at, limits, violations),
            Self::Nurbs(nurbs) => nurbs.check(at, limits, violations),
            Self::ParallelSweep(sweep) => sweep.check(at, limits, violations),
            Self::NormalSweep(sweep) => sweep.check(at, limits, violations),
            Self::Ruled(ruled) => ruled.check(at, limits, violations),
        }
    }

    /// The corners of the box around the points that the surface is given by, of a sweep around where these come to.
    pub fn bounds(&self) -> (Point3<f64>, Point3<f64>) {
        match self {
            Self::PointGrid(grid) => bounds(grid.points()),
            Self::Ferguson(ferguson) => bounds(ferguson.points()),
            Self::BezierPatches(patches) => bounds(patches.points()),
            Self::Nurbs(nurbs) => bounds(nurbs.points()),
            Self::ParallelSweep(sweep) => sweep.bounds(),
            Self::NormalSweep(sweep) => sweep.bounds(),
            Self::Ruled(ruled) => ruled.bounds(),
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

/// Converts what has been checked.
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
        }
    }
}

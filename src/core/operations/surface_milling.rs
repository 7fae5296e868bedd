//! Mills a surface in passes along parallel planes. Finishing (CL-Cartesian machining) is described here.
//! Roughing is described in `wire_union`.
//!
//! # Method
//! 1. Choose parallel planes at equal distances (`planes`).
//! 2. In each plane, find the CL curves: the curves that the tip follows while the cutter touches the
//!    surface. There are two engines. `offset_section` traces sections of the offset surface, for ball
//!    cutters only. `contact` drops a cutter of any shape onto the surface.
//! 3. Fit lines and arcs to the CL curves, which makes the passes (`passes`). Join the passes (`links`,
//!    `entries`).
//! 4. Prove how much the passes leave (`leftover`). If this is more than the scallop height that is asked
//!    for, repeat the method from item 1 with planes closer together.
//! 5. Prove how deep the cutter cuts into the surface on every move (`certificate`).
//!
//! # Guarantees
//! * `deviation_max_mm` bounds the distance of the passes from the exact CL curves, both ways and in order:
//!   each place of a pass is compared with the CL curve at its own place along the pass.
//! * `gouge_max_mm` bounds how deep the cutter or its shank enters the surface on any move.
//! * No point of the part is farther from the material that the passes remove than the larger of
//!   `scallop_max_mm` and `rest_max_mm` ([`uncut`](crate::machining::uncut)). The first counts places that
//!   the cutter can reach, the second all others. Near a place that the cutter cannot reach, a place that it
//!   can reach may count as rest. With an allowance both are estimates.
//!
//! The bounds hold for the path as computed and as the program states it. A path is
//! refused if its bound of the deviation exceeds the tolerance. The allowance is a layer of material that has
//! to stay on the surface. A path is also refused if the cutter may cut into this layer by more than the
//! tolerance, measured from the top of the layer.
//!
//! # Cost
//! O(n log m) for n CL points and m patches. For ball cutters, the cost of `regularity` comes on top. A
//! scallop height takes up to five trials of the passes.
//!
//! # Reference
//! S. Y. Ju, "CL-Cartesian Machining along Approximated Circular Arcs".

mod certificate;
mod cl_cartesian;
mod counts;
mod deviation;
mod entries;
mod job;
mod leftover;
mod links;
mod outline;
mod passes;
mod planes;
mod rest;
mod scallop;
mod wire_union;

use nalgebra::{Point3, Vector3};

use crate::budget::{Budget, Stopped};
use crate::geometry::surface::any_surface::AnySurface;
use crate::geometry::surface::joints::NotSmooth;
use crate::geometry::surface::source::SourceError;
use crate::geometry::surface::{BezierSurface, Patch};
use crate::machining::offset_section::SectionError;
use crate::machining::regularity::Irregular;
use crate::toolpath::cutting::{Cutting, HeightError};
use crate::toolpath::program::Blank;
use crate::toolpath::quantize::QuantizeError;
use crate::toolpath::units::rounded_up;
use crate::toolpath::{PathError, Toolpath};
pub use counts::PassElements;
pub use job::{
    Boundary, CutDirection, DEFAULT_MOVE_LIMIT, DEFAULT_PLANE_LIMIT, DEFAULT_POINT_LIMIT, Engine, Entry,
    Exit, Interpolation, Job, SectionPlane, Spacing, Stock,
};
pub use wire_union::MOST_COMPARED;

/// The smallest tolerance that a job may ask for, in steps of the last decimal. Rounding alone may move a
/// path by this much.
pub const LEAST_TOLERANCE_STEPS: f64 = 1.5;

/// The share of the tolerance by which the certificate's bound may exceed the deepest penetration found.
/// Passes have the rest of the tolerance.
const CERTIFICATE_GAP: f64 = 0.02;

const TOP_ACCURACY_MM: f64 = 1e-6;

/// What the passes are like, with the proved distances.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, utoipa::ToSchema), schema(as = MillReport))]
pub struct Report {
    /// Number of passes.
    pub n_passes: usize,
    /// Number of CL points.
    pub n_cl_points: usize,
    /// Distance of neighbouring planes or wires as cut, in mm.
    pub stepover_mm: f64,
    /// Proved largest distance between the exact path and the written path, in mm, measured from each to the
    /// other and in order: each place is compared with the other path at the same place along the pass.
    pub deviation_max_mm: f64,
    /// Proved largest depth to which the cutter cuts into the finished surface, in mm.
    pub gouge_max_mm: f64,
    /// Where the deepest cut into the surface was found, in mm. `null` where no cut was found; `gouge_max_mm`
    /// may be above 0 nevertheless, because it is a bound.
    #[cfg_attr(feature = "wire", schema(value_type = Option<crate::wire::Place>, required))]
    pub gouge_at: Option<Point3<f64>>,
    /// Largest distance, in mm, from the finished surface to the material that the passes remove, at places
    /// that the cutter can reach. This is the height of the scallops, or of what stays where no pass leads.
    /// It is proved that no place has more left than the larger of `scallop_max_mm` and `rest_max_mm`. Near
    /// a place that the cutter cannot reach, a place that it can reach may count as rest. With an allowance,
    /// the distance counts from the top of the layer that stays, and is an estimate. `null` with
    /// `wire_union`.
    #[cfg_attr(feature = "wire", schema(required))]
    pub scallop_max_mm: Option<f64>,
    /// Where `scallop_max_mm` was found, in mm. `null` where nothing was found.
    #[cfg_attr(feature = "wire", schema(value_type = Option<crate::wire::Place>, required))]
    pub scallop_at: Option<Point3<f64>>,
    /// Largest distance, in mm, from the finished surface to the material that the passes remove, at places
    /// that the cutter cannot reach, proved as `scallop_max_mm` is: the depth of what stays in corners,
    /// grooves and valleys narrower than the cutter, and beside the outline with `boundary: inside`. Rest
    /// much thinner than `scallop_max_mm` counts as scallop. `null` with `wire_union`.
    #[cfg_attr(feature = "wire", schema(required))]
    pub rest_max_mm: Option<f64>,
    /// Where `rest_max_mm` was found, in mm. `null` where there is no rest.
    #[cfg_attr(feature = "wire", schema(value_type = Option<crate::wire::Place>, required))]
    pub rest_at: Option<Point3<f64>>,
    /// Number of arcs.
    pub n_arcs: usize,
    /// Number of lines.
    pub n_lines: usize,
    /// The elements of each pass, in the order of cutting.
    pub elements_per_pass: Vec<PassElements>,
}

/// Something the caller should know that does not stop the job.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Warning {
    #[error("not-a-knot ends need 4 points along {direction}; there are {points}")]
    EndsReduced { direction: &'static str, points: usize },
    #[error("the cutter cannot reach all of the surface: up to {:.4} mm stay near ({:.3}, {:.3}, {:.3})", rounded_up(*depth_mm), at.x, at.y, at.z)]
    RestLeft { depth_mm: f64, at: Point3<f64> },
    #[error("the passes leave a strip: up to {:.4} mm stay near ({:.3}, {:.3}, {:.3}), far more than between neighbouring passes", rounded_up(*depth_mm), at.x, at.y, at.z)]
    StripLeft { depth_mm: f64, at: Point3<f64> },
    #[error("{count} pieces of passes are shorter than a tenth of the cutter's radius and left out, and their material stays; the longest is {:.4} mm, near ({:.3}, {:.3}, {:.3})", rounded_up(*longest_mm), at.x, at.y, at.z)]
    ShortPiecesLeftOut { count: usize, longest_mm: f64, at: Point3<f64> },
    #[error("the part is smaller than the cutter along x and along y: check that the points are in mm")]
    PartSmallerThanCutter,
    #[error("no stock is given: rapids come down to {approach_mm} mm above the surface")]
    StockNotGiven { approach_mm: f64 },
    #[error("{count} entries and exits have no room: there the cutter goes straight down or up")]
    EntryNotClear { count: usize },
    #[error("the path is for roughing and cuts up to {:.4} mm into the surface", rounded_up(*depth_mm))]
    RoughingPathGouges { depth_mm: f64 },
}

#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    pub toolpath: Toolpath,
    /// For each cutting move of the toolpath, in their order, the proved bound of its deviation, mm.
    pub deviations_mm: Vec<f64>,
    pub report: Report,
    /// The conditions with every default filled in.
    pub cutting: Cutting,
    pub warnings: Vec<Warning>,
}

#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum Error {
    #[error(transparent)]
    Stopped(#[from] Stopped),
    #[error(transparent)]
    Source(#[from] SourceError),
    #[error("sections of the offset surface are known for ball cutters only")]
    NoBall,
    #[error(transparent)]
    NotSmooth(NotSmooth),
    #[error("the surface cannot be continued past its edges because it has no tangent across one edge")]
    NoWayPast,
    #[error("the surface is vertical, overhangs or has no normal near {at}")]
    Overhang { at: Point3<f64> },
    #[error("the cutter does not fit the surface near {at}, where its offset folds or nearly folds")]
    OffsetFolds { at: Point3<f64> },
    #[error(transparent)]
    Heights(#[from] HeightError),
    #[error(
        "the tolerance {tolerance_mm} mm is too small for {decimals} decimals; use at least {least_mm:.6} mm, or more decimals"
    )]
    ToleranceBelowResolution { tolerance_mm: f64, decimals: u8, least_mm: f64 },
    #[error(
        "the tolerance {tolerance_mm} mm could not be proved; near {at} the proved bound is {deviation_mm} mm; try a larger tolerance"
    )]
    ToleranceNotReached { tolerance_mm: f64, deviation_mm: f64, at: Point3<f64> },
    #[error(
        "the job needs {needed} {what}; at most {limit} are allowed; use a larger spacing of passes or a larger tolerance"
    )]
    TooMuchWork { what: &'static str, needed: usize, limit: usize },
    #[error(
        "the job needs more than {limit} CL points, the most that are allowed; use a larger step length, spacing of passes or tolerance"
    )]
    TooManyPoints { limit: usize },
    #[error("passes in these planes leave at least {least_mm:.4} mm, where {asked_mm} mm are asked for")]
    ScallopNotReached { asked_mm: f64, least_mm: f64, at: Option<Point3<f64>> },
    #[error(
        "no section of the surface is long enough to cut; the part is too small or the boundary leaves nothing"
    )]
    NothingToCut,
    #[error("a section of the surface could not be traced near {at}; try another spacing of passes")]
    SectionLost { at: Point3<f64> },
    #[error(transparent)]
    Quantize(#[from] QuantizeError),
    #[error(transparent)]
    Path(#[from] PathError),
}

impl Error {
    /// Whether a path along sections of the offset may fail so where another part of the surface is in the
    /// way of the cutter, or where a wall is so steep that its sections have no end.
    fn is_obstacle(&self) -> bool {
        matches!(
            self,
            Self::ToleranceNotReached { .. }
                | Self::SectionLost { .. }
                | Self::TooMuchWork { .. }
                | Self::ScallopNotReached { .. }
        )
    }
}

impl From<NotSmooth> for Error {
    fn from(error: NotSmooth) -> Self {
        match error {
            NotSmooth::Stopped(stopped) => Self::Stopped(stopped),
            other => Self::NotSmooth(other),
        }
    }
}

impl From<Irregular> for Error {
    fn from(irregular: Irregular) -> Self {
        match irregular {
            Irregular::Stopped(stopped) => Self::Stopped(stopped),
            Irregular::Overhang { at } => Self::Overhang { at },
            Irregular::Folds { at } => Self::OffsetFolds { at },
        }
    }
}

impl From<SectionError> for Error {
    fn from(error: SectionError) -> Self {
        match error {
            SectionError::Stopped(stopped) => Self::Stopped(stopped),
            SectionError::Lost { at } => Self::SectionLost { at },
            SectionError::TooManyPoints { limit } => {
                Self::TooMuchWork { what: "CL points in one section", needed: limit + 1, limit }
            }
        }
    }
}

/// Plans the toolpath.
///
/// # Errors
/// One of [`Error`]; no toolpath is returned with one.
///
/// # Example
/// On a level plane, passes of a ball of radius 5 mm leave scallops of at most 0.01 mm if they are at most
/// 2 sqrt(2 * 5 * 0.01 - 0.01^2) mm apart.
///
/// ```
/// use nalgebra::Point3;
/// use toolpathd_core::budget::Budget;
/// use toolpathd_core::geometry::surface::point_grid::{Ends, PointGrid, Twist};
/// use toolpathd_core::geometry::surface::source::Source;
/// use toolpathd_core::operations::surface_milling::{Job, Spacing, plan};
/// use toolpathd_core::toolpath::tool::Tool;
/// use toolpathd_core::toolpath::units::{FeedRate, Tolerance};
///
/// let points = [0.0, 20.0].map(|x| [0.0, 20.0].map(|y| Point3::new(x, y, 0.0)).to_vec()).to_vec();
/// let grid = PointGrid { points, twist: Twist::Spline, ends: Ends::Usual };
/// let surface = Source::PointGrid(grid);
/// let tolerance = Tolerance::from_mm(0.01).unwrap();
/// let feed = FeedRate::from_mm_per_min(1000.0).unwrap();
/// let spacing = Spacing::ScallopHeight(0.01);
/// let job = Job { spacing, ..Job::new(surface, Tool::ball(5.0), 1.0, tolerance, feed) };
/// let report = plan(&job, &Budget::unlimited()).unwrap().report;
/// assert!(report.stepover_mm <= 2.0 * (0.1_f64 - 0.0001).sqrt());
/// assert!(report.scallop_max_mm.unwrap() <= 0.01);
/// ```
pub fn plan(job: &Job, budget: &Budget) -> Result<Plan, Error> {
    let step_mm = job.resolution.step_mm();
    let least_mm = LEAST_TOLERANCE_STEPS * step_mm;
    if job.tolerance.mm() < least_mm {
        let decimals = job.resolution.decimals;
        return Err(Error::ToleranceBelowResolution { tolerance_mm: job.tolerance.mm(), decimals, least_mm });
    }
    match job.surface.surface()? {
        AnySurface::Bicubic(surface) => plan_on(surface, job, budget),
        AnySurface::Rational(surface) => plan_on(surface, job, budget),
        AnySurface::HighDegree(surface) => plan_on(surface, job, budget),
    }
}

/// How far the box of the raw part reaches below the surface, mm. Without this floor, a picture of the
/// control would show holes where the surface is lowest.
const FLOOR_MM: f64 = 1.0;

/// The box around the surface and the stock over it. `None` without stock.
///
/// # Errors
/// When the data make no surface, and the budget's stop.
pub fn blank(job: &Job, budget: &Budget) -> Result<Option<Blank>, Error> {
    match job.surface.surface()? {
        AnySurface::Bicubic(surface) => blank_of(&surface, job, budget),
        AnySurface::Rational(surface) => blank_of(&surface, job, budget),
        AnySurface::HighDegree(surface) => blank_of(&surface, job, budget),
    }
}

/// The highest place of the part with its allowance and its stock, mm.
///
/// # Errors
/// When the data make no surface, and the budget's stop.
pub fn highest_mm(job: &Job, budget: &Budget) -> Result<f64, Error> {
    let (up, accuracy_mm) = (Vector3::z(), job.resolution.step_mm());
    let surface_mm = match job.surface.surface()? {
        AnySurface::Bicubic(surface) => surface.farthest_along(&up, accuracy_mm, budget),
        AnySurface::Rational(surface) => surface.farthest_along(&up, accuracy_mm, budget),
        AnySurface::HighDegree(surface) => surface.farthest_along(&up, accuracy_mm, budget),
    }?;
    Ok(job.top(surface_mm))
}

fn blank_of<P: Patch>(
    surface: &BezierSurface<P>,
    job: &Job,
    budget: &Budget,
) -> Result<Option<Blank>, Error> {
    let Some(stock) = job.stock else { return Ok(None) };
    let farthest = |along: Vector3<f64>| surface.farthest_along(&along, job.resolution.step_mm(), budget);
    let [x, y, z] = [Vector3::x(), Vector3::y(), Vector3::z()];
    let high = Point3::new(farthest(x)?, farthest(y)?, farthest(z)?);
    let low = Point3::new(-farthest(-x)?, -farthest(-y)?, -farthest(-z)?);
    // A block is known by its top alone; a layer stands on all sides.
    let across = match stock {
        Stock::Block { .. } => 0.0,
        Stock::OnSurface { thickness_mm } => job.allowance_mm + thickness_mm,
    };
    let across = Vector3::new(across, across, 0.0);
    let high = Point3::new(high.x, high.y, job.top(high.z));
    Ok(Some(Blank { low: low - across - z * FLOOR_MM, high: high + across }))
}

fn plan_on<P: Patch>(surface: BezierSurface<P>, job: &Job, budget: &Budget) -> Result<Plan, Error> {
    match job.spacing {
        Spacing::WirePitch(pitch_mm) => wire_union::plan(&surface, job, pitch_mm, budget),
        Spacing::Stepover(_) | Spacing::ScallopHeight(_) => cl_cartesian::plan(surface, job, budget),
    }
}

/// Warnings that follow from the data of the surface alone.
fn data_warnings(job: &Job) -> Vec<Warning> {
    let reduced = job.surface.reduced_ends().into_iter();
    reduced.map(|(direction, points)| Warning::EndsReduced { direction, points }).collect()
}

//! Finishing a surface along parallel plane sections.

use nalgebra::Point3;

use crate::budget::{Budget, Stopped};
use crate::geometry::surface::point_grid::{GridError, PointGrid};
use crate::toolpath::Toolpath;
use crate::toolpath::program::Resolution;
use crate::toolpath::tool::{Coolant, Cutting, Tool};
use crate::toolpath::units::{FeedRate, Tolerance};

/// The planes of the sections: zx at constant y, yz at constant x.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum SectionPlane {
    #[default]
    Zx,
    Yz,
}

/// The order in which the sections are cut.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum CutDirection {
    OneWay,
    #[default]
    Zigzag,
}

/// What the CL points are joined by.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Interpolation {
    #[default]
    Arcs,
    Lines,
}

/// Cutting conditions; what is absent is chosen from the part.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CuttingRequest {
    pub feed: FeedRate,
    /// Default: half the feed.
    pub plunge_feed: Option<FeedRate>,
    pub rapid_feed: FeedRate,
    pub spindle_rpm: Option<f64>,
    pub coolant: Coolant,
    /// Default: 20 mm above the top of the surface.
    pub clearance_z_mm: Option<f64>,
    /// Default: 2 mm above the top of the surface.
    pub retract_z_mm: Option<f64>,
}

#[derive(Debug, Clone, PartialEq)]
pub struct Job {
    pub surface: PointGrid,
    pub tool: Tool,
    pub plane: SectionPlane,
    /// Largest distance between neighbouring planes, mm.
    pub stepover_mm: f64,
    pub direction: CutDirection,
    pub tolerance: Tolerance,
    pub interpolation: Interpolation,
    /// Upper bound for the distance of neighbouring CL points, mm.
    pub step_length_mm: Option<f64>,
    pub cutting: CuttingRequest,
    /// The resolution the program will be written with: the bounds hold after rounding to it.
    pub resolution: Resolution,
}

#[derive(Debug, Clone, PartialEq)]
pub struct Report {
    pub n_passes: usize,
    pub n_cl_points: usize,
    /// Proved distance between the path as written and the exact CL curves, mm.
    pub deviation_max_mm: f64,
    /// Proved depth of the deepest penetration of the cutter into the surface, mm; zero or more.
    pub gouge_max_mm: f64,
    pub n_arcs: usize,
    pub n_lines: usize,
}

/// Something the caller should know that does not stop the job.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Warning {
    /// `not_a_knot` fell to the interpolating polynomial along this direction (fewer than 4 points).
    EndsReduced { direction: &'static str, points: usize },
    /// There is no spindle speed: the program starts no spindle.
    NoSpindleSpeed,
}

#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    pub toolpath: Toolpath,
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
    Grid(#[from] GridError),
    #[error("the surface's upward normal vanishes or turns down near {at}")]
    Overhang { at: Point3<f64> },
    #[error("the offset surface folds near {at}: the surface is curved more tightly than the cutter")]
    OffsetFolds { at: Point3<f64> },
    #[error("{field} is {value_mm} mm, below the top of the surface at {top_mm} mm")]
    HeightBelowTop { field: &'static str, value_mm: f64, top_mm: f64 },
    #[error("clearance_z_mm is {clearance_mm} mm, below retract_z_mm at {retract_mm} mm")]
    ClearanceBelowRetract { clearance_mm: f64, retract_mm: f64 },
    #[error("a tolerance of {tolerance_mm} mm cannot be held with {decimals} decimals; {least_mm} mm can")]
    ToleranceBelowResolution { tolerance_mm: f64, decimals: u8, least_mm: f64 },
    #[error("the tolerance of {tolerance_mm} mm was not reached; {deviation_mm} mm was proved near {at}")]
    ToleranceNotReached { tolerance_mm: f64, deviation_mm: f64, at: Point3<f64> },
    #[error("the job needs {needed} {what}; at most {limit} are allowed")]
    TooMuchWork { what: &'static str, needed: usize, limit: usize },
    #[error("no section of the surface is long enough to cut")]
    NothingToCut,
}

/// Plans the passes.
///
/// # Errors
/// One of [`Error`]; no toolpath is returned with one.
pub fn plan(_job: &Job, budget: &Budget) -> Result<Plan, Error> {
    budget.check()?;
    Err(Error::NothingToCut)
}

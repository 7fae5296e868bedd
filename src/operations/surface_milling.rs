//! Finishing a surface with a ball cutter along parallel plane sections (CL-Cartesian machining).
//!
//! # Method
//! 1. The surface is fitted to its points ([`point_grid`](crate::geometry::surface::point_grid)).
//! 2. Its normal is proved to point up and its offset not to fold ([`regularity`]).
//! 3. `passes`: equally spaced planes cut the offset; each section, lowered by the radius (Ju eq. 1), is a
//!    curve of CL points, and is joined by arcs and lines (Ju, section 4).
//! 4. `links`: one way or zigzag, the passes are joined by links, or by retract, rapid and plunge.
//! 5. Every move, as computed and as it will be written, is certified against the surface
//!    ([`clearance`](crate::geometry::clearance)).
//!
//! # Guarantees
//! * `deviation_max_mm` bounds the distance, both ways, between the path (computed, and rounded to the
//!   resolution) and the exact CL curves, and is at most the tolerance.
//! * `gouge_max_mm` bounds the depth to which cutter or shank enter the surface on any move; it is found
//!   without knowledge of how the path was made, and is at most the tolerance. A path that would cut deeper is
//!   refused as folded.
//!
//! # Degenerate input
//! Sections shorter than two steps of the resolution are left out: they would vanish in rounding.
//!
//! # Cost
//! O(p + n log m) for n CL points, m patches and p = m proved patches.
//!
//! # Differences from the paper
//! The step follows the proved curvature instead of being constant, and is refined until the tolerance holds
//! for the curve, not for its points. Rapids, links and the order of passes are not the paper's subject.
//!
//! # Reference
//! S. Y. Ju, "CL-Cartesian Machining along Approximated Circular Arcs".

mod links;
mod passes;

use nalgebra::Point3;

use crate::budget::{Budget, Stopped};
use crate::geometry::clearance::{Clearance, Penetration};
use crate::geometry::curve::Curve;
use crate::geometry::plane::Plane;
use crate::geometry::section::{SectionError, Sections};
use crate::geometry::surface::point_grid::{GridError, PointGrid};
use crate::geometry::surface::regularity::{self, Irregular};
use crate::geometry::surface::{BezierSurface, Surface};
use crate::toolpath::cutting::{Cutting, CuttingRequest, HeightError};
use crate::toolpath::program::{Resolution, Units};
use crate::toolpath::quantize::{QuantizeError, quantize};
use crate::toolpath::tool::Tool;
use crate::toolpath::units::{FeedRate, Tolerance};
use crate::toolpath::{Move, PathError, Toolpath};

/// The least tolerance that a program can hold, in steps of its last decimal: what rounding alone may take.
pub const LEAST_TOLERANCE_STEPS: f64 = 1.5;

/// Section planes of one job where the caller sets no limit.
pub const DEFAULT_PLANE_LIMIT: usize = 20_000;

/// The certificate's bound may exceed the deepest penetration by this part of the tolerance.
const CERTIFICATE_GAP: f64 = 0.02;

const TOP_ACCURACY_MM: f64 = 1e-6;

/// The planes of the sections: zx at constant y, yz at constant x.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum SectionPlane {
    #[default]
    Zx,
    Yz,
}

impl SectionPlane {
    /// The index of the coordinate that is constant on a plane: 1 is y, 0 is x.
    fn normal_axis(self) -> usize {
        self.arc_plane().axes()[2]
    }

    fn arc_plane(self) -> Plane {
        match self {
            SectionPlane::Zx => Plane::Zx,
            SectionPlane::Yz => Plane::Yz,
        }
    }
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
    /// More section planes than this are refused.
    pub plane_limit: usize,
}

impl Job {
    /// The job with the default of everything that has one, written in mm with three decimals.
    pub fn new(
        surface: PointGrid,
        tool: Tool,
        stepover_mm: f64,
        tolerance: Tolerance,
        feed: FeedRate,
    ) -> Self {
        Self {
            surface,
            tool,
            plane: SectionPlane::default(),
            stepover_mm,
            direction: CutDirection::default(),
            tolerance,
            interpolation: Interpolation::default(),
            step_length_mm: None,
            cutting: CuttingRequest::at_feed(feed),
            resolution: Resolution { units: Units::Mm, decimals: 3 },
            plane_limit: DEFAULT_PLANE_LIMIT,
        }
    }
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
    #[error(
        "the offset surface folds near {at}, or is too near to folding to tell: the cutter does not fit the surface"
    )]
    OffsetFolds { at: Point3<f64> },
    #[error("{field} is {value_mm} mm, below the top of the surface at {top_mm} mm")]
    HeightBelowTop { field: &'static str, value_mm: f64, top_mm: f64 },
    #[error("clearance_z_mm is {clearance_mm} mm, below retract_z_mm at {retract_mm} mm")]
    ClearanceBelowRetract { clearance_mm: f64, retract_mm: f64 },
    #[error("a tolerance of {tolerance_mm} mm cannot be held with {decimals} decimals; {least_mm:.6} mm can")]
    ToleranceBelowResolution { tolerance_mm: f64, decimals: u8, least_mm: f64 },
    #[error("the tolerance of {tolerance_mm} mm was not reached; {deviation_mm} mm was proved near {at}")]
    ToleranceNotReached { tolerance_mm: f64, deviation_mm: f64, at: Point3<f64> },
    #[error("the job needs {needed} {what}; at most {limit} are allowed")]
    TooMuchWork { what: &'static str, needed: usize, limit: usize },
    #[error("no section of the surface is long enough to cut")]
    NothingToCut,
    #[error("the section was lost near {at}")]
    SectionLost { at: Point3<f64> },
    #[error(transparent)]
    Quantize(#[from] QuantizeError),
    #[error(transparent)]
    Path(#[from] PathError),
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

impl From<HeightError> for Error {
    fn from(error: HeightError) -> Self {
        match error {
            HeightError::BelowTop { field, value_mm, top_mm } => {
                Self::HeightBelowTop { field, value_mm, top_mm }
            }
            HeightError::ClearanceBelowRetract { clearance_mm, retract_mm } => {
                Self::ClearanceBelowRetract { clearance_mm, retract_mm }
            }
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

/// Plans the passes.
///
/// # Errors
/// One of [`Error`]; no toolpath is returned with one.
pub fn plan(job: &Job, budget: &Budget) -> Result<Plan, Error> {
    let step_mm = job.resolution.step_mm();
    let least_mm = LEAST_TOLERANCE_STEPS * step_mm;
    if job.tolerance.mm() < least_mm {
        let decimals = job.resolution.decimals;
        return Err(Error::ToleranceBelowResolution { tolerance_mm: job.tolerance.mm(), decimals, least_mm });
    }
    let surface = upward(job.surface.surface()?);
    let cutting = job.cutting.above(surface.top(TOP_ACCURACY_MM, budget)?)?;
    let radius = job.tool.radius_mm;
    let curvature = regularity::prove(&surface, radius, job.plane.normal_axis(), budget)?;
    let sections = Sections::new(&surface, radius, job.plane.normal_axis(), curvature, budget)?;
    let gap = CERTIFICATE_GAP * job.tolerance.mm();
    let passes = passes::cut(job, &sections, job.tolerance.mm() - gap, budget)?;
    let clearance = Clearance::new(&surface, radius);
    let toolpath = links::join(job, &cutting, &passes, &clearance, budget)?;
    let gouge = certify(&toolpath, job, &clearance, gap, budget)?;
    let deviation_max_mm = passes.iter().map(|pass| pass.deviation_mm).fold(0.0, f64::max);
    let is_arc = |curve: &&Curve| matches!(curve, Curve::Arc(_));
    let n_arcs = passes.iter().flat_map(|pass| &pass.curves).filter(is_arc).count();
    Ok(Plan {
        report: Report {
            n_passes: passes.len(),
            n_cl_points: passes.iter().map(|pass| pass.n_points).sum(),
            deviation_max_mm,
            gouge_max_mm: gouge.bound_mm,
            n_arcs,
            n_lines: passes.iter().map(|pass| pass.curves.len()).sum::<usize>() - n_arcs,
        },
        warnings: warnings(job),
        toolpath,
        cutting,
    })
}

/// The surface with its normal up where it starts.
fn upward(surface: BezierSurface) -> BezierSurface {
    if surface.patch(0, 0).jet(0.5, 0.5).normal().z < 0.0 { surface.transposed() } else { surface }
}

/// Proves how deep the cutter cuts into the surface on any move, as computed and as written.
fn certify(
    toolpath: &Toolpath,
    job: &Job,
    clearance: &Clearance,
    gap: f64,
    budget: &Budget,
) -> Result<Penetration, Error> {
    let total = toolpath.moves().count();
    let mut deepest = Penetration::NONE;
    for (k, step) in toolpath.moves().enumerate() {
        if k.is_multiple_of(64) {
            budget.progress("certificate", k, total);
        }
        let curve = match step {
            Move::Rapid { line } => Curve::Line(*line),
            Move::Feed { along, .. } => *along,
            Move::Dwell { .. } => continue,
        };
        clearance.penetrate(&curve, 0.0, gap, &mut deepest, budget)?;
        for written in quantize(&curve, job.resolution)? {
            clearance.penetrate(&written.curve, written.slack_mm, gap, &mut deepest, budget)?;
        }
        if let (true, Some(at)) = (deepest.found_mm > job.tolerance.mm(), deepest.at) {
            return Err(Error::OffsetFolds { at });
        }
    }
    if deepest.bound_mm > job.tolerance.mm() {
        let at = deepest.at.unwrap_or(toolpath.start());
        let tolerance_mm = job.tolerance.mm();
        return Err(Error::ToleranceNotReached { tolerance_mm, deviation_mm: deepest.bound_mm, at });
    }
    Ok(deepest)
}

fn warnings(job: &Job) -> Vec<Warning> {
    let reduced = job.surface.reduced_ends();
    let mut warnings: Vec<_> =
        reduced.into_iter().map(|(direction, points)| Warning::EndsReduced { direction, points }).collect();
    if job.cutting.spindle_rpm.is_none() {
        warnings.push(Warning::NoSpindleSpeed);
    }
    warnings
}

//! Finishing a surface along parallel plane sections (CL-Cartesian machining), by direct contact or by
//! sections of the offset; and roughing along unions of wires (`wire_union`).
//!
//! # Method
//! 1. The surface is made of its data ([`source`](crate::geometry::surface::source)), and continued past its
//!    edges where the cutter is to run past them.
//! 2. *By contact*: the tip follows where the cutter, larger by the stock to be left, touches from above
//!    ([`contact`](crate::machining::drop_cutter)). *By sections of the offset*: the surface is proved to be
//!    smooth ([`joints`](crate::geometry::surface::joints)), its normal to point up and its offset, by the
//!    radius and the stock, not to fold ([`regularity`](crate::machining::regularity)); sections of the
//!    offset, lowered by the radius, are the curves (Ju eq. 1). Where that proof is there and the certificate
//!    bears it out, passes by contact of a ball are made so too. From it come the heights that passes leave
//!    between them (`scallop`).
//! 3. `planes`: planes are equally spaced; where the cutter is to stay inside the `outline`, what comes
//!    nearer to it is cut off. `passes`: the CL points of each section are joined by arcs and lines (Ju,
//!    section 4).
//! 4. `links`: one way or zigzag, the passes are joined by links, or the cutter leaves one and enters the
//!    next (`entries`).
//! 5. Every move of every cutter, as computed and as it will be written, is certified against the surface
//!    (`certificate`).
//!
//! # Guarantees
//! * `deviation_max_mm` bounds the distance, both ways, between the path (computed, and rounded to the
//!   resolution) and the exact CL curves, and is at most the tolerance.
//! * `gouge_max_mm` bounds the depth to which cutter or shank enter the surface on any move; it is found
//!   without knowledge of how the path was made. Into the
//!   stock to be left they enter by the tolerance at most; a path that would cut deeper is refused.
//! * `scallop_max_mm` bounds the height left between passes along the normal of the surface, but for the
//!   deviation, and for what lies so near to an edge that the way to the next pass would leave the surface.
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

mod certificate;
mod cl_cartesian;
mod deviation;
mod entries;
mod job;
mod links;
mod outline;
mod passes;
mod planes;
mod rest;
mod scallop;
mod wire_union;

use nalgebra::Point3;

use crate::budget::{Budget, Stopped};
use crate::geometry::surface::any_surface::AnySurface;
use crate::geometry::surface::joints::NotSmooth;
use crate::geometry::surface::source::SourceError;
use crate::geometry::surface::{BezierSurface, Patch};
use crate::machining::offset_section::SectionError;
use crate::machining::regularity::Irregular;
use crate::toolpath::cutting::{Cutting, HeightError};
use crate::toolpath::quantize::QuantizeError;
use crate::toolpath::{PathError, Toolpath};
pub use job::{
    Boundary, CutDirection, DEFAULT_PLANE_LIMIT, Engine, Entry, Exit, Interpolation, Job, SectionPlane,
    Spacing, Stock,
};

/// The least tolerance that a program can hold, in steps of its last decimal: what rounding alone may take.
pub const LEAST_TOLERANCE_STEPS: f64 = 1.5;

/// The certificate's bound may exceed the deepest penetration by this part of the tolerance.
const CERTIFICATE_GAP: f64 = 0.02;

const TOP_ACCURACY_MM: f64 = 1e-6;

#[derive(Debug, Clone, PartialEq)]
pub struct Report {
    pub n_passes: usize,
    pub n_cl_points: usize,
    /// Distance of neighbouring planes, mm.
    pub stepover_mm: f64,
    /// Proved distance between the path as written and the exact CL curves, mm.
    pub deviation_max_mm: f64,
    /// Proved depth of the deepest penetration of the cutter into the surface, mm; zero or more.
    pub gouge_max_mm: f64,
    /// Where the deepest penetration was found; `None` where none was, or the bound is not of a place.
    pub gouge_at: Option<Point3<f64>>,
    /// What the cutter cannot reach at concave places, along the normal of the surface, at most: the largest
    /// that was found, mm; `None` where it was not looked for.
    pub rest_sampled_max_mm: Option<f64>,
    /// Where that is, if it is anything.
    pub rest_at: Option<Point3<f64>>,
    /// Proved height of what is left between passes, along the surface normal, mm; `None` where the passes
    /// are too far apart to meet.
    pub scallop_max_mm: Option<f64>,
    pub n_arcs: usize,
    pub n_lines: usize,
}

/// Something the caller should know that does not stop the job.
#[derive(Debug, Clone, PartialEq)]
pub enum Warning {
    /// `not_a_knot` fell to the interpolating polynomial along this direction (fewer than 4 points).
    EndsReduced { direction: &'static str, points: usize },
    /// What is left between passes is not proved: the cutter cannot follow the surface everywhere, or is no
    /// ball.
    ScallopNotProved,
    /// Neighbouring passes do not meet: stock of any height is left between them.
    PassesApart { stepover_mm: f64 },
    /// Pieces of passes that are shorter than a tenth of the cutter's radius are left out: the cutter does
    /// not go there.
    ShortPiecesLeftOut { count: usize, longest_mm: f64 },
    /// Both extents of the part in plan are less than the diameter of the cutter.
    PartSmallerThanCutter,
    /// Nobody says what stands over the surface: rapids come down to this far above it.
    StockNotGiven { approach_mm: f64 },
    /// The number of entries and exits for which there is no room: there the cutter goes straight down or up.
    EntryNotClear { count: usize },
    /// The path is one for roughing, and cuts this deep into the surface.
    RoughingPathGouges { depth_mm: f64 },
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
    Source(#[from] SourceError),
    #[error("the engine `offset_section` supports ball cutters only; use the engine `contact`")]
    NoBall,
    #[error(transparent)]
    NotSmooth(NotSmooth),
    #[error(
        "the surface cannot be continued past its edges because it has no tangent across one edge; use the boundary `on` or `inside`"
    )]
    NoWayPast,
    #[error(
        "the surface is vertical, overhangs or has no normal near {at}; the engine `offset_section` cannot cut it; use the engine `contact`"
    )]
    Overhang { at: Point3<f64> },
    #[error(
        "the cutter does not fit the surface near {at}, where its offset folds or nearly folds; use a smaller cutter or the engine `contact`"
    )]
    OffsetFolds { at: Point3<f64> },
    #[error(transparent)]
    Heights(#[from] HeightError),
    #[error(
        "the tolerance {tolerance_mm} mm is too small for {decimals} decimals; use at least {least_mm:.6} mm, or more decimals"
    )]
    ToleranceBelowResolution { tolerance_mm: f64, decimals: u8, least_mm: f64 },
    #[error(
        "the tolerance {tolerance_mm} mm could not be proved; near {at} the proof reaches {deviation_mm} mm"
    )]
    ToleranceNotReached { tolerance_mm: f64, deviation_mm: f64, at: Point3<f64> },
    #[error("the job needs {needed} {what}; at most {limit} are allowed")]
    TooMuchWork { what: &'static str, needed: usize, limit: usize },
    #[error(
        "no section of the surface is long enough to cut; the part is too small or the boundary leaves nothing"
    )]
    NothingToCut,
    #[error("a section of the surface could not be traced near {at}")]
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
        matches!(self, Self::ToleranceNotReached { .. } | Self::SectionLost { .. } | Self::TooMuchWork { .. })
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
    match job.surface.surface()? {
        AnySurface::Bicubic(surface) => plan_on(surface, job, budget),
        AnySurface::Rational(surface) => plan_on(surface, job, budget),
        AnySurface::HighDegree(surface) => plan_on(surface, job, budget),
    }
}

fn plan_on<P: Patch>(surface: BezierSurface<P>, job: &Job, budget: &Budget) -> Result<Plan, Error> {
    match job.spacing {
        Spacing::WirePitch(pitch_mm) => wire_union::plan(&surface, job, pitch_mm, budget),
        Spacing::Stepover(_) | Spacing::ScallopHeight(_) => cl_cartesian::plan(surface, job, budget),
    }
}

/// What the data of the surface gives reason to warn of.
fn data_warnings(job: &Job) -> Vec<Warning> {
    let reduced = job.surface.reduced_ends().into_iter();
    reduced.map(|(direction, points)| Warning::EndsReduced { direction, points }).collect()
}

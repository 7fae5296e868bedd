//! Finishing a surface with a ball cutter along parallel plane sections (CL-Cartesian machining).
//!
//! # Method
//! 1. The surface is made of its data ([`source`](crate::geometry::surface::source)), proved to be smooth
//!    ([`joints`]), and continued past its edges where the cutter is to run past them.
//! 2. Its normal is proved to point up and its offset, by the radius and the stock to be left, not to fold
//!    ([`regularity`]). From the same proof come the heights that passes leave between them (`scallop`).
//! 3. `planes`: equally spaced planes cut the offset; where the cutter is to stay inside the `outline`, what comes
//!    nearer to it is cut off. `passes`: each section, lowered by the radius (Ju eq. 1), is a curve of CL points, and
//!    is joined by arcs and lines (Ju, section 4).
//! 4. `links`: one way or zigzag, the passes are joined by links, or by retract, rapid and plunge.
//! 5. Every move, as computed and as it will be written, is certified against the surface
//!    ([`clearance`](crate::geometry::clearance)).
//!
//! # Guarantees
//! * `deviation_max_mm` bounds the distance, both ways, between the path (computed, and rounded to the
//!   resolution) and the exact CL curves, and is at most the tolerance.
//! * `gouge_max_mm` bounds the depth to which cutter or shank enter the surface on any move; it is found
//!   without knowledge of how the path was made. Into the stock to be left they enter by the tolerance at most; a
//!   path that would cut deeper is refused as folded.
//! * `scallop_max_mm` bounds the height left between passes along the normal of the surface, but for the deviation,
//!   and for what lies so near to an edge that the way to the next pass would leave the surface.
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
use crate::geometry::clearance::{Clearance, Penetration};
use crate::geometry::contact::{Contacts, TipSections};
use crate::geometry::curve::Curve;
use crate::geometry::section::{SectionError, Sections};
use crate::geometry::surface::joints::{self, Joints, NotSmooth};
use crate::geometry::surface::regularity::{self, Irregular, Regularity, Slope};
use crate::geometry::surface::source::{AnySurface, SourceError};
use crate::geometry::surface::{BezierSurface, Patch};
use crate::toolpath::cutting::{Cutting, HeightError};
use crate::toolpath::quantize::{Parabolas, QuantizeError, quantize};
use crate::toolpath::tool::Shape;
use crate::toolpath::{Move, PathError, Toolpath};
pub use job::{
    Boundary, CutDirection, DEFAULT_PLANE_LIMIT, Engine, Interpolation, Job, SectionPlane, Spacing,
};
use links::Proof;
use outline::Outline;
use passes::{Allowed, Seam};
use planes::{ContactEngine, OffsetEngine, Slicer};

/// The least tolerance that a program can hold, in steps of its last decimal: what rounding alone may take.
pub const LEAST_TOLERANCE_STEPS: f64 = 1.5;

/// The certificate's bound may exceed the deepest penetration by this part of the tolerance.
const CERTIFICATE_GAP: f64 = 0.02;

const TOP_ACCURACY_MM: f64 = 1e-6;

/// The part of the tolerance that a CL curve may take between its points. Smaller parts cost points, larger ones arcs, whose number
/// falls only with the cube root of what is left. Points of direct contact are dearer.
const SECTION_HEIGHT_SHARE: f64 = 0.03;
const CONTACT_HEIGHT_SHARE: f64 = 0.06;

/// The outline that a cutter stays inside of is known to this part of the tolerance.
const OUTLINE_SHARE: f64 = 0.1;

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
    /// What the cutter cannot reach at concave places, along the normal of the surface, at most: the largest that was found, mm.
    pub rest_sampled_max_mm: f64,
    pub rest_at: Option<Point3<f64>>,
    /// Proved height of what is left between passes, along the surface normal, mm; `None` where the passes are too far
    /// apart to meet.
    pub scallop_max_mm: Option<f64>,
    pub n_arcs: usize,
    pub n_lines: usize,
}

/// Something the caller should know that does not stop the job.
#[derive(Debug, Clone, PartialEq)]
pub enum Warning {
    /// `not_a_knot` fell to the interpolating polynomial along this direction (fewer than 4 points).
    EndsReduced { direction: &'static str, points: usize },
    /// What is left between passes is not proved: the cutter cannot follow the surface everywhere, or is no ball.
    ScallopNotProved,
    /// Neighbouring passes do not meet: stock of any height is left between them.
    PassesApart { stepover_mm: f64 },
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
    #[error(transparent)]
    NotSmooth(NotSmooth),
    #[error("the surface cannot be continued past its edges: it has no tangents across one of them")]
    NoWayPast,
    #[error("the surface's upward normal vanishes or turns down near {at}")]
    Overhang { at: Point3<f64> },
    #[error(
        "the offset surface folds near {at}, or is too near to folding to tell: the cutter does not fit the surface"
    )]
    OffsetFolds { at: Point3<f64> },
    #[error(transparent)]
    Heights(#[from] HeightError),
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
    if let Spacing::WirePitch(pitch_mm) = job.spacing {
        return wire_union::plan(&surface, job, pitch_mm, budget);
    }
    let joints = match job.engine {
        Engine::OffsetSection => joints::examine(&surface, &job.surface.loose_joints(), budget)?,
        // Edges and gaps are touched like everything else.
        Engine::Contact => Joints::default(),
    };
    let surface = surface.upward();
    let surface = match job.boundary {
        Boundary::Past => surface.continued(job.tool.radius_mm).ok_or(Error::NoWayPast)?,
        Boundary::Inside | Boundary::On => surface,
    };
    let top = surface.top(TOP_ACCURACY_MM, budget)? + job.allowance_mm;
    let cutting = job.cutting.above(top)?;
    let Followed { slopes, is_proved, regularity } = followed(&surface, job, budget)?;
    let contacts = Contacts::new(&surface, job.cutter(), budget)?;
    let axis = job.plane.normal_axis();
    let engine: Box<dyn planes::Engine> = match (job.engine, &regularity) {
        (Engine::OffsetSection, Some(regularity)) => Box::new(OffsetEngine {
            sections: Sections::new(&surface, job.offset_mm(), axis, regularity, budget)?,
            rise: job.tool.radius_mm,
        }),
        _ => Box::new(ContactEngine {
            sections: TipSections { contacts: &contacts, axis },
            stock: job.allowance_mm,
        }),
    };
    let slicer = Slicer::new(&*engine, inside(&surface, job, budget)?);
    let stepover = match job.spacing {
        Spacing::Stepover(mm) | Spacing::WirePitch(mm) => mm,
        Spacing::ScallopHeight(mm) => scallop::spacing(job.cutter().corner_radius(), mm, &slopes),
    };
    let planes = slicer.planes(job, stepover, budget)?;
    let stepover_mm = (planes[1].at - planes[0].at).abs();

    let gap = CERTIFICATE_GAP * job.tolerance.mm();
    let least_share = slopes.iter().map(|slope| slope.share).fold(1.0, f64::min);
    let seam = Seam { jump: joints.jump(job.offset_mm()), bend: joints.kink / (4.0 * least_share) };
    let chord_height_share = match job.engine {
        Engine::Contact => CONTACT_HEIGHT_SHARE,
        Engine::OffsetSection => SECTION_HEIGHT_SHARE,
    };
    let allowed = Allowed { tolerance: job.tolerance.mm() - gap, seam, chord_height_share };
    let passes = passes::cut(job, &slicer, &planes, allowed, budget)?;
    let deviation_max_mm = passes.iter().map(|pass| pass.deviation_mm).fold(0.0, f64::max);
    let clearance = Clearance::new(&surface, job.offset_mm(), job.tool.radius_mm);
    let proof = match job.tool.shape {
        Shape::Ball => Proof::Certificate(&clearance),
        Shape::Flat | Shape::BullNose { .. } => Proof::Contact(&contacts),
    };
    let toolpath = links::join(job, &cutting, &passes, &proof, budget)?;
    let penetration = match job.tool.shape {
        Shape::Ball => certify(&toolpath, job, &clearance, gap, budget)?,
        // Who is moved by so much cuts no deeper.
        Shape::Flat | Shape::BullNose { .. } => Penetration {
            bound_mm: job.allowance_mm + deviation_max_mm.max(links::TOLERANCE_SHARE * job.tolerance.mm()),
            ..Penetration::NONE
        },
    };
    let rest = match job.engine {
        Engine::Contact => rest::largest(&contacts, budget)?,
        // The ball can follow the surface everywhere.
        Engine::OffsetSection => None,
    };
    let is_arc = |curve: &&Curve| matches!(curve, Curve::Arc(_));
    let n_arcs = passes.iter().flat_map(|pass| &pass.curves).filter(is_arc).count();
    let scallop = scallop::height(job.tool.radius_mm, stepover_mm, &slopes);
    let report = Report {
        n_passes: passes.len(),
        n_cl_points: passes.iter().map(|pass| pass.n_points).sum(),
        stepover_mm,
        deviation_max_mm,
        gouge_max_mm: (penetration.bound_mm - job.allowance_mm).max(0.0),
        gouge_at: penetration.at.filter(|_| penetration.found_mm > job.allowance_mm),
        scallop_max_mm: scallop.filter(|_| is_proved),
        rest_sampled_max_mm: rest.map_or(0.0, |rest| rest.height_mm),
        rest_at: rest.map(|rest| rest.at),
        n_arcs,
        n_lines: passes.iter().map(|pass| pass.curves.len()).sum::<usize>() - n_arcs,
    };
    let warnings = warnings(job, &report, is_proved);
    Ok(Plan { toolpath, report, cutting, warnings })
}

/// What is known of the slopes over which the cutter goes.
struct Followed {
    slopes: Vec<Slope>,
    /// Whether they are all, and the cutter can follow them everywhere.
    is_proved: bool,
    regularity: Option<Regularity>,
}

/// # Errors
/// Where the offset section engine could not follow, or the budget's stop.
fn followed(surface: &BezierSurface<impl Patch>, job: &Job, budget: &Budget) -> Result<Followed, Error> {
    let (radius, axis) = (job.cutter().corner_radius(), job.plane.normal_axis());
    let proof = match job.tool.shape {
        Shape::Ball => Some(regularity::prove(surface, job.offset_mm(), axis, budget)),
        Shape::Flat | Shape::BullNose { .. } => None,
    };
    match proof {
        Some(Ok(regularity)) => {
            let slopes = regularity.slopes().to_vec();
            Ok(Followed { slopes, is_proved: true, regularity: Some(regularity) })
        }
        Some(Err(Irregular::Stopped(stopped))) => Err(stopped.into()),
        Some(Err(irregular)) if job.engine == Engine::OffsetSection => Err(irregular.into()),
        _ => {
            let slopes = scallop::sampled_slopes(surface, radius, axis, budget)?;
            Ok(Followed { slopes, is_proved: false, regularity: None })
        }
    }
}

/// What keeps the cutter inside the outline, where it is to stay there.
fn inside(
    surface: &BezierSurface<impl Patch>,
    job: &Job,
    budget: &Budget,
) -> Result<Option<(Outline, f64)>, Error> {
    match job.boundary {
        Boundary::Inside => {
            let outline = Outline::new(surface, OUTLINE_SHARE * job.tolerance.mm(), budget)?;
            Ok(Some((outline, job.tool.radius_mm)))
        }
        Boundary::On | Boundary::Past => Ok(None),
    }
}

/// Proves how deep the cutter cuts into the surface on any move, as computed and as written.
fn certify(
    toolpath: &Toolpath,
    job: &Job,
    clearance: &Clearance<impl Patch>,
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
        for written in quantize(&curve, job.resolution, Parabolas::AsLines)? {
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

fn warnings(job: &Job, report: &Report, is_proved: bool) -> Vec<Warning> {
    let mut warnings: Vec<_> = job
        .surface
        .reduced_ends()
        .into_iter()
        .map(|(direction, points)| Warning::EndsReduced { direction, points })
        .collect();
    if !is_proved {
        warnings.push(Warning::ScallopNotProved);
    } else if report.scallop_max_mm.is_none() {
        warnings.push(Warning::PassesApart { stepover_mm: report.stepover_mm });
    }
    warnings
}

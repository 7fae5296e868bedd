//! Passes along parallel planes, by either engine.

use super::deviation::{Deviation, Seam};
use super::entries::{APPROACH_MM, Proofs};
use super::links::{self, Joined};
use super::outline::Outline;
use super::passes::{self, Allowed, CutPass, LeftOut, Passes};
use super::planes::{self, ContactEngine, OffsetEngine, Slicer};
use super::{
    Boundary, CERTIFICATE_GAP, Engine, Error, Job, Plan, Report, Spacing, TOP_ACCURACY_MM, Warning,
    certificate, data_warnings, rest, scallop,
};
use crate::budget::{Budget, Stopped};
use crate::geometry::curve::Curve;
use crate::geometry::surface::joints::{self, Joints, NotSmooth};
use crate::geometry::surface::patch::Bounds;
use crate::geometry::surface::{BezierSurface, Patch};
use crate::machining::drop_cutter::{Contacts, TipSections};
use crate::machining::gouge::{GougeProof, Penetration};
use crate::machining::offset_section::PlaneAt;
use crate::machining::offset_section::Sections;
use crate::machining::regularity::{self, Irregular, Regularity, Slope};
use crate::toolpath::Toolpath;
use crate::toolpath::cutting::Cutting;
use crate::toolpath::tool::Shape;

/// The part of the tolerance that a CL curve may take between its points. Smaller parts cost points, larger
/// ones arcs, whose number falls only with the cube root of what is left. Points of direct contact are
/// dearer.
const SECTION_HEIGHT_SHARE: f64 = 0.03;
const CONTACT_HEIGHT_SHARE: f64 = 0.06;

/// The outline that a cutter stays inside of is known to this part of the tolerance.
const OUTLINE_SHARE: f64 = 0.1;

/// A rim reaches up to the root of 2 farther below the surface than its path deviates: passes that it takes
/// too deep are cut again with this part of the tolerance.
const RIM_SHARE: f64 = 0.65;

/// What an engine knows of a job.
struct Found<'a, P> {
    engine: &'a dyn planes::Engine,
    /// Where the cutter touches; `None` by sections of the offset, which need no such search.
    contacts: Option<&'a Contacts<'a, P>>,
    slopes: Vec<Slope>,
    /// Whether the slopes are all there are, and the cutter can follow them everywhere.
    is_followed: bool,
    seam: Seam,
    chord_height_share: f64,
    depth: Depth,
}

/// How deep passes may cut into the surface.
#[derive(Clone, Copy, PartialEq)]
enum Depth {
    /// The tolerance.
    Tolerance,
    /// As they deviate, and no deeper: or else something is in their way that they know nothing of.
    Deviation,
}

/// Plans the passes.
///
/// # Errors
/// One of [`Error`]; no toolpath is returned with one.
pub(super) fn plan<P: Patch>(surface: BezierSurface<P>, job: &Job, budget: &Budget) -> Result<Plan, Error> {
    match job.engine {
        Engine::OffsetSection => by_offset_section(surface, job, budget),
        Engine::Contact => by_contact(surface, job, budget),
    }
}

fn by_offset_section<P: Patch>(surface: BezierSurface<P>, job: &Job, budget: &Budget) -> Result<Plan, Error> {
    if job.tool.shape != Shape::Ball {
        return Err(Error::NoBall);
    }
    let joints = joints::examine(&surface, &job.surface.loose_joints(), budget)?;
    let surface = prepared(surface, job)?;
    let regularity = regularity::prove(&surface, job.offset_mm(), job.plane.normal_axis(), budget)?;
    let offset = Offset { regularity: &regularity, seam: seam(&joints, job, regularity.slopes()) };
    by_sections(&surface, &offset, None, job, budget)
}

/// By the contacts of the cutter. Where a ball is proved to fit the surface everywhere, it touches with its
/// tangent plane, and passes are sections of the offset, unless the certificate finds that something else is
/// in their way.
fn by_contact<P: Patch>(surface: BezierSurface<P>, job: &Job, budget: &Budget) -> Result<Plan, Error> {
    let joints = match joints::examine(&surface, &job.surface.loose_joints(), budget) {
        Err(NotSmooth::Stopped(stopped)) => return Err(stopped.into()),
        joints => joints.ok(),
    };
    let surface = prepared(surface, job)?;
    let contacts = Contacts::new(&surface, job.cutter(), budget)?;
    let mut regularity = regularity(&surface, job, budget)?;
    if let (Some(proof), Some(joints)) = (&regularity, joints) {
        let offset = Offset { regularity: proof, seam: seam(&joints, job, proof.slopes()) };
        if CONTACT_HEIGHT_SHARE * job.tolerance.mm() >= offset.seam.bend * job.tool.radius_mm {
            match by_sections(&surface, &offset, Some(&contacts), job, budget) {
                // The ball fits near each place, and yet something is in its way, or a wall as good as
                // upright has sections without end.
                Err(
                    Error::ToleranceNotReached { .. } | Error::SectionLost { .. } | Error::TooMuchWork { .. },
                ) => regularity = None,
                planned => return planned,
            }
        }
    }
    let axis = job.plane.normal_axis();
    let sections = TipSections::new(&contacts, axis, budget)?;
    let found = Found {
        engine: &ContactEngine { sections, stock: job.allowance_mm },
        contacts: Some(&contacts),
        is_followed: regularity.is_some(),
        slopes: match regularity {
            Some(regularity) => regularity.slopes().to_vec(),
            None => scallop::sampled_slopes(&surface, job.cutter().corner_radius(), axis, budget)?,
        },
        // Edges and gaps are touched like everything else.
        seam: Seam::NONE,
        chord_height_share: CONTACT_HEIGHT_SHARE,
        depth: Depth::Tolerance,
    };
    plan_with(&surface, &found, job, budget)
}

/// The offset of a surface that a ball can follow everywhere.
struct Offset<'a> {
    regularity: &'a Regularity,
    seam: Seam,
}

/// By sections of the offset; with `contacts`, these are what they stand for.
fn by_sections<P: Patch>(
    surface: &BezierSurface<P>,
    offset: &Offset,
    contacts: Option<&Contacts<P>>,
    job: &Job,
    budget: &Budget,
) -> Result<Plan, Error> {
    let Offset { regularity, seam } = *offset;
    let sections = Sections::new(surface, job.offset_mm(), job.plane.normal_axis(), regularity, budget)?;
    let found = Found {
        engine: &OffsetEngine { sections, rise: job.tool.radius_mm },
        contacts,
        slopes: regularity.slopes().to_vec(),
        is_followed: true,
        seam,
        chord_height_share: SECTION_HEIGHT_SHARE,
        depth: if contacts.is_some() { Depth::Deviation } else { Depth::Tolerance },
    };
    plan_with(surface, &found, job, budget)
}

/// The surface with its normal up, as far as the cutter's contact may go.
fn prepared<P: Patch>(surface: BezierSurface<P>, job: &Job) -> Result<BezierSurface<P>, Error> {
    let surface = surface.upward();
    match job.boundary {
        Boundary::Past => surface.continued(job.tool.radius_mm).ok_or(Error::NoWayPast),
        Boundary::Inside | Boundary::On => Ok(surface),
    }
}

/// The proof that the cutter can follow the surface everywhere, where it is a ball and there is one.
fn regularity(
    surface: &BezierSurface<impl Patch>,
    job: &Job,
    budget: &Budget,
) -> Result<Option<Regularity>, Stopped> {
    if job.tool.shape != Shape::Ball {
        return Ok(None);
    }
    match regularity::prove(surface, job.offset_mm(), job.plane.normal_axis(), budget) {
        Ok(regularity) => Ok(Some(regularity)),
        Err(Irregular::Stopped(stopped)) => Err(stopped),
        Err(Irregular::Overhang { .. } | Irregular::Folds { .. }) => Ok(None),
    }
}

/// What joints that are smooth but for the rounding of their data do to the offset.
fn seam(joints: &Joints, job: &Job, slopes: &[Slope]) -> Seam {
    let least_share = slopes.iter().map(|slope| slope.share).fold(1.0, f64::min);
    Seam { jump: joints.jump(job.offset_mm()), bend: joints.kink / (4.0 * least_share) }
}

/// Passes that are proved.
struct Cut {
    passes: Vec<CutPass>,
    left_out: LeftOut,
    toolpath: Toolpath,
    n_not_clear: usize,
    deviation_max_mm: f64,
    penetration: Penetration,
}

/// Cuts the passes, which may deviate by a share of the tolerance, and proves them.
fn cut<P: Patch>(
    job: &Job,
    slicer: &Slicer,
    planes: &[PlaneAt],
    (found, share): (&Found<P>, f64),
    (cutting, proofs): (&Cutting, &Proofs<P>),
    budget: &Budget,
) -> Result<Cut, Error> {
    let gap = CERTIFICATE_GAP * job.tolerance.mm();
    let allowed = Allowed {
        tolerance: share * (job.tolerance.mm() - gap),
        seam: found.seam,
        chord_height_share: found.chord_height_share,
    };
    let Passes { passes, left_out } = passes::cut(job, slicer, planes, allowed, budget)?;
    let deviation = passes.iter().fold(Deviation::NONE, |deviation, pass| deviation.or_more(&pass.deviation));
    let deviation_max_mm = deviation.bound_mm;
    let Joined { toolpath, n_not_clear } = links::join(job, cutting, &passes, proofs, budget)?;
    let depth_mm = match found.depth {
        Depth::Tolerance => job.tolerance.mm(),
        Depth::Deviation => deviation_max_mm + gap + job.resolution.step_mm(),
    };
    let penetration = certify(&toolpath, job, &proofs.left, [gap, depth_mm], budget)?;
    Ok(Cut { passes, left_out, toolpath, n_not_clear, deviation_max_mm, penetration })
}

fn plan_with<P: Patch>(
    surface: &BezierSurface<P>,
    found: &Found<P>,
    job: &Job,
    budget: &Budget,
) -> Result<Plan, Error> {
    let cutting = job.cutting.above(job.top(surface.top(TOP_ACCURACY_MM, budget)?))?;
    let slicer = Slicer::new(found.engine, job.plane.normal_axis(), inside(surface, job, budget)?);
    let stepover = match job.spacing {
        Spacing::Stepover(mm) | Spacing::WirePitch(mm) => mm,
        Spacing::ScallopHeight(mm) => match job.cutter().corner_radius() {
            0.0 => scallop::spacing_of_flat_ends(job.cutter().radius(), mm, &found.slopes),
            corner => scallop::spacing(corner, mm, &found.slopes),
        },
    };
    let planes = slicer.planes(job, stepover, budget)?;
    let stepover_mm = (planes[1].at - planes[0].at).abs();

    let proofs = Proofs::new(surface, job);
    let cut = |share: f64| cut(job, &slicer, &planes, (found, share), (&cutting, &proofs), budget);
    let cut = match cut(1.0) {
        Err(Error::ToleranceNotReached { .. }) if job.cutter().flat_radius() > 0.0 => cut(RIM_SHARE)?,
        cut => cut?,
    };
    let Cut { passes, left_out, toolpath, n_not_clear, deviation_max_mm, penetration } = cut;
    let rest = found.contacts.map(|contacts| rest::largest(contacts, budget)).transpose()?;
    let is_arc = |curve: &&Curve| matches!(curve, Curve::Arc(_));
    let n_arcs = passes.iter().flat_map(|pass| &pass.curves).filter(is_arc).count();
    let scallop = scallop::height(job.tool.radius_mm, stepover_mm, &found.slopes);
    let report = Report {
        n_passes: passes.len(),
        n_cl_points: passes.iter().map(|pass| pass.n_points).sum(),
        stepover_mm,
        deviation_max_mm,
        gouge_max_mm: (penetration.bound_mm - job.allowance_mm).max(0.0),
        gouge_at: penetration.at.filter(|_| penetration.found_mm > job.allowance_mm),
        scallop_max_mm: scallop.filter(|_| found.is_followed),
        rest_sampled_max_mm: rest.map(|rest| rest.height_mm),
        rest_at: rest.and_then(|rest| rest.at),
        n_arcs,
        n_lines: passes.iter().map(|pass| pass.curves.len()).sum::<usize>() - n_arcs,
    };
    let bounds = surface.patches().iter().map(Patch::bounds).fold(Bounds::EMPTY, |all, own| all.union(&own));
    let is_small = (bounds.max - bounds.min).xy().amax() < 2.0 * job.tool.radius_mm;
    let warnings = warnings(job, &report, found.is_followed, (left_out, n_not_clear, is_small));
    Ok(Plan { toolpath, report, cutting, warnings })
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

/// Proves how deep the cutter cuts into the surface on any move, as computed and as written: within the
/// tolerance, and within `depth_mm` on the passes.
fn certify(
    toolpath: &Toolpath,
    job: &Job,
    proof: &GougeProof<impl Patch>,
    [gap, depth_mm]: [f64; 2],
    budget: &Budget,
) -> Result<Penetration, Error> {
    let tolerance_mm = job.tolerance.mm();
    let [between, of_passes] = certificate::curves_between_and_of_passes(toolpath);
    let n_moves = between.len() + of_passes.len();
    let search = certificate::Search::new(proof, job, [gap, tolerance_mm], n_moves, budget);
    let mut deepest = Penetration::NONE;
    for (moves, most) in [(of_passes, depth_mm.min(tolerance_mm)), (between, tolerance_mm)] {
        deepest = search.deepest(deepest, &moves)?;
        match deepest.at {
            Some(at) if deepest.found_mm > tolerance_mm && job.engine == Engine::OffsetSection => {
                return Err(Error::OffsetFolds { at });
            }
            at if deepest.bound_mm > most => {
                let at = at.unwrap_or(toolpath.start());
                return Err(Error::ToleranceNotReached { tolerance_mm, deviation_mm: deepest.bound_mm, at });
            }
            _ => {}
        }
    }
    Ok(deepest)
}

fn warnings(
    job: &Job,
    report: &Report,
    is_followed: bool,
    (left_out, n_not_clear, is_small): (LeftOut, usize, bool),
) -> Vec<Warning> {
    let mut warnings = data_warnings(job);
    if is_small {
        warnings.push(Warning::PartSmallerThanCutter);
    }
    if job.stock.is_none() {
        warnings.push(Warning::StockNotGiven { approach_mm: APPROACH_MM });
    }
    if n_not_clear > 0 {
        warnings.push(Warning::EntryNotClear { count: n_not_clear });
    }
    if let LeftOut { count: 1.., longest_mm } = left_out {
        warnings.push(Warning::ShortPiecesLeftOut { count: left_out.count, longest_mm });
    }
    if !is_followed {
        warnings.push(Warning::ScallopNotProved);
    } else if report.scallop_max_mm.is_none() {
        warnings.push(Warning::PassesApart { stepover_mm: report.stepover_mm });
    }
    warnings
}

//! Plans the finishing of a surface in passes along parallel planes. The CL curves in these planes are
//! sections of the offset surface, or they are found by dropping the cutter onto the surface.

use super::deviation::{Deviation, Seam};
use super::entries::{APPROACH_MM, Proofs};
use super::job::CONTACT_SHARE;
use super::leftover::{self, Material, Stepovers};
use super::links::{self, Joined};
use super::outline::Outline;
use super::passes::{self, Allowed, LeftOut, Passes};
use super::planes::{ClCurves, ContactCurves, OffsetCurves, Slicer};
use super::rest::Positions;
use super::{
    Boundary, CERTIFICATE_GAP, Engine, Error, Job, Plan, Report, TOP_ACCURACY_MM, Warning, certificate,
    counts, data_warnings, scallop,
};
use crate::budget::Budget;
use crate::geometry::curve::Curve;
use crate::geometry::surface::joints::{self, Joints};
use crate::geometry::surface::patch::Bounds;
use crate::geometry::surface::{BezierSurface, Patch};
use crate::machining::drop_cutter::{Contacts, TipSections};
use crate::machining::gouge::{GougeProof, Penetration};
use crate::machining::offset_section::Sections;
use crate::machining::regularity::{self, Regularity, Slope};
use crate::machining::uncut::{Left, Leftover};
use crate::toolpath::Toolpath;
use crate::toolpath::cutting::Cutting;
use crate::toolpath::tool::Shape;

/// The share of the tolerance that a CL curve may take as height over the chords of its points. A smaller
/// share needs more points. A larger one needs more arcs, but their number grows only with the inverse cube
/// root of the tolerance that is left. Points of direct contact cost more time, so their share is larger.
const SECTION_HEIGHT_SHARE: f64 = 0.03;
const CONTACT_HEIGHT_SHARE: f64 = 0.06;

/// The accuracy of the outline, as a share of the tolerance.
const OUTLINE_SHARE: f64 = 0.1;

/// The rim of a flat end reaches up to the root of 2 farther below the surface than its path deviates. If the
/// certificate rejects such passes, they are cut again with this share of the tolerance.
const RIM_SHARE: f64 = 0.65;

/// What the passes of a job are cut from.
struct Found<'a, P> {
    curves: &'a dyn ClCurves,
    milled: &'a Milled<'a, P>,
    slopes: Vec<Slope>,
    seam: Seam,
    chord_height_share: f64,
    /// A job that needs more CL points is refused.
    point_limit: usize,
    depth: Depth,
}

/// How deep passes may cut into the surface.
#[derive(Clone, Copy, PartialEq)]
enum Depth {
    /// By the tolerance.
    Tolerance,
    /// By the deviation of the passes, plus the certificate's gap and one step of the last decimal. A deeper
    /// cut shows that the passes miss some other part of the surface.
    Deviation,
}

/// How the CL curves of a surface are found.
enum Choice {
    /// As sections of the offset, because the request asks for them.
    Offset(Offset),
    /// As sections of the offset, because the ball cutter fits the surface at every place; as tips of the
    /// cutter in contact if another part of the surface is in its way ([`Error::is_obstacle`]).
    OffsetIfClear(Offset),
    /// As tips of the cutter in contact, with the proof that the cutter can follow the surface, if there is
    /// one.
    Contact(Option<Regularity>),
}

/// The surface of a job.
struct Milled<'a, P> {
    /// The part within its outline, without what `past` adds to it.
    part: &'a BezierSurface<P>,
    surface: &'a BezierSurface<P>,
    contacts: &'a Contacts<'a, P>,
}

/// The offset of a surface that a ball cutter can follow everywhere.
struct Offset {
    regularity: Regularity,
    seam: Seam,
}

/// Plans the passes.
///
/// # Errors
/// One of [`Error`]; no toolpath is returned with one.
pub(super) fn plan<P: Patch>(surface: BezierSurface<P>, job: &Job, budget: &Budget) -> Result<Plan, Error> {
    let part = surface.clone();
    let (surface, choice) = choose_engine(surface, job, budget)?;
    let contacts = Contacts::new(&surface, job.cutter(), budget)?;
    let milled = Milled { part: &part.upward(), surface: &surface, contacts: &contacts };
    match choice {
        Choice::Offset(offset) => by_sections(&milled, &offset, Depth::Tolerance, job, budget),
        Choice::OffsetIfClear(offset) => match by_sections(&milled, &offset, Depth::Deviation, job, budget) {
            Err(error) if error.is_obstacle() => by_contact(&milled, None, job, budget),
            planned => planned,
        },
        Choice::Contact(regularity) => by_contact(&milled, regularity, job, budget),
    }
}

/// Turns the normal of the surface up, and chooses how its CL curves are found.
fn choose_engine<P: Patch>(
    surface: BezierSurface<P>,
    job: &Job,
    budget: &Budget,
) -> Result<(BezierSurface<P>, Choice), Error> {
    let (is_ball, by_name) = (job.tool.shape == Shape::Ball, job.engine == Engine::OffsetSection);
    if by_name && !is_ball {
        return Err(Error::NoBall);
    }
    let joints = joints::examine(&surface, &job.surface.loose_joints(), budget);
    let joints = proved(joints.map_err(Error::from), by_name)?;
    let surface = prepared(surface, job)?;
    if !is_ball {
        return Ok((surface, Choice::Contact(None)));
    }
    let regularity = regularity::prove(&surface, job.offset_mm(), job.plane.normal_axis(), budget);
    let regularity = proved(regularity.map_err(Error::from), by_name)?;
    let (joints, regularity) = match (joints, regularity) {
        (Some(joints), Some(regularity)) => (joints, regularity),
        (_, regularity) => return Ok((surface, Choice::Contact(regularity))),
    };
    let seam = seam(&joints, job, regularity.slopes());
    let is_smooth = CONTACT_HEIGHT_SHARE * job.tolerance.mm() >= seam.bend * job.tool.radius_mm;
    let choice = match (by_name, is_smooth) {
        (true, _) => Choice::Offset(Offset { regularity, seam }),
        (false, true) => Choice::OffsetIfClear(Offset { regularity, seam }),
        (false, false) => Choice::Contact(Some(regularity)),
    };
    Ok((surface, choice))
}

/// What a proof found; `None` where it failed and is not needed.
fn proved<T>(proof: Result<T, Error>, is_needed: bool) -> Result<Option<T>, Error> {
    match proof {
        Err(error) if is_needed || matches!(error, Error::Stopped(_)) => Err(error),
        proof => Ok(proof.ok()),
    }
}

/// Plans passes along sections of the offset. Where they stand for passes by contact, they may cut no deeper
/// than they deviate.
fn by_sections<P: Patch>(
    milled: &Milled<P>,
    offset: &Offset,
    depth: Depth,
    job: &Job,
    budget: &Budget,
) -> Result<Plan, Error> {
    let Offset { regularity, seam } = offset;
    let axis = job.plane.normal_axis();
    let sections = Sections::new(milled.surface, job.offset_mm(), axis, regularity, budget)?;
    let found = Found {
        curves: &OffsetCurves { sections, rise: job.tool.radius_mm },
        milled,
        slopes: regularity.slopes().to_vec(),
        seam: *seam,
        chord_height_share: SECTION_HEIGHT_SHARE,
        point_limit: job.point_limit,
        depth,
    };
    plan_with(&found, job, budget)
}

/// Plans by the tips of the cutter in contact. The slopes are those of `regularity`, and sampled without it.
fn by_contact<P: Patch>(
    milled: &Milled<P>,
    regularity: Option<Regularity>,
    job: &Job,
    budget: &Budget,
) -> Result<Plan, Error> {
    let axis = job.plane.normal_axis();
    let sections = TipSections::new(milled.contacts, axis, budget)?;
    let found = Found {
        curves: &ContactCurves { sections, stock: job.allowance_mm },
        milled,
        slopes: match regularity {
            Some(regularity) => regularity.slopes().to_vec(),
            None => scallop::sampled_slopes(milled.surface, job.cutter().corner_radius(), axis, budget)?,
        },
        // The cutter touches edges and gaps as it touches everything else.
        seam: Seam::NONE,
        chord_height_share: CONTACT_HEIGHT_SHARE,
        point_limit: (CONTACT_SHARE * job.point_limit as f64) as usize,
        depth: Depth::Tolerance,
    };
    plan_with(&found, job, budget)
}

/// The surface with its normal up; with the boundary `past`, continued as far as the cutter may touch it.
fn prepared<P: Patch>(surface: BezierSurface<P>, job: &Job) -> Result<BezierSurface<P>, Error> {
    let surface = surface.upward();
    match job.boundary {
        Boundary::Past => surface.continued(job.tool.radius_mm).ok_or(Error::NoWayPast),
        Boundary::Inside | Boundary::On => Ok(surface),
    }
}

/// How far the offset may jump and bend at joints that are smooth only up to the rounding of their data.
fn seam(joints: &Joints, job: &Job, slopes: &[Slope]) -> Seam {
    let least_share = slopes.iter().map(|slope| slope.share).fold(1.0, f64::min);
    Seam { jump: joints.jump(job.offset_mm()), bend: joints.kink / (4.0 * least_share) }
}

/// Passes at a stepover, and what they leave.
struct Spaced {
    passes: Passes,
    stepover_mm: f64,
    left: Left,
}

/// Proved passes and their toolpath.
struct Cut {
    spaced: Spaced,
    toolpath: Toolpath,
    n_not_clear: usize,
    deviation_max_mm: f64,
    penetration: Penetration,
}

/// Passes that deviate by at most a share of the tolerance, at a stepover that leaves no more than the job
/// asks for.
fn space<P: Patch>(
    job: &Job,
    slicer: &Slicer,
    (found, share): (&Found<P>, f64),
    material: &Material<P>,
    budget: &Budget,
) -> Result<Spaced, Error> {
    let allowed = Allowed {
        tolerance: share.min(leftover::deviation_share(job)) * (1.0 - CERTIFICATE_GAP) * job.tolerance.mm(),
        seam: found.seam,
        chord_height_share: found.chord_height_share,
        point_limit: found.point_limit,
    };
    let mut stepovers = Stepovers::new(job, &found.slopes);
    // Every trial but the last chooses the next stepover, so the loop ends.
    loop {
        let cut = || -> Result<Spaced, Error> {
            let planes = slicer.planes(job, stepovers.next(), budget)?;
            let stepover_mm = (planes[1].at - planes[0].at).abs();
            let passes = passes::cut(job, slicer, &planes, allowed, budget)?;
            let left = material.left(job, &passes.passes, stepover_mm, budget)?;
            Ok(Spaced { passes, stepover_mm, left })
        };
        let spaced = cut().map_err(|error| stepovers.or_refused(error))?;
        if stepovers.is_met(spaced.stepover_mm, &spaced.left.reached)? {
            return Ok(spaced);
        }
    }
}

/// Joins passes and proves their depth.
fn join<P: Patch>(
    job: &Job,
    slicer: &Slicer,
    (found, spaced): (&Found<P>, Spaced),
    (cutting, proofs): (&Cutting, &Proofs<P>),
    budget: &Budget,
) -> Result<Cut, Error> {
    let gap = CERTIFICATE_GAP * job.tolerance.mm();
    let passes = &spaced.passes.passes;
    let deviation = passes.iter().fold(Deviation::NONE, |deviation, pass| deviation.or_more(&pass.deviation));
    let deviation_max_mm = deviation.bound_mm;
    let Joined { toolpath, n_not_clear } = links::join(job, cutting, passes, proofs, slicer, budget)?;
    let depth_mm = match found.depth {
        Depth::Tolerance => job.tolerance.mm(),
        Depth::Deviation => deviation_max_mm + gap + job.resolution.step_mm(),
    };
    let penetration = certify(&toolpath, job, &proofs.left, [gap, depth_mm], budget)?;
    Ok(Cut { spaced, toolpath, n_not_clear, deviation_max_mm, penetration })
}

fn plan_with<P: Patch>(found: &Found<P>, job: &Job, budget: &Budget) -> Result<Plan, Error> {
    let Milled { part, surface, contacts } = *found.milled;
    let cutting = job.cutting.above(job.top(surface.top(TOP_ACCURACY_MM, budget)?))?;
    let slicer = Slicer::new(found.curves, job.plane.normal_axis(), inside(surface, job, budget)?);
    let positions = Positions { contacts, inside: inside(surface, job, budget)? };
    let material = Material { part, positions };
    let proofs = Proofs::new(surface, job);
    let cut = |share: f64| {
        let spaced = space(job, &slicer, (found, share), &material, budget)?;
        join(job, &slicer, (found, spaced), (&cutting, &proofs), budget)
    };
    let cut = match cut(1.0) {
        Err(Error::ToleranceNotReached { .. }) if job.cutter().flat_radius() > 0.0 => cut(RIM_SHARE)?,
        cut => cut?,
    };
    let report = report(&cut, job);
    let bounds = surface.patches().iter().map(Patch::bounds).fold(Bounds::EMPTY, |all, own| all.union(&own));
    let is_small = (bounds.max - bounds.min).xy().amax() < 2.0 * job.tool.radius_mm;
    let mut warnings = warnings(job, cut.spaced.passes.left_out, cut.n_not_clear, is_small);
    warnings.extend(leftover::warnings(job, &cut.spaced.left, cut.spaced.stepover_mm, &found.slopes));
    let deviations_mm = passes::deviations_mm(&cut.spaced.passes.passes);
    Ok(Plan { toolpath: cut.toolpath, deviations_mm, report, cutting, warnings })
}

fn report(cut: &Cut, job: &Job) -> Report {
    let Cut { spaced: Spaced { passes, stepover_mm, left }, deviation_max_mm, penetration, .. } = cut;
    let passes = &passes.passes;
    let is_arc = |curve: &&Curve| matches!(curve, Curve::Arc(_));
    let n_arcs = passes.iter().flat_map(|pass| &pass.curves).filter(is_arc).count();
    let proved = |left: &Leftover| Some(left.bound_mm).filter(|bound| bound.is_finite());
    Report {
        n_passes: passes.len(),
        n_cl_points: passes.iter().map(|pass| pass.n_points).sum(),
        stepover_mm: *stepover_mm,
        deviation_max_mm: *deviation_max_mm,
        gouge_max_mm: (penetration.bound_mm - job.allowance_mm).max(0.0),
        gouge_at: penetration.at.filter(|_| penetration.found_mm > job.allowance_mm),
        scallop_max_mm: proved(&left.reached),
        scallop_at: left.reached.place(),
        rest_max_mm: proved(&left.rest),
        rest_at: left.rest.place(),
        n_arcs,
        n_lines: passes.iter().map(|pass| pass.curves.len()).sum::<usize>() - n_arcs,
        elements_per_pass: counts::elements(passes),
    }
}

/// The outline, and the distance in mm that the axis keeps from it; `None` where the boundary is not
/// `inside`.
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

/// Proves how deep the cutter cuts into the surface, as computed and as written: at most `depth_mm` on
/// passes, and at most the tolerance on any move. A deeper cut is an error.
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

fn warnings(job: &Job, left_out: LeftOut, n_not_clear: usize, is_small: bool) -> Vec<Warning> {
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
    if let LeftOut { count: 1.., longest_mm, at } = left_out {
        warnings.push(Warning::ShortPiecesLeftOut { count: left_out.count, longest_mm, at });
    }
    warnings
}

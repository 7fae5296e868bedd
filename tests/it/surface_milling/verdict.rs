//! Judges a plan: compares every figure of its report with a figure that is found without the geometry of the
//! library.

use nalgebra::Vector3;
use toolpathd_core::budget::Budget;
use toolpathd_core::operations::surface_milling::{
    CutDirection, Error, Job, Plan, SectionPlane, Spacing, Stock, Warning, plan,
};

use super::cutter::{Cutter, Depth};
use super::jobs::grid_of;
use super::motion::{Kind, Motion, planned, written};
use super::section::{Locus, Section};
use super::spline::Spline;

/// Largest error of the figures found here, mm.
const ACCURACY_MM: f64 = 1e-6;

/// Largest distance of the samples along a path.
const SAMPLE_MM: f64 = 0.05;

/// A plane that is nearer to the end of the CL points than this, mm, is judged this far inside. At the very
/// end a plane only touches the surface, and rounding decides where.
const OUTERMOST_MM: f64 = 1e-6;

/// How far the CL curves of such a plane may go beyond the path, mm. An arc of 1 m radius with a sagitta of
/// 1e-6 mm has a chord of 0.09 mm.
const OUTERMOST_REACH_MM: f64 = 0.1;

/// Pieces of passes shorter than this share of the cutter's radius may be left out. A warning then states
/// their length.
const LEFT_OUT_SHARE: f64 = 0.1;

/// The figures that were found.
#[derive(Debug, Clone, Copy)]
pub struct Found {
    pub gouge_mm: f64,
    pub deviation_mm: f64,
    pub radius_mismatch_mm: f64,
}

/// Plans `job`, and fails if the plan or its NC text breaks a promise of the report.
pub fn judge(job: &Job) -> Result<(Plan, Found), Error> {
    let plan = plan(job, &Budget::unlimited())?;
    let found = verify(job, &plan);
    Ok((plan, found))
}

fn verify(job: &Job, plan: &Plan) -> Found {
    let normal = match job.plane {
        SectionPlane::Zx => 1,
        SectionPlane::Yz => 0,
    };
    let surface = Spline::through(grid_of(job));
    let passes = planned(plan);
    let text = written(job, plan);
    let moves = || passes.iter().flatten().copied();
    counts_are_true(plan, &passes);
    order_is_kept(job, &passes, normal);

    let cutter = Cutter::new(&surface, job.tool.radius_mm);
    let retract = plan.cutting.retract_z_mm;
    if job.cutting.retract_z_mm.is_none() {
        let top = match job.stock {
            None => cutter.top(),
            Some(Stock::OnSurface { thickness_mm }) => cutter.top() + thickness_mm,
            Some(Stock::Block { top_z_mm }) => cutter.top().max(top_z_mm),
        };
        assert!((retract - 2.0 - top).abs() < 0.01, "the retract plane at {retract} is not 2 mm above {top}");
    }
    let step = job.resolution.step_mm();
    rapids_keep_up(moves(), &cutter, job, retract - 1e-9);
    rapids_keep_up(text.iter().copied(), &cutter, job, retract - 0.5 * step - 1e-9);

    let gouge_mm = gouge(&cutter, moves().map(|m| m.1).collect(), job, plan)
        .max(gouge(&cutter, text.iter().flat_map(|m| m.1.extremes()).collect(), job, plan))
        .max(0.0);
    assert!(
        plan.report.gouge_max_mm <= 2.0 * gouge_mm + 0.001,
        "{gouge_mm} found, far less than stated: {:?}",
        plan.report
    );

    let left_out_mm = left_out(job, plan);
    let locus = Locus::new(&surface, job.tool.radius_mm, normal);
    let planes = planes(moves(), normal);
    let extent = locus.extent();
    let mut deviation_mm: f64 = 0.0;
    for &offset in &planes {
        let inner = offset.clamp(extent[0] + OUTERMOST_MM, extent[1] - OUTERMOST_MM);
        let section = locus.section(inner);
        let as_written = cuts(text.iter().copied(), normal, offset, step);
        for path in [cuts(moves(), normal, offset, 1e-9), as_written] {
            deviation_mm = deviation_mm.max(path_to_curves(&section, &path));
            let back = curves_to_path(&section, &path, job.tolerance.mm(), left_out_mm);
            if inner == offset {
                deviation_mm = deviation_mm.max(back);
            } else {
                assert!(back < OUTERMOST_REACH_MM, "plane {offset}: the CL curve is {back} mm from the path");
            }
        }
        let allowed = plan.report.deviation_max_mm + 2.0 * OUTERMOST_MM;
        assert!(
            deviation_mm <= allowed,
            "plane {offset}: a deviation of {deviation_mm} found, more than stated: {:?}",
            plan.report
        );
    }
    assert!(
        plan.report.deviation_max_mm <= job.tolerance.mm() * (1.0 + 1e-12),
        "the stated deviation exceeds the tolerance: {:?}",
        plan.report
    );
    let radius_mismatch_mm = text.iter().map(|m| m.1.radius_mismatch()).fold(0.0, f64::max);
    assert!(
        radius_mismatch_mm <= 1.5 * job.resolution.step_mm() + 1e-9,
        "the radii of an arc differ by {radius_mismatch_mm}"
    );
    planes_reach_from_end_to_end(job, &planes, &locus);
    Found { gouge_mm, deviation_mm, radius_mismatch_mm }
}

fn counts_are_true(plan: &Plan, passes: &[Vec<(Kind, Motion)>]) {
    let is = |kind: Kind| move |m: &&(Kind, Motion)| m.0 == kind;
    let all: Vec<_> = passes.iter().flatten().collect();
    let turns = all.iter().filter(|m| matches!(m, (Kind::Cut, Motion::Turn(_)))).count();
    let cuts = all.iter().copied().filter(is(Kind::Cut)).count();
    let report = &plan.report;
    assert_eq!((report.n_arcs, report.n_arcs + report.n_lines), (turns, cuts));
    assert_eq!(report.n_passes, passes.iter().filter(|pass| pass.iter().any(|m| m.0 == Kind::Cut)).count());
    assert!(report.n_cl_points >= cuts + report.n_passes);
}

/// Fails unless all passes of a one-way path run in one direction without links, and passes in neighbouring
/// planes of a zigzag path run in opposite directions.
fn order_is_kept(job: &Job, passes: &[Vec<(Kind, Motion)>], normal: usize) {
    let runs: Vec<_> = passes
        .iter()
        .filter_map(|pass| {
            let cuts: Vec<_> = pass.iter().filter(|m| m.0 == Kind::Cut).collect();
            let (from, to) = (cuts.first()?.1.at(0.0), cuts.last()?.1.at(1.0));
            Some((from[normal], to[1 - normal] > from[1 - normal]))
        })
        .collect();
    match job.direction {
        CutDirection::OneWay => {
            assert!(runs.iter().all(|run| run.1 == runs[0].1), "the passes run in both directions: {runs:?}");
            assert!(passes.iter().flatten().all(|m| m.0 != Kind::Link), "a one-way path has a link");
        }
        CutDirection::Zigzag => {
            let is_kept = |two: &[(f64, bool)]| (two[0].0 == two[1].0) == (two[0].1 == two[1].1);
            assert!(runs.windows(2).all(is_kept), "neighbouring passes run in the same direction: {runs:?}");
        }
    }
}

/// Fails unless rapids below the retract plane are vertical, and rapids down end at least 2 mm above the
/// surface.
fn rapids_keep_up(moves: impl Iterator<Item = (Kind, Motion)>, cutter: &Cutter, job: &Job, floor: f64) {
    for (kind, motion) in moves {
        if kind == Kind::Rapid {
            let (from, to) = (motion.at(0.0), motion.at(1.0));
            let (is_straight, is_lift) = (from.xy() == to.xy(), to.z >= from.z);
            assert!(
                (to.z >= floor && from.z >= floor) || is_straight,
                "the rapid from {from} to {to} is below {floor} and not vertical"
            );
            if is_straight && !is_lift {
                let under = to - Vector3::z() * (2.0 - job.resolution.step_mm());
                let mut depth = Depth::NONE;
                cutter.follow(&Motion::Straight { from, to: under }, &mut depth);
                assert!(depth.mm <= job.tolerance.mm() + ACCURACY_MM, "{to} is {} mm too low", depth.mm);
            }
        }
    }
}

/// The deepest penetration of a path, mm. Fails if it is above the tolerance or the stated gouge.
fn gouge(cutter: &Cutter, motions: Vec<Motion>, job: &Job, plan: &Plan) -> f64 {
    let mut depth = Depth::NONE;
    for motion in &motions {
        cutter.follow(motion, &mut depth);
    }
    let Depth { mm, tip } = depth;
    assert!(mm <= job.tolerance.mm() + ACCURACY_MM, "{mm} mm deep at {tip}, more than the tolerance");
    assert!(
        mm <= plan.report.gouge_max_mm + ACCURACY_MM,
        "{mm} mm deep at {tip}, more than stated: {:?}",
        plan.report
    );
    mm
}

/// The normal coordinates of the planes that are cut, sorted, mm.
fn planes(moves: impl Iterator<Item = (Kind, Motion)>, normal: usize) -> Vec<f64> {
    let mut planes: Vec<f64> = Vec::new();
    for (kind, motion) in moves {
        if kind == Kind::Cut {
            let offset = motion.at(0.0)[normal];
            assert!((motion.at(1.0)[normal] - offset).abs() < 1e-9, "the cut at {offset} leaves its plane");
            if planes.iter().all(|p| (p - offset).abs() > 1e-9) {
                planes.push(offset);
            }
        }
    }
    planes.sort_by(f64::total_cmp);
    planes
}

/// The length of the longest piece of a pass that may be left out, mm: the length that the warning states.
/// Without a warning, only pieces that vanish in rounding may be left out.
fn left_out(job: &Job, plan: &Plan) -> f64 {
    let stated = plan.warnings.iter().find_map(|warning| match warning {
        Warning::ShortPiecesLeftOut { longest_mm, .. } => Some(*longest_mm),
        _ => None,
    });
    let most = LEFT_OUT_SHARE * job.tool.radius_mm;
    assert!(stated.is_none_or(|mm| mm < most), "a piece of {stated:?} mm is left out, more than {most} mm");
    stated.unwrap_or(0.0).max(vanishing_mm(job))
}

/// The length up to which a piece of a pass vanishes in rounding, mm.
fn vanishing_mm(job: &Job) -> f64 {
    2.0 * job.resolution.step_mm() + ACCURACY_MM
}

/// Fails unless the planes are equally spaced, no farther apart than the stepover, and the first and the last
/// are where the CL points end. At a sharp corner they may be farther inside, but only if a plane half as far
/// inside holds no CL curve long enough to be cut: pieces of a tenth of the radius are left out.
fn planes_reach_from_end_to_end(job: &Job, planes: &[f64], locus: &Locus) {
    let (first, last, extent) = (planes[0], planes[planes.len() - 1], locus.extent());
    let reaches = [(first, extent[0]), (last, extent[1])].into_iter().all(|(plane, end)| {
        let before = locus.section(0.5 * (plane + end));
        let shortest = vanishing_mm(job).max(LEFT_OUT_SHARE * job.tool.radius_mm);
        (plane - end).abs() < 0.01 || before.points().all(|p| before.is_speck(p, shortest))
    });
    assert!(reaches, "the planes {planes:?} do not reach the ends {extent:?} of the CL points");
    let spacing = (last - first) / (planes.len() - 1) as f64;
    let Spacing::Stepover(stepover_mm) = job.spacing else { panic!("{:?}", job.spacing) };
    assert!(spacing <= stepover_mm + 1e-9, "the planes are {spacing} apart, the stepover is {stepover_mm}");
    for (k, plane) in planes.iter().enumerate() {
        // The outermost planes may be moved inward a little.
        assert!(
            (plane - first - k as f64 * spacing).abs() < 0.01,
            "the planes are not equally spaced: {planes:?}"
        );
    }
}

fn cuts(moves: impl Iterator<Item = (Kind, Motion)>, normal: usize, offset: f64, within: f64) -> Vec<Motion> {
    moves
        .filter(|m| m.0 == Kind::Cut && (m.1.at(0.0)[normal] - offset).abs() <= within)
        .map(|m| m.1)
        .collect()
}

/// The largest distance of a point of the path from the CL curves, mm.
fn path_to_curves(section: &Section, path: &[Motion]) -> f64 {
    let mut largest: f64 = 0.0;
    for motion in path {
        let samples = (motion.length() / SAMPLE_MM).ceil() as usize + 1;
        for k in 0..=samples {
            largest = largest.max(section.distance(&motion.at(k as f64 / samples as f64)));
        }
    }
    largest
}

/// The largest distance of a point of the CL curves from the path, mm. Chains up to `left_out_mm` mm long are
/// left out.
fn curves_to_path(section: &Section, path: &[Motion], tolerance: f64, left_out_mm: f64) -> f64 {
    assert!(!path.is_empty(), "nothing is cut at {}", section.offset);
    let mut largest: f64 = 0.0;
    // The motion that was nearest to the last point is usually nearest again. A point that is nearer to some
    // motion than the largest distance so far cannot change the result.
    let mut last = 0;
    for p in section.points() {
        let mut nearest = path[last].distance(p);
        for (k, motion) in path.iter().enumerate() {
            if nearest <= largest {
                break;
            }
            let distance = motion.distance(p);
            if distance < nearest {
                (nearest, last) = (distance, k);
            }
        }
        if nearest > tolerance && section.is_speck(p, left_out_mm + ACCURACY_MM) {
            continue;
        }
        largest = largest.max(nearest);
    }
    largest
}

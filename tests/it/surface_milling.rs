//! Tests of surface milling. They judge paths by evaluators of their own: dense samples, root finding and
//! local minimisation.

mod approach;
mod blocks;
mod contact;
mod corruption;
mod cutter;
mod jobs;
mod kinds;
mod motion;
mod seams;
mod section;
mod sharpness;
mod spline;
mod variants;
mod verdict;

use toolpathd_core::budget::Budget;
use toolpathd_core::geometry::surface::point_grid::Ends;
use toolpathd_core::operations::surface_milling::{
    CutDirection, Engine, Error, Interpolation, Job, SectionPlane, Spacing, plan,
};
use toolpathd_core::toolpath::units::Tolerance;

use jobs::{PLANES, die, freeform, heights, job, points};
use motion::{Kind, Motion, planned};
use verdict::judge;

fn the_die_keeps_its_promises(plane: SectionPlane, direction: CutDirection) {
    let (plan, found) = judge(&die(plane, direction)).unwrap();
    let report = &plan.report;
    assert!(report.n_arcs * 10 >= (report.n_arcs + report.n_lines) * 6, "less than 60 % arcs: {report:?}");
    assert!(found.radius_mismatch_mm <= 0.0015, "the radii of an arc differ too much: {found:?}");
    // The path must use its tolerance. A deviation of a third or less means far too many moves.
    assert!(found.deviation_mm > 0.003, "the path is much finer than its tolerance: {found:?}");
}

#[test]
fn the_die_is_cut_mostly_by_arcs_within_its_report_in_zx_planes_zigzag() {
    the_die_keeps_its_promises(SectionPlane::Zx, CutDirection::Zigzag);
}

#[test]
fn the_die_is_cut_mostly_by_arcs_within_its_report_in_zx_planes_one_way() {
    the_die_keeps_its_promises(SectionPlane::Zx, CutDirection::OneWay);
}

#[test]
fn the_die_is_cut_mostly_by_arcs_within_its_report_in_yz_planes_zigzag() {
    the_die_keeps_its_promises(SectionPlane::Yz, CutDirection::Zigzag);
}

#[test]
fn the_die_is_cut_mostly_by_arcs_within_its_report_in_yz_planes_one_way() {
    the_die_keeps_its_promises(SectionPlane::Yz, CutDirection::OneWay);
}

#[test]
fn the_freeform_is_cut_within_its_report_in_every_plane_and_direction() {
    for plane in PLANES {
        for direction in [CutDirection::Zigzag, CutDirection::OneWay] {
            judge(&freeform(plane, direction)).unwrap();
        }
    }
}

#[test]
fn each_pass_over_a_spherical_cap_is_one_arc() {
    // The corners of the square slope by 60 degrees.
    let half = 40.0 * 0.75f64.sqrt() / 2f64.sqrt();
    let cap = |x: f64, y: f64| (1600.0 - x * x - y * y).sqrt();
    let surface = heights(61, [-half, half], Ends::NotAKnot, cap);
    for (plane, normal) in [(SectionPlane::Zx, 1), (SectionPlane::Yz, 0)] {
        let job = Job { plane, ..job(surface.clone(), 10.0, 4.0, 1e-3, 4) };
        let (plan, found) = judge(&job).unwrap();
        // Links between passes may gouge up to the tolerance.
        assert!(
            found.gouge_mm < 5e-4 && found.deviation_mm < 2e-4,
            "the path is not the exact arc: {found:?}"
        );
        // The offset surface is 45/40 times as wide as the cap.
        assert!(plan.report.n_passes >= (2.0 * half * 45.0 / 40.0 / 4.0) as usize);
        for pass in planned(&plan) {
            let cuts: Vec<_> = pass.iter().filter(|m| m.0 == Kind::Cut).map(|m| m.1).collect();
            let [Motion::Turn(turn)] = cuts[..] else { panic!("not one arc: {cuts:?}") };
            let offset = turn.center[normal];
            let radius = (2025.0 - offset * offset).sqrt();
            assert!((turn.radii[0] - radius).abs() < 1e-4, "the radius should be {radius}: {turn:?}");
            assert!(
                (turn.center.z + 5.0).abs() < 5e-4 && turn.center[1 - normal].abs() < 5e-4,
                "the centre is wrong: {turn:?}"
            );
        }
    }
}

#[test]
fn offset_section_refuses_a_trough_tighter_than_the_ball_at_its_bottom() {
    // The radius of curvature at x = 0 is 1.25 mm and that of the ball 2.5 mm. The trough is tighter than the
    // ball for
    // |x| < 0.64.
    let surface = heights(9, [-4.0, 4.0], Ends::NotAKnot, |x, _| 0.4 * x * x);
    for plane in PLANES {
        for direction in [CutDirection::Zigzag, CutDirection::OneWay] {
            let engine = Engine::OffsetSection;
            let job = Job { plane, direction, engine, ..job(surface.clone(), 5.0, 1.0, 0.01, 3) };
            let refused = plan(&job, &Budget::unlimited());
            let Err(Error::OffsetFolds { at }) = refused else {
                panic!("not refused as folded: {refused:?}")
            };
            assert!(at.x.abs() < 0.65 && at.y.abs() <= 4.0 && at.z.abs() < 0.2, "the fold is not at {at}");
        }
        // A ball that fits is not refused.
        judge(&Job { plane, ..job(surface.clone(), 2.4, 1.0, 0.01, 3) }).unwrap();
    }
}

fn with_tolerance(tolerance_mm: f64, decimals: u8, plane: SectionPlane) -> Job {
    let tolerance = Tolerance::from_mm(tolerance_mm).unwrap();
    let mut job = Job { tolerance, spacing: Spacing::Stepover(8.0), ..die(plane, CutDirection::Zigzag) };
    job.resolution.decimals = decimals;
    job
}

#[test]
fn a_fine_tolerance_is_kept_and_takes_more_arcs() {
    for plane in PLANES {
        let (fine, found) = judge(&with_tolerance(1e-3, 5, plane)).unwrap();
        assert!(found.deviation_mm > 3e-4, "the path is much finer than its tolerance: {found:?}");
        let usual = plan(&with_tolerance(0.01, 3, plane), &Budget::unlimited()).unwrap();
        assert!(
            fine.report.n_arcs > usual.report.n_arcs,
            "not more arcs: {:?}, usual: {:?}",
            fine.report,
            usual.report
        );
    }
}

#[test]
fn a_coarse_tolerance_is_kept_from_end_to_end_and_takes_fewer_arcs() {
    for plane in PLANES {
        let (coarse, found) = judge(&with_tolerance(0.1, 3, plane)).unwrap();
        assert!(found.deviation_mm > 0.03, "the path is much finer than its tolerance: {found:?}");
        let usual = plan(&with_tolerance(0.01, 3, plane), &Budget::unlimited()).unwrap();
        assert!(
            coarse.report.n_arcs < usual.report.n_arcs,
            "not fewer arcs: {:?}, usual: {:?}",
            coarse.report,
            usual.report
        );
    }
}

#[test]
fn the_deviation_counts_how_far_rounding_moves_the_ends() {
    // Rounding moves every coordinate of the ends by 0.4 units of the last decimal, along x outward or
    // inward.
    for outward in [0.0004, -0.0004] {
        let mut plate = job(heights(4, [0.0, 11.0], Ends::Natural, |_, _| 0.0004), 2.0, 5.5, 0.01, 3);
        for point in points(&mut plate) {
            point.x += outward * (1.0 - point.x / 5.5);
            point.y += 0.0004;
        }
        let (_, found) = judge(&plate).unwrap();
        assert!(
            (found.deviation_mm - 0.0004 * 3f64.sqrt()).abs() < 2e-6,
            "ends shifted by {outward}: the deviation should be 0.0004 times the root of 3: {found:?}"
        );
    }
}

#[test]
fn paths_interpolated_by_lines_have_no_arcs_and_keep_their_report() {
    let interpolation = Interpolation::Lines;
    let job =
        Job { interpolation, spacing: Spacing::Stepover(8.0), ..die(SectionPlane::Zx, CutDirection::Zigzag) };
    let (plan, _) = judge(&job).unwrap();
    assert_eq!(plan.report.n_arcs, 0);
    let motions: Vec<_> = planned(&plan).into_iter().flatten().collect();
    assert!(motions.iter().all(|m| matches!(m.1, Motion::Straight { .. })));
    let freeform = Job { interpolation, ..freeform(SectionPlane::Yz, CutDirection::OneWay) };
    assert_eq!(judge(&freeform).unwrap().0.report.n_arcs, 0);
}

#[test]
fn no_two_cl_points_are_farther_apart_than_the_step_length() {
    for step_length in [0.05, 0.4] {
        for interpolation in [Interpolation::Arcs, Interpolation::Lines] {
            let mut job = freeform(SectionPlane::Zx, CutDirection::Zigzag);
            (job.step_length_mm, job.interpolation, job.spacing) =
                (Some(step_length), interpolation, Spacing::Stepover(1.5));
            let (plan, _) = judge(&job).unwrap();
            let cuts: Vec<_> =
                planned(&plan).into_iter().flatten().filter(|m| m.0 == Kind::Cut).map(|m| m.1).collect();
            let length: f64 = cuts.iter().map(Motion::length).sum();
            let least = (0.999 * length / step_length).ceil() as usize;
            assert!(plan.report.n_cl_points >= least, "{least} CL points are needed: {:?}", plan.report);
        }
    }
}

//! Any surface is milled within its tolerance or refused with a named error, in bounded time.

use std::time::{Duration, Instant};

use nalgebra::Point3;
use proptest::prelude::*;
use toolpathd_core::budget::{Budget, Stopped};
use toolpathd_core::geometry::surface::point_grid::{Ends, PointGrid, Twist};
use toolpathd_core::geometry::surface::source::Source;
use toolpathd_core::operations::surface_milling::{
    CutDirection, Engine, Error, Interpolation, Job, Plan, SectionPlane, plan,
};
use toolpathd_core::toolpath::tool::Tool;
use toolpathd_core::toolpath::units::{FeedRate, Tolerance};

/// Random grids of points: a square grid with the given pitch (mm), with shifted points and random heights.
fn grid(rows: usize, columns: usize, pitch: impl Strategy<Value = f64>) -> impl Strategy<Value = PointGrid> {
    let jitter = prop_oneof![3 => Just(0.0), 2 => Just(0.2), 1 => Just(1.5)];
    let heights = prop_oneof![2 => Just(0.0), 3 => Just(0.3), 1 => Just(3.0)];
    let noise = prop::collection::vec((-1.0f64..1.0, -1.0f64..1.0, -1.0f64..1.0), rows * columns);
    let twist = prop_oneof![Just(Twist::Spline), Just(Twist::Zero)];
    let ends = prop_oneof![Just(Ends::Natural), Just(Ends::NotAKnot), Just(Ends::Bessel)];
    (jitter, heights, pitch, noise, twist, ends).prop_map(
        move |(jitter, heights, pitch, noise, twist, ends)| {
            let point = |i: usize, j: usize| {
                let (x, y, z) = noise[i * columns + j];
                Point3::new(i as f64 + jitter * x, j as f64 + jitter * y, heights * z) * pitch
            };
            let points = (0..rows).map(|i| (0..columns).map(|j| point(i, j)).collect()).collect();
            PointGrid { points, twist, ends }
        },
    )
}

/// Random jobs over grids with the given pitch (mm). The tolerance is at least `least_tolerance` times the
/// part's width.
fn job(pitch: impl Strategy<Value = f64> + Clone, least_tolerance: f64) -> impl Strategy<Value = Job> {
    let grids =
        (2usize..6, 2usize..6).prop_flat_map(move |(rows, columns)| grid(rows, columns, pitch.clone()));
    let plane = prop_oneof![Just(SectionPlane::Zx), Just(SectionPlane::Yz)];
    let direction = prop_oneof![Just(CutDirection::OneWay), Just(CutDirection::Zigzag)];
    let interpolation = prop_oneof![Just(Interpolation::Arcs), Just(Interpolation::Lines)];
    let tolerance = prop_oneof![Just(0.0015), Just(0.01), Just(1.0)];
    (grids, 0.01f64..20.0, plane, 0.05f64..2.0, direction, tolerance, interpolation).prop_map(
        move |(surface, radius_mm, plane, stepover, direction, tolerance, interpolation)| {
            let width = |c: usize| {
                let values = || surface.points.iter().flatten().map(move |p| p[c]);
                values().fold(f64::NEG_INFINITY, f64::max) - values().fold(f64::INFINITY, f64::min)
            };
            let width = width(0).max(width(1));
            let stepover_mm = stepover * width / 4.0;
            let radius_mm = radius_mm.min(LARGEST_RADIUS * width);
            let tolerance = Tolerance::from_mm(least_tolerance.mul_add(width, tolerance)).unwrap();
            let feed = FeedRate::from_mm_per_min(1000.0).unwrap();
            let job =
                Job::new(Source::PointGrid(surface), Tool::ball(radius_mm), stepover_mm, tolerance, feed);
            Job { plane, direction, interpolation, ..job }
        },
    )
}

/// Most tries to plan in time. A busy machine delays some of them, and a planner that does not look at its
/// deadline is late in all.
const TRIES: usize = 5;

/// Plans a job with a deadline. Returns the result and the time that planning took.
fn planned(job: &Job, deadline: Duration) -> (Result<Plan, Error>, Duration) {
    let begun = Instant::now();
    let result = plan(job, &Budget::unlimited().with_deadline(begun + deadline));
    (result, begun.elapsed())
}

/// Whether a result is a plan within the tolerance, or a refusal that says what is wrong with the surface.
fn keeps_the_law(job: &Job, result: &Result<Plan, Error>) -> bool {
    match result {
        Ok(Plan { report, .. }) => {
            let worst = report.deviation_max_mm.max(report.gouge_max_mm);
            worst <= job.tolerance.mm() && report.n_passes > 0
        }
        Err(
            Error::Overhang { .. }
            | Error::OffsetFolds { .. }
            | Error::NothingToCut
            | Error::ToleranceNotReached { .. }
            | Error::ScallopNotReached { .. }
            | Error::TooMuchWork { .. },
        ) => true,
        // The contact engine cannot trace some sections of a sheet that is folded in its own plane.
        Err(Error::SectionLost { .. }) => job.engine == Engine::Contact,
        Err(_) => false,
    }
}

/// Largest radius of a cutter, as a multiple of the part's width. The service refuses parts that are smaller.
const LARGEST_RADIUS: f64 = 10.0;

const ENGINES: [Engine; 2] = [Engine::Contact, Engine::OffsetSection];

/// Least tolerance, as a fraction of the part's width. A finer tolerance takes longer and tests the same
/// shapes.
const LEAST_TOLERANCE: f64 = 5e-4;

/// Deadline for a part of ordinary size. A part that is stopped by it fails the test. All parts of the test
/// together take 100 s on an idle machine of two cores.
const LONGEST: Duration = Duration::from_secs(900);

/// The longest search for a smaller case that fails too, in milliseconds.
const SHRINK_MS: u32 = 60_000;

/// Deadline for a part of micrometres or of many metres.
const DEADLINE: Duration = Duration::from_millis(200);

/// Longest time between this deadline and the end of planning.
const MOST_AFTER: Duration = Duration::from_secs(1);

proptest! {
    #![proptest_config(ProptestConfig { cases: 60, max_shrink_time: SHRINK_MS, ..ProptestConfig::default() })]

    #[test]
    fn any_part_is_milled_within_its_tolerance_or_refused(job in job(1.0..20.0, LEAST_TOLERANCE)) {
        for engine in ENGINES {
            let job = Job { engine, ..job.clone() };
            let (result, took) = planned(&job, LONGEST);
            prop_assert!(
                keeps_the_law(&job, &result),
                "{engine:?} after {took:?}: neither within the tolerance nor refused: {:?}", result.map(|p| p.report)
            );
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, max_shrink_time: SHRINK_MS, ..ProptestConfig::default() })]

    #[test]
    fn a_part_of_micrometres_or_many_metres_is_milled_or_refused_or_stopped_at_the_deadline(
        job in job(prop_oneof![Just(0.001), Just(3e4)], 0.0),
    ) {
        for engine in ENGINES {
            let job = Job { engine, ..job.clone() };
            let latest = DEADLINE + MOST_AFTER;
            let mut plans = (0..TRIES).map(|_| planned(&job, DEADLINE));
            let in_time = plans.find(|(_, took)| *took < latest);
            prop_assert!(in_time.is_some(), "{engine:?} ended {TRIES} times later than {latest:?}");
            let Some((result, _)) = in_time else { continue };
            let is_stopped = matches!(result, Err(Error::Stopped(Stopped::DeadlinePassed)));
            prop_assert!(
                is_stopped || keeps_the_law(&job, &result),
                "{engine:?}: neither within the tolerance nor refused nor stopped: {:?}", result.map(|p| p.report)
            );
        }
    }
}

//! Input that has no pocket, or one that is hard to plan.

use toolpathd_core::budget::Budget;
use toolpathd_core::geometry::region::OutlineError;
use toolpathd_core::operations::pocketing::{Job, Plan, PocketError, Warning, plan};
use toolpathd_core::toolpath::tool::{Shape, Tool};

use super::area::Area;
use super::cases::{self, Case, PATTERNS, SLOT_FEED, box_at, circle_at, job, pocket, polygon};
use super::sweep::judge;

fn planned(job: &Job) -> Result<Plan, PocketError> {
    plan(job, &Budget::unlimited())
}

fn refused(case: &Case) -> PocketError {
    planned(&job(case, &PATTERNS, None)).map(|plan| plan.report).unwrap_err()
}

/// Plans with all patterns, and asserts that the plan is sound.
fn assert_cleared(case: &Case) {
    let job = job(case, &PATTERNS, Some(SLOT_FEED));
    let plan = planned(&job).unwrap_or_else(|error| panic!("{error} for {case:?}"));
    let verdict = judge(case, &Area::new(case), &job, &plan);
    assert!(verdict.faults.is_empty(), "{verdict:#?} for {case:?}");
}

#[test]
fn a_tool_that_fits_nowhere_is_refused_with_the_largest_that_fits() {
    let slot = pocket(box_at(0.0, 0.0, 60.0, 9.0), vec![]);
    match refused(&slot) {
        PocketError::ToolTooLarge { diameter_mm, largest_mm, at } => {
            assert_eq!(diameter_mm, 10.0);
            assert!((largest_mm - 9.0).abs() < 0.05, "{largest_mm}");
            assert!((at.y - 4.5).abs() < 0.05 && at.x > 4.4 && at.x < 55.6, "{at}");
        }
        other => panic!("{other:?}"),
    }
    let largest = Case { diameter_mm: 8.9, stepover_mm: 2.0, ..slot };
    assert!(planned(&job(&largest, &PATTERNS, None)).is_ok());
}

#[test]
fn an_outline_without_area_is_refused() {
    for flat in [[[0.0, 0.0], [50.0, 0.0], [20.0, 0.0]], [[0.0, 0.0], [50.0, 50.0], [20.0, 20.0]]] {
        let error = refused(&pocket(polygon(&flat), vec![]));
        let expected = PocketError::Outline { island: None, error: OutlineError::NoArea };
        assert_eq!(error, expected);
    }
    let flat = polygon(&[[10.0, 10.0], [20.0, 10.0]]);
    let error = refused(&pocket(box_at(0.0, 0.0, 60.0, 40.0), vec![box_at(30.0, 10.0, 5.0, 5.0), flat]));
    assert_eq!(error, PocketError::Outline { island: Some(1), error: OutlineError::NoArea });
}

#[test]
fn an_outline_that_crosses_itself_is_refused_with_the_place() {
    let eight = polygon(&[[0.0, 0.0], [60.0, 40.0], [60.0, 0.0], [0.0, 30.0]]);
    // The lines y = 2x/3 and y = 30 - x/2 meet at x = 180/7.
    let [x, y] = [180.0 / 7.0, 120.0 / 7.0];
    let error = refused(&pocket(eight.clone(), vec![]));
    let PocketError::Outline { island: None, error: OutlineError::Crosses { at } } = error else {
        panic!("{error:?}");
    };
    assert!((at.x - x).hypot(at.y - y) < 1e-6, "{at}");
    let error = refused(&pocket(box_at(-20.0, -20.0, 100.0, 80.0), vec![eight]));
    let PocketError::Outline { island: Some(0), error: OutlineError::Crosses { at } } = error else {
        panic!("{error:?}");
    };
    assert!((at.x - x).hypot(at.y - y) < 1e-6, "{at}");
}

#[test]
fn an_island_that_swallows_the_pocket_leaves_nothing_to_cut() {
    for island in [box_at(-5.0, -5.0, 70.0, 50.0), circle_at(30.0, 20.0, 40.0)] {
        assert_eq!(refused(&pocket(box_at(0.0, 0.0, 60.0, 40.0), vec![island])), PocketError::NothingToCut);
    }
}

#[test]
fn an_island_that_leaves_a_narrow_ring_is_a_tool_that_is_too_large() {
    let error = refused(&pocket(circle_at(0.0, 0.0, 40.0), vec![circle_at(0.0, 0.0, 31.0)]));
    let PocketError::ToolTooLarge { largest_mm, at, .. } = error else { panic!("{error:?}") };
    assert!((largest_mm - 9.0).abs() < 0.05, "{largest_mm}");
    assert!((at.coords.norm() - 35.5).abs() < 0.05, "{at}");
}

#[test]
fn a_pocket_far_from_the_origin_is_cleared() {
    let far = |outline: Vec<[f64; 3]>| outline.iter().map(|v| [v[0] + 1e5, v[1] - 1e5, v[2]]).collect();
    for case in [cases::arcs(), cases::islands_on_walls()] {
        let islands = case.islands.clone().into_iter().map(far).collect();
        let case = Case { boundary: far(case.boundary.clone()), islands, ..case };
        let area = Area::new(&case);
        for pattern in PATTERNS {
            let job = job(&case, &[pattern], Some(SLOT_FEED));
            let plan = planned(&job).unwrap();
            let verdict = judge(&case, &area, &job, &plan);
            assert!(verdict.faults.is_empty(), "{pattern:?}: {verdict:#?}");
        }
    }
}

#[test]
fn a_tool_that_cannot_come_down_is_refused_with_the_largest_that_can() {
    // The centre may move by 0.1 mm: too little for the smallest helix of 2.5 mm, and for a ramp.
    let tight = pocket(box_at(0.0, 0.0, 10.1, 10.1), vec![]);
    let mut job = job(&tight, &PATTERNS, None);
    job.entry.plunge = true;
    assert!(planned(&job).is_ok(), "the plunge is not taken");
    job.entry.plunge = false;
    match planned(&job).map(|plan| plan.report) {
        Err(PocketError::NoEntry { at, least_mm, largest_mm }) => {
            assert_eq!(least_mm, 2.5);
            assert!((largest_mm - 7.6).abs() < 0.1, "{largest_mm}");
            assert!((5.0 - 1e-6..=5.1 + 1e-6).contains(&at.x), "{at}");
            job.tool = Tool { shape: Shape::Flat, ..Tool::ball(0.5 * largest_mm) };
            assert!(planned(&job).is_ok(), "a tool of {largest_mm} mm does not come down");
        }
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_neck_that_the_tool_does_not_pass_is_reported_with_its_place_and_area() {
    let plan = planned(&job(&cases::dumbbell(8.0), &PATTERNS, None)).unwrap();
    // The neck of 20 mm by 8 mm, less what the disc between its corners frees at both of its ends.
    let freed = 25.0 * 0.8f64.asin() - 12.0;
    let [place] = plan.report.levels[0].not_reached[..] else { panic!("{:?}", plan.report) };
    assert!((place.area_mm2 - (160.0 - 2.0 * freed)).abs() < 1e-3, "{place:?}");
    assert!((place.at.x - 50.0).hypot(place.at.y - 20.0) < 1e-3, "{place:?}");
    assert_eq!(plan.warnings, [Warning::PlacesNotReached { count: 1, largest: place }]);
    let wider = planned(&job(&cases::dumbbell(10.2), &PATTERNS, None)).unwrap();
    assert!(
        wider.report.levels[0].not_reached.is_empty() && wider.warnings.is_empty(),
        "{:?}",
        wider.warnings
    );
}

#[test]
fn islands_that_touch_walls_or_each_other_are_cleared_around() {
    let triangle = polygon(&[[0.0, 30.0], [20.0, 20.0], [20.0, 40.0]]);
    for islands in [
        vec![box_at(0.0, 15.0, 20.0, 20.0)],
        vec![triangle],
        vec![box_at(30.0, 20.0, 10.0, 15.0), box_at(40.0, 20.0, 10.0, 15.0)],
        vec![box_at(30.0, 15.0, 10.0, 10.0), box_at(40.0, 25.0, 10.0, 10.0)],
        vec![box_at(30.0, 15.0, 20.0, 15.0), box_at(30.0, 15.0, 20.0, 15.0)],
        vec![box_at(30.0, 15.0, 20.0, 15.0), box_at(35.0, 20.0, 5.0, 5.0)],
        vec![box_at(70.0, 15.0, 10.0, 15.0)],
    ] {
        assert_cleared(&pocket(box_at(0.0, 0.0, 70.0, 50.0), islands));
    }
}

#[test]
fn an_island_across_the_whole_pocket_leaves_two_pockets() {
    assert_cleared(&pocket(box_at(0.0, 0.0, 70.0, 30.0), vec![box_at(30.0, -5.0, 10.0, 40.0)]));
}

#[test]
fn outlines_with_vertices_that_change_nothing_are_cleared() {
    for corners in [
        [[0.0, 0.0], [70.0, 0.0], [70.0, 0.0], [70.0, 50.0], [0.0, 50.0]],
        [[0.0, 0.0], [70.0, 0.0], [70.0, 1e-9], [70.0, 50.0], [0.0, 50.0]],
        [[0.0, 0.0], [30.0, 0.0], [70.0, 0.0], [70.0, 50.0], [0.0, 50.0]],
    ] {
        assert_cleared(&pocket(polygon(&corners), vec![]));
    }
}

#[test]
fn an_outline_that_runs_back_along_itself_is_refused_with_a_place_on_the_spike() {
    let corners =
        [[0.0, 0.0], [70.0, 0.0], [70.0, 25.0], [90.0, 25.0], [70.0, 25.0], [70.0, 50.0], [0.0, 50.0]];
    let error = refused(&pocket(polygon(&corners), vec![]));
    let PocketError::Outline { island: None, error: OutlineError::Crosses { at } } = error else {
        panic!("{error:?}");
    };
    assert!((70.0..=90.0).contains(&at.x) && (at.y - 25.0).abs() < 1e-9, "{at}");
}

#[test]
fn spikes_that_are_thinner_than_any_tool_do_no_harm() {
    for tip in [90.0, 40.0] {
        let corners =
            [[0.0, 0.0], [70.0, 0.0], [70.0, 25.0], [tip, 25.001], [70.0, 25.002], [70.0, 50.0], [0.0, 50.0]];
        assert_cleared(&pocket(polygon(&corners), vec![]));
    }
}

#[test]
fn a_pocket_a_thousandth_of_a_millimetre_wider_than_the_tool_is_cleared() {
    for wider_mm in [0.001, 0.0] {
        assert_cleared(&pocket(box_at(0.0, 0.0, 60.0, 10.0 + wider_mm), vec![]));
        // In a hole there is room for nothing but a plunge.
        let hole = pocket(circle_at(0.0, 0.0, 5.0 + 0.5 * wider_mm), vec![]);
        let mut job = job(&hole, &PATTERNS, Some(SLOT_FEED));
        assert!(matches!(planned(&job), Err(PocketError::NoEntry { .. })), "{wider_mm}");
        job.entry.plunge = true;
        let plan = planned(&job).unwrap();
        let verdict = judge(&hole, &Area::new(&hole), &job, &plan);
        assert!(verdict.faults.is_empty(), "{verdict:#?}");
    }
}

use nalgebra::Point2;

use super::*;
use crate::geometry::curve::Direction;
use crate::geometry::plane::Plane;
use crate::geometry::segment::Segment;
use crate::geometry::surface::point_grid::{Ends, PointGrid, Twist};
use crate::machining::assembly::Frustum;
use crate::machining::cutter::Cutter;
use crate::toolpath::units::FeedRate;
use crate::toolpath::{Move, Role};

fn rectangle(low: [f64; 2], high: [f64; 2]) -> Outlines {
    let corner =
        [[low[0], low[1]], [high[0], low[1]], [high[0], high[1]], [low[0], high[1]]].map(Point2::from);
    let sides = [0, 1, 2, 3].map(|k| Segment::Line { start: corner[k], end: corner[(k + 1) % 4] });
    Outlines { boundary: sides.to_vec(), islands: Vec::new() }
}

fn pocket() -> Part {
    Part::Pocket { outlines: rectangle([0.0, 0.0], [60.0, 40.0]), top_mm: 0.0, floor_mm: -4.0 }
}

fn flat(radius: f64) -> Tool {
    Tool { assembly: Assembly::bare(Cutter::bull_nose(radius, 0.0)), flute_length_mm: None }
}

fn feed() -> FeedRate {
    FeedRate::from_mm_per_min(500.0).unwrap()
}

fn p(x: f64, y: f64, z: f64) -> Point3<f64> {
    Point3::new(x, y, z)
}

/// A good program for the pocket with a cutter of 5 mm: a helix, a ring beside the wall, and rapids.
fn ring(change: impl Fn(usize, Point3<f64>) -> Point3<f64>) -> Toolpath {
    let mut builder = Toolpath::builder(p(30.0, 20.0, 20.0));
    let at = |k: usize, x: f64, y: f64, z: f64| change(k, p(x, y, z));
    builder.rapid(at(0, 30.0, 20.0, 2.0)).unwrap();
    builder.line(at(1, 30.0, 20.0, 0.0), feed(), Role::Plunge).unwrap();
    let end = at(2, 30.0, 20.0, -4.0);
    let start = builder.at();
    let center = Point3::from((start.coords + end.coords) * 0.5) + nalgebra::Vector3::new(-3.0, 0.0, 0.0);
    let center = Point3::new(center.x, center.y, start.z);
    if (start.xy() - end.xy()).norm() < 1e-12 {
        builder.arc(end, center, (Plane::Xy, Direction::Ccw), feed(), Role::Ramp).unwrap();
    } else {
        builder.line(end, feed(), Role::Ramp).unwrap();
    }
    for (k, [x, y]) in [[55.0, 20.0], [55.0, 35.0], [5.0, 35.0], [5.0, 5.0], [55.0, 5.0], [55.0, 20.0]]
        .into_iter()
        .enumerate()
    {
        builder.line(at(3 + k, x, y, -4.0), feed(), Role::Cut).unwrap();
    }
    builder.rapid(at(9, 55.0, 20.0, 20.0)).unwrap();
    builder.finish().unwrap()
}

fn report(job: &Job) -> Report {
    verify(job, &Budget::unlimited()).unwrap()
}

fn in_pocket(toolpath: Toolpath) -> Job {
    Job { part: Some(pocket()), ..Job::new(toolpath, flat(5.0), 0.005) }
}

#[test]
fn a_good_program_passes() {
    let report = report(&in_pocket(ring(|_, at| at)));
    assert_eq!((report.verdict, report.findings.total()), (Verdict::Pass, 0), "{:?}", report.findings);
    assert!(report.gouge.unwrap().bound_mm < 1e-3);
    let material = report.material.unwrap();
    // The plunge to the top removes nothing.
    assert!((material.air_length_mm - 2.0).abs() < 1e-9, "{}", material.air_length_mm);
    assert_eq!(material.depth.unwrap().bound_mm, 4.0);
    assert!((material.before.most_mm3 - 60.0 * 40.0 * 4.0).abs() < 1e-6);
    // The middle of the floor is as high as the stock where the ring does not come.
    assert!((report.excess.unwrap().bound_mm - 4.0).abs() < 1e-6);
    assert!(report.uncut_area_mm2.unwrap() > 100.0);
}

#[test]
fn a_gouge_of_a_hundredth_is_found_at_its_move() {
    for k in [2, 3, 4, 5, 6, 7, 8] {
        let deeper = ring(|own, at| if own == k { p(at.x, at.y, at.z - 0.01) } else { at });
        let report = report(&in_pocket(deeper));
        assert_eq!(report.verdict, Verdict::Fail, "{k}");
        assert!(report.findings.listed.iter().any(|finding| finding.place.number == k), "{k}");
        assert!((report.gouge.unwrap().bound_mm - 0.01).abs() < 1e-3, "{:?}", report.gouge);
    }
    let wider = ring(|own, at| if own == 4 { p(at.x + 0.01, at.y, at.z) } else { at });
    let report = report(&in_pocket(wider));
    assert_eq!(report.verdict, Verdict::Fail);
    let finding = report.findings.listed[0];
    assert_eq!((finding.kind, finding.certainty), (Kind::Gouge, Certainty::Certain));
    assert!((finding.found_mm.unwrap() - 0.01).abs() < 1e-9, "{finding:?}");
}

#[test]
fn what_the_control_may_leave_the_path_makes_a_gouge_possible() {
    let job = Job { control_tolerance_mm: 0.01, ..in_pocket(ring(|_, at| at)) };
    let report = report(&job);
    assert_eq!(report.verdict, Verdict::Undecided);
    assert!(report.findings.listed.iter().all(|finding| finding.certainty == Certainty::Possible));
}

#[test]
fn rapids_through_part_and_stock_are_found() {
    let mut builder = Toolpath::builder(p(30.0, 20.0, 20.0));
    builder.rapid(p(30.0, 20.0, -1.0)).unwrap();
    builder.rapid(p(80.0, 20.0, -1.0)).unwrap();
    let report = report(&in_pocket(builder.finish().unwrap()));
    let kinds: Vec<(Kind, usize)> =
        report.findings.listed.iter().map(|finding| (finding.kind, finding.place.number)).collect();
    assert_eq!(
        kinds,
        [(Kind::RapidThroughStock, 0), (Kind::RapidThroughPart, 1), (Kind::RapidThroughStock, 1)]
    );
    assert_eq!(report.material.unwrap().air_length_mm, 0.0);
}

/// A rapid past a clamp is straight or a dog-leg that goes through the clamp.
#[test]
fn a_dog_leg_is_told_from_a_straight_rapid() {
    let clamp = Fixture { outlines: rectangle([30.0, -5.0], [40.0, 5.0]), bottom_mm: 0.0, top_mm: 30.0 };
    let mut builder = Toolpath::builder(p(0.0, 0.0, 60.0));
    builder.rapid(p(80.0, 0.0, 20.0)).unwrap();
    let toolpath = builder.finish().unwrap();
    let of = |rapids| {
        let fixtures = vec![clamp.clone()];
        report(&Job { fixtures, rapids, clearance_mm: 2.0, ..Job::new(toolpath.clone(), flat(3.0), 0.01) })
    };
    let straight = of(Rapids::Straight);
    // The rim is nearest to the far upper edge of the clamp where the tip is at x = 46.4.
    assert_eq!(straight.verdict, Verdict::Pass);
    let clearance = straight.fixture_clearance.unwrap();
    assert!((clearance.bound_mm - f64::hypot(3.4, 6.8)).abs() < 0.01, "{clearance:?}");
    let dog_leg = of(Rapids::DogLeg);
    // The control may run straight.
    assert_eq!(dog_leg.verdict, Verdict::Undecided);
    assert_eq!(dog_leg.fixture_clearance.unwrap().bound_mm, 0.0);
}

#[test]
fn a_holder_meets_wall_and_stock() {
    let holder =
        |bottom_mm: f64| Frustum { bottom_mm, top_mm: 60.0, bottom_radius_mm: 15.0, top_radius_mm: 15.0 };
    let of = |bottom_mm: f64, clearance_mm: f64| {
        let tool = Tool {
            assembly: Assembly { cutter: Cutter::bull_nose(5.0, 0.0), sections: vec![holder(bottom_mm)] },
            flute_length_mm: None,
        };
        let job = Job { tools: vec![tool], clearance_mm, ..in_pocket(ring(|_, at| at)) };
        report(&job)
    };
    let free = of(7.0, 2.0);
    assert_eq!(free.verdict, Verdict::Pass, "{:?}", free.findings);
    let clearance = free.holder_clearance.unwrap();
    assert!(clearance.bound_mm > 2.99 && clearance.bound_mm <= 3.0, "{clearance:?}");
    assert_eq!(of(5.5, 2.0).verdict, Verdict::Fail);
    let hit = of(3.0, 0.0);
    assert_eq!(hit.verdict, Verdict::Fail);
    assert_eq!(hit.holder_clearance.unwrap().bound_mm, 0.0);
    assert!(hit.findings.counts.contains_key(&(Kind::HolderNearStock, Certainty::Certain)));
    assert!(hit.findings.counts.contains_key(&(Kind::HolderNearPart, Certainty::Certain)));
}

#[test]
fn travel_and_flutes_are_limits() {
    let travel = Travel { low: p(0.0, 0.0, -10.0), high: p(54.0, 100.0, 100.0) };
    let tool = Tool { flute_length_mm: Some(3.0), ..flat(5.0) };
    let job = Job { travel: Some(travel), tools: vec![tool], ..in_pocket(ring(|_, at| at)) };
    let report = report(&job);
    let beyond = report.findings.listed.iter().find(|finding| finding.kind == Kind::OutsideTravel).unwrap();
    assert_eq!((beyond.found_mm, beyond.at), (Some(1.0), Some(p(55.0, 20.0, -4.0))));
    let deep = report.findings.listed.iter().filter(|finding| finding.kind == Kind::DeeperThanFlutes);
    let most = deep.filter_map(|finding| finding.found_mm).fold(0.0, f64::max);
    assert!((most - 1.0).abs() < 1e-9, "{most}");
}

/// Passes of a ball over a level plane: what stands between them, and a pass that is 0.01 mm too deep.
#[test]
fn passes_over_a_plane_leave_scallops() {
    let points = [0.0, 20.0].map(|x| [0.0, 20.0].map(|y| p(x, y, 0.0)).to_vec()).to_vec();
    let source = Source::PointGrid(PointGrid { points, twist: Twist::Spline, ends: Ends::Usual });
    let passes = |deep: f64| {
        let mut builder = Toolpath::builder(p(0.0, 0.0, 10.0));
        for k in 0..=20 {
            let y = f64::from(k);
            builder.rapid(p(0.0, y, 10.0)).unwrap();
            builder.line(p(0.0, y, if k == 7 { -deep } else { 0.0 }), feed(), Role::Plunge).unwrap();
            builder.line(p(20.0, y, 0.0), feed(), Role::Cut).unwrap();
            builder.rapid(p(20.0, y, 10.0)).unwrap();
        }
        builder.finish().unwrap()
    };
    let ball = Tool { assembly: Assembly::bare(Cutter::ball(5.0)), flute_length_mm: None };
    let part = Some(Part::Surface { source, allowance_mm: 0.0 });
    let good = report(&Job { part: part.clone(), ..Job::new(passes(0.0), ball.clone(), 0.005) });
    assert_eq!(good.verdict, Verdict::Pass, "{:?}", good.findings);
    let scallop = 5.0 - (25.0f64 - 0.25).sqrt();
    let excess = good.excess.unwrap().bound_mm;
    assert!(excess >= scallop && excess < 1.1 * scallop, "{excess} {scallop}");
    let bad = report(&Job { part, ..Job::new(passes(0.01), ball, 0.005) });
    assert_eq!(bad.verdict, Verdict::Fail);
    let moves: Vec<Move> = passes(0.0).moves().copied().collect();
    assert!(
        bad.findings.listed.iter().all(|finding| matches!(moves[finding.place.number], Move::Feed { .. }))
    );
    assert_eq!(bad.findings.listed.len(), 2);
}

#[test]
fn outlines_that_cross_themselves_are_refused() {
    let mut outlines = rectangle([0.0, 0.0], [10.0, 10.0]);
    let corner = [[0.0, 0.0], [10.0, 10.0], [10.0, 0.0], [0.0, 10.0]].map(Point2::from);
    outlines.boundary =
        [0, 1, 2, 3].map(|k| Segment::Line { start: corner[k], end: corner[(k + 1) % 4] }).to_vec();
    let fixtures = vec![Fixture { outlines, bottom_mm: 0.0, top_mm: 3.0 }];
    let refused = verify(&Job { fixtures, ..in_pocket(ring(|_, at| at)) }, &Budget::unlimited());
    assert!(matches!(refused, Err(Error::Outline { owner: Owner::Fixture(0), .. })), "{refused:?}");
}

#[test]
fn a_leaning_tool_is_refused() {
    let mut builder = Toolpath::builder(p(0.0, 0.0, 0.0));
    let axis = nalgebra::UnitVector3::new_normalize(nalgebra::Vector3::new(1.0, 0.0, 1.0));
    builder.begin_leaning_pass(None, axis);
    builder.line(p(1.0, 0.0, 0.0), feed(), Role::Cut).unwrap();
    let refused = verify(&Job::new(builder.finish().unwrap(), flat(1.0), 0.01), &Budget::unlimited());
    assert_eq!(refused, Err(Error::Leaning));
}

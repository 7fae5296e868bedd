use std::f64::consts::PI;

use nalgebra::Vector3;
use proptest::prelude::*;

use super::*;
use crate::geometry::curve::{Arc, Direction};
use crate::geometry::plane::Plane;
use crate::machining::assembly::Frustum;

const MOST: usize = 4_000_000;

fn block(x: f64, y: f64, z: f64) -> Shape {
    Shape::Block { low: Point3::new(0.0, 0.0, -z), high: Point3::new(x, y, 0.0) }
}

fn stock(shape: &Shape, cell_mm: f64) -> Stock {
    Stock::new(shape, cell_mm, MOST, &Budget::unlimited()).unwrap()
}

fn line(from: [f64; 3], to: [f64; 3]) -> Curve {
    Curve::Line(Line { start: Point3::from(from), end: Point3::from(to) })
}

fn feed(tip: Curve, tool: &Assembly) -> Step<'_> {
    Step { tip, slack_mm: 0.0, tool, is_rapid: false, is_sure: true }
}

fn run(stock: &Stock, steps: &[Step<'_>]) -> (Stock, Vec<Effect>) {
    stock.after(steps, 0.0, &Budget::unlimited()).unwrap()
}

fn holds(volume: Volume, exact: f64) {
    assert!(volume.least_mm3 <= exact && exact <= volume.most_mm3, "{volume:?} {exact}");
}

#[test]
fn a_bar_has_the_volume_of_a_cylinder() {
    let bar =
        Shape::Cylinder { center: Point2::new(3.0, 4.0), radius_mm: 20.0, bottom_mm: -5.0, top_mm: 7.0 };
    let exact = PI * 400.0 * 12.0;
    let volume = stock(&bar, 0.25).volume();
    holds(volume, exact);
    assert!(volume.most_mm3 - volume.least_mm3 < 0.04 * exact, "{volume:?}");
}

#[test]
fn a_straight_slot_has_the_volume_of_a_stadium() {
    let flat = Assembly::bare(Cutter::bull_nose(5.0, 0.0));
    let raw = stock(&block(100.0, 40.0, 20.0), 0.25);
    let (left, effects) = run(&raw, &[feed(line([20.0, 20.0, -4.0], [70.0, 20.0, -4.0]), &flat)]);
    let slot = 4.0 * (50.0 * 10.0 + 25.0 * PI);
    holds(left.volume(), 80_000.0 - slot);
    let spread = left.volume().most_mm3 - left.volume().least_mm3;
    assert!(spread < 4.0 * 131.5 * 0.25 * 1.5, "{spread}");
    assert_eq!(effects[0].removed.unwrap().0, 4.0);
}

#[test]
fn a_ball_leaves_a_half_pipe() {
    let ball = Assembly::bare(Cutter::ball(6.0));
    let raw = stock(&block(60.0, 40.0, 20.0), 0.2);
    let (left, _) = run(&raw, &[feed(line([-10.0, 20.0, -6.0], [70.0, 20.0, -6.0]), &ball)]);
    holds(left.volume(), 60.0 * 40.0 * 20.0 - 60.0 * 18.0 * PI);
}

/// The cutter of radius R that falls along a line from (0, z0) to (l, z1) over a plane at 0.
#[test]
fn a_flat_end_on_a_slope_leaves_a_wedge() {
    let flat = Assembly::bare(Cutter::bull_nose(4.0, 0.0));
    let raw = stock(&block(60.0, 8.0, 20.0), 0.1);
    // Wider than the block across, so that only the rim in front counts: z(x) = -0.2 (x + 4 at the axis).
    let (left, _) = run(&raw, &[feed(line([-10.0, 4.0, 2.0], [80.0, 4.0, -16.0]), &flat)]);
    // The rim at (x, y) is 4 cos a ahead of the axis, where sin a = (y - 4) / 4.
    let n = 4000;
    let mean: f64 = (0..n)
        .map(|k| (16.0 - (8.0 * (f64::from(k) + 0.5) / f64::from(n) - 4.0).powi(2)).sqrt())
        .sum::<f64>()
        / f64::from(n);
    let removed = 8.0 * 60.0 * 0.2 * (30.0 + mean);
    holds(left.volume(), 60.0 * 8.0 * 20.0 - removed);
    let volume = left.volume();
    assert!(volume.most_mm3 - volume.least_mm3 < 0.03 * removed, "{volume:?}");
}

#[test]
fn an_arc_and_a_helix_leave_rings() {
    let flat = Assembly::bare(Cutter::bull_nose(3.0, 0.0));
    let raw = stock(&block(60.0, 60.0, 20.0), 0.25);
    let center = Point3::new(30.0, 30.0, 0.0);
    let at = |z: f64| Point3::new(50.0, 30.0, z);
    let circle = |from: f64, to: f64| {
        Curve::Arc(
            Arc::new(Plane::Xy, Direction::Ccw, at(from), at(to), center + Vector3::z() * from).unwrap(),
        )
    };
    let (left, _) = run(&raw, &[feed(circle(0.0, -5.0), &flat), feed(circle(-5.0, -5.0), &flat)]);
    let ring = PI * (23.0f64.powi(2) - 17.0f64.powi(2)) * 5.0;
    holds(left.volume(), 72_000.0 - ring);
}

#[test]
fn what_is_cut_through_is_gone() {
    let flat = Assembly::bare(Cutter::bull_nose(5.0, 0.0));
    let raw = stock(&block(50.0, 30.0, 6.0), 0.25);
    let (left, effects) = run(&raw, &[feed(line([25.0, -10.0, -7.0], [25.0, 40.0, -7.0]), &flat)]);
    holds(left.volume(), 40.0 * 30.0 * 6.0);
    assert_eq!(left.cell(100, 60), [f64::NEG_INFINITY; 2]);
    // The depth ends at the bottom of the part.
    assert_eq!(effects[0].removed.unwrap().0, 6.0);
}

#[test]
fn a_cut_in_the_air_removes_nothing() {
    let ball = Assembly::bare(Cutter::ball(5.0));
    let raw = stock(&block(50.0, 30.0, 6.0), 0.25);
    let way = line([5.0, 15.0, -2.0], [45.0, 15.0, -2.0]);
    let above = line([5.0, 15.0, 0.1], [45.0, 15.0, 0.1]);
    let (left, effects) = run(&raw, &[feed(way, &ball), feed(above, &ball), feed(way, &ball)]);
    assert!(effects[0].removed.is_some() && effects[1].removed.is_none() && effects[2].removed.is_none());
    assert_eq!(left, run(&raw, &[feed(way, &ball)]).0);
}

#[test]
fn a_rapid_meets_what_is_left_alone() {
    let flat = Assembly::bare(Cutter::bull_nose(5.0, 0.0));
    let raw = stock(&block(50.0, 30.0, 10.0), 0.25);
    let rapid = |from, to| Step { is_rapid: true, ..feed(line(from, to), &flat) };
    let (low, high) = ([25.0, 15.0, -3.0], [25.0, 15.0, 5.0]);
    let steps = [
        feed(line([5.0, 15.0, -3.0], low), &flat),
        rapid(low, high),
        rapid(high, low),
        rapid(low, [26.0, 15.0, -3.0]),
        rapid([26.0, 15.0, 5.0], [26.0, 15.0, -3.5]),
        rapid([0.0, 0.0, -0.01], [50.0, 0.0, -0.01]),
    ];
    let (_, effects) = run(&raw, &steps);
    let found: Vec<f64> = effects.iter().map(|effect| effect.found_mm).collect();
    assert_eq!(found[..3], [0.0; 3]);
    // A rapid down to a place that the cutter has left touches its walls.
    assert!(effects[2].depth_bound_mm <= 2.0 * raw.grid().half_diagonal(), "{effects:?}");
    assert!(found[3] > 0.7 && found[3] <= 1.0, "{found:?}");
    assert!((found[4] - 0.5).abs() < 1e-6, "{found:?}");
    assert!((found[5] - 0.01).abs() < 1e-6, "{found:?}");
}

#[test]
fn a_holder_keeps_its_distance_from_what_is_left() {
    let holder = Frustum { bottom_mm: 20.0, top_mm: 60.0, bottom_radius_mm: 20.0, top_radius_mm: 25.0 };
    let tool = Assembly { cutter: Cutter::bull_nose(5.0, 0.0), sections: vec![holder] };
    let raw = stock(&block(100.0, 60.0, 40.0), 0.5);
    let steps = [-10.0, -15.0, -25.0].map(|z| feed(line([50.0, 30.0, z], [60.0, 30.0, z]), &tool));
    let (_, effects) = run(&raw, &steps);
    let found: Vec<_> = effects.iter().map(|effect| effect.approach.unwrap()).collect();
    assert!((found[0].clearance_mm - 10.0).abs() < 1e-6 && !found[0].is_met, "{found:?}");
    assert!((found[1].clearance_mm - 5.0).abs() < 1e-6 && !found[1].is_met, "{found:?}");
    assert!(found[2].clearance_mm == 0.0 && found[2].is_met, "{found:?}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]
    /// The exact material at any place lies between both bounds of its cell, for any cutter, slack and moves.
    #[test]
    fn both_bounds_hold_everywhere(
        radius in 0.3f64..6.0, share in 0.0f64..=1.0, slack in prop_oneof![Just(0.0), 0.001f64..0.5],
        ends in prop::collection::vec(prop::array::uniform3(0.0f64..1.0), 2..7),
        places in prop::collection::vec(prop::array::uniform2(0.0f64..1.0), 40),
        turns in prop::array::uniform6(-1.0f64..1.0),
    ) {
        let cutter = Cutter::bull_nose(radius, radius * share);
        let tool = Assembly::bare(cutter);
        let raw = stock(&block(20.0, 15.0, 8.0), 0.7);
        let points: Vec<Point3<f64>> = ends
            .iter()
            .map(|[x, y, z]| Point3::new(30.0 * x - 5.0, 25.0 * y - 5.0, 10.0 * z - 9.0))
            .collect();
        let moves: Vec<Line> = points.windows(2).map(|two| Line { start: two[0], end: two[1] }).collect();
        let steps: Vec<Step<'_>> = moves
            .iter()
            .map(|line| Step { slack_mm: slack, ..feed(Curve::Line(*line), &tool) })
            .collect();
        let (left, _) = run(&raw, &steps);
        // The control leaves each line by no more than the slack.
        let shift = |k: usize| {
            let [a, b, c] = [turns[k % 6], turns[(k + 1) % 6], turns[(k + 2) % 6]];
            Vector3::new(a, b, c).try_normalize(1e-9).unwrap_or_default() * slack
        };
        let run = moves.iter().enumerate().map(|(k, line)| {
            Sweep::new(cutter, &Line { start: line.start + shift(k), end: line.end + shift(k) })
        });
        let run: Vec<Sweep> = run.collect();
        for [x, y] in places {
            let p = Point2::new(20.0 * x, 15.0 * y);
            let exact = run.iter().filter_map(|sweep| sweep.at(p)).fold(0.0f64, |low, at| low.min(at.height));
            let exact = if exact > -8.0 { exact } else { f64::NEG_INFINITY };
            let grid = left.grid();
            let [i, j] = [(p.x / grid.cell.x, grid.n[0]), (p.y / grid.cell.y, grid.n[1])]
                .map(|(at, n)| (at as usize).min(n - 1));
            let [outer, inner] = left.cell(i, j);
            prop_assert!(inner <= exact && exact <= outer, "{p} {inner} {exact} {outer}");
        }
    }
}

#[test]
fn a_cancelled_run_stops() {
    let flat = Assembly::bare(Cutter::bull_nose(5.0, 0.0));
    let raw = stock(&block(50.0, 30.0, 10.0), 1.0);
    let budget = Budget::unlimited();
    budget.cancel();
    assert_eq!(raw.after(&[feed(line([0.0; 3], [1.0; 3]), &flat)], 0.0, &budget), Err(Stopped::Cancelled));
}

use std::f64::consts::{FRAC_PI_2, FRAC_PI_3, PI, TAU};

use nalgebra::{Isometry2, Vector2};

use super::*;
use crate::geometry::segment::left;

mod laws;

/// An offset, and how much of the contour it leaves unreached.
#[derive(Debug)]
struct Found {
    chains: Vec<Vec<Segment>>,
    unreached_mm: f64,
}

const R: f64 = 2.0;

/// A chain of lines and arcs through points. A positive bulge puts the arc to the right of its chord, so that
/// it turns to the left.
fn contour(points: &[(f64, f64)], bulges: &[f64]) -> Vec<Segment> {
    let at = |k: usize| Point2::new(points[k].0, points[k].1);
    let element = |k: usize| {
        let (start, end) = (at(k), at(k + 1));
        let bulge = bulges.get(k).copied().unwrap_or(0.0);
        Segment::bulging(start, end, -bulge)
    };
    (0..points.len() - 1).map(element).collect()
}

fn lines(points: &[(f64, f64)]) -> Vec<Segment> {
    contour(points, &[])
}

/// A counterclockwise circle of two half circles.
fn circle(radius: f64) -> Vec<Segment> {
    contour(&[(radius, 0.0), (-radius, 0.0), (radius, 0.0)], &[1.0, 1.0])
}

fn reversed(chain: &[Segment]) -> Vec<Segment> {
    chain.iter().rev().map(Segment::reversed).collect()
}

fn mirrored(chain: &[Segment]) -> Vec<Segment> {
    chain.iter().map(Segment::mirrored).collect()
}

fn turned(chain: &[Segment], degrees: f64) -> Vec<Segment> {
    let motion = Isometry2::new(Vector2::new(71.0, -113.0), degrees.to_radians());
    let moved = |element: &Segment| {
        Segment::turning(motion * element.start(), motion * element.end(), element.turn())
    };
    chain.iter().map(moved).collect()
}

/// Elements that meet at a hundredth of a radian. Without mitres the offset has an arc about each joint. With
/// mitres it has no such arc, is connected, and leaves its distance by at most the mitre.
#[test]
fn small_angles_are_mitred_and_large_ones_rounded() {
    let arc_and_lines =
        contour(&[(0.0, 0.0), (30.0, 0.0), (60.0, -0.3), (90.0, -0.9), (91.0, -30.0)], &[0.0, 0.001]);
    for (mitre_mm, arcs) in [(0.0, 4), (1e-4, 2)] {
        let found = offset(&[&arc_and_lines], Side::Left, R, mitre_mm, &Budget::unlimited()).unwrap();
        let [chain] = &found[..] else { panic!("{found:?}") };
        assert_eq!(
            chain.iter().filter(|element| matches!(element, Segment::Arc(_))).count(),
            arcs,
            "{chain:?}"
        );
        for pair in chain.windows(2) {
            assert_eq!(pair[0].end(), pair[1].start());
        }
        for element in chain {
            for k in 0..=50 {
                let apart = to_chain(&arc_and_lines, element.at(f64::from(k) / 50.0));
                assert!((R - 1e-6..=R + mitre_mm + 1e-6).contains(&apart), "{mitre_mm} {apart}");
            }
        }
    }
}

fn other(side: Side) -> Side {
    if side == Side::Left { Side::Right } else { Side::Left }
}

fn to_chain(elements: &[Segment], p: Point2<f64>) -> f64 {
    elements.iter().map(|element| element.distance_to(p)).fold(f64::INFINITY, f64::min)
}

fn length(chain: &[Segment]) -> f64 {
    chain.iter().map(Segment::length).sum()
}

/// The offset after its checks.
fn run(contour: &[Segment], side: Side, radius: f64) -> Found {
    let chains = offset(&[contour], side, radius, 0.0, &Budget::unlimited()).unwrap();
    let unreached_mm = unreached(contour, &chains, radius, &Budget::unlimited()).unwrap();
    check(contour, side, radius, &chains);
    Found { chains, unreached_mm }
}

/// Checks an offset by samples: it is connected, nowhere too near, and misses no place beside the contour
/// that is far enough from it. So it may be empty only if no such place exists.
fn check(contour: &[Segment], side: Side, radius: f64, chains: &[Vec<Segment>]) {
    for chain in chains {
        for pair in chain.windows(2) {
            assert_eq!(pair[0].end(), pair[1].start());
        }
    }
    let all = chains.concat();
    for element in &all {
        for k in 0..=20 {
            let p = element.at(f64::from(k) / 20.0);
            let apart = to_chain(contour, p);
            assert!((apart - radius).abs() < 1.1e-6, "{p} is {apart} mm from the contour");
        }
        if let Segment::Arc(arc) = element {
            assert!(((arc.end() - arc.center()).norm() - arc.radius()).abs() < 1e-9);
            assert!(((arc.start() - arc.center()).norm() - arc.radius()).abs() < 1e-9);
            let end = element.at(1.0_f64.next_down());
            assert!((end - arc.end()).norm() < 1e-9, "the turn of {arc:?} does not lead to its end");
        }
    }
    for p in beside(contour, side, radius) {
        assert!(to_chain(&all, p) < 1e-6, "the offset misses {p}: {chains:?}");
    }
}

/// Places on the side of the contour that are exactly at the distance from one element, or from the corner of
/// two, and farther from all other elements.
fn beside(contour: &[Segment], side: Side, radius: f64) -> Vec<Point2<f64>> {
    let sense = if side == Side::Left { 1.0 } else { -1.0 };
    let is_closed = (contour[0].start() - contour[contour.len() - 1].end()).norm() < 1e-9;
    let mut places = Vec::new();
    for (k, element) in contour.iter().enumerate() {
        let next = if k + 1 < contour.len() || is_closed { (k + 1) % contour.len() } else { k };
        let mut see = |p: Point2<f64>, own: [usize; 2]| {
            let is_other = |j: usize| !own.contains(&j);
            let mut others = contour.iter().enumerate().filter(|(j, _)| is_other(*j));
            let is_at = own.iter().all(|j| contour[*j].distance_to(p) > radius - 1e-12);
            if is_at && others.all(|(_, other)| other.distance_to(p) > radius + 1e-4) {
                places.push(p);
            }
        };
        for t in [0.1, 0.3, 0.5, 0.7, 0.9] {
            see(element.at(t) + left(element.direction(t)) * (sense * radius), [k, k]);
        }
        // The sector about the corner, between the normals. After half a turn it could lie on either side.
        let (before, after) = (element.direction(1.0), contour[next].direction(0.0));
        for t in [0.25, 0.5, 0.75].iter().filter(|_| next != k && before.dot(&after) > -0.99) {
            let out = left(before.lerp(&after, *t)).normalize() * (sense * radius);
            see(element.end() + out, [k, next]);
        }
    }
    places
}

/// As `run`, and again for the contour reversed, mirrored, and turned: all give the same offset.
fn run_all_ways(contour: &[Segment], side: Side, radius: f64) -> Found {
    let found = run(contour, side, radius);
    let total = |found: &Found| found.chains.iter().map(|chain| length(chain)).sum::<f64>();
    let same = |again: &Found, way: &str| {
        assert_eq!(again.chains.len(), found.chains.len(), "{way}");
        assert!((total(again) - total(&found)).abs() < 1e-5, "{way}: {} {}", total(again), total(&found));
        assert!(
            (again.unreached_mm - found.unreached_mm).abs() < 1e-5,
            "{way}: {} {}",
            again.unreached_mm,
            found.unreached_mm
        );
    };
    same(&run(&reversed(contour), other(side), radius), "reversed");
    same(&run(&mirrored(contour), other(side), radius), "mirrored");
    same(&run(&turned(contour, 90.0), side, radius), "turned by a quarter");
    same(&run(&turned(contour, 77.7), side, radius), "turned");
    same(&run(&turned(&mirrored(&reversed(contour)), 15.0), side, radius), "all of it");
    found
}

fn one(found: &Found) -> &[Segment] {
    assert_eq!(found.chains.len(), 1);
    &found.chains[0]
}

fn assert_near(found: f64, expected: f64) {
    assert!((found - expected).abs() < 1e-9, "{found} instead of {expected}");
}

fn assert_at(p: Point2<f64>, x: f64, y: f64) {
    assert!((p - Point2::new(x, y)).norm() < 1e-9, "{p} instead of {x}, {y}");
}

#[test]
fn a_convex_corner_is_rounded() {
    let corner = lines(&[(0.0, 0.0), (10.0, 0.0), (10.0, 7.0)]);
    let found = run_all_ways(&corner, Side::Right, R);
    let chain = one(&found);
    assert_eq!(chain.len(), 3);
    assert_at(chain[0].start(), 0.0, -R);
    assert_at(chain[2].end(), 10.0 + R, 7.0);
    assert_near(length(chain), 17.0 + R * FRAC_PI_2);
    let Segment::Arc(arc) = chain[1] else { panic!("{chain:?}") };
    assert_at(arc.center(), 10.0, 0.0);
    assert_near(arc.turn(), FRAC_PI_2);
    assert!(found.unreached_mm < 1e-12);
}

#[test]
fn a_concave_corner_is_cut_off() {
    let found = run_all_ways(&lines(&[(0.0, 0.0), (10.0, 0.0), (10.0, 7.0)]), Side::Left, R);
    let chain = one(&found);
    assert_eq!(chain.len(), 2);
    assert_at(chain[0].start(), 0.0, R);
    assert_at(chain[0].end(), 10.0 - R, R);
    assert_at(chain[1].end(), 10.0 - R, 7.0);
    assert_near(found.unreached_mm, R * (2f64.sqrt() - 1.0));
}

#[test]
fn a_circle_has_concentric_circles_as_offsets() {
    let found = run_all_ways(&circle(5.0), Side::Right, R);
    assert_near(length(one(&found)), TAU * (5.0 + R));
    assert_at(found.chains[0][0].start(), 5.0 + R, 0.0);
    let found = run_all_ways(&circle(5.0), Side::Left, R);
    assert_near(length(one(&found)), TAU * (5.0 - R));
    assert_eq!(one(&found)[0].start(), one(&found)[1].end());
    // Outside, the distance may be far larger; inside, nothing is left.
    let found = run_all_ways(&circle(5.0), Side::Right, 50.0);
    assert_near(length(one(&found)), TAU * 55.0);
    for radius in [5.0, 6.0, 50.0] {
        let none = offset(&[&circle(5.0)], Side::Left, radius, 0.0, &Budget::unlimited());
        assert_eq!(none, Ok(vec![]));
    }
}

#[test]
fn a_square_shrinks_inside_and_is_rounded_outside() {
    let square = lines(&[(0.0, 0.0), (10.0, 0.0), (10.0, 10.0), (0.0, 10.0), (0.0, 0.0)]);
    let inside = run_all_ways(&square, Side::Left, R);
    assert_near(length(one(&inside)), 4.0 * (10.0 - 2.0 * R));
    assert_eq!(one(&inside)[0].start(), one(&inside)[3].end());
    let outside = run_all_ways(&square, Side::Right, R);
    assert_near(length(one(&outside)), 40.0 + TAU * R);
    assert_eq!(one(&outside)[0].start(), one(&outside)[7].end());
    let none = offset(&[&square], Side::Left, 5.1, 0.0, &Budget::unlimited());
    assert_eq!(none, Ok(vec![]));
}

#[test]
fn the_offset_of_an_s_consists_of_concentric_arcs() {
    // Two half circles of radius 5, tangent to each other: the offset consists of half circles too.
    let s = contour(&[(0.0, 0.0), (10.0, 0.0), (20.0, 0.0)], &[1.0, -1.0]);
    let found = run_all_ways(&s, Side::Left, R);
    assert_eq!(one(&found).len(), 2);
    assert_near(length(one(&found)), PI * (5.0 - R + 5.0 + R));
    // A distance above the radius removes the first half circle, and the part of the second that is too near
    // to the first.
    let found = run_all_ways(&s, Side::Left, 6.0);
    let chain = one(&found);
    assert_eq!(chain.len(), 1);
    assert_at(chain[0].end(), 26.0, 0.0);
    assert!(found.unreached_mm > 1.0);
}

#[test]
fn the_offset_of_a_v_turns_at_twice_the_distance_from_the_tip() {
    let v = |leg: f64| {
        lines(&[
            (-leg * FRAC_PI_3.cos(), leg * FRAC_PI_3.sin()),
            (0.0, 0.0),
            (leg * 0.5, leg * 0.75f64.sqrt()),
        ])
    };
    // The offset turns at twice the distance from the tip, where both legs are at the distance.
    let found = run_all_ways(&v(10.0), Side::Left, R);
    let chain = one(&found);
    assert_at(chain[0].end(), 0.0, 2.0 * R);
    assert_near(length(chain), 2.0 * (10.0 - R * 3f64.sqrt()));
    assert_near(found.unreached_mm, R);
    // The legs are so short that no place between them is at the distance.
    let none = offset(&[&v(3.0)], Side::Left, R, 0.0, &Budget::unlimited());
    assert_eq!(none, Ok(vec![]));
}

#[test]
fn a_narrow_neck_parts_the_offset_of_the_bulb_behind_it() {
    let neck = |y: f64| {
        let points = [
            (0.0, 0.0),
            (10.0, 0.0),
            (10.0, -5.0),
            (22.0, -5.0),
            (22.0, y + 5.0),
            (10.0, y + 5.0),
            (10.0, y),
            (0.0, y),
        ];
        lines(&points)
    };
    // A neck wide enough gives one chain.
    assert_eq!(run_all_ways(&neck(4.5), Side::Left, R).chains.len(), 1);
    // A neck too narrow gives the bulb a closed offset of its own, which touches the two corners of the neck.
    let found = run_all_ways(&neck(3.0), Side::Left, R);
    let bulb = one(&found);
    assert_eq!(bulb[0].start(), bulb[bulb.len() - 1].end());
    let sides = 2.0 * (12.0 - 2.0 * R) + (13.0 - 2.0 * R);
    // On the opening's side the offset follows the walls, 5 long each, and the arcs about the neck's corners
    // up to the middle.
    let walls = 10.0 - 2.0 * R;
    assert_near(length(bulb), sides + walls + 2.0 * R * (1.5f64 / R).asin());
    // Outside, nothing is in the way.
    assert_eq!(run_all_ways(&neck(3.0), Side::Right, 1.0).chains.len(), 1);
}

#[test]
fn a_loop_of_the_contour_is_cut_off() {
    let crossing = lines(&[(0.0, 0.0), (20.0, 0.0), (20.0, 10.0), (10.0, 10.0), (10.0, -10.0)]);
    let found = run_all_ways(&crossing, Side::Left, R);
    // Before the crossing, in the loop, and after the crossing.
    let [before, within, after] = &found.chains[..] else { panic!("{:?}", found.chains) };
    assert_eq!([before.len(), within.len(), after.len()], [1, 4, 1]);
    assert_at(before[0].end(), 8.0, 2.0);
    assert_near(length(within), 24.0);
    assert_at(after[0].start(), 12.0, -2.0);
}

#[test]
fn a_piece_that_touches_a_forbidden_range_is_clipped() {
    // The last line crosses the half circle. The offset beside the half circle touches an edge of the strip
    // of places that are too near to this line. It does so halfway between the places where it crosses the
    // strip's near edge.
    let crossing = [(0.0, 0.0), (-3.0, 0.0), (-3.0, 3.0), (-3.0, 4.0), (0.0, 0.0)];
    let crossing = contour(&crossing, &[0.0, 1.0, -1.0]);
    for side in [Side::Left, Side::Right] {
        run(&crossing, side, 0.25);
    }
}

fn sine(count: usize, until: f64) -> Vec<Segment> {
    let at = |k: usize| {
        let x = until * (k as f64 / count as f64);
        (x, x.sin())
    };
    lines(&(0..=count).map(at).collect::<Vec<_>>())
}

#[test]
fn cusps_of_a_sine_are_removed() {
    let wave = sine(500, 10.0);
    for radius in [0.5, 1.5, 5.0] {
        for side in [Side::Left, Side::Right] {
            assert_eq!(run_all_ways(&wave, side, radius).chains.len(), 1, "{radius} {side:?}");
        }
    }
    // In the trough at 3 pi / 2 the disc rests on two points of equal height.
    let found = run(&wave, Side::Left, 1.5);
    assert!(found.unreached_mm > 0.05 && found.unreached_mm < 0.2, "{}", found.unreached_mm);
}

#[test]
fn tiny_elements_and_doubled_points_do_not_change_the_offset() {
    let step = 1e-10;
    let rough = [(0.0, 0.0), (5.0, 0.0), (5.0, step), (5.0, 0.0), (5.0 + step, 0.0), (9.0, 1e-7), (9.0, 4.0)];
    let smooth = lines(&[(0.0, 0.0), (9.0, 0.0), (9.0, 4.0)]);
    for side in [Side::Left, Side::Right] {
        let [rough, smooth] = [lines(&rough), smooth.clone()]
            .map(|contour| offset(&[&contour], side, R, 0.0, &Budget::unlimited()).unwrap());
        assert!((length(&rough[0]) - length(&smooth[0])).abs() < 1e-6, "{rough:?}");
    }
}

#[test]
fn a_cancelled_budget_stops() {
    let budget = Budget::unlimited();
    budget.cancel();
    let stopped = offset(&[&circle(5.0)], Side::Left, R, 0.0, &budget);
    assert_eq!(stopped, Err(OffsetError::Stopped(Stopped::Cancelled)));
}

#[test]
fn an_offset_that_comes_too_near_is_refused() {
    let line = Tree::new(lines(&[(0.0, 0.0), (10.0, 0.0)]));
    let beside = |y: f64| vec![lines(&[(0.0, y), (10.0, y)])];
    assert_eq!(prove(&line, &beside(R - 5e-7), R, &Budget::unlimited()), Ok(()));
    let refused = prove(&line, &beside(R - 2e-6), R, &Budget::unlimited());
    assert!(matches!(refused, Err(OffsetError::Unproved { .. })), "{refused:?}");
    // An arc that is lower than its ends.
    let dip = vec![contour(&[(4.0, 2.5), (6.0, 2.5)], &[1.0])];
    let refused = prove(&line, &dip, R, &Budget::unlimited());
    let Err(OffsetError::Unproved { at }) = refused else { panic!("{refused:?}") };
    assert_at(at, 5.0, 1.5);
}

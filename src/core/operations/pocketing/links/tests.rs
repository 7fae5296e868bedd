use nalgebra::{Point2, Vector2};

use super::ground::{Ground, Room};
use super::way::{Pose, direct};
use super::{Links, TURNS};
use crate::budget::Budget;
use crate::geometry::region::{Outline, Region};
use crate::geometry::segment::Segment;
use crate::machining::engagement::Swept;

const RADIUS_MM: f64 = 5.0;

/// The largest turn between two elements of a way, radians.
const KINK: f64 = std::f64::consts::FRAC_PI_6;

fn line(a: [f64; 2], b: [f64; 2]) -> Segment {
    Segment::Line { start: a.into(), end: b.into() }
}

fn square(side_mm: f64) -> Region {
    let corner = [[0.0, 0.0], [side_mm, 0.0], [side_mm, side_mm], [0.0, side_mm]];
    let sides: Vec<Segment> = (0..4).map(|k| line(corner[k], corner[(k + 1) % 4])).collect();
    let budget = Budget::unlimited();
    Region::new(&[Outline::new(&sides, &budget).unwrap()], &[], &budget).unwrap()
}

fn pose(at: [f64; 2], along: [f64; 2]) -> Pose {
    Pose { at: at.into(), along: Vector2::from(along) }
}

fn assert_smooth(way: &[Segment], [from, to]: [Pose; 2]) {
    let (first, last) = (way[0], way[way.len() - 1]);
    assert!((first.start() - from.at).norm() < 1e-9 && (last.end() - to.at).norm() < 1e-9);
    assert!((first.direction(0.0) - from.along).norm() < 1e-6, "{first:?}");
    assert!((last.direction(1.0) - to.along).norm() < 1e-6, "{last:?}");
    for pair in way.windows(2) {
        assert!((pair[0].end() - pair[1].start()).norm() < 1e-9);
        let turn = pair[0].direction(1.0).angle(&pair[1].direction(0.0));
        assert!(turn < KINK, "{turn} in {way:?}");
    }
}

#[test]
fn direct_ways_continue_the_motions_at_both_ends() {
    let ends = [pose([0.0, 0.0], [1.0, 0.0]), pose([30.0, 12.0], [0.0, -1.0])];
    let ways = direct(ends, TURNS.map(|turn| turn * RADIUS_MM));
    assert_eq!(ways.len(), 12);
    ways.iter().for_each(|way| assert_smooth(way, ends));
    let lengths: Vec<f64> = ways.iter().map(|way| way.iter().map(Segment::length).sum()).collect();
    assert!(lengths.is_sorted() && lengths[0] > 30f64.hypot(12.0));
}

#[test]
fn no_line_touches_circles_of_which_one_holds_the_other() {
    let ends = [pose([0.0, 0.0], [1.0, 0.0]), pose([0.0, 1.0], [1.0, 0.0])];
    for way in direct(ends, [5.0]) {
        assert_smooth(&way, ends);
    }
    assert!(direct(ends, [5.0]).len() < 4);
}

/// Slots along three sides of a square, in which the material in the middle stays.
fn slots() -> Vec<Segment> {
    let corner = [[0.0, 80.0], [0.0, 0.0], [80.0, 0.0], [80.0, 80.0]];
    let widened = [[8.0, 80.0], [8.0, 8.0], [72.0, 8.0], [72.0, 80.0]];
    let slot = |corner: [[f64; 2]; 4]| (0..3).map(move |k| line(corner[k], corner[k + 1]));
    slot(corner).chain(slot(widened)).collect()
}

#[test]
fn a_way_around_material_is_smooth_and_meets_none() {
    let (centers, budget) = (square(80.0), Budget::unlimited());
    let mut links = Links::new(&centers, RADIUS_MM);
    let mut swept = Swept::new(RADIUS_MM);
    for element in slots() {
        links.sweep(&element);
        swept.push(&element);
    }
    let ends = [pose([4.0, 70.0], [0.0, 1.0]), pose([76.0, 70.0], [0.0, 1.0])];
    let mut is_clear = |way: &Vec<Segment>| {
        way.iter().all(|element| centers.contains(element, 1e-6) && swept.is_clear(element, &budget).unwrap())
    };
    let radii = TURNS.map(|turn| turn * RADIUS_MM);
    assert!(!direct(ends, radii).iter().any(&mut is_clear));
    let ways = links.around(ends, Room::Wide, f64::INFINITY, &budget).unwrap();
    let way = ways.iter().find(|way| is_clear(way)).expect("no way around");
    assert_smooth(way, ends);
    let length: f64 = way.iter().map(Segment::length).sum();
    // Down, across and up, with a turn at the start.
    assert!((180.0..230.0).contains(&length), "{length}");
    assert!(links.around(ends, Room::Wide, 150.0, &budget).unwrap().is_empty());
}

#[test]
fn no_way_leads_over_ground_that_is_cleared_in_two_places_only() {
    let (centers, budget) = (square(80.0), Budget::unlimited());
    let mut links = Links::new(&centers, RADIUS_MM);
    for x in [4.0, 76.0] {
        for aside in [-2.0, 0.0, 2.0] {
            links.sweep(&line([x + aside, 0.0], [x + aside, 80.0]));
        }
    }
    let ends = [pose([4.0, 40.0], [0.0, 1.0]), pose([76.0, 40.0], [0.0, 1.0])];
    for room in [Room::Wide, Room::Narrow] {
        assert!(links.around(ends, room, f64::INFINITY, &budget).unwrap().is_empty());
    }
    let through = links.around(ends, Room::Material, f64::INFINITY, &budget).unwrap();
    assert_smooth(&through[0], ends);
}

#[test]
fn cells_are_open_exactly_where_the_disc_about_them_is_swept() {
    let (centers, budget) = (square(40.0), Budget::unlimited());
    let mut ground = Ground::new(&centers, RADIUS_MM, &budget).unwrap().unwrap();
    let path = [line([5.0, 5.0], [30.0, 12.0]), line([30.0, 12.0], [10.0, 20.0])];
    path.iter().for_each(|element| ground.sweep(element));
    let is_swept = |p: Point2<f64>| path.iter().any(|element| element.distance_to(p) <= RADIUS_MM);
    let [width, height] = ground.size();
    let cells: Vec<[usize; 2]> = (0..width).flat_map(|x| (0..height).map(move |y| [x, y])).collect();
    let mut n_open = 0;
    for cell in cells.iter().filter(|cell| ground.is_open(**cell, Room::Material)) {
        let p = ground.middle(*cell);
        let within = RADIUS_MM + ground.cell_mm();
        let is_free = cells
            .iter()
            .map(|other| ground.middle(*other))
            .filter(|other| (other - p).norm() <= within * (1.0 + 1e-12))
            .all(is_swept);
        assert_eq!(ground.is_open(*cell, Room::Wide), is_free, "{p}");
        n_open += usize::from(is_free);
    }
    // Another pass makes room between both.
    ground.sweep(&line([8.0, 10.0], [30.0, 16.0]));
    assert!(cells.iter().filter(|cell| ground.is_open(**cell, Room::Wide)).count() > n_open);
}

#[test]
fn a_level_with_too_many_cells_has_no_ground() {
    let budget = Budget::unlimited();
    assert!(Ground::new(&square(10_000.0), RADIUS_MM, &budget).unwrap().is_none());
    assert!(Ground::new(&Region::empty(), RADIUS_MM, &budget).unwrap().is_none());
}

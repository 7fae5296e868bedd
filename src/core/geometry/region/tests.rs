use std::f64::consts::{FRAC_PI_2, PI};

use super::*;

mod close;
mod laws;

/// The loop through points (x, y, bulge). Bulges are tan(turn / 4), positive for arcs that turn to the left.
fn elements(points: &[[f64; 3]]) -> Vec<Segment> {
    let at = |k: usize| Point2::new(points[k % points.len()][0], points[k % points.len()][1]);
    let element = |k: usize| {
        let (start, end) = (at(k), at(k + 1));
        Segment::bulging(start, end, -points[k][2])
    };
    (0..points.len()).map(element).collect()
}

fn outline(points: &[[f64; 3]]) -> Outline {
    Outline::new(&elements(points), &Budget::unlimited()).unwrap()
}

fn region(outline: Outline) -> Region {
    Region::new(&[outline], &[], &Budget::unlimited()).unwrap()
}

fn rectangle([x, y]: [f64; 2], [width, height]: [f64; 2]) -> Outline {
    outline(&[[x, y, 0.0], [x + width, y, 0.0], [x + width, y + height, 0.0], [x, y + height, 0.0]])
}

fn square(x: f64, y: f64, side: f64) -> Region {
    region(rectangle([x, y], [side, side]))
}

fn circle(x: f64, y: f64, radius: f64) -> Outline {
    outline(&[[x + radius, y, 1.0], [x - radius, y, 1.0]])
}

fn disc(x: f64, y: f64, radius: f64) -> Region {
    region(circle(x, y, radius))
}

fn union(a: &Region, b: &Region) -> Region {
    Region::union(&[a, b], &Budget::unlimited()).unwrap()
}

fn intersection(a: &Region, b: &Region) -> Region {
    a.intersection(b, &Budget::unlimited()).unwrap()
}

fn difference(a: &Region, b: &Region) -> Region {
    a.difference(b, &Budget::unlimited()).unwrap()
}

fn inward(region: &Region, distance: f64) -> Region {
    region.offset_inward(distance, &Budget::unlimited()).unwrap()
}

fn outward(region: &Region, distance: f64) -> Region {
    region.offset_outward(distance, &Budget::unlimited()).unwrap()
}

#[track_caller]
fn assert_near(found: f64, expected: f64) {
    assert!((found - expected).abs() < 1e-9 * (1.0 + expected.abs()), "{found} instead of {expected}");
}

/// The number of islands of each face.
fn islands(region: &Region) -> Vec<usize> {
    region.faces().iter().map(|face| face.islands.len()).collect()
}

#[test]
fn areas_and_boxes_of_outlines_include_their_arcs() {
    assert_near(rectangle([1.0, 2.0], [3.0, 4.0]).area(), 12.0);
    assert_near(circle(5.0, -3.0, 2.0).area(), 4.0 * PI);
    // A slot, and the same slot run in the other direction.
    let slot = [[0.0, 0.0, 0.0], [10.0, 0.0, 1.0], [10.0, 4.0, 0.0], [0.0, 4.0, 1.0]];
    assert_near(outline(&slot).area(), 40.0 + 4.0 * PI);
    let back = [[0.0, 4.0, 0.0], [10.0, 4.0, -1.0], [10.0, 0.0, 0.0], [0.0, 0.0, -1.0]];
    assert_near(outline(&back).area(), 40.0 + 4.0 * PI);
    let [low, high] = outline(&back).bounding_box();
    assert!((low - Point2::new(-2.0, 0.0)).norm() < 1e-12 && (high - Point2::new(12.0, 4.0)).norm() < 1e-12);
    // A flat arc of 1e7 mm radius over 100 mm: the area between arc and chord is 2/3 of chord times rise.
    let rise = 1.25e-4;
    let flat = [[0.0, 0.0, 2.0 * rise / 100.0], [100.0, 0.0, 0.0], [100.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
    assert!((outline(&flat).area() - 100.0 - 200.0 / 3.0 * rise).abs() < 1e-10);
}

#[test]
fn loops_that_are_no_outlines_are_refused_with_the_place() {
    let refused = |points: &[[f64; 3]]| Outline::new(&elements(points), &Budget::unlimited()).unwrap_err();
    let eight = refused(&[[0.0, 0.0, 0.0], [10.0, 10.0, 0.0], [10.0, 0.0, 0.0], [0.0, 8.0, 0.0]]);
    let OutlineError::Crosses { at } = eight else { panic!("{eight}") };
    assert!((at - Point2::new(40.0 / 9.0, 40.0 / 9.0)).norm() < 1e-9, "{at}");
    // A path twice around.
    let twice = refused(&[[5.0, 0.0, 1.0], [-5.0, 0.0, 1.0], [4.0, 0.0, 1.0], [-4.0, 0.0, 1.0]]);
    assert!(matches!(twice, OutlineError::Crosses { .. }), "{twice}");
    // A spike: out and back along the same line.
    let spike =
        refused(&[[0.0, 0.0, 0.0], [10.0, 0.0, 0.0], [20.0, 0.0, 0.0], [10.0, 0.0, 0.0], [0.0, 9.0, 0.0]]);
    assert!(matches!(spike, OutlineError::Crosses { .. }), "{spike}");
    assert_eq!(refused(&[[0.0, 0.0, 0.0], [10.0, 0.0, 0.0]]), OutlineError::NoArea);
    for wrong in [f64::NAN, f64::INFINITY, 2e8] {
        let large = refused(&[[0.0, 0.0, 0.0], [wrong, 0.0, 0.0], [0.0, 1.0, 0.0]]);
        assert_eq!(large, OutlineError::TooLarge { index: 0 });
    }
    assert_eq!(Outline::new(&[], &Budget::unlimited()), Err(OutlineError::Empty));
    let mut open = elements(&[[0.0, 0.0, 0.0], [10.0, 0.0, 0.0], [10.0, 10.0, 0.0]]);
    open[2] = Segment::Line { start: Point2::new(10.0, 10.0), end: Point2::new(0.0, 0.25) };
    let open = Outline::new(&open, &Budget::unlimited());
    assert_eq!(open, Err(OutlineError::Open { index: 2, gap_mm: 0.25, at: Point2::new(0.0, 0.25) }));
}

#[test]
fn an_outline_may_touch_itself_in_a_point() {
    let bow = outline(&[
        [0.0, 0.0, 0.0],
        [4.0, 0.0, 0.0],
        [2.0, 2.0, 0.0],
        [4.0, 4.0, 0.0],
        [0.0, 4.0, 0.0],
        [2.0, 2.0, 0.0],
    ]);
    assert_near(bow.area(), 8.0);
    let parts = region(bow);
    assert_eq!(islands(&parts), [0, 0]);
}

#[test]
fn overlapping_circles_meet_in_a_lens() {
    let (a, b) = (disc(0.0, 0.0, 5.0), disc(6.0, 0.0, 5.0));
    let half = (3.0_f64 / 5.0).acos();
    let lens = 2.0 * 25.0 * (half - half.sin() * half.cos());
    assert_near(intersection(&a, &b).area(), lens);
    assert_near(union(&a, &b).area(), 50.0 * PI - lens);
    assert_near(difference(&a, &b).area(), 25.0 * PI - lens);
    assert_eq!(intersection(&a, &b).faces()[0].outer.elements().len(), 2);
}

#[test]
fn squares_that_share_an_edge_become_one() {
    let both = union(&square(0.0, 0.0, 10.0), &square(10.0, 0.0, 10.0));
    assert_eq!(islands(&both), [0]);
    assert_eq!(both.faces()[0].outer.elements().len(), 4);
    assert_near(both.area(), 200.0);
    let shifted = union(&square(0.0, 0.0, 10.0), &square(10.0, 3.0, 10.0));
    assert_eq!(shifted.faces()[0].outer.elements().len(), 8);
    assert_near(shifted.area(), 200.0);
    assert!(intersection(&square(0.0, 0.0, 10.0), &square(10.0, 0.0, 10.0)).is_empty());
    assert_near(difference(&square(0.0, 0.0, 10.0), &square(10.0, 0.0, 10.0)).area(), 100.0);
    assert!(difference(&square(0.0, 0.0, 10.0), &square(0.0, 0.0, 10.0)).is_empty());
}

#[test]
fn squares_that_touch_at_a_corner_stay_two() {
    let both = union(&square(0.0, 0.0, 10.0), &square(10.0, 10.0, 10.0));
    assert_eq!(islands(&both), [0, 0]);
    assert_near(both.area(), 200.0);
    // Four squares around a hole, which touch at their corners.
    let ring: Vec<Region> = [[10.0, 0.0], [0.0, 10.0], [20.0, 10.0], [10.0, 20.0]]
        .iter()
        .map(|[x, y]| square(*x, *y, 10.0))
        .collect();
    let ring = Region::union(&ring.iter().collect::<Vec<_>>(), &Budget::unlimited()).unwrap();
    assert_near(ring.area(), 400.0);
    assert_eq!(ring.place(Point2::new(15.0, 15.0), 1e-6), Containment::Outside);
}

#[test]
fn circles_that_touch_stay_two_and_a_circle_cut_out_is_an_island() {
    assert_eq!(islands(&union(&disc(0.0, 0.0, 5.0), &disc(10.0, 0.0, 5.0))), [0, 0]);
    let washer = difference(&disc(0.0, 0.0, 5.0), &disc(0.0, 0.0, 3.0));
    assert_eq!(islands(&washer), [1]);
    assert_near(washer.area(), 16.0 * PI);
    assert!(washer.faces()[0].islands[0].area() < 0.0);
    // Circles that touch from inside.
    let crescent = difference(&disc(0.0, 0.0, 5.0), &disc(2.0, 0.0, 3.0));
    assert_near(crescent.area(), 16.0 * PI);
    assert_near(union(&crescent, &disc(2.0, 0.0, 3.0)).area(), 25.0 * PI);
}

#[test]
fn islands_may_overlap_touch_the_wall_and_contain_outlines() {
    let budget = Budget::unlimited();
    let pocket = [rectangle([0.0, 0.0], [100.0, 60.0])];
    let overlapping = [rectangle([20.0, 20.0], [20.0, 20.0]), rectangle([30.0, 30.0], [20.0, 20.0])];
    let region = Region::new(&pocket, &overlapping, &budget).unwrap();
    assert_eq!(islands(&region), [1]);
    assert_near(region.area(), 6000.0 - 700.0);
    // An island on the wall becomes a part of the wall. An island across the pocket divides the pocket.
    let region = Region::new(&pocket, &[rectangle([20.0, 0.0], [20.0, 20.0])], &budget).unwrap();
    assert_eq!(islands(&region), [0]);
    assert_near(region.area(), 6000.0 - 400.0);
    let region = Region::new(&pocket, &[rectangle([40.0, -5.0], [10.0, 70.0])], &budget).unwrap();
    assert_eq!(islands(&region), [0, 0]);
    // A round island that touches the wall, an island equal to the pocket, and an outline in an island.
    let region = Region::new(&pocket, &[circle(50.0, 10.0, 10.0)], &budget).unwrap();
    assert_near(region.area(), 6000.0 - 100.0 * PI);
    assert!(Region::new(&pocket, &pocket, &budget).unwrap().is_empty());
    let nested = [pocket[0].clone(), circle(50.0, 30.0, 20.0), circle(50.0, 30.0, 10.0)];
    let region = Region::nested(&nested, &budget).unwrap();
    assert_eq!(islands(&region), [1, 0]);
    assert_near(region.area(), 6000.0 - 300.0 * PI);
}

#[test]
fn arcs_that_coincide_become_one_edge() {
    let half = |sense: f64| region(outline(&[[5.0, 0.0, sense], [-5.0, 0.0, 0.0]]));
    let whole = union(&half(1.0), &half(-1.0));
    assert_near(whole.area(), 25.0 * PI);
    assert_eq!(whole.faces()[0].outer.elements().len(), 2);
    // A disc and a quarter of the same disc.
    let sector = region(outline(&[[0.0, 0.0, 0.0], [5.0, 0.0, (PI / 8.0).tan()], [0.0, 5.0, 0.0]]));
    assert_near(difference(&disc(0.0, 0.0, 5.0), &sector).area(), 25.0 * PI * 0.75);
    assert_near(union(&disc(0.0, 0.0, 5.0), &sector).area(), 25.0 * PI);
    assert_near(intersection(&disc(0.0, 0.0, 5.0), &sector).area(), 25.0 * PI * 0.25);
}

#[test]
fn places_at_the_heights_of_vertices_and_tangents_are_told_apart() {
    let washer = difference(&disc(0.0, 0.0, 5.0), &disc(0.0, 0.0, 3.0));
    for (x, y, expected) in [
        (-4.0, 0.0, Containment::Inside),
        (-6.0, 0.0, Containment::Outside),
        (0.0, 0.0, Containment::Outside),
        (-3.9, 3.0, Containment::Inside),
        (-4.0, 3.0, Containment::OnBoundary),
        (-6.0, 3.0, Containment::Outside),
        (-6.0, 5.0, Containment::Outside),
        (-6.0, -5.0, Containment::Outside),
        (0.0, 5.0, Containment::OnBoundary),
        (0.0, -3.0, Containment::OnBoundary),
    ] {
        assert_eq!(washer.place(Point2::new(x, y), 0.05), expected, "{x} {y}");
    }
    assert_near(washer.distance_to_boundary(Point2::new(0.0, 3.5)), 0.5);
    let [low, high] = washer.bounding_box().unwrap();
    assert!((low - Point2::new(-5.0, -5.0)).norm() < 1e-12 && (high - Point2::new(5.0, 5.0)).norm() < 1e-12);
    // Stairs: every ray from a place on the grid meets vertices.
    let stairs = outline(&[
        [0.0, 0.0, 0.0],
        [3.0, 0.0, 0.0],
        [3.0, 1.0, 0.0],
        [2.0, 1.0, 0.0],
        [2.0, 2.0, 0.0],
        [1.0, 2.0, 0.0],
        [1.0, 3.0, 0.0],
        [0.0, 3.0, 0.0],
    ]);
    let stairs = region(stairs);
    for (x, y) in (-1..8).flat_map(|x| (-1..8).map(move |y| (0.5 * f64::from(x), 0.5 * f64::from(y)))) {
        let depth = [[3.0, 1.0], [2.0, 2.0], [1.0, 3.0]].map(|[right, top]| {
            let inset: f64 = [x, y, right - x, top - y].into_iter().fold(f64::INFINITY, f64::min);
            inset
        });
        let depth = depth.into_iter().fold(f64::NEG_INFINITY, f64::max);
        let place = stairs.place(Point2::new(x, y), 1e-6);
        match place {
            Containment::Inside => assert!(depth > 0.0, "{x} {y}"),
            Containment::Outside => assert!(depth < 0.0, "{x} {y}"),
            Containment::OnBoundary => assert!(depth.abs() < 1e-6, "{x} {y}"),
        }
    }
}

#[test]
fn offsets_of_plain_shapes_have_known_areas() {
    let budget = Budget::unlimited();
    let plate = square(0.0, 0.0, 20.0);
    assert_near(inward(&plate, 3.0).area(), 14.0 * 14.0);
    assert_near(outward(&plate, 3.0).area(), 400.0 + 4.0 * 60.0 + 9.0 * PI);
    assert!(inward(&plate, 10.0).is_empty() && inward(&plate, 11.0).is_empty());
    // The island grows as the outline shrinks.
    let washer = difference(&disc(0.0, 0.0, 10.0), &disc(0.0, 0.0, 3.0));
    let shrunk = inward(&washer, 2.0);
    assert_eq!(islands(&shrunk), [1]);
    assert_near(shrunk.area(), (64.0 - 25.0) * PI);
    assert!(inward(&washer, 3.6).is_empty());
    assert_near(outward(&washer, 2.0).area(), (144.0 - 1.0) * PI);
    assert_near(outward(&washer, 3.0).area(), 169.0 * PI);
    for distance_mm in [0.0, -1.0, f64::INFINITY] {
        let refused = plate.offset_inward(distance_mm, &budget).unwrap_err();
        assert_eq!(refused, RegionError::Distance { distance_mm });
    }
}

#[test]
fn a_neck_of_twice_the_distance_parts_the_offset() {
    // Two rooms of 20 by 20 mm with a corridor 4 mm wide between them.
    let rooms = Region::union(
        &[&square(0.0, 0.0, 20.0), &square(30.0, 0.0, 20.0), &region(rectangle([15.0, 8.0], [20.0, 4.0]))],
        &Budget::unlimited(),
    )
    .unwrap();
    assert_near(rooms.area(), 800.0 + 40.0);
    assert_eq!(islands(&inward(&rooms, 1.9)), [0]);
    let parted = inward(&rooms, 2.0);
    assert_eq!(islands(&parted), [0, 0]);
    // The corners of the corridor are 2 mm away: towards the corridor, each room ends in a cusp of two arcs.
    assert_near(parted.area(), 2.0 * (256.0 + 8.0 - 2.0 * PI));
    assert_eq!(islands(&inward(&rooms, 2.1)), [0, 0]);
}

#[test]
fn a_corner_radius_equal_to_the_distance_leaves_a_sharp_corner() {
    // A plate with corners of radius 3 mm: its offset by 3 mm has sharp corners.
    let quarter = (PI / 8.0).tan();
    let rounded = outline(&[
        [3.0, 0.0, 0.0],
        [17.0, 0.0, quarter],
        [20.0, 3.0, 0.0],
        [20.0, 17.0, quarter],
        [17.0, 20.0, 0.0],
        [3.0, 20.0, quarter],
        [0.0, 17.0, 0.0],
        [0.0, 3.0, quarter],
    ]);
    let inside = inward(&region(rounded), 3.0);
    assert_near(inside.area(), 14.0 * 14.0);
    assert_eq!(inside.faces()[0].outer.elements().len(), 4);
}

#[test]
fn a_cancelled_budget_stops() {
    let budget = Budget::unlimited();
    let (a, b) = (square(0.0, 0.0, 1.0), square(0.5, 0.5, 1.0));
    budget.cancel();
    assert_eq!(a.intersection(&b, &budget).unwrap_err(), RegionError::Stopped(Stopped::Cancelled));
    assert_eq!(a.offset_inward(0.1, &budget).unwrap_err(), RegionError::Stopped(Stopped::Cancelled));
}

//! Tests of set operations and offsets on regions that touch, nearly touch or coincide. No such pair is
//! refused. Each result is within a few snaps of the exact one.

use nalgebra::{Isometry2, Vector2};
use proptest::prelude::*;

use super::*;
use crate::geometry::offset::Side;

/// How far a boundary may be off, mm.
const OFF_MM: f64 = 2e-5;

/// Distances from rounding to what a caliper shows, mm.
fn gaps() -> impl Strategy<Value = f64> {
    (prop_oneof![Just(0.0), (-9.0..-1.0_f64).prop_map(|power| 10.0_f64.powf(power))], prop::bool::ANY)
        .prop_map(|(gap, is_left)| if is_left { -gap } else { gap })
}

fn moved(region: &Region, motion: &Isometry2<f64>) -> Region {
    let element = |element: &Segment| {
        Segment::turning(motion * element.start(), motion * element.end(), element.turn())
    };
    let outlines: Vec<Outline> = region
        .outlines()
        .map(|outline| {
            let elements: Vec<Segment> = outline.elements().iter().map(element).collect();
            Outline::new(&elements, &Budget::unlimited()).unwrap()
        })
        .collect();
    Region::nested(&outlines, &Budget::unlimited()).unwrap()
}

/// Shapes with lines, arcs, tangents and islands, on round numbers.
fn shapes() -> impl Strategy<Value = Region> {
    let size = 2..8_i32;
    (0..6_i32, size.clone(), size).prop_map(|(kind, w, h)| {
        let (w, h) = (f64::from(w), f64::from(h));
        let quarter = (PI / 8.0).tan();
        match kind {
            0 => region(rectangle([0.0, 0.0], [w, h])),
            1 => disc(0.0, 0.0, w),
            2 => region(outline(&[[0.0, 0.0, 0.0], [w, 0.0, 1.0], [w, h, 0.0], [0.0, h, 1.0]])),
            3 => difference(&square(0.0, 0.0, w + h), &square(w * 0.5, h * 0.5, 1.0)),
            4 => difference(&disc(0.0, 0.0, w + h), &disc(0.0, 0.0, h)),
            _ => region(outline(&[
                [1.0, 0.0, 0.0],
                [w - 1.0, 0.0, quarter],
                [w, 1.0, 0.0],
                [w, h - 1.0, quarter],
                [w - 1.0, h, 0.0],
                [1.0, h, quarter],
                [0.0, h - 1.0, 0.0],
                [0.0, 1.0, quarter],
            ])),
        }
    })
}

/// The same shape again, or another one, moved by a gap beside or upon it.
fn neighbours() -> impl Strategy<Value = [Region; 2]> {
    let turns = prop_oneof![Just(0.0), Just(33.0_f64.to_radians()), Just(FRAC_PI_2)];
    (shapes(), shapes(), prop::bool::ANY, [gaps(), gaps()], 0..4_i32, turns, gaps()).prop_map(
        |(a, b, is_same, [x, y], aside, turn, grown)| {
            let b = if is_same { a.clone() } else { b };
            let [low, high] = a.bounding_box().unwrap();
            let [from, _] = b.bounding_box().unwrap();
            let beside = match aside {
                0 => Vector2::new(high.x - from.x, 0.0),
                1 => Vector2::new(0.0, high.y - from.y),
                2 => low - from,
                _ => Vector2::zeros(),
            };
            let b = moved(&b, &Isometry2::new(beside + Vector2::new(x, y), 0.0));
            let b = if grown > 0.0 { outward(&b, grown) } else { b };
            [a, b].map(|region| moved(&region, &Isometry2::new(Vector2::new(13.7, -5.3), turn)))
        },
    )
}

fn length(region: &Region) -> f64 {
    region.outlines().map(|outline| outline::length(outline.elements())).sum()
}

fn laws_hold(a: &Region, b: &Region) -> Result<(), TestCaseError> {
    let [all, both, left, right] = [union(a, b), intersection(a, b), difference(a, b), difference(b, a)];
    let off = OFF_MM * (length(a) + length(b));
    let close = |x: f64, y: f64| (x - y).abs() <= off;
    prop_assert!(close(all.area() + both.area(), a.area() + b.area()));
    prop_assert!(close(left.area() + both.area(), a.area()));
    prop_assert!(close(right.area() + both.area(), b.area()));
    prop_assert!(intersection(&left, b).area() <= off);
    prop_assert!(close(union(&union(&left, &both), &right).area(), all.area()));
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, ..ProptestConfig::default() })]

    #[test]
    fn neighbours_are_never_refused_and_keep_the_laws_of_sets(neighbours in neighbours()) {
        let [a, b] = neighbours;
        laws_hold(&a, &b)?;
    }

    #[test]
    fn what_is_left_of_neighbours_can_be_offset(neighbours in neighbours(), quarters in 1..8_i32) {
        let [a, b] = neighbours;
        let distance = 0.25 * f64::from(quarters);
        for region in [union(&a, &b), difference(&a, &b)] {
            let grown = outward(&region, distance);
            prop_assert!(grown.area() >= region.area());
            let back = inward(&grown, distance);
            prop_assert!(back.area() >= region.area() - OFF_MM * length(&region));
            prop_assert!(inward(&region, distance).area() <= region.area());
        }
    }

    /// Offsets by capsules are the offsets by moved outlines, on the safe side.
    #[test]
    fn capsules_make_the_same_offsets(neighbours in neighbours(), quarters in 1..8_i32) {
        let budget = Budget::unlimited();
        let [a, b] = neighbours;
        let (region, distance) = (union(&a, &b), 0.25 * f64::from(quarters));
        for side in [Side::Left, Side::Right] {
            let Ok(usual) = region.moved_aside(side, distance, &budget) else { continue };
            let other = region.by_capsules(side, distance, &budget).unwrap();
            let off = OFF_MM * (length(&usual) + length(&region));
            prop_assert!((usual.area() - other.area()).abs() <= off, "{} {}", usual.area(), other.area());
        }
    }
}

/// Rows, rings and arcs of a cutter, as earlier programs have them: beside each other by exactly the radius,
/// by nearly the diameter, and twice over the same way.
#[test]
fn swept_areas_are_known_to_a_few_snaps() {
    let budget = Budget::unlimited();
    let at = |x: f64, y: f64| Point2::new(x, y);
    let line = |a, b| Segment::Line { start: a, end: b };
    let radius = 4.0;
    for gap in [0.0, 1e-9, 1e-7, 1e-6, 1e-5, 1e-4, 1e-3] {
        for apart in [radius, 2.0 * radius - gap, 2.0 * radius + gap] {
            let rows: Vec<Vec<Segment>> = (0..4)
                .map(|k| {
                    let y = f64::from(k) * apart;
                    vec![line(at(0.0, y), at(30.0, y)), line(at(30.0, y), at(30.0, y + gap))]
                })
                .collect();
            let ring = |d: f64| {
                let corner = [at(d, d), at(40.0 - d, d), at(40.0 - d, 30.0 - d), at(d, 30.0 - d)];
                (0..4).map(|k| line(corner[k], corner[(k + 1) % 4])).collect::<Vec<_>>()
            };
            let rings = vec![ring(0.0), ring(apart), ring(0.0)];
            for chains in [rows, rings] {
                for turn in [0.0, 0.576] {
                    let motion = Isometry2::new(Vector2::new(3.0, 7.0), turn);
                    let chains: Vec<Vec<Segment>> = chains
                        .iter()
                        .map(|chain| {
                            chain.iter().map(|e| line(motion * e.start(), motion * e.end())).collect()
                        })
                        .collect();
                    let chains: Vec<&[Segment]> = chains.iter().map(Vec::as_slice).collect();
                    let swept = Region::swept(&chains, radius, &budget).unwrap();
                    let elements = chains.iter().copied().flatten();
                    let capsules = Region::of_capsules(elements, radius, &budget).unwrap();
                    let off = OFF_MM * length(&capsules);
                    assert!((swept.area() - capsules.area()).abs() < off, "gap {gap}, {apart} apart");
                }
            }
        }
    }
}

#[test]
fn a_disc_as_wide_as_a_neck_goes_through_it() {
    let budget = Budget::unlimited();
    let slack = 8e-6;
    for (narrower, goes_through) in [(0.0, true), (1e-6, true), (1e-5, true), (-1e-3, true), (1e-4, false)] {
        for turn in [0.0, 0.576, FRAC_PI_2] {
            let width = 6.0 - narrower;
            let motion = Isometry2::new(Vector2::new(-41.0, 17.0), turn);
            let neck = region(rectangle([15.0, 10.0 - 0.5 * width], [30.0, width]));
            let rooms = Region::union(&[&square(0.0, 0.0, 20.0), &square(40.0, 0.0, 20.0), &neck], &budget);
            let rooms = moved(&rooms.unwrap(), &motion);
            let centers = rooms.centers_of_disc(3.0, slack, &budget).unwrap();
            assert_eq!(centers.faces().len(), if goes_through { 1 } else { 2 }, "narrower by {narrower}");
            let middle = Segment::Line {
                start: motion * Point2::new(10.0, 10.0),
                end: motion * Point2::new(50.0, 10.0),
            };
            assert_eq!(centers.contains(&middle, 1e-6), goes_through);
            for element in centers.outlines().flat_map(Outline::elements) {
                assert!(rooms.clearance(element, 3.0) > 3.0 - slack - 2e-6);
            }
            // Where the room is wide, walls are as far as without a slack.
            let usual = rooms.offset_inward(3.0, &budget).unwrap();
            assert!((centers.area() - usual.area()).abs() < 0.03, "{} {}", centers.area(), usual.area());
            // Alone, the slot has its middle line, as long as the slot less the disc.
            let alone = moved(&neck, &motion).centers_of_disc(3.0, slack, &budget).unwrap();
            assert_eq!(alone.is_empty(), !goes_through);
            if goes_through {
                assert!((0.5 * length(&alone) - 24.0).abs() < 2e-3);
            }
        }
    }
    // A hole as wide as the disc has its centre, and a slot with round ends the line between their centres.
    let hole = disc(5.0, 7.0, 3.0).centers_of_disc(3.0, slack, &budget).unwrap();
    assert!((hole.faces()[0].outer.centroid() - Point2::new(5.0, 7.0)).norm() < 1e-5);
    let round = region(outline(&[[0.0, 0.0, 0.0], [10.0, 0.0, 1.0], [10.0, 6.0, 0.0], [0.0, 6.0, 1.0]]));
    let round = round.centers_of_disc(3.0, slack, &budget).unwrap();
    assert!((0.5 * length(&round) - 10.0).abs() < 1e-4);
    // A wedge between two discs has no strip in its cusp.
    let plate = square(-20.0, -20.0, 40.0);
    let wedge = difference(&plate, &union(&disc(0.0, 6.0, 5.0), &disc(0.0, -6.0, 5.0)));
    let [usual, centers] =
        [wedge.offset_inward(1.5, &budget).unwrap(), wedge.centers_of_disc(1.5, slack, &budget).unwrap()];
    assert!((length(&usual) - length(&centers)).abs() < 1e-9);
}

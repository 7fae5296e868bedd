//! Tests that random regions obey the laws of sets, and that offsets keep their distance. The results are
//! compared with windings and distances at sampled places.

use nalgebra::Vector2;
use proptest::prelude::*;

use super::*;

/// A star: a loop about a place that sees its corners one after the other, with arcs that cannot cross their
/// neighbours.
fn star(center: [f64; 2], corners: &[(f64, f64)]) -> Option<Region> {
    let count = corners.len() as f64;
    let points: Vec<[f64; 3]> = corners
        .iter()
        .enumerate()
        .map(|(k, (reach, bulge))| {
            let angle = 4.0 * FRAC_PI_2 * k as f64 / count;
            [center[0] + reach * angle.cos(), center[1] + reach * angle.sin(), *bulge]
        })
        .collect();
    Outline::new(&elements(&points), &Budget::unlimited()).ok().map(region)
}

/// Whether the boundary turns about the place, by the sum of the angles of chords. The chords leave their
/// arcs by less than the place's distance. This check is independent of boxes, trees and snaps.
fn is_inside(region: &Region, p: Point2<f64>) -> bool {
    let mut turned = 0.0;
    for element in region.outlines().flat_map(Outline::elements) {
        let chords = match element {
            Segment::Arc(arc) => 1.0 + arc.turn().abs() * (arc.radius() / element.distance_to(p)).sqrt(),
            Segment::Line { .. } => 1.0,
        };
        let chords = chords.ceil();
        let at = |k: usize| element.at(k as f64 / chords) - p;
        turned +=
            (0..chords as usize).map(|k| at(k).perp(&at(k + 1)).atan2(at(k).dot(&at(k + 1)))).sum::<f64>();
    }
    turned > PI
}

fn from_boundary(region: &Region, p: Point2<f64>) -> f64 {
    region
        .outlines()
        .flat_map(Outline::elements)
        .map(|element| element.distance_to(p))
        .fold(f64::INFINITY, f64::min)
}

/// Unions of blocks on round numbers, where many edges and vertices coincide.
fn blocks() -> impl Strategy<Value = Region> {
    let block = (0..8_i32, 0..8_i32, 1..5_i32, 1..5_i32, 0..3_i32);
    prop::collection::vec(block, 1..6).prop_map(|blocks| {
        let one = |(x, y, w, h, kind): (i32, i32, i32, i32, i32)| {
            let [x, y, w, h] = [x, y, w, h].map(f64::from);
            match kind {
                0 => region(rectangle([x, y], [w, h])),
                1 => disc(x, y, w),
                _ => region(outline(&[[x, y, 0.0], [x + w, y, 1.0], [x + w, y + h, 0.0], [x, y + h, 1.0]])),
            }
        };
        let blocks: Vec<Region> = blocks.into_iter().map(one).collect();
        Region::union(&blocks.iter().collect::<Vec<_>>(), &Budget::unlimited()).unwrap()
    })
}

fn stars() -> impl Strategy<Value = Region> {
    let corner = (2.0..8.0_f64, prop_oneof![Just(0.0), -0.5..0.5_f64]);
    let shape = (prop::array::uniform2(0.0..8.0_f64), prop::collection::vec(corner, 3..24));
    shape.prop_filter_map("crosses itself", |(center, corners)| star(center, &corners))
}

/// Shapes with cusps, tips and tangents, where the arc about a corner could lie on the wrong side.
#[test]
fn offsets_of_shapes_that_touch_keep_their_distance() {
    let quarter = (PI / 8.0).tan();
    let slot = |x: f64, y: f64, length: f64, width: f64| {
        outline(&[[x, y, 0.0], [x + length, y, 1.0], [x + length, y + width, 0.0], [x, y + width, 1.0]])
    };
    let sector =
        |x: f64, y: f64, radius: f64| outline(&[[x, y, 0.0], [x + radius, y, quarter], [x, y + radius, 0.0]]);
    let tip = |toward: f64| outline(&[[5.0, 5.0, 0.0], [5.0 + toward, 4.5, 0.0], [5.0 + toward, 5.5, 0.0]]);
    let shapes = [
        vec![tip(4.0), tip(-4.0)],
        vec![tip(4.0), rectangle([1.0, 1.0], [4.0, 8.0])],
        vec![circle(5.0, 5.0, 2.0), rectangle([7.0, 3.0], [2.0, 4.0])],
        // The quarter circle meets the end of the slot in a cusp.
        vec![sector(5.0, 1.0, 2.0), slot(7.0, 2.0, 4.0, 1.0)],
        // The corner of one shape lies in the corner of another.
        vec![sector(7.0, 6.0, 1.0), slot(2.0, 5.0, 3.0, 4.0), sector(6.0, 7.0, 2.0)],
    ];
    let grid: Vec<[f64; 2]> =
        (-4..28).flat_map(|x| (-4..28).map(move |y| [0.5 * f64::from(x), 0.5 * f64::from(y)])).collect();
    for shapes in shapes {
        let region = Region::new(&shapes, &[], &Budget::unlimited()).unwrap();
        for distance in [0.1, 0.25, 0.8, 1.3] {
            offsets_agree(&region, distance, &grid).unwrap();
        }
    }
}

/// Checks the laws of sets for two regions, by areas and at places.
fn sets_agree(a: &Region, b: &Region, places: &[[f64; 2]]) -> Result<(), TestCaseError> {
    let [all, both, left, right] = [union(a, b), intersection(a, b), difference(a, b), difference(b, a)];
    let length: f64 = [a, b].iter().flat_map(|r| r.outlines()).map(|o| outline::length(o.elements())).sum();
    let close = |x: f64, y: f64| (x - y).abs() <= 1e-6 * length;
    prop_assert!(close(all.area() + both.area(), a.area() + b.area()));
    prop_assert!(close(left.area() + both.area(), a.area()));
    prop_assert!(close(union(&left, &both).area(), a.area()));
    prop_assert!(intersection(&left, b).area() <= 1e-6 * length);
    for p in places.iter().map(|[x, y]| Point2::new(*x, *y)) {
        if from_boundary(a, p).min(from_boundary(b, p)) < 1e-5 {
            continue;
        }
        let [in_a, in_b] = [a, b].map(|region| is_inside(region, p));
        let expected = [in_a, in_b, in_a || in_b, in_a && in_b, in_a && !in_b, in_b && !in_a];
        for (region, is_in) in [a, b, &all, &both, &left, &right].into_iter().zip(expected) {
            let place = if is_in { Containment::Inside } else { Containment::Outside };
            prop_assert_eq!(region.place(p, 1e-6), place, "{}", p);
        }
    }
    Ok(())
}

/// Checks that a place is in an inner offset exactly if it is in the region and farther from the boundary
/// than the distance, and in an outer offset exactly if it is in the region or nearer than the distance.
fn offsets_agree(region: &Region, distance: f64, places: &[[f64; 2]]) -> Result<(), TestCaseError> {
    let (inner, outer) = (inward(region, distance), outward(region, distance));
    for offset in [&inner, &outer] {
        for element in offset.outlines().flat_map(Outline::elements) {
            for k in 0..=8 {
                let p = element.at(f64::from(k) / 8.0);
                let apart = from_boundary(region, p);
                prop_assert!((apart - distance).abs() < 4e-6, "{} is {} from the boundary", p, apart);
            }
        }
    }
    for p in places.iter().map(|[x, y]| Point2::new(*x, *y)) {
        let apart = from_boundary(region, p);
        if (apart - distance).abs() < 1e-5 {
            continue;
        }
        // A place beside the boundary is in no inner offset and in every outer offset, on whichever side it
        // lies.
        let is_in = apart > 1e-5 && is_inside(region, p);
        prop_assert_eq!(inner.place(p, 0.0) == Containment::Inside, is_in && apart > distance, "{}", p);
        prop_assert_eq!(outer.place(p, 0.0) == Containment::Inside, is_in || apart < distance, "{}", p);
    }
    Ok(())
}

fn places() -> impl Strategy<Value = Vec<[f64; 2]>> {
    prop::collection::vec(prop::array::uniform2(-4.0..16.0_f64), 40)
}

/// Places on the grid of round numbers, where rays run through vertices.
fn round_places() -> impl Strategy<Value = Vec<[f64; 2]>> {
    let halves = (-8..32_i32).prop_map(|k| 0.5 * f64::from(k));
    prop::collection::vec(prop::array::uniform2(halves), 40)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, ..ProptestConfig::default() })]

    #[test]
    fn blocks_on_round_numbers_keep_the_laws_of_sets(a in blocks(), b in blocks(), places in round_places()) {
        sets_agree(&a, &b, &places)?;
    }

    #[test]
    fn stars_with_arcs_keep_the_laws_of_sets(a in stars(), b in stars(), places in places()) {
        sets_agree(&a, &b, &places)?;
    }

    #[test]
    fn offsets_of_blocks_on_round_numbers_keep_their_distance(
        a in blocks(), quarters in 1..12_i32, places in round_places()
    ) {
        offsets_agree(&a, 0.25 * f64::from(quarters), &places)?;
    }

    #[test]
    fn offsets_of_stars_with_arcs_keep_their_distance(
        a in stars(), distance in 0.05..3.0_f64, places in places()
    ) {
        offsets_agree(&a, distance, &places)?;
    }

    /// Inner offsets are repeated until nothing is left: the area only shrinks.
    #[test]
    fn repeated_inner_offsets_end(a in stars(), distance in 0.1..1.0_f64) {
        let mut rings = vec![a];
        while !rings[rings.len() - 1].is_empty() {
            let next = inward(&rings[rings.len() - 1], distance);
            prop_assert!(next.area() < rings[rings.len() - 1].area());
            rings.push(next);
        }
        prop_assert!(rings.len() < 2 + (8.0 / distance) as usize);
    }

    #[test]
    fn a_turned_region_is_the_same_region(a in stars(), b in stars(), angle in 0.0..6.0_f64) {
        let motion = nalgebra::Isometry2::new(Vector2::new(31.0, -57.0), angle);
        let moved = |region: &Region| {
            let outlines: Vec<Outline> = region.outlines().map(|outline| {
                let elements: Vec<Segment> = outline.elements().iter().map(|element| {
                    Segment::turning(motion * element.start(), motion * element.end(), element.turn())
                }).collect();
                Outline::new(&elements, &Budget::unlimited()).unwrap()
            }).collect();
            Region::nested(&outlines, &Budget::unlimited()).unwrap()
        };
        let (here, there) = (union(&a, &b), union(&moved(&a), &moved(&b)));
        prop_assert!((here.area() - there.area()).abs() < 1e-6 * (1.0 + here.area()));
        prop_assert_eq!(islands(&here).len(), islands(&there).len());
    }
}

use nalgebra::Point3;
use proptest::prelude::*;

use super::*;
use crate::geometry::curve::{Arc, Curve, Direction, Line};
use crate::geometry::plane::Plane;
use crate::geometry::region::Outline;
use crate::machining::cutter::Cutter;

const SLICE: Slice = Slice { z_mm: -4.0, slack_mm: 0.0, chord_mm: 1e-4 };

/// A rectangle of 60 x 40 mm whose corners are rounded by `corner` mm.
fn pocket(corner: f64) -> Region {
    let budget = Budget::unlimited();
    let (w, h, r) = (60.0, 40.0, corner);
    let sides =
        [[[r, 0.0], [w - r, 0.0]], [[w, r], [w, h - r]], [[w - r, h], [r, h]], [[0.0, h - r], [0.0, r]]];
    let mut elements = Vec::new();
    for k in 0..4 {
        let [start, end] = sides[k].map(Point2::from);
        elements.push(Segment::Line { start, end });
        if r > 0.0 {
            elements.push(Segment::turning(
                end,
                Point2::from(sides[(k + 1) % 4][0]),
                std::f64::consts::FRAC_PI_2,
            ));
        }
    }
    Region::new(&[Outline::new(&elements, &budget).unwrap()], &[], &budget).unwrap()
}

fn line(from: [f64; 3], to: [f64; 3]) -> Curve {
    Curve::Line(Line { start: Point3::from(from), end: Point3::from(to) })
}

/// A ring at the distance `off` from the walls, with arcs of `corner - off` mm at its corners.
fn ring(off: f64, corner: f64, z: f64) -> Vec<Curve> {
    let (w, h, r) = (60.0, 40.0, (corner - off).max(0.0));
    let (low, right, up, a) = (off, w - off, h - off, off + r);
    let sides = [
        [[a, low], [w - a, low]],
        [[right, a], [right, h - a]],
        [[w - a, up], [a, up]],
        [[low, h - a], [low, a]],
    ];
    let centers = [[w - a, a], [w - a, h - a], [a, h - a], [a, a]];
    let mut curves = Vec::new();
    for k in 0..4 {
        let [from, to] = sides[k].map(|[x, y]| [x, y, z]);
        curves.push(line(from, to));
        if r > 0.0 {
            let [next, center] = [sides[(k + 1) % 4][0], centers[k]].map(|[x, y]| Point3::new(x, y, z));
            let arc = Arc::new(Plane::Xy, Direction::Ccw, Point3::from(to), next, center).unwrap();
            curves.push(Curve::Arc(arc));
        }
    }
    curves
}

fn cleared(curves: &[Curve], cutter: &Cutter, level: Slice) -> Cleared {
    let swaths = curves.iter().enumerate().map(|(number, tip)| Swath { tip, cutter, number });
    Cleared::new(swaths, level)
}

fn left_by(curves: &[Curve], cutter: &Cutter, corner: f64) -> Thickest {
    let cleared = cleared(curves, cutter, SLICE);
    thickest(&pocket(corner), &cleared, cutter.radius(), 1e-3, &Budget::unlimited()).unwrap().unwrap()
}

#[test]
fn a_ring_along_the_walls_leaves_nothing_where_the_cutter_reaches() {
    let flat = Cutter::bull_nose(5.0, 0.0);
    for corner in [0.0, 4.0, 5.0, 8.0] {
        let left = left_by(&ring(5.0, corner, -4.0), &flat, corner);
        assert!(left.bound_mm < 2e-3, "{corner}: {left:?}");
    }
}

#[test]
fn a_skin_of_two_hundredths_is_told_with_its_move() {
    let flat = Cutter::bull_nose(5.0, 0.0);
    for (corner, k) in [(0.0, 1), (8.0, 2), (8.0, 3)] {
        let mut curves = ring(5.0, corner, -4.0);
        let own = ring(5.02, corner, -4.0)[k];
        curves[k] = own;
        let left = left_by(&curves, &flat, corner);
        assert!((0.0195..0.0225).contains(&left.bound_mm), "{corner} {k}: {left:?}");
        assert!(left.found_mm > 0.0185, "{corner} {k}: {left:?}");
        assert_eq!(left.nearest, Some(k), "{left:?}");
    }
}

#[test]
fn a_ring_above_the_level_clears_nothing() {
    let flat = Cutter::bull_nose(5.0, 0.0);
    assert_eq!(left_by(&ring(5.0, 8.0, -3.9), &flat, 8.0).bound_mm, f64::INFINITY);
}

#[test]
fn a_rounded_corner_is_narrower_near_the_tip() {
    let bull = Cutter::bull_nose(5.0, 2.0);
    // The level is 1 mm above the tip: the cutter is 3 + sqrt(3) mm wide there.
    let left = left_by(&ring(5.0, 8.0, -5.0), &bull, 8.0);
    let expected = 2.0 - 3.0f64.sqrt();
    assert!((left.bound_mm - expected).abs() < 2e-3, "{left:?} {expected}");
}

#[test]
fn slack_thickens_what_is_left() {
    let flat = Cutter::bull_nose(5.0, 0.0);
    let curves = ring(5.0, 8.0, -4.02);
    let cleared = cleared(&curves, &flat, Slice { slack_mm: 0.01, ..SLICE });
    let left = thickest(&pocket(8.0), &cleared, 5.0, 1e-3, &Budget::unlimited()).unwrap().unwrap();
    assert!(left.bound_mm >= 0.01 && left.bound_mm < 0.012 && left.found_mm < 1e-9, "{left:?}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]
    #[test]
    fn no_reached_place_has_more_left_than_the_bound(
        ends in prop::collection::vec(prop::array::uniform2(2.0f64..38.0), 2..8), radius in 2.0f64..5.0,
        corner in 5.0f64..9.0, t in 0.0f64..1.0, side in 0usize..8,
    ) {
        let curves: Vec<Curve> =
            ends.windows(2).map(|e| line([e[0][0], e[0][1], -4.0], [e[1][0], e[1][1], -4.0])).collect();
        let flat = Cutter::bull_nose(radius, 0.0);
        let left = left_by(&curves, &flat, corner);
        let region = pocket(corner);
        let walls: Vec<Segment> = region.outlines().flat_map(|outline| outline.elements().to_vec()).collect();
        let p = walls[side % walls.len()].at(t);
        let distance = |curve: &Curve| {
            let (a, b) = (curve.start().xy(), curve.end().xy());
            (Segment::Line { start: a, end: b }.distance_to(p) - radius).max(0.0)
        };
        let own = curves.iter().map(distance).fold(f64::INFINITY, f64::min);
        prop_assert!(own <= left.bound_mm + 1e-9, "{own} {left:?}");
        prop_assert!(left.found_mm <= left.bound_mm + 1e-9, "{left:?}");
    }
}

//! Laws of offsets that demand a result: closed forms for convex outlines, and checks by samples for random
//! contours. Corrupted results show that the checks fail.

use proptest::prelude::*;

use super::*;
use crate::geometry::region::area;

/// A convex outline with its corners on a circle, counterclockwise. Arcs of the circle replace some sides.
fn convex(radius: f64, corners: &[(f64, bool)]) -> Vec<Segment> {
    let total: f64 = corners.iter().map(|(gap, _)| gap).sum();
    let (mut points, mut bulges, mut angle) = (Vec::new(), Vec::new(), 0.0);
    for (gap, is_arc) in corners {
        points.push((radius * f64::cos(angle), radius * f64::sin(angle)));
        let turn = TAU * gap / total;
        angle += turn;
        bulges.push(if *is_arc { (turn / 4.0).tan() } else { 0.0 });
    }
    points.push(points[0]);
    contour(&points, &bulges)
}

/// The only chain of an offset.
fn offset_of(contour: &[Segment], side: Side, distance: f64) -> Vec<Segment> {
    let found = run(contour, side, distance);
    assert_eq!(found.chains.len(), 1, "{found:?}");
    found.chains.concat()
}

fn square() -> Vec<Segment> {
    lines(&[(0.0, 0.0), (10.0, 0.0), (10.0, 10.0), (0.0, 10.0), (0.0, 0.0)])
}

#[test]
#[should_panic(expected = "the offset misses")]
fn an_empty_result_is_found_out_where_the_disc_fits() {
    check(&square(), Side::Left, R, &[]);
}

#[test]
#[should_panic(expected = "the offset misses")]
fn a_missing_side_is_found_out() {
    let mut chains = run(&square(), Side::Left, R).chains;
    chains[0].pop();
    check(&square(), Side::Left, R, &chains);
}

#[test]
#[should_panic(expected = "the offset misses")]
fn a_missing_corner_is_found_out() {
    let mut chains = run(&square(), Side::Right, R).chains;
    let is_arc = |element: &Segment| matches!(element, Segment::Arc(_));
    let corner = chains[0].iter().position(is_arc).unwrap();
    let rest = chains[0].split_off(corner + 1);
    chains[0].pop();
    chains.push(rest);
    check(&square(), Side::Right, R, &chains);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, ..ProptestConfig::default() })]

    /// Steiner's formulas. The offset back to the inside is the outline again.
    #[test]
    fn a_convex_outline_grows_by_the_formulas_of_steiner_and_shrinks_back(
        radius in 1.0..20.0_f64,
        corners in prop::collection::vec((1.0..4.0_f64, any::<bool>()), 3..20),
        distance in 0.1..30.0_f64,
    ) {
        let outline = convex(radius, &corners);
        let (perimeter, inside) = (length(&outline), area(&outline));
        let outer = offset_of(&outline, Side::Right, distance);
        prop_assert_eq!(outer[0].start(), outer[outer.len() - 1].end());
        prop_assert!((length(&outer) - (perimeter + TAU * distance)).abs() < 1e-6);
        let grown = inside + perimeter * distance + PI * distance * distance;
        prop_assert!((area(&outer) - grown).abs() < 1e-6 * grown);
        let again = offset_of(&outer, Side::Left, distance);
        prop_assert!((length(&again) - perimeter).abs() < 1e-5, "{} {}", length(&again), perimeter);
        prop_assert!((area(&again) - inside).abs() < 1e-5 * (1.0 + perimeter));
    }

    /// The disc about the mean of the corners is inside, so the inradius is at least its radius. A convex
    /// area A with the perimeter P has an inradius of at most 2 A / P.
    #[test]
    fn an_inner_offset_of_a_convex_outline_is_empty_only_where_the_disc_does_not_fit(
        radius in 1.0..20.0_f64,
        corners in prop::collection::vec((1.0..4.0_f64, any::<bool>()), 3..20),
        part in 0.05..0.99_f64,
    ) {
        let outline = convex(radius, &corners);
        let sum: Vector2<f64> = outline.iter().map(|element| element.start().coords).sum();
        let fits = to_chain(&outline, Point2::from(sum / outline.len() as f64));
        let inner = offset_of(&outline, Side::Left, part * fits);
        prop_assert!(area(&inner) >= PI * ((1.0 - part) * fits).powi(2) - 1e-6);
        prop_assert!(area(&inner) <= area(&outline) - part * fits * length(&inner));
        let too_large = 2.0 * area(&outline) / length(&outline) * 1.001;
        prop_assert!(run(&outline, Side::Left, too_large).chains.is_empty());
    }

    #[test]
    fn offsets_of_random_contours_keep_their_distance_and_miss_no_place(
        steps in prop::collection::vec((0.05..3.0f64, -1.2..1.2f64, -0.7..0.7f64, any::<bool>()), 2..40),
        radius in 0.1..3.0f64,
    ) {
        let (mut at, mut heading) = ((0.0, 0.0), 0.0f64);
        let (mut points, mut bulges) = (vec![at], Vec::new());
        for (length, turn, bulge, is_line) in steps {
            heading += turn;
            at = (at.0 + length * heading.cos(), at.1 + length * heading.sin());
            points.push(at);
            bulges.push(if is_line { 0.0 } else { bulge });
        }
        let contour = contour(&points, &bulges);
        for side in [Side::Left, Side::Right] {
            run(&contour, side, radius);
        }
    }
}

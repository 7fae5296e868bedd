//! Parabolas written as blocks and as lines.

use super::*;
use crate::geometry::curve::Parabola;

fn parabola(start: [f64; 3], control: [f64; 3], end: [f64; 3]) -> Parabola {
    Parabola::new(start.into(), control.into(), end.into()).unwrap()
}

/// A control that runs all arcs and these parabolas.
fn runs(parabolas: Parabolas) -> Curves {
    Curves { parabolas, ..Curves::ARCS }
}

/// Checks every promise of the module for one parabola.
fn check(source: &Parabola, resolution: Resolution, parabolas: Parabolas) -> Vec<Written> {
    let grid = Grid::new(resolution);
    let rounded = round(&Curve::Parabola(*source), resolution, &runs(parabolas)).unwrap();
    assert!(rounded.displacement_mm <= MAX_DISPLACEMENT_STEPS * grid.step_mm());
    let (start, end) = (grid.round(&source.start()).unwrap(), grid.round(&source.end()).unwrap());
    assert_eq!(rounded.curves.last().map_or(start, |block| block.end_units), end);
    let mut at = start;
    for block in &rounded.curves {
        assert_eq!((block.curve.start(), block.curve.end()), (grid.point(at), grid.point(block.end_units)));
        assert!(block.displacement_mm <= rounded.displacement_mm);
        match (block.curve, block.form) {
            (Curve::Parabola(exact), Form::Parabola { control: [i, j] }) => {
                assert_eq!(exact.control(), grid.point([at[0] + i, at[1] + j, at[2]]));
                assert_eq!(block.end_units[2], at[2]);
                assert!(parabolas == Parabolas::InXy && block.slack_mm > 0.0);
            }
            (Curve::Line(_), Form::Line) => {}
            other => panic!("{other:?}"),
        }
        for k in 0..=20 {
            let off = source.distance_to(&block.curve.point_at(f64::from(k) / 20.0));
            assert!(off <= block.displacement_mm + 1e-12, "{off} {block:?}");
        }
        at = block.end_units;
    }
    // The order is kept: the block nearest to a point of the source never goes back by more than one.
    let mut reached = 0;
    for k in 0..=200 {
        let p = source.at(f64::from(k) / 200.0);
        let off = |n: usize| match rounded.curves.get(n) {
            Some(block) => block.curve.distance_to(&p),
            None => (p - grid.point(start)).norm(),
        };
        while reached + 1 < rounded.curves.len() && off(reached) > rounded.displacement_mm + 1e-12 {
            reached += 1;
        }
        let near = off(reached).min(off(reached.saturating_sub(1)));
        assert!(near <= rounded.displacement_mm + 1e-12, "{k}: {near} {source:?}");
    }
    rounded.curves
}

fn point() -> impl Strategy<Value = [f64; 3]> {
    (-1.5..2.2f64, prop::array::uniform3(-1.0..1.0f64)).prop_map(|(size, p)| p.map(|x| x * 10f64.powf(size)))
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn parabolas_keep_every_promise(
        points in prop::array::uniform3(point()), flatness in prop_oneof![Just(1.0), (-6.0..0.0f64).prop_map(|k| 10f64.powf(k))],
        level: bool, inch: bool, place in -200.0..200.0f64,
    ) {
        let [start, control, end] = points.map(|[x, y, z]| {
            Point3::new(x + place, y - place, if level { 0.3 * place } else { z })
        });
        let middle = nalgebra::center(&start, &end);
        let source = Parabola::new(start, middle + (control - middle) * flatness, end).unwrap();
        let resolution = if inch { INCH } else { MM };
        for parabolas in [Parabolas::InXy, Parabolas::AsLines] {
            let written = check(&source, resolution, parabolas);
            if parabolas == Parabolas::AsLines || !level {
                prop_assert!(written.iter().all(|block| matches!(block.curve, Curve::Line(_))));
            }
        }
    }
}

#[test]
fn a_parabola_of_common_size_is_one_block_and_its_rounding_is_exact() {
    let arch = parabola([0.0, 0.0, 5.0], [10.0004, 8.0, 5.0], [20.0, 0.0, 5.0]);
    let written = check(&arch, MM, Parabolas::InXy);
    assert_eq!(written.len(), 1);
    assert_eq!(written[0].form, Form::Parabola { control: [10_000, 8_000] });
    assert!((written[0].displacement_mm - written[0].slack_mm - 0.0004).abs() < 1e-12);
    // The arcs of a control are too far from a large parabola.
    let large = parabola([0.0; 3], [500.0, 400.0, 0.0], [1000.0, 0.0, 0.0]);
    let blocks = check(&large, MM, Parabolas::InXy).len();
    assert!((2..=8).contains(&blocks), "{blocks}");
    assert!(check(&large, MM, Parabolas::AsLines).len() > 500);
}

#[test]
fn straight_parabolas_become_lines_and_tiny_ones_vanish() {
    for (control, count) in
        [([3.0, 0.0, 0.0], 1), ([0.0; 3], 1), ([9.0, 0.0009, 0.0], 1), ([4.0, 0.0, 2e-4], 1)]
    {
        for parabolas in [Parabolas::InXy, Parabolas::AsLines] {
            let written = check(&parabola([0.0; 3], control, [9.0, 0.0, 0.0]), MM, parabolas);
            assert_eq!((written.len(), written[0].form), (count, Form::Line), "{control:?}");
        }
    }
    let turning = check(&parabola([0.0; 3], [8.0, 0.0, 0.0], [4.0, 0.0, 0.0]), MM, Parabolas::InXy);
    assert!(turning.iter().all(|block| block.form == Form::Line));
    let farthest = turning.iter().map(|block| block.curve.end().x).fold(0.0, f64::max);
    assert!((farthest - 16.0 / 3.0).abs() <= 0.0015, "{farthest}");
    let small = parabola([0.0; 3], [1e-4, 4e-4, 0.0], [3e-4, 0.0, 0.0]);
    assert!(check(&small, MM, Parabolas::InXy).is_empty());
    for size in 1..100 {
        let loop_mm = f64::from(size) * 1e-4;
        let back = parabola([0.3e-3, 0.0, 0.0], [loop_mm, 2.0 * loop_mm, 0.0], [0.3e-3, 0.0, 0.0]);
        check(&back, MM, Parabolas::InXy);
        check(&parabola([0.0; 3], [loop_mm, loop_mm, 0.0], [0.0, loop_mm, 0.0]), MM, Parabolas::InXy);
    }
}

#[test]
fn a_long_flat_parabola_becomes_lines_where_a_control_would_divide_by_zero() {
    let fine = Resolution { units: Units::Mm, decimals: 6 };
    let flat = parabola([0.0; 3], [500.0, 2e-6, 0.0], [1000.0, 0.0, 0.0]);
    let written = check(&flat, fine, Parabolas::InXy);
    assert!(!written.is_empty() && written.iter().all(|block| block.form == Form::Line));
}

#[test]
fn a_parabola_that_needs_too_many_blocks_is_an_error() {
    let fine = Resolution { units: Units::Mm, decimals: 6 };
    let huge = Curve::Parabola(parabola([0.0; 3], [1e6, 1e6, 0.0], [-1e6, 1e6, 0.0]));
    let limit = MAX_PIECES;
    for parabolas in [Parabolas::AsLines, Parabolas::InXy] {
        let found = quantize(&huge, fine, &runs(parabolas));
        assert!(found.is_ok() || found == Err(QuantizeError::TooManyPieces { limit }), "{found:?}");
    }
    assert_eq!(quantize(&huge, fine, &Curves::ARCS), Err(QuantizeError::TooManyPieces { limit }));
}

mod parabolas;

use std::f64::consts::TAU;

use nalgebra::Vector3;
use proptest::prelude::*;

use super::*;
use crate::geometry::curve::Direction;
use crate::geometry::plane::Plane;
use crate::toolpath::program::Units;

const MM: Resolution = Resolution { units: Units::Mm, decimals: 3 };
const INCH: Resolution = Resolution { units: Units::Inch, decimals: 4 };

/// The point at the fraction `t` of a path that a control may run for a block, about the written centre. Its
/// radius is the mean of the radii at both ends, weighted by `mix`; without `mix` it changes evenly with the
/// angle.
fn run(written: &Written, grid: &Grid, t: f64, mix: Option<f64>) -> Point3<f64> {
    let (Curve::Arc(arc), Form::Arc { center: [i, j] }) = (written.curve, written.form) else {
        return written.curve.point_at(t);
    };
    let plane = arc.plane();
    let (s, e) = (plane.to_local(&arc.start()), plane.to_local(&arc.end()));
    let center = s + Vector3::new(grid.mm(i), grid.mm(j), 0.0);
    let (from, to) = ((s - center).xy(), (e - center).xy());
    let r = from.norm() + (to.norm() - from.norm()) * mix.unwrap_or(t);
    let sign = if arc.direction() == Direction::Ccw { 1.0 } else { -1.0 };
    let turn = from.perp(&to).atan2(from.dot(&to)) * sign;
    let sweep = if s.xy() == e.xy() { TAU } else { turn.rem_euclid(TAU) };
    let angle = from.y.atan2(from.x) + sign * sweep * t;
    let rise = arc.rise() * t;
    plane.to_workpiece(&(center + Vector3::new(r * angle.cos(), r * angle.sin(), rise)))
}

/// Distance from `p` to the curve `at(fraction)`. The nearest fraction is within `width` of `guess`.
fn nearest(p: &Point3<f64>, guess: f64, width: f64, at: impl Fn(f64) -> Point3<f64>) -> f64 {
    let off = |t: f64| (p - at(t)).norm();
    let (mut from, mut to) = ((guess - width).clamp(0.0, 1.0), (guess + width).clamp(0.0, 1.0));
    let ends = off(from).min(off(to));
    while to - from > 1e-12 {
        let (a, b) = (from + 0.382 * (to - from), from + 0.618 * (to - from));
        if off(a) < off(b) { to = b } else { from = a }
    }
    ends.min(off((from + to) / 2.0))
}

/// Checks every promise of the module for one arc.
fn check(arc: &Arc, resolution: Resolution) -> Vec<Written> {
    let grid = Grid::new(resolution);
    let step = grid.step_mm();
    let source = Curve::Arc(*arc);
    let rounded = round(&source, resolution, &Curves::ARCS).unwrap();
    let written = rounded.curves;
    let limit = MAX_DISPLACEMENT_STEPS * step + 1e-9;
    let (start, end) = (grid.round(&arc.start()).unwrap(), grid.round(&arc.end()).unwrap());
    assert_eq!(written.last().map_or(start, |block| block.end_units), end);
    let mut at = start;
    let mut length = 0.0;
    let mut reached = 0.0;
    let whole: f64 = written.iter().map(|block| block.curve.length()).sum();
    let samples = if written.len() > 4 { 2 } else { 8 };
    for block in &written {
        assert_eq!(grid.round(&block.curve.start()).unwrap(), at);
        assert_eq!(grid.point(block.end_units), block.curve.end());
        assert!(block.displacement_mm <= limit);
        assert!(block.radius_mismatch_mm <= (MAX_MISMATCH_STEPS * step).min(Curves::ARCS.radius_mismatch_mm));
        if let Curve::Arc(exact) = block.curve {
            assert_eq!((exact.plane(), exact.direction()), (arc.plane(), arc.direction()));
            assert!(exact.sweep() <= arc.sweep() + 1.0);
            assert!(exact.sweep() < TAU || arc.sweep() == TAU);
            let sagitta = 2.0 * exact.radius() * (exact.sweep() / 4.0).sin().powi(2);
            assert!(sagitta >= MIN_SAGITTA_STEPS * step - 1e-12);
            assert!(exact.radius() <= 1.01 * Curves::ARCS.largest_radius_mm);
        }
        // Each point a control may pass is near the source, at about its fraction of the length.
        let share = block.curve.length() / whole;
        for k in 0..=samples {
            let t = f64::from(k) / f64::from(samples);
            let guess = reached + share * t;
            let width = 0.02 + 8.0 * step / whole;
            for mix in [None, Some(0.0), Some(1.0)] {
                let p = run(block, &grid, t, mix);
                let off = nearest(&p, guess, width, |t| source.point_at(t));
                assert!(off <= block.displacement_mm + 1e-8, "{off} {block:?}");
                let exactly = block.curve.point_at(t);
                let off = nearest(&exactly, guess, width, |t| source.point_at(t));
                assert!(off <= block.displacement_mm + 1e-8, "{off} {block:?}");
                let own = nearest(&p, t, 0.05, |t| block.curve.point_at(t));
                assert!(own <= block.slack_mm + 1e-8, "{own} {block:?}");
            }
        }
        reached += share;
        at = block.end_units;
        length += block.curve.length();
    }
    assert!(rounded.displacement_mm <= limit);
    // And each point of the source is near the block that stands for its fraction, or a neighbour.
    for k in 0..=40 {
        let t = f64::from(k) / 40.0;
        let p = source.point_at(t);
        let mut off = (p - grid.point(start)).norm();
        let (mut from, slip) = (0.0, 0.02 + 8.0 * step / whole);
        for block in &written {
            let to = from + block.curve.length() / whole;
            if (from - slip..=to + slip).contains(&t) {
                let (guess, width) = ((t - from) / (to - from), slip / (to - from));
                off = off.min(nearest(&p, guess, width, |t| run(block, &grid, t, None)));
            }
            from = to;
        }
        assert!(off <= rounded.displacement_mm + 1e-8, "{off} {arc:?}");
    }
    assert!((length - arc.length()).abs() <= 8.0 * step * (1.0 + written.len() as f64) + 1e-3 * arc.length());
    written
}

fn arc(plane: Plane, ccw: bool, radius: f64, angles: [f64; 2], center: [f64; 3], rise: f64) -> Option<Arc> {
    let direction = if ccw { Direction::Ccw } else { Direction::Cw };
    let sign = if ccw { 1.0 } else { -1.0 };
    let c = Vector3::from(center);
    let on = |angle: f64, n: f64| {
        plane.to_workpiece(&(c + Vector3::new(radius * angle.cos(), radius * angle.sin(), n)))
    };
    let start = on(angles[0], 0.0);
    let end = if angles[1] == TAU {
        let mut local = plane.to_local(&start);
        local.z += rise;
        plane.to_workpiece(&local)
    } else {
        on(angles[0] + sign * angles[1], rise)
    };
    Arc::with_center_near(plane, direction, start, end, plane.to_workpiece(&c)).ok()
}

/// Rounding may make the radii at the ends of an arc disagree.
fn no_arc() -> TestCaseError {
    TestCaseError::reject("no arc")
}

fn planes() -> impl Strategy<Value = Plane> {
    prop::sample::select(Plane::ALL.to_vec())
}

fn sweeps() -> impl Strategy<Value = f64> {
    prop_oneof![4 => 1e-3..TAU, 1 => Just(TAU), 1 => (1e-8..1e-1f64).prop_map(|gap| TAU - gap), 1 => 1e-7..1e-2f64]
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(ProptestConfig::default().cases / 4) })]

    #[test]
    fn flat_arcs_keep_every_promise(
        plane in planes(), ccw: bool, size in -2.0..4.0f64, turn in 0.0..TAU, sweep in sweeps(),
        center in prop::array::uniform3(-200.0..200.0f64), inch: bool,
    ) {
        let arc = arc(plane, ccw, 10f64.powf(size), [turn, sweep], center, 0.0);
        check(&arc.ok_or_else(no_arc)?, if inch { INCH } else { MM });
    }

    #[test]
    fn helices_keep_every_promise(
        plane in planes(), ccw: bool, size in -2.0..3.0f64, turn in 0.0..TAU, sweep in sweeps(),
        center in prop::array::uniform3(-200.0..200.0f64), rise in -3.0..3.0f64, down: bool,
    ) {
        let rise = if down { -(10f64.powf(rise)) } else { 10f64.powf(rise) };
        let arc = arc(plane, ccw, 10f64.powf(size), [turn, sweep], center, rise);
        check(&arc.ok_or_else(no_arc)?, MM);
    }

    #[test]
    fn huge_radii_become_chords(plane in planes(), ccw: bool, size in 4.01..6.5f64, turn in 0.0..TAU, length in 0.01..200.0f64) {
        let radius = 10f64.powf(size);
        let (sin, cos) = turn.sin_cos();
        let center = [-radius * cos, -radius * sin, 0.0];
        let arc = arc(plane, ccw, radius, [turn, length / radius], center, 0.0).ok_or_else(no_arc)?;
        for block in check(&arc, MM) {
            prop_assert!(matches!(block.curve, Curve::Line(_)));
        }
    }

    #[test]
    fn joints_agree(p in prop::array::uniform3(-1e6..1e6f64), q in prop::array::uniform3(-1e6..1e6f64)) {
        for resolution in [MM, INCH] {
            let grid = Grid::new(resolution);
            let line = Curve::Line(Line { start: p.into(), end: q.into() });
            let written = quantize(&line, resolution, &Curves::ARCS).unwrap();
            prop_assert_eq!(written[0].end_units, grid.round(&q.into()).unwrap());
            prop_assert_eq!(grid.round(&grid.point(written[0].end_units)).unwrap(), written[0].end_units);
            prop_assert!(written[0].displacement_mm <= 0.87 * grid.step_mm());
        }
    }
}

/// How large mismatches are, and how rarely an arc is split.
#[test]
fn nearly_every_arc_stays_one_block_and_its_radii_agree_within_one_unit() {
    let mut state = 1u64;
    let mut next = move || {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (state >> 11) as f64 / (1u64 << 53) as f64
    };
    let (mut blocks, mut arcs, mut worst) = (0, 0, 0f64);
    for k in 0..5_000 {
        let plane = Plane::ALL[k % 3];
        let (radius, angles) = (0.5 + 99.5 * next(), [TAU * next(), 0.05 + 6.1 * next()]);
        let center = [next(), next(), next()].map(|x| 100.0 * x - 50.0);
        let Some(arc) = arc(plane, k % 2 == 0, radius, angles, center, 0.0) else { continue };
        let written = quantize(&Curve::Arc(arc), MM, &Curves::ARCS).unwrap();
        arcs += 1;
        blocks += written.len();
        worst = written.iter().fold(worst, |worst, block| worst.max(block.radius_mismatch_mm));
    }
    assert!(arcs > 4_900, "only {arcs} arcs");
    assert!(blocks as f64 <= 1.04 * arcs as f64, "{blocks} blocks for {arcs} arcs");
    assert!(worst <= 0.001, "{worst}");
}

#[test]
fn a_full_circle_stays_one_block_and_only_a_full_circle_becomes_one() {
    let circle = arc(Plane::Zx, true, 12.3456, [0.7, TAU], [1.00049, 2.0003, 3.0], 0.0).unwrap();
    let written = check(&circle, MM);
    assert_eq!(written.len(), 1);
    let Curve::Arc(exact) = written[0].curve else { panic!("a line") };
    assert_eq!(exact.sweep(), TAU);
    for gap in [1e-4, 1e-5, 1e-6] {
        for ccw in [true, false] {
            let open = arc(Plane::Xy, ccw, 5.0, [0.7, TAU - gap], [0.0; 3], 0.0).unwrap();
            assert!(check(&open, MM).len() > 1);
            let short = arc(Plane::Xy, ccw, 5.0, [0.7, gap], [0.0; 3], 0.0).unwrap();
            assert!(check(&short, MM).len() <= 1);
        }
    }
}

#[test]
fn curves_below_the_grid_vanish_and_small_circles_stay_near() {
    let tiny = arc(Plane::Xy, true, 4e-4, [0.0, TAU], [0.0; 3], 0.0).unwrap();
    assert!(check(&tiny, MM).len() <= 4);
    let line = Curve::Line(Line { start: Point3::new(0.0001, 0.0, 0.0), end: Point3::new(0.0004, 0.0, 0.0) });
    assert_eq!(quantize(&line, MM, &Curves::ARCS), Ok(Vec::new()));
    for k in 1..200 {
        let circle =
            arc(Plane::Yz, true, f64::from(k) * 1e-4, [1.0, TAU], [0.3e-3, 0.1e-3, 0.0], 0.0).unwrap();
        check(&circle, MM);
    }
}

#[test]
fn curves_that_cannot_be_written_are_errors() {
    let far = Curve::Line(Line { start: Point3::origin(), end: Point3::new(1e13, 0.0, 0.0) });
    assert_eq!(quantize(&far, MM, &Curves::ARCS), Err(QuantizeError::OutOfRange { value_mm: 1e13 }));
    let fine = Resolution { units: Units::Mm, decimals: 6 };
    let circle = arc(Plane::Xy, true, 1e6, [0.0, TAU], [0.0; 3], 0.0).unwrap();
    assert_eq!(
        quantize(&Curve::Arc(circle), fine, &Curves::ARCS),
        Err(QuantizeError::TooManyPieces { limit: MAX_PIECES })
    );
    let written = quantize(&Curve::Arc(circle), MM, &Curves::ARCS).unwrap();
    assert!(written.len() < 100_000 && written.iter().all(|block| block.displacement_mm <= 0.0015));
}

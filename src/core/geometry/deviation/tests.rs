use nalgebra::{Point2, Vector2};
use proptest::prelude::*;

use super::*;
use crate::geometry::plane_curve::Enclosure;
use crate::geometry::segment::Segment;

/// The graph y = sin(x), with enclosures written by hand.
struct Wave {
    domain: [f64; 2],
}

impl PlaneCurve for Wave {
    fn domain(&self) -> [f64; 2] {
        self.domain
    }

    fn breaks(&self) -> &[f64] {
        &[]
    }

    fn is_graph(&self) -> bool {
        true
    }

    fn point(&self, t: f64) -> Point2<f64> {
        Point2::new(t, t.sin())
    }

    fn derivative(&self, t: f64) -> Vector2<f64> {
        Vector2::new(1.0, t.cos())
    }

    fn enclose(&self, from: f64, to: f64) -> Enclosure {
        let (mid, half) = (0.5 * (from + to), 0.5 * (to - from));
        let slack = |x: f64| Interval::around(x, half * 1.000_001 + 1e-15);
        let x = Interval::between(from, to);
        Enclosure {
            point: [x, slack(mid.sin())],
            first: [Interval::point(1.0), slack(mid.cos())],
            second: [Interval::ZERO, slack(-mid.sin())],
        }
    }
}

/// The graph y = |x - 1|: without derivatives at the kink.
struct Kink;

impl PlaneCurve for Kink {
    fn domain(&self) -> [f64; 2] {
        [0.0, 3.0]
    }

    fn breaks(&self) -> &[f64] {
        &[]
    }

    fn point(&self, t: f64) -> Point2<f64> {
        Point2::new(t, (t - 1.0).abs())
    }

    fn derivative(&self, t: f64) -> Vector2<f64> {
        Vector2::new(1.0, (t - 1.0).signum())
    }

    fn enclose(&self, from: f64, to: f64) -> Enclosure {
        let has_kink = from <= 1.0 && to >= 1.0;
        let y = Interval::between(from - 1.0, to - 1.0).abs();
        let unknown = |otherwise: f64| if has_kink { Interval::ENTIRE } else { Interval::point(otherwise) };
        Enclosure {
            point: [Interval::between(from, to), y],
            first: [Interval::point(1.0), unknown(if to > 1.0 { 1.0 } else { -1.0 })],
            second: [Interval::ZERO, unknown(0.0)],
        }
    }
}

fn band(mm: f64, measure: Measure) -> Band {
    Band { below_mm: mm, above_mm: mm, measure }
}

fn line(curve: &impl PlaneCurve, [a, b]: [f64; 2]) -> Element {
    Segment::Line { start: curve.point(a), end: curve.point(b) }.into()
}

fn parabola(curve: &impl PlaneCurve, [a, b]: [f64; 2]) -> Element {
    Element::parabola_through([a, 0.5 * (a + b), b].map(|t| curve.point(t)))
}

fn spread(verdict: Verdict) -> Spread {
    match verdict {
        Verdict::Within(spread) => spread,
        other => panic!("{other:?}"),
    }
}

/// The elements on which the counts in Hyun's tables depend.
#[test]
fn bands_close_to_the_deviation_are_judged_right() {
    let wave = Wave { domain: [0.0, 6.5] };
    let third = [6.5 / 3.0, 13.0 / 3.0];
    let chord = line(&wave, third);
    let normal = spread(judge(&wave, &chord, third, Ends::OnCurve, &band(0.1, Measure::Normal)));
    assert!((normal.largest_mm() - 0.0898).abs() < 0.003, "{normal:?}");
    let vertical = judge(&wave, &chord, third, Ends::OnCurve, &band(0.1, Measure::Vertical));
    assert!(matches!(vertical, Verdict::Outside { .. }));
    for (domain, largest) in [([0.0, 1.3], 0.1011), ([6.5 / 7.0, 13.0 / 7.0], 0.1027)] {
        let chord = line(&wave, domain);
        let tight = judge(&wave, &chord, domain, Ends::OnCurve, &band(0.1, Measure::Normal));
        assert!(matches!(tight, Verdict::Outside { .. }), "{tight:?}");
        let loose = judge(&wave, &chord, domain, Ends::OnCurve, &band(largest + 1e-4, Measure::Normal));
        assert!(matches!(loose, Verdict::Within(_)), "{loose:?}");
    }
}

/// The verdict changes at the true deviation, to a billionth of a millimetre.
#[test]
fn a_band_just_above_the_deviation_holds_and_one_just_below_does_not() {
    let wave = Wave { domain: [0.0, 4.0] };
    let domain = [0.0, std::f64::consts::PI];
    let chord = line(&wave, domain);
    for measure in [Measure::Normal, Measure::Vertical] {
        for gap in [1e-3, 1e-5, 1e-7, 1e-9] {
            let judged = |mm| judge(&wave, &chord, domain, Ends::OnCurve, &band(mm, measure));
            assert!(matches!(judged(1.0 + gap), Verdict::Within(_)), "{gap}");
            assert!(matches!(judged(1.0 - gap), Verdict::Outside { .. }), "{gap}");
        }
    }
}

#[test]
fn a_chord_below_the_curve_needs_room_below() {
    let wave = Wave { domain: [0.0, 6.5] };
    // The chord under the first wave lies below the curve.
    let domain = [0.5, 2.0];
    let one_sided = |below_mm, above_mm| Band { below_mm, above_mm, measure: Measure::Normal };
    let chord = line(&wave, domain);
    let judged = |band: Band| judge(&wave, &chord, domain, Ends::OnCurve, &band);
    assert!(matches!(judged(one_sided(1.0, 0.0)), Verdict::Within(_)));
    assert!(matches!(judged(one_sided(0.0, 1.0)), Verdict::Outside { .. }));
    let spread = spread(judged(one_sided(1.0, 0.0)));
    assert!(spread.most_mm <= 1e-11 && spread.least_mm < -0.1, "{spread:?}");
}

#[test]
fn a_kink_is_measured_without_derivatives() {
    // The chord runs from (0, 1) to (3, 2). The kink lies 4/3 below it, or 1.2649 along the normal.
    let chord = line(&Kink, [0.0, 3.0]);
    for (measure, largest) in [(Measure::Vertical, 4.0 / 3.0), (Measure::Normal, 4.0 / 10f64.sqrt())] {
        let within = judge(&Kink, &chord, [0.0, 3.0], Ends::OnCurve, &band(largest + 1e-6, measure));
        let found = spread(within).largest_mm();
        assert!(found >= largest && found <= 1.26 * largest, "{found}");
        let outside = judge(&Kink, &chord, [0.0, 3.0], Ends::OnCurve, &band(largest - 1e-6, measure));
        assert!(matches!(outside, Verdict::Outside { .. }), "{outside:?}");
    }
}

/// A curve that runs back past its start.
struct Hairpin;

impl PlaneCurve for Hairpin {
    fn domain(&self) -> [f64; 2] {
        [0.0, 1.0]
    }

    fn breaks(&self) -> &[f64] {
        &[]
    }

    fn point(&self, t: f64) -> Point2<f64> {
        Point2::new(t * (4.0 * t - 3.0), 0.0)
    }

    fn derivative(&self, t: f64) -> Vector2<f64> {
        Vector2::new(8.0 * t - 3.0, 0.0)
    }

    fn enclose(&self, from: f64, to: f64) -> Enclosure {
        let t = Interval::between(from, to);
        Enclosure {
            point: [t * (t * 4.0 - Interval::point(3.0)), Interval::ZERO],
            first: [t * 8.0 - Interval::point(3.0), Interval::ZERO],
            second: [Interval::point(8.0), Interval::ZERO],
        }
    }
}

#[test]
fn a_curve_that_runs_back_past_its_start_leaves_its_chord() {
    // The curve goes back to x = -9/16.
    let chord = line(&Hairpin, [0.0, 1.0]);
    let judged = |mm| judge(&Hairpin, &chord, [0.0, 1.0], Ends::OnCurve, &band(mm, Measure::Normal));
    assert!(!matches!(judged(0.5), Verdict::Within(_)));
    assert!(matches!(judged(0.6), Verdict::Within(_)), "{:?}", judged(0.6));
}

fn shapes() -> impl Strategy<Value = (u8, f64, f64, f64)> {
    (0u8..3, 0.0..6.0f64, 0.05..1.5f64, -0.3..0.3f64)
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn bounds_hold_and_are_tight((shape, a, width, bulge) in shapes(), vertical in any::<bool>()) {
        let wave = Wave { domain: [0.0, 8.0] };
        let domain = [a, a + width];
        let element = match shape {
            0 => line(&wave, domain),
            1 => parabola(&wave, domain),
            _ => Segment::bulging(wave.point(a), wave.point(a + width), bulge).into(),
        };
        let measure = if vertical { Measure::Vertical } else { Measure::Normal };
        let verdict = judge(&wave, &element, domain, Ends::OnCurve, &band(10.0, measure));
        let (mut least, mut most) = (0.0f64, 0.0f64);
        let mut is_graph = true;
        for k in 0..=4000 {
            let t = a + width * f64::from(k) / 4000.0;
            let p = wave.point(t);
            let distance = match measure {
                Measure::Normal => element.foot(p, f64::from(k) / 4000.0).0.distance,
                Measure::Vertical => match element.graph_at(t) {
                    Some(y) => p.y - y,
                    None => { is_graph = false; 0.0 }
                },
            };
            (least, most) = (least.min(-distance), most.max(-distance));
        }
        if let (Verdict::Within(spread), true) = (verdict, is_graph) {
            prop_assert!(spread.most_mm >= most && spread.least_mm <= least, "{spread:?} {least} {most}");
            let largest = most.max(-least);
            prop_assert!(spread.largest_mm() <= 1.25 * largest + 3e-7, "{spread:?} {least} {most}");
        } else {
            // The arc is no graph, or is vertical at its end.
            prop_assert!(vertical && shape == 2, "{verdict:?}");
        }
    }
}

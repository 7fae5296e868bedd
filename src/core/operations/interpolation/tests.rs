//! Tests of what the service's answers do not show: errors, limits, and joints.

use super::*;
use crate::geometry::deviation::{Band, GUARD_MM};
use crate::toolpath::quantize::Parabolas;

fn job(curve: Source, method: Method, subdivision: Subdivision, mm: f64) -> Job {
    Job::new(curve, method, subdivision, Band { below_mm: mm, above_mm: mm, measure: Measure::Normal })
}

fn graph(expression: &str, domain: [f64; 2]) -> Source {
    Source::Graph { expression: expression.into(), domain }
}

fn planned(job: &Job) -> Plan {
    plan(job, &Budget::unlimited()).unwrap()
}

#[test]
fn a_circle_is_few_arcs_and_many_lines() {
    // A full circle about the origin, by rational quadratics.
    let half = 0.5f64.sqrt();
    let points = [[1, 0], [1, 1], [0, 1], [-1, 1], [-1, 0], [-1, -1], [0, -1], [1, -1], [1, 0]];
    let circle = Source::Nurbs(crate::geometry::plane_curve::nurbs::Nurbs {
        degree: 2,
        knots: vec![0.0, 0.0, 0.0, 1.0, 1.0, 2.0, 2.0, 3.0, 3.0, 4.0, 4.0, 4.0],
        control_points: points.map(|[x, y]| Point2::new(10.0 * f64::from(x), 10.0 * f64::from(y))).into(),
        weights: Some(vec![1.0, half, 1.0, half, 1.0, half, 1.0, half, 1.0]),
    });
    let least = Subdivision::Least(Joints::OnCurve);
    let arcs = planned(&job(circle.clone(), Method::Arc, least, 1e-4)).report;
    assert!(arcs.elements.len() <= 2 && arcs.deviation_max_mm < 1e-6, "{arcs:?}");
    assert!((arcs.length_mm - 20.0 * std::f64::consts::PI).abs() < 1e-9);
    // Chords of sagitta e turn by 2 acos(1 - e / r): no count of them is smaller.
    for mm in [1e-1, 1e-2, 1e-3] {
        let lines = planned(&job(circle.clone(), Method::Linear, least, mm)).report;
        let exact = std::f64::consts::PI / (1.0 - (mm + GUARD_MM) / 10.0).acos();
        assert_eq!(lines.elements.len(), exact.ceil() as usize, "{mm}");
        let bound = lines.n_elements_lower_bound.unwrap();
        assert!(bound <= lines.elements.len() && bound + 1 >= lines.elements.len(), "{mm} {bound}");
    }
}

#[test]
fn corners_are_kept_where_that_costs_nothing() {
    let text = "l(0,0) l(30,0) l(30,20) l(0,20) l(0,0)";
    let square = planned(&job(
        Source::SectionCurve(text.into()),
        Method::Linear,
        Subdivision::Least(Joints::OnCurve),
        0.05,
    ));
    let ends: Vec<_> = square.report.elements.iter().map(|element| element.element.end()).collect();
    assert_eq!(ends, [[30.0, 0.0], [30.0, 20.0], [0.0, 20.0], [0.0, 0.0]].map(Point2::from));
    assert!(square.report.deviation_max_mm < 1e-9);
}

#[test]
fn a_straight_line_is_one_element_even_without_a_band_on_one_side() {
    for method in [Method::Linear, Method::Parabolic, Method::Mixed, Method::Arc] {
        let mut job = job(graph("3 - x/7", [0.0, 50.0]), method, Subdivision::Bisection, 0.01);
        job.band.above_mm = 0.0;
        let report = planned(&job).report;
        assert_eq!((report.elements.len(), report.n_elements_lower_bound), (1, Some(1)), "{method:?}");
    }
}

#[test]
fn a_kink_and_an_upright_end_are_interpolated() {
    for (expression, domain) in
        [("abs(x-1)", [0.0, 3.0]), ("sqrt(x)", [0.0, 4.0]), ("sqrt(1-x^2)", [-1.0, 1.0])]
    {
        for method in [Method::Linear, Method::Parabolic, Method::Arc] {
            for subdivision in [Subdivision::Bisection, Subdivision::Least(Joints::OnCurve)] {
                let report = planned(&job(graph(expression, domain), method, subdivision, 0.01)).report;
                assert!(report.elements.len() < 60, "{expression} {method:?} {}", report.elements.len());
                assert!(report.deviation_max_mm <= 0.01 + 1e-9);
            }
        }
    }
}

#[test]
fn a_control_without_parabolas_gets_arcs_within_the_same_band() {
    let mut job = job(graph("sin(x)", [0.0, 6.5]), Method::Parabolic, Subdivision::Bisection, 0.01);
    job.curves.parabolas = Parabolas::AsLines;
    let plan = planned(&job);
    assert!(!plan.report.elements.is_empty());
    assert!(plan.report.elements.iter().all(|element| matches!(element.element, Element::Parabola { .. })));
    let counts =
        crate::toolpath::measure::measure(&plan.toolpath, crate::toolpath::units::FeedRate::DEFAULT_RAPID)
            .moves;
    assert_eq!(counts.parabola, 0);
    assert!(counts.arc >= 6 && counts.arc + counts.line <= 20, "{counts:?}");
}

#[test]
fn a_limit_or_a_cancelled_budget_ends_the_job_with_an_error() {
    let mut small = job(graph("sin(x)", [0.0, 6.5]), Method::Linear, Subdivision::Bisection, 1e-4);
    small.element_limit = 100;
    assert_eq!(plan(&small, &Budget::unlimited()).unwrap_err(), Error::TooManyElements { limit: 100 });
    let budget = Budget::unlimited();
    budget.cancel();
    for subdivision in [Subdivision::Bisection, Subdivision::Least(Joints::InBand)] {
        let job = job(
            Source::Points(vec![Point2::new(0.0, 0.0), Point2::new(1.0, 2.0), Point2::new(3.0, 0.0)]),
            Method::Linear,
            subdivision,
            0.01,
        );
        assert_eq!(plan(&job, &budget).unwrap_err(), Error::Stopped(Stopped::Cancelled));
    }
}

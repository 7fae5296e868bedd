//! A band whose sides are numbers, or functions of x.
//!
//! The widths belong to the points of the curve: at the point (x, y) of a graph y(x), the band is `below(x)`
//! wide below the curve and `above(x)` above it. By the vertical measure the widths are taken along y. By the
//! normal measure the point of the curve is no farther than its widths from the element. Where a function is
//! below zero, the side has no width.
//!
//! # Guarantees
//! Between two parameters, the proof takes the lower end of the enclosure of each function (`least`).
//!
//! # Reference
//! C. H. Hyun, "The Tool Path Determination for Machining the Plane Curve by an Adaptive Mesh Generation
//! Technique", 1992, section 2: the bounds G1(x) and G2(x).

use super::{AnyCurve, Error, Job};
use crate::budget::Budget;
use crate::geometry::deviation::{Band, Measure, Sides};
use crate::geometry::interval::Interval;
use crate::geometry::plane_curve::PlaneCurve;
use crate::language::expression::{Expression, ExpressionError, Undefined};

/// The largest width of a side, mm.
pub const WIDEST_MM: f64 = 10.0;

/// A side of a band.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Side {
    Below,
    Above,
}

/// Widths in mm as expressions in x, for the sides that have no constant width.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Widths {
    pub below: Option<String>,
    pub above: Option<String>,
}

/// Why a width that is an expression is no width.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum WidthError {
    #[error(transparent)]
    Expression(#[from] ExpressionError),
    #[error(transparent)]
    Undefined(#[from] Undefined),
    #[error("the width is up to {most_mm} mm; at most {WIDEST_MM} mm are supported")]
    TooWide { most_mm: f64 },
    #[error("a width that is an expression supports graphs y(x) only; send a number")]
    WithoutGraph,
    #[error("a width that is an expression does not support joints in the band; use joints on the curve")]
    JointsInBand,
}

/// A band along a curve.
#[derive(Debug, Clone, PartialEq)]
pub struct BandAlong {
    /// The widths that are numbers, and upper bounds of the others.
    pub widest: Band,
    functions: [Option<Expression>; 2],
}

impl BandAlong {
    /// The band of a job.
    ///
    /// # Errors
    /// When a function is no width over the whole domain, or the budget ends.
    pub(super) fn of(job: &Job, curve: &AnyCurve, budget: &Budget) -> Result<Self, Error> {
        let function = |side: Side, text: &Option<String>| -> Result<_, Error> {
            let Some(text) = text else { return Ok(None) };
            let refused = |error| Error::Width { side, error };
            if !curve.is_graph() {
                return Err(refused(WidthError::WithoutGraph));
            }
            let expression = Expression::parse(text).map_err(|fault| refused(fault.into()))?;
            let bounds = match expression.examine(curve.domain(), budget) {
                Ok(bounds) => bounds,
                Err(Undefined::Stopped(stopped)) => return Err(stopped.into()),
                Err(undefined) => return Err(refused(undefined.into())),
            };
            if bounds.hi() > WIDEST_MM * (1.0 + BOUND_PART) {
                return Err(refused(WidthError::TooWide { most_mm: bounds.hi() }));
            }
            Ok(Some((expression, bounds.hi().max(0.0))))
        };
        let below = function(Side::Below, &job.widths.below)?;
        let above = function(Side::Above, &job.widths.above)?;
        let widest = |number: f64, function: &Option<(Expression, f64)>| {
            function.as_ref().map_or(number, |(_, most)| *most)
        };
        let widest = Band {
            below_mm: widest(job.band.below_mm, &below),
            above_mm: widest(job.band.above_mm, &above),
            measure: job.band.measure,
        };
        if (below.is_some() || above.is_some()) && widest.below_mm + widest.above_mm < LEAST_WIDTH_MM {
            return Err(Error::BandInfeasible { at: curve.point(curve.domain()[0]) });
        }
        Ok(Self {
            widest,
            functions: [below, above].map(|function| function.map(|(expression, _)| expression)),
        })
    }

    /// Whether a side is a function.
    pub fn varies(&self) -> bool {
        self.functions.iter().any(Option::is_some)
    }

    /// The widths below and above at a parameter, to rounding, mm.
    pub fn at(&self, t: f64) -> [f64; 2] {
        self.each(|expression| expression.value(t).max(0.0))
    }

    /// The widths, with `value` for those that are functions.
    fn each(&self, value: impl Fn(&Expression) -> f64) -> [f64; 2] {
        let [below, above] = &self.functions;
        [
            below.as_ref().map_or(self.widest.below_mm, &value),
            above.as_ref().map_or(self.widest.above_mm, &value),
        ]
    }
}

/// A band that is narrower than this everywhere has no room, mm.
const LEAST_WIDTH_MM: f64 = 1e-6;

/// The part by which the upper bound of a function may exceed its values.
const BOUND_PART: f64 = 1e-3;

/// A graph has x as its parameter.
impl Sides for BandAlong {
    fn measure(&self) -> Measure {
        self.widest.measure
    }

    fn least(&self, [from, to]: [f64; 2]) -> [f64; 2] {
        self.each(|expression| expression.enclose(Interval::between(from, to))[0].lo().max(0.0))
    }

    fn most(&self, t: f64) -> [f64; 2] {
        self.each(|expression| expression.enclose(Interval::point(t))[0].hi().max(0.0))
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Point2;
    use proptest::prelude::*;

    use super::super::{Joints, Method, Plan, Source, Subdivision, Widths, plan};
    use super::*;

    const DOMAIN: [f64; 2] = [0.0, 10.0];

    fn job(expression: &str, method: Method, [below, above]: [&str; 2], measure: Measure) -> Job {
        let source = Source::Graph { expression: expression.to_owned(), domain: DOMAIN };
        let band = Band { below_mm: 0.0, above_mm: 0.0, measure };
        let widths = Widths { below: Some(below.to_owned()), above: Some(above.to_owned()) };
        Job { widths, ..Job::new(source, method, Subdivision::Least(Joints::OnCurve), band) }
    }

    fn planned(job: &Job) -> Result<Plan, Error> {
        plan(job, &Budget::unlimited())
    }

    /// By how much the elements leave the band, at many points of the curve, mm; at most rounding.
    fn excess(plan: &Plan) -> f64 {
        let mut most = f64::NEG_INFINITY;
        for reported in &plan.report.elements {
            let [from, to] = reported.domain;
            for k in 0..=400 {
                let part = f64::from(k) / 400.0;
                let t = from + (to - from) * part;
                let point = plan.curve.point(t);
                let distance = match plan.band.measure() {
                    Measure::Vertical => point.y - reported.element.graph_at(t).unwrap(),
                    Measure::Normal => reported.element.foot(point, part).0.distance,
                };
                let [below, above] = plan.band.at(t);
                most = most.max(distance - below).max(-distance - above);
            }
        }
        most
    }

    #[test]
    fn numbers_and_constant_expressions_make_the_same_elements() {
        for method in [Method::Linear, Method::Parabolic, Method::Arc] {
            let varying = job("sin(x)", method, ["0.01", "0.02"], Measure::Normal);
            let mut constant = Job { widths: Widths::default(), ..varying.clone() };
            (constant.band.below_mm, constant.band.above_mm) = (0.01, 0.02);
            let [varying, constant] = [varying, constant].map(|job| planned(&job).unwrap().report);
            assert_eq!(varying.n_elements, constant.n_elements, "{method:?}");
            assert_eq!(varying.n_elements_lower_bound, constant.n_elements_lower_bound);
        }
    }

    /// The chord of y = x^2 / 100 from a to b lies (x - a)(b - x) / 100 mm above the curve. With the width
    /// (x + 1)^2 / 400, the longest chord has b + 1 = g (a + 1), where g is the square of the golden ratio.
    #[test]
    fn elements_grow_with_a_width_that_grows() {
        let growing = job("x^2/100", Method::Linear, ["0", "(x+1)^2/400"], Measure::Vertical);
        let plan = planned(&growing).unwrap();
        let ends: Vec<f64> = plan.report.elements.iter().map(|element| element.domain[1]).collect();
        assert_eq!(ends.len(), 3);
        let golden = 0.5 * (3.0 + 5f64.sqrt());
        assert!((ends[0] + 1.0 - golden).abs() < 1e-3 && ends[1] + 1.0 < golden * golden, "{ends:?}");
        assert!(excess(&plan) < 1e-9);
    }

    #[test]
    fn a_notch_in_the_width_is_seen() {
        // The notch is narrower than the distance of samples.
        let notch = "0.05 - 0.0499*exp(-((x-3.14)/0.004)^2)";
        let notched = job("sin(x/2)", Method::Linear, [notch, notch], Measure::Normal);
        let notched = planned(&notched).unwrap();
        let notch = 157.0 / 50.0;
        let at_notch = notched.report.elements.iter().find(|e| e.domain[0] <= notch && notch < e.domain[1]);
        let element = &at_notch.unwrap().element;
        let p = Point2::new(notch, (0.5f64 * notch).sin());
        assert!(element.foot(p, 0.5).0.distance.abs() <= 1.001e-4);
    }

    #[test]
    fn what_is_no_width_is_refused() {
        let refused =
            |widths: [&str; 2]| match planned(&job("sin(x)", Method::Linear, widths, Measure::Normal)) {
                Err(Error::Width { side, error }) => Some((side, error)),
                _ => None,
            };
        assert!(matches!(refused(["0.01*", "0.01"]), Some((Side::Below, WidthError::Expression(_)))));
        assert!(matches!(refused(["0.01", "1/(x-5)"]), Some((Side::Above, WidthError::Undefined(_)))));
        assert!(matches!(refused(["0.01", "11+x"]), Some((Side::Above, WidthError::TooWide { .. }))));
        let none = job("sin(x)", Method::Linear, ["-1", "x-20"], Measure::Normal);
        assert!(matches!(planned(&none), Err(Error::BandInfeasible { .. })));
        let mut points = job("sin(x)", Method::Linear, ["0.01", "0.01"], Measure::Normal);
        points.curve = Source::Points([[0.0, 0.0], [1.0, 2.0], [3.0, 1.0]].map(Point2::from).to_vec());
        let error = planned(&points).map(|_| ());
        assert_eq!(error, Err(Error::Width { side: Side::Below, error: WidthError::WithoutGraph }));
        let mut free = job("sin(x)", Method::Linear, ["0.01", "0.01"], Measure::Normal);
        free.subdivision = Subdivision::Least(Joints::InBand);
        let error = planned(&free).map(|_| ());
        assert_eq!(error, Err(Error::Width { side: Side::Below, error: WidthError::JointsInBand }));
    }

    fn width() -> impl Strategy<Value = String> {
        (1e-3..0.03f64, -1.0..1.0f64, 0.2..3.0f64, 0..4u8).prop_map(|(a, b, c, kind)| match kind {
            0 => format!("{a}*(1+{b}*sin({c}*x))"),
            1 => format!("{a}*abs(x-{})", 5.0 + 5.0 * b),
            2 => format!("{a}*exp({b}*x/5)"),
            _ => format!("max({a}, 0.01*({b}*x+{c}))"),
        })
    }

    proptest! {
        #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(ProptestConfig::default().cases / 16) })]

        #[test]
        fn no_element_leaves_a_band_of_functions(
            below in width(), above in width(), is_vertical: bool, is_halved: bool,
            curve in prop::sample::select(vec!["sin(x)", "x^2/20", "3*exp(-x/3)*cos(x)", "hypot(x-4,0.5)"]),
            method in prop::sample::select(vec![Method::Linear, Method::Parabolic, Method::Mixed, Method::Arc]),
        ) {
            let measure = if is_vertical { Measure::Vertical } else { Measure::Normal };
            let mut job = Job { element_limit: 200, ..job(curve, method, [&below, &above], measure) };
            if is_halved {
                job.subdivision = Subdivision::Bisection;
            }
            if let Ok(plan) = planned(&job) {
                prop_assert!(excess(&plan) <= 1e-9, "{} {curve} {below} {above}", excess(&plan));
                let bound = plan.report.n_elements_lower_bound;
                prop_assert!(bound.is_none_or(|bound| bound <= plan.report.n_elements));
            }
        }
    }
}

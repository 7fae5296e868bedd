//! The graph y(x) of an expression as a plane curve.

use nalgebra::{Point2, Vector2};

use super::expression::{Expression, Undefined};
use crate::budget::Budget;
use crate::geometry::interval::Interval;
use crate::geometry::plane_curve::{Enclosure, PlaneCurve};

/// How far from its place the derivative is taken if it does not exist at the place, as a part of the domain.
const NUDGE: f64 = 1e-9;

/// The points (x, y(x)) over a domain where y is proved to be defined and continuous; mm.
#[derive(Debug, Clone, PartialEq)]
pub struct Graph {
    expression: Expression,
    domain: [f64; 2],
    bounds: Interval,
}

impl Graph {
    /// The graph of `expression` over `domain`.
    ///
    /// # Errors
    /// The place where the expression is not defined, or where the proof fails; or the budget is spent.
    pub fn new(expression: Expression, domain: [f64; 2], budget: &Budget) -> Result<Self, Undefined> {
        let bounds = expression.examine(domain, budget)?;
        Ok(Self { expression, domain, bounds })
    }

    pub fn expression(&self) -> &Expression {
        &self.expression
    }

    /// Bounds of y over the whole domain, mm; see [`Expression::examine`].
    pub fn bounds(&self) -> Interval {
        self.bounds
    }
}

impl PlaneCurve for Graph {
    fn domain(&self) -> [f64; 2] {
        self.domain
    }

    /// A graph has no breaks. Where y has a kink, the enclosure of its second derivative is the whole line.
    fn breaks(&self) -> &[f64] {
        &[]
    }

    fn is_graph(&self) -> bool {
        true
    }

    fn operations(&self) -> u64 {
        self.expression.operations()
    }

    fn point(&self, t: f64) -> Point2<f64> {
        let y = self.expression.value(t);
        if y.is_finite() {
            return Point2::new(t, y);
        }
        // Rounding moved an operand out of its domain. Enclosures use the nearest legal operand.
        let [value, ..] = self.expression.enclose(Interval::point(t));
        Point2::new(t, value.mid())
    }

    /// The derivative at `t`. Where it does not exist or is infinite, the derivative 1e-9 of the domain
    /// farther on, or else as far before `t`.
    fn derivative(&self, t: f64) -> Vector2<f64> {
        let [from, to] = self.domain;
        let step = NUDGE * (to - from);
        let places = [t, (t + step).min(to), (t - step).max(from)];
        let slopes = places.map(|x| self.expression.value_and_derivative(x)[1]);
        let slope = slopes.into_iter().find(|slope| slope.is_finite());
        Vector2::new(1.0, slope.unwrap_or(0.0))
    }

    fn enclose(&self, from: f64, to: f64) -> Enclosure {
        let t = Interval::between(from, to);
        let [value, first, second] = self.expression.enclose(t);
        Enclosure { point: [t, value], first: [Interval::ONE, first], second: [Interval::ZERO, second] }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn graph(text: &str, domain: [f64; 2]) -> Graph {
        Graph::new(Expression::parse(text).unwrap(), domain, &Budget::unlimited()).unwrap()
    }

    #[test]
    fn x_is_the_parameter() {
        let parabola = graph("x^2/4", [-2.0, 4.0]);
        assert!(parabola.is_graph() && parabola.breaks().is_empty());
        assert_eq!(parabola.domain(), [-2.0, 4.0]);
        assert_eq!(parabola.point(3.0), Point2::new(3.0, 2.25));
        assert_eq!(parabola.derivative(3.0), Vector2::new(1.0, 1.5));
        let Enclosure { point, first, second } = parabola.enclose(1.0, 2.0);
        assert_eq!(
            (point[0], first[0], second[0]),
            (Interval::between(1.0, 2.0), Interval::ONE, Interval::ZERO)
        );
        assert!(point[1].contains(0.25) && point[1].contains(1.0) && point[1].width() < 0.751);
        assert!(first[1].contains(0.5) && first[1].contains(1.0) && first[1].width() < 0.501);
        assert!(second[1].contains(0.5) && second[1].width() < 1e-12);
        assert!((parabola.bounds().lo()).abs() < 1e-3 && (parabola.bounds().hi() - 4.0).abs() < 1e-3);
    }

    #[test]
    fn points_are_enclosed_to_rounding() {
        let wave = graph("3*sin(x/5)*exp(-x/30)", [0.0, 100.0]);
        for k in 0..=100 {
            let x = f64::from(k);
            let Enclosure { point, first, .. } = wave.enclose(x, x);
            assert!(point[1].contains(wave.point(x).y) && point[1].width() < 1e-14);
            assert!(first[1].contains(wave.derivative(x).y) && first[1].width() < 1e-14);
        }
    }

    #[test]
    fn a_graph_may_end_at_the_limit_of_an_operation() {
        let circle = graph("sqrt(1 - x^2)", [-1.0, 1.0]);
        assert_eq!(circle.point(1.0).y, 0.0);
        assert!(circle.derivative(-1.0).y > 1e3 && circle.derivative(1.0).y < -1e3);
        let rounded = graph("sqrt(0.3 - 0.1 - x)", [0.0, 0.2]);
        assert!(rounded.point(0.2).y.abs() < 1e-100);
        assert!(rounded.derivative(0.2).y < -1e3);
        assert!((graph("sqrt(x^2)", [-1.0, 1.0]).derivative(0.0).y - 1.0).abs() < 1e-12);
    }

    #[test]
    fn an_expression_that_is_not_defined_makes_no_graph() {
        let reciprocal = Expression::parse("1/x").unwrap();
        assert!(Graph::new(reciprocal, [-1.0, 1.0], &Budget::unlimited()).is_err());
    }
}

//! The data of a curve, and the curve made from them.

use nalgebra::{Point2, Vector2};

use crate::budget::Budget;
use crate::geometry::plane_curve::interpolant::{self, InterpolantError};
use crate::geometry::plane_curve::nurbs::{Nurbs, NurbsError};
use crate::geometry::plane_curve::piecewise::Piecewise;
use crate::geometry::plane_curve::{Enclosure, PlaneCurve};
use crate::language::expression::{Expression, ExpressionError, Undefined};
use crate::language::graph::Graph;
use crate::language::section_curve::{SectionCurve, SectionCurveError};

/// The largest coordinate, mm: a kilometre. A larger one is taken for a mistake.
const LARGEST_MM: f64 = 1e6;

/// The data of a curve.
#[derive(Debug, Clone, PartialEq)]
pub enum Source {
    /// y(x) over a domain, mm.
    Graph {
        expression: String,
        domain: [f64; 2],
    },
    /// The C2 cubic through points.
    Points(Vec<Point2<f64>>),
    Nurbs(Nurbs),
    /// Text in the language of section curves.
    SectionCurve(String),
}

/// Why the data make no curve.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SourceError {
    #[error(transparent)]
    Expression(#[from] ExpressionError),
    #[error(transparent)]
    Undefined(#[from] Undefined),
    #[error("y runs from {least_mm:e} to {most_mm:e} mm; at most {LARGEST_MM} mm are supported")]
    TooLarge { least_mm: f64, most_mm: f64 },
    #[error(transparent)]
    Interpolant(#[from] InterpolantError),
    #[error(transparent)]
    Nurbs(#[from] NurbsError),
    #[error(transparent)]
    SectionCurve(#[from] SectionCurveError),
    #[error("the curve is in space; give every point two coordinates for a plane curve")]
    InSpace,
}

impl Source {
    /// Makes the curve.
    ///
    /// # Errors
    /// When the data make no curve, or the budget ends.
    pub fn curve(&self, budget: &Budget) -> Result<AnyCurve, SourceError> {
        Ok(match self {
            Self::Graph { expression, domain } => {
                let graph = Graph::new(Expression::parse(expression)?, *domain, budget)?;
                let bounds = graph.bounds();
                if bounds.mag() > LARGEST_MM {
                    return Err(SourceError::TooLarge { least_mm: bounds.lo(), most_mm: bounds.hi() });
                }
                AnyCurve::Graph(graph)
            }
            Self::Points(points) => AnyCurve::Piecewise(interpolant::through(points)?),
            Self::Nurbs(nurbs) => AnyCurve::Piecewise(nurbs.curve()?),
            Self::SectionCurve(text) => match SectionCurve::parse(text)? {
                SectionCurve::Plane(chain) => AnyCurve::Piecewise(chain.curve()?),
                SectionCurve::Space(_) => return Err(SourceError::InSpace),
            },
        })
    }
}

/// A curve of any kind.
#[derive(Debug, Clone)]
pub enum AnyCurve {
    Graph(Graph),
    Piecewise(Piecewise),
}

/// For drawing. Long computations use the curve of its own kind instead.
impl PlaneCurve for AnyCurve {
    fn domain(&self) -> [f64; 2] {
        match self {
            Self::Graph(graph) => graph.domain(),
            Self::Piecewise(curve) => curve.domain(),
        }
    }

    fn breaks(&self) -> &[f64] {
        match self {
            Self::Graph(graph) => graph.breaks(),
            Self::Piecewise(curve) => curve.breaks(),
        }
    }

    fn is_graph(&self) -> bool {
        matches!(self, Self::Graph(_))
    }

    fn point(&self, t: f64) -> Point2<f64> {
        match self {
            Self::Graph(graph) => graph.point(t),
            Self::Piecewise(curve) => curve.point(t),
        }
    }

    fn derivative(&self, t: f64) -> Vector2<f64> {
        match self {
            Self::Graph(graph) => graph.derivative(t),
            Self::Piecewise(curve) => curve.derivative(t),
        }
    }

    fn enclose(&self, from: f64, to: f64) -> Enclosure {
        match self {
            Self::Graph(graph) => graph.enclose(from, to),
            Self::Piecewise(curve) => curve.enclose(from, to),
        }
    }
}

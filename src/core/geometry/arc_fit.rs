//! Fits a chain of lines and arcs, the elements, to a sequence of points. Each element replaces the points
//! from the place where it starts to the place where it ends.
//!
//! # Method
//! The caller chooses one of three methods:
//! * [`Method::Greedy`] is Ju's method. It makes one element after the other. Each element takes in one point
//!   after another, as long as some line or arc can replace all of them.
//! * [`Method::Optimal`] searches for the chain with the fewest elements.
//! * [`Method::Biarc`] puts two arcs between each two neighbouring points. The chain passes through every
//!   point and has no kinks. This method ignores the tolerance.
//!
//! With [`Continuity::Tangent`], a second search follows one of the first two methods. It looks for a chain
//! that has kinks only at real corners of the points (`tangent`). If it finds none, the first chain is the
//! result.
//!
//! # Guarantees
//! The guarantees hold for the first two methods.
//! * For each point, the element that replaces it has a place within the tolerance of the point. These places
//!   follow each other along the element in the order of the points.
//! * With [`Measure::Polyline`], the lines between the points are within the tolerance of the elements, and
//!   the elements are within the tolerance of these lines.
//! * Elements meet on points. With [`Joints::Free`] they may also meet beside a point, within the tolerance
//!   of it. They do so only if the chain then has fewer elements or fewer kinks.
//! * With [`Method::Optimal`] and [`Continuity::Position`], no chain whose elements meet on points has fewer
//!   elements than the result, if its arcs are no larger than the largest radius
//!   ([`Fit::largest_radius_mm`]). [`Fitted::not_proved`] names where that is not proved. One gap has no
//!   name: the search may miss an arc that would fit, because it tries only some of the arcs between two
//!   points.
//! * With [`Joints::Free`], places beside the points are tried, and the fewest elements over all places are
//!   not proved. Up to 100 points, there are no more elements than with
//!   [`Continuity::Tangent`].
//! * Two points make a line. If the last point equals the first ([`Fit::is_closed`]), one full circle is
//!   tried first. An arc that is not a full circle turns by at most 350 degrees.
//!
//! # Cost
//! O(n m) checks of one point against one element, for n points and elements that replace m points each. A
//! check takes some 10 ns.
//!
//! # Reference
//! S. Y. Ju, "CL-Cartesian Machining along Approximated Circular Arcs", sections 4 and 5, eq. 4.

mod best;
mod biarc;
mod bounds;
mod candidate;
mod chord;
mod chord_frame;
mod corners;
mod free_joints;
mod full_circle;
mod greedy;
mod joints;
mod mean_places;
mod optimal;
mod space;
mod stabbing_bound;
mod tangent;
mod turns;
mod windows;

use nalgebra::{Point2, Vector2};

use crate::budget::{Budget, Stopped};
use crate::geometry::segment::Segment;
use optimal::Node;

pub use candidate::Points;
use candidate::{PointRange, Rule};
pub use space::{FitError, FittedCurve, FittedCurves, fit_in_space};

/// The least height of an arc above its chord, mm. A flatter arc becomes a line if the line keeps the
/// tolerance. Some controls run a full circle if rounding removes the height. Smooth chains do not keep this
/// limit, because a line would make a kink. Biarcs do not keep it either.
pub const FLATTEST_MM: f64 = 1e-3;

/// The largest radius of an arc, mm: a kilometre, which is also the largest coordinate. Distances from the
/// centre are rounded by 1e-10 mm at this radius; at a much larger radius, rounding would show in the
/// deviations. Smooth chains and biarcs do not keep this limit.
pub const LARGEST_RADIUS_MM: f64 = 1e6;

/// Points fitted at once. Longer inputs are fitted window by window: the elements that end in the first three
/// quarters of a window are kept, and the next window begins where they end.
pub const WINDOW: usize = 10_000;

/// Search budget: evaluations for each point, unless the request sets another. A second takes some hundred
/// million evaluations. `EFFORT_IN_SPACE` replaces it for points in space, where the closed form excludes
/// little. `MOST_LOOKS_IN_ALL` bounds the evaluations of all windows together.
pub const EFFORT: usize = 40_000;
const EFFORT_IN_SPACE: usize = 500;
const MOST_LOOKS_IN_ALL: usize = 1_000_000_000;

/// Evaluations for each point that may be spent on exact bounds. With a small search budget, the bounds take
/// one part in `PART_FOR_BOUNDS` of it.
const LOOKS_FOR_BOUNDS: usize = 2000;
const PART_FOR_BOUNDS: usize = 3;

/// One element. Its end stands for the point with index `end`, and it starts where the element before it
/// ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Element {
    pub end: usize,
    pub shape: Shape,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Shape {
    Segment(Segment),
    /// One full turn, from a place back to it.
    FullCircle {
        at: Point2<f64>,
        center: Point2<f64>,
        is_ccw: bool,
    },
}

impl Element {
    /// The place where the element ends.
    pub fn to(&self) -> Point2<f64> {
        match self.shape {
            Shape::Segment(segment) => segment.end(),
            Shape::FullCircle { at, .. } => at,
        }
    }

    /// The radius of an arc, mm; 0 for a line.
    fn radius(&self) -> f64 {
        match self.shape {
            Shape::Segment(Segment::Arc(arc)) => arc.radius(),
            Shape::Segment(Segment::Line { .. }) => 0.0,
            Shape::FullCircle { at, center, .. } => (at - center).norm(),
        }
    }

    fn line(end: usize, start: Vector2<f64>, to: Vector2<f64>) -> Self {
        let [start, at] = [start, to].map(Point2::from);
        Self { end, shape: Shape::Segment(Segment::Line { start, end: at }) }
    }

    fn bulging(end: usize, [start, to]: [Vector2<f64>; 2], bulge: f64) -> Self {
        Self { end, shape: Shape::Segment(Segment::bulging(start.into(), to.into(), bulge)) }
    }
}

/// The kinds of elements that a fit may use.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shapes {
    LinesOnly,
    ArcsAndLines,
}

/// How elements are found.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "wire", derive(serde::Deserialize, utoipa::ToSchema), serde(rename_all = "snake_case"))]
#[cfg_attr(feature = "wire", schema(as = ArcFitMethod))]
pub enum Method {
    /// The fewest elements.
    #[default]
    Optimal,
    /// Each element is as long as possible.
    Greedy,
    /// Two arcs through each pair of neighbouring points.
    Biarc,
}

/// How neighbouring elements meet.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "wire", derive(serde::Deserialize, utoipa::ToSchema), serde(rename_all = "snake_case"))]
#[cfg_attr(feature = "wire", schema(as = ArcFitContinuity))]
pub enum Continuity {
    #[default]
    Position,
    Tangent,
}

/// Where elements meet.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "wire", derive(serde::Deserialize, utoipa::ToSchema), serde(rename_all = "snake_case"))]
#[cfg_attr(feature = "wire", schema(as = ArcFitJoints))]
pub enum Joints {
    /// Also beside the points, within the tolerance, if that saves elements.
    #[default]
    Free,
    OnPoints,
}

/// What the tolerance holds for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "wire", derive(serde::Deserialize, utoipa::ToSchema), serde(rename_all = "snake_case"))]
#[cfg_attr(feature = "wire", schema(as = ArcFitMeasure))]
pub enum Measure {
    /// Samples of a smooth curve: the points are within the tolerance of the elements.
    #[default]
    Points,
    /// The corners of a polyline: its lines are within the tolerance of the elements, and the elements within
    /// the tolerance of its lines.
    Polyline,
}

/// How points are fitted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fit {
    pub tolerance_mm: f64,
    pub shapes: Shapes,
    pub method: Method,
    pub continuity: Continuity,
    pub joints: Joints,
    pub measure: Measure,
    /// The last point equals the first, so that one full circle may replace all points.
    pub is_closed: bool,
    /// The largest radius of an arc, mm; at most [`LARGEST_RADIUS_MM`] counts. A control may run smaller arcs
    /// only. Smooth chains and biarcs do not keep this limit.
    pub largest_radius_mm: f64,
    /// Evaluations for each point after which a search ends with the best chain found. With zero there is no
    /// search, and the greedy chain stays.
    pub effort: usize,
}

impl Fit {
    /// A fit within a tolerance, with defaults for all other fields.
    pub fn within(tolerance_mm: f64) -> Self {
        Self {
            tolerance_mm,
            shapes: Shapes::ArcsAndLines,
            method: Method::default(),
            continuity: Continuity::default(),
            joints: Joints::default(),
            measure: Measure::default(),
            is_closed: false,
            largest_radius_mm: LARGEST_RADIUS_MM,
            effort: EFFORT,
        }
    }

    fn rule(&self) -> Rule {
        Rule {
            tolerance_mm: self.tolerance_mm,
            shapes: self.shapes,
            measure: self.measure,
            largest_radius_mm: self.largest_radius_mm.min(LARGEST_RADIUS_MM),
        }
    }
}

/// Elements from `start` to the last point.
#[derive(Debug, Clone, PartialEq)]
pub struct Fitted {
    pub start: Vector2<f64>,
    pub elements: Vec<Element>,
    /// `None` where it is proved, and where the method proves nothing: [`Method::Greedy`],
    /// [`Method::Biarc`], [`Continuity::Tangent`].
    pub not_proved: Option<NotProved>,
}

/// Why it is not proved that no chain whose elements meet on points has fewer elements.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, utoipa::ToSchema), serde(rename_all = "snake_case"))]
#[cfg_attr(feature = "wire", schema(as = FewestNotProved))]
pub enum NotProved {
    /// The points were fitted in several windows.
    Windows,
    /// A search was given up.
    SearchEnded,
    /// Not all points have the same x, the same y or the same z.
    InSpace,
}

/// Fits elements to at least two points. Each point must differ from the one before it, in the plane or in
/// height.
///
/// # Errors
/// When the budget runs out.
///
/// # Example
/// Points of half a circle become one arc.
///
/// ```
/// use std::f64::consts::PI;
/// use nalgebra::Vector2;
/// use toolpathd_core::budget::Budget;
/// use toolpathd_core::geometry::arc_fit::{Fit, Points, fit};
///
/// let at = |k: u8| f64::from(k) * PI / 100.0;
/// let circle: Vec<_> = (0..=100).map(at).map(|t| Vector2::new(t.cos(), t.sin()) * 10.0).collect();
/// let points = Points { flat: &circle, heights: &[] };
/// let fitted = fit(points, &Fit::within(0.001), &Budget::unlimited()).unwrap();
/// assert_eq!(fitted.elements.len(), 1);
/// assert!((fitted.elements[0].to().coords - circle[100]).norm() <= 0.001);
/// ```
pub fn fit(points: Points, request: &Fit, budget: &Budget) -> Result<Fitted, Stopped> {
    let rule = request.rule();
    let flat = points.flat;
    if request.is_closed
        && request.method != Method::Biarc
        && request.shapes == Shapes::ArcsAndLines
        && points.heights.is_empty()
        && let Some(fitted) = full_turn(flat, &rule)
    {
        return Ok(fitted);
    }
    if request.method == Method::Biarc {
        let elements = biarc::elements(flat, request.is_closed);
        return Ok(Fitted { start: flat[0], elements, not_proved: None });
    }
    let (nodes, not_proved) = windows::nodes(points, request, budget)?;
    let chain = || Fitted { not_proved, ..shaped(points, &nodes, &rule) };
    if request.shapes == Shapes::LinesOnly {
        return Ok(chain());
    }
    if request.continuity == Continuity::Tangent {
        return tangent::chain(points, &nodes, request, budget);
    }
    let count = nodes.len() - 1;
    let is_compared = request.method == Method::Optimal
        && request.effort > 0
        && request.joints == Joints::Free
        && (2..flat.len()).contains(&count)
        && flat.len() <= free_joints::FEW_POINTS;
    if is_compared {
        let smooth = tangent::chain(points, &nodes, request, budget)?;
        let is_allowed = |element: &Element| element.radius() <= rule.largest_radius_mm;
        if smooth.elements.len() < count && smooth.elements.iter().all(is_allowed) {
            return Ok(Fitted { not_proved, ..smooth });
        }
    }
    Ok(chain())
}

/// The best element between each pair of nodes.
fn shaped(points: Points, nodes: &[Node], rule: &Rule) -> Fitted {
    let mut elements = Vec::with_capacity(nodes.len());
    for pair in nodes.windows(2) {
        let [from, to] = [pair[0], pair[1]];
        let span = PointRange { points, first: from.index, last: to.index, from: from.at, to: to.at };
        match best::best_bulge(&span, rule) {
            Some(bulge) => elements.push(Element::bulging(to.index, [from.at, to.at], bulge)),
            // The search found an element over this span. Should rounding prevent that now, lines from point
            // to point still keep the tolerance.
            None => {
                let mut at = from.at;
                let inner = (from.index + 1..to.index).map(|k| Node { index: k, at: points.flat[k] });
                elements.extend(
                    inner
                        .chain([to])
                        .map(|node| Element::line(node.index, std::mem::replace(&mut at, node.at), node.at)),
                );
            }
        }
    }
    Fitted { start: nodes[0].at, elements, not_proved: None }
}

/// Evaluations after which the search over `points` is given up. All windows together have `n_points` points.
fn looks(points: Points, n_points: usize, request: &Fit) -> usize {
    let usual = if points.heights.is_empty() { EFFORT } else { EFFORT_IN_SPACE };
    points.flat.len() * request.effort.min(usual).min(MOST_LOOKS_IN_ALL / n_points)
}

/// The evaluations that bounds may take, of the `most` evaluations of a search over `n` points.
fn for_bounds(most: usize, n: usize) -> usize {
    (most / PART_FOR_BOUNDS).min(LOOKS_FOR_BOUNDS * n)
}

fn full_turn(flat: &[Vector2<f64>], rule: &Rule) -> Option<Fitted> {
    let turn = full_circle::full_turn(flat, rule).filter(|turn| turn.radius <= rule.largest_radius_mm)?;
    let start = full_circle::Circle { center: turn.center, radius: turn.radius }.nearest_place(flat[0]);
    let shape = Shape::FullCircle { at: start.into(), center: turn.center.into(), is_ccw: turn.is_ccw };
    let elements = vec![Element { end: flat.len() - 1, shape }];
    Some(Fitted { start, elements, not_proved: None })
}

#[cfg(test)]
mod tests;

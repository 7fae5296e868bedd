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
//!   ([`Fit::largest_radius_mm`]). There are three exceptions: the input has more than [`WINDOW`] points, the
//!   search was given up ([`Fit::effort`]), or the search missed an arc that would fit, because it tries only
//!   some of the arcs between two points.
//! * Two points make a line. If the last point equals the first ([`Fit::is_closed`]), one full circle is
//!   tried first. An arc that is not a full circle turns by at most 350 degrees.
//!
//! # Cost
//! O(n m) checks of one point against one element, for n points and elements that replace m points each. A
//! check takes some 10 ns.
//!
//! # Reference
//! S. Y. Ju, "CL-Cartesian Machining along Approximated Circular Arcs", sections 4 and 5, eq. 4.

mod biarc;
mod bounds;
mod candidate;
mod chord;
mod chord_frame;
mod corners;
mod full_circle;
mod greedy;
mod joints;
mod optimal;
mod space;
mod stabbing_bound;
mod tangent;
mod turns;

use nalgebra::{Point2, Vector2};

use crate::budget::{Budget, Stopped};
use crate::geometry::segment::Segment;
use bounds::Bounds;
use optimal::{Node, Outcome};

pub use candidate::Points;
use candidate::{PointRange, Rule, Witnesses};
pub use space::{FitError, FittedCurve, fit_in_space};

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

/// Elements may meet beside the points only if there are at least this many points for each element. With
/// fewer points an element follows the errors of its points wherever elements meet.
const POINTS_FOR_FREE_JOINTS: usize = 8;

/// Nodes on each side of a point, when elements may meet beside the points.
const NODES_BESIDE: i32 = 6;

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

/// Nodes kept for a second search, after a search over all nodes exceeded its budget.
const THINNED: usize = 1_500;

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
        return Ok(Fitted { start: flat[0], elements: biarc::elements(flat, request.is_closed) });
    }
    let nodes = windowed(points, request, budget)?;
    if request.continuity == Continuity::Tangent && request.shapes == Shapes::ArcsAndLines {
        return tangent::chain(points, &nodes, request, budget);
    }
    Ok(shaped(points, &nodes, &rule))
}

/// The nodes at which elements meet, found window by window.
fn windowed(points: Points, request: &Fit, budget: &Budget) -> Result<Vec<Node>, Stopped> {
    let flat = points.flat;
    let mut nodes: Vec<Node> = Vec::new();
    while nodes.last().is_none_or(|node| node.index + 1 < flat.len()) {
        let begin = nodes.last().map_or(0, |node| node.index);
        let end = flat.len().min(begin + WINDOW);
        let window = Points {
            flat: &flat[begin..end],
            heights: if points.heights.is_empty() { &[] } else { &points.heights[begin..end] },
        };
        let mut found = joined(window, nodes.last().map(|node| node.at), flat.len(), request, budget)?;
        if end < flat.len() {
            let standing = found.iter().rposition(|node| node.index <= WINDOW / 4 * 3).unwrap_or(0).max(1);
            found.truncate(standing + 1);
        }
        let fresh = usize::from(!nodes.is_empty());
        let mut found = found[fresh..].iter().map(|node| Node { index: begin + node.index, ..*node });
        // The last element kept from the window before ended at the border; it may reach on to the first node
        // of this window.
        if let [.., before, _] = nodes[..]
            && let Some(next) = found.next()
        {
            let span =
                PointRange { points, first: before.index, last: next.index, from: before.at, to: next.at };
            if span.find(&request.rule(), &mut Witnesses::default()).is_some() {
                nodes.pop();
            }
            nodes.push(next);
        }
        nodes.extend(found);
    }
    Ok(nodes)
}

/// The best element between each pair of nodes.
fn shaped(points: Points, nodes: &[Node], rule: &Rule) -> Fitted {
    let mut elements = Vec::with_capacity(nodes.len());
    for pair in nodes.windows(2) {
        let [from, to] = [pair[0], pair[1]];
        let span = PointRange { points, first: from.index, last: to.index, from: from.at, to: to.at };
        match span.best(rule) {
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
    Fitted { start: nodes[0].at, elements }
}

/// The nodes at which the elements of one window meet, from its first point or from `start` near it. All
/// windows together have `n_points` points.
fn joined(
    points: Points,
    start: Option<Vector2<f64>>,
    n_points: usize,
    request: &Fit,
    budget: &Budget,
) -> Result<Vec<Node>, Stopped> {
    let (flat, rule) = (points.flat, request.rule());
    let on =
        |index: usize| Node { index, at: if index == 0 { start.unwrap_or(flat[0]) } else { flat[index] } };
    let one_by_one = if request.method == Method::Greedy { greedy::ONE_BY_ONE } else { greedy::FAST };
    let grown = greedy::joints(points, on(0).at, &rule, one_by_one, budget)?;
    let greedy: Vec<Node> = grown.into_iter().map(on).collect();
    if request.method == Method::Greedy || request.effort == 0 || greedy.len() == 2 {
        return Ok(greedy);
    }
    let is_on_points = on(0).at == flat[0];
    let most = looks(points, n_points, request);
    let bounds = if is_on_points {
        Bounds::on_points(points, &rule, for_bounds(most, flat.len()), budget)?
    } else {
        Bounds::unknown(flat.len())
    };
    let (known, n) = (greedy.len() - 1, flat.len());
    if bounds.left[0] == known {
        return Ok(greedy);
    }
    let mut all: Vec<Node> = (0..n).map(on).collect();
    let mut outcome = optimal::fewest(points, &all, &bounds, &rule, known, most, budget)?;
    if outcome == Outcome::GivenUp {
        all.retain(|node| node.index.is_multiple_of(1 + n / THINNED) || node.index + 1 == n);
        outcome = optimal::fewest(points, &all, &bounds, &rule, known, most, budget)?;
    }
    let Outcome::Fewer(best) = outcome else { return Ok(greedy) };
    // The search beat the greedy chain: the points have errors of their own.
    let count = best.len() - 1;
    let is_free = request.joints == Joints::Free && points.heights.is_empty();
    if is_free && n >= POINTS_FOR_FREE_JOINTS * count {
        let pinned = start.map_or(request.is_closed.then_some(flat[0]), Some);
        let nodes = joints::nodes(flat, pinned, request, (count, NODES_BESIDE));
        let unknown = Bounds::unknown(n);
        if let Outcome::Fewer(fewer) = optimal::fewest(points, &nodes, &unknown, &rule, count, most, budget)?
        {
            return Ok(fewer);
        }
    }
    Ok(best)
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
    let start = turn.center + (flat[0] - turn.center).normalize() * turn.radius;
    let shape = Shape::FullCircle { at: start.into(), center: turn.center.into(), is_ccw: turn.is_ccw };
    Some(Fitted { start, elements: vec![Element { end: flat.len() - 1, shape }] })
}

#[cfg(test)]
mod tests;

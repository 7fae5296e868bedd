//! Arcs and lines through a sequence of points in a plane.
//!
//! # Method
//! 1. Whether an element can stand for a stretch of points is decided in closed form: the arcs over a chord
//!    are a family with one parameter, and "within the tolerance of this point" is an interval of it
//!    (`chord`, `span`).
//! 2. `greedy`: Ju's method, each element grows as far as it can. `biarc`: two arcs a span through every
//!    point. `optimal`: the least number of elements between the points, by breadth first search with bounds
//!    (`bounds`) that leave out what cannot be better.
//! 3. Where the points have errors of their own, so that growing is not best, elements may also meet beside
//!    the points (`joints`) if that saves some.
//! 4. `tangent`: a chain in which each element begins in the direction in which the one before ended.
//! 5. `space`: points in space are divided where the plane of their arcs changes.
//!
//! # Guarantees
//! Of all but biarcs, which know no tolerance:
//! * Every point is within the tolerance of its element, and the elements pass the points in order: a
//!   reversal is not swallowed. The last point is reached. Arcs go round their centres as the lines between
//!   the points do.
//! * By [`Measure::Polyline`] the lines between the points are as near, both ways. By [`Measure::Points`]
//!   nothing is promised between the points: the caller knows how far the true curve leaves its chords.
//! * In a plane, with joints on points, no chain of elements within the tolerance is shorter than that of
//!   [`Method::Optimal`], within windows of [`WINDOW`] points; but of the bulges that keep the tolerance,
//!   order and lines are tried at nineteen places, which can miss one. In space it is no longer than the
//!   greedy one.
//!
//! # Degenerate input
//! Two points make a line. An arc sweeps 350 degrees at most, and its ends differ; one full turn stands only
//! for a closed way whose points are no farther apart than 30 degrees. An arc flatter than [`FLATTEST_MM`] is
//! a line where a line fits; no arc has a radius above [`LARGEST_RADIUS_MM`], but in smooth chains, where a
//! line would be a kink.
//!
//! # Cost
//! O(n m) for n points, m an element, at some 10 ns; what would take much longer, on points in space and on
//! noise of the order of the tolerance, ends with the best that is known. See `benches/arc_fitting.rs`.
//!
//! # Differences from the paper
//! As printed the algorithm drops a tail of two points; here it becomes a line. Eq. 4 measures to the whole
//! circle, this to the arc. The arc with the least largest error, which the paper asks for, leaves the
//! farthest points to its left and right equally far.
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

use nalgebra::Vector2;

use crate::budget::{Budget, Stopped};
use bounds::Bounds;
use optimal::{Node, Outcome};

pub use candidate::Points;
use candidate::{Rule, Span, Witnesses};
pub use space::{FitError, FittedCurve, fit_in_space};

/// Controls have run whole circles where an arc's height was lost in rounding.
pub const FLATTEST_MM: f64 = 1e-3;

/// Controls refuse, or run badly, arcs of larger radius.
pub const LARGEST_RADIUS_MM: f64 = 1e4;

/// More points than this are fitted window by window: what ends in the first three quarters stands, and the
/// next window begins there.
pub const WINDOW: usize = 10_000;

/// Elements with fewer points each follow the points' errors wherever they meet.
const POINTS_FOR_FREE_JOINTS: usize = 8;

/// Nodes on each side of a point where elements may meet beside it.
const NODES_BESIDE: i32 = 6;

/// Looks at points, for each of them, that a search may take, unless it is told otherwise; in space, where
/// the closed form tells little; and for all windows together. A second is some hundred million.
pub const EFFORT: usize = 40_000;
const EFFORT_IN_SPACE: usize = 500;
const MOST_LOOKS_IN_ALL: usize = 1_000_000_000;

/// Looks at each point that are worth knowing exactly how far elements reach; of a little effort a third.
const LOOKS_FOR_BOUNDS: usize = 2000;
const PART_FOR_BOUNDS: usize = 3;

/// Nodes that are left where all of them are too many.
const THINNED: usize = 1_500;

/// An element that ends for the point with index `end`, at `to`, and starts where the one before ended.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Element {
    pub end: usize,
    pub to: Vector2<f64>,
    pub shape: Shape,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Shape {
    Line,
    /// tan(sweep / 4), positive where the arc lies to the left of its chord (it then turns clockwise).
    Arc {
        bulge: f64,
    },
    /// Once round, to where it started.
    FullCircle {
        center: Vector2<f64>,
        is_ccw: bool,
    },
}

/// What elements may be.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shapes {
    LinesOnly,
    ArcsAndLines,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Method {
    Greedy,
    Biarc,
    #[default]
    Optimal,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Continuity {
    #[default]
    Position,
    Tangent,
}

/// Where elements may meet.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Joints {
    OnPoints,
    /// Also beside them, within the tolerance, where that saves elements.
    #[default]
    Free,
}

/// What the points stand for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Measure {
    /// Samples of a smooth curve: the points are near the elements.
    #[default]
    Points,
    /// The lines between them: these are near the elements, and the elements near them.
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
    /// The last point is the first again: it may be one full turn.
    pub is_closed: bool,
    /// Looks at points, for each of them, after which a search ends with the best that is known: what has
    /// grown, if it is zero.
    pub effort: usize,
}

impl Fit {
    /// The fit with the default of everything else.
    pub fn within(tolerance_mm: f64) -> Self {
        Self {
            tolerance_mm,
            shapes: Shapes::ArcsAndLines,
            method: Method::default(),
            continuity: Continuity::default(),
            joints: Joints::default(),
            measure: Measure::default(),
            is_closed: false,
            effort: EFFORT,
        }
    }

    fn rule(&self) -> Rule {
        Rule { tolerance_mm: self.tolerance_mm, shapes: self.shapes, measure: self.measure }
    }
}

/// Elements from `start` to the last point.
#[derive(Debug, Clone, PartialEq)]
pub struct Fitted {
    pub start: Vector2<f64>,
    pub elements: Vec<Element>,
}

/// Fits elements to at least two points, each different from the one before, at least in height.
///
/// # Errors
/// When the budget runs out.
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

/// Where elements meet, window by window.
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
        // What ended with the window may go on.
        if let [.., before, _] = nodes[..]
            && let Some(next) = found.next()
        {
            let span = Span { points, first: before.index, last: next.index, from: before.at, to: next.at };
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
        let span = Span { points, first: from.index, last: to.index, from: from.at, to: to.at };
        match span.best(rule) {
            Some(0.0) => elements.push(Element { end: to.index, to: to.at, shape: Shape::Line }),
            Some(bulge) => elements.push(Element { end: to.index, to: to.at, shape: Shape::Arc { bulge } }),
            // What was found once is found again; should it not be, the points themselves are safe.
            None => {
                let inner = (from.index + 1..to.index).map(|k| Node { index: k, at: points.flat[k] });
                elements.extend(inner.chain([to]).map(|node| Element {
                    end: node.index,
                    to: node.at,
                    shape: Shape::Line,
                }));
            }
        }
    }
    Fitted { start: nodes[0].at, elements }
}

/// Where the elements meet, from the first point, or from `start` near it; the window is one of `n_points`.
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
    // Growing was not the best: the points have errors of their own.
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

/// Looks at points after which the search over some of `n_points` is given up.
fn looks(points: Points, n_points: usize, request: &Fit) -> usize {
    let usual = if points.heights.is_empty() { EFFORT } else { EFFORT_IN_SPACE };
    points.flat.len() * request.effort.min(usual).min(MOST_LOOKS_IN_ALL / n_points)
}

/// The part of the looks of a search over `n` points that its bounds may take.
fn for_bounds(most: usize, n: usize) -> usize {
    (most / PART_FOR_BOUNDS).min(LOOKS_FOR_BOUNDS * n)
}

fn full_turn(flat: &[Vector2<f64>], rule: &Rule) -> Option<Fitted> {
    let turn = full_circle::full_turn(flat, rule)?;
    let start = turn.center + (flat[0] - turn.center).normalize() * turn.radius;
    let shape = Shape::FullCircle { center: turn.center, is_ccw: turn.is_ccw };
    Some(Fitted { start, elements: vec![Element { end: flat.len() - 1, to: start, shape }] })
}

/// The centre of the arc from `from` to `to` with this bulge.
pub fn center(from: Vector2<f64>, to: Vector2<f64>, bulge: f64) -> Vector2<f64> {
    let half = (to - from) * 0.5;
    let left = Vector2::new(-half.y, half.x);
    from + half + left * ((bulge * bulge - 1.0) / (2.0 * bulge))
}

#[cfg(test)]
mod tests;

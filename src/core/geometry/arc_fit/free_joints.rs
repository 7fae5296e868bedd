//! Looks for a chain with fewer elements than a known chain whose joints lie on points, now with joints also
//! beside the points, within the tolerance of them. The points lie in a plane.
//!
//! # Method
//! 1. One arc that runs nearest to all points, with its ends beside the first and the last point.
//! 2. If the lines between the points count: a search with joints where arcs of the mean radius pass the
//!    corners of a polygon ([`mean_places`]).
//! 3. A search with joints left and right of the points ([`joints`]). It is made where the points have errors
//!    of their own and each element has many points, and for few points in any case.
//!
//! The last step that finds a chain of fewer elements is the result.

use nalgebra::Vector2;

use super::bounds::Bounds;
use super::candidate::{PointRange, Points, Rule, Witnesses};
use super::optimal::{Node, Outcome, fewest};
use super::{Fit, Measure, Shapes, full_circle, joints, mean_places};
use crate::budget::{Budget, Stopped};

/// For at most this many points, joints beside them are always searched.
pub const FEW_POINTS: usize = 100;

/// With more points than that, joints beside the points are searched only if the points have errors and if
/// there are at least this many points for each element. With fewer points an element follows the errors of
/// its points wherever elements meet.
const POINTS_AN_ELEMENT: usize = 8;

/// Evaluations after which a search with joints of mean arcs gives up, half a second.
const MOST_AT_MEAN: usize = 50_000_000;

/// Nodes on each side of a point.
const BESIDE: i32 = 6;

/// The input of [`fewest_free`]: the points of one window, and the chain with the fewest elements that was
/// found so far.
pub struct Known<'a> {
    pub points: Points<'a>,
    /// A chain whose joints lie on points.
    pub chain: Vec<Node>,
    /// The place near the first point where the chain has to start; `None` at the start of all points.
    pub start: Option<Vector2<f64>>,
    /// Whether all points of the input are in the window.
    pub is_whole: bool,
    /// Whether the points seem to have errors: greedy growth did not find the fewest elements.
    pub is_noisy: bool,
}

/// The nodes of the chain with the fewest elements that was found: the known chain, or a shorter one. Each
/// search gives up after `most` evaluations.
pub fn fewest_free(
    known: Known,
    request: &Fit,
    rule: &Rule,
    most: usize,
    budget: &Budget,
) -> Result<Vec<Node>, Stopped> {
    let Known { points, mut chain, start, is_whole, is_noisy } = known;
    let (flat, n) = (points.flat, points.flat.len());
    // Only then is the last point of the window the first point, too.
    let is_ring = request.is_closed && is_whole;
    let has_arcs = rule.shapes == Shapes::ArcsAndLines;
    if has_arcs
        && is_whole
        && !request.is_closed
        && let Some(arc) = one_arc(points, rule)
    {
        return Ok(arc.to_vec());
    }
    let pins = pins(flat, start, request, is_ring);
    let unknown = Bounds::unknown(n);
    let search = |chain: &mut Vec<Node>, nodes: &[Node], most: usize| {
        let found = fewest(points, nodes, &unknown, rule, chain.len() - 1, most, budget)?;
        if let Outcome::Fewer(fewer) = found {
            *chain = fewer;
        }
        Ok(())
    };
    let mean = mean_nodes(flat, rule, is_ring);
    let has_mean = mean.iter().any(|node| node.at != flat[node.index]);
    if has_mean {
        for pin in &pins {
            search(&mut chain, &pinned(&mean, *pin, is_ring), most.min(MOST_AT_MEAN))?;
        }
    }
    let count = chain.len() - 1;
    if count > 1 && (n <= FEW_POINTS && has_arcs || is_noisy && n >= POINTS_AN_ELEMENT * count) {
        let mut nodes = joints::nodes(flat, pins[0], request, (count, BESIDE));
        if has_mean {
            nodes.extend(mean.iter().filter(|node| node.at != flat[node.index]));
            nodes.sort_by_key(|node| node.index);
            nodes = pinned(&nodes, pins[0], is_ring);
        }
        search(&mut chain, &nodes, most)?;
    }
    Ok(chain)
}

/// The ends of one arc for all points; `None` if none was found.
fn one_arc(points: Points, rule: &Rule) -> Option<[Node; 2]> {
    let flat = points.flat;
    let circle = full_circle::nearest(flat, rule)?;
    let on = |index: usize| Node { index, at: circle.nearest_place(flat[index]) };
    let ends = [on(0), on(flat.len() - 1)];
    span(points, ends).find(rule, &mut Witnesses::default()).is_some().then_some(ends)
}

fn span(points: Points<'_>, [from, to]: [Node; 2]) -> PointRange<'_> {
    PointRange { points, first: from.index, last: to.index, from: from.at, to: to.at }
}

/// The places where the chain may start, if these are few: where the window before ended, or for closed
/// points, which have to end there too, on the first point or beside it. `None` stands for any place.
fn pins(
    flat: &[Vector2<f64>],
    start: Option<Vector2<f64>>,
    request: &Fit,
    is_ring: bool,
) -> Vec<Option<Vector2<f64>>> {
    if start.is_some() || !request.is_closed {
        return vec![start];
    }
    let mean = if is_ring && request.measure == Measure::Polyline {
        mean_places::beside(flat, 0, request.tolerance_mm, true)
    } else {
        Vec::new()
    };
    std::iter::once(flat[0]).chain(mean.into_iter().map(|node| node.at)).map(Some).collect()
}

/// The nodes with the pinned place as the only one of the first point, and in a ring of the last point.
fn pinned(nodes: &[Node], pin: Option<Vector2<f64>>, is_ring: bool) -> Vec<Node> {
    let Some(at) = pin else { return nodes.to_vec() };
    let last = nodes.last().map_or(0, |node| node.index);
    let is_pinned = |index: usize| index == 0 || is_ring && index == last;
    let mut kept: Vec<Node> = nodes.iter().filter(|node| !is_pinned(node.index)).copied().collect();
    kept.insert(0, Node { index: 0, at });
    if is_ring {
        kept.push(Node { index: last, at });
    }
    kept
}

/// Nodes on all points, and where arcs of the mean radius pass beside them.
fn mean_nodes(flat: &[Vector2<f64>], rule: &Rule, is_ring: bool) -> Vec<Node> {
    if !rule.counts_lines() {
        return Vec::new();
    }
    let at = |index: usize| {
        let on = Node { index, at: flat[index] };
        std::iter::once(on).chain(mean_places::beside(flat, index, rule.tolerance_mm, is_ring))
    };
    (0..flat.len()).flat_map(at).collect()
}

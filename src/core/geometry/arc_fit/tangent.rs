//! Makes a smooth chain: each element starts in the direction in which the element before it ends. The chain
//! has kinks only at real corners of the points ([`corners`]).
//!
//! # Method
//! A node is a place where two elements may meet.
//! 1. For two nodes A and B, the arcs from A to B that keep the tolerance have bulges in one or two
//!    intervals. So their directions at A lie in one or two intervals, and so do their directions at B.
//! 2. The search goes from node to node. For each node it keeps the intervals of directions in which a smooth
//!    chain can arrive there. An arc can continue such a chain if its direction at the start lies in one of
//!    these intervals. From a corner, an arc may start in any direction.
//! 3. When the search reaches the last node, one arc that ends there is chosen. Its direction at the start is
//!    the direction in which the arc before it has to end. This fixes that arc too, and so on back to the
//!    first node.
//!
//! If the search finds no smooth chain, or is given up after a given number of checks of one point against
//! one element, the result is the chain that the search started from. It may have kinks.
//!
//! # Cost
//! O(c k^2 m) for a chain of c elements, if each element replaces m points and k nodes lie on or beside these
//! points. k has a constant limit.

use std::cell::Cell;
use std::f64::consts::{PI, TAU};

use super::bounds::Bounds;
use super::candidate::{PointRange, Points, Rule, Witnesses};
use super::chord::Chord;
use super::corners::corners;
use super::optimal::Node;
use super::{Element, Fit, Fitted, Joints, WINDOW, for_bounds, joints, looks, shaped};
use crate::budget::{Budget, Stopped};

/// Nodes on points, for each element of the guiding chain, which need not be smooth.
const NODES_AN_ELEMENT: usize = 40;

/// On each side of a joint of the guiding chain all points are nodes, over this many steps between the other
/// nodes.
const ABOUT_JOINTS: usize = 3;

/// Nodes that each step continues from, the farthest first.
const WIDEST: usize = 96;

/// Nodes on each side of a point, for a chain that may pass beside the points: beside exact points, and
/// beside points with errors of their own.
const BESIDE_EXACT: i32 = 2;
const BESIDE_NOISY: i32 = 6;

/// The most intervals of directions kept at a node.
const INTERVALS: usize = 3;

/// The largest bulge of an arc between two neighbouring points, which no point between them limits: a quarter
/// turn. If that gives no chain, three quarters of a turn.
const LARGEST_BETWEEN_NEIGHBOURS: [f64; 2] = [0.414, 2.414];

/// Above this radius an arc becomes a line if that keeps the rule, mm. Over half a metre the two differ in
/// direction by 0.01 degrees.
const FLAT_RADIUS_MM: f64 = 1e6;

/// A chain can arrive at a node in the directions between `low` and `high`, radians.
#[derive(Debug, Clone, Copy)]
struct Arrival {
    node: usize,
    low: f64,
    high: f64,
    /// The arrival that the last element starts from, as an index into the arrivals of one element fewer.
    before: usize,
}

impl Arrival {
    /// The directions in which arcs may start from here, radians, if their bulges are in `part` and their
    /// chord runs in `direction`; `None` if there are none.
    fn departures(&self, direction: f64, part: [f64; 2]) -> Option<[f64; 2]> {
        let [low, high] = part.map(|bulge| direction + 2.0 * bulge.atan());
        // The two intervals may be whole turns apart.
        let whole = ((self.low + self.high - low - high) / (2.0 * TAU)).round();
        let turns = if whole.is_finite() { whole * TAU } else { 0.0 };
        let start = [low.max(self.low - turns), high.min(self.high - turns)];
        (start[0] <= start[1]).then_some(start)
    }
}

/// Fits a smooth chain, guided by the nodes of a chain that need not be smooth.
///
/// If a smooth chain through points needs more than one extra element, a chain that may pass beside the
/// points is searched too: between a line and an arc, there may be no point at which both have the same
/// direction.
pub fn chain(points: Points, guide: &[Node], request: &Fit, budget: &Budget) -> Result<Fitted, Stopped> {
    let rule = request.rule();
    let count = guide.len() - 1;
    if count == 1 {
        return Ok(shaped(points, guide, &rule));
    }
    let corners = corners(points.flat, request.measure);
    let most = looks(points, points.flat.len(), request);
    let is_on_points = guide.iter().all(|node| node.at == points.flat[node.index]);
    let search = |nodes: &[Node], bounds: &Bounds, largest, widest| {
        let looks = Cell::default();
        Search { points, nodes, bounds, corners: &corners, rule, largest, widest, looks, most }.run(budget)
    };
    let unknown = Bounds::unknown(points.flat.len());
    let mut best: Option<Fitted> = None;
    if is_on_points {
        let nodes = on_points(points, guide, &corners);
        let n = points.flat.len();
        let is_short = n <= WINDOW;
        let known =
            is_short.then(|| Bounds::on_points(points, &rule, for_bounds(most, n), budget)).transpose()?;
        let bounds = known.as_ref().unwrap_or(&unknown);
        for largest in LARGEST_BETWEEN_NEIGHBOURS {
            best = search(&nodes, bounds, largest, WIDEST)?;
            if best.is_some() {
                break;
            }
        }
    }
    let is_good = best.as_ref().is_some_and(|fitted| fitted.elements.len() <= count + 1);
    if !is_good && points.heights.is_empty() && request.joints == Joints::Free {
        let pinned = request.is_closed.then_some(points.flat[0]);
        let side = if is_on_points { BESIDE_EXACT } else { BESIDE_NOISY };
        let nodes = joints::nodes(points.flat, pinned, request, (count, side));
        let widest = WIDEST * (1 + side as usize);
        let [largest, _] = LARGEST_BETWEEN_NEIGHBOURS;
        let beside = search(&nodes, &unknown, largest, widest)?;
        let is_fewer =
            |fitted: &Fitted| best.as_ref().is_none_or(|best| fitted.elements.len() < best.elements.len());
        if let Some(fewer) = beside.filter(is_fewer) {
            return Ok(fewer);
        }
    }
    Ok(best.unwrap_or_else(|| shaped(points, guide, &rule)))
}

/// Nodes on some points of each element of the guiding chain, on all points about its joints, and on corners.
/// Where a line becomes an arc, both have the same direction at one point only, and this point is near a
/// joint of the guiding chain.
fn on_points(points: Points, guide: &[Node], corners: &[usize]) -> Vec<Node> {
    let last = points.flat.len() - 1;
    let mut indices: Vec<usize> = corners.to_vec();
    for pair in guide.windows(2) {
        let [from, to] = [pair[0].index, pair[1].index];
        let stride = ((to - from) / NODES_AN_ELEMENT).max(1);
        indices.extend((from..=to).step_by(stride));
        let about = ABOUT_JOINTS * stride;
        indices.extend(to.saturating_sub(about)..=(to + about).min(last));
    }
    indices.sort_unstable();
    indices.dedup();
    indices.into_iter().map(|index| Node { index, at: points.flat[index] }).collect()
}

struct Search<'a> {
    points: Points<'a>,
    nodes: &'a [Node],
    bounds: &'a Bounds,
    corners: &'a [usize],
    rule: Rule,
    /// The largest bulge between neighbouring points.
    largest: f64,
    widest: usize,
    /// Evaluations of points so far, and the most that are allowed.
    looks: Cell<usize>,
    most: usize,
}

impl Search<'_> {
    fn run(&self, budget: &Budget) -> Result<Option<Fitted>, Stopped> {
        let last = self.points.flat.len() - 1;
        let starts = (0..self.nodes.len()).take_while(|&k| self.nodes[k].index == 0);
        let anywhere = |node: usize| Arrival { node, low: f64::NEG_INFINITY, high: f64::INFINITY, before: 0 };
        let mut layers: Vec<Vec<Arrival>> = vec![starts.map(anywhere).collect()];
        while layers.len() <= last {
            let next = self.next(&layers[layers.len() - 1], budget)?;
            if next.is_empty() {
                return Ok(None);
            }
            let finished = next.iter().filter(|arrival| self.nodes[arrival.node].index == last);
            let widest = finished.max_by(|a, b| (a.high - a.low).total_cmp(&(b.high - b.low))).copied();
            if let Some(end) = widest {
                return Ok(self.traced(&layers, end));
            }
            layers.push(next);
        }
        Ok(None)
    }

    /// The arrivals after one more element, at the farthest nodes only.
    fn next(&self, layer: &[Arrival], budget: &Budget) -> Result<Vec<Arrival>, Stopped> {
        let mut next: Vec<Arrival> = Vec::new();
        for from in 0..layer.len() {
            // The arrivals at one node are neighbours; each element is examined once for all of them.
            if from > 0 && layer[from - 1].node == layer[from].node {
                continue;
            }
            budget.check()?;
            if self.looks.get() > self.most {
                return Ok(Vec::new());
            }
            let node = layer[from].node;
            let here: Vec<usize> = (from..layer.len()).take_while(|&k| layer[k].node == node).collect();
            let index = self.nodes[node].index;
            let first = self.nodes.partition_point(|other| other.index <= index);
            for to in first..self.nodes.len() {
                if self.nodes[to].index >= self.bounds.beyond[index] {
                    break;
                }
                self.extend(layer, &here, to, &mut next);
            }
        }
        Ok(self.farthest(next))
    }

    /// Adds the arrivals at the node `to` from the arrivals at one node. An arc with the bulge b over a chord
    /// in the direction psi starts in the direction psi + 2 atan b and ends in the direction psi - 2 atan b.
    /// So the arrivals are the departures, mirrored in the chord.
    fn extend(&self, layer: &[Arrival], here: &[usize], to: usize, next: &mut Vec<Arrival>) {
        let span = self.span(layer[here[0]].node, to);
        let Some((chord, parts)) = self.bulges(&span) else { return };
        let direction = chord.direction();
        for part in parts {
            for &before in here {
                if let Some(start) = layer[before].departures(direction, part) {
                    let [high, low] = start.map(|start| 2.0 * direction - start);
                    next.push(self.departing(Arrival { node: to, low, high, before }));
                }
            }
        }
    }

    /// The arrival with the directions that may follow it: at a corner, any direction.
    fn departing(&self, arrival: Arrival) -> Arrival {
        let index = self.nodes[arrival.node].index;
        if self.corners.binary_search(&index).is_ok() {
            return Arrival { low: f64::NEG_INFINITY, high: f64::INFINITY, ..arrival };
        }
        arrival
    }

    fn span(&self, from: usize, to: usize) -> PointRange<'_> {
        let [from, to] = [self.nodes[from], self.nodes[to]];
        PointRange { points: self.points, first: from.index, last: to.index, from: from.at, to: to.at }
    }

    /// The chord of an element, and the intervals of bulges that it may have.
    fn bulges(&self, span: &PointRange) -> Option<(Chord, Vec<[f64; 2]>)> {
        let chord = Chord::new(span.from, span.to)?;
        let mut witnesses = Witnesses::default();
        let bulges = span.bulges(&self.rule, &mut witnesses);
        self.looks.set(self.looks.get() + witnesses.looks);
        let bulges = bulges?;
        if span.last == span.first + 1 {
            let largest = self.largest;
            return Some((chord, vec![[bulges.least.max(-largest), bulges.most.min(largest)]]));
        }
        let middle = |part: &[f64; 2]| 0.5 * (part[0] + part[1]);
        let keeps = |bulge: f64| span.keeps(bulge, &self.rule, &chord, &mut Witnesses::default());
        Some((chord, bulges.parts().filter(|part| keeps(middle(part))).collect()))
    }

    /// The widest arrivals at each of the farthest nodes, in the order of the nodes.
    fn farthest(&self, mut arrivals: Vec<Arrival>) -> Vec<Arrival> {
        let width = |arrival: &Arrival| arrival.high - arrival.low;
        arrivals.sort_by(|a, b| b.node.cmp(&a.node).then(width(b).total_cmp(&width(a))));
        let (mut kept, mut nodes): (Vec<Arrival>, usize) = (Vec::new(), 0);
        for arrival in arrivals {
            let same = kept.iter().rev().take_while(|other| other.node == arrival.node).count();
            nodes += usize::from(same == 0);
            if nodes > self.widest {
                break;
            }
            if same < INTERVALS {
                kept.push(arrival);
            }
        }
        kept
    }

    /// The chain that arrives at the end in the middle of its directions; `None` if one of its elements
    /// breaks the rule.
    fn traced(&self, layers: &[Vec<Arrival>], end: Arrival) -> Option<Fitted> {
        let mut elements = Vec::with_capacity(layers.len());
        let mut arrival = end;
        let mut direction = None;
        for layer in layers.iter().rev() {
            let before = layer[arrival.before];
            let span = self.span(before.node, arrival.node);
            let chord = Chord::new(span.from, span.to)?;
            let bulge = match direction {
                Some(direction) => Some(ending(&chord, direction)),
                // Any direction at the end is valid: the start is put in the middle of its directions.
                None => self.middle(&span, &chord, before),
            }?;
            if !span.keeps(bulge, &self.rule, &chord, &mut Witnesses::default()) {
                return None;
            }
            let is_flat = bulge.abs() * 2.0 * FLAT_RADIUS_MM < chord.half;
            let is_line =
                is_flat && self.bulges(&span)?.1.iter().any(|part| (part[0]..=part[1]).contains(&0.0));
            elements.push(if is_line {
                Element::line(span.last, span.from, span.to)
            } else {
                Element::bulging(span.last, [span.from, span.to], bulge)
            });
            let is_corner = self.corners.binary_search(&span.first).is_ok();
            direction = (!is_corner).then(|| chord.direction() + 2.0 * bulge.atan());
            arrival = before;
        }
        elements.reverse();
        Some(Fitted { start: self.nodes[arrival.node].at, elements, not_proved: None })
    }

    /// The bulge in the middle of those that continue an arrival.
    fn middle(&self, span: &PointRange, chord: &Chord, before: Arrival) -> Option<f64> {
        let (_, parts) = self.bulges(span)?;
        let direction = chord.direction();
        let ranges = parts.into_iter().filter_map(|part| before.departures(direction, part));
        let widest = ranges.max_by(|a, b| (a[1] - a[0]).total_cmp(&(b[1] - b[0])))?;
        Some((0.5 * (0.5 * (widest[0] + widest[1]) - direction)).tan())
    }
}

/// The bulge of the arc over a chord that ends in a direction.
fn ending(chord: &Chord, direction: f64) -> f64 {
    let turn = chord.direction() - direction;
    let turn = turn - TAU * (turn / TAU).round();
    (0.5 * turn.clamp(-PI, PI)).tan()
}

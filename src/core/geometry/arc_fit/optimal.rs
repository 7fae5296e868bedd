//! Searches for a chain with fewer elements than a known chain. A node is a place where two elements may
//! meet; all nodes are given.
//!
//! # Method
//! The search is breadth-first. The first round finds all nodes that one element from the first point
//! reaches. Each later round finds all nodes that one element from a node of the round before reaches. The
//! first chain that reaches the last point has the fewest elements. An element from a node A to a node B is
//! not tried in three cases:
//! 1. An element that was tried before has reached B.
//! 2. [`Bounds`] prove that no chain through A and B has fewer elements than the known chain.
//! 3. [`Fan`] proves that no circle or line through A and B passes within the tolerance of all points between
//!    A and B.
//!
//! The search is given up after a given number of checks of one point against one element. The caller then
//! repeats it with fewer nodes, or keeps the known chain.

use nalgebra::Vector2;

use super::bounds::Bounds;
use super::candidate::{PointRange, Points, Rule, Witnesses};
use super::for_bounds;
use super::stabbing_bound::Fan;
use crate::budget::{Budget, Stopped};

/// A place where elements may meet: at `at`, which stands for the point `index`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Node {
    pub index: usize,
    pub at: Vector2<f64>,
}

/// Elements from one node that fail before the search asks the fan first. While most elements are possible,
/// the fan excludes nothing.
const PATIENCE: usize = 8;

/// Evaluations of points that take as long as the fan takes for one point.
const LOOKS_OF_FAN: usize = 8;

/// Nodes kept for a second search, after a search over all nodes exceeded its budget.
const THINNED: usize = 1_500;

const NOWHERE: usize = usize::MAX;

/// The result of a search.
#[derive(Debug, Clone, PartialEq)]
pub enum Outcome {
    /// The nodes of a chain of the fewest elements.
    Fewer(Vec<Node>),
    /// No chain is shorter than the known chain.
    None,
    /// The search took more than `most` evaluations.
    GivenUp,
}

/// What a search for chains whose joints lie on points has found.
pub struct OnPoints {
    /// The nodes of a chain with fewer elements than the known chain.
    pub fewer: Option<Vec<Node>>,
    /// Whether no chain has fewer elements than this chain, or than the known chain if there is none.
    pub is_proved: bool,
}

/// Searches for a chain with fewer elements than the known chain, with joints on points.
pub fn fewest_on_points(
    points: Points,
    known: &[Node],
    rule: &Rule,
    most: usize,
    budget: &Budget,
) -> Result<OnPoints, Stopped> {
    let (flat, n) = (points.flat, points.flat.len());
    let bounds = if known[0].at == flat[0] {
        Bounds::on_points(points, rule, for_bounds(most, n), budget)?
    } else {
        Bounds::unknown(n)
    };
    let count = known.len() - 1;
    if bounds.left[0] == count {
        return Ok(OnPoints { fewer: None, is_proved: true });
    }
    let mut all: Vec<Node> = flat.iter().enumerate().map(|(index, at)| Node { index, at: *at }).collect();
    all[0] = known[0];
    let mut outcome = fewest(points, &all, &bounds, rule, count, most, budget)?;
    let is_proved = outcome != Outcome::GivenUp;
    if !is_proved {
        all.retain(|node| node.index.is_multiple_of(1 + n / THINNED) || node.index + 1 == n);
        outcome = fewest(points, &all, &bounds, rule, count, most, budget)?;
    }
    let fewer = if let Outcome::Fewer(best) = outcome { Some(best) } else { None };
    Ok(OnPoints { fewer, is_proved })
}

/// Searches for a chain of fewer than `known` elements, from a node of the first point to a node of the last
/// point. `nodes` are in the order of their points. The search gives up after `most` evaluations.
pub fn fewest(
    points: Points,
    nodes: &[Node],
    bounds: &Bounds,
    rule: &Rule,
    known: usize,
    most: usize,
    budget: &Budget,
) -> Result<Outcome, Stopped> {
    let mut frontier: Vec<usize> = (0..nodes.len()).take_while(|&k| nodes[k].index == 0).collect();
    let mut parents = vec![NOWHERE; nodes.len()];
    frontier.iter().for_each(|&k| parents[k] = k);
    let mut search = Search { points, nodes, bounds, rule, known, parents, fan: Fan::new(rule), looks: 0 };
    for count in 1..known {
        let mut next = Vec::new();
        for &source in frontier.iter().rev() {
            budget.check()?;
            if search.looks > most {
                return Ok(Outcome::GivenUp);
            }
            if let Some(end) = search.expand(source, count, &mut next) {
                return Ok(Outcome::Fewer(chain(nodes, &search.parents, end)));
            }
        }
        next.sort_unstable();
        frontier = next;
    }
    Ok(Outcome::None)
}

struct Search<'a> {
    points: Points<'a>,
    nodes: &'a [Node],
    bounds: &'a Bounds,
    rule: &'a Rule,
    known: usize,
    /// The node from which each node was reached; a start node is its own parent.
    parents: Vec<usize>,
    fan: Fan,
    /// Evaluations of points so far.
    looks: usize,
}

impl Search<'_> {
    /// Adds to `next` the nodes that one element from `source`, the element of number `count`, reaches for
    /// the first time. Returns the node of the last point as soon as that is reached.
    fn expand(&mut self, source: usize, count: usize, next: &mut Vec<usize>) -> Option<usize> {
        let mut witnesses = Witnesses::default();
        let end = self.reached(source, count, next, &mut witnesses);
        self.looks += witnesses.looks;
        end
    }

    fn reached(
        &mut self,
        source: usize,
        count: usize,
        next: &mut Vec<usize>,
        witnesses: &mut Witnesses,
    ) -> Option<usize> {
        let from = self.nodes[source];
        let (mut n_failures, mut has_failed) = (0, false);
        let mut worth = Fan::worth(from.index).peekable();
        let mut target = self.nodes.partition_point(|node| node.index <= from.index);
        while let Some(&to) = self.nodes.get(target) {
            if to.index >= self.bounds.beyond[from.index] {
                return None;
            }
            let k = target;
            target += 1;
            let is_hopeless = count + self.bounds.left[to.index] >= self.known;
            if is_hopeless || self.parents[k] != NOWHERE {
                continue;
            }
            // While most elements are possible, the fan excludes nothing.
            if n_failures >= PATIENCE {
                if n_failures == PATIENCE {
                    self.fan.restart(from.at);
                    n_failures += 1;
                }
                let mut is_open = true;
                while let Some(index) = worth.next_if(|index| *index < to.index) {
                    self.looks += LOOKS_OF_FAN;
                    is_open &= self.fan.take(self.points.flat[index]);
                }
                if std::mem::take(&mut has_failed) {
                    // Every element to a later node has to pass the points that refused an earlier element.
                    for k in witnesses.points().filter(|k| (from.index + 1..to.index).contains(k)) {
                        self.looks += LOOKS_OF_FAN;
                        is_open &= self.fan.take(self.points.flat[k]);
                    }
                }
                if !is_open {
                    return None;
                }
                if !self.fan.admits(to.at) {
                    continue;
                }
            }
            let span = PointRange {
                points: self.points,
                first: from.index,
                last: to.index,
                from: from.at,
                to: to.at,
            };
            if span.find(self.rule, witnesses).is_none() {
                n_failures += usize::from(n_failures < PATIENCE);
                has_failed = true;
                continue;
            }
            self.parents[k] = source;
            if to.index + 1 == self.points.flat.len() {
                return Some(k);
            }
            next.push(k);
        }
        None
    }
}

fn chain(nodes: &[Node], parents: &[usize], end: usize) -> Vec<Node> {
    let mut chain = vec![nodes[end]];
    let mut k = end;
    while parents[k] != k {
        k = parents[k];
        chain.push(nodes[k]);
    }
    chain.reverse();
    chain
}

//! The least number of elements between given nodes.
//!
//! # Method
//! Breadth first: what one element reaches from the start, what a second reaches from there, and so on. An
//! element may be possible where a shorter one is not, so every place is a node, not only the farthest. Nodes
//! from which the last is too far by [`Bounds`] to beat what is known already are left out, and so are all
//! that were reached before.
//!
//! # Cost
//! Each node is reached once, which costs its span; most other pairs fail at the first points that are looked
//! at.

use nalgebra::Vector2;

use super::bounds::Bounds;
use super::candidate::{Points, Rule, Span, Witnesses};
use super::stabbing_bound::Fan;
use crate::budget::{Budget, Stopped};

/// Where elements may meet: at `at`, which stands for the point `index`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Node {
    pub index: usize,
    pub at: Vector2<f64>,
}

/// Failures after which the fan is asked first.
const PATIENCE: usize = 8;

/// Looks at points that take as long as the fan takes for one.
const LOOKS_OF_FAN: usize = 8;

const NOWHERE: usize = usize::MAX;

/// What a search came to.
#[derive(Debug, Clone, PartialEq)]
pub enum Outcome {
    /// The nodes of a chain of the fewest elements.
    Fewer(Vec<Node>),
    /// There is none that is shorter than what is known.
    None,
    /// It took more than `most` looks at points.
    GivenUp,
}

/// Looks for a chain of less than `known` elements from a node of the first point to one of the last. `nodes`
/// are in the order of their points.
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
    /// Where each node was reached from; the first from themselves.
    parents: Vec<usize>,
    fan: Fan,
    /// At points, so far.
    looks: usize,
}

impl Search<'_> {
    /// Adds to `next` what one element from `source` reaches that was not reached before, as the element of
    /// number `count`; the node of the last point, if it is there.
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
            // As long as most elements are possible, the fan tells nothing.
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
                    // What no element to there passed, none to any later point does.
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
            let span =
                Span { points: self.points, first: from.index, last: to.index, from: from.at, to: to.at };
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

//! The least number of elements between given nodes.
//!
//! # Method
//! Breadth first: what one element reaches from the start, what a second reaches from there, and so on. An element may be
//! possible where a shorter one is not, so every place is a node, not only the farthest. Nodes from which the last is too far
//! by [`Bounds`] to beat what is known already are left out, and so are all that were reached before.
//!
//! # Cost
//! Each node is reached once, which costs its span; most other pairs fail at the first points that are looked at.

use nalgebra::Vector2;

use super::bounds::Bounds;
use super::fan::Fan;
use super::span::{Points, Rule, Span, Witnesses};
use crate::budget::{Budget, Stopped};

/// Where elements may meet: at `at`, which stands for the point `index`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Node {
    pub index: usize,
    pub at: Vector2<f64>,
}

const NOWHERE: usize = usize::MAX;

/// The nodes of a chain of the fewest elements, if there is one of less than `known`, from a node of the first point to one of
/// the last. `nodes` are in the order of their points.
pub fn fewest(
    points: Points,
    nodes: &[Node],
    bounds: &Bounds,
    rule: &Rule,
    known: usize,
    budget: &Budget,
) -> Result<Option<Vec<Node>>, Stopped> {
    let last = points.flat.len() - 1;
    let mut fan = Fan::new(rule);
    let mut parents = vec![NOWHERE; nodes.len()];
    let mut frontier: Vec<usize> = (0..nodes.len()).take_while(|&k| nodes[k].index == 0).collect();
    frontier.iter().for_each(|&k| parents[k] = k);
    for count in 1..known {
        let mut next = Vec::new();
        for &source in frontier.iter().rev() {
            budget.check()?;
            let from = nodes[source];
            let mut witnesses = Witnesses::default();
            fan.restart(from.at);
            let mut worth = Fan::worth(from.index).peekable();
            let mut is_open = true;
            let mut target = nodes.partition_point(|node| node.index <= from.index);
            for index in from.index + 1..bounds.beyond[from.index] {
                while let Some(&to) = nodes.get(target).filter(|node| node.index == index) {
                    let (k, from_parent) = (target, parents[target]);
                    target += 1;
                    let is_hopeless = count + bounds.left[index] >= known;
                    if from_parent != NOWHERE || is_hopeless || !fan.admits(to.at) {
                        continue;
                    }
                    let span = Span { points, first: from.index, last: index, from: from.at, to: to.at };
                    if span.find(rule, &mut witnesses).is_none() {
                        // What no element to here passes, none to any later point does.
                        let cuts = witnesses.points().filter(|k| (from.index + 1..index).contains(k));
                        is_open &= cuts.fold(true, |open, k| fan.take(points.flat[k]) && open);
                        continue;
                    }
                    parents[k] = source;
                    if index == last {
                        return Ok(Some(chain(nodes, &parents, k)));
                    }
                    next.push(k);
                }
                if worth.next_if_eq(&index).is_some() {
                    is_open &= fan.take(points.flat[index]);
                }
                if !is_open {
                    break;
                }
            }
        }
        next.sort_unstable();
        frontier = next;
    }
    Ok(None)
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

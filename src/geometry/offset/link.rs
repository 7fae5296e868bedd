//! Chains of what is left of the pieces.
//!
//! # Method
//! Where two pieces are cut by each other, each is cut at the same place to rounding: ends are joined to
//! starts, the nearest pairs first, of equally near ones those whose pieces follow each other soonest.
//!
//! # Guarantees
//! Chains are connected exactly. A joint lies off the lines and circles of its pieces by at most
//! [`BESIDE_MM`]. The chains and their elements are in the contour's order; a closed chain starts at its
//! first piece.
//!
//! # Degenerate input
//! Pieces that meet under a tiny angle are cut at places that differ along them; their joint lies between.
//!
//! # Cost
//! O(n log n) for n ranges, unless many ends are nearer to each other than the rounding of joints.

use nalgebra::{Point2, center};

use super::pieces::{self, Piece};
use crate::budget::{Budget, Stopped};
use crate::geometry::element::{Element, PlaneArc};

/// How far a joint may lie beside its pieces, mm: a tenth of what an offset may come too near.
const BESIDE_MM: f64 = 1e-7;

/// Pairs of which the distances differ by less are equally near, mm.
const EQUALLY_NEAR_MM: f64 = 1e-9;

/// Of arcs with ends nearer to each other rounding decides whether they are short or nearly full turns, mm;
/// they become lines.
const SHORTEST_ARC_MM: f64 = 2e-6;

/// So that no arc nearly closes, those that turn more are divided, radians.
const LARGEST_TURN: f64 = 1.5 * std::f64::consts::PI;

/// Ranges between two looks at the budget.
const RANGES_BETWEEN_CHECKS: usize = 256;

/// A range of a piece that is left.
#[derive(Debug, Clone, Copy)]
pub(super) struct OpenRange {
    /// The index of the piece.
    pub piece: usize,
    pub range: [f64; 2],
}

/// Joins the ranges to chains. Ends farther than `joint_mm` from each other are not joined, and shorter
/// chains are left out.
///
/// # Errors
/// When the budget ends.
pub(super) fn chains(
    pieces: &[Piece],
    ranges: &[OpenRange],
    joint_mm: f64,
    budget: &Budget,
) -> Result<Vec<Vec<Element>>, Stopped> {
    let followers = followers(pieces, ranges, joint_mm, budget)?;
    let mut is_followed = vec![false; ranges.len()];
    for follower in followers.iter().flatten() {
        is_followed[*follower] = true;
    }
    let mut is_used = vec![false; ranges.len()];
    let mut chains = Vec::new();
    // Open chains start where nothing comes before; every range that is left then is of a closed one.
    let starts = (0..ranges.len()).filter(|k| !is_followed[*k]).chain(0..ranges.len());
    for first in starts {
        let mut sequence = Vec::new();
        let mut next = Some(first);
        while let Some(k) = next.filter(|k| !is_used[*k]) {
            is_used[k] = true;
            sequence.push(k);
            next = followers[k];
        }
        let chain = chain(pieces, ranges, &sequence, next.is_some());
        if chain.iter().map(pieces::length).sum::<f64>() > joint_mm {
            chains.push((first, chain));
        }
    }
    chains.sort_by_key(|(first, _)| *first);
    Ok(chains.into_iter().map(|(_, chain)| chain).collect())
}

/// For each range the one that continues it.
fn followers(
    pieces: &[Piece],
    ranges: &[OpenRange],
    joint_mm: f64,
    budget: &Budget,
) -> Result<Vec<Option<usize>>, Stopped> {
    let ends: Vec<_> = ranges.iter().map(|range| ends(pieces, range)).collect();
    let mut starts: Vec<usize> = (0..ranges.len()).collect();
    starts.sort_by(|a, b| ends[*a][0].x.total_cmp(&ends[*b][0].x));
    let mut pairs = Vec::new();
    for (k, [_, end]) in ends.iter().enumerate() {
        if k % RANGES_BETWEEN_CHECKS == 0 {
            budget.check()?;
        }
        let first = starts.partition_point(|other| ends[*other][0].x < end.x - joint_mm);
        let near = starts[first..].iter().take_while(|other| ends[**other][0].x <= end.x + joint_mm);
        for other in near.copied().filter(|other| *other != k) {
            let apart = (ends[other][0] - end).norm();
            let joint = center(end, &ends[other][0]);
            let beside = |range: usize| pieces::from_carrier(&pieces[ranges[range].piece].element, joint);
            if apart <= joint_mm && beside(k) <= BESIDE_MM && beside(other) <= BESIDE_MM {
                let steps = (ranges[other].piece + pieces.len() - ranges[k].piece) % pieces.len();
                pairs.push(((apart / EQUALLY_NEAR_MM) as u64, steps, k, other));
            }
        }
    }
    pairs.sort_unstable();
    let mut followers = vec![None; ranges.len()];
    let mut is_followed = vec![false; ranges.len()];
    for (_, _, k, other) in pairs {
        if followers[k].is_none() && !is_followed[other] {
            followers[k] = Some(other);
            is_followed[other] = true;
        }
    }
    Ok(followers)
}

fn ends(pieces: &[Piece], range: &OpenRange) -> [Point2<f64>; 2] {
    range.range.map(|t| pieces::at(&pieces[range.piece].element, t))
}

fn chain(pieces: &[Piece], ranges: &[OpenRange], sequence: &[usize], is_closed: bool) -> Vec<Element> {
    let ends = |k: usize| ends(pieces, &ranges[sequence[k]]);
    let joint = |before: usize, after: usize| center(&ends(before)[1], &ends(after)[0]);
    let Some(last) = sequence.len().checked_sub(1) else { return Vec::new() };
    let begin = if is_closed { joint(last, 0) } else { ends(0)[0] };
    let finish = if is_closed { begin } else { ends(last)[1] };
    let mut ways: Vec<Way> = Vec::with_capacity(sequence.len());
    let mut start = begin;
    for (k, range) in sequence.iter().map(|k| &ranges[*k]).enumerate() {
        let end = if k == last { finish } else { joint(k, k + 1) };
        // What is too short is stepped over: the next element starts where it would have.
        if let Some(turn) = pieces::turn_between(&pieces[range.piece].element, range.range, [start, end]) {
            ways.push(Way { start, end, turn });
            start = end;
        }
    }
    if let Some(way) = ways.last_mut() {
        way.end = finish;
    }
    let mut chain = Vec::with_capacity(ways.len());
    for way in ways {
        way.append_to(&mut chain);
    }
    chain
}

/// An element that is to be, by its ends and the angle that it turns, radians.
struct Way {
    start: Point2<f64>,
    end: Point2<f64>,
    turn: f64,
}

impl Way {
    /// Arcs are made of their ends: these then lie on their circles to rounding, wherever the joints are.
    fn append_to(&self, chain: &mut Vec<Element>) {
        let Self { start, end, turn } = *self;
        let bulge = -(turn / 4.0).tan();
        let is_arc = (end - start).norm() >= SHORTEST_ARC_MM;
        let arc = PlaneArc::with_bulge(start, end, bulge).filter(|_| is_arc);
        match arc {
            None => chain.push(Element::Line { start, end }),
            Some(arc) if turn.abs() > LARGEST_TURN => {
                let middle = pieces::at(&Element::Arc(arc), 0.5);
                for [start, end] in [[start, middle], [middle, end]] {
                    Self { start, end, turn: 0.5 * turn }.append_to(chain);
                }
            }
            Some(arc) => chain.push(Element::Arc(arc)),
        }
    }
}

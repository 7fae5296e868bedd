//! Joins the parts of pieces that remain after clipping. The results are chains of elements.
//!
//! # Method
//! Where two pieces cut each other, clipping ends a part of one piece and starts a part of the other, at the
//! same place up to rounding. So each end of a part is joined to the start of another part nearby. The
//! nearest pairs are joined first. If there is no start near the end of a part, this part is the last one of
//! its chain.
//!
//! # Guarantees
//! Each element starts exactly where the element before it ends. If this joint connects two pieces, it lies
//! within [`BESIDE_MM`] of the line or circle of each of them. Chains run in the direction of their contours.
//!
//! # Cost
//! O(n log n) for n parts, unless many parts end near the same place.

use nalgebra::{Point2, center};

use super::pieces::{self, Piece};
use crate::budget::{Budget, Stopped};
use crate::geometry::segment::Segment;

/// The largest distance of a joint from the lines and circles of its pieces, mm: a tenth of the distance by
/// which an offset may be too near.
const BESIDE_MM: f64 = 1e-7;

/// Pairs count as equally near if their distances differ by less, mm.
const EQUALLY_NEAR_MM: f64 = 1e-9;

/// Arcs whose ends are nearer to each other become lines, mm: rounding would decide whether such an arc is
/// short or nearly a full turn.
const SHORTEST_ARC_MM: f64 = 2e-6;

/// Arcs that turn more are divided, radians, so that no arc is nearly a full circle.
const LARGEST_TURN: f64 = 1.5 * std::f64::consts::PI;

/// Ranges between two checks of the budget.
const RANGES_BETWEEN_CHECKS: usize = 256;

/// A range of a piece that is left after clipping.
#[derive(Debug, Clone, Copy)]
pub(super) struct OpenRange {
    /// The index of the piece.
    pub piece: usize,
    pub range: [f64; 2],
}

/// Joins the ranges to chains, sorted by their first ranges. Ends farther than `joint_mm` from each other are
/// not joined. Chains no longer than `joint_mm` are left out.
///
/// # Errors
/// When the budget ends.
pub(super) fn chains(
    pieces: &[Piece],
    ranges: &[OpenRange],
    joint_mm: f64,
    budget: &Budget,
) -> Result<Vec<Vec<Segment>>, Stopped> {
    let followers = followers(pieces, ranges, joint_mm, budget)?;
    let mut is_followed = vec![false; ranges.len()];
    for follower in followers.iter().flatten() {
        is_followed[*follower] = true;
    }
    let mut is_used = vec![false; ranges.len()];
    let mut chains = Vec::new();
    // Open chains start at ranges without a range before them. All ranges left after that belong to closed
    // chains.
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
        if chain.iter().map(Segment::length).sum::<f64>() > joint_mm {
            chains.push((first, chain));
        }
    }
    chains.sort_by_key(|(first, _)| *first);
    Ok(chains.into_iter().map(|(_, chain)| chain).collect())
}

/// For each range the range that continues it. Among equally near pairs, those whose pieces follow each other
/// most closely along the contour come first. If two pieces meet at a tiny angle, their ends may lie apart
/// along the pieces; the joint is in the middle between them.
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
            let beside = |range: usize| pieces[ranges[range].piece].element.distance_to_carrier(joint);
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
    range.range.map(|t| pieces[range.piece].element.at(t))
}

fn chain(pieces: &[Piece], ranges: &[OpenRange], sequence: &[usize], is_closed: bool) -> Vec<Segment> {
    let ends = |k: usize| ends(pieces, &ranges[sequence[k]]);
    let joint = |before: usize, after: usize| center(&ends(before)[1], &ends(after)[0]);
    let Some(last) = sequence.len().checked_sub(1) else { return Vec::new() };
    let begin = if is_closed { joint(last, 0) } else { ends(0)[0] };
    let finish = if is_closed { begin } else { ends(last)[1] };
    let mut ways: Vec<Way> = Vec::with_capacity(sequence.len());
    let mut start = begin;
    for (k, range) in sequence.iter().map(|k| &ranges[*k]).enumerate() {
        let end = if k == last { finish } else { joint(k, k + 1) };
        // A range that is too short is skipped: the next element starts where the skipped one would have.
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

/// An element to be made, by its ends and the angle that it turns, radians.
struct Way {
    start: Point2<f64>,
    end: Point2<f64>,
    turn: f64,
}

impl Way {
    /// Appends the element. Arcs are made from their ends, so that the ends lie on the circle to rounding,
    /// wherever the joints are.
    fn append_to(&self, chain: &mut Vec<Segment>) {
        let Self { start, end, turn } = *self;
        if (end - start).norm() < SHORTEST_ARC_MM {
            return chain.push(Segment::Line { start, end });
        }
        let segment = Segment::turning(start, end, turn);
        if turn.abs() <= LARGEST_TURN {
            return chain.push(segment);
        }
        let middle = segment.at(0.5);
        for [start, end] in [[start, middle], [middle, end]] {
            Self { start, end, turn: 0.5 * turn }.append_to(chain);
        }
    }
}

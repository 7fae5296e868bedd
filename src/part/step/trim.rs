//! The bounds of a face as closed loops in the plane of the parameters of its surface.
//!
//! # Method
//! 1. The pieces of each loop are joined. At a pole the parameters go on along the side that is the pole, so
//!    that the face lies to the left.
//! 2. A loop that goes round a closed surface ends whole periods away from its start. Two such loops are
//!    joined by a seam; a single one is closed at the pole that the face contains.
//! 3. The other loops are the outer bound and holes. On a sphere or a torus a hole alone is a hole in the
//!    whole surface.
//!
//! # Degenerate input
//! Where a surface is not closed, bounds in the wrong direction are turned round.

use toolpathd_core::budget::{Budget, Stopped};

use super::chain::Chain;
use super::model::Edge;
use super::parameter_search::ParameterSearch;
use super::piece::{BoundPiece, Part, Sampler, lift};
use super::seam::Seam;
use super::surface::{PolarSide, Surface};

/// Two edges of a loop may be this far apart, mm, and this part of the size of the face.
const GAP_MM: f64 = 0.05;
const GAP_SHARE: f64 = 1e-3;

/// A jump at a pole of less than this part of a period is a whole period: the face lies on both sides of a
/// seam.
const NO_JUMP: f64 = 1e-7;

/// The polygon of a bound may leave it by this part of the size of the face.
const POLYGON_SHARE: f64 = 5e-4;

/// The loops of a face in the plane of the parameters. The first goes round the face counterclockwise, unless
/// the face is several; the others are holes.
#[derive(Debug, Clone, PartialEq)]
pub struct Trim {
    pub chains: Vec<Chain>,
}

/// Why loops make no trim.
#[derive(Debug, Clone, PartialEq)]
pub enum Untrimmed {
    /// They bound no face: why, as a clause.
    Unbounded(&'static str),
    Stopped(Stopped),
}

impl From<&'static str> for Untrimmed {
    fn from(reason: &'static str) -> Self {
        Self::Unbounded(reason)
    }
}

impl From<Stopped> for Untrimmed {
    fn from(stopped: Stopped) -> Self {
        Self::Stopped(stopped)
    }
}

impl Trim {
    /// The trim of loops whose edges go round the surface's own normal.
    ///
    /// # Errors
    /// The loops bound no face, or the budget has ended.
    pub fn of(
        search: &ParameterSearch,
        loops: &[&[Edge]],
        size_mm: f64,
        budget: &Budget,
    ) -> Result<Self, Untrimmed> {
        let sampler = Sampler::new(search, POLYGON_SHARE * size_mm);
        let mut first = 0;
        let mut closed = Vec::new();
        let mut turning = Vec::new();
        for edges in loops {
            let chain = chain(&sampler, edges, first, GAP_MM + GAP_SHARE * size_mm, budget)?;
            first += edges.len();
            let Some(chain) = chain else { continue };
            if chain.turns == [0, 0] {
                closed.push(chain);
            } else {
                turning.push(chain);
            }
        }
        let mut chains = Vec::new();
        let edges = loops.iter().flat_map(|edges| edges.iter()).collect();
        let seam = Seam { sampler: &sampler, edges, holes: closed.iter().map(Chain::box_of).collect() };
        match turning.len() {
            0 => {}
            1 => chains.push(closed_at_pole(&seam, turning.remove(0))?),
            2 => {
                let second = turning.remove(1);
                chains.push(joined(&seam, turning.remove(0), second)?);
            }
            _ => return Err("its bounds go round the surface more than twice".into()),
        }
        arrange(search.surface, &mut chains, closed)?;
        shift_holes(&sampler, &mut chains);
        Ok(Self { chains })
    }
}

/// The pieces of one loop. `None` if all of it is at a pole.
fn chain(
    sampler: &Sampler,
    edges: &[Edge],
    first: usize,
    gap_mm: f64,
    budget: &Budget,
) -> Result<Option<Chain>, Untrimmed> {
    let mut chain: Option<Chain> = None;
    let mut last_pole = None;
    let mut first_pole = None;
    for (k, edge) in edges.iter().enumerate() {
        budget.check()?;
        let before = &edges[(k + edges.len() - 1) % edges.len()];
        let gap = (edge.start() - before.end()).norm();
        if gap.is_nan() || gap > gap_mm {
            return Err("the edges of a bound do not meet".into());
        }
        let near = chain.as_ref().map(Chain::end);
        for Part { mut piece, poles } in sampler.parts(edge, first + k, near) {
            let Some(chain) = &mut chain else {
                first_pole = poles[0];
                last_pole = poles[1];
                chain = Some(Chain { pieces: vec![piece], turns: [0, 0] });
                continue;
            };
            let (from, to) = (chain.end(), piece.start());
            let target = match last_pole.or(poles[0]) {
                Some(pole) => across_pole(sampler, &pole, chain, to),
                None => [0, 1].map(|k| lift(to[k], from[k], sampler.periods[k])),
            };
            piece.shift([target[0] - to[0], target[1] - to[1]]);
            chain.go(&[target]);
            chain.pieces.push(piece);
            last_pole = poles[1];
        }
    }
    let Some(mut chain) = chain else { return Ok(None) };
    let (start, end) = (chain.start(), chain.end());
    let target = match last_pole.or(first_pole) {
        Some(pole) => across_pole(sampler, &pole, &chain, start),
        None => [0, 1].map(|k| lift(start[k], end[k], sampler.periods[k])),
    };
    chain.go(&[target]);
    chain.turns = [0, 1]
        .map(|k| sampler.periods[k].map_or(0, |period| ((target[k] - start[k]) / period).round() as i32));
    Ok(Some(chain))
}

/// Where a chain that ends at a pole goes on, if the next piece begins at `to`: along the side of the pole,
/// with the face to the left.
fn across_pole(sampler: &Sampler, pole: &PolarSide, chain: &Chain, to: [f64; 2]) -> [f64; 2] {
    let from = chain.end();
    let other = 1 - pole.along;
    let mut target = to;
    target[pole.along] = lift(to[pole.along], from[pole.along], sampler.periods[pole.along]);
    let Some(period) = sampler.periods[other] else { return target };
    let inside = chain.pieces[chain.pieces.len() - 1].places();
    let inside = inside[inside.len().saturating_sub(2)];
    let is_upper = inside[pole.along] < from[pole.along];
    // Counterclockwise: along the upper side to lower u, along the right side to higher v.
    let is_growing = is_upper == (pole.along == 0);
    let change = to[other] - from[other];
    let least = NO_JUMP * period;
    target[other] = if is_growing {
        from[other] + (change - least).rem_euclid(period) + least
    } else {
        from[other] - ((-change - least).rem_euclid(period) + least)
    };
    target
}

/// Closes a loop that goes round once at the pole that the face contains.
fn closed_at_pole(seam: &Seam, mut chain: Chain) -> Result<Chain, &'static str> {
    let sampler = seam.sampler;
    let (along, turn) = match chain.turns {
        [turn @ (1 | -1), 0] => (0, turn),
        [0, turn @ (1 | -1)] => (1, turn),
        _ => return Err("a bound goes round the surface more than once"),
    };
    let other = 1 - along;
    let range = chain.range(other);
    let poles: Vec<&PolarSide> = sampler.poles.iter().filter(|pole| pole.along == other).collect();
    let is_on = |pole: &PolarSide, upper: bool| if upper { pole.at >= range[1] } else { pole.at <= range[0] };
    // To the left of growing u is higher v; to the left of growing v is lower u.
    let upper = (turn > 0) == (along == 0);
    let pole = match poles.iter().find(|pole| is_on(pole, upper)) {
        Some(pole) => *pole,
        None => {
            let pole = poles.iter().find(|pole| is_on(pole, !upper));
            chain.reverse();
            *pole.ok_or("its bounds leave it open")?
        }
    };
    seam.begin_towards(&mut chain, along, pole.at);
    let (start, end) = (chain.start(), chain.end());
    let (mut far, mut near) = (end, start);
    far[other] = pole.at;
    near[other] = pole.at;
    chain.go(&[far, near, start]);
    chain.turns = [0, 0];
    Ok(chain)
}

/// Joins two loops that go round in opposite directions by a seam.
fn joined(seam: &Seam, mut a: Chain, mut b: Chain) -> Result<Chain, &'static str> {
    let sampler = seam.sampler;
    let along = match a.turns {
        [1 | -1, 0] => 0,
        [0, 1 | -1] => 1,
        _ => return Err("a bound goes round the surface more than once"),
    };
    let other = 1 - along;
    if b.turns[other] != 0 || b.turns[along].abs() != 1 {
        return Err("two bounds go round the surface in different ways");
    }
    let Some(period) = sampler.periods[along] else { return Err("its bounds leave it open") };
    if sampler.periods[other].is_none() {
        // To the left of growing u is higher v; to the left of growing v is lower u.
        if (a.range(other)[0] > b.range(other)[0]) == (along == 0) {
            std::mem::swap(&mut a, &mut b);
        }
        for (chain, turn) in [(&mut a, 1), (&mut b, -1)] {
            if chain.turns[along] != turn {
                chain.reverse();
            }
        }
    } else if a.turns[along] + b.turns[along] != 0 {
        return Err("two bounds go round the surface in the same direction");
    } else if a.turns[along] < 0 {
        std::mem::swap(&mut a, &mut b);
    }
    seam.begin_beside(&mut a, &mut b, along);
    let start = a.start();
    let mut shift = [0.0; 2];
    shift[along] = lift(b.start()[along], start[along] + period, Some(period)) - b.start()[along];
    if let Some(across) = sampler.periods[other] {
        let gap = b.start()[other] - start[other];
        let least = NO_JUMP * across;
        let wanted = if along == 0 {
            (gap - least).rem_euclid(across) + least
        } else {
            -((-gap - least).rem_euclid(across) + least)
        };
        shift[other] = wanted - gap;
    }
    b.shift(shift);
    a.go(&[b.start()]);
    a.pieces.append(&mut b.pieces);
    a.go(&[start]);
    a.turns = [0, 0];
    Ok(a)
}

/// Puts the outer bound before the holes.
fn arrange(surface: &Surface, chains: &mut Vec<Chain>, mut closed: Vec<Chain>) -> Result<(), &'static str> {
    let domain = surface.closed_domain();
    let total: f64 = closed.iter().map(Chain::polygon_area).sum();
    if let Some(domain) = domain.filter(|_| chains.is_empty() && total <= 0.0) {
        chains.push(rectangle(domain, closed.first().map(Chain::box_of), surface.periods()));
    }
    closed.sort_by(|a, b| b.polygon_area().abs().total_cmp(&a.polygon_area().abs()));
    if domain.is_none() {
        for (k, chain) in closed.iter_mut().enumerate() {
            let is_outer = k == 0 && chains.is_empty();
            if (chain.polygon_area() > 0.0) != is_outer {
                chain.reverse();
            }
        }
    }
    chains.append(&mut closed);
    if chains.is_empty() { Err("it has no bounds, and its surface is not closed") } else { Ok(()) }
}

/// The whole of a closed surface, turned so that a hole lies within.
fn rectangle(domain: [[f64; 2]; 2], hole: Option<[[f64; 2]; 2]>, periods: [Option<f64>; 2]) -> Chain {
    let [u, v] = [0, 1].map(|k| match (hole, periods[k]) {
        (Some(hole), Some(period)) => {
            let middle = (hole[k][0] + hole[k][1]) / 2.0;
            [middle - period / 2.0, middle + period / 2.0]
        }
        _ => domain[k],
    });
    let corners = [[u[0], v[0]], [u[1], v[0]], [u[1], v[1]], [u[0], v[1]]];
    let sides = (0..4).map(|k| BoundPiece::Straight([corners[k], corners[(k + 1) % 4]]));
    Chain { pieces: sides.collect(), turns: [0, 0] }
}

/// Takes holes by whole periods into the outer bound.
fn shift_holes(sampler: &Sampler, chains: &mut [Chain]) {
    let Some((outer, holes)) = chains.split_first_mut() else { return };
    let middle = |range: [f64; 2]| (range[0] + range[1]) / 2.0;
    let outer = outer.box_of();
    for hole in holes {
        let found = hole.box_of();
        hole.shift([0, 1].map(|k| {
            let at = middle(found[k]);
            lift(at, middle(outer[k]), sampler.periods[k]) - at
        }));
    }
}

//! Chains of curves. Curves of one layer are joined first; what stays open is then joined across layers.

use std::collections::{BTreeMap, HashSet};

use toolpathd_core::budget::Budget;

use super::faces::Leaving;
use super::links::{EndOf, Links, links};
use super::{Branch, bulge};
use crate::fault::Unreadable;

/// A curve, or a chain of curves.
#[derive(Debug, Clone, PartialEq)]
pub struct Part {
    pub vertices: Vec<[f64; 3]>,
    pub is_closed: bool,
    /// Whether the start and the end are points that the file has.
    pub is_written: [bool; 2],
    pub layer: usize,
    /// The number of the first curve.
    pub first: usize,
}

pub type Chain = Part;

/// Chains in the order of their first curves.
#[derive(Debug, Clone, PartialEq)]
pub struct Chains {
    pub chains: Vec<Chain>,
    pub branches: Vec<Branch>,
    pub bridged_max_mm: f64,
}

/// # Errors
/// When the gap is too large for the drawing, or the budget ends.
pub fn chains(parts: Vec<Part>, gap_mm: f64, budget: &Budget) -> Result<Chains, Unreadable> {
    let mut result = Chains { chains: Vec::new(), branches: Vec::new(), bridged_max_mm: 0.0 };
    let mut layers: BTreeMap<usize, Vec<Part>> = BTreeMap::new();
    for part in parts {
        match part.is_closed {
            true => result.chains.push(part),
            false => layers.entry(part.layer).or_default().push(part),
        }
    }
    let has_more_layers = layers.len() > 1;
    let mut open = Vec::new();
    for parts in layers.into_values() {
        for chain in result.join(parts, gap_mm, !has_more_layers, budget)? {
            match chain.is_closed {
                true => result.chains.push(chain),
                false => open.push(chain),
            }
        }
    }
    if has_more_layers {
        open.sort_by_key(|chain| chain.first);
        open = result.join(open, gap_mm, true, budget)?;
    }
    result.chains.extend(open);
    result.chains.sort_by_key(|chain| chain.first);
    Ok(result)
}

impl Chains {
    /// The chains of open parts. `is_last` says that what stays open is not looked at again.
    fn join(
        &mut self,
        parts: Vec<Part>,
        gap_mm: f64,
        is_last: bool,
        budget: &Budget,
    ) -> Result<Vec<Chain>, Unreadable> {
        let origin = parts.first().map_or([0.0; 2], |part| [part.vertices[0][0], part.vertices[0][1]]);
        let mut places = Vec::with_capacity(2 * parts.len());
        let mut ends = Vec::with_capacity(2 * parts.len());
        for part in &parts {
            let length_mm = bulge::length(&part.vertices, false);
            let swept_mm2 = bulge::swept(&part.vertices, false, origin);
            let back = bulge::reversed(&part.vertices, false);
            for (k, vertices) in [&part.vertices, &back].into_iter().enumerate() {
                places.push([vertices[0][0], vertices[0][1]]);
                let swept_mm2 = if k == 0 { swept_mm2 } else { -swept_mm2 };
                let leaving = leaving(vertices);
                ends.push(EndOf { is_written: part.is_written[k], length_mm, swept_mm2, leaving });
            }
        }
        let mut links = links(places, &ends, gap_mm, budget)?;
        if is_last {
            links.tell_lone_ends_beside_others(gap_mm);
        }
        self.bridged_max_mm = self.bridged_max_mm.max(links.bridged_max_mm);
        // A branch that was found within one layer is replaced by the branch across layers at the same place.
        let place = |branch: &Branch| branch.at.map(f64::to_bits);
        let told: HashSet<[u64; 2]> = links.branches.iter().map(place).collect();
        self.branches.retain(|branch| !told.contains(&place(branch)));
        self.branches.append(&mut links.branches);
        Ok(walk(parts, &links))
    }
}

/// How a chain leaves its first vertex.
fn leaving(vertices: &[[f64; 3]]) -> Leaving {
    let first = bulge::segment(vertices[0], vertices[1]);
    let [along, _] = first.tangents();
    Leaving { angle: along.y.atan2(along.x), curvature: first.curvature() }
}

/// The chains along joined ends.
fn walk(parts: Vec<Part>, links: &Links) -> Vec<Chain> {
    let mut is_used = vec![false; parts.len()];
    let mut chains = Vec::new();
    for first in 0..parts.len() {
        if is_used[first] {
            continue;
        }
        let (entry, is_closed) = start_of(2 * first, links);
        let mut chain = Chain {
            vertices: Vec::new(),
            is_closed,
            is_written: [parts[entry / 2].is_written[entry % 2]; 2],
            layer: parts[first].layer,
            first: parts[first].first,
        };
        let mut at = entry;
        loop {
            let part = &parts[at / 2];
            is_used[at / 2] = true;
            chain.push(part, at, links);
            chain.is_written[1] = part.is_written[1 - at % 2];
            match links.mates[at ^ 1] {
                Some(next) if next != entry => at = next,
                _ => break,
            }
        }
        chains.push(chain.finished());
    }
    chains
}

/// The end at which the chain of an end starts, and whether the chain is closed: it then starts at this end.
fn start_of(end: usize, links: &Links) -> (usize, bool) {
    let mut at = end;
    while let Some(before) = links.mates[at] {
        at = before ^ 1;
        if at == end {
            return (end, true);
        }
    }
    (at, false)
}

impl Chain {
    /// Appends a part that is entered at the end `entry`.
    fn push(&mut self, part: &Part, entry: usize, links: &Links) {
        let back;
        let vertices = match entry % 2 {
            0 => &part.vertices,
            _ => {
                back = bulge::reversed(&part.vertices, false);
                &back
            }
        };
        let last = vertices.len() - 1;
        for (k, vertex) in vertices.iter().enumerate() {
            let [x, y] = match k {
                0 => links.places[entry],
                _ if k == last => links.places[entry ^ 1],
                _ => [vertex[0], vertex[1]],
            };
            // The last vertex is also the first of the next part, and a piece may have lost its length.
            if self.vertices.last().is_some_and(|before| before[..2] == [x, y]) {
                self.vertices.pop();
            }
            self.vertices.push([x, y, vertex[2]]);
        }
    }

    /// The chain; a closed one does not repeat its first vertex.
    fn finished(mut self) -> Self {
        if self.is_closed && self.vertices.len() > 1 {
            self.vertices.pop();
        }
        self
    }
}

//! Loops, open chains and their nesting, from single curves.

use toolpathd_core::budget::{Budget, Stopped};

use super::chains::{Chain, Part, chains};
use super::copies::without_copies;
use super::{Branch, Loop, OpenChain, bulge, nesting};
use crate::fault::{Place, Unreadable};
use crate::left_out::LeftOuts;

/// A loop bounds an area if the area is above this part of the square of its length. A slot of a length of a
/// metre that bounds less is a nanometre wide.
const LEAST_AREA: f64 = 2.5e-10;

/// How near curves are that count as one drawn twice, mm: above the rounding of programs that move a drawing,
/// and far below the details of any.
const SAME_CURVE_MM: f64 = 1e-6;

const TWICE: &str = "drawn twice";

/// A curve as lines and arcs.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    /// As [`Loop::vertices`]. At least two, and no piece is without length.
    pub vertices: Vec<[f64; 3]>,
    pub is_closed: bool,
    /// Whether its ends are points that the file has. Such an end stays where a computed one is joined to it.
    pub has_written_ends: bool,
    pub layer: usize,
    /// The kind of its entity. A list of what was left out names the chain by it.
    pub kind: String,
    /// The place of its entity in the file.
    pub place: Place,
}

#[derive(Clone, Copy)]
pub struct Limits<'a> {
    pub gap_mm: f64,
    pub budget: &'a Budget,
}

#[derive(Debug, Clone, Default)]
pub struct Assembly {
    pub loops: Vec<Loop>,
    pub open: Vec<OpenChain>,
    pub branches: Vec<Branch>,
    pub bridged_max_mm: f64,
    pub left_out: LeftOuts,
}

/// Joins curves to loops, and nests the loops. A curve that repeats another is left out, and so is a loop or
/// chain that repeats another within the gap.
///
/// # Errors
/// When the gap is larger than the distances of too many ends, or the budget ends.
pub fn assemble(
    curves: Vec<Curve>,
    layers: &[&str],
    mut left_out: LeftOuts,
    limits: Limits,
) -> Result<Assembly, Unreadable> {
    let budget = limits.budget;
    let curves = without_copies(
        curves,
        |curve| (&curve.vertices, curve.is_closed),
        SAME_CURVE_MM,
        budget,
        |curve| left_out.add(&curve.kind, TWICE, curve.place),
    )?;
    let origins: Vec<(String, Place)> =
        curves.iter().map(|curve| (curve.kind.clone(), curve.place)).collect();
    let parts = curves.into_iter().enumerate().map(|(first, curve)| Part {
        vertices: curve.vertices,
        is_closed: curve.is_closed,
        is_written: [curve.has_written_ends; 2],
        layer: curve.layer,
        first,
    });
    let joined = chains(parts.collect(), limits.gap_mm, limits.budget)?;
    let mut loops = Vec::new();
    let mut open = Vec::new();
    // Several curves may repeat a loop that is one curve, so that no curve is a copy.
    let chains = without_copies(
        joined.chains,
        |chain| (&chain.vertices, chain.is_closed),
        limits.gap_mm,
        budget,
        |chain| left_out.add(&origins[chain.first].0, TWICE, origins[chain.first].1),
    )?;
    for Chain { vertices, is_closed, layer, first, .. } in chains {
        let layer = layers[layer].to_owned();
        if !is_closed {
            let gap_mm = match (vertices.first(), vertices.last()) {
                (Some(start), Some(end)) => f64::hypot(end[0] - start[0], end[1] - start[1]),
                _ => continue,
            };
            open.push(OpenChain { vertices, layer, gap_mm });
            continue;
        }
        let (area, length_mm) = (bulge::area(&vertices), bulge::length(&vertices, true));
        if area.abs() <= LEAST_AREA * length_mm * length_mm {
            let (kind, place) = &origins[first];
            left_out.add(kind, "it is closed and bounds no area", *place);
            continue;
        }
        let vertices = if area < 0.0 { bulge::reversed(&vertices, true) } else { vertices };
        loops.push(Loop { vertices, layer, area_mm2: area.abs(), length_mm, depth: 0, parent: None });
    }
    Ok(Assembly {
        loops: nested(loops, limits.budget)?,
        open,
        branches: joined.branches,
        bridged_max_mm: joined.bridged_max_mm,
        left_out,
    })
}

/// The loops by their depths, with their parents.
fn nested(mut loops: Vec<Loop>, budget: &Budget) -> Result<Vec<Loop>, Stopped> {
    let nests = nesting::nests(&loops, budget)?;
    for (one, nest) in loops.iter_mut().zip(&nests) {
        one.depth = nest.depth;
        one.parent = nest.parent;
    }
    let mut order: Vec<usize> = (0..loops.len()).collect();
    order.sort_by_key(|k| loops[*k].depth);
    let mut number = vec![0; loops.len()];
    for (new, old) in order.iter().enumerate() {
        number[*old] = new;
    }
    let mut by_old: Vec<Option<Loop>> = loops.into_iter().map(Some).collect();
    let moved = order.into_iter().filter_map(|old| by_old[old].take());
    Ok(moved.map(|one| Loop { parent: one.parent.map(|old| number[old]), ..one }).collect())
}

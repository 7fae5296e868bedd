//! Loops, open chains and their nesting, from single curves.

use std::collections::HashMap;
use std::hash::{DefaultHasher, Hash, Hasher};

use toolpathd_core::budget::{Budget, Stopped};

use super::chains::{Chain, Part, chains};
use super::{Branch, Loop, OpenChain, bulge, nesting};
use crate::fault::{Place, Unreadable};
use crate::left_out::LeftOuts;

/// A loop bounds an area if the area is above this part of the square of its length. A slot of a length of a
/// metre that bounds less is a nanometre wide.
const LEAST_AREA: f64 = 2.5e-10;

/// A curve as lines and arcs.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    /// As [`Loop::vertices`]. At least two, and no piece is without length.
    pub vertices: Vec<[f64; 3]>,
    pub is_closed: bool,
    /// Whether its ends are points that the file has. Such an end stays where a computed one is joined to it.
    pub has_written_ends: bool,
    pub layer: usize,
    /// For what is left out.
    pub kind: String,
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

/// Joins curves to loops, and nests the loops. A curve that repeats another is left out.
///
/// # Errors
/// When the gap is larger than the distances of too many ends, or the budget ends.
pub fn assemble(
    curves: Vec<Curve>,
    layers: &[&str],
    mut left_out: LeftOuts,
    limits: Limits,
) -> Result<Assembly, Unreadable> {
    let curves = without_copies(curves, &mut left_out);
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
    for Chain { vertices, is_closed, layer, first, .. } in joined.chains {
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

/// The curves without those that repeat an earlier one exactly, in either direction.
fn without_copies(curves: Vec<Curve>, left_out: &mut LeftOuts) -> Vec<Curve> {
    let mut known: HashMap<u64, Vec<usize>> = HashMap::new();
    let mut kept: Vec<Curve> = Vec::with_capacity(curves.len());
    for curve in curves {
        let form = usual_form(&curve);
        let mut hasher = DefaultHasher::new();
        for number in form.as_flattened() {
            number.to_bits().hash(&mut hasher);
        }
        let same = known.entry(hasher.finish()).or_default();
        let is_copy = |k: &usize| {
            let other = &kept[*k];
            other.is_closed == curve.is_closed
                && other.vertices.len() == curve.vertices.len()
                && usual_form(other) == form
        };
        if same.iter().any(is_copy) {
            left_out.add(&curve.kind, "drawn twice", curve.place);
        } else {
            same.push(kept.len());
            kept.push(curve);
        }
    }
    kept
}

/// The vertices in an order that depends neither on the direction nor, for a loop, on the first vertex.
fn usual_form(curve: &Curve) -> Vec<[f64; 3]> {
    let back = bulge::reversed(&curve.vertices, curve.is_closed);
    let [ahead, back] = [curve.vertices.clone(), back].map(|mut vertices| {
        if curve.is_closed {
            let least = (0..vertices.len()).min_by(|a, b| compare(&vertices[*a], &vertices[*b]));
            vertices.rotate_left(least.unwrap_or(0));
        }
        vertices
    });
    let order = ahead.iter().zip(&back).map(|(a, b)| compare(a, b)).find(|order| order.is_ne());
    if order.is_some_and(|order| order.is_gt()) { back } else { ahead }
}

fn compare(a: &[f64; 3], b: &[f64; 3]) -> std::cmp::Ordering {
    a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])).then(a[2].total_cmp(&b[2]))
}

//! What a drawing in the plane holds: closed loops of lines and arcs, nested, with their layers.

pub mod arcs;
pub mod assembly;
pub mod bulge;
mod chains;
mod copies;
mod faces;
mod grid;
mod links;
mod nesting;

use super::left_out::LeftOut;
use super::unit::Unit;

/// A drawing that was read. Lengths are in mm.
#[derive(Debug, Clone, PartialEq)]
pub struct Drawing {
    /// The unit that the file states. Where neither the file nor the caller states one, all lengths are in
    /// the unknown unit of the file.
    pub unit: Option<Unit>,
    /// Whether the file states a unit that is not known. The caller's unit counts then.
    pub unknown_unit: bool,
    /// All layers that hold curves, in the order of their first curve, also those that were not asked for.
    pub layers: Vec<Layer>,
    /// The closed loops, those that hold others before those inside.
    pub loops: Vec<Loop>,
    /// Chains that are open within the gap.
    pub open: Vec<OpenChain>,
    /// Places where three ends of curves or more meet.
    pub branches: Vec<Branch>,
    pub left_out: Vec<LeftOut>,
    /// The largest gap that was bridged, mm.
    pub bridged_max_mm: f64,
    /// A bound for the distance of splines and ellipses from the arcs in their place, mm.
    pub deviation_max_mm: f64,
}

/// A layer with its number of curves.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Layer {
    pub name: String,
    pub n_curves: usize,
}

/// A closed loop of lines and arcs. It may cross itself or another loop: this is not examined.
#[derive(Debug, Clone, PartialEq)]
pub struct Loop {
    /// x, y and the bulge of the element to the next vertex (the tangent of a quarter of its turn, positive
    /// to the left), mm. The last vertex is joined to the first. Counterclockwise.
    pub vertices: Vec<[f64; 3]>,
    /// The layer of its first curve.
    pub layer: String,
    /// mm2.
    pub area_mm2: f64,
    pub length_mm: f64,
    /// How many loops it lies within: even for a wall, odd for an island.
    pub depth: usize,
    /// The smallest loop around it.
    pub parent: Option<usize>,
}

/// A chain of curves whose ends do not meet.
#[derive(Debug, Clone, PartialEq)]
pub struct OpenChain {
    /// As [`Loop::vertices`]; the last vertex ends the chain.
    pub vertices: Vec<[f64; 3]>,
    pub layer: String,
    /// The distance of its ends, mm.
    pub gap_mm: f64,
}

/// A place where three ends of curves or more meet, within the gap.
#[derive(Debug, Clone, PartialEq)]
pub struct Branch {
    pub at: [f64; 2],
    pub n_ends: usize,
    /// How many of the ends are joined to no other: they belong to open chains. The others are joined to the
    /// loops around the faces inside, by the even-odd rule.
    pub n_open: usize,
}

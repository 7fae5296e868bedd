//! What a drawing in the plane holds: closed loops of lines and arcs, nested, with their layers.

use super::left_out::LeftOut;
use super::unit::Unit;

/// A drawing that was read. Lengths are in mm.
#[derive(Debug, Clone, PartialEq)]
pub struct Drawing {
    /// The unit that the file states.
    pub unit: Option<Unit>,
    /// All layers that hold curves, in the order of their first curve.
    pub layers: Vec<Layer>,
    /// The closed loops, those that hold others before those inside.
    pub loops: Vec<Loop>,
    /// Chains that are open within the gap.
    pub open: Vec<OpenChain>,
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

/// A closed loop of lines and arcs.
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

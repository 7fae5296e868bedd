//! Drawings in DXF, as text or binary, of all releases.
//!
//! # What is read
//! LINE, ARC, CIRCLE, ELLIPSE, LWPOLYLINE, POLYLINE, SPLINE, and INSERT of blocks, in model space. Anything
//! else is listed with a reason, and so are entities on layers that are frozen or off. Such a layer is read
//! where the options ask for it by name.
//!
//! # Guarantees
//! * Lines and arcs keep their numbers: a vertex has the coordinates of the file. A unit other than mm, a
//!   rotation, a scale or a shift of a block round each coordinate once or twice.
//! * Ellipses, splines, and arcs that a block scales unevenly become arcs within the tolerance. The bound of
//!   their deviation is proved. A spline of fit points alone is the C2 cubic through them with the parameter
//!   of its chord lengths, and with the tangents at its ends that the file gives. Programs differ in how they
//!   draw such splines.
//! * Heights are ignored: a curve counts as drawn in the plane if its own height does not change. So are the
//!   widths of polylines, and thickness.
//! * A curve that repeats another is left out as drawn twice, on whatever layer it is, and so is a loop that
//!   repeats another within the gap.
//! * Ends of curves are joined only to ends: a curve that ends on the side of another stays open.
//! * A file that breaks off, a number that is none, an absent section, a block within itself and a layer that
//!   is asked for and holds no curve are errors.
//!
//! # Units
//! The unit is [`DxfOptions::unit`], or that of $INSUNITS where the options state none. Where neither states
//! a unit, [`Drawing::unit`] is `None`, and all lengths are in the numbers of the file.
//!
//! # Cost
//! O(n log n) for n curves that are not splines.

mod blocks;
mod curves;
mod entity;
mod fields;
mod file;
mod groups;
mod names;
mod placement;
mod polyline;
mod reasons;
mod shape;
mod spline;

use toolpathd_core::budget::Budget;

use crate::drawing::assembly::{Limits, assemble};
use crate::drawing::{Drawing, Layer};
use crate::fault::{Place, Unreadable};
use crate::unit::Unit;
use curves::Drafting;

/// Why entities on other layers than those that are asked for are left out.
pub use reasons::NOT_ASKED;

/// How a drawing is read.
#[derive(Debug, Clone, PartialEq)]
pub struct DxfOptions {
    /// The layers that are read, without regard to capital letters; `None` for all.
    pub layers: Option<Vec<String>>,
    /// Ends of curves up to this distance apart are joined, mm; zero joins ends that differ by rounding only.
    pub gap_mm: f64,
    /// How far arcs may lie from the splines and ellipses in whose place they are, mm.
    pub tolerance_mm: f64,
    /// The unit, in place of the one that the file states.
    pub unit: Option<Unit>,
    /// The most curves, and the most vertices of all curves.
    pub curve_limit: usize,
    pub vertex_limit: usize,
}

impl Default for DxfOptions {
    /// All layers, gaps up to 0.01 mm, and a tolerance of 0.001 mm.
    fn default() -> Self {
        Self {
            layers: None,
            gap_mm: 0.01,
            tolerance_mm: 0.001,
            unit: None,
            curve_limit: 200_000,
            vertex_limit: 2_000_000,
        }
    }
}

/// Reads a drawing.
///
/// # Errors
/// When the file breaks the format, has more than the limits allow, or has no curve on a layer that is asked
/// for; when it states a unit that is not known, and the options state none; and when the budget ends.
pub fn read(bytes: &[u8], options: &DxfOptions, budget: &Budget) -> Result<Drawing, Unreadable> {
    if !(options.tolerance_mm > 0.0 && options.gap_mm >= 0.0) {
        let detail = format!(
            "a gap of {} mm and a tolerance of {} mm are no limits; the gap has to be zero or more, and the tolerance above zero",
            options.gap_mm, options.tolerance_mm
        );
        return Err(Unreadable::at(Place::File, detail));
    }
    let file = file::read(bytes, options.curve_limit.saturating_mul(blocks::ENTITIES_A_CURVE), budget)?;
    let (stated, unknown_unit) = match file.unit.map(file::unit).transpose() {
        Ok(stated) => (stated.flatten(), false),
        Err(_) if options.unit.is_some() => (None, true),
        Err(fault) => return Err(fault),
    };
    let drafting =
        Drafting { tolerance_mm: options.tolerance_mm, vertex_limit: options.vertex_limit, budget };
    let scale = options.unit.or(stated).map_or(1.0, Unit::mm);
    let drawn = blocks::draw(file, options, scale, &drafting)?;
    let names: Vec<&str> = drawn.layers.iter().map(|layer| layer.name.as_str()).collect();
    check_layers(&drawn.layers, options)?;
    let limits = Limits { gap_mm: options.gap_mm, budget };
    let assembly = assemble(drawn.curves, &names, drawn.left_out, limits)?;
    Ok(Drawing {
        unit: stated,
        unknown_unit,
        loops: assembly.loops,
        open: assembly.open,
        branches: assembly.branches,
        left_out: assembly.left_out.list(),
        bridged_max_mm: assembly.bridged_max_mm,
        deviation_max_mm: drawn.deviation_max_mm,
        layers: drawn.layers,
    })
}

/// Refuses a layer that is asked for and holds no curve: its name is most likely misspelt.
fn check_layers(layers: &[Layer], options: &DxfOptions) -> Result<(), Unreadable> {
    for asked in options.layers.iter().flatten() {
        if !layers.iter().any(|layer| names::key(&layer.name) == names::key(asked)) {
            let mut held: Vec<String> =
                layers.iter().take(20).map(|layer| format!("\"{}\"", layer.name)).collect();
            if layers.len() > held.len() {
                held.push("others".to_owned());
            }
            let held = if held.is_empty() { "no layer".to_owned() } else { held.join(", ") };
            let detail = format!("no curve is on the layer \"{asked}\"; curves are on {held}");
            return Err(Unreadable::at(Place::File, detail));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests;

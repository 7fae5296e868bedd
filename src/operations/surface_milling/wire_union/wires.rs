//! The wire model: sections at a pitch.

use nalgebra::Vector3;

use super::super::Error;
use crate::budget::Budget;
use crate::geometry::surface::{BezierSurface, Patch};
use crate::machining::offset_section::INSET_MM;
use crate::machining::upper_envelope::{Accuracy, Profiles, Segment};

/// How exactly the extent of the surface is known, mm: less than what its outermost wires are inside.
const EXTENT_ACCURACY_MM: f64 = 1e-7;

/// Where an edge is not straight, the outermost plane would touch the surface in a point; it lies this far
/// inside instead, mm.
const TOUCH_MM: f64 = 5e-3;

/// An edge is straight where the section next to it has this part of the width of that a little inside.
const STRAIGHT_SHARE: f64 = 0.9;

/// Stretches of one model; some hundred megabytes.
const STRETCH_LIMIT: usize = 4_000_000;

/// A section of the surface with a plane of constant y.
pub(super) struct Wire {
    /// The y of the plane, mm.
    pub(super) at: f64,
    pub(super) stretches: Vec<Segment>,
}

/// Wires at equal distances, by growing y.
pub(super) struct WireModel {
    pub(super) pitch_mm: f64,
    pub(super) wires: Vec<Wire>,
}

impl WireModel {
    /// Wires at most `pitch_mm` apart, the first and the last on the extent of the surface.
    pub(super) fn new(
        surface: &BezierSurface<impl Patch>,
        pitch_mm: f64,
        limit: usize,
        accuracy: Accuracy,
        budget: &Budget,
    ) -> Result<Self, Error> {
        let profiles = Profiles::new(surface);
        let low = -surface.farthest_along(&-Vector3::y(), EXTENT_ACCURACY_MM, budget)?;
        let high = surface.farthest_along(&Vector3::y(), EXTENT_ACCURACY_MM, budget)?;
        let width = high - low;
        // One part in 1e9 keeps 80 mm at 2 mm from becoming 41 spaces.
        let spaces = (width / pitch_mm - 1e-9).ceil().max(1.0);
        if spaces >= limit as f64 {
            let needed = (spaces as usize).saturating_add(1);
            return Err(Error::TooMuchWork { what: "wires", needed, limit });
        }
        let outermost =
            |extent: f64, inward: f64| outermost(&profiles, extent, inward, width, accuracy, budget);
        let (first, last) = (outermost(low, 1.0)?, outermost(high, -1.0)?);
        let (from, to, n) = (first.at, last.at, spaces as usize);
        let mut wires = vec![first];
        let mut n_stretches = wires[0].stretches.len() + last.stretches.len();
        for k in 1..n {
            budget.progress("sections", k, n);
            let at = from + (to - from) * (k as f64 / n as f64);
            let stretches = profiles.stretches(at, accuracy, budget)?;
            n_stretches += stretches.len();
            if n_stretches > STRETCH_LIMIT {
                let what = "points of wires";
                return Err(Error::TooMuchWork { what, needed: n_stretches, limit: STRETCH_LIMIT });
            }
            wires.push(Wire { at, stretches });
        }
        wires.push(last);
        Ok(Self { pitch_mm: (to - from) / n as f64, wires })
    }
}

/// The outermost wire at `extent` mm, from which `inward` (1 or -1) leads into the part: on the extent itself
/// along a straight edge, else as far inside as [`TOUCH_MM`].
fn outermost<P: Patch>(
    profiles: &Profiles<P>,
    extent: f64,
    inward: f64,
    width: f64,
    accuracy: Accuracy,
    budget: &Budget,
) -> Result<Wire, Error> {
    let wide =
        |stretches: &[Segment]| stretches.iter().map(|stretch| stretch.to.x - stretch.from.x).sum::<f64>();
    let on_edge = profiles.stretches(extent + inward * INSET_MM.min(1e-3 * width), accuracy, budget)?;
    let at = extent + inward * TOUCH_MM.min(1e-3 * width);
    let inside = profiles.stretches(at, accuracy, budget)?;
    if wide(&on_edge) >= STRAIGHT_SHARE * wide(&inside) {
        Ok(Wire { at: extent, stretches: on_edge })
    } else {
        Ok(Wire { at, stretches: inside })
    }
}

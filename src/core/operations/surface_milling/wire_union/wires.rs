//! The wires of a surface: its sections with planes of constant y at equal distances.

use nalgebra::Vector3;

use super::super::Error;
use crate::budget::Budget;
use crate::geometry::spacing::spaces;
use crate::geometry::surface::{BezierSurface, Patch};
use crate::machining::offset_section::{INSET_MM, INSET_PART};
use crate::machining::upper_envelope::{Accuracy, Profiles, Stretch};

/// The accuracy of the extent of the surface, mm: finer than [`INSET_MM`], by which the outermost wires are
/// traced inside it.
const EXTENT_ACCURACY_MM: f64 = 1e-7;

/// How far inside the extent the outermost wire lies at an edge that is not straight, mm. On the extent its
/// plane would touch the surface in one point.
const TOUCH_MM: f64 = 5e-3;

/// An edge counts as straight if the section next to it has at least this share of the width of the section
/// [`TOUCH_MM`] inside.
const STRAIGHT_SHARE: f64 = 0.9;

/// The most stretches of one model: some hundred megabytes of memory.
const STRETCH_LIMIT: usize = 4_000_000;

/// A section of the surface with a plane of constant y.
pub(super) struct Wire {
    /// The y of the plane, mm.
    pub(super) at: f64,
    pub(super) stretches: Vec<Stretch>,
}

/// Wires at equal distances, in order of y.
pub(super) struct WireModel {
    pub(super) pitch_mm: f64,
    pub(super) wires: Vec<Wire>,
}

impl WireModel {
    /// The wires of a surface, at most `pitch_mm` apart; the first and the last lie on its extent.
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
        let spaces = spaces(width, pitch_mm);
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

/// The outermost wire at `extent` mm; `inward` (1 or -1) points into the part. Along a straight edge the wire
/// lies on the extent, else [`TOUCH_MM`] inside.
fn outermost<P: Patch>(
    profiles: &Profiles<P>,
    extent: f64,
    inward: f64,
    width: f64,
    accuracy: Accuracy,
    budget: &Budget,
) -> Result<Wire, Error> {
    let wide =
        |stretches: &[Stretch]| stretches.iter().map(|stretch| stretch.to.x - stretch.from.x).sum::<f64>();
    let on_edge = profiles.stretches(extent + inward * INSET_MM.min(INSET_PART * width), accuracy, budget)?;
    let at = extent + inward * TOUCH_MM.min(INSET_PART * width);
    let inside = profiles.stretches(at, accuracy, budget)?;
    if wide(&on_edge) >= STRAIGHT_SHARE * wide(&inside) {
        Ok(Wire { at: extent, stretches: on_edge })
    } else {
        Ok(Wire { at, stretches: inside })
    }
}

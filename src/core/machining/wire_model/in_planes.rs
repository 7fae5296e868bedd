//! Wires along x or y: sections of a surface with planes at equal distances.
//!
//! # Method
//! 1. The planes lie at equal distances from the least to the largest coordinate of the surface. Each is
//!    traced beside its place, by [`NUDGE_MM`], so that it contains no joint of patches and no wall. The
//!    outermost planes, which would only touch the surface, are traced inside by [`INSET_MM`].
//! 2. The section is made of stretches that are straight within a share of the chord height (`section`).
//! 3. Stretches become chains. Points that the rest of the chord height allows to leave out are left out, but
//!    none on an edge of the surface (`chain`).
//!
//! # Guarantees
//! Between two neighbouring points, the section leaves their chord by at most the chord height.

use nalgebra::{Point3, Vector3};

use super::part::Plane;
use super::{Wire, WireError, WireJob, chain, count, section};
use crate::budget::Budget;
use crate::geometry::surface::{BezierSurface, Patch};

/// How far beside its place a plane is traced, mm. It is far above rounding, and its points are moved back
/// along the surface; a larger value would show where the surface bends.
const NUDGE_MM: f64 = 1e-9;

/// The nudge as a part of the largest coordinate, where that is more: a thousand units of rounding.
const NUDGE_PART: f64 = 1e-13;

/// How far inside the extent of the surface an outermost plane is traced, mm. A plane on the extent would
/// touch the surface. An extent that is not exact, or a place where the surface is level, needs more; it is
/// tried in steps of a factor of ten, up to [`INSET_PART`] of the extent.
const INSET_MM: f64 = 1e-6;

/// The largest inset of an outermost plane, as a part of the extent.
const INSET_PART: f64 = 1e-3;

/// The accuracy of the extent, mm: finer than the inset.
const EXTENT_ACCURACY_MM: f64 = 1e-8;

/// The share of the chord height that stretches may take. The rest is used to leave out points.
const STRETCH_SHARE: f64 = 0.25;

/// The share of the chord height that is used to leave out points. What remains is far above rounding.
const THINNING_SHARE: f64 = 0.74;

/// The wires at right angles to `axis` (0 is x, 1 is y), all in the direction of the growing coordinate.
pub(super) fn wires(
    surface: &BezierSurface<impl Patch>,
    axis: usize,
    job: &WireJob,
    budget: &Budget,
) -> Result<Vec<Wire>, WireError> {
    let unit = Vector3::ith(axis, 1.0);
    let high = surface.farthest_along(&unit, EXTENT_ACCURACY_MM, budget)?;
    let low = -surface.farthest_along(&-unit, EXTENT_ACCURACY_MM, budget)?;
    let width = high - low;
    let n = count(width, job)?;
    let mut sweep = Sweep::new(surface, axis);
    let nudge = NUDGE_MM.max(NUDGE_PART * low.abs().max(high.abs()));
    let mut wires = Vec::new();
    let mut points = 0;
    for k in 0..=n {
        let at = low + width * (k as f64 / n.max(1) as f64);
        let mut inset = INSET_MM.min(INSET_PART * width);
        let found = loop {
            let traced_at = match k {
                0 => low + inset,
                _ if k == n => high - inset,
                _ => at - nudge,
            };
            let found = sweep.wires(traced_at, at - traced_at, job.chord_height_mm, budget)?;
            let is_inner = k > 0 && k < n;
            inset *= 10.0;
            if is_inner || !found.is_empty() || inset >= INSET_PART * width {
                break found;
            }
        };
        points += found.iter().map(Vec::len).sum::<usize>();
        if points > job.point_limit {
            return Err(WireError::TooManyPoints { limit: job.point_limit });
        }
        wires.extend(found);
    }
    // Such a surface lies in one of the planes.
    let at = Point3::from(surface.patch(0, 0).center());
    if wires.is_empty() { Err(WireError::SectionLost { at }) } else { Ok(wires) }
}

/// Planes that sweep over a surface.
struct Sweep<'a, P> {
    surface: &'a BezierSurface<P>,
    axis: usize,
    /// The indices of the patches with their least and their largest coordinate, mm, by the least.
    waiting: Vec<(usize, [f64; 2])>,
}

impl<'a, P: Patch> Sweep<'a, P> {
    fn new(surface: &'a BezierSurface<P>, axis: usize) -> Self {
        let range = |patch: &P| {
            let bounds = patch.bounds();
            [bounds.min[axis], bounds.max[axis]]
        };
        let mut waiting: Vec<_> = surface.patches().iter().map(range).enumerate().collect();
        waiting.sort_by(|a, b| a.1[0].total_cmp(&b.1[0]));
        Self { surface, axis, waiting }
    }

    /// The wires of the plane at `at` mm, moved along the surface by `shift_mm` along the axis.
    fn wires(
        &mut self,
        at: f64,
        shift_mm: f64,
        chord_height_mm: f64,
        budget: &Budget,
    ) -> Result<Vec<Wire>, WireError> {
        budget.check()?;
        let begun = self.waiting.partition_point(|(_, [low, _])| *low <= at);
        let met = self.waiting[..begun].iter().filter(|(_, [_, high])| *high >= at);
        let mut met: Vec<usize> = met.map(|(k, _)| *k).collect();
        met.sort_unstable();
        let plane = Plane { axis: self.axis, at, accuracy_mm: STRETCH_SHARE * chord_height_mm };
        let section = section::section(self.surface, &met, &plane, budget)?;
        let mut wires = chain::wires(&section, self.axis, shift_mm, THINNING_SHARE * chord_height_mm);
        for wire in &mut wires {
            for point in wire.iter_mut() {
                point[self.axis] = at + shift_mm;
            }
            if key(wire, self.axis) > key_of(&wire[wire.len() - 1], self.axis) {
                wire.reverse();
            }
        }
        wires.sort_by(|a, b| {
            let [a, b] = [a, b].map(|wire| key(wire, self.axis));
            a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1]))
        });
        Ok(wires)
    }
}

fn key(wire: &Wire, axis: usize) -> [f64; 2] {
    key_of(&wire[0], axis)
}

/// The coordinate along the wire, then the height.
fn key_of(point: &Point3<f64>, axis: usize) -> [f64; 2] {
    [point[1 - axis], point.z]
}

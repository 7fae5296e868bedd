//! Finds positions of the axis at which the cutter is tangent to the surface at a point of one of the four
//! sides of the surface. Sections begin and end at such positions.

use nalgebra::Vector2;

use super::{Contacts, LEVEL_SLOPE};
use crate::budget::{Budget, Stopped};
use crate::geometry::solve::largest_place;
use crate::geometry::surface::Surface;
use crate::geometry::surface::patch::Patch;

/// Samples of the positions along a side of a patch. A turn back and forth between two samples is not seen.
const SAMPLES: usize = 24;

/// The z coordinate of the unit normal below which a surface counts as upright.
const UPRIGHT: f64 = 1e-9;

/// Positions of the axis in plan along each of the four sides, in order; `None` where the surface has no
/// normal.
pub(super) struct Sides {
    positions: Vec<Vec<Option<Vector2<f64>>>>,
}

impl Sides {
    /// Samples the positions, with those among them that are farthest each way along `axis`.
    pub(super) fn new<P: Patch>(
        contacts: &Contacts<P>,
        axis: usize,
        budget: &Budget,
    ) -> Result<Self, Stopped> {
        let [nu, nv] = contacts.surface.spans();
        let sides = [(0, 0.0), (0, nv as f64), (1, 0.0), (1, nu as f64)];
        let mut positions = Vec::new();
        // `free` is the parameter along the side, `fixed` the value of the other parameter.
        for (free, fixed) in sides {
            budget.check()?;
            let place = |t: f64| if free == 0 { [t, fixed] } else { [fixed, t] };
            positions.push(along([nu, nv][free], |t| position(contacts, place(t)), axis));
        }
        Ok(Self { positions })
    }

    /// All positions.
    pub(super) fn positions(&self) -> impl Iterator<Item = &Vector2<f64>> {
        self.positions.iter().flatten().flatten()
    }

    /// Where the line at the coordinate `at` along `axis` meets the sides: the other coordinates, rising.
    pub(super) fn crossings(&self, axis: usize, at: f64) -> Vec<f64> {
        let mut crossings = Vec::new();
        for pair in self.positions.iter().flat_map(|side| side.windows(2)) {
            let &[Some(from), Some(to)] = pair else { continue };
            let (before, after) = (from[axis] - at, to[axis] - at);
            if (before < 0.0) != (after < 0.0) {
                let share = before / (before - after);
                crossings.push(from[1 - axis] + share * (to[1 - axis] - from[1 - axis]));
            }
        }
        crossings.sort_by(f64::total_cmp);
        crossings
    }
}

/// Positions along a side of `n` patches. Added to the samples are positions that are farther along `axis`
/// than both neighbours.
fn along(n: usize, position: impl Fn(f64) -> Option<Vector2<f64>>, axis: usize) -> Vec<Option<Vector2<f64>>> {
    let step = 1.0 / SAMPLES as f64;
    let even: Vec<_> = (0..=n * SAMPLES).map(|k| position(k as f64 * step)).collect();
    let mut positions = vec![even[0]];
    for k in 1..even.len() {
        // The positions may turn back within this interval, near one of its ends: the sample beyond that end
        // shows it.
        for (near, far, beyond) in [(k - 1, k, k.checked_sub(2)), (k, k - 1, Some(k + 1))] {
            let beyond = beyond.and_then(|beyond| even.get(beyond).copied().flatten());
            let (Some(near), Some(far), Some(beyond)) = (even[near], even[far], beyond) else { continue };
            let sense = near[axis] - far[axis];
            if sense * (near[axis] - beyond[axis]) > 0.0 {
                let value = |t: f64| position(t).map_or(f64::NEG_INFINITY, |p| sense.signum() * p[axis]);
                positions.push(position(largest_place([(k - 1) as f64 * step, k as f64 * step], value)));
            }
        }
        positions.push(even[k]);
    }
    positions
}

/// The position of the axis while the cutter touches the tangent plane at a place; `None` where the surface
/// has no normal.
pub(super) fn position<P: Patch>(contacts: &Contacts<P>, [u, v]: [f64; 2]) -> Option<Vector2<f64>> {
    let jet = contacts.surface.jet(u, v);
    let gradient = jet.gradient();
    let normal = jet.normal().normalize();
    let offset = if normal.z.abs() < UPRIGHT {
        -normal.xy().normalize() * contacts.cutter.radius()
    } else if gradient.norm() > LEVEL_SLOPE || contacts.cutter.flat_radius() == 0.0 {
        contacts.cutter.tangent_point(gradient).place
    } else {
        Vector2::zeros()
    };
    let at = jet.point.coords.xy() - offset;
    (at.x.is_finite() && at.y.is_finite()).then_some(at)
}

//! Checks whether neighbouring patches meet along their common sides, and whether they have the same normals
//! there. The two sides of a seam, at which a closed surface joins itself, count as a common side.
//!
//! Points and normals of both patches are compared at `PLACES` places along each common side. The surface is
//! refused if two points are farther apart than [`GAP_LIMIT_MM`], or two normals differ by a larger angle
//! than [`KINK_LIMIT`]. Smaller differences count as rounding of the data. The result is twice the largest
//! distance found and twice the largest angle found: the factor of two covers what lies between the places.

use nalgebra::Point3;

use super::topology::{CLOSED_MM, KINK_LIMIT, Topology};
use super::{BezierSurface, Patch, Surface};
use crate::budget::{Budget, Stopped};

/// Places along one side. The differences of points and normals along a side are quotients of polynomials of
/// degree 40 at most, for patches of degree 7. So a difference that is zero at all these places is zero
/// everywhere on the side.
const PLACES: usize = 48;

/// Patches that are farther apart than this do not join, mm. A smaller distance counts as rounding of the
/// data and becomes part of [`Joints::gap_mm`].
pub const GAP_LIMIT_MM: f64 = 1e-5;

/// A normal shorter than this, relative to the product of the lengths of the patch along u and v, is
/// rounding: the side shrinks to a point there.
const NO_NORMAL: f64 = 1e-9;

/// How precisely the patches of a surface join.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Joints {
    /// The largest distance between points of two neighbours that should coincide, mm.
    pub gap_mm: f64,
    /// The largest angle between normals of two neighbours that should coincide, radians.
    pub kink: f64,
}

impl Joints {
    /// How far the offset of the surface by `radius` mm may jump at a joint, mm.
    pub fn jump(&self, radius: f64) -> f64 {
        self.gap_mm + radius * self.kink
    }

    /// Doubles both figures: between this many places a polynomial of these degrees rises to at most twice
    /// its value at the places.
    fn with_what_lies_between(self) -> Self {
        Self { gap_mm: 2.0 * self.gap_mm, kink: 2.0 * self.kink }
    }
}

/// The fault where two patches do not join smoothly.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum NotSmooth {
    #[error(transparent)]
    Stopped(#[from] Stopped),
    #[error("patches [{}][{}] and [{}][{}] are {gap_mm} mm apart near {at}", .patches[0][0], .patches[0][1], .patches[1][0], .patches[1][1])]
    Gap { at: Point3<f64>, gap_mm: f64, patches: [[usize; 2]; 2] },
    #[error("the surface has a sharp edge of {angle_deg} degrees near {at}")]
    Edge { at: Point3<f64>, angle_deg: f64 },
}

/// How the patches join across `joints`, and across the seams of a closed surface. Each joint is given by the
/// number of patches before it, along u and along v.
///
/// # Errors
/// The first joint where the patches do not meet or make an edge, or the budget's stop.
pub fn examine(
    surface: &BezierSurface<impl Patch>,
    joints: &[Vec<usize>; 2],
    budget: &Budget,
) -> Result<Joints, NotSmooth> {
    let [nu, nv] = surface.spans();
    let mut found = Joints::default();
    for &i in &joints[0] {
        budget.check()?;
        for j in 0..nv {
            let at = |t: f64| ([i - 1, j], [1.0, t], [i, j], [0.0, t]);
            found = found.with_side(surface, at, GAP_LIMIT_MM)?;
        }
    }
    for &j in &joints[1] {
        budget.check()?;
        for i in 0..nu {
            let at = |t: f64| ([i, j - 1], [t, 1.0], [i, j], [t, 0.0]);
            found = found.with_side(surface, at, GAP_LIMIT_MM)?;
        }
    }
    let topology = Topology::of(surface);
    for j in (0..nv).filter(|_| topology.is_closed(0)) {
        let at = |t: f64| ([nu - 1, j], [1.0, t], [0, j], [0.0, t]);
        found = found.with_side(surface, at, CLOSED_MM)?;
    }
    for i in (0..nu).filter(|_| topology.is_closed(1)) {
        let at = |t: f64| ([i, nv - 1], [t, 1.0], [i, 0], [t, 0.0]);
        found = found.with_side(surface, at, CLOSED_MM)?;
    }
    Ok(found.with_what_lies_between())
}

/// A patch and a place on it, and the neighbour with the same place.
type Side = ([usize; 2], [f64; 2], [usize; 2], [f64; 2]);

impl Joints {
    fn with_side(
        mut self,
        surface: &BezierSurface<impl Patch>,
        side: impl Fn(f64) -> Side,
        gap_limit: f64,
    ) -> Result<Self, NotSmooth> {
        for k in 0..PLACES {
            let (patch, place, neighbour, same) = side(k as f64 / (PLACES - 1) as f64);
            let jet = |[i, j]: [usize; 2], [u, v]: [f64; 2]| surface.patch(i, j).jet(u, v);
            let (one, other) = (jet(patch, place), jet(neighbour, same));
            let gap_mm = (one.point - other.point).norm();
            if gap_mm > gap_limit {
                return Err(NotSmooth::Gap { at: one.point, gap_mm, patches: [patch, neighbour] });
            }
            self.gap_mm = self.gap_mm.max(gap_mm);
            // A point without a normal has no angle. The proof that normals point up reports such points.
            let (one_normal, other_normal) = (one.normal(), other.normal());
            let [along_u, along_v] = surface.patch(patch[0], patch[1]).extents();
            let least = NO_NORMAL * along_u * along_v;
            if one_normal.norm() > least && other_normal.norm() > least {
                // The arc cosine of the dot product loses small angles in rounding; atan2 does not.
                let angle = one_normal.cross(&other_normal).norm().atan2(one_normal.dot(&other_normal));
                if angle > KINK_LIMIT {
                    return Err(NotSmooth::Edge { at: one.point, angle_deg: angle.to_degrees() });
                }
                self.kink = self.kink.max(angle);
            }
        }
        Ok(self)
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;

    use super::*;
    use crate::geometry::surface::BicubicPatch;

    /// Two squares of 3 mm side by side along x, the second rising by `slope`.
    fn roof(slope: f64, lifted: f64) -> BezierSurface {
        BezierSurface::from_fn([2, 1], |i, _| BicubicPatch {
            net: std::array::from_fn(|a| {
                let x = a as f64;
                let z = if i == 0 { 0.0 } else { lifted + slope * x };
                std::array::from_fn(|b| Vector3::new(3.0 * i as f64 + x, b as f64, z))
            }),
        })
    }

    #[test]
    fn edges_and_gaps_are_found_with_their_size() {
        let examine = |surface| super::examine(&surface, &[vec![1], vec![]], &Budget::unlimited());
        assert_eq!(examine(roof(0.0, 0.0)), Ok(Joints::default()));
        let kink = examine(roof(1e-4, 0.0)).unwrap().kink;
        assert!((kink - 2e-4).abs() < 1e-9, "{kink}");
        let Err(NotSmooth::Edge { at, angle_deg }) = examine(roof(1.0, 0.0)) else { panic!("no edge") };
        assert!((angle_deg - 45.0).abs() < 1e-9 && at.x == 3.0, "{angle_deg} {at}");
        let Err(NotSmooth::Gap { gap_mm, patches, .. }) = examine(roof(0.0, 0.5)) else { panic!("no gap") };
        assert!((gap_mm - 0.5).abs() < 1e-12, "{gap_mm}");
        assert_eq!(patches, [[0, 0], [1, 0]]);
        assert!((examine(roof(0.0, 1e-6)).unwrap().gap_mm - 2e-6).abs() < 1e-12);
    }
}

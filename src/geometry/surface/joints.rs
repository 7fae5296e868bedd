//! Whether neighbouring patches meet, and share their tangent planes, along their common sides.
//!
//! # Method
//! At a number of places of a common side the points and the normals of both patches are compared. Along the
//! side both differences are quotients of polynomials, of degree 40 at most for patches of degree 7, so they
//! vanish everywhere if they do at these places.
//!
//! # Cost
//! O(sides looked at).

use nalgebra::Point3;

use super::{BezierSurface, Patch, Surface};
use crate::budget::{Budget, Stopped};

/// Places along one side: more than the degree of what is to vanish there.
const PLACES: usize = 48;

/// Patches farther apart than this do not join, mm. What is less is a rounding of the data, and is counted.
pub const GAP_LIMIT_MM: f64 = 1e-5;

/// Normals that differ by more than this make an edge, radians: a few hundredths of a degree. What is less is
/// a rounding of the data, and is counted.
pub const KINK_LIMIT: f64 = 1e-3;

/// A normal shorter than this part of what the size of the patch suggests is rounding: the side is a point
/// there.
const NO_NORMAL: f64 = 1e-9;

/// How exactly the patches of a surface join.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Joints {
    /// The largest distance of points that should be one, mm.
    pub gap_mm: f64,
    /// The largest angle between normals that should be one, radians.
    pub kink: f64,
}

impl Joints {
    /// The offset of the surface by `radius` mm may jump by this at a joint, mm.
    pub fn jump(&self, radius: f64) -> f64 {
        self.gap_mm + radius * self.kink
    }

    /// With twice what was seen: between so many places a polynomial of these degrees rises no farther.
    fn with_what_lies_between(self) -> Self {
        Self { gap_mm: 2.0 * self.gap_mm, kink: 2.0 * self.kink }
    }
}

/// Where patches do not join smoothly.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum NotSmooth {
    #[error(transparent)]
    Stopped(#[from] Stopped),
    #[error("patches [{}][{}] and [{}][{}] are {gap_mm} mm apart near {at}", .patches[0][0], .patches[0][1], .patches[1][0], .patches[1][1])]
    Gap { at: Point3<f64>, gap_mm: f64, patches: [[usize; 2]; 2] },
    #[error("the surface has a sharp edge of {angle_deg} degrees near {at}")]
    Edge { at: Point3<f64>, angle_deg: f64 },
}

/// How the patches join across `joints`, numbers of patches before the joint along u and along v.
///
/// # Errors
/// The first joint that is none, or the budget's stop.
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
            found = found.with_side(surface, at)?;
        }
    }
    for &j in &joints[1] {
        budget.check()?;
        for i in 0..nu {
            let at = |t: f64| ([i, j - 1], [t, 1.0], [i, j], [t, 0.0]);
            found = found.with_side(surface, at)?;
        }
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
    ) -> Result<Self, NotSmooth> {
        for k in 0..PLACES {
            let (patch, place, neighbour, same) = side(k as f64 / (PLACES - 1) as f64);
            let jet = |[i, j]: [usize; 2], [u, v]: [f64; 2]| surface.patch(i, j).jet(u, v);
            let (one, other) = (jet(patch, place), jet(neighbour, same));
            let gap_mm = (one.point - other.point).norm();
            if gap_mm > GAP_LIMIT_MM {
                return Err(NotSmooth::Gap { at: one.point, gap_mm, patches: [patch, neighbour] });
            }
            self.gap_mm = self.gap_mm.max(gap_mm);
            // Where there is no normal, there is no angle; the proof of an upward normal says so.
            let (one_normal, other_normal) = (one.normal(), other.normal());
            let [along_u, along_v] = surface.patch(patch[0], patch[1]).extents();
            let least = NO_NORMAL * along_u * along_v;
            if one_normal.norm() > least && other_normal.norm() > least {
                // An arc cosine could not tell small angles from rounding.
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

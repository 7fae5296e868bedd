//! Principal curvatures of a surface: the larger curvature at a point, bounds of both curvatures over a part
//! of a patch, and an upper bound of the larger curvature over the whole surface.
//!
//! # Method
//! 1. For each first and second derivative, a ball of vectors ([`VectorBall`]) contains all values of the
//!    derivative over a part. The centres of the balls give two curvatures. The radii of the balls tell how
//!    far any curvature of the part can lie outside these two.
//! 2. For the whole surface, each patch gets an upper bound of its larger curvature. The patch or part with
//!    the largest upper bound is halved, and its halves get bounds of their own (branch and bound). This is
//!    repeated until the largest upper bound is near the largest curvature found at a point.
//!
//! # Guarantees
//! A curvature is positive where the surface is concave, seen from the side to which its normal points.
//! Bounds hold for every point of the part or surface. The number of halvings is limited; if the limit is
//! reached, the bound of the whole surface still holds, but is less tight.
//!
//! # Degenerate input
//! A part or a surface that contains a point without a normal has no bound.

use super::patch::{Bounds, DerivativeBounds};
use super::vector_ball::VectorBall;
use super::{BezierSurface, Jet, Patch};
use crate::budget::{Budget, Stopped};
use crate::geometry::best_first::BestFirst;

/// Most halvings in the search for the most concave place. When they run out, the bound is correct but less
/// tight.
const HALVINGS: usize = 50_000;

/// The search stops when the bound exceeds the largest curvature found by at most this part of that
/// curvature, plus [`GAP_FLAT`].
const GAP_SHARE: f64 = 0.01;

/// Most subparts of one part that the search examines for a bound. A part that needs more counts as a part
/// with a point without a normal.
const UNBOUNDED_LIMIT: usize = 20_000;

/// A part smaller than this, relative to the size of the surface, counts as a point.
const NO_SIZE: f64 = 1e-6;

/// The gap at which the search may stop, as a part of 1 / (size of the surface). A surface that is nowhere
/// concave has a largest curvature near zero, so [`GAP_SHARE`] of it is too small a gap.
const GAP_FLAT: f64 = 1e-3;

/// Rounding of the first fundamental form at the centre, which is the identity: some 40 units.
const FORM_ROUNDING: f64 = 1e-14;

/// Bounds of both principal curvatures over a part, 1/mm: below the smaller and above the larger one. `None`
/// where the balls of the derivatives are too wide for bounds.
pub fn bounds(derivatives: &DerivativeBounds) -> Option<[f64; 2]> {
    let DerivativeBounds { du, dv, duu, duv, dvv } = *derivatives;
    let cross = derivatives.normal();
    let length = cross.center.norm();
    if cross.radius >= length {
        return None;
    }
    // Sa = p Su and Sb = q Su + s Sv are orthonormal at the centre.
    let p = 1.0 / du.center.norm();
    let along = du.center * p;
    let shear = dv.center.dot(&along);
    let s = 1.0 / (dv.center - along * shear).norm();
    let q = -shear * s * p;
    let da = du.scaled(p);
    let db = du.scaled(q).plus(dv.scaled(s));
    let daa = duu.scaled(p * p);
    let dab = duu.scaled(p * q).plus(duv.scaled(p * s));
    let dbb = duu.scaled(q * q).plus(duv.scaled(2.0 * q * s)).plus(dvv.scaled(s * s));

    // First fundamental form: the identity, with an error of at most this in each entry.
    let stretch = da.radius.max(db.radius);
    let form_error = 2.0 * (2.0 * stretch + stretch * stretch + FORM_ROUNDING);
    if form_error.is_nan() || form_error >= 0.5 {
        return None;
    }
    // Every unit normal is within `tilt` of the one at the centre: |n - n0| <= sqrt(2) sin(angle) for angles
    // below 90 degrees.
    let normal = cross.center / length;
    let tilt = std::f64::consts::SQRT_2 * cross.radius / length;
    let second = |d: VectorBall| (normal.dot(&d.center), d.radius + tilt * d.reach());
    let ((laa, eaa), (lab, eab), (lbb, ebb)) = (second(daa), second(dab), second(dbb));
    // The larger eigenvalue grows with both diagonal entries and with the absolute value of the other entry.
    let high = larger_eigenvalue(laa + eaa, lbb + ebb, lab.abs() + eab);
    let low = -larger_eigenvalue(eaa - laa, ebb - lbb, lab.abs() + eab);
    Some([-widened(-low, form_error), widened(high, form_error)])
}

/// The larger eigenvalue of the symmetric matrix with the diagonal (a, b) and `other` beside it.
fn larger_eigenvalue(a: f64, b: f64, other: f64) -> f64 {
    0.5 * (a + b) + (0.5 * (a - b)).hypot(other)
}

/// The largest value of (value) / (1 +- error).
fn widened(value: f64, error: f64) -> f64 {
    if value > 0.0 { value / (1.0 - error) } else { value / (1.0 + error) }
}

/// The larger principal curvature at a point, 1/mm; NaN where the surface has no normal.
pub fn most_concave_at(jet: &Jet) -> f64 {
    let normal = jet.normal().normalize();
    let (e, f, g) = (jet.du.norm_squared(), jet.du.dot(&jet.dv), jet.dv.norm_squared());
    let (l, m, n) = (normal.dot(&jet.duu), normal.dot(&jet.duv), normal.dot(&jet.dvv));
    let det = e * g - f * f;
    let mean = 0.5 * (e * n - 2.0 * f * m + g * l) / det;
    let gauss = (l * n - m * m) / det;
    mean + (mean * mean - gauss).max(0.0).sqrt()
}

/// A proved upper bound of the larger principal curvature over all of `surface`, 1/mm; negative where the
/// surface is convex everywhere. It exceeds the largest curvature by at most a hundredth of that curvature
/// plus a thousandth of 1 / (size of the surface), unless the search runs out of halvings. `None` where the
/// surface has a point without a normal.
///
/// # Errors
/// Only the budget's stop.
pub fn most_concave(surface: &BezierSurface<impl Patch>, budget: &Budget) -> Result<Option<f64>, Stopped> {
    let around = surface.patches().iter().fold(Bounds::EMPTY, |all, patch| all.union(&patch.bounds()));
    let size = (around.max - around.min).norm();
    let gap = GAP_FLAT / size.max(f64::MIN_POSITIVE);
    let mut search =
        Search { found: f64::NEG_INFINITY, settled: f64::NEG_INFINITY, gap, open: BestFirst::default() };
    for (k, patch) in surface.patches().iter().enumerate() {
        if k.is_multiple_of(256) {
            budget.check()?;
        }
        if !search.add(*patch, NO_SIZE * size, budget)? {
            return Ok(None);
        }
    }
    for k in 0..HALVINGS {
        if k.is_multiple_of(1024) {
            budget.check()?;
        }
        let Some((bound, part)) = search.open.pop() else { return Ok(Some(search.settled)) };
        if bound <= search.enough() {
            return Ok(Some(bound.max(search.settled)));
        }
        for half in part.split_by_bend() {
            if !search.add(half, NO_SIZE * size, budget)? {
                return Ok(None);
            }
        }
    }
    let open = search.open.pop().map_or(f64::NEG_INFINITY, |(bound, _)| bound);
    Ok(Some(open.max(search.settled)))
}

/// The undecided parts, the largest curvature found, and the largest bound of the decided parts; 1/mm.
struct Search<P> {
    found: f64,
    settled: f64,
    gap: f64,
    open: BestFirst<P>,
}

impl<P: Patch> Search<P> {
    /// A bound up to this value is tight enough: the search does not halve its part.
    fn enough(&self) -> f64 {
        self.found + GAP_SHARE * self.found.abs() + self.gap
    }

    /// Adds a part, or its subparts if it has no bound as a whole. `false` if the part has a point without a
    /// normal: then a subpart as small as a point still has no bound.
    fn add(&mut self, part: P, no_size: f64, budget: &Budget) -> Result<bool, Stopped> {
        let mut unbounded = vec![part];
        for k in 1.. {
            let Some(part) = unbounded.pop() else { break };
            if k % 256 == 0 {
                budget.check()?;
            }
            let around = part.bounds();
            let is_point = (around.max - around.min).norm() <= no_size || k > UNBOUNDED_LIMIT;
            // NaN where there is no normal; `f64::max` ignores it.
            self.found = self.found.max(most_concave_at(&part.jet(0.5, 0.5)));
            match bounds(&part.derivatives()) {
                Some([_, bound]) if bound <= self.enough() => self.settled = self.settled.max(bound),
                Some([_, bound]) => self.open.push(bound, part),
                None if is_point => return Ok(false),
                None => unbounded.extend(part.split()),
            }
        }
        Ok(true)
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{Point3, Vector4};

    use super::*;
    use crate::geometry::surface::RationalPatch;
    use crate::geometry::surface::point_grid::{Ends, PointGrid, Twist};

    fn grid(n: usize, height: impl Fn(f64, f64) -> f64) -> BezierSurface {
        let at = |i: usize| i as f64 - 0.5 * (n - 1) as f64;
        let points = (0..n)
            .map(|i| (0..n).map(|j| Point3::new(at(i), at(j), height(at(i), at(j)))).collect())
            .collect();
        PointGrid { points, twist: Twist::Spline, ends: Ends::NotAKnot }.surface().unwrap().upward()
    }

    #[test]
    fn the_bottom_of_a_bowl_is_its_most_concave_place() {
        let bowl = grid(9, |x, y| 0.1 * x * x + 0.05 * y * y);
        let bound = most_concave(&bowl, &Budget::unlimited()).unwrap().unwrap();
        assert!((0.2..=0.2025).contains(&bound), "{bound}");
    }

    #[test]
    fn plates_are_flat_and_domes_are_convex() {
        let flat = most_concave(&grid(4, |x, _| 0.3 * x), &Budget::unlimited()).unwrap().unwrap();
        assert!((0.0..1e-3).contains(&flat), "{flat}");
        let dome = most_concave(&grid(21, |x, y| (1600.0 - x * x - y * y).sqrt()), &Budget::unlimited());
        let bound = dome.unwrap().unwrap();
        assert!((bound + 0.025).abs() < 1e-3, "{bound}");
    }

    #[test]
    fn a_quarter_of_a_cylinder_has_the_curvature_of_its_radius() {
        let w = 0.5f64.sqrt();
        let arc = [(0.0, 10.0, 1.0), (10.0, 10.0, w), (10.0, 0.0, 1.0)];
        let quarter = BezierSurface::from_fn([1, 1], |_, _| {
            RationalPatch::<4>::from_fn([2, 1], |a, b| {
                let (x, z, w) = arc[a];
                Vector4::new(x * w, 30.0 * b as f64 * w, z * w, w)
            })
        });
        let outside = most_concave(&quarter, &Budget::unlimited()).unwrap().unwrap();
        let inside = most_concave(&quarter.transposed(), &Budget::unlimited()).unwrap().unwrap();
        let (convex, concave) = if outside < inside { (outside, inside) } else { (inside, outside) };
        assert!((0.0..1e-3).contains(&convex), "{convex}");
        assert!((0.1..0.102).contains(&concave), "{concave}");
    }

    #[test]
    fn a_surface_shrunk_to_a_point_has_no_bound() {
        let nothing = BezierSurface::from_fn([2, 1], |_, _| crate::geometry::surface::BicubicPatch {
            net: [[nalgebra::Vector3::zeros(); 4]; 4],
        });
        assert_eq!(most_concave(&nothing, &Budget::unlimited()), Ok(None));
    }

    #[test]
    fn a_surface_with_a_pole_has_no_bound() {
        let pole = BezierSurface::from_fn([1, 1], |_, _| {
            RationalPatch::<4>::from_fn([1, 2], |a, b| {
                Vector4::new(a as f64, (a * b) as f64, 0.1 * (a * b * b) as f64, 1.0)
            })
        });
        assert_eq!(most_concave(&pole, &Budget::unlimited()), Ok(None));
    }
}

//! The topology of a surface: which sides of its rectangle of parameters are edges, seams or poles.
//!
//! A surface is a grid of patches over a rectangle of parameters with four sides. A side is one of three
//! things.
//! * *Seam.* The side coincides with the opposite side, at equal parameters along both. The surface is closed
//!   there, and goes on at the opposite side. The opposite side is the same seam.
//! * *Pole.* The side is a single point, such as the top of a dome.
//! * *Edge.* The surface ends there. Only edges belong to the outline of the surface.
//!
//! # Method
//! Points of a side are compared at `PLACES` places for each patch. The side is a pole if all its points
//! lie within [`CLOSED_MM`] of the first one. Otherwise it is a seam if all its points lie within
//! [`CLOSED_MM`] of the points of the opposite side.
//!
//! # Guarantees
//! Sides whose points are equal at all places are equal everywhere, up to rounding: the difference of two
//! sides is a quotient of polynomials of degree 14 at most.
//!
//! # Degenerate input
//! Opposite sides that coincide in reverse, as on a Moebius strip, are edges. So are sides that coincide only
//! in part, and a side that is folded onto itself.
//!
//! # Cost
//! O(n) for n patches along the sides, and O(1) for a surface whose sides are all edges.

use nalgebra::{Point3, Vector3};

use super::Surface;

/// The largest distance between points that count as the same, mm. Data rounded to four decimals put points
/// that coincide up to 0.17 um apart. A larger value would join edges with a true gap; a smaller value would
/// take rounded seams for edges.
pub const CLOSED_MM: f64 = 2e-4;

/// Normals that differ by more than this make a kink, radians: a few hundredths of a degree. A smaller angle
/// counts as rounding of the data.
pub const KINK_LIMIT: f64 = 1e-3;

/// Places along one patch at which points and normals are compared. Fewer would not tell polynomials of
/// degree 14 apart.
const PLACES: usize = 32;

/// The largest distance from a side, in parameters, at which a place counts as on the side. The surface moves
/// less than rounding within this distance.
const ON_SIDE: f64 = 1e-9;

/// One side of the rectangle of parameters.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Side {
    /// The surface ends there.
    Edge,
    /// The surface goes on at the opposite side.
    Seam(Seam),
    /// The side is a point.
    Pole(PoleSide),
}

/// How a surface joins itself along a seam.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Seam {
    /// The largest distance found between points that coincide, mm.
    pub gap_mm: f64,
    /// The largest angle found, radians, by which the surface bends away from its normal: the angle of a
    /// ridge, seen from the side to which the normal points.
    pub convex: f64,
    /// The largest angle found, radians, by which the surface bends towards its normal: the angle of a
    /// valley.
    pub concave: f64,
}

impl Seam {
    /// Whether the surface has no kink along the seam, but for rounding of its data.
    pub fn is_smooth(&self) -> bool {
        self.convex.max(self.concave) <= KINK_LIMIT
    }
}

/// A side that is a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PoleSide {
    pub at: Point3<f64>,
    /// The largest distance found of the side from `at`, mm.
    pub gap_mm: f64,
}

/// What the four sides of a surface are.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Topology {
    spans: [usize; 2],
    /// The sides u = 0, u = nu, v = 0 and v = nv.
    sides: [Side; 4],
}

impl Topology {
    pub fn of(surface: &(impl Surface + ?Sized)) -> Self {
        let mut sides = [0, 1, 2, 3].map(|k| pole(surface, k).map_or(Side::Edge, Side::Pole));
        for axis in [0, 1] {
            if sides[2 * axis..][..2] == [Side::Edge; 2]
                && let Some(seam) = seam(surface, axis)
            {
                sides[2 * axis..][..2].fill(Side::Seam(seam));
            }
        }
        Self { spans: surface.spans(), sides }
    }

    /// The sides u = 0, u = nu, v = 0 and v = nv.
    pub fn sides(&self) -> &[Side; 4] {
        &self.sides
    }

    /// Whether the sides u = 0, u = nu, v = 0 and v = nv are edges.
    pub fn edges(&self) -> [bool; 4] {
        self.sides.map(|side| side == Side::Edge)
    }

    /// The seams along u (u = 0 coincides with u = nu) and along v.
    pub fn seams(&self) -> [Option<Seam>; 2] {
        [0, 2].map(|k| match self.sides[k] {
            Side::Seam(seam) => Some(seam),
            Side::Edge | Side::Pole(_) => None,
        })
    }

    /// Whether the parameter along `axis` (0 is u, 1 is v) starts again where it ends.
    pub fn is_closed(&self, axis: usize) -> bool {
        self.seams()[axis].is_some()
    }

    /// The name of the point at `place` that is nearest to `other` in parameters. A point on a seam has two
    /// names, at both ends of the parameter; a pole has a name for each parameter along its side. Any other
    /// place is its own only name.
    pub fn nearest_name(&self, place: [f64; 2], other: [f64; 2]) -> [f64; 2] {
        let mut name = place;
        for axis in [0, 1] {
            let end = self.spans[axis] as f64;
            let is_on = [place[axis] <= ON_SIDE, end - place[axis] <= ON_SIDE];
            match (is_on, self.sides[2 * axis], self.sides[2 * axis + 1]) {
                ([true, _], Side::Pole(_), _) | ([_, true], _, Side::Pole(_)) => {
                    name[1 - axis] = other[1 - axis];
                }
                ([true, _], Side::Seam(_), _) | ([_, true], _, Side::Seam(_)) => {
                    name[axis] = if other[axis] < 0.5 * end { 0.0 } else { end };
                }
                _ => {}
            }
        }
        name
    }
}

/// The place on side `k` at the parameter `t` along it, with k as in [`Topology::sides`].
fn place_on(spans: [usize; 2], k: usize, t: f64) -> [f64; 2] {
    let axis = k / 2;
    let fixed = if k.is_multiple_of(2) { 0.0 } else { spans[axis] as f64 };
    if axis == 0 { [fixed, t] } else { [t, fixed] }
}

/// The parameters along side `k` at which its points are compared.
fn places(spans: [usize; 2], k: usize) -> impl Iterator<Item = f64> {
    let n = spans[1 - k / 2];
    (0..=n * PLACES).map(|place| place as f64 / PLACES as f64)
}

fn pole(surface: &(impl Surface + ?Sized), k: usize) -> Option<PoleSide> {
    let spans = surface.spans();
    let point = |t: f64| {
        let [u, v] = place_on(spans, k, t);
        surface.jet(u, v).point
    };
    let mut pole = PoleSide { at: point(0.0), gap_mm: 0.0 };
    for t in places(spans, k) {
        pole.gap_mm = pole.gap_mm.max((point(t) - pole.at).norm());
        if pole.gap_mm > CLOSED_MM || pole.gap_mm.is_nan() {
            return None;
        }
    }
    Some(pole)
}

/// The seam where both sides across `axis` (0 is u, 1 is v) coincide.
fn seam(surface: &(impl Surface + ?Sized), axis: usize) -> Option<Seam> {
    let spans = surface.spans();
    let mut seam = Seam { gap_mm: 0.0, convex: 0.0, concave: 0.0 };
    for t in places(spans, 2 * axis) {
        let jet = |k: usize| {
            let [u, v] = place_on(spans, k, t);
            surface.jet(u, v)
        };
        let (after, before) = (jet(2 * axis), jet(2 * axis + 1));
        seam.gap_mm = seam.gap_mm.max((after.point - before.point).norm());
        if seam.gap_mm > CLOSED_MM || seam.gap_mm.is_nan() {
            return None;
        }
        let unit = |normal: Vector3<f64>| normal.try_normalize(0.0);
        if let (Some(one), Some(other)) = (unit(before.normal()), unit(after.normal())) {
            // The arc cosine of the dot product loses small angles in rounding; atan2 does not.
            let kink = one.cross(&other).norm().atan2(one.dot(&other));
            let ahead = if axis == 0 { after.du } else { after.dv };
            let bent = if ahead.dot(&one) > 0.0 { &mut seam.concave } else { &mut seam.convex };
            *bent = bent.max(kink);
        }
    }
    Some(seam)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{FRAC_1_SQRT_2, TAU};

    use super::*;
    use crate::geometry::surface::any_surface::AnySurface;
    use crate::geometry::surface::nurbs::Nurbs;
    use crate::geometry::surface::point_grid::{Ends, PointGrid, Twist};

    /// The surface of revolution of a curve of degree 2 or 1 in (radius, z), in four quarter turns; turned by
    /// `turned` about z, with coordinates rounded to `decimals`.
    fn revolved(curve: &[[f64; 2]], weights: &[f64], turned: f64, decimals: i32) -> Topology {
        let round = |x: f64| (x * 10f64.powi(decimals)).round() / 10f64.powi(decimals);
        let degree = curve.len() - 1;
        let corner = |k: usize| if k.is_multiple_of(2) { 1.0 } else { FRAC_1_SQRT_2 };
        let nurbs = Nurbs {
            degree: [2, degree],
            knots: [
                vec![0.0, 0.0, 0.0, 1.0, 1.0, 2.0, 2.0, 3.0, 3.0, 4.0, 4.0, 4.0],
                [vec![0.0; degree + 1], vec![1.0; degree + 1]].concat(),
            ],
            control_points: (0..9)
                .map(|k| {
                    let (sin, cos) = (turned + TAU * k as f64 / 8.0).sin_cos();
                    let at = |[r, z]: &[f64; 2]| {
                        let r = r / corner(k);
                        Point3::new(round(r * cos), round(r * sin), round(*z))
                    };
                    curve.iter().map(at).collect()
                })
                .collect(),
            weights: Some((0..9).map(|k| weights.iter().map(|w| w * corner(k)).collect()).collect()),
        };
        match nurbs.surface().unwrap() {
            AnySurface::Bicubic(surface) => Topology::of(&surface),
            AnySurface::Rational(surface) => Topology::of(&surface),
            AnySurface::HighDegree(surface) => Topology::of(&surface),
        }
    }

    #[test]
    fn a_cone_closed_in_u_has_a_smooth_seam_and_two_edges() {
        for (turned, decimals) in [(0.0, 15), (0.7, 15), (1.1, 6), (2.9, 4)] {
            let topology = revolved(&[[30.0, 0.0], [12.0, 9.0]], &[1.0, 1.0], turned, decimals);
            assert_eq!(topology.edges(), [false, false, true, true], "{turned} {decimals}");
            let seam = topology.seams()[0].unwrap();
            assert!(seam.is_smooth() && seam.gap_mm < 2e-4, "{seam:?}");
            assert!(topology.is_closed(0) && !topology.is_closed(1));
        }
    }

    #[test]
    fn a_dome_has_a_seam_an_edge_and_a_pole() {
        let curve = [[10.0, 0.0], [10.0, 10.0], [0.0, 10.0]];
        let topology = revolved(&curve, &[1.0, FRAC_1_SQRT_2, 1.0], 0.3, 15);
        let [Side::Seam(_), Side::Seam(_), Side::Edge, Side::Pole(pole)] = topology.sides() else {
            panic!("{topology:?}")
        };
        assert!((pole.at - Point3::new(0.0, 0.0, 10.0)).norm() < 1e-12, "{pole:?}");
    }

    /// A tube around the z axis through a ring of points that starts and ends at the angle 0; its seam has a
    /// kink, because splines through a ring of points have two ends.
    fn tube(radius: impl Fn(f64) -> f64) -> Topology {
        let ring = |k: usize| {
            let angle = TAU * k as f64 / 12.0;
            [0.0, 10.0, 20.0].map(|z| {
                let r = radius(angle);
                Point3::new(r * angle.cos(), r * angle.sin(), z)
            })
        };
        let points = (0..=12).map(|k| ring(k).to_vec()).collect();
        Topology::of(&PointGrid { points, twist: Twist::Spline, ends: Ends::NotAKnot }.surface().unwrap())
    }

    #[test]
    fn kinks_at_a_seam_are_convex_or_concave() {
        // The normal of the tube points outwards. A drop-shaped ring has a ridge at the angle 0, a
        // heart-shaped one a valley.
        let drop = tube(|angle| 10.0 + 4.0 * (angle - TAU / 2.0).abs()).seams()[0].unwrap();
        assert!(drop.convex > 0.3 && drop.concave == 0.0 && !drop.is_smooth(), "{drop:?}");
        let heart = tube(|angle| 20.0 - 4.0 * (angle - TAU / 2.0).abs()).seams()[0].unwrap();
        assert!(heart.concave > 0.3 && heart.convex == 0.0, "{heart:?}");
    }

    #[test]
    fn a_narrow_gap_is_no_seam_and_a_narrow_side_no_pole() {
        let strip = |gap: f64| {
            let row = |angle: f64| [0.0, 5.0].map(|z| Point3::new(angle.cos(), angle.sin(), z)).to_vec();
            let points = (0..=8).map(|k| row((TAU - gap) * k as f64 / 8.0)).collect();
            Topology::of(&PointGrid { points, twist: Twist::Spline, ends: Ends::Usual }.surface().unwrap())
        };
        assert_eq!(strip(1e-3).edges(), [true; 4]);
        assert_eq!(strip(1e-5).edges(), [false, false, true, true]);
    }

    #[test]
    fn a_place_on_a_seam_or_a_pole_takes_the_name_nearest_to_another_place() {
        let curve = [[10.0, 0.0], [10.0, 10.0], [0.0, 10.0]];
        let dome = revolved(&curve, &[1.0, FRAC_1_SQRT_2, 1.0], 0.0, 15);
        assert_eq!(dome.nearest_name([0.0, 0.4], [3.9, 0.5]), [4.0, 0.4]);
        assert_eq!(dome.nearest_name([4.0, 0.4], [0.2, 0.5]), [0.0, 0.4]);
        assert_eq!(dome.nearest_name([3.0, 0.4], [0.2, 0.5]), [3.0, 0.4]);
        assert_eq!(dome.nearest_name([3.0, 1.0], [1.2, 0.9]), [1.2, 1.0]);
        assert_eq!(dome.nearest_name([3.0, 0.0], [1.2, 0.1]), [3.0, 0.0]);
    }
}

//! Triangles that stay within a stated distance of a surface.
//!
//! # Method
//! Each patch is divided into even cells along u and v, and each cell into two triangles. Over one with
//! the sides h and k along u and v, a surface is no farther from its linear interpolation than
//! (h^2 |S_uu| + 2 h k |S_uv| + k^2 |S_vv|) / 8, with the largest second derivatives on the patch, which its
//! control points bound (Filip, Magedson, Markot). Half of the distance is for the middle term. Patches in a
//! row share their lines, so there are no gaps.
//!
//! # Guarantees
//! The surface is within the stated distance of the triangles at the same parameters. Rounding is not
//! included.
//!
//! # Degenerate input
//! Where the caller allows fewer cells than the distance needs, the triangles are farther from the surface,
//! and the stated distance is larger than the asked one. Where there are more patches than cells, or a
//! derivative has no bound, no distance is stated.
//!
//! # Cost
//! O(c + m) for c cells and m patches.
//!
//! # Reference
//! D. Filip, R. Magedson, R. Markot, *Surface algorithms using bounds on derivatives*, Computer Aided
//! Geometric Design 3, 1986.

use super::mesh::Mesh;
use super::surface::any_surface::AnySurface;
use super::surface::patch::DerivativeBounds;
use super::surface::{BezierSurface, Patch, Surface};

/// Triangles of a surface.
#[derive(Debug, Clone, PartialEq)]
pub struct Facets {
    pub mesh: Mesh,
    /// How far the surface may be from the triangles, mm; none where it is not known.
    pub chord_mm: Option<f64>,
}

impl AnySurface {
    /// Triangles within `chord_mm`, above zero, of the surface, with at most `most` cells in each direction.
    pub fn facets(&self, chord_mm: f64, most: usize) -> Facets {
        match self {
            Self::Bicubic(surface) => facets(surface, chord_mm, most),
            Self::Rational(surface) => facets(surface, chord_mm, most),
            Self::HighDegree(surface) => facets(surface, chord_mm, most),
        }
    }
}

fn facets<P: Patch>(surface: &BezierSurface<P>, chord_mm: f64, most: usize) -> Facets {
    let spans = surface.spans();
    if spans.iter().any(|n| *n > most) {
        return Facets { mesh: Mesh::of(surface, most), chord_mm: None };
    }
    let bends: Vec<Bend> = surface.patches().iter().map(|patch| Bend::of(&patch.derivatives())).collect();
    let at = |i: usize, j: usize| &bends[i * spans[1] + j];
    let mut counts = [vec![1; spans[0]], vec![1; spans[1]]];
    for i in 0..spans[0] {
        for j in 0..spans[1] {
            let [along_u, along_v] = at(i, j).counts(chord_mm, most);
            counts[0][i] = along_u.max(counts[0][i]);
            counts[1][j] = along_v.max(counts[1][j]);
        }
    }
    counts.iter_mut().for_each(|counts| limit(counts, most));
    let [of_u, of_v] = &counts;
    let distances = (0..spans[0]).flat_map(|i| (0..spans[1]).map(move |j| (i, j)));
    let worst = distances.map(|(i, j)| at(i, j).distance([of_u[i], of_v[j]])).fold(0.0, f64::max);
    let mesh = Mesh::through(surface, &parameters(of_u), &parameters(of_v));
    Facets { mesh, chord_mm: worst.is_finite().then_some(worst) }
}

/// The largest second derivatives on a patch, mm.
struct Bend {
    uu: f64,
    uv: f64,
    vv: f64,
}

impl Bend {
    fn of(DerivativeBounds { duu, duv, dvv, .. }: &DerivativeBounds) -> Self {
        let [uu, uv, vv] = [duu, duv, dvv].map(|ball| ball.center.norm() + ball.radius);
        Self { uu, uv, vv }
    }

    /// The numbers of cells along u and v that keep the distance, each at most `most`.
    fn counts(&self, chord_mm: f64, most: usize) -> [usize; 2] {
        let [mut along_u, mut along_v] =
            [self.uu, self.vv].map(|bend| (bend / (2.0 * chord_mm)).sqrt().max(1.0));
        let missing = self.uv / (2.0 * chord_mm) / (along_u * along_v);
        if missing > 1.0 {
            along_u *= missing.sqrt();
            along_v *= missing.sqrt();
        }
        // Without a finite bound of a derivative, the patch gets as many cells as are allowed.
        [along_u, along_v].map(|count| (count.ceil() as usize).clamp(1, most))
    }

    fn distance(&self, counts: [usize; 2]) -> f64 {
        let [h, k] = counts.map(|count| 1.0 / count as f64);
        (h * h * self.uu + 2.0 * h * k * self.uv + k * k * self.vv) / 8.0
    }
}

/// Makes the sum of the counts at most `most`, which is at least their number.
fn limit(counts: &mut [usize], most: usize) {
    let sum: usize = counts.iter().sum();
    if sum > most {
        // Each count keeps one cell, and its share of the others.
        let (others, room) = (sum - counts.len(), most - counts.len());
        for count in counts {
            *count = 1 + (*count - 1) * room / others.max(1);
        }
    }
}

/// The parameters of the lines of cells, from 0 on.
fn parameters(counts: &[usize]) -> Vec<f64> {
    let inner = counts.iter().enumerate();
    let starts = inner.flat_map(|(i, n)| (0..*n).map(move |k| i as f64 + k as f64 / *n as f64));
    starts.chain([counts.len() as f64]).collect()
}

#[cfg(test)]
mod tests {
    use nalgebra::{Point3, Vector3};

    use super::*;
    use crate::geometry::surface::BicubicPatch;
    use crate::geometry::surface::point_grid::{Ends, PointGrid, Twist};
    use crate::geometry::surface::source::Source;

    /// A surface through points with waves.
    fn waves() -> AnySurface {
        let height = |x: f64, y: f64| 6.0 * (0.2 * x).sin() + 4.0 * (0.15 * y).cos();
        let row = |i: usize| (0..9).map(|j| (10.0 * i as f64, 8.0 * f64::from(j))).collect::<Vec<_>>();
        let points = (0..7)
            .map(row)
            .map(|row| row.into_iter().map(|(x, y)| Point3::new(x, y, height(x, y))).collect());
        let grid = PointGrid { points: points.collect(), twist: Twist::Spline, ends: Ends::Usual };
        Source::PointGrid(grid).surface().unwrap()
    }

    /// The largest distance of the surface from the triangle over the same parameters, at many places.
    fn farthest(surface: &AnySurface, chord_mm: f64, most: usize) -> (f64, Facets) {
        let facets = surface.facets(chord_mm, most);
        let [us, vs] = facets.mesh.parameters();
        let mut worst = 0.0_f64;
        for u in us.windows(2) {
            for v in vs.windows(2) {
                let corner = |a: usize, b: usize| surface.jet(u[a], v[b]).point.coords;
                for [s, t] in [[0.3, 0.2], [0.7, 0.6], [0.5, 0.5], [0.2, 0.9], [0.9, 0.1]] {
                    let on_triangle: Vector3<f64> = if s >= t {
                        corner(0, 0) * (1.0 - s) + corner(1, 0) * (s - t) + corner(1, 1) * t
                    } else {
                        corner(0, 0) * (1.0 - t) + corner(0, 1) * (t - s) + corner(1, 1) * s
                    };
                    let exact = surface.jet(u[0] + s * (u[1] - u[0]), v[0] + t * (v[1] - v[0])).point.coords;
                    worst = worst.max((exact - on_triangle).norm());
                }
            }
        }
        (worst, facets)
    }

    #[test]
    fn the_stated_distance_bounds_the_measured_one_and_is_the_asked_one_where_cells_suffice() {
        for (chord_mm, most) in [(0.1, 1000), (0.01, 1000), (0.01, 40)] {
            let (measured, facets) = farthest(&waves(), chord_mm, most);
            let stated = facets.chord_mm.unwrap();
            assert!(measured <= stated, "{measured} is above {stated}");
            assert!(measured > 0.05 * stated, "the bound {stated} is far above {measured}");
            assert_eq!(stated <= chord_mm, most == 1000, "{stated}");
            assert!(facets.mesh.parameters().iter().all(|lines| lines.len() <= most + 1));
        }
    }

    #[test]
    fn a_plane_is_one_cell_for_each_patch_and_too_many_patches_have_no_stated_distance() {
        let plane = BezierSurface::from_fn([5, 2], |i, j| BicubicPatch {
            net: std::array::from_fn(|a| {
                std::array::from_fn(|b| Vector3::new((3 * i + a) as f64, (3 * j + b) as f64, 0.0))
            }),
        });
        let plane = AnySurface::Bicubic(plane);
        let facets = plane.facets(0.01, 100);
        assert_eq!(facets.mesh.triangles().count(), 20);
        assert!(facets.chord_mm.unwrap() < 1e-9);
        assert_eq!(plane.facets(0.01, 4).chord_mm, None);
    }
}

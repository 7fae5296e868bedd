//! Triangles that approximate a surface. Their corners are points of the surface, on a grid of its two
//! parameters. [`facets`](super::facets) states how near they are.
//!
//! # Guarantees
//! In each direction, the grid has at most as many cells as the caller allows, however large the surface is.
//! If the surface has at most that many patches in a direction, the joints of these patches are lines of the
//! grid.
//!
//! # Degenerate input
//! Where a side of the surface shrinks to a point, some triangles have no area. A point gets no normal if all
//! triangles that meet there have no area.
//!
//! # Cost
//! O(c) for c cells of the grid.

use nalgebra::{Point3, Vector3};

use super::surface::Surface;

/// Points on a surface, row after row, mm.
#[derive(Debug, Clone, PartialEq)]
pub struct Mesh {
    /// The parameters of the lines along which cells meet, along u and v.
    lines: [Vec<f64>; 2],
    points: Vec<Point3<f64>>,
}

impl Mesh {
    /// The mesh of `surface` with at most `most` cells in each direction. `most` is at least 1.
    pub fn of(surface: &dyn Surface, most: usize) -> Self {
        let spans = surface.spans();
        let cells = spans.map(|n| if n < most { n * (most / n) } else { most });
        let at = |side: usize, k: usize| (spans[side] * k) as f64 / cells[side] as f64;
        let lines = [0, 1].map(|side| (0..=cells[side]).map(|k| at(side, k)).collect::<Vec<f64>>());
        Self::through(surface, &lines[0], &lines[1])
    }

    /// The mesh of `surface` with cells between the given parameters along u and v, at least two of each.
    pub fn through(surface: &dyn Surface, along_u: &[f64], along_v: &[f64]) -> Self {
        let row = |u: &f64| along_v.iter().map(|v| surface.jet(*u, *v).point).collect::<Vec<_>>();
        let points = along_u.iter().flat_map(row).collect();
        Self { lines: [along_u.to_vec(), along_v.to_vec()], points }
    }

    /// The parameters of the lines of the mesh along u and v.
    pub fn parameters(&self) -> &[Vec<f64>; 2] {
        &self.lines
    }

    /// The numbers of cells along u and v.
    fn cells(&self) -> [usize; 2] {
        self.lines.each_ref().map(|lines| lines.len() - 1)
    }

    /// The mesh through some of the points, with at most `most` cells in each direction. The first and the
    /// last rows and columns stay.
    pub fn thinned(&self, most: usize) -> Self {
        let own = self.cells();
        let cells = own.map(|n| n.min(most));
        let at = |side: usize, k: usize| k * own[side] / cells[side];
        let row = |i: usize| (0..=cells[1]).map(move |j| self.points[at(0, i) * (own[1] + 1) + at(1, j)]);
        let lines = [0, 1].map(|side| (0..=cells[side]).map(|k| self.lines[side][at(side, k)]).collect());
        Self { lines, points: (0..=cells[0]).flat_map(row).collect() }
    }

    pub fn points(&self) -> &[Point3<f64>] {
        &self.points
    }

    /// Triangles as indices of points, all turning in the sense from u to v.
    pub fn triangles(&self) -> impl Iterator<Item = [usize; 3]> {
        let [nu, nv] = self.cells();
        (0..nu).flat_map(move |i| (0..nv).map(move |j| i * (nv + 1) + j)).flat_map(move |low| {
            let high = low + nv + 1;
            [[low, high, high + 1], [low, high + 1, low + 1]]
        })
    }

    /// The unit normals at the points, with the upward sign; zero at a point without a normal.
    pub fn normals(&self) -> Vec<Vector3<f64>> {
        let mut normals = vec![Vector3::zeros(); self.points.len()];
        for triangle in self.triangles() {
            let [a, b, c] = triangle.map(|k| self.points[k]);
            let normal = (b - a).cross(&(c - a));
            for k in triangle {
                normals[k] += normal;
            }
        }
        let upward = |normal: Vector3<f64>| if normal.z < 0.0 { -normal } else { normal };
        normals.into_iter().map(|normal| normal.try_normalize(0.0).map_or(normal, upward)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::surface::{BezierSurface, BicubicPatch};

    /// The plane z = x / 2 over 3 `n` by 3 mm.
    fn slope(n: usize) -> BezierSurface {
        BezierSurface::from_fn([n, 1], |i, _| BicubicPatch {
            net: std::array::from_fn(|a| {
                std::array::from_fn(|b| {
                    let x = (3 * i + a) as f64;
                    Vector3::new(x, b as f64, 0.5 * x)
                })
            }),
        })
    }

    #[test]
    fn the_grid_includes_joints_and_the_number_of_cells_is_bounded() {
        let mesh = Mesh::of(&slope(5), 12);
        assert_eq!(mesh.cells(), [10, 12]);
        assert_eq!(mesh.triangles().count(), 240);
        for joint in 0..=5 {
            let at = 3.0 * f64::from(joint);
            assert!(mesh.points().iter().any(|p| (p.x - at).abs() < 1e-12));
        }
        let coarse = mesh.thinned(4);
        assert_eq!(coarse.cells(), [4, 4]);
        assert_eq!(coarse.points().first(), mesh.points().first());
        assert_eq!(coarse.points().last(), mesh.points().last());
        assert_eq!(Mesh::of(&slope(50), 12).cells(), [12, 12]);
    }

    #[test]
    fn normals_point_up_and_are_zero_where_there_are_none() {
        let up = Vector3::new(-0.5, 0.0, 1.0).normalize();
        for surface in [slope(2), slope(2).transposed()] {
            let normals = Mesh::of(&surface, 8).normals();
            assert!(normals.iter().all(|normal| (normal - up).norm() < 1e-12));
        }
        let point = BezierSurface::from_fn([1, 1], |_, _| BicubicPatch { net: [[Vector3::x(); 4]; 4] });
        assert!(Mesh::of(&point, 4).normals().iter().all(|normal| *normal == Vector3::zeros()));
    }
}

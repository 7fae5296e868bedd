//! A height field: triangles that give each place of a region of the plane one height, and its level curves.
//!
//! # Method
//! * A grid of measured heights becomes four triangles in each cell, which meet in the cell's middle at the
//!   mean of the four heights. So a mirrored or rotated grid gives the mirrored or rotated field.
//! * A surface is divided along its parameters so finely that the triangles between the points lie within a
//!   given distance of it. The distance follows from bounds of the second derivatives over each patch.
//! * The part of the plane where the field is not above a height is bounded by level curves, which cross the
//!   triangles on straight lines, and by the edge of the field (`level_curves`).
//!
//! # Guarantees
//! * The distance between a surface and its triangles is at most `deviation_mm`.
//! * For a grid, the region below a height is exact for the triangles, except for [`SAME_HEIGHT_MM`] and the
//!   rounding of regions.
//! * For a surface, arcs and lines bound the region below a height. They lie within another `deviation_mm` of
//!   the level curves of the triangles.
//!
//! # Degenerate input
//! A field may have vertical walls. A surface that overhangs is refused.
//!
//! # Cost
//! O(n) for the field and for each height, with n triangles. In addition, each height makes a region of its
//! level curves; the cost of a region is stated there (`region`).

mod level_curves;
#[cfg(test)]
mod tests;

use nalgebra::{Point2, Point3, Vector3};

use crate::budget::{Budget, Stopped};
use crate::geometry::region::{Region, RegionError};
use crate::geometry::surface::any_surface::AnySurface;
use crate::geometry::surface::{BezierSurface, Patch, Surface};

/// Heights that differ by less count as the same, mm. So a level that ends on a plane of the part clears this
/// plane in spite of rounding.
pub const SAME_HEIGHT_MM: f64 = 1e-6;

/// The most triangles of a surface. While the field is made, they take about a hundred megabytes.
pub const MOST_TRIANGLES: usize = 2_000_000;

/// A triangle overhangs if it faces down: the z component of its unit normal is below minus this value. A
/// smaller value would refuse vertical walls because of rounding.
const OVERHANG: f64 = 1e-9;

/// Triangles between two checks of the budget.
const TRIANGLES_BETWEEN_CHECKS: usize = 65_536;

/// Heights over the points of a grid that is parallel to the axes.
#[derive(Debug, Clone, PartialEq)]
pub struct HeightGrid {
    /// The place of the first height.
    pub origin: Point2<f64>,
    pub spacing_mm: f64,
    /// `rows[j][i]` is the height at `origin + spacing_mm (i, j)`, mm. At least two rows of at least two
    /// heights; all rows are equally long.
    pub rows: Vec<Vec<f64>>,
}

/// Triangles over a region of the plane.
#[derive(Debug, Clone)]
pub struct HeightField {
    points: Vec<Point3<f64>>,
    /// Counterclockwise, seen from above.
    triangles: Vec<[u32; 3]>,
    /// The edges of the field, counterclockwise.
    rim: Vec<[u32; 2]>,
    deviation_mm: f64,
}

#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum HeightFieldError {
    #[error(transparent)]
    Stopped(#[from] Stopped),
    #[error("near {at} the surface overhangs: a cutter cannot reach this place from above")]
    Overhang { at: Point3<f64> },
    #[error("the surface needs more than {limit} triangles")]
    TooMany { limit: usize },
}

impl HeightField {
    /// The field of a grid: four triangles for each cell.
    pub fn of_grid(grid: &HeightGrid) -> Self {
        let HeightGrid { origin, spacing_mm, rows } = grid;
        let columns = rows.first().map_or(0, Vec::len);
        let at =
            |i: f64, j: f64, z: f64| Point3::new(origin.x + spacing_mm * i, origin.y + spacing_mm * j, z);
        let mut points = Vec::with_capacity(2 * rows.len() * columns);
        for (j, row) in rows.iter().enumerate() {
            points.extend(row.iter().enumerate().map(|(i, z)| at(i as f64, j as f64, *z)));
        }
        let mut triangles = Vec::new();
        for (j, pair) in rows.windows(2).enumerate() {
            for i in 0..columns.saturating_sub(1) {
                let mean = 0.25 * (pair[0][i] + pair[0][i + 1] + pair[1][i] + pair[1][i + 1]);
                let middle = points.len() as u32;
                points.push(at(i as f64 + 0.5, j as f64 + 0.5, mean));
                let low = (j * columns + i) as u32;
                let corners = [low, low + 1, low + 1 + columns as u32, low + columns as u32];
                triangles.extend((0..4).map(|k| [corners[k], corners[(k + 1) % 4], middle]));
            }
        }
        let rim = rim([columns, rows.len()], |i, j| j * columns + i);
        Self { points, triangles, rim, deviation_mm: 0.0 }
    }

    /// The field of a surface whose triangles lie within `deviation_mm` of it.
    ///
    /// # Errors
    /// One of [`HeightFieldError`].
    pub fn of_surface(
        surface: &AnySurface,
        deviation_mm: f64,
        budget: &Budget,
    ) -> Result<Self, HeightFieldError> {
        let divisions = match surface {
            AnySurface::Bicubic(surface) => divisions(surface, deviation_mm),
            AnySurface::Rational(surface) => divisions(surface, deviation_mm),
            AnySurface::HighDegree(surface) => divisions(surface, deviation_mm),
        };
        let counts = divisions.each_ref().map(|counts| counts.iter().sum::<f64>());
        if 2.0 * counts[0] * counts[1] > MOST_TRIANGLES as f64 {
            return Err(HeightFieldError::TooMany { limit: MOST_TRIANGLES });
        }
        let [us, vs] = divisions.map(|counts| parameters(&counts));
        let mut points = Vec::with_capacity(us.len() * vs.len());
        for u in &us {
            budget.check()?;
            points.extend(vs.iter().map(|v| surface.jet(*u, *v).point));
        }
        let columns = vs.len() as u32;
        let mut triangles = Vec::with_capacity(2 * us.len() * vs.len());
        for i in 0..us.len() as u32 - 1 {
            for j in 0..columns - 1 {
                let low = i * columns + j;
                let high = low + columns;
                triangles.extend([[low, high, high + 1], [low, high + 1, low + 1]]);
            }
        }
        let rim = rim([us.len(), vs.len()], |i, j| i * vs.len() + j);
        let mut field = Self { points, triangles, rim, deviation_mm };
        field.face_up()?;
        Ok(field)
    }

    /// Turns all triangles counterclockwise, seen from above.
    ///
    /// # Errors
    /// `Overhang` if some triangles face up and some face down.
    fn face_up(&mut self) -> Result<(), HeightFieldError> {
        let normals: Vec<Vector3<f64>> = self.triangles.iter().map(|own| self.normal(own)).collect();
        let is_down = normals.iter().map(|normal| normal.z).sum::<f64>() < 0.0;
        let sign = if is_down { -1.0 } else { 1.0 };
        let overhanging = normals.iter().position(|normal| sign * normal.z < -OVERHANG * normal.norm());
        if let Some(k) = overhanging {
            return Err(HeightFieldError::Overhang { at: self.points[self.triangles[k][0] as usize] });
        }
        if is_down {
            self.triangles.iter_mut().for_each(|triangle| triangle.swap(1, 2));
            self.rim.iter_mut().for_each(|edge| edge.swap(0, 1));
        }
        Ok(())
    }

    /// The largest distance between the triangles and the surface, mm.
    pub fn deviation_mm(&self) -> f64 {
        self.deviation_mm
    }

    /// The height of the highest point, mm.
    pub fn highest_mm(&self) -> f64 {
        self.points.iter().map(|p| p.z).fold(f64::NEG_INFINITY, f64::max)
    }

    /// The part of the plane where the field is not higher than `z_mm`. For a surface, arcs and lines bound
    /// this part; they lie within `deviation_mm` of the level curves of the triangles.
    ///
    /// # Errors
    /// One of [`RegionError`].
    pub fn region_below(&self, z_mm: f64, budget: &Budget) -> Result<Region, RegionError> {
        let chains = level_curves::around_low(self, z_mm + SAME_HEIGHT_MM, self.deviation_mm, budget)?;
        Region::on_the_left(&chains, budget)
    }

    /// Calls `visit` with each triangle as a facet.
    ///
    /// # Errors
    /// When the budget ends.
    pub fn for_each_facet(&self, budget: &Budget, mut visit: impl FnMut(&Facet)) -> Result<(), Stopped> {
        for (k, triangle) in self.triangles.iter().enumerate() {
            if k.is_multiple_of(TRIANGLES_BETWEEN_CHECKS) {
                budget.check()?;
            }
            let corners = triangle.map(|corner| self.points[corner as usize]);
            let normal = self.normal(triangle);
            let norm = normal.norm();
            let rise = if norm > 0.0 { (normal.z / norm).max(0.0) } else { 0.0 };
            visit(&Facet { corners, cosine: rise });
        }
        Ok(())
    }

    fn normal(&self, triangle: &[u32; 3]) -> Vector3<f64> {
        let [a, b, c] = triangle.map(|corner| self.points[corner as usize]);
        (b - a).cross(&(c - a))
    }
}

/// A triangle of a height field.
#[derive(Debug, Clone, Copy)]
pub struct Facet {
    pub corners: [Point3<f64>; 3],
    /// The cosine of the angle between the facet and the horizontal plane: 0 for a vertical wall.
    pub cosine: f64,
}

impl Facet {
    /// The heights of the lowest and of the highest corner, mm.
    pub fn heights(&self) -> [f64; 2] {
        let [a, b, c] = self.corners.map(|p| p.z);
        [a.min(b).min(c), a.max(b).max(c)]
    }

    /// A disc around the facet, seen from above: the centroid of the corners, and the distance of the
    /// farthest corner from the centroid.
    pub fn disc(&self) -> (Point2<f64>, f64) {
        let [a, b, c] = self.corners.map(|p| p.xy());
        let middle = Point2::from((a.coords + b.coords + c.coords) / 3.0);
        (middle, [a, b, c].into_iter().map(|p| (p - middle).norm()).fold(0.0, f64::max))
    }
}

/// The edges around a grid of n by m points: along the first index of the points, then along the second
/// index, then back along both.
fn rim([n, m]: [usize; 2], index: impl Fn(usize, usize) -> usize) -> Vec<[u32; 2]> {
    let around = (0..n - 1)
        .map(|a| (a, 0))
        .chain((0..m - 1).map(|b| (n - 1, b)))
        .chain((1..n).rev().map(|a| (a, m - 1)))
        .chain((1..m).rev().map(|b| (0, b)));
    let corners: Vec<u32> = around.map(|(a, b)| index(a, b) as u32).collect();
    (0..corners.len()).map(|k| [corners[k], corners[(k + 1) % corners.len()]]).collect()
}

/// For each row of patches the number of parts along u, and for each column the number of parts along v. With
/// these numbers, the triangles between the points lie within `deviation_mm` of the surface. A triangle whose
/// right angle has sides du and dv in the parameters differs from the surface by at most
/// `(|Suu| du² + 2 |Suv| du dv + |Svv| dv²) / 8`.
fn divisions<P: Patch>(surface: &BezierSurface<P>, deviation_mm: f64) -> [Vec<f64>; 2] {
    let [nu, nv] = surface.spans();
    let mut counts = [vec![1.0f64; nu], vec![1.0f64; nv]];
    // Each of the three terms may take a third of the distance.
    let term = deviation_mm / 3.0;
    for i in 0..nu {
        for j in 0..nv {
            let bounds = surface.patch(i, j).derivatives();
            let [uu, uv, vv] =
                [bounds.duu, bounds.duv, bounds.dvv].map(|ball| ball.center.norm() + ball.radius);
            let along = |second: f64| (second / (8.0 * term)).sqrt();
            // The mixed term is small enough if the product of both counts is at least this.
            let product = uv / (4.0 * term);
            let [u, v] = [along(uu).max(1.0), along(vv).max(1.0)];
            let more = (product / (u * v)).max(1.0).sqrt();
            counts[0][i] = counts[0][i].max((u * more).ceil());
            counts[1][j] = counts[1][j].max((v * more).ceil());
        }
    }
    counts
}

/// The parameters that divide span k into `counts[k]` equal parts.
fn parameters(counts: &[f64]) -> Vec<f64> {
    let inside = counts
        .iter()
        .enumerate()
        .flat_map(|(span, count)| (0..*count as usize).map(move |k| span as f64 + k as f64 / count));
    inside.chain([counts.len() as f64]).collect()
}

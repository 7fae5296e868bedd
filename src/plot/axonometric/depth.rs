//! How near the surface is to the reader at each spot of paper, and what it hides.

use nalgebra::{Point2, Point3};

use super::isometric::Isometric;
use toolpathd_core::geometry::mesh::Mesh;

/// Width of a spot, mm of paper: about that of a stroke.
const SPOT_MM: f64 = 0.2;

/// Distance of the places at which a stroke is looked at, mm of paper.
pub const LOOK_MM: f64 = 0.4;

/// How far a place may lie behind the surface and still show, mm of paper. Wires lie on the surface, and the
/// mesh leaves it by a tenth; more would show what a thin wall hides.
const SLACK_MM: f64 = 0.5;

/// How far beyond its edges a triangle covers spots, as a part of its height. Without it, rounding would
/// leave spots between two triangles uncovered.
const EDGE: f64 = 1e-6;

/// Spots in rows, from the upper left of the sheet.
pub struct Depth {
    columns: usize,
    /// The nearness of the surface; minus infinity where the surface is not seen.
    spots: Vec<f32>,
}

impl Depth {
    pub fn of(mesh: &Mesh, isometric: &Isometric) -> Self {
        let [columns, rows] = crate::SHEET_MM.map(|mm| (f64::from(mm) / SPOT_MM) as usize);
        let mut depth = Self { columns, spots: vec![f32::NEG_INFINITY; columns * rows] };
        let places: Vec<(Point2<f64>, f64)> =
            mesh.points().iter().map(|p| (isometric.project(p) / SPOT_MM, isometric.nearness(p))).collect();
        for triangle in mesh.triangles() {
            depth.fill(triangle.map(|k| places[k]));
        }
        depth
    }

    fn rows(&self) -> usize {
        self.spots.len() / self.columns
    }

    /// Notes a triangle at the spots whose centres it covers.
    fn fill(&mut self, [(a, near_a), (b, near_b), (c, near_c)]: [(Point2<f64>, f64); 3]) {
        let area = (b - a).perp(&(c - a));
        if area == 0.0 {
            return;
        }
        let (low, high) = (a.inf(&b).inf(&c), a.sup(&b).sup(&c));
        let range = |low: f64, high: f64, n: usize| {
            (low - 0.5).ceil().max(0.0) as usize..((high + 0.5).floor().max(0.0) as usize).min(n)
        };
        for row in range(low.y, high.y, self.rows()) {
            for column in range(low.x, high.x, self.columns) {
                let p = Point2::new(column as f64 + 0.5, row as f64 + 0.5);
                let by_b = (p - a).perp(&(c - a)) / area;
                let by_c = (b - a).perp(&(p - a)) / area;
                if by_b >= -EDGE && by_c >= -EDGE && by_b + by_c <= 1.0 + EDGE {
                    let near = near_a + by_b * (near_b - near_a) + by_c * (near_c - near_a);
                    let spot = &mut self.spots[row * self.columns + column];
                    *spot = spot.max(near as f32);
                }
            }
        }
    }

    /// Whether nothing of the surface is in front of a point, at its spot or at one beside it.
    pub fn shows(&self, p: &Point3<f64>, isometric: &Isometric) -> bool {
        let at = isometric.project(p) / SPOT_MM;
        let near = (isometric.nearness(p) + SLACK_MM / isometric.scale.value()) as f32;
        let (column, row) = (at.x as usize, at.y as usize);
        let rows = row.saturating_sub(1)..(row + 2).min(self.rows());
        let columns = column.saturating_sub(1)..(column + 2).min(self.columns);
        rows.flat_map(|row| columns.clone().map(move |column| row * self.columns + column))
            .any(|spot| self.spots[spot] <= near)
    }
}

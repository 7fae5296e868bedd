//! Normals at the corners of triangles, for pictures.
//!
//! # Method
//! The normal at a corner of a triangle is the mean of the triangles at its vertex that turn from it by less
//! than `SHARP`, each by its area. Corners of one vertex with equal normals become one point, so that a round
//! wall is smooth, and a sharp edge is sharp.
//!
//! # Cost
//! O(n m) for n triangles and at most m at one vertex, where m counts up to `MOST_AROUND`.

use toolpathd_core::budget::Budget;

use super::welding::{cross, dot, sub};
use super::{MeshFile, STEPS_PER_CHECK};
use crate::fault::Unreadable;

/// The cosine of the least turn between triangles that is shown as an edge: 30 degrees.
const SHARP: f64 = 0.866;

/// Most triangles around a vertex whose normals are compared. A vertex with more gets the normal of each
/// triangle by itself: at the tip of a fine cone there is no mean.
const MOST_AROUND: usize = 64;

/// Points with normals, and triangles by the numbers of points.
#[derive(Debug, Clone, PartialEq)]
pub struct Shaded {
    pub points: Vec<[f64; 3]>,
    /// Unit normals of the points.
    pub normals: Vec<[f64; 3]>,
    pub triangles: Vec<[u32; 3]>,
}

impl Shaded {
    /// The triangles of a mesh with normals. Slivers are left out.
    ///
    /// # Errors
    /// The budget's stop.
    pub fn of(mesh: &MeshFile, budget: &Budget) -> Result<Self, Unreadable> {
        let around = Around::of(mesh);
        let areas: Vec<[f64; 3]> = mesh.triangles.iter().map(|own| normal(mesh, own)).collect();
        let mut shaded = Self {
            points: Vec::with_capacity(mesh.vertices.len()),
            normals: Vec::with_capacity(mesh.vertices.len()),
            triangles: mesh.triangles.clone(),
        };
        for (vertex, point) in mesh.vertices.iter().enumerate() {
            if vertex.is_multiple_of(STEPS_PER_CHECK) {
                budget.check()?;
            }
            let corners = &around.corners[around.starts[vertex]..around.starts[vertex + 1]];
            let first = shaded.points.len();
            for &(triangle, corner) in corners {
                let normal = mean(areas[triangle as usize], corners, &areas);
                let known = shaded.normals[first..].iter().take(MOST_AROUND).position(|own| *own == normal);
                let place = known.map_or(shaded.points.len(), |known| first + known);
                if place == shaded.points.len() {
                    shaded.points.push(*point);
                    shaded.normals.push(normal);
                }
                shaded.triangles[triangle as usize][corner as usize] = place as u32;
            }
        }
        Ok(shaded)
    }
}

/// The normal of a triangle, twice as long as its area is large.
fn normal(mesh: &MeshFile, triangle: &[u32; 3]) -> [f64; 3] {
    let [a, b, c] = mesh.corners(triangle);
    cross(sub(b, a), sub(c, a))
}

/// The mean of the normals around a vertex that turn little from `own`.
fn mean(own: [f64; 3], corners: &[(u32, u8)], areas: &[[f64; 3]]) -> [f64; 3] {
    let length = |normal: [f64; 3]| dot(normal, normal).sqrt();
    let unit = |normal: [f64; 3]| normal.map(|x| x / length(normal));
    if corners.len() > MOST_AROUND {
        return unit(own);
    }
    let others = corners.iter().map(|(triangle, _)| areas[*triangle as usize]);
    let near = others.filter(|other| dot(own, *other) > SHARP * length(own) * length(*other));
    let sum = near.fold([0.0; 3], |sum, other| [0, 1, 2].map(|k| sum[k] + other[k]));
    if length(sum) > 0.0 { unit(sum) } else { unit(own) }
}

/// The corners of triangles at each vertex.
struct Around {
    /// Where the corners of each vertex begin, and the end of the last.
    starts: Vec<usize>,
    /// The number of a triangle, and which of its corners it is.
    corners: Vec<(u32, u8)>,
}

impl Around {
    fn of(mesh: &MeshFile) -> Self {
        let mut starts = vec![0; mesh.vertices.len() + 1];
        mesh.triangles.iter().flatten().for_each(|corner| starts[*corner as usize] += 1);
        let mut end = 0;
        for start in &mut starts {
            end += *start;
            *start = end;
        }
        let mut corners = vec![(0, 0); end];
        for (triangle, own) in mesh.triangles.iter().enumerate().rev() {
            for corner in (0..3_u8).rev() {
                let start = &mut starts[own[usize::from(corner)] as usize];
                *start -= 1;
                corners[*start] = (triangle as u32, corner);
            }
        }
        Self { starts, corners }
    }
}

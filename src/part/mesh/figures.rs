//! The figures of a mesh: its size, and whether it encloses a solid.

use std::cmp::Ordering;

use toolpathd_core::budget::Budget;

use super::edges::Edges;
use super::welding::{cross, dot, sub};
use super::{MeshFile, STEPS_PER_CHECK};
use crate::fault::Unreadable;

/// The figures of a mesh, in the unit of its file.
#[derive(Debug, Clone, PartialEq)]
pub struct Figures {
    /// The area of all triangles.
    pub area: f64,
    /// The corners of a box around the mesh: the least coordinates, and the largest.
    pub bounds: [[f64; 3]; 2],
    /// The number of bodies: triangles of one body are joined through edges. Bodies that touch along a whole
    /// edge with equal ends count as one.
    pub n_bodies: usize,
    /// Edges of one triangle alone.
    pub n_open_edges: usize,
    /// Edges of more than two triangles.
    pub n_crowded_edges: usize,
    /// Edges of two triangles that disagree which side is outside.
    pub n_turned_edges: usize,
    /// What a closed mesh encloses: each of its edges has two triangles, which agree which side is outside.
    pub solid: Option<Solid>,
}

/// What a closed mesh encloses.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Solid {
    /// The sum of the volumes of its bodies. A body whose normals point inward counts as negative, so that a
    /// void in a solid is taken off.
    pub volume: f64,
    /// Bodies whose normals point inward: voids, or solids that are turned inside out.
    pub n_inward_bodies: usize,
    /// Whether the normals point out of the material, as far as boxes tell: each inward body lies within the
    /// box of an outward body, and so may be a void in it.
    pub is_outward: bool,
}

impl Figures {
    /// # Errors
    /// The budget's stop.
    pub fn of(mesh: &MeshFile, edges: &Edges, budget: &Budget) -> Result<Self, Unreadable> {
        let mut bodies = Sets::new(mesh.triangles.len() + mesh.slivers.len());
        let [mut n_open_edges, mut n_crowded_edges, mut n_turned_edges] = [0; 3];
        for (k, edge) in edges.iter().enumerate() {
            if k.is_multiple_of(STEPS_PER_CHECK) {
                budget.check()?;
            }
            match edge.sides {
                [_] => n_open_edges += 1,
                [a, b] => n_turned_edges += usize::from(a.is_backward() == b.is_backward()),
                _ => n_crowded_edges += 1,
            }
            edge.sides.windows(2).for_each(|pair| bodies.join(pair[0].triangle(), pair[1].triangle()));
        }
        let bodies = bodies.numbers(mesh.triangles.len());
        let n_bodies = bodies.iter().max().map_or(0, |last| *last as usize + 1);
        let is_closed = n_open_edges + n_crowded_edges + n_turned_edges == 0;
        Ok(Self {
            area: area(mesh),
            bounds: bounds(mesh.vertices.iter().copied()),
            n_bodies,
            n_open_edges,
            n_crowded_edges,
            n_turned_edges,
            solid: if is_closed { Some(Solid::of(mesh, &bodies, n_bodies, budget)?) } else { None },
        })
    }
}

fn area(mesh: &MeshFile) -> f64 {
    let normals = mesh.triangles.iter().map(|corners| {
        let [a, b, c] = mesh.corners(corners);
        cross(sub(b, a), sub(c, a))
    });
    normals.map(|normal| dot(normal, normal).sqrt()).sum::<f64>() / 2.0
}

/// The corners of a box around points.
fn bounds(points: impl Iterator<Item = [f64; 3]>) -> [[f64; 3]; 2] {
    let none = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];
    points.fold(none, |[min, max], point| {
        [[0, 1, 2].map(|k| min[k].min(point[k])), [0, 1, 2].map(|k| max[k].max(point[k]))]
    })
}

impl Solid {
    /// What bodies enclose; `bodies` has the number of the body of each triangle.
    fn of(mesh: &MeshFile, bodies: &[u32], n_bodies: usize, budget: &Budget) -> Result<Self, Unreadable> {
        // Each body is measured from a corner of its own, for the sake of digits.
        let mut origins = vec![None; n_bodies];
        let mut volumes = vec![0.0; n_bodies];
        for (corners, &body) in mesh.triangles.iter().zip(bodies) {
            let [a, b, c] = mesh.corners(corners);
            let origin = *origins[body as usize].get_or_insert(a);
            volumes[body as usize] += dot(sub(a, origin), cross(sub(b, origin), sub(c, origin)));
        }
        volumes.iter_mut().for_each(|volume| *volume /= 6.0);
        budget.check()?;
        let is_inward = |volume: &f64| *volume < 0.0;
        let n_inward_bodies = volumes.iter().filter(|volume| is_inward(volume)).count();
        let is_outward = n_inward_bodies == 0 || {
            let boxes = boxes(mesh, bodies, n_bodies);
            let (inward, outward): (Vec<_>, Vec<_>) =
                boxes.iter().zip(&volumes).partition(|(_, volume)| is_inward(volume));
            are_within(&inward, outward, budget)?
        };
        Ok(Self { volume: volumes.iter().sum(), n_inward_bodies, is_outward })
    }
}

/// The box around each body.
fn boxes(mesh: &MeshFile, bodies: &[u32], n_bodies: usize) -> Vec<[[f64; 3]; 2]> {
    let mut boxes = vec![[[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]]; n_bodies];
    for (corners, &body) in mesh.triangles.iter().zip(bodies) {
        let own = &mut boxes[body as usize];
        let [min, max] = bounds(mesh.corners(corners).into_iter());
        *own = [[0, 1, 2].map(|k| own[0][k].min(min[k])), [0, 1, 2].map(|k| own[1][k].max(max[k]))];
    }
    boxes
}

/// A box, and the volume of the body in it.
type Boxed<'b> = (&'b [[f64; 3]; 2], &'b f64);

/// Whether each of some boxes lies within another, of a larger body. O(n) for each box.
fn are_within(boxes: &[Boxed], mut others: Vec<Boxed>, budget: &Budget) -> Result<bool, Unreadable> {
    // The largest bodies are the most likely ones.
    others.sort_by(|(_, a), (_, b)| b.partial_cmp(a).unwrap_or(Ordering::Equal));
    for ([min, max], volume) in boxes {
        budget.check()?;
        let is_around = |([from, to], other): &Boxed| {
            **other > -**volume && (0..3).all(|k| from[k] <= min[k] && max[k] <= to[k])
        };
        if !others.iter().any(is_around) {
            return Ok(false);
        }
    }
    Ok(true)
}

/// Sets of triangles that grow together.
struct Sets {
    /// A triangle of the same set with a smaller number, or the triangle itself.
    parents: Vec<u32>,
}

impl Sets {
    fn new(n: usize) -> Self {
        Self { parents: (0_u32..).take(n).collect() }
    }

    fn first(&mut self, mut triangle: usize) -> usize {
        while self.parents[triangle] as usize != triangle {
            let above = self.parents[self.parents[triangle] as usize];
            self.parents[triangle] = above;
            triangle = above as usize;
        }
        triangle
    }

    fn join(&mut self, a: usize, b: usize) {
        let (a, b) = (self.first(a), self.first(b));
        self.parents[a.max(b)] = a.min(b) as u32;
    }

    /// The number of the set of each of the first `n` triangles; sets are numbered from 0 in the order of
    /// their first triangles.
    fn numbers(mut self, n: usize) -> Vec<u32> {
        let mut numbers = vec![u32::MAX; self.parents.len()];
        let mut next = 0;
        for triangle in 0..n {
            let first = self.first(triangle);
            if numbers[first] == u32::MAX {
                numbers[first] = next;
                next += 1;
            }
            numbers[triangle] = numbers[first];
        }
        numbers.truncate(n);
        numbers
    }
}

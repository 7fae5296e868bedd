//! The edges of a mesh, each with the triangles that have it.
//!
//! # Method
//! Each side of each triangle is put into the row of its end with the smaller number; each row is sorted by
//! the other end. So the sides of one edge stand side by side.
//!
//! # Cost
//! O(n log m) for n triangles and at most m at one vertex; 24 bytes for a triangle and 8 for a vertex.

use toolpathd_core::budget::Budget;

use super::{MeshFile, STEPS_PER_CHECK};
use crate::fault::Unreadable;

/// The edges of a mesh.
pub struct Edges {
    /// Where the row of each vertex begins, and the end of the last.
    starts: Vec<usize>,
    sides: Vec<Side>,
}

/// A side of a triangle, in the row of its end with the smaller number.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Side {
    /// The end with the larger number.
    other: u32,
    /// Twice the number of the triangle; 1 more where the side leads to the smaller number.
    code: u32,
}

/// An edge: the numbers of its ends, the smaller one first, and the sides that are there.
#[derive(Debug, Clone, Copy)]
pub struct Edge<'e> {
    pub ends: [u32; 2],
    pub sides: &'e [Side],
}

impl Side {
    /// The number of its triangle; slivers are counted on behind the triangles.
    pub fn triangle(self) -> usize {
        (self.code / 2) as usize
    }

    /// Whether it leads to the end with the smaller number.
    pub fn is_backward(self) -> bool {
        self.code % 2 == 1
    }
}

impl Edges {
    /// The edges of all triangles and slivers.
    ///
    /// # Errors
    /// The budget's stop.
    ///
    /// # Panics
    /// When the mesh has 2^31 triangles.
    pub fn of(mesh: &MeshFile, budget: &Budget) -> Result<Self, Unreadable> {
        let n = mesh.triangles.len() + mesh.slivers.len();
        assert!(n < 1 << 31, "a mesh has fewer than 2^31 triangles");
        let all = || (0_u32..).zip(mesh.triangles.iter().chain(&mesh.slivers));
        let mut starts = vec![0; mesh.vertices.len() + 1];
        for (k, &[a, b, c]) in all() {
            check(k as usize, budget)?;
            for (from, to) in [(a, b), (b, c), (c, a)] {
                starts[from.min(to) as usize] += 1;
            }
        }
        // Each start is the end of its row first, and moves to its beginning as the row is filled.
        let mut end = 0;
        for start in &mut starts {
            end += *start;
            *start = end;
        }
        let mut sides = vec![Side { other: 0, code: 0 }; 3 * n];
        for (k, &[a, b, c]) in all() {
            check(k as usize, budget)?;
            for (from, to) in [(a, b), (b, c), (c, a)] {
                let start = &mut starts[from.min(to) as usize];
                *start -= 1;
                sides[*start] = Side { other: from.max(to), code: 2 * k + u32::from(from > to) };
            }
        }
        for (k, row) in starts.windows(2).enumerate() {
            check(k, budget)?;
            sides[row[0]..row[1]].sort_unstable();
        }
        Ok(Self { starts, sides })
    }

    /// All edges.
    pub fn iter(&self) -> impl Iterator<Item = Edge<'_>> {
        let rows = (0_u32..).zip(self.starts.windows(2));
        rows.flat_map(|(vertex, row)| {
            let edges = self.sides[row[0]..row[1]].chunk_by(|a, b| a.other == b.other);
            edges.map(move |sides| Edge { ends: [vertex, sides[0].other], sides })
        })
    }
}

fn check(k: usize, budget: &Budget) -> Result<(), Unreadable> {
    if k.is_multiple_of(STEPS_PER_CHECK) {
        budget.check()?;
    }
    Ok(())
}

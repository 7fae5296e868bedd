//! Brings equal points together, and collects triangles.

use std::hash::{BuildHasher, RandomState};

use hashbrown::HashTable;
use hashbrown::hash_table::Entry;

use super::{MeshFile, is_coordinate};
use crate::fault::{Place, Unreadable};
use crate::left_out::LeftOuts;
use crate::unit::Unit;

/// A mesh in the making.
///
/// The table of vertices holds their numbers alone, 5 bytes each, so that a mesh of millions of triangles
/// takes little more than its own memory. Its hash is keyed at random: no file can make it slow.
pub struct Welding {
    vertices: Vec<[f64; 3]>,
    numbers: HashTable<u32>,
    hasher: RandomState,
    triangles: Vec<[u32; 3]>,
    slivers: Vec<[u32; 3]>,
    n_degenerate: usize,
    pub n_polygons: usize,
    pub off_plane_max: f64,
    most_triangles: usize,
    pub left_out: LeftOuts,
}

impl Welding {
    pub fn new(most_triangles: usize) -> Self {
        Self {
            vertices: Vec::new(),
            numbers: HashTable::new(),
            hasher: RandomState::new(),
            triangles: Vec::new(),
            slivers: Vec::new(),
            n_degenerate: 0,
            n_polygons: 0,
            off_plane_max: 0.0,
            most_triangles,
            left_out: LeftOuts::default(),
        }
    }

    /// The number of the vertex at a point.
    ///
    /// # Errors
    /// When the point has a coordinate that is no number, or is far too large; when there are more vertices
    /// than numbers of them.
    pub fn vertex(&mut self, point: [f64; 3], place: Place) -> Result<u32, Unreadable> {
        if let Some(wrong) = point.iter().find(|value| !is_coordinate(**value)) {
            return Err(Unreadable::at(place, format!("{wrong:e} is no coordinate")));
        }
        // -0 + 0 is 0.
        let point = point.map(|value| value + 0.0);
        let Self { vertices, numbers, hasher, .. } = self;
        let hash = |point: &[f64; 3]| hasher.hash_one(point.map(f64::to_bits));
        let found = numbers.entry(
            hash(&point),
            |&number| vertices[number as usize] == point,
            |&number| hash(&vertices[number as usize]),
        );
        match found {
            Entry::Occupied(found) => Ok(*found.get()),
            Entry::Vacant(free) => {
                let number = u32::try_from(vertices.len()).ok().filter(|number| *number < u32::MAX);
                let number = number.ok_or_else(|| Unreadable::at(place, "there are too many vertices"))?;
                free.insert(number);
                vertices.push(point);
                Ok(number)
            }
        }
    }

    /// Ends an object: no later point is brought together with a vertex before.
    pub fn end_object(&mut self) {
        self.numbers.clear();
    }

    pub fn point(&self, vertex: u32) -> [f64; 3] {
        self.vertices[vertex as usize]
    }

    /// Adds a triangle.
    ///
    /// # Errors
    /// When there are too many triangles.
    pub fn triangle(&mut self, corners: [u32; 3], place: Place) -> Result<(), Unreadable> {
        if self.triangles.len() + self.slivers.len() >= self.most_triangles {
            let detail = format!("there are more than {} triangles", self.most_triangles);
            return Err(Unreadable::at(place, detail));
        }
        let [a, b, c] = corners;
        if a == b || b == c || c == a {
            self.n_degenerate += 1;
            self.left_out.add("triangle", "two of its corners are equal", place);
        } else if self.normal(corners) == [0.0; 3] {
            self.n_degenerate += 1;
            self.left_out.add("triangle", "its area is 0", place);
            self.slivers.push(corners);
        } else {
            self.triangles.push(corners);
        }
        Ok(())
    }

    /// The normal of a triangle, twice as long as its area is large.
    pub fn normal(&self, corners: [u32; 3]) -> [f64; 3] {
        let [a, b, c] = corners.map(|corner| self.point(corner));
        cross(sub(b, a), sub(c, a))
    }

    /// The mesh, without vertices that no triangle uses.
    pub fn mesh(self, unit: Option<Unit>) -> MeshFile {
        const UNUSED: u32 = u32::MAX;
        let Self { mut vertices, numbers, mut triangles, mut slivers, mut left_out, .. } = self;
        drop(numbers);
        let mut places = vec![UNUSED; vertices.len()];
        for &corner in triangles.iter().chain(&slivers).flatten() {
            places[corner as usize] = 0;
        }
        let mut n_used = 0;
        for (k, place) in places.iter_mut().enumerate().filter(|(_, place)| **place != UNUSED) {
            vertices[n_used as usize] = vertices[k];
            *place = n_used;
            n_used += 1;
        }
        let n_loose = vertices.len() - n_used as usize;
        left_out.add_many("vertex", "no triangle uses it", n_loose, Place::File);
        vertices.truncate(n_used as usize);
        vertices.shrink_to_fit();
        triangles.shrink_to_fit();
        for corner in triangles.iter_mut().chain(&mut slivers).flatten() {
            *corner = places[*corner as usize];
        }
        MeshFile {
            unit,
            vertices,
            triangles,
            slivers,
            n_degenerate: self.n_degenerate,
            n_polygons: self.n_polygons,
            off_plane_max: self.off_plane_max,
            left_out: left_out.list(),
        }
    }
}

pub fn sub(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

pub fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

pub fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

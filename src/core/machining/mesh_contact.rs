//! Finds where a cutter that comes down from above touches a mesh of triangles first, and proves how near the
//! tips over a line of positions are to chords.
//!
//! # Method
//! 1. How high a triangle lifts the tip is known in closed form (`lift`).
//! 2. The triangles are searched by their boxes, the most promising first. A box that cannot lift the tip
//!    higher than what is found is left out.
//! 3. A triangle and a cutter are convex. So along a line of positions of the axis, the lift of one triangle
//!    is a concave function: it lies below its tangents and above its chords. Both bounds together prove how
//!    far the tips of a stretch are from its chord (`stretch`), for all triangles.
//!
//! # Guarantees
//! Tips are exact to rounding. The mesh may have any shape: folds, walls, overhangs, holes and triangles
//! without an area are allowed, in any order of their corners.
//!
//! # Cost
//! O(log n) for n triangles, and O(t) for the t triangles below the cutter that lift it nearly as high as the
//! highest one.

mod lift;
pub mod sections;
mod stretch;

use nalgebra::{Point3, Vector2, Vector3};

use super::cutter::Cutter;
use crate::geometry::bounding_tree::Visitor;
use crate::geometry::surface::patch::Bounds;
use crate::geometry::surface::triangle_mesh::TriangleMesh;
use lift::{Lift, REACH, Support, height, lift_above};

/// A cutter that touches a mesh from above.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeshContact {
    /// The tip.
    pub tip: Point3<f64>,
    /// A point of the mesh that the cutter touches.
    pub point: Point3<f64>,
    /// The slope of the cutter's lower side where it touches, away from the axis.
    pub slope: f64,
    /// The triangle that the point belongs to, by its number in the mesh.
    triangle: u32,
    /// Whether the cutter touches the inside of the triangle.
    is_inside: bool,
}

/// A mesh and a cutter.
///
/// # Example
/// A ball over the ridge of a roof touches the ridge.
///
/// ```
/// use nalgebra::{Point3, Vector2};
/// use toolpathd_core::budget::Budget;
/// use toolpathd_core::geometry::surface::triangle_mesh::TriangleMesh;
/// use toolpathd_core::machining::cutter::Cutter;
/// use toolpathd_core::machining::mesh_contact::MeshContacts;
///
/// let points = [[0.0, 0.0, 0.0], [9.0, 0.0, 0.0], [9.0, 4.0, 3.0], [0.0, 4.0, 3.0], [9.0, 8.0, 0.0]];
/// let triangles = vec![[0, 1, 2], [0, 2, 3], [3, 2, 4]];
/// let points = points.map(Point3::from).to_vec();
/// let roof = TriangleMesh::new(points, triangles, 0.0, &Budget::unlimited()).unwrap();
/// let contacts = MeshContacts::new(&roof, Cutter::ball(2.0));
/// assert_eq!(contacts.drop(Vector2::new(8.0, 4.0)).unwrap().tip, Point3::new(8.0, 4.0, 3.0));
/// assert_eq!(contacts.drop(Vector2::new(8.0, -3.0)), None);
/// ```
#[derive(Debug, Clone, Copy)]
pub struct MeshContacts<'a> {
    mesh: &'a TriangleMesh,
    cutter: Cutter,
}

impl<'a> MeshContacts<'a> {
    pub fn new(mesh: &'a TriangleMesh, cutter: Cutter) -> Self {
        Self { mesh, cutter }
    }

    pub fn mesh(&self) -> &'a TriangleMesh {
        self.mesh
    }

    pub fn cutter(&self) -> &Cutter {
        &self.cutter
    }

    /// The contact of the cutter with its axis at `at`; `None` if the cutter misses the mesh.
    pub fn drop(&self, at: Vector2<f64>) -> Option<MeshContact> {
        self.drop_near(at, None)
    }

    /// As [`Self::drop`]. `near` is a contact of a position near by, which makes the search faster. Where
    /// several triangles lift the tip equally high, it may choose among them.
    pub(crate) fn drop_near(&self, at: Vector2<f64>, near: Option<&MeshContact>) -> Option<MeshContact> {
        let mut search = Highest { contacts: self, at, best: None };
        match near {
            Some(near) => search.visit(&[near.triangle, near.triangle + 1], 0.0),
            None => self.mesh.search(&mut Likely { search: &mut search, is_done: false }),
        }
        self.mesh.search(&mut search);
        search.best.map(|(triangle, best)| contact(at, triangle, &best))
    }
}

fn contact(at: Vector2<f64>, triangle: u32, lift: &Lift) -> MeshContact {
    MeshContact {
        tip: Point3::new(at.x, at.y, lift.tip_z),
        point: Point3::from(lift.point),
        slope: lift.slope,
        triangle,
        is_inside: lift.is_inside,
    }
}

/// The least distance in plan of a place from a box, mm.
fn distance_in_plan(bounds: &Bounds, at: &Vector2<f64>) -> f64 {
    let off = |c: usize| (bounds.min[c] - at[c]).max(at[c] - bounds.max[c]).max(0.0);
    off(0).hypot(off(1))
}

/// The box of a triangle.
fn box_of(corners: &[Vector3<f64>; 3]) -> Bounds {
    let [a, b, c] = corners;
    Bounds { min: a.inf(b).inf(c), max: a.sup(b).sup(c) }
}

/// A search for the triangle that lifts the tip highest.
struct Highest<'a> {
    contacts: &'a MeshContacts<'a>,
    at: Vector2<f64>,
    best: Option<(u32, Lift)>,
}

impl Visitor<Bounds, [u32; 2]> for Highest<'_> {
    /// The height to which anything in the box lifts the tip at most.
    fn promise(&self, bounds: &Bounds) -> f64 {
        let cutter = &self.contacts.cutter;
        let distance = distance_in_plan(bounds, &self.at);
        if distance > REACH * cutter.radius() {
            return f64::NEG_INFINITY;
        }
        bounds.max.z - height(cutter, distance)
    }

    fn is_settled(&self, promise: f64) -> bool {
        promise <= self.best.map_or(f64::NEG_INFINITY, |(_, best)| best.tip_z)
    }

    fn visit(&mut self, range: &[u32; 2], _promise: f64) {
        let contacts = self.contacts;
        for k in range[0]..range[1] {
            let corners = contacts.mesh.corners(k as usize);
            let from_axis =
                corners.map(|corner| Vector3::new(corner.x - self.at.x, corner.y - self.at.y, corner.z));
            let center = from_axis.iter().sum::<Vector3<f64>>() / 3.0;
            if self.is_settled(Support::near(&contacts.cutter, &center.xy()).lift(&from_axis)) {
                continue;
            }
            let known = self.best.map_or(f64::NEG_INFINITY, |(_, best)| best.tip_z);
            if let Some(own) = lift_above(&contacts.cutter, &corners, &self.at, known)
                && !self.is_settled(own.tip_z)
            {
                self.best = Some((k, own));
            }
        }
    }
}

/// A search for a few triangles that are likely to lift the tip high: those where the middle of the box does.
struct Likely<'a, 'b> {
    search: &'a mut Highest<'b>,
    is_done: bool,
}

impl Visitor<Bounds, [u32; 2]> for Likely<'_, '_> {
    fn promise(&self, bounds: &Bounds) -> f64 {
        let middle = 0.5 * (bounds.min + bounds.max);
        let cutter = &self.search.contacts.cutter;
        let distance = (middle.xy() - self.search.at).norm();
        // Beyond the radius, the farther the worse.
        let beyond = (distance - cutter.radius()).max(0.0);
        middle.z - height(cutter, distance) - 2.0 * beyond
    }

    fn is_settled(&self, _promise: f64) -> bool {
        self.is_done
    }

    fn visit(&mut self, range: &[u32; 2], promise: f64) {
        self.search.visit(range, promise);
        self.is_done = true;
    }
}

#[cfg(test)]
mod tests;

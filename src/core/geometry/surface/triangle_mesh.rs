//! A surface of triangles: its boxes in a hierarchy, what it covers in plan, and which side of a triangle is
//! outside.
//!
//! # Method
//! The triangles are put in an order in which near ones follow each other: all are halved at the middle
//! triangle along the longest side of the box of their centres, and so are the halves (`order`). So every
//! range of triangles that is halved again and again has small boxes, and one tree serves all searches.
//!
//! # Guarantees
//! * A mesh is *closed* if each edge belongs to two triangles, once in each direction. Then the sign of the
//!   volume that a body encloses tells where outside is. A body within the box of the largest one is a void
//!   of it if it is turned the other way.
//! * The triangles of a mesh that is not closed count as facing up, whatever the order of their corners.
//! * A side of a triangle is *sharp* where the mesh ends, turns by more than about 6 degrees, or meets a
//!   triangle without an area or more than one other triangle.
//!
//! # Degenerate input
//! Triangles without an area are kept: their sides are places of the surface.
//!
//! # Cost
//! O(n log n) for n triangles.

mod bodies;
mod order;
mod sides;

use nalgebra::{Point3, Vector2, Vector3};

use super::patch::{Bounds, FlatPatch};
use super::{BezierSurface, Jet, Patch, Surface};
use crate::budget::{Budget, Stopped};
use crate::geometry::bounding_tree::{BoundingTree, Visitor};

/// Triangles between two checks of the budget.
pub(crate) const TRIANGLES_BETWEEN_CHECKS: usize = 65_536;

/// The largest coordinate of a corner, mm.
pub const LARGEST_MM: f64 = 1e6;

/// The z component of the unit normal above which a triangle faces up. Steeper triangles are walls.
pub const UPRIGHT: f64 = 1e-4;

/// Why triangles make no mesh.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum MeshError {
    #[error(transparent)]
    Stopped(#[from] Stopped),
    #[error("there are no triangles")]
    NoTriangles,
    #[error("triangle {triangle} names a corner that is not there")]
    NoCorner { triangle: usize },
    #[error("corner {point} is not a number or farther than {LARGEST_MM} mm from the origin")]
    TooFar { point: usize },
}

/// Triangles in space, mm.
#[derive(Debug, Clone)]
pub struct TriangleMesh {
    points: Vec<Point3<f64>>,
    triangles: Vec<[u32; 3]>,
    /// For each triangle, which sides are sharp; the first is from the first corner to the second.
    sharp: Vec<[bool; 3]>,
    /// Boxes of ranges of triangles.
    tree: BoundingTree<Bounds, [u32; 2]>,
    /// For each triangle, whether its normal by the order of its corners is turned round.
    turned: Vec<bool>,
    is_closed: bool,
    /// How far the surface for which the triangles stand may be from them, mm.
    deviation_mm: f64,
}

impl PartialEq for TriangleMesh {
    fn eq(&self, other: &Self) -> bool {
        self.points == other.points && self.triangles == other.triangles
    }
}

impl TriangleMesh {
    /// The mesh of `triangles`, which name their corners in `points` (mm). `deviation_mm` is the largest
    /// distance between the triangles and the surface for which they stand; zero for a mesh that is the part.
    ///
    /// # Errors
    /// One of [`MeshError`].
    pub fn new(
        points: Vec<Point3<f64>>,
        mut triangles: Vec<[u32; 3]>,
        deviation_mm: f64,
        budget: &Budget,
    ) -> Result<Self, MeshError> {
        if triangles.is_empty() {
            return Err(MeshError::NoTriangles);
        }
        // A comparison with what is no number does not hold.
        let is_near = |p: &Point3<f64>| p.iter().all(|x| x.abs() <= LARGEST_MM);
        if let Some(point) = points.iter().position(|p| !is_near(p)) {
            return Err(MeshError::TooFar { point });
        }
        let is_known = |corners: &[u32; 3]| corners.iter().all(|k| (*k as usize) < points.len());
        if let Some(triangle) = triangles.iter().position(|corners| !is_known(corners)) {
            return Err(MeshError::NoCorner { triangle });
        }
        let tree = order::order(&points, &mut triangles, budget)?;
        let sides::Sides { sharp, turned, is_closed } = sides::sides(&points, &triangles, budget)?;
        Ok(Self { points, triangles, sharp, tree, turned, is_closed, deviation_mm })
    }

    pub fn points(&self) -> &[Point3<f64>] {
        &self.points
    }

    /// The corners of the triangles, in the order of the mesh.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    pub fn deviation_mm(&self) -> f64 {
        self.deviation_mm
    }

    /// The box of all triangles, mm.
    pub fn bounds(&self) -> &Bounds {
        self.tree.volume()
    }

    /// Whether each edge belongs to two triangles, once in each direction.
    pub fn is_closed(&self) -> bool {
        self.is_closed
    }

    /// The corners of triangle `k`.
    pub fn corners(&self, k: usize) -> [Vector3<f64>; 3] {
        self.triangles[k].map(|corner| self.points[corner as usize].coords)
    }

    /// The normal of triangle `k`, of twice the length of its area; to the outside of a closed mesh, and up
    /// in any other.
    pub fn normal(&self, k: usize) -> Vector3<f64> {
        let [a, b, c] = self.corners(k);
        let normal = (b - a).cross(&(c - a));
        if self.turned[k] { -normal } else { normal }
    }

    /// The triangles as patches, in the order of the mesh, with the normals of [`Self::normal`].
    pub fn patches(&self) -> BezierSurface<FlatPatch> {
        let patch = |k: usize| {
            let ([a, b, c], [first, second, third]) = (self.corners(k), self.sharp[k]);
            if self.turned[k] {
                FlatPatch::triangle([a, c, b], [third, second, first])
            } else {
                FlatPatch::triangle([a, b, c], [first, second, third])
            }
        };
        BezierSurface::from_fn([self.triangles.len(), 1], |k, _| patch(k))
    }

    /// The places where the mesh ends or turns sharply, as lines; at most `most`, the first ones of the mesh.
    pub fn sharp_lines(&self, most: usize) -> Vec<[Point3<f64>; 2]> {
        let sides = (0..self.triangles.len()).flat_map(|k| {
            let corners = self.triangles[k];
            (0..3)
                .filter(move |side| self.sharp[k][*side])
                .map(move |side| [corners[side], corners[(side + 1) % 3]])
        });
        // A sharp side of two triangles is told once, where its corners are in order.
        let ends = |[from, to]: [u32; 2]| [from.min(to), from.max(to)];
        let mut seen = std::collections::BTreeSet::new();
        let lines = sides.map(ends).filter(|line| seen.insert(*line)).take(most);
        lines.map(|line| line.map(|corner| self.points[corner as usize])).collect()
    }

    /// The height of the highest triangle straight above or below a place, mm; `None` where there is none.
    pub fn height_at(&self, place: Vector2<f64>) -> Option<f64> {
        let mut search = Over { mesh: self, place, highest: None, wants_height: true };
        self.tree.search(&mut search);
        search.highest
    }

    /// Shows ranges of triangles to a visitor.
    pub fn search(&self, visitor: &mut impl Visitor<Bounds, [u32; 2]>) {
        self.tree.search(visitor);
    }

    /// Whether a triangle is straight above or below a place.
    pub fn covers(&self, place: Vector2<f64>) -> bool {
        let mut search = Over { mesh: self, place, highest: None, wants_height: false };
        self.tree.search(&mut search);
        search.highest.is_some()
    }
}

/// The patches whose normals point up: the part of a mesh that a cutter from above can finish. Upright walls
/// and undersides are left out. `None` without any.
pub fn facing_up(patches: &BezierSurface<FlatPatch>) -> Option<BezierSurface<FlatPatch>> {
    let is_up = |patch: &&FlatPatch| {
        let [_, a, b, c] = patch.corners;
        let normal = patch.jet(0.5, 0.5).normal();
        !is_sliver(&[a, b, c]) && normal.z > UPRIGHT * normal.norm()
    };
    let up: Vec<FlatPatch> = patches.patches().iter().filter(is_up).copied().collect();
    (!up.is_empty()).then(|| BezierSurface::from_fn([up.len(), 1], |k, _| up[k]))
}

/// A mesh seen from above: over its box, the heights of its highest triangles, and the least height of the
/// mesh beside them.
pub struct TopView<'a>(pub &'a TriangleMesh);

impl Surface for TopView<'_> {
    fn spans(&self) -> [usize; 2] {
        [1, 1]
    }

    /// Only the point is known: the derivatives along the box are those of a level surface.
    fn jet(&self, u: f64, v: f64) -> Jet {
        let Bounds { min, max } = *self.0.bounds();
        let size = max - min;
        let (x, y) = (min.x + u * size.x, min.y + v * size.y);
        let z = self.0.height_at(Vector2::new(x, y)).unwrap_or(min.z);
        let [du, dv] = [Vector3::x() * size.x, Vector3::y() * size.y];
        let [duu, duv, dvv] = [Vector3::zeros(); 3];
        Jet { point: Point3::new(x, y, z), du, dv, duu, duv, dvv }
    }
}

/// Twice the area of a triangle that is rounding, as a share of the square of its longest side.
const NO_AREA: f64 = 1e-12;

/// Height of a triangle up to which its normal says nothing of the surface, mm.
const SLIVER_MM: f64 = 1e-6;

/// The square of the longest side of a triangle, mm^2.
fn longest_squared([a, b, c]: &[Vector3<f64>; 3]) -> f64 {
    (b - a).norm_squared().max((c - b).norm_squared()).max((a - c).norm_squared())
}

/// The normal of a triangle by the order of its corners, of twice the length of its area; `None` where it
/// would be rounding.
pub(crate) fn normal(corners: &[Vector3<f64>; 3]) -> Option<Vector3<f64>> {
    let [a, b, c] = corners;
    let normal = (b - a).cross(&(c - a));
    (normal.norm() > NO_AREA * longest_squared(corners)).then_some(normal)
}

/// Whether the corners of a triangle are nearly on one line.
pub(crate) fn is_sliver(corners: &[Vector3<f64>; 3]) -> bool {
    let longest = longest_squared(corners);
    normal(corners).is_none_or(|normal| normal.norm_squared() <= SLIVER_MM * SLIVER_MM * longest)
}

/// Whether `place` lies in a triangle in plan, its sides included.
pub(crate) fn holds(corners: &[Vector3<f64>; 3], place: &Vector2<f64>) -> bool {
    let [a, b, c] = corners.map(|corner| corner.xy() - place);
    let turns = [a.perp(&b), b.perp(&c), c.perp(&a)];
    let area = (b - a).perp(&(c - a));
    area != 0.0 && turns.iter().all(|turn| turn * area >= 0.0)
}

/// A search for the highest triangle over a place, or for any.
struct Over<'a> {
    mesh: &'a TriangleMesh,
    place: Vector2<f64>,
    highest: Option<f64>,
    wants_height: bool,
}

impl Over<'_> {
    /// The height of a triangle over the place; `None` where it is beside it.
    fn height(&self, k: usize) -> Option<f64> {
        let corners = self.mesh.corners(k);
        let normal = normal(&corners)?;
        if !holds(&corners, &self.place) {
            return None;
        }
        let [a, b, c] = corners;
        let z = a.z - normal.xy().dot(&(self.place - a.xy())) / normal.z;
        Some(z.clamp(a.z.min(b.z).min(c.z), a.z.max(b.z).max(c.z)))
    }
}

impl Visitor<Bounds, [u32; 2]> for Over<'_> {
    fn promise(&self, bounds: &Bounds) -> f64 {
        let is_within = (0..2).all(|c| (bounds.min[c]..=bounds.max[c]).contains(&self.place[c]));
        if is_within { bounds.max.z } else { f64::NEG_INFINITY }
    }

    fn is_settled(&self, promise: f64) -> bool {
        promise == f64::NEG_INFINITY
            || self.highest.is_some_and(|highest| !self.wants_height || promise <= highest)
    }

    fn visit(&mut self, range: &[u32; 2], _promise: f64) {
        let heights = (range[0] as usize..range[1] as usize).filter_map(|k| self.height(k));
        self.highest = heights.fold(self.highest, |highest, z| Some(highest.map_or(z, |known| known.max(z))));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A block from the origin to `size`, with the corners of each triangle counterclockwise from outside.
    fn block(size: [f64; 3], is_turned: bool) -> TriangleMesh {
        let bit = |k: usize, c: usize| ((k >> c) & 1) as f64;
        let points = (0..8).map(|k| Point3::from([0, 1, 2].map(|c| bit(k, c) * size[c]))).collect();
        let sides = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let halves = sides.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]);
        let turn = |[a, b, c]: [u32; 3]| if is_turned { [a, c, b] } else { [a, b, c] };
        TriangleMesh::new(points, halves.map(turn).collect(), 0.0, &Budget::unlimited()).unwrap()
    }

    #[test]
    fn the_normals_of_a_block_point_out_in_any_order_of_the_corners() {
        for is_turned in [false, true] {
            let block = block([4.0, 3.0, 2.0], is_turned);
            assert!(block.is_closed());
            for k in 0..12 {
                let middle = block.corners(k).iter().sum::<Vector3<f64>>() / 3.0;
                assert!(block.normal(k).dot(&(middle - Vector3::new(2.0, 1.5, 1.0))) > 0.0);
            }
        }
    }

    /// The triangles of a mesh and of another beside it.
    fn both(one: &TriangleMesh, other: &TriangleMesh, by: Vector3<f64>) -> TriangleMesh {
        let n = one.points().len() as u32;
        let points = one.points().iter().copied().chain(other.points().iter().map(|p| p + by)).collect();
        let moved = other.triangles().iter().map(|triangle| triangle.map(|corner| corner + n));
        let triangles = one.triangles().iter().copied().chain(moved).collect();
        TriangleMesh::new(points, triangles, 0.0, &Budget::unlimited()).unwrap()
    }

    #[test]
    fn each_body_of_a_mesh_has_its_outside_and_voids_keep_theirs() {
        let (large, small) = (block([4.0, 3.0, 2.0], false), block([1.0, 1.0, 1.0], true));
        for (by, is_void) in [(Vector3::new(10.0, 0.0, 0.0), false), (Vector3::repeat(0.5), true)] {
            let mesh = both(&large, &small, by);
            assert!(mesh.is_closed());
            for k in 0..24 {
                let middle = mesh.corners(k).iter().sum::<Vector3<f64>>() / 3.0;
                let is_small =
                    mesh.corners(k).iter().all(|p| (0..3).all(|c| (by[c]..=by[c] + 1.0).contains(&p[c])));
                let own = if is_small { by + Vector3::repeat(0.5) } else { Vector3::new(2.0, 1.5, 1.0) };
                let is_outward = mesh.normal(k).dot(&(middle - own)) > 0.0;
                assert_eq!(is_outward, !(is_small && is_void), "{by}");
            }
        }
    }

    #[test]
    fn a_mesh_with_a_hole_is_open_and_faces_up() {
        let block = block([4.0, 3.0, 2.0], false);
        let some: Vec<[u32; 3]> = block.triangles()[1..].to_vec();
        let open = TriangleMesh::new(block.points().to_vec(), some, 0.0, &Budget::unlimited()).unwrap();
        assert!(!open.is_closed());
        assert!((0..11).all(|k| open.normal(k).z >= 0.0));
    }

    #[test]
    fn places_over_the_mesh_are_covered() {
        let block = block([4.0, 3.0, 2.0], false);
        for (place, is_over) in
            [([2.0, 1.0], true), ([4.0, 3.0], true), ([4.001, 1.0], false), ([-1.0, -1.0], false)]
        {
            assert_eq!(block.covers(place.into()), is_over, "{place:?}");
        }
    }

    #[test]
    fn wrong_triangles_are_refused() {
        let new = |points: Vec<[f64; 3]>, triangles: Vec<[u32; 3]>| {
            let points = points.into_iter().map(Point3::from).collect();
            TriangleMesh::new(points, triangles, 0.0, &Budget::unlimited()).unwrap_err()
        };
        let three = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        assert_eq!(new(three.clone(), vec![]), MeshError::NoTriangles);
        assert_eq!(new(three.clone(), vec![[0, 1, 3]]), MeshError::NoCorner { triangle: 0 });
        let far = vec![[0.0; 3], [f64::NAN, 0.0, 0.0], [0.0, 1.0, 0.0]];
        assert_eq!(new(far, vec![[0, 1, 2]]), MeshError::TooFar { point: 1 });
    }
}

//! Triangles within the polygons of one face.
//!
//! # Method
//! 1. The corners make a constrained Delaunay triangulation in the plane of the parameters, scaled so that a
//!    step of 1 along either parameter costs the same deviation. Sides that cross are to be divided.
//! 2. Rectangles of parameters are halved until their corners make fine triangles; the corners within the
//!    polygons become points. Knots where the surface is not smooth are lines of such corners.
//! 3. A triangle that may leave the surface too far gets a point at the centre of its circumscribed circle,
//!    or in the middle of its longest side, until there is none.
//!
//! # Cost
//! O(n log n) for n triangles, where few triangles need the third step.

use std::collections::HashMap;

use nalgebra::Point3;
use spade::handles::{FixedFaceHandle, FixedVertexHandle, InnerTag};
use spade::{Point2, PositionInTriangulation, Triangulation};
use toolpathd_core::budget::Budget;

use super::edges::Edges;
use super::inside::Inside;
use super::lattice::Lattice;
use super::mesh::{Mesh, Spot, inside, pair};
use super::polygons::{Node, Polygons, Side};
use super::surface_bounds::{SurfaceBounds, rectangle};
use super::unfilled::Unfilled;

/// Times that triangles are looked at and divided. Each time they become smaller by a third or more.
const MOST_SWEEPS: usize = 60;

/// A point nearer to a side than this, in steps, is left out: the side's own corners are enough.
const BESIDE_SIDE: f64 = 0.25;

/// Points between two looks at the budget.
const POINTS_PER_CHECK: usize = 1024;

/// Triangles of a face.
#[derive(Debug, Clone, Default)]
pub struct Filling {
    /// The face's own vertices: those of its polygons, and more.
    pub own: Vec<Point3<f64>>,
    pub triangles: Vec<[Node; 3]>,
    /// The most that a triangle leaves the surface, apart from gaps, mm.
    pub deviation_mm: f64,
}

/// The triangulation of a face while it is filled.
struct Fill<'a> {
    bounds: &'a SurfaceBounds<'a>,
    steps: [f64; 2],
    /// What the places in steps begin at.
    origin: [f64; 2],
    mesh: Mesh,
    own: Vec<Point3<f64>>,
    /// Whether the face is on one side only of a constraint, by its vertices.
    is_bound: HashMap<[usize; 2], bool>,
    allowed_mm: f64,
    most: usize,
}

/// The polygons as a triangulation without points inside: what crosses is found.
///
/// # Errors
/// Sides cross, or the polygons are no bounds.
pub fn check_sides(
    bounds: &SurfaceBounds,
    polygons: &Polygons,
    all: &Edges,
    allowed_mm: f64,
    budget: &Budget,
) -> Result<(), Unfilled> {
    Fill::of(bounds, polygons, all, allowed_mm, usize::MAX, budget).map(|_| ())
}

/// The triangles within the polygons of a face.
///
/// # Errors
/// Sides cross, there are too many triangles, or the budget has ended.
pub fn fill(
    bounds: &SurfaceBounds,
    polygons: &Polygons,
    all: &Edges,
    allowed_mm: f64,
    most: usize,
    budget: &Budget,
) -> Result<Filling, Unfilled> {
    let mut fill = Fill::of(bounds, polygons, all, allowed_mm, most, budget)?;
    if !matches!(bounds.surface, crate::step::surface::Surface::Plane { .. }) {
        fill.add_lattice(polygons, budget)?;
        fill.refine(budget)?;
    }
    fill.finish(budget)
}

impl<'a> Fill<'a> {
    /// The triangulation of the corners alone.
    fn of(
        bounds: &'a SurfaceBounds<'a>,
        polygons: &Polygons,
        all: &Edges,
        allowed_mm: f64,
        most: usize,
        budget: &Budget,
    ) -> Result<Self, Unfilled> {
        let places: Vec<[f64; 2]> = polygons.loops.iter().flatten().map(|corner| corner.at).collect();
        let domain = rectangle(&places);
        let steps = bounds.steps(domain, allowed_mm);
        if !steps.iter().all(|step| *step > 0.0 && step.is_finite()) {
            return Err(Unfilled::Failed("its parameters have no extent"));
        }
        let origin = domain.map(|[low, high]| (low + high) / 2.0);
        let mut fill = Self {
            bounds,
            steps,
            origin,
            mesh: Mesh::new(),
            own: polygons.own.clone(),
            is_bound: HashMap::new(),
            allowed_mm,
            most,
        };
        let handles = fill.add_corners(polygons, all, budget)?;
        let flat = flat_sides(polygons, &handles);
        if !flat.is_empty() {
            return Err(Unfilled::Crossed(flat));
        }
        fill.add_sides(&handles, budget)?;
        Ok(fill)
    }

    fn place(&self, at: [f64; 2]) -> Point2<f64> {
        let [x, y] = [0, 1].map(|k| {
            let x = (at[k] - self.origin[k]) / self.steps[k];
            // The predicates take no numbers below 1e-43.
            if x.abs() < 1e-30 { 0.0 } else { x }
        });
        Point2::new(x, y)
    }

    fn spot(&self, at: [f64; 2], node: Node) -> Spot {
        Spot { place: self.place(at), at, node, point: self.bounds.surface.point(at) }
    }

    fn add_corners(
        &mut self,
        polygons: &Polygons,
        _all: &Edges,
        budget: &Budget,
    ) -> Result<Vec<Vec<FixedVertexHandle>>, Unfilled> {
        let mut spots: Vec<Spot> = Vec::new();
        let mut numbers: HashMap<[u64; 2], usize> = HashMap::new();
        let mut loops = Vec::new();
        for corners in &polygons.loops {
            let mut of_loop = Vec::with_capacity(corners.len());
            for corner in corners {
                let spot = self.spot(corner.at, corner.node);
                let key = [spot.place.x + 0.0, spot.place.y + 0.0].map(f64::to_bits);
                let number = *numbers.entry(key).or_insert(spots.len());
                if number == spots.len() {
                    spots.push(spot);
                } else if spots[number].node != corner.node {
                    return Err(Unfilled::Failed("two of its vertices are at one place of its surface"));
                }
                of_loop.push(FixedVertexHandle::from_index(number));
            }
            loops.push(of_loop);
        }
        budget.check()?;
        if spots.len() > self.most {
            return Err(Unfilled::TooMany);
        }
        self.mesh = Mesh::bulk_load_cdt(spots, Vec::new())
            .map_err(|_| Unfilled::Failed("its parameters are too large"))?;
        Ok(loops)
    }

    fn add_sides(&mut self, loops: &[Vec<FixedVertexHandle>], budget: &Budget) -> Result<(), Unfilled> {
        let mut owners: HashMap<[usize; 2], Vec<[usize; 2]>> = HashMap::new();
        let mut crossed: Vec<[usize; 2]> = Vec::new();
        for (i, handles) in loops.iter().enumerate() {
            for k in 0..handles.len() {
                if k % POINTS_PER_CHECK == 0 {
                    budget.check()?;
                }
                let ends = [handles[k], handles[(k + 1) % handles.len()]];
                let key = pair(ends);
                if key[0] == key[1] {
                    continue;
                }
                owners.entry(key).or_default().push([i, k]);
                *self.is_bound.entry(key).or_insert(false) ^= true;
                if self.mesh.exists_constraint(ends[0], ends[1]) {
                    continue;
                }
                if !self.mesh.can_add_constraint(ends[0], ends[1]) {
                    crossed.push([i, k]);
                    let others = self.mesh.get_conflicting_edges_between_vertices(ends[0], ends[1]);
                    let keys = others.map(|edge| pair([edge.from().fix(), edge.to().fix()]));
                    crossed.extend(keys.filter_map(|key| owners.get(&key)).flatten());
                } else {
                    let path = self.mesh.try_add_constraint(ends[0], ends[1]);
                    if path.len() > 1 {
                        crossed.push([i, k]);
                    }
                }
            }
        }
        if crossed.is_empty() {
            return Ok(());
        }
        crossed.sort_unstable();
        crossed.dedup();
        Err(Unfilled::Crossed(crossed))
    }

    /// Adds the corners of rectangles over which the surface is nearly flat.
    fn add_lattice(&mut self, polygons: &Polygons, budget: &Budget) -> Result<(), Unfilled> {
        let polygons: Vec<Vec<[f64; 2]>> =
            polygons.loops.iter().map(|corners| corners.iter().map(|corner| corner.at).collect()).collect();
        let inside = Inside::new(&polygons);
        let lattice =
            Lattice { bounds: self.bounds, inside: &inside, allowed_mm: self.allowed_mm, most: self.most };
        let corners = lattice.corners(rectangle(&polygons.concat()), budget)?;
        let mut hint = FixedVertexHandle::from_index(0);
        for (k, at) in corners.into_iter().enumerate() {
            if k % POINTS_PER_CHECK == 0 {
                budget.check()?;
            }
            hint = self.add(at, BESIDE_SIDE, hint)?.unwrap_or(hint);
        }
        Ok(())
    }

    /// Adds a point of the surface within the face, unless it is on a side, nearer to one than `beside`, or
    /// there is one already.
    fn add(
        &mut self,
        at: [f64; 2],
        beside: f64,
        hint: FixedVertexHandle,
    ) -> Result<Option<FixedVertexHandle>, Unfilled> {
        let place = self.place(at);
        let is_free = match self.mesh.locate_with_hint(place, hint) {
            PositionInTriangulation::OnFace(face) => self.is_apart(face, place, beside),
            PositionInTriangulation::OnEdge(edge) => {
                let edge = self.mesh.directed_edge(edge);
                !edge.is_constraint_edge()
                    && [edge.face(), edge.rev().face()]
                        .iter()
                        .filter_map(|face| face.as_inner())
                        .all(|face| self.is_apart(face.fix(), place, beside))
            }
            _ => false,
        };
        if !is_free {
            return Ok(None);
        }
        if self.mesh.num_vertices() >= self.most {
            return Err(Unfilled::TooMany);
        }
        let spot = self.spot(at, Node::Own(self.own.len() as u32));
        self.own.push(spot.point);
        let added = self.mesh.insert_with_hint(spot, hint);
        added.map(Some).map_err(|_| Unfilled::Failed("its parameters are too large"))
    }

    /// Whether a place in a triangle is farther than `beside` from its sides that are bounds.
    fn is_apart(&self, face: FixedFaceHandle<InnerTag>, place: Point2<f64>, beside: f64) -> bool {
        let sides = self.mesh.face(face).adjacent_edges();
        let mut bounds = sides.iter().filter(|edge| edge.is_constraint_edge());
        bounds.all(|edge| edge.distance_2(place) > beside * beside)
    }

    /// Adds points until every triangle within the face is near the surface.
    fn refine(&mut self, budget: &Budget) -> Result<(), Unfilled> {
        for _ in 0..MOST_SWEEPS {
            budget.check()?;
            let wanted = self.wanted(budget)?;
            if wanted.is_empty() {
                return Ok(());
            }
            for (k, (at, hint)) in wanted.into_iter().enumerate() {
                if k % POINTS_PER_CHECK == 0 {
                    budget.check()?;
                }
                self.add(at, 0.0, hint)?;
            }
        }
        Err(Unfilled::Failed("its surface bends too sharply for triangles"))
    }

    /// Points for the triangles that are too far from the surface, each with a vertex near it.
    fn wanted(&self, budget: &Budget) -> Result<Vec<([f64; 2], FixedVertexHandle)>, Unfilled> {
        let is_inside = inside(&self.mesh, &self.is_bound);
        let mut wanted = Vec::new();
        for (k, face) in self.mesh.inner_faces().enumerate() {
            if k % POINTS_PER_CHECK == 0 {
                budget.check()?;
            }
            if !is_inside[face.index()] {
                continue;
            }
            let spots = face.vertices().map(|vertex| *vertex.data());
            let deviation = self.bounds.of_triangle(spots.map(|spot| spot.at), spots.map(|spot| spot.point));
            if deviation <= self.allowed_mm {
                continue;
            }
            let centre = face.circumcenter();
            let middle = face.center();
            // Corners nearly on one line have no centre.
            let has_centre = centre.x.is_finite() && centre.y.is_finite();
            let is_seen =
                has_centre && self.mesh.get_conflicting_edges_between_points(middle, centre).next().is_none();
            let is_in = is_seen
                && match self.mesh.locate_with_hint(centre, face.vertices()[0].fix()) {
                    PositionInTriangulation::OnFace(found) => {
                        is_inside[found.index()] && self.is_apart(found, centre, 0.1)
                    }
                    _ => false,
                };
            let place = if is_in {
                centre
            } else {
                self.longest_middle(&face.adjacent_edges().map(|edge| edge.fix())).unwrap_or(middle)
            };
            let at = [self.origin[0] + place.x * self.steps[0], self.origin[1] + place.y * self.steps[1]];
            wanted.push((at, face.vertices()[0].fix()));
        }
        Ok(wanted)
    }

    /// The middle of the longest side of a triangle that is no bound.
    fn longest_middle(&self, sides: &[spade::handles::FixedDirectedEdgeHandle; 3]) -> Option<Point2<f64>> {
        let sides = sides.map(|side| self.mesh.directed_edge(side));
        let free = sides.into_iter().filter(|side| !side.is_constraint_edge());
        let longest = free.max_by(|a, b| a.length_2().total_cmp(&b.length_2()))?;
        let [a, b] = longest.positions();
        Some(Point2::new((a.x + b.x) / 2.0, (a.y + b.y) / 2.0))
    }

    fn finish(self, budget: &Budget) -> Result<Filling, Unfilled> {
        let is_inside = inside(&self.mesh, &self.is_bound);
        let mut filling = Filling { own: Vec::new(), triangles: Vec::new(), deviation_mm: 0.0 };
        for (k, face) in self.mesh.inner_faces().enumerate() {
            if k % POINTS_PER_CHECK == 0 {
                budget.check()?;
            }
            if !is_inside[face.index()] {
                continue;
            }
            let spots = face.vertices().map(|vertex| *vertex.data());
            let deviation = self.bounds.of_triangle(spots.map(|spot| spot.at), spots.map(|spot| spot.point));
            filling.deviation_mm = filling.deviation_mm.max(deviation);
            let nodes = spots.map(|spot| spot.node);
            if nodes[0] != nodes[1] && nodes[1] != nodes[2] && nodes[2] != nodes[0] {
                filling.triangles.push(nodes);
            }
        }
        if filling.triangles.len() > self.most {
            return Err(Unfilled::TooMany);
        }
        if filling.triangles.is_empty() {
            return Err(Unfilled::Failed("its bounds enclose no triangle"));
        }
        filling.own = self.own;
        Ok(filling)
    }
}

/// Sides that are one line although they stand for different parts of edges, and sides without length.
fn flat_sides(polygons: &Polygons, loops: &[Vec<FixedVertexHandle>]) -> Vec<[usize; 2]> {
    let mut known: HashMap<[usize; 2], ([usize; 2], [usize; 2])> = HashMap::new();
    let mut flat = Vec::new();
    for (i, handles) in loops.iter().enumerate() {
        for k in 0..handles.len() {
            let Side::Edge { part, .. } = polygons.loops[i][k].side else { continue };
            let key = pair([handles[k], handles[(k + 1) % handles.len()]]);
            let (first, owner) = *known.entry(key).or_insert((part, [i, k]));
            if first != part {
                flat.extend([owner, [i, k]]);
            } else if key[0] == key[1] {
                flat.push([i, k]);
            }
        }
    }
    flat.sort_unstable();
    flat.dedup();
    flat
}

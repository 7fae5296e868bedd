//! Parts of patches. Each part knows which sides of its patch are sharp edges.

use nalgebra::Vector3;

use crate::geometry::surface::topology::Topology;
use crate::geometry::surface::{BezierSurface, Patch, Surface};

/// A part is upright where the z coordinate of its unit normal is smaller than this.
const UPRIGHT: f64 = 1e-9;

/// Fractions of a common side of two patches at which their normals are compared.
const SIDE_SAMPLES: [f64; 3] = [0.0, 0.5, 1.0];

/// Sine of the largest angle between the normals of two patches along a common side that is smooth, and so no
/// edge.
const SMOOTH: f64 = 0.1;

/// How far beside a part a point of the cutter may lie and still count as below the part, as a multiple of
/// its depth below.
const NEAR: f64 = 1.5;

/// Which sides of a patch are edges, where the surface turns sharply: u = 0, u = 1, v = 0, v = 1.
pub(super) type Sides = [bool; 4];

/// A part of a patch.
#[derive(Clone, Copy)]
pub(super) struct SubPatch<P> {
    pub(super) patch: P,
    /// The ranges of the patch's parameters that the part covers.
    ranges: [[f64; 2]; 2],
    edges: Sides,
}

/// Where the cutter's farthest point along m lies relative to a part. m points against the part's normal.
pub(super) struct Beneath {
    /// Whether the point lies below the part, or beside it by no more than about its depth.
    pub(super) is_near: bool,
    /// Whether an edge of the surface is nearer to the point than its depth.
    pub(super) is_at_edge: bool,
}

impl<P: Patch> SubPatch<P> {
    pub(super) fn new(patch: P, edges: Sides) -> Self {
        Self { patch, ranges: [[0.0, 1.0]; 2], edges }
    }

    pub(super) fn halves_along_u(&self) -> [Self; 2] {
        self.halves(0, self.patch.split_u())
    }

    pub(super) fn halves_along_v(&self) -> [Self; 2] {
        self.halves(1, self.patch.split_v())
    }

    fn halves(&self, axis: usize, patches: [P; 2]) -> [Self; 2] {
        let middle = 0.5 * (self.ranges[axis][0] + self.ranges[axis][1]);
        let mut halves = patches.map(|patch| Self { patch, ..*self });
        halves[0].ranges[axis][1] = middle;
        halves[1].ranges[axis][0] = middle;
        halves
    }

    /// The unit vector against the part's normal, which does not point up; `None` for an overhanging part.
    pub(super) fn against_normal(&self) -> Option<Vector3<f64>> {
        let [p00, p01, p10, p11] = self.patch.corners();
        let m = (p11 - p00).cross(&(p10 - p01)).try_normalize(0.0)?;
        if m.z < UPRIGHT { Vector3::new(m.x, m.y, m.z.min(0.0)).try_normalize(0.0) } else { None }
    }

    /// Where the point at `beside`, seen from the centre of the part, lies relative to the part along `m`.
    pub(super) fn beneath(&self, m: &Vector3<f64>, beside: &Vector3<f64>) -> Beneath {
        let [p00, p01, p10, p11] = self.patch.corners();
        let (along_u, along_v) = (0.5 * (p10 - p00 + p11 - p01), 0.5 * (p01 - p00 + p11 - p10));
        let [a, b, c] = [along_u.norm_squared(), along_u.dot(&along_v), along_v.norm_squared()];
        let [p, q] = [along_u.dot(beside), along_v.dot(beside)];
        let det = a * c - b * b;
        let place = [(c * p - b * q) / det, (a * q - b * p) / det];
        let at_center = beside.dot(m).max(0.0);
        let widths = [c, a].map(|squared| at_center * (squared / det).sqrt());
        let is_near = (0..2).all(|k| place[k].abs() <= 0.5 + NEAR * widths[k]);
        let is_at_edge = (0..2).any(|k| {
            let [from, to] = self.ranges[k];
            let reach = [-1.0, 1.0].map(|sign| from + (to - from) * (0.5 + place[k] + sign * widths[k]));
            let [goes_low, goes_high] = [reach[0] >= 0.0, reach[1] <= 1.0];
            (self.edges[2 * k] && !goes_low) || (self.edges[2 * k + 1] && !goes_high)
        });
        Beneath { is_near, is_at_edge }
    }
}

/// The edges of every patch, in the order of [`BezierSurface::patches`]. A seam with a kink is an edge of the
/// patches on both sides.
pub(super) fn edges<P: Patch>(surface: &BezierSurface<P>) -> Vec<Sides> {
    let [nu, nv] = surface.spans();
    let mut edges = vec![[false; 4]; nu * nv];
    for i in 0..nu {
        for j in 0..nv {
            let patch = surface.patch(i, j);
            let is_edge = |next: &P, places: &dyn Fn(f64) -> [[f64; 2]; 2]| {
                SIDE_SAMPLES.iter().any(|&t| {
                    let [own, other] = places(t);
                    let normals =
                        [patch.jet(own[0], own[1]), next.jet(other[0], other[1])].map(|jet| jet.normal());
                    let size = normals[0].norm() * normals[1].norm();
                    let is_smooth = normals[0].cross(&normals[1]).norm() <= SMOOTH * size;
                    !(is_smooth && normals[0].dot(&normals[1]) > 0.0)
                })
            };
            if i + 1 < nu && is_edge(surface.patch(i + 1, j), &|t| [[1.0, t], [0.0, t]]) {
                (edges[i * nv + j][1], edges[(i + 1) * nv + j][0]) = (true, true);
            }
            if j + 1 < nv && is_edge(surface.patch(i, j + 1), &|t| [[t, 1.0], [t, 0.0]]) {
                (edges[i * nv + j][3], edges[i * nv + j + 1][2]) = (true, true);
            }
        }
    }
    let [kink_u, kink_v] =
        Topology::of(surface).seams().map(|seam| seam.is_some_and(|seam| !seam.is_smooth()));
    for j in (0..nv).filter(|_| kink_u) {
        (edges[j][0], edges[(nu - 1) * nv + j][1]) = (true, true);
    }
    for i in (0..nu).filter(|_| kink_v) {
        (edges[i * nv][2], edges[i * nv + nv - 1][3]) = (true, true);
    }
    edges
}

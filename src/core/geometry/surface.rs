//! Surfaces: the data they are made from, their evaluation, and proofs about them.
//!
//! Every kind of surface ([`source`]) becomes a grid of Bezier patches. Patch (i, j) covers the parameters
//! from i to i + 1 along u, and from j to j + 1 along v. Evaluation, sections and proofs use only the
//! patches.

pub mod any_surface;
pub mod bezier;
pub mod curvature;
pub mod ferguson;
pub mod joints;
pub mod net_grid;
pub mod normal_sweep;
pub mod nurbs;
pub mod offset;
pub mod parallel_sweep;
pub mod patch;
pub mod point_grid;
pub mod ruled;
pub mod source;
pub mod topology;
pub mod vector_ball;

mod hermite;
mod swept;

pub use bezier::BezierSurface;
pub use patch::{BicubicPatch, Patch, RationalPatch};

use nalgebra::{Point3, Vector2, Vector3};

/// A point of a surface (mm) with its derivatives to second order (mm per unit of parameter).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Jet {
    pub point: Point3<f64>,
    pub du: Vector3<f64>,
    pub dv: Vector3<f64>,
    pub duu: Vector3<f64>,
    pub duv: Vector3<f64>,
    pub dvv: Vector3<f64>,
}

impl Jet {
    /// The normal du x dv, not of unit length.
    pub fn normal(&self) -> Vector3<f64> {
        self.du.cross(&self.dv)
    }

    /// The gradient dz/dx, dz/dy of the surface. Not finite where the surface is vertical or has no normal.
    pub fn gradient(&self) -> Vector2<f64> {
        let normal = self.normal();
        -normal.xy() / normal.z
    }
}

/// A surface that can be evaluated over the unit squares of its patches.
pub trait Surface: Sync {
    /// Numbers of patches along u and v.
    fn spans(&self) -> [usize; 2];

    /// The jet at (u, v). Outside the domain the nearest patch is extrapolated.
    fn jet(&self, u: f64, v: f64) -> Jet;
}

/// A rectangle of patches of a surface: index ranges along u and v, without the upper ends.
#[derive(Debug, Clone, Copy)]
pub struct PatchRange {
    pub i: [usize; 2],
    pub j: [usize; 2],
}

impl PatchRange {
    pub fn all([nu, nv]: [usize; 2]) -> Self {
        Self { i: [0, nu], j: [0, nv] }
    }

    /// The two halves, cut across the direction with more patches; `None` for a single patch.
    pub fn halves(self) -> Option<[Self; 2]> {
        let Self { i, j } = self;
        let (rows, columns) = (i[1] - i[0], j[1] - j[0]);
        if rows == 1 && columns == 1 {
            None
        } else if rows >= columns {
            let middle = i[0] + rows / 2;
            Some([Self { i: [i[0], middle], j }, Self { i: [middle, i[1]], j }])
        } else {
            let middle = j[0] + columns / 2;
            Some([Self { i, j: [j[0], middle] }, Self { i, j: [middle, j[1]] }])
        }
    }
}

/// The index of the unit span that contains `t`, out of `n` spans.
pub fn span_of(t: f64, n: usize) -> usize {
    (t.max(0.0) as usize).min(n - 1)
}

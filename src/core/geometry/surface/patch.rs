//! What all Bezier patches can do: give points and derivatives, be halved, and bound their points and
//! derivatives by their control points.
//!
//! Two types implement [`Patch`]: [`BicubicPatch`], small and fast, and [`RationalPatch`] of any degree up to
//! 7. Proofs use only this trait, so they hold for both types.

pub mod bicubic;
pub mod raise;
pub mod rational;

use nalgebra::Vector3;

pub use bicubic::BicubicPatch;
pub use rational::RationalPatch;

use super::Jet;
use super::vector_ball::VectorBall;
use crate::geometry::bounding_tree::Volume;

/// A patch over the unit square. Every point of the patch is a convex combination of the control points; mm.
pub trait Patch: Copy + Send + Sync + std::fmt::Debug {
    /// The jet at (u, v). Outside the unit square the patch is extrapolated.
    fn jet(&self, u: f64, v: f64) -> Jet;

    /// The point at the centre of the unit square.
    fn center(&self) -> Vector3<f64>;

    /// The degrees p along u and q along v. There are (p + 1)(q + 1) control points.
    fn degree(&self) -> [usize; 2];

    /// Every control point in space, that is, divided by its weight. The point (a, b), a along u, comes at
    /// the place a (q + 1) + b.
    fn control_points(&self) -> impl Iterator<Item = Vector3<f64>>;

    /// The corners (0, 0), (0, 1), (1, 0), (1, 1).
    fn corners(&self) -> [Vector3<f64>; 4];

    /// The halves u <= 1/2 and u >= 1/2, each over a unit square again.
    fn split_u(&self) -> [Self; 2];

    /// The halves v <= 1/2 and v >= 1/2, each over a unit square again.
    fn split_v(&self) -> [Self; 2];

    /// The same patch with u and v exchanged.
    fn transposed(&self) -> Self;

    /// The same patch with its unit square turned by a quarter: the side v = 1 becomes the side u = 1.
    fn turned(&self) -> Self;

    /// A straight patch that joins this one at u = 1 and continues along the tangents there. Its length is at
    /// least `reach` times the length of the tangent. `None` where a weight of a rational patch would come
    /// near zero, so that the continuation would come near infinity.
    fn continued(&self, reach: f64) -> Option<Self>;

    /// Sets that contain every value of the derivatives over the unit square.
    fn derivatives(&self) -> DerivativeBounds;

    /// Bounds over the unit square of the sum over k of `weights[k]` times the squared coordinate
    /// along `axes[k]`. Coordinates count from `origin`.
    fn bound_squares<const N: usize>(
        &self,
        origin: &Vector3<f64>,
        axes: &[Vector3<f64>; N],
        weights: &[f64; N],
    ) -> SquareBound;

    /// The two halves across the direction in which the patch is longer.
    fn split(&self) -> [Self; 2] {
        let [along_u, along_v] = self.extents();
        if along_u >= along_v { self.split_u() } else { self.split_v() }
    }

    /// The two halves across the direction along which the tangents turn more. Where neither direction turns
    /// twice as much as the other, the halves across the longer direction.
    fn split_by_bend(&self) -> [Self; 2] {
        let jet = self.jet(0.5, 0.5);
        let (along_u, along_v) = (jet.du.norm(), jet.dv.norm());
        let turned = jet.duv.norm();
        let by_u = jet.duu.norm() / along_u + turned / along_v;
        let by_v = turned / along_u + jet.dvv.norm() / along_v;
        if by_u > 2.0 * by_v {
            self.split_u()
        } else if by_v > 2.0 * by_u {
            self.split_v()
        } else {
            self.split()
        }
    }

    /// Lengths along u and along v, mm: for each direction the longer chord of the two boundary curves.
    fn extents(&self) -> [f64; 2] {
        let [p00, p01, p10, p11] = self.corners();
        [(p10 - p00).norm().max((p11 - p01).norm()), (p01 - p00).norm().max((p11 - p10).norm())]
    }

    /// A box that contains the patch: the box of its control points.
    fn bounds(&self) -> Bounds {
        let mut bounds = Bounds::EMPTY;
        self.control_points().for_each(|p| bounds.include(&p));
        bounds
    }

    /// The least coordinate of the control points along `direction`. No point of the patch has a smaller one.
    fn lowest_along(&self, direction: &Vector3<f64>) -> f64 {
        self.control_points().map(|p| p.dot(direction)).fold(f64::INFINITY, f64::min)
    }

    /// How much the coordinate of the control points along `direction` varies, mm: the largest range over a
    /// row of constant v, and over a row of constant u.
    fn spreads(&self, direction: &Vector3<f64>) -> [f64; 2];

    /// Whether every control point, and so the whole patch, lies ahead of `origin` along `direction`.
    fn is_ahead(&self, origin: &Vector3<f64>, direction: &Vector3<f64>) -> bool {
        self.control_points().all(|p| (p - origin).dot(direction) > 0.0)
    }
}

/// Sets that contain the derivatives everywhere on a patch, mm per unit of parameter. Rounding is included.
#[derive(Debug, Clone, Copy)]
pub struct DerivativeBounds {
    pub du: VectorBall,
    pub dv: VectorBall,
    pub duu: VectorBall,
    pub duv: VectorBall,
    pub dvv: VectorBall,
}

impl DerivativeBounds {
    /// A set that contains the normals du x dv.
    pub fn normal(&self) -> VectorBall {
        self.du.cross(self.dv)
    }
}

/// Bounds from the Bernstein coefficients of a sum of squares.
#[derive(Debug, Clone, Copy)]
pub struct SquareBound {
    /// The least coefficient, mm^2: a lower bound of the sum.
    pub lowest: f64,
    /// The largest coefficient, mm^2: an upper bound of the sum.
    pub highest: f64,
    /// The largest term of the sums, mm^2. The rounding error of the coefficients is proportional to it.
    pub magnitude: f64,
    /// The largest absolute second differences of the coefficients along u and v, mm^2.
    pub bends: [f64; 2],
}

/// The largest range of `value(a, b)` over a in 0..=p with b fixed, and over b in 0..=q with a fixed.
fn spreads_of([p, q]: [usize; 2], value: impl Fn(usize, usize) -> f64) -> [f64; 2] {
    let spread = |values: &mut dyn Iterator<Item = f64>| {
        let [low, high] =
            values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| [low.min(x), high.max(x)]);
        high - low
    };
    let along_u = (0..=q).map(|b| spread(&mut (0..=p).map(|a| value(a, b)))).fold(0.0, f64::max);
    let along_v = (0..=p).map(|a| spread(&mut (0..=q).map(|b| value(a, b)))).fold(0.0, f64::max);
    [along_u, along_v]
}

/// An axis-aligned box, mm.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bounds {
    pub min: Vector3<f64>,
    pub max: Vector3<f64>,
}

impl Bounds {
    pub const EMPTY: Bounds = Bounds {
        min: Vector3::new(f64::INFINITY, f64::INFINITY, f64::INFINITY),
        max: Vector3::new(f64::NEG_INFINITY, f64::NEG_INFINITY, f64::NEG_INFINITY),
    };

    pub fn include(&mut self, p: &Vector3<f64>) {
        self.min = self.min.inf(p);
        self.max = self.max.sup(p);
    }

    pub fn union(&self, other: &Bounds) -> Bounds {
        Bounds { min: self.min.inf(&other.min), max: self.max.sup(&other.max) }
    }

    /// The largest absolute coordinate.
    pub fn magnitude(&self) -> f64 {
        self.min.amax().max(self.max.amax())
    }
}

impl Volume for Bounds {
    fn joined(&self, other: &Self) -> Self {
        self.union(other)
    }
}

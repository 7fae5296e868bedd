//! The parts into which a surface is divided for the search of contacts: small subpatches, in a hierarchy of
//! boxes. Each part has its own bounds of place and derivatives.
//!
//! A search halves parts further. The halves are kept for later searches, which mostly need the same halves:
//! the cutter has moved little. They do not change the answers, only the time.

use std::ops::Deref;
use std::rc::Rc;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicUsize, Ordering};

use nalgebra::{Vector2, Vector3};

use crate::budget::{Budget, Stopped};
use crate::geometry::bounding_tree::{BoundingTree, Visitor, Volume};
use crate::geometry::surface::patch::{Bounds, DerivativeBounds, Patch};
use crate::geometry::surface::vector_ball::VectorBall;
use crate::geometry::surface::{BezierSurface, PatchRange, Surface};

/// Size of the parts, as a share of the cutter's radius. Parts are larger if this size makes too many.
const PART_SIZE: f64 = 0.4;

/// Number of parts, about, that a surface with few patches may have.
const PART_LIMIT: usize = 20_000;

/// Slope of a part above which its cover has a level plane.
const STEEPEST_COVER: f64 = 1e3;

/// Slope above which a part counts as steep: it lies beside the cutter or far up on its side.
const LEAST_STEEPNESS: f64 = 5.0;

/// Sine of the angle between a part's normal and the vertical up to which the part counts as level.
const LEVEL_SHARE: f64 = 1e-9;

/// Depth to which a patch is halved when the tree is built.
const DEPTH_LIMIT: u32 = 14;

/// Rounding of a sum of squared coordinates, as a share of its largest term.
const ROUNDING: f64 = 2e-13;

/// Share that is more than enough for the rounding of such a sum at one point.
const NEARLY: f64 = 1e-9;

/// Most memory for halves that are kept, bytes. Halves beyond it are made again for each search: with less
/// memory the searches of a long job get slower, with more a request takes memory from others.
const KEPT_BYTES: usize = 32 << 20;

/// A part of a patch, over a unit square of its own.
#[derive(Debug)]
pub(super) struct SubPatch<P> {
    pub(super) patch: P,
    pub(super) bounds: Bounds,
    /// The middle of the part's box in plan; `half_diagonal` is half the diagonal of the box in plan, mm.
    pub(super) center: Vector2<f64>,
    pub(super) half_diagonal: f64,
    /// Bounds of the derivatives, once a search has needed them.
    bends: OnceLock<Bends>,
    /// The halves, once a search has needed and kept them.
    halves: OnceLock<Box<[SubPatch<P>; 2]>>,
    /// The parameters of the surface at the part's start.
    pub(super) start: [f64; 2],
    /// How much the parameters of the surface grow over the part, each way.
    pub(super) scale: [f64; 2],
    /// The unit vector in plan at right angles to the part; `None` if the part is level.
    pub(super) outward: Option<Vector2<f64>>,
    /// The same as `outward`, but only if the part is steep.
    pub(super) facing: Option<Vector2<f64>>,
}

/// Bounds of the derivatives of a part, mm per unit of its parameters.
#[derive(Debug, Clone, Copy)]
pub(super) struct Bends {
    pub(super) derivatives: DerivativeBounds,
    /// The first derivatives in plan, by u and by v.
    pub(super) first: [PlanBall; 2],
    /// Largest lengths in plan of the second derivatives: by u twice, by u and v, by v twice.
    pub(super) second: [f64; 3],
}

/// Every vector in plan within `radius` of `center`.
#[derive(Debug, Clone, Copy)]
pub(super) struct PlanBall {
    pub(super) center: Vector2<f64>,
    pub(super) radius: f64,
}

impl Bends {
    fn of(patch: &impl Patch) -> Self {
        let derivatives = patch.derivatives();
        let DerivativeBounds { du, dv, duu, duv, dvv } = &derivatives;
        let second = [duu, duv, dvv].map(|ball| ball.center.xy().norm() + ball.radius);
        // No place is farther than 1/2 from the centre, along u and along v.
        let [by_u, by_both, by_v] = second.map(|most| 0.5 * most);
        let jet = patch.jet(0.5, 0.5);
        let in_plan = |ball: &VectorBall, at_center: &Vector3<f64>, change: f64| {
            let changed = PlanBall { center: at_center.xy(), radius: change };
            if change < ball.radius {
                changed
            } else {
                PlanBall { center: ball.center.xy(), radius: ball.radius }
            }
        };
        let first = [in_plan(du, &jet.du, by_u + by_both), in_plan(dv, &jet.dv, by_both + by_v)];
        Self { derivatives, first, second }
    }
}

impl<P: Patch> SubPatch<P> {
    fn new(patch: P, start: [f64; 2], scale: [f64; 2]) -> Self {
        let bounds = patch.bounds();
        let center = (0.5 * (bounds.min + bounds.max)).xy();
        let half_diagonal = (0.5 * (bounds.max - bounds.min)).xy().norm();
        let [p00, p01, p10, p11] = patch.corners();
        let normal = (p11 - p00).cross(&(p01 - p10));
        let outward = normal.xy().try_normalize(LEVEL_SHARE * normal.norm());
        let is_steep = normal.xy().norm() > LEAST_STEEPNESS * normal.z.abs();
        let facing = outward.filter(|_| is_steep);
        let (bends, halves) = (OnceLock::new(), OnceLock::new());
        Self { patch, bounds, center, half_diagonal, bends, halves, start, scale, outward, facing }
    }

    /// Bounds of the derivatives.
    pub(super) fn bends(&self) -> &Bends {
        self.bends.get_or_init(|| Bends::of(&self.patch))
    }

    /// The direction across which the part is halved, the longer one: 0 for u, 1 for v.
    fn longer(&self) -> usize {
        let [along_u, along_v] = self.patch.extents();
        usize::from(along_u < along_v)
    }

    /// The halves across the longer direction.
    fn cut(&self) -> [Self; 2] {
        let axis = self.longer();
        let patches = if axis == 0 { self.patch.split_u() } else { self.patch.split_v() };
        let mut scale = self.scale;
        scale[axis] *= 0.5;
        let mut middle = self.start;
        middle[axis] += scale[axis];
        let [low, high] = patches;
        [Self::new(low, self.start, scale), Self::new(high, middle, scale)]
    }

    /// The place of the part nearest to parameters of the surface, in parameters of the part.
    pub(super) fn nearest(&self, place: [f64; 2]) -> [f64; 2] {
        std::array::from_fn(|k| ((place[k] - self.start[k]) / self.scale[k]).clamp(0.0, 1.0))
    }

    /// The corner of the part that is nearest to a place in plan.
    pub(super) fn nearest_corner(&self, place: &Vector2<f64>) -> [f64; 2] {
        let corners = [[0.0, 0.0], [0.0, 1.0], [1.0, 0.0], [1.0, 1.0]];
        let distances = self.patch.corners().map(|corner| (corner.xy() - place).norm_squared());
        let nearest = (0..4).min_by(|&a, &b| distances[a].total_cmp(&distances[b]));
        corners[nearest.unwrap_or(0)]
    }

    /// The parameters of the surface at a place of the part.
    pub(super) fn on_surface(&self, place: [f64; 2]) -> [f64; 2] {
        std::array::from_fn(|k| self.start[k] + self.scale[k] * place[k])
    }

    /// The middle of the part's box.
    pub(super) fn middle(&self) -> Vector3<f64> {
        0.5 * (self.bounds.min + self.bounds.max)
    }

    /// Whether a sum is proved to be at least `least` mm^2 for every point of the part: the sum of `weights`
    /// times the squared coordinates of the point, along `axes` from `origin`. Rounding is not counted.
    pub(super) fn is_beyond<const N: usize>(
        &self,
        origin: &Vector3<f64>,
        axes: &[Vector3<f64>; N],
        weights: &[f64; N],
        least: f64,
    ) -> bool {
        let squares = |p: &Vector3<f64>| -> f64 {
            axes.iter().zip(weights).map(|(axis, weight)| weight * axis.dot(&(p - origin)).powi(2)).sum()
        };
        let is_near = |p: &Vector3<f64>| squares(p) < (1.0 - NEARLY) * least;
        // The corners mostly show at once that the sum is too small.
        if self.patch.corners().iter().any(is_near) {
            return false;
        }
        let squares = self.patch.bound_squares(origin, axes, weights);
        squares.lowest + ROUNDING * squares.magnitude.max(least) >= least
    }

    pub(super) fn size(&self) -> f64 {
        (self.bounds.max - self.bounds.min).amax()
    }
}

/// A part that the tree keeps, or one that only a single search needs.
#[derive(Debug, Clone)]
pub(super) enum Held<'t, P> {
    Kept(&'t SubPatch<P>),
    Own(Rc<SubPatch<P>>),
}

impl<P> Deref for Held<'_, P> {
    type Target = SubPatch<P>;

    fn deref(&self) -> &SubPatch<P> {
        match self {
            Self::Kept(part) => part,
            Self::Own(part) => part,
        }
    }
}

/// A box, and a plane above everything in the box.
#[derive(Debug, Clone, Copy)]
pub(super) struct Cover {
    pub(super) bounds: Bounds,
    /// The gradient of the plane.
    gradient: Vector2<f64>,
    /// The height of the plane over the centre of the box, mm.
    height: f64,
}

impl Cover {
    fn of<P: Patch>(part: &SubPatch<P>) -> Self {
        let gradient = part.patch.jet(0.5, 0.5).gradient();
        let gradient = if gradient.norm() < STEEPEST_COVER { gradient } else { Vector2::zeros() };
        let center = part.center;
        let over = |p: Vector3<f64>| p.z - gradient.dot(&(p.xy() - center));
        let height = part.patch.control_points().map(over).fold(f64::NEG_INFINITY, f64::max);
        Self { bounds: part.bounds, gradient, height }
    }

    /// Upper bound of how far anything under the cover lies above the plane that has `gradient` and is zero
    /// at `at`, mm.
    pub(super) fn highest_over(&self, gradient: &Vector2<f64>, at: &Vector2<f64>) -> f64 {
        let center = (0.5 * (self.bounds.min + self.bounds.max)).xy();
        let half = (0.5 * (self.bounds.max - self.bounds.min)).xy();
        self.height - gradient.dot(&(center - at)) + (self.gradient - gradient).abs().dot(&half)
    }
}

impl Volume for Cover {
    fn joined(&self, other: &Self) -> Self {
        let bounds = self.bounds.union(&other.bounds);
        let gradient = 0.5 * (self.gradient + other.gradient);
        let center = (0.5 * (bounds.min + bounds.max)).xy();
        let height = self.highest_over(&gradient, &center).max(other.highest_over(&gradient, &center));
        Self { bounds, gradient, height }
    }
}

/// The parts of a surface, with the covers over them.
pub(super) struct Tree<P> {
    /// The hierarchy of covers over the indices of the parts.
    covers: BoundingTree<Cover, usize>,
    pub(super) parts: Vec<SubPatch<P>>,
    /// How each patch is divided into parts.
    divisions: Vec<Division>,
    /// For each patch the index of its whole division.
    roots: Vec<usize>,
    /// Number of parts whose halves are kept, or are to be kept.
    n_kept: AtomicUsize,
}

/// A range of a patch: one part, or two ranges that meet where the parameter along `axis` is `middle`.
#[derive(Debug)]
enum Division {
    Part(usize),
    Halved { axis: usize, middle: f64, halves: [usize; 2] },
}

impl<P: Patch> Tree<P> {
    /// Divides a surface into parts that are small against a cutter of `radius` mm.
    pub(super) fn new(surface: &BezierSurface<P>, radius: f64, budget: &Budget) -> Result<Self, Stopped> {
        let area: f64 = surface.patches().iter().map(|p| p.extents()).map(|[u, v]| u * v).sum();
        let size = (PART_SIZE * radius).max((area / PART_LIMIT as f64).sqrt());
        let mut tree = Self {
            covers: BoundingTree::default(),
            parts: Vec::new(),
            divisions: Vec::new(),
            roots: vec![0; surface.patches().len()],
            n_kept: AtomicUsize::new(0),
        };
        tree.add_patches(surface, PatchRange::all(surface.spans()), size, budget)?;
        Ok(tree)
    }

    fn add_patches(
        &mut self,
        surface: &BezierSurface<P>,
        range: PatchRange,
        size: f64,
        budget: &Budget,
    ) -> Result<usize, Stopped> {
        let Some([first, second]) = range.halves() else {
            budget.check()?;
            let (i, j) = (range.i[0], range.j[0]);
            let part = SubPatch::new(*surface.patch(i, j), [i as f64, j as f64], [1.0, 1.0]);
            let [node, root] = self.add_part(part, size, DEPTH_LIMIT);
            self.roots[i * surface.spans()[1] + j] = root;
            return Ok(node);
        };
        let first = self.add_patches(surface, first, size, budget)?;
        let second = self.add_patches(surface, second, size, budget)?;
        Ok(self.covers.join([first, second]))
    }

    /// Adds a part, or its subparts if it is too large. Returns the indices of the cover's node and of the
    /// division.
    fn add_part(&mut self, part: SubPatch<P>, size: f64, depth: u32) -> [usize; 2] {
        let [along_u, along_v] = part.patch.extents();
        if depth == 0 || along_u.max(along_v) <= size || self.parts.len() >= 4 * PART_LIMIT {
            let cover = Cover::of(&part);
            self.parts.push(part);
            self.divisions.push(Division::Part(self.parts.len() - 1));
            return [self.covers.add(cover, self.parts.len() - 1), self.divisions.len() - 1];
        }
        let (axis, halves) = (part.longer(), part.cut());
        let middle = halves[1].start[axis];
        let [first, second] = halves.map(|half| self.add_part(half, size, depth - 1));
        self.divisions.push(Division::Halved { axis, middle, halves: [first[1], second[1]] });
        [self.covers.join([first[0], second[0]]), self.divisions.len() - 1]
    }

    /// The halves of a part across its longer direction.
    pub(super) fn halves<'t>(&'t self, part: &Held<'t, P>) -> [Held<'t, P>; 2] {
        if let Held::Kept(part) = part {
            let has_room = || {
                let most = KEPT_BYTES / (2 * size_of::<SubPatch<P>>());
                self.n_kept.fetch_add(1, Ordering::Relaxed) < most
            };
            if part.halves.get().is_some() || has_room() {
                return part.halves.get_or_init(|| Box::new(part.cut())).each_ref().map(Held::Kept);
            }
        }
        part.cut().map(|half| Held::Own(Rc::new(half)))
    }

    /// Shows `look` parts of a patch that together contain the range from `low` to `high` of the surface's
    /// parameters. A part for which `look` returns `false` is halved, up to `most` times.
    pub(super) fn over_range(
        &self,
        patch: usize,
        [low, high]: [[f64; 2]; 2],
        most: u32,
        look: &mut impl FnMut(&SubPatch<P>, bool) -> bool,
    ) {
        let mut open = vec![self.roots[patch]];
        while let Some(k) = open.pop() {
            match self.divisions[k] {
                Division::Part(part) => {
                    let mut parts = vec![(Held::Kept(&self.parts[part]), most)];
                    while let Some((part, most)) = parts.pop() {
                        if !look(&part, most == 0) {
                            let axis = part.longer();
                            let middle = part.start[axis] + 0.5 * part.scale[axis];
                            let [first, second] = self.halves(&part);
                            parts.extend((low[axis] <= middle).then_some((first, most - 1)));
                            parts.extend((high[axis] >= middle).then_some((second, most - 1)));
                        }
                    }
                }
                Division::Halved { axis, middle, halves: [first, second] } => {
                    open.extend((low[axis] <= middle).then_some(first));
                    open.extend((high[axis] >= middle).then_some(second));
                }
            }
        }
    }

    /// The box of the whole surface.
    pub(super) fn bounds(&self) -> &Bounds {
        &self.covers.volume().bounds
    }

    /// Shows the visitor the parts that may matter to it, the more promising parts first.
    pub(super) fn visit<'t, V: PartVisitor<'t, P>>(&'t self, visitor: &mut V) {
        self.covers.search(&mut OfParts { parts: &self.parts, visitor });
    }
}

/// A search among parts.
pub(super) trait PartVisitor<'t, P> {
    /// Upper bound of what may be found under a cover.
    fn promise(&self, cover: &Cover) -> f64;

    /// Whether a promise no longer matters.
    fn is_settled(&self, promise: f64) -> bool;

    fn visit(&mut self, part: Held<'t, P>, promise: f64);
}

/// A search for indices of parts.
struct OfParts<'t, 'v, P, V> {
    parts: &'t [SubPatch<P>],
    visitor: &'v mut V,
}

impl<'t, P, V: PartVisitor<'t, P>> Visitor<Cover, usize> for OfParts<'t, '_, P, V> {
    fn promise(&self, cover: &Cover) -> f64 {
        self.visitor.promise(cover)
    }

    fn is_settled(&self, promise: f64) -> bool {
        self.visitor.is_settled(promise)
    }

    fn visit(&mut self, part: &usize, promise: f64) {
        self.visitor.visit(Held::Kept(&self.parts[*part]), promise);
    }
}

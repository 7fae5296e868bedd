//! How deep a moving cutter cuts into a surface: an upper bound that knows nothing of how the path was made.
//!
//! # Method
//! A cutter is everything within its corner radius of a convex core: a level disc with all that stands above
//! it (`solid`). While the tip follows a curve, a surface point P is as deep in the cutter as it is from the
//! cutter's outside; the deepest P is wanted. It is found by branch and bound over pairs of a piece of the
//! path and a part of a patch with its control net:
//! 1. *Planes*: for a unit vector m that does not point up, P is no deeper than reach(m) + max m . C - min m
//!    . P, with C over the piece and P over the control points of the part. Four m are tried: away from the
//!    core, against the part's normal, down, and to the side.
//! 2. *Ball*: a ball cutter holds the cutter and touches it along the circle that faces along m; a ball
//!    cutter is its own. The squared distance to a line, to a point, or (`ball`) a lower bound of that to a
//!    circle is a polynomial of twice the part's degree, or the quotient of two. Its least Bernstein
//!    coefficient bounds it. Along the line of contact this polynomial hardly varies, so the bound is tight
//!    on large parts.
//! 3. *Shank*: a point of the part that is above the ball's centre keeps from its axis at least what m shows,
//!    over the length of the horizontal part of m. Where this is enough, the ball alone matters.
//! 4. *Rims*: a sharp rim reaches farther below a slope than any point of the slope is deep in the cutter, by
//!    up to the root of 2. Where the lowest point of the cutter lies below the part, and no edge of the
//!    surface is nearer than that, the m against the part's normal counts for more than the others (`planes`,
//!    `part`), so that the bound covers both depths.
//! 5. An undecided pair is halved: the piece or the part, whichever reaches farther along m. A pair whose
//!    bound is no deeper than the deepest penetration found so far is dropped, and one that is small against
//!    the gap is as good as exact.
//!
//! # Guarantees
//! `bound_mm` is never below the true depth of a surface point in the cutter, for every point of every move;
//! rounding is counted. The cutter reaches no farther below the surface either, where the surface is smooth
//! around the place. It exceeds the larger of both by about `gap` and the slack of the path, unless the limit
//! of work is reached, where it is larger but still a bound. `found_mm` is the depth of a surface point.
//! Nothing about the path is assumed, nor about the surface beyond its nets.
//!
//! # Degenerate input
//! Curves of length zero are points. Helices are replaced by chords, and the chords' height is counted.
//!
//! # Cost
//! O(n log m) for n pieces of path and m patches, and O(1) parts examined for a piece. In the benchmark a
//! move of a ball takes 35 microseconds, whether there are a thousand or four thousand.

mod ball;
mod part;
mod piece;
mod planes;
mod solid;

use nalgebra::{Point3, Vector3};

use crate::budget::{Budget, Stopped};
use crate::geometry::best_first::BestFirst;
use crate::geometry::bounding_tree::{BoundingTree, Visitor};
use crate::geometry::curve::Curve;
use crate::geometry::surface::patch::Bounds;
use crate::geometry::surface::{BezierSurface, Patch, Surface};
use crate::machining::cutter::Cutter;
use part::{Sides, SubPatch};
use piece::PathPiece;
use planes::{Planes, Shown, sideways};
use solid::Solid;

/// Pairs halved for one piece; beyond this the bound at hand is taken.
const PAIR_LIMIT: usize = 20_000;

/// Pairs of a part and a piece that are shorter than this part of the gap are not halved: their bound is as
/// good as exact.
const SMALLEST: f64 = 0.25;

/// Where piece and part reach less far along m than this part of the bound, something else keeps it large:
/// the longer one is halved.
const LEAST_SPREAD: f64 = 1e-3;

/// Pairs between two looks at the budget.
const PAIRS_BETWEEN_CHECKS: usize = 256;

/// Rounding of one bound in parts of the coordinates' magnitude: some hundred operations of half an ulp each.
const ROUNDING: f64 = 1e-13;

/// The deepest penetration of a cutter into a surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Penetration {
    /// Proved upper bound, mm, zero or more.
    pub bound_mm: f64,
    /// The deepest that was found, mm; zero where none was.
    pub found_mm: f64,
    /// The surface point where it was found.
    pub at: Option<Point3<f64>>,
}

impl Penetration {
    pub const NONE: Penetration = Penetration { bound_mm: 0.0, found_mm: 0.0, at: None };

    /// The deepest of this and of `other`.
    pub fn or_deeper(self, other: Self) -> Self {
        let deeper = if other.found_mm > self.found_mm { other } else { self };
        Self { bound_mm: self.bound_mm.max(other.bound_mm), ..deeper }
    }
}

/// A surface and a cutter made ready for the question how deep the cutter cuts.
pub struct GougeProof<'a, P> {
    surface: &'a BezierSurface<P>,
    tree: BoundingTree<Bounds, [usize; 2]>,
    /// Of each patch.
    edges: Vec<Sides>,
    solid: Solid,
    /// Height of the corner circle's centre over the tip, mm.
    rise: f64,
    /// The largest absolute coordinate of a control point, mm.
    magnitude: f64,
    /// Length of the pieces into which a path is cut before the search, mm: the mean size of a patch, at
    /// least the cutter's diameter.
    piece_length: f64,
}

/// A search for the patches whose boxes meet a box.
struct Near {
    reach: Bounds,
    patches: Vec<[usize; 2]>,
}

impl Visitor<Bounds, [usize; 2]> for Near {
    fn promise(&self, bounds: &Bounds) -> f64 {
        let is_apart = (0..3).any(|c| bounds.min[c] > self.reach.max[c] || bounds.max[c] < self.reach.min[c]);
        if is_apart { -1.0 } else { 1.0 }
    }

    fn is_settled(&self, promise: f64) -> bool {
        promise < 0.0
    }

    fn visit(&mut self, patch: &[usize; 2], _promise: f64) {
        self.patches.push(*patch);
    }
}

impl<'a, P: Patch> GougeProof<'a, P> {
    /// The axis of `cutter` is along +z. With `stock` mm to be left on the surface, the cutter counts as that
    /// much larger all around.
    pub fn new(surface: &'a BezierSurface<P>, cutter: &Cutter, stock: f64) -> Self {
        let tree = surface.bounding_tree();
        let magnitude = tree.volume().magnitude();
        let [nu, nv] = surface.spans();
        let sizes = surface.patches().iter().map(Patch::extents);
        let mean_size = sizes.map(|[u, v]| u.max(v)).sum::<f64>() / (nu * nv) as f64;
        let solid = Solid { flat: cutter.flat_radius(), corner: cutter.corner_radius() + stock };
        let piece_length = mean_size.max(2.0 * solid.radius());
        let edges = if solid.flat > 0.0 { part::edges(surface) } else { vec![[false; 4]; nu * nv] };
        Self { surface, tree, edges, solid, rise: cutter.corner_radius(), magnitude, piece_length }
    }

    /// Raises `deepest` to the penetration of the cutter while its tip follows `tip`, to within `gap` mm.
    /// The control may leave the curve by `slack` mm; that much is added to the bound.
    ///
    /// # Errors
    /// Only the budget's stop.
    pub fn penetrate(
        &self,
        tip: &Curve,
        slack: f64,
        gap: f64,
        deepest: &mut Penetration,
        budget: &Budget,
    ) -> Result<(), Stopped> {
        for piece in piece::pieces(tip, self.rise, self.piece_length, slack, 0.25 * gap) {
            budget.check()?;
            let mut near = Near { reach: piece.reach(&self.solid), patches: Vec::new() };
            self.tree.search(&mut near);
            // What the slack adds is the same for every part, so the search need not know it; but a piece
            // with slack must be found less deep to be good enough.
            let bound = deepest.bound_mm.max(deepest.found_mm + gap) - piece.slack;
            let mut own = Penetration::NONE;
            self.search(piece, &near.patches, Enough { gap, bound }, &mut own, budget)?;
            if own.found_mm > deepest.found_mm {
                (deepest.found_mm, deepest.at) = (own.found_mm, own.at);
            }
            deepest.bound_mm = deepest.bound_mm.max(own.bound_mm.max(own.found_mm) + piece.slack);
        }
        Ok(())
    }

    /// The deepest penetration along several curves.
    ///
    /// # Errors
    /// Only the budget's stop.
    pub fn penetration(&self, tips: &[Curve], gap: f64, budget: &Budget) -> Result<Penetration, Stopped> {
        let mut deepest = Penetration::NONE;
        for tip in tips {
            self.penetrate(tip, 0.0, gap, &mut deepest, budget)?;
        }
        Ok(deepest)
    }

    /// Raises `deepest` to the penetration by one piece without its slack. Best first: the pair with the
    /// largest bound is halved next, until that bound is good enough.
    fn search(
        &self,
        piece: PathPiece,
        near: &[[usize; 2]],
        mut enough: Enough,
        deepest: &mut Penetration,
        budget: &Budget,
    ) -> Result<(), Stopped> {
        let mut open = BestFirst::default();
        for (k, &[i, j]) in near.iter().enumerate() {
            if k % PAIRS_BETWEEN_CHECKS == PAIRS_BETWEEN_CHECKS - 1 {
                budget.check()?;
            }
            let [_, nv] = self.surface.spans();
            let part = SubPatch::new(*self.surface.patch(i, j), self.edges[i * nv + j]);
            self.add(piece, part, enough, deepest, &mut open);
        }
        for k in 0..PAIR_LIMIT {
            if k % PAIRS_BETWEEN_CHECKS == PAIRS_BETWEEN_CHECKS - 1 {
                budget.check()?;
            }
            let Some((bound, Pair { piece, part, halving })) = open.pop() else { return Ok(()) };
            if bound <= enough.depth(deepest) {
                deepest.bound_mm = deepest.bound_mm.max(bound);
                return Ok(());
            }
            let mut add = |piece, part| self.add(piece, part, enough, deepest, &mut open);
            match halving {
                Halving::Piece => piece.halves().into_iter().for_each(|half| add(half, part)),
                Halving::AlongU => part.halves_along_u().into_iter().for_each(|half| add(piece, half)),
                Halving::AlongV => part.halves_along_v().into_iter().for_each(|half| add(piece, half)),
                Halving::Never => {
                    deepest.bound_mm = deepest.bound_mm.max(bound);
                    enough.bound = enough.bound.max(bound + enough.gap);
                }
            }
        }
        if let Some((bound, _)) = open.pop() {
            deepest.bound_mm = deepest.bound_mm.max(bound);
        }
        Ok(())
    }

    /// Examines a pair and keeps it open where it may matter.
    fn add(
        &self,
        piece: PathPiece,
        part: SubPatch<P>,
        enough: Enough,
        deepest: &mut Penetration,
        open: &mut BestFirst<Pair<P>>,
    ) {
        let depth = self.examine(&piece, &part, enough.depth(deepest));
        if let Some((found, at)) = depth.found
            && found > deepest.found_mm
        {
            (deepest.found_mm, deepest.at) = (found, Some(at.into()));
        }
        if depth.bound <= enough.depth(deepest) {
            deepest.bound_mm = deepest.bound_mm.max(depth.bound);
        } else {
            let halving = self.halving(&piece, &part, &depth, enough.gap);
            open.push(depth.bound, Pair { piece, part, halving });
        }
    }

    /// Chooses whether to halve the piece, the part along u, or the part along v, so that the bound falls
    /// most.
    fn halving(&self, piece: &PathPiece, part: &SubPatch<P>, depth: &Depth, gap: f64) -> Halving {
        let [along_u, along_v] = part.patch.extents();
        let size = along_u.max(along_v);
        let longer = if along_u >= along_v { Halving::AlongU } else { Halving::AlongV };
        if size.max(piece.length()) < SMALLEST * gap {
            return Halving::Never;
        }
        match depth.shown_by {
            ShownBy::Ball { .. } if size < piece.length() / 8.0 => Halving::Piece,
            ShownBy::Ball { varies_along_u: true } => Halving::AlongU,
            ShownBy::Ball { varies_along_u: false } => Halving::AlongV,
            ShownBy::Planes(ms) => {
                let [by_u, by_v, by_piece] = ms.iter().fold([0.0; 3], |most: [f64; 3], m| {
                    let [by_u, by_v] = part.patch.spreads(m);
                    [most[0].max(by_u), most[1].max(by_v), most[2].max(piece.spread(m))]
                });
                let most = by_u.max(by_v).max(by_piece);
                if most < LEAST_SPREAD * depth.bound {
                    if piece.length() > size { Halving::Piece } else { longer }
                } else if by_piece == most {
                    Halving::Piece
                } else if by_u >= by_v {
                    Halving::AlongU
                } else {
                    Halving::AlongV
                }
            }
        }
    }

    /// Bounds the penetration of one part by one piece; the search ends at `enough`.
    fn examine(&self, piece: &PathPiece, part: &SubPatch<P>, enough: f64) -> Depth {
        let center = part.patch.center();
        let nearest = piece.nearest(&center, self.solid.flat);
        let off = center - nearest;
        let rounding = ROUNDING * (piece.magnitude() + self.magnitude + self.solid.radius());
        let mut planes = Planes::new(enough);
        let look_along = |m: &Vector3<f64>| {
            let apart = part.patch.lowest_along(m) - piece.support(m) - rounding;
            let reach = self.solid.reach(m);
            Shown { m: *m, at_center: reach - m.dot(&off), bound: reach - apart }
        };
        let away = self.solid.away_from_core(&off);
        let is_ball = self.solid.flat == 0.0;
        let facing = if is_ball && away.is_some() { None } else { part.against_normal() };
        let beneath = facing.map(|m| part.beneath(&m, &(self.solid.farthest(&m) - off)));
        let is_beneath = beneath.as_ref().is_some_and(|beneath| beneath.is_near && !beneath.is_at_edge);
        let is_settled = away.is_some_and(|m| planes.add(look_along(&m), is_ball))
            || facing.is_some_and(|m| planes.add(look_along(&m), is_beneath))
            || (away.is_none() || !is_ball)
                && (planes.add(look_along(&-Vector3::z()), false)
                    || sideways(&off).is_some_and(|m| planes.add(look_along(&m), false)));
        // No point is farther from the outside than the axis.
        let bound = planes.bound().clamp(0.0, self.solid.radius());
        let by_plane = Depth { bound, found: None, shown_by: ShownBy::Planes(planes.halved()) };
        if is_settled {
            return by_plane;
        }
        let found = (piece.depth(&self.solid, &center, &nearest), center);
        let by_plane = Depth { found: Some(found), ..by_plane };
        let m = facing.unwrap_or(planes.halved()[0]);
        let Some(around) = self.solid.ball_around(&m) else { return by_plane };
        let rounding = rounding + ROUNDING * (around.radius + around.rise);
        // From the ball's centre, along m.
        let apart = part.patch.lowest_along(&m) - piece.support(&m) - m.z * around.rise - rounding;
        let shank = if apart > 0.0 { around.radius - apart / m.xy().norm() } else { around.radius };
        if shank > enough {
            return by_plane;
        }
        let ball = ball::nearness(piece, around.rise, &part.patch);
        // The lowest point of the cutter may lie beside this part, by as much as it lies below it. So far
        // beside, the ball is higher by no more than depth^2 / radius.
        let beside = planes
            .along_normal()
            .map_or(0.0, |depth| if is_ball { 0.0 } else { depth * depth / around.radius });
        let by_ball = (around.radius - ball.lowest_distance + rounding).max(shank).max(0.0) + beside;
        // A ball that is larger than the cutter may never show enough, nor may one on an arc about the part:
        // planes do in the end.
        let shown_by = if is_ball && by_ball < bound {
            ShownBy::Ball { varies_along_u: ball.varies_along_u }
        } else {
            by_plane.shown_by
        };
        Depth { bound: bound.min(by_ball), found: Some(found), shown_by }
    }
}

/// The penetration of one part by one piece: its bound, and the depth found.
struct Depth {
    bound: f64,
    /// A depth that is reached, and where.
    found: Option<(f64, Vector3<f64>)>,
    shown_by: ShownBy,
}

/// What showed a bound.
enum ShownBy {
    /// Those at right angles to these.
    Planes([Vector3<f64>; 2]),
    Ball {
        varies_along_u: bool,
    },
}

/// What to halve next.
#[derive(Clone, Copy)]
enum Halving {
    Piece,
    AlongU,
    AlongV,
    /// Part and piece are as good as points.
    Never,
}

/// A piece and a part that are not decided yet.
#[derive(Clone, Copy)]
struct Pair<P> {
    piece: PathPiece,
    part: SubPatch<P>,
    halving: Halving,
}

/// When a bound is good enough.
#[derive(Clone, Copy)]
struct Enough {
    /// Within this of the deepest penetration that the piece was found to make, mm.
    gap: f64,
    /// Or not above this, mm.
    bound: f64,
}

impl Enough {
    fn depth(&self, deepest: &Penetration) -> f64 {
        self.bound.max(deepest.found_mm + self.gap)
    }
}

#[cfg(test)]
mod tests;

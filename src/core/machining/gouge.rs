//! Bounds from above how deep a moving cutter cuts into a surface.
//!
//! The *depth* of a surface point inside the cutter is its distance from the nearest point outside the
//! cutter. A surface point outside the cutter has the depth zero.
//!
//! # Method
//! 1. Replace helices and parabolas of the path by chords. Cut the path into pieces: lines, and arcs of at
//!    most a quarter turn.
//! 2. For each piece, find all patches that the cutter may touch on it. The piece makes a pair with each of
//!    these patches.
//! 3. For each pair, bound from above the depth of all points of the patch while the cutter follows the
//!    piece. One bound comes from planes that have the whole cutter on one side (`planes`). Another one comes
//!    from a ball cutter that contains the cutter (`ball`). The bound of the pair is the smaller one.
//! 4. Take the pair with the largest bound, and halve its piece or its patch. This gives two pairs; bound the
//!    depth for each of them. Repeat this step until the largest bound of a pair exceeds the largest depth
//!    found at a surface point by at most the requested gap.
//!
//! # Guarantees
//! * The result is at least the depth of every surface point at every position of the cutter on the path. It
//!   includes rounding, and the distance of chords from the curves that they replace.
//! * The sharp rim of a flat end may lie farther below a sloping surface than the depth of any surface point.
//!   The result is at least this distance, too, except near edges, where the surface ends or turns sharply.
//! * The result exceeds the largest of these depths and distances by about the gap at most. The excess is
//!   larger if 20,000 halvings for one piece are not enough.
//! * Below a sharp rim of the cutter, the depth of a surface point counts up to √2 times, because the rim
//!   reaches that far below a slope. At an end of the surface and at folds between patches it counts up to
//!   5/3 times.
//! * Only surface, cutter and path are used. So the result is an independent check of the planning of the
//!   path.
//!
//! # Cost
//! O(n log m) for n pieces and m patches. A move of a ball cutter takes 35 microseconds in the benchmark.

mod ball;
mod part;
pub(super) mod piece;
mod planes;
pub(super) mod solid;

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

/// Largest number of pairs halved for one piece. At this limit the search returns the bound it has, which may
/// exceed the true depth by more than the gap.
const PAIR_LIMIT: usize = 20_000;

/// Length, as a share of the gap, below which a pair of a part and a piece is not halved: its bound is as
/// good as exact.
const SMALLEST: f64 = 0.25;

/// Least spread of piece and part along m, as a share of the bound. With less spread something else keeps the
/// bound large, and the longer of the two is halved.
const LEAST_SPREAD: f64 = 1e-3;

/// Pairs between two checks of the budget.
const PAIRS_BETWEEN_CHECKS: usize = 256;

/// Rounding of one bound, as a share of the coordinates' magnitude: several hundred operations of half an ulp
/// each.
const ROUNDING: f64 = 1e-13;

/// The deepest penetration of a cutter into a surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Penetration {
    /// Proved upper bound, mm, zero or more.
    pub bound_mm: f64,
    /// Depth of the deepest surface point found, mm; zero where none was found.
    pub found_mm: f64,
    /// The surface point at that depth.
    pub at: Option<Point3<f64>>,
}

impl Penetration {
    pub const NONE: Penetration = Penetration { bound_mm: 0.0, found_mm: 0.0, at: None };

    /// The deeper of the two penetrations found, with the larger of the two bounds.
    pub fn or_deeper(self, other: Self) -> Self {
        let deeper = if other.found_mm > self.found_mm { other } else { self };
        Self { bound_mm: self.bound_mm.max(other.bound_mm), ..deeper }
    }
}

/// A surface and a cutter, prepared for proofs of how deep the cutter cuts.
pub struct GougeProof<'a, P> {
    surface: &'a BezierSurface<P>,
    tree: BoundingTree<Bounds, [usize; 2]>,
    /// For each patch, which of its sides are sharp edges.
    edges: Vec<Sides>,
    solid: Solid,
    /// Height of the corner circle's centre over the tip, mm.
    rise: f64,
    /// The largest absolute coordinate of a control point, mm.
    magnitude: f64,
    /// Length of the pieces into which a path is cut before the search, mm: the mean size of a patch, but at
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
    /// The axis of `cutter` is along +z. `stock` is the material to be left on the surface, mm: the proof
    /// enlarges the cutter by it on all sides.
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

    /// Raises `deepest` to the penetration of the cutter while its tip follows `tip`, to within `gap` mm. The
    /// control may leave the curve by `slack` mm; the slack is added to the bound.
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
            // The search leaves the slack out, because it adds the same to every part. So a piece with slack
            // must be found less deep to be good enough.
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

    /// Raises `deepest` to the penetration by one piece without its slack. The search is best first: it
    /// halves the pair with the largest bound next, until that bound is good enough.
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

    /// Bounds a pair, and queues it for halving unless its bound is good enough.
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

    /// Bounds the penetration of one part by one piece. Tries no further bounds once one is at most `enough`
    /// mm.
    ///
    /// *By planes.* Let m be a unit vector that does not point up. No point of the cutter lies farther from C
    /// along m than a length reach(m) (`solid`). So a point of the part is no deeper than reach(m) + max m .
    /// C - min m . P. The maximum is over all C of the piece, and the minimum is over the control points P of
    /// the part. Up to four m are tried: from the core to the part's centre, against the part's normal, down,
    /// and level from the axis to the part.
    ///
    /// *By a ball.* A ball cutter contains the cutter and touches it where its lower side faces along m. The
    /// depth is at most the ball's radius less the distance between the part and the path of the ball's
    /// centre (`ball`). This bound is tight on large parts along the line of contact, where the distance
    /// hardly varies. A plane bounds the depth in the shank above the ball. If that bound is too large, the
    /// ball is not used.
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
        // No point of the cutter is deeper than a point of its axis.
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
        // The part's least distance along m from the ball's centre.
        let apart = part.patch.lowest_along(&m) - piece.support(&m) - m.z * around.rise - rounding;
        let shank = if apart > 0.0 { around.radius - apart / m.xy().norm() } else { around.radius };
        if shank > enough {
            return by_plane;
        }
        let ball = ball::nearness(piece, around.rise, &part.patch);
        // The cutter's farthest point along m may lie beside this part, by as much as it lies below the part.
        // There the ball is higher by no more than depth^2 / radius.
        let beside = planes
            .along_normal()
            .map_or(0.0, |depth| if is_ball { 0.0 } else { depth * depth / around.radius });
        let by_ball = (around.radius - ball.lowest_distance + rounding).max(shank).max(0.0) + beside;
        // The bound by a ball larger than the cutter may stay too large however small the pair is. So may the
        // bound by a ball on an arc about the part. Planes decide such pairs in the end.
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
    /// The depth of one surface point, mm, and that point.
    found: Option<(f64, Vector3<f64>)>,
    shown_by: ShownBy,
}

/// The origin of a bound.
enum ShownBy {
    /// Planes at right angles to these unit vectors.
    Planes([Vector3<f64>; 2]),
    Ball {
        varies_along_u: bool,
    },
}

/// The next halving of a pair.
#[derive(Clone, Copy)]
enum Halving {
    Piece,
    AlongU,
    AlongV,
    /// Part and piece are so small that halving them changes nothing.
    Never,
}

/// An undecided piece and part, and what to halve next.
#[derive(Clone, Copy)]
struct Pair<P> {
    piece: PathPiece,
    part: SubPatch<P>,
    halving: Halving,
}

/// States which bounds are good enough.
#[derive(Clone, Copy)]
struct Enough {
    /// A bound that exceeds the deepest penetration found by no more than this, mm, is good enough.
    gap: f64,
    /// A bound that is not above this, mm, is good enough, too.
    bound: f64,
}

impl Enough {
    fn depth(&self, deepest: &Penetration) -> f64 {
        self.bound.max(deepest.found_mm + self.gap)
    }
}

#[cfg(test)]
mod tests;

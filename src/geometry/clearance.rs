//! Certified clearance between a moving ball cutter and a surface.
//!
//! # Method
//! The cutter of radius R with its shank is everything within R of the axis ray that rises from the ball's
//! centre. While the tip follows a curve, the ray sweeps a set W. A surface point P is penetrated by
//! R - dist(P, W), and the deepest penetration over all P of the surface is wanted. It is found by branch and
//! bound over pairs of a piece of the path and a part of a patch with its control net:
//! 1. *Far*: for a unit vector m that does not point up, dist(P, W) is at least m . P - max m . C over the
//!    piece. The least m . P is that of the control points.
//! 2. *Shank*: a point of the part that is above a centre keeps from its axis at least that difference over
//!    the length of the horizontal part of m. Where this is enough, the ball alone matters.
//! 3. *Ball*: the squared distance to a line, to a point, or (`ball`) a lower bound of that to a circle is a
//!    polynomial of twice the part's degree, or the quotient of two. Its least Bernstein coefficient bounds it. Along the line
//!    of contact this polynomial hardly varies, so the bound is tight on large parts.
//! 4. What is not decided is halved. The deepest penetration found at the parts' centres tells which parts
//!    cannot matter.
//!
//! # Guarantees
//! `bound_mm` is never below the true deepest penetration, for every point of every move; rounding is
//! counted. It exceeds the penetration found by at most `gap` and the slack of the path, unless the limit of
//! work is reached, where it is larger but still a bound. Nothing about the path is assumed, nor about the
//! surface beyond its nets.
//!
//! # Degenerate input
//! Curves of length zero are points. Helices are replaced by chords, and the chords' height is counted.
//!
//! # Cost
//! O(n log m) for n pieces of path and m patches, and O(1) parts examined for a piece. In the benchmark a move
//! takes 35 microseconds, whether there are a thousand or four thousand.

mod ball;
mod path;
mod tree;

use nalgebra::{Point3, Vector3};

use super::best_first::BestFirst;
use super::surface::{BezierSurface, Patch, Surface};
use crate::budget::{Budget, Stopped};
use crate::geometry::curve::Curve;
use path::Piece;
use tree::PatchTree;

/// Pairs halved for one piece; beyond this the bound at hand is taken.
const PAIR_LIMIT: usize = 20_000;

/// Parts of a patch are not halved below this part of the radius: their nets are points to the arithmetic.
const SMALLEST_PART: f64 = 1e-9;

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

/// A surface made ready for the question how deep a ball cutter cuts into it.
pub struct Clearance<'a, P> {
    surface: &'a BezierSurface<P>,
    tree: PatchTree,
    radius: f64,
    rise: f64,
    /// The largest absolute coordinate of a control point, mm.
    magnitude: f64,
    /// Length of the pieces that paths are cut into at first, mm: that of a patch, or the ball's diameter.
    piece_length: f64,
}

impl<'a, P: Patch> Clearance<'a, P> {
    /// The cutter has `radius` mm and an axis along +z. Its tip lies `rise` mm below the ball's centre: the radius, or
    /// less than that where the ball is taken larger than the cutter is, by the stock that is to be left.
    pub fn new(surface: &'a BezierSurface<P>, radius: f64, rise: f64) -> Self {
        let tree = PatchTree::new(surface);
        let magnitude = tree.bounds().magnitude();
        let [nu, nv] = surface.spans();
        let sizes = surface.patches().iter().map(Patch::extents);
        let mean_size = sizes.map(|[u, v]| u.max(v)).sum::<f64>() / (nu * nv) as f64;
        Self { surface, tree, radius, rise, magnitude, piece_length: mean_size.max(2.0 * radius) }
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
        let mut near = Vec::new();
        for piece in path::pieces(tip, self.rise, self.piece_length, slack, 0.25 * gap) {
            budget.check()?;
            near.clear();
            self.tree.collect(&piece.reach(self.radius), &mut near);
            // What the slack adds is the same for every part, so the search need not know it; but a piece with
            // slack must be found less deep to be good enough.
            let bound = deepest.bound_mm.max(deepest.found_mm + gap) - piece.slack;
            let mut own = Penetration::NONE;
            self.search(piece, &near, Enough { gap, bound }, &mut own, budget)?;
            if own.found_mm > deepest.found_mm {
                (deepest.found_mm, deepest.at) = (own.found_mm, own.at);
            }
            deepest.bound_mm = deepest.bound_mm.max(own.bound_mm + piece.slack);
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

    /// Raises `deepest` to the penetration by one piece without its slack. Best first: the pair with the largest
    /// bound is halved next, until that bound is good enough.
    fn search(
        &self,
        piece: Piece,
        near: &[(usize, usize)],
        enough: Enough,
        deepest: &mut Penetration,
        budget: &Budget,
    ) -> Result<(), Stopped> {
        let mut open = BestFirst::default();
        for (k, &(i, j)) in near.iter().enumerate() {
            if k % PAIRS_BETWEEN_CHECKS == PAIRS_BETWEEN_CHECKS - 1 {
                budget.check()?;
            }
            self.add(piece, *self.surface.patch(i, j), enough, deepest, &mut open);
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
                Halving::AlongU => part.split_u().into_iter().for_each(|half| add(piece, half)),
                Halving::AlongV => part.split_v().into_iter().for_each(|half| add(piece, half)),
                Halving::Never => deepest.bound_mm = deepest.bound_mm.max(bound),
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
        piece: Piece,
        part: P,
        enough: Enough,
        deepest: &mut Penetration,
        open: &mut BestFirst<Pair<P>>,
    ) {
        let depth = self.examine(&piece, &part, enough.depth(deepest));
        if let Some(found) = depth.found
            && found > deepest.found_mm
        {
            deepest.found_mm = found;
            deepest.at = Some(part.center().into());
        }
        if depth.bound <= enough.depth(deepest) {
            deepest.bound_mm = deepest.bound_mm.max(depth.bound);
        } else {
            let halving = self.halving(&piece, &part, depth.varies_along_u);
            open.push(depth.bound, Pair { piece, part, halving });
        }
    }

    /// Which half would tell more: a piece that is long against the part, or the part in the direction in which
    /// the distance varies, or else in which it is longer.
    fn halving(&self, piece: &Piece, part: &P, varies_along_u: Option<bool>) -> Halving {
        let [along_u, along_v] = part.extents();
        let size = along_u.max(along_v);
        if size < SMALLEST_PART * self.radius {
            Halving::Never
        } else if size < piece.length() / 8.0 {
            Halving::Piece
        } else if varies_along_u.unwrap_or(along_u >= along_v) {
            Halving::AlongU
        } else {
            Halving::AlongV
        }
    }

    /// Bounds the penetration of one part by one piece; the search ends at `enough`.
    fn examine(&self, piece: &Piece, part: &P, enough: f64) -> Depth {
        let center = part.center();
        let nearest = piece.nearest(&center);
        let reach = self.radius;
        let rounding = ROUNDING * (piece.magnitude() + self.magnitude + reach);
        let Some(away) = downward_unit(center - nearest) else {
            return Depth { bound: reach, found: None, varies_along_u: None };
        };
        let apart = part.lowest_along(&away) - piece.support(&away) - rounding;
        let far = reach - apart;
        if far <= enough {
            return Depth { bound: far.max(0.0), found: None, varies_along_u: None };
        }
        let found = Some(reach - piece.axis_distance(&center, &nearest));
        let shank = if apart > 0.0 { reach - apart / away.xy().norm() } else { reach };
        if shank > enough {
            let varies_along_u = longer_along_u(part, &away);
            return Depth { bound: far.min(reach), found, varies_along_u };
        }
        let ball = ball::nearness(piece, part);
        let bound = far.min((reach - ball.lowest_distance + rounding).max(shank));
        Depth { bound: bound.max(0.0), found, varies_along_u: Some(ball.varies_along_u) }
    }
}

/// What is known of the penetration of one part by one piece.
struct Depth {
    bound: f64,
    found: Option<f64>,
    /// Whether the distance varies more along u than along v, where that was looked at.
    varies_along_u: Option<bool>,
}

/// What to halve next.
#[derive(Clone, Copy)]
enum Halving {
    Piece,
    AlongU,
    AlongV,
    /// The part is a point to the arithmetic.
    Never,
}

/// A piece and a part that are not decided yet.
#[derive(Clone, Copy)]
struct Pair<P> {
    piece: Piece,
    part: P,
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

/// Whether the part reaches farther along `direction` by its u than by its v; `None` where it hardly does either
/// way.
fn longer_along_u(part: &impl Patch, direction: &Vector3<f64>) -> Option<bool> {
    let [p00, p01, p10, p11] = part.corners();
    let [along_u, along_v] = [p10 - p00 + p11 - p01, p01 - p00 + p11 - p10];
    let [by_u, by_v] = [along_u, along_v].map(|edge| edge.dot(direction).abs());
    (by_u.max(by_v) > 0.01 * along_u.norm().max(along_v.norm())).then_some(by_u >= by_v)
}

/// The unit vector along `v`, or along its horizontal part where it points up; `None` where neither exists.
fn downward_unit(mut v: Vector3<f64>) -> Option<Vector3<f64>> {
    v.z = v.z.min(0.0);
    v.try_normalize(0.0)
}

#[cfg(test)]
mod tests;

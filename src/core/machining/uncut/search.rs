//! The search for the largest distance of a surface from the solid that a cutter has swept.

use nalgebra::{Point3, Vector3};

use super::bound::by_two_cutters;
use super::swept::{Nearest, Swept};
use super::{Left, Leftover, Reach, Wanted};
use crate::budget::{Budget, Stopped};
use crate::geometry::best_first::BestFirst;
use crate::geometry::surface::{BezierSurface, Jet, Patch, curvature};

/// Parts between two checks of the budget.
const PARTS_BETWEEN_CHECKS: usize = 256;

/// The search is shared out in at least this many blocks, if there are patches or halves of patches enough.
const BLOCKS: usize = 32;

/// Number of places at which the distance is looked at before the search.
const PLACES: usize = 400;

/// Number of the places with the largest distances for which it is tried whether the cutter can reach them.
const TRIED: usize = 24;

/// Share of the distance up to which a part with no larger distance may exceed its centre's and count as
/// narrow enough.
const NARROW: f64 = 0.5;

/// The gap of the rest, as a part of the gap of what is left at other places. Rest is found in few parts.
const REST_GAP: f64 = 0.4;

/// The largest ratio of the sides of a part that is halved across its shorter side. Along straight passes
/// long parts save work. Larger ratios let parts become thinner and thinner where their length makes the
/// bound.
const LONGEST: f64 = 100.0;

/// Stands for a bound that is infinite where bounds are added, mm: above any distance within a part.
const UNBOUNDED_MM: f64 = 1e9;

/// Parts of which only a corner is reached are halved down to this share of the grain.
const BORDER_SHARE: f64 = 1.0 / 32.0;

/// Most halvings of one part on the way to its smallest halves.
const DEPTH: u32 = 48;

/// A part to be looked at.
struct Open<P> {
    part: P,
    /// The piece that is nearest to the part's centre.
    near: NearestOf,
    /// The largest distance of the part from the swept solid, with the allowance, mm.
    bound: f64,
    /// Whether the part belongs to a place that the cutter cannot reach.
    is_rest: bool,
    depth: u32,
}

/// The search over one surface.
pub(super) struct Search<'a, R> {
    /// What each of the cutters has swept.
    pub(super) swept: &'a [Swept],
    pub(super) reach: &'a R,
    pub(super) wanted: Wanted,
    pub(super) budget: &'a Budget,
}

/// The nearest piece of all cutters.
#[derive(Debug, Clone, Copy)]
struct NearestOf {
    /// The index of the cutter.
    cutter: usize,
    near: Nearest,
}

/// What is left at a point.
struct LeftAt {
    distance: f64,
    jet: Jet,
}

impl<R: Reach> Search<'_, R> {
    /// # Errors
    /// Only the budget's stop.
    pub(super) fn run<P: Patch>(&self, part: &BezierSurface<P>) -> Result<Left, Stopped> {
        let known = self.sample(part)?;
        let blocks = blocks(part);
        let limit = self.wanted.part_limit / blocks.len();
        let found = self.budget.in_order(blocks.len(), |k| {
            self.budget.progress("material left", k, blocks.len());
            self.block(blocks[k], known, limit)
        })?;
        Ok(found.into_iter().fold(known, Left::or_more))
    }

    /// The largest distances at places spread over the surface.
    fn sample<P: Patch>(&self, part: &BezierSurface<P>) -> Result<Left, Stopped> {
        let patches = part.patches();
        let each = ((PLACES / patches.len()) as f64).sqrt().ceil().max(1.0) as usize;
        let stride = patches.len().div_ceil(PLACES);
        let mut places = Vec::new();
        for patch in patches.iter().step_by(stride) {
            self.budget.check()?;
            let mut hint = None;
            for k in 0..each * each {
                let at = |k: usize| (k as f64 + 0.5) / each as f64;
                let jet = patch.jet(at(k / each), at(k % each));
                let Some(near) = self.nearest(&jet.point.coords, hint) else { return Ok(Left::UNKNOWN) };
                hint = Some(near);
                places.push(LeftAt { distance: self.over_allowance(near, near.near.distance, || jet), jet });
            }
        }
        places.sort_by(|a, b| b.distance.total_cmp(&a.distance));
        let mut left = Left::NONE;
        for place in places.iter().take(TRIED) {
            if self.is_reached(place)? {
                left.reached.find(place);
                break;
            }
            left.rest.find(place);
        }
        Ok(left)
    }

    /// The bound that is good enough: it exceeds the largest distance found, with the rounding of the path,
    /// by the gap, or is at most what is wanted.
    fn enough(&self, found: &Leftover, gap_share: f64) -> f64 {
        let least = found.found_mm + self.slack();
        let enough = least * (1.0 + gap_share) + self.wanted.gap_mm;
        match self.wanted.target_mm {
            Some(target) if (least..enough).contains(&target) => target,
            _ => enough,
        }
    }

    /// How much more material may be left because the control leaves the path, mm.
    fn slack(&self) -> f64 {
        self.swept.iter().map(|swept| swept.over_allowance(swept.slack, 0.0)).fold(0.0, f64::max)
    }

    /// The piece of any cutter that is nearest to `p`; `None` without passes.
    fn nearest(&self, p: &Vector3<f64>, hint: Option<NearestOf>) -> Option<NearestOf> {
        let of_cutter = |(cutter, swept): (usize, &Swept)| {
            let hint = hint.filter(|hint| hint.cutter == cutter).map(|hint| hint.near.piece);
            swept.nearest(p, hint).map(|near| NearestOf { cutter, near })
        };
        let all = self.swept.iter().enumerate().filter_map(of_cutter);
        all.min_by(|one, other| one.near.distance.total_cmp(&other.near.distance))
    }

    /// What a distance from a cutter means with the allowance, at the place of the jet.
    fn over_allowance(&self, near: NearestOf, distance: f64, jet: impl FnOnce() -> Jet) -> f64 {
        let swept = &self.swept[near.cutter];
        if swept.allowance == 0.0 {
            return distance;
        }
        swept.over_allowance(distance, most_convex(&jet()))
    }

    /// An upper bound of the distance of a part from what all cutters have swept, mm. A bound above `enough`
    /// is improved by the cutter that is nearest to the corner that the first one leaves farthest away.
    fn bound(&self, part: &impl Patch, near: NearestOf, enough: f64) -> f64 {
        let own = &self.swept[near.cutter];
        let bound = own.bound(part, near.near.piece, enough);
        if bound <= enough || self.swept.len() == 1 {
            return bound;
        }
        let left = |p: &Vector3<f64>| own.nearest(p, Some(near.near.piece)).map_or(0.0, |near| near.distance);
        let corners = part.corners().map(|corner| (left(&corner), corner));
        let farthest = corners.into_iter().max_by(|one, other| one.0.total_cmp(&other.0));
        let other = farthest.and_then(|(_, corner)| self.nearest(&corner, Some(near)));
        match other.filter(|other| other.cutter != near.cutter) {
            Some(other) => {
                let pieces = [(own, near.near.piece), (&self.swept[other.cutter], other.near.piece)];
                bound.min(by_two_cutters(part, pieces))
            }
            None => bound,
        }
    }

    fn is_reached(&self, place: &LeftAt) -> Result<bool, Stopped> {
        let Some(normal) = place.jet.normal().try_normalize(0.0) else { return Ok(true) };
        self.reach.is_reached(&place.jet.point, &normal, place.distance, self.budget)
    }

    /// Tries the four corners of a part. Returns whether one of them is reached: at most `enough` mm of
    /// material is left there, or the cutter can come there without a gouge. `found` gets the material that
    /// is left at such corners. The search for the nearest piece of a pass begins at `hint`.
    fn finds_corner(
        &self,
        part: &impl Patch,
        hint: NearestOf,
        enough: f64,
        found: &mut Leftover,
    ) -> Result<bool, Stopped> {
        let mut is_reached = false;
        for [u, v] in [[0.0, 0.0], [0.0, 1.0], [1.0, 0.0], [1.0, 1.0]] {
            let jet = part.jet(u, v);
            let Some(near) = self.nearest(&jet.point.coords, Some(hint)) else { continue };
            let place = LeftAt { distance: self.over_allowance(near, near.near.distance, || jet), jet };
            if place.distance <= enough || self.is_reached(&place)? {
                found.find(&place);
                is_reached = true;
            }
        }
        Ok(is_reached)
    }

    /// The largest distances over one block, or smaller ones than are known.
    fn block<P: Patch>(&self, block: P, known: Left, limit: usize) -> Result<Left, Stopped> {
        let mut left = Left { reached: known.reached.without_bound(), rest: known.rest.without_bound() };
        let Some(first) = self.open(block, None, (false, 0), &left) else { return Ok(left) };
        // The part with the largest bound is next, so that the bounds that are left at the limit are small.
        let mut open = BestFirst::default();
        open.push(first.bound, first);
        let mut looked = 0usize;
        while let Some((_, next)) = open.pop() {
            looked += 1;
            if looked.is_multiple_of(PARTS_BETWEEN_CHECKS) {
                self.budget.check()?;
            }
            if looked > limit || next.depth >= DEPTH {
                let kind = if next.is_rest { &mut left.rest } else { &mut left.reached };
                kind.raise(next.bound, &next.part.center());
            } else {
                self.look_at(next, &mut left, &mut open)?;
            }
        }
        Ok(left)
    }

    /// A part with its bound. `None` without passes.
    fn open<P: Patch>(
        &self,
        part: P,
        hint: Option<NearestOf>,
        (is_rest, depth): (bool, u32),
        left: &Left,
    ) -> Option<Open<P>> {
        let near = self.nearest(&part.center(), hint)?;
        let has_allowance = self.swept[near.cutter].allowance > 0.0;
        let enough = if has_allowance { 0.0 } else { self.enough(&left.reached, self.wanted.gap_share) };
        let bound = self.bound(&part, near, enough);
        let bound = self.over_allowance(near, bound, || part.jet(0.5, 0.5));
        Some(Open { part, near, bound, is_rest, depth })
    }

    /// Settles a part whose bound is good enough; halves any other part.
    fn look_at<P: Patch>(
        &self,
        Open { part, near, bound, mut is_rest, depth }: Open<P>,
        left: &mut Left,
        open: &mut BestFirst<Open<P>>,
    ) -> Result<(), Stopped> {
        let center = part.center();
        let jet = || part.jet(0.5, 0.5);
        let enough = self.enough(&left.reached, self.wanted.gap_share);
        if bound <= enough {
            left.reached.raise(bound, &center);
            return Ok(());
        }
        let distance = self.over_allowance(near, near.near.distance, jet);
        let [along_u, along_v] = part.extents();
        let size = along_u.max(along_v);
        let is_small = size <= self.wanted.grain_mm;
        let least = distance + self.slack();
        let is_narrow = bound <= least * (1.0 + NARROW * self.wanted.gap_share) + self.wanted.gap_mm;
        // A narrow part with a bound that is too large has more left than is known.
        if (is_narrow || is_small && least > enough) && !is_rest {
            let place = LeftAt { distance, jet: jet() };
            if self.is_reached(&place)? {
                left.reached.find(&place);
            } else {
                is_rest = size <= BORDER_SHARE * self.wanted.grain_mm
                    || !self.finds_corner(&part, near, enough, &mut left.reached)?;
            }
        }
        let (kind, gap_share) = if is_rest {
            (&mut left.rest, REST_GAP * self.wanted.gap_share)
        } else {
            (&mut left.reached, self.wanted.gap_share)
        };
        if is_rest {
            kind.find(&LeftAt { distance, jet: jet() });
        }
        let enough = self.enough(kind, gap_share);
        if bound <= enough || size <= self.wanted.smallest_mm {
            kind.raise(bound, &center);
            return Ok(());
        }
        let halves = [part.split_u(), part.split_v()]
            .map(|halves| halves.map(|half| self.open(half, Some(near), (is_rest, depth + 1), left)));
        for half in self.better(halves, [along_u, along_v]).into_iter().flatten() {
            open.push(half.bound, half);
        }
        Ok(())
    }

    /// The halves whose bounds fall more: along u or along v. Where they hardly differ, and where the part is
    /// very long, it is cut across its longer side.
    ///
    /// A part may have a large bound because it is wide across a pass, or because it is long: a long part
    /// lies beside many pieces of the pass. Halving it in the other direction leaves the bound as it is.
    fn better<P>(
        &self,
        [by_u, by_v]: [[Option<Open<P>>; 2]; 2],
        [along_u, along_v]: [f64; 2],
    ) -> [Option<Open<P>>; 2] {
        let sum = |halves: &[Option<Open<P>>; 2]| {
            halves.iter().flatten().map(|half| half.bound.min(UNBOUNDED_MM)).sum::<f64>()
        };
        let gain = sum(&by_v) - sum(&by_u);
        let is_long = along_u.max(along_v) > LONGEST * along_u.min(along_v);
        let is_along_u =
            if is_long || gain.abs() <= self.wanted.gap_mm { along_u >= along_v } else { gain > 0.0 };
        if is_along_u { by_u } else { by_v }
    }
}

impl Leftover {
    fn find(&mut self, place: &LeftAt) {
        if place.distance > self.found_mm {
            (self.found_mm, self.found_at) = (place.distance, Some(place.jet.point));
        }
    }

    fn raise(&mut self, bound: f64, at: &Vector3<f64>) {
        if bound > self.bound_mm {
            (self.bound_mm, self.at) = (bound, Some(Point3::from(*at)));
        }
    }
}

/// The patches of a surface, halved until there are enough blocks.
fn blocks<P: Patch>(surface: &BezierSurface<P>) -> Vec<P> {
    let mut blocks = surface.patches().to_vec();
    while blocks.len() < BLOCKS {
        blocks = blocks.iter().flat_map(Patch::split).collect();
    }
    blocks
}

/// The most convex curvature, 1/mm; zero where the surface has no normal.
fn most_convex(jet: &Jet) -> f64 {
    // With u and v exchanged the normal points the other way.
    let turned = Jet { du: jet.dv, dv: jet.du, duu: jet.dvv, dvv: jet.duu, ..*jet };
    let curvature = curvature::most_concave_at(&turned);
    if curvature.is_finite() { curvature } else { 0.0 }
}

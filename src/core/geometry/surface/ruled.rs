//! A ruled surface between two curves. Its rulings are straight lines. Each ruling joins two points, one on
//! each curve, that divide the lengths of the curves in the same ratio.
//!
//! # Method
//! 1. Both curves are cut at the same fractions of their lengths: at every fraction where at least one of the
//!    curves has a joint. So each part of one curve faces one part of the other.
//! 2. Two lines that face each other make an exact patch. So do two arcs that turn by the same angle.
//! 3. In any other pair, each of the two parts is replaced by a cubic that approximates it, with the fraction
//!    of the part's length as its parameter. Both parts are halved until each cubic is near enough, at every
//!    parameter, to the point of its part at that fraction of the length.
//!
//! # Guarantees
//! Patches of step 2 are exact, up to rounding. In all other patches, each end of a ruling is within
//! [`TOLERANCE_MM`] of its exact place.
//!
//! # Degenerate input
//! The curves may contain cubics. A curve is refused if one of its cubics has a cusp (a place where its
//! direction jumps), or turns so tightly that a cusp cannot be ruled out. Curves that meet each other are
//! accepted; the surface has no normal where they meet.
//!
//! # Reference
//! Y. H. Koo, D. J. Lee, S. Namgung, M. S. Kang, "A Study on the Construction of CAD/CAM System for Machining
//! of Sculptured Surface of Die", 1989, section 3.2.3. The paper draws rulings only between some pairs of
//! points, and builds no patches between the rulings.

mod length;
mod part;

use super::RationalPatch;
use super::any_surface::{AnySurface, PATCH_LIMIT};
use super::swept::of_weights;
use crate::geometry::profile::{ControlPoint, Profile};
use part::Part;

/// How far a curve of constant v may leave the exact one, mm.
pub const TOLERANCE_MM: f64 = 1e-6;

/// Joints of the two curves whose fractions differ by less than this length count as one joint, mm.
const NEAREST_MM: f64 = 1e-9;

/// Most halvings of a stretch: the smallest parts are a billionth of it. A cubic that needs more has a cusp.
const MOST_HALVINGS: usize = 30;

/// The curve at v = 0 and the one at v = 1, both along u; mm.
#[derive(Debug, Clone, PartialEq)]
pub struct Ruled {
    pub first: Profile<3>,
    pub second: Profile<3>,
}

/// Why the curves make no surface. `curve` is 0 for the first curve and 1 for the second; `place` is the
/// place of the piece.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum RuledError {
    #[error("a curve has no pieces; it needs at least one")]
    Empty,
    #[error("the surface needs more than {PATCH_LIMIT} patches, the most that are supported")]
    TooManyPatches,
    #[error(
        "the curve has a cusp, or turns so tightly that it may have one; the curve has no direction at a cusp"
    )]
    Cusp { curve: usize, place: usize },
}

/// Control points of the sides v = 0 and v = 1 of a patch: the same number, with the same weights.
type Sides = [Vec<ControlPoint<3>>; 2];

/// Patches in order, and for each loose joint the number of patches before it.
#[derive(Default)]
struct Strip {
    patches: Vec<Sides>,
    loose: Vec<usize>,
}

impl Ruled {
    /// The ruled surface.
    ///
    /// # Errors
    /// One of [`RuledError`].
    pub fn surface(&self) -> Result<AnySurface, RuledError> {
        let Strip { patches, loose: _ } = self.strip()?;
        let patch = |i: usize, _: usize| {
            let sides = &patches[i];
            RationalPatch::from_fn([sides[0].len() - 1, 1], |a, b| {
                let (p, weight) = sides[b][a];
                (p.coords * weight).push(weight)
            })
        };
        let weights = patches.iter().flatten().flatten().map(|(_, weight)| *weight);
        Ok(of_weights([patches.len(), 1], weights, patch))
    }

    /// The joints at corners of either curve. Each joint is given by the number of patches before it, along u
    /// and along v. Empty if the curves make no surface.
    pub fn loose_joints(&self) -> [Vec<usize>; 2] {
        [self.strip().map_or(Vec::new(), |strip| strip.loose), Vec::new()]
    }

    fn strip(&self) -> Result<Strip, RuledError> {
        let mut curves = [Measured::new(&self.first), Measured::new(&self.second)];
        let longest = curves[0].length.max(curves[1].length);
        let mut strip = Strip::default();
        let mut from = 0.0;
        let mut heads = curves.each_mut().map(|curve| curve.next());
        if heads.iter().any(Option::is_none) {
            return Err(RuledError::Empty);
        }
        while let [Some(one), Some(other)] = heads {
            let ends = [one.end, other.end];
            let meet = (ends[0] - ends[1]).abs() * longest <= NEAREST_MM;
            let to = if meet { ends[0] } else { ends[0].min(ends[1]) };
            let mut is_loose = false;
            let mut stretch = [one.part, other.part];
            heads = [one, other].map(Some);
            for (k, curve) in curves.iter_mut().enumerate() {
                let Some(head) = heads[k] else { continue };
                if meet || head.end == to {
                    is_loose |= head.is_loose;
                    heads[k] = curve.next();
                } else {
                    let [before, after] = head.part.cut((to - from) / (head.end - from));
                    stretch[k] = before;
                    heads[k] = Some(Head { part: after, ..head });
                }
            }
            strip.rule(stretch)?;
            if is_loose && heads.iter().all(Option::is_some) {
                strip.loose.push(strip.patches.len());
            }
            from = to;
        }
        Ok(strip)
    }
}

impl Strip {
    /// Adds the patches between two parts.
    fn rule(&mut self, stretch: [Part; 2]) -> Result<(), RuledError> {
        let mut open = vec![(stretch, 0)];
        while let Some((parts, halvings)) = open.pop() {
            if let Some(sides) = exact(&parts).or_else(|| near(&parts)) {
                self.patches.push(sides);
                if self.patches.len() > PATCH_LIMIT {
                    return Err(RuledError::TooManyPatches);
                }
            } else if halvings == MOST_HALVINGS {
                let curve = usize::from(parts[0].cubic_error() <= TOLERANCE_MM);
                return Err(RuledError::Cusp { curve, place: parts[curve].place });
            } else {
                let [one, other] = parts.map(|part| part.cut(0.5));
                open.push(([one[1], other[1]], halvings + 1));
                open.push(([one[0], other[0]], halvings + 1));
            }
        }
        Ok(())
    }
}

/// The sides of an exact patch, if equal parameters of both parts mean equal fractions of their lengths.
fn exact(parts: &[Part; 2]) -> Option<Sides> {
    let [one, other] = parts;
    one.runs_like(other).then(|| {
        let weights = one.control_points();
        let with = |part: &Part| {
            part.control_points().into_iter().zip(&weights).map(|((p, _), (_, w))| (p, *w)).collect()
        };
        [with(one), with(other)]
    })
}

/// The sides as cubics in the length, if both are near enough to the parts.
fn near(parts: &[Part; 2]) -> Option<Sides> {
    let is_near = parts.iter().all(|part| part.cubic_error() <= TOLERANCE_MM);
    is_near.then(|| [0, 1].map(|k| parts[k].cubic().map(|p| (p, 1.0)).to_vec()))
}

/// The next part of a curve, the fraction of the curve's length at its end, and whether the joint there is
/// loose.
#[derive(Clone, Copy)]
struct Head {
    part: Part,
    end: f64,
    is_loose: bool,
}

/// A curve as parts with their lengths, in order.
struct Measured<'p> {
    profile: &'p Profile<3>,
    parts: std::vec::IntoIter<Part>,
    length: f64,
    /// The total length (mm) and the number of the parts taken so far.
    taken: (f64, usize),
    /// The loose joints ahead, each as the number of pieces before it.
    loose: std::iter::Peekable<std::vec::IntoIter<usize>>,
}

impl<'p> Measured<'p> {
    fn new(profile: &'p Profile<3>) -> Self {
        let parts: Vec<Part> = profile.pieces().iter().map(Part::new).collect();
        let length = parts.iter().map(|part| part.length).sum();
        let loose = profile.loose_joints().into_iter().peekable();
        Self { profile, parts: parts.into_iter(), length, taken: (0.0, 0), loose }
    }

    fn next(&mut self) -> Option<Head> {
        let part = self.parts.next()?;
        let (length, count) = (self.taken.0 + part.length, self.taken.1 + 1);
        self.taken = (length, count);
        let is_last = count == self.profile.pieces().len();
        let end = if is_last { 1.0 } else { length / self.length };
        Some(Head { part, end, is_loose: self.loose.next_if_eq(&count).is_some() })
    }
}

#[cfg(test)]
mod tests;

//! Offsets contours of lines and arcs: computes the curves that run at a given distance to one side of the
//! contours, and are nowhere nearer to any contour. A contour is a chain of elements, open or closed.
//!
//! # Method
//! 1. Each element of a contour is moved aside by the distance. At each convex corner, an arc about the
//!    corner is added. The moved elements and the arcs are the pieces (`pieces`).
//! 2. The parts of the pieces that are nearer to a contour than the distance are removed (`clip`).
//! 3. The remaining parts are joined into chains (`link`).
//! 4. At nearly straight corners, a mitre replaces the arc: the elements before and after the arc are
//!    lengthened until they meet (`mitre`).
//! 5. The least distance between the offset and the contours is computed. If it is below the
//!    given distance by more than 1e-6 mm, all mitres are undone, and it is computed again. If it is still
//!    too small, the offset is refused.
//!
//! # Guarantees
//! * Every point of the offset has at least the given distance, less 1e-6 mm, from every contour.
//! * The chains run in the direction of their contours. Each element starts exactly where the element before
//!   it ends.
//! * The offset of an open contour does not run around the ends of the contour.
//! * Contours may cross themselves and each other. If no part of a piece remains, the offset is empty.
//!   More than a million elements are refused.
//!
//! # Cost
//! O(n (log n + k)) for n elements, where k is the number of elements of contours that lie within the given
//! distance of one piece.
//!
//! # Reference
//! X.-Z. Liu, J.-H. Yong, G.-Q. Zheng, J.-G. Sun, *An offset algorithm for polyline curves*, Computers in
//! Industry 58, 2007.

mod clip;
mod link;
mod mitre;
pub(super) mod pieces;
pub mod swept;
pub(super) mod tree;

use nalgebra::Point2;

use crate::budget::{Budget, Stopped};
use crate::geometry::segment::Segment;
use clip::Clip;
use link::OpenRange;
use tree::Tree;

/// How far the distance of an offset from a contour may fall short, mm.
const TOO_NEAR_MM: f64 = 1e-6;

/// A contour is closed if its ends are no farther apart, mm.
const CLOSED_MM: f64 = 1e-9;

/// The largest number of elements of all contours, and of ranges of pieces: what one machine holds with ease.
const LIMIT: usize = 1_000_000;

/// The rounding of a computed distance, as a part of the largest coordinate or radius.
const ROUNDING: f64 = 16.0 * f64::EPSILON;

/// The largest gap between two ranges that are joined, mm, before the allowance for rounding.
const JOINT_MM: f64 = 1e-6;

/// The least and the largest number of samples of an element, in the search for the farthest place.
const SAMPLES: [f64; 2] = [4.0, 256.0];

/// Samples of an element for each offset distance of its length.
const SAMPLES_A_DISTANCE: f64 = 4.0;

/// Elements between two checks of the budget.
const ELEMENTS_BETWEEN_CHECKS: usize = 64;

/// A side of a contour, seen in its direction.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Side {
    Left,
    Right,
}

#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum OffsetError {
    #[error(transparent)]
    Stopped(#[from] Stopped),
    #[error("near {at} no offset could be proved to keep its distance from the contour")]
    Unproved { at: Point2<f64> },
    #[error("the offset needs more than {limit} elements")]
    TooMany { limit: usize },
}

/// The offset of connected chains of lines and arcs, as chains in the direction of the contours. A contour is
/// closed if it ends where it starts. At joints that are almost smooth, the offset may be up to `mitre_mm`
/// farther away than the distance.
///
/// 2,000 elements take 10 to 40 ms, and 100 ms if the distance is ten times the size of the elements.
///
/// # Errors
/// One of [`OffsetError`].
///
/// # Example
/// Outside a corner, the offset is two lines and a quarter of a circle about the corner.
///
/// ```
/// use std::f64::consts::PI;
/// use nalgebra::Point2;
/// use toolpathd_core::budget::Budget;
/// use toolpathd_core::geometry::offset::{Side, offset};
/// use toolpathd_core::geometry::segment::Segment;
///
/// let [start, corner, end] = [[0.0, 0.0], [10.0, 0.0], [10.0, 10.0]].map(Point2::from);
/// let contour = [Segment::Line { start, end: corner }, Segment::Line { start: corner, end }];
/// let chains = offset(&[&contour], Side::Right, 2.0, 0.0, &Budget::unlimited()).unwrap();
/// assert_eq!((chains.len(), chains[0].len()), (1, 3));
/// let length: f64 = chains[0].iter().map(Segment::length).sum();
/// assert!((length - (10.0 + PI + 10.0)).abs() < 1e-9);
/// ```
pub fn offset(
    contours: &[&[Segment]],
    side: Side,
    distance_mm: f64,
    mitre_mm: f64,
    budget: &Budget,
) -> Result<Vec<Vec<Segment>>, OffsetError> {
    if contours.iter().map(|contour| contour.len()).sum::<usize>() > LIMIT {
        return Err(OffsetError::TooMany { limit: LIMIT });
    }
    let to_left = if side == Side::Left { distance_mm } else { -distance_mm };
    let mut elements = Vec::new();
    let mut pieces = Vec::new();
    for contour in contours {
        let (Some(first), Some(last)) = (contour.first(), contour.last()) else { continue };
        let is_closed = (last.end() - first.start()).norm() <= CLOSED_MM;
        let contour = without_specks(contour);
        pieces::append(&contour, elements.len(), is_closed, to_left, &mut pieces);
        elements.extend(contour);
    }
    let contours = Tree::new(elements);

    let largest = contours.elements().iter().map(Segment::magnitude).fold(distance_mm, f64::max);
    let rounding = ROUNDING * largest;
    let mut clip = Clip::new(&contours, distance_mm, rounding);
    let mut ranges = Vec::new();
    let mut open = Vec::new();
    for (k, piece) in pieces.iter().enumerate() {
        if k % ELEMENTS_BETWEEN_CHECKS == 0 {
            budget.check()?;
        }
        clip.open(piece, &mut open);
        ranges.extend(open.drain(..).map(|range| OpenRange { piece: k, range }));
        if ranges.len() > LIMIT {
            return Err(OffsetError::TooMany { limit: LIMIT });
        }
    }
    // Pieces that overlap by less are no deeper in each other than the rounding, so `clip` does not cut them.
    let joint_mm = JOINT_MM + 4.0 * (8.0 * rounding * distance_mm).sqrt();
    let chains = link::chains(&pieces, &ranges, joint_mm, budget)?;
    let mitred: Vec<_> = chains.iter().map(|chain| mitre::mitred(chain, distance_mm, mitre_mm)).collect();
    match prove(&contours, &mitred, distance_mm, budget) {
        Ok(()) => Ok(mitred),
        // A mitre may come near to another part of the contour.
        Err(OffsetError::Unproved { .. }) => {
            prove(&contours, &chains, distance_mm, budget)?;
            Ok(chains)
        }
        Err(other) => Err(other),
    }
}

/// The largest distance of points of a contour from its offset, beyond the offset's distance, mm. The points
/// are samples. A disc with the distance as radius, whose centre follows the offset, leaves this much of the
/// contour unreached.
///
/// # Errors
/// When the budget ends.
pub fn unreached(
    contour: &[Segment],
    offset: &[Vec<Segment>],
    distance_mm: f64,
    budget: &Budget,
) -> Result<f64, Stopped> {
    let offset = Tree::new(offset.iter().flatten().copied().collect());
    let mut farthest: f64 = 0.0;
    // From one sample to the next, the distance grows by no more than the gap between them: this bounds the
    // next search.
    let mut before: Option<(Point2<f64>, f64)> = None;
    for (k, element) in without_specks(contour).iter().enumerate() {
        if k % ELEMENTS_BETWEEN_CHECKS == 0 {
            budget.check()?;
        }
        let [least, most] = SAMPLES;
        let count = (element.length() / distance_mm * SAMPLES_A_DISTANCE).ceil().clamp(least, most);
        for sample in 0..=count as usize {
            let p = element.at(sample as f64 / count);
            let bound = before.map_or(f64::INFINITY, |(q, distance)| distance + (p - q).norm() + JOINT_MM);
            let distance = offset.nearest(p, bound);
            before = Some((p, distance));
            farthest = farthest.max(distance - distance_mm);
        }
    }
    Ok(farthest)
}

/// The contour without elements that are too short to have a direction. The next element starts where the
/// skipped one did.
fn without_specks(contour: &[Segment]) -> Vec<Segment> {
    let mut kept: Vec<Segment> = Vec::with_capacity(contour.len());
    for element in contour {
        let start = match kept.last() {
            Some(before) => before.end(),
            None => element.start(),
        };
        let Some(turn) = pieces::turn_between(element, [0.0, 1.0], [start, element.end()]) else { continue };
        kept.push(match element {
            Segment::Line { end, .. } => Segment::Line { start, end: *end },
            Segment::Arc(arc) => arc.between([start, arc.end()], turn),
        });
    }
    kept
}

fn prove(
    contours: &Tree,
    chains: &[Vec<Segment>],
    distance_mm: f64,
    budget: &Budget,
) -> Result<(), OffsetError> {
    let allowed = distance_mm - TOO_NEAR_MM;
    for (k, element) in chains.iter().flatten().enumerate() {
        if k % ELEMENTS_BETWEEN_CHECKS == 0 {
            budget.check()?;
        }
        let (middle, reach) = element.disc();
        let mut too_near = None;
        contours.near(middle, allowed + reach, |other, _| {
            let (least, at) = element.distance_between(&contours.elements()[other]);
            too_near = (least < allowed).then_some(at);
            too_near.is_none()
        });
        if let Some(at) = too_near {
            return Err(OffsetError::Unproved { at });
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests;

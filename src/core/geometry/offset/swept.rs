//! The boundary of what a disc sweeps whose centre follows chains of lines and arcs.
//!
//! # Method
//! 1. Each element is moved aside by the radius, to both sides. Arcs are added about the corners, and half
//!    circles about the ends of chains (`pieces`).
//! 2. The parts of these pieces that are nearer than the radius to another element are removed (`clip`). What
//!    remains is the boundary.
//! 3. Parts of chains may coincide, and so may their pieces. The first of them remains: ties are broken by a
//!    difference of `TIE_MM`.
//!
//! # Guarantees
//! Every place of the boundary is nowhere nearer to a chain than the radius less `TIE_MM`. Every place at
//! the radius from a chain that is nowhere nearer to any chain is on the boundary, or is within some
//! `TIE_MM` of another chain's distance.
//!
//! # Cost
//! O(n (log n + k)) for n elements, where k is the number of elements within a diameter of one element.

use nalgebra::Point2;

use super::clip::Clip;
use super::pieces::{self, Piece};
use super::tree::Tree;
use super::{CLOSED_MM, ELEMENTS_BETWEEN_CHECKS, ROUNDING, without_specks};
use crate::budget::{Budget, Stopped};
use crate::geometry::segment::{Segment, left};

/// The difference of distances that decides which of two coincident pieces remains, mm: far above rounding,
/// far below what matters.
const TIE_MM: f64 = 1e-9;

/// The boundary of the area that a disc sweeps while its centre follows the chains. The elements come in no
/// particular order. Each element has the swept area on its left.
///
/// # Errors
/// When the budget ends.
pub fn boundary(chains: &[&[Segment]], radius_mm: f64, budget: &Budget) -> Result<Vec<Segment>, Stopped> {
    let mut elements: Vec<Segment> = Vec::new();
    let mut pieces = Vec::new();
    // For each piece, whether the chain is on its left.
    let mut is_left = Vec::new();
    for chain in chains {
        let chain = without_specks(chain);
        let (Some(first), Some(last)) = (chain.first(), chain.last()) else { continue };
        let is_closed = (last.end() - first.start()).norm() <= CLOSED_MM;
        for side in [-radius_mm, radius_mm] {
            pieces::append(&chain, elements.len(), is_closed, side, &mut pieces);
            is_left.resize(pieces.len(), side < 0.0);
        }
        if !is_closed {
            for (element, t, sense) in [(first, 0.0, -1.0), (last, 1.0, 1.0)] {
                let aside = left(element.direction(t)) * (sense * radius_mm);
                let center = element.at(t);
                let index = if sense < 0.0 { elements.len() } else { elements.len() + chain.len() - 1 };
                pieces.extend(half_circle(center, center - aside, radius_mm, index));
            }
            is_left.resize(pieces.len(), true);
        }
        elements.extend(chain);
    }
    let largest = elements.iter().map(Segment::magnitude).fold(radius_mm, f64::max);
    let rounding = ROUNDING * largest;
    let tree = Tree::new(elements);
    let mut clip = Clip::new(&tree, radius_mm, rounding);
    clip.tie = TIE_MM.max(4.0 * rounding);
    let (mut open, mut boundary) = (Vec::new(), Vec::new());
    for (k, (piece, is_left)) in pieces.iter().zip(is_left).enumerate() {
        if k % ELEMENTS_BETWEEN_CHECKS == 0 {
            budget.check()?;
        }
        clip.open(piece, &mut open);
        for [from, to] in open.drain(..) {
            let part = piece.element.part(from, to);
            boundary.push(if is_left { part } else { part.reversed() });
        }
    }
    Ok(boundary)
}

/// The half circle to the left about `center` from `start`, as two quarters.
fn half_circle(center: Point2<f64>, start: Point2<f64>, radius: f64, element_index: usize) -> [Piece; 2] {
    let spoke = start - center;
    let turn = std::f64::consts::FRAC_PI_2;
    let quarter = |from, to| Piece {
        element: Segment::about(center, radius, [center + from, center + to], turn),
        element_index,
        is_corner: true,
    };
    [quarter(spoke, left(spoke)), quarter(left(spoke), -spoke)]
}

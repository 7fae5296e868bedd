//! Replaces arcs that hardly bend by lines, where that takes no more elements.
//!
//! An arc with a radius of several metres along a nearly straight flank is a move that no machinist expects,
//! and rounding of its centre changes how it bends. So a line from the start of such an arc replaces the arc,
//! if the line stays within the band. The line may end before the arc did. Then new elements follow it. They
//! must reach one of the old joints without being more than the elements that led there before. From this
//! joint on, the old elements stay.

use super::Error;
use super::fit::{Fitted, Fitter};
use super::job::Method;
use crate::budget::Budget;
use crate::geometry::deviation::Element;
use crate::geometry::plane_curve::PlaneCurve;
use crate::geometry::segment::{PlaneArc, Segment};

/// A line is taken only if, after at most this many elements, the chain is back at an old joint.
const MOST_MOVED: usize = 16;

/// A line shorter than this share of its arc is not taken: the arc behind it would bend more sharply.
const LEAST_PART: f64 = 0.5;

/// Puts lines in place of arcs that bulge no more than the band is wide.
///
/// # Errors
/// When the budget ends.
pub fn straighten(
    fitter: &Fitter<impl PlaneCurve>,
    fitted: &mut [Fitted],
    budget: &Budget,
) -> Result<(), Error> {
    if fitter.method != Method::Arc {
        return Ok(());
    }
    for k in 0..fitted.len() {
        budget.check()?;
        if let Element::Segment(Segment::Arc(arc)) = fitted[k].element
            && bulge_mm(&arc) <= fitter.band.below_mm.max(fitter.band.above_mm)
            && let Some(moved) = from_line(fitter, &fitted[k..])
        {
            fitted[k..k + moved.len()].copy_from_slice(&moved);
        }
    }
    Ok(())
}

/// The largest distance of an arc from its chord, mm.
fn bulge_mm(arc: &PlaneArc) -> f64 {
    0.5 * (arc.end() - arc.start()).norm() * (arc.turn() / 4.0).tan().abs()
}

/// A line in place of the first element, and new elements after it up to an old joint; `None` if the chain
/// does not get back to one.
fn from_line(fitter: &Fitter<impl PlaneCurve>, rest: &[Fitted]) -> Option<Vec<Fitted>> {
    let [from, to] = rest[0].range;
    let lines = Fitter { method: Method::Linear, ..*fitter };
    let line = lines.longest([from, to], to - from).ok()?;
    let mut moved = vec![line];
    let mut at = line.range[1];
    if at - from < LEAST_PART * (to - from) {
        return None;
    }
    for old in rest.iter().skip(1).take(MOST_MOVED) {
        if at >= old.range[0] {
            break;
        }
        let next = match fitter.fit([at, old.range[1]]) {
            Some(whole) => whole,
            None => fitter.longest([at, old.range[1]], old.range[1] - old.range[0]).ok()?,
        };
        at = next.range[1];
        moved.push(next);
    }
    (at >= rest[moved.len() - 1].range[1]).then_some(moved)
}

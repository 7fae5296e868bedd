//! How deep a ball cuts into the surface on the moves of a path, whoever made it.

use super::{Error, Job};
use crate::budget::Budget;
use crate::geometry::clearance::{Clearance, Penetration};
use crate::geometry::curve::Curve;
use crate::geometry::surface::Patch;
use crate::toolpath::quantize::{Parabolas, quantize};
use crate::toolpath::{Move, Toolpath};

/// Moves between two reports of progress.
const MOVES_BETWEEN_REPORTS: usize = 64;

/// What the tip moves along.
pub(super) fn curves(toolpath: &Toolpath) -> Vec<Curve> {
    let along = |step: &Move| match step {
        Move::Rapid { line } => Some(Curve::Line(*line)),
        Move::Feed { along, .. } => Some(*along),
        Move::Dwell { .. } => None,
    };
    toolpath.moves().filter_map(along).collect()
}

/// The deepest penetration on any of the moves, as computed and as written, to within `gap` mm; what is deeper than `enough` mm ends
/// the search.
pub(super) fn deepest(
    moves: Vec<Curve>,
    clearance: &Clearance<impl Patch>,
    job: &Job,
    [gap, enough]: [f64; 2],
    budget: &Budget,
) -> Result<Penetration, Error> {
    let mut deepest = Penetration::NONE;
    for (k, curve) in moves.iter().enumerate() {
        if k.is_multiple_of(MOVES_BETWEEN_REPORTS) {
            budget.progress("certificate", k, moves.len());
        }
        penetrate(curve, clearance, job, gap, &mut deepest, budget)?;
        if deepest.found_mm > enough {
            break;
        }
    }
    Ok(deepest)
}

/// Raises the deepest penetration to that on one move, as computed and as written.
pub(super) fn penetrate(
    curve: &Curve,
    clearance: &Clearance<impl Patch>,
    job: &Job,
    gap: f64,
    deepest: &mut Penetration,
    budget: &Budget,
) -> Result<(), Error> {
    clearance.penetrate(curve, 0.0, gap, deepest, budget)?;
    for written in quantize(curve, job.resolution, Parabolas::AsLines)? {
        clearance.penetrate(&written.curve, written.slack_mm, gap, deepest, budget)?;
    }
    Ok(())
}

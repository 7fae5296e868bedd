//! How deep a ball cuts into the surface on the moves of a path, whoever made it.

use std::sync::atomic::{AtomicUsize, Ordering};

use super::{Error, Job};
use crate::budget::Budget;
use crate::geometry::clearance::{Clearance, Penetration};
use crate::geometry::curve::Curve;
use crate::geometry::surface::Patch;
use crate::operations::sharing::in_order;
use crate::toolpath::quantize::{Parabolas, quantize};
use crate::toolpath::{Move, Role, Toolpath};

/// Moves that one thread looks at in a row; each row is searched as deep as its own deepest needs.
const MOVES_IN_A_ROW: usize = 64;

/// What the tip moves along.
pub(super) fn curves(toolpath: &Toolpath) -> Vec<Curve> {
    toolpath.moves().filter_map(curve).collect()
}

/// What the tip moves along on the way from pass to pass, and while it cuts.
pub(super) fn curves_between_and_of_passes(toolpath: &Toolpath) -> [Vec<Curve>; 2] {
    let is_of_pass = |step: &&Move| matches!(step, Move::Feed { role: Role::Cut, .. });
    let (of, between): (Vec<&Move>, Vec<&Move>) = toolpath.moves().partition(is_of_pass);
    [between, of].map(|moves| moves.into_iter().filter_map(curve).collect())
}

fn curve(step: &Move) -> Option<Curve> {
    match step {
        Move::Rapid { line } => Some(Curve::Line(*line)),
        Move::Feed { along, .. } => Some(*along),
        Move::Dwell { .. } => None,
    }
}

/// Why a search ends.
enum End {
    /// At something deep enough.
    Deep(Penetration),
    Error(Error),
}

/// The deepest penetration on any of the moves, as computed and as written, to within `gap` mm, or that which is `known`, if it is
/// deeper; what is deeper than `enough` mm ends the search.
pub(super) fn deepest(
    known: Penetration,
    moves: &[Curve],
    clearance: &Clearance<impl Patch>,
    job: &Job,
    [gap, enough]: [f64; 2],
    budget: &Budget,
) -> Result<Penetration, Error> {
    let rows: Vec<&[Curve]> = moves.chunks(MOVES_IN_A_ROW).collect();
    let done = AtomicUsize::new(0);
    let of_row = |k: usize| {
        budget.progress("certificate", done.fetch_add(1, Ordering::Relaxed), rows.len());
        let mut deepest = known;
        for curve in rows[k] {
            penetrate(curve, clearance, job, gap, &mut deepest, budget).map_err(End::Error)?;
            if deepest.found_mm > enough {
                return Err(End::Deep(deepest));
            }
        }
        Ok(deepest)
    };
    match in_order(rows.len(), of_row) {
        Ok(of_rows) => Ok(of_rows.into_iter().fold(known, Penetration::or_deeper)),
        Err(End::Deep(deepest)) => Ok(deepest),
        Err(End::Error(error)) => Err(error),
    }
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

//! Proves how deep the cutter cuts into the surface on the moves of a path, for the path as computed and as
//! the program states it.

use std::sync::atomic::{AtomicUsize, Ordering};

use super::{Error, Job};
use crate::budget::Budget;
use crate::geometry::curve::Curve;
use crate::geometry::surface::Patch;
use crate::machining::gouge::{GougeProof, Penetration};
use crate::toolpath::quantize::quantize;
use crate::toolpath::{Move, Role, Toolpath};

/// Moves that one thread examines in a row. A row compares with its own deepest move only, so that the answer
/// does not depend on the number of threads.
const MOVES_IN_A_ROW: usize = 64;

/// The curves along which the tip moves.
pub(super) fn curves(toolpath: &Toolpath) -> Vec<Curve> {
    toolpath.moves().filter_map(curve).collect()
}

/// The curves along which the tip moves: first those between passes, then those of passes.
pub(super) fn curves_between_and_of_passes(toolpath: &Toolpath) -> [Vec<Curve>; 2] {
    let is_of_pass = |step: &&Move| matches!(step, Move::Feed { role: Role::Cut, .. });
    let (of, between): (Vec<&Move>, Vec<&Move>) = toolpath.moves().partition(is_of_pass);
    [between, of].map(|moves| moves.into_iter().filter_map(curve).collect())
}

fn curve(step: &Move) -> Option<Curve> {
    match step {
        Move::Rapid { line } => Some(Curve::Line(*line)),
        Move::Feed { along, .. } => Some(*along),
        Move::Turn { .. } | Move::Dwell { .. } => None,
    }
}

/// Why a search ends early.
enum End {
    /// A penetration is deeper than `enough`.
    Deep(Penetration),
    Error(Error),
}

/// A search for the deepest penetration, with its progress.
pub(super) struct Search<'a, P> {
    proof: &'a GougeProof<'a, P>,
    job: &'a Job,
    gap: f64,
    enough: f64,
    /// Moves examined so far, of `total`.
    done: AtomicUsize,
    total: usize,
    budget: &'a Budget,
}

impl<'a, P: Patch> Search<'a, P> {
    /// A search over `total` moves, to within `gap` mm. It ends early at a penetration deeper than `enough`
    /// mm.
    pub(super) fn new(
        proof: &'a GougeProof<'a, P>,
        job: &'a Job,
        [gap, enough]: [f64; 2],
        total: usize,
        budget: &'a Budget,
    ) -> Self {
        Self { proof, job, gap, enough, done: AtomicUsize::new(0), total, budget }
    }

    /// The deepest penetration on `moves`, as computed and as written; `known` if that is deeper.
    pub(super) fn deepest(&self, known: Penetration, moves: &[Curve]) -> Result<Penetration, Error> {
        let rows: Vec<&[Curve]> = moves.chunks(MOVES_IN_A_ROW).collect();
        match self.budget.in_order(rows.len(), |k| self.of_row(known, rows[k])) {
            Ok(of_rows) => Ok(of_rows.into_iter().fold(known, Penetration::or_deeper)),
            Err(End::Deep(deepest)) => Ok(deepest),
            Err(End::Error(error)) => Err(error),
        }
    }

    fn of_row(&self, known: Penetration, row: &[Curve]) -> Result<Penetration, End> {
        let done = self.done.fetch_add(row.len(), Ordering::Relaxed);
        self.budget.progress("certificate", done, self.total);
        let mut deepest = known;
        for curve in row {
            penetrate(curve, self.proof, self.job, self.gap, &mut deepest, self.budget)
                .map_err(End::Error)?;
            if deepest.found_mm > self.enough {
                return Err(End::Deep(deepest));
            }
        }
        Ok(deepest)
    }
}

/// Raises `deepest` to the penetration on one move, as computed and as written, if that is deeper.
pub(super) fn penetrate(
    curve: &Curve,
    proof: &GougeProof<impl Patch>,
    job: &Job,
    gap: f64,
    deepest: &mut Penetration,
    budget: &Budget,
) -> Result<(), Error> {
    proof.penetrate(curve, 0.0, gap, deepest, budget)?;
    for written in quantize(curve, job.resolution, &job.curves)? {
        proof.penetrate(&written.curve, written.slack_mm, gap, deepest, budget)?;
    }
    Ok(())
}

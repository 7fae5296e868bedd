//! Joins passes to one toolpath. In a zigzag, a link leads from a pass to the next one, if some link is
//! proved clear of the surface and takes less time than the way over the retract plane. Otherwise the cutter
//! leaves the pass, goes over the retract plane, and enters the next pass (`entries`).
//!
//! # Method
//! The first link tried is a straight line. If it is not proved clear, try two lines that meet above the
//! middle of the first one. Double the height of the point where they meet, until both lines are proved clear
//! or take too long. With the boundary `inside`, no link leads outside the room of the passes.

use nalgebra::{Point3, center};

use super::entries::{Entries, Proofs};
use super::passes::CutPass;
use super::planes::Slicer;
use super::{CutDirection, Error, Job};
use crate::budget::Budget;
use crate::geometry::curve::{Curve, Line};
use crate::geometry::surface::Patch;
use crate::toolpath::cutting::Cutting;
use crate::toolpath::linking::at_height;
use crate::toolpath::{Role, Toolpath};

/// The first lift of a link's middle, as a share of the link's length; each further lift is twice as high.
const FIRST_LIFT: f64 = 1.0 / 64.0;

/// The toolpath, and how many of the requested entries and exits are not clear.
#[derive(Debug)]
pub(super) struct Joined {
    pub(super) toolpath: Toolpath,
    pub(super) n_not_clear: usize,
}

/// Joins `passes` to a toolpath, from the clearance plane over the first pass to the clearance plane over the
/// last.
pub(super) fn join<P: Patch>(
    job: &Job,
    cutting: &Cutting,
    passes: &[CutPass],
    proofs: &Proofs<P>,
    slicer: &Slicer,
    budget: &Budget,
) -> Result<Joined, Error> {
    let entries = Entries { job, cutting, proofs, slicer, budget };
    let mut n_not_clear = 0;
    let start = at_height(entries.first_place(&passes[0])?, cutting.clearance_z_mm);
    let mut builder = Toolpath::builder(start).with_limit(job.move_limit);
    for (k, pass) in passes.iter().enumerate() {
        budget.check()?;
        let before = k.checked_sub(1).map(|before| &passes[before]);
        let link = match before.filter(|_| job.direction == CutDirection::Zigzag) {
            Some(before) => link(&entries, before.end(), pass.start())?,
            None => None,
        };
        if let Some(ways) = link {
            builder.begin_pass(None);
            for way in ways {
                builder.line(way.end, cutting.feed_of(Role::Link), Role::Link)?;
            }
        } else {
            if let Some(before) = before {
                n_not_clear += usize::from(!entries.leave(&mut builder, before)?);
                builder.rapid_to_height(cutting.retract_z_mm)?;
            }
            builder.begin_pass(None);
            n_not_clear += usize::from(!entries.enter(&mut builder, pass)?);
        }
        for curve in &pass.curves {
            builder.follow(*curve, cutting.feed, Role::Cut)?;
        }
    }
    n_not_clear += usize::from(!entries.leave(&mut builder, &passes[passes.len() - 1])?);
    builder.rapid_to_height(cutting.clearance_z_mm)?;
    Ok(Joined { toolpath: builder.finish()?, n_not_clear })
}

/// The lines of a link from one pass to the next; `None` if no link is both clear and quicker than the way
/// over the retract plane.
fn link(
    entries: &Entries<impl Patch>,
    from: Point3<f64>,
    to: Point3<f64>,
) -> Result<Option<Vec<Line>>, Error> {
    if !entries.slicer.lets_pass(&from, &to) {
        return Ok(None);
    }
    let straight = Line { start: from, end: to };
    let retract_min = entries.minutes_over(&straight)?;
    let feed = entries.cutting.link_feed.mm_per_min();
    let mut ways = vec![straight];
    let mut lift = FIRST_LIFT * straight.length();
    while ways.iter().map(Line::length).sum::<f64>() / feed <= retract_min {
        if entries.are_clear(ways.iter().map(|way| Curve::Line(*way)))? {
            return Ok(Some(ways));
        }
        let mut over = center(&from, &to);
        over.z += lift;
        if over.z >= entries.cutting.retract_z_mm || lift == 0.0 {
            break;
        }
        ways = vec![Line { start: from, end: over }, Line { start: over, end: to }];
        lift *= 2.0;
    }
    Ok(None)
}

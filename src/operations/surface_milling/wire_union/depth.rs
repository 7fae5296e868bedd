//! How deep a path that may gouge cuts.
//!
//! # Method
//! For a ball it is the certificate of every other path. For other shapes the depth is measured along the axis: how far the cutter
//! would have to be lifted to touch the surface only. It is bounded on a piece of the path in two ways:
//! 1. *By a disc*: while the axis goes no farther than h from a place, the cutter stays within one whose flat is h larger with its
//!    tip at the least height of the way. The height to which that larger cutter comes down over the place, less the least
//!    height, bounds the depth.
//! 2. *By a chord*: where the tips that touch are proved to keep to the chord of those at the ends
//!    ([`Contacts::is_within`]), the depth is at most that at an end, and what the proof leaves.
//!
//! What is not decided is halved; the depth at the middle tells what cannot matter.
//!
//! # Guarantees
//! An upper bound over every point of every move, as computed and as written, exact to the gap but where the limit of
//! halvings is reached. No point of the cutter is deeper in the surface than along the axis.
//!
//! # Cost
//! O(moves), with a search of the larger cutters' contacts for each of some ten halvings near the deepest place.

use nalgebra::{Point3, Vector2, Vector3};

use super::super::{Error, Job, certificate};
use crate::budget::{Budget, Stopped};
use crate::geometry::clearance::{Clearance, Penetration};
use crate::geometry::contact::{Contact, Contacts};
use crate::geometry::curve::Line;
use crate::geometry::cutter::Cutter;
use crate::geometry::surface::{BezierSurface, Patch};
use crate::toolpath::Toolpath;
use crate::toolpath::quantize::{Parabolas, quantize};
use crate::toolpath::tool::Shape;

/// The half length of the longest pieces that are looked at, in radii of the cutter.
const LONGEST_SHARE: f64 = 0.5;

/// Halvings of a piece.
const LEVELS: usize = 14;

/// The deepest penetration on any move, as computed and as written, to within `gap` mm.
pub(super) fn deepest<P: Patch>(
    surface: &BezierSurface<P>,
    toolpath: &Toolpath,
    job: &Job,
    gap: f64,
    budget: &Budget,
) -> Result<Penetration, Error> {
    match job.tool.shape {
        Shape::Ball => {
            let clearance = Clearance::new(surface, job.tool.radius_mm, job.tool.radius_mm);
            let moves = certificate::curves(toolpath);
            let search = certificate::Search::new(&clearance, job, [gap, f64::INFINITY], moves.len(), budget);
            search.deepest(Penetration::NONE, &moves)
        }
        Shape::Flat | Shape::BullNose { .. } => by_contact(surface, toolpath, job, gap, budget),
    }
}

fn by_contact<P: Patch>(
    surface: &BezierSurface<P>,
    toolpath: &Toolpath,
    job: &Job,
    gap: f64,
    budget: &Budget,
) -> Result<Penetration, Error> {
    let cutter = job.tool.cutter();
    let mut search = Search {
        longest: LONGEST_SHARE * cutter.radius(),
        exact: Contacts::new(surface, cutter, budget)?,
        larger: Vec::new(),
        surface,
        gap,
        deepest: Penetration::NONE,
        budget,
    };
    // Rounding moves a path by less than its slack and a step each way.
    let top = search.exact.bounds().max.z + job.resolution.step_mm();
    let mut moves = certificate::curves(toolpath);
    moves.retain(|curve| curve.start().z < top || curve.end().z < top);
    for (k, curve) in moves.iter().enumerate() {
        if k.is_multiple_of(64) {
            budget.progress("certificate", k, moves.len());
        }
        search.line(&Line { start: curve.start(), end: curve.end() })?;
        for written in quantize(curve, job.resolution, Parabolas::AsLines)? {
            search.line(&Line { start: written.curve.start(), end: written.curve.end() })?;
        }
    }
    Ok(search.deepest)
}

/// The search for the deepest place of a cutter that is no ball.
struct Search<'a, P> {
    surface: &'a BezierSurface<P>,
    exact: Contacts<'a, P>,
    /// The cutters with larger flats, by halvings of the longest piece, as far as they were needed.
    larger: Vec<Contacts<'a, P>>,
    longest: f64,
    gap: f64,
    deepest: Penetration,
    budget: &'a Budget,
}

/// A piece of the path, and how often the longest was halved.
#[derive(Clone, Copy)]
struct Piece {
    middle: Point3<f64>,
    /// From the middle to the end, mm.
    half: Vector3<f64>,
    level: usize,
}

impl Piece {
    fn halves(&self) -> [Piece; 2] {
        let half = 0.5 * self.half;
        [-half, half].map(|way| Piece { middle: self.middle + way, half, level: self.level + 1 })
    }
}

impl<'a, P: Patch> Search<'a, P> {
    /// Raises the deepest penetration to that on a line.
    fn line(&mut self, line: &Line) -> Result<(), Stopped> {
        let way = line.end - line.start;
        let n = (0.5 * way.xy().norm() / self.longest).ceil().max(1.0);
        let half = way / (2.0 * n);
        let piece = |k: usize| Piece { middle: line.start + half * (2 * k + 1) as f64, half, level: 0 };
        let mut open: Vec<Piece> = (0..n as usize).map(piece).collect();
        while let Some(piece) = open.pop() {
            self.budget.check()?;
            let middle = self.contact(piece.middle)?;
            if let Some(contact) = middle {
                self.found(&contact, piece.middle);
            }
            let enough = self.deepest.bound_mm.max(self.deepest.found_mm + self.gap);
            let mut bound = self.bound_by_disc(&piece)?;
            if bound > enough {
                bound = bound.min(self.bound_by_chord(&piece)?);
            }
            if bound <= enough || piece.level >= LEVELS {
                self.deepest.bound_mm = self.deepest.bound_mm.max(bound);
            } else {
                open.extend(piece.halves());
            }
        }
        Ok(())
    }

    fn contact(&self, tip: Point3<f64>) -> Result<Option<Contact>, Stopped> {
        self.exact.drop(tip.xy().coords, None, self.budget)
    }

    /// Takes note of how deep the cutter is with its tip at a place over which it would touch at `contact`.
    fn found(&mut self, contact: &Contact, tip: Point3<f64>) {
        let depth = contact.tip.z - tip.z;
        if depth > self.deepest.found_mm {
            self.deepest.found_mm = depth;
            self.deepest.at = Some(contact.point);
        }
    }

    /// How deep the cutter is anywhere on a piece, at most, if the tips that touch are known to keep to their chord; mm.
    fn bound_by_chord(&self, piece: &Piece) -> Result<f64, Stopped> {
        let ends = [piece.middle - piece.half, piece.middle + piece.half];
        let [Some(from), Some(to)] = [self.contact(ends[0])?, self.contact(ends[1])?] else {
            return Ok(f64::INFINITY);
        };
        // Half of the gap pays for the chord, the other half for what lies between the ends and the deepest place found.
        let height = 0.5 * self.gap;
        if !self.exact.is_within(&from, &to, height) {
            return Ok(f64::INFINITY);
        }
        let deeper = (from.tip.z + from.gap_mm - ends[0].z).max(to.tip.z + to.gap_mm - ends[1].z);
        Ok((deeper + height).max(0.0))
    }

    /// How deep the cutter is anywhere on a piece, at most, by a cutter that holds it all along; mm.
    fn bound_by_disc(&mut self, piece: &Piece) -> Result<f64, Stopped> {
        let lowest = piece.middle.z - piece.half.z.abs();
        let contacts = if piece.half.xy() == Vector2::zeros() {
            &self.exact
        } else {
            while self.larger.len() <= piece.level {
                let by = self.longest / (1u64 << self.larger.len()) as f64;
                let cutter = self.exact.cutter();
                let larger = Cutter::bull_nose(cutter.radius() + by, cutter.corner_radius());
                self.larger.push(Contacts::new(self.surface, larger, self.budget)?);
            }
            &self.larger[piece.level]
        };
        let contact = contacts.drop(piece.middle.xy().coords, None, self.budget)?;
        Ok(contact.map_or(0.0, |contact| (contact.tip.z + contact.gap_mm - lowest).max(0.0)))
    }
}

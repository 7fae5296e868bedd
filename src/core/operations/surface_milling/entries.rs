//! Finds the moves by which the cutter comes down to a pass, and by which it leaves the pass.
//!
//! # Method
//! 1. *Rapid.* The cutter comes down by rapid to [`APPROACH_MM`] above the stock. For a block of stock, this
//!    height is the same everywhere. For a layer of stock on the surface, bisection finds the height: a
//!    cutter that is larger by the thickness of the layer must be proved to stay off the surface, down to
//!    [`APPROACH_MM`] below the end of the rapid ([`gouge`](crate::machining::gouge)). If the job states no
//!    stock, the thickness is zero.
//! 2. *Entry.* The cutter plunges, or enters by a ramp or an arc if the job asks for one. If the ramp or the
//!    arc cannot be proved clear of the surface, the cutter plunges instead.
//! 3. *Exit.* The cutter leaves by an arc if the job asks for one and the arc is proved clear of the surface.
//!    Otherwise it goes straight up.
//!
//! With the boundary `inside`, ramps and arcs whose axis would leave the room of the passes are not made. An
//! arc is tried with smaller radii first.

use nalgebra::{Point3, Vector3};

use super::passes::CutPass;
use super::planes::Slicer;
use super::{CERTIFICATE_GAP, Entry, Error, Exit, Job, Stock, certificate};
use crate::budget::Budget;
use crate::geometry::curve::{Arc, Curve, Direction, Line};
use crate::geometry::solve::try_bisect;
use crate::geometry::surface::{BezierSurface, Patch};
use crate::machining::gouge::{GougeProof, Penetration};
use crate::toolpath::cutting::Cutting;
use crate::toolpath::linking::at_height;
use crate::toolpath::{Builder, PathError, Role};

/// Height of the cutter over the stock where a rapid down ends and the feed begins, mm.
pub(super) const APPROACH_MM: f64 = 2.0;

/// Bisection steps between a height that is not proved free and one that is: 10 find it to a thousandth of
/// the way down.
const HALVINGS: usize = 10;

/// How often the radius of an arc that would leave the outline is halved.
const RADIUS_HALVINGS: i32 = 4;

/// The most legs of one ramp; a ramp that needs more is not made, and the cutter plunges.
const LEG_LIMIT: usize = 200;

/// The proofs of how deep the cutter cuts.
pub(super) struct Proofs<'a, P> {
    /// Depth in the surface with its allowance.
    pub(super) left: GougeProof<'a, P>,
    /// Depth in the surface with its allowance and the layer of stock to be cut.
    stocked: GougeProof<'a, P>,
}

impl<'a, P: Patch> Proofs<'a, P> {
    pub(super) fn new(surface: &'a BezierSurface<P>, job: &Job) -> Self {
        let thickness = job.stock.map_or(0.0, Stock::thickness_mm);
        let proof = |stock: f64| GougeProof::new(surface, &job.tool.cutter(), stock);
        Self { left: proof(job.allowance_mm), stocked: proof(job.allowance_mm + thickness) }
    }
}

/// Finds the moves by which the cutter enters and leaves a pass.
pub(super) struct Entries<'a, P> {
    pub(super) job: &'a Job,
    pub(super) cutting: &'a Cutting,
    pub(super) proofs: &'a Proofs<'a, P>,
    /// Where the axis may go.
    pub(super) slicer: &'a Slicer<'a>,
    pub(super) budget: &'a Budget,
}

impl<P: Patch> Entries<'_, P> {
    /// The place over which the cutter first comes down to a pass.
    pub(super) fn first_place(&self, pass: &CutPass) -> Result<Point3<f64>, Error> {
        Ok(self.lead_in(pass)?.first().map_or(pass.start(), Curve::start))
    }

    /// Moves the cutter from the builder's place at rapid height to the start of a pass. Returns whether the
    /// entry is the requested one.
    pub(super) fn enter(&self, builder: &mut Builder, pass: &CutPass) -> Result<bool, Error> {
        let lead = self.lead_in(pass)?;
        let (from, low) = match lead.first() {
            Some(lead) => (lead.start(), lead.start().z),
            None => (pass.start(), self.above_stock(pass.start().z)),
        };
        builder.rapid_over(from, builder.at().z, self.free_height(from, low)?)?;
        if builder.at() != from {
            builder.line(from, self.cutting.feed_of(Role::Plunge), Role::Plunge)?;
        }
        let role = if matches!(self.job.entry, Entry::Ramp { .. }) { Role::Ramp } else { Role::LeadIn };
        for curve in &lead {
            builder.follow(*curve, self.cutting.feed_of(role), role)?;
        }
        Ok(!lead.is_empty() || self.job.entry == Entry::Plunge)
    }

    /// Moves the cutter from the end of a pass along the requested arc. Returns `false`, without a move, if
    /// there is no room for the arc.
    pub(super) fn leave(&self, builder: &mut Builder, pass: &CutPass) -> Result<bool, Error> {
        let Exit::Arc { radius_mm } = self.job.exit else { return Ok(true) };
        let last = pass.curves[pass.curves.len() - 1];
        let Some(arc) = self.arc_from(last.end(), last.tangents()[1], radius_mm)? else {
            return Ok(false);
        };
        let is_clear = self.are_clear([arc])?;
        if is_clear {
            builder.follow(arc, self.cutting.feed_of(Role::LeadOut), Role::LeadOut)?;
        }
        Ok(is_clear)
    }

    /// Whether all curves are proved to cut no deeper than the tolerance, as computed and as written.
    pub(super) fn are_clear(&self, curves: impl IntoIterator<Item = Curve>) -> Result<bool, Error> {
        for curve in curves {
            if !self.is_clear(&curve, &self.proofs.left)? {
                return Ok(false);
            }
        }
        Ok(true)
    }

    /// The time from the start of a link to its end by way of the retract plane, min.
    pub(super) fn minutes_over(&self, link: &Line) -> Result<f64, Error> {
        let free = self.free_height(link.end, self.above_stock(link.end.z))?;
        let high = self.cutting.retract_z_mm;
        let rapid = (high - link.start.z) + (link.end - link.start).xy().norm() + (high - free);
        Ok(rapid / self.cutting.rapid_feed.mm_per_min()
            + (free - link.end.z) / self.cutting.plunge_feed.mm_per_min())
    }

    /// The least height of a rapid over a place that touches the finished surface at `z`.
    fn above_stock(&self, z: f64) -> f64 {
        z + APPROACH_MM + self.job.stock.map_or(0.0, Stock::thickness_mm)
    }

    /// The lowest height to which the cutter may come down over a place by rapid, mm. It is not below `low`,
    /// and not above the higher of `low` and the retract plane.
    fn free_height(&self, place: Point3<f64>, low: f64) -> Result<f64, Error> {
        let high = self.cutting.retract_z_mm.max(low);
        if let Some(Stock::Block { top_z_mm }) = self.job.stock {
            return Ok((top_z_mm + APPROACH_MM).clamp(low, high));
        }
        if self.is_free(place, [low, high])? {
            return Ok(low);
        }
        let [free, _] = try_bisect([high, low], HALVINGS, |z| self.is_free(place, [z, high]))?;
        Ok(free)
    }

    /// Whether the cutter on its way down from `high` to `low` over a place has nothing to cut within
    /// [`APPROACH_MM`] below it.
    fn is_free(&self, place: Point3<f64>, [low, high]: [f64; 2]) -> Result<bool, Error> {
        let way = Line { start: at_height(place, high), end: at_height(place, low - APPROACH_MM) };
        self.is_clear(&Curve::Line(way), &self.proofs.stocked)
    }

    fn is_clear(&self, curve: &Curve, proof: &GougeProof<P>) -> Result<bool, Error> {
        let gap = CERTIFICATE_GAP * self.job.tolerance.mm();
        // From this bound on, the search looks for deeper cuts only.
        let most = self.job.tolerance.mm() - gap;
        let mut deepest = Penetration { bound_mm: most, ..Penetration::NONE };
        certificate::penetrate(curve, proof, self.job, gap, &mut deepest, self.budget)?;
        Ok(deepest.bound_mm <= most)
    }

    /// The curves along which the cutter enters a pass; empty for a plunge.
    fn lead_in(&self, pass: &CutPass) -> Result<Vec<Curve>, Error> {
        let start = pass.start();
        match self.job.entry {
            Entry::Plunge => Ok(Vec::new()),
            Entry::Arc { radius_mm } => {
                // The entry is the exit from the same pass cut backwards.
                let backwards = -pass.curves[0].tangents()[0];
                let Some(exit) = self.arc_from(start, backwards, radius_mm)? else {
                    return Ok(Vec::new());
                };
                let Curve::Arc(exit) = exit else { return Ok(Vec::new()) };
                let arc = self.short_arc(exit.end(), start, exit.center())?;
                Ok(if self.are_clear([arc])? { vec![arc] } else { Vec::new() })
            }
            Entry::Ramp { slope } => {
                let axis = 1 - self.job.plane.normal_axis();
                let span = pass.end()[axis] - start[axis];
                let mut ahead = Vector3::zeros();
                ahead[axis] = span.abs().max(2.0 * self.job.tool.radius_mm).copysign(span);
                for leg in [ahead, -ahead] {
                    let ramp = self.ramp(start, leg, slope)?;
                    if let Some(first) = ramp.first()
                        && self.slicer.lets_pass(&start, &first.start())
                        && self.slicer.lets_pass(&start, &first.end())
                        && self.free_height(first.start(), first.start().z)? <= first.start().z
                        && self.are_clear(ramp.iter().copied())?
                    {
                        return Ok(ramp);
                    }
                }
                Ok(Vec::new())
            }
        }
    }

    /// The legs of a ramp down to `end`, to and fro between `end` and a place at most one `leg` away. They
    /// fall by `slope` mm per mm of horizontal travel. Empty if the ramp needs more than [`LEG_LIMIT`] legs.
    fn ramp(&self, end: Point3<f64>, leg: Vector3<f64>, slope: f64) -> Result<Vec<Curve>, Error> {
        let rise = self.free_height(end, self.above_stock(end.z))? - end.z;
        let way = rise / slope;
        let n = (way / leg.norm()).ceil().max(1.0);
        if n > LEG_LIMIT as f64 {
            return Ok(Vec::new());
        }
        let leg = leg.normalize() * (way / n);
        let place = |k: usize| {
            let beside = if k.is_multiple_of(2) { Vector3::zeros() } else { leg };
            end + beside + Vector3::z() * (rise * (k as f64 / n))
        };
        let down = (0..n as usize).rev();
        Ok(down.map(|k| Curve::Line(Line { start: place(k + 1), end: place(k) })).collect())
    }

    /// The arc that continues from `place` along `tangent` and bends up, with the requested radius or, where
    /// the axis would leave its room, the largest of its halves that stays inside.
    fn arc_from(
        &self,
        place: Point3<f64>,
        tangent: Vector3<f64>,
        radius_mm: f64,
    ) -> Result<Option<Curve>, Error> {
        for halvings in 0..=RADIUS_HALVINGS {
            let radius_mm = radius_mm * 0.5f64.powi(halvings);
            let Some(Quarter { far, center }) = self.quarter(place, tangent, radius_mm) else { continue };
            let arc = self.short_arc(place, far, center)?;
            if self.stays_inside(&arc) {
                return Ok(Some(arc));
            }
        }
        Ok(None)
    }

    /// Whether the axis stays where it may go. In plan, a curve in the plane of a pass covers the way between
    /// its two farthest places.
    fn stays_inside(&self, curve: &Curve) -> bool {
        let mut along = Vector3::zeros();
        along[1 - self.job.plane.normal_axis()] = 1.0;
        let end = |sense: f64| {
            let mut end = curve.start();
            end[1 - self.job.plane.normal_axis()] = sense * curve.support(&(along * sense));
            end
        };
        self.slicer.lets_pass(&end(-1.0), &end(1.0))
    }

    /// The quarter of a circle that continues from `place` along `tangent` and bends up; `None` if it ends
    /// below `place` or above the retract plane.
    fn quarter(&self, place: Point3<f64>, tangent: Vector3<f64>, radius_mm: f64) -> Option<Quarter> {
        let mut along = tangent;
        along[self.job.plane.normal_axis()] = 0.0;
        let along = along.try_normalize(0.0)?;
        let up = (Vector3::z() - along * along.z).try_normalize(0.0)?;
        let center = place + up * radius_mm;
        let far = center + along * radius_mm;
        (place.z..=self.cutting.retract_z_mm).contains(&far.z).then_some(Quarter { far, center })
    }

    /// The arc of less than half a turn in the plane of the passes.
    fn short_arc(&self, start: Point3<f64>, end: Point3<f64>, center: Point3<f64>) -> Result<Curve, Error> {
        let plane = self.job.plane.arc_plane();
        let [a, b, _] = plane.axes();
        let [from, to] = [start - center, end - center];
        let direction = if from[a] * to[b] > from[b] * to[a] { Direction::Ccw } else { Direction::Cw };
        Ok(Curve::Arc(Arc::new(plane, direction, start, end, center).map_err(PathError::from)?))
    }
}

/// A quarter of a circle, given by its far end and its centre.
struct Quarter {
    far: Point3<f64>,
    center: Point3<f64>,
}

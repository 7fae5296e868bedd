//! Counts the work of an interpolation, so that it ends at the same place every time, on any machine.

use std::sync::atomic::{AtomicU64, Ordering};

use nalgebra::{Point2, Vector2};

use super::Error;
use crate::budget::Budget;
use crate::geometry::plane_curve::{Enclosure, PlaneCurve};

/// The most steps of a job whose caller sets no limit.
pub const DEFAULT_STEP_LIMIT: u64 = 2_000_000_000;

/// Steps of a point beside those of its operations: what is computed with it takes this long.
const OF_POINT: u64 = 4;

/// Steps of a derivative and of an enclosure, in steps of a point.
const OF_DERIVATIVE: u64 = 2;
const OF_ENCLOSURE: u64 = 4;

/// The share of the steps in which a search for something better has to end: a second of work, or two.
const SEARCH_SHARE: u64 = 16;

/// Points of the curve that the search for one element may take beside this share. A usual element takes some
/// hundred to some ten thousand; an element whose proofs fail takes a million.
const OF_ELEMENT: u64 = 100_000;

/// How many steps a job has taken, and how many it may take.
///
/// Elements that stay within the band may take all steps up to the limit. A search for something better ends
/// after a share of them ([`SEARCH_SHARE`]): longer elements, fewer elements, a lower bound. What it has not
/// found by then is left.
pub struct Meter<'a> {
    budget: &'a Budget,
    limit: u64,
    used: AtomicU64,
    /// The steps up to which longer elements are looked for.
    for_longer: AtomicU64,
}

impl<'a> Meter<'a> {
    pub fn new(limit: u64, budget: &'a Budget) -> Self {
        let for_longer = AtomicU64::new(limit / SEARCH_SHARE);
        Self { budget, limit, used: AtomicU64::new(0), for_longer }
    }

    /// One thread counts, so that the count needs no lock.
    fn count(&self, steps: u64) {
        self.used.store(self.used() + steps, Ordering::Relaxed);
    }

    fn used(&self) -> u64 {
        self.used.load(Ordering::Relaxed)
    }

    /// # Errors
    /// When the budget ends, or the job has taken all its steps.
    pub fn check(&self) -> Result<(), Error> {
        self.budget.check()?;
        if self.has_steps() { Ok(()) } else { Err(Error::TooManySteps { limit: self.limit }) }
    }

    fn has_steps(&self) -> bool {
        self.used() <= self.limit
    }

    /// How many steps there are when a search that begins now has to end.
    pub fn end_of_search(&self) -> u64 {
        self.used() + self.limit / SEARCH_SHARE
    }

    /// Whether the steps have passed the end of a search.
    pub fn is_past(&self, end: u64) -> bool {
        self.used() > end
    }

    /// Whether there are steps left for a search for longer elements.
    pub fn has_steps_for_search(&self) -> bool {
        self.used() <= self.for_longer.load(Ordering::Relaxed)
    }

    /// Gives the search the steps of one more element of a curve whose points take `operations`.
    pub fn found_element(&self, operations: u64) {
        let steps = self.for_longer.load(Ordering::Relaxed);
        self.for_longer.store(steps.saturating_add(OF_ELEMENT * operations), Ordering::Relaxed);
    }

    /// # Errors
    /// When a proof may have been given up because the budget ended, or because it took far too many steps.
    pub fn finish(&self) -> Result<(), Error> {
        self.budget.check()?;
        if self.is_far_beyond() { Err(Error::TooManySteps { limit: self.limit }) } else { Ok(()) }
    }

    fn is_far_beyond(&self) -> bool {
        self.used() > self.limit.saturating_mul(2)
    }

    fn is_spent(&self) -> bool {
        self.is_far_beyond() || self.budget.check().is_err()
    }
}

/// A curve whose values are counted.
pub struct Metered<'a, C> {
    curve: &'a C,
    meter: &'a Meter<'a>,
    operations: u64,
}

impl<'a, C: PlaneCurve> Metered<'a, C> {
    pub fn new(curve: &'a C, meter: &'a Meter<'a>) -> Self {
        Self { curve, meter, operations: OF_POINT + curve.operations() }
    }
}

impl<C: PlaneCurve> PlaneCurve for Metered<'_, C> {
    fn domain(&self) -> [f64; 2] {
        self.curve.domain()
    }

    fn breaks(&self) -> &[f64] {
        self.curve.breaks()
    }

    fn is_graph(&self) -> bool {
        self.curve.is_graph()
    }

    fn operations(&self) -> u64 {
        self.operations
    }

    fn is_spent(&self) -> bool {
        self.meter.is_spent()
    }

    fn point(&self, t: f64) -> Point2<f64> {
        self.meter.count(self.operations);
        self.curve.point(t)
    }

    fn derivative(&self, t: f64) -> Vector2<f64> {
        self.meter.count(OF_DERIVATIVE * self.operations);
        self.curve.derivative(t)
    }

    fn enclose(&self, from: f64, to: f64) -> Enclosure {
        self.meter.count(OF_ENCLOSURE * self.operations);
        self.curve.enclose(from, to)
    }
}

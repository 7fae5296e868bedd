//! Proves how far an element (a line, an arc or a parabola) deviates from a curve, over a range of the
//! curve's parameter. The caller gives the band: the largest deviations that are allowed to the left and to
//! the right of the curve. They are numbers ([`Band`]), or change along the curve ([`Sides`]).
//!
//! # Method
//! 1. At some parameters, the signed distance of the curve from the element is computed (`gauge`). Each
//!    result is a reading: an interval that contains the exact distance.
//! 2. Each two neighbouring readings give an interval that contains the distance everywhere between them. It
//!    follows from a bound of the second derivative of the distance. If the second derivative has no bound,
//!    it follows from one of the readings and a bound of how far the curve moves between the two parameters.
//! 3. If this interval is not inside the band, or reaches much farther than the largest reading so far, one
//!    more reading is made in the middle between the two. Step 2 is then done for both halves.
//! 4. The search ends when nothing is left to be halved, when a reading lies outside the band, or after some
//!    thousands of readings.
//!
//! # Guarantees
//! * [`Verdict::Within`] proves that the deviation is within the band at every parameter of the range. Its
//!   [`Spread`] contains all these deviations. With [`Measure::Normal`], it also proves that no point of the
//!   element is farther from the curve than [`Spread::largest_mm`].
//! * [`Verdict::Outside`] names a parameter at which the deviation is certainly outside the band.
//! * [`Verdict::Unproved`] says that some thousands of readings were not enough to decide, or that the curve
//!   gives no more values ([`PlaneCurve::is_spent`]).
//!
//! # Cost
//! O(1) readings for a smooth curve well within the band. If the largest deviation is close to the limit of
//! the band, below or above it, O(log(1 / g)) readings. Here g is the difference of the two, divided by the
//! limit.

mod element;
mod gauge;

use super::interval::Interval;
use super::plane_curve::PlaneCurve;
pub use element::Element;
use gauge::{Gauge, Normal, Reading, Vertical};

/// The allowance by which every band is widened for rounding: `GUARD_MM`, mm, plus `GUARD_PART` of the
/// largest coordinate. With less, a straight line might not pass a band that has no room on one side.
pub const GUARD_MM: f64 = 1e-12;
pub const GUARD_PART: f64 = 256.0 * f64::EPSILON;

/// A bound may exceed the largest reading by `LOOSE_PART` of it plus `LOOSE_MM`, mm.
const LOOSE_PART: f64 = 0.25;
const LOOSE_MM: f64 = 2.5e-7;

/// The most cells of one proof, and the extra cells for each break of the curve in its range.
const MOST_CELLS: usize = 4096;
const CELLS_A_BREAK: usize = 64;

/// A proof is given up if its first `LOOK_CELLS` cells do not prove more than `LOOK_PART` of the range: at
/// this pace all cells would prove an eighth of the range.
const LOOK_CELLS: usize = 512;
const LOOK_PART: f64 = 1.0 / 64.0;

/// Cells between two looks at whether the proof is still wanted.
const CELLS_BETWEEN_CHECKS: usize = 64;

/// If the range has more breaks than `BREAKS_TO_PROBE`, a few parameters are read first, because the element
/// will hardly fit. `PROBES` is the number of parts that these parameters divide the range into.
const BREAKS_TO_PROBE: usize = 4;
const PROBES: u32 = 9;

/// A product of a few numbers times this is no less than the exact product: some forty roundings, of which
/// six occur.
const ROUNDED_UP: f64 = 1.0 + 1e-14;

/// How the distance from the curve is measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "wire", derive(serde::Deserialize, utoipa::ToSchema), serde(rename_all = "snake_case"))]
#[cfg_attr(feature = "wire", schema(as = BandMeasure))]
pub enum Measure {
    /// Along the normal of the element.
    #[default]
    Normal,
    /// Along y, for graphs of functions.
    Vertical,
}

/// How far elements may lie to the right of the curve (below) and to the left of it (above), mm. Both are
/// zero or more.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Band {
    pub below_mm: f64,
    pub above_mm: f64,
    pub measure: Measure,
}

/// The widths of a band on both sides of a curve, which may change along the curve. A width belongs to the
/// point of the curve from which the deviation is measured.
pub trait Sides: Sync {
    fn measure(&self) -> Measure;

    /// Lower bounds of the widths below and above between two parameters, mm; zero or more.
    fn least(&self, range: [f64; 2]) -> [f64; 2];

    /// Upper bounds of the widths below and above at a parameter, mm.
    fn most(&self, t: f64) -> [f64; 2];
}

impl Sides for Band {
    fn measure(&self) -> Measure {
        self.measure
    }

    fn least(&self, _: [f64; 2]) -> [f64; 2] {
        [self.below_mm, self.above_mm]
    }

    fn most(&self, _: f64) -> [f64; 2] {
        [self.below_mm, self.above_mm]
    }
}

/// The signed deviations of an element from its curve, mm: positive where the element lies to the left of the
/// curve, or above. The two numbers contain every deviation. They exceed the largest reading by at most a
/// quarter plus 2.5e-7 mm.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Spread {
    pub least_mm: f64,
    pub most_mm: f64,
}

impl Spread {
    /// The largest absolute deviation, mm.
    pub fn largest_mm(&self) -> f64 {
        self.most_mm.max(-self.least_mm).max(0.0)
    }

    pub fn hull(&self, other: &Self) -> Self {
        Self { least_mm: self.least_mm.min(other.least_mm), most_mm: self.most_mm.max(other.most_mm) }
    }
}

/// Where the ends of an element lie.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ends {
    /// On the curve, at the ends of the range.
    OnCurve,
    /// Beside the curve: on its normals at the ends of the range, or straight above or below.
    Beside,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Verdict {
    Within(Spread),
    /// The curve leaves the band at this parameter.
    Outside {
        at: f64,
    },
    /// The proof failed near this parameter.
    Unproved {
        at: f64,
    },
}

/// Decides whether `element` stays within `band` of `curve` over the parameters `[from, to]`.
pub fn judge(
    curve: &impl PlaneCurve,
    element: &Element,
    [from, to]: [f64; 2],
    ends: Ends,
    band: &impl Sides,
) -> Verdict {
    let limits = Limits { band, guard: GUARD_MM + GUARD_PART * element.magnitude() };
    match band.measure() {
        Measure::Normal => search(&Normal { curve, element, from, to, ends }, curve, [from, to], limits),
        Measure::Vertical => search(&Vertical { curve, element }, curve, [from, to], limits),
    }
}

/// The signed distances that a point of the curve may have from the element.
struct Limits<'a, B> {
    band: &'a B,
    /// The rounding by which both sides are widened, mm.
    guard: f64,
}

impl<B: Sides> Limits<'_, B> {
    /// The least and the largest signed distance, mm. Where the element lies to the left of the curve, the
    /// curve lies to the right of the element: the sides change.
    fn signed(&self, [below, above]: [f64; 2]) -> [f64; 2] {
        [-(above + self.guard), below + self.guard]
    }

    /// Whether all distances between two readings are allowed.
    fn hold(&self, distance: Interval, [a, b]: [&Reading; 2]) -> bool {
        let [least, most] = self.signed(self.band.least([a.t, b.t]));
        least <= distance.lo() && distance.hi() <= most
    }

    /// Whether the distance of a reading is certainly not allowed.
    fn exclude(&self, reading: &Reading) -> bool {
        let ([least, most], distance) = (self.signed(self.band.most(reading.t)), reading.distance);
        distance.lo() > most || distance.hi() < least || reading.away > most.max(-least)
    }
}

fn search<B: Sides>(
    gauge: &impl Gauge,
    curve: &impl PlaneCurve,
    [from, to]: [f64; 2],
    limits: Limits<B>,
) -> Verdict {
    let breaks = curve.breaks();
    let first = breaks.partition_point(|t| *t <= from);
    let last = breaks.partition_point(|t| *t < to).max(first);
    let breaks = &breaks[first..last];
    if breaks.len() > BREAKS_TO_PROBE {
        for k in 1..PROBES {
            let at = from + (to - from) * (f64::from(k) / f64::from(PROBES));
            if limits.exclude(&gauge.read(at)) {
                return Verdict::Outside { at };
            }
        }
    }
    let mut search = Search {
        limits,
        found: 0.0,
        proved: Interval::ZERO,
        cells: MOST_CELLS + CELLS_A_BREAK * breaks.len(),
        cells_after_look: MOST_CELLS - LOOK_CELLS + CELLS_A_BREAK * breaks.len(),
        least_after_look: from + LOOK_PART * (to - from),
        is_spent: &|| curve.is_spent(),
        open: Vec::with_capacity(16),
    };
    let mut before = gauge.read(from);
    for at in breaks.iter().copied().chain([to]) {
        let after = gauge.read(at);
        if let Some(verdict) = search.piece(gauge, before, after) {
            return verdict;
        }
        before = after;
    }
    Verdict::Within(Spread { least_mm: -search.proved.hi(), most_mm: -search.proved.lo() })
}

struct Search<'a, B> {
    limits: Limits<'a, B>,
    /// The largest distance read so far, mm.
    found: f64,
    /// Encloses the distances over the cells that are finished.
    proved: Interval,
    cells: usize,
    /// Number of cells left at which the search is given up, unless it has proved the range up to
    /// `least_after_look`.
    cells_after_look: usize,
    least_after_look: f64,
    open: Vec<[Reading; 2]>,
    /// Whether nobody waits for the proof any more.
    is_spent: &'a dyn Fn() -> bool,
}

impl<B: Sides> Search<'_, B> {
    /// Examines a range without breaks. Returns a verdict if it ends the search.
    fn piece(&mut self, gauge: &impl Gauge, before: Reading, after: Reading) -> Option<Verdict> {
        for reading in [before, after] {
            if let Some(verdict) = self.note(&reading) {
                return Some(verdict);
            }
        }
        // If both ends are joints, the readings there are zero: so the first halving comes before the first
        // bound.
        self.halve(gauge, before, after).err().or_else(|| {
            while let Some([a, b]) = self.open.pop() {
                let bound = bound(gauge, &a, &b);
                let allowed = (1.0 + LOOSE_PART) * self.found + LOOSE_MM;
                if self.limits.hold(bound, [&a, &b]) && bound.mag() <= allowed {
                    self.proved = self.proved.hull(bound);
                } else if let Err(verdict) = self.halve(gauge, a, b) {
                    return Some(verdict);
                }
            }
            None
        })
    }

    fn halve(&mut self, gauge: &impl Gauge, a: Reading, b: Reading) -> Result<(), Verdict> {
        let at = 0.5 * (a.t + b.t);
        let is_spent = self.cells.is_multiple_of(CELLS_BETWEEN_CHECKS) && (self.is_spent)();
        if self.cells == 0 || is_spent || self.is_hopeless(a.t) || at <= a.t || at >= b.t {
            return Err(Verdict::Unproved { at });
        }
        self.cells -= 1;
        let middle = gauge.read_near(at, 0.5 * (a.u + b.u));
        if let Some(verdict) = self.note(&middle) {
            return Err(verdict);
        }
        self.open.push([middle, b]);
        self.open.push([a, middle]);
        Ok(())
    }

    /// Whether the cells for a look are used up, and hardly anything of the range is proved: the search goes
    /// from its start to its end.
    fn is_hopeless(&self, at: f64) -> bool {
        self.cells == self.cells_after_look && at < self.least_after_look
    }

    fn note(&mut self, reading: &Reading) -> Option<Verdict> {
        if self.limits.exclude(reading) {
            return Some(Verdict::Outside { at: reading.t });
        }
        self.found = self.found.max(reading.away);
        self.proved = self.proved.hull(reading.distance);
        None
    }
}

/// Encloses the distance between two readings.
fn bound(gauge: &impl Gauge, a: &Reading, b: &Reading) -> Interval {
    match gauge.bend(a, b) {
        Some(bend) if bend.is_bounded() => between(a.distance, b.distance, bend, b.t - a.t),
        _ => gauge.reach(a, b),
    }
}

/// Encloses a function between its ends, from its values there and its second derivative.
fn between(a: Interval, b: Interval, bend: Interval, width: f64) -> Interval {
    let square = width * width * ROUNDED_UP;
    let above = bulge(b.hi() - a.hi(), (-bend.lo()).max(0.0) * square);
    let below = bulge(a.lo() - b.lo(), bend.hi().max(0.0) * square);
    let most = a.hi().max(b.hi()) + above;
    let least = a.lo().min(b.lo()) - below;
    Interval::between(least.next_down(), most.next_up())
}

/// How far a parabola rises above the higher of its ends. The ends differ by `rise`; the second difference of
/// the parabola is -`bend`, with `bend` >= 0.
///
/// With s from 0 to 1 the parabola is rise s + bend s (1 - s) / 2 above one end; this is largest at s = 1/2 +
/// rise / bend.
fn bulge(rise: f64, bend: f64) -> f64 {
    let rise = rise.abs();
    if 2.0 * rise >= bend {
        return 0.0;
    }
    let over = bend - 2.0 * rise;
    over * over / (8.0 * bend) * ROUNDED_UP
}

#[cfg(test)]
mod tests;

//! Greedy growth: divides a curve into elements with joints on the curve, each as long as possible.
//!
//! # Method
//! 1. From the last joint, search for the longest element that stays within the band at sampled places.
//! 2. Prove that the element stays within the band everywhere. If the proof fails, shorten the element and
//!    try again.
//! 3. Place a joint at the end of the element, and repeat from step 1.
//!
//! A longer element may stay within the band although a shorter one does not, unless the elements are lines
//! on a convex part of the curve. Where this may happen, step 1 also tries longer elements. It also tries to
//! move the last joint back, because the next element may then reach farther. An element that ends shortly
//! before a break of the curve is extended to the break, where it then stays within the band.
//!
//! When the search has taken its share of the steps of the job (`meter`), step 1 ends with the first element
//! that is proved. Joints are then not moved back.
//!
//! # Guarantees
//! * Every element is proved to stay within the band.
//! * For lines on a convex curve, the number of elements is the least possible, up to rounding. For other
//!   elements and curves the number may be larger. `lower_bound` shows by how much at most.
//!
//! # Cost
//! O(n) for n elements.

use super::Error;
use super::fit::{Fitted, Fitter};
use super::job::Method;
use crate::budget::Budget;
use crate::geometry::deviation::Band;
use crate::geometry::plane_curve::PlaneCurve;

/// The most steps of the search for a length.
const LENGTH_STEPS: usize = 60;

/// The search ends when it knows the length to this share of itself.
const LENGTH_PART: f64 = 1e-9;

/// The search accepts a strain this little below one as the edge of the band. Nearer to one, proofs take
/// longer, and elements grow by less than a share of 1e-7.
const STRAIN_PART: f64 = 2e-7;

/// Where proofs alone find a length, they find it to this share of itself: each further digit takes three or
/// four proofs, and lengthens an element of a metre by a micrometre at most.
const PROVED_LENGTH_PART: f64 = 1e-6;

/// A corner this near beyond the end of an element, as a share of the element, is tried as its end. A search
/// by samples stops shortly before a corner, by less than this.
const NEAR_CORNER_PART: f64 = 1e-2;

/// An element with an earlier start is tried only if it may reach farther than the element that it replaces,
/// by this share of that element. Smaller gains may be rounding of the search.
const FARTHER_PART: f64 = 1e-6;

/// Smaller strains count as this one. They are rounding, and the logarithm of zero is infinite.
const LEAST_STRAIN: f64 = 1e-12;

/// Shares by which a length is shortened until its element is proved. If none of them helps, the length is
/// halved.
const SHORTER: [f64; 4] = [0.0, 1e-6, 1e-5, 1e-3];

/// The first length that is proved where the search has no steps left, as a multiple of the length of the
/// element before; each further length is shorter by this factor.
const HOPEFUL: f64 = 1.5;

/// How far earlier a joint is tried, as shares of the element before it.
const EARLIER: [f64; 6] = [0.02, 0.06, 0.12, 0.25, 0.4, 0.6];

/// The factor from one trial length to the next where the search looks for a longer element that fits again.
const LONGER: f64 = 1.03;

/// The search for a longer element that fits again ends at this many times the longest length found.
const LONGEST_FACTOR: f64 = 40.0;

/// The steps between tangents that show whether a curve is convex.
const TANGENTS: usize = 9;

/// Elements between two reports of progress.
const ELEMENTS_BETWEEN_REPORTS: usize = 16;

/// The fewest elements over `range` that greedy growth finds and that stay within the band.
///
/// # Errors
/// When the budget ends, there are too many elements or steps, or no element stays within the band however
/// short.
pub fn fewest(
    fitter: &Fitter<impl PlaneCurve>,
    range: [f64; 2],
    budget: &Budget,
) -> Result<Vec<Fitted>, Error> {
    let [from, to] = range;
    let mut elements: Vec<Fitted> = Vec::new();
    let mut at = from;
    let mut length = to - from;
    while at < to {
        budget.check()?;
        if elements.len().is_multiple_of(ELEMENTS_BETWEEN_REPORTS) {
            budget.progress("interpolating", elements.len(), elements.len());
        }
        if elements.len() >= fitter.element_limit {
            return Err(Error::TooManyElements { limit: fitter.element_limit });
        }
        let mut next = fitter.longest([at, to], length)?;
        if let Some(last) = elements.last().copied()
            && next.range[1] < to
            && fitter.may_fit_again([last.range[0], next.range[1]])
            && fitter.meter.has_steps_for_search()
            && let Some([earlier, longer]) = fitter.around(&last, &next, to)
        {
            elements.pop();
            elements.push(earlier);
            next = longer;
        }
        if fitter.is_hopeless(next.range) && next.range[1] < to {
            return Err(Error::BandInfeasible { at: fitter.curve.point(at) });
        }
        length = next.range[1] - next.range[0];
        at = next.range[1];
        elements.push(next);
        fitter.meter.found_element(fitter.curve.operations());
    }
    Ok(elements)
}

impl<C: PlaneCurve> Fitter<'_, C> {
    /// The longest element that starts at `from` and ends at `most` at the latest; `guess` is its approximate
    /// length.
    ///
    /// # Errors
    /// When the budget ends, the job takes too many steps, or no element stays within the band however short.
    pub fn longest(&self, [from, most]: [f64; 2], guess: f64) -> Result<Fitted, Error> {
        self.meter.check()?;
        let room = most - from;
        let guess = guess.min(room);
        let is_bent_one_way = !self.may_fit_again([from, (from + 2.0 * guess).min(most)]);
        let mut length = if is_bent_one_way {
            let hump = |length: f64| self.strain_of_hump([from, from + length]);
            limit_length(hump, from, [guess, (2.0 * guess).min(room)])
        } else {
            limit_length(|length| self.strain([from, from + length]), from, [guess, room])
        };
        if length >= 2.0 * guess && length < room {
            return self.longest([from, most], length);
        }
        let reach = self.longest_factor();
        if length < room && self.may_fit_again([from, (from + reach * length).min(most)]) {
            // A longer element may fit again farther on, where the curve has turned back.
            let shortest = length;
            let mut factor = LONGER;
            while factor <= reach && shortest * factor < room {
                self.meter.check()?;
                let farther = shortest * factor;
                if farther > length && self.strain([from, from + farther]) <= 1.0 {
                    let strain = |length: f64| self.strain([from, from + length]);
                    length = limit_length(strain, from, [farther, room]).max(length);
                }
                factor *= LONGER;
            }
        }
        let end = |length: f64| if length >= room { most } else { from + length };
        for part in SHORTER {
            self.meter.check()?;
            if let Some(fitted) = self.fit([from, end(length * (1.0 - part))]) {
                return Ok(self.up_to_corner(fitted, most));
            }
        }
        if self.meter.has_steps_for_search() {
            Ok(self.up_to_corner(self.longest_proved([from, most], length)?, most))
        } else {
            self.first_proved([from, most], (HOPEFUL * guess).min(0.5 * length))
        }
    }

    /// The element itself, or the element up to a corner of the curve that lies shortly beyond its end, if
    /// that one stays within the band. At a corner to the narrow side of the band, an element has to end on
    /// the corner, and a search for a length does not meet it.
    fn up_to_corner(&self, fitted: Fitted, most: f64) -> Fitted {
        let [from, to] = fitted.range;
        let near = self.corner([to, (to + NEAR_CORNER_PART * (to - from)).min(most)]);
        near.and_then(|corner| self.fit([from, corner])).unwrap_or(fitted)
    }

    /// As `longest`, but by proofs alone: for curves whose deviation samples do not show.
    fn longest_proved(&self, [from, most]: [f64; 2], length: f64) -> Result<Fitted, Error> {
        let mut high = length.min(most - from);
        let mut best = loop {
            self.meter.check()?;
            high *= 0.5;
            if self.is_least([from, from + high]) {
                return Err(Error::BandInfeasible { at: self.curve.point(from) });
            }
            if let Some(fitted) = self.fit([from, from + high]) {
                break fitted;
            }
        };
        let (mut low, mut high) = (high, 2.0 * high);
        while high - low > PROVED_LENGTH_PART * low {
            self.meter.check()?;
            let middle = 0.5 * (low + high);
            match self.fit([from, from + middle]) {
                Some(fitted) => (best, low) = (fitted, middle),
                None => high = middle,
            }
        }
        Ok(best)
    }

    /// As `longest_proved`, with a few proofs: the first proved element among ever shorter ones.
    fn first_proved(&self, [from, most]: [f64; 2], mut length: f64) -> Result<Fitted, Error> {
        loop {
            self.meter.check()?;
            if let Some(fitted) = self.fit([from, (from + length).min(most)]) {
                return Ok(fitted);
            }
            if self.is_least([from, from + length]) {
                return Err(Error::BandInfeasible { at: self.curve.point(from) });
            }
            length /= HOPEFUL;
        }
    }

    /// Whether a range is so short that halving it again changes nothing.
    pub fn is_least(&self, [from, to]: [f64; 2]) -> bool {
        let [first, last] = self.curve.domain();
        to - from <= 1e-13 * (last - first).max(first.abs()).max(last.abs())
    }

    /// How many times longer an element that fits again may be. A line that cuts off a bend to the narrow
    /// side of the band is short compared with a line that cuts off a bend to the wide side.
    fn longest_factor(&self) -> f64 {
        if matches!(self.method, Method::Arc | Method::Parabolic) {
            return 2.0;
        }
        let Band { below_mm, above_mm, .. } = self.band;
        let ratio = below_mm.max(above_mm) / below_mm.min(above_mm);
        (2.0 * ratio.sqrt()).min(LONGEST_FACTOR)
    }

    /// Whether a longer element might stay within the band where a shorter one does not. Lines along a convex
    /// curve exclude this.
    fn may_fit_again(&self, [from, to]: [f64; 2]) -> bool {
        if self.method != Method::Linear {
            return true;
        }
        let tangent = |k: usize| self.curve.derivative(from + (to - from) * (k as f64 / TANGENTS as f64));
        let mut before = tangent(0);
        let (mut left, mut right) = (false, false);
        for k in 1..=TANGENTS {
            let after = tangent(k);
            let turn = before.perp(&after);
            (left, right) = (left || turn > 0.0, right || turn < 0.0);
            before = after;
        }
        left && right
    }

    /// The element `before` with an earlier end, and the longest element from there, if that one reaches
    /// farther than `next`.
    fn around(&self, before: &Fitted, next: &Fitted, most: f64) -> Option<[Fitted; 2]> {
        let [start, joint] = before.range;
        let reached = next.range[1];
        let beyond = (reached + FARTHER_PART * (reached - joint)).min(most);
        let mut best: Option<[Fitted; 2]> = None;
        for part in EARLIER {
            let at = joint - part * (joint - start);
            if self.strain([at, beyond]) > 1.0 || self.strain([start, at]) > 1.0 {
                continue;
            }
            let (Some(earlier), Ok(longer)) = (self.fit([start, at]), self.longest([at, most], beyond - at))
            else {
                continue;
            };
            if longer.range[1] > best.map_or(reached, |[_, longer]| longer.range[1]) {
                best = Some([earlier, longer]);
            }
        }
        best
    }
}

/// The length at which the strain is one, or `room` if the strain stays below one. The strain of an element
/// is its deviation divided by the width of the band on that side.
///
/// The strain is nearly a power of the length. So a secant in logarithms through the last two trials finds
/// the root; each trial stays within the bracket.
fn limit_length(strain: impl Fn(f64) -> f64, from: f64, [guess, room]: [f64; 2]) -> f64 {
    let (mut low, mut high) = (0.0, f64::INFINITY);
    let mut length = guess;
    let mut last: Option<(f64, f64)> = None;
    for _ in 0..LENGTH_STEPS {
        let strain = strain(length).max(LEAST_STRAIN);
        if strain <= 1.0 {
            low = length;
            if length >= room || strain >= 1.0 - STRAIN_PART {
                break;
            }
        } else {
            high = length;
        }
        if high - low <= LENGTH_PART * low || high <= f64::EPSILON * (from.abs() + room) {
            break;
        }
        let here = (length.ln(), strain.ln());
        // The strain grows with the square of the length for lines and with the cube for parabolas; 2.3 lies
        // between.
        let power = last
            .map(|last: (f64, f64)| (here.1 - last.1) / (here.0 - last.0))
            .filter(|p| (0.5..8.0).contains(p));
        last = Some(here);
        let next = (here.0 - (here.1 + 0.5 * STRAIN_PART) / power.unwrap_or(2.3))
            .exp()
            .clamp(0.1 * length, 4.0 * length);
        length = if low < next && next < high {
            next
        } else if high.is_finite() {
            if low > 0.0 { (low * high).sqrt() } else { 0.5 * high }
        } else {
            2.0 * low
        };
        length = length.min(room);
    }
    if low > 0.0 { low } else { length }
}

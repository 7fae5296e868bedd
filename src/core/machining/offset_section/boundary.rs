//! The boundary curves of an offset surface, cut into stretches. A section plane is given by one coordinate.
//! Along each stretch, this coordinate only rises or only falls.

use crate::budget::{Budget, Stopped};
use crate::geometry::solve::bisect;
use crate::geometry::surface::Surface;
use crate::geometry::surface::offset::offset;

/// Samples a span at which the derivative's sign is examined.
const SAMPLES: usize = 16;

/// Largest number of bisections of a stretch; enough for the parameter's last bit.
const BISECTION_LIMIT: usize = 60;

#[derive(Debug, Clone, Copy, PartialEq)]
enum Side {
    LowU,
    HighU,
    LowV,
    HighV,
}

/// A point of the boundary of a surface with `spans`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct BoundaryPoint {
    side: Side,
    spans: [usize; 2],
    t: f64,
}

impl BoundaryPoint {
    /// Its parameters (u, v).
    pub(super) fn parameters(&self) -> (f64, f64) {
        match self.side {
            Side::LowU => (0.0, self.t),
            Side::HighU => (self.spans[0] as f64, self.t),
            Side::LowV => (self.t, 0.0),
            Side::HighV => (self.t, self.spans[1] as f64),
        }
    }

    /// The parameter that is constant along the side (0 is u, 1 is v), and whether it has its least value
    /// there.
    pub(super) fn side(&self) -> (usize, bool) {
        match self.side {
            Side::LowU => (0, true),
            Side::HighU => (0, false),
            Side::LowV => (1, true),
            Side::HighV => (1, false),
        }
    }

    /// The direction (du, dv) into the surface.
    pub(super) fn inward(&self) -> (f64, f64) {
        match self.side {
            Side::LowU => (1.0, 0.0),
            Side::HighU => (-1.0, 0.0),
            Side::LowV => (0.0, 1.0),
            Side::HighV => (0.0, -1.0),
        }
    }
}

/// A stretch of one side on which the coordinate is monotone, with its values at both ends, mm.
#[derive(Debug, Clone, Copy)]
struct MonotoneRange {
    side: Side,
    t: [f64; 2],
    value: [f64; 2],
}

pub(super) struct Boundary {
    radius: f64,
    axis: usize,
    stretches: Vec<MonotoneRange>,
}

impl Boundary {
    pub(super) fn new(
        surface: &dyn Surface,
        radius: f64,
        axis: usize,
        budget: &Budget,
    ) -> Result<Self, Stopped> {
        let mut boundary = Self { radius, axis, stretches: Vec::new() };
        for side in [Side::LowU, Side::HighU, Side::LowV, Side::HighV] {
            boundary.add_side(surface, side, budget)?;
        }
        Ok(boundary)
    }

    /// The least and the largest value on the boundary, mm.
    pub(super) fn extent(&self) -> [f64; 2] {
        let values = || self.stretches.iter().flat_map(|s| s.value);
        [values().fold(f64::INFINITY, f64::min), values().fold(f64::NEG_INFINITY, f64::max)]
    }

    /// The points at which the boundary passes the value `at`.
    pub(super) fn crossings(&self, surface: &dyn Surface, at: f64) -> Vec<BoundaryPoint> {
        let crossed = self.stretches.iter().filter(|s| (s.value[0] < at) != (s.value[1] < at));
        crossed.map(|s| self.root(surface, s, at)).collect()
    }

    /// Whether a stretch of a side across the parameter `across` (0 is u, 1 is v) lies within `reach` mm of
    /// the value `at`.
    pub(super) fn lies_at(&self, across: usize, at: f64, reach: f64) -> bool {
        let is_across = |s: &MonotoneRange| matches!(s.side, Side::LowU | Side::HighU) == (across == 0);
        self.stretches.iter().any(|s| is_across(s) && s.value.iter().all(|value| (value - at).abs() <= reach))
    }

    /// The crossing of the value `at` on the side through which the step from `inside` to `outside`
    /// (parameters) leaves the surface. It is sought within one sample of the place where the straight line
    /// of the step leaves.
    pub(super) fn crossing_between(
        &self,
        surface: &dyn Surface,
        at: f64,
        inside: (f64, f64),
        outside: (f64, f64),
    ) -> Option<BoundaryPoint> {
        let spans = surface.spans();
        let [nu, nv] = spans.map(|n| n as f64);
        let leaves = [
            (Side::LowU, outside.0 < 0.0, inside.0 / (inside.0 - outside.0)),
            (Side::HighU, outside.0 > nu, (nu - inside.0) / (outside.0 - inside.0)),
            (Side::LowV, outside.1 < 0.0, inside.1 / (inside.1 - outside.1)),
            (Side::HighV, outside.1 > nv, (nv - inside.1) / (outside.1 - inside.1)),
        ];
        let first = leaves.into_iter().filter(|(_, left, _)| *left).min_by(|a, b| a.2.total_cmp(&b.2))?;
        let (side, _, fraction) = first;
        let (from, to, end) = match side {
            Side::LowU | Side::HighU => (inside.1, outside.1, nv),
            Side::LowV | Side::HighV => (inside.0, outside.0, nu),
        };
        let middle = from + (to - from) * fraction;
        let reach = 1.0 / SAMPLES as f64;
        let t = [(middle - reach).max(0.0), (middle + reach).min(end)];
        let value = t.map(|t| self.value(surface, side, t)[0]);
        ((value[0] < at) != (value[1] < at))
            .then(|| self.root(surface, &MonotoneRange { side, t, value }, at))
    }

    /// Cuts one side at the extremes of the coordinate, found from the sign of the derivative at [`SAMPLES`]
    /// places a span. The paper replaces the boundary by a polygon. A polygon can miss two intersections that
    /// lie between two of its corners.
    fn add_side(&mut self, surface: &dyn Surface, side: Side, budget: &Budget) -> Result<(), Stopped> {
        let [nu, nv] = surface.spans();
        let spans = if matches!(side, Side::LowU | Side::HighU) { nv } else { nu };
        let at = |k: usize| k as f64 / SAMPLES as f64;
        let mut t = 0.0;
        let mut here = self.value(surface, side, t);
        for k in 1..=spans * SAMPLES {
            if k.is_multiple_of(1024) {
                budget.check()?;
            }
            let next_t = at(k);
            let next = self.value(surface, side, next_t);
            if here[1] * next[1] < 0.0 {
                let turn = self.extreme(surface, side, [t, next_t], here[1]);
                let value = self.value(surface, side, turn)[0];
                self.stretches.push(MonotoneRange { side, t: [t, turn], value: [here[0], value] });
                self.stretches.push(MonotoneRange { side, t: [turn, next_t], value: [value, next[0]] });
            } else {
                self.stretches.push(MonotoneRange { side, t: [t, next_t], value: [here[0], next[0]] });
            }
            (t, here) = (next_t, next);
        }
        Ok(())
    }

    /// The value and its derivative along the side.
    fn value(&self, surface: &dyn Surface, side: Side, t: f64) -> [f64; 2] {
        let point = BoundaryPoint { side, spans: surface.spans(), t };
        let (u, v) = point.parameters();
        let jet = surface.jet(u, v);
        match offset(&jet, self.radius) {
            Some(off) => {
                let along = if matches!(side, Side::LowU | Side::HighU) { off.dv } else { off.du };
                [off.point[self.axis], along[self.axis]]
            }
            None => [jet.point[self.axis], 0.0],
        }
    }

    /// Where the derivative changes sign, by bisection.
    fn extreme(&self, surface: &dyn Surface, side: Side, range: [f64; 2], slope: f64) -> f64 {
        let [a, b] = bisect(range, BISECTION_LIMIT, |t| self.value(surface, side, t)[1] * slope > 0.0);
        0.5 * (a + b)
    }

    /// The point of the value `at` on a stretch that crosses it: Newton's method kept inside the bracket.
    fn root(&self, surface: &dyn Surface, stretch: &MonotoneRange, at: f64) -> BoundaryPoint {
        let [mut a, mut b] = stretch.t;
        let rising = stretch.value[1] > stretch.value[0];
        let mut t =
            a + (b - a) * ((at - stretch.value[0]) / (stretch.value[1] - stretch.value[0])).clamp(0.0, 1.0);
        for _ in 0..BISECTION_LIMIT {
            let [value, slope] = self.value(surface, stretch.side, t);
            if value == at {
                break;
            }
            if (value < at) == rising {
                a = t;
            } else {
                b = t;
            }
            let newton = t - (value - at) / slope;
            let next = if newton > a && newton < b { newton } else { 0.5 * (a + b) };
            if next == t {
                break;
            }
            t = next;
        }
        BoundaryPoint { side: stretch.side, spans: surface.spans(), t }
    }
}

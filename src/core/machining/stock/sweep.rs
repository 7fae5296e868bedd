//! The height that a moving cutter leaves over a point of the plane.
//!
//! While the tip runs along a line, the lower side of the cutter passes over a point p of the plane. The
//! *swept height* of p is the least height of the lower side over p:
//!
//! H(p) = min over t of z(t) + h(|p - c(t)|),
//!
//! where c(t) is the tip in plan, z(t) its height and h the lower side of the cutter. h is convex and grows
//! with the distance, so the term under the minimum is convex in p and t together. Therefore H is convex in
//! p: over a cell its largest value is at a corner, and the tangent plane at any point lies below it.

use nalgebra::{Point2, Point3, Vector2};

use crate::geometry::curve::Line;
use crate::geometry::segment::left;
use crate::machining::cutter::Cutter;

/// Error of the slope at the lowest place of a bull nose on a slope. The height there exceeds the least
/// height by less than this times the cutter's radius.
const ENOUGH: f64 = 1e-10;

/// The most steps of the search for that place. About eight are usual.
const MOST_STEPS: usize = 60;

/// Stands for the slope of the lower side where it is vertical.
const STEEPEST: f64 = 1e9;

/// Rounding of a swept height, mm, for coordinates up to a kilometre.
pub(super) const SLACK_MM: f64 = 1e-8;

/// A swept height with its gradient.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Swept {
    /// mm.
    pub(super) height: f64,
    /// The height of the tip that leaves it, mm.
    pub(super) tip: f64,
    /// Not finite where the lower side is vertical.
    pub(super) gradient: Vector2<f64>,
}

/// A cutter whose tip runs along a line.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sweep {
    cutter: Cutter,
    start: Point2<f64>,
    /// The unit vector of the line in plan; along x for a line straight up or down.
    along: Vector2<f64>,
    /// Length in plan, mm.
    length: f64,
    /// The height of the tip at the start, mm; for a vertical line the lower one of its ends.
    height: f64,
    /// Rise of the tip for each mm in plan.
    slope: f64,
}

impl Sweep {
    pub(super) fn new(cutter: Cutter, tip: &Line) -> Self {
        let way = tip.end - tip.start;
        let length = way.xy().norm();
        let start = tip.start.xy();
        if length == 0.0 {
            let height = tip.start.z.min(tip.end.z);
            return Self { cutter, start, along: Vector2::x(), length, height, slope: 0.0 };
        }
        Self { cutter, start, along: way.xy() / length, length, height: tip.start.z, slope: way.z / length }
    }

    /// The lowest place of the tip, mm.
    pub(super) fn lowest(&self) -> f64 {
        self.height.min(self.height + self.slope * self.length)
    }

    pub(super) fn cutter(&self) -> &Cutter {
        &self.cutter
    }

    /// The distance of a point from the line in plan, mm.
    pub(super) fn distance(&self, p: Point2<f64>) -> f64 {
        let from = p - self.start;
        let u = from.dot(&self.along);
        length(self.along.perp(&from), u - u.clamp(0.0, self.length))
    }

    /// The range of x of the line.
    pub(super) fn across(&self) -> [f64; 2] {
        self.extent(0)
    }

    /// The range of y of the line.
    pub(super) fn rows(&self) -> [f64; 2] {
        self.extent(1)
    }

    fn extent(&self, axis: usize) -> [f64; 2] {
        let (from, to) = (self.start[axis], self.start[axis] + self.along[axis] * self.length);
        [from.min(to), from.max(to)]
    }

    /// The range of x in which points at the heights y of a strip are at most `reach` mm from the line.
    /// `None` where there are none.
    pub(super) fn columns(&self, strip: [f64; 2], reach: f64) -> Option<[f64; 2]> {
        let [low, high] = [strip[0] - reach, strip[1] + reach];
        let (from, to) = (self.start, self.start + self.along * self.length);
        if from.y.max(to.y) < low || from.y.min(to.y) > high {
            return None;
        }
        let at = |y: f64| {
            let rise = to.y - from.y;
            let t = if rise == 0.0 { 0.0 } else { ((y - from.y) / rise).clamp(0.0, 1.0) };
            from.x + (to.x - from.x) * t
        };
        let [a, b] = if from.y == to.y { [from.x, to.x] } else { [at(low), at(high)] };
        Some([a.min(b) - reach, a.max(b) + reach])
    }

    /// The swept height at `p`; `None` where the cutter does not pass over `p`.
    pub(super) fn at(&self, p: Point2<f64>) -> Option<Swept> {
        let from = p - self.start;
        let u = from.dot(&self.along);
        let across = self.along.perp(&from);
        let radius = self.cutter.radius();
        let room = (radius - across) * (radius + across);
        if room < 0.0 {
            return None;
        }
        let reach = room.sqrt();
        // v is the way from the foot of p to the tip, along the line.
        let [least, most] = [(-u).max(-reach), (self.length - u).min(reach)];
        if least > most {
            return None;
        }
        let lowest = if self.slope == 0.0 { 0.0 } else { self.lowest_place(across, reach) };
        let v = lowest.clamp(least, most);
        let tip = self.height + self.slope * (u + v);
        let distance = length(across, v).min(radius);
        let gradient = match self.cutter.slope(distance) {
            // On a slope the rim of a flat end is lowest, and the place of the rim moves with p.
            _ if self.cutter.corner_radius() == 0.0 && v.abs() == reach && self.slope != 0.0 => {
                self.along * self.slope + left(self.along) * (self.slope.abs() * across / reach)
            }
            _ if self.cutter.corner_radius() == 0.0 => Vector2::zeros(),
            0.0 => Vector2::zeros(),
            steepness => (left(self.along) * across - self.along * v) * (steepness / distance),
        };
        Some(Swept { height: tip + self.cutter.height(distance), tip, gradient })
    }

    /// The lowest height of the tip at places in plan at most `reach` mm from `p`, mm.
    pub(super) fn lowest_near(&self, p: Point2<f64>, reach: f64) -> f64 {
        let u = (p - self.start).dot(&self.along);
        let at = |u: f64| self.height + self.slope * u.clamp(0.0, self.length);
        at(u - reach).min(at(u + reach))
    }

    /// Both ends of the line in plan.
    pub(super) fn ends(&self) -> [Point2<f64>; 2] {
        [self.start, self.start + self.along * self.length]
    }

    /// The place of the tip that is nearest to `p` in plan, mm.
    pub(super) fn tip_nearest(&self, p: Point2<f64>) -> Point3<f64> {
        let u = (p - self.start).dot(&self.along).clamp(0.0, self.length);
        let place = self.start + self.along * u;
        Point3::new(place.x, place.y, self.height + self.slope * u)
    }

    /// The v at which slope * v + h(|(across, v)|) is least, for |v| <= reach.
    fn lowest_place(&self, across: f64, reach: f64) -> f64 {
        let (flat, corner) = (self.cutter.flat_radius(), self.cutter.corner_radius());
        if corner == 0.0 {
            return -reach.copysign(self.slope);
        }
        if flat == 0.0 {
            return -self.slope * reach / (1.0 + self.slope * self.slope).sqrt();
        }
        // The derivative of h along the line grows with v. Its value has to be the slope downhill.
        let wanted = self.slope.abs();
        let excess = |v: f64| {
            let distance = length(across, v);
            // The lower side is vertical at the radius.
            let slope = self.cutter.slope(distance).min(STEEPEST);
            if distance > 0.0 { slope * v / distance - wanted } else { -wanted }
        };
        -first_not_below(excess, reach).copysign(self.slope)
    }
}

/// The length of a vector of the plane. Faster than `hypot`, and as good for the lengths of a workshop.
fn length(x: f64, y: f64) -> f64 {
    (x * x + y * y).sqrt()
}

/// Where a function that grows from a value below zero at 0 passes zero, in [0, end]; `end` if it does not.
/// By false position, where a bound that stays counts half (the Illinois method).
fn first_not_below(f: impl Fn(f64) -> f64, end: f64) -> f64 {
    let [mut low, mut high] = [0.0, end];
    let [mut below, mut above] = [f(low), f(high)];
    if above <= 0.0 {
        return end;
    }
    let mut was_below = None;
    for _ in 0..MOST_STEPS {
        let v = (low * above - high * below) / (above - below);
        let value = f(v);
        let is_below = value < 0.0;
        if is_below {
            (low, below) = (v, value);
        } else {
            (high, above) = (v, value);
        }
        if was_below == Some(is_below) {
            if is_below { above *= 0.5 } else { below *= 0.5 }
        }
        was_below = Some(is_below);
        if value.abs() < ENOUGH {
            return v;
        }
    }
    low
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn cutters() -> [Cutter; 4] {
        [
            Cutter::ball(5.0),
            Cutter::bull_nose(5.0, 0.0),
            Cutter::bull_nose(5.0, 1.0),
            Cutter::bull_nose(3.0, 2.5),
        ]
    }

    /// The least height over many places of the tip.
    fn sampled(cutter: &Cutter, tip: &Line, p: Point2<f64>) -> f64 {
        let n = 20_000;
        let heights = (0..=n).map(|k| {
            let c = tip.point_at(f64::from(k) / f64::from(n));
            c.z + cutter.height((p - c.xy()).norm())
        });
        heights.fold(f64::INFINITY, f64::min)
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(300))]
        #[test]
        fn the_swept_height_is_the_least_over_the_line(
            k in 0usize..4, ends in prop::array::uniform6(-8.0f64..8.0), at in prop::array::uniform2(-12.0f64..12.0),
        ) {
            let [a, b, c, d, e, f] = ends;
            let tip = Line { start: Point3::new(a, b, c), end: Point3::new(d, e, f) };
            let (cutter, p) = (cutters()[k], Point2::from(at));
            let sweep = Sweep::new(cutter, &tip);
            let sampled = sampled(&cutter, &tip, p);
            match sweep.at(p) {
                Some(swept) => {
                    prop_assert!(swept.height <= sampled + SLACK_MM);
                    // Near the rim samples are too high.
                    if sweep.distance(p) < 0.95 * cutter.radius() {
                        prop_assert!(swept.height >= sampled - 0.02, "{} {sampled}", swept.height);
                    }
                }
                None => prop_assert!(sampled.is_infinite()),
            }
        }

        #[test]
        fn the_tangent_plane_lies_below(
            k in 0usize..4, ends in prop::array::uniform6(-8.0f64..8.0), at in prop::array::uniform2(-12.0f64..12.0),
            to in prop::array::uniform2(-12.0f64..12.0),
        ) {
            let [a, b, c, d, e, f] = ends;
            let tip = Line { start: Point3::new(a, b, c), end: Point3::new(d, e, f) };
            let sweep = Sweep::new(cutters()[k], &tip);
            let (p, q) = (Point2::from(at), Point2::from(to));
            if let (Some(one), Some(other)) = (sweep.at(p), sweep.at(q)) {
                let below = one.height + one.gradient.dot(&(q - p));
                prop_assert!(below <= other.height + 1e-6, "{below} {}", other.height);
            }
        }
    }

    #[test]
    fn a_plunge_leaves_its_lowest_place() {
        let tip = Line { start: Point3::new(1.0, 2.0, 5.0), end: Point3::new(1.0, 2.0, -3.0) };
        let sweep = Sweep::new(Cutter::ball(5.0), &tip);
        assert_eq!(sweep.at(Point2::new(4.0, 2.0)).unwrap().height, -2.0);
        assert!(sweep.at(Point2::new(6.1, 2.0)).is_none());
    }
}

//! The arcs over one chord that pass near a point, in closed form. They start at one end of the chord and end
//! at the other. "Near" means within the tolerance.
//!
//! An arc is given by its bulge tan(sweep / 4), which is positive if the arc lies to the left of the chord.
//! The chord itself has the bulge 0. There are three cases:
//! 1. The point is within the tolerance of an end of the chord: all arcs pass near it.
//! 2. The point lies beyond an end of the chord, but within the tolerance of the line that continues the
//!    chord: the arcs with bulges below some negative number or above some positive number pass near it.
//! 3. In all other cases, the arcs with bulges between two numbers pass near it.

use nalgebra::Vector2;

/// tan(sweep / 4) for 350 degrees, the largest bulge. For larger sweeps rounding alone would decide between
/// an arc and a full circle.
pub const LARGEST_BULGE: f64 = 22.903_765_548_431_4;

/// The bulges between `least` and `most` that are not inside `hole`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bulges {
    pub least: f64,
    pub most: f64,
    /// An open interval about 0; empty where its ends are equal.
    pub hole: [f64; 2],
}

impl Bulges {
    pub fn up_to(largest: f64) -> Self {
        Self { least: -largest, most: largest, hole: [0.0; 2] }
    }

    /// The closed intervals that the hole leaves, the negative one first. Without a hole there is one
    /// interval.
    pub fn parts(&self) -> impl Iterator<Item = [f64; 2]> + use<> {
        let has_hole = self.hole[0] < self.hole[1];
        let whole = [self.least, self.most];
        let parts = if has_hole {
            [[self.least, self.most.min(self.hole[0])], [self.least.max(self.hole[1]), self.most]]
        } else {
            [whole, [1.0, 0.0]]
        };
        parts.into_iter().filter(|part| part[0] <= part[1])
    }

    /// The parts of [`Self::parts`] without the arcs flatter than `flattest`.
    pub fn curved(&self, flattest: f64) -> impl Iterator<Item = [f64; 2]> + use<> {
        self.parts().flat_map(move |[low, high]| {
            [[low, high.min(-flattest)], [low.max(flattest), high]]
                .into_iter()
                .filter(|part| part[0] <= part[1])
        })
    }

    pub fn is_empty(&self) -> bool {
        self.parts().next().is_none()
    }

    pub fn contains(&self, bulge: f64) -> bool {
        self.parts().any(|part| (part[0]..=part[1]).contains(&bulge))
    }
}

/// A chord with its frame: the origin is the middle of the chord, the first axis runs along it, the second to
/// its left.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Chord {
    pub from: Vector2<f64>,
    pub to: Vector2<f64>,
    middle: Vector2<f64>,
    along: Vector2<f64>,
    /// Half the length of the chord, mm.
    pub half: f64,
}

impl Chord {
    /// `None` where the ends coincide.
    pub fn new(from: Vector2<f64>, to: Vector2<f64>) -> Option<Self> {
        let half = (to - from) * 0.5;
        let length = half.norm();
        (length > 0.0).then(|| Self { from, to, middle: from + half, along: half / length, half: length })
    }

    pub fn local(&self, p: Vector2<f64>) -> Vector2<f64> {
        let d = p - self.middle;
        Vector2::new(self.along.dot(&d), self.along.perp(&d))
    }

    /// The direction of the chord, radians.
    pub fn direction(&self) -> f64 {
        self.along.y.atan2(self.along.x)
    }

    /// The coordinate of the arc's centre on the second axis, mm.
    pub fn center(&self, bulge: f64) -> f64 {
        0.5 * self.half * (bulge - 1.0 / bulge)
    }

    pub fn radius(&self, bulge: f64) -> f64 {
        0.5 * self.half * (bulge + 1.0 / bulge).abs()
    }

    /// The bulge of an arc of the radius `r`, mm, that turns by at most half a turn.
    pub fn flattest(&self, r: f64) -> f64 {
        // For the radius r over half a chord h the bulge is (r - sqrt(r^2 - h^2)) / h.
        self.half / (r + (r * r - self.half * self.half).max(0.0).sqrt())
    }

    /// The distance of a point from the circle of an arc, or from the line through the chord, mm. It is
    /// positive to the left of them, as the chord runs, and falls as the bulge grows. `p` is in the chord's
    /// frame.
    pub fn signed_distance(&self, bulge: f64, p: Vector2<f64>) -> f64 {
        let ([x, y], b, l) = (<[f64; 2]>::from(p), bulge, self.half);
        // The signed distance |X - C| - r as a quotient, both terms times 2 |b|, so that it also holds for
        // flat arcs.
        let power = 2.0 * b * (x * x + y * y - l * l) + 2.0 * y * l * (1.0 - b * b);
        let distances = l * (1.0 + b * b) + (2.0 * b * x).hypot(2.0 * b * y + l * (1.0 - b * b));
        power / distances
    }

    /// Removes from `bulges` the arcs that do not pass within `tolerance` mm of `p`.
    ///
    /// Let L be half the length of the chord, e the tolerance, (x, y) the point in the chord's frame, and dP
    /// and dQ its distances from the ends. Let S = sqrt((dP^2 - e^2)(dQ^2 - e^2)) and k = x^2 + y^2 - L^2 -
    /// e^2. Then the arcs with these bulges b pass within e of the point:
    /// 1. If dP <= e or dQ <= e: all.
    /// 2. Otherwise, if k <= 0: b between 2L(y - e)/(S - k) and 2L(y + e)/(S - k).
    /// 3. Otherwise, if |y| > e: b between (S + k)/(2L(y + e)) and (S + k)/(2L(y - e)). These are the bounds
    ///    of case 2 in a form without cancellation, because S^2 - k^2 = 4L^2(y^2 - e^2).
    /// 4. Otherwise: b not between the bounds of case 3, of which one is negative and the other positive.
    #[inline]
    pub fn keep_near(&self, p: Vector2<f64>, tolerance: f64, bulges: &mut Bulges) {
        let [x, y] = self.local(p).into();
        let (l, e, ee) = (self.half, tolerance, tolerance * tolerance);
        let yy = y * y;
        let to_from = (x + l) * (x + l) + yy - ee;
        let to_to = (x - l) * (x - l) + yy - ee;
        if to_from <= 0.0 || to_to <= 0.0 {
            return;
        }
        let s = (to_from * to_to).sqrt();
        let k = x * x + yy - l * l - ee;
        if k <= 0.0 {
            let scale = 2.0 * l / (s - k);
            bulges.least = bulges.least.max(scale * (y - e));
            bulges.most = bulges.most.min(scale * (y + e));
            return;
        }
        let scale = (s + k) / (2.0 * l);
        // If |y| = e, one of the two bounds is infinite and only the other one limits the bulges.
        let (first, second) = (scale / (e + y), -(scale / (e - y)));
        if yy <= ee {
            bulges.hole = [bulges.hole[0].min(second), bulges.hole[1].max(first)];
        } else {
            bulges.least = bulges.least.max(first);
            bulges.most = bulges.most.min(second);
        }
    }

    /// The largest bulge of an arc to the left of the chord that rises at most `tolerance` mm above the line
    /// from `a` to `b`. The rise is measured at the line's nearest place to the arc's centre. `None` if this
    /// place is not between `a` and `b`: the line then sets no limit.
    pub fn highest_over(&self, a: Vector2<f64>, b: Vector2<f64>, tolerance: f64) -> Option<f64> {
        let [a, b] = [self.local(a), self.local(b)];
        self.over([a, b], tolerance)
    }

    /// As [`Self::highest_over`], for arcs to the right: the least bulge.
    pub fn lowest_under(&self, a: Vector2<f64>, b: Vector2<f64>, tolerance: f64) -> Option<f64> {
        let mirrored = |p| {
            let [x, y] = self.local(p).into();
            Vector2::new(x, -y)
        };
        self.over([a, b].map(mirrored), tolerance).map(|bulge| -bulge)
    }

    /// The bulge b at which the line touches a circle about the arc's centre that is smaller than the arc by
    /// e. Let n be the line's left unit normal, h the line's height over the origin along n, c the centre's
    /// height and r the radius. Then h - n_y c = r - e, which is
    /// L(1 + n_y) b^2 - 2(h + e) b + L(1 - n_y) = 0.
    fn over(&self, [a, b]: [Vector2<f64>; 2], tolerance: f64) -> Option<f64> {
        let (along, l) = (b - a, self.half);
        let length = along.norm();
        let normal = Vector2::new(-along.y, along.x) / length;
        let h = normal.dot(&a) + tolerance;
        let rest = h * h - l * l * (1.0 - normal.y * normal.y);
        if !(length > 0.0 && h > 0.0 && rest >= 0.0 && normal.y > -1.0) {
            return None;
        }
        let bulge = (h + rest.sqrt()) / (l * (1.0 + normal.y));
        let center = Vector2::new(0.0, self.center(bulge));
        let foot = (center - a).dot(&along) / (length * length);
        (0.0..=1.0).contains(&foot).then_some(bulge)
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// The distance of a point in the chord's frame from the arc, or from the chord, by samples.
    fn sampled(chord: &Chord, bulge: f64, p: Vector2<f64>) -> f64 {
        let n = 4000;
        let at = |k: usize| {
            let t = k as f64 / f64::from(n as u32);
            if bulge == 0.0 {
                return Vector2::new(chord.half * (2.0 * t - 1.0), 0.0);
            }
            let (c, r) = (chord.center(bulge), chord.radius(bulge));
            // The sweep is 4 atan b about the top of the arc.
            let angle = 4.0 * bulge.abs().atan() * (0.5 - t);
            Vector2::new(-r * angle.sin(), c + bulge.signum() * r * angle.cos())
        };
        (0..=n).map(|k| (at(k) - p).norm()).fold(f64::INFINITY, f64::min)
    }

    proptest! {
        #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

        /// Points anywhere: bulges in the set are nearer than the tolerance, bulges outside are farther.
        #[test]
        fn the_closed_form_agrees_with_sampled_distances(
            half in 0.2..5.0f64, x in -8.0..8.0f64, y in -8.0..8.0f64, e in 0.01..1.0f64, bulge in -20.0..20.0f64,
        ) {
            let chord = Chord::new(Vector2::new(-half, 0.0), Vector2::new(half, 0.0)).unwrap();
            let p = Vector2::new(x, y);
            let mut bulges = Bulges::up_to(f64::INFINITY);
            chord.keep_near(p, e, &mut bulges);
            for b in [bulge, bulge / 20.0, 1.0 / bulge, 0.0] {
                let distance = sampled(&chord, b, p);
                // The error of the sampled distance.
                let missed = 2.0 * chord.radius(b.abs().max(0.05)) * 3.2 / 4000.0;
                if (distance - e).abs() > missed {
                    prop_assert_eq!(distance < e, bulges.contains(b), "{} {} {:?}", b, distance, bulges);
                }
            }
        }

        /// At the bound, the circle that is smaller by the tolerance touches the line.
        #[test]
        fn the_bound_over_a_line_touches_it(
            ax in -0.9..0.0f64, bx in 0.05..0.9f64, ay in -0.2..0.6f64, by in -0.2..0.6f64, e in 0.001..0.1f64,
        ) {
            let chord = Chord::new(Vector2::new(-1.0, 0.0), Vector2::new(1.0, 0.0)).unwrap();
            let (a, b) = (Vector2::new(ax, ay), Vector2::new(bx, by));
            if let Some(bulge) = chord.highest_over(a, b, e) {
                let center = Vector2::new(0.0, chord.center(bulge));
                let distance = (b - a).perp(&(center - a)).abs() / (b - a).norm();
                prop_assert!((distance - (chord.radius(bulge) - e)).abs() < 1e-9 * (1.0 + distance));
                let (a, b) = (Vector2::new(ax, -ay), Vector2::new(bx, -by));
                prop_assert_eq!(chord.lowest_under(a, b, e), Some(-bulge));
            }
        }
    }
}

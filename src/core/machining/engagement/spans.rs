//! Ranges on the leading half of the unit circle. A point of this half circle is given by its y, from -1 to
//! 1, where x is the direction of motion.

use std::f64::consts::PI;

use nalgebra::Vector2;

/// Points nearer than this to the boundary of a stadium count as outside.
const ROUNDING: f64 = 1e-12;

/// The most ranges that one chord frees. The boundary of the chord's stadium crosses the circle at most
/// eight times. Between these crossings the half circle has at most five ranges inside the stadium.
const MOST: usize = 5;

/// The ranges that one chord frees, in ascending order.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Few {
    count: usize,
    ranges: [[f64; 2]; MOST],
}

impl Few {
    fn push(&mut self, range: [f64; 2]) {
        if self.count > 0 && self.ranges[self.count - 1][1] == range[0] {
            self.ranges[self.count - 1][1] = range[1];
        } else if self.count < MOST {
            self.ranges[self.count] = range;
            self.count += 1;
        }
    }

    pub(super) fn ranges(&self) -> &[[f64; 2]] {
        &self.ranges[..self.count]
    }
}

/// Any number of ranges, in ascending order and apart from each other.
#[derive(Debug, Clone, Default)]
pub(super) struct Spans {
    ranges: Vec<[f64; 2]>,
}

impl Spans {
    pub(super) fn add(&mut self, few: &Few) {
        few.ranges().iter().for_each(|range| self.insert(*range));
    }

    /// Adds the ranges that two lists of ranges have in common.
    pub(super) fn add_common(&mut self, one: &Few, other: &Few) {
        for a in one.ranges() {
            for b in other.ranges() {
                let range = [a[0].max(b[0]), a[1].min(b[1])];
                if range[0] < range[1] {
                    self.insert(range);
                }
            }
        }
    }

    /// Adds a range, and makes one range of all that it touches.
    fn insert(&mut self, [from, to]: [f64; 2]) {
        let first = self.ranges.partition_point(|range| range[1] < from);
        let touched = self.ranges[first..].iter().take_while(|range| range[0] <= to).count();
        if touched == 0 {
            self.ranges.insert(first, [from, to]);
            return;
        }
        let last = first + touched - 1;
        self.ranges[first] = [self.ranges[first][0].min(from), self.ranges[last][1].max(to)];
        self.ranges.drain(first + 1..=last);
    }

    /// The centre and the radius of a disc that contains every point of the half circle outside the ranges;
    /// `None` if the ranges cover the half circle.
    pub(super) fn disc_of_left(&self) -> Option<(Vector2<f64>, f64)> {
        let (mut from, mut to) = (-1.0, 1.0);
        if let (Some(first), Some(last)) = (self.ranges.first(), self.ranges.last()) {
            from = if first[0] <= from { first[1] } else { from };
            to = if last[1] >= to { last[0] } else { to };
        }
        let [from, to] = [from, to].map(|y| Vector2::new(((1.0 - y) * (1.0 + y)).max(0.0).sqrt(), y));
        (from.y < to.y).then(|| {
            let half = 0.5 * (to - from).norm();
            // An arc of at most half a circle lies in the disc that has the arc's chord as its diameter.
            (0.5 * (from + to), half + ROUNDING.sqrt())
        })
    }

    /// The size of the part of the half circle that is outside all ranges.
    pub(super) fn left(&self) -> Left {
        let (mut covered, mut width) = (0.0, 0.0);
        for [from, to] in &self.ranges {
            covered += to.asin() - from.asin();
            width += to - from;
        }
        Left { angle: (PI - covered).max(0.0), width: (2.0 - width).max(0.0) }
    }
}

/// The size of a part of the half circle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Left {
    /// The angle of the part at the centre of the circle, radians.
    pub angle: f64,
    /// The width of the part across the motion, as a part of the radius.
    pub width: f64,
}

/// Whether the chord from `a` to `b` is nearer to the origin than `within`.
pub(super) fn is_near(a: Vector2<f64>, b: Vector2<f64>, within: f64) -> bool {
    let chord = b - a;
    let square = chord.norm_squared();
    let u = if square > 0.0 { (-a.dot(&chord) / square).clamp(0.0, 1.0) } else { 0.0 };
    (a + chord * u).norm_squared() < within * within
}

/// The ranges of the half circle that are nearer than `reach` to the chord from `a` to `b`.
pub(super) fn freed(a: Vector2<f64>, b: Vector2<f64>, reach: f64) -> Few {
    let mut few = Few::default();
    let chord = b - a;
    let length = chord.norm();
    // The crossings of the circle with the boundary of the stadium, by their y.
    let mut crossings = [0.0; 10];
    let mut count = 0;
    let mut see = |u: Vector2<f64>| {
        if u.x > 0.0 && count < 8 {
            crossings[count] = u.y;
            count += 1;
        }
    };
    let along = if length > 0.0 { chord / length } else { Vector2::x() };
    let normal = Vector2::new(-along.y, along.x);
    if length > 0.0 {
        let beside = normal.dot(&a);
        for side in [beside - reach, beside + reach] {
            if side.abs() < 1.0 {
                let half = ((1.0 - side) * (1.0 + side)).sqrt();
                for ahead in [-half, half] {
                    let foot = ahead - along.dot(&a);
                    if (0.0..=length).contains(&foot) {
                        see(normal * side + along * ahead);
                    }
                }
            }
        }
    }
    for (end, sense) in [(a, -1.0), (b, 1.0)] {
        let distance = end.norm();
        if distance > 0.0 && distance < 1.0 + reach {
            let toward = end / distance;
            let ahead = (1.0 + distance * distance - reach * reach) / (2.0 * distance);
            if ahead.abs() < 1.0 {
                let half = ((1.0 - ahead) * (1.0 + ahead)).sqrt();
                for aside in [-half, half] {
                    let u = toward * ahead + Vector2::new(-toward.y, toward.x) * aside;
                    if sense * (u - end).dot(&along) >= 0.0 || length == 0.0 {
                        see(u);
                    }
                }
            }
        }
    }
    let square = reach * reach - ROUNDING;
    let is_inside = |y: f64| {
        let from = Vector2::new(((1.0 - y) * (1.0 + y)).max(0.0).sqrt(), y) - a;
        let u = from.dot(&along).clamp(0.0, length);
        (from - along * u).norm_squared() < square
    };
    let crossings = &mut crossings[..count];
    crossings.sort_unstable_by(f64::total_cmp);
    let mut from = -1.0;
    for to in crossings.iter().copied().chain([1.0]) {
        if to > from {
            if is_inside(0.5 * (from + to)) {
                few.push([from, to]);
            }
            from = to;
        }
    }
    few
}

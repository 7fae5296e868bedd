//! Entries: how the cutter comes down into the material at the start of a run.

use nalgebra::{Point2, Vector2};

use super::chain::first_part;
use super::conditions::Conditions;
use crate::geometry::region::{Containment, Region};
use crate::geometry::segment::Segment;
use crate::geometry::spacing::spaces;

/// How near the largest radius of a helix is found, mm.
const RADIUS_ACCURACY_MM: f64 = 1e-3;

/// How far a helix may cross the boundary of the centres' region, mm: above rounding. A run that starts on
/// the boundary has a helix that touches it.
const TOUCHING_MM: f64 = 1e-9;

/// The shortest way on which a ramp goes to and fro, as a part of the cutter's radius.
pub const SHORTEST_RAMP: f64 = 0.5;

/// How a run begins at its start.
#[derive(Debug, Clone, PartialEq)]
pub enum Entry {
    /// Straight down where the level is already cleared.
    Open,
    /// Turns about `center`, which end at the start of the run; to the left if `is_left`.
    Helix {
        center: Point2<f64>,
        is_left: bool,
    },
    /// To and fro along the first elements of the run, down to its start.
    Ramp {
        along: Vec<Segment>,
        strokes: usize,
    },
    Plunge,
}

/// The largest helix that ends at `p` in the direction `along`.
pub fn helix(
    p: Point2<f64>,
    along: Vector2<f64>,
    centers: &Region,
    conditions: &Conditions,
) -> Option<(f64, Entry)> {
    let least = 0.5 * conditions.entry.min_diameter_mm;
    let most = 0.5 * conditions.entry.max_diameter_mm;
    let aside = Vector2::new(-along.y, along.x);
    let fits = |center: Point2<f64>, radius: f64| {
        centers.place(center, TOUCHING_MM) == Containment::Inside
            && centers.distance_to_boundary(center) >= radius - TOUCHING_MM
    };
    let largest = |sense: f64| {
        let fits = |radius: f64| fits(p + aside * (sense * radius), radius);
        if !fits(least) {
            return None;
        }
        if fits(most) {
            return Some(most);
        }
        let (mut low, mut high) = (least, most);
        while high - low > RADIUS_ACCURACY_MM {
            let middle = 0.5 * (low + high);
            if fits(middle) { low = middle } else { high = middle }
        }
        Some(low)
    };
    let both = [(largest(1.0), 1.0), (largest(-1.0), -1.0)];
    let best = both.into_iter().filter_map(|(radius, sense)| radius.map(|radius| (radius, sense)));
    let (radius, sense) = best.reduce(|a, b| if b.0 > a.0 { b } else { a })?;
    Some((radius, Entry::Helix { center: p + aside * (sense * radius), is_left: sense > 0.0 }))
}

/// A ramp along the run; none where the run is too short. Where little depth is left, the ramp is flatter
/// than it could be rather than shorter.
pub fn ramp(elements: &[Segment], conditions: &Conditions) -> Option<Entry> {
    let needed = conditions.depth_mm() / conditions.entry.ramp_angle.tan();
    let whole: f64 = elements.iter().map(Segment::length).sum();
    let least = SHORTEST_RAMP * conditions.radius_mm;
    if whole < least {
        return None;
    }
    let longest = whole.min((0.5 * needed).max(least));
    let strokes = 2 * spaces(needed, 2.0 * longest) as usize;
    Some(Entry::Ramp { along: first_part(elements, (needed / strokes as f64).max(least)), strokes })
}

/// Half circles to the left about a place, from it out to a radius, which leave at most a stepover between
/// turns.
pub fn spiral(place: Point2<f64>, radius_mm: f64, stepover_mm: f64) -> Vec<Segment> {
    let count = spaces(2.0 * radius_mm, stepover_mm) as usize;
    let at = |k: usize| {
        let side = if k.is_multiple_of(2) { -1.0 } else { 1.0 };
        place + Vector2::x() * (side * radius_mm * k as f64 / count as f64)
    };
    let half = |k: usize| {
        let (start, end) = (at(k), at(k + 1));
        let center = start + (end - start) * 0.5;
        Segment::about(center, (end - center).norm(), [start, end], std::f64::consts::PI)
    };
    (0..count).map(half).collect()
}

impl Entry {
    /// The entry with x negated.
    #[must_use]
    pub fn mirrored(&self) -> Self {
        match self {
            Self::Open => Self::Open,
            Self::Plunge => Self::Plunge,
            Self::Helix { center, is_left } => {
                Self::Helix { center: Point2::new(-center.x, center.y), is_left: !is_left }
            }
            Self::Ramp { along, strokes } => {
                Self::Ramp { along: along.iter().map(Segment::mirrored).collect(), strokes: *strokes }
            }
        }
    }

    /// What the entry follows on its way down.
    pub fn ways(&self, start: Point2<f64>) -> Vec<Segment> {
        match self {
            Self::Ramp { along, .. } => along.clone(),
            _ => self.footprint(start),
        }
    }

    /// What the entry sweeps at the floor of the level.
    pub fn footprint(&self, start: Point2<f64>) -> Vec<Segment> {
        match self {
            Self::Open | Self::Plunge => vec![Segment::Line { start, end: start }],
            Self::Ramp { along, .. } => along[..1].iter().map(|first| first.part(0.0, 0.0)).collect(),
            Self::Helix { center, is_left } => circle(start, *center, *is_left).to_vec(),
        }
    }
}

/// The circle through `start` as two halves.
pub fn circle(start: Point2<f64>, center: Point2<f64>, is_left: bool) -> [Segment; 2] {
    let radius = (start - center).norm();
    let opposite = center + (center - start);
    let turn = if is_left { std::f64::consts::PI } else { -std::f64::consts::PI };
    [
        Segment::about(center, radius, [start, opposite], turn),
        Segment::about(center, radius, [opposite, start], turn),
    ]
}

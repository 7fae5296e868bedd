//! Which loops lie within which.
//!
//! # Method
//! 1. For each loop a place inside is found: the middle of the widest part of a horizontal line that lies in
//!    the loop. Several lines are tried.
//! 2. A line sweeps over the places by y. The arcs and lines that it crosses to the right of a place are
//!    counted for each loop; a loop holds the place if their number is odd.
//! 3. A loop lies within each larger loop that holds its place.
//!
//! # Guarantees
//! Where loops do not cross, the result is exact, also if they touch: the place of a loop then keeps a
//! distance from all loops that are larger. Every line and arc is divided where y turns, and the ends of its
//! parts are those of its neighbours, so that no crossing is counted twice or missed. Loops that cross each
//! other are nested by the place alone.
//!
//! # Cost
//! O(n log n) for n elements, and one step for each element at the height of each place. The sweep runs along
//! x instead of y if that takes fewer steps.

use nalgebra::Point2;
use toolpathd_core::budget::{Budget, Stopped};
use toolpathd_core::geometry::segment::Segment;

use super::{Loop, bulge};

/// The heights at which a place inside a loop is sought, as parts of its height. They are no simple
/// fractions, at which many drawings have vertices.
const HEIGHTS: [f64; 7] = [0.503, 0.353, 0.647, 0.211, 0.787, 0.0713, 0.931];

/// Where a loop lies.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Nest {
    pub depth: usize,
    /// The smallest of the loops around it.
    pub parent: Option<usize>,
}

/// # Errors
/// When the budget ends.
pub fn nests(loops: &[Loop], budget: &Budget) -> Result<Vec<Nest>, Stopped> {
    let along_y = Sweep::new(loops, |v| v, budget)?;
    // The same with x and y exchanged, which turns arcs the other way.
    let along_x = Sweep::new(loops, |[x, y, bulge]| [y, x, -bulge], budget)?;
    if along_x.n_steps() < along_y.n_steps() {
        along_x.nests(loops, budget)
    } else {
        along_y.nests(loops, budget)
    }
}

/// The parts of the loops, and a place inside each loop.
struct Sweep {
    /// By their lower ends.
    edges: Vec<Edge>,
    /// With the numbers of their loops, by y.
    places: Vec<(usize, [f64; 2])>,
}

impl Sweep {
    fn new(loops: &[Loop], map: impl Fn([f64; 3]) -> [f64; 3], budget: &Budget) -> Result<Self, Stopped> {
        let mut edges: Vec<Edge> = Vec::new();
        let mut places: Vec<(usize, [f64; 2])> = Vec::new();
        for (number, one) in loops.iter().enumerate() {
            budget.check()?;
            let first = edges.len();
            let vertices: Vec<[f64; 3]> = one.vertices.iter().map(|v| map(*v)).collect();
            for segment in bulge::segments(&vertices, true) {
                push_edges(&segment, number, &mut edges);
            }
            places.extend(place_inside(&edges[first..]).map(|place| (number, place)));
        }
        edges.sort_by(|a, b| a.low.total_cmp(&b.low));
        places.sort_by(|(a, p), (b, q)| p[1].total_cmp(&q[1]).then(a.cmp(b)));
        Ok(Self { edges, places })
    }

    /// How many edges the sweep looks at: those at the heights of all places.
    fn n_steps(&self) -> usize {
        let mut highs: Vec<f64> = self.edges.iter().map(|edge| edge.high).collect();
        highs.sort_by(f64::total_cmp);
        let at = |y: f64| {
            let begun = self.edges.partition_point(|edge| edge.low <= y);
            begun - highs.partition_point(|high| *high <= y).min(begun)
        };
        self.places.iter().map(|(_, place)| at(place[1])).sum()
    }

    fn nests(&self, loops: &[Loop], budget: &Budget) -> Result<Vec<Nest>, Stopped> {
        let mut nests = vec![Nest::default(); loops.len()];
        let mut next = 0;
        let mut crossed: Vec<Edge> = Vec::new();
        let mut is_odd = vec![false; loops.len()];
        for &(number, [x, y]) in &self.places {
            budget.check()?;
            crossed.retain(|edge| edge.high > y);
            while let Some(edge) = self.edges.get(next).filter(|edge| edge.low <= y) {
                if edge.high > y {
                    crossed.push(*edge);
                }
                next += 1;
            }
            let mut touched = Vec::new();
            for edge in &crossed {
                if edge.right > x && (edge.left > x || edge.x_at(y) > x) {
                    is_odd[edge.number] ^= true;
                    touched.push(edge.number);
                }
            }
            touched.sort_unstable();
            touched.dedup();
            let size = |k: usize| (loops[k].area_mm2, std::cmp::Reverse(k));
            let nest = &mut nests[number];
            for other in touched {
                let holds = std::mem::take(&mut is_odd[other]);
                if holds && other != number && size(other) > size(number) {
                    nest.depth += 1;
                    if nest.parent.is_none_or(|parent| size(other) < size(parent)) {
                        nest.parent = Some(other);
                    }
                }
            }
        }
        Ok(nests)
    }
}

/// A part of a line or an arc along which y rises or falls.
#[derive(Debug, Clone, Copy)]
struct Edge {
    /// The loop.
    number: usize,
    /// The range of y, without `high`.
    low: f64,
    high: f64,
    left: f64,
    right: f64,
    shape: EdgeShape,
}

#[derive(Debug, Clone, Copy)]
enum EdgeShape {
    /// From the lower end to the upper.
    Line([Point2<f64>; 2]),
    /// Of a circle, the half on this side of the centre: 1 to the right, -1 to the left.
    Arc { center: Point2<f64>, radius: f64, side: f64 },
}

impl Edge {
    fn x_at(&self, y: f64) -> f64 {
        let x = match self.shape {
            EdgeShape::Line([low, high]) => low.x + (high.x - low.x) * ((y - low.y) / (high.y - low.y)),
            EdgeShape::Arc { center, radius, side } => {
                let rise = y - center.y;
                center.x + side * ((radius - rise) * (radius + rise)).max(0.0).sqrt()
            }
        };
        x.clamp(self.left, self.right)
    }
}

/// Appends the parts of a segment along which y rises or falls. A horizontal part has no height and is left
/// out.
fn push_edges(segment: &Segment, number: usize, edges: &mut Vec<Edge>) {
    let mut push = |a: Point2<f64>, b: Point2<f64>, half: Option<(Point2<f64>, f64, f64)>| {
        let [low, high] = if a.y <= b.y { [a, b] } else { [b, a] };
        if low.y == high.y {
            return;
        }
        let (mut left, mut right) = (a.x.min(b.x), a.x.max(b.x));
        let mut shape = EdgeShape::Line([low, high]);
        if let Some((center, radius, side)) = half {
            let most = center.x + side * radius;
            if low.y <= center.y && center.y <= high.y {
                (left, right) = (left.min(most), right.max(most));
            }
            shape = EdgeShape::Arc { center, radius, side };
        }
        edges.push(Edge { number, low: low.y, high: high.y, left, right, shape });
    };
    let Segment::Arc(arc) = segment else {
        push(segment.start(), segment.end(), None);
        return;
    };
    let (center, radius) = (arc.center(), arc.radius());
    // The top and the bottom of the circle, in the order of the arc.
    let mut tops: Vec<(f64, Point2<f64>)> = [radius, -radius]
        .map(|rise| (arc.angle_to([0.0, rise].into()), Point2::new(center.x, center.y + rise)))
        .into_iter()
        .filter(|(angle, _)| *angle > 0.0 && *angle < arc.turn().abs())
        .collect();
    tops.sort_by(|(a, _), (b, _)| a.total_cmp(b));
    let mut from = arc.start();
    let mut angle_from = 0.0;
    for (angle, to) in tops.into_iter().chain([(arc.turn().abs(), arc.end())]) {
        let middle = segment.at((0.5 * (angle_from + angle)) / arc.turn().abs());
        let side = if middle.x >= center.x { 1.0 } else { -1.0 };
        push(from, to, Some((center, radius, side)));
        (from, angle_from) = (to, angle);
    }
}

/// A place inside the loop of these edges; `None` if there is none.
fn place_inside(edges: &[Edge]) -> Option<[f64; 2]> {
    let low = edges.iter().map(|edge| edge.low).fold(f64::INFINITY, f64::min);
    let high = edges.iter().map(|edge| edge.high).fold(f64::NEG_INFINITY, f64::max);
    let mut widest: Option<(f64, [f64; 2])> = None;
    for part in HEIGHTS {
        let y = low + part * (high - low);
        let mut crossings: Vec<f64> =
            edges.iter().filter(|edge| edge.low <= y && y < edge.high).map(|edge| edge.x_at(y)).collect();
        crossings.sort_by(f64::total_cmp);
        for pair in crossings.chunks_exact(2) {
            let width = pair[1] - pair[0];
            if width > 0.0 && widest.is_none_or(|(most, _)| width > most) {
                widest = Some((width, [0.5 * (pair[0] + pair[1]), y]));
            }
        }
    }
    widest.map(|(_, place)| place)
}

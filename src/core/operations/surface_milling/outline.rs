//! The outline of a surface seen from above: its edges, without seams and poles. It divides sections: only
//! the parts over which the cutter stays inside the outline are kept. A surface without edges has no outline,
//! and every place is inside.

use nalgebra::{Point3, Vector2};

use crate::budget::{Budget, Stopped};
use crate::geometry::surface::topology::Topology;
use crate::geometry::surface::{BezierSurface, Patch, Surface};
use crate::machining::offset_section::Chain;

/// The most chords of the whole outline. The patches along it share them evenly; each patch has at least one.
const CHORD_LIMIT: usize = 20_000;

/// How far a way along the margin may leave it for rounding alone, mm.
const ON_MARGIN_MM: f64 = 1e-6;

/// Steps between two checks of the budget.
const STEPS_BETWEEN_CHECKS: usize = 64;

/// The edges of a surface in plan, as closed loops of chords. A surface that is closed in one direction has a
/// loop for each of its two ends, and none for an end that is a pole.
pub(super) struct Outline {
    loops: Vec<Vec<Vector2<f64>>>,
    /// The largest distance of the sides from their chords, mm.
    chord_height_mm: f64,
}

impl Outline {
    /// The outline with chords that leave the sides by about `accuracy` mm.
    ///
    /// # Errors
    /// Only the budget's stop.
    pub(super) fn new(
        surface: &BezierSurface<impl Patch>,
        accuracy: f64,
        budget: &Budget,
    ) -> Result<Self, Stopped> {
        let [nu, nv] = surface.spans();
        let topology = Topology::of(surface);
        let [low_u, high_u, low_v, high_v] = topology.edges();
        let mut outline = Self { loops: vec![Vec::new()], chord_height_mm: 0.0 };
        let most = (CHORD_LIMIT / (2 * (nu + nv))).max(1) as f64;
        // Round the domain: along v = 0, u = nu, v = nv and u = 0. At a seam a loop ends, and the next edge
        // begins another one.
        let is_closed = topology.is_closed(0) || topology.is_closed(1);
        for i in (0..nu).filter(|_| low_v) {
            outline.add(surface.patch(i, 0), |t| [t, 0.0], [accuracy, most]);
        }
        outline.end_side(is_closed);
        budget.check()?;
        for j in (0..nv).filter(|_| high_u) {
            outline.add(surface.patch(nu - 1, j), |t| [1.0, t], [accuracy, most]);
        }
        outline.end_side(is_closed);
        for i in (0..nu).rev().filter(|_| high_v) {
            outline.add(surface.patch(i, nv - 1), |t| [1.0 - t, 1.0], [accuracy, most]);
        }
        outline.end_side(is_closed);
        budget.check()?;
        for j in (0..nv).rev().filter(|_| low_u) {
            outline.add(surface.patch(0, j), |t| [0.0, 1.0 - t], [accuracy, most]);
        }
        outline.loops.retain(|corners| !corners.is_empty());
        Ok(outline)
    }

    /// Begins another loop on a surface that is closed in one direction.
    fn end_side(&mut self, is_closed: bool) {
        if is_closed {
            self.loops.push(Vec::new());
        }
    }

    fn add(&mut self, patch: &impl Patch, place: impl Fn(f64) -> [f64; 2], [accuracy, most]: [f64; 2]) {
        let derivatives = patch.derivatives();
        let [from, to] = [place(0.0), place(1.0)];
        let bend = if from[0] != to[0] { derivatives.duu } else { derivatives.dvv };
        // A chord over a parameter step d leaves the curve by d^2 / 8 times the second derivative.
        let bend = bend.reach() / 8.0;
        let chords = (bend / accuracy).sqrt().ceil().clamp(1.0, most);
        self.chord_height_mm = self.chord_height_mm.max(bend / (chords * chords));
        let corners = (0..chords as usize).map(|k| {
            let [u, v] = place(k as f64 / chords);
            patch.jet(u, v).point.coords.xy()
        });
        self.loops.last_mut().into_iter().for_each(|side| side.extend(corners.clone()));
    }

    /// The distance of a place from the outline, mm: positive inside. A place that moves by d changes it by
    /// at most d.
    pub(super) fn depth(&self, p: &Vector2<f64>) -> f64 {
        if self.loops.is_empty() {
            return f64::INFINITY;
        }
        let mut squared = f64::INFINITY;
        let mut is_inside = false;
        for [from, to] in self.chords() {
            let (along, d) = (to - from, p - from);
            let length = along.norm_squared();
            let t = if length > 0.0 { (along.dot(&d) / length).clamp(0.0, 1.0) } else { 0.0 };
            squared = squared.min((d - along * t).norm_squared());
            if (from.y > p.y) != (to.y > p.y) && (along.perp(&d) > 0.0) == (to.y > from.y) {
                is_inside = !is_inside;
            }
        }
        if is_inside { squared.sqrt() } else { -squared.sqrt() }
    }

    /// The parts of `chain` that lie at least `margin` mm inside the sides; `margin` is above zero.
    ///
    /// # Errors
    /// Only the budget's stop.
    pub(super) fn clipped(&self, chain: &Chain, margin: f64, budget: &Budget) -> Result<Vec<Chain>, Stopped> {
        let margin = margin + self.chord_height_mm;
        let mut parts = Vec::new();
        let mut part: Vec<Point3<f64>> = Vec::new();
        // The distance from the margin at the last test, less the length gone since: so far the chain cannot
        // cross the margin.
        let (mut certain, mut was_inside) = (0.0, false);
        for (k, pair) in chain.points.windows(2).enumerate() {
            if k.is_multiple_of(STEPS_BETWEEN_CHECKS) {
                budget.check()?;
            }
            let length = (pair[1] - pair[0]).norm();
            if certain <= length {
                let depth = self.depth(&pair[0].coords.xy()) - margin;
                (certain, was_inside) = (depth.abs(), depth > 0.0);
            }
            let free = if certain > length {
                if was_inside { vec![[0.0, 1.0]] } else { Vec::new() }
            } else {
                self.free(pair[0].coords.xy(), pair[1].coords.xy(), margin)
            };
            certain -= length;
            if free.first().is_none_or(|first| first[0] > 0.0) {
                parts.push(std::mem::take(&mut part));
            }
            for [from, to] in free {
                let at = |t: f64| pair[0] + (pair[1] - pair[0]) * t;
                if part.is_empty() {
                    part.push(at(from));
                }
                part.push(at(to));
                if to < 1.0 {
                    parts.push(std::mem::take(&mut part));
                }
            }
        }
        parts.push(part);
        parts.retain(|points| points.len() >= 2);
        let chord_height_mm = chain.chord_height_mm;
        Ok(parts.into_iter().map(|points| Chain { points, chord_height_mm }).collect())
    }

    /// Whether a part of the line at the coordinate `at` along `axis` lies at least `margin` mm inside the
    /// sides.
    pub(super) fn is_inside(&self, axis: usize, at: f64, margin: f64) -> bool {
        let end = |along: f64| {
            let mut end = Vector2::repeat(at);
            end[1 - axis] = along;
            end
        };
        if self.loops.is_empty() {
            return true;
        }
        let along = |corner: &Vector2<f64>| corner[1 - axis];
        let low = self.loops.iter().flatten().map(along).fold(f64::INFINITY, f64::min);
        let high = self.loops.iter().flatten().map(along).fold(f64::NEG_INFINITY, f64::max);
        !self.free(end(low), end(high), margin + self.chord_height_mm).is_empty()
    }

    /// Whether the axis of a cutter stays at least `margin` mm inside the edges on the whole way from `from`
    /// to `to`, up to the accuracy of parts of chains.
    pub(super) fn holds(&self, from: Vector2<f64>, to: Vector2<f64>, margin: f64) -> bool {
        let margin = margin + self.chord_height_mm - ON_MARGIN_MM;
        self.free(from, to, margin) == [[0.0, 1.0]]
    }

    /// The parts of the way from `a` to `b`, as fractions of it, that lie inside and farther than `margin` mm
    /// from every chord. The points nearer to one chord form an interval, because the chord's neighbourhood
    /// is convex.
    fn free(&self, a: Vector2<f64>, b: Vector2<f64>, margin: f64) -> Vec<[f64; 2]> {
        let mut blocked: Vec<[f64; 2]> =
            self.chords().filter_map(|chord| near(chord, a, b - a, margin)).collect();
        blocked.sort_by(|x, y| x[0].total_cmp(&y[0]));
        blocked.push([1.0, 1.0]);
        let mut free = Vec::new();
        let mut from = 0.0f64;
        for [low, high] in blocked {
            let to = low.min(1.0);
            if to > from && self.depth(&(a + (b - a) * (0.5 * (from + to)))) > 0.0 {
                free.push([from, to]);
            }
            from = from.max(high);
        }
        free
    }

    fn chords(&self) -> impl Iterator<Item = [Vector2<f64>; 2]> {
        self.loops.iter().flat_map(|corners| {
            let before = corners.iter().cycle().skip(corners.len() - 1);
            before.zip(corners).map(|(from, to)| [*from, *to])
        })
    }
}

/// The interval of the way from `start` along `way`, in fractions of it, that lies nearer than `reach` mm to
/// a chord: near one of its ends, or beside it. `None` if there is none in 0..=1.
fn near([p, q]: [Vector2<f64>; 2], start: Vector2<f64>, way: Vector2<f64>, reach: f64) -> Option<[f64; 2]> {
    let along = q - p;
    let length = along.norm();
    let ends = [p, q].map(|end| within(way, start - end, reach));
    let beside = (length > 0.0).then(|| along / length).and_then(|unit| {
        let across = between(unit.perp(&way), unit.perp(&(start - p)), [-reach, reach])?;
        let between_ends = between(unit.dot(&way), unit.dot(&(start - p)), [0.0, length])?;
        intersection(across, between_ends)
    });
    let all = ends.into_iter().chain([beside]).flatten();
    let hull = all.reduce(|one, other| [one[0].min(other[0]), one[1].max(other[1])])?;
    intersection(hull, [0.0, 1.0])
}

/// The t for which |from + t way| is below `reach`.
fn within(way: Vector2<f64>, from: Vector2<f64>, reach: f64) -> Option<[f64; 2]> {
    let (a, b, c) = (way.norm_squared(), way.dot(&from), from.norm_squared() - reach * reach);
    if a == 0.0 {
        return (c < 0.0).then_some([f64::NEG_INFINITY, f64::INFINITY]);
    }
    let discriminant = b * b - a * c;
    (discriminant > 0.0).then(|| [(-b - discriminant.sqrt()) / a, (-b + discriminant.sqrt()) / a])
}

/// The t for which from + t slope lies in a range.
fn between(slope: f64, from: f64, [low, high]: [f64; 2]) -> Option<[f64; 2]> {
    if slope == 0.0 {
        return (low < from && from < high).then_some([f64::NEG_INFINITY, f64::INFINITY]);
    }
    let (one, other) = ((low - from) / slope, (high - from) / slope);
    Some([one.min(other), one.max(other)])
}

fn intersection(one: [f64; 2], other: [f64; 2]) -> Option<[f64; 2]> {
    let [low, high] = [one[0].max(other[0]), one[1].min(other[1])];
    (low <= high).then_some([low, high])
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;

    use super::*;
    use crate::geometry::surface::BicubicPatch;
    use crate::geometry::surface::point_grid::{Ends, PointGrid, Twist};

    /// A flat patch of 30 by 12 mm.
    fn outline() -> Outline {
        let surface = BezierSurface::from_fn([1, 1], |_, _| BicubicPatch {
            net: std::array::from_fn(|a| {
                std::array::from_fn(|b| Vector3::new(10.0 * a as f64, 4.0 * b as f64, 0.0))
            }),
        });
        Outline::new(&surface, 1e-3, &Budget::unlimited()).unwrap()
    }

    #[test]
    fn depth_is_the_distance_to_the_nearest_side() {
        let outline = outline();
        for (x, y, expected) in [(15.0, 6.0, 6.0), (1.0, 3.0, 1.0), (-2.0, 5.0, -2.0), (33.0, 16.0, -5.0)] {
            assert!((outline.depth(&Vector2::new(x, y)) - expected).abs() < 1e-9, "{x} {y}");
        }
    }

    #[test]
    fn chains_end_where_the_margin_does() {
        let chain = |points: Vec<Point3<f64>>| Chain { points, chord_height_mm: 0.5 };
        let across = chain((0..=200).map(|k| Point3::new(-5.0 + 0.2 * f64::from(k), 6.0, 1.0)).collect());
        let parts = outline().clipped(&across, 2.0, &Budget::unlimited()).unwrap();
        let [part] = parts.as_slice() else { panic!("{} parts", parts.len()) };
        let (first, last) = (part.points[0], part.points[part.points.len() - 1]);
        assert!((first.x - 2.0).abs() < 1e-6 && (last.x - 28.0).abs() < 1e-6, "{first} {last}");
        assert_eq!(part.chord_height_mm, 0.5);
        for (at, is_inside) in [(1.99, false), (2.01, true), (6.0, true), (9.99, true), (10.01, false)] {
            assert_eq!(outline().is_inside(1, at, 2.0), is_inside, "{at}");
        }
        let edge = chain((0..=20).map(|k| Point3::new(f64::from(k), 1.0, 0.0)).collect());
        assert!(outline().clipped(&edge, 2.0, &Budget::unlimited()).unwrap().is_empty());
        // A long step over a notch: both ends are far from the notch, and the part over the notch is cut out.
        let notched = Outline {
            loops: vec![
                [[0.0, 0.0], [14.0, 0.0], [15.0, 5.5], [16.0, 0.0], [30.0, 0.0], [30.0, 12.0], [0.0, 12.0]]
                    .map(Vector2::from)
                    .to_vec(),
            ],
            chord_height_mm: 0.0,
        };
        let step = chain(vec![Point3::new(3.0, 6.0, 0.0), Point3::new(27.0, 6.0, 0.0)]);
        let parts = notched.clipped(&step, 1.0, &Budget::unlimited()).unwrap();
        assert_eq!(parts.len(), 2);
        // The notch's tip is half a millimetre below the step.
        let gap = 0.75f64.sqrt();
        assert!((parts[0].points[1].x - (15.0 - gap)).abs() < 1e-9, "{}", parts[0].points[1]);
        assert!((parts[1].points[0].x - (15.0 + gap)).abs() < 1e-9, "{}", parts[1].points[0]);
        // Out and in again: two parts.
        let bow = [(10.0, 6.0), (12.0, 6.0), (14.0, 11.5), (16.0, 6.0), (18.0, 6.0)];
        let bow = chain(bow.iter().map(|(x, y)| Point3::new(*x, *y, 0.0)).collect());
        assert_eq!(outline().clipped(&bow, 2.0, &Budget::unlimited()).unwrap().len(), 2);
    }

    /// The outline of a cone from the radius `low` to the radius 30, closed around its axis.
    fn ring(low: f64) -> Outline {
        let row = |k: usize| {
            let (sin, cos) = (std::f64::consts::TAU * (k % 36) as f64 / 36.0).sin_cos();
            [30.0, 0.5 * (30.0 + low), low].map(|r| Point3::new(r * cos, r * sin, 30.0 - r)).to_vec()
        };
        let points = (0..=36).map(row).collect();
        let grid = PointGrid { points, twist: Twist::Spline, ends: Ends::Usual };
        Outline::new(&grid.surface().unwrap(), 1e-4, &Budget::unlimited()).unwrap()
    }

    #[test]
    fn a_closed_surface_has_an_outline_at_each_edge_and_none_at_its_seam_or_pole() {
        for (low, hole) in [(12.0, 12.0), (0.0, f64::NEG_INFINITY)] {
            let outline = ring(low);
            for (x, y) in [(21.0, 0.0), (-14.0, 0.0), (0.0, 25.0), (3.0, 4.0), (20.0, 30.0)] {
                let r = f64::hypot(x, y);
                let depth = outline.depth(&Vector2::new(x, y));
                // Without a hole, the second distance is infinite.
                let expected = (30.0 - r).min(r - hole);
                assert!((depth - expected).abs() < 0.01, "{low}, {x} {y}: {depth}, not {expected}");
            }
            assert!(outline.holds(Vector2::new(20.0, -3.0), Vector2::new(20.0, 3.0), 3.0));
            let across = outline.holds(Vector2::new(20.0, 0.0), Vector2::new(-20.0, 0.0), 3.0);
            assert_eq!(across, low == 0.0, "a way over the middle of the ring with a hole of {low}");
        }
    }
}

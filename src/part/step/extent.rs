//! The ranges of a face: of its parameters, and its box in space.
//!
//! # Method
//! The largest value of a coordinate is on the bounds, or where the coordinate's direction is the normal of
//! the surface. Planes, cylinders, cones and extrusions have no such places without one on the bounds.
//! Spheres and tori have them in closed form; other surfaces are searched from a grid.

use std::f64::consts::{PI, TAU};

use nalgebra::{Point3, Vector3};

use super::chain::Chain;
use super::model::Edge;
use super::piece::{BoundPiece, Sample, Sampler, lift, spread};
use super::spline_surface::newton_step;
use super::surface::Surface;
use super::trim::Trim;

/// The least number of places along each parameter from which extremes are searched.
const GRID: usize = 8;

/// The most places along each parameter.
const FINEST_GRID: usize = 200;

/// How often a place of the grid is compared with a side of the bounds: some 0.1 s.
const MOST_TESTS: usize = 10_000_000;

/// From how many places of the grid extremes are searched.
const MOST_TOPS: usize = 6;

/// Bisections for the place of an extreme: 1e-12 of the distance of two samples.
const BISECTIONS: usize = 40;

/// A place outside the rectangle of parameters by this part of its half width is on its side.
const ON_SIDE: f64 = 1e-7;

/// A parameter that changes by less, as a part of its size, is constant.
const ROUNDING: f64 = 1e-10;

/// Halvings of the step of the search for an extreme: 1e-9 of the distance of two places.
const HALVINGS: usize = 30;

/// The ranges of u and v of a trim.
pub fn domain(sampler: &Sampler, trim: &Trim, edges: &[Edge]) -> [[f64; 2]; 2] {
    let mut domain = [[f64::MAX, f64::MIN]; 2];
    for piece in trim.chains.iter().flat_map(|chain: &Chain| &chain.pieces) {
        for (k, [low, high]) in domain.iter_mut().enumerate() {
            for place in piece.places() {
                *low = low.min(place[k]);
                *high = high.max(place[k]);
            }
        }
        let BoundPiece::Curve { edge, samples } = piece else { continue };
        for (k, [low, high]) in domain.iter_mut().enumerate() {
            for extreme in turning_places(sampler, &edges[*edge], samples, k) {
                *low = low.min(extreme);
                *high = high.max(extreme);
            }
        }
    }
    domain
}

/// The values of a parameter where it turns round on an edge, beside its least and its largest sample.
fn turning_places(sampler: &Sampler, edge: &Edge, samples: &[Sample], k: usize) -> Vec<f64> {
    let order = |a: &usize, b: &usize| samples[*a].at[k].total_cmp(&samples[*b].at[k]);
    let all = || 0..samples.len();
    let (Some(least), Some(largest)) = (all().min_by(order), all().max_by(order)) else { return Vec::new() };
    let width = samples[largest].at[k] - samples[least].at[k];
    if width <= ROUNDING * (1.0 + samples[largest].at[k].abs()) {
        return Vec::new();
    }
    let speed = |t: f64, near: [f64; 2]| {
        let (_, du, dv) = sampler.search.surface.jet(sampler.place(edge, t, Some(near)));
        newton_step(&du, &dv, &edge.curve.jet(t).1)[k]
    };
    let mut found = Vec::new();
    for m in [least, largest].into_iter().flat_map(|m| [m.saturating_sub(1), m]) {
        let Some([a, b]) = samples.get(m..m + 2) else { continue };
        if let Some(t) = root(&|t| speed(t, a.at), a.t, b.t) {
            found.push(sampler.place(edge, t, Some(a.at))[k]);
        }
    }
    found
}

/// A root between two places where the values have different signs.
fn root(value: &impl Fn(f64) -> f64, from: f64, to: f64) -> Option<f64> {
    let (start, end) = (value(from), value(to));
    if start * end >= 0.0 || (start * end).is_nan() {
        return None;
    }
    let (mut low, mut high) = (from, to);
    for _ in 0..BISECTIONS {
        let middle = (low + high) / 2.0;
        if value(middle) * start > 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    Some((low + high) / 2.0)
}

/// Whether parameters are within polygons, by whole periods.
pub fn contains(
    polygons: &[Vec<[f64; 2]>],
    domain: [[f64; 2]; 2],
    periods: [Option<f64>; 2],
    at: [f64; 2],
) -> bool {
    let at = [0, 1].map(|k| lift(at[k], (domain[k][0] + domain[k][1]) / 2.0, periods[k]));
    let crossings = polygons.iter().flat_map(|polygon| {
        polygon.iter().zip(polygon.iter().cycle().skip(1)).filter(|(a, b)| {
            (a[1] > at[1]) != (b[1] > at[1]) && at[0] < a[0] + (b[0] - a[0]) * (at[1] - a[1]) / (b[1] - a[1])
        })
    });
    crossings.count() % 2 == 1
}

/// The corners of a box.
#[derive(Debug, Clone, Copy)]
struct Corners([Point3<f64>; 2]);

impl Corners {
    fn add(&mut self, point: &Point3<f64>) {
        self.0 = [self.0[0].inf(point), self.0[1].sup(point)];
    }
}

/// The box of the bounds, mm. `None` without edges.
pub fn edge_box(edges: &[&Edge]) -> Option<[Point3<f64>; 2]> {
    let first = edges.first()?.start();
    let mut corners = Corners([first; 2]);
    for edge in edges {
        let places = spread(edge);
        places.iter().for_each(|t| corners.add(&edge.curve.point(*t)));
        for pair in places.windows(2) {
            for axis in 0..3 {
                if let Some(t) = root(&|t| edge.curve.jet(t).1[axis], pair[0], pair[1]) {
                    corners.add(&edge.curve.point(t));
                }
            }
        }
    }
    Some(corners.0)
}

/// The box of a face within polygons of its parameters, mm.
pub fn face_box(
    surface: &Surface,
    edges: &[&Edge],
    polygons: &[Vec<[f64; 2]>],
    domain: [[f64; 2]; 2],
) -> [Point3<f64>; 2] {
    let corner = surface.point([domain[0][0], domain[1][0]]);
    let mut corners = Corners(edge_box(edges).unwrap_or([corner; 2]));
    let periods = surface.periods();
    let places = polygons.iter().flatten();
    places.for_each(|at| corners.add(&surface.point(*at)));
    let n_corners = polygons.iter().map(Vec::len).sum();
    for axis in [Vector3::x(), Vector3::y(), Vector3::z()] {
        // A place on a side of the rectangle of parameters counts as inside.
        let is_inside = |at: &[f64; 2]| {
            let beside = [0, 1].map(|k| {
                let [from, to] = domain[k];
                let middle = (from + to) / 2.0;
                middle + (lift(at[k], middle, periods[k]) - middle) * (1.0 - ON_SIDE)
            });
            contains(polygons, domain, periods, beside)
        };
        let found = extremes(surface, &axis, domain, n_corners, is_inside);
        found.into_iter().filter(is_inside).for_each(|at| corners.add(&surface.point(at)));
    }
    corners.0
}

/// Places where the normal is along an axis, or nearly.
fn extremes(
    surface: &Surface,
    axis: &Vector3<f64>,
    domain: [[f64; 2]; 2],
    n_corners: usize,
    is_inside: impl Fn(&[f64; 2]) -> bool,
) -> Vec<[f64; 2]> {
    match surface {
        Surface::Plane { .. }
        | Surface::Cylinder { .. }
        | Surface::Cone { .. }
        | Surface::Extrusion { .. } => Vec::new(),
        Surface::Sphere { frame, .. } | Surface::Torus { frame, .. } => {
            let [x, y, z] = [frame.x, frame.y, frame.z].map(|unit| unit.dot(axis));
            let (u, v) = (y.atan2(x), z.atan2(f64::hypot(x, y)));
            // The outward normal is along the axis, or against it, on both halves of a torus.
            let all = [[u, v], [u + PI, -v], [u, v + PI], [u + PI, PI - v]];
            all.map(|[u, v]| [u.rem_euclid(TAU), v]).to_vec()
        }
        Surface::Revolution { .. } | Surface::Spline(_) => {
            let most = (MOST_TESTS / n_corners.max(1)).isqrt().clamp(GRID, FINEST_GRID);
            let search = Search { surface, axis, domain, most, is_inside };
            [1.0, -1.0].into_iter().flat_map(|sign| search.highest(sign)).collect()
        }
    }
}

/// A search for the places of a face that are farthest along an axis.
struct Search<'a, F> {
    surface: &'a Surface,
    axis: &'a Vector3<f64>,
    domain: [[f64; 2]; 2],
    /// The most places of the grid along u and along v.
    most: usize,
    is_inside: F,
}

impl<F: Fn(&[f64; 2]) -> bool> Search<'_, F> {
    fn height(&self, at: [f64; 2]) -> f64 {
        self.surface.point(at).coords.dot(self.axis)
    }

    /// Places from which no step leads higher: the best of those that the highest places of a grid lead to.
    fn highest(&self, sign: f64) -> Vec<[f64; 2]> {
        let counts = match self.surface {
            Surface::Spline(spline) => [0, 1].map(|k| (2 * spline.breaks(k).len()).clamp(GRID, self.most)),
            _ => [2 * GRID, 4 * GRID].map(|n| n.min(self.most)),
        };
        let steps = [0, 1].map(|k| (self.domain[k][1] - self.domain[k][0]) / counts[k] as f64);
        let place = |i: usize, j: usize| {
            [self.domain[0][0] + i as f64 * steps[0], self.domain[1][0] + j as f64 * steps[1]]
        };
        let value = |i: usize, j: usize| {
            let at = place(i, j);
            if (self.is_inside)(&at) { sign * self.height(at) } else { f64::NEG_INFINITY }
        };
        let values: Vec<Vec<f64>> =
            (0..=counts[0]).map(|i| (0..=counts[1]).map(|j| value(i, j)).collect()).collect();
        let is_top = |i: usize, j: usize| {
            let rows = values[i.saturating_sub(1)..].iter().take(if i == 0 { 2 } else { 3 });
            let mut around =
                rows.flat_map(|row| row[j.saturating_sub(1)..].iter().take(if j == 0 { 2 } else { 3 }));
            values[i][j].is_finite() && around.all(|other| *other <= values[i][j])
        };
        let cells = (0..=counts[0]).flat_map(|i| (0..=counts[1]).map(move |j| (i, j)));
        let mut tops: Vec<(usize, usize)> = cells.filter(|(i, j)| is_top(*i, *j)).collect();
        tops.sort_by(|a, b| values[b.0][b.1].total_cmp(&values[a.0][a.1]));
        tops.into_iter().take(MOST_TOPS).map(|(i, j)| self.climb(place(i, j), steps, sign)).collect()
    }

    /// Steps along u or v as long as they lead higher, then steps of half the size.
    fn climb(&self, start: [f64; 2], steps: [f64; 2], sign: f64) -> [f64; 2] {
        let (mut at, mut best, mut step) = (start, sign * self.height(start), steps);
        for _ in 0..HALVINGS {
            for _ in 0..4 {
                let [du, dv] = step;
                let next = [[du, 0.0], [-du, 0.0], [0.0, dv], [0.0, -dv]]
                    .map(|by| [at[0] + by[0], at[1] + by[1]])
                    .map(|at| (at, sign * self.height(at)));
                let next = next.into_iter().filter(|(at, _)| (self.is_inside)(at));
                match next.max_by(|a, b| a.1.total_cmp(&b.1)) {
                    Some((place, value)) if value > best => (at, best) = (place, value),
                    _ => break,
                }
            }
            step = step.map(|s| s / 2.0);
        }
        at
    }
}

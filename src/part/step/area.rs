//! The area of a face.
//!
//! # Method
//! Green's theorem: the area is the integral of a field along the bounds in the plane of the parameters. The
//! field is the integral of the area's density along one parameter. It has a closed form for all surfaces but
//! splines.
//!
//! # Cost
//! Some evaluations of the field for each sample of the bounds. For a spline the field costs an evaluation of
//! the surface for each 3 knot spans along v and node; an untrimmed spline is integrated span by span
//! instead.

use toolpathd_core::budget::{Budget, Stopped};

use super::gauss::{adaptive, once};
use super::model::Edge;
use super::piece::{BoundPiece, Sample, Sampler};
use super::spline_surface::{SplineSurface, newton_step};
use super::surface::Surface;
use super::trim::Trim;

/// The difference of two rules in one interval of integration, as a part of a rough area. The error of the
/// better rule is some 1000 times smaller where the surface is smooth.
const SHARE: f64 = 1e-8;

/// The same as a part of the square of the size of the face, which counts for slivers without an area.
const LEAST_SHARE: f64 = 1e-12;

/// A point of an edge is on the surface within this distance, mm. Over a fillet of 1 mm it changes areas by
/// 1e-7.
const ON_SURFACE_MM: f64 = 1e-7;

/// The step of a difference quotient, as a part of the distance of two samples. Its error is the square of
/// it, and rounding is 1e-12 of it.
const STEP: f64 = 1e-3;

/// The area within a trim, mm2.
///
/// # Errors
/// The budget has ended.
pub fn trimmed(
    sampler: &Sampler,
    trim: &Trim,
    edges: &[Edge],
    size_mm: f64,
    budget: &Budget,
) -> Result<f64, Stopped> {
    let surface = sampler.search.surface;
    let start = trim.chains[0].pieces[0].start();
    let tolerance = f64::max(SHARE * rough(surface, trim), LEAST_SHARE * size_mm * size_mm);
    let mut sum = 0.0;
    for piece in trim.chains.iter().flat_map(|chain| &chain.pieces) {
        match piece {
            BoundPiece::Straight([from, to]) => {
                let change = [to[0] - from[0], to[1] - from[1]];
                sum += adaptive(0.0, 1.0, tolerance, &mut |s| {
                    let field = field(surface, [from[0] + change[0] * s, from[1] + change[1] * s], start);
                    field[0] * change[0] + field[1] * change[1]
                });
            }
            BoundPiece::Curve { edge, samples } => {
                for pair in samples.windows(2).filter(|pair| pair[0].t != pair[1].t) {
                    budget.check()?;
                    sum += adaptive(pair[0].t, pair[1].t, tolerance, &mut |t| {
                        along(sampler, &edges[*edge], [&pair[0], &pair[1]], t, start)
                    });
                }
            }
        }
    }
    Ok(sum)
}

/// The area of the polygons in parameters with the largest density at some of their corners, mm2.
fn rough(surface: &Surface, trim: &Trim) -> f64 {
    let area: f64 = trim.chains.iter().map(|chain| chain.polygon_area()).sum();
    let places: Vec<[f64; 2]> = trim.chains.iter().flat_map(|chain| chain.polygon()).collect();
    let some = places.iter().step_by(1 + places.len() / 16);
    let density = |at: &[f64; 2]| {
        let (_, du, dv) = surface.jet(*at);
        du.cross(&dv).norm()
    };
    area.abs() * some.map(density).fold(0.0, f64::max)
}

/// The field along an edge, per unit of the edge's parameter.
fn along(sampler: &Sampler, edge: &Edge, [a, b]: [&Sample; 2], t: f64, start: [f64; 2]) -> f64 {
    let near = |t: f64| {
        let share = (t - a.t) / (b.t - a.t);
        [0, 1].map(|k| a.at[k] + (b.at[k] - a.at[k]) * share)
    };
    let at = sampler.place(edge, t, Some(near(t)));
    let (on_surface, du, dv) = sampler.search.surface.jet(at);
    let (point, speed) = edge.curve.jet(t);
    let change = if (point - on_surface).norm() <= ON_SURFACE_MM {
        newton_step(&du, &dv, &speed)
    } else {
        // Beside a curved surface the nearest point moves faster or slower than the point of the edge.
        let step = STEP * (b.t - a.t);
        let ends = [t - step, t + step].map(|t| sampler.place(edge, t, Some(near(t))));
        [0, 1].map(|k| (ends[1][k] - ends[0][k]) / (2.0 * step))
    };
    let field = field(sampler.search.surface, at, start);
    field[0] * change[0] + field[1] * change[1]
}

/// A field along u and v whose curl is the density of the area.
fn field(surface: &Surface, [u, v]: [f64; 2], start: [f64; 2]) -> [f64; 2] {
    let density = |at: [f64; 2]| {
        let (_, du, dv) = surface.jet(at);
        du.cross(&dv).norm()
    };
    match surface {
        Surface::Plane { .. } | Surface::Cylinder { .. } | Surface::Extrusion { .. } => {
            [-density([u, v]) * (v - start[1]), 0.0]
        }
        Surface::Cone { radius_mm, half_angle_rad, .. } => {
            let (slope, cos) = (half_angle_rad.tan(), half_angle_rad.cos());
            let strip = |v: f64| {
                let radius = radius_mm + v * slope;
                radius * radius.abs() / (2.0 * slope * cos)
            };
            [strip(start[1]) - strip(v), 0.0]
        }
        Surface::Sphere { radius_mm, .. } => [-radius_mm * radius_mm * (v.sin() - start[1].sin()), 0.0],
        Surface::Torus { major_radius_mm, minor_radius_mm: r, is_inner, .. } => {
            let strip = |v: f64| r * (major_radius_mm * v + r * v.sin());
            let sign = if *is_inner && r >= major_radius_mm { -1.0 } else { 1.0 };
            [sign * (strip(start[1]) - strip(v)), 0.0]
        }
        Surface::Revolution { .. } => [0.0, density([u, v]) * (u - start[0])],
        Surface::Spline(spline) => {
            let cuts = crossed(spline, 1, [start[1], v]);
            let strips = cuts.windows(2).map(|pair| once(pair[0], pair[1], &mut |s| density([u, s])));
            [-strips.sum::<f64>(), 0.0]
        }
    }
}

/// The ends of a range of a parameter with the knots between, and the middles of the spans.
fn crossed(spline: &SplineSurface, along: usize, [from, to]: [f64; 2]) -> Vec<f64> {
    let breaks = spline.breaks(along);
    let (start, length) = (breaks[0], breaks[breaks.len() - 1] - breaks[0]);
    let (low, high) = (from.min(to), from.max(to));
    let first = ((low - start) / length).floor();
    let turns = ((high - low) / length).ceil().min(4.0) as usize + 1;
    let middles = breaks.windows(2).map(|pair| (pair[0] + pair[1]) / 2.0);
    let mut all: Vec<f64> = breaks.iter().copied().chain(middles).collect();
    all.sort_by(f64::total_cmp);
    let turns = (0..turns).map(|k| (first + k as f64) * length);
    let mut cuts = vec![low];
    cuts.extend(turns.flat_map(|turn| all.iter().map(move |t| t + turn)).filter(|t| *t > low && *t < high));
    cuts.push(high);
    cuts.dedup();
    if from > to {
        cuts.reverse();
    }
    cuts
}

/// The area of a spline over a rectangle of parameters, mm2.
///
/// # Errors
/// The budget has ended.
pub fn rectangle(spline: &SplineSurface, domain: [[f64; 2]; 2], budget: &Budget) -> Result<f64, Stopped> {
    let [us, vs] = [0, 1].map(|along| crossed(spline, along, domain[along]));
    let mut cells = Vec::new();
    let mut sum = 0.0;
    for u in us.windows(2) {
        budget.check()?;
        for v in vs.windows(2) {
            let cell = [[u[0], u[1]], [v[0], v[1]]];
            let area = cell_area(spline, cell);
            sum += area;
            cells.push((cell, area));
        }
    }
    // Cells that a division changes are divided further.
    for _ in 0..6 {
        let tolerance = 1e-9 * sum / cells.len().max(1) as f64;
        let mut divided = Vec::new();
        for (cell, area) in cells {
            budget.check()?;
            let quarters = quarters(cell).map(|cell| (cell, cell_area(spline, cell)));
            let finer: f64 = quarters.iter().map(|(_, area)| area).sum();
            sum += finer - area;
            if (finer - area).abs() > tolerance {
                divided.extend(quarters);
            }
        }
        cells = divided;
    }
    Ok(sum)
}

fn quarters([u, v]: [[f64; 2]; 2]) -> [[[f64; 2]; 2]; 4] {
    let halves = |[from, to]: [f64; 2]| [[from, (from + to) / 2.0], [(from + to) / 2.0, to]];
    let ([a, b], [c, d]) = (halves(u), halves(v));
    [[a, c], [a, d], [b, c], [b, d]]
}

fn cell_area(spline: &SplineSurface, [u, v]: [[f64; 2]; 2]) -> f64 {
    once(u[0], u[1], &mut |u| {
        once(v[0], v[1], &mut |v| {
            let (_, du, dv) = spline.jet([u, v]);
            du.cross(&dv).norm()
        })
    })
}

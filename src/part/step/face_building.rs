//! Faces from their outlines: trim, area, box and B-spline.

use nalgebra::Point3;
use toolpathd_core::budget::Budget;

use super::area;
use super::curve::Curve;
use super::extent::{domain, edge_box, face_box};
use super::face_reading::FaceOutline;
use super::frame::{Frame, Placement};
use super::model::{Edge, Face, Loop};
use super::nurbs_form;
use super::parameter_search::ParameterSearch;
use super::piece::{BoundPiece, Sampler};
use super::refusal::Refusal;
use super::surface::Surface;
use super::trim::{Trim, Untrimmed};

/// An edge may leave the surface by this much, mm, and this part of the size of the face.
const EDGE_MISS_MM: f64 = 0.1;
const EDGE_MISS_SHARE: f64 = 1e-3;

/// A trim this near to the sides of the rectangle of parameters is the whole rectangle, mm.
const WHOLE_MM: f64 = 1e-6;

/// Two sides of a polygon are one side if the sine of the angle between them is less.
const STRAIGHT: f64 = 1e-9;

/// The face of an outline, with its place among the bodies left open.
///
/// # Errors
/// The outline bounds no face, or the budget has ended.
pub fn face(outline: FaceOutline, budget: &Budget) -> Result<Face, Refusal> {
    let FaceOutline { entity, name, surface, is_reversed, loops } = outline;
    let refuse = |reason: &str| Refusal::shape("ADVANCED_FACE", reason, entity);
    budget.check()?;
    let directed: Vec<Vec<Edge>> = loops.iter().map(|one| directed(one, is_reversed)).collect();
    let edges: Vec<Edge> = directed.concat();
    let size_mm = size(&surface, &edges);
    if !(size_mm > 0.0 && size_mm.is_finite()) {
        return Err(refuse("it has no size"));
    }
    let search = ParameterSearch::new(&surface);
    let sampler = Sampler::new(&search, 0.0);
    let slices: Vec<&[Edge]> = directed.iter().map(Vec::as_slice).collect();
    let trim = Trim::of(&search, &slices, size_mm, budget).map_err(|untrimmed| match untrimmed {
        Untrimmed::Unbounded(reason) => refuse(reason),
        Untrimmed::Stopped(stopped) => stopped.into(),
    })?;
    let edge_deviation_mm = edge_deviation(&search, &trim, &edges);
    if edge_deviation_mm.is_nan() || edge_deviation_mm > EDGE_MISS_MM + EDGE_MISS_SHARE * size_mm {
        return Err(refuse("its edges are not on its surface"));
    }
    let covered = domain(&sampler, &trim, &edges);
    if covered.iter().any(|[from, to]| from.is_nan() || from >= to) {
        return Err(refuse("its bounds enclose nothing"));
    }
    let domain = match &surface {
        Surface::Spline(spline) => nurbs_form::snapped(spline, covered),
        _ => covered,
    };
    let corners = match &surface {
        Surface::Plane { frame } => four_corners(&directed, frame),
        _ => None,
    };
    let is_whole = is_whole(&surface, &trim, covered, domain);
    let area_mm2 = match &surface {
        Surface::Spline(spline) if is_whole => area::rectangle(spline, domain, budget)?,
        _ => area::trimmed(&sampler, &trim, &edges, size_mm, budget)?,
    };
    if !(area_mm2 > 0.0 && area_mm2.is_finite()) {
        return Err(refuse("its bounds enclose no area"));
    }
    let nurbs = match corners {
        Some(corners) => nurbs_form::patch(corners),
        None => nurbs_form::nurbs(&surface, domain),
    };
    if !nurbs.control_points.iter().flatten().all(|point| point.iter().all(|x| x.is_finite())) {
        return Err(refuse("its numbers are too large"));
    }
    let polygons = trim.chains.iter().map(|chain| chain.polygon()).collect();
    Ok(Face {
        entity,
        name,
        body: 0,
        is_reversed,
        loops,
        trim: polygons,
        domain: covered,
        nurbs,
        is_untrimmed: is_whole || corners.is_some(),
        area_mm2,
        bounds_mm: [Point3::origin(); 2],
        edge_deviation_mm,
        surface,
    })
}

/// A copy of a face at a place, with its box.
pub fn placed(face: &Face, by: &Placement, body: usize) -> Face {
    let mut copy = face.clone();
    copy.body = body;
    if *by != Placement::identity() {
        copy.surface = face.surface.placed(by);
        copy.is_reversed ^= by.is_mirror();
        for edge in copy.loops.iter_mut().flat_map(|one| &mut one.edges) {
            edge.curve = edge.curve.placed(by);
        }
        copy.nurbs.control_points.iter_mut().flatten().for_each(|point| *point = by.point(point));
    }
    let edges: Vec<&Edge> = copy.loops.iter().flat_map(|one| &one.edges).collect();
    copy.bounds_mm = face_box(&copy.surface, &edges, &copy.trim, copy.domain);
    copy
}

/// The edges of a loop as they go round the normal of the surface.
fn directed(one: &Loop, is_reversed: bool) -> Vec<Edge> {
    let mut edges = one.edges.clone();
    if is_reversed {
        edges.reverse();
        edges.iter_mut().for_each(|edge| std::mem::swap(&mut edge.from, &mut edge.to));
    }
    edges
}

/// The diagonal of the box of the edges; of a surface without edges, of some of its points. mm.
fn size(surface: &Surface, edges: &[Edge]) -> f64 {
    let edges: Vec<&Edge> = edges.iter().collect();
    if let Some([low, high]) = edge_box(&edges).filter(|[low, high]| low != high) {
        return (high - low).norm();
    }
    let Some([us, vs]) = surface.closed_domain() else { return 0.0 };
    let place = |[from, to]: [f64; 2], k: usize| from + (to - from) * k as f64 / 4.0;
    let point = |k: usize| surface.point([place(us, k / 5), place(vs, k % 5)]);
    let first = point(0);
    (1..25).map(|k| (point(k) - first).norm()).fold(0.0, f64::max)
}

/// The largest distance of the samples of edges from the surface, mm.
fn edge_deviation(search: &ParameterSearch, trim: &Trim, edges: &[Edge]) -> f64 {
    let mut largest = 0.0_f64;
    for piece in trim.chains.iter().flat_map(|chain| &chain.pieces) {
        if let BoundPiece::Curve { edge, samples } = piece {
            for sample in samples {
                let miss = search.miss(&edges[*edge].curve.point(sample.t), sample.at);
                if miss.is_nan() {
                    return miss;
                }
                largest = largest.max(miss);
            }
        }
    }
    largest
}

/// Whether the trim is the whole rectangle that it covers, and `domain` is as wide.
fn is_whole(surface: &Surface, trim: &Trim, covered: [[f64; 2]; 2], domain: [[f64; 2]; 2]) -> bool {
    let [chain] = trim.chains.as_slice() else { return false };
    let is_near = |at: [f64; 2]| {
        let (_, du, dv) = surface.jet(at);
        let lengths = [du.norm(), dv.norm()];
        let gap = |k: usize| (at[k] - covered[k][0]).abs().min((at[k] - covered[k][1]).abs()) * lengths[k];
        let wider = |k: usize| {
            let widths = [covered, domain].map(|ranges| ranges[k][1] - ranges[k][0]);
            (widths[0] - widths[1]).abs() * lengths[k]
        };
        gap(0).min(gap(1)) <= WHOLE_MM && wider(0).max(wider(1)) <= WHOLE_MM
    };
    let whole = (covered[0][1] - covered[0][0]) * (covered[1][1] - covered[1][0]);
    let places = chain.polygon();
    places.iter().all(|at| is_near(*at)) && (chain.polygon_area() / whole - 1.0).abs() < 1e-6
}

/// The corners of a plane face with four straight sides and no corner inwards.
fn four_corners(loops: &[Vec<Edge>], frame: &Frame) -> Option<[Point3<f64>; 4]> {
    let [edges] = loops else { return None };
    let is_straight = edges.iter().all(|edge| matches!(edge.curve, Curve::Line { .. }));
    if !is_straight || edges.len() > 64 {
        return None;
    }
    let n = edges.len();
    let along: Vec<_> = edges.iter().map(|edge| (edge.end() - edge.start()).normalize()).collect();
    let turn = |k: usize| along[(k + n - 1) % n].cross(&along[k]).dot(&frame.z);
    let turns: Vec<(usize, f64)> =
        (0..n).map(|k| (k, turn(k))).filter(|(_, sine)| sine.abs() > STRAIGHT).collect();
    let left = turns.iter().all(|(_, sine)| *sine > 0.0);
    let right = turns.iter().all(|(_, sine)| *sine < 0.0);
    // Vertices may be a little off the plane.
    let on_plane = |point: Point3<f64>| point - frame.z * frame.local(&point).z;
    let mut corners: Vec<Point3<f64>> = turns.iter().map(|(k, _)| on_plane(edges[*k].start())).collect();
    if right {
        corners.reverse();
    }
    if left || right { corners.try_into().ok() } else { None }
}

//! The strips between the sides of a face's polygons and its edges.
//!
//! # Method
//! A side stands for a part of an edge. Three things lie near each other: the part of the edge, the chord of
//! its ends, and the line of the surface below the chord. With the chord within `a` of the curve and within
//! `b` of the surface, and the edge within `g` of the surface, the bound of the face and the bound of the
//! triangles are within `a + b + 2 g`. Between them the surface leaves the straight line by its second-order
//! part over the strip.
//!
//! Circles and lines along one parameter of a round surface are that line of the surface: they have no strip.

use super::edges::Edges;
use super::polygons::{Corner, Polygons, Side};
use super::surface_bounds::{Rectangle, rectangle};
use super::trimmed_face::{TrimmedFace, place};
use crate::step::curve::Curve;
use crate::step::parameter_search::ParameterSearch;
use crate::step::piece::{BoundPiece, Sample, Sampler};
use crate::step::surface::Surface;

/// Parts of the allowed deviation: of strips, and of chords from the surface.
pub const STRIP_SHARE: f64 = 0.4;
const CHORD_SHARE: f64 = 0.25;

/// A side of this part of the allowed deviation is not divided.
const SHORTEST_SHARE: f64 = 1e-3;

/// A parameter that changes by less, as a part of a radian or mm, is constant.
const CONSTANT: f64 = 1e-9;

/// Places between the ends of a side where its strip is measured.
const PLACES: usize = 3;

/// What the sides of a face ask for.
#[derive(Debug, Clone, Default)]
pub struct Strips {
    /// Records with parameters where they are to be divided.
    pub wanted: Vec<(usize, f64)>,
    /// The widest strip apart from gaps, mm.
    pub width_mm: f64,
    /// The largest distance of an edge from the surface at the places, mm.
    pub gap_mm: f64,
}

/// Looks at all sides of a face.
pub fn strips(face: &TrimmedFace, polygons: &Polygons, all: &Edges, chord_mm: f64) -> Strips {
    let mut strips = Strips::default();
    let search = ParameterSearch::new(face.bounds.surface);
    let sampler = Sampler::new(&search, 0.0);
    let mut pieces: Vec<Vec<&[Sample]>> = vec![Vec::new(); face.edges.len()];
    for piece in face.trim.chains.iter().flat_map(|chain| &chain.pieces) {
        if let BoundPiece::Curve { edge, samples } = piece {
            pieces[*edge].push(samples);
        }
    }
    for corners in &polygons.loops {
        for (k, corner) in corners.iter().enumerate() {
            let next = &corners[(k + 1) % corners.len()];
            strips.gap_mm = strips.gap_mm.max(gap(face, polygons, all, corner));
            let Side::Edge { edge, t } = corner.side else { continue };
            let Some(samples) = pieces[edge].iter().find(|samples| covers(samples, t)) else { continue };
            strips.look_at(face, &sampler, all, samples, [corner, next], chord_mm);
        }
    }
    strips
}

impl Strips {
    fn look_at(
        &mut self,
        face: &TrimmedFace,
        sampler: &Sampler,
        all: &Edges,
        samples: &[Sample],
        [corner, next]: [&Corner; 2],
        chord_mm: f64,
    ) {
        let Side::Edge { edge, t } = corner.side else { return };
        let surface = face.bounds.surface;
        let one = &face.edges[edge];
        let used = face.uses[edge];
        let record = &all.records[used.record];
        let inner = |k: usize| t[0] + (t[1] - t[0]) * (k + 1) as f64 / (PLACES + 1) as f64;
        let places: Vec<[f64; 2]> = (0..PLACES).map(|k| place(sampler, one, samples, inner(k))).collect();
        let ends = [corner.at, end_place(sampler, corner.at, next.at, &places)];
        let of_curve = record.deviation(t.map(|t| record.turned(t, used.is_turned)));
        let points = ends.map(|at| surface.point(at));
        let of_surface = face.bounds.of_chord(ends, points);
        let gaps =
            places.iter().enumerate().map(|(k, at)| (one.curve.point(inner(k)) - surface.point(*at)).norm());
        self.gap_mm = gaps.fold(self.gap_mm, f64::max);
        let is_line = is_along_parameter(surface, &one.curve, &ends, &places);
        let width = if is_line { 0.0 } else { of_curve + of_surface + second_order(face, ends, &places) };
        let is_too_wide = width > STRIP_SHARE * chord_mm
            || of_curve > STRIP_SHARE * chord_mm
            || of_surface > if is_line { STRIP_SHARE } else { CHORD_SHARE } * chord_mm;
        let length = (one.curve.point(t[1]) - one.curve.point(t[0])).norm();
        let middle = (one.curve.point((t[0] + t[1]) / 2.0) - one.curve.point(t[0])).norm();
        if is_too_wide && length.max(middle) > SHORTEST_SHARE * chord_mm {
            self.wanted.push((used.record, record.turned((t[0] + t[1]) / 2.0, used.is_turned)));
        }
        self.width_mm = self.width_mm.max(width);
    }
}

/// Whether the samples of a piece go over a range of the edge's parameter.
fn covers(samples: &[Sample], t: [f64; 2]) -> bool {
    let ends = [samples[0].t, samples[samples.len() - 1].t];
    let (low, high) = (ends[0].min(ends[1]), ends[0].max(ends[1]));
    t.iter().all(|t| (low..=high).contains(t))
}

/// The end of a side in the turn of the places before it.
fn end_place(sampler: &Sampler, start: [f64; 2], end: [f64; 2], places: &[[f64; 2]]) -> [f64; 2] {
    let last = places.last().copied().unwrap_or(start);
    [0, 1].map(|k| crate::step::piece::lift(end[k], last[k], sampler.periods[k]))
}

/// The distance of the vertex of a corner from the surface's point, mm.
fn gap(face: &TrimmedFace, polygons: &Polygons, all: &Edges, corner: &Corner) -> f64 {
    let vertex = polygons.point(corner.node, all);
    (vertex - face.bounds.surface.point(corner.at)).norm()
}

/// The second-order part of the surface between a side and the places of its edge, mm. The strip is as wide
/// as twice the most that a place is beside the side.
fn second_order(face: &TrimmedFace, ends: [[f64; 2]; 2], places: &[[f64; 2]]) -> f64 {
    let mut widths = [0.0_f64; 2];
    for (k, at) in places.iter().enumerate() {
        let share = (k + 1) as f64 / (PLACES + 1) as f64;
        for i in 0..2 {
            let beside = at[i] - (ends[0][i] + (ends[1][i] - ends[0][i]) * share);
            widths[i] = widths[i].max(2.0 * beside.abs());
        }
    }
    let all: Vec<[f64; 2]> = ends.iter().chain(places).copied().collect();
    let ranges: Rectangle = rectangle(&all);
    face.bounds.of_step([0, 1].map(|k| [ranges[k][0] - widths[k], ranges[k][1] + widths[k]]), widths)
}

/// Whether an edge is a line of one parameter of a round surface. Three places of a circle or two of a line
/// that have one parameter make all of it have this parameter.
fn is_along_parameter(surface: &Surface, curve: &Curve, ends: &[[f64; 2]; 2], places: &[[f64; 2]]) -> bool {
    let is_even = |k: usize| places.iter().chain(&ends[1..]).all(|at| (at[k] - ends[0][k]).abs() <= CONSTANT);
    match (surface, curve) {
        (Surface::Cylinder { .. } | Surface::Cone { .. }, Curve::Circle { .. }) => is_even(1),
        (Surface::Torus { .. }, Curve::Circle { .. }) => is_even(0) || is_even(1),
        (Surface::Revolution { .. }, Curve::Circle { .. }) => is_even(1),
        (Surface::Cylinder { .. } | Surface::Cone { .. } | Surface::Extrusion { .. }, Curve::Line { .. }) => {
            is_even(0)
        }
        (Surface::Plane { .. }, Curve::Line { .. }) => true,
        _ => false,
    }
}

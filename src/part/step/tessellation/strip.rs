//! The strips between the sides of a face's polygons and its edges.
//!
//! # Method
//! A side stands for a part of an edge. Three things lie near each other: the part of the edge, the chord of
//! its ends, and the line of the surface below the chord. With the chord within `a` of the curve and within
//! `b` of the surface, and the edge within `g` of the surface, the bound of the face and the bound of the
//! triangles are within `a + b + 2 g`. Between them the surface leaves the straight line by its second-order
//! part over the strip, whose width in the parameters follows from bounds of the derivatives.
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

/// A derivative below this part of the one beside it is that of a pole.
const AT_POLE: f64 = 1e-6;

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
            let Side::Edge { edge, t, .. } = corner.side else { continue };
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
        let Side::Edge { edge, t, .. } = corner.side else { return };
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
        let off = |t: f64, at: &[f64; 2]| (one.curve.point(t) - surface.point(*at)).norm();
        let inner_gaps = places.iter().enumerate().map(|(k, at)| off(inner(k), at));
        let gap_mm = inner_gaps.fold(off(t[0], &ends[0]).max(off(t[1], &ends[1])), f64::max);
        self.gap_mm = self.gap_mm.max(gap_mm);
        let is_line = is_along_parameter(surface, &one.curve, &ends, &places);
        // Only what a division makes smaller is a reason for it: the gap is not.
        let wish = if is_line { Beside::Proved(0.0) } else { beside(face, ends, &places, [of_curve, 0.0]) };
        let (width, wider) = if is_line {
            (0.0, 0.0)
        } else {
            let straight = of_curve + of_surface;
            let with_gap = beside(face, ends, &places, [of_curve, gap_mm]);
            (straight + wish.bent_mm(), straight + with_gap.bent_mm())
        };
        let length = f64::max(
            (one.curve.point(t[1]) - one.curve.point(t[0])).norm(),
            (one.curve.point((t[0] + t[1]) / 2.0) - one.curve.point(t[0])).norm(),
        );
        let is_too_wide = width > STRIP_SHARE * chord_mm
            || of_curve > STRIP_SHARE * chord_mm
            || of_surface > if is_line { STRIP_SHARE } else { CHORD_SHARE } * chord_mm;
        let is_unknown = matches!(wish, Beside::Unknown(_)) && length > chord_mm;
        if is_unknown || is_too_wide && length > SHORTEST_SHARE * chord_mm {
            self.wanted.push((used.record, record.turned((t[0] + t[1]) / 2.0, used.is_turned)));
        }
        self.width_mm = self.width_mm.max(width).max(wider);
    }
}

/// How far a surface leaves the straight line across a strip, mm.
enum Beside {
    Proved(f64),
    /// At a pole, where the parameters are not bounded: twice the width at places of the edge counts.
    Measured(f64),
    /// The side is too long for a proof.
    Unknown(f64),
}

impl Beside {
    fn bent_mm(&self) -> f64 {
        let (Self::Proved(bent) | Self::Measured(bent) | Self::Unknown(bent)) = self;
        *bent
    }
}

/// How far the surface leaves the straight line across the strip of a side, mm.
///
/// The bound of the face and that of the triangles are both within `distance` of the points of the side's
/// parameters. From this the width of the strip in the parameters follows.
fn beside(
    face: &TrimmedFace,
    ends: [[f64; 2]; 2],
    places: &[[f64; 2]],
    [of_curve, gap_mm]: [f64; 2],
) -> Beside {
    let bounds = &face.bounds;
    let ranges = rectangle(&ends);
    let of_parameters = bounds.of_step(ranges, ranges.map(|[low, high]| high - low));
    let distance = of_parameters + of_curve.max(of_parameters) + 2.0 * gap_mm;
    if let Some(widths) = bounds.widths(ranges, distance) {
        let wider = [0, 1].map(|k| [ranges[k][0] - widths[k], ranges[k][1] + widths[k]]);
        return Beside::Proved(bounds.of_step(wider, widths.map(|width| 2.0 * width)));
    }
    let speeds = |at: [f64; 2]| {
        let (_, along_u, along_v) = bounds.surface.jet(at);
        [along_u.norm(), along_v.norm()]
    };
    let middle = speeds(places[PLACES / 2]);
    let is_at_pole =
        ends.iter().any(|at| speeds(*at).iter().zip(middle).any(|(end, middle)| *end <= AT_POLE * middle));
    let measured = measured(face, ends, places);
    if is_at_pole { Beside::Measured(measured) } else { Beside::Unknown(measured) }
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

/// How far the surface leaves the straight line across a strip, mm. The strip is twice as wide as the places
/// of the edge are beside the side.
fn measured(face: &TrimmedFace, ends: [[f64; 2]; 2], places: &[[f64; 2]]) -> f64 {
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

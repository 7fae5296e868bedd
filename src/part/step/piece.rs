//! Pieces of bounds in the plane of the parameters of a surface.
//!
//! # Method
//! 1. An edge is cut where it passes a pole of the surface, because its parameters jump there.
//! 2. Each part is sampled from its start on, so finely that the parameters between two samples are nearly
//!    linear. On a closed surface each sample is taken to the turn nearest to the sample before it.

use nalgebra::Point3;

use super::curve::Curve;
use super::model::Edge;
use super::parameter_search::ParameterSearch;
use super::surface::{PolarSide, Surface};

/// A curve passes a pole if it comes this near to it, mm.
const AT_POLE_MM: f64 = 1e-5;

/// The parameters at a pole are those of a point this part of the piece away from it.
const BESIDE_POLE: f64 = 1e-6;

/// Halvings of a span between two samples.
const DEEPEST: usize = 9;

/// A part of a bound. The parameters are continuous.
#[derive(Debug, Clone, PartialEq)]
pub enum BoundPiece {
    /// Part of an edge: pairs of the edge's parameter and the surface's parameters, at least 2.
    Curve { edge: usize, samples: Vec<Sample> },
    /// A straight line in the plane of the parameters: a seam, or a pole.
    Straight([[f64; 2]; 2]),
}

/// A place on an edge with its parameters on the surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    pub t: f64,
    pub at: [f64; 2],
}

/// A piece with the poles at its start and its end.
pub struct Part {
    pub piece: BoundPiece,
    pub poles: [Option<PolarSide>; 2],
}

impl BoundPiece {
    pub fn start(&self) -> [f64; 2] {
        match self {
            Self::Curve { samples, .. } => samples[0].at,
            Self::Straight([start, _]) => *start,
        }
    }

    pub fn end(&self) -> [f64; 2] {
        match self {
            Self::Curve { samples, .. } => samples[samples.len() - 1].at,
            Self::Straight([_, end]) => *end,
        }
    }

    /// The places of all samples in the plane of the parameters.
    pub fn places(&self) -> Vec<[f64; 2]> {
        match self {
            Self::Curve { samples, .. } => samples.iter().map(|sample| sample.at).collect(),
            Self::Straight(ends) => ends.to_vec(),
        }
    }

    pub fn shift(&mut self, by: [f64; 2]) {
        let moved = |at: [f64; 2]| [at[0] + by[0], at[1] + by[1]];
        match self {
            Self::Curve { samples, .. } => samples.iter_mut().for_each(|sample| sample.at = moved(sample.at)),
            Self::Straight(ends) => *ends = ends.map(moved),
        }
    }

    pub fn reverse(&mut self) {
        match self {
            Self::Curve { samples, .. } => samples.reverse(),
            Self::Straight(ends) => ends.reverse(),
        }
    }
}

/// `value` by whole periods as near to `near` as possible.
pub fn lift(value: f64, near: f64, period: Option<f64>) -> f64 {
    period.map_or(value, |period| value + ((near - value) / period).round() * period)
}

/// Samples the edges of one face.
pub struct Sampler<'a> {
    pub search: &'a ParameterSearch<'a>,
    pub poles: Vec<PolarSide>,
    pub periods: [Option<f64>; 2],
    /// The polygon of samples may leave the edge by this much, mm.
    pub tolerance_mm: f64,
}

impl<'a> Sampler<'a> {
    pub fn new(search: &'a ParameterSearch<'a>, tolerance_mm: f64) -> Self {
        let surface: &Surface = search.surface;
        Self { search, poles: surface.poles(), periods: surface.periods(), tolerance_mm }
    }

    /// The parts of an edge in its direction. None for an edge that is all at a pole.
    pub fn parts(&self, edge: &Edge, number: usize, mut near: Option<[f64; 2]>) -> Vec<Part> {
        let mut parts = Vec::new();
        for pair in self.cuts(edge).windows(2) {
            let (range, poles) = ([pair[0].0, pair[1].0], [pair[0].1, pair[1].1]);
            let middle = edge.curve.point((range[0] + range[1]) / 2.0);
            if poles.iter().all(Option::is_some) && self.pole_at(&middle).is_some() {
                continue;
            }
            let samples = self.samples(edge, range, poles, near);
            near = samples.last().map(|sample| sample.at);
            parts.push(Part { piece: BoundPiece::Curve { edge: number, samples }, poles });
        }
        parts
    }

    fn pole_at(&self, point: &Point3<f64>) -> Option<PolarSide> {
        self.poles.iter().copied().find(|pole| (pole.point - point).norm() <= AT_POLE_MM)
    }

    /// The ends of an edge, and the places between where it passes a pole.
    fn cuts(&self, edge: &Edge) -> Vec<(f64, Option<PolarSide>)> {
        let [from, to] = [edge.from, edge.to];
        let mut cuts = vec![from];
        for pole in &self.poles {
            let distance = |t: f64| (edge.curve.point(t) - pole.point).norm();
            let places = spread(edge);
            for three in places.windows(3) {
                if distance(three[1]) <= distance(three[0]) && distance(three[1]) <= distance(three[2]) {
                    let t = lowest(&distance, three[0], three[2]);
                    let is_inner = (t - from).abs().min((t - to).abs()) > 1e-6 * (to - from).abs();
                    if is_inner && distance(t) <= AT_POLE_MM {
                        cuts.push(t);
                    }
                }
            }
        }
        cuts.push(to);
        cuts.sort_by(|a, b| if from <= to { a.total_cmp(b) } else { b.total_cmp(a) });
        cuts.into_iter().map(|t| (t, self.pole_at(&edge.curve.point(t)))).collect()
    }

    fn samples(
        &self,
        edge: &Edge,
        [from, to]: [f64; 2],
        poles: [Option<PolarSide>; 2],
        near: Option<[f64; 2]>,
    ) -> Vec<Sample> {
        let beside = BESIDE_POLE * (to - from);
        let (mut places, ends) = (spread(edge), [from.min(to), from.max(to)]);
        places.retain(|t| *t > ends[0] && *t < ends[1]);
        // At a pole the sample is taken beside it, and moved to the pole afterwards.
        let first = if poles[0].is_some() { from + beside } else { from };
        let last = if poles[1].is_some() { to - beside } else { to };
        // Near a pole a search finds any parameters: one that begins at the pole begins farther inside.
        let inside = places.first().filter(|_| poles[0].is_some()).map(|t| {
            let free = self.search.of(&edge.curve.point(*t), None);
            near.map_or(free, |near| [0, 1].map(|k| lift(free[k], near[k], self.periods[k])))
        });
        let mut samples = vec![Sample { t: first, at: self.place(edge, first, inside.or(near)) }];
        for t in places.into_iter().chain([last]) {
            let before = samples[samples.len() - 1];
            let after = Sample { t, at: self.place(edge, t, Some(before.at)) };
            self.refine(edge, [before, after], 0, &mut samples);
        }
        let n = samples.len();
        for (k, end) in [(0, from), (n - 1, to)] {
            if let Some(pole) = poles[usize::from(k > 0)] {
                samples[k].t = end;
                let value = &mut samples[k].at[pole.along];
                *value = lift(pole.at, *value, self.periods[pole.along]);
            }
        }
        samples
    }

    /// The parameters of a point of an edge, by whole periods nearest to `near`.
    pub fn place(&self, edge: &Edge, t: f64, near: Option<[f64; 2]>) -> [f64; 2] {
        let at = self.search.of(&edge.curve.point(t), near);
        near.map_or(at, |near| [0, 1].map(|k| lift(at[k], near[k], self.periods[k])))
    }

    /// Appends samples up to the later of two, and more between where the parameters are not nearly linear.
    fn refine(&self, edge: &Edge, [a, b]: [Sample; 2], depth: usize, samples: &mut Vec<Sample>) {
        let t = (a.t + b.t) / 2.0;
        let middle = Sample { t, at: self.place(edge, t, Some(a.at)) };
        let jumps = |k: usize, [a, b]: [&Sample; 2]| {
            self.periods[k].is_some_and(|period| (b.at[k] - a.at[k]).abs() > period / 5.0)
        };
        let is_far = |k| jumps(k, [&a, &middle]) || jumps(k, [&middle, &b]);
        let between = [0, 1].map(|k| (a.at[k] + b.at[k]) / 2.0);
        let bent = (self.search.surface.point(between) - self.search.surface.point(middle.at)).norm();
        if depth < DEEPEST && (is_far(0) || is_far(1) || bent > self.tolerance_mm) {
            self.refine(edge, [a, middle], depth + 1, samples);
            // The end is taken to the turn nearest to what is now before it.
            let before = samples[samples.len() - 1];
            let end = [0, 1].map(|k| lift(b.at[k], before.at[k], self.periods[k]));
            self.refine(edge, [before, Sample { t: b.t, at: end }], depth + 1, samples);
        } else {
            samples.push(b);
        }
    }
}

/// Parameters on an edge in its direction, several between each two of its breaks, with both ends.
pub fn spread(edge: &Edge) -> Vec<f64> {
    let [from, to] = [edge.from, edge.to];
    let breaks = edge.curve.breaks([from.min(to), from.max(to)]);
    let n = if matches!(edge.curve, Curve::Polyline(_)) { 1 } else { 4 };
    let inner = breaks
        .windows(2)
        .flat_map(|pair| (0..n).map(move |k| pair[0] + (pair[1] - pair[0]) * f64::from(k) / f64::from(n)));
    let mut places: Vec<f64> = inner.chain([from.max(to)]).collect();
    if from > to {
        places.reverse();
    }
    places
}

/// The place of the lowest value between two places, by thirds.
fn lowest(value: &impl Fn(f64) -> f64, mut low: f64, mut high: f64) -> f64 {
    for _ in 0..100 {
        let (a, b) = (low + (high - low) / 3.0, high - (high - low) / 3.0);
        if value(a) <= value(b) {
            high = b;
        } else {
            low = a;
        }
    }
    (low + high) / 2.0
}

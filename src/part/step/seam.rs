//! Where loops that go round a closed surface are cut, so that a seam joins them.
//!
//! # Method
//! The seam is a line of one parameter that passes no hole. Of the places where the loops cross the line, two
//! with the face between them and no other place are the ends of the seam.

use super::chain::Chain;
use super::model::Edge;
use super::piece::{BoundPiece, Sample, Sampler};

/// Bisections for the place where an edge crosses the seam.
const BISECTIONS: usize = 60;

/// A place on the other side of a closed surface is less than a period away by this part of it.
const NO_GAP: f64 = 1e-7;

/// What the search for a seam needs to know of a face.
pub struct Seam<'a> {
    pub sampler: &'a Sampler<'a>,
    /// The edges of all loops.
    pub edges: Vec<&'a Edge>,
    /// The ranges of u and v of loops that do not go round.
    pub holes: Vec<[[f64; 2]; 2]>,
}

/// A place where a loop crosses a line.
#[derive(Debug, Clone, Copy)]
struct Crossing {
    piece: usize,
    /// The sample before the crossing.
    before: usize,
    sample: Sample,
    is_growing: bool,
}

impl Seam<'_> {
    /// Begins a loop that goes round once at its crossing with the seam that is nearest to a pole.
    pub fn begin_towards(&self, chain: &mut Chain, along: usize, pole: f64) {
        let crossings = self.crossings(chain, along, self.line(chain, along));
        let is_growing = chain.turns[along] > 0;
        let gap = |crossing: &Crossing| (crossing.sample.at[1 - along] - pole).abs();
        let fitting = crossings.into_iter().filter(|crossing| crossing.is_growing == is_growing);
        if let Some(crossing) = fitting.min_by(|a, b| gap(a).total_cmp(&gap(b))) {
            self.begin_at(chain, crossing, along);
        }
    }

    /// Begins two loops, of which the first goes round upwards and the second downwards, at the ends of a
    /// seam.
    pub fn begin_beside(&self, a: &mut Chain, b: &mut Chain, along: usize) {
        let line = self.line(a, along);
        let (of_a, of_b) = (self.crossings(a, along, line), self.crossings(b, along, line));
        let gap = |a: &Crossing, b: &Crossing| {
            let gap = b.sample.at[1 - along] - a.sample.at[1 - along];
            // To the left of growing u is higher v; to the left of growing v is lower u.
            let gap = if along == 0 { gap } else { -gap };
            match self.sampler.periods[1 - along] {
                Some(period) => (gap - NO_GAP * period).rem_euclid(period) + NO_GAP * period,
                None => gap,
            }
        };
        let starts = of_a.iter().filter(|crossing| crossing.is_growing);
        let pairs = starts.flat_map(|a| of_b.iter().filter(|b| !b.is_growing).map(move |b| (a, b)));
        let fitting = pairs.filter(|(a, b)| gap(a, b) > 0.0);
        if let Some((start, end)) = fitting.min_by(|x, y| gap(x.0, x.1).total_cmp(&gap(y.0, y.1))) {
            self.begin_at(a, *start, along);
            self.begin_at(b, *end, along);
        }
    }

    /// The value of a parameter at the seam: between two samples of the loop, where no hole is beside.
    /// Samples themselves are avoided, because loops often begin at the same value but for rounding.
    fn line(&self, chain: &Chain, along: usize) -> f64 {
        let period = self.sampler.periods[along].unwrap_or(f64::MAX);
        let is_free = |value: &f64| {
            self.holes.iter().all(|hole| {
                let [from, to] = hole[along];
                (value - from).rem_euclid(period) > to - from
            })
        };
        let places = chain.polygon();
        let middles = || places.windows(2).map(|pair| (pair[0][along] + pair[1][along]) / 2.0);
        middles().find(is_free).or_else(|| middles().next()).unwrap_or_default()
    }

    /// The places where a loop crosses a line, in any turn.
    fn crossings(&self, chain: &Chain, along: usize, line: f64) -> Vec<Crossing> {
        let Some(period) = self.sampler.periods[along] else { return Vec::new() };
        let mut found = Vec::new();
        for (piece, of) in chain.pieces.iter().enumerate() {
            let BoundPiece::Curve { edge, samples } = of else { continue };
            for (before, pair) in samples.windows(2).enumerate() {
                let [from, to] = [pair[0].at[along], pair[1].at[along]];
                let target = line + ((from.max(to) - line) / period).floor() * period;
                // Of the two ends, the lower one counts. Rounding may put the target outside.
                if !(from.min(to)..from.max(to)).contains(&target) {
                    continue;
                }
                let is_growing = from < to;
                let sample = self.bisect(self.edges[*edge], [pair[0], pair[1]], along, target);
                found.push(Crossing { piece, before, sample, is_growing });
            }
        }
        found
    }

    /// The place between two samples where a parameter has a value.
    fn bisect(&self, edge: &Edge, [a, b]: [Sample; 2], along: usize, target: f64) -> Sample {
        for end in [a, b] {
            if end.at[along] == target {
                return end;
            }
        }
        let (mut low, mut high) = (a, b);
        for _ in 0..BISECTIONS {
            let t = (low.t + high.t) / 2.0;
            let middle = Sample { t, at: self.sampler.place(edge, t, Some(low.at)) };
            if (middle.at[along] < target) == (a.at[along] < target) {
                low = middle;
            } else {
                high = middle;
            }
        }
        let mut found = low;
        found.at[along] = target;
        found
    }

    /// Begins a loop at a crossing. What lay before it follows after a whole turn.
    fn begin_at(&self, chain: &mut Chain, crossing: Crossing, along: usize) {
        let BoundPiece::Curve { edge, samples } = chain.pieces[crossing.piece].clone() else { return };
        let mut first = samples[..=crossing.before].to_vec();
        let mut second = samples[crossing.before + 1..].to_vec();
        if first[first.len() - 1].t != crossing.sample.t {
            first.push(crossing.sample);
        }
        if second[0].t != crossing.sample.t {
            second.insert(0, crossing.sample);
        }
        let curve = |samples: Vec<Sample>| (samples.len() > 1).then_some(BoundPiece::Curve { edge, samples });
        let behind = chain.pieces[crossing.piece + 1..].to_vec();
        let mut before = chain.pieces[..crossing.piece].to_vec();
        before.extend(curve(first));
        let mut shift = [0.0; 2];
        shift[along] = f64::from(chain.turns[along]) * self.sampler.periods[along].unwrap_or(0.0);
        before.iter_mut().for_each(|piece| piece.shift(shift));
        chain.pieces = curve(second).into_iter().chain(behind).chain(before).collect();
    }
}

//! A face with its trim, ready to be divided.

use super::edges::{Edges, Use};
use super::surface_bounds::SurfaceBounds;
use crate::step::model::Edge;
use crate::step::piece::{BoundPiece, Sample, Sampler};
use crate::step::trim::Trim;

/// A face with its trim, ready to be divided.
pub struct TrimmedFace<'a> {
    pub bounds: SurfaceBounds<'a>,
    pub trim: Trim,
    /// The edges that the pieces of the trim name.
    pub edges: Vec<Edge>,
    pub uses: Vec<Use>,
}

impl TrimmedFace<'_> {
    /// The parameters of the edges where their pieces end within them, as (record, parameter).
    pub fn cuts(&self, all: &Edges) -> Vec<(usize, f64)> {
        let mut cuts = Vec::new();
        for piece in self.trim.chains.iter().flat_map(|chain| &chain.pieces) {
            let BoundPiece::Curve { edge, samples } = piece else { continue };
            let at = self.uses[*edge];
            for sample in [&samples[0], &samples[samples.len() - 1]] {
                cuts.push((at.record, all.records[at.record].turned(sample.t, at.is_turned)));
            }
        }
        cuts
    }
}

/// The parameters of a point of an edge between its samples.
pub fn place(sampler: &Sampler, edge: &Edge, samples: &[Sample], t: f64) -> [f64; 2] {
    let is_growing = samples[0].t <= samples[samples.len() - 1].t;
    let after = samples.partition_point(|sample| if is_growing { sample.t < t } else { sample.t > t });
    let after = after.clamp(1, samples.len() - 1);
    let (a, b) = (samples[after - 1], samples[after]);
    let share = if b.t == a.t { 0.0 } else { (t - a.t) / (b.t - a.t) };
    let near = [0, 1].map(|k| a.at[k] + (b.at[k] - a.at[k]) * share);
    sampler.place(edge, t, Some(near))
}

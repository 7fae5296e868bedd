//! A composite surface of bicubic Bezier patches.

use super::Surface;
use super::patch::{Bounds, Patch};

/// `nu` times `nv` patches, `patches[i * nv + j]` over i..=i+1, j..=j+1.
#[derive(Debug, Clone, PartialEq)]
pub struct BezierSurface {
    spans: [usize; 2],
    patches: Vec<Patch>,
}

impl BezierSurface {
    /// Makes the surface whose patch (i, j) is `patch(i, j)`; both spans are at least 1.
    pub fn from_fn(spans: [usize; 2], patch: impl Fn(usize, usize) -> Patch) -> Self {
        let patches = (0..spans[0])
            .flat_map(|i| (0..spans[1]).map(move |j| (i, j)))
            .map(|(i, j)| patch(i, j))
            .collect();
        Self { spans, patches }
    }

    /// A box that holds the surface: that of its control points, mm.
    pub fn bounds(&self) -> Bounds {
        self.patches.iter().fold(Bounds::EMPTY, |all, patch| all.union(&patch.bounds()))
    }

    /// The same surface with u and v exchanged, so that its normal points the other way.
    pub fn transposed(&self) -> Self {
        let [nu, nv] = self.spans;
        Self::from_fn([nv, nu], |j, i| {
            let net = &self.patch(i, j).net;
            Patch { net: std::array::from_fn(|b| std::array::from_fn(|a| net[a][b])) }
        })
    }
}

impl Surface for BezierSurface {
    fn spans(&self) -> [usize; 2] {
        self.spans
    }

    fn patch(&self, i: usize, j: usize) -> &Patch {
        &self.patches[i * self.spans[1] + j]
    }
}

//! A composite surface of bicubic Bezier patches.

use super::Surface;
use super::patch::Patch;
use crate::budget::{Budget, Stopped};

/// Halvings in the search for the top.
const TOP_HALVINGS: usize = 100_000;

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

    /// The height of the surface's highest point, mm: never below it, and at most `accuracy` mm above, or as high
    /// as control points on a surface that is level at its top along a whole curve.
    ///
    /// # Errors
    /// Only the budget's stop.
    pub fn top(&self, accuracy: f64, budget: &Budget) -> Result<f64, Stopped> {
        let highest = |part: &Patch| part.bounds().max.z;
        let mut open: Vec<Patch> = self.patches.clone();
        let corners = |part: &Patch| [part.net[0][0].z, part.net[0][3].z, part.net[3][0].z, part.net[3][3].z];
        let mut found = open.iter().flat_map(corners).fold(f64::NEG_INFINITY, f64::max);
        let mut top = found;
        let (mut halvings, mut parts) = (0, 0usize);
        while let Some(part) = open.pop() {
            parts += 1;
            if parts.is_multiple_of(1024) {
                budget.check()?;
            }
            found = corners(&part).into_iter().fold(found, f64::max);
            if highest(&part) <= found + accuracy || halvings >= TOP_HALVINGS {
                top = top.max(highest(&part));
            } else {
                halvings += 1;
                open.extend(part.split());
            }
        }
        Ok(top)
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

//! What each pass consists of, beside the biarcs that would join the same CL points.

use super::passes::CutPass;
use crate::geometry::curve::Curve;

/// What one pass consists of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, utoipa::ToSchema), schema(as = PassElements))]
pub struct PassElements {
    /// Number of CL points of the pass.
    pub n_cl_points: usize,
    /// Number of arcs of the pass.
    pub n_arcs: usize,
    /// Number of lines of the pass.
    pub n_lines: usize,
    /// Number of biarcs, each of two arcs, that join the same CL points: one between each two neighbours. The
    /// comparison is that of Ju's Table 1.
    pub n_biarcs: usize,
}

/// The elements of each pass, in the order of cutting.
pub(super) fn elements(passes: &[CutPass]) -> Vec<PassElements> {
    let of = |pass: &CutPass| {
        let n_arcs = pass.curves.iter().filter(|curve| matches!(curve, Curve::Arc(_))).count();
        let n_lines = pass.curves.len() - n_arcs;
        PassElements {
            n_cl_points: pass.n_points,
            n_arcs,
            n_lines,
            n_biarcs: pass.n_points.saturating_sub(1),
        }
    };
    passes.iter().map(of).collect()
}

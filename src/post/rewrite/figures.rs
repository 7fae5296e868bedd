//! How a program is rewritten, what changed in it, and why a program is not rewritten to its end.

use super::block::Block;
use super::lines::{MAX_LINE_LENGTH, TooLong};
use crate::dialect::Dialect;
use toolpathd_core::budget::Stopped;
use toolpathd_core::geometry::arc_fit::{Fit, Joints, Measure};

/// How a program is rewritten.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RewriteJob {
    pub dialect: &'static Dialect,
    /// The rewriter sets three fields itself: it measures the polyline, puts joints on the points, and takes
    /// the path to be open. Tangent continuity, if asked for, ends at windows, at kept blocks, and where a
    /// curve was fitted again because rounding had moved it too far.
    pub fit: Fit,
}

impl RewriteJob {
    /// The same job, with the fields of the fit that the rewriter sets itself.
    pub(super) fn with_own_fit(self) -> Self {
        let fit = Fit {
            joints: Joints::OnPoints,
            measure: Measure::Polyline,
            is_closed: false,
            largest_radius_mm: self.fit.largest_radius_mm.min(self.dialect.curves.largest_radius_mm),
            ..self.fit
        };
        Self { fit, ..self }
    }
}

/// What changed in an NC program.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, utoipa::ToSchema), schema(as = ProgramReport))]
pub struct Figures {
    /// Number of runs of G1 blocks that were replaced.
    pub n_runs: u64,
    /// Number of points in these runs: the ends of the G1 blocks.
    pub n_points: u64,
    /// Number of arcs and helices in these runs after the rewriting.
    pub n_arcs: u64,
    /// Number of straight moves in these runs after the rewriting.
    pub n_lines: u64,
    /// Proved largest distance between the new blocks and the straight moves that they replace, in mm,
    /// measured from each to the other. Because coordinates are rounded, the radii at the start and at the
    /// end of an arc differ slightly; the bound holds for every radius between the two that the control may
    /// use.
    pub deviation_max_mm: f64,
    /// Number of blocks of the program that move an axis.
    pub n_motions: u64,
    /// Number of blocks that move at rapid speed or along arcs. Together with `n_points` and all counts of
    /// `left_alone`, they are `n_motions`.
    pub n_other_motions: u64,
    /// How many cutting blocks were left as they were, by reason.
    pub left_alone: LeftAlone,
    /// Length of the program as sent, in bytes.
    pub bytes_in: u64,
    /// Length of the program as answered, in bytes.
    pub bytes_out: u64,
}

/// How many cutting blocks were left as they were, by reason.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, utoipa::ToSchema))]
pub struct LeftAlone {
    /// Number of blocks with variables, expressions, or words that the service does not understand.
    pub macros: u64,
    /// Number of blocks that move axes other than X, Y and Z.
    pub other_axes: u64,
    /// Number of blocks under cutter compensation, absolute centres, inverse time feed, or an unknown mode.
    pub modes: u64,
    /// Number of blocks to which the program may jump.
    pub labels: u64,
    /// Number of other blocks: with a comment that a control may obey, a block delete, words beside N, G1, X,
    /// Y, Z, F and the S in force, a number of more than six decimals, or a start that is not known.
    pub others: u64,
    /// Number of blocks in runs of fewer than three blocks.
    pub short_runs: u64,
}

impl LeftAlone {
    /// Counts a cutting block that is in no run. `may_arrive`: the program may jump to it. `allows_runs`: the
    /// modes before it let a block be in a run.
    pub fn add(&mut self, block: &Block, may_arrive: bool, allows_runs: bool) {
        let Self { macros, other_axes, modes, labels, others, short_runs: _ } = self;
        *if block.is_unclear {
            macros
        } else if block.has_other_axes() {
            other_axes
        } else if may_arrive {
            labels
        } else if !allows_runs {
            modes
        } else {
            others
        } += 1;
    }
}

/// Why a program is not rewritten to its end.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum RewriteError {
    #[error(transparent)]
    Stopped(#[from] Stopped),
    #[error("line {line} is longer than {limit} bytes; split the line")]
    LineTooLong {
        /// From 1.
        line: u64,
        limit: usize,
    },
    #[error(
        "line {line} may jump back to a block that was replaced before the jump was known, more than {limit} bytes \
         into the program; leave out the jump, or put it before that"
    )]
    LateJump {
        /// From 1.
        line: u64,
        limit: usize,
    },
}

impl From<TooLong> for RewriteError {
    fn from(TooLong { line }: TooLong) -> Self {
        Self::LineTooLong { line, limit: MAX_LINE_LENGTH }
    }
}

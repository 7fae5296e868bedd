//! What is wrong with a toolpath, or may be.

use std::collections::BTreeMap;

use nalgebra::Point3;

/// The most findings that are listed. All are counted.
pub const MOST_LISTED: usize = 1000;

/// A move of the toolpath.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct MoveNumber {
    pub pass: usize,
    /// The number of the move in its pass.
    pub index: usize,
    /// The number of the move in the toolpath.
    pub number: usize,
}

/// What a finding is about.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, utoipa::ToSchema))]
#[cfg_attr(feature = "wire", serde(rename_all = "snake_case"), schema(as = FindingKind))]
pub enum Kind {
    /// A feed move cuts into the part.
    Gouge,
    /// A rapid enters the part.
    RapidThroughPart,
    /// A rapid enters material that is not cut yet.
    RapidThroughStock,
    /// Shank or holder come too near to the stock.
    HolderNearStock,
    /// Shank or holder come too near to the part.
    HolderNearPart,
    /// Cutter, shank or holder come too near to a fixture.
    FixtureNear,
    /// The tip leaves the travel of the machine.
    OutsideTravel,
    /// The material beside the tip is higher than the cutting edges.
    DeeperThanFlutes,
    /// More stands above the part at the end than is allowed. The move is the nearest one.
    MaterialLeft,
}

/// Whether a finding holds for every path that the control may run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, utoipa::ToSchema))]
#[cfg_attr(feature = "wire", serde(rename_all = "snake_case"))]
pub enum Certainty {
    Certain,
    /// The bound does not exclude it.
    Possible,
}

/// What the findings come to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, utoipa::ToSchema))]
#[cfg_attr(feature = "wire", serde(rename_all = "snake_case"))]
pub enum Verdict {
    Pass,
    Fail,
    Undecided,
}

/// One thing that is wrong, or may be.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Finding {
    pub kind: Kind,
    pub certainty: Certainty,
    pub place: MoveNumber,
    pub at: Option<Point3<f64>>,
    /// The depth, the distance, or the excess over a limit that was found, mm; `None` where none was.
    pub found_mm: Option<f64>,
    /// The proved bound of the depth, the distance or the excess, mm.
    pub bound_mm: f64,
}

/// All findings: the first of them as a list, the others as counts.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Findings {
    pub listed: Vec<Finding>,
    pub counts: BTreeMap<(Kind, Certainty), usize>,
}

impl Findings {
    pub(super) fn add(&mut self, finding: Finding) {
        *self.counts.entry((finding.kind, finding.certainty)).or_default() += 1;
        self.listed.push(finding);
    }

    /// Puts the certain findings first, each sort in the order of the moves, and keeps the first of them.
    pub(super) fn sort(&mut self) {
        self.listed.sort_by_key(|finding| (finding.certainty, finding.place, finding.kind));
        self.listed.truncate(MOST_LISTED);
    }

    pub fn total(&self) -> usize {
        self.counts.values().sum()
    }

    pub fn verdict(&self) -> Verdict {
        let has = |certainty| self.counts.keys().any(|(_, own)| *own == certainty);
        if has(Certainty::Certain) {
            Verdict::Fail
        } else if has(Certainty::Possible) {
            Verdict::Undecided
        } else {
            Verdict::Pass
        }
    }
}

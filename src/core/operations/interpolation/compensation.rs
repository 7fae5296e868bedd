//! The path of a round cutter's centre beside the contour: the contour's offset by the cutter's radius.

use nalgebra::Point2;

use crate::budget::{Budget, Stopped};
use crate::geometry::offset::{OffsetError, Side, offset, unreached};
use crate::geometry::segment::Segment;

/// The path of the cutter's centre.
#[derive(Debug, Clone, PartialEq)]
pub struct Compensated {
    /// Chains of lines and arcs, in the direction of the contour.
    pub chains: Vec<Vec<Segment>>,
    /// The largest distance between the cutter and the contour, at sampled points, mm.
    pub uncut_mm: f64,
}

#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum CompensationError {
    #[error(transparent)]
    Stopped(#[from] Stopped),
    #[error("the cutter fits nowhere beside the contour; use a smaller cutter")]
    NothingLeft,
    #[error(
        "near {at} no path beside the contour could be proved not to gouge the contour; try a smaller cutter"
    )]
    Gouges { at: Point2<f64> },
    #[error("the path beside the contour needs more than {limit} elements; use a wider band")]
    TooMany { limit: usize },
}

/// The path of a cutter's centre beside a connected chain of lines and arcs. Where elements of the contour
/// meet almost smoothly, the path may lie up to `mitre_mm` farther from the contour than the radius.
///
/// # Errors
/// One of [`CompensationError`].
pub fn compensate(
    contour: &[Segment],
    side: Side,
    radius_mm: f64,
    mitre_mm: f64,
    budget: &Budget,
) -> Result<Compensated, CompensationError> {
    let chains = offset(&[contour], side, radius_mm, mitre_mm, budget)?;
    if chains.is_empty() {
        return Err(CompensationError::NothingLeft);
    }
    let uncut_mm = unreached(contour, &chains, radius_mm, budget)?;
    Ok(Compensated { chains, uncut_mm })
}

impl From<OffsetError> for CompensationError {
    fn from(error: OffsetError) -> Self {
        match error {
            OffsetError::Stopped(stopped) => Self::Stopped(stopped),
            OffsetError::Unproved { at } => Self::Gouges { at },
            OffsetError::TooMany { limit } => Self::TooMany { limit },
        }
    }
}

//! Where the centre of a disc may be if the disc stays inside a region, also in slots exactly as wide as the
//! disc.
//!
//! # Method
//! 1. The usual places are all places whose distance from the boundary is at least the radius.
//! 2. In a slot exactly as wide as the disc, the usual places are a line. A line has no area, so a region
//!    cannot hold it. Therefore the places with a distance of at least the radius less a slack are computed
//!    too. The part of them that is far from all usual places is a strip along such a line.
//! 3. Each strip is added to the usual places, unless it is only the short end of a cusp.
//!
//! # Guarantees
//! * On strips, and where strips join the usual places, the distance from the boundary is at least the radius
//!   less the slack. Everywhere else it is at least the radius less a few snaps.
//! * A slot has a strip if it is narrower than the disc by less than twice the slack and two snaps.

use super::{Region, RegionError};
use crate::budget::Budget;

/// Places nearer to the usual ones are no strip, mm. Corners of half a degree reach so far for a slack of
/// 1e-5 mm.
const NEAR_MM: f64 = 1e-3;

/// A strip that meets the usual places is left out if it is shorter than this part of the radius: there two
/// walls come together slowly, and what the disc reaches more is thinner than a micrometre.
const CUSP: f64 = 0.01;

/// How wide the usual places are where a strip ends in them, mm: far above the snap. Between two corners they
/// end in a cusp, whose width is the square of the distance from its tip divided by the radius.
const JOINT_MM: f64 = 1e-4;

/// The boundaries of strips and of usual places differ in length by more than this part of a strip's.
const LONGER: f64 = 0.5;

impl Region {
    /// The places where the centre of a disc may be: those at least `radius_mm` from the boundary, and strips
    /// along the middle of places that are as wide as the disc, or narrower by up to twice the slack.
    ///
    /// # Errors
    /// One of [`RegionError`].
    pub fn centers_of_disc(
        &self,
        radius_mm: f64,
        slack_mm: f64,
        budget: &Budget,
    ) -> Result<Self, RegionError> {
        let usual = self.offset_inward(radius_mm, budget)?;
        if radius_mm <= slack_mm {
            return Ok(usual);
        }
        let wide = self.offset_inward(radius_mm - slack_mm, budget)?;
        let shortest = CUSP * radius_mm;
        let is_same = usual.faces.len() == wide.faces.len()
            && usual.outlines().count() == wide.outlines().count()
            && wide.boundary_length() - usual.boundary_length() < LONGER * shortest;
        if is_same {
            return Ok(usual);
        }
        if usual.is_empty() {
            return Ok(wide);
        }
        let beyond = wide.difference(&usual.offset_outward(NEAR_MM, budget)?, budget)?;
        let is_strip = |part: &Self| {
            let size = part.bounding_box().map_or(0.0, |[low, high]| (high - low).norm());
            let meets = part
                .outlines()
                .flat_map(super::Outline::elements)
                .any(|element| usual.clearance(element, 2.0 * NEAR_MM) < 2.0 * NEAR_MM);
            size >= shortest || !meets
        };
        let strips: Vec<Self> = beyond.parts().into_iter().filter(is_strip).collect();
        if strips.is_empty() {
            return Ok(usual);
        }
        let overlap_mm = NEAR_MM + (JOINT_MM * radius_mm).sqrt();
        let joined =
            Self::of_parts(&strips).offset_outward(overlap_mm, budget)?.intersection(&wide, budget)?;
        Self::union(&[&usual, &joined], budget)
    }

    /// The length of all outlines, mm.
    fn boundary_length(&self) -> f64 {
        self.outlines().map(|outline| super::outline::length(outline.elements())).sum()
    }
}

//! What earlier tools have emptied: the places at each height, and paths of the cutter over these places.

use super::PocketError;
use super::chain::from_above;
use super::job::Emptied;
use super::rings;
use crate::budget::Budget;
use crate::geometry::region::Region;
use crate::geometry::segment::Segment;

/// Heights that differ by less are the same, mm.
const SAME_HEIGHT_MM: f64 = 1e-6;

/// A layer of this thickness beside emptied places counts as emptied, mm. Without this skin, a cutter that
/// follows the edge of an emptied place would meet material of no thickness.
const SKIN_MM: f64 = 0.005;

/// The distance between neighbouring paths over an emptied place, in radii of the cutter. At a larger
/// distance rings may leave gaps at corners.
const APART: f64 = 1.0;

/// Emptied places.
pub struct Cleared {
    /// Emptied down to the floor of the pocket.
    regions: Vec<Region>,
    /// Paths of earlier tools.
    paths: Vec<Path>,
}

struct Path {
    radius_mm: f64,
    /// Elements seen from above, with the height of their higher end, mm.
    elements: Vec<(Segment, f64)>,
}

impl Cleared {
    pub fn new(emptied: &[Emptied], budget: &Budget) -> Result<Self, PocketError> {
        let (mut regions, mut paths) = (Vec::new(), Vec::new());
        for (k, emptied) in emptied.iter().enumerate() {
            match emptied {
                Emptied::Region(area) => regions.push(area.region(budget).map_err(|error| match error {
                    PocketError::Outline { island, error } => {
                        PocketError::Cleared { index: k, island, error }
                    }
                    PocketError::NothingToCut => PocketError::ClearedEmpty { index: k },
                    other => other,
                })?),
                Emptied::Path { along, radius_mm } => {
                    let elements = along
                        .iter()
                        .map(|curve| (from_above(curve), curve.start().z.max(curve.end().z)))
                        .filter(|(element, _)| element.length() > 0.0);
                    paths.push(Path { radius_mm: *radius_mm, elements: elements.collect() });
                }
            }
        }
        Ok(Self { regions, paths })
    }

    pub fn is_empty(&self) -> bool {
        self.regions.is_empty() && self.paths.is_empty()
    }

    /// The places that are emptied down to the height `z_mm`, or deeper.
    pub fn at(&self, z_mm: f64, budget: &Budget) -> Result<Region, PocketError> {
        let mut all = self.regions.clone();
        for path in &self.paths {
            let mut chains: Vec<Vec<Segment>> = Vec::new();
            for (element, _) in path.elements.iter().filter(|(_, z)| *z <= z_mm + SAME_HEIGHT_MM) {
                match chains.last_mut() {
                    Some(chain) if chain.last().is_some_and(|last| last.end() == element.start()) => {
                        chain.push(*element);
                    }
                    _ => chains.push(vec![*element]),
                }
            }
            let chains: Vec<&[Segment]> = chains.iter().map(Vec::as_slice).collect();
            all.push(Region::swept(&chains, path.radius_mm, budget)?);
        }
        Ok(Region::union(&all.iter().collect::<Vec<_>>(), budget)?)
    }
}

/// Paths on which a cutter sweeps the emptied places of a pocket, as far as the cutter reaches them. A path
/// may be nearer to the pocket's walls than the radius, by the skin.
pub fn paths_over(
    emptied: &Region,
    pocket: &Region,
    radius_mm: f64,
    budget: &Budget,
) -> Result<Vec<Vec<Segment>>, PocketError> {
    if emptied.is_empty() {
        return Ok(Vec::new());
    }
    let pocket = pocket.offset_outward(SKIN_MM, budget)?;
    let emptied = emptied.offset_outward(SKIN_MM, budget)?.intersection(&pocket, budget)?;
    over(&emptied, radius_mm, budget)
}

/// Paths on which a cutter sweeps the air in and around a pocket.
pub fn paths_in_air(air: &Region, radius_mm: f64, budget: &Budget) -> Result<Vec<Vec<Segment>>, PocketError> {
    if air.is_empty() {
        return Ok(Vec::new());
    }
    over(&air.offset_outward(SKIN_MM, budget)?, radius_mm, budget)
}

/// Paths on which a cutter sweeps a region as far as it fits in it.
fn over(region: &Region, radius_mm: f64, budget: &Budget) -> Result<Vec<Vec<Segment>>, PocketError> {
    let centers = region.offset_inward(radius_mm, budget)?;
    Ok(rings::inside_out(&rings::rings(&centers, radius_mm, APART * radius_mm, budget)?))
}

//! Open edges and the stock: where the cutter comes in from the air, and where material stands.
//!
//! # Method
//! In front of open edges the pocket goes on by a zone in which the cutter is wholly outside the material
//! ([`Outline::front`]). All patterns clear the pocket with its zones, as if the zones had been emptied by an
//! earlier tool: then passes begin and end in the air, and what meets no material is not cut. Where the stock
//! is known, all of the pocket that is outside the stock counts as emptied, too. Where stock stands in front
//! of an open edge, there is no zone.
//!
//! # Guarantees
//! The centre of the cutter comes no farther beyond an open edge than the zone is wide, less the radius. It
//! keeps the radius away from closed edges and from their straight continuations beside an open edge.

use super::PocketError;
use super::cleared::paths_in_air;
use super::job::Job;
use super::outlines::Walls;
use crate::budget::Budget;
use crate::geometry::region::Region;
use crate::geometry::segment::Segment;

/// How far beyond an open edge the centre may be where no layer is left for a pass along walls: by the radius
/// of the cutter, this part of it, and a little, mm.
const BEYOND: f64 = 0.25;
const BEYOND_MM: f64 = 0.2;

/// A pocket that is not closed all around, or has less material than its walls would hold.
#[derive(Debug, Clone)]
pub struct Opened {
    /// The pocket with the zones in front of its open edges.
    pub pocket: Region,
    /// Where material stands.
    pub material: Region,
    /// Paths of the cutter over the air in and beside the pocket.
    pub air: Vec<Vec<Segment>>,
    /// Whether the pocket has open edges in front of which nothing stands.
    pub has_zones: bool,
}

impl Opened {
    /// `None` for a pocket with closed edges alone whose stock is not known.
    pub fn new(job: &Job, walls: &Walls, budget: &Budget) -> Result<Option<Self>, PocketError> {
        let stock = job.stock.as_ref().map(|stock| Walls::new(&stock.outlines, &[], budget)).transpose()?;
        let stock = stock.map(|stock| stock.region);
        let radius_mm = job.tool.radius_mm;
        let mut zones = walls.boundary.front(|element| walls.open.has(element), width_mm(job), budget)?;
        if zones.is_empty() && stock.is_none() {
            return Ok(None);
        }
        for island in &walls.islands {
            let island = Region::new(std::slice::from_ref(island), &[], budget)?;
            zones = zones.difference(&island, budget)?;
        }
        let mut material = walls.region.clone();
        if let Some(stock) = &stock {
            zones = zones.difference(stock, budget)?;
            material = material.intersection(stock, budget)?;
        }
        if material.is_empty() {
            return Err(PocketError::NothingToCut);
        }
        let pocket = Region::union(&[&walls.region, &zones], budget)?;
        // Beside the zones and the pocket, too, so that discs of the cutter are free up to their corners.
        let air = match &stock {
            Some(stock) => pocket.offset_outward(2.0 * radius_mm, budget)?.difference(stock, budget)?,
            None => zones.offset_outward(radius_mm, budget)?.difference(&walls.region, budget)?,
        };
        let has_zones = !zones.is_empty();
        Ok(Some(Self { pocket, material, air: paths_in_air(&air, radius_mm, budget)?, has_zones }))
    }
}

/// How far zones reach beyond open edges, mm.
fn width_mm(job: &Job) -> f64 {
    let radius = job.tool.radius_mm;
    let kept = job.stepover_mm.max(job.side_mm()).min(radius) + job.allowance_mm.min(radius);
    (2.0 + BEYOND) * radius + kept + BEYOND_MM
}

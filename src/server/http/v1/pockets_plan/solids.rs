//! The part with its pocket, and the stock, in three dimensions.
//!
//! A request says where the pocket is, and seldom how large the part is. Where it tells the stock in plan,
//! that is the outline of both. Else a block around the pocket is assumed. With open edges and without a
//! stock no block can be assumed: in front of these edges is air. Then the stock is what is cut.

use nalgebra::{Point2, Vector2};

use crate::http::answer::model::{PART_CHORD_MM, Solids};
use crate::http::error::ApiError;
use toolpathd_core::budget::Budget;
use toolpathd_core::geometry::region::{Region, RegionError};
use toolpathd_core::geometry::segment::Segment;
use toolpathd_core::operations::pocketing::{Job, LevelOutlines, PocketError, Standing};
use toolpathd_plot::gltf::Stock;
use toolpathd_plot::solid::{self, Slab};

/// How far an assumed block reaches beyond the pocket, as a part of its largest extent in plan, and below its
/// floor, as a part of its depth.
const AROUND: f64 = 0.1;
const BELOW: f64 = 0.25;

/// Parts with more lines and arcs on all their levels are not drawn.
const MOST_ELEMENTS: usize = 100_000;

/// From what part and stock are made.
pub struct Bodies {
    pub levels: Vec<LevelOutlines>,
    /// Where material stands, if the request tells it.
    pub stock: Option<Standing>,
    pub has_open_edges: bool,
}

impl Bodies {
    pub fn new(job: &Job, levels: Vec<LevelOutlines>) -> Self {
        Self { levels, stock: job.stock.clone(), has_open_edges: !job.open.is_empty() }
    }

    /// Part and stock. Without them where they cannot be made.
    ///
    /// # Errors
    /// The budget's stop.
    pub fn solids(&self, budget: &Budget) -> Result<Solids, ApiError> {
        match self.made(budget) {
            Ok(solids) => Ok(solids),
            Err(PocketError::Stopped(stopped)) => Err(stopped.into()),
            Err(_) => Ok(Solids::default()),
        }
    }

    fn made(&self, budget: &Budget) -> Result<Solids, PocketError> {
        let n_elements: usize = self.levels.iter().flat_map(|level| &level.pocket).map(Vec::len).sum();
        let free = if n_elements <= MOST_ELEMENTS { self.free(budget)? } else { Vec::new() };
        let (Some(highest), Some(lowest)) = (free.first(), free.last()) else { return Ok(Solids::default()) };
        let (top_z_mm, floor_z_mm) = (highest.top_z_mm, lowest.bottom_z_mm);
        let stock = self.stock.as_ref().map(|stock| stock.outlines.region(budget)).transpose()?;
        if stock.is_none() && self.has_open_edges {
            let triangles = solid::triangles(&free, PART_CHORD_MM, budget)?;
            return Ok(Solids { stock: Some(Stock { triangles, is_assumed: false }), ..Solids::default() });
        }
        let is_assumed = stock.is_none();
        let whole = match stock {
            Some(stock) => stock,
            None => block_around(&free, budget)?,
        };
        let assumed_z_mm = floor_z_mm - BELOW * (top_z_mm - floor_z_mm);
        let bottom_z_mm = self.stock.as_ref().map_or(assumed_z_mm, |stock| stock.bottom_z_mm);
        let mut slabs: Vec<Slab> = Vec::with_capacity(free.len() + 1);
        let mut free_above: Option<Region> = None;
        for Slab { top_z_mm, bottom_z_mm: low_z_mm, region } in free {
            let is_same = free_above.as_ref().is_some_and(|above| above.faces() == region.faces());
            let standing = match slabs.last() {
                Some(above) if is_same => above.region.clone(),
                _ => whole.difference(&region, budget)?,
            };
            free_above = Some(region);
            slabs.push(Slab { top_z_mm, bottom_z_mm: low_z_mm.max(bottom_z_mm), region: standing });
        }
        slabs.push(Slab { top_z_mm: floor_z_mm, bottom_z_mm, region: whole.clone() });
        slabs.retain(|slab| slab.top_z_mm > slab.bottom_z_mm);
        let part = solid::triangles(&slabs, PART_CHORD_MM, budget)?;
        let block = [Slab { top_z_mm, bottom_z_mm, region: whole }];
        let triangles = solid::triangles(&block, PART_CHORD_MM, budget)?;
        Ok(Solids {
            part: Some(part),
            part_chord_mm: Some(PART_CHORD_MM),
            stock: Some(Stock { triangles, is_assumed }),
        })
    }

    /// What the levels leave free, from the top down.
    fn free(&self, budget: &Budget) -> Result<Vec<Slab>, RegionError> {
        let mut heights: Vec<f64> =
            self.levels.iter().flat_map(|level| [level.top_z_mm, level.z_mm]).collect();
        heights.sort_by(|a, b| b.total_cmp(a));
        heights.dedup();
        let mut slabs: Vec<Slab> = Vec::new();
        let mut last: Vec<&Vec<Segment>> = Vec::new();
        for pair in heights.windows(2) {
            let is_across = |level: &&LevelOutlines| level.top_z_mm >= pair[0] && level.z_mm <= pair[1];
            let chains: Vec<&Vec<Segment>> =
                self.levels.iter().filter(is_across).flat_map(|level| &level.pocket).collect();
            let region = match slabs.last() {
                Some(above) if chains == last => above.region.clone(),
                _ => Region::on_the_left(
                    &chains.iter().map(|chain| (*chain).clone()).collect::<Vec<_>>(),
                    budget,
                )?,
            };
            slabs.push(Slab { top_z_mm: pair[0], bottom_z_mm: pair[1], region });
            last = chains;
        }
        Ok(slabs)
    }
}

/// A block around all that is free, in plan.
fn block_around(free: &[Slab], budget: &Budget) -> Result<Region, RegionError> {
    let boxes = free.iter().filter_map(|slab| slab.region.bounding_box());
    let whole = boxes.reduce(|[low, high], [l, h]| [low.inf(&l), high.sup(&h)]);
    let Some([low, high]) = whole else { return Ok(Region::empty()) };
    let around = Vector2::repeat(AROUND * (high - low).amax());
    let (low, high) = (low - around, high + around);
    let corners = [low, Point2::new(high.x, low.y), high, Point2::new(low.x, high.y)];
    let side = |k: usize| Segment::Line { start: corners[k], end: corners[(k + 1) % 4] };
    Region::on_the_left(&[(0..4).map(side).collect()], budget)
}

#[cfg(test)]
mod tests {
    use super::*;
    use toolpathd_core::operations::pocketing::Outlines;
    use toolpathd_plot::gltf::Triangles;

    fn square(low: f64, high: f64) -> Vec<Segment> {
        let corners = [[low, low], [high, low], [high, high], [low, high]].map(Point2::from);
        (0..4).map(|k| Segment::Line { start: corners[k], end: corners[(k + 1) % 4] }).collect()
    }

    fn level(top_z_mm: f64, z_mm: f64, pocket: &[Vec<Segment>]) -> LevelOutlines {
        LevelOutlines { top_z_mm, z_mm, pocket: pocket.to_vec(), uncut: Vec::new() }
    }

    /// The volumes of part and stock.
    fn volumes(levels: Vec<LevelOutlines>) -> [f64; 2] {
        let outlines = Outlines { boundary: square(0.0, 40.0), islands: Vec::new() };
        let stock = Some(Standing { outlines, bottom_z_mm: -12.0 });
        let Solids { part, stock, .. } =
            Bodies { levels, stock, has_open_edges: false }.made(&Budget::unlimited()).unwrap();
        let volume = |triangles: &Triangles| -> f64 {
            let corners = |triangle: &[u32; 3]| triangle.map(|k| triangles.points[k as usize].coords);
            triangles.triangles.iter().map(corners).map(|[a, b, c]| a.dot(&b.cross(&c)) / 6.0).sum()
        };
        [volume(&part.unwrap()), volume(&stock.unwrap().triangles)]
    }

    #[test]
    fn the_part_is_the_stock_without_what_each_level_leaves_free() {
        let (wide, narrow, whole) = ([square(10.0, 30.0)], [square(15.0, 25.0)], [square(0.0, 40.0)]);
        let stock = 1600.0 * 12.0;
        for (levels, free) in [
            (vec![level(0.0, -2.0, &wide), level(-2.0, -4.0, &wide), level(-4.0, -6.0, &wide)], 400.0 * 6.0),
            (vec![level(0.0, -3.0, &wide), level(-3.0, -5.0, &narrow)], 400.0 * 3.0 + 100.0 * 2.0),
            // Nothing stands beside the upper levels, and nothing is free on the lower ones.
            (vec![level(0.0, -2.5, &whole), level(-2.5, -5.0, &whole), level(-5.0, -7.5, &[])], 1600.0 * 5.0),
            // Below the stock nothing is left.
            (vec![level(0.0, -14.0, &wide)], 400.0 * 12.0),
        ] {
            let [part, raw] = volumes(levels);
            assert!(
                (raw - stock).abs() < 1e-6 && (part - (stock - free)).abs() < 1e-6,
                "{part} {raw} {free}"
            );
        }
    }
}

//! The part: which places it leaves free at each height, and how deep a level may be.
//!
//! # Depth of a level
//! Between its top and its floor a level leaves material on the slopes of a relief. Above a place of the
//! relief that is `h` mm below the level's top and has the slope s, this material is `h cos(s)` thick, at a
//! right angle to the relief. So a facet that reaches from the height `low` to the height `high` limits the
//! depth d of a level in closed form. The level is allowed if its floor is not below any place of the facet,
//! `d <= top - high`, or if what it leaves is thin, `d cos(s) <= allowance`. A facet does not limit the level
//! if even all the material between the facet and the level's top is thin enough. For a horizontal facet
//! `low` equals `high`, so a level ends on a plane of the part rather than leave too much on it.
//!
//! # Differences from the paper
//! The paper makes the depth smaller in steps until the largest difference is allowed, and does not say how
//! the difference is measured. Here the largest depth is found at once.

use super::PocketError;
use super::job::{IslandsBy, Job, Relief};
use super::labelling;
use super::opened::Opened;
use super::outlines::{FITTED_MM, Walls, is_fitted};
use crate::budget::Budget;
use crate::geometry::height_field::{Facet, HeightField, HeightFieldError, HeightGrid, SAME_HEIGHT_MM};
use crate::geometry::region::{Containment, Region};

/// The largest distance between a surface and the triangles that stand for it, mm.
const DEVIATION_MM: f64 = 0.001;

/// The part of the allowance that is kept for rounding.
const ROUNDING: f64 = 1e-9;

pub struct Part {
    /// The pocket, with the zones in front of its open edges.
    walls: Option<Region>,
    /// What open edges and the stock change.
    opened: Option<Opened>,
    /// Whether arcs replace the lines of the walls.
    is_fitted: bool,
    field: Option<HeightField>,
    /// The grid whose cells are labelled, if islands are found that way.
    cells: Option<HeightGrid>,
    /// The facets that may be inside the walls; none without a roughing allowance.
    facets: Vec<Facet>,
}

impl Part {
    pub fn new(job: &Job, budget: &Budget) -> Result<Self, PocketError> {
        let walls = job.area.as_ref().map(|area| Walls::new(area, &job.open, budget)).transpose()?;
        let opened = match &walls {
            Some(walls) => Opened::new(job, walls, budget)?,
            None => None,
        };
        let walls = walls.map(|walls| opened.as_ref().map_or(walls.region, |opened| opened.pocket.clone()));
        let field = job.relief.as_ref().map(|relief| field(relief, budget)).transpose()?;
        let cells = match (&field, &job.relief, job.islands_by) {
            (_, Some(Relief::Grid(grid)), IslandsBy::Labelling { .. }) => Some(grid.clone()),
            (Some(field), _, IslandsBy::Labelling { cell_mm }) => {
                Some(labelling::sampled(field, cell_mm, budget)?)
            }
            _ => None,
        };
        let mut facets = Vec::new();
        if let Some(field) = &field
            && job.roughing_allowance_mm.is_some()
        {
            field.for_each_facet(budget, |facet| {
                let (middle, reach) = facet.disc();
                let is_inside = walls.as_ref().is_none_or(|walls| {
                    walls.place(middle, 0.0) == Containment::Inside
                        || walls.distance_to_boundary(middle) < reach
                });
                if is_inside {
                    facets.push(*facet);
                }
            })?;
        }
        let is_fitted = job.area.as_ref().is_some_and(is_fitted);
        Ok(Self { walls, opened, is_fitted, field, cells, facets })
    }

    /// What open edges and the stock change on a level with these walls.
    pub fn opened_at(&self, walls: &Region, budget: &Budget) -> Result<Option<Opened>, PocketError> {
        let mut opened = self.opened.clone();
        if let Some(opened) = opened.as_mut().filter(|_| self.field.is_some()) {
            opened.material = opened.material.intersection(walls, budget)?;
        }
        Ok(opened)
    }

    /// The height of the highest point of the relief, mm.
    pub fn highest_mm(&self) -> Option<f64> {
        self.field.as_ref().map(HeightField::highest_mm)
    }

    /// The largest distance between the boundary of a region and the part, mm: the distance of the triangles
    /// from the surface, and that of the fitted arcs from the triangles.
    pub fn deviation_mm(&self) -> f64 {
        let relief = self.field.as_ref().map_or(0.0, |field| 2.0 * field.deviation_mm());
        if self.is_fitted { relief.max(FITTED_MM) } else { relief }
    }

    /// By how much the part may be higher than a level's floor in places that the level clears, mm.
    pub fn overlap_mm(&self) -> f64 {
        self.field.as_ref().map_or(0.0, |field| field.deviation_mm() + SAME_HEIGHT_MM)
    }

    /// The region inside the walls where the part is not higher than `z_mm`.
    pub fn region_at(&self, z_mm: f64, budget: &Budget) -> Result<Region, PocketError> {
        let Some(field) = &self.field else { return Ok(self.walls.clone().unwrap_or_else(Region::empty)) };
        self.within_walls(field.region_below(z_mm, budget)?, budget)
    }

    /// The region that is cleared down to a height, made of cells. None if islands are not found by
    /// labelling.
    pub fn labelled_at(&self, z_mm: f64, budget: &Budget) -> Result<Option<Region>, PocketError> {
        let Some(cells) = &self.cells else { return Ok(None) };
        let low = labelling::low_cells(cells, z_mm, budget)?;
        Ok(Some(self.within_walls(low, budget)?))
    }

    fn within_walls(&self, region: Region, budget: &Budget) -> Result<Region, PocketError> {
        match &self.walls {
            Some(walls) => Ok(region.intersection(walls, budget)?),
            None => Ok(region),
        }
    }

    /// The largest depth of a level below `top_z_mm`, at most `most_mm`, that leaves at most `allowance_mm`
    /// on the relief, mm.
    pub fn depth_mm(&self, top_z_mm: f64, most_mm: f64, allowance_mm: f64) -> f64 {
        let allowance_mm = allowance_mm * (1.0 - ROUNDING);
        let limit = |facet: &Facet| {
            let [low, high] = facet.heights();
            let is_thin = (top_z_mm - low).min(most_mm) * facet.cosine <= allowance_mm;
            if is_thin || low >= top_z_mm {
                return f64::INFINITY;
            }
            (top_z_mm - high).max(allowance_mm / facet.cosine)
        };
        self.facets.iter().map(limit).fold(most_mm, f64::min)
    }

    /// The thickest material that a level from `top_z_mm` down to `z_mm` leaves on the relief, at a right
    /// angle to the relief, mm.
    pub fn leftover_mm(&self, top_z_mm: f64, z_mm: f64) -> f64 {
        let left = |facet: &Facet| {
            let [low, high] = facet.heights();
            if high <= z_mm + SAME_HEIGHT_MM {
                0.0
            } else {
                (top_z_mm - low.max(z_mm)).max(0.0) * facet.cosine
            }
        };
        self.facets.iter().map(left).fold(0.0, f64::max)
    }
}

fn field(relief: &Relief, budget: &Budget) -> Result<HeightField, PocketError> {
    match relief {
        Relief::Grid(grid) => Ok(HeightField::of_grid(grid)),
        Relief::Surface(source) => {
            let surface = source.surface().map_err(PocketError::Surface)?;
            HeightField::of_surface(&surface, DEVIATION_MM, budget).map_err(|error| match error {
                HeightFieldError::Stopped(stopped) => PocketError::Stopped(stopped),
                other => PocketError::Relief(other),
            })
        }
    }
}

//! The part: what of it stands at each height, and how deep a level may go.
//!
//! # Depth of a level
//! Between its top and its floor a level leaves material on the slopes of a relief. Above a place of the
//! relief that is `h` mm below the level's top and has the slope s, this material is `h cos(s)` thick, at a
//! right angle to the relief. A facet that reaches from `low` to `high` therefore limits the depth d of a
//! level in closed form: either the floor is at or below the whole facet, `d <= top - high`, or
//! `d cos(s) <= allowance`. Facets on which the whole of the rest is thin enough do not limit it. So a level
//! ends on a plane of the part where that leaves less.
//!
//! # Differences from the paper
//! The paper makes the depth smaller in steps until the largest difference is allowed, and does not say how
//! the difference is measured. Here the largest depth is found at once.

use super::PocketError;
use super::job::{IslandsBy, Job, Outlines, Relief};
use super::labelling;
use crate::budget::Budget;
use crate::geometry::element::Element;
use crate::geometry::height_field::{Facet, HeightField, HeightFieldError, HeightGrid, SAME_HEIGHT_MM};
use crate::geometry::region::{Outline, OutlineError, Place, Region};

/// The largest distance between a surface and the triangles that stand for it, mm.
const DEVIATION_MM: f64 = 0.001;

/// The part of the allowance that is kept for rounding.
const ROUNDING: f64 = 1e-9;

pub struct Part {
    walls: Option<Region>,
    field: Option<HeightField>,
    /// The grid whose cells are labelled, if islands are found that way.
    cells: Option<HeightGrid>,
    /// The facets that the walls surround.
    facets: Vec<Facet>,
}

impl Part {
    pub fn new(job: &Job, budget: &Budget) -> Result<Self, PocketError> {
        let walls = job.area.as_ref().map(|area| region(area, budget)).transpose()?;
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
                    walls.place(middle, 0.0) == Place::Inside || walls.distance_to_boundary(middle) < reach
                });
                if is_inside {
                    facets.push(*facet);
                }
            })?;
        }
        Ok(Self { walls, field, cells, facets })
    }

    /// The height of the highest point of the relief, mm.
    pub fn highest_mm(&self) -> Option<f64> {
        self.field.as_ref().map(HeightField::highest_mm)
    }

    /// By how much the boundary of a region may differ from the part, mm: triangles differ from the surface, and
    /// arcs from the triangles.
    pub fn deviation_mm(&self) -> f64 {
        self.field.as_ref().map_or(0.0, |field| 2.0 * field.deviation_mm())
    }

    /// By how much the part may be higher than a level whose floor it is, mm.
    pub fn overlap_mm(&self) -> f64 {
        self.field.as_ref().map_or(0.0, |field| field.deviation_mm() + SAME_HEIGHT_MM)
    }

    /// Where the part is not higher than `z_mm`.
    pub fn region_at(&self, z_mm: f64, budget: &Budget) -> Result<Region, PocketError> {
        let Some(field) = &self.field else { return Ok(self.walls.clone().unwrap_or_else(Region::empty)) };
        self.within_walls(field.region_below(z_mm, budget)?, budget)
    }

    /// What is cleared at a height where islands are found by labelling; none where they are not.
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

    /// The largest depth below `top_z_mm` of a level that leaves at most `allowance_mm` on the relief, mm.
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

    /// The thickest material that a level leaves on the relief, at a right angle to it, mm.
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

/// The region inside the wall and outside all islands.
pub fn region(area: &Outlines, budget: &Budget) -> Result<Region, PocketError> {
    let outline = |elements: &[Element], island: Option<usize>| {
        Outline::new(elements, budget).map_err(|error| match error {
            OutlineError::Stopped(stopped) => PocketError::Stopped(stopped),
            error => PocketError::Outline { island, error },
        })
    };
    let boundary = outline(&area.boundary, None)?;
    let islands = area.islands.iter().enumerate().map(|(k, island)| outline(island, Some(k)));
    let region = Region::new(&[boundary], &islands.collect::<Result<Vec<_>, _>>()?, budget)?;
    if region.is_empty() { Err(PocketError::NothingToCut) } else { Ok(region) }
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

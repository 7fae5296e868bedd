//! The levels of a pocket, and the shape that is cleared on each.

use nalgebra::Point2;

use super::PocketError;
use super::depth::deepest;
use super::job::{Job, Outlines};
use crate::budget::Budget;
use crate::geometry::element::Element;
use crate::geometry::region::{Outline, OutlineError, Region};

/// The most levels.
const MOST_LEVELS: usize = 1000;

/// The longest path of a level, in radii of the cutter.
const MOST_RADII: usize = 200_000;

/// A depth may exceed a multiple of the stepdown by this part of a stepdown: it is rounding.
const ROUNDING: f64 = 1e-9;

/// Places that the tool does not reach and that are smaller than this part of the square of its radius are
/// not listed: a right-angled corner has 0.21.
const LISTED: f64 = 0.25;

/// What is cleared on a level.
#[derive(Debug, Clone)]
pub struct Shape {
    /// All that is to be cleared.
    pub pocket: Region,
    /// Where the cutter's centre may be.
    pub centers: Region,
    /// What the cutter can reach.
    pub reach: Region,
}

/// One level.
#[derive(Debug, Clone, Copy)]
pub struct Level {
    /// Where its material begins, mm.
    pub top_z_mm: f64,
    /// Its floor, mm.
    pub z_mm: f64,
    /// The index of its shape.
    pub shape: usize,
}

/// A place that stays uncut.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Uncut {
    pub area_mm2: f64,
    pub at: Point2<f64>,
}

/// An island of a level.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Island {
    pub area_mm2: f64,
    pub centroid: Point2<f64>,
    /// The distance to the nearest other island, mm; none if there is no other.
    pub nearest_island_mm: Option<f64>,
    /// The distance to the wall, mm.
    pub wall_mm: f64,
}

/// The levels of a job from the top down, and their shapes. Each level but the last is the largest stepdown
/// deep; the last ends on the floor.
///
/// # Errors
/// When a region cannot be computed, or there are too many levels.
pub fn levels(job: &Job, budget: &Budget) -> Result<(Vec<Shape>, Vec<Level>), PocketError> {
    let depth = job.top_z_mm - job.floor_z_mm;
    let count = (depth / job.stepdown_max_mm - ROUNDING).ceil().max(1.0);
    if count > MOST_LEVELS as f64 {
        return Err(PocketError::TooMuchWork { what: "levels", limit: MOST_LEVELS });
    }
    let count = count as usize;
    let z =
        |k: usize| if k == count { job.floor_z_mm } else { job.top_z_mm - k as f64 * job.stepdown_max_mm };
    let shape = Shape::new(region(&job.area, budget)?, job.tool.radius_mm, budget)?;
    shape.check_work(job)?;
    let level = |k: usize| Level { top_z_mm: z(k), z_mm: z(k + 1), shape: 0 };
    Ok((vec![shape], (0..count).map(level).collect()))
}

/// The region inside the wall and outside all islands.
fn region(area: &Outlines, budget: &Budget) -> Result<Region, PocketError> {
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

impl Shape {
    pub fn new(pocket: Region, radius_mm: f64, budget: &Budget) -> Result<Self, PocketError> {
        let centers = pocket.offset_inward(radius_mm, budget)?;
        if centers.is_empty() {
            return Err(too_large(&pocket, radius_mm, budget)?);
        }
        let reach = centers.offset_outward(radius_mm, budget)?;
        Ok(Self { pocket, centers, reach })
    }

    /// Refuses a pocket whose path would be very long in terms of the cutter.
    fn check_work(&self, job: &Job) -> Result<(), PocketError> {
        let edge: f64 = self.centers.outlines().flat_map(Outline::elements).map(Element::length).sum();
        let length = edge + self.reach.area() / job.stepover_mm;
        if length > MOST_RADII as f64 * job.tool.radius_mm {
            let what = "times the cutter's radius as length of a path";
            return Err(PocketError::TooMuchWork { what, limit: MOST_RADII });
        }
        Ok(())
    }

    /// The area that the tool cannot reach, mm², and its largest places.
    pub fn unreachable(&self, radius_mm: f64, budget: &Budget) -> Result<(f64, Vec<Uncut>), PocketError> {
        let area_mm2 = (self.pocket.area() - self.reach.area()).max(0.0);
        let left = self.pocket.difference(&self.reach, budget)?;
        let uncut = |part: &Region| Uncut { area_mm2: part.area(), at: centroid(part.outlines()) };
        let parts = left.parts();
        let mut places: Vec<Uncut> =
            parts.iter().map(uncut).filter(|uncut| uncut.area_mm2 > LISTED * radius_mm * radius_mm).collect();
        places.sort_by(|a, b| b.area_mm2.total_cmp(&a.area_mm2));
        Ok((area_mm2, places))
    }

    pub fn islands(&self) -> Vec<Island> {
        let faces = self.pocket.faces();
        let islands: Vec<(&Outline, &Outline)> = faces
            .iter()
            .flat_map(|face| face.islands.iter().map(move |island| (island, &face.outer)))
            .collect();
        let between = |a: &Outline, b: &Outline| a.distance(b);
        let figures = |k: usize| {
            let (island, wall) = islands[k];
            let others = (0..islands.len()).filter(|other| *other != k);
            Island {
                area_mm2: island.area().abs(),
                centroid: centroid([island].into_iter()),
                nearest_island_mm: others
                    .map(|other| between(island, islands[other].0))
                    .min_by(f64::total_cmp),
                wall_mm: between(island, wall),
            }
        };
        (0..islands.len()).map(figures).collect()
    }
}

/// The error of a tool that fits nowhere.
fn too_large(pocket: &Region, radius_mm: f64, budget: &Budget) -> Result<PocketError, PocketError> {
    let at = deepest(pocket, radius_mm, budget)?;
    let largest_mm = 2.0 * pocket.distance_to_boundary(at);
    Ok(PocketError::ToolTooLarge { diameter_mm: 2.0 * radius_mm, largest_mm, at })
}

/// The centroid of the area inside outlines.
fn centroid<'a>(outlines: impl Iterator<Item = &'a Outline>) -> Point2<f64> {
    let (mut area, mut sum) = (0.0, nalgebra::Vector2::zeros());
    for outline in outlines {
        let own = outline.area();
        area += own;
        sum += outline.centroid().coords * own;
    }
    Point2::from(sum / area)
}

//! The levels of a pocket, and the shape that is cleared on each.

use nalgebra::Point2;

use super::PocketError;
use super::cleared::{Cleared, paths_over};
use super::depth::deepest;
use super::job::Job;
use super::part::Part;
use crate::budget::Budget;
use crate::geometry::region::{Outline, Region};
use crate::geometry::segment::Segment;

/// The most levels.
pub const MOST_LEVELS: usize = 1000;

/// The longest path of a level, in radii of the cutter.
pub const MOST_RADII: usize = 200_000;

/// A level that would end less than this part of a stepdown above the pocket's floor ends on the floor: the
/// difference is rounding.
const ROUNDING: f64 = 1e-9;

/// Places that the tool does not reach and that are smaller than this part of the square of its radius are
/// not listed: a right-angled corner has 0.21.
const LISTED: f64 = 0.25;

/// What is cleared on a level.
#[derive(Debug, Clone)]
pub struct Shape {
    /// All that is to be cleared. It differs from `walls` only with labelling.
    pub pocket: Region,
    /// The places that the part leaves free at the level's floor. The cutter must not touch what is outside.
    pub walls: Region,
    /// Where the cutter's centre may be.
    pub centers: Region,
    /// What the cutter can reach.
    pub reach: Region,
    /// Bound of the error of the walls, mm. The cutter's centre stays this much farther away from the walls
    /// than the radius.
    pub deviation_mm: f64,
    /// Paths of the cutter over what earlier tools have emptied.
    pub emptied: Vec<Vec<Segment>>,
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
    /// The thickest material that the level leaves on slopes of a relief, mm; none without a roughing
    /// allowance.
    pub leftover_mm: Option<f64>,
}

/// A place that stays uncut.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, utoipa::ToSchema), schema(as = UncutPlace))]
pub struct Uncut {
    /// Area, in mm2.
    pub area_mm2: f64,
    /// Centroid `[x, y]`, in mm.
    #[cfg_attr(feature = "wire", schema(value_type = [f64; 2]))]
    pub at: Point2<f64>,
}

/// An island of a level.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, utoipa::ToSchema), schema(as = PocketIsland))]
pub struct Island {
    /// Area, in mm2.
    pub area_mm2: f64,
    /// Centroid `[x, y]`, in mm.
    #[cfg_attr(feature = "wire", schema(value_type = [f64; 2]))]
    pub centroid: Point2<f64>,
    /// Distance to the nearest other island, in mm; `null` without another island.
    #[cfg_attr(feature = "wire", schema(required))]
    pub nearest_island_mm: Option<f64>,
    /// Distance to the wall, in mm.
    pub wall_mm: f64,
}

/// The heights of a job.
#[derive(Debug, Clone, Copy)]
pub struct Heights {
    /// Top of the stock, mm.
    pub top_z_mm: f64,
    /// The height of the stock's top or of the part's highest point, whichever is higher, mm.
    pub highest_mm: f64,
    /// Bound of the error of the walls of all levels, mm.
    pub deviation_mm: f64,
    /// By how much the part may be higher than a level's floor in places that the level clears, mm.
    pub overlap_mm: f64,
}

/// The levels of a job from the top down, and their shapes. Each level but the last is as deep as the
/// stepdown and the allowance permit; the last ends on the floor.
///
/// # Errors
/// When a region cannot be computed, there are too many levels, or nothing can be cut on any level.
pub fn levels(job: &Job, budget: &Budget) -> Result<(Heights, Vec<Shape>, Vec<Level>), PocketError> {
    let part = Part::new(job, budget)?;
    let highest = part.highest_mm();
    let top_z_mm = job.top_z_mm.or(highest).unwrap_or(0.0);
    if job.floor_z_mm >= top_z_mm {
        return Err(PocketError::FloorNotBelowTop { floor_mm: job.floor_z_mm, top_mm: top_z_mm });
    }
    let heights = Heights {
        top_z_mm,
        highest_mm: highest.map_or(top_z_mm, |highest| highest.max(top_z_mm)),
        deviation_mm: part.deviation_mm(),
        overlap_mm: part.overlap_mm(),
    };
    let cleared = Cleared::new(&job.cleared, budget)?;
    let mut shapes: Vec<Shape> = Vec::new();
    let mut levels = Vec::new();
    for [top_z_mm, z_mm] in floors(job, &part, top_z_mm)? {
        let walls = part.region_at(z_mm, budget)?;
        let is_known = |shape: &Shape| shape.walls.faces() == walls.faces();
        // With labelling, levels with equal walls may have different cells.
        let labelled = part.labelled_at(z_mm, budget)?;
        if labelled.is_some() || !cleared.is_empty() || !shapes.last().is_some_and(is_known) {
            let pocket = labelled.unwrap_or_else(|| walls.clone());
            let radius = job.tool.radius_mm;
            let mut shape = Shape::new(pocket, walls, radius, heights.deviation_mm, budget)?;
            shape.check_work(job)?;
            if !cleared.is_empty() {
                let emptied = cleared.at(z_mm, budget)?;
                shape.emptied = paths_over(&emptied, &shape.pocket, radius, budget)?;
            }
            shapes.push(shape);
        }
        let leftover_mm = job.roughing_allowance_mm.map(|_| part.leftover_mm(top_z_mm, z_mm));
        levels.push(Level { top_z_mm, z_mm, shape: shapes.len() - 1, leftover_mm });
    }
    if shapes.iter().all(|shape| shape.centers.is_empty()) {
        let Some(pocket) = shapes.iter().map(|shape| &shape.pocket).find(|pocket| !pocket.is_empty()) else {
            return Err(PocketError::NothingToCut);
        };
        return Err(too_large(pocket, job.tool.radius_mm, budget)?);
    }
    Ok((heights, shapes, levels))
}

/// The top and the floor of each level, mm.
fn floors(job: &Job, part: &Part, top_z_mm: f64) -> Result<Vec<[f64; 2]>, PocketError> {
    let mut floors = Vec::new();
    let mut z = top_z_mm;
    while z > job.floor_z_mm {
        if floors.len() >= MOST_LEVELS {
            return Err(PocketError::TooMuchWork { what: "levels", limit: MOST_LEVELS });
        }
        let most = job.stepdown_max_mm;
        let depth = job.roughing_allowance_mm.map_or(most, |allowance| part.depth_mm(z, most, allowance));
        // As long as all levels are as deep as the stepdown, floors are counted from the top, so that
        // rounding does not add up.
        let next = if depth == most && floors.len() as f64 * most == top_z_mm - z {
            top_z_mm - (floors.len() + 1) as f64 * most
        } else {
            z - depth
        };
        let is_last = next <= job.floor_z_mm + ROUNDING * most;
        let next = if is_last { job.floor_z_mm } else { next };
        floors.push([z, next]);
        z = next;
    }
    Ok(floors)
}

impl Shape {
    /// The shape of a level that clears `pocket` between `walls`, which may be wrong by `deviation_mm`.
    fn new(
        pocket: Region,
        walls: Region,
        radius_mm: f64,
        deviation_mm: f64,
        budget: &Budget,
    ) -> Result<Self, PocketError> {
        let centers = pocket.offset_inward(radius_mm + deviation_mm, budget)?;
        let reach = centers.offset_outward(radius_mm, budget)?;
        Ok(Self { pocket, walls, centers, reach, deviation_mm, emptied: Vec::new() })
    }

    /// About the length of a path that clears the shape, mm.
    pub fn path_length_mm(&self, stepover_mm: f64) -> f64 {
        let edge: f64 = self.centers.outlines().flat_map(Outline::elements).map(Segment::length).sum();
        edge + self.reach.area() / stepover_mm
    }

    /// Refuses a pocket whose path would be very long in terms of the cutter.
    fn check_work(&self, job: &Job) -> Result<(), PocketError> {
        if self.path_length_mm(job.stepover_mm) > MOST_RADII as f64 * job.tool.radius_mm {
            let what = "cutter radii of path on a level";
            return Err(PocketError::TooMuchWork { what, limit: MOST_RADII });
        }
        Ok(())
    }

    /// What the tool cannot reach.
    pub fn not_reached(&self, budget: &Budget) -> Result<Region, PocketError> {
        if self.deviation_mm == 0.0 {
            return Ok(self.pocket.difference(&self.reach, budget)?);
        }
        let reach = self.reach.offset_outward(self.deviation_mm, budget)?;
        Ok(self.pocket.difference(&reach, budget)?)
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

/// The connected parts of what is not reached that are larger than corners, the largest first.
pub fn largest_places(not_reached: &Region, radius_mm: f64) -> Vec<Uncut> {
    let uncut = |part: &Region| Uncut { area_mm2: part.area(), at: centroid(part.outlines()) };
    let parts = not_reached.parts();
    let mut places: Vec<Uncut> =
        parts.iter().map(uncut).filter(|uncut| uncut.area_mm2 > LISTED * radius_mm * radius_mm).collect();
    places.sort_by(|a, b| b.area_mm2.total_cmp(&a.area_mm2));
    places
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

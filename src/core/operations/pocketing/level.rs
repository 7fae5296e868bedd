//! The levels of a pocket, and the shape that is cleared on each.

use nalgebra::Point2;

use super::PocketError;
use super::cleared::{Cleared, paths_over};
use super::depth::{largest_disc, with_room};
use super::entry::SHORTEST_RAMP;
use super::job::Job;
use super::opened::Opened;
use super::part::Part;
use crate::budget::Budget;
use crate::geometry::region::{Outline, Region};
use crate::geometry::segment::Segment;
use crate::geometry::spacing::spaces;

/// The most levels.
pub const MOST_LEVELS: usize = 1000;

/// The longest path of a level, in radii of the cutter.
pub const MOST_RADII: usize = 200_000;

/// The thickest layer that is left to the pass along the walls, in radii of the cutter. A thicker one would
/// stay in part.
const THICKEST_LAYER: f64 = 0.95;

/// How often the distance from the walls is halved where a part has no room for it.
const NARROWER: usize = 4;

/// A level may be deeper than the stepdown by so much, mm, rather than that another level is needed: no
/// control is set, and no tool cuts, so exactly.
const DEEPER_MM: f64 = 1e-3;

/// Places that the tool does not reach and that are smaller than this part of the square of its radius are
/// not listed: a right-angled corner has 0.21.
const LISTED: f64 = 0.25;

/// A cutter may be wider than a slot by up to twice this, mm: coordinates of outlines are rounded. It cuts so
/// far into the walls at most, which is less than the check allows.
const WIDER_MM: f64 = 8e-6;

/// What is cleared on a level.
#[derive(Debug, Clone)]
pub struct Shape {
    /// All that is to be cleared. It differs from `walls` only with labelling.
    pub pocket: Region,
    /// The places that the part leaves free at the level's floor. The cutter must not touch what is outside.
    pub walls: Region,
    /// Where the cutter's centre may be.
    pub room: Room,
    /// What the cutter can reach.
    pub reach: Region,
    /// Bound of the error of the walls, mm. The cutter's centre stays this much farther away from the walls
    /// than the radius.
    pub deviation_mm: f64,
    /// What is left on the walls for finishing, mm.
    pub allowance_mm: f64,
    /// Paths of the cutter over what earlier tools have emptied, and over the air.
    pub emptied: Vec<Vec<Segment>>,
    /// What open edges and the stock change.
    pub opened: Option<Opened>,
}

/// Where the cutter's centre may be, and where it is while nothing but the last pass touches walls.
#[derive(Debug, Clone)]
pub struct Room {
    /// The centre may be here: the pass along walls and islands follows the boundary.
    pub centers: Region,
    /// Entries, lifts, links and rapids stay here, away from walls and islands.
    pub safe: Region,
    /// The passes before the last one along the walls stay here. What they leave is a layer about as thick as
    /// a stepover.
    pub inner: Region,
    /// Whether the layer is as thick as a stepover: it is thinner if the stepover is about the radius or
    /// more.
    pub is_layer_whole: bool,
    /// How far the safe region is inside, where there is room for that, mm.
    pub side_mm: f64,
}

/// What is cut on a level.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stage {
    Roughing,
    /// What roughing leaves on the floor.
    Floor,
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
    /// What is cut on it.
    pub stage: Stage,
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
    let mut levels: Vec<Level> = Vec::new();
    let mut ranges: Vec<([f64; 2], Stage)> =
        floors(job, &part, top_z_mm)?.into_iter().map(|range| (range, Stage::Roughing)).collect();
    let finishing = job.finishing_floor();
    if finishing.is_some() {
        ranges.push(([job.floor_z_mm + job.floor_allowance_mm, job.floor_z_mm], Stage::Floor));
    }
    for ([top_z_mm, z_mm], stage) in ranges {
        let job = finishing.as_ref().filter(|_| stage == Stage::Floor).unwrap_or(job);
        let walls = part.region_at(z_mm, budget)?;
        let is_known = |shape: &Shape| {
            shape.walls.faces() == walls.faces() && levels.last().is_some_and(|level| level.stage == stage)
        };
        // With labelling, levels with equal walls may have different cells.
        let labelled = part.labelled_at(z_mm, budget)?;
        if labelled.is_some() || !cleared.is_empty() || !shapes.last().is_some_and(is_known) {
            let pocket = labelled.unwrap_or_else(|| walls.clone());
            let radius = job.tool.radius_mm;
            let opened = part.opened_at(&walls, budget)?;
            let mut shape = Shape::new(pocket, walls, opened, job, heights.deviation_mm, budget)?;
            shape.check_work(job)?;
            if !cleared.is_empty() {
                let emptied = cleared.at(z_mm, budget)?;
                shape.emptied.extend(paths_over(&emptied, &shape.pocket, radius, budget)?);
            }
            shapes.push(shape);
        }
        let leftover_mm = job.roughing_allowance_mm.map(|_| part.leftover_mm(top_z_mm, z_mm));
        levels.push(Level { top_z_mm, z_mm, shape: shapes.len() - 1, stage, leftover_mm });
    }
    if shapes.iter().all(|shape| shape.room.centers.is_empty()) {
        let Some(pocket) = shapes.iter().map(|shape| &shape.pocket).find(|pocket| !pocket.is_empty()) else {
            return Err(PocketError::NothingToCut);
        };
        return Err(too_large(pocket, job.tool.radius_mm, budget)?);
    }
    Ok((heights, shapes, levels))
}

/// The top and the floor of each level, mm. The levels are as deep as each other, unless an allowance makes
/// them less deep.
fn floors(job: &Job, part: &Part, top_z_mm: f64) -> Result<Vec<[f64; 2]>, PocketError> {
    let floor_z_mm = job.floor_z_mm + job.floor_allowance_mm;
    let mut floors: Vec<[f64; 2]> = Vec::new();
    // The heights from which levels are counted evenly, so that rounding does not add up.
    let (mut from, mut done) = (top_z_mm, 0);
    while floors.last().map_or(top_z_mm, |last| last[1]) > floor_z_mm {
        if floors.len() >= MOST_LEVELS {
            return Err(PocketError::TooMuchWork { what: "levels", limit: MOST_LEVELS });
        }
        let z = floors.last().map_or(top_z_mm, |last| last[1]);
        let count = spaces(from - floor_z_mm, job.stepdown_max_mm + DEEPER_MM);
        let even = if done + 1 >= count as usize {
            floor_z_mm
        } else {
            from - (from - floor_z_mm) * ((done + 1) as f64 / count)
        };
        let depth = job.roughing_allowance_mm.map(|allowance| part.depth_mm(z, z - even, allowance));
        let next = match depth {
            Some(depth) if depth < z - even => {
                (from, done) = (z - depth, 0);
                z - depth
            }
            _ => {
                done += 1;
                even
            }
        };
        floors.push([z, next]);
    }
    Ok(floors)
}

impl Room {
    /// The room about `centers`, where the cutter's centre may be.
    pub fn new(centers: Region, job: &Job, budget: &Budget) -> Result<Self, PocketError> {
        let side_mm = job.side_mm();
        let thickest_mm = THICKEST_LAYER * job.tool.radius_mm;
        let is_layer_whole = job.stepover_mm <= thickest_mm;
        let layer_mm = job.stepover_mm.min(thickest_mm).max(side_mm);
        let safe = inside(&centers, side_mm, budget)?;
        let inner = inside(&centers, layer_mm, budget)?;
        Ok(Self { centers, safe, inner, is_layer_whole, side_mm })
    }

    /// The room with x negated.
    #[must_use]
    pub fn mirrored(&self) -> Self {
        let Self { centers, safe, inner, is_layer_whole, side_mm } = self;
        Self {
            centers: centers.mirrored(),
            safe: safe.mirrored(),
            inner: inner.mirrored(),
            is_layer_whole: *is_layer_whole,
            side_mm: *side_mm,
        }
    }
}

/// What of each part of a region is `distance_mm` inside, or as far as the part has room for.
fn inside(region: &Region, distance_mm: f64, budget: &Budget) -> Result<Region, PocketError> {
    if distance_mm == 0.0 {
        return Ok(region.clone());
    }
    let whole = region.offset_inward(distance_mm, budget)?;
    let mut all = vec![whole];
    for part in region.parts() {
        let mut distance = distance_mm;
        for _ in 0..NARROWER {
            let inner = part.offset_inward(distance, budget)?;
            if !inner.is_empty() {
                if distance < distance_mm {
                    all.push(inner);
                }
                break;
            }
            distance *= 0.5;
        }
    }
    if all.len() == 1 {
        return Ok(all.swap_remove(0));
    }
    Ok(Region::union(&all.iter().collect::<Vec<_>>(), budget)?)
}

impl Shape {
    /// The same places without an allowance on the walls, and what has been cut with it counts as emptied.
    /// `job` is that of the pass that follows.
    pub fn finished(
        &self,
        job: &Job,
        emptied: Vec<Vec<Segment>>,
        budget: &Budget,
    ) -> Result<Self, PocketError> {
        let (pocket, walls) = (self.pocket.clone(), self.walls.clone());
        let mut shape = Self::new(pocket, walls, self.opened.clone(), job, self.deviation_mm, budget)?;
        shape.emptied.extend(emptied);
        Ok(shape)
    }

    /// Where material stands before the first level.
    pub fn material(&self) -> &Region {
        self.opened.as_ref().map_or(&self.pocket, |opened| &opened.material)
    }

    /// Whether the cutter can come in from the side over open edges.
    pub fn is_open(&self) -> bool {
        self.opened.as_ref().is_some_and(|opened| opened.has_zones)
    }

    /// The shape of a level that clears `pocket` between `walls`, which may be wrong by `deviation_mm`.
    fn new(
        pocket: Region,
        walls: Region,
        opened: Option<Opened>,
        job: &Job,
        deviation_mm: f64,
        budget: &Budget,
    ) -> Result<Self, PocketError> {
        let radius_mm = job.tool.radius_mm;
        let allowance_mm = job.allowance_mm;
        let centers = pocket.centers_of_disc(radius_mm + deviation_mm + allowance_mm, WIDER_MM, budget)?;
        // Where no ramp has room, the cutter cannot enter without a plunge or a hole.
        let needed_mm = if job.entry.plunge { 0.0 } else { SHORTEST_RAMP * radius_mm };
        let drilled = job.entry.at.filter(|_| job.entry.is_predrilled);
        let centers = with_room(centers, needed_mm, drilled);
        let mut reach = centers.offset_outward(radius_mm, budget)?;
        let mut emptied = Vec::new();
        if let Some(opened) = &opened {
            reach = reach.intersection(&opened.material, budget)?;
            emptied.clone_from(&opened.air);
        }
        let room = Room::new(centers, job, budget)?;
        Ok(Self { pocket, walls, room, reach, deviation_mm, allowance_mm, emptied, opened })
    }

    /// About the length of a path that clears the shape, mm.
    pub fn path_length_mm(&self, stepover_mm: f64) -> f64 {
        let edge: f64 = self.room.centers.outlines().flat_map(Outline::elements).map(Segment::length).sum();
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
        let kept_mm = self.deviation_mm + self.allowance_mm;
        if kept_mm == 0.0 {
            return Ok(self.material().difference(&self.reach, budget)?);
        }
        let reach = self.reach.offset_outward(kept_mm, budget)?;
        Ok(self.material().difference(&reach, budget)?)
    }

    pub fn islands(&self) -> Vec<Island> {
        let faces = self.material().faces();
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
    let (largest_mm, at) = largest_disc(pocket, radius_mm, budget)?;
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

//! Outlines of level faces in plan, and what stands around them.
//!
//! # Method
//! 1. Faces of one level that share edges are joined: their common edges vanish (`outline/rings`).
//! 2. The edges that remain become lines and arcs (`outline/plan`).
//! 3. Beside each edge of a face that looks up, the next face of the body is a wall if it goes up from there
//!    (`outline/walls`).
//!
//! # Known limitations
//! * Faces that touch without a common edge are outlines of their own.
//! * An outline is known to be covered by level faces that look down, and by walls that lean over it. A dome
//!   above an outline is not found.

mod plan;
mod rings;
mod walls;

use std::collections::BTreeMap;

use toolpathd_core::budget::{Budget, Stopped};
use toolpathd_core::geometry::region::{Outline as Boundary, Region, RegionError};
use toolpathd_core::geometry::segment::Segment;

use self::plan::NoPlan;
use self::rings::{HalfEdge, JoinedFaces, joined_faces};
use self::walls::{Beside, Surroundings};
use super::model::{LevelFaces, Model};
use crate::drawing::bulge;
use crate::fault::Place;
use crate::left_out::{LeftOut, LeftOuts};

/// Two outlines overlap if their common area is wider than this on the average, mm: above the rounding of
/// edges that lie one above the other.
const OVERLAP_MM: f64 = 1e-4;

/// The height of a wall's end is that of a level that is this near, mm.
const SAME_HEIGHT_MM: f64 = 1e-4;

/// Level faces of one body that hang together by edges.
#[derive(Debug, Clone, PartialEq)]
pub struct Outline {
    /// The places of the faces in [`Model::faces`].
    pub faces: Vec<usize>,
    pub outer: OutlineLoop,
    pub inner: Vec<OutlineLoop>,
    /// The area of the outer loop without the inner ones, mm2.
    pub area_mm2: f64,
    /// A bound for the distance of the loops from the edges, mm.
    pub deviation_max_mm: f64,
    /// Whether a face of the body is known to stand above, so that no tool reaches all of it from there.
    pub is_covered: bool,
}

/// A closed loop of lines and arcs.
#[derive(Debug, Clone, PartialEq)]
pub struct OutlineLoop {
    /// x, y and the bulge of the element to the next vertex, mm. Counterclockwise.
    pub vertices: Vec<[f64; 3]>,
    /// The area inside, mm2.
    pub area_mm2: f64,
    /// For each element whether a wall goes up from it. `false` for faces that look down.
    pub has_wall: Vec<bool>,
    /// The height at which all of its walls end. `None` without walls, or where they end at several heights.
    pub top_mm: Option<f64>,
    /// For an inner loop, whether a face within its box in plan reaches above the level.
    pub holds_higher: bool,
}

/// From how many elements of a loop walls go up.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Walled {
    All,
    Some,
    None,
}

/// The outlines of a model.
#[derive(Debug, Clone, PartialEq)]
pub struct Outlines {
    /// For each of [`Model::levels`] its outlines, in the order of their first faces.
    pub by_level: Vec<Vec<Outline>>,
    /// Edges that have no arcs. The faces of their body and level have no outlines.
    pub left_out: Vec<LeftOut>,
}

/// The outlines of all levels. Curves that are no lines or circles become arcs within the tolerance.
///
/// # Errors
/// When the budget ends.
pub fn outlines(model: &Model, tolerance_mm: f64, budget: &Budget) -> Result<Outlines, Stopped> {
    let mut left_out = LeftOuts::default();
    let mut surroundings: BTreeMap<usize, Surroundings> = BTreeMap::new();
    let mut by_level = Vec::with_capacity(model.levels.len());
    for (k, level) in model.levels.iter().enumerate() {
        budget.progress("outlines", k, model.levels.len());
        let mut found = Vec::new();
        for own in level.faces.chunk_by(|a, b| model.faces[*a].body == model.faces[*b].body) {
            budget.check()?;
            let body = model.faces[own[0]].body;
            let around = surroundings
                .entry(body)
                .or_insert_with(|| Surroundings::of(&model.bodies[body], &model.faces));
            let setting = Setting { model, level, around };
            match joined_faces(&model.faces, own, tolerance_mm, budget) {
                Ok(joined) => found.extend(joined.iter().map(|faces| setting.outline(faces))),
                Err((_, NoPlan::Stopped(stopped))) => return Err(stopped),
                Err((entity, NoPlan::Reason(reason))) => {
                    left_out.add("OUTLINE", reason, Place::Entity(entity));
                }
            }
        }
        found.sort_by(|a: &Outline, b| a.faces.cmp(&b.faces));
        by_level.push(found);
    }
    cover(model, &mut by_level, budget)?;
    Ok(Outlines { by_level, left_out: left_out.list() })
}

/// A level, and the faces of a body around it.
struct Setting<'a> {
    model: &'a Model,
    level: &'a LevelFaces,
    around: &'a Surroundings<'a>,
}

impl Setting<'_> {
    fn outline(&self, joined: &JoinedFaces) -> Outline {
        let (outer, mut is_covered) = self.ring(&joined.outer);
        let mut inner = Vec::with_capacity(joined.inner.len());
        for ring in &joined.inner {
            let (mut ring, is_leaning) = self.ring(ring);
            is_covered |= is_leaning;
            ring.holds_higher =
                self.level.is_up && self.around.stands_within(plan_box(&ring), self.level.height_mm);
            inner.push(ring);
        }
        let area_mm2 = outer.area_mm2 - inner.iter().map(|ring| ring.area_mm2).sum::<f64>();
        let rings = joined.inner.iter().chain([&joined.outer]);
        let deviation_max_mm = rings.map(|ring| rings::deviation_mm(ring)).fold(0.0, f64::max);
        Outline { faces: joined.faces.clone(), outer, inner, area_mm2, deviation_max_mm, is_covered }
    }

    /// A loop counterclockwise, and whether one of its walls leans over the level.
    fn ring(&self, ring: &[HalfEdge]) -> (OutlineLoop, bool) {
        let nothing = Beside { wall: None, is_leaning: false };
        let height_mm = self.level.height_mm;
        let beside: Vec<Beside> = ring
            .iter()
            .map(|half| if self.level.is_up { self.around.beside(half, height_mm) } else { nothing })
            .collect();
        let mut has_wall: Vec<bool> = Vec::new();
        for (half, beside) in ring.iter().zip(&beside) {
            has_wall.extend(vec![beside.wall.is_some(); half.plan.vertices.len() - 1]);
        }
        let mut vertices = rings::vertices(ring);
        let area = bulge::area(&vertices);
        if area < 0.0 {
            vertices = bulge::reversed(&vertices, true);
            has_wall.reverse();
        }
        let top = self.around.top(beside.iter().filter_map(|beside| beside.wall), height_mm);
        let top_mm = top.map(|top| self.of_level(top));
        let is_leaning = beside.iter().any(|beside| beside.is_leaning);
        let ring = OutlineLoop { vertices, area_mm2: area.abs(), has_wall, top_mm, holds_higher: false };
        (ring, is_leaning)
    }

    /// A height, or that of a level beside it.
    fn of_level(&self, height_mm: f64) -> f64 {
        let heights = self.model.levels.iter().map(|level| level.height_mm);
        let nearest = heights.min_by(|a, b| (a - height_mm).abs().total_cmp(&(b - height_mm).abs()));
        nearest.filter(|level| (level - height_mm).abs() <= SAME_HEIGHT_MM).unwrap_or(height_mm)
    }
}

impl OutlineLoop {
    pub fn walled(&self) -> Walled {
        match (self.has_wall.contains(&true), self.has_wall.contains(&false)) {
            (true, false) => Walled::All,
            (true, true) => Walled::Some,
            (false, _) => Walled::None,
        }
    }

    /// The stretches without walls between walls, each from a vertex on to another. None without walls.
    pub fn open(&self) -> Vec<[usize; 2]> {
        let n = self.has_wall.len();
        let begins = |k: &usize| !self.has_wall[*k] && self.has_wall[(*k + n - 1) % n];
        let end = |k: usize| (1..=n).map(|step| (k + step) % n).find(|k| self.has_wall[*k]);
        (0..n).filter(begins).filter_map(|k| end(k).map(|end| [k, end])).collect()
    }
}

/// Where an outline is: its level and its place there, its body, its height, and its box in plan.
struct Footprint {
    at: [usize; 2],
    body: usize,
    height_mm: f64,
    plan_box: [[f64; 2]; 2],
}

/// Finds the outlines above which faces of their bodies look down.
fn cover(model: &Model, by_level: &mut [Vec<Outline>], budget: &Budget) -> Result<(), Stopped> {
    let areas = |is_up: bool| -> Vec<Footprint> {
        let levels = by_level.iter().enumerate().filter(|(k, _)| model.levels[*k].is_up == is_up);
        let all = levels.flat_map(|(k, own)| own.iter().enumerate().map(move |(m, own)| ([k, m], own)));
        all.filter(|(_, own)| !(is_up && own.is_covered))
            .map(|(at, own)| {
                let body = model.faces[own.faces[0]].body;
                let height_mm = model.levels[at[0]].height_mm;
                Footprint { at, body, height_mm, plan_box: plan_box(&own.outer) }
            })
            .collect()
    };
    let ceilings = areas(false);
    let mut covered = Vec::new();
    for floor in areas(true) {
        let is_above = |ceiling: &&Footprint| {
            ceiling.body == floor.body
                && ceiling.height_mm > floor.height_mm
                && do_meet(ceiling.plan_box, floor.plan_box)
        };
        for ceiling in ceilings.iter().filter(is_above) {
            budget.check()?;
            let [a, b] = [&floor, ceiling].map(|area| &by_level[area.at[0]][area.at[1]]);
            if overlap(a, b, budget)? {
                covered.push(floor.at);
                break;
            }
        }
    }
    for [level, k] in covered {
        by_level[level][k].is_covered = true;
    }
    Ok(())
}

fn plan_box(ring: &OutlineLoop) -> [[f64; 2]; 2] {
    let corners = bulge::segments(&ring.vertices, true).flat_map(|element| element.bounding_box());
    let wider = |[low, high]: [[f64; 2]; 2], x: f64, y: f64| {
        [[low[0].min(x), low[1].min(y)], [high[0].max(x), high[1].max(y)]]
    };
    corners.fold([[f64::MAX; 2], [f64::MIN; 2]], |found, corner| wider(found, corner.x, corner.y))
}

fn do_meet([low, high]: [[f64; 2]; 2], [other_low, other_high]: [[f64; 2]; 2]) -> bool {
    (0..2).all(|k| low[k] < other_high[k] && other_low[k] < high[k])
}

/// Whether outlines have an area in common. Outlines that cross themselves count as overlapping.
fn overlap(a: &Outline, b: &Outline, budget: &Budget) -> Result<bool, Stopped> {
    let length = |outline: &Outline| {
        let rings = outline.inner.iter().chain([&outline.outer]);
        rings.map(|ring| bulge::length(&ring.vertices, true)).sum::<f64>()
    };
    let slack = OVERLAP_MM + a.deviation_max_mm + b.deviation_max_mm;
    let common = || -> Result<f64, RegionError> {
        let within = plan_box(&a.outer);
        let both = region(a, within, budget)?.zip(region(b, within, budget)?);
        both.map_or(Ok(f64::INFINITY), |(a, b)| Ok(a.intersection(&b, budget)?.area()))
    };
    match common() {
        Ok(area) => Ok(area > slack * length(a).min(length(b))),
        Err(RegionError::Stopped(stopped)) => Err(stopped),
        Err(_) => Ok(true),
    }
}

/// The area of an outline, without the inner loops that are beside a box; `None` if a loop crosses itself.
fn region(outline: &Outline, within: [[f64; 2]; 2], budget: &Budget) -> Result<Option<Region>, RegionError> {
    let boundary = |ring: &OutlineLoop| {
        let elements: Vec<Segment> = bulge::segments(&ring.vertices, true).collect();
        Boundary::new(&elements, budget).ok()
    };
    let Some(outer) = boundary(&outline.outer) else { return Ok(None) };
    let near = outline.inner.iter().filter(|ring| do_meet(plan_box(ring), within));
    let Some(inner) = near.map(boundary).collect::<Option<Vec<_>>>() else { return Ok(None) };
    Region::new(&[outer], &inner, budget).map(Some)
}

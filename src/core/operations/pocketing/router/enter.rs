//! Where the cutter comes down into the material.

use std::f64::consts::TAU;

use nalgebra::{Point2, Vector2};

use super::super::PocketError;
use super::super::chain::{begun_at, foot, nearest};
use super::super::entry::{self, Entry};
use super::super::links::{Pose, Room, TURNS, direct};
use super::{BESIDE_MM, LARGER_MM, Purpose, Router, STARTS};
use crate::geometry::region::{Containment, Outline, Region};
use crate::geometry::segment::{Segment, left};

/// A helix that has this part of the radius of the largest is good enough: a slot from a place that is far
/// away takes longer than the turns that it saves.
const GOOD: f64 = 0.5;

/// Places on the circle of a helix at which it may end.
const ENDS: usize = 8;

/// How far beside the material the cutter comes down in the air, as a part of its radius, and mm.
const BESIDE_MATERIAL: f64 = 0.05;
const BESIDE_MATERIAL_MM: f64 = 0.2;

/// The most places in the air from which a way into the material is looked for.
const MOST_PLACES: usize = 8;

impl Router<'_> {
    /// Comes down for a stroke, and goes to its start. Returns whether the cutter can come down in the
    /// connected part in which the stroke lies.
    pub(super) fn enter(&mut self, stroke: &[Segment]) -> Result<bool, PocketError> {
        let start = stroke[0].start();
        if self.is_free(start) {
            self.begin(start, Entry::Open);
            return Ok(true);
        }
        let k = self.part_of(start);
        if self.is_left_out(start)? {
            return Ok(false);
        }
        let to = Pose::before(&stroke[0]);
        if self.enter_where_told(k, to)? {
            return Ok(true);
        }
        if self.is_open && self.enter_from_air(k, to)? {
            return Ok(true);
        }
        let most = 0.5 * self.conditions.entry.max_diameter_mm;
        let helix = entry::helix(start, to.along, self.centers, self.conditions);
        if let Some((radius, entry)) = &helix
            && (*radius >= GOOD * most || *radius >= GOOD * self.deepest(k)?.1)
        {
            self.begin(start, entry.clone());
            return Ok(true);
        }
        if self.enter_aside(k, to)? {
            return Ok(true);
        }
        let here = helix.map(|(_, entry)| entry).or_else(|| entry::ramp(stroke, self.conditions));
        if let Some(entry) = here {
            self.begin(start, entry);
            return Ok(true);
        }
        if self.ramp_along_edge(k, to)? {
            return Ok(true);
        }
        if self.conditions.entry.plunge {
            self.begin(start, Entry::Plunge);
            return Ok(true);
        }
        self.leave_out(k, start)?;
        Ok(false)
    }

    /// The place at which the caller wants the cutter to come down, if it lies in a region.
    pub fn told_place(&self, region: &Region) -> Option<Point2<f64>> {
        self.conditions.entry.at.filter(|at| region.place(*at, BESIDE_MM) != Containment::Outside)
    }

    /// Comes down at the place that the caller chose, unless the cutter has been there already.
    fn enter_where_told(&mut self, k: usize, to: Pose) -> Result<bool, PocketError> {
        if self.parts()[k].is_entered {
            return Ok(false);
        }
        let region = self.parts()[k].region.clone();
        let Some(at) = self.told_place(&region) else { return Ok(false) };
        self.parts()[k].is_entered = true;
        if self.is_free(at) {
            return Ok(false);
        }
        let limits = self.conditions.entry;
        if !limits.is_predrilled {
            if self.helix_about(at, region.distance_to_boundary(at), to)? {
                return Ok(true);
            }
            if !limits.plunge {
                return Ok(false);
            }
        }
        self.plunge_at(at, to)
    }

    /// Comes straight down at a place, and goes on to a pose.
    fn plunge_at(&mut self, at: Point2<f64>, to: Pose) -> Result<bool, PocketError> {
        let Some(along) = (to.at - at).try_normalize(BESIDE_MM) else {
            self.begin(at, Entry::Plunge);
            return Ok(true);
        };
        let Some(way) = self.slot([Pose { at, along }, to])? else { return Ok(false) };
        self.begin(at, Entry::Plunge);
        self.follow(&way, Purpose::Cut)?;
        Ok(true)
    }

    /// Comes down where the largest helix fits, as near as possible, or on cleared ground if that is nearer.
    fn enter_aside(&mut self, k: usize, to: Pose) -> Result<bool, PocketError> {
        let most = 0.5 * self.conditions.entry.max_diameter_mm;
        let (place, room) = self.deepest(k)?;
        let center = if room > most + LARGER_MM {
            let budget = self.budget;
            let inner = self.parts()[k].region.offset_inward(most, budget)?;
            nearest_in(&inner, to.at).unwrap_or(place)
        } else {
            place
        };
        let fits = room >= 0.5 * self.conditions.entry.min_diameter_mm;
        let beyond = if fits { (center - to.at).norm() } else { f64::INFINITY };
        if let Some(place) = self.nearest_swept(k, to.at, beyond)
            && let Some(along) = (to.at - place).try_normalize(BESIDE_MM)
            && let Some(way) = self.slot([Pose { at: place, along }, to])?
        {
            self.begin(place, Entry::Open);
            self.follow(&way, Purpose::Cut)?;
            return Ok(true);
        }
        Ok(fits && self.helix_about(center, room, to)?)
    }

    /// The place on a loop that is nearest to the air in front of open edges: the index of the element, and
    /// the fraction of its length. `None` without such air.
    pub(super) fn nearest_to_air(&self, elements: &[Segment]) -> Option<(usize, f64)> {
        if !self.is_open {
            return None;
        }
        let stride = elements.len().div_ceil(STARTS).max(1);
        let places = (0..elements.len()).step_by(stride).flat_map(|k| [(k, 0.0), (k, 0.5)]);
        let distance = |(k, t): (usize, f64)| {
            let air = self.emptied.iter().flatten();
            air.map(|air| foot(air, elements[k].at(t)).0).fold(f64::INFINITY, f64::min)
        };
        places
            .map(|place| (distance(place), place))
            .min_by(|a, b| a.0.total_cmp(&b.0))
            .map(|(_, place)| place)
    }

    /// The first chain with an end in the air in front of open edges, and whether that is its last end.
    pub(super) fn end_in_air(&mut self, chains: &[Vec<Segment>]) -> Option<(usize, bool)> {
        if !self.is_open {
            return None;
        }
        chains.iter().enumerate().find_map(|(k, chain)| {
            let ends = [chain[0].start(), chain[chain.len() - 1].end()];
            ends.into_iter().position(|end| self.is_free(end)).map(|end| (k, end == 1))
        })
    }

    /// Comes down in the air, a little beside the place where the cutter would touch the material that is
    /// nearest to a pose, and goes on to the pose through the material.
    fn enter_from_air(&mut self, k: usize, to: Pose) -> Result<bool, PocketError> {
        let mut places: Vec<(f64, Point2<f64>)> =
            self.emptied.iter().flatten().map(|air| foot(air, to.at)).collect();
        places.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut tried = 0;
        let beside_mm = BESIDE_MATERIAL * self.conditions.radius_mm + BESIDE_MATERIAL_MM;
        for (distance, touching) in places {
            // The air is known a little too large.
            let place = touching + (touching - to.at) * (beside_mm / distance.max(beside_mm));
            let is_in = self.parts()[k].region.place(place, BESIDE_MM) != Containment::Outside;
            if !is_in || !self.is_free(place) {
                continue;
            }
            if let Some(along) = (to.at - place).try_normalize(BESIDE_MM)
                && let Some(way) = self.slot([Pose { at: place, along }, to])?
            {
                self.begin(place, Entry::Open);
                self.follow(&way, Purpose::Cut)?;
                return Ok(true);
            }
            tried += 1;
            if tried == MOST_PLACES {
                break;
            }
        }
        Ok(false)
    }

    /// The place on the path so far, in a part, that is nearest to a place and nearer than `within_mm`.
    fn nearest_swept(&mut self, k: usize, p: Point2<f64>, within_mm: f64) -> Option<Point2<f64>> {
        let mut best: Option<(f64, Point2<f64>)> = None;
        for run in 0..self.runs.len() {
            for step in 0..self.runs[run].steps.len() {
                let place = self.runs[run].steps[step].element.end();
                let distance = (place - p).norm();
                if distance < best.map_or(within_mm, |(least, _)| least)
                    && self.parts()[k].region.place(place, BESIDE_MM) != Containment::Outside
                    && self.is_free(place)
                {
                    best = Some((distance, place));
                }
            }
        }
        best.map(|(_, place)| place)
    }

    /// Comes down on the largest helix about a place that has this much room, and goes on to a pose.
    fn helix_about(&mut self, center: Point2<f64>, room_mm: f64, to: Pose) -> Result<bool, PocketError> {
        let limits = self.conditions.entry;
        let radius = room_mm.min(0.5 * limits.max_diameter_mm);
        if radius < 0.5 * limits.min_diameter_mm {
            return Ok(false);
        }
        let end = |k: usize| {
            let (sin, cos) = (TAU * k as f64 / ENDS as f64).sin_cos();
            let spoke = Vector2::new(cos, sin);
            Pose { at: center + spoke * radius, along: left(spoke) }
        };
        let mut best: Option<(f64, Pose, Vec<Segment>)> = None;
        for from in (0..ENDS).map(end) {
            let Some(way) = self.straight_slot([from, to]) else { continue };
            let length = way.iter().map(Segment::length).sum();
            if best.as_ref().is_none_or(|(least, ..)| length < *least) {
                best = Some((length, from, way));
            }
        }
        if best.is_none() {
            for from in (0..ENDS).map(end) {
                if let Some(way) = self.slot([from, to])? {
                    best = Some((0.0, from, way));
                    break;
                }
            }
        }
        let Some((_, from, way)) = best else { return Ok(false) };
        self.begin(from.at, Entry::Helix { center, is_left: true });
        self.follow(&way, Purpose::Cut)?;
        Ok(true)
    }

    /// Comes down on a ramp along the edge of a part, near a pose, and goes on there.
    fn ramp_along_edge(&mut self, k: usize, to: Pose) -> Result<bool, PocketError> {
        let outlines: Vec<Vec<Segment>> =
            self.parts()[k].region.outlines().map(|outline| outline.elements().to_vec()).collect();
        let mut best: Option<(f64, Vec<Segment>)> = None;
        for elements in outlines {
            let (k, t) = nearest(&elements, to.at);
            let distance = (elements[k].at(t) - to.at).norm();
            if best.as_ref().is_none_or(|(least, _)| distance < *least) {
                best = Some((distance, begun_at(&elements, k, t)));
            }
        }
        let Some((distance, edge)) = best else { return Ok(false) };
        let Some(entry) = entry::ramp(&edge, self.conditions) else { return Ok(false) };
        let from = edge[0].start();
        let way = if distance <= BESIDE_MM {
            vec![Segment::Line { start: from, end: to.at }]
        } else {
            let Some(along) = (to.at - from).try_normalize(BESIDE_MM) else { return Ok(false) };
            let Some(way) = self.slot([Pose { at: from, along }, to])? else { return Ok(false) };
            way
        };
        self.begin(from, entry);
        self.follow(&way, Purpose::Cut)?;
        Ok(true)
    }

    /// A way in the region, through whatever is there.
    fn slot(&mut self, ends: [Pose; 2]) -> Result<Option<Vec<Segment>>, PocketError> {
        if let Some(way) = self.straight_slot(ends) {
            return Ok(Some(way));
        }
        let ways = self.links.around(ends, Room::Material, f64::INFINITY, self.budget)?;
        if let Some(way) = ways.into_iter().find(|way| self.is_allowed(way)) {
            return Ok(Some(way));
        }
        let line = Segment::Line { start: ends[0].at, end: ends[1].at };
        Ok(self.is_allowed(&[line]).then(|| vec![line]))
    }

    /// The shortest way in the region along two arcs and the line that touches both.
    fn straight_slot(&self, ends: [Pose; 2]) -> Option<Vec<Segment>> {
        let radii = TURNS.map(|turn| turn * self.conditions.radius_mm);
        direct(ends, radii).into_iter().find(|way| self.is_allowed(way))
    }
}

/// The place of a region that is nearest to `p`; `None` for an empty region.
fn nearest_in(region: &Region, p: Point2<f64>) -> Option<Point2<f64>> {
    if region.place(p, 0.0) == Containment::Inside {
        return Some(p);
    }
    let on = |outline: &Outline| {
        let (k, t) = nearest(outline.elements(), p);
        outline.elements()[k].at(t)
    };
    region.outlines().map(on).min_by(|a, b| (a - p).norm().total_cmp(&(b - p).norm()))
}

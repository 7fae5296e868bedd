//! Joins strokes into runs: chooses where closed strokes begin, how the cutter gets from one stroke to the
//! next, and where it comes down.

mod approach;
mod enter;
mod parts;

use nalgebra::{Point2, Vector2};

use super::PocketError;
use super::chain::{begun_at, nearest};
use super::conditions::Conditions;
use super::entry::{self, Entry};
use super::links::{Links, Pose};
use super::pieces::{Pieces, pieces};
use super::work;
use crate::budget::Budget;
use crate::geometry::region::Region;
use crate::geometry::segment::{Segment, left};
use crate::machining::engagement::{Enough, Stretch, Swept};
use parts::Place;

/// Where the cutter comes straight down, at most a rim of this width is not cleared, mm.
const OPEN_MARGIN_MM: f64 = 0.05;

/// How near the wall a cutter's centre may come to its limit, mm: above the rounding of offsets.
const BESIDE_MM: f64 = 2e-6;

/// How far before the rest of the material a stroke begins, in radii of the cutter.
const LEAD: f64 = 0.25;

/// Places at which a closed stroke may begin.
const STARTS: usize = 24;

/// A helix at a later place has to be larger by this, mm. Helices that fit equally well at several places
/// differ by rounding, which must not choose between them.
const LARGER_MM: f64 = 1e-6;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Purpose {
    Cut,
    Link,
    /// The way to the start of a pass along a wall, through what that pass cuts.
    LeadIn,
    /// The way from its end.
    LeadOut,
}

/// One motion at the level's floor, with the angles in material along it.
#[derive(Debug, Clone)]
pub struct Step {
    pub element: Segment,
    pub purpose: Purpose,
    pub angles: Vec<Stretch>,
}

/// What is cut without a lift.
#[derive(Debug, Clone)]
pub struct Run {
    pub start: Point2<f64>,
    pub entry: Entry,
    pub steps: Vec<Step>,
}

impl Run {
    /// Where the cutter comes down and where it is lifted.
    pub fn ends(&self) -> [Point2<f64>; 2] {
        [self.start, self.steps.last().map_or(self.start, |step| step.element.end())]
    }

    /// The run with x negated.
    #[must_use]
    pub fn mirrored(&self) -> Self {
        let start = Point2::new(-self.start.x, self.start.y);
        let steps = self.steps.iter();
        let mirrored = |step: &Step| Step { element: step.element.mirrored(), ..step.clone() };
        Self { start, entry: self.entry.mirrored(), steps: steps.map(mirrored).collect() }
    }

    /// What the cutter's centre follows on the level's floor.
    pub fn chain(&self) -> Vec<Segment> {
        let steps = self.steps.iter().map(|step| step.element);
        self.entry.footprint(self.start).into_iter().chain(steps).collect()
    }
}

pub struct Router<'a> {
    pub conditions: &'a Conditions,
    centers: &'a Region,
    swept: Swept,
    links: Links<'a>,
    /// Paths over what is empty before the first cut: then only the rest is cut.
    emptied: &'a [Vec<Segment>],
    /// Whether some of that is in front of open edges, so that the cutter can come in from there.
    is_open: bool,
    runs: Vec<Run>,
    /// The centre of the circle on which the cutter may leave the last cut.
    leaving: Option<Point2<f64>>,
    /// The connected parts of the region of centres, from the first entry on.
    parts: Option<Vec<Place>>,
    budget: &'a Budget,
}

impl<'a> Router<'a> {
    /// `emptied` are paths over what is empty: what earlier tools have cut, and the air.
    pub fn new(
        conditions: &'a Conditions,
        centers: &'a Region,
        emptied: &'a [Vec<Segment>],
        budget: &'a Budget,
    ) -> Self {
        let mut swept = Swept::new(conditions.radius_mm);
        let mut links = Links::new(centers, conditions.radius_mm);
        for element in emptied.iter().flatten() {
            swept.push(element);
            links.sweep(element);
        }
        Self {
            conditions,
            centers,
            swept,
            links,
            emptied,
            is_open: false,
            runs: Vec::new(),
            leaving: None,
            parts: None,
            budget,
        }
    }

    /// Says whether the cutter comes in over open edges wherever it can.
    #[must_use]
    pub fn with_open_edges(self, is_open: bool) -> Self {
        Self { is_open, ..self }
    }

    pub fn finish(self) -> Vec<Run> {
        self.runs
    }

    /// What the cutter's centre has followed on the level's floor.
    pub fn chains(&self) -> Vec<Vec<Segment>> {
        self.runs.iter().map(Run::chain).collect()
    }

    pub fn at(&self) -> Option<Point2<f64>> {
        let run = self.runs.last()?;
        Some(run.steps.last().map_or(run.start, |step| step.element.end()))
    }

    /// From now on the centre may be in another region.
    pub fn move_within(&mut self, centers: &'a Region) {
        if !std::ptr::eq(self.centers, centers) {
            self.centers = centers;
            self.parts = None;
            self.links.move_within(centers);
        }
    }

    /// Whether the cutter may come straight down at a place.
    pub fn is_free(&mut self, p: Point2<f64>) -> bool {
        self.swept.is_free(p, OPEN_MARGIN_MM)
    }

    pub fn is_rest(&self) -> bool {
        !self.emptied.is_empty()
    }

    /// Cuts along a loop, from the place on it that is best to get to.
    pub fn cut_loop(&mut self, elements: &[Segment]) -> Result<(), PocketError> {
        if self.is_rest()
            && let Pieces::Some(pieces) = self.pieces(elements, LEAD)?
        {
            return self.cut_all(&pieces);
        }
        if let Some(at) = self.at() {
            let (k, t) = nearest(elements, at);
            let begun = begun_at(elements, k, t);
            if self.approach(&begun)? {
                return self.follow(&begun, Purpose::Cut);
            }
        }
        if self.is_left_out(elements[0].start())? {
            return Ok(());
        }
        if let Some((k, t)) = self.nearest_to_air(elements) {
            let begun = begun_at(elements, k, t);
            return if self.enter(&begun)? { self.follow(&begun, Purpose::Cut) } else { Ok(()) };
        }
        // A new entry: where the largest helix fits.
        let mut best: Option<(f64, Vec<Segment>)> = None;
        let stride = elements.len().div_ceil(STARTS);
        for k in (0..elements.len()).step_by(stride.max(1)) {
            for t in [0.0, 0.5] {
                let (p, along) = (elements[k].at(t), elements[k].direction(t));
                let radius =
                    entry::helix(p, along, self.centers, self.conditions).map_or(0.0, |(radius, _)| radius);
                if best.as_ref().is_none_or(|(most, _)| radius > *most + LARGER_MM) {
                    best = Some((radius, begun_at(elements, k, t)));
                }
            }
        }
        let Some((_, begun)) = best else { return Ok(()) };
        if self.enter(&begun)? { self.follow(&begun, Purpose::Cut) } else { Ok(()) }
    }

    /// Cuts along an open chain.
    pub fn cut_chain(&mut self, elements: &[Segment]) -> Result<(), PocketError> {
        if elements.is_empty() {
            return Ok(());
        }
        if self.is_rest()
            && let Pieces::Some(pieces) = self.pieces(elements, LEAD)?
        {
            return self.cut_all(&pieces);
        }
        self.cut_all(&[elements.to_vec()])
    }

    /// The pieces of a stroke along which there is material. Each begins `lead` radii of the cutter before
    /// its material. Over open edges it goes on as far behind the material, so that no burr stays at the
    /// edge.
    pub fn pieces(&mut self, stroke: &[Segment], lead: f64) -> Result<Pieces, PocketError> {
        self.check_work()?;
        let (swept, budget) = (&mut self.swept, self.budget);
        let survey = |element: &Segment, enough| swept.survey(element, Enough::Angle(enough), budget);
        let beyond = if self.is_open { lead } else { 0.0 };
        Ok(pieces(stroke, self.conditions.radius_mm, [lead, beyond], survey)?)
    }

    fn cut_all(&mut self, chains: &[Vec<Segment>]) -> Result<(), PocketError> {
        for chain in chains {
            if self.come_to(chain)? {
                self.follow(chain, Purpose::Cut)?;
            }
        }
        Ok(())
    }

    /// Cuts along chains, each of which may be closed, the nearest first.
    pub fn cut_nearest(&mut self, mut chains: Vec<Vec<Segment>>) -> Result<(), PocketError> {
        while !chains.is_empty() {
            let distance = |chain: &Vec<Segment>| self.at().map_or(0.0, |at| (chain[0].start() - at).norm());
            let k = (0..chains.len())
                .min_by(|a, b| distance(&chains[*a]).total_cmp(&distance(&chains[*b])))
                .unwrap_or(0);
            let chain = chains.remove(k);
            if chain[0].start() == chain[chain.len() - 1].end() {
                self.cut_loop(&chain)?;
            } else {
                self.cut_chain(&chain)?;
            }
        }
        Ok(())
    }

    /// Cuts along open chains in either direction, the nearest end first.
    pub fn cut_nearest_end(&mut self, mut chains: Vec<Vec<Segment>>) -> Result<(), PocketError> {
        while !chains.is_empty() {
            let mut best = (f64::INFINITY, 0, false);
            if self.at().is_none() {
                best = self.end_in_air(&chains).map_or(best, |(k, is_reversed)| (0.0, k, is_reversed));
            }
            if let Some(at) = self.at() {
                for (k, chain) in chains.iter().enumerate() {
                    let ends = [chain[0].start(), chain[chain.len() - 1].end()];
                    for (end, is_reversed) in ends.into_iter().zip([false, true]) {
                        let distance = (end - at).norm();
                        if distance < best.0 {
                            best = (distance, k, is_reversed);
                        }
                    }
                }
            }
            let (_, k, is_reversed) = best;
            let chain = chains.remove(k);
            if is_reversed {
                self.cut_chain(&chain.iter().rev().map(Segment::reversed).collect::<Vec<_>>())?;
            } else {
                self.cut_chain(&chain)?;
            }
        }
        Ok(())
    }

    /// Where the cutter is, and the direction in which it came there.
    pub fn heading(&self) -> Option<Pose> {
        let run = self.runs.last()?;
        match (run.steps.last(), &run.entry) {
            (Some(step), _) => Some(Pose::after(&step.element)),
            (None, Entry::Helix { center, is_left }) => {
                let sense = if *is_left { 1.0 } else { -1.0 };
                Some(Pose { at: run.start, along: left(run.start - center).normalize() * sense })
            }
            _ => None,
        }
    }

    /// Whether the centre may follow these elements.
    pub fn is_allowed(&self, elements: &[Segment]) -> bool {
        elements.iter().all(|element| self.centers.contains(element, BESIDE_MM))
    }

    /// The angle in material at a place, in a direction of motion.
    pub fn angle_at(&mut self, p: Point2<f64>, along: Vector2<f64>) -> f64 {
        self.swept.angle_at(p, along)
    }

    /// Whether all these elements run over cleared ground.
    fn are_clear(&mut self, elements: &[Segment]) -> Result<bool, PocketError> {
        for element in elements.iter().filter(|element| element.length() > 0.0) {
            if !self.is_clear(element)? {
                return Ok(false);
            }
        }
        Ok(true)
    }

    /// Refuses a path that takes too many comparisons.
    fn check_work(&self) -> Result<(), PocketError> {
        let is_too_much = self.swept.comparisons() > self.conditions.most_comparisons;
        if is_too_much { Err(work::too_much(self.conditions)) } else { Ok(()) }
    }

    fn is_clear(&mut self, link: &Segment) -> Result<bool, PocketError> {
        self.check_work()?;
        Ok(self.swept.is_clear(link, self.budget)?)
    }

    pub fn begin(&mut self, start: Point2<f64>, entry: Entry) {
        for element in entry.footprint(start) {
            self.swept.push(&element);
            self.links.sweep(&element);
        }
        self.runs.push(Run { start, entry, steps: Vec::new() });
    }

    pub fn follow(&mut self, elements: &[Segment], purpose: Purpose) -> Result<(), PocketError> {
        for element in elements.iter().filter(|element| element.length() > 0.0) {
            self.check_work()?;
            let enough = match purpose {
                Purpose::Link => Enough::Clear,
                _ => Enough::Angle(self.conditions.slot_angle),
            };
            let angles = self.swept.follow(element, enough, self.budget)?;
            if purpose != Purpose::Link {
                self.links.sweep(element);
            }
            if let Some(run) = self.runs.last_mut() {
                run.steps.push(Step { element: *element, purpose, angles });
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests;

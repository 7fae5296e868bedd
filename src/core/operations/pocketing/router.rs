//! Joins strokes into runs: chooses where closed strokes begin, how the cutter gets from one stroke to the
//! next, and where it comes down.

use nalgebra::{Point2, Vector2};

use super::PocketError;
use super::chain::{begun_at, foot, nearest};
use super::conditions::Conditions;
use super::depth::deepest;
use super::entry::{self, Entry};
use super::leads::{belt, lead_to};
use super::pieces::{Pieces, pieces};
use super::work;
use crate::budget::Budget;
use crate::geometry::region::Region;
use crate::geometry::segment::Segment;
use crate::machining::engagement::{Enough, Stretch, Swept};

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

/// The longest way through material from one stroke to the next, in stepovers.
const THROUGH: f64 = 2.0;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Purpose {
    Cut,
    Link,
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
    /// Whether earlier tools have emptied some of the pocket: then only the rest is cut.
    is_rest: bool,
    runs: Vec<Run>,
    /// The centre of the circle on which the cutter may leave the last cut.
    leaving: Option<Point2<f64>>,
    budget: &'a Budget,
}

impl<'a> Router<'a> {
    /// `emptied` are paths over what earlier tools have emptied.
    pub fn new(
        conditions: &'a Conditions,
        centers: &'a Region,
        emptied: &[Vec<Segment>],
        budget: &'a Budget,
    ) -> Self {
        let mut swept = Swept::new(conditions.radius_mm);
        emptied.iter().flatten().for_each(|element| swept.push(element));
        Self {
            conditions,
            centers,
            swept,
            is_rest: !emptied.is_empty(),
            runs: Vec::new(),
            leaving: None,
            budget,
        }
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

    pub fn is_rest(&self) -> bool {
        self.is_rest
    }

    /// Cuts along a loop, from the place on it that is best to get to.
    pub fn cut_loop(&mut self, elements: &[Segment]) -> Result<(), PocketError> {
        if self.is_rest
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
        self.enter(&begun)?;
        self.follow(&begun, Purpose::Cut)
    }

    /// Cuts along an open chain.
    pub fn cut_chain(&mut self, elements: &[Segment]) -> Result<(), PocketError> {
        if elements.is_empty() {
            return Ok(());
        }
        if self.is_rest
            && let Pieces::Some(pieces) = self.pieces(elements, LEAD)?
        {
            return self.cut_all(&pieces);
        }
        self.cut_all(&[elements.to_vec()])
    }

    /// The pieces of a stroke along which there is material. Each begins `lead` radii of the cutter before
    /// its material.
    pub fn pieces(&mut self, stroke: &[Segment], lead: f64) -> Result<Pieces, PocketError> {
        self.check_work()?;
        let (swept, budget) = (&mut self.swept, self.budget);
        let survey = |element: &Segment, enough| swept.survey(element, Enough::Angle(enough), budget);
        Ok(pieces(stroke, self.conditions.radius_mm, lead, survey)?)
    }

    fn cut_all(&mut self, chains: &[Vec<Segment>]) -> Result<(), PocketError> {
        for chain in chains {
            if !self.approach(chain)? {
                self.enter(chain)?;
            }
            self.follow(chain, Purpose::Cut)?;
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
    pub fn heading(&self) -> Option<(Point2<f64>, Vector2<f64>)> {
        let run = self.runs.last()?;
        match (run.steps.last(), &run.entry) {
            (Some(step), _) => Some((step.element.end(), step.element.direction(1.0))),
            (None, Entry::Helix { center, is_left }) => {
                let spoke = run.start - center;
                let sense = if *is_left { 1.0 } else { -1.0 };
                Some((run.start, Vector2::new(-spoke.y, spoke.x).normalize() * sense))
            }
            _ => None,
        }
    }

    /// Whether the centre may follow these elements.
    pub fn is_allowed(&self, elements: &[Segment]) -> bool {
        elements.iter().all(|element| self.centers.contains(element, BESIDE_MM))
    }

    /// Says that the cutter may leave the last cut on the circle about this centre, to the left.
    pub fn leave_about(&mut self, center: Point2<f64>) {
        self.leaving = Some(center);
    }

    /// Comes to `start` on the circle about `center`, to the left: by a link from the last cut along two
    /// arcs and the line that touches both, or by a lift, whichever is allowed and faster.
    pub fn lead_to(&mut self, start: Point2<f64>, center: Point2<f64>) -> Result<(), PocketError> {
        let leaving = self.leaving.take();
        if let (Some(from), Some(at)) = (leaving, self.at()) {
            let belt = belt([at, start], [from, center]);
            let length: f64 = belt.iter().map(Segment::length).sum();
            let is_fast = self.conditions.link_seconds(length) <= self.conditions.lift_seconds(length);
            if is_fast && !belt.is_empty() && self.is_allowed(&belt) && self.are_clear(&belt)? {
                return self.follow(&belt, Purpose::Link);
            }
        }
        let lead = lead_to(start, center);
        if self.is_allowed(&[lead]) && self.swept.is_free(lead.start(), OPEN_MARGIN_MM) {
            self.begin(lead.start(), Entry::Open);
            return self.follow(&[lead], Purpose::Cut);
        }
        self.cut_chain(&[Segment::Line { start, end: start }])
    }

    /// The angle in material at a place, in a direction of motion.
    pub fn angle_at(&mut self, p: Point2<f64>, along: Vector2<f64>) -> f64 {
        self.swept.angle_at(p, along)
    }

    fn are_clear(&mut self, elements: &[Segment]) -> Result<bool, PocketError> {
        for element in elements.iter().filter(|element| element.length() > 0.0) {
            if !self.is_clear(element)? {
                return Ok(false);
            }
        }
        Ok(true)
    }

    /// Goes to the start of a stroke if it can be reached without an entry into the full material.
    fn approach(&mut self, stroke: &[Segment]) -> Result<bool, PocketError> {
        let Some(at) = self.at() else { return Ok(false) };
        let start = stroke[0].start();
        if at == start {
            return Ok(true);
        }
        let straight = Segment::Line { start: at, end: start };
        let length = straight.length();
        let is_allowed = self.centers.contains(&straight, BESIDE_MM);
        if is_allowed && self.is_clear(&straight)? {
            if self.conditions.link_seconds(length) <= self.conditions.lift_seconds(length)
                || !self.swept.is_free(start, OPEN_MARGIN_MM)
            {
                self.follow(&[straight], Purpose::Link)?;
            } else {
                self.begin(start, Entry::Open);
            }
            return Ok(true);
        }
        let conditions = self.conditions;
        let through = THROUGH * conditions.stepover_mm;
        if is_allowed && length <= through {
            self.follow(&[straight], Purpose::Cut)?;
            return Ok(true);
        }
        // From a place on the path so far that is near.
        let mut nearest: Option<(f64, Point2<f64>)> = None;
        for element in self.runs.iter().flat_map(|run| &run.steps).map(|step| &step.element) {
            let (distance, place) = foot(element, start);
            if distance <= through && nearest.is_none_or(|(least, _)| distance < least) {
                let way = Segment::Line { start: place, end: start };
                if distance <= BESIDE_MM || self.centers.contains(&way, BESIDE_MM) {
                    nearest = Some((distance, place));
                }
            }
        }
        let Some((distance, place)) = nearest else {
            if self.is_rest && self.swept.is_free(start, OPEN_MARGIN_MM) {
                return Ok(false);
            }
            let seconds = length / conditions.slot_feed.mm_per_s();
            let is_fast = seconds <= conditions.lift_seconds(length) + conditions.entry_seconds();
            if is_allowed && is_fast {
                self.follow(&[straight], Purpose::Cut)?;
            }
            return Ok(is_allowed && is_fast);
        };
        let link = Segment::Line { start: at, end: place };
        let length = link.length();
        let is_fast = self.conditions.link_seconds(length) <= self.conditions.lift_seconds(length);
        if length > 0.0 && is_fast && self.centers.contains(&link, BESIDE_MM) && self.is_clear(&link)? {
            self.follow(&[link], Purpose::Link)?;
        } else if length > 0.0 {
            self.begin(place, Entry::Open);
        }
        if distance > 0.0 {
            self.follow(&[Segment::Line { start: place, end: start }], Purpose::Cut)?;
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

    /// Comes down into the material at the start of a stroke.
    fn enter(&mut self, stroke: &[Segment]) -> Result<(), PocketError> {
        let start = stroke[0].start();
        if self.is_rest && self.swept.is_free(start, OPEN_MARGIN_MM) {
            self.begin(start, Entry::Open);
            return Ok(());
        }
        let helix = entry::helix(start, stroke[0].direction(0.0), self.centers, self.conditions);
        let entry = match helix {
            Some((_, entry)) => entry,
            None => match entry::ramp(stroke, self.conditions) {
                Some(entry) => entry,
                None => return Err(self.no_entry(start)?),
            },
        };
        self.begin(start, entry);
        Ok(())
    }

    /// The error where the cutter cannot come down, with the largest tool that can.
    fn no_entry(&self, at: Point2<f64>) -> Result<PocketError, PocketError> {
        let conditions = self.conditions;
        let parts = self.centers.parts();
        let here =
            parts.iter().min_by(|a, b| a.distance_to_boundary(at).total_cmp(&b.distance_to_boundary(at)));
        let room = here.map_or(Ok(0.0), |part| {
            deepest(part, conditions.radius_mm, self.budget).map(|place| part.distance_to_boundary(place))
        })?;
        let least_mm = conditions.entry.min_diameter_mm;
        let largest_mm = (2.0 * (conditions.radius_mm + room) - least_mm).max(0.0);
        Ok(PocketError::NoEntry { at, least_mm, largest_mm })
    }

    pub fn begin(&mut self, start: Point2<f64>, entry: Entry) {
        for element in entry.footprint(start) {
            self.swept.push(&element);
        }
        self.runs.push(Run { start, entry, steps: Vec::new() });
    }

    pub fn follow(&mut self, elements: &[Segment], purpose: Purpose) -> Result<(), PocketError> {
        for element in elements.iter().filter(|element| element.length() > 0.0) {
            self.check_work()?;
            let enough = match purpose {
                Purpose::Cut => Enough::Angle(self.conditions.slot_angle),
                Purpose::Link => Enough::Clear,
            };
            let angles = self.swept.follow(element, enough, self.budget)?;
            if let Some(run) = self.runs.last_mut() {
                run.steps.push(Step { element: *element, purpose, angles });
            }
        }
        Ok(())
    }
}

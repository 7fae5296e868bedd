//! The report of a pocket: each level with all candidates, and bounds over the whole toolpath.

use nalgebra::Point3;

use super::PocketError;
use super::candidate::Route;
use super::chain::from_above;
use super::check::Exception;
use super::conditions::Conditions;
use super::job::{ChooseBy, Job, Pattern};
use super::level::{Heights, Island, Level, Shape, Uncut, largest_places};
use super::path;
use crate::budget::Budget;
use crate::geometry::curve::Curve;
use crate::geometry::element::Element;
use crate::geometry::region::Region;
use crate::toolpath::cutting::Cutting;
use crate::toolpath::measure::measure;
use crate::toolpath::motion_time::motion_time;
use crate::toolpath::quantize;
use crate::toolpath::{Move, Toolpath};

/// The paper's time, and the times of the actual moves, s.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Times {
    pub paper_time_s: f64,
    pub time_s: f64,
    pub time_with_acceleration_s: f64,
    pub non_cutting_time_s: f64,
    pub cutting_length_mm: f64,
    pub rapid_length_mm: f64,
}

/// The figures of a pattern on a level.
#[derive(Debug, Clone, PartialEq)]
pub struct Candidate {
    pub pattern: Pattern,
    /// None if the pattern has no path.
    pub times: Option<Times>,
    pub n_retracts: usize,
    pub uncut_area_mm2: f64,
    /// The largest angle in material, radians.
    pub engagement_max: f64,
    pub engagement_over_length_mm: f64,
    /// Where the angle exceeds 1.1 of that of a straight pass; for the pattern `engagement` alone.
    pub exceptions: Vec<Exception>,
    pub air_length_mm: f64,
    pub invalid_because: Option<String>,
}

#[derive(Debug, Clone, PartialEq)]
pub struct LevelReport {
    pub top_z_mm: f64,
    pub z_mm: f64,
    /// The thickest material that the level leaves on the slopes of a relief, mm, where that is limited.
    pub leftover_mm: Option<f64>,
    pub islands: Vec<Island>,
    /// None where the tool fits nowhere.
    pub chosen: Option<Pattern>,
    pub candidates: Vec<Candidate>,
    /// The area that the tool cannot reach, mm², and its places larger than corners.
    pub not_reached_mm2: f64,
    pub not_reached: Vec<Uncut>,
    /// The outlines of the pocket and of all that stays uncut, for pictures.
    pub outlines: Vec<Vec<Element>>,
    pub uncut: Vec<Vec<Element>>,
}

#[derive(Debug, Clone, Default, PartialEq)]
pub struct Report {
    pub levels: Vec<LevelReport>,
    pub total_time_s: f64,
    /// What stays uncut on all levels, in reach or not, mm².
    pub uncut_area_mm2: f64,
    /// Bound of the depth to which the cutter may cut into walls and islands, after rounding, mm.
    pub gouge_max_mm: f64,
}

impl Times {
    /// The times of a route on a level.
    ///
    /// # Errors
    /// When the route has more than `move_limit` moves.
    pub fn of(route: &Route, conditions: &Conditions, move_limit: usize) -> Result<Self, PocketError> {
        let retract = conditions.cutting.retract_z_mm;
        let start =
            route.runs.first().map_or(Point3::origin(), |run| Point3::new(run.start.x, run.start.y, retract));
        let mut builder = Toolpath::builder(start).with_limit(move_limit);
        path::append(&mut builder, 0, &route.runs, conditions)?;
        let toolpath = builder.finish()?;
        let cutting = &conditions.cutting;
        let measures = measure(&toolpath, cutting.rapid_feed);
        let ramps = motion_time(&toolpath, cutting.rapid_feed, cutting.acceleration);
        let time_s = measures.total_time_s.unwrap_or(f64::INFINITY);
        Ok(Self {
            paper_time_s: measures.cutting_length_mm / cutting.feed.mm_per_s() + measures.rapid_time_s,
            time_s,
            time_with_acceleration_s: ramps.unwrap_or(f64::INFINITY),
            non_cutting_time_s: measures.rapid_time_s + route.check.air_length_mm / cutting.feed.mm_per_s(),
            cutting_length_mm: measures.cutting_length_mm,
            rapid_length_mm: measures.rapid_length_mm,
        })
    }

    pub fn figure(&self, choose_by: ChooseBy) -> f64 {
        match choose_by {
            ChooseBy::Time => self.time_s,
            ChooseBy::PaperTime => self.paper_time_s,
            ChooseBy::TimeWithAcceleration => self.time_with_acceleration_s,
        }
    }
}

impl Candidate {
    pub fn new(pattern: Pattern, route: &Route, times: &Times) -> Self {
        let check = &route.check;
        Self {
            pattern,
            times: Some(*times),
            n_retracts: route.runs.len().saturating_sub(1),
            uncut_area_mm2: check.uncut_area_mm2,
            engagement_max: check.engagement_max,
            engagement_over_length_mm: check.engagement_over_length_mm,
            exceptions: match pattern {
                Pattern::Engagement => check.exceptions.clone(),
                _ => Vec::new(),
            },
            air_length_mm: check.air_length_mm,
            invalid_because: check.invalid_because.clone(),
        }
    }

    /// A pattern without a path.
    pub fn failed(pattern: Pattern, because: String) -> Self {
        Self {
            pattern,
            times: None,
            n_retracts: 0,
            uncut_area_mm2: 0.0,
            engagement_max: 0.0,
            engagement_over_length_mm: 0.0,
            exceptions: Vec::new(),
            air_length_mm: 0.0,
            invalid_because: Some(because),
        }
    }

    pub fn is_valid(&self) -> bool {
        self.invalid_because.is_none()
    }
}

impl LevelReport {
    pub fn new(
        shape: &Shape,
        level: &Level,
        conditions: &Conditions,
        chosen: Option<(Pattern, &Route)>,
        candidates: Vec<Candidate>,
        budget: &Budget,
    ) -> Result<Self, PocketError> {
        let not_reached = shape.not_reached(budget)?;
        let elements =
            |region: &Region| region.outlines().map(|outline| outline.elements().to_vec()).collect();
        let mut uncut: Vec<Vec<Element>> = elements(&not_reached);
        uncut.extend(chosen.iter().flat_map(|(_, route)| &route.check.uncut).map(|element| vec![*element]));
        Ok(Self {
            top_z_mm: level.top_z_mm,
            z_mm: level.z_mm,
            leftover_mm: level.leftover_mm,
            islands: shape.islands(),
            chosen: chosen.map(|(pattern, _)| pattern),
            candidates,
            // The sum over no outlines is minus zero.
            not_reached_mm2: not_reached.area() + 0.0,
            not_reached: largest_places(&not_reached, conditions.radius_mm),
            outlines: elements(&shape.pocket),
            uncut,
        })
    }

    fn uncut_mm2(&self) -> f64 {
        let chosen = self.candidates.iter().find(|candidate| Some(candidate.pattern) == self.chosen);
        self.not_reached_mm2 + chosen.map_or(0.0, |candidate| candidate.uncut_area_mm2)
    }
}

impl Report {
    /// Fills in the figures of the whole toolpath.
    pub fn finish(
        &mut self,
        toolpath: &Toolpath,
        shapes: &[Shape],
        levels: &[Level],
        heights: &Heights,
        job: &Job,
        cutting: &Cutting,
    ) -> Result<(), PocketError> {
        self.total_time_s = measure(toolpath, cutting.rapid_feed).total_time_s.unwrap_or(0.0);
        self.uncut_area_mm2 = self.levels.iter().map(LevelReport::uncut_mm2).sum();
        // Above the places of a relief that are not higher than the level.
        self.gouge_max_mm = heights.overlap_mm;
        for pass in toolpath.passes() {
            let Some(level) = pass.level().and_then(|k| levels.get(k as usize)) else { continue };
            for step in pass.moves() {
                if let Move::Feed { along, .. } = step {
                    let depth = gouge(along, &shapes[level.shape].walls, heights.deviation_mm, job)?;
                    self.gouge_max_mm = self.gouge_max_mm.max(depth);
                }
            }
        }
        Ok(())
    }
}

/// Bound of the depth to which the cutter cuts into walls along a curve as it is written, mm. The walls may
/// be wrong by `deviation_mm`.
fn gouge(along: &Curve, walls: &Region, deviation_mm: f64, job: &Job) -> Result<f64, PocketError> {
    let rounded = quantize::round(along, job.resolution, &job.curves)?;
    // A curve that is not near any wall may be left out.
    let bound = job.tool.radius_mm + deviation_mm + rounded.displacement_mm;
    Ok((bound - walls.clearance(&from_above(along), bound)).max(0.0))
}

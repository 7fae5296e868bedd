//! The report of a pocket: each level with all candidates, and bounds over the whole toolpath.

use nalgebra::Point3;

use super::PocketError;
use super::candidate::Route;
use super::chain::from_above;
use super::check::{Exception, Invalid};
use super::conditions::Conditions;
use super::job::{ChooseBy, Job, Pattern};
use super::level::{Heights, Island, Level, Shape, Uncut, largest_places};
use super::path;
use crate::budget::Budget;
use crate::geometry::curve::Curve;
use crate::geometry::region::Region;
use crate::geometry::segment::Segment;
use crate::toolpath::cutting::Cutting;
use crate::toolpath::measure::{measure, measure_on};
use crate::toolpath::quantize;
use crate::toolpath::{Move, Toolpath};

/// The figures of one pattern on one level.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, utoipa::ToSchema), schema(as = PocketCandidate))]
pub struct Candidate {
    /// The pattern.
    pub pattern: Pattern,
    /// Whether the pattern passes the service's check of coverage, walls and links.
    pub valid: bool,
    /// Why the pattern does not pass the check. Absent for a valid pattern.
    #[cfg_attr(feature = "wire", serde(skip_serializing_if = "Option::is_none"))]
    pub invalid_because: Option<String>,
    /// The paper's time, in s: cutting length by feed, and rapid length by traverse rate. `null`, like the
    /// other times and lengths, where the pattern has no path.
    #[cfg_attr(feature = "wire", schema(required))]
    pub paper_time_s: Option<f64>,
    /// Time of all moves at their feeds, in s.
    #[cfg_attr(feature = "wire", schema(required))]
    pub time_s: Option<f64>,
    /// Estimated time on a machine that accelerates and brakes, in s.
    #[cfg_attr(feature = "wire", schema(required))]
    pub time_with_acceleration_s: Option<f64>,
    /// Time of rapids and of feed motion that cuts nothing, in s.
    #[cfg_attr(feature = "wire", schema(required))]
    pub non_cutting_time_s: Option<f64>,
    /// Length of all feed moves, in mm.
    #[cfg_attr(feature = "wire", schema(required))]
    pub cutting_length_mm: Option<f64>,
    /// Length of all rapids, in mm.
    #[cfg_attr(feature = "wire", schema(required))]
    pub rapid_length_mm: Option<f64>,
    /// Length of feed motion at the level's floor that cuts nothing, in mm.
    pub air_length_mm: f64,
    /// Number of times the tool is lifted between the first and the last cut.
    pub n_retracts: usize,
    /// Area in the tool's reach that the pattern leaves uncut, in mm2.
    pub uncut_area_mm2: f64,
    /// Proved largest angle of the cutter in the material, in degrees, without entries: 180 in a slot.
    pub engagement_max_deg: f64,
    /// Length on which this angle is larger than on a straight pass with the stepover, in mm.
    pub engagement_over_length_mm: f64,
    /// Where the pattern `engagement` exceeds 1.1 times the angle on a straight pass, in the order of the
    /// path. Absent for other patterns.
    #[cfg_attr(feature = "wire", serde(skip_serializing_if = "Option::is_none"))]
    pub engagement_exceptions: Option<Vec<Exception>>,
}

/// A level of a pocket.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, utoipa::ToSchema), schema(as = PocketLevel))]
pub struct LevelReport {
    /// Height of the level's floor, in mm.
    pub z_mm: f64,
    /// Thickest material that the level leaves on slopes of the part, in mm, at a right angle to the slope.
    /// Places that the tool cannot reach do not count. Absent without `roughing_allowance_mm`.
    #[cfg_attr(feature = "wire", serde(skip_serializing_if = "Option::is_none"))]
    pub leftover_max_mm: Option<f64>,
    /// Number of islands.
    pub n_islands: usize,
    /// The islands.
    pub islands: Vec<Island>,
    /// The pattern that the program uses; `null` where the tool fits nowhere on the level.
    #[cfg_attr(feature = "wire", schema(required))]
    pub chosen: Option<Pattern>,
    /// All patterns that were asked for; none where the tool fits nowhere.
    pub candidates: Vec<Candidate>,
    /// Area that the tool cannot reach, in mm2.
    pub not_reached_area_mm2: f64,
    /// Places that the tool cannot reach and that are larger than corners, the largest first.
    pub not_reached: Vec<Uncut>,
}

/// The outlines of a level, for pictures.
#[derive(Debug, Clone, PartialEq)]
pub struct LevelOutlines {
    pub top_z_mm: f64,
    pub z_mm: f64,
    pub pocket: Vec<Vec<Segment>>,
    /// All that stays uncut.
    pub uncut: Vec<Vec<Segment>>,
}

/// The levels with the figures of all patterns, and figures of the whole program.
#[derive(Debug, Clone, Default, PartialEq)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, utoipa::ToSchema), schema(as = PocketReport))]
pub struct Report {
    /// The levels, from the top down.
    pub levels: Vec<LevelReport>,
    /// Time of all moves at their feeds, in s.
    pub total_time_s: f64,
    /// Area that stays uncut, summed over the levels, in mm2: what the tool cannot reach, and what the chosen
    /// patterns leave.
    pub uncut_area_mm2: f64,
    /// Proved largest depth to which the cutter cuts into walls and islands, in mm, after rounding to the
    /// program's decimals.
    pub gouge_max_mm: f64,
}

impl Candidate {
    /// The figures of a pattern with a route on a level.
    ///
    /// # Errors
    /// When the route has more than `move_limit` moves.
    pub fn new(
        pattern: Pattern,
        route: &Route,
        conditions: &Conditions,
        move_limit: usize,
    ) -> Result<Self, PocketError> {
        let (check, cutting) = (&route.check, &conditions.cutting);
        let retract = cutting.retract_z_mm;
        let start =
            route.runs.first().map_or(Point3::origin(), |run| Point3::new(run.start.x, run.start.y, retract));
        let mut builder = Toolpath::builder(start).with_limit(move_limit);
        path::append(&mut builder, 0, &route.runs, conditions)?;
        let measures = measure_on(&builder.finish()?, Some(cutting));
        let feed_mm_per_s = cutting.feed.mm_per_s();
        Ok(Self {
            pattern,
            valid: check.invalid_because.is_none(),
            invalid_because: check.invalid_because.as_ref().map(Invalid::to_string),
            paper_time_s: Some(measures.cutting_length_mm / feed_mm_per_s + measures.rapid_time_s),
            time_s: measures.total_time_s,
            time_with_acceleration_s: measures.time_with_acceleration_s,
            non_cutting_time_s: Some(measures.rapid_time_s + check.air_length_mm / feed_mm_per_s),
            cutting_length_mm: Some(measures.cutting_length_mm),
            rapid_length_mm: Some(measures.rapid_length_mm),
            air_length_mm: check.air_length_mm,
            n_retracts: route.runs.len().saturating_sub(1),
            uncut_area_mm2: check.uncut_area_mm2,
            engagement_max_deg: check.engagement_max.to_degrees(),
            engagement_over_length_mm: check.engagement_over_length_mm,
            engagement_exceptions: (pattern == Pattern::Engagement).then(|| check.exceptions.clone()),
        })
    }

    /// A pattern without a path.
    pub fn failed(pattern: Pattern, because: String) -> Self {
        Self {
            pattern,
            valid: false,
            invalid_because: Some(because),
            paper_time_s: None,
            time_s: None,
            time_with_acceleration_s: None,
            non_cutting_time_s: None,
            cutting_length_mm: None,
            rapid_length_mm: None,
            air_length_mm: 0.0,
            n_retracts: 0,
            uncut_area_mm2: 0.0,
            engagement_max_deg: 0.0,
            engagement_over_length_mm: 0.0,
            engagement_exceptions: (pattern == Pattern::Engagement).then(Vec::new),
        }
    }

    /// The figure by which patterns are compared.
    pub fn figure(&self, choose_by: ChooseBy) -> f64 {
        let figure = match choose_by {
            ChooseBy::Time => self.time_s,
            ChooseBy::PaperTime => self.paper_time_s,
            ChooseBy::TimeWithAcceleration => self.time_with_acceleration_s,
        };
        figure.unwrap_or(f64::INFINITY)
    }
}

impl LevelReport {
    /// The report of a level, and its outlines.
    pub fn new(
        shape: &Shape,
        level: &Level,
        conditions: &Conditions,
        chosen: Option<(Pattern, &Route)>,
        candidates: Vec<Candidate>,
        budget: &Budget,
    ) -> Result<(Self, LevelOutlines), PocketError> {
        let not_reached = shape.not_reached(budget)?;
        let elements =
            |region: &Region| region.outlines().map(|outline| outline.elements().to_vec()).collect();
        let mut uncut: Vec<Vec<Segment>> = elements(&not_reached);
        uncut.extend(chosen.iter().flat_map(|(_, route)| &route.check.uncut).map(|element| vec![*element]));
        let &Level { top_z_mm, z_mm, .. } = level;
        let outlines = LevelOutlines { top_z_mm, z_mm, pocket: elements(&shape.pocket), uncut };
        let islands = shape.islands();
        let report = Self {
            z_mm,
            leftover_max_mm: level.leftover_mm,
            n_islands: islands.len(),
            islands,
            chosen: chosen.map(|(pattern, _)| pattern),
            candidates,
            // The sum over no outlines is minus zero.
            not_reached_area_mm2: not_reached.area() + 0.0,
            not_reached: largest_places(&not_reached, conditions.radius_mm),
        };
        Ok((report, outlines))
    }

    fn uncut_mm2(&self) -> f64 {
        let chosen = self.candidates.iter().find(|candidate| Some(candidate.pattern) == self.chosen);
        self.not_reached_area_mm2 + chosen.map_or(0.0, |candidate| candidate.uncut_area_mm2)
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

//! The report of a pocket: each level with all candidates, and bounds over the whole toolpath.

use nalgebra::Point3;

use super::PocketError;
use super::candidate::Route;
use super::chain::from_above;
use super::check::{Exception, Invalid};
use super::conditions::Conditions;
use super::finish::Finished;
use super::job::{ChooseBy, IslandsBy, Job, Pattern};
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
    /// How near to walls and islands the cutter comes on its way down, up and from cut to cut, in mm, beside
    /// its radius and what is left for finishing; at most twice `clearance_side_mm`.
    pub clearance_side_mm: f64,
    /// Where the pattern `engagement` exceeds 1.1 times the angle on a straight pass, in the order of the
    /// path. Absent for other patterns.
    #[cfg_attr(feature = "wire", serde(skip_serializing_if = "Option::is_none"))]
    pub engagement_exceptions: Option<Vec<Exception>>,
}

/// A level of a pocket.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, utoipa::ToSchema), schema(as = PocketLevel))]
pub struct LevelReport {
    /// The numbers of the `regions` that the level clears, counted from 0: several, where they are cut as
    /// one. Absent for a pocket of one `region`.
    #[cfg_attr(feature = "wire", serde(skip_serializing_if = "Option::is_none"))]
    pub regions: Option<Vec<usize>>,
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

/// How much nearer to a wall than its radius a path may come before it is rounded, mm.
const ROUNDING_MM: f64 = 1e-4;

/// The passes along walls and islands over one depth, after all levels are cleared.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, utoipa::ToSchema), schema(as = PocketFinish))]
pub struct FinishReport {
    /// The numbers of the `regions` whose walls are finished, counted from 0. Absent for a pocket of one
    /// `region`.
    #[cfg_attr(feature = "wire", serde(skip_serializing_if = "Option::is_none"))]
    pub regions: Option<Vec<usize>>,
    /// Height of the material's top, in mm.
    pub top_z_mm: f64,
    /// Height to which the passes go, in mm.
    pub z_mm: f64,
    /// Number of passes along each wall and island, spring passes included.
    pub n_passes: usize,
    /// Area in the tool's reach that the passes leave uncut, in mm2.
    pub uncut_area_mm2: f64,
    /// How near to walls and islands the cutter comes on its way down, up and from cut to cut, in mm, beside
    /// its radius and what is left; at most twice `clearance_side_mm`.
    pub clearance_side_mm: f64,
}

/// What stands on walls and floor after the program, where the tool reaches.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, utoipa::ToSchema), schema(as = PocketLeft))]
pub struct Left {
    /// Proved least thickness on walls and islands, in mm, after rounding to the program's decimals.
    pub walls_min_mm: f64,
    /// Largest thickness on walls and islands beside the pass along them, in mm, after rounding to the
    /// program's decimals.
    pub walls_max_mm: f64,
    /// Thickness on the floor, in mm.
    pub floor_mm: f64,
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
    /// The levels, from the top down; with several `regions`, in the order in which they are cut.
    pub levels: Vec<LevelReport>,
    /// The passes that finish walls and islands, from the top down; with several `regions`, in the order in
    /// which they are cut.
    pub finish: Vec<FinishReport>,
    /// What stands after the program.
    pub left: Left,
    /// How near to walls and islands the cutter comes on its way down, up and from cut to cut, in mm, beside
    /// its radius and what is left; at most twice `clearance_side_mm`. `null` without a cut.
    #[cfg_attr(feature = "wire", schema(required))]
    pub clearance_side_mm: Option<f64>,
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
            clearance_side_mm: check.side_mm,
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
            clearance_side_mm: 0.0,
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
        let outlines = LevelOutlines { top_z_mm, z_mm, pocket: elements(shape.material()), uncut };
        let islands = shape.islands();
        let report = Self {
            regions: None,
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
        self.not_reached_area_mm2 + self.chosen().map_or(0.0, |candidate| candidate.uncut_area_mm2)
    }

    /// The figures of the chosen pattern.
    fn chosen(&self) -> Option<&Candidate> {
        self.candidates.iter().find(|candidate| Some(candidate.pattern) == self.chosen)
    }
}

impl FinishReport {
    /// The figures of passes in the area that stands for `regions`, if there are several.
    pub fn new(finished: &Finished, regions: Option<Vec<usize>>) -> Self {
        Self {
            regions,
            top_z_mm: finished.top_z_mm,
            z_mm: finished.z_mm,
            n_passes: finished.passes.len(),
            uncut_area_mm2: finished.check.uncut_area_mm2,
            clearance_side_mm: finished.check.side_mm,
        }
    }
}

impl Report {
    /// Fills in what is left by the passes that finish walls, and the least distance from walls.
    pub fn finish_with(&mut self, finish: Vec<FinishReport>, job: &Job) {
        self.finish = finish;
        let chosen = self.levels.iter().filter_map(LevelReport::chosen).map(|level| level.clearance_side_mm);
        let sides = chosen.chain(self.finish.iter().map(|finish| finish.clearance_side_mm));
        self.clearance_side_mm = sides.min_by(f64::total_cmp);
        let on_walls = if job.finishing_walls().is_some() { 0.0 } else { job.allowance_mm };
        let on_floor = if job.finishing_floor().is_some() { 0.0 } else { job.floor_allowance_mm };
        self.left = Left { walls_min_mm: on_walls, walls_max_mm: on_walls, floor_mm: on_floor };
    }

    /// Fills in the figures of the whole toolpath. `shapes` are those of the report's levels; each pass is
    /// compared with the walls of its own level.
    pub fn finish(
        &mut self,
        toolpath: &Toolpath,
        shapes: &[&Shape],
        heights: &Heights,
        job: &Job,
        cutting: &Cutting,
    ) -> Result<(), PocketError> {
        self.total_time_s = measure(toolpath, cutting.rapid_feed).total_time_s.unwrap_or(0.0);
        self.uncut_area_mm2 = self.levels.iter().map(LevelReport::uncut_mm2).sum();
        // Above the places of a relief that are not higher than the level.
        self.gouge_max_mm = heights.overlap_mm;
        let (mut nearest_mm, mut displacement_mm) = (self.left.walls_min_mm, 0.0_f64);
        for pass in toolpath.passes() {
            let Some(shape) = pass.level().and_then(|k| shapes.get(k as usize)) else { continue };
            for step in pass.moves() {
                if let Move::Feed { along, .. } = step {
                    let near = beside(along, &shape.walls, shape.deviation_mm, job)?;
                    self.gouge_max_mm = self.gouge_max_mm.max(-near.distance_mm);
                    nearest_mm = nearest_mm.min(near.distance_mm);
                    displacement_mm = displacement_mm.max(near.displacement_mm);
                }
            }
        }
        // A path that was found to keep away from walls comes nearer by rounding alone.
        let deviation_mm = shapes.iter().map(|shape| shape.deviation_mm).fold(0.0, f64::max);
        let by_rounding_mm = heights.overlap_mm + 2.0 * deviation_mm + displacement_mm + ROUNDING_MM;
        if self.gouge_max_mm > by_rounding_mm && job.islands_by == IslandsBy::Slicing {
            let because = format!("as it is written it cuts {:.4} mm into a wall", self.gouge_max_mm);
            return Err(PocketError::NoneValid { because });
        }
        self.left.walls_min_mm = nearest_mm.max(0.0);
        self.left.walls_max_mm += 2.0 * deviation_mm + displacement_mm;
        Ok(())
    }
}

/// How near a curve brings the cutter to walls.
struct Beside {
    /// Lower bound of the distance between the cutter and the walls, mm; negative in a wall, and no larger
    /// than the allowance.
    distance_mm: f64,
    /// How far rounding moves the curve, mm.
    displacement_mm: f64,
}

/// How near the cutter comes to walls along a curve as it is written. The walls may be wrong by
/// `deviation_mm`.
fn beside(along: &Curve, walls: &Region, deviation_mm: f64, job: &Job) -> Result<Beside, PocketError> {
    let rounded = quantize::round(along, job.resolution, &job.curves)?;
    let reach = job.tool.radius_mm + deviation_mm + rounded.displacement_mm;
    // A curve that is not near any wall may be left out.
    let clearance = walls.clearance(&from_above(along), reach + job.allowance_mm);
    Ok(Beside { distance_mm: clearance - reach, displacement_mm: rounded.displacement_mm })
}

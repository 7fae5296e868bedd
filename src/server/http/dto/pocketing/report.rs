//! The report of a pocket.

use serde::Serialize;
use utoipa::ToSchema;

use super::Pattern;
use toolpathd_core::operations::pocketing as core;

/// The levels with the figures of all patterns, and figures of the whole program.
#[derive(Debug, Clone, Serialize, ToSchema)]
pub struct PocketReport {
    /// The levels, from the top down.
    levels: Vec<PocketLevel>,
    /// Time of all moves at their feeds, in s.
    total_time_s: f64,
    /// Area that stays uncut, summed over the levels, in mm2: what the tool cannot reach, and what the chosen
    /// patterns leave.
    uncut_area_mm2: f64,
    /// Proved largest depth to which the cutter cuts into walls and islands, in mm, after rounding to the
    /// program's decimals.
    gouge_max_mm: f64,
}

/// A level of a pocket.
#[derive(Debug, Clone, Serialize, ToSchema)]
pub struct PocketLevel {
    /// Height of the level's floor, in mm.
    z_mm: f64,
    /// Thickest material that the level leaves on slopes of the part, in mm, at a right angle to the slope.
    /// Places that the tool cannot reach do not count. Absent without `roughing_allowance_mm`.
    #[serde(skip_serializing_if = "Option::is_none")]
    leftover_max_mm: Option<f64>,
    /// Number of islands.
    n_islands: usize,
    /// The islands.
    islands: Vec<PocketIsland>,
    /// The pattern that the program uses; `null` where the tool fits nowhere on the level.
    chosen: Option<Pattern>,
    /// All patterns that were asked for; none where the tool fits nowhere.
    candidates: Vec<PocketCandidate>,
    /// Area that the tool cannot reach, in mm2.
    not_reached_area_mm2: f64,
    /// Places that the tool cannot reach and that are larger than corners, the largest first.
    not_reached: Vec<UncutPlace>,
}

/// An island of a level.
#[derive(Debug, Clone, Serialize, ToSchema)]
pub struct PocketIsland {
    /// Area, in mm2.
    area_mm2: f64,
    /// Centroid `[x, y]`, in mm.
    centroid: [f64; 2],
    /// Distance to the nearest other island, in mm; `null` without another island.
    nearest_island_mm: Option<f64>,
    /// Distance to the wall, in mm.
    wall_mm: f64,
}

/// A place that stays uncut.
#[derive(Debug, Clone, Serialize, ToSchema)]
pub struct UncutPlace {
    /// Area, in mm2.
    area_mm2: f64,
    /// Centroid `[x, y]`, in mm.
    at: [f64; 2],
}

/// The figures of one pattern on one level.
#[derive(Debug, Clone, Serialize, ToSchema)]
pub struct PocketCandidate {
    /// The pattern.
    pattern: Pattern,
    /// Whether the pattern passes the service's check of coverage, walls and links.
    valid: bool,
    /// Why the pattern does not pass the check. Absent for a valid pattern.
    #[serde(skip_serializing_if = "Option::is_none")]
    invalid_because: Option<String>,
    /// The paper's time, in s: cutting length by feed, and rapid length by traverse rate. `null`, like the
    /// other times and lengths, where the pattern has no path.
    paper_time_s: Option<f64>,
    /// Time of all moves at their feeds, in s.
    time_s: Option<f64>,
    /// Estimated time on a machine that accelerates and brakes, in s.
    time_with_acceleration_s: Option<f64>,
    /// Time of rapids and of feed motion that cuts nothing, in s.
    non_cutting_time_s: Option<f64>,
    /// Length of all feed moves, in mm.
    cutting_length_mm: Option<f64>,
    /// Length of all rapids, in mm.
    rapid_length_mm: Option<f64>,
    /// Length of feed motion at the level's floor that cuts nothing, in mm.
    air_length_mm: f64,
    /// Number of times the tool is lifted between the first and the last cut.
    n_retracts: usize,
    /// Area in the tool's reach that the pattern leaves uncut, in mm2.
    uncut_area_mm2: f64,
    /// Proved largest angle of the cutter in the material, in degrees, without entries: 180 in a slot.
    engagement_max_deg: f64,
    /// Length on which this angle is larger than on a straight pass with the stepover, in mm.
    engagement_over_length_mm: f64,
    /// Where the pattern `engagement` exceeds 1.1 times the angle on a straight pass, in the order of the
    /// path. Absent for other patterns.
    #[serde(skip_serializing_if = "Option::is_none")]
    engagement_exceptions: Option<Vec<EngagementException>>,
}

/// A part of the path along which the angle of the cutter in the material is large.
#[derive(Debug, Clone, Serialize, ToSchema)]
pub struct EngagementException {
    /// Where it begins, `[x, y]`, in mm.
    at: [f64; 2],
    /// Its length, in mm.
    length_mm: f64,
    /// Proved largest angle, in degrees.
    angle_deg: f64,
}

impl From<&core::Report> for PocketReport {
    fn from(report: &core::Report) -> Self {
        let core::Report { levels, total_time_s, uncut_area_mm2, gouge_max_mm } = report;
        Self {
            levels: levels.iter().map(PocketLevel::from).collect(),
            total_time_s: *total_time_s,
            uncut_area_mm2: *uncut_area_mm2,
            gouge_max_mm: *gouge_max_mm,
        }
    }
}

impl From<&core::LevelReport> for PocketLevel {
    fn from(level: &core::LevelReport) -> Self {
        let core::LevelReport {
            top_z_mm: _,
            z_mm,
            leftover_mm,
            islands,
            chosen,
            candidates,
            not_reached_mm2,
            not_reached,
            outlines: _,
            uncut: _,
        } = level;
        let island = |island: &core::Island| {
            let &core::Island { area_mm2, centroid, nearest_island_mm, wall_mm } = island;
            PocketIsland { area_mm2, centroid: centroid.into(), nearest_island_mm, wall_mm }
        };
        let place = |uncut: &core::Uncut| UncutPlace { area_mm2: uncut.area_mm2, at: uncut.at.into() };
        Self {
            z_mm: *z_mm,
            leftover_max_mm: *leftover_mm,
            n_islands: islands.len(),
            islands: islands.iter().map(island).collect(),
            chosen: chosen.map(Pattern::from),
            candidates: candidates.iter().map(PocketCandidate::from).collect(),
            not_reached_area_mm2: *not_reached_mm2,
            not_reached: not_reached.iter().map(place).collect(),
        }
    }
}

impl From<&core::Candidate> for PocketCandidate {
    fn from(candidate: &core::Candidate) -> Self {
        let core::Candidate {
            pattern,
            times,
            n_retracts,
            uncut_area_mm2,
            engagement_max,
            engagement_over_length_mm,
            exceptions,
            air_length_mm,
            invalid_because,
        } = candidate;
        let exception = |exception: &core::Exception| {
            let &core::Exception { at, length_mm, angle } = exception;
            EngagementException { at: at.into(), length_mm, angle_deg: angle.to_degrees() }
        };
        let is_bounded = *pattern == core::Pattern::Engagement;
        Self {
            pattern: (*pattern).into(),
            valid: invalid_because.is_none(),
            invalid_because: invalid_because.clone(),
            paper_time_s: times.map(|times| times.paper_time_s),
            time_s: times.map(|times| times.time_s),
            time_with_acceleration_s: times.map(|times| times.time_with_acceleration_s),
            non_cutting_time_s: times.map(|times| times.non_cutting_time_s),
            cutting_length_mm: times.map(|times| times.cutting_length_mm),
            rapid_length_mm: times.map(|times| times.rapid_length_mm),
            air_length_mm: *air_length_mm,
            n_retracts: *n_retracts,
            uncut_area_mm2: *uncut_area_mm2,
            engagement_max_deg: engagement_max.to_degrees(),
            engagement_over_length_mm: *engagement_over_length_mm,
            engagement_exceptions: is_bounded.then(|| exceptions.iter().map(exception).collect()),
        }
    }
}

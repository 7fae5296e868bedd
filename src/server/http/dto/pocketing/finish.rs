//! What a pocket leaves for finishing, how it is finished, and how the cutter comes to walls.

use serde::Deserialize;
use utoipa::ToSchema;

use super::super::check::{Range, Violations};
use crate::http::decode::object;
use crate::http::error::FieldCode;
use crate::http::pointer::Pointer;
use toolpathd_core::operations::pocketing as core;
use toolpathd_core::toolpath::units::FeedRate;

/// The most passes along a wall, spring passes apart.
const MOST_PASSES: u32 = 100;

/// How what is left on walls and floor is taken off. Without a member that part stays.
#[derive(Debug, Clone, Copy, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct PocketFinishing {
    /// The passes along walls and islands, which take `allowance_mm`.
    #[serde(default, deserialize_with = "object::optional")]
    walls: Option<FinishedWalls>,
    /// The level that takes `floor_allowance_mm`.
    #[serde(default, deserialize_with = "object::optional")]
    floor: Option<FinishedFloor>,
}

/// The passes that bring walls and islands to their size.
#[derive(Debug, Clone, Copy, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct FinishedWalls {
    /// Number of passes that share `allowance_mm`.
    #[serde(default = "one")]
    #[schema(minimum = 1, maximum = 100, default = 1)]
    passes: u32,
    /// What each pass but the first takes, in mm. Default: equal parts of `allowance_mm`.
    #[schema(minimum = 0.001, maximum = 1_000_000)]
    stepover_mm: Option<f64>,
    /// Largest depth of a pass, in mm. Default: the whole depth of the walls.
    #[schema(minimum = 0.001, maximum = 1_000_000)]
    stepdown_mm: Option<f64>,
    /// Feed of the passes, in mm/min. Default: `cutting.feed_mm_per_min`.
    #[schema(minimum = 0.001, maximum = 1_000_000)]
    feed_mm_per_min: Option<f64>,
    /// Number of times the last pass is followed again.
    #[serde(default)]
    #[schema(minimum = 0, maximum = 100, default = 0)]
    spring_passes: u32,
}

/// The level that brings the floor to its height.
#[derive(Debug, Clone, Copy, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct FinishedFloor {
    /// Largest distance of neighbouring passes, in mm; at most the cutter's diameter. Default: `stepover_mm`
    /// of the request.
    #[schema(minimum = 0.001, maximum = 1_000_000)]
    stepover_mm: Option<f64>,
    /// Feed of the passes, in mm/min. Default: `cutting.feed_mm_per_min`.
    #[schema(minimum = 0.001, maximum = 1_000_000)]
    feed_mm_per_min: Option<f64>,
}

/// How passes along walls and islands begin and end.
#[derive(Debug, Clone, Copy, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct PocketLead {
    /// `arc`: on a quarter of a circle that touches the wall. `line`: straight to the wall and away from it.
    /// `none`: the cutter comes down beside the wall.
    #[serde(default)]
    #[schema(default = "arc")]
    kind: core::LeadKind,
    /// Radius of the arc, or length of the line, in mm. Where it does not fit, it is as large as fits.
    /// Default: a quarter of the cutter's diameter, or more where the pass takes more.
    #[schema(minimum = 0.001, maximum = 1_000_000)]
    radius_mm: Option<f64>,
    /// How far a closed pass goes on beyond its start, in mm. Default: a tenth of the cutter's diameter.
    #[schema(minimum = 0, maximum = 1_000_000)]
    overlap_mm: Option<f64>,
}

fn one() -> u32 {
    1
}

/// The members of a request about finishing, as they were sent.
pub struct SentFinish {
    pub allowance_mm: Option<f64>,
    pub floor_allowance_mm: Option<f64>,
    pub finish: Option<PocketFinishing>,
    pub only: Option<core::Only>,
    pub lead: Option<PocketLead>,
    pub clearance_side_mm: Option<f64>,
}

/// What a job says about finishing.
pub struct Finishing {
    pub allowance_mm: f64,
    pub floor_allowance_mm: f64,
    pub finish: core::Finish,
    pub only: Option<core::Only>,
    pub lead: core::Lead,
    pub clearance_side_mm: Option<f64>,
}

impl SentFinish {
    /// Adds violations to `violations`. `depth_mm` is the depth of the pocket, where it is known.
    pub fn convert(self, diameter_mm: f64, depth_mm: Option<f64>, violations: &mut Violations) -> Finishing {
        let root = Pointer::root();
        let Self { allowance_mm, floor_allowance_mm, finish, only, lead, clearance_side_mm } = self;
        for (name, value) in [
            ("allowance_mm", allowance_mm),
            ("floor_allowance_mm", floor_allowance_mm),
            ("clearance_side_mm", clearance_side_mm),
        ] {
            violations.optional(&root.field(name), value, Range::NOT_NEGATIVE, "mm");
        }
        let (allowance, floor_allowance) = (allowance_mm.unwrap_or(0.0), floor_allowance_mm.unwrap_or(0.0));
        if let Some(depth) = depth_mm.filter(|depth| *depth > 0.0 && floor_allowance >= *depth) {
            let detail = format!("{floor_allowance} mm are left on the floor of a pocket of {depth} mm");
            violations.add(&root.field("floor_allowance_mm"), FieldCode::OutOfRange, detail);
        }
        let at = root.field("finish");
        let sent = finish.unwrap_or(PocketFinishing { walls: None, floor: None });
        let walls = sent.walls.map(|walls| walls.convert(&at.field("walls"), allowance, violations));
        let floor = sent
            .floor
            .map(|floor| floor.convert(&at.field("floor"), floor_allowance, diameter_mm, violations));
        if only == Some(core::Only::Finishing) && walls.is_none() && floor.is_none() {
            let detail = "nothing is to be finished: send `finish` with `walls` or `floor`";
            violations.add(&root.field("only"), FieldCode::Conflict, detail);
        }
        let lead = lead.map(|lead| lead.convert(&root.field("lead"), violations)).unwrap_or_default();
        Finishing {
            allowance_mm: allowance,
            floor_allowance_mm: floor_allowance,
            finish: core::Finish { walls, floor },
            only,
            lead,
            clearance_side_mm,
        }
    }
}

impl FinishedWalls {
    fn convert(self, at: &Pointer, allowance_mm: f64, violations: &mut Violations) -> core::FinishWalls {
        let Self { passes, stepover_mm, stepdown_mm, feed_mm_per_min, spring_passes } = self;
        if allowance_mm == 0.0 {
            let detail = "nothing is left on the walls: send `allowance_mm`";
            violations.add(at, FieldCode::Conflict, detail);
        }
        let limited = [("passes", passes, 1), ("spring_passes", spring_passes, 0)];
        for (name, count, least) in limited {
            if !(least..=MOST_PASSES).contains(&count) {
                let detail = format!("{count} passes; send {least} to {MOST_PASSES}");
                violations.add(&at.field(name), FieldCode::OutOfRange, detail);
            }
        }
        violations.optional(&at.field("stepover_mm"), stepover_mm, Range::POSITIVE, "mm");
        if let Some(stepover) = stepover_mm
            && f64::from(passes.saturating_sub(1)) * stepover >= allowance_mm
            && allowance_mm > 0.0
        {
            let detail = format!(
                "{} passes of {stepover} mm leave nothing of the {allowance_mm} mm to the first pass",
                passes - 1
            );
            violations.add(&at.field("stepover_mm"), FieldCode::Conflict, detail);
        }
        violations.optional(&at.field("stepdown_mm"), stepdown_mm, Range::POSITIVE, "mm");
        let feed = feed(&at.field("feed_mm_per_min"), feed_mm_per_min, violations);
        core::FinishWalls { passes, stepover_mm, stepdown_mm, feed, spring_passes }
    }
}

impl FinishedFloor {
    fn convert(
        self,
        at: &Pointer,
        floor_allowance_mm: f64,
        diameter_mm: f64,
        violations: &mut Violations,
    ) -> core::FinishFloor {
        let Self { stepover_mm, feed_mm_per_min } = self;
        if floor_allowance_mm == 0.0 {
            let detail = "nothing is left on the floor: send `floor_allowance_mm`";
            violations.add(at, FieldCode::Conflict, detail);
        }
        let range = Range { max: diameter_mm, ..Range::POSITIVE };
        violations.optional(&at.field("stepover_mm"), stepover_mm, range, "mm");
        let feed = feed(&at.field("feed_mm_per_min"), feed_mm_per_min, violations);
        core::FinishFloor { stepover_mm, feed }
    }
}

impl PocketLead {
    fn convert(self, at: &Pointer, violations: &mut Violations) -> core::Lead {
        let Self { kind, radius_mm, overlap_mm } = self;
        violations.optional(&at.field("radius_mm"), radius_mm, Range::POSITIVE, "mm");
        violations.optional(&at.field("overlap_mm"), overlap_mm, Range::NOT_NEGATIVE, "mm");
        core::Lead { kind, radius_mm, overlap_mm }
    }
}

fn feed(at: &Pointer, value: Option<f64>, violations: &mut Violations) -> Option<FeedRate> {
    violations.optional(at, value, Range::POSITIVE, "mm/min");
    value.and_then(FeedRate::from_mm_per_min)
}

//! Cutting conditions in requests.

use serde::Deserialize;
use utoipa::ToSchema;

use super::check::{Range, Violations};
use crate::http::pointer::Pointer;
use toolpathd_core::toolpath::cutting::{Coolant, CuttingRequest};
use toolpathd_core::toolpath::units::{Acceleration, FeedRate};

/// Cutting conditions: feeds, spindle, coolant and heights.
#[derive(Debug, Clone, Copy, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct Cutting {
    /// Feed of cutting moves, in mm/min.
    #[schema(minimum = 0.001, maximum = 1_000_000)]
    feed_mm_per_min: f64,
    /// Feed straight down to the start of a pass, in mm/min. Default: half of `feed_mm_per_min`.
    #[schema(minimum = 0.001, maximum = 1_000_000)]
    plunge_feed_mm_per_min: Option<f64>,
    /// Feed down a ramp, in mm/min. Default: `plunge_feed_mm_per_min`. For `/v1/pockets/plan`, whose ramps
    /// and helices are gentle, the default is `slot_feed_mm_per_min`, or less where the cutter would come
    /// down faster than `plunge_feed_mm_per_min`.
    #[schema(minimum = 0.001, maximum = 1_000_000)]
    ramp_feed_mm_per_min: Option<f64>,
    /// Feed of lead-ins, in mm/min. Default: `feed_mm_per_min`.
    #[schema(minimum = 0.001, maximum = 1_000_000)]
    lead_in_feed_mm_per_min: Option<f64>,
    /// Feed of links, which lead from the end of a pass straight to the next pass, in mm/min. Default:
    /// `feed_mm_per_min`.
    #[schema(minimum = 0.001, maximum = 1_000_000)]
    link_feed_mm_per_min: Option<f64>,
    /// Feed of lead-outs, in mm/min. Default: `feed_mm_per_min`.
    #[schema(minimum = 0.001, maximum = 1_000_000)]
    lead_out_feed_mm_per_min: Option<f64>,
    /// Feed where the angle of the cutter in the material is more than 1.1 times that of a straight pass, as
    /// in a slot or an inside corner, in mm/min. Only `/v1/pockets/plan` uses it. Default: in four steps down
    /// to 0.4 of `feed_mm_per_min`, over equal ranges of the angle; with `choose_by: paper_time`
    /// `feed_mm_per_min`.
    #[schema(minimum = 0.001, maximum = 1_000_000)]
    slot_feed_mm_per_min: Option<f64>,
    /// The machine's traverse rate, in mm/min. Only times depend on the traverse rate.
    #[schema(minimum = 0.001, maximum = 1_000_000, default = 10_000)]
    rapid_feed_mm_per_min: Option<f64>,
    /// The machine's acceleration, in mm/s2. Only `time_with_acceleration_s` depends on the acceleration.
    #[schema(minimum = 0.001, maximum = 1_000_000, default = 1000)]
    acceleration_mm_per_s2: Option<f64>,
    /// Spindle speed, in 1/min. Without a spindle speed the program starts no spindle, and the answer warns.
    #[schema(minimum = 0.001, maximum = 1_000_000)]
    spindle_rpm: Option<f64>,
    /// The coolant that the program switches on. `off`: none. `flood`: M8. `mist`: M7.
    #[serde(default)]
    #[schema(default = "off")]
    coolant: Coolant,
    /// Absolute height of the clearance plane, in mm: the height of rapids before the first pass and after
    /// the last pass. `wire_union` also crosses from pass to pass at this height. Default: 20 mm above the
    /// top of the part and its stock; for `/v1/programs/write` 20 mm above everything that the toolpath
    /// cuts.
    #[schema(minimum = -1_000_000, maximum = 1_000_000)]
    clearance_z_mm: Option<f64>,
    /// Absolute height of the retract plane, in mm: the height to which the tool is lifted between passes.
    /// `wire_union` lifts the tool to the clearance plane and comes down to the retract plane by rapid.
    /// Default: 2 mm above the top of the part and its stock.
    #[schema(minimum = -1_000_000, maximum = 1_000_000)]
    retract_z_mm: Option<f64>,
}

impl Cutting {
    /// The conditions. Adds violations to `violations`. `None` where `feed_mm_per_min` cannot be a feed at
    /// all.
    pub fn convert(self, at: &Pointer, violations: &mut Violations) -> Option<CuttingRequest> {
        let Self {
            feed_mm_per_min,
            plunge_feed_mm_per_min,
            ramp_feed_mm_per_min,
            lead_in_feed_mm_per_min,
            link_feed_mm_per_min,
            lead_out_feed_mm_per_min,
            slot_feed_mm_per_min,
            rapid_feed_mm_per_min,
            acceleration_mm_per_s2,
            spindle_rpm,
            coolant,
            clearance_z_mm,
            retract_z_mm,
        } = self;
        let mut feed = |name: &str, value: Option<f64>| {
            violations.optional(&at.field(name), value, Range::POSITIVE, "mm/min");
            value.and_then(FeedRate::from_mm_per_min)
        };
        let cutting_feed = feed("feed_mm_per_min", Some(feed_mm_per_min));
        let plunge_feed = feed("plunge_feed_mm_per_min", plunge_feed_mm_per_min);
        let ramp_feed = feed("ramp_feed_mm_per_min", ramp_feed_mm_per_min);
        let lead_in_feed = feed("lead_in_feed_mm_per_min", lead_in_feed_mm_per_min);
        let link_feed = feed("link_feed_mm_per_min", link_feed_mm_per_min);
        let lead_out_feed = feed("lead_out_feed_mm_per_min", lead_out_feed_mm_per_min);
        let slot_feed = feed("slot_feed_mm_per_min", slot_feed_mm_per_min);
        let rapid_feed = feed("rapid_feed_mm_per_min", rapid_feed_mm_per_min);
        let at_acceleration = at.field("acceleration_mm_per_s2");
        violations.optional(&at_acceleration, acceleration_mm_per_s2, Range::POSITIVE, "mm/s2");
        violations.optional(&at.field("spindle_rpm"), spindle_rpm, Range::POSITIVE, "rpm");
        for (name, height) in [("clearance_z_mm", clearance_z_mm), ("retract_z_mm", retract_z_mm)] {
            violations.optional(&at.field(name), height, Range::COORDINATE, "mm");
        }
        Some(CuttingRequest {
            feed: cutting_feed?,
            plunge_feed,
            ramp_feed,
            lead_in_feed,
            link_feed,
            lead_out_feed,
            slot_feed,
            rapid_feed,
            acceleration: acceleration_mm_per_s2.and_then(Acceleration::from_mm_per_s2),
            spindle_rpm,
            coolant,
            clearance_z_mm,
            retract_z_mm,
        })
    }
}

//! Cutting conditions as they are sent.

use serde::Deserialize;
use utoipa::ToSchema;

use super::check::{Range, Violations};
use crate::http::pointer::Pointer;
use crate::operations::surface_milling::CuttingRequest;
use crate::toolpath::tool as core;
use crate::toolpath::units::FeedRate;

/// Feeds, spindle, coolant and heights.
#[derive(Debug, Clone, Copy, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct Cutting {
    #[schema(minimum = 0.001, maximum = 1_000_000)]
    feed_mm_per_min: f64,
    /// Default: half the feed.
    #[schema(minimum = 0.001, maximum = 1_000_000)]
    plunge_feed_mm_per_min: Option<f64>,
    /// The machine's traverse rate, for times. Default: 10000.
    #[schema(minimum = 0.001, maximum = 1_000_000)]
    rapid_feed_mm_per_min: Option<f64>,
    /// Without it the program starts no spindle, and the answer warns.
    #[schema(minimum = 0.001, maximum = 1_000_000)]
    spindle_rpm: Option<f64>,
    #[serde(default)]
    #[schema(default = "off")]
    coolant: Coolant,
    /// Absolute height of rapids between distant places. Default: 20 mm above the top of the surface.
    #[schema(minimum = -1_000_000, maximum = 1_000_000)]
    clearance_z_mm: Option<f64>,
    /// Absolute height to which the tool is lifted between passes. Default: 2 mm above the top of the surface.
    #[schema(minimum = -1_000_000, maximum = 1_000_000)]
    retract_z_mm: Option<f64>,
}

#[derive(Debug, Clone, Copy, Default, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum Coolant {
    #[default]
    Off,
    Flood,
    Mist,
}

impl Cutting {
    /// The conditions, or nothing with the reasons in `violations`.
    pub fn convert(self, at: &Pointer, violations: &mut Violations) -> Option<CuttingRequest> {
        let Self {
            feed_mm_per_min,
            plunge_feed_mm_per_min,
            rapid_feed_mm_per_min,
            spindle_rpm,
            coolant,
            clearance_z_mm,
            retract_z_mm,
        } = self;
        let mut feed = |name: &str, value: f64| {
            violations.number(&at.field(name), value, Range::POSITIVE, "mm/min");
            FeedRate::from_mm_per_min(value)
        };
        let cutting_feed = feed("feed_mm_per_min", feed_mm_per_min);
        let plunge_feed = plunge_feed_mm_per_min.and_then(|value| feed("plunge_feed_mm_per_min", value));
        let rapid_feed = rapid_feed_mm_per_min.and_then(|value| feed("rapid_feed_mm_per_min", value));
        violations.optional(&at.field("spindle_rpm"), spindle_rpm, Range::POSITIVE, "rpm");
        for (name, height) in [("clearance_z_mm", clearance_z_mm), ("retract_z_mm", retract_z_mm)] {
            violations.optional(&at.field(name), height, Range::COORDINATE, "mm");
        }
        Some(CuttingRequest {
            feed: cutting_feed?,
            plunge_feed,
            rapid_feed,
            spindle_rpm,
            coolant: match coolant {
                Coolant::Off => core::Coolant::Off,
                Coolant::Flood => core::Coolant::Flood,
                Coolant::Mist => core::Coolant::Mist,
            },
            clearance_z_mm,
            retract_z_mm,
        })
    }
}

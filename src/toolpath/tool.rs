//! Cutters, and the conditions they cut under.

use super::units::FeedRate;

/// A ball cutter: a hemisphere below a cylinder of the same radius. The tip is its lowest point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tool {
    /// Radius, mm.
    pub radius_mm: f64,
    /// Number in the tool table.
    pub number: u32,
    /// Number of the length offset.
    pub length_offset: u32,
}

impl Tool {
    /// Tool 1 with length offset 1.
    pub fn ball(radius_mm: f64) -> Self {
        Self { radius_mm, number: 1, length_offset: 1 }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Coolant {
    #[default]
    Off,
    Flood,
    Mist,
}

/// Feeds, spindle, coolant and heights of one job.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cutting {
    pub feed: FeedRate,
    pub plunge_feed: FeedRate,
    /// The machine's traverse rate; used for times only.
    pub rapid_feed: FeedRate,
    /// Spindle speed, rpm; without one the program starts no spindle.
    pub spindle_rpm: Option<f64>,
    pub coolant: Coolant,
    /// Absolute height of rapids between distant places, mm.
    pub clearance_z_mm: f64,
    /// Absolute height to which the tool is lifted between passes and from which it plunges, mm.
    pub retract_z_mm: f64,
}

//! Stock over the surface, and entries and exits of passes, in requests.

use serde::Deserialize;
use utoipa::ToSchema;

use super::check::{Range, Violations};
use crate::http::decode::tagged::{Kind, by_kind};
use crate::http::pointer::Pointer;
use toolpathd_core::operations::surface_milling as core;

/// Legal angles of ramps with the horizontal plane, degrees.
const RAMP: Range = Range { min: 0.1, max: 89.0 };

/// Legal thicknesses of stock, mm.
const THICKNESS: Range = Range { min: 0.0, max: 1000.0 };

by_kind! {
    /// The stock that stands over the surface before the program runs; `kind` says in which form. Rapids of
    /// `cl_cartesian` come down to 2 mm above the stock.
    #[derive(Debug, Clone, Copy)]
    Stock { "on_surface" => OnSurface(StockOnSurface), "block" => Block(StockBlock) }
}

/// Stock that follows the surface, as roughing leaves it.
#[derive(Debug, Clone, Copy, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct StockOnSurface {
    #[serde(rename = "kind")]
    #[schema(ignore)]
    _kind: Kind,
    /// Largest thickness of the material that the program removes, in mm along the normal. It does not count
    /// `allowance_mm`, which stays on the surface.
    #[schema(minimum = 0, maximum = 1000)]
    thickness_mm: f64,
}

/// A block of stock with a level top.
#[derive(Debug, Clone, Copy, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct StockBlock {
    #[serde(rename = "kind")]
    #[schema(ignore)]
    _kind: Kind,
    /// Absolute height of the block's top, in mm.
    #[schema(minimum = -1_000_000, maximum = 1_000_000)]
    top_z_mm: f64,
}

by_kind! {
    /// How the cutter comes down to a pass; `kind` says which way. Where the entry has no room, the cutter
    /// plunges and the answer warns.
    #[derive(Debug, Clone, Copy)]
    Entry { "plunge" => Plunge(Plunge), "ramp" => Ramp(Ramp), "arc" => Arc(EntryArc) }
}

/// Straight down.
#[derive(Debug, Clone, Copy, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct Plunge {
    #[serde(rename = "kind")]
    #[schema(ignore)]
    _kind: Kind,
}

/// Down along sloping lines, to and fro above the pass. Where the cutter has no room there, the lines lie
/// before the start of the pass.
#[derive(Debug, Clone, Copy, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct Ramp {
    #[serde(rename = "kind")]
    #[schema(ignore)]
    _kind: Kind,
    /// Angle between the ramp and the horizontal, in degrees. A larger angle makes a shorter ramp.
    #[schema(minimum = 0.1, maximum = 89)]
    angle_deg: f64,
}

/// Down along a quarter of a circle that ends in the direction of the pass.
#[derive(Debug, Clone, Copy, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct EntryArc {
    #[serde(rename = "kind")]
    #[schema(ignore)]
    _kind: Kind,
    /// Radius of the circle, in mm.
    #[schema(minimum = 0.001, maximum = 1_000_000)]
    radius_mm: f64,
}

by_kind! {
    /// How the cutter leaves a pass; `kind` says which way. Where the exit has no room, the cutter goes
    /// straight up and the answer warns.
    #[derive(Debug, Clone, Copy)]
    Exit { "retract" => Retract(Retract), "arc" => Arc(ExitArc) }
}

/// Straight up.
#[derive(Debug, Clone, Copy, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct Retract {
    #[serde(rename = "kind")]
    #[schema(ignore)]
    _kind: Kind,
}

/// Up along a quarter of a circle that begins in the direction of the pass.
#[derive(Debug, Clone, Copy, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct ExitArc {
    #[serde(rename = "kind")]
    #[schema(ignore)]
    _kind: Kind,
    /// Radius of the circle, in mm.
    #[schema(minimum = 0.001, maximum = 1_000_000)]
    radius_mm: f64,
}

impl Stock {
    pub fn convert(self, at: &Pointer, violations: &mut Violations) -> core::Stock {
        match self {
            Self::OnSurface(StockOnSurface { thickness_mm, .. }) => {
                violations.number(&at.field("thickness_mm"), thickness_mm, THICKNESS, "mm");
                core::Stock::OnSurface { thickness_mm }
            }
            Self::Block(StockBlock { top_z_mm, .. }) => {
                violations.number(&at.field("top_z_mm"), top_z_mm, Range::COORDINATE, "mm");
                core::Stock::Block { top_z_mm }
            }
        }
    }
}

impl Entry {
    pub fn convert(self, at: &Pointer, violations: &mut Violations) -> core::Entry {
        match self {
            Self::Plunge(_) => core::Entry::Plunge,
            Self::Ramp(Ramp { angle_deg, .. }) => {
                violations.number(&at.field("angle_deg"), angle_deg, RAMP, "degrees");
                core::Entry::Ramp { slope: angle_deg.to_radians().tan() }
            }
            Self::Arc(EntryArc { radius_mm, .. }) => {
                violations.number(&at.field("radius_mm"), radius_mm, Range::POSITIVE, "mm");
                core::Entry::Arc { radius_mm }
            }
        }
    }
}

impl Exit {
    pub fn convert(self, at: &Pointer, violations: &mut Violations) -> core::Exit {
        match self {
            Self::Retract(_) => core::Exit::Retract,
            Self::Arc(ExitArc { radius_mm, .. }) => {
                violations.number(&at.field("radius_mm"), radius_mm, Range::POSITIVE, "mm");
                core::Exit::Arc { radius_mm }
            }
        }
    }
}

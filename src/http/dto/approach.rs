//! What stands over the surface, and how the cutter comes to a pass and leaves it, as they are sent.

use serde::{Deserialize, Deserializer};
use serde_json::value::RawValue;
use utoipa::ToSchema;

use super::check::{Range, Violations};
use super::tagged;
use crate::http::pointer::Pointer;
use crate::operations::surface_milling as core;

/// Angles of ramps with the level, degrees.
const RAMP: Range = Range { min: 0.1, max: 89.0 };

/// Thicknesses of stock, mm.
const THICKNESS: Range = Range { min: 0.0, max: 1000.0 };

/// Makes an enum of objects that are told apart by their `kind`, each of a name of its own.
macro_rules! by_kind {
    ($(#[$doc:meta])* $name:ident { $($variant:ident($body:ty) = $kind:literal),+ $(,)? }) => {
        $(#[$doc])*
        #[derive(Debug, Clone, Copy, ToSchema)]
        #[serde(untagged)]
        pub enum $name {
            $($variant($body)),+
        }

        impl<'de> Deserialize<'de> for $name {
            fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
                let object = <&RawValue>::deserialize(deserializer)?;
                match tagged::kind_of::<D::Error>(object)?.as_str() {
                    $($kind => tagged::decode(object).map(Self::$variant),)+
                    other => Err(tagged::unknown(other, &[], &[$($kind),+])),
                }
            }
        }
    };
}

/// Makes the object of one kind.
macro_rules! object_of_kind {
    ($(#[$doc:meta])* $name:ident, $tag:ident::$variant:ident { $($(#[$meta:meta])* $field:ident),* $(,)? }) => {
        #[derive(Debug, Clone, Copy, Deserialize, ToSchema)]
        #[serde(rename_all = "snake_case")]
        pub enum $tag {
            $variant,
        }

        $(#[$doc])*
        #[derive(Debug, Clone, Copy, Deserialize, ToSchema)]
        #[serde(deny_unknown_fields)]
        pub struct $name {
            #[serde(rename = "kind")]
            #[schema(inline)]
            _kind: $tag,
            $($(#[$meta])* $field: f64,)*
        }
    };
}

by_kind! {
    /// What stands over the surface before the program is run, told apart by `kind`: rapids come down to 2 mm above it.
    Stock { OnSurface(StockOnSurface) = "on_surface", Block(StockBlock) = "block" }
}

object_of_kind! {
    /// Stock that follows the surface, as roughing leaves it.
    StockOnSurface, OnSurfaceKind::OnSurface {
        /// No more than this lies above what this program leaves, along the normal of the surface.
        #[schema(minimum = 0, maximum = 1000)]
        thickness_mm,
    }
}

object_of_kind! {
    /// Stock of one height.
    StockBlock, BlockKind::Block {
        /// Nothing is higher, but the part itself.
        #[schema(minimum = -1_000_000, maximum = 1_000_000)]
        top_z_mm,
    }
}

by_kind! {
    /// How the cutter comes down to a pass, told apart by `kind`. Where there is no room for it the cutter plunges, and the answer warns.
    Entry { Plunge(Plunge) = "plunge", Ramp(Ramp) = "ramp", Arc(EntryArc) = "arc" }
}

object_of_kind! {
    /// Straight down.
    Plunge, PlungeKind::Plunge {}
}

object_of_kind! {
    /// Down lines over the pass, or before it where that is not clear.
    Ramp, RampKind::Ramp {
        /// Their angle with the level, degrees.
        #[schema(minimum = 0.1, maximum = 89)]
        angle_deg,
    }
}

object_of_kind! {
    /// Down a quarter of a circle along the tangent of the pass.
    EntryArc, EntryArcKind::Arc {
        #[schema(minimum = 0.001, maximum = 1_000_000)]
        radius_mm,
    }
}

by_kind! {
    /// How the cutter leaves a pass, told apart by `kind`. Where there is no room for it the cutter goes straight up, and the answer warns.
    Exit { Retract(Retract) = "retract", Arc(ExitArc) = "arc" }
}

object_of_kind! {
    /// Straight up.
    Retract, RetractKind::Retract {}
}

object_of_kind! {
    /// Up a quarter of a circle along the tangent of the pass.
    ExitArc, ExitArcKind::Arc {
        #[schema(minimum = 0.001, maximum = 1_000_000)]
        radius_mm,
    }
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

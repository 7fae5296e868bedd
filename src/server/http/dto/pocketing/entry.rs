//! How the cutter comes down into the material of a pocket.

use nalgebra::Point2;
use serde::Deserialize;
use utoipa::ToSchema;

use crate::http::dto::check::{Range, Violations};
use crate::http::dto::point::PlanePoint;
use crate::http::error::FieldCode;
use crate::http::pointer::Pointer;
use toolpathd_core::operations::pocketing as core;

/// Legal angles of ramps, degrees.
const RAMP: Range = Range { min: 0.1, max: 89.0 };

/// How the cutter comes down into the material: on the largest helix that fits in the connected part, else on
/// a ramp, else straight down if that is allowed. A part in which none of these has room stays uncut.
#[derive(Debug, Clone, Copy, Default, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct PocketEntry {
    /// Largest diameter of the circle that the cutter's centre follows on a helix, in mm; at most the
    /// cutter's diameter. Default: 0.9 of the cutter's diameter.
    #[schema(minimum = 0.001, maximum = 1_000_000)]
    max_diameter_mm: Option<f64>,
    /// Smallest diameter of this circle, in mm. Default: a quarter of the cutter's diameter, or
    /// `max_diameter_mm` where that is less.
    #[schema(minimum = 0.001, maximum = 1_000_000)]
    min_diameter_mm: Option<f64>,
    /// Steepest angle of helices and ramps, in degrees.
    #[schema(minimum = 0.1, maximum = 89, default = 5)]
    ramp_angle_deg: Option<f64>,
    /// Whether the cutter may go straight down where neither a helix nor a ramp fits.
    #[serde(default)]
    #[schema(default = false)]
    plunge: bool,
    /// Where the cutter comes down first on every level, `[x, y]`: the centre of the helix, or of the hole
    /// that `predrilled_diameter_mm` tells of, in mm. Other connected parts of the level, and other regions,
    /// keep entries of their own. A pattern that comes down at the place wins over a pattern that cannot.
    /// Default: the service chooses.
    at: Option<PlanePoint>,
    /// Diameter of a hole that is drilled at `at`, in mm. It has this diameter down to `floor_z_mm`. The
    /// cutter goes straight down in it. The hole is at least as wide as the cutter. A narrower hole leaves
    /// a ring through which the cutter plunges, and needs `plunge: true`. Default: no hole.
    #[schema(minimum = 0.001, maximum = 1_000_000)]
    predrilled_diameter_mm: Option<f64>,
}

impl PocketEntry {
    /// The entry in the core's terms, of a cutter of `diameter_mm`. Adds violations to `violations`.
    pub fn convert(
        entry: Option<Self>,
        place: &Pointer,
        diameter_mm: f64,
        violations: &mut Violations,
    ) -> core::EntryLimits {
        let usual = core::EntryLimits::of(diameter_mm);
        let entry = entry.unwrap_or_default();
        entry.check_hole(place, diameter_mm, violations);
        let Self { max_diameter_mm, min_diameter_mm, ramp_angle_deg, plunge, at, predrilled_diameter_mm } =
            entry;
        let range = Range { max: diameter_mm, ..Range::POSITIVE };
        violations.optional(&place.field("max_diameter_mm"), max_diameter_mm, range, "mm");
        let max_diameter_mm =
            max_diameter_mm.unwrap_or(usual.max_diameter_mm.max(min_diameter_mm.unwrap_or(0.0)));
        let range = Range { max: max_diameter_mm, ..Range::POSITIVE };
        violations.optional(&place.field("min_diameter_mm"), min_diameter_mm, range, "mm");
        violations.optional(&place.field("ramp_angle_deg"), ramp_angle_deg, RAMP, "degrees");
        if let Some(at) = at {
            at.check(&place.field("at"), violations);
        }
        core::EntryLimits {
            max_diameter_mm,
            min_diameter_mm: min_diameter_mm.unwrap_or(usual.min_diameter_mm.min(max_diameter_mm)),
            ramp_angle: ramp_angle_deg.map_or(usual.ramp_angle, f64::to_radians),
            plunge,
            at: at.map(Point2::from),
            is_predrilled: predrilled_diameter_mm.is_some(),
        }
    }

    /// Checks the hole that is drilled before.
    fn check_hole(&self, place: &Pointer, diameter_mm: f64, violations: &mut Violations) {
        let Some(hole_mm) = self.predrilled_diameter_mm else { return };
        let member = place.field("predrilled_diameter_mm");
        violations.number(&member, hole_mm, Range::POSITIVE, "mm");
        if self.at.is_none() {
            let detail = "the place of the hole is not known: send `at`, or leave this out";
            violations.add(&member, FieldCode::Conflict, detail);
        }
        if Range::POSITIVE.holds(hole_mm) && hole_mm < diameter_mm && !self.plunge {
            let detail = format!(
                "the hole of {hole_mm} mm is narrower than the cutter of {diameter_mm} mm, which would plunge through the ring that is left; drill it wider, or send `plunge: true`"
            );
            violations.add(&member, FieldCode::OutOfRange, detail);
        }
    }
}

//! Holders in requests: cylinders and cones about the tool axis.

use serde::Deserialize;
use utoipa::ToSchema;

use super::check::{Range, Violations};
use super::schema::{array_of, reference, schema_of};
use crate::http::error::FieldCode;
use crate::http::pointer::Pointer;
use toolpathd_core::toolpath::tool_body as core;

/// The most sections of shank and holder.
const MOST_SECTIONS: usize = 100;

schema_of!(HolderSections of HolderSection, "Sections of shank and holder, from below upwards.", {
    array_of(reference::<HolderSection>(), 0, MOST_SECTIONS)
});

/// A section of shank or holder: a cylinder or a cone about the tool axis.
#[derive(Debug, Clone, Copy, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct HolderSection {
    /// Its length along the axis, in mm.
    #[schema(minimum = 0.001, maximum = 1_000_000)]
    length_mm: f64,
    /// Its diameter at the lower end, in mm.
    #[schema(minimum = 0.001, maximum = 1_000_000)]
    diameter_mm: f64,
    /// Its diameter at the upper end, in mm. Default: `diameter_mm`.
    #[schema(minimum = 0.001, maximum = 1_000_000)]
    top_diameter_mm: Option<f64>,
}

impl HolderSection {
    /// The section in the core's terms.
    fn convert(self) -> core::HolderSection {
        let Self { length_mm, diameter_mm, top_diameter_mm } = self;
        let diameters_mm = [diameter_mm, top_diameter_mm.unwrap_or(diameter_mm)];
        core::HolderSection { length_mm, diameters_mm }
    }

    fn check(&self, at: &Pointer, violations: &mut Violations) {
        let Self { length_mm, diameter_mm, top_diameter_mm } = *self;
        violations.number(&at.field("length_mm"), length_mm, Range::POSITIVE, "mm");
        violations.number(&at.field("diameter_mm"), diameter_mm, Range::POSITIVE, "mm");
        violations.optional(&at.field("top_diameter_mm"), top_diameter_mm, Range::POSITIVE, "mm");
    }
}

/// Checks the sections of a holder.
pub fn check(at: &Pointer, holder: &[HolderSection], violations: &mut Violations) {
    if holder.len() > MOST_SECTIONS {
        let detail = format!("there are {} sections; send at most {MOST_SECTIONS}", holder.len());
        violations.add(at, FieldCode::TooLong, detail);
        return;
    }
    for (k, section) in holder.iter().enumerate() {
        section.check(&at.index(k), violations);
    }
}

/// The sections in the core's terms.
pub fn converted(holder: &[HolderSection]) -> Vec<core::HolderSection> {
    holder.iter().map(|section| section.convert()).collect()
}

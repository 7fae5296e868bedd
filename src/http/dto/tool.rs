//! Cutters as they are sent.

use serde::Deserialize;
use utoipa::ToSchema;

use super::check::{Range, Violations};
use crate::http::error::FieldCode;
use crate::http::pointer::Pointer;
use crate::toolpath::tool as core;

/// Numbers in tool and offset tables.
const TABLE: (u32, u32) = (1, 99_999);

#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum Shape {
    Ball,
    Flat,
    BullNose,
}

/// A cutter; positions are those of its tip.
#[derive(Debug, Clone, Copy, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct Tool {
    #[schema(inline)]
    shape: Shape,
    #[schema(minimum = 0.001, maximum = 1_000_000)]
    diameter_mm: f64,
    /// Of a `bull_nose`, and of no other: at most half the diameter.
    #[schema(minimum = 0.001, maximum = 500_000)]
    corner_radius_mm: Option<f64>,
    /// Number in the tool table. Default: 1, with a warning.
    #[schema(minimum = 1, maximum = 99_999)]
    number: Option<u32>,
    /// Number of the length offset. Default: `number`.
    #[schema(minimum = 1, maximum = 99_999)]
    length_offset: Option<u32>,
}

impl Tool {
    pub fn check(&self, at: &Pointer, violations: &mut Violations) {
        self.check_corner(&at.field("corner_radius_mm"), violations);
        self.check_numbers(at, violations);
    }

    /// As [`Self::check`], for a method that knows balls alone.
    pub fn check_ball(&self, at: &Pointer, violations: &mut Violations) {
        if self.shape == Shape::Ball {
            return self.check(at, violations);
        }
        let detail = "this engine supports no other shape than `ball`";
        violations.add(&at.field("shape"), FieldCode::Unsupported, detail);
        self.check_numbers(at, violations);
    }

    pub fn diameter_mm(&self) -> f64 {
        self.diameter_mm
    }

    pub fn is_flat(&self) -> bool {
        self.shape == Shape::Flat
    }

    fn check_numbers(&self, at: &Pointer, violations: &mut Violations) {
        let Self { shape: _, diameter_mm, corner_radius_mm: _, number, length_offset } = *self;
        violations.number(&at.field("diameter_mm"), diameter_mm, Range::POSITIVE, "mm");
        for (name, value) in [("number", number), ("length_offset", length_offset)] {
            if let Some(value) = value {
                violations.integer(&at.field(name), value, TABLE);
            }
        }
    }

    fn check_corner(&self, at: &Pointer, violations: &mut Violations) {
        match (self.shape, self.corner_radius_mm) {
            (Shape::BullNose, None) => {
                let detail = "`corner_radius_mm` is required of a bull nose cutter";
                violations.add(at, FieldCode::MissingField, detail);
            }
            (Shape::BullNose, Some(corner)) => {
                let range = Range { max: self.diameter_mm / 2.0, ..Range::POSITIVE };
                violations.number(at, corner, range, "mm");
            }
            (Shape::Ball | Shape::Flat, Some(_)) => {
                let detail = "only a bull nose cutter has a `corner_radius_mm`";
                violations.add(at, FieldCode::UnknownField, detail);
            }
            (Shape::Ball | Shape::Flat, None) => {}
        }
    }
}

/// Converts what has been checked.
impl From<Tool> for core::Tool {
    fn from(tool: Tool) -> Self {
        let Tool { shape, diameter_mm, corner_radius_mm, number, length_offset } = tool;
        core::Tool {
            shape: match (shape, corner_radius_mm) {
                (Shape::Ball, _) => core::Shape::Ball,
                (Shape::BullNose, Some(corner_radius_mm)) => core::Shape::BullNose { corner_radius_mm },
                (Shape::Flat, _) | (Shape::BullNose, None) => core::Shape::Flat,
            },
            radius_mm: diameter_mm / 2.0,
            number,
            length_offset,
        }
    }
}

//! Cutters as they are sent.

use serde::Deserialize;
use utoipa::ToSchema;

use super::check::{Range, Violations};
use crate::http::pointer::Pointer;
use crate::toolpath::tool as core;

/// Numbers in tool and offset tables.
const TABLE: (u32, u32) = (1, 99_999);

#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum Shape {
    Ball,
}

/// A cutter; positions are those of its tip.
#[derive(Debug, Clone, Copy, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct Tool {
    #[schema(inline)]
    shape: Shape,
    #[schema(minimum = 0.001, maximum = 1_000_000)]
    diameter_mm: f64,
    /// Number in the tool table. Default: 1.
    #[schema(minimum = 1, maximum = 99_999)]
    number: Option<u32>,
    /// Number of the length offset. Default: `number`.
    #[schema(minimum = 1, maximum = 99_999)]
    length_offset: Option<u32>,
}

impl Tool {
    pub fn check(&self, at: &Pointer, violations: &mut Violations) {
        let Self { shape: Shape::Ball, diameter_mm, number, length_offset } = *self;
        violations.number(&at.field("diameter_mm"), diameter_mm, Range::POSITIVE, "mm");
        for (name, value) in [("number", number), ("length_offset", length_offset)] {
            if let Some(value) = value {
                violations.integer(&at.field(name), value, TABLE);
            }
        }
    }
}

/// Converts what has been checked.
impl From<Tool> for core::Tool {
    fn from(tool: Tool) -> Self {
        let Tool { shape: Shape::Ball, diameter_mm, number, length_offset } = tool;
        let number = number.unwrap_or(1);
        core::Tool { radius_mm: diameter_mm / 2.0, number, length_offset: length_offset.unwrap_or(number) }
    }
}

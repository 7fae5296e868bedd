//! Cutters in requests.

use serde::Deserialize;
use utoipa::ToSchema;

use super::check::{Range, Violations};
use crate::http::error::FieldCode;
use crate::http::pointer::Pointer;
use toolpathd_core::toolpath::tool as core;

/// The smallest and the largest legal number in tool tables and offset tables.
const TABLE: (u32, u32) = (1, 99_999);

/// The shape of a cutter's end.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
#[schema(as = ToolShape)]
pub enum Shape {
    Ball,
    Flat,
    BullNose,
}

/// A cutter. Every position is the position of the cutter's tip.
#[derive(Debug, Clone, Copy, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct Tool {
    /// The shape of the cutter's end: `ball`, `flat`, or `bull_nose`, which is a flat end with a rounded
    /// corner.
    shape: Shape,
    /// Diameter of the cutter, in mm.
    #[schema(minimum = 0.001, maximum = 1_000_000)]
    diameter_mm: f64,
    /// Radius of the rounded corner of a `bull_nose`, in mm; at most half of the diameter. Required for a
    /// `bull_nose`, refused for other shapes.
    #[schema(minimum = 0.001, maximum = 500_000)]
    corner_radius_mm: Option<f64>,
    /// Number of the tool in the tool table. Without a number the program calls tool 1, and the answer warns.
    #[schema(minimum = 1, maximum = 99_999)]
    number: Option<u32>,
    /// Number of the tool's length offset (H). Default: the value of `number`, or 1 without `number`.
    #[schema(minimum = 1, maximum = 99_999)]
    length_offset: Option<u32>,
}

impl Tool {
    /// A tool with its numbers in the tables of the control: that of the tool and that of its length offset.
    pub fn new(
        shape: Shape,
        diameter_mm: f64,
        corner_radius_mm: Option<f64>,
        (number, length_offset): (Option<u32>, Option<u32>),
    ) -> Self {
        Self { shape, diameter_mm, corner_radius_mm, number, length_offset }
    }

    /// The tool in the core's terms. Adds violations to `violations`.
    pub fn convert(self, at: &Pointer, violations: &mut Violations) -> core::Tool {
        let Self { shape, diameter_mm, corner_radius_mm, number, length_offset } = self;
        self.check_corner(&at.field("corner_radius_mm"), violations);
        violations.number(&at.field("diameter_mm"), diameter_mm, Range::POSITIVE, "mm");
        for (name, value) in [("number", number), ("length_offset", length_offset)] {
            if let Some(value) = value {
                violations.integer(&at.field(name), value, TABLE);
            }
        }
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

    /// Refuses any cutter but a ball, for `engine: offset_section`.
    pub fn check_is_ball(&self, at: &Pointer, violations: &mut Violations) {
        if self.shape != Shape::Ball {
            let detail = "`offset_section` supports ball cutters only; use `engine: contact`";
            violations.add(&at.field("shape"), FieldCode::Unsupported, detail);
        }
    }

    pub fn diameter_mm(&self) -> f64 {
        self.diameter_mm
    }

    pub fn is_flat(&self) -> bool {
        self.shape == Shape::Flat
    }

    fn check_corner(&self, at: &Pointer, violations: &mut Violations) {
        match (self.shape, self.corner_radius_mm) {
            (Shape::BullNose, None) => {
                let detail = "a `bull_nose` needs `corner_radius_mm`";
                violations.add(at, FieldCode::MissingField, detail);
            }
            (Shape::BullNose, Some(corner)) => {
                let range = Range { max: self.diameter_mm / 2.0, ..Range::POSITIVE };
                violations.number(at, corner, range, "mm");
            }
            (Shape::Ball | Shape::Flat, Some(_)) => {
                let detail = "only a `bull_nose` has `corner_radius_mm`: leave `corner_radius_mm` out";
                violations.add(at, FieldCode::UnknownField, detail);
            }
            (Shape::Ball | Shape::Flat, None) => {}
        }
    }
}

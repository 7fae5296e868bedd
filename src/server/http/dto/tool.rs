//! Cutters in requests.

use serde::Deserialize;
use utoipa::ToSchema;

use super::check::{Range, Violations};
use super::holder::{self, HolderSection, HolderSections};
use crate::http::decode::object;
use crate::http::error::FieldCode;
use crate::http::pointer::Pointer;
use toolpathd_core::toolpath::tool as core;
use toolpathd_core::toolpath::tool_body::ToolBody;

/// The smallest and the largest legal number in tool tables and offset tables.
const TABLE: (u32, u32) = (1, 99_999);

/// The least and the largest number of cutting edges.
const FLUTES: (u32, u32) = (1, 100);

/// Legal angles between opposite sides of a tip, degrees. A larger angle is a flat end, and a smaller one a
/// needle.
const TIP_ANGLE: Range = Range { min: 1.0, max: 179.0 };

/// Legal angles between the side of a cone and the axis, degrees.
const TAPER: Range = Range { min: 0.1, max: 80.0 };

/// Legal angles of the point of a drill, degrees. A point of 180 degrees is flat.
const POINT_ANGLE: Range = Range { min: 1.0, max: 180.0 };

/// The shape of a cutter's end.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
#[schema(as = ToolShape)]
pub enum Shape {
    Ball,
    Flat,
    BullNose,
    V,
    Cone,
    Drill,
}

/// A cutter. Every position is the position of the cutter's tip. Nothing is assumed of a member that is
/// absent.
#[derive(Debug, Clone, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct Tool {
    /// The shape of the cutter's end: `ball`, `flat`, or `bull_nose`, which is a flat end with a rounded
    /// corner; `v`, a cone to engrave and chamfer with; `cone`, a tapered cutter; `drill`. Where the path
    /// depends on the shape, only the first three are taken, and for pockets only `flat`.
    shape: Shape,
    /// Diameter of the cutter, in mm. Of a `v` and a `cone` it is the largest diameter.
    #[schema(minimum = 0.001, maximum = 1_000_000)]
    diameter_mm: f64,
    /// Radius of the rounded corner of a `bull_nose`, in mm; at most half of the diameter. Required for a
    /// `bull_nose`, refused for other shapes.
    #[schema(minimum = 0.001, maximum = 500_000)]
    corner_radius_mm: Option<f64>,
    /// Angle between opposite sides of a `v`, in degrees. Required for a `v`, refused for other shapes.
    #[schema(minimum = 1, maximum = 179)]
    tip_angle_deg: Option<f64>,
    /// Angle between the side of a `cone` and the axis, in degrees. Required for a `cone`, refused for other
    /// shapes.
    #[schema(minimum = 0.1, maximum = 80)]
    taper_angle_deg: Option<f64>,
    /// Diameter of the flat at the tip of a `v` or a `cone`, in mm; at most the diameter. Default for a `v`:
    /// 0. Required for a `cone`, refused for other shapes.
    #[schema(minimum = 0, maximum = 1_000_000)]
    tip_diameter_mm: Option<f64>,
    /// Angle between opposite edges of the point of a `drill`, in degrees. Refused for other shapes.
    #[schema(minimum = 1, maximum = 180)]
    point_angle_deg: Option<f64>,
    /// Number of the tool in the tool table. Without a number the program calls tool 1, and the answer warns.
    #[schema(minimum = 1, maximum = 99_999)]
    number: Option<u32>,
    /// Number of the tool's length offset (H). Default: the value of `number`, or 1 without `number`.
    #[schema(minimum = 1, maximum = 99_999)]
    length_offset: Option<u32>,
    /// Length of the cutting edges from the tip upwards, in mm. Milling and pockets refuse to cut deeper at
    /// once, and warn where the job is deeper. Default: without limit.
    #[schema(minimum = 0.001, maximum = 1_000_000)]
    flute_length_mm: Option<f64>,
    /// How far the tool sticks out of its holder: the height of the holder's lower end over the tip, in mm.
    /// Milling and pockets refuse to go deeper below the top of part and stock than this, unless the holder
    /// is no wider than the cutter. Default: without limit. Required with `holder`.
    #[schema(minimum = 0.001, maximum = 1_000_000)]
    length_mm: Option<f64>,
    /// Number of cutting edges. With it and `cutting.spindle_rpm` the answer warns of a feed of each edge
    /// below 0.001 mm or above 1 mm.
    #[schema(minimum = 1, maximum = 100)]
    n_flutes: Option<u32>,
    /// The fastest that the tool may turn, in 1/min. A faster `cutting.spindle_rpm` is refused. Default:
    /// without limit.
    #[schema(minimum = 0.001, maximum = 1_000_000)]
    max_rpm: Option<f64>,
    /// The sections of the holder from its lower end upwards, each on top of the one before. Default: none
    /// told.
    #[serde(default, deserialize_with = "object::optional_list")]
    #[schema(value_type = Option<HolderSections>)]
    holder: Option<Vec<HolderSection>>,
}

impl Shape {
    /// The shapes of mills, whose paths depend on the shape.
    const MILLS: [Self; 3] = [Self::Ball, Self::Flat, Self::BullNose];

    fn name(self) -> &'static str {
        match self {
            Self::Ball => "ball",
            Self::Flat => "flat",
            Self::BullNose => "bull_nose",
            Self::V => "v",
            Self::Cone => "cone",
            Self::Drill => "drill",
        }
    }

    /// The shape, where it is that of a mill. Refuses other shapes, and stands a flat end in for them.
    pub fn of_mill(self, at: &Pointer, violations: &mut Violations) -> Self {
        if Self::MILLS.contains(&self) {
            return self;
        }
        let detail = format!(
            "the path depends on the shape of the cutter, and that of a `{}` is not supported: send `ball`, `flat` or `bull_nose`",
            self.name()
        );
        violations.add(at, FieldCode::Unsupported, detail);
        Self::Flat
    }
}

impl Tool {
    /// A tool with its numbers in the tables of the control: that of the tool and that of its length offset.
    pub fn new(
        shape: Shape,
        diameter_mm: f64,
        corner_radius_mm: Option<f64>,
        (number, length_offset): (Option<u32>, Option<u32>),
    ) -> Self {
        Self {
            shape,
            diameter_mm,
            corner_radius_mm,
            tip_angle_deg: None,
            taper_angle_deg: None,
            tip_diameter_mm: None,
            point_angle_deg: None,
            number,
            length_offset,
            flute_length_mm: None,
            length_mm: None,
            n_flutes: None,
            max_rpm: None,
            holder: None,
        }
    }

    /// The tool in the core's terms. Adds violations to `violations`.
    pub fn convert(&self, at: &Pointer, violations: &mut Violations) -> core::Tool {
        self.check_shape(at, violations);
        self.check_body(at, violations);
        violations.number(&at.field("diameter_mm"), self.diameter_mm, Range::POSITIVE, "mm");
        for (name, value, range) in [
            ("number", self.number, TABLE),
            ("length_offset", self.length_offset, TABLE),
            ("n_flutes", self.n_flutes, FLUTES),
        ] {
            if let Some(value) = value {
                violations.integer(&at.field(name), value, range);
            }
        }
        core::Tool {
            shape: self.core_shape(),
            radius_mm: self.diameter_mm / 2.0,
            number: self.number,
            length_offset: self.length_offset,
        }
    }

    /// As [`Self::convert`], where the path depends on the shape. Refuses the shapes that are no mills.
    pub fn convert_mill(&self, at: &Pointer, violations: &mut Violations) -> core::Tool {
        self.shape.of_mill(&at.field("shape"), violations);
        self.convert(at, violations)
    }

    /// What is told of the tool beside its cutting edge.
    pub fn body(&self) -> ToolBody {
        ToolBody {
            flute_length_mm: self.flute_length_mm,
            length_mm: self.length_mm,
            n_flutes: self.n_flutes,
            max_rpm: self.max_rpm,
            holder: holder::converted(self.holder.as_deref().unwrap_or_default()),
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

    /// The shape in the core's terms; a flat end where a member that the shape needs is absent.
    fn core_shape(&self) -> core::Shape {
        let tip_diameter_mm = self.tip_diameter_mm.unwrap_or(0.0);
        let told = match self.shape {
            Shape::Ball => Some(core::Shape::Ball),
            Shape::Flat => None,
            Shape::BullNose => self.corner_radius_mm.map(|mm| core::Shape::BullNose { corner_radius_mm: mm }),
            Shape::V => self.tip_angle_deg.map(|deg| core::Shape::V { tip_angle_deg: deg, tip_diameter_mm }),
            Shape::Cone => {
                self.taper_angle_deg.map(|deg| core::Shape::Cone { taper_angle_deg: deg, tip_diameter_mm })
            }
            Shape::Drill => Some(core::Shape::Drill { point_angle_deg: self.point_angle_deg }),
        };
        told.unwrap_or(core::Shape::Flat)
    }

    /// Checks the members that belong to some shapes only.
    fn check_shape(&self, at: &Pointer, violations: &mut Violations) {
        let corner = Range { max: self.diameter_mm / 2.0, ..Range::POSITIVE };
        let tip = Range { min: 0.0, max: self.diameter_mm };
        let own = [
            Own::needed("corner_radius_mm", self.corner_radius_mm, Shape::BullNose, corner),
            Own::needed("tip_angle_deg", self.tip_angle_deg, Shape::V, TIP_ANGLE),
            Own::needed("taper_angle_deg", self.taper_angle_deg, Shape::Cone, TAPER),
            Own {
                also: Some(Shape::V),
                ..Own::needed("tip_diameter_mm", self.tip_diameter_mm, Shape::Cone, tip)
            },
            Own {
                is_needed: false,
                ..Own::needed("point_angle_deg", self.point_angle_deg, Shape::Drill, POINT_ANGLE)
            },
        ];
        for own in own {
            own.check(self.shape, at, violations);
        }
    }

    /// Checks the members that tell what the tool is above its cutting edge.
    fn check_body(&self, at: &Pointer, violations: &mut Violations) {
        for (name, value, unit) in [
            ("flute_length_mm", self.flute_length_mm, "mm"),
            ("length_mm", self.length_mm, "mm"),
            ("max_rpm", self.max_rpm, "1/min"),
        ] {
            violations.optional(&at.field(name), value, Range::POSITIVE, unit);
        }
        let Some(sections) = &self.holder else { return };
        holder::check(&at.field("holder"), sections, violations);
        if self.length_mm.is_none() {
            let detail = "a `holder` needs `length_mm`, the height of its lower end over the tip";
            violations.add(&at.field("length_mm"), FieldCode::MissingField, detail);
        }
    }
}

/// A member that belongs to some shapes only.
struct Own {
    name: &'static str,
    value: Option<f64>,
    /// The shape that has the member.
    of: Shape,
    /// Whether this shape needs the member.
    is_needed: bool,
    /// Another shape that may have the member.
    also: Option<Shape>,
    range: Range,
}

impl Own {
    /// A member that one shape has and needs.
    fn needed(name: &'static str, value: Option<f64>, of: Shape, range: Range) -> Self {
        Self { name, value, of, is_needed: true, also: None, range }
    }

    fn check(&self, shape: Shape, at: &Pointer, violations: &mut Violations) {
        let Self { name, value, of, is_needed, also, range } = *self;
        let at = at.field(name);
        match value {
            None if is_needed && shape == of => {
                let detail = format!("a `{}` needs `{name}`", of.name());
                violations.add(&at, FieldCode::MissingField, detail);
            }
            Some(_) if shape != of && also != Some(shape) => {
                let or = also.map_or(String::new(), |also| format!(" or a `{}`", also.name()));
                let detail = format!("only a `{}`{or} has `{name}`: leave `{name}` out", of.name());
                violations.add(&at, FieldCode::UnknownField, detail);
            }
            value => {
                let unit = if name.ends_with("_deg") { "degrees" } else { "mm" };
                violations.optional(&at, value, range, unit);
            }
        }
    }
}

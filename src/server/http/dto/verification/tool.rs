//! Tools in requests to verify: the cutter, and what holds it.

use serde::Deserialize;
use utoipa::ToSchema;

use crate::http::decode::object;
use crate::http::dto::check::{Range, Violations};
use crate::http::dto::holder::{self, HolderSection, HolderSections};
use crate::http::dto::tool::{Shape, Tool};
use crate::http::error::FieldCode;
use crate::http::pointer::Pointer;
use toolpathd_core::machining::assembly::{Assembly, Frustum};
use toolpathd_core::operations::verification as core;
use toolpathd_nc::machine::Cutter;

/// The most tools.
pub const MOST: usize = 200;

/// Legal heights over the tip, mm.
const HEIGHT: Range = Range { min: 0.0, max: 1e6 };

/// A cutter with its shank and holder.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct VerifiedTool {
    /// The shape of the cutter's end: `ball`, `flat`, or `bull_nose`, which is a flat end with a rounded
    /// corner.
    shape: Shape,
    /// Diameter of the cutter, in mm. Its shank counts as wide up to any height.
    #[schema(minimum = 0.001, maximum = 1_000_000)]
    diameter_mm: f64,
    /// Radius of the rounded corner of a `bull_nose`, in mm; at most half of the diameter. Required for a
    /// `bull_nose`, refused for other shapes.
    #[schema(minimum = 0.001, maximum = 500_000)]
    corner_radius_mm: Option<f64>,
    /// Number by which the program calls the tool. Where `tools` has several, each needs `number` or `name`.
    #[schema(minimum = 1, maximum = 99_999)]
    number: Option<u32>,
    /// Name by which the program calls the tool, in letters of any case.
    #[schema(max_length = 100)]
    name: Option<String>,
    /// Number of the tool's length offset (H). It changes nothing of the answer.
    #[schema(minimum = 1, maximum = 99_999)]
    length_offset: Option<u32>,
    /// Length of the cutting edges from the tip upwards, in mm. Default: without limit.
    #[schema(minimum = 0.001, maximum = 1_000_000)]
    flute_length_mm: Option<f64>,
    /// Height of the lower end of the first section of `holder` over the tip, in mm.
    #[schema(minimum = 0, maximum = 1_000_000, default = 0)]
    stickout_mm: Option<f64>,
    /// The sections of shank and holder from below upwards, each on top of the one before. Default: none, and
    /// nothing but the cutter is verified.
    #[serde(default, deserialize_with = "object::optional_list")]
    #[schema(value_type = Option<HolderSections>)]
    holder: Option<Vec<HolderSection>>,
}

/// A tool in the core's terms, with the number by which the program calls it.
#[derive(Debug)]
pub struct NumberedTool {
    pub number: Option<u32>,
    pub name: Option<String>,
    pub has_holder: bool,
    pub tool: core::Tool,
}

impl VerifiedTool {
    pub fn convert(self, at: &Pointer, violations: &mut Violations) -> NumberedTool {
        let Self {
            shape,
            diameter_mm,
            corner_radius_mm,
            number,
            name,
            length_offset,
            flute_length_mm,
            stickout_mm,
            holder,
        } = self;
        let shape = shape.of_mill(&at.field("shape"), violations);
        let sent = Tool::new(shape, diameter_mm, corner_radius_mm, (number, length_offset));
        let cutter = sent.convert(at, violations).cutter();
        violations.optional(&at.field("flute_length_mm"), flute_length_mm, Range::POSITIVE, "mm");
        violations.optional(&at.field("stickout_mm"), stickout_mm, HEIGHT, "mm");
        let holder = holder.unwrap_or_default();
        let at_holder = at.field("holder");
        holder::check(&at_holder, &holder, violations);
        if stickout_mm.is_some() && holder.is_empty() {
            let detail = "`stickout_mm` is the height of a `holder`; send the `holder`, or leave it out";
            violations.add(&at.field("stickout_mm"), FieldCode::Conflict, detail);
        }
        let has_holder = !holder.is_empty();
        let mut bottom_mm = stickout_mm.unwrap_or(0.0);
        let mut sections = Vec::with_capacity(holder.len());
        for section in holder::converted(&holder) {
            let length_mm = section.length_mm;
            let top_mm = bottom_mm + length_mm;
            let [bottom_radius_mm, top_radius_mm] = section.diameters_mm.map(|diameter| 0.5 * diameter);
            // What is no wider than the cutter lies within the cutter's own shank.
            if bottom_radius_mm.max(top_radius_mm) > cutter.radius() {
                sections.push(Frustum { bottom_mm, top_mm, bottom_radius_mm, top_radius_mm });
            }
            bottom_mm = top_mm;
        }
        NumberedTool {
            number,
            name,
            has_holder,
            tool: core::Tool { assembly: Assembly { cutter, sections }, flute_length_mm },
        }
    }
}

/// The tools of a request, which has one or several. Adds violations to `violations`.
pub fn checked(
    tool: Option<VerifiedTool>,
    tools: Option<Vec<VerifiedTool>>,
    violations: &mut Violations,
) -> Vec<NumberedTool> {
    let root = Pointer::root();
    let tools = match (tool, tools) {
        (Some(tool), None) => return vec![tool.convert(&root.field("tool"), violations)],
        (None, Some(tools)) if (1..=MOST).contains(&tools.len()) => tools,
        (None, Some(tools)) => {
            let detail = format!("there are {} tools; send 1 to {MOST}", tools.len());
            violations.add(&root.field("tools"), FieldCode::WrongLength, detail);
            return Vec::new();
        }
        (one, _) => {
            let at = if one.is_some() { root.field("tools") } else { root };
            violations.add(&at, FieldCode::Conflict, "send either `tool` or `tools`");
            return Vec::new();
        }
    };
    let at = root.field("tools");
    let is_one = tools.len() == 1;
    let mut converted: Vec<NumberedTool> = Vec::with_capacity(tools.len());
    for (k, tool) in tools.into_iter().enumerate() {
        let own = at.index(k);
        let tool = tool.convert(&own, violations);
        match tool.number {
            None if !is_one && tool.name.is_none() => {
                let detail =
                    "each of several tools needs the `number` or the `name` by which the program calls it";
                violations.add(&own.field("number"), FieldCode::MissingField, detail);
            }
            Some(number) if converted.iter().any(|other| other.number == Some(number)) => {
                let detail = format!("tool {number} stands twice; send it once");
                violations.add(&own.field("number"), FieldCode::Conflict, detail);
            }
            _ => {}
        }
        converted.push(tool);
    }
    converted
}

/// The cutters by which cutter compensation is computed. A single tool is that of the whole program.
pub fn cutters(tools: &[NumberedTool]) -> Vec<Cutter> {
    let is_one = tools.len() == 1;
    let named = tools.iter().filter(|tool| is_one || tool.number.is_some());
    let cutter = |tool: &NumberedTool| Cutter {
        number: tool.number.filter(|_| !is_one),
        radius_mm: tool.tool.assembly.cutter.radius(),
    };
    named.map(cutter).collect()
}

//! The operations that follow the first one in the same program.

use serde::Deserialize;
use utoipa::ToSchema;

use super::{ARC_TOLERANCE_STEPS, conditions};
use crate::http::decode::object;
use crate::http::dto::check::Violations;
use crate::http::dto::cutting::Cutting;
use crate::http::dto::meta::MAX_TEXT_CHARACTERS;
use crate::http::dto::program::WorkOffset;
use crate::http::dto::sent_toolpath::{Read, ReadSettings, SentToolpath};
use crate::http::dto::setup;
use crate::http::dto::tool::Tool;
use crate::http::error::FieldCode;
use crate::http::messages::{self, Warning};
use crate::http::pointer::Pointer;
use toolpathd_core::toolpath as core;
use toolpathd_core::toolpath::cutting::{self, Caution, Coolant, CuttingRequest};
use toolpathd_core::toolpath::tool_body::ToolBody;
use toolpathd_core::toolpath::{program, tool};
use toolpathd_post::{Dialect, Missing};

/// Most operations that follow the first one.
pub const MOST: usize = 50;

/// An operation that follows in the same program.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct FurtherOperation {
    /// Name of the operation. It stands in a comment before the operation, in plain letters and digits.
    #[schema(max_length = 1000)]
    name: Option<String>,
    /// The toolpath, with a tool axis that is straight up.
    #[serde(deserialize_with = "object::required")]
    toolpath: SentToolpath,
    /// The tool. Default: the tool of the operation before, which then stays in the spindle.
    #[serde(default, deserialize_with = "object::optional")]
    tool: Option<Tool>,
    /// Spindle, coolant, the clearance plane, and the feeds of moves that have no `feed_mm_per_min` of their
    /// own. Without `cutting`, the operation uses the `cutting` of the operation before. A `cutting` that is
    /// sent replaces all of it, the coolant too.
    #[serde(default, deserialize_with = "object::optional")]
    cutting: Option<Cutting>,
    /// The work offset. Without `work_offset`, the operation uses the work offset of the operation before.
    work_offset: Option<WorkOffset>,
}

/// One operation of a program.
#[derive(Debug)]
pub struct Operation {
    pub name: Option<String>,
    pub toolpath: core::Toolpath,
    /// Upper bound for the distance between the arcs in the request and the exact arcs in `toolpath`, mm.
    pub moved_mm: f64,
    /// The caution that the service chose the clearance plane. `None` where the request has one.
    pub caution: Option<Caution>,
    pub cutting: cutting::Cutting,
    pub tool: Option<tool::Tool>,
    pub program: program::Program,
    /// What is legal in the request and yet often a mistake.
    pub remarks: Vec<Warning>,
}

/// What an operation takes from the one before it.
#[derive(Clone)]
pub struct Before {
    pub tool: Option<tool::Tool>,
    /// What is told of the tool beside its cutting edge.
    pub body: ToolBody,
    pub request: Option<CuttingRequest>,
    pub program: program::Program,
}

impl FurtherOperation {
    pub fn n_moves(&self) -> usize {
        self.toolpath.n_moves()
    }

    /// The operation, and what the next one takes from it. The operation is `None` where its toolpath has
    /// violations, which `violations` then holds.
    pub fn convert(
        self,
        at: &Pointer,
        (mut before, dialect): (Before, &Dialect),
        max_moves: usize,
        violations: &mut Violations,
    ) -> (Option<Operation>, Before) {
        let Self { name, toolpath, tool, cutting, work_offset } = self;
        if let Some(name) = &name {
            violations.text(&at.field("name"), name, MAX_TEXT_CHARACTERS);
        }
        let (own_tool, own_cutting) = (tool.is_some(), cutting.is_some());
        if let Some(tool) = tool {
            before.tool = Some(tool.convert(&at.field("tool"), violations));
            before.body = tool.body();
        }
        if let Some(cutting) = cutting {
            before.request = cutting.convert(&at.field("cutting"), violations);
        }
        let mut remarks = Vec::new();
        if let Some(cutting) = before.request.as_ref().filter(|_| own_tool || own_cutting) {
            setup::check_speed(cutting, &before.body, at, violations);
            remarks = setup::remarks_of_feeds(cutting, &before.body, at);
        }
        if let Some(offset) = work_offset {
            before.program.work_offset = Some(offset as u8);
        }
        let coolant = before.request.map_or(Coolant::Off, |request| request.coolant);
        for missing in toolpathd_post::missing(dialect, &before.program, coolant, before.tool.as_ref()) {
            let (path, is_own) = match missing {
                Missing::WorkOffset { .. } => ("/work_offset", work_offset.is_some()),
                Missing::Coolant { .. } => ("/cutting/coolant", own_cutting),
                Missing::ToolNumber { .. } => ("/tool/number", own_tool),
                Missing::LengthOffset { .. } | Missing::LengthOffsetNumber { .. } => {
                    ("/tool/length_offset", own_tool)
                }
                // These are members of the whole request.
                _ => continue,
            };
            if is_own {
                violations.add(&at.join(path), FieldCode::Unsupported, messages::missing(&missing).1);
            }
        }
        let reading = ReadSettings {
            cutting: before.request.as_ref(),
            arc_tolerance_mm: ARC_TOLERANCE_STEPS * before.program.resolution.step_mm(),
            max_moves,
            may_be_apart: false,
        };
        let read = toolpath.convert(&at.field("toolpath"), &reading, violations);
        let operation = read.map(|Read { toolpath, moved_mm }| {
            if !toolpath.is_upright() {
                let detail =
                    "the tool leans or turns: send this toolpath alone, without `further_operations`";
                violations.add(&at.field("toolpath"), FieldCode::Unsupported, detail);
            }
            let (cutting, caution) = conditions(&toolpath, before.request, at, violations);
            let (tool, program) = (before.tool, before.program.clone());
            Operation { name, toolpath, moved_mm, caution, cutting, tool, program, remarks }
        });
        (operation, before)
    }
}

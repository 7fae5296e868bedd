//! The members that requests for toolpaths share: tool, cutting conditions, program and the caller's texts.

use super::axis_output::AxisSetup;
use super::check::Violations;
use super::cutting::Cutting;
use super::meta::{self, Meta};
use super::program::Program;
use crate::http::error::FieldCode;
use crate::http::messages;
use crate::http::pointer::Pointer;
use toolpathd_core::toolpath::cutting::{Coolant, CuttingRequest};
use toolpathd_core::toolpath::{program, tool};
use toolpathd_post::Dialect;

/// The shared members as they were sent. The tool has been checked already.
pub struct SentSetup {
    pub tool: Option<tool::Tool>,
    pub cutting: Option<Cutting>,
    pub program: Program,
    pub meta: Option<Meta>,
}

/// The tool, and how the program is written.
#[derive(Debug, Clone)]
pub struct Setup {
    pub tool: Option<tool::Tool>,
    pub program: program::Program,
    pub dialect: &'static Dialect,
    /// How the axis of a leaning tool is written. `None` where it is straight up.
    pub five_axes: Option<AxisSetup>,
    /// The number of the tool that the text of a path calls. The request describes no tool then.
    pub called: Option<u32>,
}

/// A job of an operation with its setup.
#[derive(Debug)]
pub struct JobWithSetup<J> {
    pub job: J,
    pub setup: Setup,
    pub meta: Option<Meta>,
}

impl SentSetup {
    /// The setup, the cutting conditions (`None` where they are absent or without a usable feed), and the
    /// caller's texts. Adds violations to `violations`.
    pub fn convert(self, violations: &mut Violations) -> (Setup, Option<CuttingRequest>, Option<Meta>) {
        let Self { tool, cutting, program, meta } = self;
        let root = Pointer::root();
        let cutting = cutting.and_then(|cutting| cutting.convert(&root.field("cutting"), violations));
        program.check(&root.field("program"), violations);
        meta::check(meta.as_ref(), violations);
        let (dialect, program) = program.convert();
        let coolant = cutting.as_ref().map_or(Coolant::Off, |cutting| cutting.coolant);
        for missing in toolpathd_post::missing(dialect, &program, coolant, tool.as_ref()) {
            let (at, detail) = messages::missing(&missing);
            violations.add(&at, FieldCode::Unsupported, detail);
        }
        (Setup { tool, program, dialect, five_axes: None, called: None }, cutting, meta)
    }
}

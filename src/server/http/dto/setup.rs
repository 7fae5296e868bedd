//! The members that requests for toolpaths share: tool, cutting conditions, program and the caller's texts.

use super::axis_output::AxisSetup;
use super::check::Violations;
use super::cutting::Cutting;
use super::meta::{self, Meta};
use super::program::Program;
use crate::http::error::{ApiError, FieldCode};
use crate::http::messages::{self, Warning};
use crate::http::pointer::Pointer;
use toolpathd_core::toolpath::cutting::{Coolant, CuttingRequest};
use toolpathd_core::toolpath::tool_body::{Depths, ToolBody};
use toolpathd_core::toolpath::units::FeedRate;
use toolpathd_core::toolpath::{program, tool};
use toolpathd_post::Dialect;

/// The shared members as they were sent. The tool has been checked already.
pub struct SentSetup {
    pub tool: Option<tool::Tool>,
    /// What is told of the tool beside its cutting edge.
    pub body: ToolBody,
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
    /// What is told of the tool beside its cutting edge.
    pub body: ToolBody,
    /// What is legal in the request and yet often a mistake.
    pub remarks: Vec<Warning>,
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
        let Self { tool, body, cutting, program, meta } = self;
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
        let mut remarks: Vec<Warning> = messages::second_work_offset(dialect, &program).into_iter().collect();
        if let Some(cutting) = &cutting {
            check_speed(cutting, &body, &root, violations);
            remarks.extend(remarks_of_feeds(cutting, &body, &root));
        }
        let setup = Setup { tool, program, dialect, five_axes: None, called: None, body, remarks };
        (setup, cutting, meta)
    }
}

impl Setup {
    /// A setup without a tool.
    pub fn of_program(dialect: &'static Dialect, program: program::Program) -> Self {
        let (body, remarks) = (ToolBody::default(), Vec::new());
        Self { tool: None, program, dialect, five_axes: None, called: None, body, remarks }
    }
}

impl Setup {
    /// Refuses depths for which the tool is too short, and adds what is doubtful to the remarks. `at_once` is
    /// the path of the member that decides how deep is cut at once, and the advice about it.
    ///
    /// # Errors
    /// `invalid_request` with the members at fault.
    pub fn check_depths(&mut self, depths: &Depths, at_once: (&str, &str)) -> Result<(), ApiError> {
        let Some(tool) = self.tool else { return Ok(()) };
        let faults = self.body.too_short(2.0 * tool.radius_mm, depths);
        if let Some(error) = messages::too_short(&faults, at_once) {
            return Err(error);
        }
        self.remarks.extend(self.body.doubt_of_depth(depths).map(Warning::from));
        Ok(())
    }
}

/// Refuses a speed above that of the tool. `at` is the place of the object with the cutting conditions.
pub fn check_speed(cutting: &CuttingRequest, body: &ToolBody, at: &Pointer, violations: &mut Violations) {
    check_speed_limit(cutting, body.max_rpm, "the tool may turn at most", "tool.max_rpm", at, violations);
}

/// Refuses a speed above that of the machine.
pub fn check_machine_speed(cutting: &CuttingRequest, max_rpm: Option<f64>, violations: &mut Violations) {
    let fact = "the spindle turns at most";
    check_speed_limit(cutting, max_rpm, fact, "machine.max_rpm", &Pointer::root(), violations);
}

fn check_speed_limit(
    cutting: &CuttingRequest,
    max_rpm: Option<f64>,
    fact: &str,
    member: &str,
    at: &Pointer,
    violations: &mut Violations,
) {
    if let Some((rpm, max_rpm)) = cutting.spindle_rpm.zip(max_rpm).filter(|(rpm, max_rpm)| rpm > max_rpm) {
        let detail = format!(
            "{rpm} 1/min is too fast: {fact} {max_rpm} 1/min (`{member}`); send at most {max_rpm}, and a feed to match"
        );
        violations.add(&at.field("cutting").field("spindle_rpm"), FieldCode::OutOfRange, detail);
    }
}

/// The warnings about feeds. `at` is the place of the object with the cutting conditions.
pub fn remarks_of_feeds(cutting: &CuttingRequest, body: &ToolBody, at: &Pointer) -> Vec<Warning> {
    let conditions = at.field("cutting");
    let feed = cutting.feed.mm_per_min();
    let doubt = cutting.spindle_rpm.and_then(|rpm| body.doubt_of_feed(feed, rpm));
    let per_tooth = doubt.map(|doubt| Warning::from(doubt).about(&conditions.field("feed_mm_per_min")));
    let slot = cutting.slot_feed.map(FeedRate::mm_per_min).filter(|slot| *slot > feed);
    let slot = slot.map(|slot| {
        Warning::slot_feed_above_feed(slot, feed).about(&conditions.field("slot_feed_mm_per_min"))
    });
    per_tooth.into_iter().chain(slot).collect()
}

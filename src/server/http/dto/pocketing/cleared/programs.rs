//! The flat cutters of an NC program, and what they have swept.

use super::ClearingTool;
use crate::config::Limits;
use crate::http::dto::check::{Range, Violations};
use crate::http::dto::dialect;
use crate::http::dto::program_reading::{Compensation, WithoutPoint};
use crate::http::error::FieldCode;
use crate::http::messages;
use crate::http::pointer::Pointer;
use toolpathd_core::budget::Budget;
use toolpathd_core::geometry::curve::Curve;
use toolpathd_core::operations::pocketing as core;
use toolpathd_core::toolpath::program::Units;
use toolpathd_core::toolpath::{Move, Pass, Toolpath};
use toolpathd_nc::control::{self, Control};
use toolpathd_nc::machine::{Correction, Cutter};
use toolpathd_nc::record::ToolUse;
use toolpathd_nc::{ReadError, ReadJob, ReadProgram};
use toolpathd_post::Dialect;
use toolpathd_post::read::{Reader, Step};

/// The most tools of a program.
pub const MOST_TOOLS: usize = 200;

/// By how much the distances of an arc's ends from its centre may differ in a program of a dialect that only
/// this service writes, mm. Rounding to the program's decimals makes a few thousandths.
const RADII_MM: f64 = 0.01;

/// A program, with what its text does not say.
pub struct Program {
    pub nc: String,
    pub dialect: Option<String>,
    pub units: Option<Units>,
    pub without_point: Option<WithoutPoint>,
    pub compensation: Option<Compensation>,
}

/// The flat cutters of a program.
pub enum Cutters {
    /// One cutter runs the whole program.
    One {
        diameter_mm: f64,
    },
    Several(Vec<ClearingTool>),
}

/// The cutters of a request: one diameter, or several tools.
pub fn cutters(
    diameter_mm: Option<f64>,
    tools: Option<Vec<ClearingTool>>,
    at: &Pointer,
    violations: &mut Violations,
) -> Option<Cutters> {
    let (at_one, at_all) = (at.field("tool_diameter_mm"), at.field("tools"));
    match (diameter_mm, tools) {
        (Some(diameter_mm), None) => {
            violations.number(&at_one, diameter_mm, Range::POSITIVE, "mm");
            Some(Cutters::One { diameter_mm })
        }
        (None, Some(tools)) => {
            if !(1..=MOST_TOOLS).contains(&tools.len()) {
                let detail = format!("there are {} tools; send 1 to {MOST_TOOLS}", tools.len());
                violations.add(&at_all, FieldCode::WrongLength, detail);
                return None;
            }
            for (k, tool) in tools.iter().enumerate() {
                check(tool, &tools[..k], &at_all.index(k), violations);
            }
            Some(Cutters::Several(tools))
        }
        (Some(_), Some(_)) => {
            let detail = "send either `tool_diameter_mm` or `tools`";
            violations.add(&at_all, FieldCode::Conflict, detail);
            None
        }
        (None, None) => {
            let detail = "`nc` needs the diameter of its cutter, or its `tools`";
            violations.add(&at_one, FieldCode::MissingField, detail);
            None
        }
    }
}

fn check(tool: &ClearingTool, before: &[ClearingTool], at: &Pointer, violations: &mut Violations) {
    violations.number(&at.field("diameter_mm"), tool.diameter_mm, Range::POSITIVE, "mm");
    if tool.number.is_some() == tool.name.is_some() {
        let detail = "send either the `number` or the `name` by which the program calls the tool";
        violations.add(at, FieldCode::Conflict, detail);
    }
    let is_same = |other: &ClearingTool| match (tool.number, &tool.name, &other.name) {
        (Some(number), _, _) => other.number == Some(number),
        (None, Some(name), Some(other)) => name.eq_ignore_ascii_case(other),
        _ => false,
    };
    if before.iter().any(is_same) {
        violations.add(at, FieldCode::Conflict, "the tool stands twice; send it once");
    }
}

impl Program {
    /// What each cutter has swept. Adds violations to `violations`.
    pub fn convert(
        &self,
        cutters: &Cutters,
        at: &Pointer,
        limits: &Limits,
        violations: &mut Violations,
    ) -> Vec<core::Emptied> {
        let dialect = match dialect::find(self.dialect.as_deref()) {
            Ok(dialect) => dialect,
            Err(detail) => {
                violations.add(&at.field("dialect"), FieldCode::UnknownDialect, detail);
                return Vec::new();
            }
        };
        let swept = match Control::named(dialect.name) {
            Some(control) => self.read(control, cutters, at, limits, violations),
            None => self.read_own(dialect, cutters, at, limits, violations),
        };
        swept
            .into_iter()
            .map(|(along, diameter_mm)| core::Emptied::Path { along, radius_mm: 0.5 * diameter_mm })
            .collect()
    }

    /// The feed moves of each cutter, with its diameter in mm.
    fn read(
        &self,
        control: &'static Control,
        cutters: &Cutters,
        at: &Pointer,
        limits: &Limits,
        violations: &mut Violations,
    ) -> Vec<(Vec<Curve>, f64)> {
        let radii = cutters.radii();
        let job = ReadJob {
            in_inches: self.units == Some(Units::Inch),
            without_point: self.without_point.map(|own| match own {
                WithoutPoint::Increments => control::WithoutPoint::Increments,
                WithoutPoint::Units => control::WithoutPoint::Units,
            }),
            correction: match self.compensation {
                None | Some(Compensation::Refuse) => Correction::Refused,
                Some(Compensation::Wear) => Correction::Wear,
                Some(Compensation::Compute) => Correction::Computed(&radii),
            },
            most_moves: limits.moves,
            ..ReadJob::plain(self.nc.as_bytes(), control)
        };
        // The reader ends by its own limits.
        let program = match toolpathd_nc::read(&job, &Budget::unlimited()) {
            Ok(program) => program,
            Err(error) => {
                refuse(error, &at.field("nc"), violations);
                return Vec::new();
            }
        };
        let ReadProgram { toolpath, tools, .. } = &program;
        match cutters {
            Cutters::One { diameter_mm } => {
                let mut cutting =
                    tools.iter().filter(|tool| tool.n_passes > 0 && tool.cutting_length_mm > 0.0);
                let first = cutting.next();
                if let Some(other) = cutting.find(|other| !is_one(first, other)) {
                    let detail = format!(
                        "line {}: the program cuts with another tool; send the diameter of each tool as `tools`",
                        other.line
                    );
                    violations.add(&at.field("tool_diameter_mm"), FieldCode::Conflict, detail);
                }
                vec![(feeds(toolpath, 0, usize::MAX), *diameter_mm)]
            }
            Cutters::Several(sent) => {
                let mut swept = Vec::new();
                for (k, sent) in sent.iter().enumerate() {
                    let uses: Vec<&ToolUse> = tools.iter().filter(|tool| sent.is_called_as(tool)).collect();
                    let along: Vec<Curve> = uses
                        .iter()
                        .flat_map(|tool| feeds(toolpath, tool.first_pass, tool.n_passes))
                        .collect();
                    if along.is_empty() {
                        let detail =
                            "the program cuts with no tool of this number or name; leave the tool out";
                        violations.add(&at.field("tools").index(k), FieldCode::Conflict, detail);
                    }
                    swept.push((along, sent.diameter_mm));
                }
                swept
            }
        }
    }

    /// The feed moves of a program in a dialect that this service writes and the reader of programs of any
    /// origin does not know.
    fn read_own(
        &self,
        dialect: &'static Dialect,
        cutters: &Cutters,
        at: &Pointer,
        limits: &Limits,
        violations: &mut Violations,
    ) -> Vec<(Vec<Curve>, f64)> {
        let Cutters::One { diameter_mm } = cutters else {
            let detail =
                format!("of a program in `{}` one tool is read; send `tool_diameter_mm`", dialect.name);
            violations.add(&at.field("tools"), FieldCode::Unsupported, detail);
            return Vec::new();
        };
        let at = at.field("nc");
        let mut moves = Vec::new();
        let mut program = Reader::new(&self.nc, dialect, RADII_MM);
        let mut first = None;
        while let Some(placed) = program.next() {
            match placed.map(|placed| placed.step) {
                Ok(Step::Feed { along, .. }) => {
                    let state = program.state();
                    let own = (state.tool, state.work_offset);
                    if *first.get_or_insert(own) != own {
                        let detail = format!(
                            "line {}: another tool or work offset than the cuts before; send the part of each tool and offset as a program of its own",
                            program.line()
                        );
                        violations.add(&at, FieldCode::Unsupported, detail);
                        return Vec::new();
                    }
                    moves.push(along);
                }
                Ok(_) => {}
                Err(error) => {
                    violations.add(&at, FieldCode::Syntax, error.to_string());
                    return Vec::new();
                }
            }
            if moves.len() > limits.moves {
                let detail = format!("the program has more than {} feed moves", limits.moves);
                violations.add(&at, FieldCode::LimitExceeded, detail);
                return Vec::new();
            }
        }
        vec![(moves, *diameter_mm)]
    }
}

impl Cutters {
    /// The cutters by which cutter compensation is computed.
    fn radii(&self) -> Vec<Cutter> {
        match self {
            Self::One { diameter_mm } => vec![Cutter { number: None, radius_mm: 0.5 * diameter_mm }],
            Self::Several(tools) => tools
                .iter()
                .filter(|tool| tool.number.is_some())
                .map(|tool| Cutter { number: tool.number, radius_mm: 0.5 * tool.diameter_mm })
                .collect(),
        }
    }
}

impl ClearingTool {
    fn is_called_as(&self, used: &ToolUse) -> bool {
        match (&self.name, &used.name) {
            (Some(name), Some(used)) => name.eq_ignore_ascii_case(used),
            _ => self.number.is_some() && self.number == used.number,
        }
    }
}

/// Whether two uses are of the same tool. Before the first change the tool is not known.
fn is_one(first: Option<&ToolUse>, other: &ToolUse) -> bool {
    first.is_none_or(|first| (first.number, &first.name) == (other.number, &other.name))
}

/// The feed moves of `n` passes from the pass `first` on.
fn feeds(toolpath: &Toolpath, first: usize, n: usize) -> Vec<Curve> {
    let moves = toolpath.passes().iter().skip(first).take(n).flat_map(Pass::moves);
    let along = |step: &Move| if let Move::Feed { along, .. } = step { Some(*along) } else { None };
    moves.filter_map(along).collect()
}

/// Refuses a program that is not read.
fn refuse(error: ReadError, at: &Pointer, violations: &mut Violations) {
    if error == ReadError::NoMotion {
        violations.add(at, FieldCode::RefusedWord, error.to_string());
        return;
    }
    for error in messages::not_read(error, at).errors() {
        violations.add_made(|| error.clone());
    }
}

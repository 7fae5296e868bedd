//! How a program states the tool axis.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use crate::http::dto::check::Violations;
use crate::http::dto::names::into_core;
use crate::http::error::FieldCode;
use crate::http::pointer::Pointer;
use toolpathd_core::machine::{Machine, Straying};
use toolpathd_post::{Dialect, FiveAxes};

/// How a program states the tool axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum AxisOutput {
    /// The tip and the angles of the rotary axes (Fanuc: G43.4, Siemens: TRAORI, Heidenhain: TCPM). The
    /// control keeps the tip on its line.
    Angles,
    /// The tip and the vector of the tool axis (Fanuc: G43.5, Siemens: A3 B3 C3, Heidenhain: LN).
    Vectors,
    /// As `vectors`, and the smooth path as polynomials of the tip and of a second point where
    /// `/v1/five-axis/smooth` has made it (Siemens: ORICURVE, POLY).
    Rails,
    /// The positions of all five axes of the machine, with the time of each block (G93).
    Machine,
}

into_core!(AxisOutput => toolpathd_post::AxisOutput, [Angles, Vectors, Rails, Machine]);

impl AxisOutput {
    /// All ways in which a dialect can state the tool axis.
    pub fn all_of(dialect: &Dialect) -> Vec<Self> {
        let all = [Self::Angles, Self::Vectors, Self::Rails, Self::Machine];
        all.into_iter().filter(|&output| dialect.five_axes.write(output.into())).collect()
    }
}

/// What a program of a leaning tool needs besides the toolpath.
#[derive(Debug, Clone)]
pub struct AxisSetup {
    output: toolpathd_post::AxisOutput,
    machine: Option<Machine>,
    allowed: Straying,
}

impl AxisSetup {
    /// The way that was asked for, or the usual one of the dialect. `None` where neither `axis_output` nor
    /// `machine` was sent and the dialect writes no vectors. Adds violations to `violations`.
    pub fn choose(
        sent: Option<AxisOutput>,
        machine: Option<Machine>,
        dialect: &Dialect,
        allowed: Straying,
        violations: &mut Violations,
    ) -> Option<Self> {
        use toolpathd_post::AxisOutput::{Angles, Machine as Positions, Rails, Vectors};
        let words = dialect.five_axes;
        if AxisOutput::all_of(dialect).is_empty() {
            let at = Pointer::root().field("program").field("dialect");
            let detail = format!(
                "the dialect `{}` has no words for a leaning tool; choose a dialect of a control with five axes",
                dialect.name
            );
            violations.add(&at, FieldCode::Unsupported, detail);
            return None;
        }
        let output = match sent.map(toolpathd_post::AxisOutput::from) {
            Some(output) => output,
            None if machine.is_some() && words.angles.is_some() => Angles,
            None if machine.is_some() => Positions,
            None if words.vectors.is_some() => Vectors,
            None => return None,
        };
        if !words.write(output) {
            let at = Pointer::root().field("axis_output");
            let detail = format!(
                "the dialect `{}` cannot write this `axis_output`; send one that `/v1/dialects` lists, or leave it out",
                dialect.name
            );
            violations.add(&at, FieldCode::Unsupported, detail);
        } else if machine.is_none() && output != Vectors && output != Rails {
            let detail = "angles and positions of axes need a machine: send `machine`";
            violations.add(&Pointer::root().field("machine"), FieldCode::MissingField, detail);
        }
        Some(Self { output, machine, allowed })
    }

    /// The same for the writer of programs.
    pub fn five_axes(&self) -> FiveAxes<'_> {
        FiveAxes { output: self.output, machine: self.machine.as_ref(), allowed: self.allowed }
    }

    /// How far the tip may stray between blocks, mm: only where the program states positions.
    pub fn strays_mm(&self) -> f64 {
        if self.output == toolpathd_post::AxisOutput::Machine { self.allowed.tip_mm } else { 0.0 }
    }
}

//! How a program states the tool axis.

use crate::http::dto::check::Violations;
use crate::http::error::FieldCode;
use crate::http::pointer::Pointer;
use toolpathd_core::machine::{Machine, Straying};
use toolpathd_core::operations::five_axis::MotionLimits;
use toolpathd_post::{AxisOutput, Dialect, FiveAxes};

/// What a program of a leaning tool needs besides the toolpath.
#[derive(Debug, Clone)]
pub struct AxisSetup {
    output: AxisOutput,
    machine: Option<Machine>,
    allowed: Straying,
    speeds: [f64; 5],
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
        if words.outputs().next().is_none() {
            let at = Pointer::root().field("program").field("dialect");
            let detail = format!(
                "the dialect `{}` has no words for a leaning tool; choose a dialect of a control with five axes",
                dialect.name
            );
            violations.add(&at, FieldCode::Unsupported, detail);
            return None;
        }
        let output = match sent {
            Some(output) => output,
            None if machine.is_some() && words.angles.is_some() && !words.switches_kinematics => Angles,
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
        Some(Self { output, machine, allowed, speeds: [f64::INFINITY; 5] })
    }

    /// No axis is to be faster than these limits allow.
    pub fn limit(&mut self, limits: &MotionLimits) {
        if let Some(machine) = &self.machine {
            self.speeds = limits.speeds(machine);
        }
    }

    /// How far the tool may stray while the axes move in step. `None` where the program does not state their
    /// positions.
    pub fn in_step(&self) -> Option<Straying> {
        use toolpathd_post::AxisOutput::{Angles, Machine as Positions, Rails, Vectors};
        match self.output {
            Positions => Some(self.allowed),
            // The control keeps the tip on its line.
            Angles => Some(Straying { tip_mm: f64::INFINITY, ..self.allowed }),
            Vectors | Rails => None,
        }
    }

    /// The same for the writer of programs.
    pub fn five_axes(&self) -> FiveAxes<'_> {
        FiveAxes {
            output: self.output,
            machine: self.machine.as_ref(),
            allowed: self.allowed,
            speeds: self.speeds,
        }
    }

    /// How far the tip may stray between blocks, mm: only where the program states positions.
    pub fn strays_mm(&self) -> f64 {
        if self.output == toolpathd_post::AxisOutput::Machine { self.allowed.tip_mm } else { 0.0 }
    }
}

//! Drilling cycles by their calls: which are read, and what their parameters mean.
//!
//! # Method
//! The parameters are those of the manual *Cycles*. Later versions add three masks (_GMODE, _DMODE, _AMODE)
//! behind them; values of the masks that this reader does not know are refused.

use toolpathd_core::geometry::plane::Plane;

use super::Mill;
use super::values::Value;
use crate::block::Line;
use crate::fault::Fault;

/// A cycle that is read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// CYCLE81 and CYCLE82.
    Drill,
    /// CYCLE83.
    Pecks,
    /// CYCLE84.
    RigidTap,
    /// CYCLE840.
    Tap,
    /// CYCLE85 and CYCLE89: out by feed.
    Ream,
    /// CYCLE86: out with the spindle at rest, away from the wall.
    Bore,
    /// CYCLE87 and CYCLE88: out with the spindle at rest.
    BoreAndStop,
}

/// A call of a cycle.
#[derive(Debug, Clone, PartialEq)]
pub struct Cycle {
    pub name: String,
    pub kind: Kind,
    pub parameters: Vec<Option<f64>>,
    /// Where the call stands in its line.
    pub span: [usize; 2],
}

/// The heights of a hole along the normal in coordinates of the program, mm.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Heights {
    pub retraction: f64,
    pub reference: f64,
    /// The height down to which rapids lead.
    pub start: f64,
    pub depth: f64,
}

/// Indices of the three masks behind the parameters of a cycle.
fn masks(name: &str) -> Option<(Kind, usize)> {
    Some(match name {
        "CYCLE81" | "CYCLE82" => (Kind::Drill, 6),
        "CYCLE83" => (Kind::Pecks, 17),
        "CYCLE84" => (Kind::RigidTap, 21),
        "CYCLE840" => (Kind::Tap, 17),
        "CYCLE85" => (Kind::Ream, 8),
        "CYCLE89" => (Kind::Ream, 6),
        "CYCLE86" => (Kind::Bore, 11),
        "CYCLE87" => (Kind::BoreAndStop, 6),
        "CYCLE88" => (Kind::BoreAndStop, 7),
        _ => return None,
    })
}

/// The call of a drilling cycle; `None` for another name.
///
/// # Errors
/// When a parameter is a text.
pub fn cycle(name: &str, arguments: &[Option<Value>], span: [usize; 2]) -> Option<Result<Cycle, Fault>> {
    let (kind, _) = masks(name)?;
    let number = |argument: &Option<Value>| match argument {
        None => Ok(None),
        Some(Value::Text(text)) if text.is_empty() => Ok(None),
        Some(value) => value.number().map(Some),
    };
    let parameters: Result<Vec<_>, _> = arguments.iter().map(number).collect();
    Some(parameters.map(|parameters| Cycle { name: name.to_owned(), kind, parameters, span }))
}

impl Cycle {
    /// A parameter; zero if it is absent.
    pub fn value(&self, index: usize) -> f64 {
        self.parameters.get(index).copied().flatten().unwrap_or(0.0)
    }

    fn first_mask(&self) -> usize {
        masks(&self.name).map_or(0, |(_, first)| first)
    }

    /// The index of the dwell time at the bottom.
    pub fn dwell_index(&self) -> Option<usize> {
        match (self.kind, self.name.as_str()) {
            (Kind::Pecks, _) => Some(8),
            (_, "CYCLE87") => None,
            _ => Some(5),
        }
    }
}

impl<'a> Mill<'a, '_> {
    pub(super) fn refuse_parameter(&mut self, line: Line<'a>, cycle: &Cycle, name: &'static str) {
        self.refuse(line, span_in(line, cycle), Fault::CycleParameter(name));
    }

    /// The heights of a cycle. A refusal has been made where there are none.
    pub(super) fn heights(&mut self, line: Line<'a>, cycle: &Cycle) -> Option<Heights> {
        if !self.allows_masks(line, cycle) {
            return None;
        }
        self.assume_units(line);
        let unit = self.machine.unit_mm();
        for (index, name) in [(0, "RTP"), (1, "RFP")] {
            if cycle.parameters.get(index).copied().flatten().is_none() {
                self.refuse_parameter(line, cycle, name);
                return None;
            }
        }
        let [retraction, reference, clearance] = [0, 1, 2].map(|k| cycle.value(k) * unit);
        let (absolute, relative) = (cycle.parameters.get(3).copied().flatten(), cycle.value(4) * unit);
        let mode = self.amode(cycle) % 10;
        let is_relative = relative != 0.0;
        let fits = match mode {
            1 => is_relative && absolute.unwrap_or(0.0) == 0.0,
            2 => absolute.is_some() && !is_relative,
            _ => is_relative || absolute.is_some(),
        };
        if !fits {
            self.refuse_parameter(line, cycle, "DP");
            return None;
        }
        // DPR counts where both are given.
        let depth = if is_relative { reference - relative.abs() } else { absolute.unwrap_or(0.0) * unit };
        let is_above = retraction > reference || retraction == reference && !is_relative;
        if !is_above || depth >= reference {
            self.refuse_parameter(line, cycle, if is_above { "DP" } else { "RTP" });
            return None;
        }
        Some(Heights { retraction, reference, start: reference + clearance.abs(), depth })
    }

    fn amode(&self, cycle: &Cycle) -> u32 {
        cycle.value(cycle.first_mask() + 2) as u32
    }

    /// Whether the masks of later versions say nothing beyond what is read.
    fn allows_masks(&mut self, line: Line<'a>, cycle: &Cycle) -> bool {
        let first = cycle.first_mask();
        let plane = match self.machine.plane {
            Plane::Xy => 1.0,
            Plane::Zx => 2.0,
            Plane::Yz => 3.0,
        };
        // Behind CYCLE81 some systems write no dwell time: the masks 0, 0 and 10 then stand one place before.
        let is_early = cycle.name == "CYCLE81" && cycle.parameters.len() == 8 && cycle.value(7) == 10.0;
        let first = if is_early { 5 } else { first };
        let mode = cycle.value(first + 2);
        let dwell_s = cycle.dwell_index().map_or(0.0, |index| cycle.value(index));
        let depth_modes: &[f64] = &[0.0, 1.0, 2.0];
        // The tens say that the dwell time is in seconds (1) or in turns (2).
        let is_mode = depth_modes.contains(&(mode % 10.0))
            && match (mode / 10.0).trunc() {
                0.0 | 1.0 => true,
                2.0 => dwell_s == 0.0,
                // All times of CYCLE83 are in seconds, and its depths are as without masks.
                11.0 | 111.0 | 100_111.0 => cycle.kind == Kind::Pecks,
                _ => false,
            };
        let wrong = if cycle.value(first) != 0.0 {
            Some("_GMODE")
        } else if cycle.value(first + 1) != 0.0 && cycle.value(first + 1) != plane {
            Some("_DMODE")
        } else if !is_mode {
            Some("_AMODE")
        } else if cycle.parameters.iter().skip(first + 3).flatten().any(|value| *value != 0.0) {
            Some("behind _AMODE")
        } else {
            None
        };
        if let Some(name) = wrong {
            self.refuse_parameter(line, cycle, name);
        }
        wrong.is_none()
    }

    /// The axis of the tool that a parameter names is the normal of the plane, or not named.
    pub(super) fn is_along_normal(&mut self, line: Line<'a>, cycle: &Cycle, index: usize) -> bool {
        let is_normal = matches!(cycle.value(index), 0.0 | 3.0);
        if !is_normal {
            self.refuse_parameter(line, cycle, "_AXN");
        }
        is_normal
    }

    /// The dwell time of a parameter, s: turns of the spindle if it is negative.
    pub(super) fn pause_by(&mut self, line: Line<'a>, cycle: &Cycle, value: f64) {
        let seconds = match self.machine.speed.filter(|speed| *speed > 0.0) {
            _ if value >= 0.0 => value,
            Some(speed) => -value * 60.0 / speed,
            None => return self.machine.refuse_state(line, Fault::NoSpindleSpeed),
        };
        if seconds > 0.0 {
            self.pause(line, span_in(line, cycle), seconds);
        }
    }

    /// The pitch of a thread, mm; `None` has been refused.
    pub(super) fn pitch(
        &mut self,
        line: Line<'a>,
        cycle: &Cycle,
        [size, pitch, unit]: [usize; 3],
    ) -> Option<f64> {
        let [size, pitch, unit] = [size, pitch, unit].map(|index| cycle.value(index).abs());
        let of_size = if size == 0.0 { None } else { coarse_pitch(size) };
        let is_legal = match (size == 0.0, of_size) {
            (false, None) => false,
            (false, Some(of_size)) => pitch == 0.0 || pitch == of_size,
            (true, _) => pitch > 0.0 && !self.machine.in_inches(),
        };
        if !is_legal || unit > 1.0 {
            self.refuse_parameter(line, cycle, if unit > 1.0 { "_PITA" } else { "PIT" });
            return None;
        }
        Some(of_size.unwrap_or(pitch))
    }
}

/// The call of a cycle in its line; a whole line that a modal cycle runs behind.
fn span_in(line: Line<'_>, cycle: &Cycle) -> [usize; 2] {
    let [start, end] = cycle.span;
    let text = line.text.get(start..end).unwrap_or_default();
    let is_own = text.to_ascii_uppercase().starts_with(cycle.name.as_bytes());
    if is_own { cycle.span } else { [0, line.text.len()] }
}

/// The pitch of a metric thread of this size, mm (ISO 261, coarse).
fn coarse_pitch(size: f64) -> Option<f64> {
    let table = [
        (3.0, 0.5),
        (4.0, 0.7),
        (5.0, 0.8),
        (6.0, 1.0),
        (8.0, 1.25),
        (10.0, 1.5),
        (12.0, 1.75),
        (14.0, 2.0),
        (16.0, 2.0),
        (18.0, 2.5),
        (20.0, 2.5),
        (22.0, 2.5),
        (24.0, 3.0),
        (27.0, 3.0),
        (30.0, 3.5),
        (33.0, 3.5),
        (36.0, 4.0),
        (39.0, 4.0),
        (42.0, 4.5),
        (45.0, 4.5),
        (48.0, 5.0),
    ];
    table.into_iter().find(|(own, _)| *own == size).map(|(_, pitch)| pitch)
}

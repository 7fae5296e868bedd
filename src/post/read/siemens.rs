//! Reads programs in the language of Siemens controls.
//!
//! # Method
//! 1. `words` reads the words of a line up to the semicolon of its comment.
//! 2. The words take effect in this order: G codes, tool, cutting edge, feed, end of the program.
//! 3. `motion` makes a step of the rest and of the modal state.
//!
//! # Guarantees
//! * No mode is assumed. A motion needs G700 or G710, G90 and a code of motion, an arc needs its plane, and a
//!   feed needs G93 or G94: machine data decide in which modes a program starts.
//! * A motion along Z needs a cutting edge (D) other than 0. A tool change and D0 end the length offset.
//! * Under G93 each feed block states F, one by its minutes. A change between G93 and G94 loses the feed.
//! * Under TRAORI a motion needs ORIVECT, and then A3, B3 and C3, or ORIAXES, and then rotary axes that are
//!   known. TRAORI, TRAFOOF and a work offset lose the position, and another cutting edge loses Z.
//! * A motion with a vector leaves the rotary axes at angles that are not known. No cut without TRAORI may
//!   follow until a block states the angles.
//! * Under G94 the axis does not turn about a resting tip, and without TRAORI it does not turn in a feed
//!   block: what F counts there differs between machines.
//! * N words count as the dialect says; a block may have none.
//! * Letters are capitals, though the control reads small letters, too.
//!
//! # Reference
//! SINUMERIK 840D/840Di/810D, *Programming Manual Job Planning*, 03/2006 (TRAORI, ORIWKS, ORIVECT, A3=);
//! SINUMERIK 840D sl, *Programming Manual* (example of ORIVECT); SINUMERIK 840Di sl manual (G93, G700, G710);
//! SINUMERIK 840De, *Programming Manual*, p. 55 (equal signs, points); SINUMERIK 802D sl, *ISO manual*, p.
//! 3-42 (SUPA); SINUMERIK ONE, *Programming Manual*, pp. 52, 204 (tool, arcs).

mod cycle;
mod motion;
mod rails;
mod words;

use self::words::{Keyword, Words};
use super::hole::Cycle;
use super::number::Number;
use super::state::{Calls, MachineState, Spindle};
use super::{Language, Step, TipMode};
use crate::dialect::{BlockNumbers, Dialect, Syntax};
use crate::nc::{Fault, FeedMode, Modal, Motion, WordFault, effect};
use toolpathd_core::geometry::plane::Plane;
use toolpathd_core::toolpath::arc_rule::ArcRule;
use toolpathd_core::toolpath::cutting::Coolant;
use toolpathd_core::toolpath::program::{Smoothing, SmoothingMode, Units};
use toolpathd_core::toolpath::units::FeedRate;

/// The number of a tool and of its cutting edge, at most.
const MAX_TOOL: u32 = 99_999_999;
const MAX_EDGE: u32 = 32_000;

const DWELL: u16 = 4;
/// Corners are rounded from the distance ADIS on.
const ROUNDING: u16 = 641;

/// The rules of the language, with the modal state.
pub struct Reader<'a> {
    dialect: &'a Dialect,
    /// What the control demands of an arc.
    arcs: ArcRule,
    block_numbers: Option<BlockNumbers>,
    /// The last N word.
    number: Option<u32>,
    /// Whether M30 has been read.
    is_over: bool,
    /// Position in mm.
    modal: Modal<f64, FeedRate>,
    /// The cutting edge, 0 without length offset.
    edge: u32,
    /// Whether the edge was selected in the plane XY: the length of a tool counts along the normal of the
    /// plane.
    is_edge_along_z: bool,
    /// ORIWKS has been stated. Without it, machine data decide in which frame vectors count.
    is_in_workpiece: bool,
    has_tip_control: bool,
    /// How the axis is told under tip control.
    orientation: Option<TipMode>,
    angles: [Option<f64>; 3],
    vector: Option<[f64; 3]>,
    /// ORICURVE is in force: blocks state a second point of the tool.
    is_on_rails: bool,
    is_polynomial: bool,
    /// POLYPATH has let polynomials move the second point.
    has_polynomials: bool,
    /// The second point, mm.
    second: Option<[f64; 3]>,
    /// Whether the last motion with a vector has left the rotary axes at unknown angles.
    has_lost_axis: bool,
    smoothing: Option<Smoothing>,
    cycle: Option<Cycle>,
    /// All but the length offset, which is the cutting edge.
    state: MachineState,
    /// No mode is taken for granted behind a change from one tool to another.
    is_strict: bool,
}

impl Language for Reader<'_> {
    fn line(&mut self, text: &str) -> Result<Option<Step>, Fault> {
        if self.is_over {
            return if text.trim().is_empty() { Ok(None) } else { Err(Fault::AfterEnd) };
        }
        let limit = self.dialect.max_line_length;
        if text.chars().count() > limit {
            return Err(Fault::LongLine { limit });
        }
        if self.is_on_rails && rails::is_rail(text) {
            return self.rail(text).map(|rail| Some(Step::Rail(rail)));
        }
        let words = Words::of(text, self.dialect)?;
        self.block(&words)
    }

    fn pass(&mut self) {
        if let (Some(number), Some(rule)) = (self.number, self.block_numbers) {
            self.number = Some(if number < rule.max { number + rule.step } else { rule.step });
        }
        self.modal = Modal::UNKNOWN;
        (self.edge, self.has_tip_control, self.orientation) = (0, false, None);
        (self.angles, self.vector, self.is_in_workpiece) = ([None; 3], None, false);
        (self.is_on_rails, self.has_polynomials) = (false, false);
        (self.smoothing, self.cycle) = (None, None);
        self.state = self.state.behind_own_lines();
    }

    fn assume_nothing(&mut self) {
        self.is_strict = true;
    }

    fn calls(&self) -> Calls {
        Calls { tools: true, length_offsets: true }
    }

    fn state(&self) -> MachineState {
        MachineState {
            length_offset: Some(self.edge).filter(|edge| *edge > 0 && self.is_edge_along_z),
            ..self.state
        }
    }

    fn smoothing(&self) -> Option<Smoothing> {
        self.smoothing
    }

    fn end(&self) -> Result<(), Fault> {
        if self.is_over { Ok(()) } else { Err(Fault::NoEnd) }
    }
}

impl<'a> Reader<'a> {
    pub fn new(dialect: &'a Dialect, arcs: ArcRule) -> Self {
        let block_numbers = match &dialect.syntax {
            Syntax::Siemens(iso) => Some(iso.block_numbers),
            _ => None,
        };
        Self {
            dialect,
            arcs,
            block_numbers,
            number: None,
            is_over: false,
            modal: Modal::UNKNOWN,
            edge: 0,
            is_edge_along_z: false,
            is_in_workpiece: false,
            has_tip_control: false,
            orientation: None,
            angles: [None; 3],
            vector: None,
            is_on_rails: false,
            is_polynomial: false,
            has_polynomials: false,
            second: None,
            has_lost_axis: false,
            smoothing: None,
            cycle: None,
            state: MachineState::default(),
            is_strict: false,
        }
    }

    fn block(&mut self, words: &Words) -> Result<Option<Step>, Fault> {
        self.check_number(words.number)?;
        if words.rounding.is_some() != words.g.contains(&ROUNDING) {
            return Err(Fault::Word("ADIS", WordFault::Unused));
        }
        if let Some(call) = words.modal_call {
            return self.modal_call(call, words).map(|()| None);
        }
        if let Some(arguments) = words.smoothing {
            return self.cycle_832(arguments, words).map(|()| None);
        }
        match words.keyword {
            Some(Keyword::MachineZero) => return self.machine_zero(words),
            Some(keyword) => return self.switch(keyword, words).map(|()| None),
            None => {}
        }
        for &code in words.g.iter() {
            self.apply(code);
        }
        if words.g.iter().any(|code| [64, ROUNDING].contains(code)) {
            let of_path = |mm| Smoothing { tolerance_mm: Some(mm), tolerance_deg: None, mode: None };
            let tolerance_mm =
                words.rounding.map(|distance| self.unit_mm().map(|unit_mm| distance * unit_mm));
            self.smoothing = tolerance_mm.transpose()?.map(of_path);
        }
        if words.g.contains(&DWELL) {
            return dwell(words).map(Some);
        }
        self.tool(words)?;
        self.feed(words)?;
        self.is_over = words.m.contains(&30);
        if self.is_over && self.has_tip_control {
            return Err(Fault::UnderTipControl);
        }
        if self.is_over && self.smoothing.is_some_and(|smoothing| smoothing.mode.is_some()) {
            // It would hold for the next program.
            return Err(Fault::Conflict);
        }
        self.motion(words)
    }

    /// `CYCLE832(0.01,_FINISH,1)`, or `CYCLE832(0.01,_ORI_FINISH,0.5)` with a tolerance of angles in degrees.
    /// Without arguments the cycle ends the smoothing.
    fn cycle_832(&mut self, arguments: &str, words: &Words) -> Result<(), Fault> {
        if !words.is_empty() || words.keyword.is_some() || words.rounding.is_some() {
            return Err(Fault::Conflict);
        }
        if arguments.is_empty() {
            self.smoothing = None;
            return Ok(());
        }
        let wrong = |fault| Fault::Word("CYCLE832", fault);
        let parts: Vec<&str> = arguments.split(',').collect();
        let &[path, mode, last] = &parts[..] else { return Err(wrong(WordFault::Form)) };
        let number = |text: &str| {
            let number = Number::whole_of(text).filter(|number| number.sign.is_none());
            number.map(|number| number.value).filter(|value| *value > 0.0).ok_or(wrong(WordFault::Number))
        };
        let (mode, has_angle) = match mode {
            "_ROUGH" => (SmoothingMode::Roughing, false),
            "_SEMIFIN" => (SmoothingMode::SemiFinishing, false),
            "_FINISH" => (SmoothingMode::Finishing, false),
            "_ORI_ROUGH" => (SmoothingMode::Roughing, true),
            "_ORI_SEMIFIN" => (SmoothingMode::SemiFinishing, true),
            "_ORI_FINISH" => (SmoothingMode::Finishing, true),
            _ => return Err(wrong(WordFault::Form)),
        };
        if !has_angle && last != "1" {
            return Err(wrong(WordFault::Range));
        }
        let tolerance_deg = if has_angle { Some(number(last)?) } else { None };
        let tolerance_mm = Some(number(path)? * self.unit_mm()?);
        self.smoothing = Some(Smoothing { tolerance_mm, tolerance_deg, mode: Some(mode) });
        Ok(())
    }

    /// # Errors
    /// When the N word does not follow the one before it.
    fn check_number(&mut self, number: Option<u32>) -> Result<(), Fault> {
        let (Some(number), Some(rule)) = (number, self.block_numbers) else { return Ok(()) };
        let expected = match self.number {
            Some(last) if last < rule.max => last + rule.step,
            _ => rule.step,
        };
        self.number = Some(number);
        if number == expected { Ok(()) } else { Err(Fault::BlockNumber { expected }) }
    }

    /// Lets a G code take effect. `words` has refused all codes but those that are read.
    fn apply(&mut self, code: u16) {
        let modal = &mut self.modal;
        match code {
            700 | 710 => {
                let units = if code == 700 { Units::Inch } else { Units::Mm };
                if modal.units.replace(units) != Some(units) {
                    modal.feed = None;
                }
            }
            93 | 94 => {
                let mode = if code == 93 { FeedMode::InverseTime } else { FeedMode::PerMinute };
                if modal.feed_mode.replace(mode) != Some(mode) {
                    modal.feed = None;
                }
            }
            54..=57 => {
                modal.at = [None; 3];
                self.state.work_offset = Some(u32::from(code));
            }
            // These have no effect on the steps.
            DWELL | 40 | 64 => {}
            code => modal.apply(effect(i32::from(code) * 10)),
        }
    }

    /// A block of one word that changes how the axis is told.
    fn switch(&mut self, keyword: Keyword, words: &Words) -> Result<(), Fault> {
        if !words.is_empty() {
            return Err(Fault::Conflict);
        }
        match keyword {
            Keyword::BeginTipControl if self.has_tip_control => return Err(Fault::UnderTipControl),
            Keyword::BeginTipControl | Keyword::EndTipControl => {
                let begins = keyword == Keyword::BeginTipControl;
                if self.has_tip_control != begins {
                    self.modal.at = [None; 3];
                    self.vector = None;
                }
                self.has_tip_control = begins;
            }
            Keyword::ByAxes => (self.orientation, self.is_on_rails) = (Some(TipMode::Angles), false),
            Keyword::ByVectors => (self.orientation, self.is_on_rails) = (Some(TipMode::Vectors), false),
            Keyword::ByCurve if !self.has_tip_control => return Err(Fault::NoTipControl),
            Keyword::ByCurve => (self.is_on_rails, self.is_polynomial, self.second) = (true, false, None),
            Keyword::Polynomials => self.has_polynomials = true,
            Keyword::InWorkpiece => self.is_in_workpiece = true,
            Keyword::MachineZero => {}
        }
        Ok(())
    }

    /// `G0 SUPA Z0 D0`, a rapid in the machine's coordinates without length offset.
    fn machine_zero(&mut self, words: &Words) -> Result<Option<Step>, Fault> {
        if self.has_tip_control {
            return Err(Fault::UnderTipControl);
        }
        let has_others = words.first_of("XYIJKABCFST").is_some() || words.has_vector() || !words.m.is_empty();
        let is_known =
            words.g.as_slice() == [0] && words.get('Z') == Some(0.0) && words.get('D') == Some(0.0);
        if has_others || !is_known {
            return Err(Fault::Conflict);
        }
        self.modal.motion = Some(Motion::Rapid);
        self.modal.at[2] = None;
        self.edge = 0;
        self.state.homes += 1;
        Ok(None)
    }

    /// Tool, cutting edge, spindle and coolant.
    fn tool(&mut self, words: &Words) -> Result<(), Fault> {
        let count = |name: &'static str, letter, max| match words.get(letter) {
            Some(value) if value > f64::from(max) => Err(Fault::Word(name, WordFault::Range)),
            // `words` has read it as a whole number.
            value => Ok(value.map(|value| value as u32)),
        };
        let tool = count("T", 'T', MAX_TOOL)?;
        match (tool.is_some(), words.m.contains(&6)) {
            (true, false) => return Err(Fault::Word("M6", WordFault::Missing)),
            (false, true) => return Err(Fault::Word("T", WordFault::Missing)),
            (true, true) if self.has_tip_control => return Err(Fault::UnderTipControl),
            (true, true) => {
                if self.is_strict && self.state.tool.is_some() {
                    // The change may run a program of its own, which leaves other modes.
                    self.modal = Modal::UNKNOWN;
                    self.state.work_offset = None;
                }
                (self.edge, self.modal.at[2]) = (0, None);
                self.state.change_tool(tool);
            }
            (false, false) => {}
        }
        if let Some(edge) = count("D", 'D', MAX_EDGE)? {
            if edge != self.edge {
                self.modal.at[2] = None;
            }
            self.edge = edge;
            self.is_edge_along_z = self.modal.plane == Some(Plane::Xy);
        }
        let max_rpm = f64::from(self.dialect.numbers.max_spindle_rpm);
        if let Some(rpm) = words.get('S') {
            if !(rpm > 0.0 && rpm <= max_rpm) {
                return Err(Fault::Word("S", WordFault::Range));
            }
            self.state.speed_rpm = Some(rpm);
        }
        for code in &words.m {
            match code {
                3 => self.state.spindle = Spindle::Clockwise,
                5 => self.state.spindle = Spindle::Off,
                7 => self.state.coolant = Coolant::Mist,
                8 => self.state.coolant = Coolant::Flood,
                9 => self.state.coolant = Coolant::Off,
                _ => {}
            }
        }
        Ok(())
    }

    /// The feed by the minute. Under G93, `motion` reads F.
    fn feed(&mut self, words: &Words) -> Result<(), Fault> {
        let Some(feed) = words.get('F') else { return Ok(()) };
        if feed <= 0.0 {
            return Err(Fault::Word("F", WordFault::Range));
        }
        if self.modal.feed_mode.ok_or(Fault::NoMode("G93 or G94"))? == FeedMode::PerMinute {
            let rate = FeedRate::from_mm_per_min(feed * self.unit_mm()?);
            self.modal.feed = Some(rate.ok_or(Fault::Word("F", WordFault::Range))?);
        }
        Ok(())
    }

    fn unit_mm(&self) -> Result<f64, Fault> {
        self.modal.units.map(Units::mm).ok_or(Fault::NoMode("G700 or G710"))
    }

    fn plane(&self) -> Result<Plane, Fault> {
        self.modal.plane.ok_or(Fault::NoMode("G17, G18 or G19"))
    }
}

/// `G4 F0.25`, in a block of its own.
fn dwell(words: &Words) -> Result<Step, Fault> {
    let seconds = words.get('F').ok_or(Fault::Word("F", WordFault::Missing))?;
    let has_others = words.first_of("XYZIJKABCSTD").is_some() || words.has_vector() || !words.m.is_empty();
    if has_others || words.g.as_slice() != [DWELL] {
        return Err(Fault::Conflict);
    }
    Ok(Step::Dwell { seconds })
}

#[cfg(test)]
mod tests;

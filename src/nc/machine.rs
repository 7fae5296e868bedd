//! The modal state of a control, and the machine that its blocks move.
//!
//! # Guarantees
//! * A place is known along an axis only if the program or its caller says so. What is not known stays so:
//!   a rapid from or to such a place is no move of the toolpath, a cut is refused.
//! * Every word of a block is used, left alone and counted, or refused.

mod arcs;
mod calls;
mod checks;
mod compensation;
mod conditions;
mod contour;
mod coordinates;
mod correction;
mod cycles;
mod modes;
mod motion;
mod placing;
mod tracing;

use nalgebra::{Point3, Vector3};
use toolpathd_core::geometry::plane::Plane;
use toolpathd_core::toolpath::path::PathError;

use super::block::{Block, Code, Line, WordValue};
pub use super::codes::Side;
use super::codes::{FeedMode, Function, Meaning, Motion, function, function_group, group, meaning};
use super::control::{Centers, Control, DwellTime, Family, WithoutPoint};
use super::fault::{Fault, MAX_REFUSALS, Refusal};
use super::frames::Frames;
use super::notes::{LeftAlone, Note};
pub use super::placement::At;
use super::placement::Placement;
use super::record::Record;
use super::trace::TracedBlock;
use compensation::Compensation;
pub(crate) use correction::Radius;
use cycles::Cycle;
pub(crate) use modes::Modes;
use placing::Placing;

/// The letters of the linear axes, and of the distances of a centre along them.
pub const AXES: [u8; 3] = *b"XYZ";
const OFFSETS: [u8; 3] = *b"IJK";

/// A pause that is longer is told, s. Shorter pauses are usual.
const LONG_DWELL_S: f64 = 60.0;

/// Longest pause, s: a day.
const MAX_DWELL_S: f64 = 86_400.0;

/// What a machine is told before the first block.
#[derive(Debug, Clone)]
pub struct Setting<'a> {
    pub control: &'a Control,
    pub in_inches: bool,
    pub without_point: WithoutPoint,
    pub start: At,
    /// Zeros of work offsets in coordinates of the machine, mm.
    pub offsets: &'a [(u32, [f64; 3])],
    pub correction: Correction<'a>,
    pub most_moves: usize,
    /// Blocks whose modal state is recorded.
    pub most_traced: usize,
}

/// What G41 and G42 mean.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Correction<'a> {
    Refused,
    /// They correct wear: the program's path is that of the cutter's centre.
    Wear,
    /// The path of the centre is computed with the radii of these cutters.
    Computed(&'a [Cutter]),
}

/// The radius by which compensation moves the path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cutter {
    /// The number of the tool; `None` for every tool.
    pub number: Option<u32>,
    pub radius_mm: f64,
}

/// What a block asks of the flow of the program.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Next {
    Block,
    End,
    /// Another program, how often, and the place of the word.
    Call {
        program: u32,
        times: u32,
        is_local: bool,
    },
    Macro {
        program: u32,
        times: u32,
    },
    /// Back to the caller, or on to the block with this number.
    Return {
        label: Option<u32>,
    },
    /// Nothing can follow: a fault of the whole program.
    Stop,
}

/// A control and its machine.
pub struct Machine<'a> {
    pub control: &'a Control,
    setting: &'a Setting<'a>,
    pub record: Record,
    pub refusals: Vec<Refusal>,
    pub left: LeftAlone,
    pub notes: Vec<Note>,
    pub traced: Vec<TracedBlock>,
    pub at: At,
    pub frames: Frames,
    /// Where coordinates of the program lie in the work offset.
    pub placement: Placement,
    placing: Placing,
    /// The polar words of the block: radius and angle.
    polar_words: [Option<WordValue>; 2],
    compensation: Option<Compensation>,
    /// How far the tool is beside its programmed place since compensation has ended, mm.
    displaced: Option<Vector3<f64>>,
    pub motion: Option<Motion>,
    cycle: Option<Cycle>,
    last_cycle_dwell_s: Option<f64>,
    pub plane: Plane,
    /// `None` until G20 or G21.
    units: Option<bool>,
    pub is_absolute: bool,
    /// Whether centres are absolute, once G90.1 or G91.1 has said so.
    centers: Option<bool>,
    pub feed_mode: FeedMode,
    /// In mm/min, 1/min or mm per turn, by the mode.
    pub feed: Option<f64>,
    pub speed: Option<f64>,
    pub is_turning: bool,
    tool: Option<u32>,
    pub called_tool: Option<u32>,
    /// The last D.
    radius_number: Option<WordValue>,
    /// The number of the length offset, once a code has said so; 0 for none.
    length: Option<i64>,
    returns_high: bool,
    /// How many numbers lack a point, and the line of the first.
    points: (usize, usize),
    moved_arcs: (usize, usize, f64),
    /// A word before was refused, so that places and feeds may be others than the program's.
    is_doubtful: bool,
}

impl<'a> Machine<'a> {
    pub fn new(setting: &'a Setting<'a>) -> Self {
        let control = setting.control;
        Self {
            control,
            setting,
            record: Record::new(setting.most_moves),
            refusals: Vec::new(),
            left: LeftAlone::default(),
            notes: Vec::new(),
            traced: Vec::new(),
            at: setting.start,
            frames: Frames::new(setting.offsets),
            placement: Placement::plain(),
            placing: Placing::plain(),
            polar_words: [None; 2],
            compensation: None,
            displaced: None,
            motion: control.starts_rapid.then_some(Motion::Rapid),
            cycle: None,
            last_cycle_dwell_s: None,
            plane: Plane::Xy,
            units: None,
            is_absolute: true,
            centers: None,
            feed_mode: FeedMode::PerMinute,
            feed: None,
            speed: None,
            is_turning: false,
            tool: None,
            called_tool: None,
            radius_number: None,
            length: None,
            // LinuxCNC's interpreter begins as after G99.
            returns_high: !control.is(Family::LinuxCnc),
            points: (0, 0),
            moved_arcs: (0, 0, 0.0),
            is_doubtful: false,
        }
    }

    pub fn is_full(&self) -> bool {
        self.refusals.len() >= MAX_REFUSALS
    }

    pub fn refuse(&mut self, refusal: Refusal) {
        if !self.is_full() {
            self.refusals.push(refusal);
        }
        self.is_doubtful = true;
    }

    fn refuse_word(&mut self, line: Line<'_>, slot: WordValue, fault: Fault) {
        self.refuse(line.refusal(slot.start, slot.end, fault));
    }

    fn refuse_code(&mut self, line: Line<'_>, code: Code, fault: Fault) {
        self.refuse(line.refusal(code.start, code.end, fault));
    }

    /// Refuses a move for a fault of the state before it, once: later blocks have the same fault.
    pub(crate) fn refuse_state(&mut self, line: Line<'_>, fault: Fault) {
        if !self.is_doubtful {
            self.refuse(line.refused(fault));
        }
    }

    fn refuse_path(&mut self, line: Line<'_>, error: PathError) {
        let fault = match error {
            PathError::Arc(error) => Fault::Arc(error),
            PathError::TooManyMoves { limit } => Fault::TooManyMoves(limit),
            _ => Fault::NotFinite,
        };
        self.refuse(line.refused(fault));
    }

    /// Tells the note once for each line.
    pub(crate) fn note(&mut self, note: Note) {
        if self.notes.len() < MAX_REFUSALS && !self.notes.contains(&note) {
            self.notes.push(note);
        }
    }

    /// Tells the first note of its kind.
    pub(crate) fn note_first(&mut self, note: Note) {
        let kind = std::mem::discriminant(&note);
        if !self.notes.iter().any(|other| std::mem::discriminant(other) == kind) {
            self.note(note);
        }
    }

    fn leave_code(&mut self, line: Line<'_>, letter: char, tenths: i32) {
        let (whole, tenth) = (tenths / 10, tenths % 10);
        let word = if tenth == 0 { format!("{letter}{whole}") } else { format!("{letter}{whole}.{tenth}") };
        self.left.add(&word, line.number);
    }

    pub(crate) fn in_inches(&self) -> bool {
        self.units.unwrap_or(self.setting.in_inches)
    }

    /// Lengths are in inches, or in mm.
    pub(crate) fn set_units(&mut self, in_inches: bool) {
        self.units = Some(in_inches);
    }

    /// Millimetres of one unit of length.
    pub(crate) fn unit_mm(&self) -> f64 {
        if self.in_inches() { 25.4 } else { 1.0 }
    }

    /// The length of a word, mm.
    fn length_mm(&mut self, line: Line<'_>, slot: WordValue) -> f64 {
        if self.units.is_none() {
            let units = if self.setting.in_inches { "inches" } else { "mm" };
            self.units = Some(self.setting.in_inches);
            self.note(Note::UnitsAssumed { line: line.number, units });
        }
        slot.value * self.unit_mm() * self.increment(line, slot)
    }

    /// What a number without a point is multiplied by.
    fn increment(&mut self, line: Line<'_>, slot: WordValue) -> f64 {
        if !slot.lacks_point || slot.value == 0.0 || !self.control.points_matter {
            return 1.0;
        }
        let (count, first) = &mut self.points;
        *count += 1;
        *first = if *first == 0 { line.number } else { *first };
        match (self.setting.without_point, self.in_inches()) {
            (WithoutPoint::Units, _) => 1.0,
            (WithoutPoint::Increments, false) => 1e-3,
            (WithoutPoint::Increments, true) => 1e-4,
        }
    }

    /// Runs a block. Blocks of control words are not for the machine.
    pub fn run(&mut self, line: Line<'_>, block: &mut Block) -> Next {
        let meanings: Vec<(Code, Meaning)> =
            block.g.iter().map(|code| (*code, meaning(code.tenths, self.control))).collect();
        self.check_codes(line, block, &meanings);
        let functions: Vec<(Code, Function)> =
            block.m.iter().map(|code| (*code, function(code.tenths, self.control))).collect();
        block.use_up(b"NO");
        let leaves = self.leave_codes(line, &meanings, &functions);
        let unit_before_mm = self.unit_mm();
        // G80 before the others: `G0 G80` leaves G0 in force.
        let ends = |meaning: &Meaning| *meaning == Meaning::CycleEnd;
        for (_, meaning) in meanings.iter().filter(|(_, meaning)| ends(meaning)) {
            self.set_mode(*meaning);
        }
        for (_, meaning) in meanings.iter().filter(|(_, meaning)| !ends(meaning)) {
            self.set_mode(*meaning);
        }
        if let Some(call) = meanings.iter().find(|(_, meaning)| *meaning == Meaning::Call) {
            let next = self.macro_call(line, block, call.0);
            self.check_unused(line, block, leaves, next);
            return next;
        }
        self.compensate(line, block, &meanings);
        self.take_feed_and_speed(line, block, &meanings, unit_before_mm);
        self.change_tool(line, block, &functions);
        for (_, function) in &functions {
            if let Function::Spindle(turns) = function {
                self.is_turning = *turns;
            }
        }
        if meanings.iter().any(|(_, meaning)| *meaning == Meaning::Dwell) {
            self.dwell(line, block);
        }
        self.select_lengths(line, block, &meanings);
        self.select_offsets(line, block, &meanings);
        self.use_polar_words(line, block);
        self.move_by(line, block, &meanings);
        let next = self.leave_or_go(line, block, &functions);
        self.check_unused(line, block, leaves, next);
        next
    }

    fn set_mode(&mut self, meaning: Meaning) {
        match meaning {
            Meaning::Motion(motion) => {
                self.motion = Some(motion);
                self.cycle = None;
            }
            Meaning::CycleEnd => {
                self.cycle = None;
                if self.control.is_strict || self.control.is(Family::Mach) {
                    self.motion = None;
                }
            }
            Meaning::Plane(plane) => self.plane = plane,
            Meaning::Units(inches) => self.units = Some(inches),
            Meaning::Distance(is_absolute) => self.is_absolute = is_absolute,
            Meaning::Centers(is_absolute) => self.centers = Some(is_absolute),
            Meaning::FeedMode(mode) if mode != self.feed_mode => {
                self.feed_mode = mode;
                self.feed = None;
            }
            Meaning::Return(high) => self.returns_high = high,
            Meaning::UnsetPlace { .. } | Meaning::RestorePlace if self.control.is_strict => {
                self.unset_place(meaning, [true; 3]);
            }
            _ => {}
        }
    }

    /// The place of the tool, where it is known.
    pub fn place(at: &At) -> Result<Point3<f64>, char> {
        for (axis, letter) in AXES.iter().enumerate() {
            if at[axis].is_none() {
                return Err(char::from(*letter));
            }
        }
        Ok(Point3::new(at[0].unwrap_or(0.0), at[1].unwrap_or(0.0), at[2].unwrap_or(0.0)))
    }

    /// Ends what the end of the program leaves open, and adds the notes on what was counted over the whole
    /// program.
    pub fn finish(&mut self) {
        self.end_compensation();
        if let Some(shift) = self.displaced {
            self.at = [0, 1, 2].map(|k| self.at[k].map(|at| at + shift[k]));
        }
        let (count, line) = self.points;
        if count > 0 {
            let ten_mm = if self.in_inches() { 0.0254 } else { 0.01 };
            self.notes.push(match self.setting.without_point {
                WithoutPoint::Increments => Note::LeastIncrements { count, line, ten_mm },
                WithoutPoint::Units => Note::WholeUnits { count, line },
            });
        }
        let (count, line, most_mm) = self.moved_arcs;
        if count > 0 {
            self.notes.push(Note::ArcsMoved { count, line, most_mm });
        }
    }

    pub(crate) fn most_traced(&self) -> usize {
        self.setting.most_traced
    }

    /// The number of the tool in the spindle, once a tool change has said so.
    pub fn tool(&self) -> Option<u32> {
        self.tool
    }
}

//! Reads programs of ISO words.
//!
//! # Method
//! For each line, `words` collects the words. Then the words take effect in the order in which a control
//! applies them: units, plane, feed, motion.

mod asked;
mod control;
mod cycle;
mod posed;
mod smoothing;
mod words;

use nalgebra::{Point3, Vector3};

use self::control::{Control, Dwell};
use self::posed::Leaning;
use self::words::Words;
use super::cut::Cut;
use super::hole::Cycle;
use super::state::{Calls, MachineState};
use super::{Language, Step};
use crate::nc::{Distance, Fault, FeedMode, Modal, Motion, effect, modal_group};
use toolpathd_core::geometry::curve::{Curve, Parabola};
use toolpathd_core::geometry::plane::Plane;
use toolpathd_core::toolpath::arc_rule::ArcRule;
use toolpathd_core::toolpath::program::{Smoothing, Units};
use toolpathd_core::toolpath::units::FeedRate;

/// G codes that every control knows, in tenths.
const KNOWN_G: &[i32] =
    &[0, 10, 20, 30, 40, 170, 180, 190, 200, 210, 280, 400, 490, 530, 610, 640, 800, 900, 910, 930, 940];
/// G54 to G59, on controls without a code of their own for work offsets.
const WORK_OFFSETS: [i32; 6] = [540, 550, 560, 570, 580, 590];
const LENGTH_OFFSET: i32 = 430;
const DWELL: i32 = 40;
const PARABOLA: i32 = 51;
const HOME: i32 = 280;
const MACHINE_COORDINATES: i32 = 530;
const INVERSE_TIME: i32 = 930;
const PER_MINUTE: i32 = 940;
const BLENDING: i32 = 640;
/// On a control that knows this code, another mode counts centres from zero.
const INCREMENTAL_CENTERS: i32 = 911;

/// M codes that the reader knows, in tenths, and those of them that end a program.
const KNOWN_M: &[i32] = &[20, 30, 50, 60, 70, 80, 90, 300];
const ENDS: [i32; 2] = [20, 300];

/// M codes that exclude each other: of the tool change, of the spindle, of the coolant, and of the end.
const M_GROUPS: [&[i32]; 4] = [&[60], &[30, 50], &[70, 80, 90], &ENDS];

/// The modal group of G0 to G3, G5.1 and G80.
const MOTION_GROUP: i32 = 1;

/// The rules of a control, with the modal state.
pub struct Reader {
    control: Control,
    expects: Expected,
    /// What the control demands of an arc.
    arcs: ArcRule,
    /// Position in mm.
    modal: Modal<f64, FeedRate>,
    leaning: Leaning,
    smoothing: Option<Smoothing>,
    cycle: Option<Cycle>,
    state: MachineState,
    program: Option<u32>,
    /// No mode is taken for granted, neither at the start nor behind a change from one tool to another.
    is_strict: bool,
}

/// The line before and behind a program.
const TAPE_MARK: &str = "%";

/// The kind of line that has to come next.
#[derive(Clone, Copy, PartialEq)]
enum Expected {
    TapeMark,
    ProgramNumber,
    Block,
    /// The tape mark behind the last block.
    LastTapeMark,
    /// Nothing but blank lines.
    Blank,
    /// The control reads no more.
    Nothing,
}

impl Language for Reader {
    fn line(&mut self, text: &str) -> Result<Option<Step>, Fault> {
        let is_mark = self.control.has_tape_marks && text.trim() == TAPE_MARK;
        match self.expects {
            Expected::TapeMark => {
                self.expects = Expected::ProgramNumber;
                if is_mark { Ok(None) } else { Err(Fault::TapeMark) }
            }
            Expected::ProgramNumber => {
                self.expects = Expected::Block;
                match self.control.program_number {
                    Some(rule) => {
                        self.program = Some(rule.number(text)?);
                        Ok(None)
                    }
                    None => self.line(text),
                }
            }
            Expected::Block => {
                let words = Words::of(text)?;
                self.check_points(&words)?;
                self.block(&words)
            }
            Expected::LastTapeMark => {
                self.expects = Expected::Blank;
                if is_mark { Ok(None) } else { Err(Fault::TapeMark) }
            }
            Expected::Blank => {
                if text.trim().is_empty() {
                    Ok(None)
                } else {
                    Err(Fault::TapeMark)
                }
            }
            Expected::Nothing => Ok(None),
        }
    }

    fn pass(&mut self) {
        self.modal = Modal::UNKNOWN;
        self.leaning = Leaning::default();
        (self.smoothing, self.cycle) = (None, None);
        self.state = self.state.behind_own_lines();
    }

    fn assume_nothing(&mut self) {
        self.modal = Modal::UNKNOWN;
        self.is_strict = true;
    }

    fn calls(&self) -> Calls {
        Calls { tools: self.control.has_tools, length_offsets: self.control.length_offset.is_some() }
    }

    fn state(&self) -> MachineState {
        self.state
    }

    fn program(&self) -> Option<u32> {
        self.program
    }

    fn smoothing(&self) -> Option<Smoothing> {
        self.smoothing
    }

    fn end(&self) -> Result<(), Fault> {
        match self.expects {
            Expected::TapeMark | Expected::ProgramNumber | Expected::Block => Err(Fault::NoEnd),
            Expected::LastTapeMark => Err(Fault::TapeMark),
            Expected::Blank | Expected::Nothing => Ok(()),
        }
    }
}

impl Reader {
    /// Reads the dialect called `name`.
    pub fn new(name: &str, arcs: ArcRule) -> Self {
        let control = Control::of(name);
        Self {
            control,
            expects: if control.has_tape_marks { Expected::TapeMark } else { Expected::ProgramNumber },
            arcs,
            modal: Modal::START,
            leaning: Leaning::default(),
            smoothing: None,
            cycle: None,
            state: MachineState::default(),
            program: None,
            is_strict: false,
        }
    }

    /// On a control where a decimal point decides the value, measured numbers need a point and counted
    /// numbers must not have one.
    fn check_points(&self, words: &Words) -> Result<(), Fault> {
        if !self.control.needs_points {
            return Ok(());
        }
        let is_cycle = cycle::begins(words);
        let (with, without) = match (is_cycle, self.control.dwell == Dwell::Milliseconds) {
            (true, true) => ("XYZABCEIJKFQR", "NHSTP"),
            (true, false) => ("XYZABCEIJKFQR", "NHST"),
            (false, true) => ("XYZABCEIJKF", "NHSTPQR"),
            (false, false) => ("XYZABCEIJKF", "NHSTQR"),
        };
        let missing = words.first_written(with, false).map(Fault::MissingPoint);
        let unexpected = || words.first_written(without, true).map(Fault::UnexpectedPoint);
        missing.or_else(unexpected).map_or(Ok(()), Err)
    }

    fn block(&mut self, words: &Words) -> Result<Option<Step>, Fault> {
        self.check_codes(words)?;
        let g = &words.g;
        for &code in g.all() {
            if !self.control.takes_offset(code) || code == LENGTH_OFFSET {
                self.modal.apply(effect(code));
            }
            if code == PARABOLA && self.control.has_parabolas {
                // A block without a G word behind it would be run as the last G0 to G3 says, even as a rapid.
                self.modal.motion = None;
            }
            if self.leaning.apply(code, &self.control) {
                self.modal.at = [None; 3];
            }
        }
        if self.leaning.switch(words, &self.control)? {
            self.modal.at = [None; 3];
        }
        self.ask(words);
        if g.has(INVERSE_TIME) || g.has(PER_MINUTE) {
            // A feed of the other mode means something else.
            self.modal.feed = None;
        }
        if g.has(HOME) || g.has(MACHINE_COORDINATES) {
            return self.home(words);
        }
        if self.smoothed(words)? {
            return Ok(None);
        }
        let (is_dwell, is_cycle) = (g.has(DWELL), cycle::begins(words));
        if g.all().iter().any(|&code| modal_group(code) == MOTION_GROUP) {
            // Whether the feed of a cycle stays in force is not certain.
            if self.cycle.take().is_some() {
                self.modal.feed = None;
            }
        }
        if let Some(letter) = words.first_of(if is_dwell { "QER" } else { "PQER" }).filter(|_| !is_cycle) {
            // E and R are words of few controls, and only in the blocks that are read above.
            let is_word = matches!(letter, 'P' | 'Q');
            return Err(if is_word { Fault::Unused(letter) } else { Fault::UnknownWord(letter) });
        }
        if let Some(feed) = words.get('F').filter(|_| !is_dwell) {
            let mode = self.modal.feed_mode.ok_or(Fault::NoMode("G93 or G94"))?;
            let unit = if mode == FeedMode::InverseTime { 1.0 } else { self.unit_mm()? };
            let rate = FeedRate::from_mm_per_min(feed * unit);
            self.modal.feed = Some(rate.ok_or(Fault::BadNumber('F'))?);
        }
        if ENDS.iter().any(|&code| words.m.has(code)) {
            self.leaning.check_off()?;
            self.check_smoothing_off()?;
            let has_mark = self.control.has_tape_marks;
            self.expects = if has_mark { Expected::LastTapeMark } else { Expected::Nothing };
        }
        if is_dwell {
            return self.dwell(words);
        }
        if is_cycle {
            return self.begin_cycle(words).map(Some);
        }
        if g.has(PARABOLA) { self.parabola(words) } else { self.motion(words) }
    }

    /// # Errors
    /// When a code is unknown, two codes exclude each other, or G43 or its like stands without H.
    fn check_codes(&self, words: &Words) -> Result<(), Fault> {
        let Words { g, m, .. } = words;
        let has_work_offsets = self.control.work_offset.is_none();
        let is_known = |&code: &i32| {
            KNOWN_G.contains(&code)
                || WORK_OFFSETS.contains(&code) && has_work_offsets
                || self.control.further_g.contains(&code)
                || self.control.takes_offset(code)
                || code == PARABOLA && self.control.has_parabolas
                || self.control.has_cycles && cycle::takes(code)
                || self.control.smoothing.takes(code)
        };
        let number = |code: &i32| f64::from(*code) / 10.0;
        if let Some(code) = g.all().iter().find(|code| !is_known(code)) {
            return Err(Fault::UnknownG(number(code)));
        }
        let switches = self.control.kinematics.unwrap_or_default();
        let is_known_m = |code: &&i32| KNOWN_M.contains(code) || switches.contains(code);
        if let Some(code) = m.all().iter().find(|code| !is_known_m(code)) {
            return Err(Fault::UnknownM(number(code)));
        }
        let mut groups = g.all().iter().map(|&code| modal_group(code)).enumerate();
        let is_twice = groups.any(|(k, group)| g.all()[..k].iter().any(|&other| modal_group(other) == group));
        let in_group = |group: &&[i32]| m.all().iter().filter(|code| group.contains(code)).count();
        let is_twice = is_twice || M_GROUPS.iter().any(|group| in_group(group) > 1);
        if is_twice || g.has(BLENDING) && g.has(DWELL) {
            return Err(Fault::Conflict);
        }
        match (g.all().iter().any(|&code| self.control.takes_offset(code)), words.has('H')) {
            (true, false) => Err(Fault::Missing('H')),
            (false, true) => Err(Fault::Unused('H')),
            _ => Ok(()),
        }
    }

    fn dwell(&self, words: &Words) -> Result<Option<Step>, Fault> {
        let letter = if self.control.dwell == Dwell::FeedWord { 'F' } else { 'P' };
        let count = words.get(letter).ok_or(Fault::Missing(letter))?;
        let seconds = if self.control.dwell == Dwell::Milliseconds { count / 1000.0 } else { count };
        let has_motion = words.g.all().iter().any(|&code| modal_group(code) == MOTION_GROUP);
        if has_motion || words.first_of("XYZIJKABC").is_some() || seconds < 0.0 {
            return Err(Fault::Conflict);
        }
        Ok(Some(Step::Dwell { seconds }))
    }

    fn motion(&mut self, words: &Words) -> Result<Option<Step>, Fault> {
        if words.first_of("XYZIJKABC").is_none() {
            return Ok(None);
        }
        if self.cycle.is_some() {
            return self.next_hole(words).map(Some);
        }
        let motion = self.modal.motion.ok_or(Fault::NoMotion)?;
        if self.modal.distance != Some(Distance::Absolute) {
            return Err(Fault::Relative);
        }
        let from = self.moved(words)?;
        if self.leaning.is_in_force(words) {
            return self.posed(words, motion, from).map(Some);
        }
        if self.modal.feed_mode == Some(FeedMode::InverseTime) && motion != Motion::Rapid {
            return Err(Fault::Conflict);
        }
        if let (Motion::Rapid | Motion::Line, Some(letter)) = (motion, words.first_of("IJK")) {
            return Err(Fault::Unused(letter));
        }
        if motion == Motion::Rapid {
            return Ok(Some(Step::Rapid { from, to: self.modal.at }));
        }
        let cut = Cut::between(from, self.modal.at, self.modal.feed.ok_or(Fault::NoFeed)?)?;
        let Motion::Arc(direction) = motion else { return Ok(Some(cut.line())) };
        let (plane, center) = (self.plane()?, self.center(words, &cut.start())?);
        cut.arc(plane, direction, center, &self.arcs).map(Some)
    }

    /// The parabola of a block. Both offsets of its control point have to be written, and it has no Z word.
    fn parabola(&mut self, words: &Words) -> Result<Option<Step>, Fault> {
        if self.plane()? != Plane::Xy {
            return Err(Fault::ParabolaPlane);
        }
        if let Some(letter) = words.first_of("ZKABC") {
            return Err(Fault::Unused(letter));
        }
        if words.first_of("XY").is_none() {
            return Err(Fault::Missing('X'));
        }
        let offset = |letter| words.get(letter).ok_or(Fault::Missing(letter));
        let offset = Vector3::new(offset('I')?, offset('J')?, 0.0) * self.unit_mm()?;
        let from = self.moved(words)?;
        let (rate, start, end) = self.cut_from(from)?;
        let parabola = Parabola::new(start, start + offset, end).map_err(|_| Fault::ParabolaSize)?;
        let along = Curve::Parabola(parabola);
        Ok(Some(Step::Feed { along, rate, radius_mismatch_mm: 0.0, center: None }))
    }

    /// Goes to the coordinates of a block, and returns where the block starts.
    fn moved(&mut self, words: &Words) -> Result<[Option<f64>; 3], Fault> {
        let (from, unit_mm) = (self.modal.at, self.unit_mm()?);
        for (axis, letter) in ['X', 'Y', 'Z'].into_iter().enumerate() {
            if let Some(value) = words.get(letter) {
                self.modal.at[axis] = Some(value * unit_mm);
            }
        }
        Ok(from)
    }

    /// Feed, start and end of a cutting block that has moved the position.
    fn cut_from(&self, from: [Option<f64>; 3]) -> Result<(FeedRate, Point3<f64>, Point3<f64>), Fault> {
        let known = |at: [Option<f64>; 3]| match at {
            [Some(x), Some(y), Some(z)] => Ok(Point3::new(x, y, z)),
            _ => Err(Fault::UnknownStart),
        };
        Ok((self.modal.feed.ok_or(Fault::NoFeed)?, known(from)?, known(self.modal.at)?))
    }

    /// The written centre: offsets from the start, of which one may be missing.
    fn center(&self, words: &Words, start: &Point3<f64>) -> Result<Point3<f64>, Fault> {
        const OFFSETS: [char; 3] = ['I', 'J', 'K'];
        let [a, b, n] = self.plane()?.axes();
        let has_modes = self.control.further_g.contains(&INCREMENTAL_CENTERS);
        if has_modes && self.modal.centers != Some(Distance::Incremental) {
            return Err(Fault::NoMode("G91.1"));
        }
        if words.has(OFFSETS[n]) {
            return Err(Fault::Unused(OFFSETS[n]));
        }
        let mut center = *start;
        let offsets = [a, b].map(|axis| (axis, words.get(OFFSETS[axis])));
        if offsets.iter().all(|(_, offset)| offset.is_none()) {
            return Err(Fault::MissingCenter);
        }
        for (axis, offset) in offsets {
            center[axis] += offset.unwrap_or(0.0) * self.unit_mm()?;
        }
        Ok(center)
    }

    /// Millimetres in one unit.
    fn unit_mm(&self) -> Result<f64, Fault> {
        self.modal.units.map(Units::mm).ok_or(Fault::NoMode("G20 or G21"))
    }

    fn plane(&self) -> Result<Plane, Fault> {
        self.modal.plane.ok_or(Fault::NoMode("G17, G18 or G19"))
    }
}

//! Rewrites NC programs of anybody's making: runs of G1 blocks become fewer arcs and lines.
//!
//! # Method
//! 1. Bytes become lines (`push`), however they were cut. A line that says nothing but a number, G1, coordinates and
//!    a feed is a block that may stand in a run (`block`); of any other, the words are read as far as they are understood
//!    (`line`, `codes`) and change the state of the control that is followed (`modes`).
//! 2. Consecutive blocks of lines with one feed, under modes that allow it, are a run (`run`). It ends at everything else.
//! 3. The points of a run are fitted, rounded and proved (`pieces`), and written (`text`); what does not get shorter stays.
//!    A run longer than [`WINDOW`] is fitted window by window: of each, the pieces that end within its first three
//!    quarters are written, and the next window begins where they end.
//! 4. Before a line that relies on G1 or on the plane where the output holds another, the mode is set again: by a
//!    G1 in the line where it moves as the mode says, else by a block of its own.
//!
//! # Guarantees
//! * Every byte that is no part of a run stays where it is; what is put between is such a G1 or such a block, and no motion.
//! * A run's output lies within the tolerance of the run's lines and vice versa, whatever radius between those at its two ends
//!   a control takes for an arc; joints are points of the program, exactly, so nothing accumulates.
//! * The output does not depend on how the input was cut.
//! * No full circle is written, which controls read in several ways.
//! * A stream's optimum is exact within windows of [`WINDOW`] blocks. Tangent continuity, where it is asked for, ends at
//!   windows, at pieces that were fitted again because rounding had moved them too far, and where blocks stay as they were.
//!
//! # What is left alone
//! * A program that does not say otherwise is taken to begin in mm, absolute, in XY, with feeds by the minute. Behind macros,
//!   calls, jumps, program names and ends, units, compensations and the way feeds and centres are counted are taken to be
//!   as before; everything else is unknown until it is said again. An assignment leaves only feed and position unknown.
//! * Nothing is fitted under cutter compensation, rotation, scaling, mirroring, polar or cylindrical coordinates, diameters,
//!   tool centre point control, exact stop, modal macros, feeds by the turn.
//! * An axis is known when a block has said where it is, and not any more behind whatever shifts it. A block that moves
//!   an unknown axis absolutely is in no run; one that never moves counts as 0.
//! * Once a line has been met that goes on elsewhere in the program, numbered blocks are in no run and behind them nothing
//!   is known: something may arrive there. Numbers of blocks before that may have gone.
//!
//! # Degenerate input
//! A line longer than [`MAX_LINE_LENGTH`] is an error. Whatever else is odd is left alone: bytes of any encoding, missing line
//! ends, numbers finer than a millionth.
//!
//! # Numbers
//! They have as many decimals as those of the run, not fewer than the dialect's default, and more where the points need it. Zeros
//! at the end are written where all numbers of the run have the same decimals, and as many as that; else they are not. A run
//! whose points need more decimals than the dialect has stays as it is.
//!
//! # Cost
//! O(n) beside the fitting. Memory is bounded: a window of blocks of at most 256 bytes, and a line.

mod block;
mod codes;
mod line;
mod modes;
mod number;
mod pieces;
mod run;
mod text;

use self::block::Block;
use self::line::Line;
use self::modes::{Distance, Modes, Motion, Needs};
use self::pieces::Fitting;
use self::run::{Run, Style};
use self::text::{Output, Tally, Writer, line_end, push_with_g1};
use super::dialect::Dialect;
use crate::budget::{Budget, Stopped};
use crate::geometry::arc_fit::{Fit, Joints, Measure};

/// Blocks of a run that are fitted at once.
pub const WINDOW: usize = 4096;

/// The longest line that is read, bytes with its end.
pub const MAX_LINE_LENGTH: usize = 64 * 1024;

/// Runs of fewer blocks stay as they are.
const MIN_BLOCKS: usize = 3;

/// Lines between two looks at the budget.
const LINES_BETWEEN_CHECKS: u64 = 1024;

/// How a program is rewritten.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RewriteJob {
    pub dialect: &'static Dialect,
    /// The measure is that of the polyline, joints are on its points and it is open, whatever this says.
    pub fit: Fit,
}

/// What has been done so far.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Figures {
    pub n_runs: u64,
    /// Ends of the blocks of runs.
    pub n_points: u64,
    pub n_arcs: u64,
    /// Lines in runs that were written or stayed.
    pub n_lines: u64,
    /// Upper bound for the distance of what was written from the lines it stands for, mm, both ways.
    pub deviation_max_mm: f64,
    /// Lines of the program that move an axis.
    pub n_motions: u64,
    /// Cutting lines that no run could take, by the reason.
    pub left_alone: LeftAlone,
    pub bytes_in: u64,
    pub bytes_out: u64,
}

/// Why lines that cut were left as they are, and how many.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct LeftAlone {
    /// Variables, expressions, and words that are not understood.
    pub macros: u64,
    /// Axes beside X, Y and Z.
    pub other_axes: u64,
    /// Cutter compensation, absolute centres without a known place, feeds by time, or a mode of which nothing is known.
    pub modes: u64,
}

/// Why a program is not rewritten to its end.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum RewriteError {
    #[error(transparent)]
    Stopped(#[from] Stopped),
    #[error("line {line} is longer than {limit} bytes")]
    LineTooLong {
        /// From 1.
        line: u64,
        limit: usize,
    },
}

/// Rewrites one program; after an error it is of no more use.
#[derive(Debug)]
pub struct Rewriter {
    job: RewriteJob,
    modes: Modes,
    output: Output,
    run: Run,
    /// The beginning of a line whose end has not come yet.
    partial: Vec<u8>,
    /// What is written for a window, and a block of it.
    written: Vec<u8>,
    block: String,
    line_end: &'static [u8],
    n_lines: u64,
    may_jump: bool,
    figures: Figures,
}

impl Rewriter {
    pub fn new(job: RewriteJob) -> Self {
        let fit = Fit { joints: Joints::OnPoints, measure: Measure::Polyline, is_closed: false, ..job.fit };
        Self {
            job: RewriteJob { fit, ..job },
            modes: Modes::START,
            output: Output::default(),
            run: Run::default(),
            partial: Vec::new(),
            written: Vec::new(),
            block: String::new(),
            line_end: b"\n",
            n_lines: 0,
            may_jump: false,
            figures: Figures::default(),
        }
    }

    /// Takes the next bytes, cut anywhere, and appends what is ready to `out`.
    ///
    /// # Errors
    /// When the budget is spent or a line is too long.
    pub fn push(&mut self, bytes: &[u8], out: &mut Vec<u8>, budget: &Budget) -> Result<(), RewriteError> {
        let before = out.len();
        self.figures.bytes_in += bytes.len() as u64;
        let mut rest = bytes;
        while let Some(end) = rest.iter().position(|&c| c == b'\n') {
            let (line, behind) = rest.split_at(end + 1);
            rest = behind;
            if self.partial.is_empty() {
                self.line(line, out, budget)?;
            } else {
                self.keep_partial(line)?;
                self.partial_line(out, budget)?;
            }
        }
        self.keep_partial(rest)?;
        self.figures.bytes_out += (out.len() - before) as u64;
        Ok(())
    }

    /// Says that the input is over; the last line may lack its end.
    ///
    /// # Errors
    /// As [`Rewriter::push`].
    pub fn finish(&mut self, out: &mut Vec<u8>, budget: &Budget) -> Result<(), RewriteError> {
        let before = out.len();
        if !self.partial.is_empty() {
            self.partial_line(out, budget)?;
        }
        self.end_run(out, budget)?;
        self.figures.bytes_out += (out.len() - before) as u64;
        Ok(())
    }

    pub fn figures(&self) -> &Figures {
        &self.figures
    }

    fn keep_partial(&mut self, bytes: &[u8]) -> Result<(), RewriteError> {
        self.check_length(self.partial.len() + bytes.len())?;
        self.partial.extend_from_slice(bytes);
        Ok(())
    }

    fn partial_line(&mut self, out: &mut Vec<u8>, budget: &Budget) -> Result<(), RewriteError> {
        let line = std::mem::take(&mut self.partial);
        self.line(&line, out, budget)?;
        self.partial = line;
        self.partial.clear();
        Ok(())
    }

    fn check_length(&self, length: usize) -> Result<(), RewriteError> {
        if length > MAX_LINE_LENGTH {
            return Err(RewriteError::LineTooLong { line: self.n_lines + 1, limit: MAX_LINE_LENGTH });
        }
        Ok(())
    }

    /// Takes the next line with its end, if it has one.
    fn line(&mut self, line: &[u8], out: &mut Vec<u8>, budget: &Budget) -> Result<(), RewriteError> {
        self.check_length(line.len())?;
        if self.n_lines.is_multiple_of(LINES_BETWEEN_CHECKS) {
            budget.check()?;
        }
        self.n_lines += 1;
        let end = line_end(line);
        if !end.is_empty() {
            self.line_end = end;
        }
        let text = &line[..line.len() - end.len()];
        let is_in_run = match Block::read(text) {
            Some(block) => self.join(line, &block, out, budget)?,
            None => false,
        };
        if is_in_run {
            self.figures.n_motions += 1;
        } else {
            self.end_run(out, budget)?;
            let said = Line::read(text);
            self.count(&said);
            self.pass(line, &said, out);
        }
        Ok(())
    }

    /// Takes a block into the run, or as the first of the next; `false` where it can be in none.
    fn join(
        &mut self,
        line: &[u8],
        block: &Block,
        out: &mut Vec<u8>,
        budget: &Budget,
    ) -> Result<bool, RewriteError> {
        let is_line = block.has_g1 || self.modes.motion == Some(Motion::Line);
        let may_arrive = self.may_jump && !block.number.is_empty();
        if !is_line || may_arrive || !self.modes.allow_runs() {
            return Ok(false);
        }
        let step = self.run.step(block, &self.modes, self.job.dialect);
        if step.is_some_and(|step| !self.run.is_empty() && !self.run.continues(&step, &self.modes)) {
            self.end_run(out, budget)?;
            // Now it starts where the next run does.
            return self.join(line, block, out, budget);
        }
        let Some(step) = step else { return Ok(false) };
        self.run.push(line, block, &step, &mut self.modes);
        if self.run.blocks.len() == WINDOW {
            self.write_run(WINDOW / 4 * 3, out, budget)?;
        }
        Ok(true)
    }

    /// Counts a line that is in no run.
    fn count(&mut self, said: &Line) {
        let named = [0, 10, 20, 30].into_iter().find(|motion| said.g.has(*motion));
        let is_motion = (said.has_axes() || said.is_unclear && !said.is_assignment)
            && (named.is_some() || self.modes.motion.is_some());
        if !is_motion {
            return;
        }
        self.figures.n_motions += 1;
        let is_line = named.map_or(self.modes.motion == Some(Motion::Line), |motion| motion == 10);
        if !is_line {
            return;
        }
        let LeftAlone { macros, other_axes, modes } = &mut self.figures.left_alone;
        if said.is_unclear {
            *macros += 1;
        } else if said.has_other_axes() {
            *other_axes += 1;
        } else if !self.modes.allow_runs() {
            *modes += 1;
        }
    }

    /// Writes a line that is in no run, and follows what it says.
    fn pass(&mut self, line: &[u8], said: &Line, out: &mut Vec<u8>) {
        let dialect = self.job.dialect;
        let may_arrive = self.may_jump && said.is_numbered;
        let before = if may_arrive { self.modes.forgotten() } else { self.modes };
        let (next, needs) = before.read(said, dialect);
        let needs = if may_arrive { Needs::ALL } else { needs };
        if self.output.settle(&needs, &self.modes, dialect, self.line_end, out) {
            push_with_g1(out, line, said.first, said.is_spaced || self.run.is_spaced);
        } else {
            out.extend_from_slice(line);
        }
        self.may_jump |= said.jumps || said.m.has(970) || said.m.has(990) && said.has(b"P");
        self.modes = next;
    }

    fn end_run(&mut self, out: &mut Vec<u8>, budget: &Budget) -> Result<(), RewriteError> {
        while !self.run.blocks.is_empty() {
            self.write_run(self.run.blocks.len(), out, budget)?;
        }
        self.run.clear();
        Ok(())
    }

    /// Writes and forgets the blocks of the run up to `reach`, or fewer, but some.
    fn write_run(&mut self, reach: usize, out: &mut Vec<u8>, budget: &Budget) -> Result<(), RewriteError> {
        let is_long = self.run.blocks.len() >= MIN_BLOCKS;
        let style = self.modes.units.and_then(|units| self.run.style(units, self.job.dialect));
        let (end, written) = match style.filter(|_| is_long) {
            Some(style) => self.rewritten(style, reach, budget)?,
            None => (reach, None),
        };
        let tally = match written {
            Some(tally) => {
                out.extend_from_slice(&self.written);
                tally
            }
            None => self.output.keep(&self.run, 0, end, out),
        };
        if is_long || self.run.is_continued {
            let figures = &mut self.figures;
            figures.n_runs += u64::from(!self.run.is_continued);
            figures.n_points += end as u64;
            figures.n_arcs += tally.arcs;
            figures.n_lines += tally.lines;
            figures.deviation_max_mm = figures.deviation_max_mm.max(tally.deviation_mm);
        }
        self.run.drain(end);
        Ok(())
    }

    /// Puts what may be written for the blocks up to `reach`, or fewer, into `written`. Returns for how many blocks it
    /// stands, and what it is; none where it is no shorter than they are.
    fn rewritten(
        &mut self,
        style: Style,
        reach: usize,
        budget: &Budget,
    ) -> Result<(usize, Option<Tally>), Stopped> {
        let run = &self.run;
        let is_writable = match self.modes.distance {
            Some(Distance::Absolute) => run.is_known,
            _ => [true; 3],
        };
        let fitting = Fitting { fit: &self.job.fit, resolution: style.resolution, is_writable, budget };
        let stretches = fitting.stretches(&run.points, reach)?;
        self.written.clear();
        let mut writer = Writer {
            run,
            modes: &self.modes,
            dialect: self.job.dialect,
            style,
            output: self.output,
            text: &mut self.written,
            line: &mut self.block,
            tally: Tally::default(),
            is_refused: false,
        };
        let mut end = 0;
        for stretch in &stretches {
            writer.stretch(end, stretch);
            end = stretch.end;
        }
        let (output, tally) = (writer.output, writer.tally);
        // The plane may have to come back in a block of its own.
        let blocks = tally.arcs + tally.lines + u64::from(output.plane.is_some());
        let is_shorter = blocks < end as u64 && self.written.len() < run.blocks[end - 1].text.end;
        if is_shorter {
            self.output = output;
        }
        Ok((end, is_shorter.then_some(tally)))
    }
}

#[cfg(test)]
mod tests;

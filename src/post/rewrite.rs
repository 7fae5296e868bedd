//! Shortens NC programs of any origin: replaces runs of short G1 blocks by fewer arcs and lines.
//!
//! A *run* is a series of consecutive G1 blocks at one speed. Each block of a run has at most 256 bytes, and
//! has no words but N, G1, X, Y, Z, F and the S in force. Comments for people may stand in its blocks and
//! between them.
//!
//! # Method
//! 1. Read each line (`block`), and follow the modal state of the control (`modes`).
//! 2. Collect the blocks of each run (`run`).
//! 3. Fit arcs and lines to the end points of these blocks, with a proof that they deviate from the path of
//!    the run by at most the tolerance (`stretches`). A run longer than [`WINDOW`] blocks is fitted in parts.
//! 4. Where the text of the arcs and lines is shorter than the blocks, write it in place of the blocks
//!    (`text`). Comments of replaced blocks become lines before their curve, in their order; blank lines
//!    between these blocks are left out. Copy all other blocks.
//! 5. After an arc, the control is in G2 or G3, and perhaps in another plane than in the source program. If a
//!    later line relies on the modes of the source program, write words that restore these modes: a G1 in
//!    that line, or a block before it.
//!
//! # Guarantees
//! * Text outside of runs is copied byte for byte, apart from the added words of step 5. These words cause no
//!   motion.
//! * The Frechet distance between the path of a run and the path that replaces it is at most the tolerance.
//!   This holds for every control: a rounded arc has slightly different radii at its two ends, and a control
//!   may run the arc at any radius between them.
//! * Arcs and lines that replace blocks start exactly where the first of these blocks starts, and end exactly
//!   where the last one ends. So errors do not add up along the program.
//!
//! # What is left alone
//! These blocks are in no run:
//! * Blocks under a mode that changes their path or their speed, such as cutter compensation or feeds per
//!   turn.
//! * Blocks that rely on a mode or on a position that is not known, for example after a macro. At its start,
//!   a program is taken to be in mm, with absolute coordinates, in the XY plane, and with feeds per minute.
//! * Blocks to which the program jumps. Behind such a block, the modes are known where all ways to it have
//!   the same modes (`arrivals`). A jump behind the first [`SCANNED`] bytes is an error where it leads to a
//!   block that was replaced, or to one whose modes were taken as known.
//! * Blocks with a comment that a control may obey, such as `(MSG, ...)`.
//!
//! # Degenerate input
//! A line longer than [`MAX_LINE_LENGTH`] is an error. Text of any encoding is copied.
//!
//! # Cost
//! O(n) for n bytes, plus the cost of fitting. Only one line and one window of blocks are in memory at a
//! time.

mod arrivals;
mod block;
mod figures;
mod labels;
mod lines;
mod mentions;
mod modes;
mod run;
mod stretches;
mod text;

use self::arrivals::Arrivals;
use self::block::{Block, MAX_RUN_BLOCK_LENGTH};
pub use self::figures::{Figures, LeftAlone, RewriteError, RewriteJob};
use self::labels::{Jumps, Labels};
pub use self::lines::MAX_LINE_LENGTH;
use self::lines::{Cutter, line_end, whole};
use self::mentions::Mentions;
use self::modes::{Modes, Needs};
use self::run::{OpenRun, Style};
use self::stretches::Fitting;
use self::text::{Output, Tally, Writer, push_with_g1};
use super::nc::{Distance, Motion};
use toolpathd_core::budget::{Budget, Stopped};

/// Blocks of a run that are fitted at once. Of each window, the curves that end in its first three quarters
/// are written. The next window begins where these curves end. A larger window needs more memory and time; a
/// smaller window ends more arcs early.
pub const WINDOW: usize = 4096;

/// Bytes whose jumps are found before anything is written. More would hold back answers to long programs.
pub const SCANNED: usize = 256 * 1024;

/// A run of fewer blocks stays as it is: two blocks can hardly become shorter.
const MIN_BLOCKS: usize = 3;

/// Lines between two checks of the budget.
const LINES_BETWEEN_CHECKS: u64 = 1024;

/// Rewrites one program. After an error the rewriter cannot go on.
#[derive(Debug)]
pub struct Rewriter {
    job: RewriteJob,
    modes: Modes,
    output: Output,
    run: OpenRun,
    cutter: Cutter,
    /// The text for a window.
    written: Vec<u8>,
    /// The text for a block of the window.
    written_block: String,
    line_end: &'static [u8],
    n_lines: u64,
    /// Blocks to which the program may jump: they are in no run.
    labels: Labels,
    /// The modes at these blocks. `Mentions::forget` holds at others.
    arrivals: Arrivals,
    /// The modes that the text sets anywhere, as far as it has arrived.
    mentions: Mentions,
    /// The start of the program, until its jumps have been found.
    held: Vec<u8>,
    is_scanned: bool,
    /// The lines whose jumps `arrivals` knows.
    n_scanned_lines: u64,
    /// The S in force, where it is known, in millionths.
    speed: Option<i64>,
    figures: Figures,
}

impl Rewriter {
    pub fn new(job: RewriteJob) -> Self {
        Self {
            job: job.with_own_fit(),
            modes: Modes::START,
            output: Output::default(),
            run: OpenRun::default(),
            cutter: Cutter::default(),
            written: Vec::new(),
            written_block: String::new(),
            line_end: b"\n",
            n_lines: 0,
            labels: Labels::default(),
            arrivals: Arrivals::default(),
            mentions: Mentions::default(),
            held: Vec::new(),
            is_scanned: false,
            n_scanned_lines: 0,
            speed: None,
            figures: Figures::default(),
        }
    }

    /// Takes the next bytes, cut anywhere, and appends what is ready to `out`.
    ///
    /// # Errors
    /// When the budget is spent or a line is too long.
    pub fn push(&mut self, bytes: &[u8], out: &mut Vec<u8>, budget: &Budget) -> Result<(), RewriteError> {
        self.figures.bytes_in += bytes.len() as u64;
        if self.is_scanned {
            return self.take(bytes, out, budget);
        }
        self.held.extend_from_slice(bytes);
        if self.held.len() > SCANNED { self.scan(false, out, budget) } else { Ok(()) }
    }

    /// Finds the jumps of the start of the program, and rewrites it.
    fn scan(&mut self, is_whole: bool, out: &mut Vec<u8>, budget: &Budget) -> Result<(), RewriteError> {
        self.is_scanned = true;
        let held = std::mem::take(&mut self.held);
        budget.check()?;
        self.labels.find(&held, self.job.dialect);
        self.mentions = Mentions::find(&held);
        self.modes = self.mentions.start();
        let scanned = if is_whole { &held[..] } else { &held[..whole(&held)] };
        self.arrivals = Arrivals::find(scanned, &self.labels, (self.job.dialect, &self.mentions), budget)?;
        self.n_scanned_lines = lines::split(scanned).count() as u64;
        self.take(&held, out, budget)
    }

    fn take(&mut self, bytes: &[u8], out: &mut Vec<u8>, budget: &Budget) -> Result<(), RewriteError> {
        let before = out.len();
        let mut cutter = std::mem::take(&mut self.cutter);
        let taken = cutter.push(bytes, |line| self.line(line, out, budget));
        self.cutter = cutter;
        self.figures.bytes_out += (out.len() - before) as u64;
        taken
    }

    /// Ends the input; the last line may lack its line end.
    ///
    /// # Errors
    /// As [`Rewriter::push`].
    pub fn finish(&mut self, out: &mut Vec<u8>, budget: &Budget) -> Result<(), RewriteError> {
        if !self.is_scanned {
            self.scan(true, out, budget)?;
        }
        let before = out.len();
        let mut cutter = std::mem::take(&mut self.cutter);
        let taken = cutter.finish(|line| self.line(line, out, budget));
        taken?;
        self.end_run(out, budget)?;
        self.figures.bytes_out += (out.len() - before) as u64;
        Ok(())
    }

    pub fn figures(&self) -> &Figures {
        &self.figures
    }

    /// Takes the next line with its end, if it has one.
    fn line(&mut self, line: &[u8], out: &mut Vec<u8>, budget: &Budget) -> Result<(), RewriteError> {
        if self.n_lines.is_multiple_of(LINES_BETWEEN_CHECKS) {
            budget.check()?;
        }
        self.n_lines += 1;
        let end = line_end(line);
        if !end.is_empty() {
            self.line_end = end;
        }
        let text = &line[..line.len() - end.len()];
        if self.n_lines > self.n_scanned_lines {
            self.mentions.take(text);
        }
        let block = if self.n_lines == 1 { Block::read_first(text) } else { Block::read(text) };
        let block = block.on(self.job.dialect);
        let is_short = text.len() <= MAX_RUN_BLOCK_LENGTH && self.run.has_room(line.len());
        if is_short && !self.run.blocks.is_empty() && block.is_remark() {
            self.run.push_remark(line);
            return Ok(());
        }
        let may_be_in_run = is_short && block.may_be_in_run();
        if may_be_in_run && self.join(line, &block, out, budget)? {
            self.figures.n_motions += 1;
        } else {
            self.end_run(out, budget)?;
            self.count(text, &block);
            self.pass(line, &block, out)?;
        }
        Ok(())
    }

    /// Takes a block into the run, or as the first block of the next run. `false` where the block can be in
    /// no run.
    fn join(
        &mut self,
        line: &[u8],
        block: &Block,
        out: &mut Vec<u8>,
        budget: &Budget,
    ) -> Result<bool, RewriteError> {
        let is_line = block.g.has(10) || self.modes.motion == Some(Motion::Line);
        let has_speed = block.speed.is_none_or(|speed| Some(speed.millionths) == self.speed);
        if !is_line || !has_speed || self.may_arrive(line, block) || !self.modes.allow_runs() {
            return Ok(false);
        }
        let Some(step) = self.run.step(block, &self.modes, self.job.dialect) else { return Ok(false) };
        if !self.run.is_empty() && !self.run.continues(&step, &self.modes) {
            self.end_run(out, budget)?;
            // The block may start the next run, whose first step begins at the modal position.
            return self.join(line, block, out, budget);
        }
        self.run.push(line, block, &step, &mut self.modes);
        if self.run.blocks.len() == WINDOW {
            self.write_run(WINDOW / 4 * 3, out, budget)?;
        }
        Ok(true)
    }

    /// Counts a line that is in no run.
    fn count(&mut self, line: &[u8], block: &Block) {
        let named = [0, 10, 20, 30].into_iter().find(|motion| block.g.has(*motion));
        let is_unknown = named.is_none() && self.modes.motion.is_none();
        let moves = match (block.is_unclear, is_unknown) {
            (true, _) => !is_unknown && !block.is_assignment,
            (false, true) => block.has_axes() && block.g.all().is_empty(),
            (false, false) => block.has_axes(),
        };
        if !moves {
            return;
        }
        self.figures.n_motions += 1;
        let is_line = named.map_or(self.modes.motion == Some(Motion::Line), |motion| motion == 10);
        if is_line || is_unknown {
            let (may_arrive, allows_runs) = (self.may_arrive(line, block), self.modes.allow_runs());
            self.figures.left_alone.add(block, may_arrive, allows_runs && !is_unknown);
        } else {
            self.figures.n_other_motions += 1;
        }
    }

    /// Whether the program may jump to a block.
    fn may_arrive(&self, line: &[u8], block: &Block) -> bool {
        self.labels.hold(&line[block.number.clone()])
    }

    /// The modes that hold at a label, also where the program arrives from above.
    fn modes_at(&self, number: &[u8]) -> Modes {
        self.arrivals
            .at(number)
            .map_or(self.mentions.forget(&self.modes), |modes| modes.common_with(&self.modes))
    }

    /// Writes a line that is in no run, and follows its words.
    fn pass(&mut self, line: &[u8], block: &Block, out: &mut Vec<u8>) -> Result<(), RewriteError> {
        let dialect = self.job.dialect;
        let may_arrive = self.may_arrive(line, block);
        let jumps = Jumps::of(&line[..line.len() - line_end(line).len()], block);
        let is_late = self.n_lines > self.n_scanned_lines;
        if !self.labels.meet(&jumps) || is_late && self.arrivals.are_broken_by(&jumps) {
            return Err(RewriteError::LateJump { line: self.n_lines, limit: SCANNED });
        }
        let before = if may_arrive { self.modes_at(&line[block.number.clone()]) } else { self.modes };
        let (next, needs) = before.read(block, dialect, &self.mentions);
        let needs = if may_arrive { Needs::ALL } else { needs };
        if self.output.settle(&needs, &self.modes, dialect, self.line_end, out) {
            // One blank at the end of a line may be a slip.
            let blanks_behind = line.len() - line_end(line).len() - block.end;
            let is_spaced = block.is_spaced || self.run.is_spaced || blanks_behind > 1;
            push_with_g1(out, line, block.first, is_spaced);
        } else {
            out.extend_from_slice(line);
        }
        let is_certain = next.distance.is_some() && !block.is_optional && !may_arrive;
        self.speed = match block.speed {
            _ if !is_certain || block.is_unclear => None,
            Some(speed) => Some(speed.millionths),
            None => self.speed,
        };
        self.modes = next;
        Ok(())
    }

    fn end_run(&mut self, out: &mut Vec<u8>, budget: &Budget) -> Result<(), RewriteError> {
        while !self.run.blocks.is_empty() {
            self.write_run(self.run.blocks.len(), out, budget)?;
        }
        self.run.clear();
        Ok(())
    }

    /// Writes and forgets at least one and at most `reach` blocks of the run.
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
        if written.is_some() {
            self.labels.replace(self.run.number_words(end));
        }
        if is_long || self.run.is_continued {
            let figures = &mut self.figures;
            figures.n_runs += u64::from(!self.run.is_continued);
            figures.n_points += end as u64;
            figures.n_arcs += tally.arcs;
            figures.n_lines += tally.lines;
            figures.deviation_max_mm = figures.deviation_max_mm.max(tally.deviation_mm);
        } else {
            self.figures.left_alone.short_runs += end as u64;
        }
        self.run.drain(end);
        Ok(())
    }

    /// Puts the text that may replace at most `reach` blocks into `written`. Returns how many blocks the text
    /// replaces, and its tally; `None` for the tally if the text is no shorter than the blocks.
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
        let fitting = Fitting {
            fit: &self.job.fit,
            resolution: style.resolution,
            curves: &self.job.dialect.curves,
            is_writable,
            budget,
        };
        let stretches = fitting.stretches(&run.points, reach)?;
        self.written.clear();
        let mut writer = Writer {
            run,
            modes: &self.modes,
            dialect: self.job.dialect,
            style,
            output: self.output,
            line_end: self.line_end,
            text: &mut self.written,
            line: &mut self.written_block,
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

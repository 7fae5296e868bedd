//! Writes programs for Deckel FP-2, as one paper prints them.
//!
//! * A program begins with its name, a row of the tool table and the name in parentheses, and ends with `?`.
//! * Blocks are numbered from 1. G0 is written again in each rapid, except in one that only moves Z and
//!   follows a rapid across.
//! * Numbers have no zero before the point and none at the end. In rapids, a positive number has a blank
//!   where a negative one has its sign; in cutting blocks, a blank stands before every number. The first
//!   block and the last two write plus signs.
//! * A cutting block states X and Z also where they do not change; leads state what changes.
//!
//! # Source
//! Fig. 4-4 of Y. H. Koo, D. J. Lee, S. Namgung, M. S. Kang, *A Study on the Construction of CAD/CAM System
//! for Machining of Sculptured Surface of Die*, 1989.

use super::lines::{Lines, Numbering, Written};
use super::program_number;
use crate::block::Block;
use crate::words::{self, AXES, FeedWord};
use crate::{ProgramJob, WriteError};
use toolpathd_core::toolpath::path::Role;

const NUMBERING: Numbering = Numbering { prefix: "N", first: 1, step: 1, max: u32::MAX };

/// The text of a whole program; see [`super::text`].
pub fn text(blocks: &[Block], job: &ProgramJob) -> Result<Written, WriteError> {
    let mut writer = Writer {
        job,
        lines: Lines::new(job.dialect, Some(NUMBERING), blocks.len()),
        at: [None; 3],
        last: Last::Other,
        feed: None,
    };
    let (tool, _) = job.tool_numbers();
    let name = format!("&X{}", program_number(job)?.unwrap_or(1));
    let radius = job.tool.map_or(0, |tool| (tool.radius_mm * 1000.0).round() as i64);
    let radius = short(radius, 3);
    for text in [&name, &format!("T {tool} R {radius} L0.000 S A A ( )"), "Z", &format!("({name})")] {
        writer.lines.word(text);
        writer.lines.end_unnumbered()?;
    }
    let mut n_parked = 0;
    writer.lines.begin_blocks();
    for (k, block) in blocks.iter().enumerate() {
        let is_parked = matches!(block, Block::Park { .. });
        n_parked += usize::from(is_parked);
        if is_parked && n_parked == 2 {
            writer.frame("T 0")?;
        }
        writer.block(block)?;
        if is_parked && n_parked == 3 {
            writer.lines.word("M30");
        }
        writer.lines.end()?;
        writer.lines.end_block();
        match k {
            0 => writer.frame(&format!("G17 T {tool}"))?,
            1 => writer.spindle()?,
            _ => {}
        }
    }
    writer.lines.word("?");
    writer.lines.end_unnumbered()?;
    Ok(writer.lines.finish())
}

struct Writer<'a> {
    job: &'a ProgramJob<'a>,
    lines: Lines<'a>,
    /// The position as last written.
    at: [Option<i64>; 3],
    last: Last,
    feed: Option<FeedWord>,
}

/// The kind of the block before.
#[derive(Clone, Copy, PartialEq)]
enum Last {
    RapidAcross,
    Line,
    Other,
}

impl Writer<'_> {
    fn frame(&mut self, text: &str) -> Result<(), WriteError> {
        self.last = Last::Other;
        self.lines.line(text)
    }

    fn spindle(&mut self) -> Result<(), WriteError> {
        let Some(rpm) = self.job.cutting.spindle_rpm else { return Ok(()) };
        let speed = words::spindle(rpm, &self.job.dialect.numbers)?;
        self.frame(&format!("S {}", short(speed.digits, speed.decimals)))
    }

    fn block(&mut self, block: &Block) -> Result<(), WriteError> {
        match *block {
            Block::Park { to } => {
                self.lines.word("G0");
                self.words(to, |number, is_negative| if is_negative { number } else { format!("+{number}") });
                self.last = Last::Other;
            }
            Block::Rapid { to } => {
                let is_across = to[0].is_some() || to[1].is_some();
                if is_across || self.last != Last::RapidAcross {
                    self.lines.word("G0");
                }
                self.words(to, |number, is_negative| if is_negative { number } else { format!(" {number}") });
                self.last = if is_across { Last::RapidAcross } else { Last::Other };
            }
            Block::Line { to, feed, role } => {
                if self.last != Last::Line {
                    self.lines.word("G1");
                }
                let is_stated =
                    |axis: usize| self.at[axis] != Some(to[axis]) || role == Role::Cut && axis != 1;
                let stated = [0, 1, 2].map(|axis| is_stated(axis).then_some(to[axis]));
                self.words(stated, |number, _| format!(" {number}"));
                if self.feed != Some(feed) {
                    self.lines.word(&format!("F {}", short(feed.digits, feed.decimals)));
                    self.lines.check_digits(feed.digits, feed.decimals);
                    self.feed = Some(feed);
                }
                self.last = Last::Line;
            }
            // The paper prints no such blocks. What needs them was lowered or refused.
            Block::Arc { .. }
            | Block::Helix { .. }
            | Block::Parabola { .. }
            | Block::Dwell { .. }
            | Block::BeginCycle { .. }
            | Block::Hole { .. }
            | Block::EndCycle
            | Block::Rotate { .. }
            | Block::BeginTipControl { .. }
            | Block::Posed { .. }
            | Block::BeginRails { .. }
            | Block::Rail { .. }
            | Block::EndRails
            | Block::EndPosed => return Err(WriteError::Differs { line: 0, what: "kind" }),
        }
        Ok(())
    }

    /// Writes the coordinates that have a value. `form` puts a sign or a blank before a number.
    fn words(&mut self, to: [Option<i64>; 3], form: impl Fn(String, bool) -> String) {
        for (axis, to) in to.into_iter().enumerate() {
            let Some(to) = to else { continue };
            let number = short(to, self.job.program.resolution.decimals);
            self.lines.word(&format!("{}{}", AXES[axis], form(number, to < 0)));
            self.lines.check_digits(to, self.job.program.resolution.decimals);
            self.at[axis] = Some(to);
        }
    }
}

/// A number without a zero before the point and without zeros at the end.
fn short(digits: i64, decimals: u8) -> String {
    let text = words::fixed(digits, decimals);
    if decimals == 0 {
        return text;
    }
    let text = text.trim_end_matches('0').trim_end_matches('.');
    match text.strip_prefix('-') {
        Some(rest) if rest.starts_with("0.") => format!("-{}", &rest[1..]),
        _ if text.starts_with("0.") => text[1..].to_owned(),
        _ => text.to_owned(),
    }
}

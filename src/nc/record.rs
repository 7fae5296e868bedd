//! What a program does: its toolpath, with the sums of each tool and of each feed.

use std::collections::BTreeMap;

use nalgebra::Point3;
use toolpathd_core::geometry::curve::{Curve, Line};
use toolpathd_core::toolpath::path::{Builder, PathError};
use toolpathd_core::toolpath::units::FeedRate;
use toolpathd_core::toolpath::{Role, Toolpath};

/// What one tool does, from its change to the next.
#[derive(Debug, Clone, PartialEq)]
pub struct ToolUse {
    /// `None` before the first tool change, and for a tool that the program calls by a name.
    pub number: Option<u32>,
    pub name: Option<String>,
    /// The line of the change, counted from 1; 1 before the first change.
    pub line: usize,
    /// The index of the first pass that the tool cuts.
    pub first_pass: usize,
    pub n_passes: usize,
    pub cutting_length_mm: f64,
    pub cutting_time_s: f64,
    pub rapid_length_mm: f64,
    pub dwell_time_s: f64,
    pub largest_feed_mm_per_min: f64,
    /// The fastest spindle speed while it cuts, 1/min.
    pub largest_speed_rpm: Option<f64>,
}

/// What is cut at one feed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FeedUse {
    pub feed_mm_per_min: f64,
    pub length_mm: f64,
    pub time_s: f64,
}

/// The moves so far.
pub struct Record {
    builder: Option<Builder>,
    limit: usize,
    n_passes: usize,
    /// The next move begins a pass.
    begins_pass: bool,
    tools: Vec<ToolUse>,
    feeds: BTreeMap<u64, FeedUse>,
    /// Pauses before the first place that is known, s.
    early_s: Vec<f64>,
    /// Rapids whose start or end is not known.
    pub n_rapids_not_counted: usize,
    /// The line of each move, counted from 1.
    lines: Vec<u32>,
}

/// Feeds that are told apart; further ones are joined to the nearest.
const MAX_FEEDS: usize = 1000;

/// A toolpath with its tools and its feeds, and the line of each move.
pub type Recorded = (Toolpath, Vec<ToolUse>, Vec<FeedUse>, Vec<u32>);

impl Record {
    pub fn new(limit: usize) -> Self {
        Self {
            builder: None,
            limit,
            n_passes: 0,
            begins_pass: false,
            tools: vec![ToolUse::begun(None, None, 1)],
            feeds: BTreeMap::new(),
            early_s: Vec::new(),
            n_rapids_not_counted: 0,
            lines: Vec::new(),
        }
    }

    pub fn has_moves(&self) -> bool {
        self.builder.is_some()
    }

    fn builder_at(&mut self, from: Point3<f64>) -> Result<&mut Builder, PathError> {
        let (is_new, limit) = (self.builder.is_none(), self.limit);
        let builder = self.builder.get_or_insert_with(|| Toolpath::builder(from).with_limit(limit));
        let is_apart = builder.at() != from;
        if is_apart {
            builder.begin_pass_apart(from);
        } else if is_new || self.begins_pass {
            builder.begin_pass(None);
        }
        if is_apart || is_new || self.begins_pass {
            self.n_passes += 1;
            self.begins_pass = false;
            if let Some(tool) = self.tools.last_mut() {
                tool.first_pass = if tool.n_passes == 0 { self.n_passes - 1 } else { tool.first_pass };
                tool.n_passes += 1;
            }
        }
        for seconds in self.early_s.drain(..) {
            builder.dwell(seconds)?;
            self.lines.push(0);
        }
        Ok(builder)
    }

    /// # Errors
    /// As [`Builder::rapid`].
    pub fn rapid(&mut self, from: Point3<f64>, to: Point3<f64>, line: usize) -> Result<(), PathError> {
        if from == to {
            return Ok(());
        }
        self.builder_at(from)?.rapid(to)?;
        self.lines.push(line as u32);
        if let Some(tool) = self.tools.last_mut() {
            tool.rapid_length_mm += Line { start: from, end: to }.length();
        }
        Ok(())
    }

    /// A cut; a curve without length is left out.
    ///
    /// # Errors
    /// As [`Builder::follow`].
    pub fn feed(
        &mut self,
        curve: Curve,
        rate: FeedRate,
        speed_rpm: Option<f64>,
        line: usize,
    ) -> Result<(), PathError> {
        let length_mm = curve.length();
        if length_mm == 0.0 {
            return Ok(());
        }
        self.builder_at(curve.start())?.follow(curve, rate, Role::Cut)?;
        self.lines.push(line as u32);
        let feed_mm_per_min = rate.mm_per_min();
        let time_s = length_mm / feed_mm_per_min * 60.0;
        if let Some(tool) = self.tools.last_mut() {
            tool.cutting_length_mm += length_mm;
            tool.cutting_time_s += time_s;
            tool.largest_feed_mm_per_min = tool.largest_feed_mm_per_min.max(feed_mm_per_min);
            let fastest = [tool.largest_speed_rpm, speed_rpm].into_iter().flatten().reduce(f64::max);
            tool.largest_speed_rpm = fastest;
        }
        // Bits of positive numbers are in the order of the numbers.
        let mut key = feed_mm_per_min.to_bits();
        if self.feeds.len() >= MAX_FEEDS && !self.feeds.contains_key(&key) {
            key = self.feeds.range(..key).next_back().or(self.feeds.iter().next()).map_or(key, |(k, _)| *k);
        }
        let used = self.feeds.entry(key).or_insert(FeedUse { feed_mm_per_min, length_mm: 0.0, time_s: 0.0 });
        used.length_mm += length_mm;
        used.time_s += time_s;
        Ok(())
    }

    /// # Errors
    /// As [`Builder::dwell`].
    pub fn dwell(&mut self, seconds: f64, line: usize) -> Result<(), PathError> {
        if let Some(tool) = self.tools.last_mut() {
            tool.dwell_time_s += seconds;
        }
        match &mut self.builder {
            Some(builder) => {
                builder.dwell(seconds)?;
                self.lines.push(line as u32);
            }
            None if self.early_s.len() >= self.limit => {
                return Err(PathError::TooManyMoves { limit: self.limit });
            }
            None => self.early_s.push(seconds),
        }
        Ok(())
    }

    pub fn change_tool(&mut self, number: Option<u32>, name: Option<String>, line: usize) {
        self.begins_pass = self.builder.is_some();
        match self.tools.last_mut() {
            Some(tool) if tool.n_passes == 0 && tool.dwell_time_s == 0.0 => {
                *tool = ToolUse::begun(number, name, line);
            }
            _ => self.tools.push(ToolUse::begun(number, name, line)),
        }
    }

    /// The toolpath, its tools and its feeds, and the line of each move. `None` where no move is known from
    /// its start to its end.
    pub fn finish(self) -> Option<Recorded> {
        let toolpath = self.builder?.finish().ok()?;
        Some((toolpath, self.tools, self.feeds.into_values().collect(), self.lines))
    }
}

impl ToolUse {
    fn begun(number: Option<u32>, name: Option<String>, line: usize) -> Self {
        Self {
            number,
            name,
            line,
            first_pass: 0,
            n_passes: 0,
            cutting_length_mm: 0.0,
            cutting_time_s: 0.0,
            rapid_length_mm: 0.0,
            dwell_time_s: 0.0,
            largest_feed_mm_per_min: 0.0,
            largest_speed_rpm: None,
        }
    }
}

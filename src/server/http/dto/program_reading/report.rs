//! The report on a program that was read.

use serde::Serialize;
use utoipa::ToSchema;

use super::trace::TracedReport;
use toolpathd_nc::ReadProgram;
use toolpathd_nc::control::Control;
use toolpathd_nc::frames;
use toolpathd_nc::notes::LeftWord;
use toolpathd_nc::record::{FeedUse, ToolUse};

/// What a program does.
#[derive(Debug, Clone, Serialize, ToSchema)]
pub struct ReadReport {
    /// Dialect in which the program was read.
    dialect: &'static str,
    /// Number of lines of the text.
    n_lines: usize,
    /// Number of blocks that run, each as often as it runs. Blocks that loops and branches pass over count
    /// too.
    n_blocks: usize,
    /// Number of rapids from or to a place that is not known. They count in no length, time or bound.
    n_rapids_not_counted: usize,
    /// Work offset in force at the end.
    work_offset: String,
    /// Where the tip of the tool stands at the end, in mm: x, y and z, each `null` where it is not known.
    #[schema(value_type = Vec<Option<f64>>, min_items = 3, max_items = 3)]
    end: [Option<f64>; 3],
    /// Largest feed of a cut, in mm/min; 0 where nothing is cut.
    feed_max_mm_per_min: f64,
    /// Largest speed of the spindle during a cut, in 1/min. `null` where the spindle never turns.
    #[schema(required)]
    spindle_max_rpm: Option<f64>,
    /// What each tool does, in the order of the tool changes.
    tools: Vec<ToolReport>,
    /// What is cut at each feed, in the order of the feeds.
    feeds: Vec<FeedReport>,
    /// Words that change nothing of the toolpath, in the order of their texts.
    left_alone: Vec<LeftWordReport>,
    /// Number of words that were left alone.
    n_left_alone: usize,
    /// The modal state behind each block that has run, with `trace=true`.
    #[serde(skip_serializing_if = "Option::is_none")]
    trace: Option<Vec<TracedReport>>,
}

/// What one tool does, from its change to the next.
#[derive(Debug, Clone, Serialize, ToSchema)]
struct ToolReport {
    /// Number of the tool. `null` before the first tool change.
    #[schema(required)]
    number: Option<u32>,
    /// Name by which the program calls the tool; absent where it calls a number.
    #[serde(skip_serializing_if = "Option::is_none")]
    name: Option<String>,
    /// Number of the line of the tool change, counted from 1; 1 before the first tool change.
    line: usize,
    /// Number of the tool's first pass in `toolpath`, counted from 0.
    first_pass: usize,
    /// Number of the tool's passes.
    n_passes: usize,
    /// Length of its feed moves, in mm.
    cutting_length_mm: f64,
    /// Time of its feed moves, in s.
    cutting_time_s: f64,
    /// Length of its rapids, in mm.
    rapid_length_mm: f64,
    /// Time of its pauses, in s.
    dwell_time_s: f64,
    /// Its largest feed, in mm/min; 0 where it cuts nothing.
    feed_max_mm_per_min: f64,
    /// Its largest speed during a cut, in 1/min. `null` where the spindle never turns.
    #[schema(required)]
    spindle_max_rpm: Option<f64>,
}

/// What is cut at one feed.
#[derive(Debug, Clone, Serialize, ToSchema)]
struct FeedReport {
    /// Feed, in mm/min.
    feed_mm_per_min: f64,
    /// Length of the moves at this feed, in mm.
    length_mm: f64,
    /// Time of the moves at this feed, in s.
    time_s: f64,
}

/// A word that was left alone.
#[derive(Debug, Clone, Serialize, ToSchema)]
struct LeftWordReport {
    /// The word, or its letter.
    word: String,
    /// Number of times it was left alone.
    count: usize,
    /// Number of the line where it stands first, counted from 1.
    line: usize,
}

impl ReadReport {
    pub fn new(reading: &ReadProgram, control: &Control, with_trace: bool) -> Self {
        let tools: Vec<ToolReport> = reading.tools.iter().map(ToolReport::from).collect();
        Self {
            dialect: control.name,
            n_lines: reading.n_lines,
            n_blocks: reading.n_blocks,
            n_rapids_not_counted: reading.n_rapids_not_counted,
            work_offset: frames::name(reading.work_offset),
            end: reading.end,
            feed_max_mm_per_min: tools.iter().map(|tool| tool.feed_max_mm_per_min).fold(0.0, f64::max),
            spindle_max_rpm: tools.iter().filter_map(|tool| tool.spindle_max_rpm).reduce(f64::max),
            tools,
            feeds: reading.feeds.iter().map(FeedReport::from).collect(),
            left_alone: reading.left_alone.iter().map(LeftWordReport::from).collect(),
            n_left_alone: reading.n_left_alone,
            trace: with_trace.then(|| reading.trace.iter().map(TracedReport::from).collect()),
        }
    }
}

impl From<&ToolUse> for ToolReport {
    fn from(tool: &ToolUse) -> Self {
        Self {
            number: tool.number,
            name: tool.name.clone(),
            line: tool.line,
            first_pass: tool.first_pass,
            n_passes: tool.n_passes,
            cutting_length_mm: tool.cutting_length_mm,
            cutting_time_s: tool.cutting_time_s,
            rapid_length_mm: tool.rapid_length_mm,
            dwell_time_s: tool.dwell_time_s,
            feed_max_mm_per_min: tool.largest_feed_mm_per_min,
            spindle_max_rpm: tool.largest_speed_rpm,
        }
    }
}

impl From<&FeedUse> for FeedReport {
    fn from(used: &FeedUse) -> Self {
        let FeedUse { feed_mm_per_min, length_mm, time_s } = *used;
        Self { feed_mm_per_min, length_mm, time_s }
    }
}

impl From<&LeftWord> for LeftWordReport {
    fn from(left: &LeftWord) -> Self {
        Self { word: left.word.clone(), count: left.count, line: left.line }
    }
}

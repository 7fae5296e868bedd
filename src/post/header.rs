//! The comments for human readers at the head of a program and of each operation, before its first block.
//!
//! Lengths and feeds are in the units of the program. `write` replaces characters that are not allowed in a
//! comment.

use std::fmt::Write;

use super::coarse::{CoarseFeeds, coarse_feeds};
use super::dialect::Dialect;
use super::lower::Lowered;
use super::posed::Slowed;
use super::words::{self, FeedWord};
use super::{AxisOutput, FiveAxes, Operation, PassNote, ProgramJob, WriteError};
use toolpathd_core::toolpath::cutting::Coolant;
use toolpathd_core::toolpath::measure::{Bounds, measure};
use toolpathd_core::toolpath::motion_time::motion_time;
use toolpathd_core::toolpath::path::{Move, Role, Toolpath};
use toolpathd_core::toolpath::program::Units;
use toolpathd_core::toolpath::tool::{Shape, Tool};
use toolpathd_core::toolpath::units::rounded_up;

/// Most notes of a header. Further notes are only counted, so that the header stays a page.
const MAX_NOTES: usize = 40;

/// The label of a warning. A warning may take several lines.
pub const WARNING: &str = "WARNING";

/// One remark: a fixed label and the text behind it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Remark {
    pub label: &'static str,
    pub text: String,
}

/// The remarks about each operation of a program, in order. Those about the whole program stand before those
/// about the first operation.
///
/// # Errors
/// When a feed cannot be written.
pub fn remarks(operations: &[Operation], lowered: &[Lowered]) -> Result<Vec<Vec<Remark>>, WriteError> {
    let mut all = Vec::with_capacity(operations.len());
    let mut times = Some(Times::default());
    for (operation, lowered) in operations.iter().zip(lowered) {
        let (remarks, own) = of_operation(operation, lowered)?;
        times = times.zip(own).map(|(sum, own)| Times {
            plain: sum.plain + own.plain,
            with_ramps: sum.with_ramps + own.with_ramps,
        });
        all.push(remarks);
    }
    if operations.len() > 1 {
        for (k, (remarks, operation)) in all.iter_mut().zip(operations).enumerate() {
            let name = operation.name.map_or(String::new(), |name| format!(" - {name}"));
            let offset = operation.job.program.work_offset;
            let offset = offset.map_or(String::new(), |number| format!(" - WORK OFFSET G{number}"));
            let text = format!("{} OF {}{offset}{name}", k + 1, operations.len());
            let notes = if k == 0 { Vec::new() } else { notes(&operation.job) };
            remarks.splice(0..0, std::iter::once(Remark { label: "OPERATION", text }).chain(notes));
        }
    }
    if let ([first, ..], Some(remarks)) = (operations, all.first_mut()) {
        remarks.splice(0..0, of_program(&first.job, operations, times));
    }
    Ok(all)
}

/// What stands at the head of the program: its name, notes and units, and for several operations their tools
/// and the times of all of them.
fn of_program(job: &ProgramJob, operations: &[Operation], times: Option<Times>) -> Vec<Remark> {
    let unit = Unit::of(job);
    let mut remarks = Vec::new();
    if let Some(name) = job.program.name.as_ref().filter(|_| !job.dialect.names_programs_at_their_number()) {
        remarks.push(Remark { label: "PROGRAM", text: name.clone() });
    }
    remarks.extend(notes(job));
    let is_alone = operations.len() == 1;
    remarks.push(Remark { label: "WRITTEN", text: written(job, &unit, is_alone) });
    if is_alone {
        return remarks;
    }
    let mut told: Vec<u32> = Vec::new();
    for job in operations.iter().map(|operation| &operation.job) {
        let number = job.tool_numbers().0;
        if let Some(tool) = job.tool.filter(|_| !told.contains(&number)) {
            remarks.push(Remark { label: "TOOL", text: tool_text(tool, job.dialect, &unit) });
            told.push(number);
        }
    }
    if let Some(Times { plain, with_ramps }) = times {
        let [plain, with_ramps] = [plain, with_ramps].map(clock);
        let text = format!("{plain} - WITH ACCELERATION {with_ramps} - NO TOOL CHANGES COUNTED");
        remarks.push(Remark { label: "TIME OF ALL", text });
    }
    remarks
}

/// The remark that stands before a pass.
pub fn of_pass(note: &PassNote, job: &ProgramJob) -> Remark {
    let height = Unit::of(job).length(note.z_mm);
    Remark { label: note.label, text: format!("{} - Z {height}", note.text) }
}

fn notes(job: &ProgramJob) -> Vec<Remark> {
    let note = |text: String| Remark { label: "NOTE", text };
    let mut notes: Vec<Remark> = job.comments.iter().take(MAX_NOTES).cloned().map(note).collect();
    if job.comments.len() > MAX_NOTES {
        notes.push(note(format!("{} MORE ARE LEFT OUT", job.comments.len() - MAX_NOTES)));
    }
    notes
}

/// The time of an operation, s: at constant feeds, and with the ramps of the machine.
#[derive(Clone, Copy, Default)]
struct Times {
    plain: f64,
    with_ramps: f64,
}

/// The remarks about one operation, and its time.
fn of_operation(
    operation: &Operation,
    lowered: &Lowered,
) -> Result<(Vec<Remark>, Option<Times>), WriteError> {
    let Operation { toolpath, job, .. } = operation;
    let unit = Unit::of(job);
    let mut remarks = Vec::new();
    let mut say = |label, text: String| remarks.push(Remark { label, text });
    if let Some(tool) = job.tool {
        say("TOOL", tool_text(tool, job.dialect, &unit));
    }
    let feeds = feeds(toolpath, job)?;
    if !feeds.is_empty() {
        say("FEED", format!("{feeds} {} PER MIN", unit.name));
    }
    say("SPINDLE", spindle(job));
    if let Some(five) = job.five_axes {
        say("AXES", axes(&five, job.dialect));
    }
    let measures = measure(toolpath, job.cutting.rapid_feed);
    say("RANGE", range(&measures.bounds, job.cutting.clearance_z_mm, &unit));
    let output = job.five_axes.map(|five| five.output);
    let coarse = coarse_feeds(toolpath, job.dialect, job.program.resolution.units, output);
    let delay_s = lowered.delay_s + coarse.map_or(0.0, |coarse| coarse.by_s);
    let with_ramps = motion_time(toolpath, job.cutting.rapid_feed, job.cutting.acceleration);
    let times = measures.total_time_s.zip(with_ramps);
    let times =
        times.map(|(plain, with_ramps)| Times { plain: plain + delay_s, with_ramps: with_ramps + delay_s });
    if let Some(Times { plain, with_ramps }) = times {
        say("TIME", format!("{} - WITH ACCELERATION {}", clock(plain), clock(with_ramps)));
    }
    let axis = match lowered.displacement_axis.to_degrees() {
        0.0 => String::new(),
        degrees => format!(" AND {:.4} DEGREES", rounded_up(degrees)),
    };
    say("ROUNDING", format!("WITHIN {:.4} MM{axis} OF THE TOOLPATH", rounded_up(lowered.displacement_mm)));
    if let Some(coarse) = coarse {
        say(WARNING, coarse_text(&coarse, &unit));
    }
    if let Slowed { coarse: blocks @ 1.., coarse_by_s, .. } = lowered.slowed {
        let by_s = rounded_up(coarse_by_s);
        say(
            WARNING,
            format!("{blocks} BLOCKS ARE TOO SLOW FOR THE DECIMALS OF F AND TAKE {by_s:.3} S LONGER"),
        );
    }
    if let Slowed { blocks: blocks @ 1.., by_s, .. } = lowered.slowed {
        let by_s = rounded_up(by_s);
        say(WARNING, format!("{blocks} BLOCKS ARE TOO SHORT FOR THE LARGEST F AND TAKE {by_s:.3} S LONGER"));
    }
    for warning in job.warnings {
        // No control keeps a colon in a comment.
        say(WARNING, warning.replace([':', ';'], " -"));
    }
    Ok((remarks, times))
}

/// The units of the program, for figures.
struct Unit {
    name: &'static str,
    mm: f64,
    decimals: u8,
}

impl Unit {
    fn of(job: &ProgramJob) -> Self {
        let resolution = job.program.resolution;
        let name = match resolution.units {
            Units::Mm => "MM",
            Units::Inch => "INCH",
        };
        Self { name, mm: resolution.units.mm(), decimals: resolution.decimals }
    }

    fn length(&self, mm: f64) -> String {
        let digits = (mm / self.mm * 10f64.powi(i32::from(self.decimals))).round() as i64;
        words::fixed(digits, self.decimals)
    }
}

fn written(job: &ProgramJob, unit: &Unit, with_offset: bool) -> String {
    let mut text = format!("FOR {} - {} - {} DECIMALS", job.dialect.name, unit.name, unit.decimals);
    if let Some(number) = job.program.work_offset.filter(|_| with_offset) {
        let _ = write!(text, " - WORK OFFSET G{number}");
    }
    text
}

fn tool_text(tool: &Tool, dialect: &Dialect, unit: &Unit) -> String {
    let &Tool { shape, radius_mm, .. } = tool;
    let number = tool.places().0;
    let (shape, more) = match shape {
        Shape::Ball => ("BALL".to_owned(), String::new()),
        Shape::Flat => ("FLAT".to_owned(), String::new()),
        Shape::BullNose { corner_radius_mm } => {
            ("BULL NOSE".to_owned(), format!(" CORNER RADIUS {}", unit.length(corner_radius_mm)))
        }
        Shape::V { tip_angle_deg, tip_diameter_mm } => {
            (format!("V OF {tip_angle_deg} DEG"), format!(" TIP DIAMETER {}", unit.length(tip_diameter_mm)))
        }
        Shape::Cone { taper_angle_deg, tip_diameter_mm } => (
            format!("CONE OF {taper_angle_deg} DEG"),
            format!(" TIP DIAMETER {}", unit.length(tip_diameter_mm)),
        ),
        Shape::Drill { point_angle_deg } => {
            let point = point_angle_deg.map_or(String::new(), |deg| format!(" OF {deg} DEG"));
            (format!("DRILL{point}"), String::new())
        }
    };
    let diameter = unit.length(2.0 * radius_mm);
    let offset = dialect
        .abilities
        .length_offsets
        .map_or(String::new(), |offsets| format!(" {}{}", offsets.letter, dialect.length_offset_of(tool)));
    format!("T{number}{offset} {shape} DIAMETER {diameter}{more} {}", unit.name)
}

/// The feed of every role in the toolpath, as written; a range where a role has several feeds.
fn feeds(toolpath: &Toolpath, job: &ProgramJob) -> Result<String, WriteError> {
    const ROLES: [(Role, &str); 6] = [
        (Role::Cut, "CUT"),
        (Role::Plunge, "PLUNGE"),
        (Role::Ramp, "RAMP"),
        (Role::LeadIn, "LEAD-IN"),
        (Role::Link, "LINK"),
        (Role::LeadOut, "LEAD-OUT"),
    ];
    let mut ranges = [None; ROLES.len()];
    for step in toolpath.moves() {
        let Move::Feed { rate: Some(rate), role, .. } = step else { continue };
        for (range, _) in ranges.iter_mut().zip(ROLES).filter(|(_, (of, _))| of == role) {
            let (least, most) = range.unwrap_or((*rate, *rate));
            *range =
                Some((if *rate < least { *rate } else { least }, if *rate > most { *rate } else { most }));
        }
    }
    let mut parts = Vec::new();
    for (range, (_, name)) in ranges.into_iter().zip(ROLES) {
        let Some((least, most)) = range else { continue };
        let [least, most] =
            [least, most].map(|rate| words::feed(rate, job.program.resolution.units, &job.dialect.numbers));
        let (least, most) = (least?, most?);
        let number = |FeedWord { digits, decimals }: FeedWord| words::fixed(digits, decimals);
        let to = if least == most { String::new() } else { format!(" TO {}", number(most)) };
        parts.push(format!("{name} {}{to}", number(least)));
    }
    Ok(parts.join(" "))
}

/// What the feeds become that the decimals of F cannot state.
fn coarse_text(coarse: &CoarseFeeds, unit: &Unit) -> String {
    let &CoarseFeeds { moves, asked_mm_per_min, written_mm_per_min, by_s } = coarse;
    let [asked, written] = [asked_mm_per_min, written_mm_per_min].map(|feed| feed / unit.mm);
    let (name, by_s) = (unit.name, rounded_up(by_s));
    let feeds = if moves == 1 { "1 FEED IS".to_owned() } else { format!("{moves} FEEDS ARE") };
    format!(
        "{feeds} TOO SLOW FOR THE DECIMALS OF F - {asked:.6} {name} PER MIN IS WRITTEN AS {written:.4} - {by_s:.3} S LONGER"
    )
}

/// What coordinates and axis words mean.
fn axes(five: &FiveAxes, dialect: &Dialect) -> String {
    let machine = five.machine.map_or(String::new(), |machine| {
        let [first, second] = machine.rotary();
        format!(" - {} AND {} OF {}", first.name, second.name, machine.name())
    });
    match five.output {
        AxisOutput::Angles if dialect.five_axes.switches_kinematics => {
            format!("TIP OF THE TOOL AND ANGLES BY THE KINEMATICS OF M428{machine}")
        }
        AxisOutput::Angles => format!("TIP OF THE TOOL AND ANGLES{machine}"),
        AxisOutput::Vectors => "TIP OF THE TOOL AND VECTOR OF ITS AXIS".to_owned(),
        AxisOutput::Rails => "TIP OF THE TOOL AND VECTOR OF ITS AXIS - POLYNOMIALS OF TWO POINTS".to_owned(),
        AxisOutput::Machine => format!("POSITIONS OF ALL AXES OF THE MACHINE{machine}"),
    }
}

fn spindle(job: &ProgramJob) -> String {
    let speed = match job.cutting.spindle_rpm {
        Some(rpm) => format!("{} RPM", rpm.round()),
        None => "NOT STARTED".into(),
    };
    let coolant = match job.cutting.coolant {
        Coolant::Off => "OFF",
        Coolant::Flood => "FLOOD",
        Coolant::Mist => "MIST",
    };
    format!("{speed} - COOLANT {coolant}")
}

/// The bounding box of all motion, with the motion to the clearance plane.
fn range(bounds: &Bounds, clearance_z_mm: f64, unit: &Unit) -> String {
    let Bounds { min, mut max } = *bounds;
    max.z = max.z.max(clearance_z_mm);
    let along = |axis: usize| format!("{} TO {}", unit.length(min[axis]), unit.length(max[axis]));
    format!("X {} Y {} Z {} {}", along(0), along(1), along(2), unit.name)
}

/// A time in hours, minutes and seconds.
pub fn clock(seconds: f64) -> String {
    let whole = seconds.round() as u64;
    let (hours, minutes, seconds) = (whole / 3600, whole / 60 % 60, whole % 60);
    match (hours, minutes) {
        (0, 0) => format!("{seconds} S"),
        (0, _) => format!("{minutes} MIN {seconds} S"),
        _ => format!("{hours} H {minutes} MIN {seconds} S"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_time_is_written_in_hours_minutes_and_seconds() {
        for (seconds, text) in
            [(0.2, "0 S"), (59.6, "1 MIN 0 S"), (3599.4, "59 MIN 59 S"), (7322.0, "2 H 2 MIN 2 S")]
        {
            assert_eq!(clock(seconds), text);
        }
    }
}

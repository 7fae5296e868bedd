//! Draws quantities over time, one diagram above the other, as one SVG sheet: A4 landscape.
//!
//! # Method
//! All diagrams share the axis of time. Each has the range of values of the motion after the change. The
//! motion before the change may take a quarter more; what goes beyond is drawn at the edge. Of all values in
//! a narrow column of paper, only the least and the largest are drawn.
//!
//! # Guarantees
//! * A sheet has about 1 MB at most.
//! * The same content gives the same bytes. Texts of the caller appear as text only, never as markup.
//!
//! # Degenerate input
//! A diagram without values, or with values that are not finite, has its caption alone.
//!
//! # Cost
//! O(n) for n values.

use super::axes;
use super::column::{self, BLOCK_Y_MM, LEFT_MM, LEGEND_LINE_MM, LINE_MM, SAMPLE_MM, TOP_MM, Texts, WIDTH_MM};
use super::number::{RoundNumber, fixed, with_decimals};
use super::text::{self, escape};

/// Width of a column in which two values are drawn, mm of paper.
const COLUMN_MM: f64 = 0.15;

/// The area of the diagrams: left, top, right, bottom; mm of paper.
const AREA_MM: [f64; 4] = [24.0, 16.0, 216.0, 194.0];
/// Distance between diagrams, for a caption.
const GAP_MM: f64 = 7.0;
/// How far the lines of the grid reach out of the frame, mm of paper.
const TICK_MM: f64 = 1.2;

/// The fewest intervals between the numbers of an axis.
const INTERVALS: f64 = 4.0;

/// The part of the range of values that the motion before the change may take more.
const BEYOND: f64 = 0.25;

/// The part of the range of values that stays free at both ends.
const ROOM: f64 = 0.03;

/// Values whose range is smaller than this part of them count as one value: the range is rounding.
const ONE_VALUE: f64 = 1e-9;

/// The room on both sides of one value, as a part of it.
const ROOM_OF_ONE: f64 = 1e-3;

const STYLE: &str =
    ".plot .before{stroke:#8a8a8a;stroke-width:.13}.plot .after{stroke:#0072b2;stroke-width:.25}";

/// One quantity over time.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Diagram {
    /// Its name with its unit.
    pub name: String,
    /// Times, s, with values, in order.
    pub before: Vec<[f64; 2]>,
    pub after: Vec<[f64; 2]>,
}

/// What a sheet of diagrams shows.
#[derive(Debug, Clone, Copy)]
pub struct DiagramScene<'a> {
    pub title: &'a str,
    /// Lines beside the diagrams.
    pub notes: &'a [String],
    /// Warnings above the notes.
    pub warnings: &'a [String],
    pub diagrams: &'a [Diagram],
    /// What the two motions are.
    pub before: &'a str,
    pub after: &'a str,
}

/// Draws the sheet as an SVG document.
pub fn svg(scene: &DiagramScene) -> String {
    let mut out = super::opening(scene.title, "motion over time", STYLE);
    let [left, top, right, bottom] = AREA_MM;
    let count = scene.diagrams.len().max(1) as f64;
    let high = (bottom - top - GAP_MM * (count - 1.0)) / count;
    let last = scene
        .diagrams
        .iter()
        .flat_map(|diagram| diagram.before.last().into_iter().chain(diagram.after.last()));
    let duration = last.map(|[t, _]| *t).fold(0.0, f64::max);
    for (k, diagram) in scene.diagrams.iter().enumerate() {
        let frame = [left, top + (high + GAP_MM) * k as f64, right - left, high];
        let is_lowest = k + 1 == scene.diagrams.len();
        out += &draw(diagram, frame, duration, is_lowest);
    }
    out += &self::column(scene);
    out + "</svg>\n"
}

fn draw(diagram: &Diagram, frame: [f64; 4], duration: f64, is_lowest: bool) -> String {
    let [left, top, width, height] = frame;
    let mut out =
        format!("<g class=\"diagram\">\n{}", axes::text_at("head", left, top - 1.2, &escape(&diagram.name)));
    let values = Range::of(diagram);
    if let Some(values) = values.filter(|_| duration > 0.0 && duration.is_finite()) {
        let x = |t: f64| left + width * t / duration;
        let y = |value: f64| top + height * (1.0 - values.part(value));
        let mut grid = String::new();
        for value in ticks(values.low, values.high, INTERVALS) {
            grid += &format!("M{} {}H{}", fixed(left + width), fixed(y(value.0)), fixed(left - TICK_MM));
            out += &axes::number_beside(left - TICK_MM - 0.5, y(value.0) + text::SIZE_MM / 3.0, &value.1);
        }
        for time in ticks(0.0, duration, 2.0 * INTERVALS) {
            let end = top + height + if is_lowest { TICK_MM } else { 0.0 };
            grid += &format!("M{} {}V{}", fixed(x(time.0)), fixed(top), fixed(end));
            if is_lowest {
                out += &axes::text_at("middle", x(time.0), end + text::SIZE_MM, &time.1);
            }
        }
        out += &format!("<path class=\"grid\" d=\"{grid}\"/>\n");
        for (class, course) in [("before", &diagram.before), ("after", &diagram.after)] {
            let line = line(course, |[t, value]| [x(t), y(value)]);
            if !line.is_empty() {
                out += &format!("<path class=\"{class}\" d=\"{line}\"/>\n");
            }
        }
        if is_lowest {
            out += &axes::text_at("axis right", left + width - 0.8, top + height - 1.0, "time, s");
        }
    }
    let frame = frame.map(fixed);
    out + &format!(
        "<rect class=\"frame\" x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\"/>\n</g>\n",
        frame[0], frame[1], frame[2], frame[3]
    )
}

/// The values that a diagram shows.
#[derive(Debug, Clone, Copy)]
struct Range {
    low: f64,
    high: f64,
}

impl Range {
    fn of(diagram: &Diagram) -> Option<Self> {
        let of = |course: &[[f64; 2]]| {
            let values = course.iter().map(|[_, value]| *value);
            let low = values.clone().fold(f64::INFINITY, f64::min);
            let high = values.fold(f64::NEG_INFINITY, f64::max);
            (low.is_finite() && high.is_finite()).then_some(Self { low, high })
        };
        let after = of(&diagram.after)?;
        let before = of(&diagram.before).unwrap_or(after);
        let beyond = BEYOND * (after.high - after.low);
        let low = after.low.min(before.low.max(after.low - beyond));
        let high = after.high.max(before.high.min(after.high + beyond));
        // A line at the frame would not be seen; a value that does not change gets some room.
        let room = if high - low > ONE_VALUE * high.abs().max(low.abs()) {
            ROOM * (high - low)
        } else {
            1.0_f64.max(ROOM_OF_ONE * high.abs())
        };
        Some(Self { low: low - room, high: high + room })
    }

    /// The place of a value from the lower edge, 0, to the upper edge, 1.
    fn part(&self, value: f64) -> f64 {
        ((value - self.low) / (self.high - self.low)).clamp(0.0, 1.0)
    }
}

/// The numbers of an axis from `low` to `high`, with at least so many intervals between them.
fn ticks(low: f64, high: f64, intervals: f64) -> Vec<(f64, String)> {
    let mut step = RoundNumber::at_least((high - low) / intervals);
    if step.value() * intervals > 1.001 * (high - low) {
        step = step.previous();
    }
    let first = (low / step.value()).ceil();
    let count = ((high / step.value()).floor() - first).max(0.0) as usize;
    let value = |k: usize| step.times(first + k as f64);
    (0..=count).map(|k| (value(k), with_decimals(value(k), step.decimals()))).collect()
}

/// Thins a course: divides its time into about `most` equal parts, and keeps the least and the largest value
/// of each part. A course of at most `2 * most` values stays as it is.
pub fn thinned(course: &[[f64; 2]], most: usize) -> Vec<[f64; 2]> {
    match course.last() {
        Some([end, _]) if course.len() > 2 * most => extremes(course.iter().copied(), end / most as f64),
        _ => course.to_vec(),
    }
}

/// Of each column of the width the places with the least and the largest second coordinate.
fn extremes(places: impl Iterator<Item = [f64; 2]>, width: f64) -> Vec<[f64; 2]> {
    let mut kept: Vec<[f64; 2]> = Vec::new();
    let mut column: Vec<[f64; 2]> = Vec::new();
    let mut of = f64::NEG_INFINITY;
    for at in places {
        let own = (at[0] / width).floor();
        if own > of {
            flush(&mut column, &mut kept);
            of = own;
        }
        column.push(at);
    }
    flush(&mut column, &mut kept);
    kept
}

/// The path data of a course. Of each column of the paper it holds the least and the largest value.
fn line(course: &[[f64; 2]], place: impl Fn([f64; 2]) -> [f64; 2]) -> String {
    let kept = extremes(course.iter().map(|own| place(*own)), COLUMN_MM);
    let mut data = String::new();
    for (k, [x, y]) in kept.iter().enumerate() {
        data += &format!("{}{} {}", if k == 0 { "M" } else { "L" }, fixed(*x), fixed(*y));
    }
    data
}

/// Moves the least and the largest point of a column to `kept`, in order of time.
fn flush(column: &mut Vec<[f64; 2]>, kept: &mut Vec<[f64; 2]>) {
    let by_value = |a: &&[f64; 2], b: &&[f64; 2]| a[1].total_cmp(&b[1]);
    let ends = column.iter().min_by(by_value).zip(column.iter().max_by(by_value));
    if let Some((low, high)) = ends {
        let (first, second) = if low[0] <= high[0] { (low, high) } else { (high, low) };
        kept.push(*first);
        if first != second {
            kept.push(*second);
        }
    }
    column.clear();
}

/// The column of a sheet of diagrams: what its lines are, the notes, and the title with the largest values.
fn column(scene: &DiagramScene) -> String {
    let mut out = column::line("head", LEFT_MM, TOP_MM, "Legend");
    let mut y = TOP_MM;
    for (class, label) in [("before", scene.before), ("after", scene.after)] {
        y += LEGEND_LINE_MM;
        let (x, middle) = (fixed(LEFT_MM), fixed(y - text::SIZE_MM / 3.0));
        out += &format!("<path class=\"{class}\" d=\"M{x} {middle}h{SAMPLE_MM}\"/>\n");
        out += &column::line("", LEFT_MM + SAMPLE_MM + 3.0, y, &escape(label));
    }
    out += &column::notes(
        Texts { warnings: scene.warnings, notes: scene.notes },
        None,
        y + 2.0 * LEGEND_LINE_MM,
    );
    out += &column::title(scene.title);
    let largest = |course: &[[f64; 2]]| course.iter().map(|[_, value]| value.abs()).fold(0.0, f64::max);
    let mut y = BLOCK_Y_MM + 18.0;
    let mut row = |class: &str, cells: [&str; 3]| {
        out += &column::line(class, LEFT_MM, y, cells[0]);
        for (k, cell) in cells[1..].iter().enumerate() {
            out += &column::line(
                &format!("{class} right"),
                LEFT_MM + WIDTH_MM - 18.0 * (1.0 - k as f64),
                y,
                cell,
            );
        }
        y += LINE_MM;
    };
    row("head", ["largest", "before", "after"]);
    for diagram in scene.diagrams {
        let [before, after] = [&diagram.before, &diagram.after].map(|course| short(largest(course)));
        row("", [&escape(&diagram.name), &before, &after]);
    }
    out
}

/// A number with at least four digits.
fn short(value: f64) -> String {
    with_decimals(
        value,
        if value < 10.0 {
            3
        } else if value < 1000.0 {
            1
        } else {
            0
        },
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wave(count: usize, height: f64) -> Vec<[f64; 2]> {
        (0..=count).map(|k| [k as f64 * 1e-3, height * (k as f64 * 0.01).sin()]).collect()
    }

    fn sheet(diagrams: &[Diagram]) -> String {
        let notes = ["a note".to_owned()];
        svg(&DiagramScene {
            title: "Part <1>",
            notes: &notes,
            warnings: &[],
            diagrams,
            before: "given",
            after: "smooth",
        })
    }

    #[test]
    fn a_course_of_few_values_is_drawn_point_by_point() {
        let diagram = Diagram {
            name: "feed, mm/min".into(),
            before: Vec::new(),
            after: vec![[0.0, 0.0], [1.0, 10.0], [2.0, 5.0]],
        };
        let sheet = sheet(&[diagram]);
        assert!(sheet.contains("d=\"M24 188.96L120 21.04L216 105\""), "{sheet}");
        assert!(sheet.contains("Part &lt;1&gt;") && sheet.contains(">feed, mm/min<"));
    }

    #[test]
    fn long_motions_stay_small_and_keep_their_peaks() {
        let mut after = wave(300_000, 2.0);
        after[123_456][1] = 5.0;
        let diagram = Diagram { name: "jerk".into(), before: wave(300_000, 90.0), after };
        let sheet = sheet(&vec![diagram; 5]);
        assert!(sheet.len() < 1_200_000, "{}", sheet.len());
        // A quarter more for the other course, and 3 % of all that.
        let range = Range { low: -3.75 - 0.03 * 10.5, high: 6.75 + 0.03 * 10.5 };
        let y = 16.0 + 30.0 * (1.0 - range.part(5.0));
        assert!(sheet.contains(&format!(" {}L", fixed(y))), "{y}");
    }

    #[test]
    fn a_diagram_without_values_or_change_is_drawn() {
        let still = Diagram { name: "C".into(), before: Vec::new(), after: vec![[0.0, 3.0], [1.0, 3.0]] };
        let empty = Diagram::default();
        let endless = Diagram { after: vec![[0.0, f64::NAN]], ..Diagram::default() };
        let sheet = sheet(&[still, empty, endless]);
        assert!(!sheet.contains("NaN") && !sheet.contains("inf"), "{sheet}");
        // One in the legend.
        assert_eq!(sheet.matches("class=\"after\"").count(), 2);
    }
}

//! Draws times as bars, on SVG sheets: A4 landscape. A chart compares several ways to do the same work.
//!
//! # Method
//! A sheet has up to six charts, in a grid; more charts go on further sheets. All charts of the same
//! group share one scale, so that their bars can be compared. A bar has two parts, one after the other. A
//! bar that is not valid has an outline only, with the reason in it.
//!
//! # Guarantees
//! * There are at most [`MOST_CHARTS`] charts; the sheet says how many more are left out.
//! * The same content gives the same bytes. Texts of the caller appear as text only, never as markup.
//!
//! # Degenerate input
//! A time that is negative or not finite has no bar. A chart without bars has its caption alone.
//!
//! # Cost
//! O(n) for n bars.

use super::axes::text_at;
use super::column::{self, LEFT_MM, LEGEND_LINE_MM, SAMPLE_MM, TOP_MM, Texts};
use super::number::{RoundNumber, fixed, with_decimals};
use super::text::{self, SIZE_MM, clean, escape};

/// Most charts that are drawn: eight sheets.
pub const MOST_CHARTS: usize = 48;

/// Charts beside each other and below each other on a sheet.
const COLUMNS: usize = 2;
const ROWS: usize = 3;

/// The area of the charts: left, top, right, bottom; mm of paper.
const AREA_MM: [f64; 4] = [12.0, 12.0, 216.0, 198.0];
/// Distance between charts beside each other, mm of paper.
const GAP_MM: f64 = 6.0;

/// Distance from bar to bar, and the height of a bar, mm of paper.
const PITCH_MM: f64 = 5.6;
const BAR_MM: f64 = 3.6;
/// The most bars of a chart: more would reach into the chart below.
const MOST_BARS: usize = 8;

/// The width of the names, mm of paper, and of the times behind the longest bar.
const NAMES_MM: f64 = 36.0;
const TIMES_MM: f64 = 27.0;

/// The fewest intervals between the numbers of an axis.
const INTERVALS: f64 = 3.0;

const STYLE: &str = ".plot .first{fill:#0072b2}.plot .second{fill:#a6cbe3}\
     .plot .invalid{fill:#fff;stroke:#8a8a8a;stroke-width:.2;stroke-dasharray:.9 .6}\
     .plot .reason{fill:#8a2d00}.plot .mark{fill:#000;stroke:none}";

/// What a bar stands for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    Usual,
    /// It is taken.
    Chosen,
    /// It cannot be taken.
    Invalid,
}

/// One bar.
#[derive(Debug, Clone, PartialEq)]
pub struct Bar {
    pub name: String,
    /// The times of both parts, s; none where there is nothing to draw.
    pub times_s: Option<[f64; 2]>,
    /// What stands behind the time, or why the bar is not valid.
    pub remark: String,
    pub kind: Kind,
}

/// Bars below each other.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct BarChart {
    pub name: String,
    /// Which time it is, with its unit.
    pub axis: String,
    pub bars: Vec<Bar>,
    /// Charts with the same number share one scale.
    pub group: usize,
}

/// What sheets of bars show.
#[derive(Debug, Clone, Copy)]
pub struct BarScene<'a> {
    pub title: &'a str,
    /// Lines beside the charts.
    pub notes: &'a [String],
    /// Warnings above the notes.
    pub warnings: &'a [String],
    pub charts: &'a [BarChart],
    /// What both parts of a bar are.
    pub parts: [&'a str; 2],
}

impl Bar {
    /// The times of both parts, s, as far as they can be drawn.
    fn times(&self) -> Option<[f64; 2]> {
        self.times_s.filter(|[first, second]| (first + second).is_finite() && first.min(*second) >= 0.0)
    }

    fn whole_s(&self) -> f64 {
        self.times().map_or(0.0, |[first, second]| first + second)
    }
}

/// Draws the sheets as SVG documents, one after the other.
pub fn svg(scene: &BarScene) -> String {
    let shown = &scene.charts[..scene.charts.len().min(MOST_CHARTS)];
    let left_out = scene.charts.len() - shown.len();
    let n_sheets = shown.len().div_ceil(COLUMNS * ROWS);
    let sheet = |(k, charts): (usize, &[BarChart])| {
        let mut last = if n_sheets > 1 { format!("Sheet {} of {n_sheets}.", k + 1) } else { String::new() };
        if k + 1 == n_sheets && left_out > 0 {
            last += &format!(" {left_out} more charts are left out.");
        }
        let drawn = charts.iter().enumerate().map(|(place, chart)| {
            let longest_s = longest_s(shown, chart.group);
            draw(chart, frame(place, charts.len()), longest_s)
        });
        super::opening(scene.title, "times as bars", STYLE)
            + &drawn.collect::<String>()
            + &column(scene, Some(last.trim()).filter(|last| !last.is_empty()))
            + "</svg>\n"
    };
    shown.chunks(COLUMNS * ROWS).enumerate().map(sheet).collect()
}

/// The longest bar of a group, s.
fn longest_s(charts: &[BarChart], group: usize) -> f64 {
    let bars = charts.iter().filter(|chart| chart.group == group).flat_map(|chart| &chart.bars);
    bars.map(Bar::whole_s).fold(0.0, f64::max)
}

/// The left end, the top and the width of the chart at a place, mm of paper. Few charts have the whole width.
fn frame(place: usize, count: usize) -> [f64; 3] {
    let [left, top, right, bottom] = AREA_MM;
    let columns = if count > ROWS { COLUMNS } else { 1 };
    let width = (right - left - GAP_MM * (columns - 1) as f64) / columns as f64;
    let height = (bottom - top) / ROWS as f64;
    let (column, row) = (place % columns, place / columns);
    [left + (width + GAP_MM) * column as f64, top + height * row as f64, width]
}

fn draw(chart: &BarChart, [left, top, width]: [f64; 3], longest_s: f64) -> String {
    let bars = &chart.bars[..chart.bars.len().min(MOST_BARS)];
    let axis = clean(&chart.axis);
    let name = text::cut(&clean(&chart.name), width / SIZE_MM - text::width(&axis) - 1.0);
    let mut out = format!(
        "<g class=\"chart\">\n{}{}",
        text_at("head", left, top, &escape(&name)),
        text_at("right", left + width, top, &escape(&axis))
    );
    let (start, room) = (left + NAMES_MM, width - NAMES_MM - TIMES_MM);
    let top = top + 2.0;
    let scale = if longest_s > 0.0 { room / longest_s } else { 0.0 };
    if !bars.is_empty() && scale > 0.0 {
        out += &grid([start, top, room], PITCH_MM * bars.len() as f64, longest_s);
    }
    for (k, bar) in bars.iter().enumerate() {
        out += &draw_bar(bar, [left, top + PITCH_MM * k as f64, width], scale);
    }
    out + "</g>\n"
}

/// The lines of the grid with their times below, down to `height` below the top.
fn grid([left, top, width]: [f64; 3], height: f64, longest_s: f64) -> String {
    let mut step = RoundNumber::at_least(longest_s / INTERVALS);
    if step.value() * INTERVALS > 1.001 * longest_s {
        step = step.previous();
    }
    let (bottom, count) = (top + height, (longest_s / step.value()).floor());
    let mut out = String::new();
    let mut lines = String::new();
    for k in 0..=count as usize {
        let value = step.times(k as f64);
        let x = left + width * value / longest_s;
        lines += &format!("M{} {}V{}", fixed(x), fixed(top), fixed(bottom + 1.0));
        out += &text_at("middle", x, bottom + 1.0 + SIZE_MM, &with_decimals(value, step.decimals()));
    }
    format!("<path class=\"grid\" d=\"{lines}\"/>\n{out}")
}

fn draw_bar(bar: &Bar, [left, top, width]: [f64; 3], scale: f64) -> String {
    let start = left + NAMES_MM;
    let middle = top + 0.5 * PITCH_MM;
    let base = middle + SIZE_MM / 3.0;
    let class = if bar.kind == Kind::Chosen { "head" } else { "name" };
    let name = text::cut(&clean(&bar.name), (NAMES_MM - 4.0) / SIZE_MM);
    let mut out = text_at(class, left + 3.0, base, &escape(&name));
    if bar.kind == Kind::Chosen {
        let (x, y) = (fixed(left), fixed(middle - 1.1));
        out += &format!("<path class=\"mark\" d=\"M{x} {y}l1.9 1.1l-1.9 1.1z\"/>\n");
    }
    let rect = |class: &str, x: f64, long: f64| {
        let [x, y, long, high] = [x, middle - 0.5 * BAR_MM, long, BAR_MM].map(fixed);
        format!("<rect class=\"{class}\" x=\"{x}\" y=\"{y}\" width=\"{long}\" height=\"{high}\"/>\n")
    };
    let long = bar.whole_s() * scale;
    let time = bar.times().map(|_| time(bar.whole_s()));
    let words = [time, Some(bar.remark.clone()).filter(|remark| !remark.is_empty())];
    let words = clean(&words.into_iter().flatten().collect::<Vec<_>>().join(", "));
    if bar.kind == Kind::Invalid {
        if bar.times().is_some() {
            out += &rect("invalid", start, long);
        }
        let words = text::cut(&words, (left + width - start - 1.0) / SIZE_MM);
        return out + &text_at("reason", start + 1.0, base, &escape(&words));
    }
    if let Some([first, second]) = bar.times() {
        out += &rect("first", start, first * scale);
        out += &rect("second", start + first * scale, second * scale);
    }
    let words = text::cut(&words, (left + width - start - long - 1.0) / SIZE_MM);
    out + &text_at(class, start + long + 1.0, base, &escape(&words))
}

/// A time for people: `12.3 s`, `4:05 min` or `1:02:03 h`.
fn time(seconds: f64) -> String {
    let whole = seconds.round();
    let part = |size: f64, of: f64| (whole / size).floor() % of;
    if seconds < 100.0 {
        format!("{seconds:.1} s")
    } else if whole < 3600.0 {
        format!("{:.0}:{:02.0} min", part(60.0, 60.0), part(1.0, 60.0))
    } else {
        format!("{:.0}:{:02.0}:{:02.0} h", part(3600.0, f64::INFINITY), part(60.0, 60.0), part(1.0, 60.0))
    }
}

/// The column of a sheet: what the parts of bars are, the notes, and the title.
fn column(scene: &BarScene, last: Option<&str>) -> String {
    let mut out = column::line("head", LEFT_MM, TOP_MM, "Legend");
    let mut y = TOP_MM;
    let [first, second] = scene.parts;
    for (class, label) in [("first", first), ("second", second), ("invalid", "not valid, with the reason")] {
        y += LEGEND_LINE_MM;
        let [x, top, high] = [LEFT_MM, y - SIZE_MM, 0.8 * BAR_MM].map(fixed);
        out += &format!(
            "<rect class=\"{class}\" x=\"{x}\" y=\"{top}\" width=\"{SAMPLE_MM}\" height=\"{high}\"/>\n"
        );
        out += &column::line("", LEFT_MM + SAMPLE_MM + 3.0, y, &escape(label));
    }
    y += LEGEND_LINE_MM;
    let [x, top] = [LEFT_MM + 0.5 * SAMPLE_MM - 1.0, y - SIZE_MM].map(fixed);
    out += &format!("<path class=\"mark\" d=\"M{x} {top}l1.9 1.1l-1.9 1.1z\"/>\n");
    out += &column::line("", LEFT_MM + SAMPLE_MM + 3.0, y, "chosen");
    out + &column::notes(
        Texts { warnings: scene.warnings, notes: scene.notes },
        last,
        y + 2.0 * LEGEND_LINE_MM,
    ) + &column::title(scene.title)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bar(name: &str, times_s: Option<[f64; 2]>, remark: &str, kind: Kind) -> Bar {
        Bar { name: name.into(), times_s, remark: remark.into(), kind }
    }

    fn chart(bars: Vec<Bar>) -> BarChart {
        BarChart { name: "Level <1>".into(), axis: "time, s".into(), bars, group: 0 }
    }

    fn sheets(charts: &[BarChart]) -> String {
        svg(&BarScene {
            title: "Part",
            notes: &["a note".to_owned()],
            warnings: &[],
            charts,
            parts: ["cutting", "rapids"],
        })
    }

    #[test]
    fn both_parts_of_a_bar_are_as_long_as_their_times() {
        let bars = vec![
            bar("a", Some([30.0, 10.0]), "", Kind::Usual),
            bar("b", Some([20.0, 10.0]), "", Kind::Chosen),
        ];
        let sheet = sheets(&[chart(bars)]);
        // The longest bar fills the room between names and times.
        let room = AREA_MM[2] - AREA_MM[0] - NAMES_MM - TIMES_MM;
        for (class, part) in [("first", 0.75), ("second", 0.25), ("first", 0.5), ("second", 0.25)] {
            let width = format!("width=\"{}\"", fixed(part * room));
            let found =
                sheet.lines().any(|line| line.contains(&format!("\"{class}\"")) && line.contains(&width));
            assert!(found, "{class} {width}\n{sheet}");
        }
        for text in [">Level &lt;1&gt;<", ">time, s<", ">40.0 s<", ">a note<"] {
            assert!(sheet.contains(text), "{text}\n{sheet}");
        }
        // One in the legend.
        assert_eq!(sheet.matches("class=\"mark\"").count(), 2);
    }

    #[test]
    fn charts_of_one_group_share_a_scale() {
        let long = chart(vec![bar("a", Some([40.0, 0.0]), "", Kind::Usual)]);
        let short = chart(vec![bar("a", Some([10.0, 0.0]), "", Kind::Usual)]);
        let other = BarChart { group: 1, ..short.clone() };
        let sheet = sheets(&[long, short, other]);
        let room = AREA_MM[2] - AREA_MM[0] - NAMES_MM - TIMES_MM;
        let bars = |long: f64| {
            let width = format!("width=\"{}\"", fixed(long));
            sheet.lines().filter(|line| line.contains("\"first\"") && line.contains(&width)).count()
        };
        assert_eq!([bars(room), bars(0.25 * room)], [2, 1]);
    }

    #[test]
    fn what_is_not_valid_has_its_reason_and_no_time_is_not_a_bar() {
        let bars = vec![
            bar("a", Some([30.0, 1.0]), "it leaves 3 mm2 & more", Kind::Invalid),
            bar("b", None, "no room", Kind::Invalid),
            bar("c", Some([f64::NAN, 1.0]), "", Kind::Usual),
            bar("d", Some([1.0, f64::INFINITY]), "", Kind::Usual),
        ];
        let sheet = sheets(&[chart(bars), chart(Vec::new())]);
        assert!(sheet.contains(">31.0 s, it leaves 3 mm2 &amp; more<") && sheet.contains(">no room<"));
        assert!(!sheet.contains("NaN") && !sheet.contains("inf"), "{sheet}");
        // One in the legend.
        assert_eq!(sheet.matches("class=\"invalid\"").count(), 2);
        assert_eq!(sheet.matches("class=\"first\"").count(), 1);
    }

    #[test]
    fn many_charts_take_several_sheets_and_the_rest_is_counted() {
        let one = chart(vec![bar("a", Some([30.0, 1.0]), "", Kind::Usual)]);
        let sheet = sheets(&vec![one; MOST_CHARTS + 5]);
        assert_eq!(sheet.matches("<svg").count(), MOST_CHARTS.div_ceil(COLUMNS * ROWS));
        assert_eq!(sheet.matches("class=\"chart\"").count(), MOST_CHARTS);
        assert!(sheet.contains("5 more charts are left out."));
        assert_eq!(svg(&BarScene { title: "", notes: &[], warnings: &[], charts: &[], parts: ["", ""] }), "");
    }

    #[test]
    fn times_are_written_for_people() {
        for (seconds, words) in [
            (12.34, "12.3 s"),
            (99.94, "99.9 s"),
            (245.4, "4:05 min"),
            (3599.6, "1:00:00 h"),
            (3723.0, "1:02:03 h"),
        ] {
            assert_eq!(time(seconds), words);
        }
    }
}

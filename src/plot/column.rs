//! The column beside the views: legend, notes, and the title block with bounds, moves and scale.

use nalgebra::{Point2, Vector2};

use super::SHEET_MM;
use super::class::Class;
use super::layout::{BORDER_MM, COLUMN_X_MM, Layout, Projection};
use super::number::{RoundNumber, fixed, with_decimals};
use super::text::{self, SIZE_MM, TITLE_SIZE_MM, escape};
use super::{Scene, marks, relief};
use toolpathd_core::toolpath::measure::measure;
use toolpathd_core::toolpath::units::FeedRate;

/// The left end and the width of the column's text.
pub const LEFT_MM: f64 = COLUMN_X_MM + 4.0;
pub const WIDTH_MM: f64 = BORDER_MM[2] - 4.0 - LEFT_MM;
/// The top of the title block.
pub const BLOCK_Y_MM: f64 = 141.0;
/// The top of the column's text.
pub const TOP_MM: f64 = BORDER_MM[1] + 6.0;
/// Distance between lines of text.
pub const LINE_MM: f64 = 4.0;
pub const LEGEND_LINE_MM: f64 = 4.8;
/// Length of the sample strokes in the legend.
pub const SAMPLE_MM: f64 = 13.0;
/// Most lines of one note; a warning has as many as it needs.
const LINES_A_NOTE: usize = 2;
/// Sizes of the text of notes, mm of paper, with their classes. The largest size is taken at which all
/// warnings fit, with some lines of other notes. The smallest size can still be read on paper.
const NOTE_SIZES: [(f64, &str); 4] = [(SIZE_MM, ""), (2.1, "small"), (1.8, "smaller"), (1.5, "smallest")];
/// Lines of other notes that are told beside warnings: what a setter needs.
const LINES_BESIDE_WARNINGS: usize = 10;
/// Width of a number in the table of bounds.
const NUMBER_MM: f64 = 18.5;
/// Greatest length of the scale bar.
const BAR_MM: f64 = 30.0;

/// The white sheet, its border, and the lines around the column and the title block.
pub fn border() -> String {
    let [left, top, right, bottom] = BORDER_MM.map(fixed);
    let [width, height] = SHEET_MM;
    let (column, block) = (fixed(COLUMN_X_MM), fixed(BLOCK_Y_MM));
    format!(
        "<rect class=\"sheet\" width=\"{width}\" height=\"{height}\"/>\n\
         <path d=\"M{left} {top}H{right}V{bottom}H{left}ZM{column} {top}V{bottom}M{column} {block}H{right}\"/>\n"
    )
}

/// Legend, notes and title block. `raster_mm` is the cell size of the raster if strokes were left out.
pub fn draw(scene: &Scene, layout: &Layout, used: &[Class], raster_mm: Option<f64>) -> String {
    let left_out = raster_mm.map(|mm| format!("Strokes within {mm} mm of others on paper are left out."));
    let (legend, below) = legend(scene, used, layout.projection);
    legend
        + &notes(scene.texts(), left_out.as_deref(), below)
        + &title(scene.title)
        + &bounds(layout)
        + &moves(scene)
        + &scale(layout.scale, layout.projection)
}

/// The column of a sheet without a drawing.
pub fn refusal(scene: &Scene, reason: &str) -> String {
    notes(scene.texts(), None, TOP_MM)
        + &title(scene.title)
        + &moves(scene)
        + &line("middle", 0.5 * (BORDER_MM[0] + COLUMN_X_MM), 0.5 * (BORDER_MM[1] + BORDER_MM[3]), reason)
}

/// The legend, and the place of its lower end, mm of paper.
fn legend(scene: &Scene, used: &[Class], projection: Projection) -> (String, f64) {
    let mut out = line("head", LEFT_MM, TOP_MM, "Legend");
    let mut y = TOP_MM;
    let mut entry = |sample: &dyn Fn(f64) -> String, label: &str| {
        y += LEGEND_LINE_MM;
        out += &sample(y - SIZE_MM / 3.0);
        out += &line("", LEFT_MM + SAMPLE_MM + 3.0, y, label);
    };
    for class in used {
        let stroke = |y: f64| {
            format!("<path class=\"{}\" d=\"M{} {}h{SAMPLE_MM}\"/>\n", class.name(), fixed(LEFT_MM), fixed(y))
        };
        entry(&stroke, class.label());
    }
    if scene.toolpath.is_some() {
        let middle = |y: f64| Point2::new(LEFT_MM + 0.5 * SAMPLE_MM, y);
        entry(&|y| marks::datum(middle(y)), "zero");
        entry(&|y| marks::start(middle(y)), "start");
        entry(&|y| marks::cross(middle(y)), "end");
        let is_drilled = scene.toolpath.is_some_and(|path| !marks::places_of_holes(path).is_empty());
        if projection == Projection::FirstAngle && is_drilled {
            entry(&|y| marks::hole(middle(y)), "hole");
        }
        let cuts = [Class::CutLine, Class::CutArc, Class::CutParabola];
        if projection == Projection::FirstAngle && cuts.iter().any(|class| used.contains(class)) {
            entry(&|y| marks::arrow(middle(y), Vector2::x()), "direction of the cut");
        }
    }
    if let Some(mesh) = &scene.drawing.relief {
        y += 1.4 * LEGEND_LINE_MM;
        out += &line("", LEFT_MM, y, "height z of the surface, mm");
        let (bar, height) = relief::legend(mesh.points(), [LEFT_MM, y + 1.2, WIDTH_MM]);
        out += &bar;
        y += 1.2 + height;
    }
    (out, y + 2.0 * LEGEND_LINE_MM)
}

/// The texts beside a drawing.
#[derive(Debug, Clone, Copy)]
pub struct Texts<'a> {
    /// They are told whole.
    pub warnings: &'a [String],
    pub notes: &'a [String],
}

/// The notes from `y` down to the title block: first the warnings. The line `last` always has a place.
pub fn notes(texts: Texts, last: Option<&str>, y: f64) -> String {
    let set = |(size_mm, class)| Setting::of(texts, last, y, (size_mm, class));
    let [larger @ .., smallest] = NOTE_SIZES;
    let setting = larger.into_iter().map(set).find(|setting| setting.is_enough);
    setting.unwrap_or_else(|| set(smallest)).draw(y)
}

/// Notes as lines of one size of text.
struct Setting {
    class: &'static str,
    /// Distance between lines.
    line_mm: f64,
    lines: Vec<String>,
    /// Lines that have a place below the others.
    last: Vec<String>,
    /// Most lines beside the last ones.
    room: usize,
    /// Whether the warnings and some other notes fit.
    is_enough: bool,
}

impl Setting {
    fn of(texts: Texts, last: Option<&str>, y: f64, (size_mm, class): (f64, &'static str)) -> Self {
        let Texts { warnings, notes } = texts;
        let wrapped = |text: &str, most: usize| text::wrap(&text::clean(text), WIDTH_MM / size_mm, most);
        let line_mm = LINE_MM * size_mm / SIZE_MM;
        let last = last.map(|text| wrapped(text, LINES_A_NOTE)).unwrap_or_default();
        let room = (((BLOCK_Y_MM - LINE_MM - y) / line_mm) as usize).saturating_sub(last.len());
        let mut lines: Vec<String> = warnings.iter().flat_map(|text| wrapped(text, usize::MAX)).collect();
        let n_warnings = lines.len();
        lines.extend(notes.iter().take(room + 1).flat_map(|text| wrapped(text, LINES_A_NOTE)));
        let is_enough = n_warnings == 0 || lines.len().min(n_warnings + LINES_BESIDE_WARNINGS) <= room;
        Self { class, line_mm, lines, last, room, is_enough }
    }

    fn draw(mut self, y: f64) -> String {
        if self.lines.len() > self.room {
            self.lines.truncate(self.room.saturating_sub(1));
            self.lines.push("\u{2026}".into());
        }
        self.lines.extend(self.last);
        if self.lines.is_empty() {
            return String::new();
        }
        let rows = (1_u16..).zip(&self.lines);
        let at = |k: u16| y + LINE_MM + self.line_mm * f64::from(k - 1);
        let text: String = rows.map(|(k, text)| line(self.class, LEFT_MM, at(k), &escape(text))).collect();
        line("head", LEFT_MM, y, "Notes") + &text
    }
}

pub fn title(title: &str) -> String {
    let lines = text::wrap(&text::clean(title), WIDTH_MM / TITLE_SIZE_MM / 1.1, 2);
    let rows = lines.iter().enumerate();
    rows.map(|(k, text)| line("title", LEFT_MM, BLOCK_Y_MM + 6.5 + 5.3 * k as f64, &escape(text))).collect()
}

/// A table of the least, the largest and the difference of each coordinate.
fn bounds(layout: &Layout) -> String {
    let (min, max) = (layout.bounds.min, layout.bounds.max);
    let row = |y: f64, class: &str, cells: [&str; 4]| -> String {
        let numbers = cells[1..].iter().enumerate();
        let numbers = numbers
            .map(|(k, cell)| line(&format!("{class} right"), LEFT_MM + 20.0 * (k as f64 + 1.0), y, cell));
        line(class, LEFT_MM, y, cells[0]) + &numbers.collect::<String>()
    };
    let y = BLOCK_Y_MM + 18.0;
    // Show micrometres, or one decimal more than the ticks if that is finer, as far as there is room.
    let widest = -min.coords.amax().max(max.coords.amax());
    let fits = |decimals: &usize| text::width(&with_decimals(widest, *decimals)) * SIZE_MM < NUMBER_MM;
    let decimals = (0..=layout.step.decimals().max(2) + 1).rev().find(fits).unwrap_or(0);
    let mut out = row(y, "head", ["mm", "min", "max", "extent"]);
    for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
        let [low, high, extent] =
            [min[axis], max[axis], max[axis] - min[axis]].map(|mm| with_decimals(mm, decimals));
        out += &row(y + LINE_MM * (axis as f64 + 1.0), "", [name, &low, &high, &extent]);
    }
    out
}

fn moves(scene: &Scene) -> String {
    let Some(toolpath) = scene.toolpath else { return String::new() };
    // Any feed rate gives the same counts of moves.
    let counts = measure(toolpath, FeedRate::DEFAULT_RAPID).moves;
    let mut words = format!("Moves: {} rapid, {} line, {} arc", counts.rapid, counts.line, counts.arc);
    if counts.parabola > 0 {
        words += &format!(", {} parabola", counts.parabola);
    }
    line("", LEFT_MM, BLOCK_Y_MM + 37.0, &words)
}

/// The stated scale, a bar that stays true when the print is enlarged or reduced, and the projection. An
/// isometric view has the scale along the axes.
fn scale(scale: RoundNumber, projection: Projection) -> String {
    let (words, symbol) = match projection {
        Projection::FirstAngle => {
            ("A4, first angle", first_angle(Point2::new(LEFT_MM + WIDTH_MM - 14.0, BLOCK_Y_MM + 46.5)))
        }
        Projection::Isometric => ("A4, along the axes", String::new()),
    };
    let mut length = RoundNumber::at_least(BAR_MM / scale.value());
    while length.value() * scale.value() > BAR_MM {
        length = length.previous();
    }
    let bar = length.value() * scale.value();
    let (x, y) = (LEFT_MM, BLOCK_Y_MM + 49.0);
    let half = fixed(0.5 * bar);
    format!(
        "{}{}<path d=\"M{} {}h{}v1.6h-{}z\"/>\n<rect x=\"{}\" y=\"{}\" width=\"{half}\" height=\"1.6\"/>\n{}{}{}",
        line("title", x, BLOCK_Y_MM + 45.0, &format!("Scale {}", scale.as_scale())),
        line("right", LEFT_MM + WIDTH_MM, y + 5.0, words),
        fixed(x),
        fixed(y),
        fixed(bar),
        fixed(bar),
        fixed(x),
        fixed(y),
        line("", x, y + 5.0, "0"),
        line("middle", x + bar, y + 5.0, &format!("{} mm", with_decimals(length.value(), length.decimals()))),
        symbol,
    )
}

/// The symbol of first-angle projection: a cone from its side and, to the right of it, from its left end.
fn first_angle(at: Point2<f64>) -> String {
    let circle = |r: f64| {
        format!("<circle class=\"frame\" cx=\"{}\" cy=\"{}\" r=\"{r}\"/>", fixed(at.x + 11.0), fixed(at.y))
    };
    let (x, y) = (fixed(at.x), fixed(at.y - 1.5));
    format!("<path d=\"M{x} {y}l6 -1.5v6l-6 -1.5z\"/>\n{}{}\n", circle(1.5), circle(3.0))
}

pub fn line(class: &str, x: f64, y: f64, words: &str) -> String {
    let class = if class.is_empty() { String::new() } else { format!(" class=\"{}\"", class.trim()) };
    format!("<text{class} x=\"{}\" y=\"{}\">{words}</text>\n", fixed(x), fixed(y))
}

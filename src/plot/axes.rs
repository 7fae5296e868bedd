//! The frame of a view: a grid at round steps, with numbers, caption and names of axes.

use super::layout::Layout;
use super::number::{RoundNumber, fixed, with_decimals};
use super::text;
use super::view::View;

const NAMES: [&str; 3] = ["x", "y", "z"];

/// How far a tick reaches out of the frame, mm of paper.
const TICK_MM: f64 = 1.2;
/// Width of a number to the left of the plan, mm of paper.
const NUMBER_MM: f64 = 14.0;

/// A line of the grid: its place on paper, and its number.
struct Tick {
    at_mm: f64,
    number: String,
}

/// The frame of `view`: everything except strokes, marks and relief.
///
/// The numbers of x are below the plan, those of y to the left of the plan, and those of z to the left of the
/// front and below the left side. The views are aligned, so no number appears twice.
pub fn draw(view: &View, layout: &Layout) -> String {
    let [left, top, width, height] = view.frame;
    let (right, bottom) = (left + width, top + height);
    let [across, up] = [0, 1].map(|side| ticks(view, side, layout.step));
    let mut grid = String::new();
    let mut numbers = String::new();
    let is_numbered_below = view.axes[1] == 1;
    let is_numbered_left = view.axes[0] == 0;
    for Tick { at_mm, number } in &across {
        let tick = if is_numbered_below { TICK_MM } else { 0.0 };
        grid += &format!("M{} {}V{}", fixed(*at_mm), fixed(top), fixed(bottom + tick));
        if is_numbered_below {
            numbers += &text_at("middle", *at_mm, bottom + TICK_MM + text::SIZE_MM, number);
        }
    }
    for Tick { at_mm, number } in &up {
        let tick = if is_numbered_left { TICK_MM } else { 0.0 };
        grid += &format!("M{} {}H{}", fixed(right), fixed(*at_mm), fixed(left - tick));
        if is_numbered_left {
            // The middle of a digit is a third of the text size above the base line.
            numbers += &number_beside(left - TICK_MM - 0.5, *at_mm + text::SIZE_MM / 3.0, number);
        }
    }
    let [right_name, up_name] = view.axes.map(|axis| NAMES[axis]);
    format!(
        "<path class=\"grid\" d=\"{grid}\"/>\n{numbers}\
         <rect class=\"frame\" x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\"/>\n{}{}{}",
        fixed(left),
        fixed(top),
        fixed(width),
        fixed(height),
        text_at("head", left, top - 1.5, view.name),
        text_at("axis right", right - 0.8, bottom - 1.0, right_name),
        text_at("axis", left + 0.8, top + 2.4, up_name),
    )
}

/// The ticks along a side. A frame too narrow for a tick of the common step gets a finer step.
fn ticks(view: &View, side: usize, mut step: RoundNumber) -> Vec<Tick> {
    let [low, high] = view.span(side);
    let place = |value: f64| {
        let fraction = (value - low) / (high - low);
        let [start, length] = [view.frame[side], view.frame[2 + side]];
        if side == 0 { start + fraction * length } else { start + (1.0 - fraction) * length }
    };
    loop {
        let (first, last) = ((low / step.value()).ceil(), (high / step.value()).floor());
        let count = last - first + 1.0;
        if count >= 1.0 {
            let value = |k: usize| step.times(first + k as f64);
            return (0..count as usize)
                .map(|k| Tick { at_mm: place(value(k)), number: with_decimals(value(k), step.decimals()) })
                .collect();
        }
        step = step.previous();
    }
}

pub fn text_at(class: &str, x: f64, y: f64, words: &str) -> String {
    format!("<text class=\"{class}\" x=\"{}\" y=\"{}\">{words}</text>\n", fixed(x), fixed(y))
}

/// A number that ends at `x`. It is condensed if it would leave the sheet.
pub fn number_beside(x: f64, y: f64, number: &str) -> String {
    let condensed = if text::width(number) * text::SIZE_MM > NUMBER_MM {
        format!(" textLength=\"{}\" lengthAdjust=\"spacingAndGlyphs\"", fixed(NUMBER_MM))
    } else {
        String::new()
    };
    format!("<text class=\"right\" x=\"{}\" y=\"{}\"{condensed}>{number}</text>\n", fixed(x), fixed(y))
}

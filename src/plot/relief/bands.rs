//! Bands of heights: where one ends, which colour each has, and how the sheet says so.

use nalgebra::Point3;

use super::{Corner, split};
use crate::plot::number::{RoundNumber, fixed, with_decimals};
use crate::plot::text::{self, SIZE_MM};
use crate::plot::view::View;

/// A range of heights is cut into at most so many steps, and into two fifths of them at least.
const STEPS: f64 = 10.0;
/// A surface is level when its heights differ by less than this share of its coordinates: rounding would be drawn.
const LEVEL: f64 = 1e-9;

/// Colours of the lowest, a middle and the highest band. They are light, so that paths are read on them, and grow
/// lighter upward, so that a print without colours shows them.
const RAMP: [[f64; 3]; 3] = [[150.0, 181.0, 180.0], [206.0, 214.0, 186.0], [253.0, 245.0, 224.0]];

/// Height of the bar in the legend, mm of paper.
const BAR_MM: f64 = 3.2;

/// Heights cut at round levels.
#[derive(Debug, Clone, PartialEq)]
pub struct Bands {
    step: RoundNumber,
    /// Ascending, mm; one fewer than there are bands.
    levels: Vec<f64>,
    /// The height of a level surface, mm.
    low: f64,
}

impl Bands {
    /// The bands of some points, of which there is one at least.
    pub fn of(points: &[Point3<f64>]) -> Self {
        let heights = points.iter().map(|p| p.z);
        let (low, high) =
            heights.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), z| (low.min(z), high.max(z)));
        let magnitude = points.iter().map(|p| p.coords.amax()).fold(0.0, f64::max);
        let range = high - low;
        if range <= LEVEL * magnitude {
            return Self { step: RoundNumber::ONE, levels: Vec::new(), low };
        }
        let step = RoundNumber::at_least(range / STEPS);
        let first = (low / step.value()).ceil();
        let inside = |level: &f64| *level > low && *level < high;
        // One more step than the range has, should the first be its end.
        let levels = (0..=STEPS as usize + 1).map(|k| step.times(first + k as f64)).filter(inside).collect();
        Self { step, levels, low }
    }

    pub fn count(&self) -> usize {
        self.levels.len() + 1
    }

    /// The number of bands that a triangle with corners at these heights, mm, has a part in.
    pub fn pieces(&self, heights: [f64; 3]) -> usize {
        let below = |height: f64| self.levels.partition_point(|level| *level <= height);
        let [a, b, c] = heights.map(below);
        a.max(b).max(c) - a.min(b).min(c) + 1
    }

    /// Calls `each` with the number of a band and the part of a convex piece in it, from the lowest up.
    pub fn cut(&self, piece: &[Corner], mut each: impl FnMut(usize, &[Corner])) {
        let lowest = piece.iter().map(|corner| corner.height).fold(f64::INFINITY, f64::min);
        let highest = piece.iter().map(|corner| corner.height).fold(f64::NEG_INFINITY, f64::max);
        let mut band = self.levels.partition_point(|level| *level <= lowest);
        let mut rest: Option<Vec<Corner>> = None;
        while let Some(level) = self.levels.get(band).filter(|level| **level <= highest) {
            let [below, above] = split(rest.as_deref().unwrap_or(piece), *level, |corner| corner.height);
            each(band, &below);
            rest = Some(above);
            band += 1;
        }
        each(band, rest.as_deref().unwrap_or(piece));
    }

    /// Rules for the class `h` of each band and for contours.
    pub fn style(&self) -> String {
        let fills = (0..self.count()).map(|band| format!(".plot .h{band}{{fill:{}}}", self.color(band)));
        ".plot .contour{stroke:#7d7766;stroke-width:.1}".to_owned() + &fills.collect::<String>()
    }

    /// The gradient `id`, in steps, by which an area in `view` is filled by its height.
    pub fn gradient(&self, view: &View, id: &str) -> String {
        let ends = [0, self.levels.len().saturating_sub(1)].map(|k| self.levels.get(k).copied());
        let [low, high] = match ends {
            [Some(low), Some(high)] if high > low => [low, high],
            // Any height above it does for the end of a gradient whose steps are all at its start.
            [Some(low), _] => [low, low + self.step.value()],
            _ => [self.low, self.low + self.step.value()],
        };
        let [from, to] = [low, high].map(|z| view.project(&Point3::new(0.0, 0.0, z)));
        let (across, along) = if view.axes[0] == 2 { ("x", [from.x, to.x]) } else { ("y", [from.y, to.y]) };
        let other = if across == "x" { "y" } else { "x" };
        let stop = |share: f64, band: usize| {
            format!("<stop offset=\"{share:.4}\" stop-color=\"{}\"/>", self.color(band))
        };
        let mut stops = stop(0.0, 0);
        for (band, level) in self.levels.iter().enumerate() {
            let share = (level - low) / (high - low);
            stops += &(stop(share, band) + &stop(share, band + 1));
        }
        format!(
            "<linearGradient id=\"{id}\" gradientUnits=\"userSpaceOnUse\" {across}1=\"{}\" {across}2=\"{}\" \
             {other}1=\"0\" {other}2=\"0\">{stops}</linearGradient>\n",
            along[0], along[1]
        )
    }

    /// The colour of a band.
    fn color(&self, band: usize) -> String {
        let place = if self.levels.is_empty() { 1.0 } else { 2.0 * band as f64 / self.levels.len() as f64 };
        let (from, to) = if place < 1.0 { (RAMP[0], RAMP[1]) } else { (RAMP[1], RAMP[2]) };
        let share = if place < 1.0 { place } else { place - 1.0 };
        let [r, g, b] = [0, 1, 2].map(|k| (from[k] + (to[k] - from[k]) * share).round() as u8);
        format!("#{r:02x}{g:02x}{b:02x}")
    }

    /// The levels whose numbers have room at a bar on which bands are `width_mm` wide: every first, second, fifth ...
    fn numbered(&self, width_mm: f64) -> Vec<(usize, String)> {
        let number = |level: &f64| with_decimals(*level, self.step.decimals());
        let numbers = || self.levels.iter().map(number);
        let widest = numbers().map(|number| text::width(&number)).fold(0.0, f64::max) * SIZE_MM;
        let every = ((widest + SIZE_MM) / width_mm).ceil().max(1.0) as usize;
        numbers().enumerate().step_by(every).collect()
    }
}

/// The bar of the bands of `points` in the legend: its left, top and width, mm of paper; and its height with numbers.
pub fn legend(points: &[Point3<f64>], [left, top, width]: [f64; 3]) -> (String, f64) {
    let bands = Bands::of(points);
    let each = width / bands.count() as f64;
    let swatch = |band: usize| {
        let x = fixed(left + each * band as f64);
        format!(
            "<path class=\"h{band}\" d=\"M{x} {}h{}v{BAR_MM}h-{}z\"/>\n",
            fixed(top),
            fixed(each),
            fixed(each)
        )
    };
    let below = top + BAR_MM + SIZE_MM + 0.6;
    let number = |(level, number): (usize, String)| {
        // A number at an end of the bar must not leave the column.
        let half = 0.5 * text::width(&number) * SIZE_MM;
        let x = left
            + (each * (level as f64 + 1.0)).clamp(half.min(0.5 * width), (width - half).max(0.5 * width));
        format!("<text class=\"middle\" x=\"{}\" y=\"{}\">{number}</text>\n", fixed(x), fixed(below))
    };
    let numbers: String = bands.numbered(each).into_iter().map(number).collect();
    ((0..bands.count()).map(swatch).collect::<String>() + &numbers, BAR_MM + SIZE_MM + 0.6)
}

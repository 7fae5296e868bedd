//! Bands of heights: the levels where two bands meet, the colours of the bands, and their legend.

use nalgebra::Point3;

use super::{Corner, split};
use crate::number::{RoundNumber, fixed, with_decimals};
use crate::text::{self, SIZE_MM};
use crate::view::View;

/// Most steps that the range of heights is divided into. Round steps make at least two fifths of this number.
const STEPS: f64 = 12.0;
/// A surface is level if its heights differ by less than this part of its largest coordinate. Without this
/// limit, rounding would be drawn.
const LEVEL: f64 = 1e-9;
/// A height this close to a level, as a part of a step, counts as the level. So a plateau at a level has no
/// contours from rounding.
const AT_LEVEL: f64 = 1e-6;

/// Colours of the lowest, the middle and the highest band. They are light, so that paths are legible on top.
/// They grow lighter upward, so that a print without colours shows them.
const RAMP: [[f64; 3]; 3] = [[133.0, 172.0, 178.0], [203.0, 214.0, 184.0], [254.0, 246.0, 226.0]];

/// Decimals of the height of a level surface, mm.
const LEVEL_DECIMALS: usize = 3;
/// Height of the bar in the legend, mm of paper.
const BAR_MM: f64 = 3.2;

/// A range of heights, cut at round levels.
#[derive(Debug, Clone, PartialEq)]
pub struct Bands {
    step: RoundNumber,
    /// Ascending, mm. Their number is one less than the number of bands.
    levels: Vec<f64>,
    /// The lowest height, mm; the legend shows it for a level surface.
    low: f64,
}

impl Bands {
    /// The bands for some points, at least one.
    pub fn of(points: &[Point3<f64>]) -> Self {
        let heights = points.iter().map(|p| p.z);
        let (low, high) =
            heights.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), z| (low.min(z), high.max(z)));
        let magnitude = points.iter().map(|p| p.coords.amax()).fold(0.0, f64::max);
        let range = high - low;
        if range <= LEVEL * magnitude {
            return Self { step: RoundNumber::ONE, levels: Vec::new(), low };
        }
        // A range slightly larger than a round number, because of rounding, still gets the round steps.
        let step = RoundNumber::at_least(range / STEPS * (1.0 - AT_LEVEL));
        let first = (low / step.value()).ceil();
        let near = AT_LEVEL * step.value();
        let inside = |level: &f64| *level > low + near && *level < high - near;
        // One level more than the steps need, because the first level may be the end of the range.
        let levels = (0..=STEPS as usize + 1).map(|k| step.times(first + k as f64)).filter(inside).collect();
        Self { step, levels, low }
    }

    pub fn count(&self) -> usize {
        self.levels.len() + 1
    }

    /// The height that decides the band of a place, mm: heights close to a level become the level.
    pub fn snapped(&self, height: f64) -> f64 {
        let near = AT_LEVEL * self.step.value();
        let above = self.levels.partition_point(|level| *level < height - near);
        self.levels.get(above).copied().filter(|level| *level <= height + near).unwrap_or(height)
    }

    /// The number of cuts of a triangle whose corners have these heights, mm.
    pub fn cuts(&self, heights: [f64; 3]) -> usize {
        let below = |height: f64| self.levels.partition_point(|level| *level <= height);
        let [a, b, c] = heights.map(below);
        a.max(b).max(c) - a.min(b).min(c)
    }

    /// Cuts a convex piece at the levels. Calls `each` with the number of a band and the part in that band,
    /// from the lowest up.
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

    /// Style rules for the class `h` of each band, and for contours.
    pub fn style(&self) -> String {
        let fills = (0..self.count()).map(|band| format!(".plot .h{band}{{fill:{}}}", self.color(band)));
        ".plot .contour{stroke:#8c5a2b;stroke-width:.1}".to_owned() + &fills.collect::<String>()
    }

    /// The stepped gradient `id`, which fills an area in `view` by its height.
    pub fn gradient(&self, view: &View, id: &str) -> String {
        let ends = [0, self.levels.len().saturating_sub(1)].map(|k| self.levels.get(k).copied());
        let [low, high] = match ends {
            [Some(low), Some(high)] if high > low => [low, high],
            // All steps are at the start of the gradient, so any greater height works as its end.
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

    /// The colour of a band for a style sheet.
    fn color(&self, band: usize) -> String {
        let [r, g, b] = self.rgb(band);
        format!("#{r:02x}{g:02x}{b:02x}")
    }

    /// The red, green and blue of a band.
    pub fn rgb(&self, band: usize) -> [u8; 3] {
        let place = if self.levels.is_empty() { 1.0 } else { 2.0 * band as f64 / self.levels.len() as f64 };
        let (from, to) = if place < 1.0 { (RAMP[0], RAMP[1]) } else { (RAMP[1], RAMP[2]) };
        let share = if place < 1.0 { place } else { place - 1.0 };
        [0, 1, 2].map(|k| (from[k] + (to[k] - from[k]) * share).round() as u8)
    }

    /// The numbers below a bar that is `width` mm of paper wide, with their places along it. All bands have
    /// the same width. Every level has a number, or every second, every third ... if there is less room.
    fn numbers(&self, width: f64) -> Vec<(f64, String)> {
        if self.levels.is_empty() {
            return vec![(0.5 * width, with_decimals(self.low, LEVEL_DECIMALS))];
        }
        let each = width / self.count() as f64;
        let numbers: Vec<String> =
            self.levels.iter().map(|level| with_decimals(*level, self.step.decimals())).collect();
        let widest = numbers.iter().map(|number| text::width(number)).fold(0.0, f64::max) * SIZE_MM;
        let every = ((widest + SIZE_MM) / each).ceil() as usize;
        let places = numbers.into_iter().enumerate().map(|(k, number)| (each * (k + 1) as f64, number));
        let fits = |(at, _): &(f64, String)| *at >= 0.5 * widest && *at <= width - 0.5 * widest;
        places.filter(fits).step_by(every).collect()
    }
}

/// The bar of the bands of `points` for the legend, at this left, top and width, mm of paper; and its height
/// with the numbers.
pub fn legend(points: &[Point3<f64>], [left, top, width]: [f64; 3]) -> (String, f64) {
    let bands = Bands::of(points);
    let height = BAR_MM + SIZE_MM + 0.6;
    let each = width / bands.count() as f64;
    let swatch = |band: usize| {
        let [x, y, each] = [left + each * band as f64, top, each].map(fixed);
        format!("<path class=\"contour h{band}\" d=\"M{x} {y}h{each}v{BAR_MM}h-{each}z\"/>\n")
    };
    let number = |(at, number): (f64, String)| {
        let [x, y] = [left + at, top + height].map(fixed);
        format!("<text class=\"middle\" x=\"{x}\" y=\"{y}\">{number}</text>\n")
    };
    let swatches: String = (0..bands.count()).map(swatch).collect();
    let numbers: String = bands.numbers(width).into_iter().map(number).collect();
    (swatches + &numbers, height)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(heights: [f64; 2]) -> Bands {
        Bands::of(&heights.map(|z| Point3::new(0.0, 0.0, z)))
    }

    #[test]
    fn levels_are_round_and_inside_the_range() {
        assert_eq!(of([-9.0, 3.0]).levels, [-8.0, -7.0, -6.0, -5.0, -4.0, -3.0, -2.0, -1.0, 0.0, 1.0, 2.0]);
        assert_eq!(of([0.0, 1e-6]).levels.len(), 9);
        for scale in [1e-9, 1e-3, 1.0, 123.4, 1e9] {
            let count = of([0.3 * scale, 1.7 * scale]).count();
            assert!((4..=13).contains(&count), "{scale}: {count}");
        }
        // A plateau at the last level belongs to the band below, even if rounding moves it.
        assert_eq!(of([0.0, 12.0]).count(), of([0.0, 12.000_000_000_1]).count());
        assert_eq!(of([0.0, 12.0]).snapped(5.999_999_999), 6.0);
        assert_eq!(of([0.0, 12.0]).snapped(5.9), 5.9);
    }

    #[test]
    fn a_level_surface_is_one_band() {
        for heights in [[5.0, 5.0], [1e6, 1e6 + 1e-6], [0.0, 0.0]] {
            assert_eq!(of(heights).count(), 1, "{heights:?}");
        }
        assert_eq!(of([5.0, 5.0]).numbers(60.0), [(30.0, "5.000".to_owned())]);
    }

    #[test]
    fn numbers_do_not_touch_each_other_or_leave_the_bar() {
        for heights in [[-9.0, 3.0], [-123_456.7, -123_456.6], [1e9, 1e9 + 13.0], [0.0, 1e-7]] {
            let numbers = of(heights).numbers(60.0);
            assert!(!numbers.is_empty(), "{heights:?}");
            let mut free = 0.0;
            for (at, number) in numbers {
                let half = 0.5 * text::width(&number) * SIZE_MM;
                assert!(at - half >= free && at + half <= 60.0, "{heights:?} {number}");
                free = at + half + 1.0;
            }
        }
    }
}

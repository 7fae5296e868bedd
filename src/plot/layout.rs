//! Chooses the scale and the places of the views on the sheet.
//!
//! In first-angle arrangement the front is above the plan, and the left side is to the right of the plan.
//! Along the sheet, every coordinate grows to the right or upward. A point of the part is equally far from
//! the left edge of the sheet in plan and front, and equally far from the top edge in plan and left side.

use nalgebra::{Point2, Point3};

use super::number::{RoundNumber, with_decimals};
use super::view::View;
use super::{Scene, text};
use toolpathd_core::toolpath::measure::{Bounds, measure};
use toolpathd_core::toolpath::units::FeedRate;

/// The border, inside the area that printers reach: left, top, right, bottom.
pub const BORDER_MM: [f64; 4] = [7.0, 7.0, 290.0, 203.0];
/// The left end of the column beside the views.
pub const COLUMN_X_MM: f64 = 222.0;

/// The largest coordinate that is drawn: a thousand kilometres. Larger numbers would not fit at the axes.
pub const LARGEST_MM: f64 = 1e9;

/// The area for the views, inside the numbers at the axes: left, top, right, bottom.
const AREA_MM: [f64; 4] = [24.0, 14.0, 216.0, 194.0];
/// Distance between views, for a caption or the name of an axis.
const GAP_MM: f64 = 10.0;
/// Distance between the drawing and the frame of its view, for the marks of start and end and the names of
/// axes.
const PADDING_MM: f64 = 4.0;
/// Least width and height of a view, for its caption and a number.
const LEAST_VIEW_MM: f64 = 16.0;
/// The power of ten of the largest scale, 100,000:1: a micrometre becomes a tenth of a metre.
const LARGEST_SCALE: i32 = 5;
/// Least distance between ticks, mm of paper.
const LEAST_STEP_MM: f64 = 9.0;

/// What the sheet says about its views.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Projection {
    FirstAngle,
    Isometric,
}

/// The views and their common figures.
#[derive(Debug, Clone)]
pub struct Layout {
    pub bounds: Bounds,
    pub scale: RoundNumber,
    pub projection: Projection,
    /// Distance between ticks, mm of the part.
    pub step: RoundNumber,
    /// Plan, front, left side.
    pub views: [View; 3],
}

/// Why a sheet has no drawing.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum NotDrawn {
    #[error("There is nothing to draw.")]
    Empty,
    #[error("The coordinates are too large for a picture.")]
    TooLarge,
}

impl Layout {
    /// Chooses the scale and the places of the views.
    ///
    /// # Errors
    /// When there is nothing to draw, or coordinates are too large.
    pub fn of(scene: &Scene) -> Result<Self, NotDrawn> {
        let bounds = bounds(scene).ok_or(NotDrawn::Empty)?;
        let is_drawable = |p: &Point3<f64>| p.iter().all(|x| x.abs() <= LARGEST_MM);
        if !(is_drawable(&bounds.min) && is_drawable(&bounds.max) && scene.drawing.points().all(is_drawable))
        {
            return Err(NotDrawn::TooLarge);
        }
        let extent = bounds.max - bounds.min;
        let size = |axis: usize, scale: f64| (extent[axis] * scale + 2.0 * PADDING_MM).max(LEAST_VIEW_MM);
        let [left, top, right, bottom] = AREA_MM;
        let fits = |scale: f64| {
            size(0, scale) + GAP_MM + size(2, scale) <= right - left
                && size(1, scale) + GAP_MM + size(2, scale) <= bottom - top
        };
        let mut scale = RoundNumber::power_of_ten(LARGEST_SCALE);
        if extent.amax() == 0.0 {
            scale = RoundNumber::ONE;
        }
        while !fits(scale.value()) {
            scale = scale.previous();
        }
        let [x, y, z] = [0, 1, 2].map(|axis| size(axis, scale.value()));
        let origin = Point2::new(
            left + 0.5 * (right - left - x - GAP_MM - z),
            top + 0.5 * (bottom - top - z - GAP_MM - y),
        );
        let view = |id, name, axes: [usize; 2], corner: Point2<f64>| {
            let frame = [corner.x, corner.y, size(axes[0], scale.value()), size(axes[1], scale.value())];
            View::new(id, name, axes, frame, &bounds, scale.value())
        };
        let below = origin.y + z + GAP_MM;
        let views = [
            view("plan", "Plan", [0, 1], Point2::new(origin.x, below)),
            view("front", "Front", [0, 2], origin),
            view("left-side", "Left side", [2, 1], Point2::new(origin.x + x + GAP_MM, below)),
        ];
        Ok(Self { bounds, scale, projection: Projection::FirstAngle, step: step(&bounds, scale), views })
    }
}

/// The box of everything that is drawn; `None` for an empty scene.
fn bounds(scene: &Scene) -> Option<Bounds> {
    // Any feed rate gives the same box.
    let path = scene.toolpath.map(|toolpath| measure(toolpath, FeedRate::DEFAULT_RAPID).bounds);
    scene.drawing.points().fold(path, |bounds, point| {
        let Bounds { min, max } = bounds.unwrap_or(Bounds { min: *point, max: *point });
        Some(Bounds { min: min.inf(point), max: max.sup(point) })
    })
}

/// The least round step, mm of the part, at which the numbers of ticks do not touch.
fn step(bounds: &Bounds, scale: RoundNumber) -> RoundNumber {
    let largest = bounds.min.coords.amax().max(bounds.max.coords.amax());
    let mut step = RoundNumber::at_least(LEAST_STEP_MM / scale.value());
    // A larger step never needs a wider number, so the loop ends.
    while step.value() * scale.value() < number_width(largest, step) + text::SIZE_MM {
        step = step.next();
    }
    step
}

/// The width of the widest number, mm of paper.
fn number_width(largest: f64, step: RoundNumber) -> f64 {
    text::SIZE_MM * text::width(&with_decimals(-largest, step.decimals()))
}

//! The isometric projection onto the sheet, and the frame of its view.

use nalgebra::{Point2, Point3, Vector2};

use crate::column::line;
use crate::number::{RoundNumber, fixed, with_decimals};
use crate::text;
use toolpathd_core::toolpath::measure::Bounds;

/// The directions of x, y and z on paper, to the right and upward: 30 degrees above the level, to the right
/// and to the left, and straight up.
const AXES: [[f64; 2]; 3] = [[0.866_025_403_784_438_6, 0.5], [-0.866_025_403_784_438_6, 0.5], [0.0, 1.0]];

/// The area for the view: left, top, right, bottom, mm of paper.
const AREA_MM: [f64; 4] = [10.0, 12.0, 219.0, 200.0];
/// Room around the view for the numbers and names of the axes.
const ROOM_MM: [f64; 2] = [15.0, 10.0];
/// The power of ten of the largest scale, as on the other sheets.
const LARGEST_SCALE: i32 = 5;
/// Least distance between ticks, mm of paper.
const LEAST_STEP_MM: f64 = 9.0;
/// Length of a tick, mm of paper.
const TICK_MM: f64 = 1.4;
/// Distance of the name of an axis from the end of its edge, mm of paper.
const NAME_MM: f64 = 4.0;

/// The projection, and what it shows.
#[derive(Debug, Clone)]
pub struct Isometric {
    pub scale: RoundNumber,
    /// Distance between ticks, mm of the part.
    pub step: RoundNumber,
    bounds: Bounds,
    middle: Point2<f64>,
}

impl Isometric {
    /// The largest standard scale at which the box fits.
    pub fn of(bounds: &Bounds) -> Self {
        let extent = bounds.max - bounds.min;
        let [left, top, right, bottom] = AREA_MM;
        let size = [AXES[0][0] * (extent.x + extent.y), 0.5 * (extent.x + extent.y) + extent.z];
        let room = [right - left - 2.0 * ROOM_MM[0], bottom - top - 2.0 * ROOM_MM[1]];
        let mut scale = RoundNumber::power_of_ten(LARGEST_SCALE);
        if extent.amax() == 0.0 {
            scale = RoundNumber::ONE;
        }
        while (0..2).any(|side| size[side] * scale.value() > room[side]) {
            scale = scale.previous();
        }
        let step = RoundNumber::at_least(LEAST_STEP_MM / scale.value());
        let middle = Point2::new(0.5 * (left + right), 0.5 * (top + bottom));
        Self { scale, step, bounds: *bounds, middle }
    }

    /// The place of a point of the workpiece on paper, mm.
    pub fn project(&self, p: &Point3<f64>) -> Point2<f64> {
        let way = p - nalgebra::center(&self.bounds.min, &self.bounds.max);
        let [right, up] = [0, 1].map(|side| (0..3).map(|axis| AXES[axis][side] * way[axis]).sum::<f64>());
        let scale = self.scale.value();
        Point2::new(self.middle.x + right * scale, self.middle.y - up * scale)
    }

    /// How near a point is to the reader, mm of the part; larger is nearer.
    pub fn nearness(&self, p: &Point3<f64>) -> f64 {
        (p.z - p.x - p.y) / 3f64.sqrt()
    }

    /// Whether the box holds the point.
    pub fn shows(&self, p: &Point3<f64>) -> bool {
        (0..3).all(|axis| (self.bounds.min[axis]..=self.bounds.max[axis]).contains(&p[axis]))
    }

    /// The floor of the box with a grid, the upright edge at its left, and the numbers and names of the axes.
    pub fn frame(&self) -> String {
        let Bounds { min, max } = &self.bounds;
        let (mut grid, mut ticks, mut words) = (String::new(), String::new(), String::new());
        let floor = |x: f64, y: f64| Point3::new(x, y, min.z);
        // Outward from the edges along x, along y and along z, on paper.
        let outward = [[AXES[0][0], 0.5], [-AXES[0][0], 0.5], [-1.0, 0.0]].map(Vector2::from);
        for (axis, outward) in outward.into_iter().enumerate() {
            for value in self.values(axis) {
                let (on_edge, across) = match axis {
                    0 => (floor(value, min.y), Some(floor(value, max.y))),
                    1 => (floor(min.x, value), Some(floor(max.x, value))),
                    _ => (Point3::new(min.x, max.y, value), None),
                };
                let at = self.project(&on_edge);
                grid += &across.map(|across| stroke(at, self.project(&across))).unwrap_or_default();
                ticks += &stroke(at, at + outward * TICK_MM);
                let place = at + outward * (TICK_MM + 0.6);
                let drop = if axis == 2 { text::SIZE_MM / 3.0 } else { text::SIZE_MM * 0.7 };
                let class = if axis == 0 { "" } else { "right" };
                words += &line(class, place.x, place.y + drop, &with_decimals(value, self.step.decimals()));
            }
        }
        let [near, right, left] =
            [floor(min.x, min.y), floor(max.x, min.y), floor(min.x, max.y)].map(|p| self.project(&p));
        let back = self.project(&floor(max.x, max.y));
        let top = self.project(&Point3::new(min.x, max.y, max.z));
        let edges = stroke(near, right) + &stroke(right, back) + &stroke(back, left) + &stroke(left, near);
        let edges = edges + &stroke(left, top);
        words += &line("axis", right.x + NAME_MM, right.y - NAME_MM * 0.5, "x");
        words += &line("axis right", left.x - NAME_MM, left.y - NAME_MM * 0.5, "y");
        words += &line("axis middle", top.x, top.y - 1.5, "z");
        format!("<path class=\"grid\" d=\"{grid}\"/>\n<path d=\"{edges}{ticks}\"/>\n{words}")
    }

    /// The round values along an axis.
    fn values(&self, axis: usize) -> Vec<f64> {
        let step = self.step.value();
        let [low, high] = [self.bounds.min[axis], self.bounds.max[axis]];
        let (first, last) = ((low / step - 1e-9).ceil(), (high / step + 1e-9).floor());
        let count = (last - first + 1.0).max(0.0) as usize;
        (0..count).map(|k| self.step.times(first + k as f64)).collect()
    }
}

fn stroke(from: Point2<f64>, to: Point2<f64>) -> String {
    format!("M{} {}L{} {}", fixed(from.x), fixed(from.y), fixed(to.x), fixed(to.y))
}

//! What entities draw: curves in the plane, and placed blocks.

use toolpathd_core::geometry::plane_curve::nurbs::Nurbs;

use super::placement::Placement;

/// How much z may change along a curve in the plane, as a part of its largest coordinate plus 1. The value is
/// above the rounding of files with 8 decimals.
const FLAT: f64 = 1e-7;

#[derive(Debug, Clone, PartialEq)]
pub enum Content {
    Curve(Shape),
    Insert(Box<Insert>),
    /// The reason.
    LeftOut(&'static str),
}

/// A curve in the plane, in the lengths of the file.
#[derive(Debug, Clone, PartialEq)]
pub enum Shape {
    Line([[f64; 2]; 2]),
    Circle {
        center: [f64; 2],
        radius: f64,
        is_mirrored: bool,
    },
    /// Counterclockwise from `start` to `end`, degrees, before it is mirrored.
    Arc {
        center: [f64; 2],
        radius: f64,
        start: f64,
        end: f64,
        is_mirrored: bool,
    },
    /// The points center + cos t major + sin t minor, for t from `start` to `end`, radians.
    Ellipse {
        center: [f64; 2],
        major: [f64; 2],
        minor: [f64; 2],
        start: f64,
        end: f64,
    },
    /// x, y and the bulge to the next vertex.
    Polyline {
        vertices: Vec<[f64; 3]>,
        is_closed: bool,
    },
    Nurbs(Box<Nurbs>),
    /// A smooth curve through points, whose ends have these tangents.
    Through {
        points: Vec<[f64; 2]>,
        tangents: Tangents,
    },
}

/// The tangents at the ends of a curve through points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Tangents {
    Free,
    /// Directions of any length.
    Given([[f64; 2]; 2]),
    /// The curve is closed, and its last point is its first. It has no kink there.
    Closed,
}

/// A block that is placed.
#[derive(Debug, Clone, PartialEq)]
pub struct Insert {
    /// The key of the block's name.
    pub block: String,
    pub at: [f64; 2],
    pub scale: [f64; 2],
    pub degrees: f64,
    /// Columns and rows.
    pub counts: [u32; 2],
    /// The distances of the columns and of the rows.
    pub distances: [f64; 2],
    pub is_mirrored: bool,
}

impl Insert {
    /// The map of the copy in a column and a row, of a block with this base point.
    pub fn placement(&self, base: [f64; 2], [column, row]: [u32; 2]) -> Placement {
        let turned = Placement::of_block([0.0, 0.0], [1.0, 1.0], self.degrees, [0.0, 0.0]);
        let aside = [f64::from(column) * self.distances[0], f64::from(row) * self.distances[1]];
        let aside = turned.direction(aside);
        let to = [self.at[0] + aside[0], self.at[1] + aside[1]];
        let placed = Placement::of_block(base, self.scale, self.degrees, to);
        if self.is_mirrored { Placement::seen_from_below().after(&placed) } else { placed }
    }
}

/// Whether heights differ by rounding only, on a curve with this largest coordinate.
pub fn is_flat(heights: impl Iterator<Item = f64>, magnitude: f64) -> bool {
    let [low, high] =
        heights.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], z| [low.min(z), high.max(z)]);
    // Without heights, low is above high.
    low > high || high - low <= FLAT * (magnitude + 1.0)
}

/// The largest coordinate of points.
pub fn magnitude(points: impl Iterator<Item = [f64; 2]>) -> f64 {
    points.fold(0.0, |most, p| most.max(p[0].abs()).max(p[1].abs()))
}

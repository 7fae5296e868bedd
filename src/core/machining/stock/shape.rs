//! The shapes of raw parts: prisms with a level bottom and a level top.

use nalgebra::{Point2, Point3, Vector2};

use super::band::{NOTHING, Rows};
use super::blocks::Blocks;
use super::grid::Grid;
use crate::budget::Stopped;
use crate::geometry::region::{Containment, Region};

/// How far the boundary of a region may lie from the outline that was given, mm.
const SNAP_MM: f64 = 2e-5;

/// The shape of a raw part.
#[derive(Debug, Clone)]
pub enum Shape {
    /// A block between two corners.
    Block { low: Point3<f64>, high: Point3<f64> },
    /// A bar that stands upright.
    Cylinder { center: Point2<f64>, radius_mm: f64, bottom_mm: f64, top_mm: f64 },
    /// A plate with any outline.
    Outline { region: Region, bottom_mm: f64, top_mm: f64 },
}

#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum ShapeError {
    #[error(transparent)]
    Stopped(#[from] Stopped),
    #[error("the stock has no volume")]
    Empty,
    #[error("the stock has {cells} cells; at most {limit} are allowed")]
    TooManyCells { cells: f64, limit: usize },
}

impl Shape {
    /// The corners of the rectangle around the shape in plan.
    pub fn rectangle(&self) -> Option<[Point2<f64>; 2]> {
        match self {
            Self::Block { low, high } => Some([low.xy(), high.xy()]),
            Self::Cylinder { center, radius_mm, .. } => {
                let out = Vector2::new(*radius_mm, *radius_mm);
                Some([center - out, center + out])
            }
            Self::Outline { region, .. } => region.bounding_box(),
        }
    }

    /// The heights of bottom and top, mm.
    pub(super) fn heights(&self) -> (f64, f64) {
        match self {
            Self::Block { low, high } => (low.z, high.z),
            Self::Cylinder { bottom_mm, top_mm, .. } | Self::Outline { bottom_mm, top_mm, .. } => {
                (*bottom_mm, *top_mm)
            }
        }
    }

    /// Where a disc lies: inside, across the boundary, or outside.
    fn place(&self, center: Point2<f64>, radius: f64) -> Containment {
        match self {
            Self::Block { .. } => Containment::Inside,
            Self::Cylinder { center: middle, radius_mm, .. } => {
                let away = (center - middle).norm();
                if away + radius <= *radius_mm {
                    Containment::Inside
                } else if away - radius >= *radius_mm {
                    Containment::Outside
                } else {
                    Containment::OnBoundary
                }
            }
            Self::Outline { region, .. } => region.place(center, radius + SNAP_MM),
        }
    }

    /// The rows of a height map of the shape.
    pub(super) fn band(&self, grid: &Grid, rows: [usize; 2], (bottom, top): (f64, f64)) -> Rows {
        let [columns, height] = [grid.n[0], rows[1] - rows[0]];
        let mut outer = vec![NOTHING; columns * height];
        let mut inner = outer.clone();
        // Corners across the boundary are looked at one by one.
        let mut samples = vec![NOTHING; (columns + 1) * (height + 1)];
        let place = |center, radius| self.place(center, radius);
        grid.divide([[0, columns], rows], &place, &mut |[[from, to], [first, last]], own| {
            if own == Containment::Outside {
                return;
            }
            for j in first - rows[0]..last - rows[0] {
                outer[j * columns..][from..to].fill(top);
                if own == Containment::Inside {
                    inner[j * columns..][from..to].fill(top);
                }
            }
            for (i, j) in (first..=last).flat_map(|j| (from..=to).map(move |i| (i, j))) {
                if own == Containment::Inside || self.place(grid.corner(i, j), 0.0) == Containment::Inside {
                    samples[(j - rows[0]) * (columns + 1) + i] = top;
                }
            }
        });
        Rows { grid: *grid, rows, bottom, outer, inner, samples, blocks: Blocks::new([columns, height]) }
    }
}

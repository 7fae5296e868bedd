//! Rectangles of parameters over which a surface is nearly flat.
//!
//! # Method
//! The range of the face is cut at the knots where its surface is not smooth. A rectangle over which
//! triangles would leave the surface too far is cut across the parameter that causes more of it, and its
//! parts in turn.

use toolpathd_core::budget::Budget;

use super::curve_bounds::parted;
use super::inside::Inside;
use super::surface_bounds::{Rectangle, SurfaceBounds};
use super::unfilled::Unfilled;

/// The part of the allowed deviation of the rectangles, so that triangles across two of them are near, too.
const SHARE: f64 = 0.7;

/// A rectangle that needs more parts is halved first: a part may need fewer.
const MOST_PARTS: f64 = 3.0;

/// Times that a rectangle is cut.
const DEEPEST: u32 = 40;

/// What the rectangles of a face depend on.
pub struct Lattice<'a> {
    pub bounds: &'a SurfaceBounds<'a>,
    pub inside: &'a Inside,
    pub allowed_mm: f64,
    /// The most rectangles.
    pub most: usize,
}

impl Lattice<'_> {
    /// The corners of the rectangles that are within the polygons, in the order of their parameters.
    ///
    /// # Errors
    /// There are too many, or the budget has ended.
    pub fn corners(&self, domain: Rectangle, budget: &Budget) -> Result<Vec<[f64; 2]>, Unfilled> {
        let kinks = self.bounds.kinks(domain);
        let lines = [0, 1].map(|k| {
            let mut lines = vec![domain[k][0]];
            lines.extend(kinks[k].iter().map(|(t, _)| *t));
            lines.push(domain[k][1]);
            lines
        });
        let mut corners: Vec<[f64; 2]> = Vec::new();
        for u in lines[0].windows(2) {
            for v in lines[1].windows(2) {
                self.cut([[u[0], u[1]], [v[0], v[1]]], 0, &mut corners, budget)?;
            }
        }
        corners.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
        corners.dedup();
        budget.check()?;
        corners.retain(|at| self.inside.contains(*at));
        Ok(corners)
    }

    /// Cuts a rectangle until it is nearly flat, and adds the corners of its parts.
    fn cut(
        &self,
        ranges: Rectangle,
        depth: u32,
        corners: &mut Vec<[f64; 2]>,
        budget: &Budget,
    ) -> Result<(), Unfilled> {
        budget.check()?;
        let causes = self.bounds.of_rectangle(ranges);
        let allowed = SHARE * self.allowed_mm;
        if causes[0] + causes[1] <= allowed || depth == DEEPEST || !self.inside.may_touch(ranges) {
            let [u, v] = ranges;
            corners.extend([[u[0], v[0]], [u[1], v[0]], [u[1], v[1]], [u[0], v[1]]]);
            return if corners.len() / 4 > self.most { Err(Unfilled::TooMany) } else { Ok(()) };
        }
        let along = usize::from(causes[1] > causes[0]);
        // The deviation goes with the square of the extent.
        let wanted = (causes[along] / (allowed - causes[1 - along]).max(0.0)).sqrt();
        let n = if wanted <= MOST_PARTS { wanted.ceil().max(2.0) as usize } else { 2 };
        for range in parted(ranges[along], n) {
            let mut part = ranges;
            part[along] = range;
            self.cut(part, depth + 1, corners, budget)?;
        }
        Ok(())
    }
}

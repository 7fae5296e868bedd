//! The skyline of a surface over a plane of constant y: the largest z of their section for every x.
//!
//! # Method
//! 1. Patches that the plane may meet are halved until, on each part, one parameter of the section is a
//!    function of the other, say v of u: S_y has one sign along v (`part`).
//! 2. The section of a part runs between two points on the sides of the part, which are found exactly. The
//!    second derivative of the section along u, S_uu + 2 S_uv v' + S_vv v'^2 + S_v v'', bounds how far the
//!    section leaves its chord in height. A part on which that is too far is halved.
//! 3. Where the section is too steep for a bound in height, a part narrower than the width asked for becomes
//!    a level [`Segment`] at the height of the part's top.
//! 4. The skyline is the upper envelope of the stretches of one section, or of several ([`union`]).
//!
//! # Guarantees
//! Heights over x of the stretches and of the sections differ by at most [`Accuracy::height_mm`], at places
//! that are at most [`Accuracy::width_mm`] apart. Where the section is not upright, these are the same
//! places. The largest of several functions changes by no more than the functions do, so the same holds for
//! unions. Only slots between upright walls that are narrower than the width may be missing. The surface may
//! have any shape: creases, folds and overhangs need no special care.
//!
//! # Degenerate input
//! Where an edge of the surface grazes the plane, the section may begin or end as the section of a plane up
//! to `height_mm` away would. A surface that lies upright in the plane itself has no section. It is an error
//! if its search takes too many parts.
//!
//! # Cost
//! O(stretches), with a few halvings for each. The envelope takes O(n log n + n m) for n stretches of which
//! at most m lie over one x.

mod envelope;
mod part;

use nalgebra::{Point3, Vector2};

use crate::budget::{Budget, Stopped};
use crate::geometry::surface::{BezierSurface, Patch};
pub use envelope::{UpperEnvelope, union};

/// Largest number of parts examined for one plane; a few hundred are usual.
const PART_LIMIT: usize = 1_000_000;

/// Parts between two checks of the budget.
const PARTS_BETWEEN_CHECKS: usize = 256;

/// A straight stretch of a section: points (x, z), mm, the first at the smaller x.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Segment {
    pub from: Vector2<f64>,
    pub to: Vector2<f64>,
}

impl Segment {
    /// The height over a place between the ends, mm.
    fn height(&self, x: f64) -> f64 {
        let share = ((x - self.from.x) / (self.to.x - self.from.x)).clamp(0.0, 1.0);
        self.from.y + share * (self.to.y - self.from.y)
    }
}

/// The accuracy of stretches.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Accuracy {
    /// The accuracy of heights, mm.
    pub height_mm: f64,
    /// The accuracy of x where the section is nearly upright, mm.
    pub width_mm: f64,
}

#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum EnvelopeError {
    #[error(transparent)]
    Stopped(#[from] Stopped),
    #[error("the plane section could not be found near {at}, where the surface lies in the plane")]
    Lost { at: Point3<f64> },
}

/// A surface, prepared for its sections with planes of constant y.
pub struct Profiles<'a, P> {
    surface: &'a BezierSurface<P>,
    /// The least and the largest y of each patch, mm.
    ranges: Vec<[f64; 2]>,
}

impl<'a, P: Patch> Profiles<'a, P> {
    pub fn new(surface: &'a BezierSurface<P>) -> Self {
        let range = |patch: &P| {
            let bounds = patch.bounds();
            [bounds.min.y, bounds.max.y]
        };
        Self { surface, ranges: surface.patches().iter().map(range).collect() }
    }

    /// The stretches of the section with the plane at `y` mm, in no particular order.
    ///
    /// # Errors
    /// When the section is lost, or the budget stops.
    pub fn stretches(
        &self,
        y: f64,
        accuracy: Accuracy,
        budget: &Budget,
    ) -> Result<Vec<Segment>, EnvelopeError> {
        let met =
            self.ranges.iter().zip(self.surface.patches()).filter(|([low, high], _)| *low <= y && y <= *high);
        let mut open: Vec<P> = met.map(|(_, patch)| *patch).collect();
        let mut stretches = Vec::new();
        let mut parts = 0;
        while let Some(patch) = open.pop() {
            parts += 1;
            if parts > PART_LIMIT {
                return Err(EnvelopeError::Lost { at: Point3::from(patch.center()) });
            }
            if parts.is_multiple_of(PARTS_BETWEEN_CHECKS) {
                budget.check()?;
            }
            match part::section(&patch, y, accuracy) {
                part::Section::Missed => {}
                part::Section::Met(stretch) => stretches.push(stretch),
                part::Section::Unknown => open.extend(patch.split()),
            }
        }
        Ok(stretches)
    }
}

#[cfg(test)]
mod tests;

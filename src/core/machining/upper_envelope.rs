//! Finds the skyline of a surface in a plane of constant y: for every x, the largest z of the section.
//!
//! # Method
//! 1. Take the patches that the plane may meet. Halve each of them until the section of each part differs
//!    little in height from its chord. This chord becomes a [`Stretch`]. Where the section is nearly upright,
//!    a narrow part becomes a level [`Stretch`] at the height of its highest point (`part`).
//! 2. Take the upper envelope of the stretches of one section, or of several sections together ([`union`]).
//!
//! # Guarantees
//! * The height of the skyline is accurate to [`Accuracy::height_mm`] at every x. Near a nearly upright wall,
//!   the height at x may be that of a place up to [`Accuracy::width_mm`] beside x.
//! * Slots between upright walls may be missing if they are narrower than `width_mm`.
//! * Creases, folds and overhangs of the surface are allowed. A plane that needs more than a million parts is
//!   refused, for example because the surface lies in the plane.
//!
//! # Cost
//! O(n log n + n m) for n stretches, of which at most m lie over one x.

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
pub struct Stretch {
    pub from: Vector2<f64>,
    pub to: Vector2<f64>,
}

impl Stretch {
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

    /// The stretches of the section with the plane at `y` mm, in no particular order. Where an edge of the
    /// surface grazes the plane, the ends of the section may be those of a section with a plane up to
    /// `accuracy.height_mm` away.
    ///
    /// # Errors
    /// When the section is lost, or the budget stops.
    pub fn stretches(
        &self,
        y: f64,
        accuracy: Accuracy,
        budget: &Budget,
    ) -> Result<Vec<Stretch>, EnvelopeError> {
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

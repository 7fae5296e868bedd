//! A closed loop of lines and arcs that does not cross itself.

use nalgebra::{Point2, Vector2};

use super::arrangement::{Arrangement, Loop, SNAP_MM};
use super::winding::{self, Sides};
use crate::budget::{Budget, Stopped};
use crate::geometry::bounding_tree::Volume;
use crate::geometry::offset::tree::{Bounds, Tree};
use crate::geometry::segment::Segment;

/// The largest coordinate or radius, mm: its rounding is a hundredth of [`SNAP_MM`].
const LARGEST_MM: f64 = 1e8;

/// An arc that rises less above its chord becomes a line, mm.
const FLAT_MM: f64 = 1e-9;

/// Below this turn, radians, `turn - sin(turn)` is computed by its series, because the difference would lose
/// digits. The first neglected term is below 1e-13 of the result.
const SMALL_TURN: f64 = 0.05;

/// A closed loop of lines and arcs. Each element starts exactly where the one before it ends. A loop may
/// touch itself in single points.
#[derive(Debug, Clone, PartialEq)]
pub struct Outline {
    elements: Vec<Segment>,
}

#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum OutlineError {
    #[error(transparent)]
    Stopped(#[from] Stopped),
    #[error("the outline has no elements")]
    Empty,
    #[error("element {index} of the outline has a coordinate or a radius beyond {LARGEST_MM:e} mm")]
    TooLarge { index: usize },
    #[error("element {index} of the outline ends {gap_mm} mm from the start of the next element, near {at}")]
    Open { index: usize, gap_mm: f64, at: Point2<f64> },
    #[error("the outline crosses or overlaps itself near {at}")]
    Crosses { at: Point2<f64> },
    #[error("the outline encloses no area")]
    NoArea,
    #[error("the outline needs more than {limit} elements")]
    TooMany { limit: usize },
}

impl Outline {
    /// The outline of elements that follow each other within 1e-6 mm, also the last to the first. The outline
    /// runs counterclockwise, whatever the direction of its elements.
    ///
    /// # Errors
    /// One of [`OutlineError`]. Indices count elements from 0.
    pub fn new(elements: &[Segment], budget: &Budget) -> Result<Self, OutlineError> {
        let joined = joined(elements)?;
        let area = area(&joined);
        if area.abs() <= SNAP_MM * length(&joined) {
            return Err(OutlineError::NoArea);
        }
        let outline = Self { elements: joined };
        let outline = if area < 0.0 { outline.reversed() } else { outline };
        let arrangement =
            Arrangement::new(&[Loop { group: 0, elements: &outline.elements }], SNAP_MM, 1, budget)?;
        if let Some(at) = arrangement.overlap {
            return Err(OutlineError::Crosses { at });
        }
        let sides = winding::sides(&arrangement, budget)?;
        let is_crossed = |sides: &Sides| (sides.left[0], sides.right[0]) != (1, 0);
        if let Some(at) = winding::first_junction(&arrangement, &sides, is_crossed) {
            return Err(OutlineError::Crosses { at });
        }
        Ok(outline)
    }

    /// An outline of elements that need no check.
    pub(super) fn unchecked(elements: Vec<Segment>) -> Self {
        Self { elements }
    }

    pub fn elements(&self) -> &[Segment] {
        &self.elements
    }

    /// The area to the left of the outline, mm²; negative if the outline runs clockwise.
    pub fn area(&self) -> f64 {
        area(&self.elements)
    }

    /// The centroid of the area inside.
    pub fn centroid(&self) -> Point2<f64> {
        let origin = self.elements[0].start();
        let (mut area, mut moment) = (0.0, Vector2::zeros());
        for element in &self.elements {
            let (start, end) = (element.start() - origin, element.end() - origin);
            let triangle = 0.5 * start.perp(&end);
            area += triangle;
            moment += (start + end) * (triangle / 3.0);
            if let Segment::Arc(arc) = element {
                let between = 0.5 * arc.radius() * arc.radius() * turn_less_sine(arc.turn());
                let outward = (element.at(0.5) - arc.center()) / arc.radius();
                let lever = (arc.radius() * (0.5 * arc.turn()).sin()).powi(3) * (2.0 / 3.0);
                area += between;
                moment += (arc.center() - origin) * between + outward * lever;
            }
        }
        origin + moment / area
    }

    /// The least distance between the lines of two outlines, mm.
    pub fn distance(&self, other: &Self) -> f64 {
        let tree = Tree::new(other.elements.clone());
        let mut least = tree.nearest(self.elements[0].start(), f64::INFINITY);
        for element in &self.elements {
            let (middle, reach) = element.disc();
            tree.near(middle, least + reach, |k, _| {
                least = least.min(element.distance_between(&other.elements[k]).0);
                true
            });
        }
        least
    }

    /// The lowest and the highest coordinates, mm.
    pub fn bounding_box(&self) -> [Point2<f64>; 2] {
        let bounds = self.elements.iter().map(Bounds::of);
        let Bounds { low, high } = bounds.fold(Bounds::NONE, |all, own| all.joined(&own));
        [low, high]
    }

    /// The same loop in the other direction.
    #[must_use]
    pub fn reversed(&self) -> Self {
        Self { elements: self.elements.iter().rev().map(Segment::reversed).collect() }
    }

    /// The loop with x negated, in the direction that keeps the same side on its left.
    #[must_use]
    pub fn mirrored(&self) -> Self {
        let mirrored = |element: &Segment| element.mirrored().reversed();
        Self { elements: self.elements.iter().rev().map(mirrored).collect() }
    }
}

/// The elements with gaps closed: each starts where the one before it ends. Arcs are made again from their
/// ends and turns.
fn joined(elements: &[Segment]) -> Result<Vec<Segment>, OutlineError> {
    if let Some(index) = elements.iter().position(|element| !is_small(element)) {
        return Err(OutlineError::TooLarge { index });
    }
    let Some(last) = elements.last() else { return Err(OutlineError::Empty) };
    let mut start = last.end();
    let mut joined = Vec::with_capacity(elements.len());
    for (index, element) in elements.iter().enumerate() {
        let gap_mm = (element.start() - start).norm();
        if gap_mm > SNAP_MM {
            let index = index.checked_sub(1).unwrap_or(elements.len() - 1);
            return Err(OutlineError::Open { index, gap_mm, at: start });
        }
        let (end, bulge) = (element.end(), -(element.turn() / 4.0).tan());
        let is_flat = 0.5 * bulge.abs() * (end - start).norm() <= FLAT_MM;
        joined.push(if is_flat { Segment::Line { start, end } } else { Segment::bulging(start, end, bulge) });
        start = end;
    }
    joined.retain(|element| element.start() != element.end());
    if joined.is_empty() { Err(OutlineError::NoArea) } else { Ok(joined) }
}

/// Whether the ends of an element are finite, and its coordinates and radius at most [`LARGEST_MM`].
fn is_small(element: &Segment) -> bool {
    // The magnitude does not show every NaN.
    let is_finite = [element.start(), element.end()].iter().flat_map(|p| p.iter()).all(|x| x.is_finite());
    is_finite && element.magnitude() <= LARGEST_MM
}

/// The area that closed chains of lines and arcs enclose, mm². Counterclockwise chains count as positive,
/// clockwise chains as negative. The elements may come in any order.
///
/// The result is the signed area of the polygons that the chords form, plus the signed area between each arc
/// and its chord.
pub fn area(chain: &[Segment]) -> f64 {
    let Some(origin) = chain.first().map(Segment::start) else { return 0.0 };
    let twice = |element: &Segment| {
        let chord = (element.start() - origin).perp(&(element.end() - origin));
        match element {
            Segment::Line { .. } => chord,
            Segment::Arc(arc) => chord + arc.radius() * arc.radius() * turn_less_sine(arc.turn()),
        }
    };
    0.5 * chain.iter().map(twice).sum::<f64>()
}

/// The area between an arc of radius 1 and its chord, twice.
fn turn_less_sine(turn: f64) -> f64 {
    if turn.abs() > SMALL_TURN {
        return turn - turn.sin();
    }
    let square = turn * turn;
    turn * square / 6.0 * (1.0 - square / 20.0 * (1.0 - square / 42.0 * (1.0 - square / 72.0)))
}

/// The length of a chain, mm.
pub(super) fn length(chain: &[Segment]) -> f64 {
    chain.iter().map(Segment::length).sum()
}

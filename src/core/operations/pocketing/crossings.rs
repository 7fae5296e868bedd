//! Where level lines meet the outlines of a region, in the order along the lines and along the outlines.

use std::f64::consts::FRAC_PI_2;

use nalgebra::{Matrix2, Rotation2, Vector2};

use super::PocketError;
use super::chain::ROUNDING_MM;
use crate::budget::Budget;
use crate::geometry::region::{self, Outline, Region};
use crate::geometry::segment::Segment;

/// The most lines, and the most places where they meet outlines.
const MOST: usize = 1_000_000;

/// A line of the boundary at a smaller angle is along x or y, radians: over a metre it leaves the axis by a
/// micrometre, so that rows along it would be the same rows.
const ALONG_AXIS: f64 = 1e-6;

/// A pole of an arc at less than this part of its turn from an end is that end.
const AT_END: f64 = 1e-12;

/// A frame that is turned against the workpiece, so that rows run along its x.
#[derive(Debug, Clone, Copy)]
pub struct Frame {
    /// From the frame to the workpiece.
    pub rotation: Rotation2<f64>,
}

/// A place where a line meets an outline.
#[derive(Debug, Clone, Copy)]
pub struct Crossing {
    pub outline: usize,
    pub element: usize,
    /// The fraction of the element's length.
    pub t: f64,
    pub x: f64,
    /// The index of the line.
    pub row: usize,
    /// Whether the outline goes up here.
    pub is_up: bool,
    /// The other end of the part of the line that is in the region.
    pub other: usize,
    /// The crossings before and after this one along the outline.
    pub before: usize,
    pub after: usize,
}

#[derive(Debug, Clone, Default)]
pub struct Crossings {
    pub all: Vec<Crossing>,
    /// The left ends of the parts of lines in the region.
    pub lefts: Vec<usize>,
}

impl Frame {
    /// Rows along the direction `angle`, radians. Right angles are turned without rounding.
    pub fn new(angle: f64) -> Self {
        let rotation = if angle == FRAC_PI_2 {
            Rotation2::from_matrix_unchecked(Matrix2::new(0.0, -1.0, 1.0, 0.0))
        } else {
            Rotation2::new(angle)
        };
        Self { rotation }
    }

    /// The frame turned by half a turn.
    pub fn reversed(self) -> Self {
        let [[a, b], [c, d]]: [[f64; 2]; 2] = self.rotation.into_inner().into();
        // Columns, without rounding.
        Self { rotation: Rotation2::from_matrix_unchecked(Matrix2::new(-a, -c, -b, -d)) }
    }

    /// The directions of x and y, and those along and across the longest line of the boundary.
    pub fn candidates(region: &Region) -> Vec<Self> {
        let mut angles = vec![0.0, FRAC_PI_2];
        let lines = region.outlines().flat_map(Outline::elements).filter(|element| element.turn() == 0.0);
        if let Some(longest) = lines.max_by(|a, b| a.length().total_cmp(&b.length())) {
            let along = longest.end() - longest.start();
            let angle = along.y.atan2(along.x).rem_euclid(FRAC_PI_2);
            if angle.min(FRAC_PI_2 - angle) > ALONG_AXIS {
                angles.extend([angle, angle + FRAC_PI_2]);
            }
        }
        angles.into_iter().map(Self::new).collect()
    }

    /// The outlines of a region in this frame.
    pub fn outlines(&self, region: &Region) -> Vec<Vec<Segment>> {
        let back = self.rotation.inverse();
        let turned =
            |outline: &Outline| outline.elements().iter().map(|element| element.rotated(&back)).collect();
        region.outlines().map(turned).collect()
    }

    /// Elements of this frame in the workpiece.
    pub fn in_workpiece(&self, elements: &[Segment]) -> Vec<Segment> {
        elements.iter().map(|element| element.rotated(&self.rotation)).collect()
    }
}

impl Crossings {
    /// The crossings of the outlines of a region with the lines at these heights, which rise. A line that
    /// runs along an edge counts as just above it.
    pub fn new(outlines: &[Vec<Segment>], ys: &[f64], budget: &Budget) -> Result<Self, PocketError> {
        let mut all: Vec<Crossing> = Vec::new();
        for (j, outline) in outlines.iter().enumerate() {
            budget.check()?;
            let first = all.len();
            for (k, element) in outline.iter().enumerate() {
                let begin = all.len();
                for range in monotone(element) {
                    let [a, b] = range.map(|t| element.at(t).y);
                    let (low, high) = (a.min(b), a.max(b));
                    let start = ys.partition_point(|y| *y < low);
                    for (row, y) in ys.iter().enumerate().skip(start).take_while(|(_, y)| **y < high) {
                        let t = meets(element, range, *y);
                        let x = element.at(t).x;
                        let is_up = a < b;
                        all.push(Crossing {
                            outline: j,
                            element: k,
                            t,
                            x,
                            row,
                            is_up,
                            other: 0,
                            before: 0,
                            after: 0,
                        });
                    }
                }
                all[begin..].sort_by(|a, b| a.t.total_cmp(&b.t));
                Self::checked(all.len() as f64)?;
            }
            let last = all.len();
            for (k, crossing) in all.iter_mut().enumerate().skip(first) {
                crossing.before = if k == first { last - 1 } else { k - 1 };
                crossing.after = if k + 1 == last { first } else { k + 1 };
            }
        }
        let mut order: Vec<usize> = (0..all.len()).collect();
        order.sort_by(|a, b| {
            let (a, b) = (&all[*a], &all[*b]);
            a.row.cmp(&b.row).then(a.x.total_cmp(&b.x))
        });
        let mut lefts = Vec::with_capacity(all.len() / 2);
        for pair in order.chunks_exact(2) {
            all[pair[0]].other = pair[1];
            all[pair[1]].other = pair[0];
            lefts.push(pair[0]);
        }
        Ok(Self { all, lefts })
    }

    /// A number of lines or crossings that is not too large.
    pub fn checked(count: f64) -> Result<usize, PocketError> {
        if count <= MOST as f64 {
            Ok(count as usize)
        } else {
            Err(PocketError::TooMuchWork { what: "rows", limit: MOST })
        }
    }

    /// The elements of the outline from one crossing on to another, without specks.
    pub fn between(&self, outlines: &[Vec<Segment>], from: usize, to: usize) -> Vec<Segment> {
        let (a, b) = (self.all[from], self.all[to]);
        let outline = &outlines[a.outline];
        let mut way = Vec::new();
        if a.element == b.element && a.t < b.t {
            way.push(outline[a.element].part(a.t, b.t));
        } else {
            way.push(outline[a.element].part(a.t, 1.0));
            let mut k = (a.element + 1) % outline.len();
            while k != b.element {
                way.push(outline[k]);
                k = (k + 1) % outline.len();
            }
            way.push(outline[b.element].part(0.0, b.t));
        }
        way.retain(|element| element.length() > ROUNDING_MM);
        way
    }

    /// The lowest and the highest y of outlines.
    pub fn range(outlines: &[Vec<Segment>]) -> Option<[f64; 2]> {
        let ys = outlines
            .iter()
            .flatten()
            .flat_map(|element| monotone(element).into_iter().flatten().map(|t| element.at(t).y));
        ys.fold(None, |range, y| {
            Some(range.map_or([y, y], |[low, high]: [f64; 2]| [low.min(y), high.max(y)]))
        })
    }

    /// The least and the largest x of an element.
    pub fn width(element: &Segment) -> [f64; 2] {
        let xs = between_poles(element, Vector2::x()).into_iter().flatten().map(|t| element.at(t).x);
        xs.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| [low.min(x), high.max(x)])
    }

    /// Whether no line meets this outline.
    pub fn is_untouched(&self, outlines: &[Vec<Segment>], outline: &[Segment]) -> bool {
        !self.all.iter().any(|crossing| std::ptr::eq(outlines[crossing.outline].as_slice(), outline))
    }

    /// Whether a loop runs counterclockwise.
    pub fn turns_left(outline: &[Segment]) -> bool {
        region::area(outline) > 0.0
    }
}

/// The ranges of an element along which y only rises or only falls.
fn monotone(element: &Segment) -> Vec<[f64; 2]> {
    between_poles(element, Vector2::y())
}

/// The ranges of an element between the places that are farthest along an axis and against it.
fn between_poles(element: &Segment, axis: Vector2<f64>) -> Vec<[f64; 2]> {
    let mut cuts = vec![0.0];
    if let Segment::Arc(arc) = element {
        let mut poles = [axis, -axis].map(|pole| arc.angle_to(pole) / arc.turn().abs());
        poles.sort_by(f64::total_cmp);
        cuts.extend(poles.into_iter().filter(|t| *t > AT_END && *t < 1.0 - AT_END));
    }
    cuts.push(1.0);
    cuts.windows(2).map(|pair| [pair[0], pair[1]]).collect()
}

/// Where a monotone part of an element has the height `y`.
fn meets(element: &Segment, [from, to]: [f64; 2], y: f64) -> f64 {
    match element {
        Segment::Arc(arc) => {
            let up = ((y - arc.center().y) / arc.radius()).clamp(-1.0, 1.0);
            let middle = element.at(0.5 * (from + to)) - arc.center();
            let spoke = Vector2::new((1.0 - up * up).sqrt().copysign(middle.x), up) * arc.radius();
            let angle = arc.turn().signum() * middle.perp(&spoke).atan2(middle.dot(&spoke));
            (0.5 * (from + to) + angle / arc.turn().abs()).clamp(from, to)
        }
        Segment::Line { start, end } => ((y - start.y) / (end.y - start.y)).clamp(from, to),
    }
}

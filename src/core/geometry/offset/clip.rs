//! Clipping: removes every part of a piece that is nearer to a contour than the offset's distance. A piece is
//! an element of a contour, moved aside by this distance, or an arc about a corner of a contour.
//!
//! # Method
//! These steps are done for each piece and each element of a contour near it:
//! 1. The places at exactly the offset's distance from the element lie on parallels to the element and on
//!    circles about its ends.
//! 2. These parallels and circles cut the piece into parts. A part is nearer to the element than the offset's
//!    distance either all along or nowhere.
//! 3. So one place of each part is enough: if the middle of the part is too near, the part is removed.
//!
//! # Guarantees
//! The parts that remain are nearer to a contour than the distance by no more than rounding.
//!
//! # Cost
//! Each piece is compared only with the elements that are nearer to the middle of the piece than the offset's
//! distance plus half the length of the piece.

use nalgebra::{Point2, Vector2};

use super::pieces::{Piece, SHORTEST_MM};
use super::tree::Tree;
use crate::geometry::segment::{PlaneArc, Segment, circle_meets, circles_meet, left};

/// Clips pieces one after the other, with buffers that are used again. Liu et al. remove parts between
/// crossings of pieces only; here each piece is compared with each element near it.
pub(super) struct Clip<'a> {
    pub contour: &'a Tree,
    /// The offset's distance, mm.
    pub distance: f64,
    /// How parts of a piece are judged that are exactly at the distance from another element, within this
    /// many mm; zero if they all remain. Of coincident pieces with the contour on the same side the first
    /// remains, and none of those with the contour on both sides.
    pub tie: f64,
    /// Ranges that are too near by less than this are kept, mm.
    pub rounding: f64,
    /// The element that last forbade a whole piece: it is likely to forbid the next piece too.
    blocker: usize,
    blocked: Vec<[f64; 2]>,
    crossings: Vec<f64>,
}

impl<'a> Clip<'a> {
    pub(super) fn new(contour: &'a Tree, distance: f64, rounding: f64) -> Self {
        Self { contour, distance, tie: 0.0, rounding, blocker: 0, blocked: Vec::new(), crossings: Vec::new() }
    }

    /// Appends the ranges of the piece that are left, in their order. Ranges run from 0 to 1 along the piece.
    pub(super) fn open(&mut self, piece: &Piece, open: &mut Vec<[f64; 2]>) {
        let (middle, reach) = piece.element.disc();
        let blocking = self.distance - reach - self.rounding;
        let blocker = &self.contour.elements()[self.blocker];
        if blocker.distance_to(middle) < blocking {
            return;
        }
        self.blocked.clear();
        let mut is_blocked = false;
        self.contour.near(middle, self.distance + self.tie + reach, |k, apart| {
            if apart < blocking {
                (is_blocked, self.blocker) = (true, k);
            } else if piece.is_corner || piece.element_index != k {
                let element = &self.contour.elements()[k];
                self.crossings.clear();
                self.crossings.extend([0.0, 1.0]);
                cross(&piece.element, element, self.distance, &mut self.crossings);
                self.crossings.sort_unstable_by(f64::total_cmp);
                for pair in self.crossings.windows(2) {
                    let place = piece.element.at(0.5 * (pair[0] + pair[1]));
                    if pair[0] < pair[1] && self.is_blocked(piece, k, place) {
                        self.blocked.push([pair[0], pair[1]]);
                    }
                }
            }
            !is_blocked
        });
        if is_blocked {
            return;
        }
        self.blocked.sort_unstable_by(|a, b| a[0].total_cmp(&b[0]));
        let shortest = SHORTEST_MM / piece.element.length();
        let mut from = 0.0;
        for [start, end] in self.blocked.iter().copied().chain([[1.0, 1.0]]) {
            if start - from >= shortest {
                open.push([from, start]);
            }
            from = end.max(from);
        }
    }

    /// Whether a place of the piece is too near to element `k`.
    fn is_blocked(&self, piece: &Piece, k: usize, place: Point2<f64>) -> bool {
        let element = &self.contour.elements()[k];
        let distance = element.distance_to(place);
        if distance < self.distance - self.rounding - self.tie || self.tie == 0.0 {
            return distance < self.distance - self.rounding;
        }
        // Elements that follow each other have pieces that follow each other.
        if distance > self.distance + self.tie || k.abs_diff(piece.element_index) <= 1 {
            return false;
        }
        let own = match &piece.element {
            Segment::Arc(arc) if piece.is_corner => arc.center() - place,
            _ => self.contour.elements()[piece.element_index].nearest(place) - place,
        };
        let other = element.nearest(place) - place;
        k < piece.element_index || own.dot(&other) < 0.0
    }
}

/// Appends the places along the piece where its distance to the element may pass through `distance`. These
/// are its crossings with lines and circles, and the places where it comes nearest to them or is farthest
/// from them. Where the piece touches a line or circle, the two crossings are inaccurate. The part between
/// them is too near by no more than rounding.
fn cross(piece: &Segment, element: &Segment, distance: f64, found: &mut Vec<f64>) {
    match element {
        Segment::Line { start, end } => {
            if let Some(along) = (end - start).try_normalize(0.0) {
                let aside = left(along) * distance;
                cross_line(piece, start + aside, along, found);
                cross_line(piece, start - aside, along, found);
            }
        }
        Segment::Arc(arc) => {
            cross_circle(piece, arc.center(), arc.radius() + distance, found);
            if arc.radius() > distance {
                cross_circle(piece, arc.center(), arc.radius() - distance, found);
            }
        }
    }
    cross_circle(piece, element.start(), distance, found);
    cross_circle(piece, element.end(), distance, found);
}

fn cross_line(piece: &Segment, from: Point2<f64>, along: Vector2<f64>, found: &mut Vec<f64>) {
    match piece {
        Segment::Line { start, end } => {
            let t = (from - start).perp(&along) / (end - start).perp(&along);
            found.extend(Some(t).filter(|t| (0.0..1.0).contains(t)));
        }
        Segment::Arc(arc) => {
            let crossings = circle_meets(arc.radius(), from - arc.center(), along);
            let extremes = [left(along), -left(along)];
            let spokes = crossings.into_iter().flatten().chain(extremes);
            found.extend(spokes.filter_map(|spoke| place_on(arc, spoke)));
        }
    }
}

fn cross_circle(piece: &Segment, center: Point2<f64>, radius: f64, found: &mut Vec<f64>) {
    match piece {
        Segment::Line { start, end } => {
            let chord = end - start;
            let length = chord.norm();
            let along = chord / length;
            let foot = (center - start).dot(&along) / length;
            let crossings = circle_meets(radius, start - center, along).into_iter().flatten();
            let crossings = crossings.map(|spoke| foot + spoke.dot(&along) / length);
            found.extend(crossings.chain([foot]).filter(|t| (0.0..1.0).contains(t)));
        }
        Segment::Arc(arc) => {
            let apart = center - arc.center();
            let crossings = circles_meet(arc.radius(), apart, radius);
            let spokes = crossings.into_iter().flatten().chain([apart, -apart]);
            found.extend(spokes.filter_map(|spoke| place_on(arc, spoke)));
        }
    }
}

/// The fraction of the arc at which its circle meets the spoke; `None` if that is not on the arc.
fn place_on(arc: &PlaneArc, spoke: Vector2<f64>) -> Option<f64> {
    let t = arc.angle_to(spoke) / arc.turn().abs();
    (t < 1.0).then_some(t)
}

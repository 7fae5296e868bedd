//! RND and CHF: a rounding or a chamfer where two elements of the path meet.
//!
//! # Method
//! The arc of a rounding touches both elements. Its centre lies on the side to which the path turns, where
//! the two elements meet when they are offset by the radius: of such places, the one nearest to the corner.
//! A chamfer cuts the same length off both lines.

use nalgebra::Vector2;
use toolpathd_core::geometry::curve::Direction;
use toolpathd_core::geometry::plane::Plane;

use super::Execution;
use super::cursor::{Broken, Cursor};
use super::path::{Corner, NO_WAY_MM, PathElement, Turn, Way, in_plane};
use super::script::Block;
use super::words::{Feed, Sort};
use crate::fault::Fault;
use crate::offset_curve::{OffsetCurve, left_of};

/// Sines of angles that count as none: elements that meet at a smaller angle go on tangentially.
const NO_ANGLE: f64 = 1e-9;

/// How far a corner may exceed its elements, mm: rounding of coordinates.
const SLACK_MM: f64 = 1e-6;

/// An element in the plane: a line or an arc, with its ends.
#[derive(Debug, Clone, Copy)]
struct Flat {
    from: Vector2<f64>,
    to: Vector2<f64>,
    /// The centre, and whether it turns counterclockwise.
    about: Option<(Vector2<f64>, bool)>,
}

/// The ends of the piece that replaces a corner, and its centre if it is an arc.
struct Cut {
    ends: [Vector2<f64>; 2],
    center: Option<Vector2<f64>>,
}

impl<'a> Execution<'a, '_> {
    /// `RND R5` and `CHF 5`.
    pub(super) fn set_corner(&mut self, block: &Block<'a>, cursor: &mut Cursor<'_>, is_round: bool) {
        let size = self.corner_size(cursor, is_round);
        let words = self.scan(block, cursor, &[Sort::Feed]);
        let size_mm = match size {
            Ok(size) => size * self.machine.unit_mm(),
            Err(broken) => {
                self.refuse_broken(block, broken);
                return self.lose_place();
            }
        };
        let fault = match (words.feed, self.path.held, self.path.corner) {
            _ if size_mm <= 0.0 => Some(Fault::OutOfRange(size_mm)),
            (Some(Feed::Rapid), ..) | (_, _, Some(_)) => Some(Fault::Conflict),
            (_, None, _) => Some(Fault::Lacks("an element before it")),
            _ => None,
        };
        if let Some(fault) = fault.filter(|_| !words.is_broken) {
            if matches!(fault, Fault::Lacks(_)) {
                self.machine.refuse_state(block.line(), fault);
            } else {
                self.refuse_block(block, fault);
            }
            return self.lose_place();
        }
        let feed = self.rate_of(words.feed);
        self.path.corner = Some(Corner { line: block.line(), size_mm, is_round, feed });
    }

    fn corner_size(&self, cursor: &mut Cursor<'_>, is_round: bool) -> Result<f64, Broken> {
        cursor.skip_blanks();
        if is_round && !cursor.letters("R") {
            return Err(Broken {
                fault: Some(Fault::Missing('R')),
                start: cursor.at,
                end: cursor.word_end(),
            });
        }
        cursor.value(&self.parameters)
    }

    /// Follows `first` and the corner behind it, and lets `second` begin where the corner ends.
    pub(super) fn join(
        &mut self,
        block: &Block<'a>,
        first: PathElement<'a>,
        corner: &Corner<'a>,
        second: &mut PathElement<'a>,
    ) {
        let plane = self.machine.plane;
        let Some((factor, _)) = self.machine.placement.in_plane(plane) else {
            self.machine.refuse(corner.line.refused(Fault::Ellipse));
            return;
        };
        let flat = (Flat::of(&first, plane), Flat::of(second, plane));
        let is_known = !first.from.contains(&None) && !second.to.contains(&None);
        let (Some(a), Some(b), true) = (flat.0, flat.1, is_known) else {
            if is_known {
                self.machine.refuse(corner.line.refused(Fault::NotRead));
            } else {
                self.machine.refuse_state(block.line(), Fault::Lacks("a known start"));
            }
            return;
        };
        let cut = match corner.cut(a, b, factor) {
            Ok(cut) => cut,
            Err(fault) => return self.machine.refuse(corner.line.refused(fault)),
        };
        let Some(Cut { ends, center }) = cut else { return self.follow(first) };
        let [start, end] = ends.map(|place| {
            let [i, j, _] = plane.axes();
            let mut at = second.from;
            (at[i], at[j]) = (Some(place.x), Some(place.y));
            at
        });
        self.follow(PathElement { to: start, ..first });
        let way = match center {
            None => Way::Line,
            Some(center) => {
                let arm = ends[0] - center;
                let is_left = Vector2::new(-arm.y, arm.x).dot(&a.tangent_at(ends[0])) > 0.0;
                let direction = if is_left { Direction::Ccw } else { Direction::Cw };
                Way::Arc(Turn { plane, center: center.into(), direction, turns: 1 })
            }
        };
        let (feed_mode, feed) = corner.feed.map_or((first.feed_mode, first.feed), |(m, f)| (m, Some(f)));
        self.follow(PathElement { line: corner.line, from: start, to: end, way, feed, feed_mode });
        second.from = end;
    }
}

impl Corner<'_> {
    /// What replaces the corner. `None` where the elements go on tangentially.
    fn cut(&self, first: Flat, second: Flat, factor: f64) -> Result<Option<Cut>, Fault> {
        let [along, onward] = [first.tangent_at(first.to), second.tangent_at(second.from)];
        let turn = along.perp(&onward);
        if turn.abs() <= NO_ANGLE {
            return if along.dot(&onward) > 0.0 { Ok(None) } else { Err(Fault::NoCenter) };
        }
        let size = self.size_mm * factor;
        if !self.is_round {
            if first.about.is_some() || second.about.is_some() {
                return Err(Fault::NotRead);
            }
            let ends = [first.to - along * size, second.from + onward * size];
            let fits = first.has(ends[0]) && second.has(ends[1]);
            return if fits {
                Ok(Some(Cut { ends, center: None }))
            } else {
                Err(Fault::OutOfRange(self.size_mm))
            };
        }
        let distance = size * turn.signum();
        let corner = first.to;
        let mut places = first.offset(distance).crossings(second.offset(distance), 0.0);
        places.retain(|center| first.has(first.foot(*center)) && second.has(second.foot(*center)));
        places.sort_by(|a, b| (a - corner).norm().total_cmp(&(b - corner).norm()));
        let center = *places.first().ok_or(Fault::OutOfRange(self.size_mm))?;
        Ok(Some(Cut { ends: [first.foot(center), second.foot(center)], center: Some(center) }))
    }
}

impl Flat {
    /// An element that lies in the plane, and is neither a rapid nor a helix.
    fn of(element: &PathElement<'_>, plane: Plane) -> Option<Self> {
        let n = plane.axes()[2];
        if element.from[n] != element.to[n] {
            return None;
        }
        let about = match element.way {
            Way::Rapid => return None,
            Way::Line => None,
            Way::Arc(turn) if turn.plane == plane && turn.turns == 1 => {
                Some((Vector2::from(turn.center), turn.direction == Direction::Ccw))
            }
            Way::Arc(_) => return None,
        };
        let flat = Self { from: in_plane(&element.from, plane)?, to: in_plane(&element.to, plane)?, about };
        let is_long = (flat.to - flat.from).norm() > NO_WAY_MM;
        is_long.then_some(flat)
    }

    /// The unit tangent where the element passes `at`.
    fn tangent_at(&self, at: Vector2<f64>) -> Vector2<f64> {
        let along = match self.about {
            None => self.to - self.from,
            Some((center, is_left)) => {
                let arm = at - center;
                let left = left_of(arm);
                if is_left { left } else { -left }
            }
        };
        along.try_normalize(f64::MIN_POSITIVE).unwrap_or_default()
    }

    /// The element moved to its left.
    fn offset(&self, distance: f64) -> OffsetCurve {
        match self.about {
            None => {
                let along = self.tangent_at(self.from);
                OffsetCurve::Line { at: self.from + left_of(along) * distance, along }
            }
            Some((center, is_left)) => {
                let radius = (self.to - center).norm();
                OffsetCurve::Circle {
                    center,
                    radius_mm: if is_left { radius - distance } else { radius + distance },
                }
            }
        }
    }

    /// The place of the element's line or circle nearest to `at`.
    fn foot(&self, at: Vector2<f64>) -> Vector2<f64> {
        match self.about {
            None => {
                let along = self.tangent_at(self.from);
                self.from + along * along.dot(&(at - self.from))
            }
            Some((center, _)) => {
                let arm = (at - center).try_normalize(f64::MIN_POSITIVE).unwrap_or_default();
                center + arm * (self.to - center).norm()
            }
        }
    }

    /// Whether a place of its line or circle lies between the ends.
    fn has(&self, at: Vector2<f64>) -> bool {
        match self.about {
            None => {
                let along = self.tangent_at(self.from);
                let way = along.dot(&(at - self.from));
                (-SLACK_MM..=(self.to - self.from).norm() + SLACK_MM).contains(&way)
            }
            Some((center, is_left)) => {
                let angle = |to: Vector2<f64>| {
                    let (from, to) = (self.from - center, to - center);
                    let angle = from.perp(&to).atan2(from.dot(&to));
                    if is_left { angle } else { -angle }.rem_euclid(std::f64::consts::TAU)
                };
                angle(at) <= angle(self.to)
            }
        }
    }
}

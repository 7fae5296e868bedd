//! Corners between two blocks: RND and RNDM round them, CHF and CHR cut them off.
//!
//! # Method
//! 1. A block with a corner at its end waits for the next block of the plane.
//! 2. The centre of a rounding lies at its radius from both paths, on the side to which the path turns. It is
//!    a crossing of the two paths moved by the radius to that side.
//! 3. Both paths end and begin at the feet of the centre. A corner that does not fit is refused.
//!
//! # Differences from the control
//! A corner without a feed of its own (FRC, FRCM) has that of the block before; machine data 20201 decides.

use nalgebra::Vector2;
use toolpathd_core::geometry::curve::Direction;
use toolpathd_core::geometry::plane::Plane;

use super::Mill;
use super::corner_geometry::{Path, chamfer, rounding};
use crate::block::Line;
use crate::codes::FeedMode;
use crate::fault::Fault;
use crate::machine::At;

/// A shorter way is none, mm.
pub(super) const NO_WAY_MM: f64 = 1e-9;

/// The way of a cut in the plane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Shape {
    Line,
    /// About a centre in coordinates of the answer, in the sense of the program.
    Arc {
        center: [f64; 2],
        direction: Direction,
        turns: usize,
    },
}

/// What becomes of a corner; lengths in mm of the program.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Kind {
    /// An arc of this radius.
    Round(f64),
    /// A chamfer of this width.
    Width(f64),
    /// A chamfer that takes this length of both ways.
    Leg(f64),
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Corner {
    pub kind: Kind,
    pub feed: Option<f64>,
    /// The word of the block; `None` where RNDM asks for the corner.
    pub span: Option<[usize; 2]>,
}

/// A cut whose end waits for the next block.
#[derive(Debug, Clone, Copy)]
pub struct Pending<'a> {
    line: Line<'a>,
    from: At,
    to: At,
    shape: Shape,
    corner: Corner,
    plane: Plane,
    feed: Option<f64>,
    speed: Option<f64>,
    is_turning: bool,
}

impl<'a> Mill<'a, '_> {
    /// Cuts to `to`, or holds the cut back until its corner is known.
    pub(super) fn follow(&mut self, line: Line<'a>, to: At, shape: Shape, corner: Option<Corner>) {
        let has_way = shape != Shape::Line
            || (0..3).any(|k| match (self.machine.at[k], to[k]) {
                (Some(from), Some(to)) => (from - to).abs() > NO_WAY_MM,
                _ => true,
            });
        if !has_way {
            // A block without a way has no corner.
            return self.machine.line(line, to);
        }
        if self.pending.is_some() && !self.is_in_plane(&to) {
            self.settle_across(line);
        }
        if let Some(pending) = self.pending.take() {
            self.join(pending, &to, shape);
        }
        let from = self.machine.at;
        let is_known = !from.contains(&None) && !to.contains(&None);
        match corner {
            Some(corner) if is_known && self.is_in_plane(&to) => {
                if self.machine.feed_mode == FeedMode::InverseTime {
                    self.refuse(line, corner.span.unwrap_or([0, line.text.len()]), Fault::Conflict);
                }
                let machine = &self.machine;
                let (plane, feed) = (machine.plane, machine.feed);
                let (speed, is_turning) = (machine.speed, machine.is_turning);
                self.pending =
                    Some(Pending { line, from, to, shape, corner, plane, feed, speed, is_turning });
                self.machine.at = to;
            }
            Some(Corner { span: Some(span), .. }) if is_known => self.refuse(line, span, Fault::NoCorner),
            _ => self.run_cut(line, to, shape),
        }
    }

    /// Whether a way to `to` stays in the plane.
    fn is_in_plane(&self, to: &At) -> bool {
        let normal = self.machine.plane.axes()[2];
        self.machine.at[normal] == to[normal]
    }

    fn run_cut(&mut self, line: Line<'a>, to: At, shape: Shape) {
        let from = self.machine.at;
        self.tangent = self.arrives(&from, &to, shape);
        match shape {
            Shape::Line => self.machine.line(line, to),
            Shape::Arc { center, direction, turns } => {
                self.machine.arc_about(line, to, center, direction, turns);
            }
        }
    }

    /// The direction in the plane in which a cut arrives.
    fn arrives(&self, from: &At, to: &At, shape: Shape) -> Option<[f64; 2]> {
        let path = self.path(from, to, shape)?;
        let direction = path.direction_at(&path.end)?;
        Some([direction.x, direction.y])
    }

    /// A cut as a path in the plane; `None` where its ends are not known.
    fn path(&self, from: &At, to: &At, shape: Shape) -> Option<Path> {
        let [a, b, _] = self.machine.plane.axes();
        let in_plane = |at: &At| at[a].zip(at[b]).map(|(x, y)| Vector2::new(x, y));
        let arc = match shape {
            Shape::Line => None,
            Shape::Arc { center, direction, .. } => {
                Some((Vector2::from(center), self.runs(direction) == Direction::Ccw))
            }
        };
        Some(Path { start: in_plane(from)?, end: in_plane(to)?, arc })
    }

    /// The sense of an arc of the program where it lies. The same map gives the sense of the program.
    pub(super) fn runs(&self, direction: Direction) -> Direction {
        match (self.machine.placement.in_plane(self.machine.plane), direction) {
            (Some((_, true)), Direction::Cw) => Direction::Ccw,
            (Some((_, true)), Direction::Ccw) => Direction::Cw,
            _ => direction,
        }
    }

    /// Runs a cut that has waited, its corner, and leaves the tool where the next cut begins.
    fn join(&mut self, pending: Pending<'a>, to: &At, shape: Shape) {
        let [a, b, n] = pending.plane.axes();
        let paths =
            self.path(&pending.from, &pending.to, pending.shape).zip(self.path(&pending.to, to, shape));
        let (Some((before, after)), Some((factor, _))) =
            (paths, self.machine.placement.in_plane(pending.plane))
        else {
            let is_even = self.machine.placement.in_plane(pending.plane).is_some();
            if let Some(span) = pending.corner.span.filter(|_| !is_even) {
                self.refuse(pending.line, span, Fault::Ellipse);
            }
            return self.run_waiting(&pending, None);
        };
        let cut = match pending.corner.kind {
            Kind::Round(mm) => rounding(&before, &after, mm * factor),
            Kind::Width(mm) => chamfer(&before, &after, mm * factor, true),
            Kind::Leg(mm) => chamfer(&before, &after, mm * factor, false),
        };
        let joint = match cut {
            Ok(joint) => joint,
            Err(()) => {
                let span = pending.corner.span.unwrap_or([0, pending.line.text.len()]);
                self.refuse(pending.line, span, Fault::NoCorner);
                None
            }
        };
        let Some(joint) = joint else { return self.run_waiting(&pending, None) };
        let place = |p: Vector2<f64>| {
            let mut at = pending.to;
            (at[a], at[b], at[n]) = (Some(p.x), Some(p.y), pending.to[n]);
            at
        };
        let shape = match joint.center {
            None => Shape::Line,
            Some((center, is_left)) => {
                let direction = self.runs(if is_left { Direction::Ccw } else { Direction::Cw });
                Shape::Arc { center: center.into(), direction, turns: 1 }
            }
        };
        self.run_waiting(&pending, Some((place(joint.first), place(joint.second), shape)));
    }

    /// Runs a cut that has waited, to its end or to its corner, with the feed of its block.
    fn run_waiting(&mut self, pending: &Pending<'a>, corner: Option<(At, At, Shape)>) {
        let machine = &mut self.machine;
        let now = (machine.feed, machine.speed, machine.is_turning);
        (machine.feed, machine.speed, machine.is_turning) = (pending.feed, pending.speed, pending.is_turning);
        machine.at = pending.from;
        let line = pending.line;
        match corner {
            None => self.run_cut(line, pending.to, pending.shape),
            Some((first, second, shape)) => {
                self.run_cut(line, first, pending.shape);
                if let Some(feed) = pending.corner.feed {
                    self.machine.feed = Some(feed);
                }
                self.run_cut(line, second, shape);
            }
        }
        (self.machine.feed, self.machine.speed, self.machine.is_turning) = now;
    }

    /// Ends a cut that waits for its corner where the next block is none of the plane: what the control does
    /// there is not certain.
    pub(super) fn settle(&mut self, _: Line<'a>) {
        if let Some(pending) = self.pending.take() {
            let span = pending.corner.span.unwrap_or([0, pending.line.text.len()]);
            self.refuse(pending.line, span, Fault::NoCorner);
            self.run_waiting(&pending, None);
        }
    }

    /// As [`Mill::settle`] before a cut that leaves the plane, where RNDM rounds nothing.
    fn settle_across(&mut self, line: Line<'a>) {
        self.finish_corner();
        self.settle(line);
    }

    /// Ends a cut that waits for a corner of RNDM. A corner of its own block stays open.
    pub(super) fn finish_corner(&mut self) {
        if let Some(pending) = self.pending.take_if(|pending| pending.corner.span.is_none()) {
            self.run_waiting(&pending, None);
        }
    }
}

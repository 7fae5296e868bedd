//! The elements of the path, one at a time.
//!
//! # Method
//! An element is held back until the next block, because RND or CHF may cut its end off. The place of the
//! machine is the end of the element that is held back. [`Execution::settle`] sends it to the machine.

use nalgebra::{Point3, Vector2};
use toolpathd_core::geometry::curve::Direction;
use toolpathd_core::geometry::plane::Plane;

use super::script::Block;
use super::{Approach, Execution};
use crate::block::Line;
use crate::codes::FeedMode;
use crate::fault::Fault;
use crate::machine::{At, Machine};

/// Ends that are nearer have no direction, mm. Sums of coordinates differ by some 1e-12 mm.
pub const NO_WAY_MM: f64 = 1e-9;

/// A straight line or an arc of the path, with its ends in coordinates of the answer.
#[derive(Debug, Clone, Copy)]
pub struct PathElement<'a> {
    pub line: Line<'a>,
    pub from: At,
    pub to: At,
    pub way: Way,
    pub feed: Option<f64>,
    pub feed_mode: FeedMode,
}

/// How an element gets to its end.
#[derive(Debug, Clone, Copy)]
pub enum Way {
    Rapid,
    Line,
    Arc(Turn),
}

/// An arc about a centre.
#[derive(Debug, Clone, Copy)]
pub struct Turn {
    pub plane: Plane,
    /// Along the axes of the plane.
    pub center: [f64; 2],
    /// As seen in the coordinates of the answer.
    pub direction: Direction,
    pub turns: usize,
}

/// A corner that the next element completes.
#[derive(Debug, Clone, Copy)]
pub struct Corner<'a> {
    pub line: Line<'a>,
    /// The radius, or the length of the chamfer along both elements, mm of the program.
    pub size_mm: f64,
    pub is_round: bool,
    pub feed: Option<(FeedMode, f64)>,
}

/// The element that waits for the next block, and the corner at its end.
#[derive(Debug, Default)]
pub struct Path<'a> {
    pub held: Option<PathElement<'a>>,
    pub corner: Option<Corner<'a>>,
    /// An approach that the next element completes.
    pub approach: Option<Approach<'a>>,
    /// The last element was a rapid.
    pub ends_rapid: bool,
    /// The plane and the direction in it with which the last element ends.
    tangent: Option<(Plane, Vector2<f64>)>,
}

impl PathElement<'_> {
    /// The unit tangents in a plane at the start and at the end. `None` where the element has none there.
    pub fn tangents(&self, plane: Plane) -> Option<[Vector2<f64>; 2]> {
        let [from, to] = [in_plane(&self.from, plane)?, in_plane(&self.to, plane)?];
        match self.way {
            Way::Arc(turn) if turn.plane == plane => {
                let center = Vector2::from(turn.center);
                let tangent = |at: Vector2<f64>| {
                    let arm = at - center;
                    let left = Vector2::new(-arm.y, arm.x);
                    let along = if turn.direction == Direction::Ccw { left } else { -left };
                    along.try_normalize(NO_WAY_MM)
                };
                Some([tangent(from)?, tangent(to)?])
            }
            Way::Arc(_) => None,
            _ => (to - from).try_normalize(NO_WAY_MM).map(|along| [along, along]),
        }
    }
}

impl<'a> Execution<'a, '_> {
    /// An element from where the tool stands, at the feed in force.
    pub(super) fn element(&self, block: &Block<'a>, to: At, way: Way) -> PathElement<'a> {
        let Machine { at, feed, feed_mode, .. } = *self.machine;
        PathElement { line: block.line(), from: at, to, way, feed, feed_mode }
    }

    /// Goes on by an element, behind the corner that the last block has stated.
    pub(super) fn advance(&mut self, block: &Block<'a>, mut element: PathElement<'a>) {
        if let Some(approach) = self.path.approach.take()
            && !self.run_approach(&approach, &element)
        {
            return self.lose_place();
        }
        match (self.path.corner.take(), self.path.held.take()) {
            (Some(corner), Some(held)) => self.join(block, held, &corner, &mut element),
            (_, Some(held)) => self.follow(held),
            _ => {}
        }
        self.machine.at = element.to;
        self.path.ends_rapid = matches!(element.way, Way::Rapid);
        self.path.held = Some(element);
    }

    /// Sends the waiting element to the machine. Refuses a corner behind which no element comes.
    pub(super) fn settle(&mut self) {
        if let Some(corner) = self.path.corner.take() {
            self.machine.refuse(corner.line.refused(Fault::Lacks("the next element")));
        }
        let Some(held) = self.path.held.take() else { return };
        let plane = self.machine.plane;
        self.path.tangent = held.tangents(plane).map(|tangents| (plane, tangents[1]));
        self.follow(held);
    }

    /// Sends an element to the machine, whose place stays the one that the program has reached.
    pub(super) fn follow(&mut self, element: PathElement<'a>) {
        let PathElement { line, from, to, way, feed, feed_mode } = element;
        let (at, now) = (self.machine.at, (self.machine.feed, self.machine.feed_mode, self.machine.plane));
        self.machine.at = from;
        (self.machine.feed, self.machine.feed_mode) = (feed, feed_mode);
        match way {
            Way::Rapid => self.machine.rapid(line, to),
            Way::Line => self.machine.line(line, to),
            Way::Arc(turn) => {
                self.machine.plane = turn.plane;
                let direction = self.sense(turn.plane, turn.direction);
                self.machine.arc_about(line, to, turn.center, direction, turn.turns);
            }
        }
        self.machine.at = at;
        (self.machine.feed, self.machine.feed_mode, self.machine.plane) = now;
    }

    /// A sense of the program in coordinates of the answer, and back.
    pub(super) fn sense(&self, plane: Plane, direction: Direction) -> Direction {
        let is_mirrored = self.machine.placement.in_plane(plane).is_some_and(|(_, mirrored)| mirrored);
        match (is_mirrored, direction) {
            (false, direction) => direction,
            (true, Direction::Cw) => Direction::Ccw,
            (true, Direction::Ccw) => Direction::Cw,
        }
    }

    /// The direction with which the last element ends in the plane of the tool.
    pub(super) fn tangent(&self) -> Option<Vector2<f64>> {
        self.path.tangent.filter(|(plane, _)| *plane == self.machine.plane).map(|(_, along)| along)
    }

    /// The direction of the last element counts no more.
    pub(super) fn forget_tangent(&mut self) {
        self.path.tangent = None;
    }

    /// The place is not known any more, because a block that moves was refused.
    pub(super) fn lose_place(&mut self) {
        self.path = Path::default();
        self.machine.at = [None; 3];
    }

    /// The start and the end of a cut in the plane of the tool. Where one is not known, the cut is refused.
    pub(super) fn known_ends(&mut self, block: &Block<'a>, to: &At) -> Option<[Point3<f64>; 2]> {
        self.machine.ends(block.line(), to)
    }
}

/// A place along the axes of a plane, if it is known.
pub fn in_plane(at: &At, plane: Plane) -> Option<Vector2<f64>> {
    let [a, b, _] = plane.axes();
    Some(Vector2::new(at[a]?, at[b]?))
}

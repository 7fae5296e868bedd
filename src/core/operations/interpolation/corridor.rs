//! Finds the fewest lines from end to end of a band, if their joints may lie anywhere in the band.
//!
//! # Method
//! 1. Lay many straight gates across the band, from its left edge to its right edge. The left ends of the
//!    gates are the points of one chain, and the right ends those of another chain. A *corridor* is the
//!    region between two such chains.
//! 2. Bound the distance between the edges of the band and the chains. Moved inward by this bound, the chains
//!    enclose the inner corridor, which lies inside the band. Moved outward by it, they enclose the outer
//!    corridor, which contains the band.
//! 3. In each corridor, find the line from the start that leads farthest. Every path to the end of the
//!    corridor crosses the last stretch of this line: from the last chain point that the line touches to the
//!    end of the line. Among all lines that start on this stretch, find the one that leads farthest. Go on in
//!    the same way to the end.
//! 4. In the inner corridor, place a joint wherever two successive lines meet.
//!
//! # Guarantees
//! * The number of lines through the outer corridor is a lower bound for the number of lines of every path
//!   within the band.
//! * The lines through the inner corridor are a candidate: the caller still has to prove that they stay
//!   within the band.
//! * If the band folds, or turns back within the reach of one line, no path is returned, and the lower bound
//!   is 1.
//!
//! # Reference
//! S. Suri, *A linear time algorithm for minimum link paths inside a simple polygon*, CVGIP 35, 1986.

mod gates;

use nalgebra::{Point2, Vector2};

use crate::budget::{Budget, Stopped};
use crate::geometry::deviation::{Band, GUARD_MM, GUARD_PART, Measure};
use crate::geometry::plane_curve::PlaneCurve;
use crate::geometry::solve::{TO_ROUNDING, bisect};
use gates::Gate;

/// Points of a chain between two checks of the budget.
const GATES_BETWEEN_CHECKS: usize = 1024;

/// A point counts as on a line if it lies beside it by at most this share of its place along the line. The
/// last gate needs this, because it is a point of both chains.
const ROUNDING: f64 = 1e-13;

/// How far beyond an end of its window a point still counts as in the window, as a share of the window. A
/// joint may lie at an end itself, and is then on either side by rounding.
const AT_END: f64 = 1e-9;

/// A band as a sequence of gates.
pub struct Corridor {
    gates: Vec<Gate>,
    band: Band,
    /// Whether the tangent jumps somewhere: there the gates do not span the band.
    has_corner: bool,
}

/// Which corridor is meant: the one inside the band, or the one that holds the band.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Edges {
    Inside,
    Outside,
}

/// A joint beside the curve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Joint {
    pub at: Point2<f64>,
    /// The curve parameter on whose normal, or vertical, the joint lies.
    pub t: f64,
    /// How far the joint lies to the left of the curve, mm.
    pub offset_mm: f64,
}

impl Corridor {
    /// A lower bound for the number of lines of a path within the band. It is 1 if the curve has a corner and
    /// the band is measured along the normal.
    ///
    /// # Errors
    /// When the budget ends.
    pub fn fewest(&self, curve: &impl PlaneCurve, budget: &Budget) -> Result<usize, Stopped> {
        if self.has_corner && self.band.measure == Measure::Normal {
            return Ok(1);
        }
        Ok(self.links(curve, Edges::Outside, budget)?.map_or(1, |links| links.len()))
    }

    /// The joints of a path with the fewest lines from the first gate to the last, both ends included; `None`
    /// if none is found.
    ///
    /// # Errors
    /// When the budget ends.
    pub fn path(&self, curve: &impl PlaneCurve, budget: &Budget) -> Result<Option<Vec<Joint>>, Stopped> {
        Ok(self.links(curve, Edges::Inside, budget)?.and_then(|links| self.joints(&links, curve)))
    }

    fn links(
        &self,
        curve: &impl PlaneCurve,
        edges: Edges,
        budget: &Budget,
    ) -> Result<Option<Vec<PathLine>>, Stopped> {
        let [left, right] = self.chains(edges);
        if left.iter().chain(&right).any(|p| !(p.x.is_finite() && p.y.is_finite())) {
            return Ok(None);
        }
        let mut walk = Walk { left: &left, right: &right, links: Vec::new() };
        // The direction from which a link is built: all points that the link can pass lie ahead of its start.
        let ahead = |gate: usize| match self.band.measure {
            Measure::Vertical => Vector2::x(),
            Measure::Normal => curve.derivative(self.gates[gate].t),
        };
        let is_through = walk.walk(ahead, budget)?;
        Ok(is_through.then_some(walk.links))
    }

    /// The left and the right chain. The first and the last gate are points of the curve.
    fn chains(&self, edges: Edges) -> [Vec<Point2<f64>>; 2] {
        let last = self.gates.len() - 1;
        let outward = |k: usize| {
            let bulge = self.gates[k].bulge_mm.max(if k > 0 { self.gates[k - 1].bulge_mm } else { 0.0 });
            match edges {
                Edges::Inside => -bulge,
                // An element that the proof accepts may lie outside the band by rounding.
                Edges::Outside => bulge + 2.0 * (GUARD_MM + GUARD_PART * self.gates[k].point.coords.amax()),
            }
        };
        let chain = |side: f64, width: f64| {
            let gates = self.gates.iter().enumerate();
            gates
                .map(|(k, gate)| {
                    let is_end = k == 0 || k == last;
                    if is_end { gate.point } else { gate.point + gate.across * (side * (width + outward(k))) }
                })
                .collect()
        };
        [chain(1.0, self.band.above_mm), chain(-1.0, self.band.below_mm)]
    }

    /// The joints, at which the lines of successive links meet.
    fn joints(&self, links: &[PathLine], curve: &impl PlaneCurve) -> Option<Vec<Joint>> {
        let end = |gate: &Gate| Joint { at: gate.point, t: gate.t, offset_mm: 0.0 };
        let mut joints = vec![end(self.gates.first()?)];
        for pair in links.windows(2) {
            let (before, after) = (&pair[0], &pair[1]);
            let sine = before.along.perp(&after.along);
            let part = (after.through - before.through).perp(&after.along) / sine;
            let at = before.through + before.along * part;
            // The meeting point of nearly parallel lines is not reliable: the end of the window serves as the
            // joint instead.
            let at = if part.is_finite() && before.is_in_window(&at) { at } else { before.exit };
            let joint = self.place(at, before.gates, curve)?;
            if joint.t <= joints[joints.len() - 1].t {
                return None;
            }
            joints.push(joint);
        }
        joints.push(end(self.gates.last()?));
        let is_rising = joints.windows(2).all(|pair| pair[0].t < pair[1].t);
        is_rising.then_some(joints)
    }

    /// The joint at `at`: its parameter is that on whose normal `at` lies, between two gates or a little
    /// beside them. `None` if there is no such parameter.
    fn place(&self, at: Point2<f64>, [first, last]: [usize; 2], curve: &impl PlaneCurve) -> Option<Joint> {
        if self.band.measure == Measure::Vertical {
            return Some(Joint { at, t: at.x, offset_mm: at.y - curve.point(at.x).y });
        }
        let low = self.gates[first.saturating_sub(2)].t;
        let high = self.gates[(last + 2).min(self.gates.len() - 1)].t;
        let ahead = |t: f64| (at - curve.point(t)).dot(&curve.derivative(t));
        if !(ahead(low) >= 0.0 && ahead(high) <= 0.0) {
            return None;
        }
        let [t, _] = bisect([low, high], TO_ROUNDING, |t| ahead(t) > 0.0);
        let from = at - curve.point(t);
        let offset_mm = from.norm().copysign(curve.derivative(t).perp(&from));
        Some(Joint { at, t, offset_mm })
    }
}

/// One line of a path, and the window on it to the next line.
#[derive(Debug, Clone, Copy)]
struct PathLine {
    through: Point2<f64>,
    along: Vector2<f64>,
    /// The last point at which the line touches a chain, and the place where it leaves the corridor.
    touch: Point2<f64>,
    exit: Point2<f64>,
    /// The gates between which the window lies.
    gates: [usize; 2],
}

impl PathLine {
    fn is_in_window(&self, p: &Point2<f64>) -> bool {
        let place = |q: &Point2<f64>| (q - self.through).dot(&self.along);
        let (from, to, at) = (place(&self.touch), place(&self.exit), place(p));
        let slack = AT_END * (to - from).abs();
        from.min(to) - slack <= at && at <= from.max(to) + slack
    }
}

/// A point of a chain with its gate; x is its place along the link, y its distance to the left of the link.
#[derive(Debug, Clone, Copy)]
struct Vertex {
    gate: usize,
    at: Point2<f64>,
    x: f64,
    y: f64,
}

/// The line through the first and the last point of the chains that it touches.
#[derive(Debug, Clone, Copy)]
struct Touching {
    first: Vertex,
    last: Vertex,
    /// The index of `last` in the list of its side.
    index: usize,
}

impl Touching {
    fn height(&self, x: f64) -> f64 {
        self.first.y + (self.last.y - self.first.y) / (self.last.x - self.first.x) * (x - self.first.x)
    }
}

/// All lines with the points `left` on their left and the points `right` on their right. Only the two
/// outermost are kept (J. O'Rourke, *An on-line algorithm for fitting straight lines between data ranges*,
/// CACM 24, 1981).
#[derive(Debug, Default)]
struct Bundle {
    left: Vec<Vertex>,
    right: Vec<Vertex>,
    /// The line that turns most to the left: it touches the right chain, then the left.
    steepest: Option<Touching>,
    /// The line that turns most to the right.
    flattest: Option<Touching>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Side {
    Left,
    Right,
}

impl Bundle {
    /// Adds a point of a chain; returns `false` if no line is left.
    fn take(&mut self, side: Side, vertex: Vertex) -> bool {
        // The right side is treated as the left side of a mirror image.
        let (own, other, sign) = match side {
            Side::Left => (&mut self.left, &self.right, 1.0),
            Side::Right => (&mut self.right, &self.left, -1.0),
        };
        let (near, far) = match side {
            Side::Left => (&mut self.steepest, &self.flattest),
            Side::Right => (&mut self.flattest, &self.steepest),
        };
        if far.is_some_and(|line| sign * (vertex.y - line.height(vertex.x)) < -ROUNDING * vertex.x.abs()) {
            return false;
        }
        if near.is_none_or(|line| sign * (vertex.y - line.height(vertex.x)) < 0.0) {
            let slope = |from: &Vertex| sign * (vertex.y - from.y) / (vertex.x - from.x);
            let before = other.iter().filter(|from| from.x < vertex.x);
            if let Some(first) = before.min_by(|a, b| slope(a).total_cmp(&slope(b))) {
                *near = Some(Touching { first: *first, last: vertex, index: own.len() });
            }
        }
        own.push(vertex);
        true
    }
}

/// The rest of a chain from the window of a link on: first a few points, then the points of the gates from
/// `next` on.
struct Rest<'a> {
    first: Vec<(usize, Point2<f64>)>,
    chain: &'a [Point2<f64>],
    next: usize,
    /// How many points have been taken.
    taken: usize,
}

impl<'a> Rest<'a> {
    fn new(first: Vec<(usize, Point2<f64>)>, chain: &'a [Point2<f64>], next: usize) -> Self {
        Self { first, chain, next, taken: 0 }
    }

    fn peek(&self) -> Option<(usize, Point2<f64>)> {
        let gate = self.next + self.taken.saturating_sub(self.first.len());
        self.first.get(self.taken).copied().or_else(|| Some((gate, *self.chain.get(gate)?)))
    }

    /// The points not yet taken, after some other points.
    fn behind(&self, mut points: Vec<(usize, Point2<f64>)>) -> Self {
        points.extend(self.first.iter().skip(self.taken));
        Self::new(points, self.chain, self.next + self.taken.saturating_sub(self.first.len()))
    }
}

struct Walk<'a> {
    left: &'a [Point2<f64>],
    right: &'a [Point2<f64>],
    links: Vec<PathLine>,
}

impl Walk<'_> {
    /// Finds the links; returns `false` if no line leads on.
    fn walk(&mut self, ahead: impl Fn(usize) -> Vector2<f64>, budget: &Budget) -> Result<bool, Stopped> {
        let start = (0, self.left[0]);
        let (mut left, mut right) =
            (Rest::new(vec![start], self.left, 1), Rest::new(vec![start], self.right, 1));
        let mut origin = start;
        let mut taken = 0usize;
        while self.links.len() <= self.left.len() {
            budget.check()?;
            let along = ahead(origin.0).normalize();
            let vertex = |(gate, at): (usize, Point2<f64>)| {
                let from = at - origin.1;
                Vertex { gate, at, x: along.dot(&from), y: along.perp(&from) }
            };
            let mut bundle = Bundle::default();
            // Take the points of both chains in order of their place along the link.
            let blocked = loop {
                let (side, next) = match (left.peek().map(vertex), right.peek().map(vertex)) {
                    (Some(l), Some(r)) if l.x <= r.x => (Side::Left, l),
                    (_, Some(r)) => (Side::Right, r),
                    (Some(l), None) => (Side::Left, l),
                    (None, None) => break None,
                };
                taken += 1;
                if taken.is_multiple_of(GATES_BETWEEN_CHECKS) {
                    budget.check()?;
                }
                if !bundle.take(side, next) {
                    break Some((side, next));
                }
                match side {
                    Side::Left => left.taken += 1,
                    Side::Right => right.taken += 1,
                }
            };
            let Some((side, blocked)) = blocked else {
                let (Some(steepest), Some(flattest)) = (bundle.steepest, bundle.flattest) else {
                    return Ok(false);
                };
                self.finish(self.left.len() - 1, steepest, flattest);
                return Ok(true);
            };
            // The line that turns farthest away from the blocking point reaches farthest.
            let (line, own, other) = match side {
                Side::Left => (bundle.flattest, &bundle.left, &bundle.right),
                Side::Right => (bundle.steepest, &bundle.right, &bundle.left),
            };
            let (Some(line), Some(before)) = (line, own.last()) else { return Ok(false) };
            let (above, below) = (before.y - line.height(before.x), blocked.y - line.height(blocked.x));
            let part = above / (above - below);
            if !part.is_finite() {
                return Ok(false);
            }
            let exit = before.at + (blocked.at - before.at) * part.clamp(0.0, 1.0);
            let touch = line.last;
            self.links.push(PathLine {
                through: line.first.at,
                along: (touch.at - line.first.at).normalize(),
                touch: touch.at,
                exit,
                gates: [touch.gate, blocked.gate],
            });
            origin = (blocked.gate, touch.at);
            let touched: Vec<_> = other[line.index..].iter().map(|v| (v.gate, v.at)).collect();
            let exit = vec![(before.gate, exit)];
            (left, right) = match side {
                Side::Left => (left.behind(exit), right.behind(touched)),
                Side::Right => (left.behind(touched), right.behind(exit)),
            };
        }
        Ok(false)
    }

    /// Adds the last link, which ends at the last gate, halfway between the two outermost lines that reach
    /// that gate.
    fn finish(&mut self, last: usize, steepest: Touching, flattest: Touching) {
        let end = self.left[last];
        let direction = |line: Touching| (line.last.at - line.first.at).normalize();
        let along = (direction(steepest) + direction(flattest)).normalize();
        self.links.push(PathLine { through: end, along, touch: end, exit: end, gates: [last, last] });
    }
}

//! The angle of a cutter in the material, along a path in the plane: how much of the leading half of the
//! cutter's circle touches material that nothing has removed yet.
//!
//! # Method
//! 1. The path so far is kept as chords ([`Swept`]). The stadium of a chord is the set of places that are
//!    nearer to the chord than the cutter's radius less the height of the path over the chord. The cutter has
//!    removed all material in the stadiums. A line is kept as one long chord. An arc is kept as a few long
//!    chords, and also as many short chords. The short chords are used only where the long chords leave
//!    material.
//! 2. At a place of the path, the leading half of the circle consists of the points whose direction from the
//!    centre makes at most a right angle with the motion. A chord frees the points of this half circle that
//!    lie inside its stadium. These points form ranges, which have a closed form (`spans`).
//! 3. A stretch is a part of a motion. On a straight stretch, each point of the circle moves along a line. A
//!    stadium is convex, so a point that is inside a stadium at both ends of the stretch is inside this
//!    stadium all along the stretch. On a stretch of an arc, the points of the circle move on arcs about the
//!    same centre. These arcs stay within a known height of their chords, so the radius of the stadium is
//!    made smaller by this height.
//! 4. A point that no single stadium contains at both ends of the stretch counts as a point in material. The
//!    angle of all these points is the bound of the stretch. A stretch is halved until its bound is low
//!    enough for the caller ([`Enough`]), or at most a degree above the larger angle at its ends, or until
//!    the stretch is no longer than a hundredth of the radius.
//!
//! # Guarantees
//! The bound of a stretch is never below the true angle at any place of the stretch, except for rounding. A
//! bound that is low enough for the caller is not made exact. Any other bound exceeds the largest true angle
//! of the stretch by about a degree. The excess is larger in two cases:
//! * Where material begins or ends, the excess is up to the change of the angle along a hundredth of the
//!   radius.
//! * Beside thin slivers, the excess is several degrees, because chords stand for arcs.
//!
//! # Cost
//! O(m) for each stretch, where m is the number of chords within a diameter of the stretch.

mod bounds;
mod cells;
mod spans;
#[cfg(test)]
mod tests;

use nalgebra::{Point2, Vector2};

use crate::budget::{Budget, Stopped};
use crate::geometry::segment::{PlaneArc, Segment};
use cells::Cells;
use spans::Left;

/// The longest stretch, as a part of the radius.
const LONGEST: f64 = 4.0;

/// The largest turn of a stretch of an arc, radians.
const LARGEST_TURN: f64 = 0.5;

/// The largest height of an arc over the chords that stand for it, as a part of the radius: over the many
/// that show its edge, and over the few that are enough elsewhere.
const CHORD_HEIGHTS: [f64; 2] = [0.001, 0.02];

/// Long chords at a larger distance from the cutter's centre free no point of the cutter's circle, in radii.
/// Their short chords may be nearer by the height of the arc.
const REACH: f64 = 2.0 + CHORD_HEIGHTS[1];

/// The size of the cells in which long chords are searched, as a part of the radius.
const CELL: f64 = 0.5;

/// Material that is narrower across the motion does not count as such where the motion must be clear, as a
/// part of the radius. It is above what the heights of arcs leave beside the cutter.
const CLEAR_WIDTH: f64 = 0.008;

/// A line goes on in its direction if it comes back to the start of what was before this near, mm.
const STRAIGHT_ON_MM: f64 = 1e-9;

/// What the disc of a cutter has swept.
#[derive(Debug, Clone)]
pub struct Swept {
    radius_mm: f64,
    long_chords: Vec<LongChord>,
    /// The short chords of all arcs, in the order of the path.
    short_chords: Vec<Chord>,
    cells: Cells,
    /// Buffers that are used again.
    near: Vec<u32>,
    steps: usize,
    comparisons: u64,
}

/// A chord. All places that are nearer to the chord than the radius less `slack_mm` are free.
#[derive(Debug, Clone, Copy)]
struct Chord {
    start: Point2<f64>,
    end: Point2<f64>,
    /// The height of the arc over the chord, mm; zero for a line.
    slack_mm: f64,
}

/// A line of the path, or one of the few long chords of an arc of the path.
#[derive(Debug, Clone, Copy)]
struct LongChord {
    chord: Chord,
    /// The range of the short chords that show the same part of the arc more exactly; empty for a line.
    short: [u32; 2],
}

/// A part of a motion, between two fractions of its length.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stretch {
    pub from: f64,
    pub to: f64,
    /// Upper bound of the angle in material, radians, from 0 to pi.
    pub angle: f64,
    /// Upper bound of the width of the material across the motion, as a part of the radius.
    width: f64,
}

/// What need not be known more exactly.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Enough {
    /// Angles of at most this, radians.
    Angle(f64),
    /// Motion without material.
    Clear,
}

impl Stretch {
    fn new([from, to]: [f64; 2], left: Left) -> Self {
        Self { from, to, angle: left.angle, width: left.width }
    }

    /// Whether there is no material along the stretch.
    pub fn is_clear(&self) -> bool {
        self.width <= CLEAR_WIDTH
    }
}

impl Enough {
    fn is_met(self, left: Left) -> bool {
        match self {
            Self::Angle(angle) => left.angle <= angle,
            Self::Clear => left.width <= CLEAR_WIDTH,
        }
    }
}

/// The angle in material of a cutter that follows a straight pass beside cut material, radians. It cuts a
/// strip of the width `stepover_mm`.
pub fn straight_angle(radius_mm: f64, stepover_mm: f64) -> f64 {
    (1.0 - stepover_mm / radius_mm).clamp(-1.0, 1.0).acos()
}

impl Swept {
    /// Nothing is swept yet.
    pub fn new(radius_mm: f64) -> Self {
        let cells = Cells::new(CELL * radius_mm);
        Self {
            radius_mm,
            long_chords: Vec::new(),
            short_chords: Vec::new(),
            cells,
            near: Vec::new(),
            steps: 0,
            comparisons: 0,
        }
    }

    /// How many times a chord has been compared with the cutter. The time of all calls grows with this
    /// number: 15 to 35 million took a second on one core.
    pub fn comparisons(&self) -> u64 {
        self.comparisons
    }

    /// Sweeps along an element.
    pub fn push(&mut self, element: &Segment) {
        let arc = match element {
            Segment::Line { start, end } => return self.push_line(*start, *end),
            Segment::Arc(arc) => arc,
        };
        let [fine, coarse] = CHORD_HEIGHTS.map(|height| chords(arc, height * self.radius_mm));
        let each = fine.div_ceil(coarse);
        for k in 0..coarse {
            let from = self.short_chords.len() as u32;
            if each > 1 {
                let own = (k * each..(k + 1) * each).map(|k| chord(element, arc, k, coarse * each));
                self.short_chords.extend(own);
            }
            let short = [from, self.short_chords.len() as u32];
            self.push_long(LongChord { chord: chord(element, arc, k, coarse), short });
        }
    }

    fn push_line(&mut self, start: Point2<f64>, end: Point2<f64>) {
        let own = end - start;
        // A line that goes on in its direction stays one chord.
        if let Some(LongChord { chord: last, .. }) = self.long_chords.last_mut()
            && last.slack_mm == 0.0
            && last.end == start
            && own.perp(&(end - last.start)).abs() <= STRAIGHT_ON_MM * own.norm()
            && own.dot(&(start - last.start)) >= 0.0
        {
            last.end = end;
            self.cells.add(start, end, self.long_chords.len() as u32 - 1);
            return;
        }
        self.push_long(LongChord { chord: Chord { start, end, slack_mm: 0.0 }, short: [0, 0] });
    }

    fn push_long(&mut self, long: LongChord) {
        self.cells.add(long.chord.start, long.chord.end, self.long_chords.len() as u32);
        self.long_chords.push(long);
    }

    /// The angles along a motion, in order and without gaps. A stretch whose angle is at most `enough`
    /// radians is not divided further. The motion itself is swept afterwards.
    ///
    /// # Errors
    /// When the budget ends.
    pub fn follow(
        &mut self,
        motion: &Segment,
        enough: Enough,
        budget: &Budget,
    ) -> Result<Vec<Stretch>, Stopped> {
        let mut stretches = Vec::new();
        let parts = self.parts(motion);
        for k in 0..parts {
            let [from, to] = [k, k + 1].map(|k| k as f64 / parts as f64);
            let known = stretches.len();
            self.angles(motion, [from, to], enough, &mut stretches, budget)?;
            // A cutter on a tight arc comes back to what it freed itself. What meets nothing frees nothing.
            if !stretches[known..].iter().all(Stretch::is_clear) {
                self.push(&motion.part(from, to));
            }
        }
        Ok(stretches)
    }

    /// As [`Self::follow`], without sweeping.
    ///
    /// # Errors
    /// When the budget ends.
    pub fn survey(
        &mut self,
        motion: &Segment,
        enough: Enough,
        budget: &Budget,
    ) -> Result<Vec<Stretch>, Stopped> {
        let mut stretches = Vec::new();
        let parts = self.parts(motion);
        for k in 0..parts {
            let range = [k, k + 1].map(|k| k as f64 / parts as f64);
            self.angles(motion, range, enough, &mut stretches, budget)?;
        }
        Ok(stretches)
    }

    /// Whether a motion meets no material.
    ///
    /// # Errors
    /// When the budget ends.
    pub fn is_clear(&mut self, motion: &Segment, budget: &Budget) -> Result<bool, Stopped> {
        // Most motions that are not clear have material at one of these places, which are looked at fast.
        let is_clear_at = |t: &f64| Enough::Clear.is_met(self.left_at(&Frame::at(motion, *t)));
        if ![1.0, 0.5, 0.0].iter().all(is_clear_at) {
            return Ok(false);
        }
        Ok(self.survey(motion, Enough::Clear, budget)?.iter().all(Stretch::is_clear))
    }

    /// The angle at a place, in a direction of motion, radians.
    pub fn angle_at(&mut self, p: Point2<f64>, along: Vector2<f64>) -> f64 {
        self.left_at(&Frame { origin: p, along }).angle
    }

    /// The material on the half circle of a frame.
    fn left_at(&mut self, frame: &Frame) -> Left {
        let mut near = std::mem::take(&mut self.near);
        self.cells.about(frame.origin, REACH * self.radius_mm, &mut near);
        self.comparisons += near.len() as u64;
        let left = self.left_in(frame, &mut near);
        self.near = near;
        left
    }

    /// Whether the disc of the cutter about `p`, less a rim of `margin_mm`, is swept.
    pub fn is_free(&mut self, p: Point2<f64>, margin_mm: f64) -> bool {
        let mut near = std::mem::take(&mut self.near);
        self.cells.about(p, REACH * self.radius_mm, &mut near);
        near.retain(|k| {
            let Chord { start, end, .. } = self.long_chords[*k as usize].chord;
            distance_to_chord(p, start, end) < REACH * self.radius_mm
        });
        let is_free =
            self.is_square_free(p, self.radius_mm, (p, self.radius_mm - margin_mm), margin_mm, &near);
        self.near = near;
        is_free
    }

    /// Whether what a square, given by its middle and half its side, has in common with a disc is swept.
    fn is_square_free(
        &mut self,
        middle: Point2<f64>,
        half_mm: f64,
        disc: (Point2<f64>, f64),
        margin_mm: f64,
        near: &[u32],
    ) -> bool {
        let to_corner = half_mm * std::f64::consts::SQRT_2;
        self.comparisons += near.len() as u64;
        let contains = |Chord { start, end, slack_mm }: &Chord| {
            distance_to_chord(middle, *start, *end) + to_corner < self.radius_mm - slack_mm
        };
        let is_swept = |k: &u32| {
            let long = &self.long_chords[*k as usize];
            contains(&long.chord) || self.short(long).iter().any(contains)
        };
        if (middle - disc.0).norm() - to_corner >= disc.1 || near.iter().any(is_swept) {
            return true;
        }
        // The square may reach over the edge of the disc by half the margin.
        let quarter = 0.5 * half_mm;
        to_corner > 0.5 * margin_mm
            && [[-1.0, -1.0], [-1.0, 1.0], [1.0, -1.0], [1.0, 1.0]].into_iter().all(|[x, y]| {
                let middle = middle + Vector2::new(x, y) * quarter;
                self.is_square_free(middle, quarter, disc, margin_mm, near)
            })
    }

    /// The short chords of a long one.
    fn short(&self, long: &LongChord) -> &[Chord] {
        let [from, to] = long.short;
        &self.short_chords[from as usize..to as usize]
    }

    /// How many parts a motion is examined in.
    fn parts(&self, motion: &Segment) -> usize {
        let by_length = motion.length() / (LONGEST * self.radius_mm);
        by_length.max(motion.turn().abs() / LARGEST_TURN).ceil().max(1.0) as usize
    }
}

/// One of `count` equal chords of an arc.
fn chord(element: &Segment, arc: &PlaneArc, k: usize, count: usize) -> Chord {
    let half = 0.5 * arc.turn().abs() / count as f64;
    let [start, end] = [k, k + 1].map(|k| element.at(k as f64 / count as f64));
    Chord { start, end, slack_mm: arc.radius() * (1.0 - half.cos()) }
}

/// How many chords no farther from an arc than this stand for it.
fn chords(arc: &PlaneArc, height_mm: f64) -> usize {
    let turn = 2.0 * (1.0 - height_mm / arc.radius()).max(-1.0).acos();
    (arc.turn().abs() / turn.min(1.0)).ceil().max(1.0) as usize
}

/// The frame of a cutter: x along its motion.
struct Frame {
    origin: Point2<f64>,
    along: Vector2<f64>,
}

impl Frame {
    fn at(motion: &Segment, t: f64) -> Self {
        Self { origin: motion.at(t), along: motion.direction(t) }
    }

    fn local(&self, p: Point2<f64>) -> Vector2<f64> {
        let from = p - self.origin;
        Vector2::new(self.along.dot(&from), self.along.perp(&from))
    }
}

fn distance_to_chord(p: Point2<f64>, start: Point2<f64>, end: Point2<f64>) -> f64 {
    let (along, from) = (end - start, p - start);
    let square = along.norm_squared();
    let u = if square > 0.0 { (from.dot(&along) / square).clamp(0.0, 1.0) } else { 0.0 };
    (from - along * u).norm()
}

//! The toolpath of smooth rails: straight moves whose ends lie on the rails.
//!
//! # Method
//! 1. Each span is divided evenly into chords. An eighth of the largest second derivative bounds how far a
//!    polynomial leaves its chord, and the Bernstein coefficients bound the second derivative. This gives the
//!    number of chords.
//! 2. Where a program is to state the positions of the axes, a chord is halved while the tool would stray too
//!    far from it with all axes in step ([`Machine::straying`]). At the end of each move the toolpath holds
//!    the positions of the rotary axes on the rails, with the branch and the turns of the motion.
//! 3. The chords are proved against the given path by the proof of the rails (`deviation`).
//!
//! # Guarantees
//! * The moves are within the stated deviation of the given path, and the given path within it of the moves.
//! * The feed of a move is the largest speed of the motion at its ends and its middle. A control that plans
//!   its own ramps then loses no time.
//!
//! # Cost
//! O(n) for n moves.

use nalgebra::Vector3;

use super::deviation::{Deviation, mean_of_axes, of_chords, of_span};
use super::drive::Drive;
use super::leg::Leg;
use super::motion::ConstantFeed;
use super::path::Path;
use super::rail::{Piece, Source, Span, join, tip, top};
use super::stations::{Followed, pose};
use super::{FiveAxisError, Job, Rails};
use crate::budget::Budget;
use crate::machine::{AxisPositions, Machine, Straying};
use crate::toolpath::path::{Builder, Role, Toolpath};
use crate::toolpath::pose::{Pace, Pose};
use crate::toolpath::rail::Rail;
use crate::toolpath::units::FeedRate;

/// The part of a tolerance that chords may take beside the rails.
pub const CHORDS: f64 = 0.125;

/// The same around corners, where the chords go farther from the corner than the rails do.
pub const CHORDS_AT_CORNERS: f64 = 0.03;

/// Chords of one span, at most.
const MOST_CHORDS: f64 = 10_000.0;

/// Halvings of a chord, at most. Each divides the straying by four.
const MOST_HALVINGS: u32 = 20;

/// How fast a rotary axis turns on a pole between a rapid and a cut, radians per second: 29 degrees by s.
const TURN_PER_S: f64 = 0.5;

/// An axis that turns by no more between two moves does not turn, radians: rounding.
const SAME_ANGLE: f64 = 1e-10;

/// Moves between two checks of the budget.
const BETWEEN_CHECKS: usize = 256;

/// No move is slower, mm/min: the slowest feed that a request may ask for.
const SLOWEST_MM_PER_MIN: f64 = 0.001;

/// The moves along rails.
pub struct Moves {
    pub toolpath: Toolpath,
    /// For each move the time of the motion at its end, s. The ways in and out take no time of the motion,
    /// and neither do turns on a pole beside a rapid.
    pub ends_s: Vec<f64>,
    /// Of the moves from the given path.
    pub deviation: Deviation,
}

/// The motion along the rails: within limits, or at the feed with the axes of a machine or none.
#[derive(Clone, Copy)]
pub struct Along<'a> {
    /// The motion at the feed.
    pub feeding: &'a ConstantFeed<'a>,
    pub drive: Option<&'a Drive<'a>>,
    pub followed: Option<&'a Followed<'a>>,
}

impl Along<'_> {
    /// The positions of the axes at a parameter of a piece.
    fn joints(&self, piece: usize, u: f64) -> Option<AxisPositions> {
        match self.drive {
            Some(drive) => drive.joints(piece, u),
            None => Some(self.followed?.at(piece, u)),
        }
    }

    /// The time at a parameter of a piece, in the span with a number among all spans, s.
    fn time_at(&self, piece: usize, span: usize, u: f64) -> f64 {
        match self.drive {
            Some(drive) => drive.time_at(piece, u),
            None => self.feeding.time_at(span, u),
        }
    }
}

/// The end of a chord: its parameter, and the positions of the axes where a program states them.
type End = (f64, Option<AxisPositions>);

/// The height of chords that is allowed beside a tolerance.
fn allowed(tolerance: Deviation, part: f64) -> Deviation {
    Deviation { tip_mm: part * tolerance.tip_mm, axis: part * tolerance.axis }
}

pub fn moves(
    job: &Job,
    path: &Path,
    rails: &Rails,
    along: Along,
    budget: &Budget,
) -> Result<Moves, FiveAxisError> {
    let pieces = &rails.rail.pieces;
    let (first, last) = (&pieces[0], &pieces[pieces.len() - 1]);
    let start = pose(&first.spans[0].start());
    let end = pose(&last.spans[last.spans.len() - 1].end());
    let begins_with_feed = !first.is_rapid && job.path[0].pace != Pace::Rapid;
    let away = |pose: &Pose| pose.tip + pose.axis.into_inner() * job.retract_mm;
    let begins = if begins_with_feed { away(&start) } else { start.tip };
    let mut moving = Moving {
        builder: Toolpath::builder(begins).with_limit(job.move_limit),
        deviation: Deviation::NONE,
        allowed: allowed(job.tolerance(), CHORDS),
        allowed_at_corners: allowed(job.tolerance(), CHORDS_AT_CORNERS),
        path,
        rails,
        along,
        in_step: job.machine.as_ref().zip(job.in_step),
        rotary: None,
        n_spans: 0,
        ends_s: Vec::new(),
    };
    moving.rotate_to(moving.end(0, first.spans[0].from).1);
    moving.builder.begin_leaning_pass(None, start.axis);
    if begins_with_feed {
        moving.builder.line(start.tip, rate(first.feeds[0]), Role::LeadIn)?;
        moving.ends_at(0.0);
    }
    for (k, piece) in pieces.iter().enumerate() {
        let begins_pass = k > 0 && (piece.is_rapid || pieces[k - 1].is_rapid);
        if begins_pass {
            moving.builder.begin_pass(None);
        }
        moving.turn_on_pole(k, piece)?;
        moving.piece(k, piece, budget)?;
    }
    if !last.is_rapid {
        moving.builder.line(away(&end), rate(last.feeds[last.feeds.len() - 1]), Role::LeadOut)?;
        moving.ends_with_the_one_before();
    }
    let deviation = moving.deviation.plus(path.moved);
    Ok(Moves { toolpath: moving.builder.finish()?, ends_s: moving.ends_s, deviation })
}

struct Moving<'a> {
    builder: Builder,
    deviation: Deviation,
    allowed: Deviation,
    allowed_at_corners: Deviation,
    path: &'a Path,
    rails: &'a Rails,
    along: Along<'a>,
    /// The machine whose axes move in step, and how far the tool may then stray.
    in_step: Option<(&'a Machine, Straying)>,
    /// The positions of the rotary axes at the end of the moves so far.
    rotary: Option<[f64; 2]>,
    /// The number of spans of the pieces before.
    n_spans: usize,
    ends_s: Vec<f64>,
}

impl Moving<'_> {
    fn end(&self, piece: usize, u: f64) -> End {
        (u, self.in_step.and_then(|_| self.along.joints(piece, u)))
    }

    /// Tells the time of the motion at the end of the move that was made last, s.
    fn ends_at(&mut self, time_s: f64) {
        self.ends_s.push(time_s);
    }

    /// Tells that the move that was made last takes no time of the motion.
    fn ends_with_the_one_before(&mut self) {
        self.ends_at(self.ends_s.last().copied().unwrap_or(0.0));
    }

    /// During the next move the rotary axes turn to a position.
    fn rotate_to(&mut self, joints: Option<AxisPositions>) {
        if let Some(AxisPositions { rotary, .. }) = joints {
            self.rotary = Some(rotary);
            self.builder.rotate_next(rotary);
        }
    }

    /// Where a rapid begins or ends on a pole, the axis that is free there turns to where the next piece
    /// begins. The tool stands still.
    fn turn_on_pole(&mut self, k: usize, piece: &Piece) -> Result<(), FiveAxisError> {
        let (Some((machine, allowed)), Some(from)) = (self.in_step, self.rotary) else { return Ok(()) };
        let (_, Some(AxisPositions { rotary: to, .. })) = self.end(k, piece.spans[0].from) else {
            return Ok(());
        };
        let turns = [0, 1].map(|k| to[k] - from[k]);
        let angle = turns[0].abs().max(turns[1].abs());
        if angle <= SAME_ANGLE {
            return Ok(());
        }
        let pose = pose(&piece.spans[0].start());
        let at = |part: f64| machine.at(&pose.tip, [0, 1].map(|k| from[k] + turns[k] * part));
        let halvings = (0..MOST_HALVINGS)
            .find(|n| !is_farther(&machine.straying(&at(0.0), &at(0.5_f64.powi(*n as i32))), &allowed));
        let count = 1_u32 << halvings.unwrap_or(MOST_HALVINGS);
        for n in 1..=count {
            self.rotate_to(Some(at(f64::from(n) / f64::from(count))));
            self.builder.turn(pose.axis, Some(angle / TURN_PER_S / f64::from(count)), Role::Link)?;
            self.ends_with_the_one_before();
        }
        Ok(())
    }

    /// The ends of the chords of a span: `count` even ones, halved where the tool would stray too far.
    fn ends(&self, k: usize, span: &Span, count: usize) -> Vec<End> {
        let mut ends = vec![self.end(k, span.from)];
        for i in 1..=count {
            let u = if i == count { span.to } else { span.from + span.length() * (i as f64 / count as f64) };
            self.halve(k, [ends[ends.len() - 1], self.end(k, u)], MOST_HALVINGS, &mut ends);
        }
        ends
    }

    /// Adds the ends of a chord and of its halves.
    fn halve(&self, k: usize, [from, to]: [End; 2], halvings: u32, ends: &mut Vec<End>) {
        let strays = match (self.in_step, from.1, to.1) {
            (Some((machine, allowed)), Some(first), Some(last)) => {
                is_farther(&machine.straying(&first, &last), &allowed)
            }
            _ => false,
        };
        if strays && halvings > 0 && ends.len() <= MOST_CHORDS as usize {
            let middle = self.end(k, 0.5 * (from.0 + to.0));
            self.halve(k, [from, middle], halvings - 1, ends);
            self.halve(k, [middle, to], halvings - 1, ends);
        } else {
            ends.push(to);
        }
    }

    fn piece(&mut self, k: usize, piece: &Piece, budget: &Budget) -> Result<(), FiveAxisError> {
        let before = self.n_spans;
        self.n_spans += piece.spans.len();
        if piece.is_rapid {
            for (n, span) in piece.spans.iter().enumerate() {
                for (u, joints) in self.ends(k, span, 1).into_iter().skip(1) {
                    let to = pose(&span.jet(u)[0]);
                    self.rotate_to(joints);
                    self.builder.turn_next(to.axis)?;
                    self.builder.rapid(to.tip)?;
                    self.ends_at(self.along.time_at(k, before + n, u));
                }
            }
            return Ok(());
        }
        let rests = piece.rests();
        for (n, span) in piece.spans.iter().enumerate() {
            if n.is_multiple_of(BETWEEN_CHECKS) {
                budget.check()?;
            }
            let is_blend = matches!(piece.sources[n], Source::Corner(_));
            let bends = bends(span);
            let count = chords(bends, if is_blend { self.allowed_at_corners } else { self.allowed });
            let height = heights(bends, count);
            let ends = self.ends(k, span, count);
            let places: Vec<_> = ends.iter().map(|(u, _)| span.jet(*u)[0]).collect();
            let legs: Vec<Leg> = match piece.sources[n] {
                Source::Run(_) => Vec::new(),
                source => {
                    let [first, last] = source.legs();
                    (first..=last).map(|leg| self.path.leg(leg)).collect()
                }
            };
            let first = self.builder.n_moves_of_pass();
            for i in 0..ends.len() - 1 {
                let to = pose(&places[i + 1]);
                self.rotate_to(ends[i + 1].1);
                let ends = [ends[i].0, ends[i + 1].0];
                if rests {
                    if matches!(piece.sources[n], Source::Run(_)) {
                        let axis = self.rails.deviation.axis + height.axis;
                        self.deviation.axis = self.deviation.axis.max(axis);
                    }
                    let seconds = match self.along.drive {
                        Some(drive) => drive.seconds(k, ends),
                        None => (top(&places[i + 1]) - top(&places[i])).norm() / piece.feeds[n],
                    };
                    self.builder.turn(to.axis, Some(seconds), Role::Cut)?;
                } else {
                    let chord = Span::line(ends[0], ends[1], places[i], places[i + 1]);
                    self.deviation =
                        self.deviation.max(self.of_chord(&chord, height, piece.sources[n], &legs));
                    let speed = self.along.drive.map_or(piece.feeds[n], |drive| drive.largest_speed(k, ends));
                    self.builder.turn_next(to.axis)?;
                    self.builder.line(to.tip, rate(speed), Role::Cut)?;
                }
                self.ends_at(self.along.time_at(k, before + n, ends[1]));
            }
            if !rests {
                let moves = first..self.builder.n_moves_of_pass();
                let (tip, to_second) = (span.control.map(|p| tip(&p).into()), span.control.map(|p| top(&p)));
                self.builder.rail(Rail { moves, tip, to_second });
            }
            if is_blend {
                let tips: Vec<Vector3<f64>> = places.iter().map(tip).collect();
                self.deviation.tip_mm = self.deviation.tip_mm.max(corner(&tips, &legs));
            }
        }
        Ok(())
    }

    /// The bound of the deviation of a chord of the rails, which are at most `height` beside it.
    fn of_chord(&self, chord: &Span, height: Deviation, source: Source, legs: &[Leg]) -> Deviation {
        // The axis turns on the great circle; the line of tops that are equally far away is near to it.
        let far = top(&self.path.stations[0]).norm();
        let [start, end] = [chord.start(), chord.end()].map(|at| join(tip(&at), top(&at).normalize() * far));
        let circle = Deviation { tip_mm: 0.0, axis: mean_of_axes(&Leg::new(start, end)) };
        let chord = Span::line(chord.from, chord.to, start, end);
        match source {
            Source::Run(_) => self.rails.deviation.plus(height).plus(circle),
            // Around a corner, the nearest leg changes along the chord.
            Source::Corner(_) => of_span(&chord, legs, Deviation::NONE).plus(circle),
            // The search may end early at a bound that is no larger than that of the rails.
            Source::Leg(_) => of_span(&chord, legs, self.rails.deviation).plus(circle),
        }
    }
}

/// The distance of the corner of two legs from the chords around it, and of the lines that lead to it, mm.
fn corner(chords: &[Vector3<f64>], legs: &[Leg]) -> f64 {
    let part = |leg: &Leg, p: &Vector3<f64>| super::deviation::part_of(leg, p).clamp(0.0, 1.0);
    let (leaves, meets) = (&chords[0], &chords[chords.len() - 1]);
    of_chords(chords, &legs[0], [part(&legs[0], leaves), 1.0]).max(of_chords(
        chords,
        &legs[1],
        [0.0, part(&legs[1], meets)],
    ))
}

/// How far a span may leave the chord over all of it: the tip, and the axis.
fn bends(span: &Span) -> Deviation {
    let second = span.control.windows(3).map(|p| p[2] - p[1] * 2.0 + p[0]);
    let (mut of_tip, mut of_top, mut shortest) = (0.0_f64, 0.0_f64, f64::INFINITY);
    for bend in second {
        of_tip = of_tip.max(tip(&bend).norm());
        of_top = of_top.max(top(&bend).norm());
    }
    for p in &span.control {
        shortest = shortest.min(top(p).norm());
    }
    // The height of a chord is at most an eighth of the second derivative times the square of the length. The
    // second derivative of a quintic is at most 20 times the second differences of its control points, by the
    // same square.
    Deviation { tip_mm: 2.5 * of_tip, axis: 2.5 * of_top / shortest }
}

/// The chords of a span whose heights are allowed.
fn chords(bends: Deviation, allowed: Deviation) -> usize {
    bends.of(allowed).sqrt().ceil().clamp(1.0, MOST_CHORDS) as usize
}

/// How far a span that is divided into `count` chords leaves them: the height falls with the square of
/// `count`.
fn heights(bends: Deviation, count: usize) -> Deviation {
    let part = 1.0 / (count * count) as f64;
    Deviation { tip_mm: bends.tip_mm * part, axis: bends.axis * part }
}

fn is_farther(straying: &Straying, allowed: &Straying) -> bool {
    straying.tip_mm > allowed.tip_mm || straying.axis > allowed.axis
}

fn rate(mm_per_s: f64) -> Option<FeedRate> {
    FeedRate::from_mm_per_min((60.0 * mm_per_s).max(SLOWEST_MM_PER_MIN))
}

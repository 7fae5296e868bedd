//! The toolpath of smooth rails: straight moves whose ends lie on the rails.
//!
//! # Method
//! 1. Each span is divided evenly into chords. An eighth of the largest second derivative bounds how far a
//!    polynomial leaves its chord, and the Bernstein coefficients bound the second derivative. This gives the
//!    number of chords.
//! 2. The chords are proved against the given path by the proof of the rails (`deviation`).
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
use super::path::Path;
use super::rail::{Piece, Source, Span, join, tip, top};
use super::stations::pose;
use super::{FiveAxisError, Job, Rails};
use crate::budget::Budget;
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

/// Moves between two checks of the budget.
const BETWEEN_CHECKS: usize = 256;

/// No move is slower, mm/min: the slowest feed that a request may ask for.
const SLOWEST_MM_PER_MIN: f64 = 0.001;

/// The moves along rails.
pub struct Moves {
    pub toolpath: Toolpath,
    /// Of the moves from the given path.
    pub deviation: Deviation,
}

/// The height of chords that is allowed beside a tolerance.
fn allowed(tolerance: Deviation, part: f64) -> Deviation {
    Deviation { tip_mm: part * tolerance.tip_mm, axis: part * tolerance.axis }
}

pub fn moves(
    job: &Job,
    path: &Path,
    rails: &Rails,
    drive: Option<&Drive>,
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
        drive,
    };
    moving.builder.begin_leaning_pass(None, start.axis);
    if begins_with_feed {
        moving.builder.line(start.tip, rate(first.feeds[0]), Role::LeadIn)?;
    }
    for (k, piece) in pieces.iter().enumerate() {
        let begins_pass = k > 0 && (piece.is_rapid || pieces[k - 1].is_rapid);
        if begins_pass {
            moving.builder.begin_pass(None);
        }
        moving.piece(k, piece, budget)?;
    }
    if !last.is_rapid {
        moving.builder.line(away(&end), rate(last.feeds[last.feeds.len() - 1]), Role::LeadOut)?;
    }
    let deviation = moving.deviation.plus(path.moved);
    Ok(Moves { toolpath: moving.builder.finish()?, deviation })
}

struct Moving<'a> {
    builder: Builder,
    deviation: Deviation,
    allowed: Deviation,
    allowed_at_corners: Deviation,
    path: &'a Path,
    rails: &'a Rails,
    drive: Option<&'a Drive<'a>>,
}

impl Moving<'_> {
    fn piece(&mut self, k: usize, piece: &Piece, budget: &Budget) -> Result<(), FiveAxisError> {
        if piece.is_rapid {
            let end = pose(&piece.spans[piece.spans.len() - 1].end());
            self.builder.turn_next(end.axis)?;
            return Ok(self.builder.rapid(end.tip)?);
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
            let at = |i: usize| {
                if i == count { span.to } else { span.from + span.length() * (i as f64 / count as f64) }
            };
            let places: Vec<_> = (0..=count).map(|i| span.jet(at(i))[0]).collect();
            let legs: Vec<Leg> = match piece.sources[n] {
                Source::Run(_) => Vec::new(),
                source => {
                    let [first, last] = source.legs();
                    (first..=last).map(|leg| self.path.leg(leg)).collect()
                }
            };
            let first = self.builder.n_moves_of_pass();
            for i in 0..count {
                let to = pose(&places[i + 1]);
                let ends = [at(i), at(i + 1)];
                if rests {
                    if matches!(piece.sources[n], Source::Run(_)) {
                        let axis = self.rails.deviation.axis + height.axis;
                        self.deviation.axis = self.deviation.axis.max(axis);
                    }
                    let seconds = match self.drive {
                        Some(drive) => drive.seconds(k, ends),
                        None => (top(&places[i + 1]) - top(&places[i])).norm() / piece.feeds[n],
                    };
                    self.builder.turn(to.axis, Some(seconds), Role::Cut)?;
                } else {
                    let chord = Span::line(ends[0], ends[1], places[i], places[i + 1]);
                    self.deviation =
                        self.deviation.max(self.of_chord(&chord, height, piece.sources[n], &legs));
                    let speed = self.drive.map_or(piece.feeds[n], |drive| drive.largest_speed(k, ends));
                    self.builder.turn_next(to.axis)?;
                    self.builder.line(to.tip, rate(speed), Role::Cut)?;
                }
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

fn rate(mm_per_s: f64) -> Option<FeedRate> {
    FeedRate::from_mm_per_min((60.0 * mm_per_s).max(SLOWEST_MM_PER_MIN))
}

//! A leaning toolpath as straight motions between poses, and motions along rails.

use std::cell::Cell;

use super::super::{MAX_BLOCKS, ProgramJob, WriteError};
use toolpathd_core::geometry::curve::Curve;
use toolpathd_core::geometry::flatten::flatten;
use toolpathd_core::toolpath::path::{Move, Pass, Toolpath};
use toolpathd_core::toolpath::pose::Pose;
use toolpathd_core::toolpath::rail::Rail;
use toolpathd_core::toolpath::tool_axes::angle_between;
use toolpathd_core::toolpath::units::FeedRate;

/// How fast the tool turns between two passes, radians per second: 29 degrees by s.
const TURN_PER_S: f64 = 0.5;

/// One straight motion, or one along a rail.
pub struct Leg<'a> {
    pub to: Pose,
    /// The positions of the rotary axes at the end, radians, where the toolpath has them.
    pub rotary: Option<[f64; 2]>,
    pub time: LegTime,
    pub rail: Option<&'a Rail>,
}

/// How fast a leg is run, or how long it takes.
#[derive(Clone, Copy)]
pub enum LegTime {
    Feed(FeedRate),
    Seconds(f64),
    /// The tool rests.
    Dwell(f64),
}

impl LegTime {
    /// How long a straight motion takes.
    pub fn seconds(self, from: &Pose, to: &Pose) -> f64 {
        match self {
            Self::Feed(rate) => (to.tip - from.tip).norm() / rate.mm_per_s(),
            Self::Seconds(seconds) | Self::Dwell(seconds) => seconds,
        }
    }
}

/// A toolpath as motions from a start.
pub struct Legs<'a> {
    pub start: Pose,
    /// The positions of the rotary axes at the start, radians, where the toolpath has them.
    pub rotary: Option<[f64; 2]>,
    pub legs: Vec<Leg<'a>>,
    /// For each move of the toolpath the number of legs up to its end.
    pub ends: Vec<usize>,
    /// How much longer the rails take than their moves, s.
    pub delay_s: f64,
}

/// Chords stay within `chord_mm` of curves. Rails stand for their moves where `has_rails`.
pub fn divide<'a>(
    toolpath: &'a Toolpath,
    job: &ProgramJob,
    chord_mm: f64,
    has_rails: bool,
) -> Result<Legs<'a>, WriteError> {
    let mut tip = toolpath.start();
    let first = toolpath.passes().first().map(|pass| pass.axes().start());
    let start = Pose { tip, axis: first.unwrap_or(nalgebra::Vector3::z_axis()) };
    let mut axis = start.axis;
    let begins = toolpath.passes().first().and_then(|pass| Some(pass.rotary()?.start));
    let mut rotary = begins;
    let (mut legs, mut ends, mut delay_s) = (Vec::new(), Vec::new(), 0.0);
    let n_legs = Cell::new(0);
    let mut push = |to: Pose, rotary: Option<[f64; 2]>, time: LegTime, rail: Option<&'a Rail>| {
        legs.push(Leg { to, rotary, time, rail });
        n_legs.set(legs.len());
        if legs.len() > MAX_BLOCKS { Err(WriteError::TooManyBlocks { limit: MAX_BLOCKS }) } else { Ok(()) }
    };
    for pass in toolpath.passes() {
        let begins = pass.axes().start();
        if begins != axis {
            let angle = angle_between(&axis, &begins);
            rotary = pass.rotary().map(|rotary| rotary.start);
            push(Pose { tip, axis: begins }, rotary, LegTime::Seconds(angle / TURN_PER_S), None)?;
            axis = begins;
        }
        let mut rails = pass.rails().iter().filter(|rail| has_rails && !rail.moves.is_empty()).peekable();
        for (k, step) in pass.moves().iter().enumerate() {
            if let Some(rail) = rails.next_if(|rail| rail.moves.end == k + 1) {
                let (rate, longer_s) = slowest(&pass.moves()[rail.moves.clone()])?;
                delay_s += longer_s;
                (tip, axis) = (rail.tip[5], pass.axes().after(k));
                rotary = rotary_after(pass, k);
                push(Pose { tip, axis }, rotary, LegTime::Feed(rate), Some(rail))?;
                ends.push(n_legs.get());
                continue;
            }
            if rails.peek().is_some_and(|rail| rail.moves.contains(&k)) {
                // The rail to come ends all of its moves.
                ends.push(n_legs.get() + 1);
                continue;
            }
            let from = Pose { tip, axis };
            axis = pass.axes().after(k);
            let before = std::mem::replace(&mut rotary, rotary_after(pass, k));
            match step {
                Move::Rapid { line } => {
                    tip = line.end;
                    let time = if tip == from.tip {
                        LegTime::Seconds(angle_between(&from.axis, &axis) / TURN_PER_S)
                    } else {
                        LegTime::Feed(job.cutting.rapid_feed)
                    };
                    push(Pose { tip, axis }, rotary, time, None)?;
                }
                Move::Feed { along, rate, .. } => {
                    let rate = rate.ok_or(WriteError::FeedMissing)?;
                    let points = match along {
                        Curve::Line(line) => vec![line.start, line.end],
                        curve => flatten(curve, chord_mm, MAX_BLOCKS)
                            .map_err(|_| WriteError::TooManyBlocks { limit: MAX_BLOCKS })?,
                    };
                    let parts = (points.len() - 1) as f64;
                    tip = along.end();
                    let to = Pose { tip, axis };
                    for (n, point) in points.into_iter().enumerate().skip(1) {
                        let part = n as f64 / parts;
                        let axis = from.between(&to, part).axis;
                        let turned = before
                            .zip(rotary)
                            .map(|(from, to)| [0, 1].map(|k| from[k] + (to[k] - from[k]) * part));
                        push(Pose { tip: point, axis }, turned, LegTime::Feed(rate), None)?;
                    }
                }
                Move::Turn { seconds, .. } => {
                    push(
                        Pose { tip, axis },
                        rotary,
                        LegTime::Seconds(seconds.ok_or(WriteError::FeedMissing)?),
                        None,
                    )?;
                }
                Move::Dwell { seconds } => push(from, rotary, LegTime::Dwell(*seconds), None)?,
            }
            ends.push(n_legs.get());
        }
    }
    Ok(Legs { start, rotary: begins, legs, ends, delay_s })
}

/// The positions of the rotary axes at the end of the move `k` of a pass.
fn rotary_after(pass: &Pass, k: usize) -> Option<[f64; 2]> {
    pass.rotary().and_then(|rotary| rotary.ends.get(k).copied())
}

/// The one feed of a rail, which is no faster than any of its moves may be, and how much longer they take
/// with it, s.
fn slowest(moves: &[Move]) -> Result<(FeedRate, f64), WriteError> {
    let feeds = || {
        moves.iter().filter_map(|step| match step {
            Move::Feed { along, rate: Some(rate), .. } => Some((along.length(), *rate)),
            _ => None,
        })
    };
    let rates = feeds().map(|(_, rate)| rate);
    let slowest = rates.reduce(|a, b| if b < a { b } else { a }).ok_or(WriteError::FeedMissing)?;
    let delay_s = feeds().map(|(mm, rate)| mm / slowest.mm_per_s() - mm / rate.mm_per_s()).sum();
    Ok((slowest, delay_s))
}

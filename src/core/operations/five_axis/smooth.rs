//! Smooth rails through the stations of a path, and blends around its corners: the default method.
//!
//! # Method
//! 1. A station is a corner if the path turns so far there that a smooth curve through it would leave the
//!    tolerance (`severity`). Between corners, a cubic spline runs through all stations, with shared
//!    parameters that grow by the length of each leg.
//!    If its third derivative jumps to and fro from span to span (`roughness`), the poses have noise or
//!    rounding, and the spline of least jerk within the tolerance takes its place (`tube`).
//! 2. Each span is proved (`deviation`). A span that leaves the tolerance gets a point more: beside a much
//!    longer leg on this leg, at distances that grow by a factor; otherwise in the middle, nearer to the
//!    leg. If that is not enough, the worse one of its ends becomes a corner, and the spline is made anew.
//! 3. At a corner the rails leave the legs a distance before it and come back to them a distance after it,
//!    on a quintic that continues value, slope and second derivative. The largest distance within the
//!    tolerance is taken. Where the path turns back, and beside a rotation about a resting tip, the motion
//!    stops instead.
//!
//! # Guarantees
//! All spans are proved to be within the tolerance. Ends are hit exactly. Inside a piece the second
//! derivatives are continuous.

mod on_pole;
mod repairs;
mod turns;

use super::blend::{Blend, begin_at, blend, end_at};
use super::deviation::Deviation;
use super::leg::Leg;
use super::rail::{Fitted, Piece, Point6, Rail, Source, Span, tip, top};
use super::{Continuity, FiveAxisError, Rails, roughness, tube};
use crate::budget::Budget;
use crate::geometry::spline::{EndCondition, derivatives_over};
use crate::toolpath::tool_axes::angle_between;
use repairs::turned;

/// Rounds of proof and repair. A path needs a few. After these, every station of a run that leaves the
/// tolerance is a corner.
const MOST_ROUNDS: usize = 40;

/// Repairs of a leg that stands alone, after which the tolerance counts as not reached. Each halves the
/// parts of the leg; ten bring any turn within a nanoradian of the great circle.
const MOST_REPAIRS: u8 = 10;

/// A station is a corner at once if the estimate of its deviation is above this multiple of the tolerance.
const CERTAIN: f64 = 1.5;

/// Turns above this angle are reversals, radians.
const REVERSAL: f64 = 2.6;

/// Between two points of a leg the axis turns by at most this angle, radians.
const LARGEST_TURN: f64 = 0.2;

/// A point of the spline between the ends of a leg.
#[derive(Debug, Clone, Copy)]
struct Inner {
    /// The part of the leg, from 0 to 1.
    part: f64,
    at: Point6,
}

/// A stretch of a path without rapids.
#[derive(Clone, Copy)]
pub struct Stretch<'a> {
    pub stations: &'a [Point6],
    /// Whether the rails have to hit a station: it is on a pole.
    pub on_pole: &'a [bool],
    /// How far the axis may be from each leg because of a pole beside it, radians.
    pub rooms: &'a [f64],
}

/// What chords and rounding of a program need of the tolerance: at blends, and along splines inside the tube.
#[derive(Clone, Copy)]
pub struct Room {
    pub at_corners: Deviation,
    pub in_tube: Deviation,
}

struct Smoother<'a> {
    stretch: Stretch<'a>,
    legs: Vec<Leg>,
    is_corner: Vec<bool>,
    inner: Vec<Vec<Inner>>,
    repairs: Vec<u8>,
    tolerance: Deviation,
    /// What programs need of the tolerance.
    room: Room,
    /// Whether all runs get the spline of least jerk inside the tolerance. Otherwise those with noise do.
    in_tube: bool,
}

/// What follows one corner and ends at the next.
struct RunSpans {
    first: usize,
    spans: Vec<Fitted>,
    deviation: Deviation,
}

/// Rails within the tolerance. Blends at corners, and splines inside the tube, leave `room` of it.
pub fn smooth(
    stretch: &Stretch,
    tolerance: Deviation,
    room: Room,
    in_tube: bool,
    budget: &Budget,
) -> Result<Rails, FiveAxisError> {
    let mut smoother = Smoother::new(*stretch, tolerance);
    smoother.room = room;
    smoother.in_tube = in_tube;
    let runs = smoother.runs(budget)?;
    smoother.join(runs, budget)
}

impl<'a> Smoother<'a> {
    fn new(stretch: Stretch<'a>, tolerance: Deviation) -> Self {
        let Stretch { stations, .. } = stretch;
        let legs: Vec<Leg> = stations.windows(2).map(|pair| Leg::new(pair[0], pair[1])).collect();
        let inner = legs.iter().map(|leg| turned(leg, LARGEST_TURN)).collect();
        let mut smoother = Self {
            stretch,
            is_corner: vec![false; stations.len()],
            repairs: vec![0; legs.len()],
            inner,
            legs,
            tolerance,
            room: Room { at_corners: Deviation::NONE, in_tube: Deviation::NONE },
            in_tube: false,
        };
        for k in 0..stations.len() {
            let is_end = k == 0 || k == stations.len() - 1;
            if is_end || smoother.severity(k) > CERTAIN {
                smoother.make_corner(k);
            }
        }
        smoother
    }

    /// An estimate of the deviation of a smooth curve through a station, as a part of the tolerance: that of
    /// a circle whose chords are as long as the shorter leg.
    fn severity(&self, k: usize) -> f64 {
        let (before, after) = (&self.legs[k - 1], &self.legs[k]);
        if before.is_rotation() || after.is_rotation() || self.turn(k) > REVERSAL {
            return f64::INFINITY;
        }
        let shorter = before.length.min(after.length);
        let within = self.within(k - 1..k + 1);
        let slope = |leg: &Leg| (top(&leg.end) - top(&leg.start)) / leg.length;
        let swing = (slope(after) - slope(before)).norm() / top(&before.end).norm();
        (self.turn(k) * shorter / (8.0 * within.tip_mm)).max(swing * shorter / (8.0 * within.axis))
    }

    /// The motion may stop at a station. On a pole, the legs beside it that leave the pole then stay lines,
    /// so that the free angle is the same before and after the stop.
    fn make_corner(&mut self, k: usize) {
        self.is_corner[k] = true;
        if self.stretch.on_pole[k] {
            if k > 0 && self.legs[k - 1].turns() {
                self.is_corner[k - 1] = true;
            }
            if self.legs.get(k).is_some_and(Leg::turns) {
                self.is_corner[k + 1] = true;
            }
        }
    }

    /// Whether the rails have to hit a station inside the path, because they come to a pole there or leave
    /// it. Where the axis rests on the pole, no rotary axis has to turn.
    fn passes_pole(&self, k: usize) -> bool {
        self.stretch.on_pole[k] && (self.legs[k - 1].turns() || self.legs[k].turns())
    }

    /// The tolerance of the rails along legs.
    fn within(&self, legs: std::ops::Range<usize>) -> Deviation {
        let rooms = self.stretch.rooms[legs].iter();
        Deviation { axis: rooms.copied().fold(self.tolerance.axis, f64::min), ..self.tolerance }
    }

    fn turn(&self, k: usize) -> f64 {
        angle_between(&self.legs[k - 1].direction(), &self.legs[k].direction())
    }

    /// The runs between corners, each within the tolerance.
    fn runs(&mut self, budget: &Budget) -> Result<Vec<RunSpans>, FiveAxisError> {
        let mut done = Vec::new();
        let mut open: Vec<[usize; 2]> = self.between_corners(0, self.stretch.stations.len() - 1);
        for round in 0.. {
            let mut again = Vec::new();
            for [first, last] in open {
                budget.check()?;
                if self.legs[first].is_rotation() {
                    done.push(RunSpans { first, spans: Vec::new(), deviation: Deviation::NONE });
                    continue;
                }
                let spans = self.fit(first, last);
                let is_alone = last == first + 1;
                let hits_pole = (first + 1..last).any(|k| self.passes_pole(k));
                // Points that a repair has added jump to and fro by themselves.
                let is_as_given = self.repairs[first..last].iter().all(|repairs| *repairs == 0);
                let is_rough = || is_as_given && roughness::is_rough(&spans);
                if !is_alone && !hits_pole && (self.in_tube || is_rough()) {
                    let within = self.within(first..last).without(self.room.in_tube);
                    let found = tube::fit(&self.legs, [first, last], within, budget)?;
                    let is_smoother = |tube: &tube::Tube| {
                        roughness::jerk(&spans) > roughness::NOISE * roughness::jerk(&tube.spans)
                    };
                    if let Some(tube) = found.filter(|tube| self.in_tube || is_smoother(tube)) {
                        done.push(RunSpans { first, spans: tube.spans, deviation: tube.deviation });
                        continue;
                    }
                }
                let (deviation, failed) = self.proved(&spans, is_alone);
                if failed.is_empty() {
                    done.push(RunSpans { first, spans, deviation });
                    continue;
                }
                for (leg, deviation, span) in failed {
                    if is_alone && self.repairs[leg] > MOST_REPAIRS {
                        let at = tip(&self.stretch.stations[first]).into();
                        return Err(FiveAxisError::ToleranceNotReached { at });
                    }
                    if round >= MOST_ROUNDS && !is_alone {
                        self.isolate(first, last);
                    } else {
                        self.repair(leg, deviation, &span, [first, last]);
                    }
                }
                again.extend(self.between_corners(first, last));
            }
            if again.is_empty() {
                break;
            }
            open = again;
        }
        done.sort_by_key(|run| run.first);
        Ok(done)
    }

    fn between_corners(&self, first: usize, last: usize) -> Vec<[usize; 2]> {
        let corners: Vec<usize> = (first..=last).filter(|k| self.is_corner[*k]).collect();
        corners.windows(2).map(|pair| [pair[0], pair[1]]).collect()
    }

    /// The spline through the stations of a run. A run of one leg is that leg.
    fn fit(&self, first: usize, last: usize) -> Vec<Fitted> {
        let mut points = vec![self.stretch.stations[first]];
        let (mut steps, mut of_leg) = (Vec::new(), Vec::new());
        for k in first..last {
            let leg = &self.legs[k];
            let mut before = 0.0;
            let end = Inner { part: 1.0, at: leg.end };
            for inner in self.inner[k].iter().chain([&end]) {
                steps.push((inner.part - before) * leg.length);
                points.push(inner.at);
                of_leg.push(k);
                before = inner.part;
            }
        }
        let spline = derivatives_over(&steps, &points, EndCondition::NotAKnot);
        let mut from = 0.0;
        let mut spans = Vec::with_capacity(steps.len());
        for (k, step) in steps.iter().enumerate() {
            let range = [from, from + step];
            from += step;
            let span = Span::cubic(range, [points[k], spline[k]], [points[k + 1], spline[k + 1]]);
            spans.push(Fitted { span, source: Source::Leg(of_leg[k]) });
        }
        for k in 1..spans.len() {
            let is_station = of_leg[k] != of_leg[k - 1];
            let on_pole = &self.stretch.on_pole;
            // Of three stations on the pole, the path rests on it.
            if is_station && on_pole[of_leg[k]] && !on_pole[of_leg[k - 1]] && !on_pole[of_leg[k] + 1] {
                let [before, after] = on_pole::smooth_thrice(&spans[k - 1].span, &spans[k].span);
                spans[k - 1].span = before;
                spans[k].span = after;
            }
        }
        spans
    }

    /// Adds the motion along the turns from a leg on, if it is the first of them.
    fn turn_at_rest(&self, first: usize, rails: &mut Rails, budget: &Budget) -> Result<(), FiveAxisError> {
        if first > 0 && self.legs[first - 1].is_rotation() {
            return Ok(());
        }
        let count = self.legs[first..].iter().take_while(|leg| leg.is_rotation()).count();
        let within = self.within(first..first + count).without(self.room.in_tube);
        let on_pole = &self.stretch.on_pole[first..=first + count];
        let chain = turns::chain(&self.legs[first..first + count], on_pole, first, within.axis, budget)?;
        rails.deviation.axis = rails.deviation.axis.max(chain.deviation);
        rails.n_blends += chain.n_blends;
        rails.rail.pieces.extend(chain.pieces);
        Ok(())
    }

    /// Joins the runs by blends and stops.
    fn join(&self, runs: Vec<RunSpans>, budget: &Budget) -> Result<Rails, FiveAxisError> {
        let mut rails = Rails {
            rail: Rail::default(),
            deviation: Deviation::NONE,
            n_blends: 0,
            continuity: Continuity::C2,
        };
        let mut piece: Vec<Fitted> = Vec::new();
        for RunSpans { first, mut spans, deviation } in runs {
            budget.check()?;
            rails.deviation = rails.deviation.max(deviation);
            let leg = self.legs[first];
            if leg.is_rotation() {
                rails.end_piece(&mut piece);
                self.turn_at_rest(first, &mut rails, budget)?;
                continue;
            }
            if !piece.is_empty() {
                let legs = [self.legs[first - 1], leg];
                let is_turn = self.turn(first) <= REVERSAL;
                let within = self.within(first - 1..first + 1).without(self.room.at_corners);
                // A blend would miss the pole, and turn a rotary axis far beside it.
                let blends = is_turn && !self.passes_pole(first);
                let found = blends.then(|| blend(&piece, &spans, &legs, within)).flatten();
                if let Some(Blend { span, leaves, meets, deviation }) = found {
                    end_at(&mut piece, leaves);
                    begin_at(&mut spans, meets);
                    piece.push(Fitted { span, source: Source::Corner(first) });
                    rails.deviation = rails.deviation.max(deviation);
                    rails.n_blends += 1;
                } else {
                    rails.end_piece(&mut piece);
                }
            }
            // The parameters of a run begin at zero; only those at the end of a piece matter.
            let end = piece.last().map_or(0.0, |last| last.span.to) - spans[0].span.from;
            piece.extend(spans.into_iter().map(|fitted| {
                let span = fitted.span.moved_to(fitted.span.from + end);
                Fitted { span, ..fitted }
            }));
        }
        rails.end_piece(&mut piece);
        rails.rail.number();
        Ok(rails)
    }
}

impl Rails {
    fn end_piece(&mut self, piece: &mut Vec<Fitted>) {
        if !piece.is_empty() {
            self.rail.pieces.push(Piece::new(std::mem::take(piece)));
        }
    }
}

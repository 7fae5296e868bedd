//! The stations of a motion along rails, and the positions of the axes of a machine there.

use nalgebra::{Point3, Unit};

use super::FiveAxisError;
use super::passage::Passage;
use super::rail::{Piece, Point6, Rail, Span, tip, top};
use crate::budget::Budget;
use crate::machine::{AxisPositions, Inverse, Machine};
use crate::toolpath::pose::Pose;

/// The most and the least stations of a span. With more, the time hardly shrinks.
const PER_SPAN: [usize; 2] = [100, 1];

/// The stations that a whole path aims at, and the most and the least of a piece. More hardly shorten the
/// time: with 100, a line takes less than 0.2 % longer than its closed form.
const WANTED: f64 = 4000.0;
const PER_PIECE: [f64; 2] = [1000.0, 100.0];

/// Of very many pieces, each has its part of so many stations, and at least `FEWEST`. Nodes are added toward
/// the ends of each.
const OF_MANY_PIECES: f64 = 40_000.0;
const FEWEST: f64 = 4.0;

/// Between two stations a rotary axis is to turn by at most the first angle, and must not turn by more than
/// the second one, radians. With larger turns, limits would be missed between stations.
const LARGEST_TURN: f64 = 0.02;
const RESOLVED: f64 = 0.04;

/// The most parts of an interval in one round, and the most rounds: together they resolve a turn that happens
/// within a billionth of an interval.
const MOST_PARTS: f64 = 32.0;
const MOST_ROUNDS: usize = 6;

/// Where a piece ends and the next one begins, an axis turns by at most this angle, radians: rounding.
const SAME_ANGLE: f64 = 1e-10;

/// A parameter of a piece with the positions of the axes there.
pub type Station = (f64, AxisPositions);

pub fn pose(at: &Point6) -> Pose {
    Pose { tip: Point3::from(tip(at)), axis: Unit::new_normalize(top(at)) }
}

/// The parameters of the stations of a piece that is a part `share` of the path; it has at least `fewest`.
fn places(spans: &[Span], share: f64, fewest: f64) -> Vec<f64> {
    let [most, least] = PER_SPAN;
    let wanted = (WANTED * share).clamp(fewest, PER_PIECE[0]);
    let each = ((wanted / spans.len() as f64) as usize).clamp(least, most);
    let mut places = vec![spans[0].from];
    for span in spans {
        places.extend((1..each).map(|k| span.from + span.length() * (k as f64 / each as f64)));
        places.push(span.to);
    }
    places
}

/// Parameters of each piece between which axes need not be followed.
pub fn unfollowed(rail: &Rail) -> Vec<Vec<f64>> {
    let length = |piece: &Piece| piece.spans.iter().map(Span::length).sum::<f64>();
    let whole: f64 = rail.pieces.iter().map(length).sum();
    let fewest = (OF_MANY_PIECES / rail.pieces.len() as f64).clamp(FEWEST, PER_PIECE[1]);
    rail.pieces.iter().map(|piece| places(&piece.spans, length(piece) / whole, fewest)).collect()
}

/// The stations of each piece, between which no rotary axis turns far. Beside the pole a rotary axis turns
/// far on a short way: there the stations are as near as needed. `start` holds the angles of the rotary axes
/// before the path, radians. Where a rapid begins or ends on a pole, `rapids_may_jump`: the machine turns
/// there.
///
/// # Errors
/// Where the machine cannot follow the rails, and where an axis would have to jump.
pub fn resolved(
    rail: &Rail,
    machine: &Machine,
    start: [f64; 2],
    rapids_may_jump: bool,
    budget: &Budget,
) -> Result<Vec<Vec<Station>>, FiveAxisError> {
    let mut places = unfollowed(rail);
    let mut farthest = (0.0, Point3::origin());
    for _ in 0..=MOST_ROUNDS {
        budget.check()?;
        let stations = followed(rail, &places, machine, start)?;
        let mut finer = Vec::with_capacity(places.len());
        farthest = (0.0, Point3::origin());
        for (piece, own) in rail.pieces.iter().zip(&stations) {
            let mut finer_own = vec![own[0].0];
            for pair in own.windows(2) {
                let ([from, to], turn) = ([pair[0].0, pair[1].0], turn(&pair[0].1, &pair[1].1));
                if turn > farthest.0 {
                    farthest = (turn, Point3::from(tip(&piece.spans[piece.index_at(to)].jet(to)[0])));
                }
                let parts = (turn / LARGEST_TURN).ceil().clamp(1.0, MOST_PARTS) as usize;
                let at = |k: usize| from + (to - from) * (k as f64 / parts as f64);
                finer_own.extend((1..parts).map(at));
                finer_own.push(to);
            }
            finer.push(finer_own);
        }
        if farthest.0 <= RESOLVED {
            return match first_jump(rail, &stations, rapids_may_jump) {
                Some(at) => Err(FiveAxisError::OnPole { at }),
                None => Ok(stations),
            };
        }
        places = finer;
    }
    Err(FiveAxisError::OnPole { at: farthest.1 })
}

/// The first place where an axis has two positions because two pieces meet there: on the pole, the angle that
/// a piece ends with may differ from the one that the next piece needs.
fn first_jump(rail: &Rail, stations: &[Vec<Station>], rapids_may_jump: bool) -> Option<Point3<f64>> {
    let ends = stations.windows(2).map(|pair| Some([pair[0].last()?.1, pair[1].first()?.1]));
    rail.pieces.windows(2).zip(ends).find_map(|(pieces, ends)| {
        let [end, start] = ends?;
        let may_jump = rapids_may_jump && pieces.iter().any(|piece| piece.is_rapid);
        let at = tip(&pieces[1].spans[0].start());
        (!may_jump && turn(&end, &start) > SAME_ANGLE).then(|| Point3::from(at))
    })
}

/// The larger turn of the two rotary axes, radians.
fn turn(from: &AxisPositions, to: &AxisPositions) -> f64 {
    (to.rotary[0] - from.rotary[0]).abs().max((to.rotary[1] - from.rotary[1]).abs())
}

/// The positions of the axes along all pieces of a path.
pub struct Followed<'a> {
    machine: &'a Machine,
    pieces: &'a [Piece],
    stations: Vec<Vec<Station>>,
}

impl<'a> Followed<'a> {
    /// Rotary axes may jump where a rapid begins or ends on a pole.
    ///
    /// # Errors
    /// Where the machine cannot follow the rails, and where an axis would have to jump elsewhere.
    pub fn new(
        rail: &'a Rail,
        machine: &'a Machine,
        start: [f64; 2],
        budget: &Budget,
    ) -> Result<Self, FiveAxisError> {
        let stations = resolved(rail, machine, start, true, budget)?;
        Ok(Self { machine, pieces: &rail.pieces, stations })
    }

    /// The positions at a parameter of a piece.
    pub fn at(&self, piece: usize, u: f64) -> AxisPositions {
        let Piece { spans, .. } = &self.pieces[piece];
        let span = &spans[self.pieces[piece].index_at(u)];
        positions(self.machine, &self.stations[piece], span, u)
    }
}

/// The positions at a parameter of a piece, on one of its spans, near those of the stations beside it: what
/// was chosen there is not chosen again.
pub fn positions(machine: &Machine, stations: &[Station], span: &Span, u: f64) -> AxisPositions {
    let k = stations.partition_point(|(at, _)| *at <= u).clamp(1, stations.len() - 1);
    let [(u0, before), (u1, after)] = [stations[k - 1], stations[k]];
    let part = ((u - u0) / (u1 - u0)).clamp(0.0, 1.0);
    let rotary = [0, 1].map(|k| before.rotary[k] + (after.rotary[k] - before.rotary[k]) * part);
    let near = AxisPositions { rotary, ..before };
    through_pole(machine, span, u, &near).unwrap_or_else(|| machine.nearest(&pose(&span.jet(u)[0]), rotary))
}

/// The positions on a span that goes through a pole. By the pose alone, the free angle would be rounded more
/// and more toward the pole.
fn through_pole(machine: &Machine, span: &Span, u: f64, near: &AxisPositions) -> Option<AxisPositions> {
    let through = Passage::of(span, machine)?.jet(u);
    let jet = span.jet(u);
    let [_, _, _, first, second] =
        machine.derivatives(&jet.map(|p| tip(&p)), &jet.map(|p| top(&p)), Some(&through), near)?;
    Some(machine.at(&pose(&jet[0]).tip, [first[0], second[0]]))
}

/// The positions of the axes at places of all pieces.
fn followed(
    rail: &Rail,
    places: &[Vec<f64>],
    machine: &Machine,
    start: [f64; 2],
) -> Result<Vec<Vec<Station>>, FiveAxisError> {
    let (mut poses, mut of_spans) = (Vec::new(), Vec::new());
    for (Piece { spans, .. }, places) in rail.pieces.iter().zip(places) {
        let mut k = 0;
        for u in places {
            while spans[k].to < *u && k + 1 < spans.len() {
                k += 1;
            }
            poses.push(pose(&spans[k].jet(*u)[0]));
            of_spans.push((&spans[k], *u));
        }
    }
    let mut joints = machine.follow_exactly(&poses, start).map_err(|error| {
        let at = poses[error.index().unwrap_or(0).min(poses.len() - 1)].tip;
        FiveAxisError::NotFollowed { error, at }
    })?;
    // On a pole that the path goes through, the free angle is that of the path beside it.
    for k in 0..joints.len() {
        let (span, u) = of_spans[k];
        let is_pole = matches!(machine.inverse(&poses[k]), Inverse::Pole { .. });
        let near = if !is_pole {
            joints[k]
        } else if u > span.from {
            joints[k - 1]
        } else {
            joints[k + 1]
        };
        joints[k] = through_pole(machine, span, u, &near).unwrap_or(joints[k]);
    }
    let mut joints = joints.into_iter();
    let of_piece = |places: &Vec<f64>| places.iter().copied().zip(joints.by_ref()).collect();
    Ok(places.iter().map(of_piece).collect())
}

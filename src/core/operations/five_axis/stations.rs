//! The stations of a motion along rails, and the positions of the axes of a machine there.

use nalgebra::{Point3, Unit};

use super::FiveAxisError;
use super::rail::{Piece, Point6, Rail, Span, tip, top};
use crate::budget::Budget;
use crate::machine::{AxisPositions, Machine};
use crate::toolpath::pose::Pose;

/// The most and the least stations of a span. With more, the time hardly shrinks.
const PER_SPAN: [usize; 2] = [100, 1];

/// The stations that a whole path aims at, and the most and the least of a piece. More hardly shorten the
/// time: with 100, a line takes less than 0.2 % longer than its closed form.
const WANTED: f64 = 4000.0;
const PER_PIECE: [f64; 2] = [1000.0, 100.0];

/// Between two stations a rotary axis is to turn by at most the first angle, and must not turn by more than
/// the second one, radians. With larger turns, limits would be missed between stations.
const LARGEST_TURN: f64 = 0.02;
const RESOLVED: f64 = 0.04;

/// The most parts of an interval in one round, and the most rounds: together they resolve a turn that happens
/// within a billionth of an interval.
const MOST_PARTS: f64 = 32.0;
const MOST_ROUNDS: usize = 6;

/// The stations of all pieces.
pub struct Stations {
    /// The parameters of the stations of each piece.
    pub places: Vec<Vec<f64>>,
    /// The positions of the axes at all stations, one piece after the other; none without a machine.
    pub joints: Vec<Option<AxisPositions>>,
}

pub fn pose(at: &Point6) -> Pose {
    Pose { tip: Point3::from(tip(at)), axis: Unit::new_normalize(top(at)) }
}

/// The parameters of the stations of a piece that is a part `share` of the path.
fn places(spans: &[Span], share: f64) -> Vec<f64> {
    let [most, least] = PER_SPAN;
    let wanted = (WANTED * share).clamp(PER_PIECE[1], PER_PIECE[0]);
    let each = ((wanted / spans.len() as f64) as usize).clamp(least, most);
    let mut places = vec![spans[0].from];
    for span in spans {
        places.extend((1..each).map(|k| span.from + span.length() * (k as f64 / each as f64)));
        places.push(span.to);
    }
    places
}

/// Stations between which no rotary axis turns far. Beside the pole a rotary axis turns far on a short way:
/// there the stations are as near as needed.
pub fn resolved(rail: &Rail, machine: Option<&Machine>, budget: &Budget) -> Result<Stations, FiveAxisError> {
    let length = |piece: &Piece| piece.spans.iter().map(Span::length).sum::<f64>();
    let whole: f64 = rail.pieces.iter().map(length).sum();
    let mut places: Vec<Vec<f64>> =
        rail.pieces.iter().map(|piece| self::places(&piece.spans, length(piece) / whole)).collect();
    let mut farthest = (0.0, Point3::origin());
    for _ in 0..=MOST_ROUNDS {
        budget.check()?;
        let joints = followed(rail, &places, machine)?;
        let mut finer = Vec::with_capacity(places.len());
        let mut first = 0;
        farthest = (0.0, Point3::origin());
        for (piece, own) in rail.pieces.iter().zip(&places) {
            let joints = &joints[first..first + own.len()];
            first += own.len();
            let mut finer_own = vec![own[0]];
            for (pair, ends) in own.windows(2).zip(joints.windows(2)) {
                let turn = ends[0].zip(ends[1]).map_or(0.0, |(a, b)| {
                    (b.rotary[0] - a.rotary[0]).abs().max((b.rotary[1] - a.rotary[1]).abs())
                });
                if turn > farthest.0 {
                    farthest =
                        (turn, Point3::from(tip(&piece.spans[piece.index_at(pair[1])].jet(pair[1])[0])));
                }
                let parts = (turn / LARGEST_TURN).ceil().clamp(1.0, MOST_PARTS) as usize;
                let at = |k: usize| pair[0] + (pair[1] - pair[0]) * (k as f64 / parts as f64);
                finer_own.extend((1..parts).map(at));
                finer_own.push(pair[1]);
            }
            finer.push(finer_own);
        }
        if farthest.0 <= RESOLVED {
            return Ok(Stations { places, joints });
        }
        places = finer;
    }
    Err(FiveAxisError::OnPole { at: farthest.1 })
}

/// The positions of the axes at all stations.
fn followed(
    rail: &Rail,
    places: &[Vec<f64>],
    machine: Option<&Machine>,
) -> Result<Vec<Option<AxisPositions>>, FiveAxisError> {
    let Some(machine) = machine else {
        return Ok(places.iter().flatten().map(|_| None).collect());
    };
    let mut poses = Vec::new();
    for (Piece { spans, .. }, places) in rail.pieces.iter().zip(places) {
        let mut k = 0;
        for u in places {
            while spans[k].to < *u && k + 1 < spans.len() {
                k += 1;
            }
            poses.push(pose(&spans[k].jet(*u)[0]));
        }
    }
    Ok(follow(machine, &poses)?.into_iter().map(Some).collect())
}

/// The positions of the axes at poses.
pub fn follow(machine: &Machine, poses: &[Pose]) -> Result<Vec<AxisPositions>, FiveAxisError> {
    machine.follow(poses, [0.0; 2]).map_err(|error| {
        let at = poses[error.index().unwrap_or(0).min(poses.len() - 1)].tip;
        FiveAxisError::NotFollowed { error, at }
    })
}

//! A quintic around a corner, from the rails before it to the rails after it.

use super::deviation::{Deviation, of_line, of_span, part_of, seen};
use super::leg::Leg;
use super::rail::{Fitted, Span, tip};
use crate::toolpath::tool_axes::angle_between;

/// The part of a leg that a blend may take: the corner at its other end needs room too.
const ROOM: f64 = 0.45;

/// Trials for the distance of a blend from its corner, and the largest and the smallest factor between two.
const TRIALS: usize = 24;
const SHORTER: [f64; 2] = [0.3, 0.9];

/// The part of the tolerance that a blend is to take.
const WANTED: f64 = 0.999;

/// The distance at which a blend between two lines at a right angle is one unit away from the corner, by the
/// sine of half the turn: a quintic over the same parameter as the lines leaves 3/16 of the difference of
/// both directions.
const FIRST: f64 = 1.0 / 0.375;

/// The least sine of half a turn in the estimate of the first distance. At a corner without a turn the sine
/// is zero, and the room decides alone: the estimate is then longer than any leg.
const LEAST_SINE: f64 = 1e-9;

/// The parts of a blend at whose ends its deviation is seen.
const PLACES: usize = 8;

/// Blends that are shorter gain nothing over a stop, mm.
const SHORTEST_MM: f64 = 1e-5;

pub struct Blend {
    pub span: Span,
    /// The parameters at which it leaves the run before and meets the run after.
    pub leaves: f64,
    pub meets: f64,
    pub deviation: Deviation,
}

/// The longest blend within the tolerance between a run and the run after it, which meet at the corner of the
/// two legs; none if only a tiny one would be.
pub fn blend(before: &[Fitted], after: &[Fitted], legs: &[Leg; 2], tolerance: Deviation) -> Option<Blend> {
    let ends = [before.last()?.span.to, after.first()?.span.from];
    let turn = angle_between(&legs[0].direction(), &legs[1].direction());
    let room = ROOM * legs[0].length.min(legs[1].length);
    let mut distance = room.min(FIRST * WANTED * tolerance.tip_mm / (0.5 * turn).sin().max(LEAST_SINE));
    for _ in 0..TRIALS {
        if distance < SHORTEST_MM {
            break;
        }
        let (leaves, meets) = (ends[0] - distance, ends[1] + distance);
        let start = before.iter().rev().find(|fitted| fitted.span.from < leaves)?.span.jet(leaves);
        let end = after.iter().find(|fitted| fitted.span.to > meets)?.span.jet(meets);
        let span =
            Span::quintic([0.0, 2.0 * distance], [start[0], start[1], start[2]], [end[0], end[1], end[2]]);
        let parts = [part_of(&legs[0], &tip(&start[0])), part_of(&legs[1], &tip(&end[0]))];
        let seen = seen_around(&span, legs);
        if let Some(deviation) = proved(&span, legs, parts, seen, tolerance) {
            return Some(Blend { span, leaves, meets, deviation });
        }
        // The deviation grows with the distance of the blend's ends from the corner.
        let [least, most] = SHORTER;
        distance *= (WANTED / seen.of(tolerance)).clamp(least, most);
    }
    None
}

/// The deviation of a blend at some places, and of the corner from its middle.
fn seen_around(around: &Span, legs: &[Leg; 2]) -> Deviation {
    let place = |k: usize| around.jet(around.from + around.length() * k as f64 / PLACES as f64)[0];
    let apart = (tip(&place(PLACES / 2)) - tip(&legs[0].end)).norm();
    let places = (1..PLACES).map(|k| seen(&place(k), legs));
    places.fold(Deviation { tip_mm: apart, axis: 0.0 }, Deviation::max)
}

/// The bound of a blend's deviation, both ways; none if it leaves the tolerance.
fn proved(
    around: &Span,
    legs: &[Leg; 2],
    parts: [f64; 2],
    seen: Deviation,
    tolerance: Deviation,
) -> Option<Deviation> {
    // A blend that leaves the tolerance at one of the tried places needs no proof: it is refused.
    if seen.of(tolerance) > 1.0 {
        return None;
    }
    let there = of_span(around, legs, tolerance);
    if there.of(tolerance) > 1.0 {
        return None;
    }
    let back = of_line(around, &legs[0], [parts[0], 1.0]).max(of_line(around, &legs[1], [0.0, parts[1]]));
    let both = Deviation { tip_mm: there.tip_mm.max(back), ..there };
    (both.of(tolerance) <= 1.0).then_some(both)
}

/// Ends a run at a parameter.
pub fn end_at(spans: &mut Vec<Fitted>, to: f64) {
    while spans.last().is_some_and(|last| last.span.from >= to) {
        spans.pop();
    }
    if let Some(last) = spans.last_mut()
        && last.span.to > to
    {
        let [first, _] = last.span.split(to);
        last.span = first;
    }
}

/// Begins a run at a parameter.
pub fn begin_at(spans: &mut Vec<Fitted>, from: f64) {
    let gone = spans.iter().take_while(|fitted| fitted.span.to <= from).count();
    spans.drain(..gone);
    if let Some(first) = spans.first_mut()
        && first.span.from < from
    {
        let [_, second] = first.span.split(from);
        first.span = second;
    }
}

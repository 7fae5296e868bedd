//! A rotation of the tool about its resting tip, and the even motion along a leg.

use super::leg::Leg;
use super::rail::{Point6, Span, join, tip, top};

/// The largest turn of one span, radians. A quintic with the right values and derivatives at the ends of so
/// much leaves the speed of the turn within 1e-7 of even.
const LARGEST_TURN: f64 = 0.25;

/// The spans of a turn on the great circle. The parameter is the way of the top, mm.
pub fn spans(leg: &Leg) -> Vec<Span> {
    let count = (leg.angle / LARGEST_TURN).ceil().max(1.0) as usize;
    even(leg, leg.angle * top(&leg.start).norm(), count)
}

/// The spans of a leg, along which tip and axis move evenly by a parameter from zero to `length`. At the ends
/// of the spans, value and two derivatives are exact.
pub fn even(leg: &Leg, length: f64, count: usize) -> Vec<Span> {
    let (from, radius) = (top(&leg.start), top(&leg.start).norm());
    let across = top(&leg.end) - from * (from.dot(&top(&leg.end)) / (radius * radius));
    let across = across.try_normalize(0.0).unwrap_or_default() * radius;
    let rate = leg.angle / length;
    let moves = (tip(&leg.end) - tip(&leg.start)) / length;
    let jet = |k: usize| -> [Point6; 3] {
        let part = k as f64 / count as f64;
        let (sin, cos) = (part * leg.angle).sin_cos();
        let out = from * cos + across * sin;
        let value = match k {
            0 => leg.start,
            k if k == count => leg.end,
            _ => join(tip(&leg.start).lerp(&tip(&leg.end), part), out),
        };
        let resting = nalgebra::Vector3::zeros();
        [value, join(moves, (across * cos - from * sin) * rate), join(resting, out * (-rate * rate))]
    };
    let at = |k: usize| length * (k as f64 / count as f64);
    (0..count).map(|k| Span::quintic([at(k), at(k + 1)], jet(k), jet(k + 1))).collect()
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;

    use super::*;
    use crate::toolpath::tool_axes::angle_between;

    #[test]
    fn the_axis_turns_evenly_on_the_great_circle() {
        let tip = Vector3::new(1.0, 2.0, 3.0);
        let leg = Leg::new(join(tip, Vector3::z() * 40.0), join(tip, Vector3::new(0.0, 40.0, 0.0)));
        let spans = spans(&leg);
        let whole = spans[spans.len() - 1].to;
        for k in 0..=100 {
            let u = whole * f64::from(k) / 100.0;
            let span = spans.iter().find(|span| u <= span.to).unwrap();
            let axis = top(&span.jet(u)[0]);
            assert!((angle_between(&Vector3::z(), &axis) - u / 40.0).abs() < 1e-7);
            assert!(axis.x.abs() < 1e-12);
        }
    }
}

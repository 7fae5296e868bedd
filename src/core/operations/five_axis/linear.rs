//! The legs as they are: the motion stops between them.

use super::deviation::{Deviation, of_span};
use super::leg::Leg;
use super::rail::{Fitted, Piece, Point6, Rail, Source};
use super::{Continuity, Rails, rotation};

/// Between two points of a leg the axis turns by at most this angle, radians. The mean of two axes is then
/// within a seventh of a microradian of their great circle; the least legal tolerance is ten times as large.
const LARGEST_TURN: f64 = 0.02;

pub fn rails(stations: &[Point6]) -> Rails {
    let mut rail = Rail::default();
    let mut deviation = Deviation::NONE;
    for (k, pair) in stations.windows(2).enumerate() {
        let leg = Leg::new(pair[0], pair[1]);
        let count = (leg.angle / LARGEST_TURN).ceil().max(1.0) as usize;
        let spans =
            if leg.is_rotation() { rotation::spans(&leg) } else { rotation::even(&leg, leg.length, count) };
        // A turn about a resting tip is on its great circle.
        for span in spans.iter().filter(|_| !leg.is_rotation()) {
            let part = Leg::new(span.start(), span.end());
            deviation = deviation.max(of_span(span, &[part], Deviation::NONE));
        }
        let fitted = spans.into_iter().map(|span| Fitted { span, source: Source::Leg(k) });
        rail.pieces.push(Piece::new(fitted));
    }
    rail.number();
    Rails { rail, deviation, n_blends: 0, continuity: Continuity::C0 }
}

//! Turns of the tool one after the other about its resting tip.
//!
//! One turn is an arc of a great circle. Turns one after the other are smoothed like any path, on which the
//! top moves in place of the tip: they are one motion, but for stops where the axis turns back.

use nalgebra::Vector3;

use super::{Room, Stretch, smooth};
use crate::budget::Budget;
use crate::operations::five_axis::FiveAxisError;
use crate::operations::five_axis::deviation::Deviation;
use crate::operations::five_axis::leg::Leg;
use crate::operations::five_axis::rail::{Fitted, Piece, Source, Span, join, tip, top};
use crate::operations::five_axis::rotation::spans;

/// Between two points of a chain the axis turns by at most this angle, radians, and its arc leaves the chord
/// by at most the part `SAG` of the tolerance.
const LARGEST_STEP: f64 = 0.1;
const SAG: f64 = 0.1;

/// Points nearer to each other than this part of the height are one point.
const ONE_POINT: f64 = 1e-6;

/// A chord is at least this part of the height away from the tip: its angles are larger by as much.
const NEAREST: f64 = 0.99;

/// Pieces of turns one after the other.
pub struct Chain {
    pub pieces: Vec<Piece>,
    /// How far an axis is from the great circles, at most, radians.
    pub deviation: f64,
    pub n_blends: usize,
}

/// The motion along turns about one tip, within an angle of their great circles. It hits the stations that
/// are `on_pole`. The sources of its spans count legs from `first` on.
///
/// # Errors
/// The errors of [`smooth`].
pub fn chain(
    legs: &[Leg],
    on_pole: &[bool],
    first: usize,
    tolerance: f64,
    budget: &Budget,
) -> Result<Chain, FiveAxisError> {
    if let [leg] = legs {
        let fitted = spans(leg).into_iter().map(|span| Fitted { span, source: Source::Leg(first) });
        return Ok(Chain { pieces: vec![Piece::new(fitted)], deviation: 0.0, n_blends: 0 });
    }
    let height = top(&legs[0].start).norm();
    let step = (8.0 * SAG * tolerance).sqrt().min(LARGEST_STEP);
    let moved = |top: Vector3<f64>| join(top, Vector3::z());
    let mut stations = vec![moved(top(&legs[0].start))];
    let (mut of_legs, mut is_hit) = (Vec::new(), vec![on_pole[0]]);
    for (k, leg) in legs.iter().enumerate() {
        if leg.angle <= ONE_POINT {
            continue;
        }
        let parts = (leg.angle / step).ceil() as usize;
        for n in 1..=parts {
            let at = if n == parts { top(&leg.end) } else { leg.top_at(n as f64 / parts as f64) };
            stations.push(moved(at));
            is_hit.push(n == parts && on_pole[k + 1]);
            of_legs.push(first + k);
        }
    }
    let rooms = vec![f64::INFINITY; of_legs.len()];
    let stretch = Stretch { stations: &stations, on_pole: &is_hit, rooms: &rooms };
    let within = Deviation { tip_mm: NEAREST * height * tolerance, axis: tolerance };
    let none = Room { at_corners: Deviation::NONE, in_tube: Deviation::NONE };
    let rails = smooth(&stretch, within, none, false, budget)?;
    let at = tip(&legs[0].start);
    let turned = |piece: Piece| {
        let fitted = piece.spans.into_iter().zip(piece.sources).map(|(span, source)| {
            let span = Span { control: span.control.map(|p| join(at, tip(&p))), ..span };
            Fitted { span, source: Source::Run(source.legs().map(|k| of_legs[k])) }
        });
        Piece::new(fitted)
    };
    Ok(Chain {
        pieces: rails.rail.pieces.into_iter().map(turned).collect(),
        deviation: rails.deviation.tip_mm / (NEAREST * height),
        n_blends: rails.n_blends,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::operations::five_axis::rail::Point6;

    #[test]
    fn turns_one_after_the_other_are_one_motion_unless_the_axis_turns_back() {
        let leaning = |x: f64, y: f64| join(Vector3::x(), Vector3::new(x, y, 1.0).normalize() * 50.0);
        let chained = |places: &[[f64; 2]]| {
            let stations: Vec<Point6> = places.iter().map(|[x, y]| leaning(*x, *y)).collect();
            let legs: Vec<Leg> = stations.windows(2).map(|pair| Leg::new(pair[0], pair[1])).collect();
            chain(&legs, &vec![false; stations.len()], 7, 0.002, &Budget::unlimited()).unwrap()
        };
        let round: Vec<[f64; 2]> =
            (0..=20).map(|k| f64::from(k) * 0.1).map(|t| [0.3 * t.cos(), 0.3 * t.sin()]).collect();
        for places in [&round[..], &[[0.0, 0.0], [0.3, 0.0], [0.3, 0.4]]] {
            let Chain { pieces, deviation, .. } = chained(places);
            assert_eq!(pieces.len(), 1);
            assert!(deviation <= 0.002);
            assert!(
                pieces[0].rests() && pieces[0].spans.iter().all(|span| tip(&span.start()) == Vector3::x())
            );
            assert!(
                (top(&pieces[0].spans[0].start()) - top(&leaning(places[0][0], places[0][1]))).norm() < 1e-12
            );
            for source in &pieces[0].sources {
                assert!(source.legs()[0] >= 7 && source.legs()[1] < 7 + places.len() - 1);
            }
        }
        assert_eq!(chained(&[[0.0, 0.0], [0.3, 0.0], [0.1, 0.0]]).pieces.len(), 2);
    }
}

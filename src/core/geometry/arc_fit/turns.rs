//! Arcs over a chord, one for each way in which the lines between the points turn about the arc's centre.
//!
//! An element runs the same way round as its points: the lines between the points turn about its centre
//! as far as the arc, give or take half a turn. How far they turn changes only where the centre crosses
//! one of the lines. So the crossings cut the bulges into ranges, and in some of these ranges no arc can
//! fit. A range may be too small for bulges that are tried at fixed places.

use nalgebra::Vector2;

use super::chord::{Bulges, Chord};

/// Most crossings that cut the bulges. Points with more crossings are noise, and each range costs a check of
/// all points.
const MOST_CROSSINGS: usize = 64;

/// A bulge from the middle of each range, for arcs over `chord` with these `bulges` and the `lines` between
/// the points. Empty if the centre crosses no line.
pub fn between(lines: impl Iterator<Item = [Vector2<f64>; 2]>, bulges: &Bulges, chord: &Chord) -> Vec<f64> {
    let crossed = lines.map(|line| line.map(|p| chord.local(p))).filter(|[a, b]| a.x * b.x < 0.0);
    let crossings: Vec<f64> = crossed
        .flat_map(|[a, b]| {
            // Two arcs have their centres at this height: see `Chord::center`.
            let share = (a.y * b.x - b.y * a.x) / ((b.x - a.x) * chord.half);
            [share - share.hypot(1.0), share + share.hypot(1.0)]
        })
        .take(MOST_CROSSINGS)
        .collect();
    let mut middles = Vec::new();
    for [low, high] in bulges.curved(chord.flattest()) {
        let mut ends: Vec<f64> = crossings.iter().copied().filter(|b| low < *b && *b < high).collect();
        if ends.is_empty() {
            continue;
        }
        ends.extend([low, high]);
        ends.sort_by(f64::total_cmp);
        middles.extend(ends.windows(2).map(|ends| (0.5 * (ends[0].atan() + ends[1].atan())).tan()));
    }
    middles
}

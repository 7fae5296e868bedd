//! More bulges to try where the bulges at fixed places have given no arc (`candidate`).
//!
//! Each bulge puts the arc's centre at one place. Seen from there, the lines between the points turn by some
//! angle, and an arc fits only if it turns by the same angle, give or take half a turn. As the centre moves,
//! this angle jumps only where the centre crosses one of the lines. So the crossings cut the bulges into
//! ranges, and in some of them no arc can fit. A range may be so narrow that no fixed place is in it.

use nalgebra::Vector2;

use super::chord::{Bulges, Chord};

/// At most this many crossings are used, two for each line that is crossed. More of them come from noise, and
/// each range costs a check of all points.
const MOST_CROSSINGS: usize = 64;

/// A bulge from the middle of each range, for arcs over `chord` with these `bulges`, none below `flattest`,
/// and the `lines` between the points. Empty if no crossing is among the bulges.
pub fn one_bulge_per_range(
    lines: impl Iterator<Item = [Vector2<f64>; 2]>,
    bulges: &Bulges,
    chord: &Chord,
    flattest: f64,
) -> Vec<f64> {
    let crossed = lines.map(|line| line.map(|p| chord.local(p))).filter(|[a, b]| a.x * b.x < 0.0);
    let crossings: Vec<f64> = crossed
        .flat_map(|[a, b]| {
            // The height of the centre where it crosses the line, by half the chord. Two arcs have this
            // centre: see `Chord::center`.
            let share = (a.y * b.x - b.y * a.x) / ((b.x - a.x) * chord.half);
            [share - share.hypot(1.0), share + share.hypot(1.0)]
        })
        .take(MOST_CROSSINGS)
        .collect();
    let mut middles = Vec::new();
    for [low, high] in bulges.curved(flattest) {
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

//! The clock of diagrams beside the time of the path.
//!
//! Diagrams show a motion with its ramps, and without the ways in and out. The times of the path are those of
//! lengths and feeds. So both clocks tell other times at the same place.

/// Most pairs of a clock. Between two pairs both clocks count as even.
const MOST_PAIRS: usize = 2000;

/// Pairs of seconds at the same places: on the clock of the diagrams, and of the path. `diagram_s` and
/// `path_s` have the times at the ends of all moves. The first pair is where the motion of the diagrams
/// begins, and the last one where it ends. Nothing for a path without moves.
pub fn pairs(diagram_s: &[f64], path_s: &[f64]) -> Vec<[f64; 2]> {
    let all: Vec<[f64; 2]> = std::iter::once([0.0; 2])
        .chain(diagram_s.iter().zip(path_s).map(|(own, path)| [*own, *path]))
        .collect();
    let [.., [end, _]] = all[..] else { return Vec::new() };
    let first = all.iter().rposition(|[own, _]| *own <= 0.0).unwrap_or(0);
    let last = all.iter().position(|[own, _]| *own >= end).unwrap_or(0);
    let Some(moving) = all.get(first..=last).filter(|moving| moving.len() > 1) else { return Vec::new() };
    let every = moving.len().div_ceil(MOST_PAIRS);
    let mut kept: Vec<[f64; 2]> = moving.iter().copied().step_by(every).collect();
    if (moving.len() - 1) % every != 0 {
        kept.push(moving[moving.len() - 1]);
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_clock_begins_and_ends_with_the_motion() {
        // A way in of 2 s, a motion of 3 s that the path counts as 2.5 s, and a way out of 1 s.
        let found = pairs(&[0.0, 1.0, 3.0, 3.0], &[2.0, 2.5, 4.5, 5.5]);
        assert_eq!(found, [[0.0, 2.0], [1.0, 2.5], [3.0, 4.5]]);
        assert_eq!(pairs(&[1.0], &[4.0]), [[0.0, 0.0], [1.0, 4.0]]);
        assert!(pairs(&[], &[]).is_empty() && pairs(&[0.0, 0.0], &[1.0, 2.0]).is_empty());
    }

    #[test]
    fn a_long_clock_is_thinned_and_keeps_its_ends() {
        let times: Vec<f64> = (1..=12_345).map(f64::from).collect();
        let found = pairs(&times, &times);
        assert!(found.len() <= MOST_PAIRS + 1, "{}", found.len());
        assert_eq!((found[0], found[found.len() - 1]), ([0.0; 2], [12_345.0; 2]));
    }
}

//! Finds the best element between two given ends.
//!
//! # Method
//! * The best arc is as far from the farthest point on its left as from the farthest point on its right.
//! * If the lines between the points count, their farthest places can take part in the balance, too. They do
//!   so first for an arc that starts or ends beside its points, and otherwise if the arc above does not keep
//!   the rule.
//! * If neither arc keeps the rule, the first element found is the result.
//!
//! Each balance is a root, because every signed distance falls as the bulge grows
//! ([`Chord::signed_distance`]). The paper asks for the arc with the least largest error, which has this
//! property.

use nalgebra::Vector2;

use super::candidate::{PointRange, Rule, Witnesses};
use super::chord::Chord;
use super::chord_frame::nearest_on_line;
use super::{FLATTEST_MM, Shapes};
use crate::geometry::solve;

/// The bulge with the least largest deviation, 0 for a line; `None` if no element keeps the rule. An arc
/// flatter than [`FLATTEST_MM`] becomes a line if a line keeps the rule.
pub fn best_bulge(span: &PointRange, rule: &Rule) -> Option<f64> {
    let found = span.find(rule, &mut Witnesses::default())?;
    if span.last == span.first + 1 || rule.shapes == Shapes::LinesOnly {
        return Some(found);
    }
    let Some((chord, part)) = part_of(span, found, rule) else { return Some(found) };
    let flattest = chord.flattest(rule.largest_radius_mm);
    let best = balanced(span, &chord, part);
    let is_flat = best.abs() < flattest || best.abs() * chord.half < FLATTEST_MM;
    if is_flat && found == 0.0 {
        return Some(0.0);
    }
    let keeps =
        |bulge: &f64| bulge.abs() >= flattest && span.keeps(*bulge, rule, &chord, &mut Witnesses::default());
    let counts_lines = rule.counts_lines() && span.points.heights.is_empty();
    let with_lines = || counts_lines.then(|| balanced_with_lines(span, &chord, part)).filter(keeps);
    let by_points = Some(best).filter(keeps);
    let best = if span.is_on_points() { by_points.or_else(with_lines) } else { with_lines().or(by_points) };
    Some(best.unwrap_or(found))
}

/// The chord, and the interval of valid bulges about one that keeps the rule. `None` if rounding has put
/// this bulge outside every interval.
fn part_of(span: &PointRange, found: f64, rule: &Rule) -> Option<(Chord, [f64; 2])> {
    let bulges = span.bulges(rule, &mut Witnesses::default())?;
    let part = bulges.parts().find(|part| (part[0]..=part[1]).contains(&found))?;
    Some((Chord::new(span.from, span.to)?, part))
}

/// The bulge in `part` that leaves the farthest points to its left and to its right equally far.
fn balanced(span: &PointRange, chord: &Chord, part: [f64; 2]) -> f64 {
    let unbalance = |bulge: f64| {
        let mut range = [0.0; 2];
        for p in span.inner() {
            widen(&mut range, chord.signed_distance(bulge, chord.local(*p)));
        }
        range[0] + range[1]
    };
    solve::falling_root(part, unbalance)
}

/// As [`balanced`], for the lines between the points. Of each line, its end counts, and its place nearest to
/// the arc's centre.
fn balanced_with_lines(span: &PointRange, chord: &Chord, part: [f64; 2]) -> f64 {
    let unbalance = |bulge: f64| {
        let mut range = [0.0; 2];
        for [p, q] in span.lines().map(|line| line.map(|p| chord.local(p))) {
            widen(&mut range, chord.signed_distance(bulge, q));
            if bulge != 0.0 {
                let center = Vector2::new(0.0, chord.center(bulge));
                widen(&mut range, chord.signed_distance(bulge, nearest_on_line(center, p, q)));
            }
        }
        range[0] + range[1]
    };
    solve::falling_root(part, unbalance)
}

/// Widens a range so that it includes a number.
fn widen(range: &mut [f64; 2], number: f64) {
    *range = [range[0].min(number), range[1].max(number)];
}

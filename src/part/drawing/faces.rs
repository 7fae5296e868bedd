//! The loops of curves that touch each other in several places.
//!
//! # Method
//! Chains that meet in branches divide the plane into faces. Where an even number of ends meets at each
//! branch, the faces are inside and outside by turns: two faces beside one chain differ. The boundary of each
//! face inside is one loop, so that the loops bound the same places as the curves do by the even-odd rule.
//!
//! 1. The ends at each branch are put in order by their directions, and by their curvatures where directions
//!    are equal.
//! 2. A walk that always takes the next end clockwise follows the boundary of a face on its left. The face
//!    with a negative area is the one around everything.
//! 3. Faces are coloured from there, across chains.
//!
//! # Degenerate input
//! Chains stay open if an odd number of ends meets somewhere, if two ends leave a branch alike, or if the
//! curves cross each other beside branches in such a way that there is no face around them or more than one.

use std::cmp::Ordering;
use std::collections::{HashMap, HashSet};

/// How an end leaves its branch.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Leaving {
    /// The direction away from the branch, radians.
    pub angle: f64,
    /// Positive if the curve turns to the left, 1/mm.
    pub curvature: f64,
}

/// Directions that differ by less than this angle are compared by curvature, radians. The value is above the
/// rounding of ends that are computed from angles, and far below the angle between two sides of a drawing.
const ALIKE: f64 = 1e-6;

/// Curvatures that differ by less than this part are equal.
const ALIKE_PART: f64 = 1e-6;

/// The ends to join, two by two. `branches` are the ends at each branch; the chain of each of them leads to
/// an end at a branch, its opposite. `area` is the area between the branches' origin and the chain that
/// leaves at an end, positive to its left.
pub fn joints(
    branches: &[Vec<usize>],
    leaving: impl Fn(usize) -> Leaving,
    opposite: impl Fn(usize) -> usize,
    area: impl Fn(usize) -> f64,
) -> Vec<[usize; 2]> {
    let branch_of: HashMap<usize, usize> =
        branches.iter().enumerate().flat_map(|(k, ends)| ends.iter().map(move |end| (*end, k))).collect();
    let mut is_seen = vec![false; branches.len()];
    let mut joints = Vec::new();
    for first in 0..branches.len() {
        let mut connected = Vec::new();
        let mut open = vec![first];
        while let Some(number) = open.pop() {
            if !std::mem::replace(&mut is_seen[number], true) {
                connected.push(number);
                open.extend(branches[number].iter().filter_map(|end| branch_of.get(&opposite(*end))));
            }
        }
        let Some(next) = walk(&connected, branches, &leaving, &opposite) else { continue };
        joints.extend(inside(&next, &opposite, &area).unwrap_or_default());
    }
    joints
}

/// For each end of connected branches, the end at which the boundary of the face to the left of its chain
/// goes on; `None` if there is no order.
fn walk(
    connected: &[usize],
    branches: &[Vec<usize>],
    leaving: &impl Fn(usize) -> Leaving,
    opposite: &impl Fn(usize) -> usize,
) -> Option<HashMap<usize, usize>> {
    let mut clockwise = HashMap::new();
    for number in connected {
        let mut ends: Vec<(usize, Leaving)> =
            branches[*number].iter().map(|end| (*end, leaving(*end))).collect();
        ends.sort_by(|(_, a), (_, b)| a.angle.total_cmp(&b.angle));
        // A direction just above -180 degrees is alike to one just below 180.
        let turns = ends.iter().position(|(_, end)| end.angle > ALIKE - std::f64::consts::PI).unwrap_or(0);
        ends.rotate_left(turns);
        let n = ends.len();
        if n % 2 == 1 {
            return None;
        }
        let is_alike = |a: &Leaving, b: &Leaving| turned(a.angle, b.angle) < ALIKE;
        let mut start = 0;
        while start < n {
            let count = ends[start..].windows(2).take_while(|pair| is_alike(&pair[0].1, &pair[1].1)).count();
            let alike = &mut ends[start..=start + count];
            alike.sort_by(|(_, a), (_, b)| a.curvature.total_cmp(&b.curvature));
            if alike.windows(2).any(|pair| curves_alike(&pair[0].1, &pair[1].1) != Ordering::Less) {
                return None;
            }
            start += count + 1;
        }
        for k in 0..n {
            clockwise.insert(ends[k].0, ends[(k + n - 1) % n].0);
        }
    }
    clockwise.keys().map(|end| Some((*end, *clockwise.get(&opposite(*end))?))).collect()
}

/// The angle between two directions.
fn turned(a: f64, b: f64) -> f64 {
    let apart = (b - a).abs();
    apart.min((std::f64::consts::TAU - apart).abs())
}

fn curves_alike(a: &Leaving, b: &Leaving) -> Ordering {
    let slack = ALIKE_PART * a.curvature.abs().max(b.curvature.abs());
    if a.curvature + slack < b.curvature { Ordering::Less } else { Ordering::Equal }
}

/// The joints along the boundaries of the faces inside; `None` if the faces have no colours.
fn inside(
    next: &HashMap<usize, usize>,
    opposite: &impl Fn(usize) -> usize,
    area: &impl Fn(usize) -> f64,
) -> Option<Vec<[usize; 2]>> {
    let mut face_of: HashMap<usize, usize> = HashMap::new();
    let mut faces: Vec<Vec<usize>> = Vec::new();
    let mut ends: Vec<usize> = next.keys().copied().collect();
    ends.sort_unstable();
    for end in &ends {
        let mut at = *end;
        let mut face = Vec::new();
        while !face_of.contains_key(&at) {
            face_of.insert(at, faces.len());
            face.push(at);
            at = next[&at];
        }
        if !face.is_empty() {
            faces.push(face);
        }
    }
    let areas: Vec<f64> = faces.iter().map(|face| face.iter().map(|end| area(*end)).sum()).collect();
    let mut around = (0..faces.len()).filter(|k| areas[*k] <= 0.0);
    let (outer, None) = (around.next()?, around.next()) else { return None };
    let mut is_inside: HashMap<usize, bool> = HashMap::from([(outer, false)]);
    let mut open = vec![outer];
    while let Some(face) = open.pop() {
        for end in &faces[face] {
            let beside = face_of[&opposite(*end)];
            match is_inside.get(&beside) {
                Some(known) if *known == is_inside[&face] => return None,
                Some(_) => {}
                None => {
                    is_inside.insert(beside, !is_inside[&face]);
                    open.push(beside);
                }
            }
        }
    }
    let chosen: HashSet<usize> = is_inside.iter().filter(|(_, inside)| **inside).map(|(k, _)| *k).collect();
    let along = ends.iter().filter(|end| chosen.contains(&face_of[*end]));
    Some(along.map(|end| [opposite(*end), next[end]]).collect())
}

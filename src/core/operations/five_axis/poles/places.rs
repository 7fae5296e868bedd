//! Places of a stretch at which its axes are given anew.

use super::{SAME_PART, way};
use crate::operations::five_axis::path::Path;

/// A pose of the path at most this part of a stretch from its middle is the one on the pole.
const MIDDLE: f64 = 0.1;

/// Poses are added where there is none within this part of a stretch.
const APART: f64 = 0.02;

/// A pose of a stretch.
pub struct Node {
    pub leg: usize,
    pub part: f64,
    /// From 0 at the start of the stretch to 1 at its end.
    pub share: f64,
    pub is_given: bool,
}

/// The ends of a stretch and the stations inside it.
pub fn places(path: &Path, ends: [(usize, f64); 2]) -> Vec<Node> {
    let [(first, from), (last, to)] = ends;
    let mut places = vec![Node { leg: first, part: from, share: 0.0, is_given: true }];
    let mut sum = 0.0;
    for k in first..=last {
        let part = [if k == first { from } else { 0.0 }, if k == last { to } else { 1.0 }];
        sum += (part[1] - part[0]) * way(&path.leg(k));
        places.push(if k < last {
            Node { leg: k + 1, part: 0.0, share: sum, is_given: true }
        } else {
            Node { leg: k, part: to, share: sum, is_given: true }
        });
    }
    places.iter_mut().for_each(|place| place.share /= sum);
    places
}

/// Adds places at shares where there are none nearby.
pub fn add(places: &mut Vec<Node>, shares: &[f64]) {
    for share in shares {
        if places.iter().all(|place| (place.share - share).abs() >= APART) {
            insert(places, *share);
        }
    }
}

/// Adds the place on the pole, unless a pose is there but for rounding.
pub fn add_center(places: &mut Vec<Node>, share: f64) {
    match places.iter_mut().find(|place| (place.share - share).abs() <= SAME_PART) {
        Some(place) => place.share = share,
        None => insert(places, share),
    }
}

/// Adds a place at a share.
fn insert(places: &mut Vec<Node>, share: f64) {
    let k = places.partition_point(|place| place.share < share);
    let [before, after] = [&places[k - 1], &places[k]];
    let part = (share - before.share) / (after.share - before.share);
    // The place after is on the same leg, or at its end.
    let end = if after.leg == before.leg { after.part } else { 1.0 };
    let place =
        Node { leg: before.leg, part: before.part + part * (end - before.part), share, is_given: false };
    places.insert(k, place);
}

/// Lets the given pose nearest to the middle of a stretch be in its middle, if it is near, in place of one
/// that was added.
pub fn center(places: &mut Vec<Node>) {
    let last = places.len() - 1;
    let off = |place: &Node| (place.share - 0.5).abs();
    let inner = (1..last).filter(|k| places[*k].is_given && off(&places[*k]) <= MIDDLE);
    let Some(k) = inner.min_by(|a, b| off(&places[*a]).total_cmp(&off(&places[*b]))) else { return };
    let middle = places[k].share;
    for place in places.iter_mut() {
        place.share = if place.share <= middle {
            0.5 * place.share / middle
        } else {
            1.0 - 0.5 * (1.0 - place.share) / (1.0 - middle)
        };
    }
    places[k].share = 0.5;
    places.retain(|place| place.is_given);
}

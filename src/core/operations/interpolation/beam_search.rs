//! Searches for an interpolation with fewer elements than greedy growth (`least`) finds. Greedy growth makes
//! each element as long as possible, from the start of the curve to its end.
//!
//! # Method
//! 1. Layer k is a set of places on the curve that k elements can reach. Layer 0 holds only the start of the
//!    curve.
//! 2. From each place of layer k, find the longest element. The ends of these elements belong to layer k + 1.
//! 3. Divide the curve between the farthest places of layers k and k + 1 into equal parts. Add each of these
//!    places, and each corner of the curve between them, to layer k + 1 if an element from a place of layer k
//!    reaches it. Near an inflection or at a corner, an element that starts there may reach farther than an
//!    element that starts at the farthest place.
//! 4. Repeat steps 2 and 3 for the next layer, until an element reaches the end of the curve. If the layers
//!    become as many as the elements of greedy growth, nothing is gained, and these elements are kept.
//!
//! The search also ends, without a result, when it has taken its share of the steps of the job (`meter`).
//!
//! If greedy growth finds more than [`MOST_ELEMENTS`] elements, there is no search.
//!
//! # Cost
//! Each layer takes up to twice [`PLACES`] searches for a longest element, and samples the deviation of at
//! most twice [`PLACES`] squared elements for step 3.

use super::Error;
use super::fit::{Fitted, Fitter};
use crate::geometry::plane_curve::PlaneCurve;

/// Equal steps behind the farthest place of a layer, and the most corners that are tried there. A layer holds
/// at most three times as many places.
const PLACES: usize = 12;

/// A chain with more elements is left as it is.
const MOST_ELEMENTS: usize = 300;

/// A place that can be reached with as many elements as its layer counts.
#[derive(Clone, Copy)]
struct Reached {
    t: f64,
    /// The index, in the layer before, of the place where the last of these elements starts.
    before: usize,
}

/// Elements over the range of `greedy`; `None` if no fewer are found.
///
/// # Errors
/// When the budget ends.
pub fn fewer(fitter: &Fitter<impl PlaneCurve>, greedy: &[Fitted]) -> Result<Option<Vec<Fitted>>, Error> {
    let (Some(first), Some(last)) = (greedy.first(), greedy.last()) else { return Ok(None) };
    if !(3..=MOST_ELEMENTS).contains(&greedy.len()) {
        return Ok(None);
    }
    let (from, to) = (first.range[0], last.range[1]);
    let end = fitter.meter.end_of_search();
    let mut layers = vec![vec![Reached { t: from, before: 0 }]];
    // A chain that is worth finding has at least one element fewer.
    for k in 0..greedy.len() - 1 {
        if fitter.meter.is_past(end) {
            return Ok(None);
        }
        let layer = &layers[k];
        let guess = greedy[k].range[1] - greedy[k].range[0];
        let mut next = Vec::with_capacity(2 * PLACES);
        for (before, place) in layer.iter().enumerate() {
            match fitter.longest([place.t, to], guess) {
                Ok(longest) => next.push(Reached { t: longest.range[1], before }),
                Err(Error::Stopped(stopped)) => return Err(stopped.into()),
                Err(_) => {}
            }
        }
        let Some(farthest) = next.iter().copied().max_by(|a, b| a.t.total_cmp(&b.t)) else { return Ok(None) };
        if farthest.t >= to {
            layers.push(vec![farthest]);
            return Ok(proved(fitter, &layers));
        }
        let start = layer.iter().map(|place| place.t).fold(from, f64::max);
        let even = (1..PLACES).map(|j| farthest.t - (farthest.t - start) * (j as f64 / PLACES as f64));
        for t in even.chain(fitter.corners([start, farthest.t]).take(PLACES)) {
            let fits = |place: &Reached| place.t < t && fitter.strain([place.t, t]) <= 1.0;
            if let Some(before) = layer.iter().position(fits) {
                next.push(Reached { t, before });
            }
        }
        next.retain(|place| place.t > start);
        next.sort_by(|a, b| b.t.total_cmp(&a.t));
        next.dedup_by(|a, b| a.t == b.t);
        next.truncate(3 * PLACES);
        layers.push(next);
    }
    Ok(None)
}

/// The elements that lead to the first place of the last layer; `None` if one of them is not proved.
fn proved(fitter: &Fitter<impl PlaneCurve>, layers: &[Vec<Reached>]) -> Option<Vec<Fitted>> {
    let mut joints = Vec::with_capacity(layers.len());
    let mut index = 0;
    for layer in layers.iter().rev() {
        let place = layer.get(index)?;
        joints.push(place.t);
        index = place.before;
    }
    joints.reverse();
    joints.windows(2).map(|pair| fitter.fit([pair[0], pair[1]])).collect()
}

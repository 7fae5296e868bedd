//! Fewer elements than greedy growth finds, by keeping several places that as many elements reach.
//!
//! # Method
//! Of all places that k elements reach, a layer keeps the farthest and some behind it. From each the longest
//! element is found; where these end, and at equal steps behind the farthest of them as far as some element
//! of the layer before fits, is the next layer. Where an element from a nearer place reaches farther, as it
//! may about an inflection, it is not lost.
//!
//! # Cost
//! Some [`PLACES`] longest elements, and the square of it in strains, for each element.

use super::Error;
use super::fit::{Fitted, Fitter};
use crate::budget::Budget;
use crate::geometry::plane_curve::PlaneCurve;

/// Places of a layer.
const PLACES: usize = 12;

/// More elements are left as they are.
const MOST_ELEMENTS: usize = 300;

/// A place that as many elements reach as its layer counts.
#[derive(Clone, Copy)]
struct Place {
    t: f64,
    /// The place in the layer before where the last of them starts.
    before: usize,
}

/// Elements over the range of `greedy`, where there are fewer.
///
/// # Errors
/// When the budget ends.
pub fn fewer(
    fitter: &Fitter<impl PlaneCurve>,
    greedy: &[Fitted],
    budget: &Budget,
) -> Result<Option<Vec<Fitted>>, Error> {
    let (Some(first), Some(last)) = (greedy.first(), greedy.last()) else { return Ok(None) };
    if !(3..=MOST_ELEMENTS).contains(&greedy.len()) {
        return Ok(None);
    }
    let (from, to) = (first.range[0], last.range[1]);
    let mut layers = vec![vec![Place { t: from, before: 0 }]];
    // One element fewer at most: the last layer but one must reach the end.
    for k in 0..greedy.len() - 1 {
        budget.check()?;
        let layer = &layers[k];
        let guess = greedy[k].range[1] - greedy[k].range[0];
        let mut next = Vec::with_capacity(2 * PLACES);
        for (before, place) in layer.iter().enumerate() {
            if let Ok(longest) = fitter.longest([place.t, to], guess) {
                next.push(Place { t: longest.range[1], before });
            }
        }
        let Some(farthest) = next.iter().copied().max_by(|a, b| a.t.total_cmp(&b.t)) else { return Ok(None) };
        if farthest.t >= to {
            layers.push(vec![farthest]);
            return Ok(proved(fitter, &layers));
        }
        let start = layer.iter().map(|place| place.t).fold(from, f64::max);
        for j in 1..PLACES {
            let t = farthest.t - (farthest.t - start) * (j as f64 / PLACES as f64);
            let fits = |place: &Place| place.t < t && fitter.strain([place.t, t]) <= 1.0;
            if let Some(before) = layer.iter().position(fits) {
                next.push(Place { t, before });
            }
        }
        next.retain(|place| place.t > start);
        next.sort_by(|a, b| b.t.total_cmp(&a.t));
        next.dedup_by(|a, b| a.t == b.t);
        next.truncate(2 * PLACES);
        layers.push(next);
    }
    Ok(None)
}

/// The elements of the way to the first place of the last layer, if each is proved.
fn proved(fitter: &Fitter<impl PlaneCurve>, layers: &[Vec<Place>]) -> Option<Vec<Fitted>> {
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

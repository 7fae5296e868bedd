//! Finds the nodes at which elements meet. Up to [`WINDOW`] points are searched at once. More points are
//! searched window by window: the elements that end in the first three quarters of a window are kept, and the
//! next window begins where they end.

use nalgebra::Vector2;

use super::candidate::{PointRange, Points, Witnesses};
use super::optimal::{Node, OnPoints};
use super::{Fit, Joints, Method, NotProved, WINDOW, free_joints, greedy, looks, optimal};
use crate::budget::{Budget, Stopped};

/// The nodes at which elements meet, and why fewer elements are not excluded.
pub fn nodes(
    points: Points,
    request: &Fit,
    budget: &Budget,
) -> Result<(Vec<Node>, Option<NotProved>), Stopped> {
    let flat = points.flat;
    let mut nodes: Vec<Node> = Vec::new();
    let mut not_proved = (flat.len() > WINDOW).then_some(NotProved::Windows);
    while nodes.last().is_none_or(|node| node.index + 1 < flat.len()) {
        let begin = nodes.last().map_or(0, |node| node.index);
        let end = flat.len().min(begin + WINDOW);
        let window = Points {
            flat: &flat[begin..end],
            heights: if points.heights.is_empty() { &[] } else { &points.heights[begin..end] },
        };
        let start = nodes.last().map(|node| node.at);
        let (mut found, is_proved) = in_window(window, start, flat.len(), request, budget)?;
        not_proved = not_proved.or((!is_proved).then_some(NotProved::SearchEnded));
        if end < flat.len() {
            let standing = found.iter().rposition(|node| node.index <= WINDOW / 4 * 3).unwrap_or(0).max(1);
            found.truncate(standing + 1);
        }
        let fresh = usize::from(!nodes.is_empty());
        let mut found = found[fresh..].iter().map(|node| Node { index: begin + node.index, ..*node });
        // The last element kept from the window before ended at the border; it may reach on to the first node
        // of this window.
        if let [.., before, _] = nodes[..]
            && let Some(next) = found.next()
        {
            let span =
                PointRange { points, first: before.index, last: next.index, from: before.at, to: next.at };
            if span.find(&request.rule(), &mut Witnesses::default()).is_some() {
                nodes.pop();
            }
            nodes.push(next);
        }
        nodes.extend(found);
    }
    Ok((nodes, not_proved.filter(|_| request.method == Method::Optimal)))
}

/// The nodes at which the elements of one window meet, from its first point or from `start` near it, and
/// whether no chain with joints on points has fewer. All windows together have `n_points` points.
fn in_window(
    points: Points,
    start: Option<Vector2<f64>>,
    n_points: usize,
    request: &Fit,
    budget: &Budget,
) -> Result<(Vec<Node>, bool), Stopped> {
    let (flat, rule) = (points.flat, request.rule());
    let on =
        |index: usize| Node { index, at: if index == 0 { start.unwrap_or(flat[0]) } else { flat[index] } };
    let one_by_one = if request.method == Method::Greedy { greedy::ONE_BY_ONE } else { greedy::FAST };
    let grown = greedy::joints(points, on(0).at, &rule, one_by_one, budget)?;
    let greedy: Vec<Node> = grown.into_iter().map(on).collect();
    let is_one = greedy.len() == 2;
    if request.method == Method::Greedy || request.effort == 0 || is_one {
        return Ok((greedy, is_one));
    }
    let most = looks(points, n_points, request);
    let found = optimal::fewest_on_points(points, &greedy, &rule, most, budget)?;
    let OnPoints { fewer, is_proved } = found;
    let is_noisy = fewer.is_some();
    let chain = fewer.unwrap_or(greedy);
    if request.joints == Joints::OnPoints || !points.heights.is_empty() {
        return Ok((chain, is_proved));
    }
    let is_whole = points.flat.len() == n_points;
    let known = free_joints::Known { points, chain, start, is_whole, is_noisy };
    let chain = free_joints::fewest_free(known, request, &rule, most, budget)?;
    Ok((chain, is_proved))
}

//! The choice of a pattern on a level.

use std::sync::Arc;

use super::PocketError;
use super::candidate::Route;
use super::conditions::Conditions;
use super::entry_place;
use super::job::{Job, Pattern};
use super::level::Shape;
use super::report::Candidate;
use crate::budget::Budget;
use crate::toolpath::path::PathError;

/// The routes of one pattern, or why it has none.
pub type Found = (Pattern, Result<Vec<Arc<Route>>, PocketError>);

/// The pattern of a level with its route; none where the tool fits nowhere.
pub type Chosen = Option<(Pattern, Arc<Route>)>;

/// The rank of a valid route; the least wins. First come routes that come down at the place that the job asks
/// for. Where the cutter can come in over open edges, those with the fewest entries into material come next.
/// Then the figure decides by which the job chooses.
type Rank = (bool, usize, f64);

/// The candidates of a level, and the pattern with the least rank among the valid ones.
pub fn choose(
    job: &Job,
    shape: &Shape,
    found: &[Found],
    conditions: &Conditions,
    budget: &Budget,
) -> Result<(Vec<Candidate>, Chosen), PocketError> {
    let mut candidates = Vec::new();
    let mut best: Option<(Rank, Pattern, &Arc<Route>)> = None;
    let n_entries = |route: &Route| if shape.is_open() { route.n_entries() } else { 0 };
    let is_elsewhere = |route: &Route| !entry_place::is_kept(&job.entry, &route.runs);
    let mut failure = None;
    for (pattern, routes) in found {
        let routes = match routes {
            Ok(routes) => routes,
            Err(error) => {
                candidates.push(Candidate::failed(*pattern, error.to_string()));
                failure.get_or_insert_with(|| error.clone());
                continue;
            }
        };
        let mut first: Option<(Rank, Candidate, &Arc<Route>)> = None;
        let mut too_long = None;
        for route in routes {
            budget.check()?;
            let candidate = match Candidate::new(*pattern, route, conditions, job.move_limit) {
                Err(error @ PocketError::Path(PathError::TooManyMoves { .. })) => {
                    too_long = Some(error);
                    continue;
                }
                candidate => candidate?,
            };
            let rank = (is_elsewhere(route), n_entries(route), candidate.figure(job.choose_by));
            let is_better = |(least, other, _): &(Rank, Candidate, &Arc<Route>)| {
                (!candidate.valid, rank) < (!other.valid, *least)
            };
            if first.as_ref().is_none_or(is_better) {
                first = Some((rank, candidate, route));
            }
        }
        if let (None, Some(error)) = (&first, too_long) {
            candidates.push(Candidate::failed(*pattern, error.to_string()));
            failure.get_or_insert(error);
        }
        let Some((rank, candidate, route)) = first else { continue };
        if candidate.valid && best.is_none_or(|(least, ..)| rank < least) {
            best = Some((rank, *pattern, route));
        }
        candidates.push(candidate);
    }
    if let Some((_, pattern, route)) = best {
        return Ok((candidates, Some((pattern, Arc::clone(route)))));
    }
    let because = candidates.iter().find_map(|candidate| candidate.invalid_because.clone());
    let invalid = because.map(|because| PocketError::NoneValid { because });
    // Where the tool fits nowhere there are no routes at all.
    failure.or(invalid).map_or(Ok((candidates, None)), Err)
}

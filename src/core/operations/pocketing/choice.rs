//! The choice of a pattern on a level.

use super::PocketError;
use super::candidate::Route;
use super::conditions::Conditions;
use super::entry_place;
use super::job::{Job, Pattern};
use super::report::Candidate;
use crate::budget::Budget;
use crate::toolpath::path::PathError;

/// The routes of one pattern, or why it has none.
pub type Found = (Pattern, Result<Vec<Route>, PocketError>);

/// The pattern of a level with its route; none where the tool fits nowhere.
pub type Chosen<'a> = Option<(Pattern, &'a Route)>;

/// The candidates of a level, and the pattern with the least figure among the valid ones. Patterns that come
/// down at the place that the job asks for win over others.
pub fn choose<'a>(
    job: &Job,
    found: &'a [Found],
    conditions: &Conditions,
    budget: &Budget,
) -> Result<(Vec<Candidate>, Chosen<'a>), PocketError> {
    let mut candidates = Vec::new();
    let mut best: Option<(f64, Pattern, &Route)> = None;
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
        let mut fastest: Option<(f64, Candidate, &Route)> = None;
        let is_kept = |route: &Route| entry_place::is_kept(&job.entry, &route.runs);
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
            let figure = candidate.figure(job.choose_by);
            let is_better = |(least, other, before): &(f64, Candidate, &Route)| {
                (candidate.valid, is_kept(route), -figure) > (other.valid, is_kept(before), -*least)
            };
            if fastest.as_ref().is_none_or(is_better) {
                fastest = Some((figure, candidate, route));
            }
        }
        if let (None, Some(error)) = (&fastest, too_long) {
            candidates.push(Candidate::failed(*pattern, error.to_string()));
            failure.get_or_insert(error);
        }
        let Some((figure, candidate, route)) = fastest else { continue };
        let is_better = |(least, _, before): (f64, Pattern, &Route)| {
            (is_kept(route), -figure) > (is_kept(before), -least)
        };
        if candidate.valid && best.is_none_or(is_better) {
            best = Some((figure, *pattern, route));
        }
        candidates.push(candidate);
    }
    if let Some((_, pattern, route)) = best {
        return Ok((candidates, Some((pattern, route))));
    }
    let because = candidates.iter().find_map(|candidate| candidate.invalid_because.clone());
    let invalid = because.map(|because| PocketError::NoneValid { because });
    // Where the tool fits nowhere there are no routes at all.
    failure.or(invalid).map_or(Ok((candidates, None)), Err)
}

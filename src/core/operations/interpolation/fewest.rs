//! Divides a range of a curve into as few elements as the methods find, with joints on the curve.
//!
//! # Method
//! 1. Greedy growth makes each element as long as possible (`least`). A beam search then looks for fewer
//!    elements (`beam_search`).
//! 2. Bisection is tried too, and ends as soon as it has as many elements. It may win where the best joints
//!    are corners of the curve in the middle of a range.
//! 3. Joints are moved to corners, and arcs that hardly bend become lines, where the number of elements stays
//!    the same (`corners`, `straight`).
//!
//! # Guarantees
//! There are never more elements than bisection makes, and no curve is refused that bisection divides, unless
//! the steps of the search have ended (`meter`).

use super::fit::{Fitted, Fitter};
use super::{Error, beam_search, bisection, corners, least, straight};
use crate::budget::Budget;
use crate::geometry::plane_curve::PlaneCurve;

/// The elements of a range.
pub struct Fewest {
    pub elements: Vec<Fitted>,
    /// The elements that each end as far on as possible, which guide the lower bounds.
    pub longest: Vec<Fitted>,
}

/// The fewest elements over `range` that are found.
///
/// # Errors
/// When the budget ends, there are too many elements or steps, or no element stays within the band however
/// short.
pub fn fewest(fitter: &Fitter<impl PlaneCurve>, range: [f64; 2], budget: &Budget) -> Result<Fewest, Error> {
    let longest = match least::fewest(fitter, range, budget) {
        Ok(longest) => longest,
        Err(Error::Stopped(stopped)) => return Err(stopped.into()),
        Err(refused) => bisected(fitter, range, budget)?.ok_or(refused)?,
    };
    let mut elements = beam_search::fewer(fitter, &longest)?.unwrap_or_else(|| longest.clone());
    if elements.len() > 1 && fitter.meter.has_steps_for_search() {
        let fewer = Fitter { element_limit: elements.len() - 1, ..*fitter };
        if let Some(fewer) = bisected(&fewer, range, budget)? {
            elements = fewer;
        }
    }
    corners::keep_corners(fitter, &mut elements, budget)?;
    straight::straighten(fitter, &mut elements, budget)?;
    Ok(Fewest { elements, longest })
}

/// The elements of a bisection; `None` if bisection is refused, or has too many elements.
fn bisected(
    fitter: &Fitter<impl PlaneCurve>,
    range: [f64; 2],
    budget: &Budget,
) -> Result<Option<Vec<Fitted>>, Error> {
    match bisection::bisect(fitter, range, budget) {
        Ok(elements) => Ok(Some(elements)),
        Err(Error::Stopped(stopped)) => Err(stopped.into()),
        Err(_) => Ok(None),
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::super::{Job, Joints, Method, Source, Subdivision, plan};
    use crate::budget::Budget;
    use crate::geometry::deviation::{Band, Measure};

    const METHODS: [Method; 4] = [Method::Linear, Method::Parabolic, Method::Mixed, Method::Arc];

    /// The number of elements; `None` if the curve is refused.
    fn count(
        expression: &str,
        domain: [f64; 2],
        method: Method,
        subdivision: Subdivision,
        band: Band,
    ) -> Option<usize> {
        let source = Source::Graph { expression: expression.to_owned(), domain };
        let job = Job { element_limit: 3_000, ..Job::new(source, method, subdivision, band) };
        plan(&job, &Budget::unlimited()).ok().map(|plan| plan.report.n_elements)
    }

    fn least(expression: &str, domain: [f64; 2], method: Method, band: Band) -> Option<usize> {
        count(expression, domain, method, Subdivision::Least(Joints::OnCurve), band)
    }

    fn below(below_mm: f64) -> Band {
        Band { below_mm, above_mm: 0.0, measure: Measure::Normal }
    }

    #[test]
    fn a_kink_to_the_side_without_room_gets_a_joint() {
        for method in METHODS {
            assert_eq!(least("abs(x-1)", [0.0, 2.0], method, below(0.01)), Some(2), "{method:?}");
            assert_eq!(least("abs(x-sqrt(2))", [0.0, 2.0], method, below(0.01)), Some(2), "{method:?}");
        }
        let both = Band { below_mm: 0.01, above_mm: 0.01, measure: Measure::Normal };
        for band in [both, below(0.01)] {
            assert_eq!(least("max(x,1)", [0.0, 2.0], Method::Parabolic, band), Some(2));
        }
    }

    /// A term of an expression. Half of the kinks lie where bisection places joints.
    fn term() -> impl Strategy<Value = String> {
        let place = prop_oneof![(1..16u8).prop_map(|k| f64::from(k) / 8.0), 0.1..1.9f64];
        let factor = prop_oneof![-2.0..2.0f64, Just(1.0), Just(-1.0)];
        (factor, place, 0..7u8).prop_map(|(a, c, kind)| match kind {
            0 => format!("({a})*abs(x-{c})"),
            1 => format!("({a})*max(x,{c})"),
            2 => format!("({a})*min(x^2,{c})"),
            3 => format!("({a})*sin(3*x+{c})"),
            4 => format!("({a})*(x-{c})^3"),
            5 => format!("({a})*sqrt(x+{c})"),
            _ => format!("({a})*x"),
        })
    }

    proptest! {
        #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(ProptestConfig::default().cases / 4) })]

        #[test]
        fn there_are_never_more_elements_than_bisection_makes(
            terms in prop::collection::vec(term(), 1..4), method in prop::sample::select(METHODS.to_vec()),
            below in prop_oneof![Just(0.0), 1e-3..5e-2f64], above in prop_oneof![Just(0.0), 1e-3..5e-2f64],
            is_vertical: bool,
        ) {
            let measure = if is_vertical { Measure::Vertical } else { Measure::Normal };
            let band = Band { below_mm: below, above_mm: if below + above == 0.0 { 0.01 } else { above }, measure };
            let expression = terms.join("+");
            let domain = [0.0, 2.0];
            if let Some(halved) = count(&expression, domain, method, Subdivision::Bisection, band) {
                let found = least(&expression, domain, method, band);
                prop_assert!(found.is_some_and(|found| found <= halved), "{expression} {found:?} {halved}");
            }
        }
    }
}

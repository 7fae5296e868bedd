//! Tests of pockets. They judge toolpaths by a checker of their own, which knows nothing of the planner: it
//! computes with outlines, discs and a grid of points.

mod area;
mod cases;
mod clearance;
mod corruption;
mod engagement;
mod entry;
mod grid;
mod hard;
mod heights;
mod invariance;
mod levels;
mod motion;
mod open;
mod plane;
mod regions;
mod relief;
mod rest;
mod samples;
mod service;
mod sweep;

use toolpathd_core::budget::Budget;
use toolpathd_core::operations::pocketing::plan;

use area::Area;
use cases::{Case, PATTERNS, SLOT_FEED, job};
use sweep::judge;

/// Plans a case with each pattern alone, and judges all plans.
fn every_pattern_clears(case: &Case) {
    let area = Area::new(case);
    let mut wrong = Vec::new();
    for pattern in PATTERNS {
        let job = job(case, &[pattern], Some(SLOT_FEED));
        match plan(&job, &Budget::unlimited()) {
            Ok(plan) => {
                let verdict = judge(case, &area, &job, &plan);
                if !verdict.faults.is_empty() {
                    wrong.push(format!("{pattern:?}: {:#?}", verdict.faults));
                }
            }
            Err(error) => wrong.push(format!("{pattern:?}: {error}")),
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn every_pattern_clears_a_rectangle() {
    every_pattern_clears(&cases::rectangle());
}

#[test]
fn every_pattern_clears_an_ell() {
    every_pattern_clears(&cases::ell());
}

#[test]
fn every_pattern_clears_a_circle_of_two_arcs() {
    every_pattern_clears(&cases::circle());
}

#[test]
fn every_pattern_clears_around_a_central_island() {
    every_pattern_clears(&cases::central_island());
}

#[test]
fn every_pattern_clears_around_an_island_in_a_corner() {
    every_pattern_clears(&cases::corner_island());
}

#[test]
fn every_pattern_clears_around_islands_with_gaps_narrower_than_the_tool() {
    every_pattern_clears(&cases::three_islands());
}

#[test]
fn every_pattern_clears_around_islands_that_overlap_walls_and_each_other() {
    every_pattern_clears(&cases::islands_on_walls());
}

#[test]
fn every_pattern_clears_a_comb() {
    every_pattern_clears(&cases::comb());
}

#[test]
fn every_pattern_clears_a_noisy_outline() {
    every_pattern_clears(&cases::noisy());
}

#[test]
fn every_pattern_clears_around_a_hundred_islands() {
    every_pattern_clears(&cases::hundred_islands());
}

#[test]
fn every_pattern_clears_both_ends_of_a_dumbbell_with_a_narrow_neck() {
    every_pattern_clears(&cases::dumbbell(8.0));
}

#[test]
fn every_pattern_clears_a_dumbbell_with_a_neck_just_wider_than_the_tool() {
    every_pattern_clears(&cases::dumbbell(10.2));
}

#[test]
fn every_pattern_clears_an_outline_of_arcs() {
    every_pattern_clears(&cases::arcs());
}

#[test]
fn every_pattern_clears_fillets_just_above_the_radius_of_the_tool() {
    every_pattern_clears(&cases::filleted(5.01));
}

#[test]
fn every_pattern_clears_fillets_just_below_the_radius_of_the_tool() {
    every_pattern_clears(&cases::filleted(4.99));
}

#[test]
fn every_pattern_clears_three_levels_of_which_the_last_is_thinner() {
    every_pattern_clears(&cases::three_levels());
}

#[test]
fn every_pattern_clears_with_a_stepover_of_four_fifths_of_the_diameter() {
    for case in [cases::ell(), cases::three_islands(), cases::islands_on_walls(), cases::filleted(4.99)] {
        every_pattern_clears(&case.with_stepover(0.8));
    }
}

#[test]
fn every_pattern_clears_with_a_stepover_of_the_whole_diameter() {
    for case in [cases::central_island(), cases::three_islands(), cases::comb(), cases::arcs()] {
        every_pattern_clears(&case.with_stepover(1.0));
    }
}

//! The checker has to find what is wrong: toolpaths and reports are spoiled in one way each.

use nalgebra::Vector3;
use toolpathd_core::budget::Budget;
use toolpathd_core::geometry::curve::{Curve, Line};
use toolpathd_core::operations::pocketing::{Job, Pattern, Plan, plan};
use toolpathd_core::toolpath::path::Builder;
use toolpathd_core::toolpath::units::FeedRate;
use toolpathd_core::toolpath::{Move, Role, Toolpath};

use super::area::Area;
use super::cases::{self, Case, FEED, SLOT_FEED, job};
use super::sweep::{Fault, Verdict, judge};

fn planned(case: &Case, pattern: Pattern) -> (Job, Plan) {
    let job = job(case, &[pattern], Some(SLOT_FEED));
    let plan = plan(&job, &Budget::unlimited()).unwrap();
    (job, plan)
}

/// Adds a move from where the builder is.
fn push(builder: &mut Builder, step: &Move) {
    match *step {
        Move::Rapid { line } => builder.rapid(line.end),
        Move::Feed { along, rate, role } => builder.follow(along, rate, role),
        Move::Turn { .. } => panic!("pockets lean no tool"),
        Move::Dwell { seconds } => builder.dwell(seconds),
    }
    .unwrap();
}

/// The plan with other moves: `change` gets the number of the pass and the move, and returns the moves that
/// stand for it.
fn changed(plan: &Plan, change: impl Fn(usize, &Move) -> Vec<Move>) -> Plan {
    let mut builder = Toolpath::builder(plan.toolpath.start());
    for (k, pass) in plan.toolpath.passes().iter().enumerate() {
        builder.begin_pass(pass.level());
        for step in pass.moves() {
            for other in change(k, step) {
                push(&mut builder, &other);
            }
        }
    }
    Plan { toolpath: builder.finish().unwrap(), ..plan.clone() }
}

/// The plan with the feed and the role of its feed moves changed.
fn relabelled(plan: &Plan, change: impl Fn(&Curve, f64, Role) -> (f64, Role)) -> Plan {
    changed(plan, |_, step| match step {
        Move::Feed { along, rate: Some(rate), role } => {
            let (feed, role) = change(along, rate.mm_per_min(), *role);
            vec![Move::Feed { along: *along, rate: FeedRate::from_mm_per_min(feed), role }]
        }
        other => vec![*other],
    })
}

fn shifted(plan: &Plan, by: Vector3<f64>) -> Plan {
    let line = |line: &Line| Line { start: line.start + by, end: line.end + by };
    let curve = |curve: &Curve| match curve {
        Curve::Line(own) => Curve::Line(line(own)),
        Curve::Arc(arc) => Curve::Arc(arc.translated(&by)),
        Curve::Parabola(_) => panic!("pockets have no parabolas"),
    };
    let mut builder = Toolpath::builder(plan.toolpath.start() + by);
    for pass in plan.toolpath.passes() {
        builder.begin_pass(pass.level());
        for step in pass.moves() {
            let other = match step {
                Move::Rapid { line: own } => Move::Rapid { line: line(own) },
                Move::Feed { along, rate, role } => {
                    Move::Feed { along: curve(along), rate: *rate, role: *role }
                }
                Move::Turn { .. } | Move::Dwell { .. } => *step,
            };
            push(&mut builder, &other);
        }
    }
    Plan { toolpath: builder.finish().unwrap(), ..plan.clone() }
}

/// Asserts that the plan as it is has no fault.
fn judged(case: &Case, job: &Job, plan: &Plan, spoiled: &Plan) -> Verdict {
    let area = Area::new(case);
    assert_sound(case, &area, job, plan);
    judge(case, &area, job, spoiled)
}

fn assert_sound(case: &Case, area: &Area, job: &Job, plan: &Plan) {
    let verdict = judge(case, area, job, plan);
    assert!(verdict.faults.is_empty(), "{verdict:?}");
}

#[test]
fn a_path_shifted_by_a_hundredth_of_a_millimetre_gouges() {
    for case in [cases::rectangle(), cases::circle(), cases::central_island()] {
        let (job, plan) = planned(&case, Pattern::IslandStockOffset);
        let area = Area::new(&case);
        assert_sound(&case, &area, &job, &plan);
        for by in [Vector3::x(), -Vector3::y()] {
            let verdict = judge(&case, &area, &job, &shifted(&plan, by * 0.01));
            assert!(verdict.has(Fault::Gouge), "{verdict:?}");
            assert!((verdict.gouge_mm - 0.01).abs() < 1e-4, "{verdict:?}");
        }
    }
}

#[test]
fn a_path_without_one_of_its_passes_leaves_material() {
    let case = cases::dumbbell(8.0);
    let (job, plan) = planned(&case, Pattern::IslandStockOffset);
    assert!(plan.toolpath.passes().len() >= 2, "both ends of the dumbbell were cut in one pass");
    let spoiled = changed(&plan, |pass, step| if pass == 0 { vec![] } else { vec![*step] });
    let verdict = judged(&case, &job, &plan, &spoiled);
    assert!(verdict.has(Fault::Uncut) && verdict.uncut_part > 0.1, "{verdict:?}");
}

#[test]
fn a_path_without_the_end_of_its_pass_along_the_wall_leaves_material() {
    let case = cases::rectangle();
    // Its rows keep away from the walls, and the pass along the walls is the last.
    let (job, plan) = planned(&case, Pattern::ZigzagStockOffset);
    let cuts: Vec<Move> = plan
        .toolpath
        .moves()
        .filter(|step| matches!(step, Move::Feed { role: Role::Cut | Role::LeadOut, .. }))
        .copied()
        .collect();
    // The end of the pass goes over its start again, and so does the way out.
    let ends = &cuts[cuts.len() - 8..];
    let spoiled = changed(&plan, |_, step| if ends.contains(step) { vec![] } else { vec![*step] });
    let verdict = judged(&case, &job, &plan, &spoiled);
    assert!(verdict.has(Fault::Uncut), "{verdict:?}");
}

#[test]
fn a_cut_that_is_called_a_link_runs_through_stock() {
    for case in [cases::rectangle(), cases::three_levels()] {
        let (job, plan) = planned(&case, Pattern::IslandStockOffset);
        let longest = plan.toolpath.moves().filter_map(|step| match step {
            Move::Feed { along, role: Role::Cut, .. } => Some(along.length()),
            _ => None,
        });
        let longest = longest.fold(0.0, f64::max);
        let spoiled = relabelled(&plan, |along, feed, role| {
            (feed, if along.length() == longest { Role::Link } else { role })
        });
        let verdict = judged(&case, &job, &plan, &spoiled);
        assert!(verdict.has(Fault::ThroughStock), "{verdict:?}");
    }
}

#[test]
fn a_slot_that_is_cut_at_the_full_feed_is_too_fast() {
    for pattern in [Pattern::ZigzagOffset, Pattern::IslandStockOffset] {
        let case = cases::rectangle();
        let (job, plan) = planned(&case, pattern);
        let spoiled = relabelled(&plan, |_, feed, role| (if role == Role::Cut { FEED } else { feed }, role));
        let verdict = judged(&case, &job, &plan, &spoiled);
        assert!(verdict.has(Fault::SlotFeed) && verdict.has(Fault::Time), "{verdict:?}");
    }
}

#[test]
fn a_level_that_is_left_out_makes_the_next_too_deep() {
    let case = cases::three_levels();
    let (job, plan) = planned(&case, Pattern::IslandStockOffset);
    let levels: Vec<_> = plan.toolpath.passes().iter().map(|pass| pass.level()).collect();
    let spoiled = changed(&plan, |pass, step| if levels[pass] == Some(1) { vec![] } else { vec![*step] });
    let verdict = judged(&case, &job, &plan, &spoiled);
    assert!(verdict.has(Fault::TooDeep), "{verdict:?}");
    assert!((verdict.faults[&Fault::TooDeep].0 - 2.0 * 13.0 / 3.0).abs() < 0.1, "{verdict:?}");
}

#[test]
fn a_rapid_below_the_retract_plane_is_found() {
    let case = cases::dumbbell(8.0);
    let (job, plan) = planned(&case, Pattern::IslandStockOffset);
    let retract = plan.cutting.retract_z_mm;
    // Rapids from one end of the dumbbell to the other run just above the stock.
    let spoiled = changed(&plan, |_, step| match step {
        Move::Rapid { line } if line.end.z == retract && (line.end - line.start).xy().norm() > 1.0 => {
            let low = |mut line: Line| {
                line.end.z = 0.1;
                Move::Rapid { line }
            };
            let down = Line { start: line.start, end: line.start };
            vec![low(down), low(*line), *step]
        }
        other => vec![*other],
    });
    let verdict = judged(&case, &job, &plan, &spoiled);
    assert!(verdict.has(Fault::Rapid), "{verdict:?}");
}

#[test]
fn a_helix_that_is_too_fast_is_found() {
    let case = cases::rectangle();
    let (job, plan) = planned(&case, Pattern::IslandStockOffset);
    assert!(plan.toolpath.moves().any(|step| matches!(step, Move::Feed { role: Role::Ramp, .. })));
    let spoiled =
        relabelled(&plan, |_, feed, role| (if role == Role::Ramp { 20.0 * FEED } else { feed }, role));
    let verdict = judged(&case, &job, &plan, &spoiled);
    assert!(verdict.has(Fault::Entry), "{verdict:?}");
}

#[test]
fn reports_that_promise_too_much_are_found() {
    let case = cases::three_islands();
    let (job, plan) = planned(&case, Pattern::IslandStockOffset);
    let mut spoiled = plan.clone();
    spoiled.report.total_time_s *= 1.0 - 1e-5;
    let level = &mut spoiled.report.levels[0];
    level.not_reached_area_mm2 -= 2.5;
    level.candidates[0].engagement_max_deg -= 5.0;
    let verdict = judged(&case, &job, &plan, &spoiled);
    let found: Vec<_> = verdict.faults.keys().copied().collect();
    assert_eq!(found, [Fault::EngagementReport, Fault::NotReachedReport, Fault::Time]);
}

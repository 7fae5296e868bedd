//! Plans of the same pocket in other positions, and times beside a nominal time.

use std::sync::OnceLock;

use toolpathd_core::budget::Budget;
use toolpathd_core::operations::pocketing::{ChooseBy, Job, Pattern, Plan, plan};

use super::area::Area;
use super::cases::{self, Case, FEED, PATTERNS, SLOT_FEED, job};
use super::plane::Vertex;
use super::sweep::judge;

/// The largest part by which the time may change.
const TIME_PART: f64 = 0.01;

/// The most that the chosen pattern may take where slots are cut at the full feed, as a multiple of the
/// nominal time.
const MOST_TIME: f64 = 1.25;

/// Plans with all patterns and without a slot feed, and asserts that the plan is sound.
fn sound(case: &Case, area: &Area) -> Plan {
    sound_by(case, area, ChooseBy::default())
}

fn sound_by(case: &Case, area: &Area, choose_by: ChooseBy) -> Plan {
    let job = Job { choose_by, ..job(case, &PATTERNS, None) };
    let plan = plan(&job, &Budget::unlimited()).unwrap();
    let verdict = judge(case, area, &job, &plan);
    assert!(verdict.faults.is_empty(), "{verdict:#?}");
    plan
}

/// The time of the chosen pattern on the first level, s.
fn chosen_time(plan: &Plan) -> f64 {
    let level = &plan.report.levels[0];
    let chosen = level.candidates.iter().find(|candidate| Some(candidate.pattern) == level.chosen);
    chosen.and_then(|candidate| candidate.time_s).unwrap()
}

/// The same outline with each vertex moved. Bulges change their sign where the image is mirrored.
fn moved(outline: &[Vertex], image: impl Fn(f64, f64) -> [f64; 2], sign: f64) -> Vec<Vertex> {
    let vertex = |v: &Vertex| {
        let [x, y] = image(v[0], v[1]);
        [x, y, sign * v[2]]
    };
    outline.iter().map(vertex).collect()
}

fn reversed(outline: &[Vertex]) -> Vec<Vertex> {
    let n = outline.len();
    // The piece that leaves a vertex is the one that led to it.
    let vertex = |k: usize| [outline[k][0], outline[k][1], -outline[(k + n - 1) % n][2]];
    (0..n).rev().map(vertex).collect()
}

fn begun_later(outline: &[Vertex]) -> Vec<Vertex> {
    let mut outline = outline.to_vec();
    outline.rotate_left(1);
    outline
}

fn with_each(case: &Case, change: &impl Fn(&[Vertex]) -> Vec<Vertex>) -> Case {
    let islands = case.islands.iter().map(|island| change(island)).collect();
    Case { boundary: change(&case.boundary), islands, ..case.clone() }
}

/// The time of the chosen pattern of a pocket that is cleared soundly, and the pattern.
fn time_and_pattern(case: &Case) -> (f64, Pattern) {
    let plan = sound(case, &Area::new(case));
    (chosen_time(&plan), plan.report.levels[0].chosen.unwrap())
}

/// Asserts that the changed pockets are cleared in the same time.
fn takes_the_same_time(change: impl Fn(&[Vertex]) -> Vec<Vertex>) {
    static UNCHANGED: OnceLock<Vec<(f64, Pattern)>> = OnceLock::new();
    let named = [
        ("ell", cases::ell()),
        ("corner island", cases::corner_island()),
        ("islands on walls", cases::islands_on_walls()),
        ("arcs", cases::arcs()),
        ("dumbbell", cases::dumbbell(8.0)),
    ];
    let unchanged = UNCHANGED.get_or_init(|| named.iter().map(|(_, case)| time_and_pattern(case)).collect());
    let mut wrong = Vec::new();
    for ((name, case), before) in named.iter().zip(unchanged) {
        let after = time_and_pattern(&with_each(case, &change));
        if (after.0 - before.0).abs() > TIME_PART * before.0 {
            wrong.push(format!("{name}: {before:?} became {after:?}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn a_mirrored_pocket_takes_the_same_time() {
    takes_the_same_time(|outline| moved(outline, |x, y| [-x, y], -1.0));
}

#[test]
fn a_pocket_turned_by_a_right_angle_takes_the_same_time() {
    takes_the_same_time(|outline| moved(outline, |x, y| [-y, x], 1.0));
}

#[test]
fn a_pocket_whose_outlines_begin_elsewhere_takes_the_same_time() {
    takes_the_same_time(begun_later);
}

#[test]
fn a_pocket_whose_outlines_run_backward_takes_the_same_time() {
    takes_the_same_time(reversed);
}

#[test]
fn the_pattern_that_is_fastest_alone_is_chosen_among_all() {
    for case in [cases::rectangle(), cases::comb(), cases::islands_on_walls(), cases::arcs()] {
        let planned = |patterns: &[Pattern]| {
            plan(&job(&case, patterns, Some(SLOT_FEED)), &Budget::unlimited()).unwrap()
        };
        let alone = PATTERNS.map(|pattern| planned(&[pattern]).report.total_time_s);
        let least = alone.into_iter().fold(f64::INFINITY, f64::min);
        let together = planned(&PATTERNS).report.total_time_s;
        assert!((together - least).abs() < 1e-9 * least, "{together} {alone:?}");
    }
}

/// The nominal length is that of a pass along walls and islands, and of what this pass leaves, cut in
/// strips of the stepover.
#[test]
fn the_pattern_with_the_least_paper_time_takes_little_more_than_the_nominal_time() {
    let mut slow = Vec::new();
    let named = [
        ("rectangle", cases::rectangle()),
        ("ell", cases::ell()),
        ("circle", cases::circle()),
        ("central island", cases::central_island()),
        ("corner island", cases::corner_island()),
    ];
    for (name, case) in named {
        let area = Area::new(&case);
        let plan = sound_by(&case, &area, ChooseBy::PaperTime);
        let cutting = &plan.cutting;
        let length = area.edge_mm + area.inner_mm2 / case.stepover_mm;
        let minutes = length / FEED - case.floor_mm / cutting.plunge_feed.mm_per_min()
            + 14.0 / cutting.rapid_feed.mm_per_min();
        let ratio = chosen_time(&plan) / (60.0 * minutes);
        if ratio > MOST_TIME {
            slow.push((name, ratio));
        }
    }
    assert!(slow.is_empty(), "{slow:?}");
}

/// The lengths and areas of the nominal time, which the checker finds on its grid, are those of closed forms.
#[test]
fn the_nominal_length_agrees_with_closed_forms() {
    let pi = std::f64::consts::PI;
    let known = [
        (cases::rectangle(), 280.0, 3200.0),
        (cases::circle(), 70.0 * pi, 900.0 * pi),
        (cases::central_island(), 420.0 + 10.0 * pi, 4800.0 - 1600.0 - 100.0 * pi),
        (cases::ell(), 90.0 + 30.0 + 55.0 + 2.5 * pi + 55.0 + 30.0 + 90.0, 2900.0 - 25.0 * pi),
    ];
    for (case, edge_mm, inner_mm2) in known {
        let area = Area::new(&case);
        assert!((area.edge_mm - edge_mm).abs() < 0.2, "{} {edge_mm}", area.edge_mm);
        assert!((area.inner_mm2 - inner_mm2).abs() < 0.004 * inner_mm2, "{} {inner_mm2}", area.inner_mm2);
    }
}

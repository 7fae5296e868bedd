//! Tests of what happens beside walls: how far moves that do not cut along them keep away, leads, allowances
//! and finishing.

use std::collections::BTreeMap;

use toolpathd_core::budget::Budget;
use toolpathd_core::operations::pocketing::{
    ChooseBy, Finish, FinishFloor, FinishWalls, Job, Lead, LeadKind, Milling, Only, Pattern, Plan, plan,
};
use toolpathd_core::toolpath::Role;

use super::area::Area;
use super::cases::{self, Case, PATTERNS, SLOT_FEED, job};
use super::motion::{Kind, Motion, motions};
use super::plane::{P, apart};

/// What distances that are computed in two ways may differ by, mm.
const ROUNDING_MM: f64 = 1e-5;

/// How near to the distance of a pass along a wall the centre has to be, mm.
const ON_WALL_MM: f64 = 1e-4;

fn planned(job: &Job) -> Plan {
    plan(job, &Budget::unlimited()).expect("a plan")
}

fn is_cut(motion: &Motion) -> bool {
    matches!(motion.kind, Kind::Feed(Role::Cut | Role::LeadIn | Role::LeadOut)) && motion.is_level()
}

/// The nearest that moves which are no cuts come to walls, beside the radius and the allowance, mm.
fn nearest_beside(area: &Area, job: &Job, motions: &[Motion]) -> f64 {
    let beside = motions.iter().filter(|motion| motion.low() < cases::TOP_MM - 1e-9 && !is_cut(motion));
    let clearance = |motion: &Motion| {
        let points = motion.piece.points(0.001, 0.02);
        points.into_iter().map(|p| area.clearance(p)).fold(f64::INFINITY, f64::min)
    };
    beside.map(clearance).fold(f64::INFINITY, f64::min) - job.tool.radius_mm - job.allowance_mm
}

fn ordinary() -> Vec<Case> {
    vec![
        cases::rectangle(),
        cases::ell(),
        cases::circle(),
        cases::central_island(),
        cases::three_islands(),
        cases::comb(),
        cases::arcs(),
        cases::three_levels(),
    ]
}

#[test]
fn nothing_but_the_pass_along_it_comes_near_a_wall() {
    for case in ordinary() {
        let area = Area::new(&case);
        for pattern in PATTERNS {
            let job = job(&case, &[pattern], Some(SLOT_FEED));
            let plan = planned(&job);
            let found = nearest_beside(&area, &job, &motions(&plan.toolpath));
            let reported = plan.report.clearance_side_mm.expect("a distance");
            assert!(found >= job.side_mm() - ROUNDING_MM, "{pattern:?}: {found} mm in {case:?}");
            assert!(reported <= found + ROUNDING_MM, "{pattern:?}: {reported} reported, {found} found");
        }
    }
}

#[test]
fn a_larger_clearance_is_kept_and_what_does_not_fit_is_told() {
    let case = cases::rectangle();
    let area = Area::new(&case);
    for side_mm in [0.0, 0.5, 2.0, 4.0] {
        let job = Job { clearance_side_mm: Some(side_mm), ..job(&case, &PATTERNS, None) };
        let plan = planned(&job);
        let found = nearest_beside(&area, &job, &motions(&plan.toolpath));
        assert!(found >= side_mm - ROUNDING_MM, "{found} mm for {side_mm}");
    }
    let narrow = cases::pocket(cases::box_at(0.0, 0.0, 60.0, 10.3), vec![]);
    let plan = planned(&job(&narrow, &PATTERNS, None));
    let warnings: Vec<String> = plan.warnings.iter().map(ToString::to_string).collect();
    assert!(warnings.iter().any(|text| text.contains("beside its cuts")), "{warnings:?}");
}

/// The runs of moves along walls, as indices of moves: each is at the distance of the radius and `left_mm`.
fn wall_passes(area: &Area, job: &Job, motions: &[Motion], left_mm: f64) -> Vec<[usize; 2]> {
    let is_along = |motion: &Motion| {
        let on =
            |t: f64| (area.clearance(motion.piece.at(t)) - job.tool.radius_mm - left_mm).abs() < ON_WALL_MM;
        motion.kind == Kind::Feed(Role::Cut) && motion.is_level() && [0.0, 0.3, 0.5, 1.0].into_iter().all(on)
    };
    let mut passes: Vec<[usize; 2]> = Vec::new();
    for k in (0..motions.len()).filter(|k| is_along(&motions[*k])) {
        match passes.last_mut() {
            Some([_, last]) if *last + 1 == k && motions[k].pass == motions[*last].pass => *last = k,
            _ => passes.push([k, k]),
        }
    }
    passes
}

/// The moves before and after a pass along a wall that lead to it and away from it.
fn leads(motions: &[Motion], [first, last]: [usize; 2]) -> [&[Motion]; 2] {
    let is = |motion: &Motion, role| motion.kind == Kind::Feed(role) && motion.is_level();
    let before = motions[..first].iter().rev().take_while(|motion| is(motion, Role::LeadIn)).count();
    let after = motions[last + 1..].iter().take_while(|motion| is(motion, Role::LeadOut)).count();
    [&motions[first - before..first], &motions[last + 1..last + 1 + after]]
}

fn check_leads(area: &Area, job: &Job, motions: &[Motion], overlap_mm: f64) {
    let passes = wall_passes(area, job, motions, 0.0);
    assert!(!passes.is_empty());
    for [first, last] in passes {
        let lead_in = &motions[first - 1];
        let lead_out = &motions[last + 1];
        assert_eq!([lead_in.kind, lead_out.kind], [Kind::Feed(Role::LeadIn), Kind::Feed(Role::LeadOut)]);
        for (before, after) in [(lead_in, &motions[first]), (&motions[last], lead_out)] {
            let turn = before.piece.heading(1.0) - after.piece.heading(0.0);
            assert!(turn.sin().abs() < 1e-6 && turn.cos() > 0.0, "{before:?} {after:?}");
        }
        for parts in leads(motions, [first, last]) {
            let turn: f64 = parts.iter().map(|lead| lead.piece.heading(1.0) - lead.piece.heading(0.0)).sum();
            assert!((turn.abs() - 0.25 * std::f64::consts::TAU).abs() < 1e-6, "{parts:?}");
        }
        let length: f64 = motions[first..=last].iter().map(|motion| motion.piece.length()).sum();
        let (start, end) = (motions[first].piece.at(0.0), motions[last].piece.at(1.0));
        assert!(apart(start, end) <= overlap_mm + 1e-6 && length > overlap_mm, "{start:?} {end:?}");
    }
}

#[test]
fn walls_are_entered_and_left_on_quarter_circles_that_touch_them() {
    for case in ordinary() {
        let area = Area::new(&case);
        for milling in [Milling::Climb, Milling::Conventional] {
            for pattern in [Pattern::IslandStockOffset, Pattern::Engagement, Pattern::ContinuousOffset] {
                let job = Job { milling, ..job(&case, &[pattern], None) };
                let plan = planned(&job);
                check_leads(&area, &job, &motions(&plan.toolpath), 0.1 * case.diameter_mm);
            }
        }
    }
}

#[test]
fn a_pass_along_a_wall_overlaps_its_start_as_far_as_asked_for() {
    let case = cases::circle();
    let area = Area::new(&case);
    let lead = Lead { radius_mm: Some(2.0), overlap_mm: Some(3.0), ..Lead::default() };
    let job = Job { lead, ..job(&case, &[Pattern::IslandStockOffset], None) };
    let motions = motions(&planned(&job).toolpath);
    let passes = wall_passes(&area, &job, &motions, 0.0);
    let [[first, last]] = passes[..] else { panic!("{passes:?}") };
    let length: f64 = motions[first..=last].iter().map(|motion| motion.piece.length()).sum();
    // The wall's radius is 40 mm, and that of the cutter 5 mm.
    assert!((length - 35.0 * std::f64::consts::TAU - 3.0).abs() < 1e-6, "{length}");
    let [parts, _] = leads(&motions, [first, last]);
    let lead: f64 = parts.iter().map(|lead| lead.piece.length()).sum();
    assert!((lead - 2.0 * 0.25 * std::f64::consts::TAU).abs() < 1e-6, "{lead}");
}

#[test]
fn without_leads_the_cutter_comes_down_on_the_pass_and_lines_stand_upright_on_it() {
    let case = cases::rectangle();
    let area = Area::new(&case);
    for (kind, cosine) in [(LeadKind::None, None), (LeadKind::Line, Some(0.0))] {
        let lead = Lead { kind, ..Lead::default() };
        let job = Job { lead, ..job(&case, &[Pattern::IslandStockOffset], None) };
        let motions = motions(&planned(&job).toolpath);
        for [first, _] in wall_passes(&area, &job, &motions, 0.0) {
            let before = &motions[first - 1];
            let is_lead = before.kind == Kind::Feed(Role::LeadIn) && before.is_level();
            assert_eq!(is_lead, cosine.is_some(), "{before:?}");
            if let Some(cosine) = cosine {
                let turn = before.piece.heading(1.0) - motions[first].piece.heading(0.0);
                assert!((turn.cos() - cosine).abs() < 1e-6, "{turn}");
            }
        }
    }
}

/// The distance of places on straight walls from the sweep of the cutter at each height, mm.
fn left_on_walls(places: &[P], job: &Job, motions: &[Motion]) -> BTreeMap<i64, [f64; 2]> {
    let mut heights: BTreeMap<i64, Vec<&Motion>> = BTreeMap::new();
    for motion in motions.iter().filter(|motion| is_cut(motion)) {
        heights.entry((motion.z[0] * 1e6).round() as i64).or_default().push(motion);
    }
    let of = |motions: Vec<&Motion>| {
        let distance = |p: &P| {
            motions.iter().map(|motion| motion.piece.distance(*p)).fold(f64::INFINITY, f64::min)
                - job.tool.radius_mm
        };
        let all: Vec<f64> = places.iter().map(distance).collect();
        [all.iter().copied().fold(f64::INFINITY, f64::min), all.iter().copied().fold(0.0, f64::max)]
    };
    heights.into_iter().map(|(z, motions)| (z, of(motions))).collect()
}

/// Places on the four sides of a rectangle of 100 x 60 mm, away from its corners.
fn places() -> Vec<P> {
    let along = |length: f64| (0..200).map(move |k| 6.0 + (length - 12.0) * f64::from(k) / 199.0);
    let level = along(100.0).flat_map(|x| [[x, 0.0], [x, 60.0]]);
    level.chain(along(60.0).flat_map(|y| [[0.0, y], [100.0, y]])).collect()
}

#[test]
fn roughing_leaves_the_allowance_and_finishing_nothing() {
    let case = Case { floor_mm: -9.0, ..cases::rectangle() };
    let area = Area::new(&case);
    for pattern in PATTERNS {
        let base =
            Job { allowance_mm: 0.3, floor_allowance_mm: 0.2, ..job(&case, &[pattern], Some(SLOT_FEED)) };
        let rough = planned(&base);
        let moved = motions(&rough.toolpath);
        for (z, [least, most]) in left_on_walls(&places(), &base, &moved) {
            assert!(
                (least - 0.3).abs() < 1e-6 && (most - 0.3).abs() < 1e-6,
                "{pattern:?} at {z}: {least}, {most}"
            );
        }
        let floor = moved.iter().map(Motion::low).fold(f64::INFINITY, f64::min);
        assert!((floor + 8.8).abs() < 1e-9, "{floor}");
        assert!(nearest_beside(&area, &base, &moved) >= base.side_mm() - ROUNDING_MM);
        let left = rough.report.left;
        assert!((left.walls_min_mm - 0.3).abs() < 2e-3 && (left.walls_max_mm - 0.3).abs() < 2e-3, "{left:?}");
        assert!(left.floor_mm == 0.2, "{left:?}");

        let walls =
            FinishWalls { passes: 2, stepover_mm: None, stepdown_mm: None, feed: None, spring_passes: 1 };
        let floor = FinishFloor { stepover_mm: None, feed: None };
        let finish = Finish { walls: Some(walls), floor: Some(floor) };
        let job = Job { finish, ..base.clone() };
        let both = planned(&job);
        let moved = motions(&both.toolpath);
        let found = left_on_walls(&places(), &job, &moved);
        let [least, most] = found[&-9_000_000];
        assert!(least.abs() < 1e-6 && most.abs() < 1e-6, "{pattern:?}: {least}, {most}");
        assert_eq!(both.report.finish.len(), 1);
        assert_eq!(both.report.finish[0].n_passes, 3);
        assert!(both.report.left.walls_min_mm == 0.0 && both.report.left.floor_mm == 0.0);
        assert_eq!(wall_passes(&area, &job, &moved, 0.15).len(), 1);
        assert_eq!(wall_passes(&area, &job, &moved, 0.0).len(), 2);
        check_leads(&area, &job, &moved, 1.0);

        // The two halves of the work are the whole work.
        let only = |only| motions(&planned(&Job { only: Some(only), ..job.clone() }).toolpath);
        let (rough, finished) = (only(Only::Roughing), only(Only::Finishing));
        assert!((rough.iter().map(Motion::low).fold(f64::INFINITY, f64::min) + 8.8).abs() < 1e-9);
        let cut = |motions: &[Motion]| motions.iter().filter(|motion| is_cut(motion)).count();
        assert_eq!(cut(&rough) + cut(&finished), cut(&moved), "{pattern:?}");
    }
}

#[test]
fn levels_are_even_and_none_is_a_sliver() {
    for (floor_mm, depths) in [(-10.001, vec![5.0005; 2]), (-12.0, vec![4.0; 3]), (-18.3, vec![4.575; 4])] {
        let case = Case { floor_mm, ..cases::rectangle() };
        let plan = planned(&job(&case, &[Pattern::IslandStockOffset], None));
        let mut top = 0.0;
        let found: Vec<f64> = plan
            .report
            .levels
            .iter()
            .map(|level| std::mem::replace(&mut top, level.z_mm) - level.z_mm)
            .collect();
        assert_eq!(found.len(), depths.len());
        assert!(found.iter().zip(&depths).all(|(a, b)| (a - b).abs() < 1e-9), "{found:?}");
        assert!((top - floor_mm).abs() < 1e-12);
    }
}

#[test]
fn by_default_the_feed_goes_down_in_four_steps_and_never_for_the_papers_time() {
    let case = cases::rectangle();
    let plan = planned(&job(&case, &[Pattern::ZigzagOffset], None));
    let feeds = |plan: &Plan| {
        let mut feeds: Vec<i64> = motions(&plan.toolpath)
            .iter()
            .filter(|motion| motion.kind == Kind::Feed(Role::Cut))
            .filter_map(|motion| motion.feed.map(|feed| feed.round() as i64))
            .collect();
        feeds.sort_unstable();
        feeds.dedup();
        feeds
    };
    // The feed is 800 mm/min.
    assert_eq!(feeds(&plan), [320, 440, 560, 680, 800]);
    let paper = Job { choose_by: ChooseBy::PaperTime, ..job(&case, &[Pattern::ZigzagOffset], None) };
    let plan = planned(&paper);
    assert_eq!(feeds(&plan), [800]);
    assert!(plan.warnings.iter().any(|warning| warning.to_string().contains("paper's time")));
}

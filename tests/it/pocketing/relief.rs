//! Pockets whose part has heights of its own: each level is cleared around what is higher than the level.

use std::sync::Arc;

use serde_json::{Value, json};
use toolpathd_server::http::App;

use super::cases::{box_at, circle_at};
use super::heights::{self, Heights};
use super::plane::P;
use super::samples::Part;
use super::service::{ALL, Cut, FAST, Region, app, assert_refused, floors, planned, refused, seconds, with};

/// For the bumps, and for the channel.
const BUMPS: Cut = Cut { diameter_mm: 10.0, stepover_mm: 4.0, floor_mm: -15.0, stepdown_mm: 5.0 };

/// For the block and the step.
const BLOCK: Cut = Cut { diameter_mm: 8.0, stepover_mm: 3.0, floor_mm: -15.0, stepdown_mm: 5.0 };

/// For slopes and terraces.
const TERRACES: Cut = Cut { diameter_mm: 8.0, stepover_mm: 3.0, floor_mm: -12.0, stepdown_mm: 5.0 };

/// The largest part by which the time of a mirrored or turned part may differ.
const TIME_PART: f64 = 0.02;

/// The largest gouge that may be reported where islands are exact, mm: rounding to three decimals, and the
/// distance between a surface and the triangles that stand for it.
const REPORTED_MM: f64 = 0.002;

/// How exactly the tests know the thickness of what a level leaves, mm: by samples.
const LEFTOVER_MM: f64 = 0.005;

/// Plans a pocket from the full stock, and asserts that the answer is sound.
async fn sound(app: &Arc<App>, cut: &Cut, request: &Value, part: &Part<'_>) -> Value {
    let answer = planned(app, request).await;
    part.judge(cut, &answer, &part.stock(|_| false)).assert_sound();
    let reported = answer["report"]["gouge_max_mm"].as_f64().expect("a depth");
    assert!(reported < REPORTED_MM, "a gouge of {reported} mm is reported");
    answer
}

/// As [`sound`], with two patterns over all heights.
async fn sound_over(heights: &Heights, cut: &Cut) -> Value {
    let request = with(&cut.request(&FAST), "heights", heights.json());
    sound(&app(), cut, &request, &heights.part(None)).await
}

fn assert_floors(answer: &Value, expected: &[f64]) {
    let found = floors(answer);
    let is_same =
        found.len() == expected.len() && found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-6);
    assert!(is_same, "floors at {found:?} instead of {expected:?}");
}

/// The numbers of islands on all levels.
fn islands(answer: &Value) -> Vec<u64> {
    let levels = answer["report"]["levels"].as_array().expect("levels");
    levels.iter().map(|level| level["n_islands"].as_u64().expect("a number")).collect()
}

fn warns(answer: &Value, code: &str) -> bool {
    answer["warnings"].as_array().expect("warnings").iter().any(|warning| warning["code"] == code)
}

#[tokio::test]
async fn each_level_is_cleared_around_three_bumps() {
    let answer = sound_over(&heights::bumps(), &BUMPS).await;
    assert_floors(&answer, &[-5.0, -10.0, -15.0]);
    assert_eq!(islands(&answer), [3, 3, 3]);
}

#[tokio::test]
async fn levels_on_the_planes_of_a_block_and_a_step_clear_these_planes() {
    let answer = sound_over(&heights::block_and_step(), &BLOCK).await;
    assert_floors(&answer, &[-5.0, -10.0, -15.0]);
    assert_eq!(islands(&answer), [1, 1, 1]);
    // The step of 20 mm by 60 mm is cleared at -10 mm: the tool reaches all but its corners.
    let corners = answer["report"]["levels"][1]["not_reached_area_mm2"].as_f64().expect("an area");
    assert!(corners < 20.0, "{corners} mm2 are not reached at -10 mm");
}

#[tokio::test]
async fn a_channel_is_cleared_down_to_its_bottom() {
    let cut = Cut { floor_mm: -10.0, ..BUMPS };
    let answer = sound_over(&heights::channel(), &cut).await;
    assert_floors(&answer, &[-5.0, -10.0]);
    assert_eq!(islands(&answer), [0, 0]);
}

#[tokio::test]
async fn every_pattern_clears_around_a_block_and_a_step() {
    let (app, heights) = (app(), heights::block_and_step());
    let part = heights.part(None);
    for pattern in ALL {
        let request = with(&BLOCK.request(&[pattern]), "heights", heights.json());
        let answer = sound(&app, &BLOCK, &request, &part).await;
        for level in answer["report"]["levels"].as_array().expect("levels") {
            assert_eq!(level["chosen"], pattern);
        }
    }
}

#[tokio::test]
async fn an_island_of_the_region_stays_beside_the_bumps() {
    let heights = heights::bumps();
    let region = Region::new(box_at(5.0, 3.0, 90.0, 74.0), vec![box_at(70.0, 56.0, 12.0, 8.0)]);
    let request = with(&BUMPS.request(&FAST), "heights", heights.json());
    let request = with(&request, "region", region.json());
    let answer = sound(&app(), &BUMPS, &request, &heights.part(Some(&region))).await;
    assert_eq!(islands(&answer), [4, 4, 4]);
}

#[tokio::test]
async fn mirrored_and_turned_heights_take_the_same_time() {
    let heights = heights::bumps();
    let before = seconds(&sound_over(&heights, &BUMPS).await);
    for (name, other) in [("mirrored", heights.mirrored()), ("turned", heights.turned())] {
        let after = seconds(&sound_over(&other, &BUMPS).await);
        assert!((after - before).abs() <= TIME_PART * before, "{name}: {before} s became {after} s");
    }
}

#[tokio::test]
async fn labelling_reports_its_gouges_and_slicing_makes_none() {
    let (app, heights) = (app(), heights::bumps());
    let part = heights.part(None);
    let request = with(&BUMPS.request(&FAST), "heights", heights.json());
    let sliced = sound(&app, &BUMPS, &request, &part).await;
    assert!(!warns(&sliced, "roughing_path_gouges"), "{}", sliced["warnings"]);
    let labelled = planned(&app, &with(&request, "islands_by", json!("labelling"))).await;
    assert!(warns(&labelled, "roughing_path_gouges"), "{}", labelled["warnings"]);
    let found = part.judge(&BUMPS, &labelled, &part.stock(|_| false)).gouge_mm;
    let reported = labelled["report"]["gouge_max_mm"].as_f64().expect("a depth");
    assert!(found > 0.1, "cells of 2 mm gouge by {found} mm only");
    assert!(found <= reported + 1e-6, "{found} mm deep, {reported} mm reported");
}

/// Nine patches, of which the middle one is a dome over a square with sides of 40 mm.
const DOME_X: [f64; 4] = [0.0, 40.0, 80.0, 120.0];
const DOME_Y: [f64; 4] = [0.0, 30.0, 70.0, 100.0];
const DOME_FLOOR_MM: f64 = -8.0;

/// The dome is this times u (1 - u) v (1 - v) above the floor, mm: 8 mm in the middle.
const DOME_MM: f64 = 128.0;

fn dome() -> Value {
    let along = |ends: [f64; 4], k: usize, c: usize| ends[k] + (ends[k + 1] - ends[k]) * c as f64 / 3.0;
    let point = |[i, j]: [usize; 2], [a, b]: [usize; 2]| {
        let is_raised = [i, j] == [1, 1] && (1..=2).contains(&a) && (1..=2).contains(&b);
        let rise = if is_raised { DOME_MM / 9.0 } else { 0.0 };
        [along(DOME_X, i, a), along(DOME_Y, j, b), DOME_FLOOR_MM + rise]
    };
    let net = |i: usize, j: usize| [0, 1, 2, 3].map(|a| [0, 1, 2, 3].map(|b| point([i, j], [a, b])));
    let patches: Vec<Vec<_>> = (0..3).map(|i| (0..3).map(|j| net(i, j)).collect()).collect();
    json!({ "kind": "bezier_patches", "patches": patches })
}

fn dome_at([x, y]: P) -> f64 {
    let [u, v] = [(x - DOME_X[1]) / 40.0, (y - DOME_Y[1]) / 40.0];
    DOME_FLOOR_MM + DOME_MM * (u * (1.0 - u)).max(0.0) * (v * (1.0 - v)).max(0.0)
}

#[tokio::test]
async fn a_dome_of_patches_is_cleared_around_inside_a_round_region() {
    let cut = Cut { diameter_mm: 8.0, stepover_mm: 3.0, floor_mm: DOME_FLOOR_MM, stepdown_mm: 3.0 };
    let region = Region::new(circle_at(60.0, 50.0, 45.0), vec![]);
    let request = with(&cut.request(&FAST), "surface", dome());
    let request = with(&with(&request, "region", region.json()), "top_z_mm", json!(0));
    let height = |p: P| if region.contains(p) { dome_at(p) } else { f64::INFINITY };
    let part = Part::new([[DOME_X[0], DOME_Y[0]], [DOME_X[3], DOME_Y[3]]], height);
    let answer = sound(&app(), &cut, &request, &part).await;
    assert_floors(&answer, &[-8.0 / 3.0, -16.0 / 3.0, -8.0]);
    assert_eq!(islands(&answer), [1, 1, 1]);
}

#[tokio::test]
async fn a_trough_is_cleared_between_the_upright_walls_of_a_region() {
    let cut = Cut { diameter_mm: 8.0, stepover_mm: 3.0, floor_mm: -11.0, stepdown_mm: 4.0 };
    let depths = [0.0, -16.0, -16.0, 0.0];
    let net = [0usize, 1, 2, 3]
        .map(|a| [0usize, 1, 2, 3].map(|b| [80.0 * a as f64 / 3.0, 20.0 * b as f64, depths[a]]));
    let region = Region::new(box_at(15.0, 10.0, 50.0, 40.0), vec![]);
    let surface = json!({ "kind": "bezier_patches", "patches": [[net]] });
    let request = with(&cut.request(&FAST), "surface", surface);
    let request = with(&with(&request, "region", region.json()), "top_z_mm", json!(0));
    let trough = |x: f64| -48.0 * (x / 80.0) * (1.0 - x / 80.0);
    let height = |p: P| if region.contains(p) { trough(p[0]) } else { f64::INFINITY };
    let answer = sound(&app(), &cut, &request, &Part::new([[0.0, 0.0], [80.0, 60.0]], height)).await;
    assert_floors(&answer, &[-11.0 / 3.0, -22.0 / 3.0, -11.0]);
}

/// The width of all stairs, mm.
const STAIRS_MM: f64 = 40.0;

/// A surface of treads with upright walls between them. Each tread is given by the x of its end and its
/// height, mm.
fn stairs(treads: &[P]) -> Value {
    let curve = |y: f64| {
        let (mut x, mut text) = (0.0, String::new());
        for [end, z] in treads {
            text.push_str(&format!("l({x},{y},{z}) l({end},{y},{z}) "));
            x = *end;
        }
        text
    };
    json!({ "kind": "ruled", "first": curve(0.0).trim(), "second": curve(STAIRS_MM).trim() })
}

/// Plans the pocket over stairs with an allowance, and asserts that the answer is sound.
async fn sound_over_stairs(treads: &[P], cut: &Cut, allowance_mm: Option<f64>) -> Value {
    let request = with(&cut.request(&FAST), "surface", stairs(treads));
    let mut request = with(&request, "top_z_mm", json!(0));
    if let Some(allowance_mm) = allowance_mm {
        request = with(&request, "roughing_allowance_mm", json!(allowance_mm));
    }
    let width = treads[treads.len() - 1][0];
    let is_inside = |[x, y]: P| (0.0..=width).contains(&x) && (0.0..=STAIRS_MM).contains(&y);
    let tread = |p: P| treads.iter().find(|tread| p[0] <= tread[0]).map_or(f64::INFINITY, |tread| tread[1]);
    let height = |p: P| if is_inside(p) { tread(p) } else { f64::INFINITY };
    sound(&app(), cut, &request, &Part::new([[0.0, 0.0], [width, STAIRS_MM]], height)).await
}

#[tokio::test]
async fn beside_upright_walls_levels_are_equally_deep() {
    let cut = Cut { floor_mm: -11.0, stepdown_mm: 4.0, ..TERRACES };
    let answer = sound_over_stairs(&[[15.0, 0.0], [60.0, -11.0]], &cut, Some(0.5)).await;
    assert_floors(&answer, &[-11.0 / 3.0, -22.0 / 3.0, -11.0]);
    for level in answer["report"]["levels"].as_array().expect("levels") {
        let left = level["leftover_max_mm"].as_f64().expect("a thickness");
        assert!(left < 1e-6, "{left} mm on an upright wall");
    }
}

#[tokio::test]
async fn with_an_allowance_levels_end_on_treads_between_upright_walls() {
    let treads = [[10.0, 0.0], [40.0, -3.0], [70.0, -7.0], [110.0, -12.0]];
    let with_allowance = sound_over_stairs(&treads, &TERRACES, Some(0.5)).await;
    assert_floors(&with_allowance, &[-3.0, -7.0, -12.0]);
    let without = sound_over_stairs(&treads, &TERRACES, None).await;
    assert_floors(&without, &[-4.0, -8.0, -12.0]);
    assert!(without["report"]["levels"][0].get("leftover_max_mm").is_none());
}

/// Plans the pocket over heights with an allowance, and asserts that the answer is sound, that no level
/// leaves more than the allowance, and that the report states what each level leaves.
async fn sound_with_allowance(heights: &Heights, cut: &Cut, allowance_mm: f64) -> Value {
    let request = with(&cut.request(&FAST), "heights", heights.json());
    let request = with(&request, "roughing_allowance_mm", json!(allowance_mm));
    let answer = sound(&app(), cut, &request, &heights.part(None)).await;
    let mut top = 0.0;
    assert_eq!(floors(&answer).last(), Some(&cut.floor_mm));
    for level in answer["report"]["levels"].as_array().expect("levels") {
        let [z, reported] = ["z_mm", "leftover_max_mm"].map(|name| level[name].as_f64().expect("a length"));
        let found = heights.leftover_mm(top, z);
        assert!(
            found <= reported + 1e-6 && reported <= allowance_mm + 1e-6,
            "from {top} to {z}: {found} mm are left, {reported} mm reported, {allowance_mm} mm allowed"
        );
        top = z;
    }
    answer
}

/// Asserts that each level that is neither as deep as the stepdown nor the last would leave more than the
/// allowance if the level were deeper.
fn assert_deepest(heights: &Heights, cut: &Cut, answer: &Value, allowance_mm: f64) {
    let floors = floors(answer);
    let mut top = 0.0;
    for z in &floors[..floors.len() - 1] {
        let left = heights.leftover_mm(top, z - 2.0 * LEFTOVER_MM);
        let is_whole = top - z > cut.stepdown_mm - 1e-6;
        assert!(is_whole || left > allowance_mm, "from {top} to {z}: a deeper level leaves {left} mm only");
        top = *z;
    }
}

#[tokio::test]
async fn on_a_slope_of_45_degrees_levels_are_as_deep_as_the_root_of_two_allows() {
    let (heights, allowance) = (heights::slope(), 1.5);
    let answer = sound_with_allowance(&heights, &TERRACES, allowance).await;
    let depth = allowance * 2f64.sqrt();
    let expected: Vec<f64> = (1..=5).map(|k| -depth * f64::from(k)).chain([-12.0]).collect();
    assert_floors(&answer, &expected);
    assert_deepest(&heights, &TERRACES, &answer, allowance);
    let found = heights.leftover_mm(0.0, expected[0]);
    let reported = answer["report"]["levels"][0]["leftover_max_mm"].as_f64().expect("a thickness");
    assert!((found - reported).abs() < LEFTOVER_MM, "{found} mm are left, {reported} mm reported");
    let shallow = Cut { stepdown_mm: 2.0, ..TERRACES };
    let answer = sound_with_allowance(&heights, &shallow, allowance).await;
    assert_floors(&answer, &[-2.0, -4.0, -6.0, -8.0, -10.0, -12.0]);
}

#[tokio::test]
async fn with_an_allowance_levels_end_on_terraces_between_steep_slopes() {
    let (heights, allowance) = (heights::terraces(), 1.0);
    let answer = sound_with_allowance(&heights, &TERRACES, allowance).await;
    assert_floors(&answer, &[-3.0, -7.0, -12.0]);
    assert_deepest(&heights, &TERRACES, &answer, allowance);
    let without = sound_over(&heights, &TERRACES).await;
    assert_floors(&without, &[-4.0, -8.0, -12.0]);
}

#[tokio::test]
async fn no_level_leaves_more_than_the_allowance_on_bumps() {
    let answer = sound_with_allowance(&heights::bumps(), &BUMPS, 3.0).await;
    assert!(floors(&answer).len() > 3, "the allowance of 3 mm adds no level of less than 5 mm");
}

#[tokio::test]
async fn a_relief_that_contradicts_the_request_is_refused_with_the_place() {
    let (app, base) = (app(), BUMPS.request(&FAST));
    let heights = with(&base, "heights", heights::bumps().json());
    let region = with(&base, "region", Region::new(box_at(0.0, 0.0, 50.0, 40.0), vec![]).json());
    let ragged = json!({ "origin": [0, 0], "spacing_mm": 9, "z": [[0, 0, 0], [0, 0], [-15, -15, -15]] });
    for (request, code, pointer) in [
        (with(&base, "heights", ragged), "ragged_grid", "#/heights/z/1"),
        (with(&heights, "surface", dome()), "conflict", "#/heights"),
        (base, "missing_field", "#/region"),
        (with(&region, "roughing_allowance_mm", json!(1)), "conflict", "#/roughing_allowance_mm"),
        (with(&region, "islands_by", json!("labelling")), "conflict", "#/islands_by"),
        (with(&heights, "floor_z_mm", json!(0.5)), "out_of_range", "#/floor_z_mm"),
        (with(&heights, "cell_mm", json!(1)), "conflict", "#/cell_mm"),
    ] {
        assert_refused(&app, &request, code, pointer).await;
    }
}

#[tokio::test]
async fn a_surface_that_overhangs_is_refused() {
    let (across, down) = ([0.0, 60.0, -10.0, 50.0], [0.0, -5.0, -10.0, -15.0]);
    let net = [0usize, 1, 2, 3].map(|a| [0usize, 1, 2, 3].map(|b| [across[a], 20.0 * b as f64, down[a]]));
    let surface = json!({ "kind": "bezier_patches", "patches": [[net]] });
    let (code, _) = refused(&app(), &with(&BUMPS.request(&FAST), "surface", surface)).await;
    assert_eq!(code, "overhang");
}

/// The answer with each move changed.
fn spoiled(answer: &Value, change: impl Fn(&mut Value)) -> Value {
    let mut answer = answer.clone();
    for pass in answer["toolpath"]["passes"].as_array_mut().expect("passes") {
        pass["moves"].as_array_mut().expect("moves").iter_mut().for_each(&change);
    }
    answer
}

#[tokio::test]
async fn the_checker_finds_gouges_uncut_places_low_rapids_and_links_through_stock() {
    let heights = heights::block_and_step();
    let part = heights.part(None);
    let request = with(&BLOCK.request(&FAST), "heights", heights.json());
    let answer = sound(&app(), &BLOCK, &request, &part).await;
    let judge = |cut: &Cut, answer: &Value| part.judge(cut, answer, &part.stock(|_| false));
    let finds = |cut: &Cut, answer: &Value, fault: &str| {
        let faults = judge(cut, answer).faults;
        assert!(faults.iter().any(|found| found.contains(fault)), "{fault}: {faults:#?}");
    };
    // The radius is larger by 0.01 mm.
    let gouge = judge(&Cut { diameter_mm: 8.02, ..BLOCK }, &answer).gouge_mm;
    assert!((gouge - 0.01).abs() < 0.002, "{gouge} mm");
    finds(&Cut { diameter_mm: 7.0, ..BLOCK }, &answer, "stay uncut");
    finds(&Cut { stepdown_mm: 4.0, ..BLOCK }, &answer, "floors at");
    let low = spoiled(&answer, |step| {
        if step["kind"] == "rapid" {
            let z = step["to"][2].as_f64().expect("a height");
            step["to"][2] = json!(z - 2.0);
        }
    });
    finds(&BLOCK, &low, "below the retract plane");
    let linked = spoiled(&answer, |step| {
        if step["role"] == "cut" {
            step["role"] = json!("link");
        }
    });
    finds(&BLOCK, &linked, "stock are in the way");
}

//! Pockets of which earlier tools have emptied a part: only the rest is cut.

use std::sync::Arc;

use serde_json::{Value, json};
use toolpathd_server::http::App;

use super::cases::{box_at, filleted, polygon};
use super::heights;
use super::samples::Part;
use super::service::{
    ALL, Cut, FAST, Region, app, assert_refused, floors, planned, refused, seconds, steps, with,
};
use crate::api::support::get;

/// The earlier cutter, for two levels.
const LARGE: Cut = Cut { diameter_mm: 20.0, stepover_mm: 8.0, floor_mm: -8.0, stepdown_mm: 4.0 };

/// The cutter of the rest.
const SMALL: Cut = Cut { diameter_mm: 6.0, stepover_mm: 2.0, floor_mm: -8.0, stepdown_mm: 4.0 };

/// The most that the rest may take, as a part of the time for the whole pocket.
const REST_TIME: f64 = 0.2;

/// A pocket whose island leaves the large cutter room on all sides.
fn roomy() -> Region {
    Region::new(box_at(0.0, 0.0, 100.0, 60.0), vec![box_at(40.0, 22.0, 20.0, 16.0)])
}

/// A pocket whose island is 14 mm from the wall: the large cutter does not pass there.
fn tight() -> Region {
    Region::new(box_at(0.0, 0.0, 100.0, 60.0), vec![box_at(40.0, 14.0, 20.0, 24.0)])
}

/// What the large cutter sweeps in the roomy pocket: all but the corners.
fn swept_by_large() -> Region {
    Region::new(filleted(LARGE.radius_mm()).boundary, vec![box_at(40.0, 22.0, 20.0, 16.0)])
}

/// The part outside a pocket with a flat floor.
fn part(region: &Region) -> Part<'_> {
    Part::new(region.bounds(), move |p| if region.contains(p) { f64::NEG_INFINITY } else { f64::INFINITY })
}

fn request(cut: &Cut, patterns: &[&str], region: &Region) -> Value {
    with(&cut.request(patterns), "region", region.json())
}

/// What a planned program leaves of the stock. Asserts that the program runs through no stock by rapid.
fn stock_after(part: &Part<'_>, cut: &Cut, answer: &Value) -> Vec<f64> {
    let mut stock = part.stock(|_| false);
    let faults = part.run(&mut stock, &steps(answer), cut.radius_mm());
    assert!(faults.is_empty(), "{faults:#?}");
    stock
}

/// The member `cleared` for a program of the service.
fn by_program(cut: &Cut, dialect: &str, answer: &Value) -> Value {
    json!([{ "nc": answer["nc"], "dialect": dialect, "tool_diameter_mm": cut.diameter_mm }])
}

/// Plans the rest of a pocket over `stock`, and asserts that the answer is sound.
async fn sound(app: &Arc<App>, cut: &Cut, request: &Value, part: &Part<'_>, stock: &[f64]) -> Value {
    let answer = planned(app, request).await;
    part.judge(cut, &answer, stock).assert_sound();
    answer
}

/// Asserts that the rest takes little time.
fn assert_short(rest: &Value, whole: &Value) {
    let [rest, whole] = [rest, whole].map(seconds);
    assert!(rest < REST_TIME * whole, "the rest takes {rest} s, the whole pocket {whole} s");
}

#[tokio::test]
async fn after_an_emptied_region_only_the_corners_are_cut() {
    let (app, region, emptied) = (app(), roomy(), swept_by_large());
    let part = part(&region);
    let whole_request = request(&SMALL, &FAST, &region);
    let whole = sound(&app, &SMALL, &whole_request, &part, &part.stock(|_| false)).await;
    let rest_request = with(&whole_request, "cleared", json!([emptied.json()]));
    let stock = part.stock(|p| emptied.contains(p));
    let rest = sound(&app, &SMALL, &rest_request, &part, &stock).await;
    assert_short(&rest, &whole);
    // The cutter stays within its diameter of the corners that the large cutter leaves.
    let reach = LARGE.radius_mm() + SMALL.diameter_mm;
    let steps = steps(&rest);
    let feeds: Vec<_> = steps.iter().filter(|step| step.role.is_some()).collect();
    assert!(feeds.len() > 8, "{} feed moves for two levels of four corners", feeds.len());
    for step in feeds {
        let [x, y] = step.piece.at(1.0);
        let is_near = x.min(100.0 - x) < reach && y.min(60.0 - y) < reach;
        assert!(is_near, "{step:?} is far from the corners");
    }
}

#[tokio::test]
async fn after_a_program_in_any_dialect_only_the_rest_is_cut() {
    let (app, region) = (app(), tight());
    let part = part(&region);
    let whole = planned(&app, &request(&SMALL, &FAST, &region)).await;
    let listed = get(&app, "/v1/dialects").await.json();
    let dialects: Vec<&str> =
        listed["dialects"].as_array().expect("dialects").iter().filter_map(|d| d["name"].as_str()).collect();
    assert!(["linuxcnc", "fanuc"].iter().all(|name| dialects.contains(name)), "{dialects:?}");
    for dialect in dialects {
        let large_request = request(&LARGE, &FAST, &region);
        let large = planned(&app, &with(&large_request, "program", json!({ "dialect": dialect }))).await;
        let rest_request =
            with(&request(&SMALL, &FAST, &region), "cleared", by_program(&LARGE, dialect, &large));
        let rest = sound(&app, &SMALL, &rest_request, &part, &stock_after(&part, &LARGE, &large)).await;
        assert_eq!(floors(&rest), [-4.0, -8.0]);
        assert_short(&rest, &whole);
    }
}

#[tokio::test]
async fn a_program_in_inches_empties_the_same_places() {
    let (app, region) = (app(), tight());
    let part = part(&region);
    let program = json!({ "dialect": "linuxcnc", "units": "inch" });
    let large = planned(&app, &with(&request(&LARGE, &FAST, &region), "program", program)).await;
    let rest_request =
        with(&request(&SMALL, &FAST, &region), "cleared", by_program(&LARGE, "linuxcnc", &large));
    sound(&app, &SMALL, &rest_request, &part, &stock_after(&part, &LARGE, &large)).await;
}

#[tokio::test]
async fn every_pattern_cuts_the_rest() {
    let (app, region) = (app(), tight());
    let part = part(&region);
    let large = planned(&app, &request(&LARGE, &FAST, &region)).await;
    let stock = stock_after(&part, &LARGE, &large);
    let cleared = by_program(&LARGE, "linuxcnc", &large);
    for pattern in ALL {
        let rest_request = with(&request(&SMALL, &[pattern], &region), "cleared", cleared.clone());
        let rest = sound(&app, &SMALL, &rest_request, &part, &stock).await;
        assert_eq!(floors(&rest), [-4.0, -8.0]);
        for level in rest["report"]["levels"].as_array().expect("levels") {
            assert_eq!(level["chosen"], pattern);
            assert_eq!(level["candidates"][0]["valid"], true, "{level}");
        }
    }
}

#[tokio::test]
async fn a_level_below_the_floor_of_an_earlier_program_is_cut_whole() {
    let (app, region) = (app(), tight());
    let part = part(&region);
    let shallow = Cut { floor_mm: -4.0, ..LARGE };
    let large = planned(&app, &request(&shallow, &FAST, &region)).await;
    let small_request = request(&SMALL, &FAST, &region);
    let rest_request = with(&small_request, "cleared", by_program(&shallow, "linuxcnc", &large));
    let rest = sound(&app, &SMALL, &rest_request, &part, &stock_after(&part, &shallow, &large)).await;
    let whole = planned(&app, &small_request).await;
    // The upper level is short, and the lower one is the same.
    let (rest, whole) = (seconds(&rest), seconds(&whole));
    assert!((0.4..0.7).contains(&(rest / whole)), "the rest takes {rest} s, the whole pocket {whole} s");
}

#[tokio::test]
async fn after_a_large_cutter_the_rest_around_bumps_is_cut() {
    let (app, heights) = (app(), heights::bumps());
    let part = heights.part(None);
    let large = Cut { diameter_mm: 16.0, stepover_mm: 6.0, floor_mm: -15.0, stepdown_mm: 5.0 };
    let small = Cut { diameter_mm: 6.0, stepover_mm: 2.0, ..large };
    let over_heights = |cut: &Cut| with(&cut.request(&FAST), "heights", heights.json());
    let first = planned(&app, &over_heights(&large)).await;
    let rest_request = with(&over_heights(&small), "cleared", by_program(&large, "linuxcnc", &first));
    let rest = sound(&app, &small, &rest_request, &part, &stock_after(&part, &large, &first)).await;
    let whole = planned(&app, &over_heights(&small)).await;
    let (rest, whole) = (seconds(&rest), seconds(&whole));
    assert!(rest < 0.5 * whole, "the rest takes {rest} s, the whole pocket {whole} s");
}

#[tokio::test]
async fn where_everything_is_emptied_there_is_nothing_to_cut() {
    let app = app();
    let all = json!([{ "boundary": box_at(-5.0, -5.0, 110.0, 70.0) }]);
    let halves = json!([
        { "boundary": box_at(-5.0, -5.0, 60.0, 70.0) },
        { "boundary": box_at(45.0, -5.0, 60.0, 70.0) },
    ]);
    for cleared in [all, halves] {
        let emptied = with(&request(&SMALL, &FAST, &roomy()), "cleared", cleared);
        let (code, _) = refused(&app, &emptied).await;
        assert_eq!(code, "nothing_to_cut");
    }
}

#[tokio::test]
async fn an_emptied_place_beside_the_pocket_changes_no_move() {
    let (app, region) = (app(), roomy());
    let alone = request(&SMALL, &FAST, &region);
    let expected = planned(&app, &alone).await;
    let beside = json!([{ "boundary": box_at(300.0, 0.0, 50.0, 50.0) }]);
    for cleared in [json!([]), beside] {
        let answer = planned(&app, &with(&alone, "cleared", cleared)).await;
        assert!(answer["toolpath"]["passes"].is_array(), "the answer has no moves");
        assert!(answer["toolpath"] == expected["toolpath"], "the moves differ");
    }
}

#[tokio::test]
async fn emptied_places_that_make_no_sense_are_refused_with_the_place() {
    let (app, base) = (app(), request(&SMALL, &FAST, &roomy()));
    let square = box_at(0.0, 0.0, 20.0, 20.0);
    let eight = polygon(&[[0.0, 0.0], [60.0, 40.0], [60.0, 0.0], [0.0, 30.0]]);
    let nc = "G0 Z5";
    for (cleared, code, pointer) in [
        (json!([{}]), "conflict", "#/cleared/0"),
        (json!([{ "boundary": square }, {}]), "conflict", "#/cleared/1"),
        (json!([{ "boundary": eight, "nc": nc, "tool_diameter_mm": 20 }]), "conflict", "#/cleared/0"),
        (json!([{ "nc": nc }]), "missing_field", "#/cleared/0/tool_diameter_mm"),
        (json!([{ "nc": "G0 X\nM30", "tool_diameter_mm": 20 }]), "syntax", "#/cleared/0/nc"),
        (
            json!([{ "nc": nc, "tool_diameter_mm": 20, "dialect": "none" }]),
            "unknown_dialect",
            "#/cleared/0/dialect",
        ),
        (json!([{ "boundary": square, "tool_diameter_mm": 20 }]), "conflict", "#/cleared/0/tool_diameter_mm"),
        (json!([{ "boundary": eight }]), "out_of_range", "#/cleared/0/boundary"),
        (json!([{ "boundary": square, "islands": [eight] }]), "out_of_range", "#/cleared/0/islands/0"),
    ] {
        assert_refused(&app, &with(&base, "cleared", cleared), code, pointer).await;
    }
}

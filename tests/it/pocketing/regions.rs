//! Tests of several regions in one request.

use std::collections::BTreeSet;
use std::f64::consts::PI;
use std::time::Instant;

use serde_json::{Value, json};

use super::plane::{P, apart};
use super::service::{Cut, FAST, RETRACT_MM, Step, TOP_MM, app, floors, planned, refused, steps, with};
use crate::api::support::post;

const CUT: Cut = Cut { diameter_mm: 6.0, stepover_mm: 2.0, floor_mm: -4.0, stepdown_mm: 2.0 };

fn rectangle([x, y]: P, [width, height]: P) -> Value {
    json!({ "boundary": [[x, y], [x + width, y], [x + width, y + height], [x, y + height]] })
}

fn request(regions: &[Value]) -> Value {
    with(&CUT.request(&FAST), "regions", json!(regions))
}

/// Two pockets of 20 mm, 20 mm apart.
fn two_apart() -> [Value; 2] {
    [rectangle([0.0, 0.0], [20.0, 20.0]), rectangle([40.0, 0.0], [20.0, 20.0])]
}

/// The indices of the regions of each level, in the order of the report.
fn regions_of_levels(answer: &Value) -> Vec<Vec<u64>> {
    let levels = answer["report"]["levels"].as_array().expect("levels");
    let indices = |level: &Value| level["regions"].as_array().expect("indices").clone();
    levels
        .iter()
        .map(|level| indices(level).iter().map(|k| k.as_u64().expect("an index")).collect())
        .collect()
}

fn is_feed_below_top(step: &Step) -> bool {
    step.role.is_some() && step.low() < TOP_MM
}

/// The number of a pocket in a row whose pockets begin every `pitch_mm`.
fn pocket_at(p: P, pitch_mm: f64) -> i64 {
    (p[0] / pitch_mm).floor() as i64
}

/// The pockets and floors in the order in which they are cut.
fn order_of_cuts(answer: &Value, pitch_mm: f64) -> Vec<(i64, f64)> {
    let cuts = steps(answer);
    let places = cuts
        .iter()
        .filter(|step| is_feed_below_top(step) && step.z[0] == step.z[1])
        .map(|step| (pocket_at(step.piece.at(0.5), pitch_mm), step.z[0]))
        .filter(|(_, z)| [-2.0, -4.0].contains(z));
    let mut order: Vec<(i64, f64)> = Vec::new();
    for place in places {
        if order.last() != Some(&place) {
            order.push(place);
        }
    }
    order
}

/// The length of rapids in the plane, mm.
fn rapids_mm(answer: &Value) -> f64 {
    steps(answer).iter().filter(|step| step.role.is_none()).map(|step| step.piece.length()).sum()
}

/// What a flat cutter leaves in the corners of rectangles with `corners` corners, mm2.
fn corners_mm2(corners: f64) -> f64 {
    corners * CUT.radius_mm().powi(2) * (1.0 - PI / 4.0)
}

fn uncut_mm2(answer: &Value) -> f64 {
    answer["report"]["uncut_area_mm2"].as_f64().expect("an area")
}

#[tokio::test]
async fn two_pockets_apart_are_both_cleared_with_the_tool_up_between_them() {
    let request = with(&request(&two_apart()), "sequence", json!("as_given"));
    let answer = planned(&app(), &request).await;
    assert_eq!(regions_of_levels(&answer), [[0], [0], [1], [1]]);
    assert_eq!(floors(&answer), [-2.0, -4.0, -2.0, -4.0]);
    // Four corners of each pocket on each level, and nothing else.
    assert!((uncut_mm2(&answer) - corners_mm2(16.0)).abs() < 0.01, "{}", uncut_mm2(&answer));
    let moves = steps(&answer);
    for step in &moves {
        let [a, b] = [step.piece.at(0.0), step.piece.at(1.0)];
        let inside = |p: P| (0.0..=20.0).contains(&(p[0].rem_euclid(40.0))) && (0.0..=20.0).contains(&p[1]);
        if step.low() < RETRACT_MM {
            assert!(inside(a) && inside(b) && pocket_at(a, 40.0) == pocket_at(b, 40.0), "{step:?}");
        }
    }
    // The level of a pass is the level of the report.
    for step in moves.iter().filter(|step| is_feed_below_top(step) && step.role.as_deref() == Some("cut")) {
        let level = step.level.expect("a level");
        assert_eq!(pocket_at(step.piece.at(0.5), 40.0), (level / 2) as i64, "{step:?}");
        assert!(step.low() >= floors(&answer)[level] - 1e-9, "{step:?}");
    }
}

#[tokio::test]
async fn a_list_of_one_region_is_cut_as_the_region_alone() {
    let region = rectangle([0.0, 0.0], [30.0, 20.0]);
    let app = app();
    let alone = planned(&app, &with(&CUT.request(&FAST), "region", region.clone())).await;
    let listed = planned(&app, &request(&[region])).await;
    assert_eq!(alone["toolpath"], listed["toolpath"]);
    assert_eq!(alone["nc"], listed["nc"]);
    assert_eq!(regions_of_levels(&listed), [[0], [0]]);
    assert!(alone["report"]["levels"][0].get("regions").is_none());
}

#[tokio::test]
async fn pockets_that_share_a_wall_are_cut_as_one_and_nothing_of_the_wall_is_left() {
    let app = app();
    let shared = [rectangle([0.0, 0.0], [20.0, 20.0]), rectangle([20.0, 0.0], [20.0, 20.0])];
    let answer = planned(&app, &request(&shared)).await;
    assert_eq!(regions_of_levels(&answer), [[0, 1], [0, 1]]);
    assert!((uncut_mm2(&answer) - corners_mm2(8.0)).abs() < 0.01, "{}", uncut_mm2(&answer));
    let whole = with(&CUT.request(&FAST), "region", rectangle([0.0, 0.0], [40.0, 20.0]));
    let whole = planned(&app, &whole).await;
    assert_eq!(uncut_mm2(&whole), uncut_mm2(&answer));
    // The centre goes where a wall would keep it a radius away.
    let is_on_wall = |step: &Step| is_feed_below_top(step) && (step.piece.at(1.0)[0] - 20.0).abs() < 1.0;
    assert!(steps(&answer).iter().any(is_on_wall));
    // Overlaps, and a wall that is there by the rounding of coordinates alone.
    for x in [15.0, 19.9995, 20.0005] {
        let regions = [shared[0].clone(), rectangle([x, 0.0], [40.0 - x, 20.0])];
        let answer = planned(&app, &request(&regions)).await;
        assert_eq!(regions_of_levels(&answer), [[0, 1], [0, 1]], "{x}");
        assert!((uncut_mm2(&answer) - corners_mm2(8.0)).abs() < 0.02, "{x}: {}", uncut_mm2(&answer));
    }
}

#[tokio::test]
async fn depth_first_finishes_a_pocket_and_level_first_a_level() {
    let app = app();
    let finish = json!({ "walls": {} });
    let request = with(&with(&request(&two_apart()), "finish", finish), "allowance_mm", json!(0.3));
    let request = with(&request, "sequence", json!("as_given"));
    let depth = planned(&app, &with(&request, "order", json!("depth_first"))).await;
    assert_eq!(order_of_cuts(&depth, 40.0), [(0, -2.0), (0, -4.0), (1, -2.0), (1, -4.0)]);
    let level = planned(&app, &with(&request, "order", json!("level_first"))).await;
    // The finishing passes come last, at the whole depth.
    let expected = [(0, -2.0), (1, -2.0), (0, -4.0), (1, -4.0), (0, -4.0), (1, -4.0)];
    assert_eq!(order_of_cuts(&level, 40.0), expected);
    assert_eq!(regions_of_levels(&level), [[0], [1], [0], [1]]);
    let finished = |answer: &Value| {
        let finish = answer["report"]["finish"].as_array().expect("passes").clone();
        finish.iter().map(|pass| pass["regions"].clone()).collect::<Vec<_>>()
    };
    for answer in [depth, level] {
        assert_eq!(finished(&answer), [json!([0]), json!([1])]);
        let report = &answer["report"];
        assert!(report["gouge_max_mm"].as_f64().expect("a bound") < 0.001);
        assert!(report["left"]["walls_max_mm"].as_f64().expect("a bound") < 0.002);
    }
}

/// Five pockets in a row, in an order that goes to and fro.
fn row() -> Vec<Value> {
    [0, 3, 1, 4, 2].iter().map(|k| rectangle([40.0 * f64::from(*k), 0.0], [12.0, 12.0])).collect()
}

#[tokio::test]
async fn as_given_keeps_the_order_and_least_travel_goes_along_the_row() {
    let app = app();
    for order in ["depth_first", "level_first"] {
        let request = with(&request(&row()), "order", json!(order));
        let given = planned(&app, &with(&request, "sequence", json!("as_given"))).await;
        let firsts = |answer: &Value| {
            let mut seen = BTreeSet::new();
            let order = order_of_cuts(answer, 40.0).into_iter();
            order.map(|(pocket, _)| pocket).filter(|pocket| seen.insert(*pocket)).collect::<Vec<_>>()
        };
        assert_eq!(firsts(&given), [0, 3, 1, 4, 2]);
        let least = planned(&app, &request).await;
        assert!(rapids_mm(&least) < 0.8 * rapids_mm(&given), "{order}");
        if order == "depth_first" {
            let order = firsts(&least);
            assert!(order.is_sorted() || order.is_sorted_by(|a, b| a > b), "{order:?}");
        }
    }
}

#[tokio::test]
async fn the_same_request_gets_the_same_bytes() {
    let request = with(&request(&row()), "order", json!("level_first"));
    let ask = async || post(&app(), "/v1/pockets/plan?nc=true", request.to_string(), &[]).await.body;
    assert!(ask().await == ask().await);
}

#[tokio::test]
async fn a_refusal_names_the_region() {
    let app = app();
    let [first, second] = two_apart();
    let slot = rectangle([80.0, 0.0], [20.0, 5.0]);
    let (code, violations) = refused(&app, &request(&[first.clone(), slot, second])).await;
    assert_eq!(code, "tool_too_large");
    assert!(violations.iter().any(|(_, pointer)| pointer == "#/regions/1"), "{violations:?}");
    let crossed = json!({ "boundary": [[80, 0], [90, 10], [90, 0], [80, 10]] });
    let (_, violations) = refused(&app, &request(&[first.clone(), crossed])).await;
    assert_eq!(violations[0].1, "#/regions/1/boundary");
    let short = json!({ "boundary": [[80, 0]] });
    let (_, violations) = refused(&app, &request(&[first.clone(), short])).await;
    assert_eq!(violations, [("too_few_points".to_owned(), "#/regions/1/boundary".to_owned())]);
    let mut filled = rectangle([80.0, 0.0], [20.0, 20.0]);
    filled["islands"] = json!([filled["boundary"]]);
    let (code, violations) = refused(&app, &request(&[first, filled])).await;
    assert_eq!(code, "nothing_to_cut");
    assert_eq!(violations[0].1, "#/regions/1");
}

#[tokio::test]
async fn members_that_do_not_go_together_are_refused() {
    let app = app();
    let region = rectangle([0.0, 0.0], [20.0, 20.0]);
    let conflict = |member: &str| vec![("conflict".to_owned(), format!("#/{member}"))];
    let both = with(&request(&two_apart()), "region", region.clone());
    assert_eq!(refused(&app, &both).await.1, conflict("region"));
    let heights = json!({ "origin": [0, 0], "spacing_mm": 10, "z": [[0, 0], [0, 0]] });
    let high = with(&request(&two_apart()), "heights", heights);
    assert_eq!(refused(&app, &high).await.1, conflict("heights"));
    let alone = with(&CUT.request(&FAST), "region", region);
    assert_eq!(refused(&app, &with(&alone, "order", json!("level_first"))).await.1, conflict("order"));
    assert_eq!(refused(&app, &with(&alone, "sequence", json!("as_given"))).await.1, conflict("sequence"));
    let empty = refused(&app, &request(&[])).await.1;
    assert_eq!(empty, [("wrong_length".to_owned(), "#/regions".to_owned())]);
    let many = vec![json!({ "boundary": [[0, 0], [9, 0], [9, 9]] }); 1001];
    let many = refused(&app, &request(&many)).await.1;
    assert_eq!(many[0].1, "#/regions");
}

#[tokio::test]
async fn an_island_that_another_region_cuts_is_told() {
    let mut ring = rectangle([0.0, 0.0], [60.0, 60.0]);
    ring["islands"] = json!([[[20, 20], [40, 20], [40, 40], [20, 40]]]);
    let across = rectangle([10.0, 24.0], [20.0, 12.0]);
    let answer = planned(&app(), &request(&[ring.clone(), across])).await;
    let warnings = answer["warnings"].as_array().expect("warnings");
    let told = warnings.iter().find(|warning| warning["code"] == "island_cut").expect("a warning");
    assert_eq!(told["pointer"], "#/regions/0/islands/0");
    // A pocket on the island is meant to be there.
    let answer = planned(&app(), &request(&[ring, rectangle([24.0, 24.0], [12.0, 12.0])])).await;
    let warnings = answer["warnings"].as_array().expect("warnings");
    assert!(warnings.iter().all(|warning| warning["code"] != "island_cut"), "{warnings:?}");
    assert_eq!(regions_of_levels(&answer).into_iter().collect::<BTreeSet<_>>().len(), 2);
}

#[tokio::test]
async fn places_emptied_by_earlier_tools_are_left_out_region_by_region() {
    let app = app();
    let cleared = json!([{ "boundary": [[-1, -1], [21, -1], [21, 21], [-1, 21]] }]);
    let answer = planned(&app, &with(&request(&two_apart()), "cleared", cleared)).await;
    assert_eq!(regions_of_levels(&answer).len(), 4);
    let cuts: BTreeSet<i64> = order_of_cuts(&answer, 40.0).into_iter().map(|(pocket, _)| pocket).collect();
    assert_eq!(cuts, BTreeSet::from([1]));
}

#[tokio::test]
async fn a_hundred_pockets_are_planned_soon_with_less_travel_than_as_given() {
    // The pockets of a grid, in an order that jumps about.
    let place = |k: u32| [20.0 * f64::from(k * 37 % 100 % 10), 20.0 * f64::from(k * 37 % 100 / 10)];
    let regions: Vec<Value> = (0..100).map(|k| rectangle(place(k), [12.0, 12.0])).collect();
    let request = with(&request(&regions), "stepdown_max_mm", json!(4.0));
    let app = app();
    let begun = Instant::now();
    let least = planned(&app, &request).await;
    let seconds = begun.elapsed().as_secs_f64();
    assert!(seconds < 60.0, "{seconds} s");
    let given = planned(&app, &with(&request, "sequence", json!("as_given"))).await;
    assert!(rapids_mm(&least) < 0.5 * rapids_mm(&given), "{} and {}", rapids_mm(&least), rapids_mm(&given));
    let cut: BTreeSet<Vec<u64>> = regions_of_levels(&least).into_iter().collect();
    assert_eq!(cut.len(), 100);
    assert!((uncut_mm2(&least) - corners_mm2(400.0)).abs() < 1.0, "{}", uncut_mm2(&least));
    // Each pocket has a cut next to each of its four walls.
    let moves = steps(&least);
    for k in 0..100 {
        let [x, y] = place(k);
        let reach = CUT.radius_mm();
        for wall in [
            [x + reach, y + 6.0],
            [x + 12.0 - reach, y + 6.0],
            [x + 6.0, y + reach],
            [x + 6.0, y + 12.0 - reach],
        ] {
            let near = |step: &Step| {
                is_feed_below_top(step)
                    && step.piece.points(0.01, 0.5).into_iter().any(|p| apart(p, wall) < 0.6)
            };
            assert!(moves.iter().any(near), "{k}: {wall:?}");
        }
    }
}

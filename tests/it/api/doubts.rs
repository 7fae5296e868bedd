//! Tests of warnings about what is legal in a request and yet often a mistake: each has its place, and none
//! comes where the request is as usual.

use serde_json::{Value, json};

use super::support::{MILL, ONE_PASS, app, post};

const PLAN: &str = "/v1/pockets/plan";

/// A pocket of 60 x 40 mm with two islands, about which nothing is doubtful.
fn pocket() -> Value {
    json!({
        "region": {
            "boundary": [[0, 0], [60, 0], [60, 40], [0, 40]],
            "islands": [[[10, 10], [16, 10], [16, 16], [10, 16]], [[40, 10], [46, 10], [46, 16], [40, 16]]],
        },
        "floor_z_mm": -4, "stepdown_max_mm": 4, "stepover_mm": 3,
        "tool": { "shape": "flat", "diameter_mm": 6 },
        "patterns": ["zigzag_stock_offset"],
        "cutting": { "feed_mm_per_min": 800 },
    })
}

/// Heights of 60 x 40 mm that rise from -10 to 2 mm.
fn heights() -> Value {
    let row: Value = (0..16).map(|i| json!(-10.0 + 0.8 * f64::from(i))).collect();
    json!({ "origin": [0, 0], "spacing_mm": 4, "z": vec![row; 11] })
}

/// The codes and the pointers of the warnings, but for those that only say what is absent.
async fn doubts(path: &str, body: &Value) -> Vec<(String, String)> {
    let answer = post(&app(&["--workers", "1"]), &format!("{path}?format=json"), body.to_string(), &[]).await;
    assert_eq!(answer.status, 200, "{}", answer.text());
    let text = |value: &Value| value.as_str().unwrap_or_default().to_owned();
    let answer = answer.json();
    let warnings = answer["warnings"].as_array().expect("warnings").iter();
    let of = warnings.map(|warning| (text(&warning["code"]), text(&warning["pointer"])));
    of.filter(|(code, _)| !code.starts_with("no_") && code != "stock_not_given" && code != "clearance_chosen")
        .filter(|(code, _)| code != "places_not_reached")
        .collect()
}

fn one(code: &str, at: &str) -> Vec<(String, String)> {
    vec![(code.to_owned(), at.to_owned())]
}

/// The pocket with the value at a place changed.
fn with(place: &str, value: Value) -> Value {
    let mut body = pocket();
    let (parent, name) = place.rsplit_once('/').expect("a place");
    let parent = body.pointer_mut(parent).expect("a parent");
    match parent.as_array_mut() {
        Some(array) => array[name.parse::<usize>().expect("an index")] = value,
        None => parent[name] = value,
    }
    body
}

#[tokio::test]
async fn a_usual_pocket_is_not_doubted() {
    assert_eq!(doubts(PLAN, &pocket()).await, []);
}

#[tokio::test]
async fn a_bulge_beyond_a_half_circle_is_named_with_its_place() {
    // A radius where a bulge was meant.
    let wide = with("/region/boundary/1", json!([60, 0, 1.2]));
    assert_eq!(doubts(PLAN, &wide).await, one("bulge_over_half_circle", "#/region/boundary/1/2"));
    let island = json!([[40, 10], [46, 10, -0.2], [46, 16, 1.5], [40, 16, 1.5]]);
    let island = with("/region/islands/1", island);
    let answer = post(&app(&[]), PLAN, island.to_string(), &[]).await;
    assert_eq!(answer.header("toolpathd-warnings").matches("bulge_over_half_circle").count(), 1);
    let answer = answer.json();
    let warnings = answer["warnings"].as_array().expect("warnings");
    let bulge = warnings.iter().find(|warning| warning["code"] == "bulge_over_half_circle").expect("a bulge");
    assert_eq!(bulge["pointer"], "#/region/islands/1/2/2");
    assert!(bulge["detail"].as_str().expect("a detail").contains("(and one more)"), "{bulge}");
    for half_circle in [1.0, -1.0, 1.000_000_5] {
        let half = with("/region/islands/1", json!([[40, 10, half_circle], [46, 10, half_circle]]));
        assert_eq!(doubts(PLAN, &half).await, [], "{half_circle}");
    }
    let mut cleared = pocket();
    cleared["cleared"] = json!([{ "boundary": [[20, 20], [30, 20, 1.1], [30, 30], [20, 30]] }]);
    assert_eq!(doubts(PLAN, &cleared).await, one("bulge_over_half_circle", "#/cleared/0/boundary/1/2"));
}

#[tokio::test]
async fn an_island_outside_the_wall_is_named_with_its_index() {
    let square = |x: f64, y: f64| json!([[x, y], [x + 6.0, y], [x + 6.0, y + 6.0], [x, y + 6.0]]);
    let outside = one("island_outside", "#/region/islands/1");
    // A sign slip, an island in the box of a concave wall, and one that touches the wall from outside.
    assert_eq!(doubts(PLAN, &with("/region/islands/1", square(-46.0, 10.0))).await, outside);
    assert_eq!(doubts(PLAN, &with("/region/islands/1", square(60.0, 10.0))).await, outside);
    let mut concave = with("/region/islands/1", square(40.0, 30.0));
    concave["region"]["boundary"] = json!([[0, 0], [60, 0], [60, 20], [30, 20], [30, 40], [0, 40]]);
    assert_eq!(doubts(PLAN, &concave).await, outside);
    // Islands inside, across the wall, and along it.
    for [x, y] in [[40.0, 10.0], [57.0, 10.0], [54.0, 10.0], [-0.5, 37.0]] {
        assert_eq!(doubts(PLAN, &with("/region/islands/1", square(x, y))).await, [], "{x} {y}");
    }
}

#[tokio::test]
async fn a_region_beyond_its_heights_says_that_nothing_is_cut_there() {
    let mut body = pocket();
    body["heights"] = heights();
    body["top_z_mm"] = json!(2);
    assert_eq!(doubts(PLAN, &body).await, [], "the region is as large as the heights");
    body["region"]["boundary"] = json!([[0, 0], [60.1, 0], [60.1, 40], [0, 40]]);
    assert_eq!(doubts(PLAN, &body).await, one("region_beyond_part", "#/region/boundary"));
    // What is said is so: no cut lies outside.
    let answer = post(&app(&[]), &format!("{PLAN}?toolpath=true"), body.to_string(), &[]).await.json();
    assert!(answer["measures"]["bounds"]["max"][0].as_f64().expect("a place") < 60.0);
    let mut surface = pocket();
    surface["surface"] = json!({ "kind": "point_grid", "points": [
        [[0, 0, -6], [0, 40, -6]], [[60, 0, -6], [60, 40, -6]]] });
    surface["top_z_mm"] = json!(0);
    assert_eq!(doubts(PLAN, &surface).await, []);
    surface["region"]["boundary"] = json!([[0, -3], [60, -3], [60, 40], [0, 40]]);
    assert_eq!(doubts(PLAN, &surface).await, one("region_beyond_part", "#/region/boundary"));
}

#[tokio::test]
async fn a_stock_below_the_part_is_doubted() {
    let mut body = pocket();
    body["heights"] = heights();
    for (top_z_mm, expected) in [(2.0, Vec::new()), (1.0, one("stock_below_part", "#/top_z_mm"))] {
        body["top_z_mm"] = json!(top_z_mm);
        assert_eq!(doubts(PLAN, &body).await, expected, "{top_z_mm}");
    }
    body.as_object_mut().expect("an object").remove("top_z_mm");
    assert_eq!(doubts(PLAN, &body).await, [], "the default is the part's highest point");
}

#[tokio::test]
async fn two_words_for_one_work_offset_are_doubted() {
    for (program, expected) in [
        (
            json!({ "dialect": "haas", "work_offset": "G55", "custom": { "header": ["M31", "G154 P5"] } }),
            true,
        ),
        (json!({ "dialect": "fanuc", "work_offset": "G55", "custom": { "header": ["G54.1 P3"] } }), true),
        (json!({ "dialect": "siemens", "work_offset": "G55", "custom": { "header": ["G505"] } }), true),
        (json!({ "dialect": "haas", "custom": { "header": ["G154 P5"] } }), false),
        (json!({ "dialect": "haas", "work_offset": "G55", "custom": { "header": ["M31"] } }), false),
    ] {
        let mut body = pocket();
        body["program"] = program.clone();
        let header = program["custom"]["header"].as_array().expect("lines");
        let at = format!("#/program/custom/header/{}", header.len() - 1);
        let expected = if expected { one("work_offset_twice", &at) } else { Vec::new() };
        let answer = post(&app(&[]), PLAN, body.to_string(), &[]).await;
        assert_eq!(answer.status, 200, "{program}: {}", answer.text());
        assert_eq!(doubts(PLAN, &body).await, expected, "{program}");
    }
}

#[tokio::test]
async fn a_slot_feed_above_the_feed_is_doubted() {
    for (slot, expected) in
        [(800.0, Vec::new()), (801.0, one("slot_feed_above_feed", "#/cutting/slot_feed_mm_per_min"))]
    {
        assert_eq!(
            doubts(PLAN, &with("/cutting/slot_feed_mm_per_min", json!(slot))).await,
            expected,
            "{slot}"
        );
    }
}

#[tokio::test]
async fn a_tolerance_above_a_tenth_of_the_radius_is_doubted() {
    let mut body: Value = serde_json::from_str(ONE_PASS).expect("JSON");
    let radius_mm = 0.5 * body["tool"]["diameter_mm"].as_f64().expect("a diameter");
    for (share, expected) in [(0.1, Vec::new()), (0.101, one("tolerance_coarse", "#/tolerance_mm"))] {
        body["tolerance_mm"] = json!(share * radius_mm);
        let mut told = doubts(MILL, &body).await;
        told.retain(|(code, _)| code == "tolerance_coarse");
        assert_eq!(told, expected, "{share}");
    }
}

#[tokio::test]
async fn a_program_of_more_than_ten_hours_is_doubted() {
    let line = |feed: f64| {
        json!({ "toolpath": { "start": [0, 0, 5], "passes": [{ "moves": [
            { "kind": "line", "to": [600, 0, -1], "feed_mm_per_min": feed }] }] } })
    };
    // 600.03 mm at 1 mm/min take 10 h and some seconds.
    assert_eq!(doubts("/v1/programs/write", &line(1.0)).await, one("long_time", ""));
    assert_eq!(doubts("/v1/programs/write", &line(1.001)).await, []);
}

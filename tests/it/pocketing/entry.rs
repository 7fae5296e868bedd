//! Pockets whose request says where the cutter comes down first.

use serde_json::{Value, json};

use super::cases::box_at;
use super::plane::{P, Piece, apart};
use super::service::{ALL, Cut, Region, Step, app, assert_refused, planned, steps, with};
use crate::api::support::post;

const CUT: Cut = Cut { diameter_mm: 10.0, stepover_mm: 4.0, floor_mm: -6.0, stepdown_mm: 3.0 };

const N_LEVELS: usize = 2;

/// The shortest edge of a region of centres along which the cutter ramps down: half of its radius, mm.
const LEAST_EDGE_MM: f64 = 2.5;

/// A place away from the middle of the pocket.
const PLACE: P = [43.0, 16.0];

/// Rounding to the program's decimals, mm.
const ROUNDING_MM: f64 = 2e-3;

fn region() -> Region {
    Region::new(box_at(0.0, 0.0, 60.0, 40.0), vec![])
}

fn request(patterns: &[&str], entry: Value) -> Value {
    with(&with(&CUT.request(patterns), "region", region().json()), "entry", entry)
}

fn has_role(step: &Step, role: &str) -> bool {
    step.role.as_deref() == Some(role)
}

/// The first move into the material of each level.
fn first_entries(all: &[Step]) -> Vec<&Step> {
    let is_entry = |step: &&Step| has_role(step, "ramp") || has_role(step, "plunge");
    (0..N_LEVELS)
        .map(|level| all.iter().filter(is_entry).find(|step| step.level == Some(level)).expect("an entry"))
        .collect()
}

fn is_helix_about(step: &Step, place: P) -> bool {
    matches!(step.piece, Piece::Arc { center, .. } if apart(center, place) < ROUNDING_MM)
        && step.z[1] < step.z[0]
}

fn is_plunge_at(step: &Step, place: P) -> bool {
    has_role(step, "plunge") && [0.0, 1.0].iter().all(|t| apart(step.piece.at(*t), place) < ROUNDING_MM)
}

/// The details of the warnings of a code.
fn warnings(answer: &Value, code: &str) -> Vec<String> {
    let all = answer["warnings"].as_array().expect("warnings");
    let own = all.iter().filter(|warning| warning["code"] == code);
    own.map(|warning| warning["detail"].as_str().expect("a detail").to_owned()).collect()
}

#[tokio::test]
async fn every_pattern_begins_every_level_on_a_helix_about_the_place() {
    let app = app();
    for pattern in ALL {
        for direction in ["climb", "conventional"] {
            let request = with(&request(&[pattern], json!({ "at": PLACE })), "direction", json!(direction));
            let answer = planned(&app, &request).await;
            let all = steps(&answer);
            for step in first_entries(&all) {
                assert!(is_helix_about(step, PLACE), "{pattern}, {direction}: {step:?}");
            }
            assert!(warnings(&answer, "entry_elsewhere").is_empty(), "{pattern}, {direction}");
        }
    }
}

#[tokio::test]
async fn in_a_hole_the_cutter_goes_straight_down_and_nowhere_else_into_the_material() {
    let app = app();
    for pattern in ["zigzag_stock_offset", "island_stock_offset", "engagement"] {
        for direction in ["climb", "conventional"] {
            let entry = json!({ "at": PLACE, "predrilled_diameter_mm": 10 });
            let request = with(&request(&[pattern], entry), "direction", json!(direction));
            let all = steps(&planned(&app, &request).await);
            for step in first_entries(&all) {
                assert!(is_plunge_at(step, PLACE), "{pattern}, {direction}: {step:?}");
            }
            assert!(!all.iter().any(|step| has_role(step, "ramp")), "{pattern}, {direction}");
            assert_eq!(all.iter().filter(|step| has_role(step, "plunge")).count(), N_LEVELS);
        }
    }
}

#[tokio::test]
async fn a_pattern_that_comes_down_at_the_place_wins_over_faster_ones() {
    let app = app();
    // Beside the wall, where the pattern `engagement` cannot come down.
    let entry = json!({ "at": [6.5, 20], "plunge": true });
    let request = request(&["engagement", "zigzag_stock_offset"], entry);
    let answer = planned(&app, &request).await;
    assert!(warnings(&answer, "entry_elsewhere").is_empty());
    for step in first_entries(&steps(&answer)) {
        assert!(is_plunge_at(step, [6.5, 20.0]) || is_helix_about(step, [6.5, 20.0]), "{step:?}");
    }
}

#[tokio::test]
async fn a_place_outside_is_refused_with_its_distance() {
    let app = app();
    // The centre may come down 5.2 mm from the wall.
    for (at, off) in [([2, 20], "3.200 mm"), ([-10, 20], "15.200 mm")] {
        let request = request(&["zigzag_stock_offset", "engagement"], json!({ "at": at }));
        assert_refused(&app, &request, "out_of_range", "#/entry/at").await;
        let answer = post(&app, "/v1/pockets/plan", request.to_string(), &[]).await;
        assert!(answer.text().contains(off), "{}", answer.text());
    }
}

#[tokio::test]
async fn a_place_without_room_for_a_helix_needs_a_plunge_or_a_hole() {
    let (app, at) = (app(), json!([5.6, 20]));
    let bare = request(&["zigzag_stock_offset"], json!({ "at": at }));
    assert_refused(&app, &bare, "out_of_range", "#/entry/at").await;
    for entry in [json!({ "at": at, "plunge": true }), json!({ "at": at, "predrilled_diameter_mm": 12 })] {
        let answer = planned(&app, &request(&["zigzag_stock_offset"], entry.clone())).await;
        for step in first_entries(&steps(&answer)) {
            assert!(is_plunge_at(step, [5.6, 20.0]), "{entry}: {step:?}");
        }
    }
}

#[tokio::test]
async fn a_hole_needs_a_place_and_the_width_of_the_cutter() {
    let app = app();
    let hole = "#/entry/predrilled_diameter_mm";
    let without = request(&["zigzag_stock_offset"], json!({ "predrilled_diameter_mm": 10 }));
    assert_refused(&app, &without, "conflict", hole).await;
    let narrow = |plunge: bool| json!({ "at": PLACE, "predrilled_diameter_mm": 9.9, "plunge": plunge });
    assert_refused(&app, &request(&["zigzag_stock_offset"], narrow(false)), "out_of_range", hole).await;
    let answer = planned(&app, &request(&["zigzag_stock_offset"], narrow(true))).await;
    assert!(first_entries(&steps(&answer)).iter().all(|step| is_plunge_at(step, PLACE)));
}

#[tokio::test]
async fn a_place_for_walls_that_are_only_finished_is_refused() {
    let bare = with(&request(&["zigzag_stock_offset"], json!({ "at": PLACE })), "only", json!("finishing"));
    let finished = with(&with(&bare, "allowance_mm", json!(0.3)), "finish", json!({ "walls": {} }));
    assert_refused(&app(), &finished, "conflict", "#/entry/at").await;
}

#[tokio::test]
async fn levels_on_which_the_cutter_comes_down_elsewhere_are_told() {
    let app = app();
    let bare = with(&CUT.request(&["zigzag_stock_offset"]), "entry", json!({ "at": [12, 20] }));
    // The second level ends below the left half of the part.
    let row = [-4, -4, -12, -12];
    let heights = json!({ "origin": [0, 0], "spacing_mm": 20, "z": [row, row, row], "outliers": "accept" });
    let relief = with(&with(&bare, "heights", heights), "top_z_mm", json!(0));
    let told = warnings(&planned(&app, &relief).await, "entry_elsewhere");
    assert!(told.len() == 1 && told[0].contains("on 1 of 2 levels, first at Z -6.000 mm"), "{told:?}");
    // An earlier tool has emptied the place.
    let cleared = json!([{ "boundary": box_at(0.0, 0.0, 30.0, 40.0) }]);
    let rest = with(&with(&bare, "region", region().json()), "cleared", cleared);
    let told = warnings(&planned(&app, &rest).await, "entry_elsewhere");
    assert!(told.len() == 1 && told[0].contains("on 2 of 2 levels"), "{told:?}");
}

/// A pocket with a square room between four islands that overlap each other.
fn with_room(size_mm: f64) -> Region {
    let (x, y, thick) = (75.0, 12.0, 5.0);
    let whole = size_mm + 2.0 * thick;
    let islands = vec![
        box_at(x - thick, y - thick, whole, thick),
        box_at(x - thick, y + size_mm, whole, thick),
        box_at(x - thick, y - thick, thick, whole),
        box_at(x + size_mm, y - thick, thick, whole),
    ];
    Region::new(box_at(0.0, 0.0, 120.0, 40.0), islands)
}

#[tokio::test]
async fn a_room_hardly_wider_than_the_cutter_is_cut_or_told_and_stops_no_plan() {
    let app = app();
    for size_mm in [10.2, 10.55, 10.7, 10.9, 11.4] {
        let region = with(&CUT.request(&[]), "region", with_room(size_mm).json());
        let is_entered = 4.0 * (size_mm - CUT.diameter_mm) >= LEAST_EDGE_MM;
        for pattern in ALL {
            let answer = planned(&app, &with(&region, "patterns", json!([pattern]))).await;
            let is_in = |p: P| p[0] > 75.0 && p[0] < 75.0 + size_mm && p[1] > 12.0 && p[1] < 12.0 + size_mm;
            let is_cut = steps(&answer).iter().any(|step| step.role.is_some() && is_in(step.piece.at(0.5)));
            assert_eq!(is_cut, is_entered, "{pattern}: {size_mm} mm");
            let not_reached =
                answer["report"]["levels"][0]["not_reached"].as_array().expect("places").clone();
            let is_room = |place: &Value| {
                let at = [0, 1].map(|k| place["at"][k].as_f64().expect("a number"));
                // Corners of the room are smaller.
                is_in(at) && place["area_mm2"].as_f64().expect("an area") > 50.0
            };
            assert_eq!(
                !not_reached.iter().any(is_room),
                is_entered,
                "{pattern}, {size_mm} mm: {not_reached:?}"
            );
        }
    }
}

#[tokio::test]
async fn with_several_regions_the_place_is_that_of_its_region() {
    let app = app();
    let second = Region::new(box_at(80.0, 0.0, 60.0, 40.0), vec![]);
    let all =
        with(&CUT.request(&["zigzag_stock_offset"]), "regions", json!([second.json(), region().json()]));
    let entry = |at: P| with(&all, "entry", json!({ "at": at }));
    let answer = planned(&app, &entry(PLACE)).await;
    assert!(warnings(&answer, "entry_elsewhere").is_empty());
    let all_steps = steps(&answer);
    let (own, other): (Vec<&Step>, Vec<&Step>) =
        all_steps.iter().filter(|step| has_role(step, "ramp")).partition(|step| step.piece.at(0.5)[0] < 70.0);
    assert!(!other.is_empty() && own.iter().filter(|step| step.z[1] < step.z[0]).count() > 0);
    assert!(
        own.iter().filter(|step| step.z[1] < step.z[0]).all(|step| is_helix_about(step, PLACE)),
        "{own:?}"
    );
    assert_refused(&app, &entry([70.0, 16.0]), "out_of_range", "#/entry/at").await;
}

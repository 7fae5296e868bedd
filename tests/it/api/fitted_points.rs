//! Surfaces near noisy points in any order: what is told of them, and what is refused with its pointer.

use serde_json::{Value, json};

use super::support::{Answer, app, post};

const MODEL: &str = "/v1/surfaces/model";

/// Points of a bowl at places that are not in rows.
fn points() -> Vec<[f64; 3]> {
    let place = |k: u32| {
        let (i, j) = (f64::from(k / 25), f64::from(k % 25));
        [4.0 * i + 1.1 * (2.3 * j).sin(), 4.0 * j + 1.1 * (1.7 * i).cos()]
    };
    let height = |[x, y]: [f64; 2]| [x, y, 0.002 * ((x - 48.0).powi(2) + (y - 45.0).powi(2))];
    (0..625).map(place).map(height).collect()
}

fn surface(points: &[[f64; 3]], fit: Value) -> Value {
    json!({ "kind": "points", "points": points, "fit": fit })
}

async fn model(surface: &Value) -> Answer {
    post(&app(&["--workers", "1"]), MODEL, json!({ "surface": surface }).to_string(), &[]).await
}

/// The detail of the warning with this code.
fn told(answer: &Answer, code: &str) -> Option<String> {
    let warnings = answer.json()["warnings"].as_array().cloned().unwrap_or_default();
    let found = warnings.into_iter().find(|warning| warning["code"] == code)?;
    assert_eq!(found["pointer"], "#/surface");
    found["detail"].as_str().map(str::to_owned)
}

#[tokio::test]
async fn a_fitted_surface_is_told_with_its_figures() {
    let answer = model(&surface(&points(), json!({ "max_mm": 0.02 }))).await;
    assert_eq!(answer.status, 200, "{}", answer.text());
    let detail = told(&answer, "points_fitted").expect("a warning");
    assert!(detail.starts_with("the surface runs near 625 points"), "{detail}");
    let largest = detail.split("largest ").nth(1).and_then(|rest| rest.split(' ').next());
    let largest: f64 = largest.expect("the largest error").parse().expect("a number");
    assert!(largest > 0.01 && largest <= 0.02, "{detail}");
    let bounds = &answer.json()["report"]["bounds"];
    assert!(bounds["min"][2].as_f64().expect("a number").abs() < 0.2, "{bounds}");
}

#[tokio::test]
async fn outliers_and_missing_values_are_refused_by_place_or_left_out_with_a_word() {
    let mut wrong = points();
    wrong[312][2] += 0.5;
    let mut sent = surface(&wrong, json!({ "rms_mm": 0.005 }));
    let refused = model(&sent).await;
    assert_eq!(refused.violations(), [("outlier".to_owned(), "#/surface/points/312".to_owned())]);
    assert!(refused.text().contains("off the surface of its neighbours"), "{}", refused.text());
    sent["outliers"] = json!("leave_out");
    let answer = model(&sent).await;
    assert_eq!(answer.status, 200, "{}", answer.text());
    let detail = told(&answer, "outliers_left_out").expect("a warning");
    assert!(detail.starts_with("1 points are off") && detail.contains("point 312 at x"), "{detail}");

    wrong[312][2] -= 0.5;
    wrong[7][2] = -9999.0;
    wrong[9][2] += 0.5;
    let mut sent = surface(&wrong, json!({ "rms_mm": 0.005 }));
    assert_eq!(
        model(&sent).await.violations(),
        [("missing_value".to_owned(), "#/surface/points/7".to_owned())]
    );
    // Places count in the list as it was sent.
    sent["outliers"] = json!("leave_out");
    let answer = model(&sent).await;
    assert!(answer.text().contains("point 9 at x"), "{}", answer.text());
}

#[tokio::test]
async fn points_that_make_no_surface_are_refused_with_their_place() {
    let pointer = |answer: &Answer| answer.violations().into_iter().next().expect("a violation");
    let line: Vec<[f64; 3]> = (0..9).map(|k| [f64::from(k), 2.0 * f64::from(k), 0.0]).collect();
    let answer = model(&surface(&line, json!({ "max_mm": 0.02 }))).await;
    assert_eq!(pointer(&answer), ("unsupported".to_owned(), "#/surface/points".to_owned()));
    let mut sides = points();
    sides.extend(points().iter().map(|[x, y, z]| [*x, *y, z + 20.0]));
    let answer = model(&surface(&sides, json!({ "max_mm": 0.02 }))).await;
    let (code, place) = pointer(&answer);
    assert!(code == "conflict" && place.starts_with("#/surface/points/"), "{place}");
    for (fit, code) in [(json!({}), "missing_field"), (json!({ "max_mm": 1, "rms_mm": 1 }), "conflict")] {
        let answer = model(&surface(&points(), fit)).await;
        assert_eq!(pointer(&answer), (code.to_owned(), "#/surface/fit".to_owned()));
    }
    let step: Vec<[f64; 3]> =
        points().iter().map(|[x, y, _]| [*x, *y, if *x < 50.0 { 0.0 } else { 3.0 }]).collect();
    let mut sent = surface(&step, json!({ "max_mm": 1e-6 }));
    sent["outliers"] = json!("accept");
    let answer = model(&sent).await;
    if answer.status != 200 {
        assert_eq!(pointer(&answer), ("out_of_range".to_owned(), "#/surface/fit".to_owned()));
    }
}

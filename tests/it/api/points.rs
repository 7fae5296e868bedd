//! Measured points with mistakes: what is put right with a warning, and what is refused with its pointer.

use std::f64::consts::TAU;

use serde_json::{Value, json};

use super::support::{Answer, app, post};

const MODEL: &str = "/v1/surfaces/model";

/// The job of the README, with these heights of its nine points.
fn readme(z: [[f64; 3]; 3]) -> Value {
    let row = |i: usize| (0..3).map(|j| json!([20 * i, 15 * j, z[i][j]])).collect::<Vec<_>>();
    json!({ "kind": "point_grid", "points": (0..3).map(row).collect::<Vec<_>>() })
}

const DOME: [[f64; 3]; 3] = [[2.0, 3.5, 2.0], [4.0, 6.5, 4.0], [2.0, 3.5, 2.0]];

async fn model(surface: &Value) -> Answer {
    post(&app(&["--workers", "1"]), MODEL, json!({ "surface": surface }).to_string(), &[]).await
}

/// The codes of the warnings.
fn warned(answer: &Answer) -> Vec<String> {
    let warnings = answer.json()["warnings"].as_array().cloned().unwrap_or_default();
    warnings.iter().filter_map(|warning| warning["code"].as_str().map(str::to_owned)).collect()
}

#[tokio::test]
async fn a_row_in_reverse_order_is_put_right_with_a_word() {
    let right = model(&readme(DOME)).await;
    assert_eq!((right.status.as_u16(), warned(&right)), (200, vec![]), "{}", right.text());
    let mut sent = readme(DOME);
    sent["points"][1].as_array_mut().unwrap().reverse();
    let answer = model(&sent).await;
    assert_eq!((answer.status.as_u16(), warned(&answer)), (200, vec!["points_reordered".to_owned()]));
    assert!(answer.text().contains("row 1 ran the other way"), "{}", answer.text());
    assert_eq!(answer.json()["report"]["patches"], right.json()["report"]["patches"]);
    let tangents = [json!([20, 0, 0]), json!([0, 15, 0])].map(|t| vec![t; 3]);
    sent["ends"] = json!("clamped");
    sent["end_tangents"] =
        json!({ "u0": tangents[0], "u1": tangents[0], "v0": tangents[1], "v1": tangents[1] });
    let refused = model(&sent).await;
    assert_eq!(refused.violations(), [("reversed_row".to_owned(), "#/surface/points/1".to_owned())]);
}

#[tokio::test]
async fn a_mistake_in_the_points_of_the_readme_is_named() {
    for (place, value, code) in [
        (1, json!([20, 15, 65]), "outlier"),
        (1, json!([20, 0, 4]), "coincident"),
        (1, json!([20, 15, -9999]), "missing_value"),
    ] {
        let mut sent = readme(DOME);
        sent["points"][1][place] = value;
        let answer = model(&sent).await;
        assert_eq!(answer.violations(), [(code.to_owned(), "#/surface/points/1/1".to_owned())]);
        sent["outliers"] = json!("accept");
        assert_eq!(model(&sent).await.status, 200);
    }
}

#[tokio::test]
async fn a_missing_height_is_refused_like_a_missing_point() {
    let mut z = vec![vec![0.0; 5]; 5];
    z[2][3] = -9999.0;
    let pocket = |outliers: &str| {
        json!({
            "heights": { "origin": [0, 0], "spacing_mm": 10, "z": z, "outliers": outliers },
            "floor_z_mm": -3, "stepdown_max_mm": 2, "top_z_mm": 2, "stepover_mm": 2,
            "tool": { "shape": "flat", "diameter_mm": 4, "number": 1 },
            "cutting": { "feed_mm_per_min": 500, "spindle_rpm": 5000 },
        })
        .to_string()
    };
    let app = app(&["--workers", "1"]);
    let refused = post(&app, "/v1/pockets/plan", pocket("refuse"), &[]).await;
    assert_eq!(refused.violations(), [("missing_value".to_owned(), "#/heights/z/2/3".to_owned())]);
    assert_eq!(post(&app, "/v1/pockets/plan", pocket("accept"), &[]).await.status, 200);
}

#[tokio::test]
async fn closed_points_close_smoothly_and_the_answer_says_so() {
    let at = |i: usize, j: usize| {
        let angle = TAU * (j % 12) as f64 / 12.0;
        json!([20.0 * angle.cos(), 20.0 * angle.sin(), 5 * i])
    };
    let rows: Vec<Vec<Value>> = (0..5).map(|i| (0..13).map(|j| at(i, j)).collect()).collect();
    let ring = json!({ "kind": "point_grid", "points": rows });
    let usual = model(&ring).await;
    assert!(warned(&usual).contains(&"ends_periodic".to_owned()), "{}", usual.text());
    let mut asked = ring.clone();
    asked["ends"] = json!("periodic");
    let periodic = model(&asked).await;
    assert!(!warned(&periodic).contains(&"ends_periodic".to_owned()));
    assert_eq!(usual.json()["report"]["patches"], periodic.json()["report"]["patches"]);
    let mut open = readme(DOME);
    open["ends"] = json!("periodic");
    assert_eq!(model(&open).await.violations(), [("conflict".to_owned(), "#/surface/ends".to_owned())]);
}

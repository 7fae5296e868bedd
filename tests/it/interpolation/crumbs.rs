//! Paths beside contours have no tiny moves, and no nearly straight arcs.

use serde_json::Value;

use super::answer;

const PROFILE: &str = include_str!("../../../openapi/examples/curves-interpolate/profile.json");

fn place(value: &Value) -> [f64; 2] {
    [0, 1].map(|k| value[k].as_f64().expect("a coordinate"))
}

/// This path once had four lines of 8 to 35 micrometres between its arcs, and an arc of 4850 mm radius along
/// a flank.
#[tokio::test]
async fn a_path_beside_the_profile_has_no_tiny_moves_and_no_nearly_straight_arcs() {
    let body: Value = serde_json::from_str(PROFILE).expect("JSON");
    for side in ["left", "right"] {
        for below in [0.01, 0.002, 0.05] {
            let mut body = body.clone();
            body["compensation"] = side.into();
            body["band"]["below_mm"] = below.into();
            let answer = answer(&body).await;
            let mut at = place(&answer["toolpath"]["start"]);
            let mut n_cuts = 0;
            for step in answer["toolpath"]["passes"].as_array().expect("passes").iter() {
                for step in step["moves"].as_array().expect("moves") {
                    let to = place(&step["to"]);
                    let length = (to[0] - at[0]).hypot(to[1] - at[1]);
                    if step["role"] == "cut" {
                        n_cuts += 1;
                        assert!(length > 0.04, "{side} {below}: {step} is {length} mm long");
                    }
                    // In a narrower band the flank may be an arc of a large radius.
                    if step["kind"] == "arc" && below >= 0.01 {
                        let center = place(&step["center"]);
                        let radius = (to[0] - center[0]).hypot(to[1] - center[1]);
                        assert!(radius < 1500.0, "{side} {below}: {step} has a radius of {radius} mm");
                    }
                    at = to;
                }
            }
            assert!(n_cuts >= 8, "{side} {below}: only {n_cuts} cuts");
        }
    }
}

#[tokio::test]
async fn each_line_of_the_profile_becomes_one_element() {
    let body: Value = serde_json::from_str(PROFILE).expect("JSON");
    let report = &answer(&body).await["report"];
    assert_eq!(report["n_elements"], 12);
    assert_eq!(
        report["elements"].as_array().expect("elements").iter().filter(|e| e["shape"] == "line").count(),
        4
    );
}

//! Tests of machines that an MTConnect document describes.

use serde_json::{Value, json};

use super::support::{app, post};

const SMOOTH: &str = "/v1/five-axis/smooth";

/// A probe document of a table that tilts about X and carries a table that turns about Z.
fn probe() -> String {
    let linear = |name: &str, axis: &str, low: f64, high: f64| {
        format!(
            r#"<Linear id="{name}" name="{name}"><Configuration>
                 <Motion id="m{name}" type="PRISMATIC"><Axis>{axis}</Axis></Motion>
                 <Specifications><Specification id="s{name}" type="POSITION" units="MILLIMETER">
                   <Maximum>{high}</Maximum><Minimum>{low}</Minimum>
                 </Specification></Specifications>
               </Configuration></Linear>"#
        )
    };
    format!(
        r#"<?xml version="1.0" encoding="UTF-8"?>
        <MTConnectDevices xmlns="urn:mtconnect.org:MTConnectDevices:2.0">
          <Header version="2.0" sender="agent"/>
          <Devices><Device id="d" name="mill" uuid="1"><Components><Axes id="a"><Components>
            {}{}{}
            <Rotary id="C" name="C"><Configuration>
              <Motion id="mC" parentIdRef="mA" type="CONTINUOUS">
                <Origin>0 0 -20</Origin><Axis>0 0 1</Axis></Motion></Configuration></Rotary>
            <Rotary id="A" name="A">
              <DataItems><DataItem id="pa" type="ANGLE" category="SAMPLE"><Constraints>
                <Minimum>-100</Minimum><Maximum>30</Maximum></Constraints></DataItem></DataItems>
              <Configuration><Motion id="mA" type="REVOLUTE">
                <Transformation><Translation>0 5 -20</Translation></Transformation>
                <Axis>1 0 0</Axis></Motion></Configuration></Rotary>
            <Rotary id="S" name="S1"/>
          </Components></Axes></Components></Device></Devices>
        </MTConnectDevices>"#,
        linear("X", "1 0 0", -500.0, 500.0),
        linear("Y", "0 1 0", -400.0, 400.0),
        linear("Z", "0 0 1", -300.0, 500.0),
    )
}

fn body(machine: Value) -> String {
    json!({
        "path": [
            { "tip": [0, 0, 0], "axis": [0.1, 0.2, 1] },
            { "tip": [10, 2, 0], "axis": [0.15, 0.25, 1] },
            { "tip": [20, 0, 1], "axis": [0.2, 0.2, 1] },
        ],
        "feed_mm_per_min": 1200, "tolerance_mm": 0.01, "tolerance_deg": 0.5, "machine": machine,
    })
    .to_string()
}

#[tokio::test]
async fn a_probe_document_gives_the_same_motion_as_the_machine_in_the_request() {
    let app = app(&[]);
    let probed = json!({ "mtconnect": probe(), "kind": "table_table" });
    let sent = json!({
        "kind": "table_table", "axes": "AC",
        "rotary": [
            { "direction": [1, 0, 0], "point_mm": [0, 5, -20], "travel_deg": [-100, 30] },
            { "direction": [0, 0, 1], "point_mm": [0, 0, -20], "wrapped": true },
        ],
        "travel_mm": { "X": [-500, 500], "Y": [-400, 400], "Z": [-300, 500] },
    });
    let path = format!("{SMOOTH}?samples=true");
    let [a, b] = [post(&app, &path, body(probed), &[]).await, post(&app, &path, body(sent), &[]).await];
    assert!(a.status == 200 && b.status == 200, "{} {}", a.text(), b.text());
    assert_eq!(a.json()["samples"], b.json()["samples"]);
    // The travel of the document counts: the other branch of A is beyond it.
    let narrow = probe().replace("<Minimum>-100</Minimum>", "<Minimum>-5</Minimum>");
    let narrow = json!({ "mtconnect": narrow.replace("<Maximum>30</Maximum>", "<Maximum>5</Maximum>"), "kind": "table_table" });
    let refused = post(&app, SMOOTH, body(narrow), &[]).await;
    assert_eq!(refused.json()["code"], "out_of_travel", "{}", refused.text());
}

#[tokio::test]
async fn what_a_probe_document_does_not_state_is_named() {
    let app = app(&[]);
    let pointers = async |machine: Value| {
        let answer = post(&app, SMOOTH, body(machine), &[]).await;
        assert_eq!(answer.status, 422, "{}", answer.text());
        let errors = answer.json()["errors"].as_array().expect("errors").clone();
        errors.iter().map(|own| own["pointer"].as_str().expect("a pointer").to_owned()).collect::<Vec<_>>()
    };
    assert_eq!(pointers(json!({ "mtconnect": probe() })).await, ["#/machine/kind"]);
    let bare = probe().replace(
        "<Axis>1 0 0</Axis></Motion></Configuration></Rotary>",
        "</Motion></Configuration></Rotary>",
    );
    let bare = bare.replace("<Origin>0 0 -20</Origin>", "").replace(" parentIdRef=\"mA\"", "");
    assert_eq!(pointers(json!({ "mtconnect": bare, "kind": "head_head" })).await, ["#/machine/axes"]);
    let missing = json!({ "mtconnect": bare, "kind": "table_table", "axes": "AC" });
    assert_eq!(pointers(missing).await, ["#/machine/rotary/0/direction", "#/machine/rotary/1/point_mm"]);
    let completed = json!({
        "mtconnect": bare, "kind": "table_table", "axes": "AC",
        "rotary": [{ "direction": [1, 0, 0] }, { "point_mm": [0, 0, 0] }],
    });
    assert_eq!(post(&app, SMOOTH, body(completed), &[]).await.status, 200);
    assert_eq!(
        pointers(json!({ "mtconnect": "no XML", "kind": "table_table" })).await,
        ["#/machine/mtconnect"]
    );
    let two = json!({ "mtconnect": probe(), "name": "table_table_ac" });
    assert_eq!(pointers(two).await, ["#/machine"]);
}

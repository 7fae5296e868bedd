//! Tests of the forms of outlines: vertices with bulges, arcs by their radius, and section curves.

use serde_json::{Value, json};

use super::support::{Answer, app, post};

const PLAN: &str = "/v1/pockets/plan";

async fn planned(boundary: &Value) -> Answer {
    let body = json!({
        "region": { "boundary": boundary },
        "floor_z_mm": -4, "stepdown_max_mm": 4, "stepover_mm": 3,
        "tool": { "shape": "flat", "diameter_mm": 6 },
        "patterns": ["zigzag_stock_offset"],
        "cutting": { "feed_mm_per_min": 800 },
    });
    post(&app(&["--workers", "1"]), &format!("{PLAN}?format=gcode"), body.to_string(), &[]).await
}

async fn program(boundary: &Value) -> String {
    let answer = planned(boundary).await;
    assert_eq!(answer.status, 200, "{boundary}: {}", answer.text());
    answer.text()
}

/// The bulge of an arc of this radius over this chord, mm.
fn bulge(chord: f64, radius: f64) -> f64 {
    (0.5 * (0.5 * chord / radius).asin()).tan()
}

#[tokio::test]
async fn an_arc_by_its_radius_makes_the_program_of_the_same_arc_by_its_bulge() {
    let at = |x: f64, y: f64, radius: f64| json!({ "to": [x, y], "radius_mm": radius });
    let with = |mut arc: Value, name: &str, value: Value| {
        arc[name] = value;
        arc
    };
    for (by_radius, by_bulge) in [
        // A slot with round ends; the second arc leads to the first vertex.
        (
            json!([at(0.0, 0.0, 8.0), [40, 0], at(40.0, 16.0, 8.0), [0, 16]]),
            json!([[0, 0], [40, 0, 1], [40, 16], [0, 16, 1]]),
        ),
        // A shallow arc outward, and one inward.
        (
            json!([
                [0, 0],
                [40, 0],
                at(40.0, 20.0, 30.0),
                with(at(0.0, 20.0, 60.0), "direction", json!("cw"))
            ]),
            json!([[0, 0], [40, 0, bulge(20.0, 30.0)], [40, 20, -bulge(40.0, 60.0)], [0, 20]]),
        ),
        // A large arc: nearly a whole circle on a base of 10 mm.
        (
            json!([[0, 0], with(at(10.0, 0.0, 20.0), "large", json!(true))]),
            json!([[0, 0, 1.0 / bulge(10.0, 20.0)], [10, 0]]),
        ),
        // A radius that is rounded to three decimals, and short of the half circle by less than one of them.
        (json!([[0, 0], [40, 0], at(50.0, 17.0, 9.861)]), json!([[0, 0], [40, 0, 1], [50, 17]])),
    ] {
        let (found, expected) = (program(&by_radius).await, program(&by_bulge).await);
        let words = |text: &str| {
            text.lines().filter(|line| !line.contains("WARNING")).map(str::to_owned).collect::<Vec<_>>()
        };
        assert_eq!(words(&found), words(&expected), "{by_radius}");
    }
}

#[tokio::test]
async fn a_section_curve_makes_the_program_of_its_vertices() {
    let quarter = (std::f64::consts::PI / 8.0).tan();
    let text = json!("l(20,0) r(40,0,8) r(40,30,8) l(0,30) l(0,0)");
    let vertices = json!([[20, 0], [32, 0, quarter], [40, 8], [40, 22, quarter], [32, 30], [0, 30], [0, 0]]);
    assert_eq!(program(&text).await, program(&vertices).await);
    // The other way around, and closed by its author.
    let back = json!("l(20,0) l(0,0) l(0,30) r(40,30,8) r(40,0,8) l(20,0)");
    let vertices =
        json!([[20, 0], [0, 0], [0, 30], [32, 30, -quarter], [40, 22], [40, 8, -quarter], [32, 0]]);
    assert_eq!(program(&back).await, program(&vertices).await);
}

#[tokio::test]
async fn islands_and_emptied_places_take_all_forms() {
    let circle = json!([{ "to": [20, 20], "radius_mm": 5 }, { "to": [30, 20], "radius_mm": 5 }]);
    let body = |island: &Value, emptied: &Value| {
        json!({
            "region": { "boundary": "l(0,0) l(60,0) l(60,40) l(0,40)", "islands": [island] },
            "cleared": [{ "boundary": emptied }],
            "floor_z_mm": -4, "stepdown_max_mm": 4, "stepover_mm": 3,
            "tool": { "shape": "flat", "diameter_mm": 6 }, "patterns": ["zigzag_stock_offset"],
            "cutting": { "feed_mm_per_min": 800 },
        })
    };
    let square = json!([[40, 10], [50, 10], [50, 20], [40, 20]]);
    let app = app(&["--workers", "1"]);
    let mut texts = Vec::new();
    for (island, emptied) in [
        (&circle, &json!("l(40,10) l(50,10) l(50,20) l(40,20)")),
        (&json!([[20, 20, 1], [30, 20, 1]]), &square),
    ] {
        let answer =
            post(&app, &format!("{PLAN}?format=gcode"), body(island, emptied).to_string(), &[]).await;
        assert_eq!(answer.status, 200, "{}", answer.text());
        texts.push(answer.text());
    }
    assert_eq!(texts[0], texts[1]);
}

#[tokio::test]
async fn impossible_arcs_and_texts_are_refused_at_their_place() {
    let arc = |radius: f64| json!([[0, 0], [40, 0], { "to": [40, 16], "radius_mm": radius }, [0, 16]]);
    assert_eq!(planned(&arc(7.999_5)).await.status, 200, "rounded");
    let mut twice = arc(8.0);
    twice[1] = json!([40, 0, 0.5]);
    let mut closed = arc(8.0);
    closed[2]["to"] = json!([40, 0]);
    let mut large = arc(1e6);
    large[2]["large"] = json!(true);
    for (boundary, code, at) in [
        (arc(7.998), "out_of_range", "/2/radius_mm"),
        (arc(0.0), "out_of_range", "/2/radius_mm"),
        (arc(-8.0), "out_of_range", "/2/radius_mm"),
        (large, "out_of_range", "/2/radius_mm"),
        (twice, "conflict", "/1/2"),
        (closed, "coincident", "/2/to"),
        (json!([[0, 0], [40, 0], { "to": [40, 16] }]), "missing_field", "/2/radius_mm"),
        (json!([[0, 0], [40, 0], { "to": [40], "radius_mm": 8 }]), "wrong_length", "/2/to"),
        (json!([[0, 0], [40, 0], { "to": [40, 2e6], "radius_mm": 8 }]), "too_large", "/2/to/1"),
        (
            json!([[0, 0], [40, 0], { "to": [40, 16], "radius_mm": 8, "bulge": 1 }]),
            "unknown_field",
            "/2/bulge",
        ),
        (json!([[0, 0], [40, 0], 7]), "wrong_type", "/2"),
        (json!([[0, 0]]), "too_few_points", ""),
        (json!(7), "wrong_type", ""),
        (json!("l(0,0) l(40,0) x"), "syntax", ""),
        (json!("l(0,0) b((40,0),(50,10)) l(0,16)"), "unsupported", ""),
        (json!("l(0,0,0) l(40,0,0) l(40,16,0)"), "wrong_length", ""),
    ] {
        let answer = planned(&boundary).await;
        assert_eq!(answer.status, 422, "{boundary}: {}", answer.text());
        let violations = answer.violations();
        let expected = (code.to_owned(), format!("#/region/boundary{at}"));
        assert!(violations.contains(&expected), "{boundary}: {violations:?}");
    }
}

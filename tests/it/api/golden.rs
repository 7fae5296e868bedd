//! Programs of each operation in each dialect, as text: `tests/golden/<dialect>/<operation>`.
//!
//! Each text was read once by a person. `TOOLPATHD_WRITE_GOLDEN=1` writes them again.

use std::fs;
use std::path::{Path, PathBuf};

use serde_json::{Value, json};
use toolpathd_post::{DIALECTS, Dialect};

use super::support::{app, for_dialect, post};

/// One small example of each operation: its endpoint and its body.
const OPERATIONS: [(&str, &str, &str); 4] = [
    ("milling", "/v1/surfaces/mill", include_str!("../../../openapi/examples/surfaces-mill/one-pass.json")),
    ("pocket", "/v1/pockets/plan", include_str!("../../../openapi/examples/pockets-plan/circle.json")),
    (
        "curve",
        "/v1/curves/interpolate",
        include_str!("../../../openapi/examples/curves-interpolate/parabolas.json"),
    ),
    (
        "five-axes",
        "/v1/five-axis/smooth",
        include_str!("../../../openapi/examples/five-axis-smooth/corner.json"),
    ),
];

/// Longest text that is kept whole, and the lines kept of a longer one at its start and at its end.
const WHOLE: usize = 130;
const KEPT: [usize; 2] = [70, 30];

#[tokio::test]
async fn every_operation_has_its_golden_program_in_every_dialect() {
    let app = app(&["--workers", "1"]);
    for dialect in DIALECTS {
        for (operation, path, body) in OPERATIONS {
            let body: Value = serde_json::from_str(body).expect("JSON");
            let mut body = for_dialect(body, dialect);
            body["program"]["safe_home"] = json!(safe_home(dialect));
            let answer = post(&app, &format!("{path}?format=gcode"), body.to_string(), &[]).await;
            let is_written = operation != "five-axes"
                || dialect.five_axes.angles.is_some()
                || dialect.five_axes.has_positions;
            if !is_written {
                let violations: Vec<String> = answer.violations().into_iter().map(|(_, at)| at).collect();
                assert_eq!((answer.status.as_u16(), violations), (422, vec!["#/program/dialect".to_owned()]));
                continue;
            }
            assert_eq!(answer.status, 200, "{operation} {}: {}", dialect.name, answer.text());
            check(&golden(dialect, operation), &shortened(&answer.text()));
        }
    }
}

#[tokio::test]
async fn a_smooth_path_has_its_golden_rails() {
    let app = app(&["--workers", "1"]);
    let (_, path, body) = OPERATIONS[3];
    let body: Value = serde_json::from_str(body).expect("JSON");
    for dialect in DIALECTS.iter().filter(|dialect| dialect.five_axes.rails.is_some()) {
        let mut body = for_dialect(body.clone(), dialect);
        body["axis_output"] = json!("rails");
        let answer = post(&app, &format!("{path}?format=gcode"), body.to_string(), &[]).await;
        assert_eq!(answer.status, 200, "{}: {}", dialect.name, answer.text());
        check(&golden(dialect, "rails"), &shortened(&answer.text()));
    }
}

#[tokio::test]
async fn a_smooth_path_has_its_golden_program_of_switched_kinematics() {
    let app = app(&["--workers", "1"]);
    let (_, path, body) = OPERATIONS[3];
    let body: Value = serde_json::from_str(body).expect("JSON");
    let has_switch = |dialect: &&&Dialect| dialect.five_axes.switches_kinematics;
    assert_eq!(DIALECTS.iter().filter(has_switch).count(), 1);
    for dialect in DIALECTS.iter().filter(has_switch) {
        let mut body = for_dialect(body.clone(), dialect);
        body["axis_output"] = json!("angles");
        let answer = post(&app, &format!("{path}?format=gcode"), body.to_string(), &[]).await;
        assert_eq!(answer.status, 200, "{}: {}", dialect.name, answer.text());
        check(&golden(dialect, "kinematics"), &shortened(&answer.text()));
    }
}

/// The move home that a dialect has.
fn safe_home(dialect: &Dialect) -> &'static str {
    use toolpathd_core::toolpath::program::SafeHome;
    if dialect.abilities.safe_homes.contains(&SafeHome::G53) { "g53" } else { "none" }
}

fn golden(dialect: &Dialect, operation: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden").join(dialect.name);
    folder.join(format!("{operation}.{}", dialect.file_extension))
}

fn shortened(text: &str) -> String {
    let lines: Vec<&str> = text.lines().collect();
    if lines.len() <= WHOLE {
        return text.to_owned();
    }
    let [first, last] = KEPT;
    let gap = format!("... {} lines ...", lines.len() - first - last);
    [&lines[..first], &[gap.as_str()], &lines[lines.len() - last..]].concat().join("\n") + "\n"
}

fn check(golden: &Path, text: &str) {
    if std::env::var_os("TOOLPATHD_WRITE_GOLDEN").is_some() {
        fs::create_dir_all(golden.parent().expect("a folder")).expect("a folder");
        fs::write(golden, text).expect("a file");
    }
    let kept = fs::read_to_string(golden).unwrap_or_default();
    assert!(kept == text, "{} differs; see TOOLPATHD_WRITE_GOLDEN:\n{text}", golden.display());
}

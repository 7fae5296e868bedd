//! The answers that the contract shows equal the answers of the service.

use std::path::{Path, PathBuf};
use std::{env, fs};

use serde_json::Value;

use crate::api::support::{Answer, app, get, post};

/// If this environment variable is set, the test writes the answers instead of comparing them.
const WRITE: &str = "TOOLPATHD_WRITE_ANSWERS";

fn openapi() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("openapi")
}

/// Compares an answer with its file below `openapi/answers`.
fn compare(file: &str, answer: &Answer) {
    let path = openapi().join("answers").join(file);
    let text = match file.ends_with(".json") {
        true => format!("{:#}\n", answer.json()),
        false => answer.text(),
    };
    if env::var_os(WRITE).is_some() {
        fs::write(&path, text).expect("the answer can be written");
    } else {
        let committed = fs::read_to_string(&path).expect("an answer");
        assert!(committed == text, "openapi/answers/{file} is stale; run the test again with {WRITE}=1");
    }
}

#[tokio::test]
async fn the_answers_that_the_contract_shows_equal_those_of_the_service() {
    let app = app(&["--workers", "2"]);
    let id = ("x-request-id", "example");
    let mut n_answers = 0;
    for folder in fs::read_dir(openapi().join("answers")).expect("folders").map(|entry| entry.unwrap().path())
    {
        let endpoint = folder.file_name().unwrap().to_str().unwrap().to_owned();
        if endpoint == "service" {
            continue;
        }
        for file in fs::read_dir(&folder).expect("files").map(|entry| entry.unwrap().path()) {
            let name = file.file_stem().unwrap().to_str().unwrap();
            let body = fs::read(openapi().join("examples").join(&endpoint).join(format!("{name}.json")));
            let (extension, format) = match file.extension().unwrap().to_str() {
                Some("ngc") => ("ngc", "gcode"),
                _ => ("json", "json"),
            };
            let (noun, verb) = endpoint.rsplit_once('-').expect("a noun and a verb");
            let path = format!("/v1/{noun}/{verb}?format={format}");
            let answer = post(&app, &path, body.expect("a request"), &[id]).await;
            assert_eq!(answer.status, 200, "{path} refuses the example {name}");
            compare(&format!("{endpoint}/{name}.{extension}"), &answer);
            n_answers += 1;
        }
    }
    assert!(n_answers >= 10, "only {n_answers} answers were found");
    compare("service/dialects.json", &get(&app, "/v1/dialects").await);
    compare("service/machines.json", &get(&app, "/v1/machines").await);
    compare("service/limits.json", &get(&app, "/v1/limits").await);
    let path = openapi().join("examples/surfaces-mill/one-pass.json");
    let mut body: Value = serde_json::from_slice(&fs::read(path).expect("a request")).expect("JSON");
    body["tool"]["diameter_mm"] = (-6).into();
    let refused = post(&app, "/v1/surfaces/mill", body.to_string(), &[id]).await;
    assert_eq!(refused.code(), "invalid_request");
    compare("service/problem.json", &refused);
}

//! Sends every example of every endpoint, and asks for every form of answer and every dialect.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::sync::{Arc, Mutex};

use serde_json::{Value, json};
use tokio::sync::OnceCell;
use toolpathd_post::{DIALECTS, Dialect};
use toolpathd_server::http::{App, contract};

use super::support::{Answer, app, for_dialect, post};
use crate::openapi::schema;

/// An answer that is computed when it is asked for first.
type Known = Arc<OnceCell<Arc<Answer>>>;

/// The answers in JSON to all examples, by endpoint and name.
static ANSWERS: Mutex<BTreeMap<String, Known>> = Mutex::new(BTreeMap::new());

/// One file of `openapi/examples`: its endpoint, its name and its body.
struct Example {
    path: String,
    name: String,
    body: Value,
}

impl Example {
    /// The answer in JSON to a request with the id `one`. Several tests look at it, and it is computed once.
    async fn in_json(&self, app: &Arc<App>) -> Arc<Answer> {
        let Self { path, name, body } = self;
        let known =
            Known::clone(ANSWERS.lock().expect("no panic").entry(format!("{path} {name}")).or_default());
        let query = format!("{path}?format=json");
        let ask = async || Arc::new(post(app, &query, body.to_string(), &[("x-request-id", "one")]).await);
        Arc::clone(known.get_or_init(ask).await)
    }

    /// The endpoint that writes the program of the example, and its body for the dialects that can write the
    /// program: a leaning tool needs words for its axis. A path that takes long to plan is planned once, and
    /// `/v1/programs/write` writes it in every dialect.
    async fn written_in_dialects(&self, app: &Arc<App>) -> (&str, Vec<(&'static Dialect, String)>) {
        if !["/v1/surfaces/mill", "/v1/pockets/plan"].contains(&self.path.as_str()) {
            return (&self.path, self.in_dialects().collect());
        }
        let answer = self.in_json(app).await.json();
        let mut body = json!({ "toolpath": answer["toolpath"] });
        for member in ["tool", "cutting", "program", "meta"] {
            if let Some(value) = self.body.get(member) {
                body[member] = value.clone();
            }
        }
        let planned = Self { path: "/v1/programs/write".into(), name: self.name.clone(), body };
        ("/v1/programs/write", planned.in_dialects().collect())
    }

    /// The body for the dialects that can write its program.
    fn in_dialects(&self) -> impl Iterator<Item = (&'static Dialect, String)> {
        let leans = self.path.contains("five-axis") || self.name.contains("leaning");
        // The example of several operations has two tools, and a tool that goes on at another work offset.
        let has_several = self.body.get("further_operations").is_some();
        let all = DIALECTS.iter().copied();
        let able = all.filter(move |dialect| {
            (!leans || dialect.five_axes.has_positions || dialect.five_axes.angles.is_some())
                && (!has_several || dialect.changes_tools() && dialect.abilities.safe_homes.len() > 1)
        });
        able.map(|dialect| (dialect, for_dialect(self.body.clone(), dialect).to_string()))
    }
}

/// All examples. The folder `surfaces-mill` holds the bodies for `/v1/surfaces/mill`, and so on.
fn examples() -> Vec<Example> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("openapi/examples");
    let entries = |folder: &Path| {
        let mut paths: Vec<_> =
            fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry").path()).collect();
        paths.sort();
        paths
    };
    let stem = |path: &Path| path.file_stem().and_then(|stem| stem.to_str()).expect("a name").to_owned();
    let mut examples = Vec::new();
    for folder in entries(&root) {
        let (noun, verb) =
            stem(&folder).rsplit_once('-').map(|(n, v)| (n.to_owned(), v.to_owned())).expect("a path");
        // A folder may also hold NC programs.
        for file in entries(&folder).into_iter().filter(|file| file.extension().is_some_and(|e| e == "json"))
        {
            let text = fs::read_to_string(&file).expect("a text");
            let body = serde_json::from_str(&text).expect("JSON");
            examples.push(Example { path: format!("/v1/{noun}/{verb}"), name: stem(&file), body });
        }
    }
    assert!(examples.len() >= 8, "only {} examples were found", examples.len());
    examples
}

/// The example with the shortest body of each endpoint. These suffice for tests that do not depend on the
/// job.
fn short_examples() -> Vec<Example> {
    let mut shortest: BTreeMap<String, Example> = BTreeMap::new();
    let length = |example: &Example| example.body.to_string().len();
    for example in examples() {
        let known = shortest.get(&example.path);
        if known.is_none_or(|known| length(&example) < length(known)) {
            shortest.insert(example.path.clone(), example);
        }
    }
    shortest.into_values().collect()
}

/// The values of the query parameter `format` that the contract lists for `path`.
fn formats(document: &Value, path: &str) -> Vec<String> {
    let parameters = document["paths"][path]["post"]["parameters"].as_array().expect("parameters");
    let format = parameters.iter().find(|parameter| parameter["name"] == "format").expect("a format");
    let values = format["schema"]["enum"].as_array().expect("values");
    values.iter().map(|value| value.as_str().expect("a name").to_owned()).collect()
}

/// Fails unless an answer is a program in ASCII with a name for its file. `what` says which one it is.
fn assert_program(answer: &Answer, what: &str) {
    assert_eq!(answer.status, 200, "{what}: refused");
    assert_eq!(answer.header("content-type"), "text/x-gcode; charset=us-ascii", "{what}");
    let disposition = answer.header("content-disposition");
    assert!(
        disposition.starts_with("attachment; filename=\"") && disposition.ends_with('"'),
        "{what}: no file name: {disposition}"
    );
    assert!(answer.body.is_ascii(), "{what}: not ASCII");
}

/// Whether an endpoint answers with a toolpath.
fn is_path(path: &str) -> bool {
    !["/v1/surfaces/model", "/v1/surfaces/drop", "/v1/parts/inspect"].contains(&path)
}

#[test]
fn the_contract_shows_every_example_of_every_endpoint() {
    let document: Value = serde_json::from_str(&contract()).expect("JSON");
    let examples = examples();
    for (path, item) in document["paths"].as_object().expect("paths") {
        let Some(body) = item.pointer("/post/requestBody/content/application~1json") else { continue };
        let shown = body["examples"].as_object().unwrap_or_else(|| panic!("{path} shows no example"));
        let own: Vec<_> = examples.iter().filter(|example| example.path == *path).collect();
        assert_eq!(shown.len(), own.len(), "{path}: the number of examples in the contract");
        for example in own {
            assert_eq!(
                shown[&example.name]["value"], example.body,
                "{path}: the contract shows another body for {}",
                example.name
            );
        }
    }
}

#[tokio::test]
async fn every_example_is_answered_in_every_form_of_its_endpoint() {
    let app = app(&["--workers", "1"]);
    let document: Value = serde_json::from_str(&contract()).expect("JSON");
    for example in examples() {
        let Example { path, name, body } = &example;
        for format in formats(&document, path) {
            let (media_type, start) = match format.as_str() {
                "json" => ("application/json", "{\"engine_version\""),
                "gcode" => ("text/x-gcode", ""),
                "svg" => ("image/svg+xml", "<svg"),
                "html" => ("text/html", "<!DOCTYPE"),
                "glb" => ("model/gltf-binary", "glTF"),
                "stl" => ("model/stl", "binary STL"),
                "events" => ("text/event-stream", "event: progress"),
                other => panic!("the form {other} is not known to this test"),
            };
            let query = format!("{path}?format={format}");
            let by_query = match format.as_str() {
                "json" => example.in_json(&app).await,
                _ => {
                    let id = ("x-request-id", "one");
                    Arc::new(post(&app, &query, body.to_string(), &[id]).await)
                }
            };
            assert_eq!(by_query.status, 200, "{path} {name} {format}: refused");
            assert!(
                by_query.header("content-type").starts_with(media_type),
                "{path} {name} {format}: another media type"
            );
            assert!(by_query.body.starts_with(start.as_bytes()), "{path} {name} {format}: another beginning");
            if format == "gcode" && has_program(path) {
                assert_program(&by_query, &format!("{path} {name}"));
            }
        }
    }
}

#[tokio::test]
async fn the_accept_header_and_the_format_parameter_give_the_same_answer() {
    let app = app(&["--workers", "1"]);
    let document: Value = serde_json::from_str(&contract()).expect("JSON");
    for Example { path, name, body } in short_examples() {
        for format in formats(&document, &path) {
            let id = ("x-request-id", "one");
            let by_query = post(&app, &format!("{path}?format={format}"), body.to_string(), &[id]).await;
            let media_type = by_query.header("content-type").split(';').next().expect("a type").to_owned();
            let by_header = post(&app, &path, body.to_string(), &[("accept", &media_type), id]).await;
            assert_eq!(by_header.header("content-type"), by_query.header("content-type"));
            if format != "events" {
                assert_eq!(by_header.body, by_query.body, "{path} {name} {format}: another body");
            }
        }
    }
}

#[tokio::test]
async fn every_answer_in_json_obeys_the_contract() {
    let app = app(&["--workers", "1"]);
    let document: Value = serde_json::from_str(&contract()).expect("JSON");
    for example in examples() {
        let Example { path, name, body } = &example;
        let answer = example.in_json(&app).await;
        assert_eq!(answer.header("x-request-id"), "one");
        let json = answer.json();
        assert_eq!(json["engine_version"], env!("CARGO_PKG_VERSION"));
        assert!(json.get("request_id").is_none(), "{path} {name}: the same request would give other bytes");
        assert_eq!(json.get("meta"), body.get("meta"), "{path} {name}: meta is not returned");
        assert!(
            json["warnings"].is_array() && json["report"].is_object(),
            "{path} {name}: no warnings or no report"
        );
        let answered = &document["paths"][path]["post"]["responses"]["200"]["content"]["application/json"];
        let faults = schema::faults(&document, &answered["schema"], &json, "#");
        assert!(faults.is_empty(), "{path} {name}: the answer breaks its schema: {faults:#?}");
        let has_path = is_path(path);
        assert_eq!(json["measures"]["moves"]["line"].is_u64(), has_path, "{path} {name}: measures");
    }
}

#[tokio::test]
async fn an_answer_holds_its_toolpath_unless_the_query_says_toolpath_false() {
    let app = app(&["--workers", "1"]);
    for Example { path, name, body } in short_examples() {
        let query = format!("{path}?format=json");
        let has_path = is_path(&path);
        let whole = post(&app, &format!("{query}&toolpath=true"), body.to_string(), &[]).await.json();
        assert_eq!(
            whole["toolpath"]["passes"][0]["moves"][0]["kind"].is_string(),
            has_path,
            "{path} {name}: toolpath"
        );
        let bare = post(&app, &format!("{query}&toolpath=false"), body.to_string(), &[]).await.json();
        assert!(
            bare.get("toolpath").is_none() && bare["measures"] == whole["measures"],
            "{path} {name}: a toolpath, or other measures"
        );
    }
}

/// Whether an endpoint answers with a program. A program that is read or verified is not written again.
fn has_program(path: &str) -> bool {
    is_path(path) && !["/v1/programs/read", "/v1/programs/verify"].contains(&path)
}

#[tokio::test]
async fn every_example_becomes_an_ascii_program_in_every_dialect() {
    let app = app(&["--workers", "1"]);
    for example in examples().into_iter().filter(|example| has_program(&example.path)) {
        let Example { path, name, .. } = &example;
        let (written_by, bodies) = example.written_in_dialects(&app).await;
        for (dialect, body) in bodies {
            let answer = post(&app, &format!("{written_by}?format=gcode"), body, &[]).await;
            assert_program(&answer, &format!("{path} {name} {}", dialect.name));
        }
    }
}

#[tokio::test]
async fn a_program_is_the_same_under_every_media_type_for_programs() {
    let app = app(&["--workers", "1"]);
    for example in short_examples().into_iter().filter(|example| has_program(&example.path)) {
        let Example { path, name, body } = &example;
        let own = (path.as_str(), vec![("its own dialect", body.to_string())]);
        let (writing, bodies) = example.written_in_dialects(&app).await;
        let bodies = bodies.into_iter().map(|(dialect, body)| (dialect.name, body)).collect();
        for (path, bodies) in [own, (writing, bodies)] {
            for (dialect, body) in bodies {
                let by_query = post(&app, &format!("{path}?format=gcode"), body.clone(), &[]).await;
                assert_program(&by_query, &format!("{path} {name} {dialect}"));
                for media_type in ["text/x.gcode", "application/x-gcode", "text/plain"] {
                    let answer = post(&app, path, body.clone(), &[("accept", media_type)]).await;
                    assert_eq!(answer.header("content-type"), format!("{media_type}; charset=us-ascii"));
                    assert_eq!(answer.body, by_query.body, "{path} {name} {dialect}: another program");
                }
            }
        }
    }
}

/// What a program of decimals may cut deeper than its plan, and what a plan of a pocket is allowed, mm.
const VERIFIED_TOLERANCE_MM: f64 = 0.002;

/// Dialects in which the programs of examples are verified, one for each language.
const VERIFIED_DIALECTS: [&str; 4] = ["linuxcnc", "fanuc", "siemens", "heidenhain"];

impl Example {
    /// What its program is verified against. `None` where the part of the example is no part of a request to
    /// verify: measured heights, a surface within walls, a stock that is partly cleared, several regions; and
    /// for the wires of a paper, which gouge the part and report so.
    fn verified_against(&self) -> Option<Value> {
        let strategy = self.body.pointer("/strategy/kind").and_then(Value::as_str);
        let has = |member: &str| self.body.get(member).is_some();
        if has("heights") || has("cleared") || has("regions") || strategy == Some("wire_union") {
            return None;
        }
        let members: &[&str] = match self.path.as_str() {
            "/v1/surfaces/mill" => &["surface", "allowance_mm"],
            "/v1/pockets/plan" if !has("surface") => &["region", "top_z_mm", "floor_z_mm"],
            _ => return None,
        };
        let planned = self.body.get("tolerance_mm").and_then(Value::as_f64).unwrap_or(0.0);
        let mut against =
            json!({ "tool": self.body["tool"], "tolerance_mm": planned + VERIFIED_TOLERANCE_MM });
        for member in members.iter().filter(|member| has(member)) {
            against[*member] = self.body[*member].clone();
        }
        if self.body.pointer("/region/open").is_some() {
            self.open_in_front(&mut against);
        }
        Some(against)
    }

    /// Says what lies in front of open edges: a part whose pocket goes on there, and stock only in the
    /// region.
    fn open_in_front(&self, against: &mut Value) {
        let boundary = match self.name.rsplit('/').next() {
            Some("boss") => json!([[-30, -30], [130, -30], [130, 110], [-30, 110]]),
            Some("open-slot") => json!([[-30, 0], [110, 0], [110, 25], [-30, 25]]),
            _ => panic!("the test does not know what lies in front of {}", self.name),
        };
        let stock = self.body.get("stock").cloned().unwrap_or_else(|| {
            let (bottom, top) = (&self.body["floor_z_mm"], 0);
            let inside = &self.body["region"]["boundary"];
            json!({ "kind": "outline", "boundary": inside, "bottom_z_mm": bottom, "top_z_mm": top })
        });
        if let Some(top) = stock.pointer("/max/2") {
            against["top_z_mm"] = top.clone();
        }
        let islands = self.body.pointer("/region/islands").cloned().unwrap_or_else(|| json!([]));
        against["region"] = json!({ "boundary": boundary, "islands": islands });
        against["stock"] = stock;
    }
}

#[tokio::test]
async fn the_programs_of_examples_pass_their_own_verification() {
    let app = app(&[]);
    let mut n = 0;
    for example in examples() {
        let Some(against) = example.verified_against() else { continue };
        let (path, bodies) = example.written_in_dialects(&app).await;
        for (dialect, body) in bodies.into_iter().filter(|(own, _)| VERIFIED_DIALECTS.contains(&own.name)) {
            let what = format!("{} in {}", example.name, dialect.name);
            let written = post(&app, &format!("{path}?format=gcode"), body, &[]).await;
            assert_eq!(written.status, 200, "{what}: {}", written.text());
            let mut request = against.clone();
            request["nc"] = json!(written.text());
            request["dialect"] = json!(dialect.name);
            let answer = post(&app, "/v1/programs/verify", request.to_string(), &[]).await;
            assert_eq!(answer.status, 200, "{what}: {}", answer.text());
            let report = answer.json()["report"].clone();
            assert_eq!(report["verdict"], "pass", "{what}: {} {}", report["counts"], report["findings"][0]);
            n += 1;
        }
    }
    assert!(n >= 60, "only {n} programs were verified");
}

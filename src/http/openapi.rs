//! The contract, generated from the handlers and the wire types, and the routes it describes.

use std::collections::BTreeMap;
use std::sync::{Arc, LazyLock};

use axum::http::{HeaderValue, StatusCode, header};
use axum::response::{IntoResponse, Response};
use serde_json::{Map, Value, json};
use utoipa::OpenApi;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

use super::error::{PROBLEM_JSON, Problem};
use super::output::{EVENTS, JSON, Representation};
use super::{App, health, metrics, v1};

#[derive(OpenApi)]
#[openapi(
    info(
        title = "toolpathd",
        description = "Turns part data into CNC toolpaths and NC programs. Lengths in mm, feeds in mm/min, times in s. \
            Bodies may come with `Content-Encoding: gzip`, answers go with it where `Accept-Encoding` asks; the limit of \
            a body holds for what was coded."
    ),
    tags(
        (name = "curves", description = "Curves in the plane"),
        (name = "surfaces", description = "Sculptured surfaces"),
        (name = "programs", description = "NC programs"),
        (name = "service", description = "What this server accepts and speaks"),
        (name = "operation", description = "For supervisors and load balancers")
    ),
    components(schemas(Problem, super::events::Progress, super::dto::point::Point, super::dto::point::PlanePoint,
        super::dto::point::Position))
)]
struct Document;

const EVENTS_DESCRIPTION: &str = "While the computation runs, events `progress` (data: `Progress`): the beginning of \
    every stage, and at most ten a second within one. Then one event `result` (data: the JSON answer, on one line) or \
    `problem` (data: `Problem`). Comments keep a silent connection open. What is refused before the computation starts is \
    answered as a problem with its status.";

/// A request that is known to work, with the operation it is for.
macro_rules! example {
    ($path:literal, $folder:literal, $name:literal) => {
        ($path, $name, include_str!(concat!("../../openapi/examples/", $folder, "/", $name, ".json")))
    };
}

/// One folder for each operation.
const EXAMPLES: [(&str, &str, &str); 28] = [
    example!("/v1/arcs/fit", "arcs-fit", "contour"),
    example!("/v1/arcs/fit", "arcs-fit", "helix"),
    example!("/v1/arcs/fit", "arcs-fit", "probed-circle"),
    example!("/v1/arcs/fit", "arcs-fit", "section"),
    example!("/v1/arcs/fit", "arcs-fit", "sine"),
    example!("/v1/curves/interpolate", "curves-interpolate", "in-band"),
    example!("/v1/curves/interpolate", "curves-interpolate", "nurbs"),
    example!("/v1/curves/interpolate", "curves-interpolate", "parabolas"),
    example!("/v1/curves/interpolate", "curves-interpolate", "profile"),
    example!("/v1/curves/interpolate", "curves-interpolate", "sine"),
    example!("/v1/curves/interpolate", "curves-interpolate", "spline"),
    example!("/v1/surfaces/drop", "surfaces-drop", "bowl"),
    example!("/v1/surfaces/drop", "surfaces-drop", "bull-nose"),
    example!("/v1/surfaces/model", "surfaces-model", "cylinder"),
    example!("/v1/surfaces/model", "surfaces-model", "ferguson"),
    example!("/v1/surfaces/model", "surfaces-model", "normal-sweep"),
    example!("/v1/surfaces/model", "surfaces-model", "parallel-sweep"),
    example!("/v1/surfaces/model", "surfaces-model", "ruled"),
    example!("/v1/surfaces/mill", "surfaces-mill", "bezier-patches"),
    example!("/v1/surfaces/mill", "surfaces-mill", "cylinder"),
    example!("/v1/surfaces/mill", "surfaces-mill", "die"),
    example!("/v1/surfaces/mill", "surfaces-mill", "freeform"),
    example!("/v1/surfaces/mill", "surfaces-mill", "one-pass"),
    example!("/v1/surfaces/mill", "surfaces-mill", "wire-union"),
    example!("/v1/programs/write", "programs-write", "contour"),
    example!("/v1/programs/write", "programs-write", "inch-fanuc"),
    example!("/v1/programs/write", "programs-write", "one-line"),
    example!("/v1/programs/write", "programs-write", "parabolas"),
];

/// Statuses of failure that any operation can answer, and those of operations with a body.
const ANY_FAILURE: [StatusCode; 4] = [
    StatusCode::BAD_REQUEST,
    StatusCode::URI_TOO_LONG,
    StatusCode::REQUEST_HEADER_FIELDS_TOO_LARGE,
    StatusCode::INTERNAL_SERVER_ERROR,
];
const BODY_FAILURE: [StatusCode; 7] = [
    StatusCode::NOT_ACCEPTABLE,
    StatusCode::REQUEST_TIMEOUT,
    StatusCode::PAYLOAD_TOO_LARGE,
    StatusCode::UNSUPPORTED_MEDIA_TYPE,
    StatusCode::UNPROCESSABLE_ENTITY,
    StatusCode::SERVICE_UNAVAILABLE,
    StatusCode::GATEWAY_TIMEOUT,
];

/// Every route with its documentation.
pub fn routes() -> OpenApiRouter<Arc<App>> {
    OpenApiRouter::with_openapi(Document::openapi())
        .routes(routes!(v1::arcs_fit::fit_arcs, v1::arcs_fit::put_arcs))
        .routes(routes!(v1::curves_interpolate::interpolate_curve))
        .routes(routes!(v1::surfaces_drop::drop_cutter))
        .routes(routes!(v1::surfaces_mill::mill_surface))
        .routes(routes!(v1::surfaces_model::model_surface))
        .routes(routes!(v1::programs_write::write_program))
        .routes(routes!(v1::limits::get_limits))
        .routes(routes!(v1::dialects::list_dialects))
        .routes(routes!(health::livez))
        .routes(routes!(health::readyz))
        .routes(routes!(metrics::get_metrics))
        .routes(routes!(get_contract))
}

/// Every path that is answered.
pub fn paths() -> Vec<&'static str> {
    static PATHS: LazyLock<Vec<String>> =
        LazyLock::new(|| routes().into_openapi().paths.paths.into_keys().collect());
    PATHS.iter().map(String::as_str).collect()
}

/// The methods that a path answers; none for a path that the contract does not name.
pub fn methods(path: &str) -> Vec<String> {
    static METHODS: LazyLock<BTreeMap<String, Vec<String>>> = LazyLock::new(|| {
        let document = serde_json::to_value(routes().into_openapi().paths).unwrap_or_default();
        let of = |item: &Value| {
            item.as_object().into_iter().flat_map(Map::keys).map(|key| key.to_uppercase()).collect()
        };
        document.as_object().into_iter().flatten().map(|(path, item)| (path.clone(), of(item))).collect()
    });
    METHODS.get(path).cloned().unwrap_or_default()
}

/// This contract.
#[utoipa::path(get, path = "/openapi.json", operation_id = "getContract", tag = "service",
    responses((status = 200, description = "OpenAPI 3.1.", body = Object)))]
async fn get_contract() -> Response {
    ([(header::CONTENT_TYPE, HeaderValue::from_static(JSON))], contract()).into_response()
}

/// The contract as formatted JSON.
pub fn contract() -> String {
    let mut document = serde_json::to_value(routes().into_openapi()).unwrap_or_default();
    add_problems(&mut document);
    add_representations(&mut document);
    add_examples(&mut document);
    format!("{document:#}")
}

/// Gives every computing operation the forms of its answer: the media types of what its `format` names, and events.
/// The handler documents JSON alone.
fn add_representations(document: &mut Value) {
    document["components"]["headers"]["ReprDigest"] = json!({
        "description": "`sha-256=:...:` by RFC 9530, of the bytes that are sent: after content coding. Not with events.",
        "schema": { "type": "string", "pattern": "^sha-256=:[A-Za-z0-9+/]{43}=:$" },
    });
    document["components"]["headers"]["Warnings"] = json!({
        "description": "The codes of all `warnings`, with commas; absent where there are none, and with events.",
        "schema": { "type": "string" },
    });
    document["components"]["headers"]["ServerTiming"] = json!({
        "description": "Milliseconds in `queue`, `parse`, `compute` and `encode`. Not with events.",
        "schema": { "type": "string" },
    });
    let paths = document["paths"].as_object_mut();
    let operations = paths.into_iter().flat_map(|paths| paths.values_mut()).filter_map(Value::as_object_mut);
    for (_, post) in operations.flatten().filter(|(method, _)| ["post", "put"].contains(&method.as_str())) {
        let parameters = post["parameters"].as_array().into_iter().flatten();
        let format = parameters.clone().find(|parameter| parameter["name"] == "format");
        let Some(names) = format.and_then(|format| format["schema"]["enum"].as_array()).cloned() else {
            continue;
        };
        let answer = &mut post["responses"]["200"];
        for name in names {
            let Ok(offer) = serde_json::from_value::<Representation>(name) else { continue };
            for media_type in offer.media_types().iter().filter(|media_type| **media_type != JSON) {
                answer["content"][media_type] = json!({ "schema": { "type": "string" } });
            }
        }
        answer["content"][EVENTS] =
            json!({ "schema": { "type": "string", "description": EVENTS_DESCRIPTION } });
        answer["headers"]["repr-digest"] = json!({ "$ref": "#/components/headers/ReprDigest" });
        answer["headers"]["server-timing"] = json!({ "$ref": "#/components/headers/ServerTiming" });
        answer["headers"]["toolpathd-warnings"] = json!({ "$ref": "#/components/headers/Warnings" });
    }
}

/// Gives every operation the failures it can answer.
fn add_problems(document: &mut Value) {
    let headers = json!({
        "x-request-id": { "$ref": "#/components/headers/RequestId" },
        "x-engine-version": { "$ref": "#/components/headers/EngineVersion" },
    });
    document["components"]["headers"] = json!({
        "RequestId": {
            "description": "The id sent with the request, or else one made for it.",
            "schema": { "type": "string" },
        },
        "EngineVersion": {
            "description": "The same request to the same version gives the same bytes.",
            "schema": { "type": "string" },
        },
        "RetryAfter": { "description": "Whole seconds.", "schema": { "type": "integer", "minimum": 0 } },
    });
    let Some(paths) = document["paths"].as_object_mut() else { return };
    for (path, item) in paths {
        for operation in item.as_object_mut().into_iter().flat_map(|item| item.values_mut()) {
            let has_body = operation.get("requestBody").is_some();
            let extra: &[StatusCode] = match path.as_str() {
                _ if has_body => &BODY_FAILURE,
                "/readyz" => &[StatusCode::SERVICE_UNAVAILABLE],
                _ => &[],
            };
            let Some(responses) = operation["responses"].as_object_mut() else { continue };
            for response in responses.values_mut() {
                response["headers"] = headers.clone();
            }
            for status in ANY_FAILURE.iter().chain(extra) {
                let mut response = json!({
                    "description": status.canonical_reason(),
                    "headers": headers.clone(),
                    "content": { PROBLEM_JSON: { "schema": { "$ref": "#/components/schemas/Problem" } } },
                });
                if *status == StatusCode::SERVICE_UNAVAILABLE {
                    response["headers"]["retry-after"] = json!({ "$ref": "#/components/headers/RetryAfter" });
                }
                responses.insert(status.as_str().to_owned(), response);
            }
        }
    }
}

fn add_examples(document: &mut Value) {
    for (path, name, text) in EXAMPLES {
        let value: Value = serde_json::from_str(text).unwrap_or_default();
        let examples = &mut document["paths"][path]["post"]["requestBody"]["content"][JSON]["examples"];
        examples[name] = json!({ "value": value });
    }
}

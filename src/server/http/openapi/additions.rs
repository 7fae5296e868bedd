//! Adds the parts of the contract that all operations share: headers, problem documents and the forms of
//! answers. The handlers document only the JSON answer.

use axum::http::StatusCode;
use serde_json::{Map, Value, json};

use crate::http::error::PROBLEM_JSON;
use crate::http::request::multipart::FORM_DATA;
use crate::http::request::representation::{EVENTS, GLB, JSON, Representation, STL};

const EVENTS_DESCRIPTION: &str = "Events `progress` while the computation runs, with `Progress` as data: one event at the \
    beginning of every stage, and at most ten events a second within a stage. The last event is `result`, with the JSON answer on \
    one line as data, or `problem`, with `Problem` as data. Comments keep a silent connection open. A request that is refused \
    before the computation starts gets a problem with its own status instead of events.";

/// Statuses of failures that any operation can answer.
const ANY_FAILURE: [StatusCode; 4] = [
    StatusCode::BAD_REQUEST,
    StatusCode::URI_TOO_LONG,
    StatusCode::REQUEST_HEADER_FIELDS_TOO_LARGE,
    StatusCode::INTERNAL_SERVER_ERROR,
];
/// Further statuses of failures that operations with a body can answer.
const BODY_FAILURE: [StatusCode; 7] = [
    StatusCode::NOT_ACCEPTABLE,
    StatusCode::REQUEST_TIMEOUT,
    StatusCode::PAYLOAD_TOO_LARGE,
    StatusCode::UNSUPPORTED_MEDIA_TYPE,
    StatusCode::UNPROCESSABLE_ENTITY,
    StatusCode::SERVICE_UNAVAILABLE,
    StatusCode::GATEWAY_TIMEOUT,
];

/// Further statuses of failures when a program is sent to a control.
const SENDING_FAILURE: [StatusCode; 4] =
    [StatusCode::FORBIDDEN, StatusCode::NOT_FOUND, StatusCode::CONFLICT, StatusCode::BAD_GATEWAY];

/// The headers of answers, by their names in the `components` of the contract.
fn headers() -> Value {
    let text = |description: &str| json!({ "description": description, "schema": { "type": "string" } });
    json!({
        "RequestId": text("Id of the request: the id that was sent with the request, else a new id."),
        "EngineVersion": text("Version of the service. The same request to the same version gives the same bytes."),
        "RetryAfter": {
            "description": "Time after which the request may be sent again, in whole seconds.",
            "schema": { "type": "integer", "minimum": 0 },
        },
        "ReprDigest": {
            "description": "SHA-256 of the sent bytes, after compression: `sha-256=:...:` by RFC 9530. Absent with events.",
            "schema": { "type": "string", "pattern": "^sha-256=:[A-Za-z0-9+/]{43}=:$" },
        },
        "Warnings": text("Codes of all `warnings`, separated by commas. Absent where there are none, and with events."),
        "IdempotencyKey": text("The `Idempotency-Key` of the request. Absent where the request has none."),
        "JobOrderId": text(
            "The text `job_order_id` of the request's `meta`, with control characters, `%` and characters beyond ASCII \
             percent-encoded. Absent where `meta` has none, and with events."
        ),
        "ServerTiming": text("Milliseconds in `queue`, `parse`, `compute` and `encode`. Absent with events."),
    })
}

/// The header by which callers mark a request and its repetitions.
fn idempotency_key() -> Value {
    json!({
        "name": "Idempotency-Key",
        "in": "header",
        "description": "Your own key of this request. The answer repeats the key. The service keeps nothing: the same request \
            gives the same answer, with any key.",
        "schema": { "type": "string", "pattern": "^[!-~]([ -~]{0,253}[!-~])?$" },
    })
}

fn header(name: &str) -> Value {
    json!({ "$ref": format!("#/components/headers/{name}") })
}

/// Operations whose requests may refer to files, each with whether the part `job` is required.
const WITH_FILES: [(&str, bool); 6] = [
    ("/v1/parts/inspect", false),
    ("/v1/pockets/plan", true),
    ("/v1/programs/verify", true),
    ("/v1/surfaces/drop", true),
    ("/v1/surfaces/mill", true),
    ("/v1/surfaces/model", true),
];

/// Adds to an operation the body with files beside the job.
fn add_files(path: &str, operation: &mut Value) {
    let Some((_, needs_job)) = WITH_FILES.iter().find(|(own, _)| *own == path) else { return };
    let content = &mut operation["requestBody"]["content"];
    let mut job = content[JSON]["schema"].clone();
    job["description"] = "The request, as a body of JSON has it.".into();
    let mut schema = json!({
        "type": "object",
        "description": "The request in the part `job`, and files in parts of any other names.",
        "properties": { "job": job },
        "additionalProperties": { "type": "string", "format": "binary" },
    });
    if *needs_job {
        schema["required"] = json!(["job"]);
    }
    content[FORM_DATA] = json!({ "schema": schema, "encoding": { "job": { "contentType": JSON } } });
}

/// Adds headers, problems and the forms of answers to all operations.
pub fn add(document: &mut Value) {
    document["components"]["headers"] = headers();
    let Some(paths) = document["paths"].as_object_mut() else { return };
    for (path, item) in paths {
        for operation in item.as_object_mut().into_iter().flat_map(Map::values_mut) {
            for response in operation["responses"].as_object_mut().into_iter().flat_map(Map::values_mut) {
                response["headers"] = common_headers();
            }
            add_problems(path, operation);
            add_forms(operation);
            add_files(path, operation);
            let sent = operation.pointer_mut("/requestBody/content/text~1x-gcode/schema");
            // Bytes, because programs may hold characters of any code page: some generators cannot send text.
            sent.into_iter().for_each(|schema| schema["format"] = "binary".into());
        }
    }
}

fn common_headers() -> Value {
    json!({ "x-request-id": header("RequestId"), "x-engine-version": header("EngineVersion") })
}

/// Gives an operation the failures that the operation can answer.
fn add_problems(path: &str, operation: &mut Value) {
    let extra: &[StatusCode] = match path {
        _ if operation.get("requestBody").is_some() => &BODY_FAILURE,
        "/readyz" => &[StatusCode::SERVICE_UNAVAILABLE],
        _ => &[],
    };
    let sending: &[StatusCode] = if path == "/v1/dnc/{target}" { &SENDING_FAILURE } else { &[] };
    for status in ANY_FAILURE.iter().chain(extra).chain(sending) {
        let response = &mut operation["responses"][status.as_str()];
        *response = json!({
            "description": status.canonical_reason(),
            "headers": common_headers(),
            "content": { PROBLEM_JSON: { "schema": { "$ref": "#/components/schemas/Problem" } } },
        });
        if *status == StatusCode::SERVICE_UNAVAILABLE {
            response["headers"]["retry-after"] = header("RetryAfter");
        }
    }
}

/// Adds to a computing operation the other forms of its answer: the media types of all values of `format`,
/// and events.
fn add_forms(operation: &mut Value) {
    let mut parameters = operation["parameters"].as_array().into_iter().flatten();
    let format = parameters.find(|parameter| parameter["name"] == "format");
    let Some(names) = format.and_then(|format| format["schema"]["enum"].as_array()).cloned() else { return };
    let answer = &mut operation["responses"]["200"];
    let forms = names.iter().filter_map(|name| Representation::named(name.as_str()?));
    for media_type in forms.flat_map(Representation::media_types).filter(|media_type| **media_type != JSON) {
        // A file of bytes has no schema in JSON.
        let schema = if [GLB, STL].contains(media_type) {
            json!({})
        } else {
            json!({ "schema": { "type": "string" } })
        };
        answer["content"][media_type] = schema;
    }
    answer["content"][EVENTS] = json!({ "schema": { "type": "string", "description": EVENTS_DESCRIPTION } });
    answer["headers"]["repr-digest"] = header("ReprDigest");
    answer["headers"]["server-timing"] = header("ServerTiming");
    answer["headers"]["toolpathd-warnings"] = header("Warnings");
    answer["headers"]["toolpathd-job-order-id"] = header("JobOrderId");
    answer["headers"]["idempotency-key"] = header("IdempotencyKey");
    if let Some(parameters) = operation["parameters"].as_array_mut() {
        parameters.push(idempotency_key());
    }
}

/// Tidies all descriptions: the description of a member that may be null moves beside the member's
/// alternatives, defaults move into descriptions, and every paragraph becomes one line.
pub fn tidy(value: &mut Value) {
    match value {
        Value::Object(members) => {
            hoist(members);
            if let Some(Value::String(text)) = members.get_mut("description") {
                let paragraphs = text.split("\n\n").map(|paragraph| paragraph.replace('\n', " "));
                *text = paragraphs.collect::<Vec<_>>().join("\n\n");
            }
            if let Some(Value::Object(properties)) = members.get_mut("properties") {
                properties.values_mut().for_each(tell_default);
            }
            members
                .iter_mut()
                .filter(|(name, _)| !name.starts_with("example"))
                .for_each(|(_, value)| tidy(value));
        }
        Value::Array(items) => items.iter_mut().for_each(tidy),
        _ => {}
    }
}

/// Moves the default of a member into its description. Generators of clients take a member with a default for
/// one that is always there, in requests too.
fn tell_default(member: &mut Value) {
    let Some(member) = member.as_object_mut() else { return };
    let Some(default) = member.remove("default") else { return };
    let text = member.get("description").and_then(Value::as_str).unwrap_or_default();
    if !text.contains("Default") {
        let default = default.as_str().map_or_else(|| default.to_string(), str::to_owned);
        let told = format!("{text} Default: `{default}`.");
        member.insert("description".to_owned(), told.trim_start().into());
    }
}

/// Moves the description of an optional reference out of the reference, where the generator leaves it.
fn hoist(members: &mut Map<String, Value>) {
    let items = members.get_mut("oneOf").and_then(Value::as_array_mut).into_iter().flatten();
    let found = items.filter_map(Value::as_object_mut).filter(|item| item.contains_key("$ref"));
    let found: Vec<Value> = found.filter_map(|item| item.remove("description")).collect();
    if let Some(description) = found.into_iter().next() {
        members.insert("description".to_owned(), description);
    }
}

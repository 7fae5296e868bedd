//! The decoders of all requests agree with the contract. Bodies are changed in one place at a time.
//!
//! One disagreement is known and harmless: serde takes a name also as an object with a `null`, such as
//! `{"ball": null}`.

use std::fs;
use std::path::Path as File;

use serde_json::{Map, Value, json};
use utoipa::openapi::schema::{AdditionalProperties, OneOf, Schema, Type};
use utoipa::openapi::{Ref, RefOr};

use crate::config::Limits;
use crate::http::decode::IntoJob;
use crate::http::decode::check::Violations;
use crate::http::decode::contract::{Checked, Contract, items, range, type_of};
use crate::http::decode::object::Object;
use crate::http::dto::arc_fitting::FitRequest;
use crate::http::dto::dropping::DropRequest;
use crate::http::dto::five_axis::SmoothRequest;
use crate::http::dto::interpolation::InterpolateRequest;
use crate::http::dto::milling::MillRequest;
use crate::http::dto::modelling::ModelRequest;
use crate::http::dto::pocketing::PocketRequest;
use crate::http::dto::program_reading::ReadRequest;
use crate::http::dto::program_writing::WriteRequest;
use crate::http::dto::verification::VerifyRequest;
use crate::http::error::{FieldCode, FieldError};
use crate::http::pointer::Pointer;
use toolpathd_core::budget::Budget;

/// The most kinds of a union.
const MOST_KINDS: usize = 7;

/// The most elements of an array in a body: those of a row of a Bezier patch. More elements of the same type
/// would only take time.
const MOST_ELEMENTS: usize = 4;

/// What a value is replaced by: all types of JSON, and numbers that no or few schemas allow.
fn replacements() -> Vec<Value> {
    vec![
        json!(null),
        json!(true),
        json!(7),
        json!(7.0),
        json!(-1),
        json!(1.5),
        json!(-0.0),
        json!(5_000_000_000_u64),
        json!(u64::MAX),
        json!(1e300),
        json!("x"),
        json!(""),
        json!([]),
        json!([null]),
        json!([1, 2]),
        json!(["x", "x"]),
        json!([[1, 2], [3, 4]]),
        json!({}),
        json!({ "kind": "x" }),
        json!({ "kind": null }),
        json!({ "own": null }),
    ]
}

/// What is done to one value of a body.
enum Change {
    Replace(Value),
    Remove,
    /// A member gets another name.
    Misspell,
    /// A text or a name gets one more letter.
    Lengthen,
    /// An object gets one more member.
    Add(Value),
    /// An array gets one more element.
    Push(Value),
    /// An array loses its last element.
    Pop,
    /// An object becomes the array of its values.
    Flatten,
}

/// The changes of the value at a place.
fn changes(value: &Value) -> Vec<Change> {
    let mut changes = vec![Change::Remove, Change::Misspell];
    changes.extend(replacements().into_iter().map(Change::Replace));
    match value {
        Value::String(_) => changes.push(Change::Lengthen),
        Value::Object(_) => {
            changes.extend([Change::Add(json!(1)), Change::Add(json!(null)), Change::Flatten]);
        }
        Value::Array(elements) => {
            changes.extend([Change::Pop, Change::Push(json!(null))]);
            changes.extend(elements.last().cloned().map(Change::Push));
        }
        Value::Null | Value::Bool(_) | Value::Number(_) => {}
    }
    changes
}

/// The places of a body, as pointers without `#`: all members of objects, and the first and the last element
/// of each array. No name in a body needs escapes.
fn places(value: &Value, at: &str, found: &mut Vec<String>) {
    found.push(at.to_owned());
    match value {
        Value::Object(members) => {
            members.iter().for_each(|(name, member)| places(member, &format!("{at}/{name}"), found));
        }
        Value::Array(elements) => {
            let last = elements.len().saturating_sub(1);
            let ends = elements.iter().enumerate().filter(|(k, _)| [0, last].contains(k));
            ends.for_each(|(k, element)| places(element, &format!("{at}/{k}"), found));
        }
        _ => {}
    }
}

/// The changed body, and the place that is to blame. `None` where the change does not apply.
fn changed(body: &Value, place: &str, change: &Change) -> Option<(Value, String)> {
    let mut body = body.clone();
    let mut blamed = place.to_owned();
    match change {
        Change::Replace(value) => *body.pointer_mut(place)? = value.clone(),
        Change::Remove | Change::Misspell => {
            let (parent, name) = place.rsplit_once('/')?;
            let parent_at = parent.to_owned();
            let parent = body.pointer_mut(parent)?.as_object_mut()?;
            let value = parent.remove(name)?;
            if matches!(change, Change::Misspell) {
                parent.insert(format!("{name}x"), value);
                // The member is missing, and its wrong name is unknown.
                blamed = parent_at;
            }
        }
        Change::Lengthen => {
            let text = format!("{}x", body.pointer(place)?.as_str()?);
            *body.pointer_mut(place)? = text.into();
        }
        Change::Add(value) => {
            body.pointer_mut(place)?.as_object_mut()?.insert("extra".to_owned(), value.clone());
            blamed = format!("{place}/extra");
        }
        Change::Push(value) => body.pointer_mut(place)?.as_array_mut()?.push(value.clone()),
        Change::Pop => {
            body.pointer_mut(place)?.as_array_mut()?.pop()?;
        }
        Change::Flatten => {
            let members = body.pointer(place)?.as_object()?.values().cloned().collect();
            *body.pointer_mut(place)? = Value::Array(members);
        }
    }
    Some((body, blamed))
}

fn decoded<T: IntoJob>(body: &Value) -> Option<T> {
    decoded_text(&body.to_string())
}

fn decoded_text<T: IntoJob>(text: &str) -> Option<T> {
    serde_json::from_str::<Object<T>>(text).ok().map(|Object(request)| request)
}

/// Whether `pointer` leads to `place` or to a value inside it.
fn is_within(pointer: &str, place: &str) -> bool {
    let at = place.split('/').skip(1).fold(Pointer::root(), |at, name| at.field(name));
    let rest = pointer.strip_prefix(at.as_str());
    rest.is_some_and(|rest| rest.is_empty() || rest.starts_with('/'))
}

/// The codes of violations that no rule of a request can find, because the decoder refuses the body.
const OF_TYPES: [FieldCode; 4] =
    [FieldCode::MissingField, FieldCode::UnknownField, FieldCode::WrongType, FieldCode::UnknownValue];

/// The violations of a body, and the body as the decoder needs it.
fn checked(contract: &Contract, body: &Value) -> (Violations, String) {
    let (text, budget) = (body.to_string(), Budget::unlimited());
    let Checked { violations, .. } = contract.check(&text, &budget).expect("JSON");
    (violations, contract.written(&text, &budget).expect("JSON"))
}

/// Checks the laws of one body, made by a change at `blamed`. `is_job` says that no rule refused the body
/// before the change.
fn judge<T: IntoJob>(contract: &Contract, body: &Value, blamed: &str, is_job: bool) -> Result<(), String> {
    let (violations, written) = checked(contract, body);
    let is_clean = violations.total() == 0;
    let found = violations.into_error().errors().to_vec();
    let request = decoded_text::<T>(&written);
    if request.is_none() && is_clean {
        return Err("the decoder refuses the body, and no violation is found".into());
    }
    if decoded::<T>(body).is_some() && request.is_none() {
        return Err(format!("the decoder takes the body, and the pass makes it illegal: {found:?}"));
    }
    if let Some(error) = found.iter().find(|error| !is_within(&error.pointer, blamed)) {
        return Err(format!("{} is blamed: {}", error.pointer, error.detail));
    }
    let Some(request) = request.filter(|_| !is_clean) else { return Ok(()) };
    if let Some(error) = found.iter().find(|error| OF_TYPES.contains(&error.code)) {
        return Err(format!("the decoder takes what the contract forbids: {error:?}"));
    }
    // The contract forbids what the decoder takes, so a rule of the request must refuse it.
    let refused = match request.into_job(&Limits::DEFAULT) {
        Ok(_) => Vec::new(),
        Err(error) => error.errors().to_vec(),
    };
    let is_refused = |error: &FieldError| {
        refused.iter().any(|rule| (&rule.pointer, rule.code) == (&error.pointer, error.code))
    };
    match found.iter().find(|error| is_job && !is_refused(error)) {
        Some(error) => Err(format!("only the contract forbids {error:?}; the rules: {refused:?}")),
        None => Ok(()),
    }
}

/// What was found about all bodies of a request.
#[derive(Default)]
struct Tally {
    n_bodies: usize,
    /// Number of bodies that no rule refuses before a change.
    n_jobs: usize,
    faults: Vec<String>,
}

/// Checks a legal body and all bodies that one change makes of it.
fn judge_all<T: IntoJob>(contract: &Contract, body: &Value, name: &str, tally: &mut Tally) {
    let found = checked(contract, body).0.into_error();
    let Some(request) = decoded::<T>(body).filter(|_| found.errors().is_empty()) else {
        let error = serde_json::from_str::<Object<T>>(&body.to_string()).err();
        tally.faults.push(format!("{name} is not legal: {error:?}, {found:?}"));
        return;
    };
    let is_job = request.into_job(&Limits::DEFAULT).is_ok();
    tally.n_jobs += usize::from(is_job);
    let mut all = Vec::new();
    places(body, "", &mut all);
    for place in all {
        for change in changes(body.pointer(&place).expect("a place")) {
            let Some((body, blamed)) = changed(body, &place, &change) else { continue };
            tally.n_bodies += 1;
            if let Err(fault) = judge::<T>(contract, &body, &blamed, is_job) {
                let now = body.pointer(&place).map(Value::to_string).unwrap_or_default();
                tally.faults.push(format!("{name}{place} = {now:.60}: {fault}"));
            }
        }
    }
}

/// Shortens all arrays.
fn shorten(value: &mut Value) {
    match value {
        Value::Array(elements) => {
            elements.truncate(MOST_ELEMENTS);
            elements.iter_mut().for_each(shorten);
        }
        Value::Object(members) => members.values_mut().for_each(shorten),
        _ => {}
    }
}

/// A body with all members that the schema has. Of a union it has kind number `choice`.
fn full(contract: &Contract, schema: &RefOr<Schema>, choice: usize) -> Value {
    let (_, schema) = contract.resolved(schema).expect("every reference has a schema");
    match schema {
        Schema::Array(array) => {
            let element = full(contract, items(array).expect("elements"), choice);
            Value::Array(vec![element; array.min_items.unwrap_or(1).max(1)])
        }
        Schema::OneOf(OneOf { discriminator: Some(kinds), .. }) => {
            let (kind, target) = kinds.mapping.iter().nth(choice % kinds.mapping.len()).expect("a kind");
            let mut object = full(contract, &RefOr::Ref(Ref::new(target)), choice);
            object[kinds.property_name.as_str()] = kind.as_str().into();
            object
        }
        Schema::Object(object) => match type_of(&object.schema_type) {
            Type::Object => {
                let member = |(name, schema): (&String, &RefOr<Schema>)| {
                    (name.clone(), full(contract, schema, choice))
                };
                let mut members: Map<String, Value> = object.properties.iter().map(member).collect();
                if let Some(AdditionalProperties::RefOr(schema)) = object.additional_properties.as_deref() {
                    members.insert("own".to_owned(), full(contract, schema, choice));
                }
                Value::Object(members)
            }
            Type::String => match &object.enum_values {
                Some(names) => names[0].clone(),
                None => "text".into(),
            },
            Type::Integer => json!(range(object).min as i64),
            Type::Number => json!(range(object).min.max(0.0)),
            Type::Boolean => true.into(),
            Type::Array | Type::Null => panic!("a schema without a type"),
        },
        _ => panic!("a schema of another form"),
    }
}

/// Checks a request with the examples in a folder, and with bodies that have all members.
fn check<T: IntoJob>(folder: &str) {
    let contract = Contract::of::<T>();
    let examples = File::new(env!("CARGO_MANIFEST_DIR")).join("../../openapi/examples").join(folder);
    let mut bodies = Vec::new();
    for file in fs::read_dir(examples).expect("examples").map(|entry| entry.expect("a file").path()) {
        if file.extension().is_some_and(|extension| extension == "json") {
            let text = fs::read_to_string(&file).expect("an example");
            let mut body: Value = serde_json::from_str(&text).expect("JSON");
            shorten(&mut body);
            bodies.push((file.file_stem().expect("a name").to_string_lossy().into_owned(), body));
        }
    }
    assert!(bodies.len() >= 2, "only {} examples were found", bodies.len());
    bodies.extend((0..MOST_KINDS).map(|k| (format!("full {k}"), full(&contract, &contract.request, k))));
    let mut tally = Tally::default();
    for (name, body) in bodies {
        judge_all::<T>(&contract, &body, &name, &mut tally);
    }
    let Tally { n_bodies, n_jobs, mut faults } = tally;
    faults.truncate(40);
    assert!(faults.is_empty(), "{}", faults.join("\n"));
    assert!(n_bodies > 1000, "only {n_bodies} bodies were checked");
    assert!(n_jobs > 0, "no body without a change is a job");
}

macro_rules! agreement {
    ($($name:ident: $request:ty, $folder:literal;)+) => {
        $(#[test]
        fn $name() {
            check::<$request>($folder);
        })+
    };
}

agreement! {
    fitting_arcs_agrees_with_its_schema: FitRequest, "arcs-fit";
    interpolating_agrees_with_its_schema: InterpolateRequest, "curves-interpolate";
    smoothing_agrees_with_its_schema: SmoothRequest, "five-axis-smooth";
    pockets_agree_with_their_schema: PocketRequest, "pockets-plan";
    reading_agrees_with_its_schema: ReadRequest, "programs-read";
    verifying_agrees_with_its_schema: VerifyRequest, "programs-verify";
    writing_agrees_with_its_schema: WriteRequest, "programs-write";
    dropping_agrees_with_its_schema: DropRequest, "surfaces-drop";
    milling_agrees_with_its_schema: MillRequest, "surfaces-mill";
    modelling_agrees_with_its_schema: ModelRequest, "surfaces-model";
}

#[test]
fn an_array_of_the_values_of_its_members_is_no_object() {
    let pose = json!([[0, 0, 0], [0, 0, 1], 100, false]);
    let smooth = json!({ "tolerance_mm": 0.1, "tolerance_deg": 1, "path": [pose, pose] });
    assert!(decoded::<SmoothRequest>(&smooth).is_none());
    let rotary = json!([null, null, null, false, false]);
    let smooth =
        json!({ "tolerance_mm": 0.1, "tolerance_deg": 1, "machine": { "rotary": [rotary, rotary] } });
    assert!(decoded::<SmoothRequest>(&smooth).is_none());
    let write = json!({ "toolpath": { "start": [0, 0, 0], "passes": [[1, null, []]] } });
    assert!(decoded::<WriteRequest>(&write).is_none());
}

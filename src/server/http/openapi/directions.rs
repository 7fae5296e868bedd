//! Gives requests and answers schemas of their own where they differ in `null`. A request may send `null` for
//! an optional member, as the decoder reads it: the member counts as absent. An answer leaves an optional
//! member out, and never sends `null` for it; a member of an answer that may be `null` is required.
//!
//! # Method
//! Each type is defined once, in Rust. Schemas that only requests or only answers reach change in place. Of a
//! schema that both reach, and that differs, answers keep the name, and requests get a copy with the name
//! `Given` in front: `GivenLineMove` beside `LineMove`. A schema also differs where it refers to one that
//! does.

use std::collections::BTreeSet;

use serde_json::{Map, Value, json};

/// The beginning of the names of schemas that only requests use.
const GIVEN: &str = "Given";

/// The place of all schemas in the contract.
const SCHEMAS: &str = "#/components/schemas/";

/// Gives requests and answers each the schemas that they obey.
pub fn tell_apart(document: &mut Value) {
    let Some(Value::Object(schemas)) = document.pointer("/components/schemas").cloned() else { return };
    let sent = reached(&schemas, parts(document, "requestBody"));
    let mut answered = reached(&schemas, parts(document, "responses"));
    // A schema that no operation names describes a part of an answer, such as an event.
    answered.extend(schemas.keys().filter(|name| !sent.contains(*name)).cloned());
    let answers = changed(&schemas, &answered, forbid_null);
    let mut requests = changed(&schemas, &sent, let_optional_members_be_null);
    let apart = apart(&requests, &answers);
    requests.values_mut().for_each(|schema| rename(schema, &apart));
    let items = document["paths"].as_object_mut().into_iter().flat_map(Map::values_mut);
    for operation in items.filter_map(Value::as_object_mut).flat_map(Map::values_mut) {
        operation.get_mut("requestBody").into_iter().for_each(|body| rename(body, &apart));
    }
    let mut all = answers;
    for (name, schema) in requests {
        all.insert(if apart.contains(&name) { format!("{GIVEN}{name}") } else { name }, schema);
    }
    document["components"]["schemas"] = all.into();
}

/// A part of every operation that has the part.
fn parts<'a>(document: &'a Value, name: &'a str) -> impl Iterator<Item = &'a Value> {
    let items = document["paths"].as_object().into_iter().flat_map(Map::values);
    items.filter_map(Value::as_object).flat_map(Map::values).filter_map(move |operation| operation.get(name))
}

/// The names of all schemas to which the parts refer, and to which these schemas refer in turn.
fn reached<'a>(schemas: &Map<String, Value>, parts: impl Iterator<Item = &'a Value>) -> BTreeSet<String> {
    let mut open = Vec::new();
    parts.for_each(|part| gather_references(part, &mut open));
    let mut done = BTreeSet::new();
    while let Some(name) = open.pop() {
        if done.insert(name.clone()) {
            schemas.get(&name).into_iter().for_each(|schema| gather_references(schema, &mut open));
        }
    }
    done
}

/// The schemas with these names, changed.
fn changed(
    schemas: &Map<String, Value>,
    names: &BTreeSet<String>,
    change: impl Fn(&mut Value),
) -> Map<String, Value> {
    let mut all = Map::new();
    for (name, schema) in schemas.iter().filter(|(name, _)| names.contains(*name)) {
        let mut schema = schema.clone();
        change(&mut schema);
        all.insert(name.clone(), schema);
    }
    all
}

/// The names of the schemas that differ between requests and answers.
fn apart(requests: &Map<String, Value>, answers: &Map<String, Value>) -> BTreeSet<String> {
    let shared = || requests.iter().filter_map(|(name, sent)| Some((name, sent, answers.get(name)?)));
    let mut apart: BTreeSet<String> =
        shared().filter(|(_, sent, answered)| sent != answered).map(|(name, ..)| name.clone()).collect();
    // Each round but the last adds a name.
    loop {
        let refers = |schema: &Value| {
            let mut names = Vec::new();
            gather_references(schema, &mut names);
            names.iter().any(|name| apart.contains(name))
        };
        let further: Vec<String> = shared()
            .filter(|(name, sent, _)| !apart.contains(*name) && refers(sent))
            .map(|(name, ..)| name.clone())
            .collect();
        if further.is_empty() {
            return apart;
        }
        apart.extend(further);
    }
}

/// The names of all schemas that a part of the contract refers to.
fn gather_references(value: &Value, names: &mut Vec<String>) {
    match value {
        Value::Object(members) => {
            let name = members.get("$ref").and_then(Value::as_str).and_then(|place| place.rsplit('/').next());
            names.extend(name.map(str::to_owned));
            members.values().for_each(|value| gather_references(value, names));
        }
        Value::Array(items) => items.iter().for_each(|value| gather_references(value, names)),
        _ => {}
    }
}

/// Lets all references to schemas with these names refer to the schemas of requests. A discriminator states
/// places of schemas without `$ref`.
fn rename(value: &mut Value, names: &BTreeSet<String>) {
    match value {
        Value::String(place) => {
            if let Some(name) = place.strip_prefix(SCHEMAS).filter(|name| names.contains(*name)) {
                *place = format!("{SCHEMAS}{GIVEN}{name}");
            }
        }
        Value::Object(members) => members.values_mut().for_each(|value| rename(value, names)),
        Value::Array(items) => items.iter_mut().for_each(|value| rename(value, names)),
        _ => {}
    }
}

/// Whether a member of an object need not be there.
fn is_optional(required: &Value, name: &str) -> bool {
    required.as_array().is_none_or(|names| !names.contains(&json!(name)))
}

/// Lets every optional member of a request be `null`, as the decoder does: such a member counts as absent.
fn let_optional_members_be_null(schema: &mut Value) {
    let required = schema["required"].clone();
    let properties = schema.get_mut("properties").and_then(Value::as_object_mut);
    let optional = properties.into_iter().flatten().filter(|(name, _)| is_optional(&required, name));
    optional.for_each(|(_, member)| let_be_null(member));
    schema.get_mut("additionalProperties").into_iter().for_each(let_be_null);
}

/// Adds `null` to what a schema allows. The description and the default stay beside the alternatives.
fn let_be_null(schema: &mut Value) {
    let nothing = json!({ "type": "null" });
    let Some(members) = schema.as_object_mut() else { return };
    if let Some(reference) = members.remove("$ref") {
        members.insert("oneOf".to_owned(), json!([{ "$ref": reference }, nothing]));
    } else if let Some(alternatives) = members.get_mut("oneOf").and_then(Value::as_array_mut) {
        if !alternatives.contains(&nothing) {
            alternatives.push(nothing);
        }
    } else if let Some(Value::String(own)) = members.get("type") {
        let types = json!([own, "null"]);
        members.insert("type".to_owned(), types);
    }
}

/// Removes `null` from what the optional members of all objects in an answer's schema allow.
fn forbid_null(schema: &mut Value) {
    match schema {
        Value::Object(members) => {
            let required = members.get("required").cloned().unwrap_or_default();
            let properties = members.get_mut("properties").and_then(Value::as_object_mut);
            let optional = properties.into_iter().flatten().filter(|(name, _)| is_optional(&required, name));
            optional.for_each(|(_, member)| remove_null(member));
            members.values_mut().for_each(forbid_null);
        }
        Value::Array(items) => items.iter_mut().for_each(forbid_null),
        _ => {}
    }
}

/// Removes `null` from what a schema allows. Where one alternative is left, the schema becomes that
/// alternative, with its own description.
fn remove_null(schema: &mut Value) {
    let Some(members) = schema.as_object_mut() else { return };
    if let Some(Value::Array(types)) = members.get_mut("type") {
        types.retain(|name| name != "null");
        if let [own] = types.as_slice() {
            let own = own.clone();
            members.insert("type".to_owned(), own);
        }
    }
    let Some(Value::Array(alternatives)) = members.get_mut("oneOf") else { return };
    alternatives.retain(|alternative| *alternative != json!({ "type": "null" }));
    if let [Value::Object(only)] = alternatives.as_slice() {
        let only = only.clone();
        members.remove("oneOf");
        for (name, value) in only {
            members.entry(name).or_insert(value);
        }
    }
}

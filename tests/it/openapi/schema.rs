//! Checks whether a value obeys a schema, for the part of JSON Schema that the contract uses.

use serde_json::Value;

/// The faults of `value` by `schema`; empty if it has none. `at` is the pointer to the value, for the texts.
pub fn faults(document: &Value, schema: &Value, value: &Value, at: &str) -> Vec<String> {
    let mut found = Vec::new();
    if let Some(target) = schema["$ref"].as_str() {
        let target = document.pointer(target.trim_start_matches('#')).expect("a schema");
        found.extend(faults(document, target, value, at));
    }
    if let Some(options) = schema["oneOf"].as_array() {
        let tried: Vec<_> = options.iter().map(|option| faults(document, option, value, at)).collect();
        let n_fitting = tried.iter().filter(|faults| faults.is_empty()).count();
        if n_fitting != 1 {
            found.push(format!("{at} fits {n_fitting} of {} schemas: {tried:?}", options.len()));
        }
    }
    for part in schema["allOf"].as_array().into_iter().flatten() {
        found.extend(faults(document, part, value, at));
    }
    let types: Vec<&str> = match &schema["type"] {
        Value::String(name) => vec![name],
        Value::Array(names) => names.iter().filter_map(Value::as_str).collect(),
        _ => Vec::new(),
    };
    if !types.is_empty() && !types.iter().any(|name| is_of_type(value, name)) {
        found.push(format!("{at} must be of type {types:?}: {value}"));
    }
    if schema["enum"].as_array().is_some_and(|names| !names.contains(value)) {
        found.push(format!("{at} must be one of {}: {value}", schema["enum"]));
    }
    let size = match value {
        Value::String(text) => Some((text.chars().count() as f64, "minLength", "maxLength")),
        Value::Array(items) => Some((items.len() as f64, "minItems", "maxItems")),
        Value::Object(members) => Some((members.len() as f64, "minProperties", "maxProperties")),
        Value::Number(number) => Some((number.as_f64().expect("a number"), "minimum", "maximum")),
        Value::Null | Value::Bool(_) => None,
    };
    if let Some((size, least, most)) = size {
        let is_below = schema[least].as_f64().is_some_and(|least| size < least);
        let is_above = schema[most].as_f64().is_some_and(|most| size > most);
        if is_below || is_above {
            found.push(format!("{at} is outside {}..={}", schema[least], schema[most]));
        }
    }
    for (k, item) in value.as_array().into_iter().flatten().enumerate() {
        found.extend(faults(document, &schema["items"], item, &format!("{at}/{k}")));
    }
    if let Some(members) = value.as_object() {
        for name in schema["required"].as_array().into_iter().flatten().filter_map(Value::as_str) {
            if !members.contains_key(name) {
                found.push(format!("{at} has no {name}"));
            }
        }
        for (name, member) in members {
            let at = format!("{at}/{name}");
            match (schema["properties"].get(name), &schema["additionalProperties"]) {
                (Some(property), _) => found.extend(faults(document, property, member, &at)),
                (None, Value::Bool(false)) => found.push(format!("{at} is not in the schema")),
                (None, others) => found.extend(faults(document, others, member, &at)),
            }
        }
    }
    found
}

fn is_of_type(value: &Value, name: &str) -> bool {
    match name {
        "object" => value.is_object(),
        "array" => value.is_array(),
        "string" => value.is_string(),
        "number" => value.is_number(),
        "integer" => value.as_f64().is_some_and(|number| number.fract() == 0.0),
        "boolean" => value.is_boolean(),
        "null" => value.is_null(),
        other => panic!("{other} is not a type of JSON Schema"),
    }
}

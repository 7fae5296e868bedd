//! Turns the schema of a field into the words of a table: type, unit, default and meaning.

use std::collections::BTreeMap;

use serde_json::{Map, Value};

/// Endings of field names, with the unit that each stands for. The first that fits counts.
const UNITS: &[(&str, &str)] = &[
    ("_mm_per_min", "mm/min"),
    ("_mm_per_s2", "mm/s²"),
    ("_per_mm", "1/mm"),
    ("_mm", "mm"),
    ("_deg", "degrees"),
    ("_rpm", "1/min"),
    ("_s", "s"),
    ("seconds", "s"),
    ("bytes", "bytes"),
    ("bytes_in", "bytes"),
    ("bytes_out", "bytes"),
    ("text_characters", "characters"),
];

/// Schemas whose values are coordinates.
const COORDINATES: &[&str] = &["Point", "PlanePoint", "Position", "Place", "SectionText", "Bounds", "Patch"];

/// The committed contract with the headings under which a page describes its schemas.
pub struct Contract<'a> {
    pub schemas: &'a Map<String, Value>,
    /// The heading of each schema that has a table.
    pub headings: BTreeMap<String, String>,
}

/// A schema whose reference is resolved and whose `null` is removed.
pub struct Field {
    /// The name of the schema that the field refers to, if it refers to one.
    pub refers_to: Option<String>,
    schema: Value,
    pub is_nullable: bool,
    pub default: Option<Value>,
    description: String,
}

impl Contract<'_> {
    /// The schema with this name in the contract.
    pub fn component(&self, name: &str) -> &Value {
        self.schemas.get(name).unwrap_or_else(|| panic!("the contract has no schema {name}"))
    }

    pub fn field(&self, schema: &Value) -> Field {
        let text = |schema: &Value| schema["description"].as_str().unwrap_or_default().to_owned();
        let mut inner = schema.clone();
        let mut description = text(schema);
        let mut is_nullable = false;
        if let Some([one, null]) = schema["oneOf"].as_array().map(Vec::as_slice)
            && null["type"] == "null"
        {
            is_nullable = true;
            inner = one.clone();
        } else if let Some(all) = schema["allOf"].as_array() {
            // One part is the object; the others add a description.
            let object =
                all.iter().find(|part| part.get("$ref").is_some() || part.get("properties").is_some());
            inner = object.expect("an object among allOf").clone();
            let words = all.iter().filter(|part| *part != &inner).map(text);
            description =
                std::iter::once(description).chain(words).find(|words| !words.is_empty()).unwrap_or_default();
        }
        if description.is_empty() {
            description = text(&inner);
        }
        let refers_to = inner["$ref"].as_str().and_then(|path| path.rsplit('/').next()).map(str::to_owned);
        let default =
            schema.get("default").or(inner.get("default")).filter(|value| !value.is_null()).cloned();
        if let Some(name) = &refers_to {
            inner = self.component(name).clone();
            if description.is_empty() {
                description = text(&inner);
            }
        }
        is_nullable |= inner["type"].as_array().is_some_and(|types| types.contains(&"null".into()));
        Field { refers_to, schema: inner, is_nullable, default, description }
    }

    /// The type of a field in words.
    pub fn type_of(&self, field: &Field, with_limits: bool) -> String {
        let schema = &field.schema;
        if let Some(name) = &field.refers_to {
            if let Some(heading) = self.headings.get(name) {
                return format!("[{heading}](#{})", super::page::anchor(heading));
            }
            if let Some(shape) = shape_of_point(schema) {
                return shape;
            }
        }
        if let Some(name) = schema["const"].as_str() {
            return format!("`{name}`");
        }
        if let Some(names) = schema["enum"].as_array() {
            let names: Vec<_> =
                names.iter().filter_map(Value::as_str).map(|name| format!("`{name}`")).collect();
            return list_of(&names, "or");
        }
        if let Some(kinds) = schema["oneOf"].as_array() {
            let kinds: Vec<_> =
                kinds.iter().map(|kind| self.type_of(&self.field(kind), with_limits)).collect();
            return list_of(&kinds, "or");
        }
        let limits = |text: String| if with_limits { text } else { String::new() };
        match type_name(schema) {
            "number" => format!("number{}", limits(range(schema))),
            "integer" => format!("whole number{}", limits(range(schema))),
            "boolean" => "`true` or `false`".to_owned(),
            "string" => format!("text{}", limits(longest(schema, "maxLength", "characters"))),
            "array" => format!("list of {}{}", self.items_of(schema), limits(count(schema))),
            "object" if schema["additionalProperties"].is_object() => "object of texts".to_owned(),
            _ => "object".to_owned(),
        }
    }

    /// The type of the items of a list, in the plural. A choice of types stands in parentheses.
    fn items_of(&self, list: &Value) -> String {
        let item = self.field(&list["items"]);
        let name = self.type_of(&item, false);
        let is_choice = item.schema["oneOf"].is_array() && name.contains(" or ");
        match (is_choice, item.is_nullable) {
            (_, true) => format!("({name} or `null`)"),
            (true, false) => format!("({name})"),
            (false, false) => plural(&name),
        }
    }

    /// The unit of a field: by its name, or mm if it holds coordinates, or nothing.
    pub fn unit_of(&self, name: &str, field: &Field) -> &'static str {
        if let Some((_, unit)) = UNITS.iter().find(|(ending, _)| name.ends_with(ending)) {
            return unit;
        }
        let mut innermost = field.schema.clone();
        let mut named = field.refers_to.clone();
        while type_name(&innermost) == "array" && !named.as_deref().is_some_and(|n| COORDINATES.contains(&n))
        {
            let item = self.field(&innermost["items"]);
            (innermost, named) = (item.schema, item.refers_to);
        }
        if named.as_deref().is_some_and(|name| COORDINATES.contains(&name)) { "mm" } else { "" }
    }

    /// The default and the meaning of a field. The default comes from the schema or the description.
    pub fn default_and_meaning(&self, field: &Field, is_required: bool) -> (String, String) {
        let words = field.description.split_whitespace().collect::<Vec<_>>().join(" ");
        let (said, meaning) = split_default(&words);
        let default = match (&field.default, said) {
            _ if is_required => "required".to_owned(),
            (Some(value), _) => format!("`{}`", value.to_string().trim_matches('"')),
            (None, Some(said)) => said,
            (None, None) if self.has_only_defaults(field) => "its own defaults".to_owned(),
            (None, None) => "none".to_owned(),
        };
        (default, meaning)
    }

    fn has_only_defaults(&self, field: &Field) -> bool {
        !field.is_nullable
            && field.schema.get("properties").is_some()
            && field.schema.get("required").is_none()
    }
}

impl Field {
    /// Whether a member of an answer is left out where it has no value, instead of being `null`. The contract
    /// does not tell the two apart, so descriptions of such members say where they are absent or present.
    pub fn is_left_out(&self) -> bool {
        let says = |word: &str| self.description.contains(word);
        self.is_nullable && (says("Absent ") || says("Present "))
    }

    /// The schema of an object that has no name of its own in the contract.
    pub fn inline_object(&self) -> Option<&Value> {
        (self.refers_to.is_none() && self.schema.get("properties").is_some()).then_some(&self.schema)
    }
}

/// Whether a schema is a union of several named objects, which `kind` distinguishes.
pub fn is_tagged_union(schema: &Value) -> bool {
    schema["oneOf"]
        .as_array()
        .is_some_and(|kinds| kinds.len() > 1 && kinds.iter().all(|kind| kind.get("$ref").is_some()))
}

/// The plural of the name of a type. Names of objects stay as they are.
fn plural(name: &str) -> String {
    match name.split_once(" of ") {
        Some(("list", items)) => format!("lists of {items}"),
        _ if ["number", "whole number", "text", "object"].contains(&name) => format!("{name}s"),
        _ => name.to_owned(),
    }
}

/// Splits a sentence such as `Default: 1, with a warning.` off a description. Returns the default, if there
/// is one, and the rest of the description.
fn split_default(words: &str) -> (Option<String>, String) {
    let found = ["Default: ", "Default in a request: "].iter().find_map(|mark| words.split_once(mark));
    let Some((before, after)) = found else { return (None, words.to_owned()) };
    let end = after.match_indices(". ").map(|(at, _)| at).next().unwrap_or(after.trim_end_matches('.').len());
    let meaning = [before.trim(), after[end..].trim_start_matches('.').trim()].join(" ");
    (Some(after[..end].to_owned()), meaning.trim().to_owned())
}

/// A shape such as `[x, y, z]`, if the schema is a list of numbers and its description shows the shape.
fn shape_of_point(schema: &Value) -> Option<String> {
    if type_name(schema) != "array" || type_name(&schema["items"]) != "number" {
        return None;
    }
    let shown = schema["description"].as_str()?.split('`').skip(1).step_by(2);
    let shapes: Vec<_> = shown.filter(|text| text.starts_with('[')).map(|text| format!("`{text}`")).collect();
    (!shapes.is_empty()).then(|| list_of(&shapes, "or"))
}

/// The type of a schema, apart from `null`.
fn type_name(schema: &Value) -> &str {
    match &schema["type"] {
        Value::Array(types) => {
            types.iter().filter_map(Value::as_str).find(|name| *name != "null").unwrap_or_default()
        }
        name => name.as_str().unwrap_or_default(),
    }
}

fn range(schema: &Value) -> String {
    match (schema["minimum"].as_f64(), schema["maximum"].as_f64()) {
        (Some(min), Some(max)) => format!(", {} to {}", grouped(min), grouped(max)),
        (Some(min), None) => format!(", {} or more", grouped(min)),
        (None, Some(max)) => format!(", at most {}", grouped(max)),
        (None, None) => String::new(),
    }
}

/// The number of items of a list. The items of a list of lists are rows.
fn count(schema: &Value) -> String {
    let what = if type_name(&schema["items"]) == "array" { "rows" } else { "of them" };
    match (schema["minItems"].as_u64(), schema["maxItems"].as_u64()) {
        (Some(min), Some(max)) if min == max => format!(", {min} {what}"),
        (Some(min), Some(max)) => format!(", {} to {} {what}", grouped(min as f64), grouped(max as f64)),
        (Some(min), None) => format!(", {min} or more {what}"),
        _ => longest(schema, "maxItems", what),
    }
}

fn longest(schema: &Value, limit: &str, what: &str) -> String {
    schema[limit]
        .as_u64()
        .map(|most| format!(", at most {} {what}", grouped(most as f64)))
        .unwrap_or_default()
}

/// A number with commas between its thousands.
fn grouped(value: f64) -> String {
    let text = format!("{}", value.abs());
    let (whole, fraction) =
        text.split_once('.').map_or((text.as_str(), None), |(whole, rest)| (whole, Some(rest)));
    let mut out = String::from(if value < 0.0 { "-" } else { "" });
    for (k, digit) in whole.chars().enumerate() {
        if k > 0 && (whole.len() - k) % 3 == 0 {
            out.push(',');
        }
        out.push(digit);
    }
    fraction.map_or(out.clone(), |fraction| format!("{out}.{fraction}"))
}

/// A list in words, such as `a, b or c`.
pub fn list_of(items: &[String], last: &str) -> String {
    match items {
        [] => String::new(),
        [one] => one.clone(),
        [most @ .., end] => format!("{} {last} {end}", most.join(", ")),
    }
}

#[test]
fn numbers_get_commas_between_thousands_and_lists_a_last_word() {
    assert_eq!(grouped(1e6), "1,000,000");
    assert_eq!(grouped(-1e6), "-1,000,000");
    assert_eq!(grouped(1e-6), "0.000001");
    assert_eq!(grouped(9_007_199_254_740_991.0), "9,007,199,254,740,991");
    assert_eq!(list_of(&["a".into(), "b".into(), "c".into()], "or"), "a, b or c");
}

#[test]
fn a_default_in_a_description_is_split_off() {
    let split = |words: &str| split_default(words);
    assert_eq!(split("Chord height. Default: 0.01."), (Some("0.01".into()), "Chord height.".into()));
    assert_eq!(split("Default: 1. Some take less."), (Some("1".into()), "Some take less.".into()));
    assert_eq!(split("A name."), (None, "A name.".into()));
}

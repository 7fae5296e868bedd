//! Sentences about what a request must hold and what it holds instead, for people.

use std::fmt::Display;

use serde_json::Value;
use utoipa::openapi::schema::Object;

use crate::http::error::MAX_DETAIL_CHARACTERS;

/// As much of a text as a sentence may show. A text may be as long as a body.
fn beginning(text: &str) -> &str {
    text.char_indices().nth(MAX_DETAIL_CHARACTERS).map_or(text, |(end, _)| &text[..end])
}

/// The sentence about a name that is not in `names`.
pub fn unknown(name: &str, names: &[&str]) -> String {
    format!("`{}` is unknown; use {}", beginning(name), one_of(names))
}

/// The names that a text with the schema `object` may be.
pub fn names(object: &Object) -> Vec<&str> {
    object.enum_values.iter().flatten().filter_map(Value::as_str).collect()
}

/// The names among which a caller chooses.
pub fn one_of(names: &[&str]) -> String {
    let one_of = if names.len() > 1 { "one of " } else { "" };
    format!("{one_of}`{}`", names.join("`, `"))
}

/// The sentence about a member that an object with the members `known` does not have.
pub fn unknown_member(name: &str, known: &[&str]) -> String {
    let known = if known.is_empty() {
        "no members".to_owned()
    } else {
        format!("the members `{}`", known.join("`, `"))
    };
    format!("`{}` is unknown; this object has {known}", beginning(name))
}

/// The sentence about a number outside its range.
pub fn outside(value: impl Display, least: impl Display, most: impl Display) -> String {
    format!("{value} is not allowed; send {least} to {most}")
}

/// The sentence about a text that is too long.
pub fn too_long(characters: usize, most: usize) -> String {
    format!("the text has {characters} characters; send at most {most}")
}

/// The sentence about a value of the wrong type.
pub fn wrong(expected: &str, value: &Value) -> String {
    let sent = match value {
        Value::String(text) => format!("the text {:?}", beginning(text)),
        Value::Array(_) => "an array".to_owned(),
        Value::Object(_) => "an object".to_owned(),
        Value::Null | Value::Bool(_) | Value::Number(_) => format!("`{value}`"),
    };
    format!("send {expected}, not {sent}")
}

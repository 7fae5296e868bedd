//! Decodes the JSON bodies of requests. Each error has a pointer to the member at fault.
//!
//! # Method
//! 1. The whole body is checked to be JSON. So a body that is not JSON is always reported as such.
//! 2. The body is decoded as the type of the request. The decoder stops at its first error.
//! 3. After an error, `mend` looks for further errors in the body.

mod foreign;
mod mend;
pub mod object;
pub mod tagged;
pub mod words;

use std::collections::HashSet;
use std::fmt;

use serde::de::{DeserializeOwned, DeserializeSeed, Error as _, MapAccess, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer};
use serde_path_to_error::{Path, Segment};

use super::error::{ApiError, Code, FieldCode, FieldError};
use super::pointer::Pointer;
use crate::config::Limits;
use object::Object;

/// Longest name in a pointer, in bytes. For a member with a longer name the pointer names its object instead.
const MAX_NAME_BYTES: usize = 200;

/// A wire type of requests that can be converted to a job.
pub trait IntoJob: DeserializeOwned + Send + 'static {
    type Job: Send + 'static;

    /// Checks the request and converts it.
    ///
    /// # Errors
    /// `invalid_request` with every violation.
    fn into_job(self, limits: &Limits) -> Result<Self::Job, ApiError>;
}

/// Decodes a body and converts it to a job.
///
/// # Errors
/// `malformed_json`, or `invalid_request` with every violation.
pub fn job<T: IntoJob>(body: &[u8], limits: &Limits) -> Result<T::Job, ApiError> {
    let text = json_text(body)?;
    match decode_at::<T>(text) {
        Ok(request) => request.into_job(limits),
        Err(first) => mend::job::<T>(text, first, limits),
    }
}

/// The text of a body.
///
/// # Errors
/// `malformed_json` when the body is not JSON in UTF-8.
fn json_text(body: &[u8]) -> Result<&str, ApiError> {
    let malformed = |detail: String| ApiError::new(Code::MalformedJson, detail);
    if body.iter().all(u8::is_ascii_whitespace) {
        return Err(malformed("the body is empty".into()));
    }
    let text = std::str::from_utf8(body).map_err(|error| {
        malformed(foreign::named(body, None).map_or_else(
            || format!("the body is not UTF-8: byte {} is wrong", error.valid_up_to()),
            str::to_owned,
        ))
    })?;
    serde_json::from_str::<Checked>(text).map_err(|error| {
        let lines_before = text.split_inclusive('\n').take(error.line().saturating_sub(1));
        let fault_at = lines_before.map(str::len).sum::<usize>() + error.column().saturating_sub(1);
        malformed(
            foreign::named(body, Some(fault_at))
                .map_or_else(|| format!("the body is not JSON: {error}"), str::to_owned),
        )
    })?;
    Ok(text)
}

/// Decodes an object from text that is JSON. The pointer of an error starts at this object.
pub fn decode_at<'de, T: Deserialize<'de>>(text: &'de str) -> Result<T, FieldError> {
    let mut deserializer = serde_json::Deserializer::from_str(text);
    match serde_path_to_error::deserialize(&mut deserializer) {
        Ok(Object(value)) => Ok(value),
        Err(error) => {
            let at = pointer_of(error.path());
            Err(explain(&at, &error.into_inner().to_string()))
        }
    }
}

/// The pointer of a path. It ends before the first name that is too long.
fn pointer_of(path: &Path) -> Pointer {
    let is_short = |segment: &&Segment| match segment {
        Segment::Map { key } => key.len() <= MAX_NAME_BYTES,
        _ => true,
    };
    path.iter().take_while(is_short).fold(Pointer::root(), |at, segment| match segment {
        Segment::Seq { index } => at.index(*index),
        Segment::Map { key } | Segment::Enum { variant: key } => at.field(key),
        Segment::Unknown => at,
    })
}

/// The violation for an error of the decoder. The decoder gives only a message, so the code follows from its
/// text.
fn explain(at: &Pointer, message: &str) -> FieldError {
    if let Some(inner) = tagged::unpack(message) {
        return FieldError { pointer: at.join(&inner.pointer).as_str().to_owned(), ..inner };
    }
    // The message ends with line and column, which the pointer replaces.
    let message = message.rsplit_once(" at line ").map_or(message, |(before, _)| before);
    let named = message.split('`').nth(1);
    if let (Some(name), true) = (named, message.starts_with("missing field")) {
        return FieldError::new(&at.field(name), FieldCode::MissingField, format!("`{name}` is required"));
    }
    if let (Some(name), true) = (named, message.starts_with("unknown field")) {
        // The path already ends with the name.
        let known = message.split('`').skip(3).step_by(2).collect::<Vec<_>>().join("`, `");
        let known = if known.is_empty() { "no members".to_owned() } else { format!("the members `{known}`") };
        let detail = format!("`{name}` is unknown; this object has {known}");
        return FieldError::new(at, FieldCode::UnknownField, detail);
    }
    if let (Some(value), true) = (named, message.starts_with("unknown variant")) {
        let names: Vec<&str> = message.split('`').skip(3).step_by(2).collect();
        return FieldError::new(at, FieldCode::UnknownValue, words::unknown(value, &names));
    }
    let code = if message.starts_with("invalid length") || message.starts_with("trailing characters") {
        FieldCode::WrongLength
    } else {
        FieldCode::WrongType
    };
    FieldError::new(at, code, words::plain(message))
}

/// Any JSON value. Reading it finds errors and keeps nothing: syntax, numbers beyond f64, too deep nesting,
/// repeated keys.
struct Checked;

impl<'de> Deserialize<'de> for Checked {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(Checked)
    }
}

impl<'de> DeserializeSeed<'de> for Checked {
    type Value = Checked;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(self)
    }
}

impl<'de> Visitor<'de> for Checked {
    type Value = Checked;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a JSON value")
    }

    fn visit_bool<E>(self, _: bool) -> Result<Self, E> {
        Ok(self)
    }

    fn visit_i64<E>(self, _: i64) -> Result<Self, E> {
        Ok(self)
    }

    fn visit_u64<E>(self, _: u64) -> Result<Self, E> {
        Ok(self)
    }

    fn visit_f64<E>(self, _: f64) -> Result<Self, E> {
        Ok(self)
    }

    fn visit_str<E>(self, _: &str) -> Result<Self, E> {
        Ok(self)
    }

    fn visit_unit<E>(self) -> Result<Self, E> {
        Ok(self)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<Self, A::Error> {
        while seq.next_element::<Checked>()?.is_some() {}
        Ok(self)
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Self, A::Error> {
        let mut keys = HashSet::new();
        while let Some(key) = map.next_key::<String>()? {
            map.next_value::<Checked>()?;
            if keys.contains(&key) {
                return Err(A::Error::custom(format!("the member `{key}` stands twice in one object")));
            }
            keys.insert(key);
        }
        Ok(self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Debug, Deserialize)]
    #[serde(deny_unknown_fields)]
    struct Outer {
        #[serde(default)]
        _list: Vec<[f64; 2]>,
        #[serde(default)]
        _inner: Option<Inner>,
    }

    #[derive(Debug, Deserialize)]
    #[serde(deny_unknown_fields)]
    struct Inner {
        _width: f64,
        #[serde(default)]
        _side: Option<Side>,
    }

    #[derive(Debug, Deserialize)]
    #[serde(rename_all = "snake_case")]
    enum Side {
        Left,
    }

    impl IntoJob for Outer {
        type Job = ();

        fn into_job(self, _: &Limits) -> Result<(), ApiError> {
            Ok(())
        }
    }

    fn decoded(body: &[u8]) -> Result<(), ApiError> {
        job::<Outer>(body, &Limits::DEFAULT)
    }

    fn code_of(body: &str) -> Code {
        decoded(body.as_bytes()).expect_err(body).code()
    }

    #[test]
    fn a_body_that_is_not_json_is_malformed_whatever_else_is_wrong() {
        let deep = "[".repeat(100_000);
        for body in [
            "",
            "  \n",
            "{",
            "{\"_list\": [[1, 2]",
            "nothing",
            "{\"_list\": [[NaN, 1]]}",
            "{\"_list\": [[Infinity, 1]]}",
            "{\"_list\": [[1e999, 1]]}",
            "{\"unknown\": 1e999}",
            "{\"unknown\": 1, \"_list\": [",
            "{} {}",
            "{\"_list\": [], \"_list\": []}",
            "{\"x\": {\"a\": 1, \"a\": 2}}",
            &deep,
        ] {
            assert_eq!(code_of(body), Code::MalformedJson, "{}", &body[..body.len().min(40)]);
        }
        assert_eq!(decoded(b"{\"_list\": \"\xff\"}").expect_err("utf-8").code(), Code::MalformedJson);
    }

    #[test]
    fn a_pointer_leads_to_the_member_at_fault() {
        for (body, pointer, code) in [
            (r#"{"_lisst": 1}"#, "#/_lisst", FieldCode::UnknownField),
            (r#"{"_list": [[1, 2], [3, "x"]]}"#, "#/_list/1/1", FieldCode::WrongType),
            (r#"{"_list": [[1, 2], [3]]}"#, "#/_list/1", FieldCode::WrongLength),
            (r#"{"_list": [[1, 2, 3]]}"#, "#/_list/0", FieldCode::WrongLength),
            (r#"{"_list": 3}"#, "#/_list", FieldCode::WrongType),
            (r#"{"_inner": {}}"#, "#/_inner/_width", FieldCode::MissingField),
            (r#"{"_inner": {"_width": 1, "a/b": 1}}"#, "#/_inner/a~1b", FieldCode::UnknownField),
            (r#"{"_inner": {"_width": null}}"#, "#/_inner/_width", FieldCode::WrongType),
            (r#"{"_inner": {"_width": 1, "_side": "up"}}"#, "#/_inner/_side", FieldCode::UnknownValue),
            (r#"{"_inner": {"_width": 1, "_side": 4}}"#, "#/_inner/_side", FieldCode::WrongType),
            ("[]", "#", FieldCode::WrongType),
            ("5", "#", FieldCode::WrongType),
        ] {
            let error = decoded(body.as_bytes()).expect_err(body);
            let [only] = error.errors() else { panic!("{body}: {error:?}") };
            assert_eq!((only.pointer.as_str(), only.code), (pointer, code), "{body}: {}", only.detail);
        }
    }
}

//! Objects that are told apart by their member `kind`.
//!
//! The dispatch is by hand: a derived internally tagged enum buffers its content, and the path of an error
//! ends at the enum. Here the object is decoded from its own text; its error travels up inside the outer
//! decoder's error message, the only thing that decoder lets through.

use serde::Deserialize;
use serde::de::Error;
use serde_json::value::RawValue;

use super::object::Object;
use crate::http::decode::decode_at;
use crate::http::error::{FieldCode, FieldError};
use crate::http::pointer::Pointer;

/// Begins a packed error, as no message of a decoder begins, and separates its parts.
const MARK: char = '\u{1}';

#[derive(Deserialize)]
struct Kind {
    kind: String,
}

/// The `kind` of an object.
///
/// # Errors
/// When it has none.
pub fn kind_of<E: Error>(object: &RawValue) -> Result<String, E> {
    decode::<Kind, E>(object).map(|tag| tag.kind)
}

/// The object as the type that its kind asks for.
///
/// # Errors
/// When it does not fit.
pub fn decode<'de, T: Deserialize<'de>, E: Error>(object: &'de RawValue) -> Result<T, E> {
    // Keeping the path to an error takes longer than decoding: it is only asked for where there is one.
    match serde_json::from_str(object.get()) {
        Ok(Object(value)) => Ok(value),
        Err(_) => decode_at(object.get()).map_err(|error| E::custom(pack(&error))),
    }
}

/// The error for a `kind` that is none of `expected`.
pub fn unknown<E: Error>(kind: &str, later: &[&str], expected: &[&str]) -> E {
    let at = Pointer::root().field("kind");
    let expected = expected.join("`, `");
    E::custom(pack(&if later.contains(&kind) {
        let detail = format!("`{kind}` is not supported yet, expected `{expected}`");
        FieldError::new(&at, FieldCode::Unsupported, detail)
    } else {
        FieldError::new(&at, FieldCode::UnknownValue, format!("`{kind}` is unknown, expected `{expected}`"))
    }))
}

fn pack(error: &FieldError) -> String {
    let code = CODES.iter().position(|code| *code == error.code).unwrap_or_default();
    format!("{MARK}{}{MARK}{code}{MARK}{}{MARK}", error.pointer, error.detail)
}

/// The error inside an outer decoder's message.
pub fn unpack(message: &str) -> Option<FieldError> {
    let mut parts = message.strip_prefix(MARK)?.split(MARK);
    let (pointer, code, detail) = (parts.next()?, parts.next()?, parts.next()?);
    let code = *CODES.get(code.parse::<usize>().ok()?)?;
    Some(FieldError { pointer: pointer.to_owned(), code, detail: detail.to_owned(), offset: None })
}

/// What decoding can find.
const CODES: [FieldCode; 6] = [
    FieldCode::WrongType,
    FieldCode::WrongLength,
    FieldCode::UnknownField,
    FieldCode::MissingField,
    FieldCode::UnknownValue,
    FieldCode::Unsupported,
];

//! Decodes the JSON bodies of requests. Each error has a pointer to the member at fault.
//!
//! # Method
//! 1. The whole body is checked to be JSON. So a body that is not JSON is always reported as such.
//! 2. The body is decoded as the type of the request. The decoder stops at its first error.
//! 3. After an error, `contract` finds all violations, and leaves out what counts as absent. If it finds
//!    none, the body is decoded again.

pub mod check;
mod contract;
mod foreign;
pub mod object;
mod path;
pub mod query;
pub mod tagged;
pub mod words;

use std::collections::HashSet;
use std::fmt;

use serde::de::{DeserializeOwned, DeserializeSeed, Error as _, MapAccess, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer};
use serde_json::Value;
use utoipa::ToSchema;

use super::error::{ApiError, Code, FieldCode};
use super::messages::Warning;
use super::pointer::Pointer;
use crate::config::Limits;
use contract::Contract;
use object::Object;

/// A wire type of requests that can be converted to a job.
pub trait IntoJob: DeserializeOwned + ToSchema + Send + 'static {
    type Job: Send + 'static;

    /// Puts right in the request what is unambiguous, and tells what.
    fn put_right(&mut self, _: &Limits) -> Vec<Warning> {
        Vec::new()
    }

    /// Checks the request and converts it.
    ///
    /// # Errors
    /// `invalid_request` with every violation.
    fn into_job(self, limits: &Limits) -> Result<Self::Job, ApiError>;
}

/// A job, and what was put right in its request.
pub struct SentJob<J> {
    pub job: J,
    pub remarks: Vec<Warning>,
}

impl<J> SentJob<J> {
    fn of<T: IntoJob<Job = J>>(mut request: T, limits: &Limits) -> Result<Self, ApiError> {
        let remarks = request.put_right(limits);
        Ok(Self { job: request.into_job(limits)?, remarks })
    }
}

/// Decodes a body and converts it to a job.
///
/// # Errors
/// `malformed_json`, or `invalid_request` with every violation.
pub fn job<T: IntoJob>(body: &[u8], limits: &Limits) -> Result<SentJob<T::Job>, ApiError> {
    let text = json_text(body)?;
    if let Ok(Object(request)) = serde_json::from_str::<Object<T>>(text) {
        return SentJob::of(request, limits);
    }
    let mut value: Value = serde_json::from_str(text).map_err(not_json)?;
    let mut violations = Contract::of::<T>().check(&mut value);
    if let Ok(Object(request)) = serde_json::from_str::<Object<T>>(&value.to_string()) {
        return SentJob::of(request, limits);
    }
    if violations.total() == 0 {
        let detail = "the body does not fit the contract";
        violations.add(&Pointer::root(), FieldCode::WrongType, detail);
    }
    Err(violations.into_error())
}

fn malformed(detail: impl Into<String>) -> ApiError {
    ApiError::new(Code::MalformedJson, detail)
}

fn not_json(error: serde_json::Error) -> ApiError {
    malformed(format!("the body is not JSON: {error}"))
}

/// The text of a body.
///
/// # Errors
/// `malformed_json` when the body is not JSON in UTF-8.
fn json_text(body: &[u8]) -> Result<&str, ApiError> {
    if body.iter().all(u8::is_ascii_whitespace) {
        return Err(malformed("the body is empty"));
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
        foreign::named(body, Some(fault_at)).map_or_else(|| not_json(error), malformed)
    })?;
    Ok(text)
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
mod tests;

//! Values without their contents: of what type a part of a body is, and of what kind an object.

use std::fmt;

use serde::Deserializer;
use serde::de::{Error, IgnoredAny, MapAccess, Visitor};
use serde_json::value::RawValue;
use serde_json::{Map, Value};
use utoipa::openapi::schema::Type;

use crate::http::decode::json::Name;

/// The value of the member `tag` of an object, as [`outline`] makes it. `None` where the object has no such
/// member.
pub fn tag_of(object: &RawValue, tag: &str) -> serde_json::Result<Option<Value>> {
    serde_json::Deserializer::from_str(object.get()).deserialize_map(Tag(tag))
}

/// The names of the members of an object: of the first hundred.
pub fn names_of(object: &RawValue) -> serde_json::Result<Vec<String>> {
    serde_json::Deserializer::from_str(object.get()).deserialize_map(MemberNames)
}

/// The most names that are kept. No legal object that is told apart by its names has as many.
const MOST_NAMES: usize = 100;

struct MemberNames;

impl<'de> Visitor<'de> for MemberNames {
    type Value = Vec<String>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("an object")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut sent: A) -> Result<Vec<String>, A::Error> {
        let mut names = Vec::new();
        while let Some(name) = sent.next_key_seed(Name)? {
            sent.next_value::<IgnoredAny>()?;
            if names.len() < MOST_NAMES {
                names.push(name.into_owned());
            }
        }
        Ok(names)
    }
}

struct Tag<'a>(&'a str);

impl<'de> Visitor<'de> for Tag<'_> {
    type Value = Option<Value>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("an object")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut sent: A) -> Result<Option<Value>, A::Error> {
        let mut found = None;
        while let Some(name) = sent.next_key_seed(Name)? {
            if *name == *self.0 {
                found = Some(outline(sent.next_value()?)?);
            } else {
                sent.next_value::<IgnoredAny>()?;
            }
        }
        Ok(found)
    }
}

/// The value, but an array or an object without its contents.
pub fn outline<E: Error>(sent: &RawValue) -> Result<Value, E> {
    match sent.get().as_bytes().first() {
        Some(b'[') => Ok(Value::Array(Vec::new())),
        Some(b'{') => Ok(Value::Object(Map::new())),
        _ => serde_json::from_str(sent.get()).map_err(E::custom),
    }
}

/// The type of a value; a whole number is a number.
pub fn type_of_value(sent: &Value) -> Type {
    match sent {
        Value::Null => Type::Null,
        Value::Bool(_) => Type::Boolean,
        Value::Number(_) => Type::Number,
        Value::String(_) => Type::String,
        Value::Array(_) => Type::Array,
        Value::Object(_) => Type::Object,
    }
}

//! Reads any JSON, and tells what is wrong with a body that is not JSON.
//!
//! The memory does not grow with the body.

use std::borrow::Cow;
use std::collections::HashSet;
use std::fmt;

use serde::Deserializer;
use serde::de::{DeserializeSeed, Error, MapAccess, SeqAccess, Visitor};

use super::foreign;
use super::patience::Patience;
use crate::http::error::{ApiError, Code};
use toolpathd_core::budget::{Budget, Stopped};

/// Names of an object that are compared one by one. Few objects have more members.
const FEW_NAMES: usize = 16;

/// Most further names of an object that are kept to find a repeated name. No legal object has as many
/// members. Without this limit, an object of a few million members would fill some hundred MB.
const MOST_NAMES: usize = 1_000;

/// Why a body was not read to its end.
#[derive(Debug)]
pub enum Unread {
    /// [`fault`] tells what is wrong, and where.
    NotJson,
    Stopped(Stopped),
}

/// The text of a body. Whether the text is JSON is not known yet.
///
/// # Errors
/// `malformed_json` when the body is empty or no UTF-8.
pub fn text_of(body: &[u8]) -> Result<&str, ApiError> {
    if body.iter().all(u8::is_ascii_whitespace) {
        return Err(malformed("the body is empty"));
    }
    std::str::from_utf8(body).map_err(|error| {
        malformed(foreign::named(body, None).map_or_else(
            || format!("the body is not UTF-8: byte {} is wrong", error.valid_up_to()),
            str::to_owned,
        ))
    })
}

/// The error of a text that is not JSON.
pub fn fault(text: &str, budget: &Budget) -> ApiError {
    let mut patience = Patience::new(budget);
    let mut reader = serde_json::Deserializer::from_str(text);
    let read = AnyValue(&mut patience).deserialize(&mut reader).and_then(|()| reader.end());
    if let Err(stopped) = patience.result() {
        return stopped.into();
    }
    let Err(error) = read else { return malformed("the body is not JSON") };
    let lines_before = text.split_inclusive('\n').take(error.line().saturating_sub(1));
    let fault_at = lines_before.map(str::len).sum::<usize>() + error.column().saturating_sub(1);
    let foreign = foreign::named(text.as_bytes(), Some(fault_at));
    foreign.map_or_else(|| malformed(format!("the body is not JSON: {error}")), malformed)
}

fn malformed(detail: impl Into<String>) -> ApiError {
    ApiError::new(Code::MalformedJson, detail)
}

/// Any JSON value. Reading it finds errors and keeps nothing: syntax, numbers beyond f64, too deep nesting,
/// repeated names.
pub struct AnyValue<'a, 'b>(pub &'a mut Patience<'b>);

impl<'de> DeserializeSeed<'de> for AnyValue<'_, '_> {
    type Value = ();

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<(), D::Error> {
        deserializer.deserialize_any(self)
    }
}

impl<'de> Visitor<'de> for AnyValue<'_, '_> {
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a JSON value")
    }

    fn visit_bool<E>(self, _: bool) -> Result<(), E> {
        Ok(())
    }

    fn visit_i64<E>(self, _: i64) -> Result<(), E> {
        Ok(())
    }

    fn visit_u64<E>(self, _: u64) -> Result<(), E> {
        Ok(())
    }

    fn visit_f64<E>(self, _: f64) -> Result<(), E> {
        Ok(())
    }

    fn visit_str<E>(self, _: &str) -> Result<(), E> {
        Ok(())
    }

    fn visit_unit<E>(self) -> Result<(), E> {
        Ok(())
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<(), A::Error> {
        while seq.next_element_seed(AnyValue(self.0))?.is_some() {
            self.0.spend()?;
        }
        Ok(())
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<(), A::Error> {
        let mut names = Names::default();
        while let Some(name) = map.next_key_seed(Name)? {
            map.next_value_seed(AnyValue(self.0))?;
            self.0.spend()?;
            names.add(name)?;
        }
        Ok(())
    }
}

/// The names of the members of one object.
#[derive(Default)]
pub struct Names<'de> {
    few: Vec<Cow<'de, str>>,
    more: HashSet<Cow<'de, str>>,
}

impl<'de> Names<'de> {
    /// # Errors
    /// When the object has the name already.
    pub fn add<E: Error>(&mut self, name: Cow<'de, str>) -> Result<(), E> {
        if self.few.contains(&name) || self.more.contains(&name) {
            return Err(E::custom(format!("the member `{name}` stands twice in one object")));
        }
        if self.few.len() < FEW_NAMES {
            self.few.push(name);
        } else if self.more.len() < MOST_NAMES {
            self.more.insert(name);
        }
        Ok(())
    }
}

/// The name of a member: a part of the text, or a text of its own where the name has escapes.
pub struct Name;

impl<'de> DeserializeSeed<'de> for Name {
    type Value = Cow<'de, str>;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<Cow<'de, str>, D::Error> {
        deserializer.deserialize_str(self)
    }
}

impl<'de> Visitor<'de> for Name {
    type Value = Cow<'de, str>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a name")
    }

    fn visit_borrowed_str<E>(self, name: &'de str) -> Result<Cow<'de, str>, E> {
        Ok(Cow::Borrowed(name))
    }

    fn visit_str<E>(self, name: &str) -> Result<Cow<'de, str>, E> {
        Ok(Cow::Owned(name.to_owned()))
    }
}

//! The walk over the text of one body.

mod objects;

use std::fmt;

use serde::de::{DeserializeSeed, Error as _, MapAccess, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer};
use serde_json::value::RawValue;
use serde_json::{Map, Number, Value};
use utoipa::openapi::schema::{AdditionalProperties, Array, Object, OneOf, Schema, SchemaType, Type};

use super::outline::{outline, type_of_value};
use super::written::Written;
use super::{Asked, Checked, Contract, items, range, tuple, type_of};
use crate::http::decode::check::{Violations, fault_of_number};
use crate::http::decode::json::{AnyValue, Name, Names, Unread};
use crate::http::decode::path::Path;
use crate::http::decode::patience::Patience;
use crate::http::decode::words;
use crate::http::error::{FieldCode, FieldError};
use toolpathd_core::budget::Budget;

/// Whole numbers from here on may not be exact in floating point (2^53 is about 9.007e15).
const LARGEST_WHOLE: f64 = 9e15;

/// The schema of names of dialects. An unknown dialect has a code of its own.
const DIALECTS: &str = "DialectName";

/// What the decoder always refuses. Other violations may be left to the rules of the request.
const REFUSED: [FieldCode; 5] = [
    FieldCode::MissingField,
    FieldCode::UnknownField,
    FieldCode::WrongType,
    FieldCode::UnknownValue,
    FieldCode::Unsupported,
];

/// The walk over the text of one body.
pub struct Walk<'c> {
    contract: &'c Contract,
    violations: Violations,
    is_refused: bool,
    written: Written,
    patience: Patience<'c>,
}

impl<'c> Walk<'c> {
    /// A walk that writes the body where `written` keeps what is written.
    pub fn new(contract: &'c Contract, written: Written, budget: &'c Budget) -> Self {
        let (violations, patience) = (Violations::default(), Patience::new(budget));
        Self { contract, violations, is_refused: false, written, patience }
    }

    /// # Errors
    /// When `text` is not JSON, or the budget stops the walk.
    pub fn over(mut self, text: &str) -> Result<(Checked, Written), Unread> {
        let asked = self.contract.asked(&self.contract.request);
        let mut reader = serde_json::Deserializer::from_str(text);
        let check = ValueCheck { walk: &mut self, at: &Path::Body, asked, is_member: false };
        let read = check.deserialize(&mut reader).and_then(|_| reader.end());
        self.patience.result().map_err(Unread::Stopped)?;
        read.map_err(|_| Unread::NotJson)?;
        let Self { violations, is_refused, written, .. } = self;
        Ok((Checked { violations, is_refused }, written))
    }

    fn blame(&mut self, at: &Path, code: FieldCode, detail: impl FnOnce() -> String) {
        self.is_refused |= REFUSED.contains(&code);
        self.violations.add_made(|| FieldError::new(&at.pointer(), code, detail()));
    }

    fn missing(&mut self, at: &Path, name: &str) {
        self.blame(at, FieldCode::MissingField, || format!("`{name}` is required"));
    }

    fn wrong_type(&mut self, at: &Path, schema: &Schema, sent: &Value) {
        let contract = self.contract;
        self.blame(at, FieldCode::WrongType, || words::wrong(&contract.expectation(schema), sent));
    }

    /// An array or an object where the contract has neither.
    fn unfit(&mut self, at: &Path, asked: Asked, sent: &Value) {
        match asked.usual {
            Some((_, schema)) => self.wrong_type(at, schema, sent),
            None => self.is_refused = true,
        }
    }

    /// A text, a number, `true`, `false` or `null`.
    fn scalar(&mut self, at: &Path, asked: Asked, sent: &Value) {
        let mark = self.written.mark();
        self.written.value(sent);
        let Some((name, schema)) = asked.of(&type_of_value(sent)) else { return };
        let Schema::Object(object) = schema else { return self.wrong_type(at, schema, sent) };
        match (type_of(&object.schema_type), sent) {
            (Type::String, Value::String(text)) => self.text(at, name, object, text),
            (Type::Boolean, Value::Bool(_)) => {}
            (Type::Number, Value::Number(number)) => self.number(at, object, number),
            (Type::Integer, Value::Number(number)) if is_whole(number) => {
                if let Some(whole) = self.integer(at, object, number) {
                    self.written.back_to(mark);
                    self.written.value(&whole.into());
                }
            }
            _ => self.wrong_type(at, schema, sent),
        }
    }

    fn text(&mut self, at: &Path, name: &str, object: &Object, text: &str) {
        let characters = || text.chars().count();
        if let Some(most) = object.max_length.filter(|most| characters() > *most) {
            self.blame(at, FieldCode::TooLong, || words::too_long(characters(), most));
        }
        if object.enum_values.as_ref().is_some_and(|names| !names.iter().any(|name| name == text)) {
            let code = if name == DIALECTS { FieldCode::UnknownDialect } else { FieldCode::UnknownValue };
            self.blame(at, code, || words::unknown(text, &words::names(object)));
        }
    }

    fn number(&mut self, at: &Path, object: &Object, number: &Number) {
        let (value, range) = (number.as_f64().unwrap_or(f64::INFINITY), range(object));
        if !range.holds(value) {
            self.violations.add_made(|| {
                let (code, detail) = fault_of_number(value, range, "");
                FieldError::new(&at.pointer(), code, detail)
            });
        }
    }

    /// The integer that the decoder needs in place of a whole number with a decimal point.
    fn integer(&mut self, at: &Path, object: &Object, number: &Number) -> Option<i64> {
        let (value, range) = (number.as_f64().unwrap_or(f64::INFINITY), range(object));
        if !range.holds(value) {
            self.blame(at, FieldCode::OutOfRange, || words::outside(number, range.min, range.max));
            return None;
        }
        (number.is_f64() && value.abs() < LARGEST_WHOLE).then_some(value as i64)
    }

    fn elements<'de, A: SeqAccess<'de>>(
        &mut self,
        at: &Path,
        array: &'c Array,
        mut sent: A,
    ) -> Result<(), A::Error> {
        let contract = self.contract;
        let asked = items(array).map_or(Asked { usual: None, choices: &[] }, |items| contract.asked(items));
        self.written.push("[");
        let first = self.written.mark();
        let mut count = 0;
        loop {
            let mark = self.written.mark();
            self.written.separate(first);
            let element = Path::Element(at, count);
            let check = ValueCheck { walk: &mut *self, at: &element, asked, is_member: false };
            if sent.next_element_seed(check)?.is_none() {
                self.written.back_to(mark);
                break;
            }
            count += 1;
        }
        self.written.push("]");
        if tuple(array).is_some_and(|(least, most)| !(least..=most).contains(&count)) {
            self.blame(at, FieldCode::WrongLength, || {
                format!("send {}, not an array of {count}", contract.expected_array(array))
            });
        }
        Ok(())
    }

    fn members<'de, A: MapAccess<'de>>(
        &mut self,
        at: &Path,
        object: &'c Object,
        mut sent: A,
    ) -> Result<(), A::Error> {
        let contract = self.contract;
        let others = match object.additional_properties.as_deref() {
            Some(AdditionalProperties::RefOr(schema)) => Some(schema),
            _ => None,
        };
        let mut found: Vec<&String> = Vec::with_capacity(object.required.len());
        let mut names = Names::default();
        self.written.push("{");
        let first = self.written.mark();
        while let Some(name) = sent.next_key_seed(Name)? {
            let member = Path::Member(at, &name);
            let mark = self.written.mark();
            self.written.separate(first);
            self.written.name(&name);
            let Some(schema) = object.properties.get(&*name).or(others) else {
                self.blame(&member, FieldCode::UnknownField, || {
                    let known: Vec<&str> = object.properties.keys().map(String::as_str).collect();
                    words::unknown_member(&name, &known)
                });
                sent.next_value_seed(Unchecked(self))?;
                names.add(name)?;
                continue;
            };
            let asked = contract.asked(schema);
            let check = ValueCheck { walk: &mut *self, at: &member, asked, is_member: true };
            match sent.next_value_seed(check)? {
                Sent::Absent => self.written.back_to(mark),
                Sent::Value => found.extend(object.required.iter().find(|required| **required == *name)),
            }
            names.add(name)?;
        }
        self.written.push("}");
        for name in object.required.iter().filter(|name| !found.contains(name)) {
            self.missing(&Path::Member(at, name), name);
        }
        Ok(())
    }
}

/// What the walk has met at a place.
enum Sent {
    /// A `null` that stands for an absent member.
    Absent,
    Value,
}

/// Checks the value at a place.
struct ValueCheck<'p, 'c> {
    walk: &'p mut Walk<'c>,
    at: &'p Path<'p>,
    asked: Asked<'c>,
    /// Whether the value belongs to a member, which counts as absent where the value is `null`.
    is_member: bool,
}

impl ValueCheck<'_, '_> {
    /// Whether a number is legal and need not be written: the short way for coordinates, of which a body has
    /// millions.
    fn takes(&self, number: f64) -> bool {
        match self.asked.usual {
            Some((_, Schema::Object(object))) => {
                matches!(object.schema_type, SchemaType::Type(Type::Number))
                    && self.asked.choices.is_empty()
                    && !self.walk.written.is_kept()
                    && range(object).holds(number)
            }
            _ => false,
        }
    }

    fn scalar<E>(self, sent: &Value) -> Result<Sent, E> {
        if self.is_member && sent.is_null() {
            return Ok(Sent::Absent);
        }
        self.walk.scalar(self.at, self.asked, sent);
        Ok(Sent::Value)
    }
}

impl<'de> DeserializeSeed<'de> for ValueCheck<'_, '_> {
    type Value = Sent;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<Sent, D::Error> {
        self.walk.patience.spend()?;
        let objects = self.walk.contract.objects(&self.asked);
        if !objects.is_empty() {
            let sent = <&RawValue>::deserialize(deserializer)?;
            return match outline(sent)? {
                Value::Object(_) => {
                    self.walk.choice(self.at, &objects, sent).map(|()| Sent::Value).map_err(D::Error::custom)
                }
                _ => serde_json::Deserializer::from_str(sent.get())
                    .deserialize_any(self)
                    .map_err(D::Error::custom),
            };
        }
        let Some((name, Schema::OneOf(OneOf { discriminator: Some(kinds), .. }))) = self.asked.usual else {
            return deserializer.deserialize_any(self);
        };
        let sent = <&RawValue>::deserialize(deserializer)?;
        match outline(sent)? {
            Value::Object(_) => self.walk.union(self.at, name, kinds, sent).map_err(D::Error::custom)?,
            array @ Value::Array(_) => {
                self.walk.unfit(self.at, self.asked, &array);
                let mut reader = serde_json::Deserializer::from_str(sent.get());
                Unchecked(self.walk).deserialize(&mut reader).map_err(D::Error::custom)?;
            }
            scalar => return self.scalar(&scalar),
        }
        Ok(Sent::Value)
    }
}

impl<'de> Visitor<'de> for ValueCheck<'_, '_> {
    type Value = Sent;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a JSON value")
    }

    fn visit_bool<E>(self, sent: bool) -> Result<Sent, E> {
        self.scalar(&sent.into())
    }

    fn visit_i64<E>(self, sent: i64) -> Result<Sent, E> {
        if self.takes(sent as f64) { Ok(Sent::Value) } else { self.scalar(&sent.into()) }
    }

    fn visit_u64<E>(self, sent: u64) -> Result<Sent, E> {
        if self.takes(sent as f64) { Ok(Sent::Value) } else { self.scalar(&sent.into()) }
    }

    fn visit_f64<E>(self, sent: f64) -> Result<Sent, E> {
        if self.takes(sent) { Ok(Sent::Value) } else { self.scalar(&sent.into()) }
    }

    fn visit_str<E>(self, sent: &str) -> Result<Sent, E> {
        self.scalar(&sent.into())
    }

    fn visit_unit<E>(self) -> Result<Sent, E> {
        self.scalar(&Value::Null)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut sent: A) -> Result<Sent, A::Error> {
        if let Some((_, Schema::Array(array))) = self.asked.usual {
            self.walk.elements(self.at, array, sent)?;
            return Ok(Sent::Value);
        }
        self.walk.unfit(self.at, self.asked, &Value::Array(Vec::new()));
        self.walk.written.push("[");
        let first = self.walk.written.mark();
        loop {
            let mark = self.walk.written.mark();
            self.walk.written.separate(first);
            if sent.next_element_seed(Unchecked(self.walk))?.is_none() {
                self.walk.written.back_to(mark);
                break;
            }
        }
        self.walk.written.push("]");
        Ok(Sent::Value)
    }

    fn visit_map<A: MapAccess<'de>>(self, mut sent: A) -> Result<Sent, A::Error> {
        let contract = self.walk.contract;
        if let Some(object) = contract.object_of(&self.asked) {
            self.walk.members(self.at, object, sent)?;
            return Ok(Sent::Value);
        }
        self.walk.unfit(self.at, self.asked, &Value::Object(Map::new()));
        self.walk.written.push("{");
        let first = self.walk.written.mark();
        let mut names = Names::default();
        while let Some(name) = sent.next_key_seed(Name)? {
            self.walk.written.separate(first);
            self.walk.written.name(&name);
            sent.next_value_seed(Unchecked(self.walk))?;
            names.add(name)?;
        }
        self.walk.written.push("}");
        Ok(Sent::Value)
    }
}

/// Reads a value to which no schema applies, and writes the value as it was sent.
struct Unchecked<'p, 'c>(&'p mut Walk<'c>);

impl<'de> DeserializeSeed<'de> for Unchecked<'_, '_> {
    type Value = ();

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<(), D::Error> {
        let Self(walk) = self;
        walk.patience.spend()?;
        if !walk.written.is_kept() {
            return AnyValue(&mut walk.patience).deserialize(deserializer);
        }
        walk.written.push(<&RawValue>::deserialize(deserializer)?.get());
        Ok(())
    }
}

fn is_whole(number: &Number) -> bool {
    !number.is_f64() || number.as_f64().is_some_and(|value| value.fract() == 0.0)
}

//! Finds all violations of a body that does not decode, by the schema of its request.
//!
//! # Method
//! One pass goes over the body and the schema side by side. The schema is the schema that the contract
//! publishes, so a violation is found exactly where the body breaks the contract.
//!
//! The pass also writes the body as the decoder needs it: a member that is `null` is left out, and a whole
//! number with a decimal point, such as `12.0`, becomes an integer where the schema says so.
//!
//! # Guarantees
//! * If the decoder refuses what the pass has written, the pass has found a violation.
//! * Every object is closed: a member that the schema does not name is a violation, even a member that is
//!   `null`. The contract leaves the schema of a toolpath open for answers only.
//!
//! # Cost
//! The time is linear in the size of the body. Nesting is as deep as the JSON parser allows.
//!
//! # What it leaves to the rules of a request
//! Whatever depends on several members or on settings of the server: the lengths of lists, members that
//! exclude each other, and the languages of texts.

use std::any::TypeId;
use std::collections::{BTreeMap, HashMap};
use std::sync::{Arc, LazyLock, Mutex, PoisonError};

use serde_json::{Map, Number, Value};
use utoipa::openapi::RefOr;
use utoipa::openapi::schema::{
    AdditionalProperties, Array, ArrayItems, Discriminator, Object, OneOf, Schema, SchemaType, Type,
};
use utoipa::{Number as Bound, ToSchema};

use super::check::{Range, Violations};
use super::path::Path;
use super::words;
use crate::http::error::{FieldCode, FieldError};

/// Most elements of an array whose length belongs to its type: a point, or a row of a Bezier patch. The
/// lengths of longer arrays depend on other members and on settings, so rules of the request judge them.
const LONGEST_TUPLE: usize = 4;

/// Whole numbers from here on may not be exact in floating point (2^53 is about 9.007e15).
const LARGEST_WHOLE: f64 = 9e15;

/// The schema of names of dialects. An unknown dialect has a code of its own.
const DIALECTS: &str = "DialectName";

/// The union, and its kinds that reports count and this version cannot read yet.
const PLANNED: (&str, &[&str]) = ("Move", &["spline"]);

/// The schema of a request, with all schemas that it refers to.
pub struct Contract {
    pub(super) request: RefOr<Schema>,
    named: BTreeMap<String, RefOr<Schema>>,
}

impl Contract {
    /// The contract of the request `T`. It is made at the first use and kept.
    pub fn of<T: ToSchema + 'static>() -> Arc<Self> {
        static MADE: LazyLock<Mutex<HashMap<TypeId, Arc<Contract>>>> = LazyLock::new(Mutex::default);
        let make = || {
            let mut named = Vec::new();
            T::schemas(&mut named);
            Arc::new(Self { request: T::schema(), named: named.into_iter().collect() })
        };
        let mut made = MADE.lock().unwrap_or_else(PoisonError::into_inner);
        Arc::clone(made.entry(TypeId::of::<T>()).or_insert_with(make))
    }

    /// Finds all violations of `body`, and writes `body` as the decoder needs it.
    pub fn check(&self, body: &mut Value) -> Violations {
        let mut pass = BodyCheck { contract: self, violations: Violations::default() };
        pass.value(&Path::Body, &self.request, body);
        pass.violations
    }

    /// The schema that `schema` refers to, and its name. Where the schema allows `null` besides another
    /// schema, the other schema. `None` where the name has no schema.
    pub(super) fn resolved<'a>(&'a self, schema: &'a RefOr<Schema>) -> Option<(&'a str, &'a Schema)> {
        let (name, schema) = match schema {
            RefOr::T(schema) => ("", schema),
            RefOr::Ref(reference) => {
                let (_, name) = reference.ref_location.rsplit_once('/')?;
                match self.named.get(name)? {
                    RefOr::T(schema) => (name, schema),
                    further @ RefOr::Ref(_) => return self.resolved(further),
                }
            }
        };
        match schema {
            Schema::OneOf(OneOf { discriminator: None, items, .. }) => {
                let is_null = |item: &&RefOr<Schema>| match item {
                    RefOr::T(Schema::Object(object)) => type_of(&object.schema_type) == Type::Null,
                    _ => false,
                };
                self.resolved(items.iter().find(|item| !is_null(item))?)
            }
            schema => Some((name, schema)),
        }
    }

    /// Of the schemas that `schema` lets choose from, the one that takes a value of the type of `value`;
    /// `schema` itself where there is no such choice.
    fn alternative<'a>(&'a self, schema: &'a RefOr<Schema>, value: &Value) -> &'a RefOr<Schema> {
        let own = match schema {
            RefOr::T(own) => Some(own),
            RefOr::Ref(reference) => {
                let name = reference.ref_location.rsplit('/').next();
                match name.and_then(|name| self.named.get(name)) {
                    Some(RefOr::T(own)) => Some(own),
                    _ => None,
                }
            }
        };
        let Some(Schema::OneOf(OneOf { discriminator: None, items, .. })) = own else { return schema };
        let takes = |item: &&RefOr<Schema>| match item {
            RefOr::T(Schema::Object(object)) => match type_of(&object.schema_type) {
                Type::Number => value.is_number(),
                Type::String => value.is_string(),
                _ => false,
            },
            _ => false,
        };
        items.iter().find(takes).unwrap_or(schema)
    }

    /// What a schema expects, for people.
    fn expectation(&self, schema: &Schema) -> String {
        match schema {
            Schema::Array(array) => self.expected_array(array),
            Schema::Object(object) => match type_of(&object.schema_type) {
                Type::String if object.enum_values.is_some() => words::one_of(&words::names(object)),
                Type::String => "a text".to_owned(),
                Type::Integer if range(object).min >= 0.0 => "a whole number of 0 or more".to_owned(),
                Type::Integer => "a whole number".to_owned(),
                Type::Number => "a number".to_owned(),
                Type::Boolean => "`true` or `false`".to_owned(),
                _ => "an object".to_owned(),
            },
            _ => "an object".to_owned(),
        }
    }

    fn expected_array(&self, array: &Array) -> String {
        let Some((least, most)) = tuple(array) else { return "an array".to_owned() };
        let length = if least == most { most.to_string() } else { format!("{least} or {most}") };
        match items(array).and_then(|items| self.resolved(items)) {
            Some((_, Schema::Object(object))) if type_of(&object.schema_type) == Type::Number => {
                format!("an array of {length} numbers")
            }
            _ => format!("an array of {length}"),
        }
    }
}

/// The pass over one body.
struct BodyCheck<'a> {
    contract: &'a Contract,
    violations: Violations,
}

impl BodyCheck<'_> {
    fn blame(&mut self, at: &Path, code: FieldCode, detail: impl FnOnce() -> String) {
        self.violations.add_made(|| FieldError::new(&at.pointer(), code, detail()));
    }

    fn value(&mut self, at: &Path, schema: &RefOr<Schema>, value: &mut Value) {
        let contract = self.contract;
        let schema = contract.alternative(schema, value);
        let Some((name, schema)) = contract.resolved(schema) else { return };
        match (schema, &mut *value) {
            (Schema::Array(array), Value::Array(elements)) => self.elements(at, array, elements),
            (Schema::OneOf(OneOf { discriminator: Some(kinds), .. }), Value::Object(members)) => {
                self.union(at, name, kinds, members);
            }
            (Schema::Object(object), sent) => match (type_of(&object.schema_type), sent) {
                (Type::Object, Value::Object(members)) => self.members(at, object, members),
                (Type::String, Value::String(text)) => self.text(at, name, object, text),
                (Type::Boolean, Value::Bool(_)) => {}
                (Type::Number, Value::Number(number)) => self.number(at, object, number),
                (Type::Integer, Value::Number(number)) if is_whole(number) => {
                    self.integer(at, object, number);
                }
                _ => self.wrong_type(at, schema, value),
            },
            _ => self.wrong_type(at, schema, value),
        }
    }

    fn wrong_type(&mut self, at: &Path, schema: &Schema, value: &Value) {
        let contract = self.contract;
        self.blame(at, FieldCode::WrongType, || words::wrong(&contract.expectation(schema), value));
    }

    fn elements(&mut self, at: &Path, array: &Array, elements: &mut [Value]) {
        if tuple(array).is_some_and(|(least, most)| !(least..=most).contains(&elements.len())) {
            let contract = self.contract;
            let sent = elements.len();
            self.blame(at, FieldCode::WrongLength, || {
                format!("send {}, not an array of {sent}", contract.expected_array(array))
            });
        }
        let Some(items) = items(array) else { return };
        for (k, element) in elements.iter_mut().enumerate() {
            self.value(&Path::Element(at, k), items, element);
        }
    }

    /// An object whose member `kind` says which other members the object has.
    fn union(&mut self, at: &Path, name: &str, kinds: &Discriminator, members: &mut Map<String, Value>) {
        let tag = kinds.property_name.as_str();
        let at_tag = Path::Member(at, tag);
        let names = || kinds.mapping.keys().map(String::as_str).collect::<Vec<_>>();
        match members.get(tag) {
            None | Some(Value::Null) => self.missing(&at_tag, tag),
            Some(Value::String(kind)) => match kinds.mapping.get(kind) {
                Some(target) => {
                    let body = RefOr::Ref(utoipa::openapi::Ref::new(target));
                    self.value_of_kind(at, &body, members);
                }
                None if name == PLANNED.0 && PLANNED.1.contains(&kind.as_str()) => {
                    self.blame(&at_tag, FieldCode::Unsupported, || {
                        format!("`{kind}` is not supported yet; use {}", words::one_of(&names()))
                    });
                }
                None => self.blame(&at_tag, FieldCode::UnknownValue, || words::unknown(kind, &names())),
            },
            Some(other) => {
                self.blame(&at_tag, FieldCode::WrongType, || words::wrong(&words::one_of(&names()), other));
            }
        }
    }

    fn value_of_kind(&mut self, at: &Path, schema: &RefOr<Schema>, members: &mut Map<String, Value>) {
        let contract = self.contract;
        if let Some((_, Schema::Object(object))) = contract.resolved(schema) {
            self.members(at, object, members);
        }
    }

    fn missing(&mut self, at: &Path, name: &str) {
        self.blame(at, FieldCode::MissingField, || format!("`{name}` is required"));
    }

    fn members(&mut self, at: &Path, object: &Object, members: &mut Map<String, Value>) {
        let others = match object.additional_properties.as_deref() {
            Some(AdditionalProperties::RefOr(schema)) => Some(schema),
            _ => None,
        };
        let schema_of = |name: &String| object.properties.get(name).or(others);
        members.retain(|name, value| !value.is_null() || schema_of(name).is_none());
        for (name, value) in members.iter_mut() {
            let at = Path::Member(at, name);
            match schema_of(name) {
                Some(schema) => self.value(&at, schema, value),
                None => self.blame(&at, FieldCode::UnknownField, || {
                    let known: Vec<&str> = object.properties.keys().map(String::as_str).collect();
                    words::unknown_member(name, &known)
                }),
            }
        }
        for name in object.required.iter().filter(|name| !members.contains_key(*name)) {
            self.missing(&Path::Member(at, name), name);
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
            self.violations.number(&at.pointer(), value, range, "");
        }
    }

    fn integer(&mut self, at: &Path, object: &Object, number: &mut Number) {
        let (value, range) = (number.as_f64().unwrap_or(f64::INFINITY), range(object));
        if !range.holds(value) {
            self.blame(at, FieldCode::OutOfRange, || words::outside(&*number, range.min, range.max));
        } else if number.is_f64() && value.abs() < LARGEST_WHOLE {
            *number = Number::from(value as i64);
        }
    }
}

fn is_whole(number: &Number) -> bool {
    !number.is_f64() || number.as_f64().is_some_and(|value| value.fract() == 0.0)
}

/// The type of a schema, but for `null`. `Null` if the schema allows only `null`, or names no type.
pub(super) fn type_of(types: &SchemaType) -> Type {
    match types {
        SchemaType::Type(own) => own.clone(),
        SchemaType::Array(types) => {
            types.iter().find(|own| **own != Type::Null).cloned().unwrap_or(Type::Null)
        }
        SchemaType::AnyValue => Type::Null,
    }
}

/// The least and the largest number of elements of an array whose length belongs to its type.
fn tuple(array: &Array) -> Option<(usize, usize)> {
    let most = array.max_items.filter(|most| *most <= LONGEST_TUPLE)?;
    Some((array.min_items.unwrap_or(0), most))
}

/// The schema of the elements of an array.
pub(super) fn items(array: &Array) -> Option<&RefOr<Schema>> {
    match &array.items {
        ArrayItems::RefOrSchema(items) => Some(items),
        ArrayItems::False => None,
    }
}

/// The legal numbers.
pub(super) fn range(object: &Object) -> Range {
    let value = |bound: &Bound| match *bound {
        Bound::Int(value) => value as f64,
        Bound::UInt(value) => value as f64,
        Bound::Float(value) => value,
    };
    Range {
        min: object.minimum.as_ref().map_or(f64::NEG_INFINITY, value),
        max: object.maximum.as_ref().map_or(f64::INFINITY, value),
    }
}

//! Finds all violations of a body, by the schema of its request.
//!
//! # Method
//! One walk over the text of the body reads it with the schema at its side. The schema is the schema that the
//! contract publishes, so a violation is found exactly where the body breaks the contract.
//!
//! A further walk writes the body as the decoder needs it, where the decoder refuses a body without a
//! violation: a member that is `null` is left out, and a whole number with a decimal point, such as `12.0`,
//! becomes an integer where the schema says so.
//!
//! # Guarantees
//! * If the decoder refuses what a walk has written, the walk has found a violation.
//! * Memory besides the written text is bounded by the depth of the contract and by the number of violations
//!   that are listed, whatever the size of the body.
//! * Every object is closed: a member that the schema does not name is a violation, even a member that is
//!   `null`. The contract leaves the schema of a toolpath open for answers only.
//!
//! # Cost
//! The time is linear in the size of the body. An object with a member `kind` is scanned twice before it is
//! read, to find its end and its kind.
//!
//! # What it leaves to the rules of a request
//! Whatever depends on several members or on settings of the server: the lengths of lists, members that
//! exclude each other, and the languages of texts.

mod outline;
mod walk;
mod written;

use std::any::TypeId;
use std::collections::{BTreeMap, HashMap};
use std::sync::{Arc, LazyLock, Mutex, PoisonError};

use utoipa::openapi::RefOr;
use utoipa::openapi::schema::{Array, ArrayItems, Object, OneOf, Schema, SchemaType, Type};
use utoipa::{Number as Bound, ToSchema};

use super::check::{Range, Violations};
use super::json::Unread;
use super::words;
use toolpathd_core::budget::Budget;
use walk::Walk;
use written::Written;

/// Most elements of an array whose length belongs to its type: a point, or a row of a Bezier patch. The
/// lengths of longer arrays depend on other members and on settings, so rules of the request judge them.
const LONGEST_TUPLE: usize = 4;

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

    /// Finds all violations of the body with this text.
    ///
    /// # Errors
    /// When `text` is not JSON, or `budget` stops the walk.
    pub fn check(&self, text: &str, budget: &Budget) -> Result<Checked, Unread> {
        Walk::new(self, Written::forgotten(), budget).over(text).map(|(checked, _)| checked)
    }

    /// Writes the body with this text as the decoder needs it.
    ///
    /// # Errors
    /// As [`Self::check`].
    pub fn written(&self, text: &str, budget: &Budget) -> Result<String, Unread> {
        Walk::new(self, Written::kept(), budget).over(text).map(|(_, written)| written.text())
    }

    /// The schema that `schema` refers to, and its name. Where the schema allows `null` besides another
    /// schema, the other schema. `None` where the name has no schema.
    pub(super) fn resolved<'a>(&'a self, schema: &'a RefOr<Schema>) -> Option<(&'a str, &'a Schema)> {
        match schema {
            RefOr::T(schema) => self.without_null("", schema),
            RefOr::Ref(reference) => self.at(&reference.ref_location),
        }
    }

    /// As [`Self::resolved`], for the location of a schema, such as `#/components/schemas/Point`.
    fn at(&self, location: &str) -> Option<(&str, &Schema)> {
        let (_, name) = location.rsplit_once('/')?;
        match self.named.get_key_value(name)? {
            (name, RefOr::T(schema)) => self.without_null(name, schema),
            (_, further @ RefOr::Ref(_)) => self.resolved(further),
        }
    }

    fn without_null<'a>(&'a self, name: &'a str, schema: &'a Schema) -> Option<(&'a str, &'a Schema)> {
        match schema {
            Schema::OneOf(OneOf { discriminator: None, items, .. }) => {
                self.resolved(items.iter().find(|item| !is_null(item))?)
            }
            schema => Some((name, schema)),
        }
    }

    /// What `schema` asks for, with references followed.
    fn asked<'a>(&'a self, schema: &'a RefOr<Schema>) -> Asked<'a> {
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
        let Some(Schema::OneOf(OneOf { discriminator: None, items, .. })) = own else {
            return Asked { usual: self.resolved(schema), choices: &[] };
        };
        let mut others = items.iter().filter(|item| !is_null(item));
        match (others.next(), others.next()) {
            // The schema allows `null` besides another schema, which may have choices of its own.
            (Some(other), None) if items.len() > 1 => self.asked(other),
            _ => Asked { usual: self.resolved(schema), choices: items },
        }
    }

    /// The schema of an object among those that are asked for.
    fn object_of<'a>(&'a self, asked: &Asked<'a>) -> Option<&'a Object> {
        let chosen = asked.choices.iter().map(|choice| self.resolved(choice));
        std::iter::once(asked.usual).chain(chosen).flatten().find_map(|(_, schema)| match schema {
            Schema::Object(object) if type_of(&object.schema_type) == Type::Object => Some(object),
            _ => None,
        })
    }

    /// The objects among the choices for a value, where there are several, and the kinds by which they are
    /// told apart. One of them may have no kind.
    fn objects<'a>(&'a self, asked: &Asked<'a>) -> Vec<(Option<&'a str>, Asked<'a>)> {
        // Only references to named schemas are several objects.
        if asked.choices.iter().filter(|choice| matches!(choice, RefOr::Ref(_))).count() < 2 {
            return Vec::new();
        }
        let objects = asked.choices.iter().filter_map(|choice| match self.resolved(choice)? {
            (name, schema @ Schema::Object(object)) if type_of(&object.schema_type) == Type::Object => {
                Some((kind_of(object), Asked { usual: Some((name, schema)), choices: &[] }))
            }
            _ => None,
        });
        let objects: Vec<_> = objects.collect();
        if objects.len() > 1 { objects } else { Vec::new() }
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

/// The only legal text of the member `kind` of an object.
fn kind_of(object: &Object) -> Option<&str> {
    match object.properties.get("kind")? {
        RefOr::T(Schema::Object(kind)) => kind.enum_values.as_ref()?.first()?.as_str(),
        _ => None,
    }
}

/// Whether a schema allows `null` alone.
fn is_null(schema: &RefOr<Schema>) -> bool {
    match schema {
        RefOr::T(Schema::Object(object)) => type_of(&object.schema_type) == Type::Null,
        _ => false,
    }
}

/// What a walk has found.
pub struct Checked {
    pub violations: Violations,
    /// Whether there is a violation that the decoder refuses. The rules of the request judge the others.
    pub is_refused: bool,
}

/// What a schema asks for at a place of the body.
#[derive(Clone, Copy)]
struct Asked<'a> {
    /// The schema and its name. `None` where its name has no schema.
    usual: Option<(&'a str, &'a Schema)>,
    /// The schemas to choose from by the type of the value.
    choices: &'a [RefOr<Schema>],
}

impl<'a> Asked<'a> {
    /// The schema for a value of the type `sent`.
    fn of(&self, sent: &Type) -> Option<(&'a str, &'a Schema)> {
        let takes = |item: &&RefOr<Schema>| match item {
            RefOr::T(Schema::Object(object)) => type_of(&object.schema_type) == *sent,
            _ => false,
        };
        match self.choices.iter().find(takes) {
            Some(RefOr::T(schema)) if [Type::Number, Type::String].contains(sent) => Some(("", schema)),
            _ => self.usual,
        }
    }
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

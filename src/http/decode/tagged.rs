//! Objects that their member `kind` tells apart: the decoder, and the schema with its discriminator.
//!
//! The dispatch is by hand: a derived internally tagged enum buffers its content, and the path of an error
//! ends at the enum. Here the object is decoded from its own text. An error of the object travels inside the
//! message of the outer decoder, because an outer decoder passes on nothing but a message.

use serde::de::{Error, IgnoredAny};
use serde::{Deserialize, Deserializer};
use serde_json::value::RawValue;
use utoipa::openapi::schema::{Discriminator, ObjectBuilder, OneOfBuilder, Schema, Type};
use utoipa::openapi::{Ref, RefOr};

use super::decode_at;
use super::object::Object;
use super::words;
use crate::http::error::{FieldCode, FieldError};
use crate::http::pointer::Pointer;

/// Begins a packed error, as no message of a decoder begins, and separates its parts.
const MARK: char = '\u{1}';

/// Gives an enum of objects its decoder and its schema. Each object has a `_kind` of type [`Kind`]; the
/// schema of the object gets the member `kind` here. `later` names kinds that the contract has and this
/// version cannot read yet.
macro_rules! by_kind {
    (
        $(#[doc = $doc:literal])+
        #[derive($($derived:ident),+)]
        $(#[serde($($serde:tt)+)])?
        $name:ident { $($kind:literal => $variant:ident($body:ty)),+ $(,)? } $(later [$($later:literal),+])?
    ) => {
        $(#[doc = $doc])+
        #[derive($($derived),+)]
        $(#[serde($($serde)+)])?
        pub enum $name {
            $($variant($body)),+
        }

        impl<'de> serde::Deserialize<'de> for $name {
            fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
                use $crate::http::decode::tagged;
                let object = <&serde_json::value::RawValue as serde::Deserialize>::deserialize(deserializer)?;
                match tagged::kind_of::<D::Error>(object)?.as_str() {
                    $($kind => tagged::decode(object).map(Self::$variant),)+
                    other => Err(tagged::unknown(other, &[$($($later),+)?], &[$($kind),+])),
                }
            }
        }

        impl utoipa::PartialSchema for $name {
            fn schema() -> utoipa::openapi::RefOr<utoipa::openapi::schema::Schema> {
                let kinds = [$(($kind, <$body as utoipa::ToSchema>::name())),+];
                $crate::http::decode::tagged::union(concat!($($doc),+), kinds.iter())
            }
        }

        impl utoipa::ToSchema for $name {
            fn schemas(
                schemas: &mut Vec<(String, utoipa::openapi::RefOr<utoipa::openapi::schema::Schema>)>,
            ) {
                $(
                    let schema = <$body as utoipa::PartialSchema>::schema();
                    let schema = $crate::http::decode::tagged::with_kind($kind, schema);
                    schemas.push((<$body as utoipa::ToSchema>::name().into_owned(), schema));
                    <$body as utoipa::ToSchema>::schemas(schemas);
                )+
            }
        }
    };
}
pub(in crate::http) use by_kind;

/// The member `kind` of an object. The enum around the object has read it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Kind;

impl<'de> Deserialize<'de> for Kind {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        IgnoredAny::deserialize(deserializer).map(|_| Self)
    }
}

#[derive(Deserialize)]
struct Tag {
    kind: String,
}

/// The `kind` of an object.
///
/// # Errors
/// When it has none.
pub fn kind_of<E: Error>(object: &RawValue) -> Result<String, E> {
    decode::<Tag, E>(object).map(|tag| tag.kind)
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
    let (code, detail) = if later.contains(&kind) {
        let names = expected.join("`, `");
        (FieldCode::Unsupported, format!("`{kind}` is not supported yet; use one of `{names}`"))
    } else {
        (FieldCode::UnknownValue, words::unknown(kind, expected))
    };
    E::custom(pack(&FieldError::new(&at, code, detail)))
}

/// The schema of one of several objects, each given by its kind and the name of its schema.
pub fn union<'a, N: AsRef<str> + 'a>(
    description: &str,
    kinds: impl Iterator<Item = &'a (&'a str, N)>,
) -> RefOr<Schema> {
    let (mut one_of, mut mapping) = (OneOfBuilder::new(), Vec::new());
    for (kind, name) in kinds {
        let object = Ref::from_schema_name(name.as_ref());
        mapping.push(((*kind).to_owned(), object.ref_location.clone()));
        one_of = one_of.item(object);
    }
    let discriminator = Discriminator::with_mapping("kind", mapping);
    one_of.description(Some(description.trim())).discriminator(Some(discriminator)).into()
}

/// The schema of an object with its member `kind`.
pub fn with_kind(kind: &str, schema: RefOr<Schema>) -> RefOr<Schema> {
    let RefOr::T(Schema::Object(mut object)) = schema else { return schema };
    let tag = ObjectBuilder::new()
        .schema_type(Type::String)
        .enum_values(Some([kind]))
        .description(Some(format!("Always `{kind}`: says what this object is.")));
    object.properties.insert("kind".to_owned(), tag.into());
    object.required.insert(0, "kind".to_owned());
    RefOr::T(Schema::Object(object))
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

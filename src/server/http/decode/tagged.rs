//! Decodes objects whose member `kind` says which other members they have, and makes their schemas for the
//! contract.
//!
//! All kinds of such an object form a Rust enum. A macro writes the decoder of the enum. serde's own decoder
//! of such enums copies the object before it knows the kind; the macro's decoder reads the text twice, which
//! is faster.

use serde::de::{Error, IgnoredAny};
use serde::{Deserialize, Deserializer};
use serde_json::value::RawValue;
use utoipa::openapi::schema::{Discriminator, ObjectBuilder, OneOfBuilder, Schema, Type};
use utoipa::openapi::{Ref, RefOr};

use super::object::Object;

/// Makes an enum of objects with its decoder and its schema. Each object has a field `_kind` of type
/// [`Kind`]; this macro adds the member `kind` to the schema of the object.
macro_rules! by_kind {
    (
        $(#[doc = $doc:literal])+
        #[derive($($derived:ident),+)]
        $(#[serde($($serde:tt)+)])?
        $name:ident { $($kind:literal => $variant:ident($body:ty)),+ $(,)? }
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
                    _ => Err(serde::de::Error::custom("the kind is unknown")),
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
/// When the object has no `kind`.
pub fn kind_of<E: Error>(object: &RawValue) -> Result<String, E> {
    decode::<Tag, E>(object).map(|tag| tag.kind)
}

#[derive(Deserialize)]
struct OptionalTag {
    #[serde(default)]
    kind: Option<String>,
}

/// The `kind` of an object that may have none.
///
/// # Errors
/// When there is no object, or its `kind` is no text.
pub fn optional_kind_of<E: Error>(object: &RawValue) -> Result<Option<String>, E> {
    decode::<OptionalTag, E>(object).map(|tag| tag.kind)
}

/// Decodes the object as a `T`.
///
/// # Errors
/// When the object does not fit.
pub fn decode<'de, T: Deserialize<'de>, E: Error>(object: &'de RawValue) -> Result<T, E> {
    serde_json::from_str(object.get()).map(|Object(value)| value).map_err(E::custom)
}

/// The schema of an enum: one of several objects, each given by its kind and the name of its schema.
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

/// The schema of an object, with the member `kind` added.
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

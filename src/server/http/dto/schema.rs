//! Schemas of arrays and numbers with limits. Each schema has a name of its own, so that a field that refers
//! to the schema keeps its own description.

use utoipa::ToSchema;
use utoipa::openapi::schema::{ArrayBuilder, KnownFormat, ObjectBuilder, Schema, SchemaFormat, Type};
use utoipa::openapi::{Ref, RefOr};

use super::check::Range;

/// Makes a type that stands for a schema of the contract, from the description of the schema and its builder.
/// After `of` stands the type whose schema the builder refers to.
macro_rules! schema_of {
    ($name:ident $(of $of:ty)?, $description:literal, $builder:expr) => {
        #[doc = $description]
        pub enum $name {}

        impl utoipa::PartialSchema for $name {
            fn schema() -> utoipa::openapi::RefOr<utoipa::openapi::schema::Schema> {
                $builder.description(Some($description)).into()
            }
        }

        impl utoipa::ToSchema for $name {
            $(fn schemas(
                schemas: &mut Vec<(String, utoipa::openapi::RefOr<utoipa::openapi::schema::Schema>)>,
            ) {
                let schema = <$of as utoipa::PartialSchema>::schema();
                schemas.push((<$of as utoipa::ToSchema>::name().into_owned(), schema));
                <$of as utoipa::ToSchema>::schemas(schemas);
            })?
        }
    };
}
pub(in crate::http::dto) use schema_of;

/// A reference to the schema of `T`, which `schema_of` adds to the contract.
pub fn reference<T: ToSchema>() -> Ref {
    Ref::from_schema_name(T::name())
}

/// The schema of an array of `least` to `most` elements.
pub fn array_of(items: impl Into<RefOr<Schema>>, least: usize, most: usize) -> ArrayBuilder {
    ArrayBuilder::new().items(items.into()).min_items(Some(least)).max_items(Some(most))
}

/// The schema of a number in a range.
pub fn number(range: Range) -> ObjectBuilder {
    ObjectBuilder::new()
        .schema_type(Type::Number)
        .format(Some(SchemaFormat::KnownFormat(KnownFormat::Double)))
        .minimum(Some(range.min))
        .maximum(Some(range.max))
}

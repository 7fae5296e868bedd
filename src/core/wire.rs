//! The schemas of points in reports.

use utoipa::openapi::schema::{
    ArrayBuilder, KnownFormat, ObjectBuilder, OneOfBuilder, Schema, SchemaFormat, Type,
};
use utoipa::openapi::{Ref, RefOr};
use utoipa::{PartialSchema, ToSchema};

/// Stands for a `Point3` in a schema: an array `[x, y, z]` of any coordinates, in mm.
pub enum Place {}

impl PartialSchema for Place {
    fn schema() -> RefOr<Schema> {
        let number = SchemaFormat::KnownFormat(KnownFormat::Double);
        let number = ObjectBuilder::new().schema_type(Type::Number).format(Some(number));
        let place = ArrayBuilder::new().items(number).min_items(Some(3)).max_items(Some(3));
        place.description(Some("A point `[x, y, z]`, in mm.")).into()
    }
}

impl ToSchema for Place {}

/// Stands for a list of `Option<Point3>` in a schema.
pub enum Places {}

impl PartialSchema for Places {
    fn schema() -> RefOr<Schema> {
        let null = ObjectBuilder::new().schema_type(Type::Null);
        let item = OneOfBuilder::new().item(Ref::from_schema_name(Place::name())).item(null);
        ArrayBuilder::new().items(item).description(Some("Points `[x, y, z]`, in mm, or `null`.")).into()
    }
}

impl ToSchema for Places {}

//! The schemas of points in reports.

use utoipa::openapi::RefOr;
use utoipa::openapi::schema::{ArrayBuilder, KnownFormat, ObjectBuilder, Schema, SchemaFormat, Type};
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

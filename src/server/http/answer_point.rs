//! The point of an answer, which may lie anywhere.

use nalgebra::Point3;
use serde::Serialize;
use utoipa::openapi::RefOr;
use utoipa::openapi::schema::{ArrayBuilder, KnownFormat, ObjectBuilder, Schema, SchemaFormat, Type};
use utoipa::{PartialSchema, ToSchema};

/// A point `[x, y, z]` in an answer, in mm. Unlike a point in a request it may have any coordinates.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Place(pub [f64; 3]);

impl From<Point3<f64>> for Place {
    fn from(point: Point3<f64>) -> Self {
        Self(point.into())
    }
}

impl PartialSchema for Place {
    fn schema() -> RefOr<Schema> {
        let number = SchemaFormat::KnownFormat(KnownFormat::Double);
        let number = ObjectBuilder::new().schema_type(Type::Number).format(Some(number));
        let place = ArrayBuilder::new().items(number).min_items(Some(3)).max_items(Some(3));
        place.description(Some("A point `[x, y, z]`, in mm.")).into()
    }
}

impl ToSchema for Place {}

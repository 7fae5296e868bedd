//! Points and vectors, `[x, y, z]`.

use std::fmt;

use nalgebra::{Point3, Vector3};
use serde::de::{Error, IgnoredAny, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize};
use utoipa::openapi::schema::{ArrayBuilder, KnownFormat, ObjectBuilder, Schema, SchemaFormat, Type};
use utoipa::openapi::{Ref, RefOr};
use utoipa::{PartialSchema, ToSchema};

use super::check::{MAX_MAGNITUDE_MM, Range, Violations};
use crate::http::pointer::Pointer;

/// A point in mm, or a vector.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Point(pub [f64; 3]);

impl Point {
    /// Whether every coordinate is of a legal magnitude.
    pub fn is_legal(&self) -> bool {
        self.0.iter().all(|x| x.abs() <= MAX_MAGNITUDE_MM)
    }

    /// Looks at every coordinate of element `k` of the array at `at`.
    pub fn check_in(&self, at: &Pointer, k: usize, violations: &mut Violations) {
        // Pointers are built for those to blame alone: a surface has very many points.
        for (axis, value) in self.0.into_iter().enumerate().filter(|(_, x)| x.abs() > MAX_MAGNITUDE_MM) {
            violations.number(&at.index(k).index(axis), value, Range::COORDINATE, "mm");
        }
    }
}

impl From<Point> for Point3<f64> {
    fn from(Point(xyz): Point) -> Self {
        xyz.into()
    }
}

impl From<Point> for Vector3<f64> {
    fn from(Point(xyz): Point) -> Self {
        xyz.into()
    }
}

impl From<Point3<f64>> for Point {
    fn from(point: Point3<f64>) -> Self {
        Self(point.into())
    }
}

impl<'de> Deserialize<'de> for Point {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_seq(Coordinates)
    }
}

struct Coordinates;

impl<'de> Visitor<'de> for Coordinates {
    type Value = Point;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a point [x, y, z]")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<Point, A::Error> {
        let mut xyz = [0.0; 3];
        for (k, coordinate) in xyz.iter_mut().enumerate() {
            *coordinate = seq.next_element()?.ok_or_else(|| A::Error::invalid_length(k, &self))?;
        }
        match seq.next_element::<IgnoredAny>()? {
            None => Ok(Point(xyz)),
            Some(_) => Err(A::Error::invalid_length(4, &self)),
        }
    }
}

impl PartialSchema for Point {
    fn schema() -> RefOr<Schema> {
        let coordinate = ObjectBuilder::new()
            .schema_type(Type::Number)
            .format(Some(SchemaFormat::KnownFormat(KnownFormat::Double)))
            .minimum(Some(-MAX_MAGNITUDE_MM))
            .maximum(Some(MAX_MAGNITUDE_MM));
        ArrayBuilder::new()
            .items(coordinate)
            .min_items(Some(3))
            .max_items(Some(3))
            .description(Some("A point `[x, y, z]` in mm, or a vector."))
            .into()
    }
}

impl ToSchema for Point {
    fn name() -> std::borrow::Cow<'static, str> {
        "Point".into()
    }
}

/// Points in a row, of which there must be some.
pub fn row_schema(max_items: usize) -> ArrayBuilder {
    ArrayBuilder::new()
        .items(RefOr::<Schema>::Ref(Ref::from_schema_name("Point")))
        .min_items(Some(2))
        .max_items(Some(max_items))
}

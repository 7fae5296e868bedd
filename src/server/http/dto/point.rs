//! Points and vectors in requests and toolpaths: `[x, y, z]` or `[x, y]`, in mm.

use std::fmt;

use nalgebra::{Point2, Point3, Vector3};
use serde::de::{Error, IgnoredAny, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use utoipa::openapi::RefOr;
use utoipa::openapi::schema::Schema;
use utoipa::{PartialSchema, ToSchema};

use super::check::{MAX_MAGNITUDE_MM, Range, Violations};
use super::schema::{array_of, number};
use crate::http::pointer::Pointer;

/// The coordinates of a point or a vector, in mm.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Coordinates<const N: usize>(pub [f64; N]);

/// A point or a vector in space.
pub type Point = Coordinates<3>;

/// A point or a vector in the plane.
pub type PlanePoint = Coordinates<2>;

impl<const N: usize> Serialize for Coordinates<N> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_seq(self.0)
    }
}

impl<const N: usize> Coordinates<N> {
    /// Whether every coordinate has a legal magnitude.
    pub fn is_legal(&self) -> bool {
        self.0.iter().all(|x| x.abs() <= MAX_MAGNITUDE_MM)
    }

    /// Checks every coordinate of this point, which is element `k` of the array at `at`.
    pub fn check_in(&self, at: &Pointer, k: usize, violations: &mut Violations) {
        self.check(&at.index(k), violations);
    }

    /// Checks every coordinate of the point at `at`.
    pub fn check(&self, at: &Pointer, violations: &mut Violations) {
        // Only illegal coordinates get a pointer, because a surface has very many points.
        for (axis, value) in self.0.into_iter().enumerate().filter(|(_, x)| x.abs() > MAX_MAGNITUDE_MM) {
            violations.number(&at.index(axis), value, Range::COORDINATE, "mm");
        }
    }
}

impl From<Point> for Point3<f64> {
    fn from(Coordinates(xyz): Point) -> Self {
        xyz.into()
    }
}

impl From<Point> for Vector3<f64> {
    fn from(Coordinates(xyz): Point) -> Self {
        xyz.into()
    }
}

impl From<PlanePoint> for Point2<f64> {
    fn from(Coordinates(xy): PlanePoint) -> Self {
        xy.into()
    }
}

impl From<Point3<f64>> for Point {
    fn from(point: Point3<f64>) -> Self {
        Self(point.into())
    }
}

impl<'de, const N: usize> Deserialize<'de> for Coordinates<N> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_seq(Sequence)
    }
}

struct Sequence<const N: usize>;

impl<'de, const N: usize> Visitor<'de> for Sequence<N> {
    type Value = Coordinates<N>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "a point {}", form(N))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<Self::Value, A::Error> {
        let mut coordinates = [0.0; N];
        for (k, coordinate) in coordinates.iter_mut().enumerate() {
            *coordinate = seq.next_element()?.ok_or_else(|| A::Error::invalid_length(k, &self))?;
        }
        match seq.next_element::<IgnoredAny>()? {
            None => Ok(Coordinates(coordinates)),
            Some(_) => Err(A::Error::invalid_length(N + 1, &self)),
        }
    }
}

/// How a point of 2 or 3 coordinates is written.
fn form(dimension: usize) -> &'static str {
    if dimension == 2 { "[x, y]" } else { "[x, y, z]" }
}

impl<const N: usize> PartialSchema for Coordinates<N> {
    fn schema() -> RefOr<Schema> {
        let description = format!("A point or a vector `{}`, in mm.", form(N));
        array_of(number(Range::COORDINATE), N, N).description(Some(description)).into()
    }
}

impl<const N: usize> ToSchema for Coordinates<N> {
    fn name() -> std::borrow::Cow<'static, str> {
        if N == 2 { "PlanePoint".into() } else { "Point".into() }
    }
}

/// A point in mm: in the plane z = 0, or in space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Position {
    Flat(PlanePoint),
    InSpace(Point),
}

impl Position {
    pub fn is_flat(&self) -> bool {
        matches!(self, Self::Flat(_))
    }

    /// Checks every coordinate of this point, which is element `k` of the array at `at`.
    pub fn check_in(&self, at: &Pointer, k: usize, violations: &mut Violations) {
        match self {
            Self::Flat(point) => point.check_in(at, k, violations),
            Self::InSpace(point) => point.check_in(at, k, violations),
        }
    }
}

impl From<Position> for Point3<f64> {
    fn from(position: Position) -> Self {
        match position {
            Position::Flat(Coordinates([x, y])) => Self::new(x, y, 0.0),
            Position::InSpace(point) => point.into(),
        }
    }
}

impl<'de> Deserialize<'de> for Position {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_seq(TwoOrThree)
    }
}

struct TwoOrThree;

impl<'de> Visitor<'de> for TwoOrThree {
    type Value = Position;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a point [x, y] or [x, y, z]")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<Position, A::Error> {
        let mut next = |k: usize| seq.next_element::<f64>().map(|value| (k, value));
        let needed =
            |(k, value): (usize, Option<f64>)| value.ok_or_else(|| A::Error::invalid_length(k, &self));
        let (x, y) = (needed(next(0)?)?, needed(next(1)?)?);
        let Some(z) = next(2)?.1 else { return Ok(Position::Flat(Coordinates([x, y]))) };
        match seq.next_element::<IgnoredAny>()? {
            None => Ok(Position::InSpace(Coordinates([x, y, z]))),
            Some(_) => Err(A::Error::invalid_length(4, &self)),
        }
    }
}

impl PartialSchema for Position {
    fn schema() -> RefOr<Schema> {
        let description = "A point in mm: `[x, y]`, at z = 0, or `[x, y, z]`.";
        array_of(number(Range::COORDINATE), 2, 3).description(Some(description)).into()
    }
}

impl ToSchema for Position {
    fn name() -> std::borrow::Cow<'static, str> {
        "Position".into()
    }
}

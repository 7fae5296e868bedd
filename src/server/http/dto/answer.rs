//! The members of all computed answers, and the members of answers with a toolpath.

use std::borrow::Cow;

use nalgebra::Point3;
use serde::{Serialize, Serializer};
use utoipa::openapi::RefOr;
use utoipa::openapi::schema::{Object, ObjectBuilder, RefBuilder, Schema, Type};
use utoipa::{PartialSchema, ToSchema};

use super::meta::{Meta, MetaTexts};
use super::point::Point;
use super::toolpath::Toolpath;
use crate::http::ENGINE_VERSION;
use crate::http::messages::Warning;
use toolpathd_core::toolpath::flattened::Points;
use toolpathd_core::toolpath::measure::Measures;

/// The answer of a computation: the members of every answer, the report of the operation, and the members of
/// its product.
#[derive(Serialize)]
pub struct Answer<R, M = PathMembers> {
    #[serde(flatten)]
    pub head: Head,
    pub report: R,
    #[serde(flatten)]
    pub members: M,
    /// The file of the form `glb`, in base64.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub glb: Option<String>,
    #[serde(flatten)]
    pub points: Option<PointMembers>,
}

/// The toolpath as points, for callers that draw no arcs.
#[derive(Serialize, ToSchema)]
pub struct PointMembers {
    /// The places of the tip `[x, y, z]` along all moves, in mm, without arcs. Present with `?points=true`.
    #[serde(serialize_with = "write_points")]
    #[schema(value_type = Vec<Point>)]
    polyline: Vec<Point3<f64>>,
    /// How far the lines of `polyline` may be from the moves, in mm: 0.001, or more where there would be more
    /// than two million points.
    polyline_chord_mm: f64,
}

impl From<Points> for PointMembers {
    fn from(Points { points, chord_mm }: Points) -> Self {
        Self { polyline: points, polyline_chord_mm: chord_mm }
    }
}

fn write_points<S: Serializer>(points: &[Point3<f64>], serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_seq(points.iter().map(|point| Point::from(*point)))
}

/// What every answer holds.
#[derive(Serialize, ToSchema)]
pub struct Head {
    /// Version of the service. The same request to the same version gives the same answer.
    pub engine_version: &'static str,
    /// The texts of `meta` in the request. Absent where the request has no `meta`.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(value_type = Option<MetaTexts>)]
    pub meta: Option<Meta>,
    /// What to know before the program runs; an empty list where there is nothing.
    pub warnings: Vec<Warning>,
}

impl Head {
    pub fn new(meta: Option<Meta>, warnings: Vec<Warning>) -> Self {
        Self { engine_version: ENGINE_VERSION, meta, warnings }
    }
}

/// The members of an answer with a toolpath.
#[derive(Default, Serialize, ToSchema)]
pub struct PathMembers {
    /// Lengths and times of the toolpath. Absent where the endpoint makes no toolpath, and where
    /// `/v1/arcs/fit` rewrites an NC program.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub measures: Option<Measures>,
    /// The text of the NC program. Present with `?nc=true`, and in answers of `/v1/programs/write`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub nc: Option<String>,
    /// The moves. Absent where `measures` is absent, with `?toolpath=false`, and where the answer has `nc`
    /// unless `?toolpath=true` asks for the moves.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub toolpath: Option<Toolpath>,
}

/// The further members of an answer that has only a report: none.
pub type NoMembers = ();

impl<R: ToSchema, M: ToSchema> PartialSchema for Answer<R, M> {
    fn schema() -> RefOr<Schema> {
        let report = RefBuilder::new()
            .ref_location_from_schema_name(R::name())
            .description(Some("What the operation found and proved."));
        let glb = ObjectBuilder::new()
            .schema_type(Type::String)
            .content_encoding("base64")
            .content_media_type("model/gltf-binary")
            .description(Some("The binary glTF file, in base64. Present with `?glb=true`."));
        let answer = ObjectBuilder::new()
            .description(Some("The answer of a computation."))
            .property("report", report.build())
            .required("report")
            .property("glb", glb)
            .build();
        let optional = |mut points: Object| {
            points.required.clear();
            points.into()
        };
        let points = match PointMembers::schema() {
            RefOr::T(Schema::Object(points)) => optional(points),
            other => other,
        };
        joined([answer.into(), Head::schema(), M::schema(), points])
    }
}

/// The schema of an object with the members of several objects, and the description of the first.
pub fn joined<const N: usize>(parts: [RefOr<Schema>; N]) -> RefOr<Schema> {
    let objects = parts.into_iter().filter_map(|part| match part {
        RefOr::T(Schema::Object(object)) => Some(object),
        _ => None,
    });
    let all = objects.reduce(|mut all, part| {
        all.properties.extend(part.properties);
        all.required.extend(part.required);
        all
    });
    all.unwrap_or_default().into()
}

impl<R: ToSchema, M: ToSchema> ToSchema for Answer<R, M> {
    fn name() -> Cow<'static, str> {
        format!("Answer_{}", R::name()).into()
    }

    fn schemas(schemas: &mut Vec<(String, RefOr<Schema>)>) {
        schemas.push((R::name().into_owned(), R::schema()));
        R::schemas(schemas);
        Head::schemas(schemas);
        M::schemas(schemas);
        PointMembers::schemas(schemas);
    }
}

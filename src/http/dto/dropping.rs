//! A request for dropping a cutter onto a surface, and where it touches.

use nalgebra::Point2;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;
use utoipa::openapi::schema::{ArrayBuilder, Schema};
use utoipa::openapi::{Ref, RefOr};

use super::check::Violations;
use super::meta::{self, Meta};
use super::object;
use super::point::{Place, PlanePoint};
use super::surface::Surface;
use super::tool::Tool;
use crate::config::Limits;
use crate::http::error::ApiError;
use crate::http::extract::IntoJob;
use crate::http::pointer::Pointer;
use crate::operations::cutter_location as core;

/// Where a cutter touches a surface.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct DropRequest {
    surface: Surface,
    #[serde(deserialize_with = "object::required")]
    tool: Tool,
    /// Places of the cutter's axis.
    #[schema(schema_with = points_schema)]
    points: Vec<PlanePoint>,
    /// Texts of the caller under names of the caller, returned as they came: at most 32.
    #[schema(schema_with = meta::schema)]
    meta: Option<Meta>,
}

fn points_schema() -> Schema {
    ArrayBuilder::new()
        .items(RefOr::<Schema>::Ref(Ref::from_schema_name(PlanePoint::name())))
        .min_items(Some(1))
        .max_items(Some(Limits::DEFAULT.drop_points))
        .into()
}

/// A request in the core's terms.
#[derive(Debug)]
pub struct DropJob {
    pub job: core::Job,
    pub meta: Option<Meta>,
}

impl IntoJob for DropRequest {
    type Job = DropJob;

    fn into_job(self, limits: &Limits) -> Result<DropJob, ApiError> {
        let Self { surface, tool, points, meta } = self;
        let root = Pointer::root();
        let mut violations = Violations::default();
        surface.check(&root.field("surface"), limits, &mut violations);
        tool.check(&root.field("tool"), &mut violations);
        check_points(&points, &root.field("points"), limits, &mut violations);
        if let Some(meta) = &meta {
            meta::check(meta, &root.field("meta"), &mut violations);
        }
        violations.result()?;
        let points = points.into_iter().map(Point2::from).collect();
        Ok(DropJob { job: core::Job { surface: surface.into(), tool: tool.into(), points }, meta })
    }
}

fn check_points(points: &[PlanePoint], at: &Pointer, limits: &Limits, violations: &mut Violations) {
    if !violations.count_of_points(at, points.len(), 1, limits.drop_points) {
        return;
    }
    for (k, point) in points.iter().enumerate().filter(|(_, point)| !point.is_legal()) {
        point.check_in(at, k, violations);
    }
}

/// Where the cutter touches.
#[derive(Debug, Clone, Serialize, ToSchema)]
pub struct DropReport {
    /// For each point the tip of the cutter that touches the surface from above; `null` beside the surface.
    #[schema(schema_with = places_schema)]
    tips: Vec<Option<Place>>,
    /// For each point a place at which the cutter touches; `null` beside the surface.
    #[schema(schema_with = places_schema)]
    contacts: Vec<Option<Place>>,
    /// Proved: no tip is farther below its true height, but for rounding.
    gap_max_mm: f64,
}

fn places_schema() -> Schema {
    let point = RefOr::<Schema>::Ref(Ref::from_schema_name(Place::name()));
    let null = utoipa::openapi::ObjectBuilder::new().schema_type(utoipa::openapi::schema::Type::Null);
    let place = utoipa::openapi::schema::OneOfBuilder::new().item(point).item(null);
    ArrayBuilder::new().items(place).into()
}

impl From<&[Option<core::Location>]> for DropReport {
    fn from(locations: &[Option<core::Location>]) -> Self {
        let all = || locations.iter();
        Self {
            tips: all().map(|at| at.map(|location| location.tip.into())).collect(),
            contacts: all().map(|at| at.map(|location| location.contact.into())).collect(),
            gap_max_mm: all().flatten().map(|location| location.gap_mm).fold(0.0, f64::max),
        }
    }
}

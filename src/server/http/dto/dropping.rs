//! The request to lower a cutter onto a surface.

use nalgebra::Point2;
use serde::Deserialize;
use utoipa::ToSchema;

use super::check::Violations;
use super::meta::{self, Meta, MetaTexts};
use super::point::PlanePoint;
use super::schema::{array_of, reference, schema_of};
use super::surface::Surface;
use super::tool::Tool;
use crate::config::Limits;
use crate::http::decode::IntoJob;
use crate::http::decode::files::FileReading;
use crate::http::decode::object;
use crate::http::error::ApiError;
use crate::http::messages::Warning;
use crate::http::pointer::Pointer;
use toolpathd_core::operations::cutter_location as core;

/// A surface, a cutter, and the places at which the cutter comes down.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct DropRequest {
    /// The surface that the cutter comes down onto.
    surface: Surface,
    /// The cutter.
    #[serde(deserialize_with = "object::required")]
    tool: Tool,
    /// The places of the cutter's axis: points `[x, y]` in mm.
    #[schema(value_type = DropPoints)]
    points: Vec<PlanePoint>,
    /// Up to 32 names with texts of your choice, for example part id, operation and work order. The answer
    /// and the sheet repeat the texts.
    #[schema(value_type = Option<MetaTexts>)]
    meta: Option<Meta>,
}

schema_of!(DropPoints of PlanePoint, "Points `[x, y]`, in mm.", {
    array_of(reference::<PlanePoint>(), 1, Limits::DEFAULT.drop_points)
});

/// A request in the core's terms.
#[derive(Debug)]
pub struct DropJob {
    pub job: core::Job,
    pub meta: Option<Meta>,
}

impl IntoJob for DropRequest {
    type Job = DropJob;

    fn read_files(&mut self, reading: &mut FileReading) {
        self.surface.read_file(&Pointer::root().field("surface"), reading);
    }

    fn put_right(&mut self, limits: &Limits) -> Vec<Warning> {
        self.surface.put_right(limits)
    }

    fn into_job(self, limits: &Limits) -> Result<DropJob, ApiError> {
        let Self { surface, tool, points, meta } = self;
        let root = Pointer::root();
        let mut violations = Violations::default();
        surface.check(&root.field("surface"), limits, &mut violations);
        let tool = tool.convert_mill(&root.field("tool"), &mut violations);
        check_points(&points, &root.field("points"), limits, &mut violations);
        meta::check(meta.as_ref(), &mut violations);
        violations.result()?;
        let points = points.into_iter().map(Point2::from).collect();
        Ok(DropJob { job: core::Job { surface: surface.into(), tool, points }, meta })
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

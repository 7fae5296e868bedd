//! The request to describe a surface, and the report.

use nalgebra::Vector3;
use serde::{Deserialize, Serialize, Serializer};
use utoipa::ToSchema;

use super::check::{Range, Violations};
use super::meta::{self, Meta, MetaTexts};
use super::surface::Surface;
use crate::config::Limits;
use crate::http::decode::IntoJob;
use crate::http::decode::files::FileReading;
use crate::http::decode::object;
use crate::http::error::ApiError;
use crate::http::messages::Warning;
use crate::http::pointer::Pointer;
use toolpathd_core::geometry::surface::any_surface::AnySurface;
use toolpathd_core::geometry::surface::{
    BezierSurface, BicubicPatch, Patch as _, RationalPatch, Surface as _,
};
use toolpathd_core::machining::wire_model::{self, Along, Wire};
use toolpathd_core::operations::surface_model as core;
use toolpathd_core::toolpath::measure::Bounds;
use toolpathd_core::wire::Place;

/// Most control points of all patches in one answer: those of 20,000 bicubic patches.
pub const MAX_CONTROL_POINTS: usize = 320_000;

/// Default of `chord_height_mm`: the largest distance of a wire from its chords, mm.
const DEFAULT_CHORD_HEIGHT_MM: f64 = 0.01;

/// Legal values of `chord_height_mm`, mm.
const CHORD_HEIGHT: Range = Range { min: 1e-6, max: 10.0 };

/// A surface to be described: patches, bounds, curvature and wires.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct ModelRequest {
    /// The surface.
    surface: Surface,
    /// The wires that the answer holds: curves on the surface at a fixed spacing. Without `wires` the answer
    /// holds none.
    #[serde(default, deserialize_with = "object::optional")]
    wires: Option<Wires>,
    /// Whether the answer holds the control nets of the patches.
    #[schema(default = true)]
    patches: Option<bool>,
    /// Up to 32 names with texts of your choice, for example part id, operation and work order. The answer
    /// and the sheet repeat the texts.
    #[schema(value_type = Option<MetaTexts>)]
    meta: Option<Meta>,
}

/// A family of wires: curves on the surface at a fixed spacing.
#[derive(Debug, Clone, Copy, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct Wires {
    /// Largest distance of neighbouring wires, in mm. The distance of wires along x or y is measured in plan,
    /// that of wires along u or v on the surface. A larger pitch makes fewer wires.
    #[schema(minimum = 0.001, maximum = 1_000_000)]
    pitch_mm: f64,
    /// The direction of the wires. `u` and `v`: along that parameter of the surface. `x`: along x, at
    /// constant y. `y`: along y, at constant x.
    #[serde(default)]
    #[schema(default = "u")]
    direction: Along,
    /// Largest distance of a wire from the straight lines between its points, in mm. A larger value makes
    /// fewer points.
    #[schema(minimum = 0.000_001, maximum = 10, default = 0.01)]
    chord_height_mm: Option<f64>,
}

/// A request in the core's terms.
#[derive(Debug)]
pub struct ModelJob {
    pub job: core::Job,
    pub with_patches: bool,
    pub meta: Option<Meta>,
}

impl IntoJob for ModelRequest {
    type Job = ModelJob;

    fn read_files(&mut self, reading: &mut FileReading) {
        self.surface.read_file(&Pointer::root().field("surface"), reading);
    }

    fn put_right(&mut self, limits: &Limits) -> Vec<Warning> {
        self.surface.put_right(limits)
    }

    fn into_job(self, limits: &Limits) -> Result<ModelJob, ApiError> {
        let Self { surface, wires, patches, meta } = self;
        let root = Pointer::root();
        let mut violations = Violations::default();
        surface.check(&root.field("surface"), limits, &mut violations);
        let wires = wires.map(|wires| wires.convert(&root.field("wires"), limits, &mut violations));
        meta::check(meta.as_ref(), &mut violations);
        violations.result()?;
        let with_patches = patches.unwrap_or(true);
        let control_point_limit = if with_patches { MAX_CONTROL_POINTS } else { usize::MAX };
        let job = core::Job { surface: surface.into(), wires, control_point_limit };
        Ok(ModelJob { job, with_patches, meta })
    }
}

impl Wires {
    fn convert(self, at: &Pointer, limits: &Limits, violations: &mut Violations) -> wire_model::WireJob {
        let Self { pitch_mm, direction, chord_height_mm } = self;
        violations.number(&at.field("pitch_mm"), pitch_mm, Range::POSITIVE, "mm");
        violations.optional(&at.field("chord_height_mm"), chord_height_mm, CHORD_HEIGHT, "mm");
        wire_model::WireJob {
            along: direction,
            pitch_mm,
            chord_height_mm: chord_height_mm.unwrap_or(DEFAULT_CHORD_HEIGHT_MM),
            wire_limit: limits.sections,
            point_limit: limits.wire_points,
        }
    }
}

/// What the surface is like.
#[derive(Serialize, ToSchema)]
pub struct ModelReport {
    /// Number of patches.
    n_patches: usize,
    /// The patches: `patches[i][j]` lies between the knots or points i and i + 1 along u, and j and j + 1
    /// along v. A bicubic patch is a 4 x 4 control net `net[a][b]` of points in mm, a along u. A rational
    /// patch, or a patch of another degree, is an object. Absent with `patches: false`.
    #[serde(skip_serializing_if = "Option::is_none", serialize_with = "write_patches")]
    #[schema(value_type = Option<Vec<Vec<Patch>>>)]
    patches: Option<AnySurface>,
    /// A box that holds the surface, in mm. Each side is at most 1e-6 mm farther out than the surface, except
    /// where the surface reaches its extreme coordinate along a whole curve: there the side may lie as far
    /// out as the control points.
    bounds: Bounds,
    /// The wires as polylines: points on the surface, in mm. Where a wire leaves the surface and comes back,
    /// a new polyline begins. Absent without `wires` in the request.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(value_type = Option<Vec<Vec<Place>>>)]
    wires: Option<Vec<Wire>>,
    /// Largest distance between the given points and the surface through these points, in mm. `null` for
    /// kinds of surfaces that do not pass through given points.
    #[schema(required)]
    fit_deviation_max_mm: Option<f64>,
    /// Proved upper bound of the curvature over all places and directions, in 1/mm, counted positive where
    /// the surface is concave seen from above and negative where it is convex. Where the value is above 0, a
    /// ball fits everywhere if its radius is less than 1 divided by the value. Where the value is 0 or
    /// negative, every ball fits. `null` where a place of the surface has no normal, or may have none.
    #[schema(required)]
    curvature_max_concave_per_mm: Option<f64>,
}

impl ModelReport {
    pub fn new(model: core::Model, with_patches: bool) -> Self {
        let [nu, nv] = model.surface.spans();
        let [min, max] = model.bounds;
        Self {
            n_patches: nu * nv,
            patches: with_patches.then_some(model.surface),
            bounds: Bounds { min, max },
            wires: model.wires,
            fit_deviation_max_mm: model.fit_deviation_max_mm,
            curvature_max_concave_per_mm: model.curvature_max_concave_per_mm,
        }
    }
}

/// One patch: the 4 x 4 control net of a bicubic patch, or an object for any other patch.
#[derive(Serialize, ToSchema)]
#[serde(untagged)]
pub enum Patch {
    #[schema(value_type = [[Place; 4]; 4])]
    Bicubic(Box<[[Vector3<f64>; 4]; 4]>),
    General(GeneralPatch),
}

/// A rational patch, or a patch of another degree than 3.
#[derive(Serialize, ToSchema)]
pub struct GeneralPatch {
    /// Degrees along u and along v: two counts.
    degree: [usize; 2],
    /// Control points in mm: `net[a][b]`, a along u. The coordinates are not multiplied by the weights.
    #[schema(value_type = Vec<Vec<Place>>)]
    net: Vec<Vec<Vector3<f64>>>,
    /// Weights of the control points: plain numbers.
    weights: Vec<Vec<f64>>,
}

impl From<&BicubicPatch> for Patch {
    fn from(patch: &BicubicPatch) -> Self {
        Self::Bicubic(Box::new(patch.net))
    }
}

impl<const N: usize> From<&RationalPatch<N>> for Patch {
    fn from(patch: &RationalPatch<N>) -> Self {
        let [p, q] = patch.degree();
        let rows = |of: &dyn Fn(usize, usize) -> f64| -> Vec<Vec<f64>> {
            (0..=p).map(|a| (0..=q).map(|b| of(a, b)).collect()).collect()
        };
        let mut points = patch.control_points();
        Self::General(GeneralPatch {
            degree: [p, q],
            net: (0..=p).map(|_| points.by_ref().take(q + 1).collect()).collect(),
            weights: rows(&|a, b| patch.homogeneous(a, b).w),
        })
    }
}

/// Converts the patches one row at a time while they are written, so that no second copy of all is held.
fn write_patches<S: Serializer>(surface: &Option<AnySurface>, serializer: S) -> Result<S::Ok, S::Error> {
    match surface {
        None => serializer.serialize_none(),
        Some(AnySurface::Bicubic(surface)) => serializer.collect_seq(rows(surface)),
        Some(AnySurface::Rational(surface)) => serializer.collect_seq(rows(surface)),
        Some(AnySurface::HighDegree(surface)) => serializer.collect_seq(rows(surface)),
    }
}

fn rows<'a, P>(surface: &'a BezierSurface<P>) -> impl Iterator<Item = Vec<Patch>> + 'a
where
    P: toolpathd_core::geometry::surface::Patch,
    Patch: From<&'a P>,
{
    let [nu, nv] = surface.spans();
    (0..nu).map(move |i| (0..nv).map(|j| Patch::from(surface.patch(i, j))).collect())
}

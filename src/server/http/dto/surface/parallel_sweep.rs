//! The surface kind `parallel_sweep` in requests: a drive curve carried along a basic curve without being
//! rotated.

use nalgebra::{Point2, Point3};
use serde::Deserialize;
use utoipa::ToSchema;

use super::section_text::{Room, SectionText};
use crate::config::Limits;
use crate::http::decode::tagged::Kind;
use crate::http::dto::check::Violations;
use crate::http::pointer::Pointer;
use toolpathd_core::geometry::profile::Profile;
use toolpathd_core::geometry::surface::parallel_sweep as core;

/// A drive curve carried along a basic curve without turning: basic(u) + drive(v) - drive(0). The surface
/// starts at the start of the basic curve; only the shape of the drive curve counts, not its place. The
/// surface is exact. A sharp corner of either curve is an edge of the surface.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct ParallelSweep {
    #[serde(rename = "kind")]
    #[schema(ignore)]
    _kind: Kind,
    /// The basic curve, along u: points `x,y,z` in mm. A curve of points with two coordinates lies in the xz
    /// plane.
    basic: SectionText,
    /// The drive curve, along v: points `x,y,z` in mm. A curve of points with two coordinates lies in the yz
    /// plane.
    drive: SectionText,
}

impl ParallelSweep {
    pub fn check(&self, at: &Pointer, limits: &Limits, violations: &mut Violations) {
        let Self { _kind: _, basic, drive } = self;
        basic.check(&at.field("basic"), Room::PlaneOrSpace, limits, violations);
        drive.check(&at.field("drive"), Room::PlaneOrSpace, limits, violations);
    }

    /// Two corners of a box around the surface.
    pub fn bounds(&self) -> (Point3<f64>, Point3<f64>) {
        let [basic, drive] = self.curves();
        let ([low, high], [below, above]) = (basic.bounds(), drive.bounds());
        let start = drive.start().unwrap_or_default();
        (low + (below - start), high + (above - start))
    }

    fn curves(&self) -> [Profile<3>; 2] {
        let in_xz = |p: Point2<f64>| Point3::new(p.x, 0.0, p.y);
        let in_yz = |p: Point2<f64>| Point3::new(0.0, p.x, p.y);
        [self.basic.in_space(in_xz), self.drive.in_space(in_yz)]
    }
}

/// Converts a surface that has been checked.
impl From<ParallelSweep> for core::ParallelSweep {
    fn from(sweep: ParallelSweep) -> Self {
        let [basic, drive] = sweep.curves();
        Self { basic, drive }
    }
}

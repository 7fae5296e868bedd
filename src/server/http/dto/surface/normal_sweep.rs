//! The surface kind `normal_sweep` in requests: a drive curve carried along a basic curve, at right angles to
//! it.

use nalgebra::{Point2, Point3, Vector3};
use serde::Deserialize;
use utoipa::ToSchema;

use super::section_text::{Room, SectionText};
use crate::config::Limits;
use crate::http::decode::tagged::Kind;
use crate::http::dto::check::Violations;
use crate::http::pointer::Pointer;
use toolpathd_core::geometry::profile::Profile;
use toolpathd_core::geometry::surface::normal_sweep as core;

/// A drive curve carried along a basic curve at its height. The plane of the drive curve stays upright and at
/// right angles to the basic curve, seen from above. The surface is exact along lines and level arcs of the
/// basic curve, and within 2e-6 mm along other curves.
///
/// A sharp corner of the basic curve is mitred where two lines meet, also where a closed curve ends. Any
/// other sharp corner of the basic curve is refused. A drive curve is refused that reaches beyond the centre
/// of a rounding, or beyond the place where mitres meet. A sharp corner of the drive curve, and a mitred
/// corner, is an edge of the surface.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct NormalSweep {
    #[serde(rename = "kind")]
    #[schema(ignore)]
    _kind: Kind,
    /// The basic curve, along u: points `x,y,z` in mm. A curve of points with two coordinates lies in the xy
    /// plane.
    basic: SectionText,
    /// The drive curve, along v: points in mm, first the distance to the left of the basic curve seen from
    /// above, then the height.
    drive: SectionText,
}

impl NormalSweep {
    pub fn check(&self, at: &Pointer, limits: &Limits, violations: &mut Violations) {
        let Self { _kind: _, basic, drive } = self;
        basic.check(&at.field("basic"), Room::PlaneOrSpace, limits, violations);
        drive.check(&at.field("drive"), Room::PlaneOnly, limits, violations);
    }

    /// Two corners of a box around the surface. Mitres may reach out of the box.
    pub fn bounds(&self) -> (Point3<f64>, Point3<f64>) {
        let [low, high] = self.basic().bounds();
        let [below, above] = self.drive.in_plane().bounds();
        let reach = below.x.abs().max(above.x.abs());
        let around = Vector3::new(reach, reach, 0.0);
        (low + Vector3::z() * below.y - around, high + Vector3::z() * above.y + around)
    }

    fn basic(&self) -> Profile<3> {
        self.basic.in_space(|p: Point2<f64>| Point3::new(p.x, p.y, 0.0))
    }
}

/// Converts a surface that has been checked.
impl From<NormalSweep> for core::NormalSweep {
    fn from(sweep: NormalSweep) -> Self {
        Self { basic: sweep.basic(), drive: sweep.drive.in_plane() }
    }
}

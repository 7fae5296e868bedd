//! The surface kind `ruled` in requests: two curves, and straight lines between them.

use nalgebra::{Point2, Point3};
use serde::Deserialize;
use utoipa::ToSchema;

use super::section_text::{Room, SectionText};
use crate::config::Limits;
use crate::http::decode::tagged::Kind;
use crate::http::dto::check::Violations;
use crate::http::pointer::Pointer;
use toolpathd_core::geometry::profile::Profile;
use toolpathd_core::geometry::surface::ruled as core;

/// Two curves joined by straight lines. Each line joins two points at equal fractions of the lengths of the
/// curves. The surface is exact between two lines and between two arcs that turn by the same angle, and
/// within 1e-6 mm between other curves. A sharp corner of either curve is an edge of the surface.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct Ruled {
    #[serde(rename = "kind")]
    #[schema(ignore)]
    _kind: Kind,
    /// The first curve, along u at v = 0: points `x,y,z` in mm. A curve of points with two coordinates lies
    /// in the xy plane.
    first: SectionText,
    /// The second curve, along u at the largest v: points `x,y,z` in mm. A curve of points with two
    /// coordinates lies in the xy plane.
    second: SectionText,
}

impl Ruled {
    pub fn check(&self, at: &Pointer, limits: &Limits, violations: &mut Violations) {
        let Self { _kind: _, first, second } = self;
        first.check(&at.field("first"), Room::PlaneOrSpace, limits, violations);
        second.check(&at.field("second"), Room::PlaneOrSpace, limits, violations);
    }

    /// Two corners of the box around the control points of both curves.
    pub fn bounds(&self) -> (Point3<f64>, Point3<f64>) {
        let [[low, high], [below, above]] = self.curves().map(|curve| curve.bounds());
        (low.inf(&below), high.sup(&above))
    }

    fn curves(&self) -> [Profile<3>; 2] {
        let in_xy = |p: Point2<f64>| Point3::new(p.x, p.y, 0.0);
        [self.first.in_space(in_xy), self.second.in_space(in_xy)]
    }
}

/// Converts a surface that has been checked.
impl From<Ruled> for core::Ruled {
    fn from(ruled: Ruled) -> Self {
        let [first, second] = ruled.curves();
        Self { first, second }
    }
}

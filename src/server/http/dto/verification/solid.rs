//! Solids in requests: the stock and fixtures, with upright walls and level tops.

use nalgebra::Point3;
use serde::Deserialize;
use utoipa::ToSchema;

use crate::config::Limits;
use crate::http::decode::tagged::{Kind, by_kind};
use crate::http::dto::check::{Range, Violations};
use crate::http::dto::outline::{Islands, Outline, WalledRegion};
use crate::http::dto::point::{PlanePoint, Point};
use crate::http::error::FieldCode;
use crate::http::pointer::Pointer;
use toolpathd_core::operations::pocketing::Outlines;
use toolpathd_core::operations::verification as core;

by_kind! {
    /// A solid with upright walls, a level bottom and a level top; `kind` says which.
    #[derive(Debug)]
    Solid {
        "box" => Block(BoxSolid),
        "cylinder" => Cylinder(CylinderSolid),
        "outline" => Outline(OutlineSolid),
    }
}

/// A box along the axes.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct BoxSolid {
    #[serde(rename = "kind")]
    #[schema(ignore)]
    _kind: Kind,
    /// The corner with the least coordinates, in mm.
    min: Point,
    /// The corner with the largest coordinates, in mm.
    max: Point,
}

/// An upright cylinder.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct CylinderSolid {
    #[serde(rename = "kind")]
    #[schema(ignore)]
    _kind: Kind,
    /// The place of its axis in plan, in mm.
    center: PlanePoint,
    /// Its diameter, in mm.
    #[schema(minimum = 0.001, maximum = 1_000_000)]
    diameter_mm: f64,
    /// Height of its bottom, in mm.
    #[schema(minimum = -1_000_000, maximum = 1_000_000)]
    bottom_z_mm: f64,
    /// Height of its top, in mm; above `bottom_z_mm`.
    #[schema(minimum = -1_000_000, maximum = 1_000_000)]
    top_z_mm: f64,
}

/// A plate of any outline.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct OutlineSolid {
    #[serde(rename = "kind")]
    #[schema(ignore)]
    _kind: Kind,
    /// The outer outline, in mm.
    boundary: Outline,
    /// Outlines of holes, in mm. Default: none.
    #[schema(value_type = Option<Islands>)]
    islands: Option<Vec<Outline>>,
    /// Height of its bottom, in mm.
    #[schema(minimum = -1_000_000, maximum = 1_000_000)]
    bottom_z_mm: f64,
    /// Height of its top, in mm; above `bottom_z_mm`.
    #[schema(minimum = -1_000_000, maximum = 1_000_000)]
    top_z_mm: f64,
}

impl Solid {
    /// The raw part of this shape. Adds violations to `violations`.
    pub fn stock(self, at: &Pointer, limits: &Limits, violations: &mut Violations) -> core::Raw {
        match self {
            Self::Block(solid) => {
                let [low, high] = solid.corners(at, violations);
                core::Raw::Block { low, high }
            }
            Self::Cylinder(solid) => {
                solid.check(at, violations);
                core::Raw::Cylinder {
                    center: solid.center.into(),
                    radius_mm: 0.5 * solid.diameter_mm,
                    bottom_mm: solid.bottom_z_mm,
                    top_mm: solid.top_z_mm,
                }
            }
            Self::Outline(solid) => {
                let (bottom_mm, top_mm) = (solid.bottom_z_mm, solid.top_z_mm);
                core::Raw::Outline { outlines: solid.outlines(at, limits, violations), bottom_mm, top_mm }
            }
        }
    }

    /// The fixture of this shape; without outlines where the solid has violations, which are added to
    /// `violations`.
    pub fn fixture(self, at: &Pointer, limits: &Limits, violations: &mut Violations) -> core::Fixture {
        let before = violations.total();
        let raw = self.stock(at, limits, violations);
        if violations.total() > before {
            let outlines = Outlines { boundary: Vec::new(), islands: Vec::new() };
            return core::Fixture { outlines, bottom_mm: 0.0, top_mm: 0.0 };
        }
        let (outlines, bottom_mm, top_mm) = raw.outlines();
        core::Fixture { outlines, bottom_mm, top_mm }
    }
}

impl BoxSolid {
    fn corners(&self, at: &Pointer, violations: &mut Violations) -> [Point3<f64>; 2] {
        corners((&self.min, &self.max), at, violations)
    }
}

/// Two corners of a box along the axes, the second above the first on each axis.
pub fn corners((min, max): (&Point, &Point), at: &Pointer, violations: &mut Violations) -> [Point3<f64>; 2] {
    min.check(&at.field("min"), violations);
    max.check(&at.field("max"), violations);
    for (k, axis) in ["x", "y", "z"].into_iter().enumerate() {
        let (low, high) = (min.0[k], max.0[k]);
        if low >= high {
            let detail = format!("the largest {axis} {high} is not above the least {axis} {low}");
            violations.add(&at.field("max").index(k), FieldCode::OutOfRange, detail);
        }
    }
    [(*min).into(), (*max).into()]
}

impl CylinderSolid {
    fn check(&self, at: &Pointer, violations: &mut Violations) {
        self.center.check(&at.field("center"), violations);
        violations.number(&at.field("diameter_mm"), self.diameter_mm, Range::POSITIVE, "mm");
        check_heights((self.bottom_z_mm, self.top_z_mm), at, violations);
    }
}

impl OutlineSolid {
    fn outlines(self, at: &Pointer, limits: &Limits, violations: &mut Violations) -> Outlines {
        check_heights((self.bottom_z_mm, self.top_z_mm), at, violations);
        WalledRegion::new(self.boundary, self.islands).convert(at, limits, violations)
    }
}

fn check_heights((bottom, top): (f64, f64), at: &Pointer, violations: &mut Violations) {
    violations.number(&at.field("bottom_z_mm"), bottom, Range::COORDINATE, "mm");
    violations.number(&at.field("top_z_mm"), top, Range::COORDINATE, "mm");
    if top <= bottom {
        let detail = format!("the top at {top} mm is not above the bottom at {bottom} mm");
        violations.add(&at.field("top_z_mm"), FieldCode::OutOfRange, detail);
    }
}

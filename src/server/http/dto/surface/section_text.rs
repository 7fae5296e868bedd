//! Section curves that a request gives as texts.

use nalgebra::{Point2, Point3};
use serde::{Deserialize, Deserializer};
use utoipa::ToSchema;

use crate::config::Limits;
use crate::http::dto::check::Violations;
use crate::http::error::FieldCode;
use crate::http::pointer::Pointer;
use toolpathd_core::geometry::profile::Profile;
use toolpathd_core::language::section_curve::{Fault, SectionCurve, SectionCurveError};

/// A text in the language of section curves, in mm, such as `l(0,0,0) r(50,0,0,10) l(50,40,0)`. `l(x,y)` is a
/// corner of a polyline. `r(x,y,R)` is a corner rounded by the radius R; R = 0 leaves the corner sharp.
/// `b((x,y),...)` is a smooth curve through points: the C2 cubic spline with uniform parameters and natural
/// ends; `b(x,y),(x,y),...` is the same. White space separates the items. Points with three coordinates make
/// a curve in space: `l(x,y,z)`, `r(x,y,z,R)`, `b((x,y,z),...)`.
#[derive(Debug, ToSchema)]
#[schema(as = SectionText, value_type = String, max_length = 8_000_000, example = "l(0,0) r(50,0,10) l(50,40)")]
pub struct SectionText(Result<SectionCurve, SectionCurveError>);

/// The text is parsed while it is decoded, so that text and curve are never held together for long.
impl<'de> Deserialize<'de> for SectionText {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let text = String::deserialize(deserializer)?;
        Ok(Self(SectionCurve::parse(&text)))
    }
}

/// Whether a curve must lie in the plane.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Room {
    PlaneOnly,
    PlaneOrSpace,
}

impl SectionText {
    /// Collects the violations of the text at `at`.
    pub fn check(&self, at: &Pointer, room: Room, limits: &Limits, violations: &mut Violations) {
        let n_pieces = match &self.0 {
            Err(error) => {
                let code = match error.fault {
                    Fault::TextTooLong => FieldCode::TooLong,
                    Fault::TooManyPoints => FieldCode::LimitExceeded,
                    Fault::Coincident => FieldCode::Coincident,
                    _ => FieldCode::Syntax,
                };
                return violations.add_in_text(at, error.at, code, error.to_string());
            }
            Ok(SectionCurve::Plane(chain)) => chain.pieces().len(),
            Ok(SectionCurve::Space(chain)) => {
                if room == Room::PlaneOnly {
                    let detail = "the curve must lie in a plane: send points with two coordinates";
                    violations.add(at, FieldCode::WrongLength, detail);
                }
                chain.pieces().len()
            }
        };
        if n_pieces > limits.curve_points {
            let detail = format!(
                "the curve has {n_pieces} lines, arcs and cubics; send at most {}",
                limits.curve_points
            );
            violations.add(at, FieldCode::LimitExceeded, detail);
        }
    }

    /// The curve in space. `lifted` puts the points of a plane curve into space. Empty for an illegal text.
    pub fn in_space(&self, lifted: impl Fn(Point2<f64>) -> Point3<f64>) -> Profile<3> {
        match &self.0 {
            Ok(SectionCurve::Plane(chain)) => chain.profile().mapped(lifted),
            Ok(SectionCurve::Space(chain)) => chain.profile(),
            Err(_) => Profile::default(),
        }
    }

    /// The curve in the plane. Empty for an illegal text or a curve in space.
    pub fn in_plane(&self) -> Profile<2> {
        match &self.0 {
            Ok(SectionCurve::Plane(chain)) => chain.profile(),
            Ok(SectionCurve::Space(_)) | Err(_) => Profile::default(),
        }
    }
}

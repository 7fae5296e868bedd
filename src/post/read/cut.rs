//! Cutting motions of three axes, as steps.

use nalgebra::Point3;

use super::{Fault, Step};
use toolpathd_core::geometry::curve::{Arc, Curve, Direction, Line};
use toolpathd_core::geometry::plane::Plane;
use toolpathd_core::toolpath::arc_rule::{ArcRefusal, ArcRule};
use toolpathd_core::toolpath::units::FeedRate;

/// A cutting motion whose curve is not known yet. Places in mm.
#[derive(Debug, Clone, Copy)]
pub struct Cut {
    start: Point3<f64>,
    end: Point3<f64>,
    rate: FeedRate,
}

impl Cut {
    /// # Errors
    /// When a coordinate of the start or of the end is unknown.
    pub fn between(from: [Option<f64>; 3], to: [Option<f64>; 3], rate: FeedRate) -> Result<Self, Fault> {
        let known = |at: [Option<f64>; 3]| match at {
            [Some(x), Some(y), Some(z)] => Ok(Point3::new(x, y, z)),
            _ => Err(Fault::UnknownStart),
        };
        Ok(Self { start: known(from)?, end: known(to)?, rate })
    }

    pub fn start(&self) -> Point3<f64> {
        self.start
    }

    pub fn line(self) -> Step {
        let along = Curve::Line(Line { start: self.start, end: self.end });
        Step::Feed { along, rate: self.rate, radius_mismatch_mm: 0.0, center: None }
    }

    /// The arc about `center`, whose coordinate along the normal of the plane does not count.
    ///
    /// # Errors
    /// When the arc breaks a rule of `accepts`, or the points make no arc.
    pub fn arc(
        self,
        plane: Plane,
        direction: Direction,
        mut center: Point3<f64>,
        accepts: &ArcRule,
    ) -> Result<Step, Fault> {
        let Self { start, end, rate } = self;
        let normal = plane.axes()[2];
        center[normal] = start[normal];
        let [s, e, c] = [start, end, center].map(|p| plane.to_local(&p).xy());
        let radius_mismatch_mm = ((s - c).norm() - (e - c).norm()).abs();
        if let Some(refusal) = accepts.refusal(&(c - s), &(e - s)) {
            return Err(fault(refusal));
        }
        let arc = Arc::with_center_near(plane, direction, start, end, center).map_err(Fault::Arc)?;
        Ok(Step::Feed { along: Curve::Arc(arc), rate, radius_mismatch_mm, center: Some(center) })
    }
}

fn fault(refusal: ArcRefusal) -> Fault {
    match refusal {
        ArcRefusal::Radii { mismatch_mm } => Fault::RadiusMismatch { mismatch_mm },
        ArcRefusal::NoOwnCenter => Fault::NoOwnCenter,
        ArcRefusal::Turned { angle } => Fault::TurnedCenter { degrees: angle.to_degrees() },
    }
}

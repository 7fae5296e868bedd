//! A circular arc in a coordinate plane, or a helix about the plane's normal.

use std::f64::consts::TAU;

use nalgebra::{Point3, Vector3};

use crate::geometry::plane::Plane;

/// The sense of an arc, seen from the positive end of its plane's normal.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Direction {
    /// Clockwise, G2.
    Cw,
    /// Counterclockwise, G3.
    Ccw,
}

impl Direction {
    pub fn reversed(self) -> Self {
        match self {
            Direction::Cw => Direction::Ccw,
            Direction::Ccw => Direction::Cw,
        }
    }
}

/// Why three points do not make an arc.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum ArcError {
    #[error("a coordinate of the arc is not finite")]
    NotFinite,
    #[error("the arc's centre coincides with its start")]
    ZeroRadius,
    #[error("the radii at the arc's ends, {start_mm} and {end_mm} mm, do not agree")]
    RadiusMismatch { start_mm: f64, end_mm: f64 },
    #[error("the arc's centre is not in the plane of its start")]
    CenterOffPlane,
}

/// The radii of an arc's ends agree within this part of the coordinates' magnitude: it allows for the
/// rounding of a centre that was computed from the ends, and for nothing a control could see.
const RADIUS_AGREEMENT: f64 = 1e-9;

/// An arc about `center` from `start` to `end`. Equal ends in the plane make one full turn; ends that differ
/// along the normal make a helix of less than, or exactly, one turn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Arc {
    plane: Plane,
    direction: Direction,
    start: Point3<f64>,
    end: Point3<f64>,
    center: Point3<f64>,
    radius: f64,
    start_angle: f64,
    sweep: f64,
}

impl Arc {
    /// `center` has the start's coordinate along the plane's normal; all in mm.
    ///
    /// # Errors
    /// When a coordinate is not finite, the radius is zero, the two radii differ, or the centre lies off
    /// the start's plane.
    pub fn new(
        plane: Plane,
        direction: Direction,
        start: Point3<f64>,
        end: Point3<f64>,
        center: Point3<f64>,
    ) -> Result<Self, ArcError> {
        let [s, e, c] = [start, end, center].map(|p| plane.to_local(&p));
        if !(s + e + c).iter().all(|x| x.is_finite()) {
            return Err(ArcError::NotFinite);
        }
        let scale = 1.0 + s.amax().max(e.amax()).max(c.amax());
        if (c.z - s.z).abs() > RADIUS_AGREEMENT * scale {
            return Err(ArcError::CenterOffPlane);
        }
        let (from, to) = ((s - c).xy(), (e - c).xy());
        let (start_mm, end_mm) = (from.norm(), to.norm());
        if start_mm == 0.0 {
            return Err(ArcError::ZeroRadius);
        }
        if (start_mm - end_mm).abs() > RADIUS_AGREEMENT * scale {
            return Err(ArcError::RadiusMismatch { start_mm, end_mm });
        }
        let turn = from.perp(&to).atan2(from.dot(&to));
        let sweep = if s.xy() == e.xy() {
            TAU
        } else {
            match direction {
                Direction::Ccw => turn.rem_euclid(TAU),
                Direction::Cw => (-turn).rem_euclid(TAU),
            }
        };
        Ok(Self {
            plane,
            direction,
            start,
            end,
            center,
            radius: start_mm,
            start_angle: from.y.atan2(from.x),
            sweep,
        })
    }

    pub fn plane(&self) -> Plane {
        self.plane
    }

    pub fn direction(&self) -> Direction {
        self.direction
    }

    pub fn start(&self) -> Point3<f64> {
        self.start
    }

    pub fn end(&self) -> Point3<f64> {
        self.end
    }

    pub fn center(&self) -> Point3<f64> {
        self.center
    }

    /// Radius at the start, mm.
    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// The angle turned, radians, in 0..=2 pi whatever the direction.
    pub fn sweep(&self) -> f64 {
        self.sweep
    }

    /// How far the end lies from the start along the plane's normal, mm; zero for a plane arc.
    pub fn rise(&self) -> f64 {
        let n = self.plane.axes()[2];
        self.end[n] - self.start[n]
    }

    /// Length, mm.
    pub fn length(&self) -> f64 {
        (self.radius * self.sweep).hypot(self.rise())
    }

    /// The point at the fraction `t` of the length. The ends are returned exactly.
    pub fn point_at(&self, t: f64) -> Point3<f64> {
        if t <= 0.0 {
            return self.start;
        }
        if t >= 1.0 {
            return self.end;
        }
        let (sin, cos) = self.angle_at(t).sin_cos();
        let mut local = self.plane.to_local(&self.center);
        local.x += self.radius * cos;
        local.y += self.radius * sin;
        local.z += self.rise() * t;
        self.plane.to_workpiece(&local)
    }

    /// Distance from `p` to the arc, mm; for a helix the distance to the point at `p`'s own angle or to an
    /// end, which is never below the true distance.
    pub fn distance_to(&self, p: &Point3<f64>) -> f64 {
        let ends = (p - self.start).norm().min((p - self.end).norm());
        let local = self.plane.to_local(p) - self.plane.to_local(&self.center);
        match self.fraction_of_angle(local.y.atan2(local.x)) {
            Some(t) => {
                let radial = local.xy().norm() - self.radius;
                ends.min(radial.hypot(local.z - self.rise() * t))
            }
            None => ends,
        }
    }

    /// The fraction of the sweep at which the arc passes the angle `angle` (radians, in the local frame),
    /// if it does.
    pub fn fraction_of_angle(&self, angle: f64) -> Option<f64> {
        let turned = match self.direction {
            Direction::Ccw => (angle - self.start_angle).rem_euclid(TAU),
            Direction::Cw => (self.start_angle - angle).rem_euclid(TAU),
        };
        (turned <= self.sweep).then(|| turned / self.sweep)
    }

    /// The largest coordinate along `direction` over the arc; for a helix an upper bound.
    pub fn support(&self, direction: &Vector3<f64>) -> f64 {
        let [a, b, n] = self.plane.axes();
        let ends = self.start.coords.dot(direction).max(self.end.coords.dot(direction));
        let (da, db) = (direction[a], direction[b]);
        if self.fraction_of_angle(db.atan2(da)).is_none() {
            return ends;
        }
        let rise = (self.rise() * direction[n]).max(0.0);
        ends.max(self.center.coords.dot(direction) + self.radius * da.hypot(db) + rise)
    }

    /// The part between the fractions `from` < `to` of the length.
    pub fn part(&self, from: f64, to: f64) -> Arc {
        let mut center = self.center;
        center[self.plane.axes()[2]] += self.rise() * from;
        Arc {
            start: self.point_at(from),
            end: self.point_at(to),
            center,
            start_angle: self.angle_at(from),
            sweep: self.sweep * (to - from),
            ..*self
        }
    }

    pub fn translated(&self, by: &Vector3<f64>) -> Arc {
        Arc { start: self.start + by, end: self.end + by, center: self.center + by, ..*self }
    }

    fn angle_at(&self, t: f64) -> f64 {
        match self.direction {
            Direction::Ccw => self.start_angle + t * self.sweep,
            Direction::Cw => self.start_angle - t * self.sweep,
        }
    }
}

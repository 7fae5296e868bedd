//! A circular arc parallel to a coordinate plane, or a helix about a normal of that plane.

use std::f64::consts::TAU;

use nalgebra::{Point3, Vector3};

use crate::geometry::plane::Plane;

/// The direction of an arc: `cw` (G2) or `ccw` (G3).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, serde::Deserialize, utoipa::ToSchema))]
#[cfg_attr(feature = "wire", serde(rename_all = "snake_case"), schema(as = ArcDirection))]
pub enum Direction {
    /// Clockwise, seen from the positive side of the plane's normal.
    Cw,
    /// Counterclockwise.
    Ccw,
}

/// Why three points give no arc.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum ArcError {
    #[error("a coordinate of the arc is not finite")]
    NotFinite,
    #[error("the arc's centre coincides with its start")]
    ZeroRadius,
    #[error("the radii at the arc's ends, {start_mm} and {end_mm} mm, do not agree")]
    RadiusMismatch { start_mm: f64, end_mm: f64 },
    #[error("the arc's centre is not in the arc's plane through its start")]
    CenterOffPlane,
    #[error("the arc's ends are {gap_mm} mm apart, too close to tell a short arc from a full circle")]
    NearlyClosed { gap_mm: f64 },
}

/// The largest difference of the radii at an arc's two ends, as a part of the largest coordinate. It allows
/// for the rounding of a centre that was computed from the ends. A larger value would allow a difference that
/// a control could detect.
const RADIUS_AGREEMENT: f64 = 1e-9;

/// The largest difference of the radii for any coordinates, mm: a thousandth of the usual output unit, and a
/// thousand times the rounding of coordinates of a kilometre.
const RADIUS_AGREEMENT_MAX_MM: f64 = 1e-6;

/// An arc about `center` from `start` to `end`. If the ends are equal in the plane, the arc makes one full
/// turn. If the ends differ along the normal, it is a helix of at most one turn.
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
    /// The arc through `start` and `end` about `center`, all in mm. `center` has the start's coordinate along
    /// the plane's normal. Only ends that are exactly equal in the plane make a full turn.
    ///
    /// # Errors
    /// When a coordinate is not finite, the radius is zero, the two radii differ, or the centre lies off the
    /// start's plane. Also when the ends are so close without being equal that rounding would decide between
    /// a sweep of nothing and a full turn.
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
        let agreement = (RADIUS_AGREEMENT * scale).min(RADIUS_AGREEMENT_MAX_MM);
        if (c.z - s.z).abs() > agreement {
            return Err(ArcError::CenterOffPlane);
        }
        let (from, to) = ((s - c).xy(), (e - c).xy());
        let (start_mm, end_mm) = (from.x.hypot(from.y), to.x.hypot(to.y));
        if !(start_mm.is_finite() && end_mm.is_finite()) {
            return Err(ArcError::NotFinite);
        }
        if start_mm == 0.0 {
            return Err(ArcError::ZeroRadius);
        }
        if (start_mm - end_mm).abs() > agreement {
            return Err(ArcError::RadiusMismatch { start_mm, end_mm });
        }
        let is_closed = s.xy() == e.xy();
        let gap_mm = (e.x - s.x).hypot(e.y - s.y);
        if !is_closed && gap_mm <= agreement {
            return Err(ArcError::NearlyClosed { gap_mm });
        }
        // Computed from the directions only: the product of two radii could overflow.
        let (from, to) = (from / start_mm, to / end_mm);
        let turn = from.perp(&to).atan2(from.dot(&to));
        let sweep = if is_closed {
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

    /// The arc whose centre is the place nearest to `near` that is equally far from both ends; for equal
    /// ends, `near` itself. So a centre that was rounded, or read from a program, gives an exact arc.
    ///
    /// # Errors
    /// As [`Arc::new`].
    pub fn with_center_near(
        plane: Plane,
        direction: Direction,
        start: Point3<f64>,
        end: Point3<f64>,
        near: Point3<f64>,
    ) -> Result<Self, ArcError> {
        let [s, e, mut c] = [start, end, near].map(|p| plane.to_local(&p));
        let chord = (e - s).xy();
        let length = chord.x.hypot(chord.y);
        if length > 0.0 {
            let along = chord / length;
            let off = (c - (s + e) / 2.0).xy().dot(&along);
            c.x -= off * along.x;
            c.y -= off * along.y;
        }
        c.z = s.z;
        Self::new(plane, direction, start, end, plane.to_workpiece(&c))
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

    /// The radius at the start, mm.
    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// The angle that the arc turns, radians, in 0..=2 pi for both directions.
    pub fn sweep(&self) -> f64 {
        self.sweep
    }

    /// How far the end lies from the start along the plane's normal, mm; zero for a plane arc.
    pub fn rise(&self) -> f64 {
        let n = self.plane.axes()[2];
        self.end[n] - self.start[n]
    }

    /// The length, mm.
    pub fn length(&self) -> f64 {
        (self.radius * self.sweep).hypot(self.rise())
    }

    /// Vectors along the arc at its start and its end.
    pub fn tangents(&self) -> [Vector3<f64>; 2] {
        [self.start, self.end].map(|p| self.tangent_in(&p))
    }

    /// A vector along the arc at one of its points.
    pub fn tangent_in(&self, point: &Point3<f64>) -> Vector3<f64> {
        let sense = if self.direction == Direction::Ccw { 1.0 } else { -1.0 };
        let spoke = self.plane.to_local(point) - self.plane.to_local(&self.center);
        let local = Vector3::new(-spoke.y * sense, spoke.x * sense, self.rise() / self.sweep);
        self.plane.to_workpiece(&local).coords
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

    /// The distance from `p` to the arc, mm. For a helix it is the distance to the point at `p`'s own angle
    /// or to an end, which is never below the true distance.
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

    /// The fraction of the sweep at which the arc passes the angle `angle` (radians, in the local frame);
    /// `None` if it does not.
    pub fn fraction_of_angle(&self, angle: f64) -> Option<f64> {
        let turned = match self.direction {
            Direction::Ccw => (angle - self.start_angle).rem_euclid(TAU),
            Direction::Cw => (self.start_angle - angle).rem_euclid(TAU),
        };
        (turned <= self.sweep).then(|| turned / self.sweep)
    }

    /// The largest scalar product of `direction` with a point of the arc; for a helix an upper bound.
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

#[cfg(test)]
mod tests {
    use std::f64::consts::{FRAC_PI_2, PI};

    use super::*;

    /// A point from its coordinates (first, second, normal) in `plane`.
    fn at(plane: Plane, a: f64, b: f64, n: f64) -> Point3<f64> {
        plane.to_workpiece(&Vector3::new(a, b, n))
    }

    fn close(p: Point3<f64>, q: Point3<f64>) -> bool {
        (p - q).norm() < 1e-12
    }

    #[test]
    fn ends_and_a_direction_make_a_quarter_or_three_quarters_in_every_plane() {
        for plane in Plane::ALL {
            let (s, e, c) = (at(plane, 11.0, 2.0, 3.0), at(plane, 1.0, 12.0, 3.0), at(plane, 1.0, 2.0, 3.0));
            let quarter = Arc::new(plane, Direction::Ccw, s, e, c).unwrap();
            assert!((quarter.sweep() - FRAC_PI_2).abs() < 1e-15);
            assert!((quarter.length() - 5.0 * PI).abs() < 1e-12);
            let half = 10.0 * FRAC_PI_2.sin() / 2f64.sqrt();
            assert!(close(quarter.point_at(0.5), at(plane, 1.0 + half, 2.0 + half, 3.0)));
            let rest = Arc::new(plane, Direction::Cw, s, e, c).unwrap();
            assert!((rest.sweep() - 1.5 * PI).abs() < 1e-15);
            assert!(close(rest.point_at(0.5), at(plane, 1.0 - half, 2.0 - half, 3.0)));
            assert!(close(rest.point_at(1.0 / 3.0), at(plane, 1.0, -8.0, 3.0)));
            // For a point outside the sweep the nearest point is an end; within the sweep it is on the
            // point's own ray.
            let beyond = at(plane, 1.0, -18.0, 3.0);
            assert!((quarter.distance_to(&beyond) - (beyond - s).norm()).abs() < 1e-12);
            assert!((rest.distance_to(&beyond) - 10.0).abs() < 1e-12);
            assert!((quarter.distance_to(&c) - 10.0).abs() < 1e-12);
            assert!((rest.distance_to(&at(plane, -5.0, 2.0, 6.0)) - 5.0).abs() < 1e-12);
        }
    }

    #[test]
    fn the_support_is_at_an_extreme_or_at_an_end() {
        for plane in Plane::ALL {
            let axes = plane.axes();
            let unit = |k: usize, sign: f64| {
                let mut v = Vector3::zeros();
                v[axes[k]] = sign;
                v
            };
            let (s, e, c) = (at(plane, 10.0, 0.0, 1.0), at(plane, 0.0, -10.0, 4.0), at(plane, 0.0, 0.0, 1.0));
            let arc = Arc::new(plane, Direction::Ccw, s, e, c).unwrap();
            let supports = [(0, 1.0), (0, -1.0), (1, 1.0), (1, -1.0), (2, 1.0), (2, -1.0)]
                .map(|(k, sign)| arc.support(&unit(k, sign)));
            for (got, wanted) in supports.into_iter().zip([10.0, 10.0, 10.0, 10.0, 4.0, -1.0]) {
                assert!((got - wanted).abs() < 1e-12, "{got} {wanted}");
            }
            let short = Arc::new(plane, Direction::Cw, s, e, c).unwrap();
            assert!(short.support(&unit(1, 1.0)).abs() < 1e-12);
            assert!(short.support(&unit(0, -1.0)).abs() < 1e-12);
        }
    }

    #[test]
    fn equal_ends_turn_once_and_a_rise_makes_a_helix() {
        for plane in Plane::ALL {
            for direction in [Direction::Cw, Direction::Ccw] {
                let (s, c) = (at(plane, 3.0, 0.0, 0.0), at(plane, 0.0, 0.0, 0.0));
                let circle = Arc::new(plane, direction, s, s, c).unwrap();
                assert_eq!(circle.sweep(), TAU);
                assert!((circle.length() - 6.0 * PI).abs() < 1e-12);
                assert!(close(circle.point_at(0.5), at(plane, -3.0, 0.0, 0.0)));
                let helix = Arc::new(plane, direction, s, at(plane, 3.0, 0.0, 8.0), c).unwrap();
                assert_eq!(helix.rise(), 8.0);
                assert!((helix.length() - (6.0 * PI).hypot(8.0)).abs() < 1e-12);
                assert!(close(helix.point_at(0.5), at(plane, -3.0, 0.0, 4.0)));
                assert_eq!((helix.point_at(0.0), helix.point_at(1.0)), (helix.start(), helix.end()));
                assert!(helix.distance_to(&at(plane, -4.0, 0.0, 4.0)) <= 1.0 + 1e-12);
            }
        }
    }

    /// As controls move: G18 G3 from X0 to X10 bulges toward +Z, and G19 G2 from Y0 to Y10 too.
    #[test]
    fn senses_are_those_of_g18_and_g19() {
        let (s, e, c) = (Point3::origin(), Point3::new(10.0, 0.0, 0.0), Point3::new(5.0, 0.0, 0.0));
        let hump = Arc::new(Plane::Zx, Direction::Ccw, s, e, c).unwrap();
        assert!(close(hump.point_at(0.5), Point3::new(5.0, 0.0, 5.0)));
        let (e, c) = (Point3::new(0.0, 10.0, 0.0), Point3::new(0.0, 5.0, 0.0));
        let hump = Arc::new(Plane::Yz, Direction::Cw, s, e, c).unwrap();
        assert!(close(hump.point_at(0.5), Point3::new(0.0, 5.0, 5.0)));
    }

    #[test]
    fn points_that_make_no_arc_are_refused() {
        let arc = |s: [f64; 3], e: [f64; 3], c: [f64; 3]| {
            Arc::new(Plane::Xy, Direction::Ccw, s.into(), e.into(), c.into())
        };
        assert_eq!(arc([0.0; 3], [1.0, 0.0, 0.0], [0.0; 3]), Err(ArcError::ZeroRadius));
        assert_eq!(arc([f64::NAN, 0.0, 0.0], [1.0, 0.0, 0.0], [0.5, 0.0, 0.0]), Err(ArcError::NotFinite));
        assert_eq!(arc([1e308, 0.0, 0.0], [-1e308, 0.0, 0.0], [0.0; 3]).map(|a| a.radius()), Ok(1e308));
        assert_eq!(arc([0.0; 3], [2.0, 0.0, 1.0], [1.0, 0.0, 0.1]), Err(ArcError::CenterOffPlane));
        assert!(matches!(
            arc([0.0; 3], [2.0, 0.0, 0.0], [1.0001, 0.0, 0.0]),
            Err(ArcError::RadiusMismatch { .. })
        ));
        // At large coordinates the allowance stays below what a control could detect.
        assert!(matches!(
            arc([0.0; 3], [2e6, 0.0, 0.0], [1e6 + 1e-5, 0.0, 0.0]),
            Err(ArcError::RadiusMismatch { .. })
        ));
    }

    #[test]
    fn nearly_equal_ends_are_neither_a_short_arc_nor_a_full_turn() {
        for gap in [1e-9, -1e-9, 1e-16, -1e-16] {
            for direction in [Direction::Cw, Direction::Ccw] {
                let (s, e) = (Point3::new(10.0, 0.0, 0.0), Point3::new(10.0, gap, 0.0));
                let arc = Arc::new(Plane::Xy, direction, s, e, Point3::origin());
                assert_eq!(arc, Err(ArcError::NearlyClosed { gap_mm: gap.abs() }));
            }
        }
        let (s, e) = (Point3::new(10.0, 0.0, 0.0), Point3::new(10.0, 1e-6, 0.0));
        let sweep = |direction| {
            Arc::with_center_near(Plane::Xy, direction, s, e, Point3::origin()).map(|arc| arc.sweep())
        };
        assert!((sweep(Direction::Ccw).unwrap() - 1e-7).abs() < 1e-12);
        assert!((sweep(Direction::Cw).unwrap() - (TAU - 1e-7)).abs() < 1e-12);
    }

    #[test]
    fn a_rounded_centre_is_moved_onto_the_bisector() {
        let (s, e) = (Point3::new(0.0, 0.0, 0.0), Point3::new(8.0, 6.0, 1.0));
        let near = Point3::new(4.0 - 3.0 + 0.008, 3.0 + 4.0 + 0.006, 0.0);
        let arc = Arc::with_center_near(Plane::Xy, Direction::Cw, s, e, near).unwrap();
        assert!(close(arc.center(), Point3::new(1.0, 7.0, 0.0)));
    }
}

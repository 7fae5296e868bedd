//! Replaces a rounded arc by one or two exact arcs. Other software rounds the ends and the centre of an arc,
//! so that its two *radii* (the distances of its two ends from the centre) differ. The radii of an exact arc
//! agree.
//!
//! # Method
//! 1. Refuse an arc whose two radii differ by more than the allowed distance.
//! 2. Keep the ends, and move the centre to their perpendicular bisector. If the new arc lies within the
//!    allowed distance of the given one, it is the answer.
//! 3. Otherwise divide the given arc at the middle of its sweep. The point of division is the mean of the two
//!    radii away from the centre. Do step 2 for each half. This helps an arc that is nearly a full circle,
//!    because its ends say little about its centre.
//! 4. If the new arc of a half does not lie within the allowed distance either, refuse the given arc.
//!
//! # Guarantees
//! A control may run the given arc at any radius between its two radii. [`NearArc::moved_mm`] bounds the
//! distance of each point of every such path from the exact arcs, and of each point of the exact arcs from
//! the path.

use std::f64::consts::TAU;

use nalgebra::{Point3, Vector2, Vector3};

use super::quantize::bound::{self, Circular, Family};
use crate::geometry::curve::{Arc, ArcError, Direction};
use crate::geometry::plane::Plane;

/// One or two exact arcs that stand for an arc that is nearly exact.
#[derive(Debug, Clone, PartialEq)]
pub struct NearArc {
    pub arcs: Vec<Arc>,
    /// Upper bound of the distance between the arc as given and `arcs`, mm; zero where nothing was moved.
    pub moved_mm: f64,
}

/// The exact arcs for three points, where `center` may be off by rounding.
///
/// # Errors
/// When the points make no arc, or no exact arc lies within `allowed_mm` of the arc as given.
pub fn near_arc(
    (plane, direction): (Plane, Direction),
    start: Point3<f64>,
    end: Point3<f64>,
    center: Point3<f64>,
    allowed_mm: f64,
) -> Result<NearArc, ArcError> {
    let refused = match Arc::new(plane, direction, start, end, center) {
        Ok(arc) => return Ok(NearArc { arcs: vec![arc], moved_mm: 0.0 }),
        Err(error @ (ArcError::RadiusMismatch { .. } | ArcError::CenterOffPlane)) => error,
        Err(error) => return Err(error),
    };
    let [s, e, c] = [start, end, center].map(|p| plane.to_local(&p));
    let given = Given { turn: (plane, direction), s, e, c: c.xy() };
    let radii = given.radii();
    if (radii[0] - radii[1]).abs() > allowed_mm || (c.z - s.z).abs() > allowed_mm || radii.contains(&0.0) {
        return Err(refused);
    }
    let whole = given.exact().filter(|near| near.moved_mm <= allowed_mm);
    whole.or_else(|| given.halves().filter(|near| near.moved_mm <= allowed_mm)).ok_or(refused)
}

/// An arc as given, in coordinates of its plane: (first, second, normal), mm.
struct Given {
    turn: (Plane, Direction),
    s: Vector3<f64>,
    e: Vector3<f64>,
    c: Vector2<f64>,
}

impl Given {
    fn radii(&self) -> [f64; 2] {
        [(self.s.xy() - self.c).norm(), (self.e.xy() - self.c).norm()]
    }

    fn sweep(&self) -> f64 {
        let [from, to] = [self.s, self.e].map(|p| p.xy() - self.c);
        if self.s.xy() == self.e.xy() {
            return TAU;
        }
        (bound::sense(self.turn.1) * bound::angle(&from, &to)).rem_euclid(TAU)
    }

    /// One exact arc between the same ends, with its bound.
    fn exact(&self) -> Option<NearArc> {
        let (plane, direction) = self.turn;
        let [start, end, near] = [self.s, self.e, Vector3::new(self.c.x, self.c.y, self.s.z)]
            .map(|local| plane.to_workpiece(&local));
        let arc = Arc::with_center_near(plane, direction, start, end, near).ok()?;
        let family = Family {
            center: self.c,
            start: self.s,
            end: self.e,
            to_start: self.s.xy() - self.c,
            to_end: self.e.xy() - self.c,
            sweep: self.sweep(),
            sense: bound::sense(direction),
        };
        let moved_mm = bound::distance(&family, &Circular::of(&arc))?;
        Some(NearArc { arcs: vec![arc], moved_mm })
    }

    /// Two exact arcs that meet at the middle of the sweep. Any radius that a control takes there differs
    /// from the mean by at most half the difference of the radii.
    fn halves(&self) -> Option<NearArc> {
        let [from, to] = self.radii();
        let spoke = self.s.xy() - self.c;
        let angle = spoke.y.atan2(spoke.x) + bound::sense(self.turn.1) * self.sweep() / 2.0;
        let middle = self.c + Vector2::new(angle.cos(), angle.sin()) * ((from + to) / 2.0);
        let m = Vector3::new(middle.x, middle.y, (self.s.z + self.e.z) / 2.0);
        let first = Given { e: m, ..*self }.exact()?;
        let second = Given { s: m, ..*self }.exact()?;
        Some(NearArc {
            arcs: [first.arcs, second.arcs].concat(),
            moved_mm: first.moved_mm.max(second.moved_mm) + (from - to).abs() / 2.0,
        })
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    const ALLOWED: f64 = 0.0015;

    fn rounded(p: Point3<f64>, decimals: i32) -> Point3<f64> {
        let scale = 10f64.powi(decimals);
        Point3::from(p.coords.map(|x| (x * scale).round() / scale))
    }

    #[test]
    fn exact_arcs_stay_as_they_are_and_wrong_ones_are_refused() {
        let turn = (Plane::Xy, Direction::Ccw);
        let (s, e) = (Point3::new(10.0, 0.0, 1.0), Point3::new(0.0, 10.0, 1.0));
        let near = near_arc(turn, s, e, Point3::new(0.0, 0.0, 1.0), ALLOWED).unwrap();
        assert_eq!((near.arcs.len(), near.moved_mm), (1, 0.0));
        for center in [[0.01, 0.0, 1.0], [0.0, 0.0, 1.1], [0.0, 0.0, 0.0]] {
            assert!(near_arc(turn, s, e, Point3::from(center), ALLOWED).is_err(), "{center:?}");
        }
        let refused = near_arc(turn, s, e, s, ALLOWED);
        assert_eq!(refused, Err(ArcError::ZeroRadius));
    }

    proptest! {
        #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

        /// Every arc that other software rounded to four decimals is accepted, and lies near the arc before
        /// rounding.
        #[test]
        fn rounded_arcs_are_accepted(
            plane in prop::sample::select(Plane::ALL.to_vec()), ccw: bool, radius in 0.5..500.0f64,
            from in 0.0..TAU, sweep in 0.05..6.27f64, slope in -0.5..0.5f64, flat: bool,
        ) {
            let direction = if ccw { Direction::Ccw } else { Direction::Cw };
            let sense = bound::sense(direction);
            let at = |t: f64, z: f64| {
                let angle = from + sense * sweep * t;
                Vector3::new(7.0 + radius * angle.cos(), -3.0 + radius * angle.sin(), z)
            };
            // The distance to a helix is measured at equal angles, which overestimates it for a steep helix.
            let rise = if flat { 0.0 } else { slope * radius * sweep };
            let [s, e, c] = [at(0.0, 2.0), at(1.0, 2.0 + rise), Vector3::new(7.0, -3.0, 2.0)]
                .map(|local| rounded(plane.to_workpiece(&local), 4));
            let near = near_arc((plane, direction), s, e, c, ALLOWED).unwrap();
            prop_assert!(near.moved_mm <= ALLOWED);
            prop_assert_eq!((near.arcs[0].start(), near.arcs[near.arcs.len() - 1].end()), (s, e));
            let turned: f64 = near.arcs.iter().map(Arc::sweep).sum();
            prop_assert!((turned - sweep).abs() < 1e-2, "{turned} {sweep}");
            // Half a unit in each coordinate of both ends and of the centre, and what was moved.
            let off = near.moved_mm + 3e-4;
            for k in 0..=100 {
                let t = f64::from(k) / 100.0;
                let p = plane.to_workpiece(&at(t, 2.0 + rise * t));
                let distance = near.arcs.iter().map(|arc| arc.distance_to(&p)).fold(f64::INFINITY, f64::min);
                prop_assert!(distance <= off, "{distance} {off}");
            }
        }
    }
}

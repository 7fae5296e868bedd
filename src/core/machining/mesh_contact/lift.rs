//! How high one triangle lifts the tip of a cutter, in closed form.
//!
//! The cutter touches the inside of a triangle where its lower side has the gradient of the triangle's plane.
//! If that place is outside, the highest lift is at a side of the triangle. Along a side, the lift of a point
//! is a concave function of its place, because the lower side is convex; so the lift is largest at one place,
//! or at the end of the side that is nearest to it.
//!
//! Let m be the slope of a side in plan, d0 the distance of its line from the axis in plan, and l the
//! distance from the foot of the axis on the line. At the largest lift, the lower side rises along the line
//! by m:
//! * a ball of radius c: l = m q / sqrt(1 + m^2), with q^2 = c^2 - d0^2;
//! * a flat end: at the end of the chord that the cutter's circle has in the line;
//! * a bull nose: where sin(t) l = |m| cos(t) d, with d = r + c sin(t) and l^2 = d^2 - d0^2.

use std::f64::consts::FRAC_PI_2;

use nalgebra::{Vector2, Vector3};

use crate::geometry::surface::triangle_mesh::{holds, normal};
use crate::machining::cutter::Cutter;

/// Distance from the axis, as a share of the radius, up to which points count as below the cutter: at the
/// radius itself rounding decides.
pub(super) const REACH: f64 = 1.0 - 1e-12;

/// Distance from the axis, as a share of the radius, beyond which no plane below the lower side is taken: its
/// slope grows without bound towards the radius.
const STEEPEST: f64 = 0.98;

/// Steps of the search for the place on a side; eight are usual.
const STEPS: usize = 60;

/// Accuracy of that place, radians on the rounded corner. The lift varies with its square.
const ACCURACY: f64 = 1e-9;

/// A lift of the tip by a triangle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Lift {
    /// The height of the tip, mm.
    pub(super) tip_z: f64,
    /// The place that the cutter touches.
    pub(super) point: Vector3<f64>,
    /// The slope of the lower side there, away from the axis. At the rim of a flat end, where the lower side
    /// has no slope, that of the plane that touches both cutter and triangle.
    pub(super) slope: f64,
    /// Whether the cutter touches the inside of the triangle.
    pub(super) is_inside: bool,
}

impl Lift {
    /// The change of the tip's height while the axis moves from `axis` by `way` mm, per length of `way`.
    pub(super) fn rise(&self, axis: &Vector2<f64>, way: &Vector2<f64>) -> f64 {
        let out = self.point.xy() - axis;
        let distance = out.norm();
        if self.slope == 0.0 || distance == 0.0 { 0.0 } else { self.slope * out.dot(way) / distance }
    }
}

/// A plane that is nowhere above the lower side of a cutter.
#[derive(Debug, Clone, Copy)]
pub(super) struct Support {
    gradient: Vector2<f64>,
    /// The height over the tip at the axis, mm.
    at_axis: f64,
}

impl Support {
    /// The plane that touches the lower side near `off`, a place in plan relative to the axis.
    pub(super) fn near(cutter: &Cutter, off: &Vector2<f64>) -> Self {
        let distance = off.norm();
        let touched = distance.min(STEEPEST * cutter.radius());
        let slope = slope_at(cutter, touched);
        let away = if distance > 0.0 { off / distance } else { Vector2::zeros() };
        Self { gradient: away * slope, at_axis: cutter.height(touched) - slope * touched }
    }

    /// An upper bound of how high a triangle with these corners, relative to the axis, lifts the tip.
    pub(super) fn lift(&self, corners: &[Vector3<f64>; 3]) -> f64 {
        let over = |corner: &Vector3<f64>| corner.z - self.gradient.dot(&corner.xy());
        corners.iter().map(over).fold(f64::NEG_INFINITY, f64::max) - self.at_axis
    }

    /// By how much the plane rises along a way in plan, mm.
    pub(super) fn rise(&self, way: &Vector2<f64>) -> f64 {
        self.gradient.dot(way)
    }
}

/// The height of the lower side at a distance from the axis, mm; that of the rim beyond the radius.
pub(super) fn height(cutter: &Cutter, distance: f64) -> f64 {
    if distance >= cutter.radius() { cutter.corner_radius() } else { cutter.height(distance) }
}

/// The largest lift of a triangle; `None` where the triangle is beside the cutter.
pub(super) fn lift(cutter: &Cutter, corners: &[Vector3<f64>; 3], axis: &Vector2<f64>) -> Option<Lift> {
    lift_above(cutter, corners, axis, f64::NEG_INFINITY)
}

/// The largest lift of a triangle if it is above `least` mm; `None` or any lift of it otherwise.
pub(super) fn lift_above(
    cutter: &Cutter,
    corners: &[Vector3<f64>; 3],
    axis: &Vector2<f64>,
    least: f64,
) -> Option<Lift> {
    if let Some(inside) = by_plane(cutter, corners, axis) {
        return Some(inside);
    }
    let [a, b, c] = corners;
    let mut best: Option<Lift> = None;
    for [p, q] in [[a, b], [b, c], [c, a]] {
        let known = best.map_or(least, |best| best.tip_z.max(least));
        if known > f64::NEG_INFINITY {
            let off = 0.5 * (p.xy() + q.xy()) - axis;
            let support = Support::near(cutter, &off);
            let over = |corner: &Vector3<f64>| corner.z - support.gradient.dot(&(corner.xy() - axis));
            if over(p).max(over(q)) - support.at_axis <= known {
                continue;
            }
        }
        best = match (best, by_side(cutter, [p, q], axis)) {
            (Some(one), Some(other)) if other.tip_z <= one.tip_z => Some(one),
            (one, other) => other.or(one),
        };
    }
    best
}

/// The lift of the inside of a triangle, where the cutter touches it.
fn by_plane(cutter: &Cutter, corners: &[Vector3<f64>; 3], axis: &Vector2<f64>) -> Option<Lift> {
    let [a, b, c] = corners;
    let normal = normal(corners)?;
    let gradient = -normal.xy() / normal.z;
    if !gradient.norm_squared().is_finite() {
        return None;
    }
    let lower = cutter.tangent_point(gradient);
    let slope = lower.slope();
    // A level triangle touches the whole flat: the place below the axis stands for it.
    let place = if slope == 0.0 { *axis } else { axis + lower.place };
    if !holds(corners, &place) {
        return None;
    }
    let [low, high] = [a.z.min(b.z).min(c.z), a.z.max(b.z).max(c.z)];
    let z = (a.z + gradient.dot(&(place - a.xy()))).clamp(low, high);
    Some(Lift { tip_z: z - lower.height, point: Vector3::new(place.x, place.y, z), slope, is_inside: true })
}

/// The largest lift of a side.
fn by_side(cutter: &Cutter, [p, q]: [&Vector3<f64>; 2], axis: &Vector2<f64>) -> Option<Lift> {
    let reach = REACH * cutter.radius();
    let way = q - p;
    let length = way.xy().norm();
    if length == 0.0 {
        return by_point(cutter, if q.z > p.z { q } else { p }, axis);
    }
    let along = way.xy() / length;
    let from_axis = p.xy() - axis;
    let (first, beside) = (from_axis.dot(&along), from_axis.perp(&along).abs());
    if beside > reach {
        return None;
    }
    let half = ((reach - beside) * (reach + beside)).sqrt();
    let (low, high) = (first.max(-half), (first + length).min(half));
    if low > high {
        return None;
    }
    let slope = way.z / length;
    let best = place_on_line(cutter, slope, beside, half);
    let place = best.clamp(low, high);
    let distance = place.hypot(beside);
    // At the ends of the side, the ends themselves: rounding would put the place beside them.
    let share = ((place - first) / length).clamp(0.0, 1.0);
    let point = if share == 1.0 { *q } else { p + way * share };
    let is_on_rim = cutter.corner_radius() == 0.0 && place == best && slope != 0.0;
    let slope = if is_on_rim { slope.abs() * distance / place.abs() } else { slope_at(cutter, distance) };
    Some(Lift { tip_z: point.z - height(cutter, distance), point, slope, is_inside: false })
}

/// The lift of a single point.
fn by_point(cutter: &Cutter, point: &Vector3<f64>, axis: &Vector2<f64>) -> Option<Lift> {
    let distance = (point.xy() - axis).norm();
    (distance <= REACH * cutter.radius()).then(|| Lift {
        tip_z: point.z - height(cutter, distance),
        point: *point,
        slope: slope_at(cutter, distance),
        is_inside: false,
    })
}

/// The slope of the lower side; zero on the bottom of a flat end, its rim included.
fn slope_at(cutter: &Cutter, distance: f64) -> f64 {
    if cutter.corner_radius() == 0.0 { 0.0 } else { cutter.slope(distance) }
}

/// Where on an endless line the lift is largest, mm from the foot of the axis. The line rises by `slope`, and
/// lies `beside` mm from the axis; the cutter's circle has a chord of twice `half` mm in it.
fn place_on_line(cutter: &Cutter, slope: f64, beside: f64, half: f64) -> f64 {
    let (flat, corner) = (cutter.flat_radius(), cutter.corner_radius());
    if slope == 0.0 {
        0.0
    } else if corner == 0.0 {
        half.copysign(slope)
    } else if flat == 0.0 {
        half * slope / (1.0 + slope * slope).sqrt()
    } else {
        place_of_bull_nose([flat, corner], slope.abs(), beside).min(half).copysign(slope)
    }
}

fn place_of_bull_nose([flat, corner]: [f64; 2], slope: f64, beside: f64) -> f64 {
    let place = |angle: f64| {
        let distance = flat + corner * angle.sin();
        (((distance - beside) * (distance + beside)).max(0.0).sqrt(), distance)
    };
    // Grows with the angle, from below zero to above it.
    let excess = |angle: f64| {
        let (place, distance) = place(angle);
        angle.sin() * place - slope * distance * angle.cos()
    };
    let mut low = if beside > flat { ((beside - flat) / corner).min(1.0).asin() } else { 0.0 };
    let mut high = FRAC_PI_2;
    let (mut at_low, mut at_high) = (excess(low), excess(high));
    // Chords, with the value at an end that stays halved, so that both ends move.
    for _ in 0..STEPS {
        if high - low <= ACCURACY || at_low >= 0.0 {
            break;
        }
        let next = high - at_high * (high - low) / (at_high - at_low);
        let next = if next > low && next < high { next } else { 0.5 * (low + high) };
        let value = excess(next);
        if value < 0.0 {
            (low, at_low, at_high) = (next, value, 0.5 * at_high);
        } else {
            (high, at_high, at_low) = (next, value, 0.5 * at_low);
        }
    }
    place(0.5 * (low + high)).0
}

//! Decides how a plane cuts one part of a patch.
//!
//! # Method
//! Offs are the distances of control points from the plane, with a sign. Along a side of a part, the section
//! crosses at most as often as the signs of the offs along that side change. A part is decided when
//! 1. the signs change at most once along each side. So the crossings of the sides are known exactly.
//! 2. the off grows or falls along u, or along v, over the whole part. So the section is one curve from side
//!    to side, or it misses the part.
//! 3. a bound of the second derivative keeps the section within the accuracy of its chord.
//!
//! A part that is smaller than the accuracy needs condition 1 only.

use nalgebra::{Point3, Vector3};

use crate::geometry::solve::falling_root;
use crate::geometry::surface::Patch;
use crate::geometry::surface::patch::DerivativeBounds;
use crate::geometry::surface::vector_ball::VectorBall;

/// Most control points of a patch: 8 each way.
const MOST_POINTS: usize = 64;

/// A plane at right angles to x (`axis` 0) or y (`axis` 1), and the accuracy of its section.
#[derive(Debug, Clone, Copy)]
pub(super) struct Plane {
    pub(super) axis: usize,
    /// The coordinate of the plane, mm.
    pub(super) at: f64,
    /// How far the section may lie from the chords, mm.
    pub(super) accuracy_mm: f64,
}

/// The direction in which a part is halved.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Halving {
    U,
    V,
}

/// A side of a part; its place in [`Side::ALL`] is its index.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Side {
    FirstU,
    LastU,
    FirstV,
    LastV,
}

impl Side {
    const ALL: [Side; 4] = [Side::FirstU, Side::LastU, Side::FirstV, Side::LastV];

    /// The parameters at the place `t` along the side.
    fn parameters(self, t: f64) -> [f64; 2] {
        match self {
            Side::FirstU => [0.0, t],
            Side::LastU => [1.0, t],
            Side::FirstV => [t, 0.0],
            Side::LastV => [t, 1.0],
        }
    }
}

/// A place where the section crosses a side.
#[derive(Debug, Clone, Copy)]
pub(super) struct Crossing {
    pub(super) side: Side,
    /// The parameter along the side, from 0 to 1.
    pub(super) t: f64,
    pub(super) point: Point3<f64>,
    /// The unit normal of the surface; zero where it has none.
    pub(super) normal: Vector3<f64>,
    u: f64,
    v: f64,
}

/// How the plane cuts a part.
pub(super) enum Finding {
    Missed,
    /// The section runs from the first crossing of each pair to the second.
    Met(Vec<[Crossing; 2]>),
    Undecided(Halving),
}

/// Decides `part`. Not inlined: its bounds would make the recursion's frames large.
#[inline(never)]
pub(super) fn examine(part: &impl Patch, plane: &Plane) -> Finding {
    let [p, q] = part.degree();
    let mut offs = [0.0; MOST_POINTS];
    for (off, point) in offs.iter_mut().zip(part.control_points()) {
        *off = point[plane.axis] - plane.at;
    }
    let n = (p + 1) * (q + 1);
    let is_behind = |k: usize| offs[k] >= 0.0;
    if (1..n).all(|k| is_behind(k) == is_behind(0)) {
        return Finding::Missed;
    }
    // The index of the control point (a, b) is a (q + 1) + b.
    let [along_u, along_v] = [(p, q + 1), (q, 1)];
    let changes = |first: usize, (degree, step): (usize, usize)| {
        (0..degree).filter(|k| is_behind(first + k * step) != is_behind(first + (k + 1) * step)).count()
    };
    let counts =
        [changes(0, along_v), changes(p * (q + 1), along_v), changes(0, along_u), changes(q, along_u)];
    let by_offs = || {
        let [along_u, along_v] = part.spreads(&Vector3::ith(plane.axis, 1.0));
        Finding::Undecided(if along_u >= along_v { Halving::U } else { Halving::V })
    };
    if counts.iter().any(|count| *count > 1) {
        return by_offs();
    }
    let bounds = part.bounds();
    if (bounds.max - bounds.min).amax() <= plane.accuracy_mm {
        return Finding::Met(pairs(crossings(part, plane, counts)));
    }
    let derivatives = part.derivatives();
    let [steady_u, steady_v] = [&derivatives.du, &derivatives.dv].map(|ball| steadiness(ball, plane.axis));
    if steady_u.max(steady_v) <= 0.0 {
        return by_offs();
    }
    match crossings(part, plane, counts)[..] {
        // The section does not turn back between the sides and does not cross a side, so there is none.
        [] => Finding::Missed,
        [from, to] if is_straight(&derivatives, steady_v >= steady_u, [from, to], plane) => {
            Finding::Met(vec![[from, to]])
        }
        _ => Finding::Undecided(by_bend(part, &derivatives)),
    }
}

/// How surely the off grows or falls along a derivative: above zero where it does, and at most 1.
fn steadiness(ball: &VectorBall, axis: usize) -> f64 {
    let center = ball.center[axis].abs();
    if center > ball.radius { (center - ball.radius) / (center + ball.radius) } else { 0.0 }
}

/// The direction along which the tangents turn more; else the longer one.
fn by_bend(part: &impl Patch, derivatives: &DerivativeBounds) -> Halving {
    let DerivativeBounds { du, dv, duu, duv, dvv } = derivatives;
    let (along_u, along_v) = (du.center.norm(), dv.center.norm());
    let twist = duv.center.norm();
    let by_u = duu.center.norm() / along_u + twist / along_v;
    let by_v = twist / along_u + dvv.center.norm() / along_v;
    let [long_u, long_v] = part.extents();
    let is_u = if by_u > 2.0 * by_v {
        true
    } else if by_v > 2.0 * by_u {
        false
    } else {
        long_u >= long_v
    };
    if is_u { Halving::U } else { Halving::V }
}

/// The crossings of the sides along which the sign changes.
fn crossings(part: &impl Patch, plane: &Plane, counts: [usize; 4]) -> Vec<Crossing> {
    let crossed = Side::ALL.into_iter().zip(counts).filter(|(_, count)| *count == 1);
    crossed.map(|(side, _)| crossing(part, plane, side)).collect()
}

fn crossing(part: &impl Patch, plane: &Plane, side: Side) -> Crossing {
    let off = |t: f64| {
        let [u, v] = side.parameters(t);
        part.jet(u, v).point[plane.axis] - plane.at
    };
    let sense = if off(0.0) >= 0.0 { 1.0 } else { -1.0 };
    let t = falling_root([0.0, 1.0], |t| sense * off(t));
    let [u, v] = side.parameters(t);
    let jet = part.jet(u, v);
    Crossing { side, t, point: jet.point, normal: jet.normal().try_normalize(0.0).unwrap_or_default(), u, v }
}

/// The ends of the sections of a part that is smaller than the accuracy.
fn pairs(crossings: Vec<Crossing>) -> Vec<[Crossing; 2]> {
    match crossings[..] {
        // Between the sides of constant u and those of constant v, no two sections cross.
        [a, b, c, d] => vec![[a, c], [b, d]],
        [a, b] => vec![[a, b]],
        _ => Vec::new(),
    }
}

/// Whether the section from crossing to crossing is within the accuracy of its chord.
///
/// Let the off grow or fall along v, and let n be a unit vector in the plane. Along the section, v is a
/// function of u, and the second derivative of n . S by u is the sum of n . D - l (axis . D) over D = S_uu, 2
/// S_uv v' and S_vv v'^2. Here l is (n . S_v) / (axis . S_v). If the sum is at most m, the section leaves its
/// chord by at most m / 8 times the square of the range of u.
fn is_straight(
    derivatives: &DerivativeBounds,
    along_v: bool,
    [from, to]: [Crossing; 2],
    plane: &Plane,
) -> bool {
    let DerivativeBounds { du, dv, duu, duv, dvv } = derivatives;
    let (range, first, across, seconds) = if along_v {
        (to.u - from.u, du, dv, [duu, duv, dvv])
    } else {
        (to.v - from.v, dv, du, [dvv, duv, duu])
    };
    let axis = plane.axis;
    let least = across.center[axis].abs() - across.radius;
    let slope = (first.center[axis].abs() + first.radius) / least;
    let shares = [1.0, 2.0 * slope, slope * slope];
    let height = |n: &Vector3<f64>| {
        let l = n.dot(&across.center) / across.center[axis];
        let l_radius = across.radius * (1.0 + l.abs()) / least;
        let of = |second: &VectorBall| {
            let aside = n.dot(&second.center) - l * second.center[axis];
            aside.abs()
                + second.radius * (1.0 + l * l).sqrt()
                + l_radius * (second.center[axis].abs() + second.radius)
        };
        let sum: f64 = seconds.iter().zip(shares).map(|(second, share)| of(second) * share).sum();
        sum * range * range / 8.0
    };
    let mut chord = to.point - from.point;
    chord[axis] = 0.0;
    let length = chord.norm();
    let Some(along) = chord.try_normalize(0.0) else {
        return height(&Vector3::z()).hypot(height(&Vector3::ith(1 - axis, 1.0))) <= plane.accuracy_mm;
    };
    let aside = height(&along.cross(&Vector3::ith(axis, 1.0)));
    // The section does not reach beyond the ends of the chord, or hardly does.
    let beyond = height(&along);
    let beyond = if 4.0 * beyond <= length { 0.0 } else { beyond };
    aside.hypot(beyond) <= plane.accuracy_mm
}

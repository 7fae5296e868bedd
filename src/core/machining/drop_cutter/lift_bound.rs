//! Bounds the height to which a part of the surface lifts the tip while the axis moves along a line in plan.
//! The number t is the position of the axis on this line.
//!
//! # Method
//! 1. Choose a place of the part, and a point of the cutter that may touch there. The lower side of the
//!    cutter lies on or above a known quadratic surface that touches it at this point
//!    ([`Cutter::support_forms`]).
//! 2. With the quadratic surface in place of the lower side, the lift of a point of the part is a smooth
//!    function of t and of the part's parameters u and v. The true lift is at most as large. Bound the second
//!    derivatives of this function.
//! 3. From these bounds, make a quadratic function of t, u and v that is at least as large as the smooth
//!    function. It has to be concave in u and v. If it is not, subtract squares of u and v from it, and add
//!    to the result the most by which this lowers the function on the part.
//! 4. The result is the largest value of the quadratic function over all t, u and v.
//!
//! # Guarantees
//! The result is at least the lift of every point of the part for every t, to within rounding.

use nalgebra::{Matrix2, Vector2};

use super::tree::{Bends, SubPatch};
use crate::geometry::surface::Jet;
use crate::geometry::surface::patch::{Bounds, Patch};
use crate::geometry::surface::vector_ball::VectorBall;
use crate::machining::cutter::{Cutter, Form, LowerPoint};

/// Share of the least curvature that is given up to bound how the gradient by the parameters changes along
/// the track.
const SHARE_FOR_DOUBT: f64 = 0.2;

/// A form is definite where its least value is this share of its size. Both shares are tried. The smaller one
/// suits lifts that are level along a line, as on swept and turned surfaces. The larger one suits forms that
/// must also cover uncertainty.
const LEAST_SHARES: [f64; 2] = [1e-13, 1e-6];

/// Positions of the axis in plan: `center` + t `way`, |t| <= `reach`, mm.
#[derive(Debug, Clone, Copy)]
pub(super) struct AxisMove {
    pub(super) center: Vector2<f64>,
    /// A unit vector, or zero if `reach` is zero.
    pub(super) way: Vector2<f64>,
    pub(super) reach: f64,
}

impl AxisMove {
    pub(super) fn point(center: Vector2<f64>) -> Self {
        Self { center, way: Vector2::zeros(), reach: 0.0 }
    }

    /// The straight move from one position to another.
    pub(super) fn between(from: Vector2<f64>, to: Vector2<f64>) -> Self {
        let length = (to - from).norm();
        let way = if length > 0.0 { (to - from) / length } else { Vector2::zeros() };
        Self { center: 0.5 * (from + to), way, reach: 0.5 * length }
    }

    /// The position nearest to a place.
    pub(super) fn nearest(&self, place: &Vector2<f64>) -> Vector2<f64> {
        self.center + self.way * self.way.dot(&(place - self.center)).clamp(-self.reach, self.reach)
    }

    /// Lower bound of the squared distance in plan, mm^2, between a box and the place `at`, which moves along
    /// with the axis. It is exact for moves along x or y.
    pub(super) fn squared_distance(&self, bounds: &Bounds, at: &Vector2<f64>) -> f64 {
        let beyond = |k: usize| {
            let half = self.way[k].abs() * self.reach;
            (bounds.min[k] - at[k] - half).max(at[k] - half - bounds.max[k]).max(0.0)
        };
        let (x, y) = (beyond(0), beyond(1));
        x * x + y * y
    }
}

/// The height with which lifts are compared, mm: `level` + t `slope`.
#[derive(Debug, Clone, Copy)]
pub(super) struct Threshold {
    pub(super) level: f64,
    pub(super) slope: f64,
}

/// A quadratic function of t.
#[derive(Debug, Clone, Copy)]
struct Quadratic {
    constant: f64,
    linear: f64,
    square: f64,
}

impl Quadratic {
    /// The largest value for |t| <= reach.
    fn largest(&self, reach: f64) -> f64 {
        let at = |t: f64| self.constant + t * (self.linear + t * self.square);
        let ends = at(reach).max(at(-reach));
        let top = -self.linear / (2.0 * self.square);
        if self.square < 0.0 && top.abs() < reach { ends.max(at(top)) } else { ends }
    }
}

/// A place of a part and a point of the cutter that may touch there.
pub(super) struct Touch<'a, P> {
    pub(super) part: &'a SubPatch<P>,
    pub(super) bends: &'a Bends,
    pub(super) place: [f64; 2],
    pub(super) jet: &'a Jet,
    pub(super) lower: LowerPoint,
}

impl<P: Patch> Touch<'_, P> {
    /// Upper bound of how far the part lifts the tip above `level`, mm; infinite where no bound is known.
    pub(super) fn excess(&self, cutter: &Cutter, track: &AxisMove, level: &Threshold) -> f64 {
        let from_touch = self.part.center - track.center - self.lower.place;
        let width = self.part.half_diagonal + track.reach;
        let least = self.lower.away_of(&from_touch) - width;
        let forms = cutter.support_forms(&self.lower, least);
        let mut lowest = f64::INFINITY;
        for form in &forms {
            for share in LEAST_SHARES {
                let (excess, is_definite) = self.excess_by(form, share, &from_touch, width, track, level);
                lowest = lowest.min(excess);
                if lowest <= 0.0 {
                    return lowest;
                }
                if is_definite {
                    break;
                }
            }
        }
        lowest
    }

    /// The bound of [`Self::excess`] by one form that `least_share` makes definite; and whether the form was
    /// clearly definite without that.
    fn excess_by(
        &self,
        form: &Form,
        least_share: f64,
        from_touch: &Vector2<f64>,
        width: f64,
        track: &AxisMove,
        level: &Threshold,
    ) -> (f64, bool) {
        let Bends { derivatives, first, second: by } = self.bends;
        let norm = form.norm();
        let gradient = &self.lower.gradient;
        // The gradient of the supporting function over the part: its value at the part's centre, and how much
        // it changes.
        let middle = gradient + form.times(from_touch);
        let changes = norm * width;
        let length = (1.0 + middle.norm_squared()).sqrt();
        let second = |s: &VectorBall, reach: f64| {
            let value = s.center.z - middle.dot(&s.center.xy());
            (value, length * s.radius + changes * reach)
        };
        let [(cu, ru), (cv, rv)] = first.map(|ball| (ball.center, ball.radius));
        let (fu, fv) = (form.times(&cu), form.times(&cv));
        let (nu, nv) = (cu.norm(), cv.norm());
        let [by_u, by_both, by_v] = *by;
        let (uu, duu) = second(&derivatives.duu, by_u);
        let (uv, duv) = second(&derivatives.duv, by_both);
        let (vv, dvv) = second(&derivatives.dvv, by_v);
        let doubt_uv = duv + norm * (nu * rv + nv * ru + ru * rv);
        let mut n_uu = fu.dot(&cu) - uu - duu - norm * ru * (2.0 * nu + ru) - doubt_uv;
        let mut n_vv = fv.dot(&cv) - vv - dvv - norm * rv * (2.0 * nv + rv) - doubt_uv;
        let n_uv = fu.dot(&cv) - uv;
        // A function that is not concave is made concave by adding the lacking curvature. The most that this
        // lowers the function over the part is added to the bound.
        let (lacking, least) = lacking_curvature([n_uu, n_uv, n_vv], least_share);
        if !lacking.is_finite() {
            return (f64::INFINITY, true);
        }
        let is_definite = lacking == 0.0 && least > LEAST_SHARES[1] * (n_uu + n_vv);
        n_uu += lacking;
        n_vv += lacking;
        // How the gradient by the parameters changes along the track.
        let (with_u, with_v) = (fu.dot(&track.way), fv.dot(&track.way));
        let mut doubt_square = 0.0;
        if track.reach > 0.0 {
            let share = SHARE_FOR_DOUBT * least;
            doubt_square = (norm * norm) * (ru * ru + rv * rv) / (2.0 * share);
            n_uu -= share;
            n_vv -= share;
        }
        let off = self.jet.point.coords.xy() - track.center - self.lower.place;
        let bent = form.times(&off);
        let slope = gradient + bent;
        let lift = self.jet.point.z - self.lower.height - gradient.dot(&off) - 0.5 * off.dot(&bent);
        let g = [self.jet.du, self.jet.dv].map(|d| d.z - slope.dot(&d.xy()));
        let own = Quadratic {
            // Two places of the square are at most a diagonal apart, so the added curvature lowers the
            // function by no more than this.
            constant: lift - level.level + lacking,
            linear: slope.dot(&track.way) - level.slope,
            square: doubt_square - 0.5 * track.way.dot(&form.times(&track.way)),
        };
        let bowl = Bowl {
            n: Matrix2::new(n_uu, n_uv, n_uv, n_vv),
            least,
            is_level: !is_definite,
            g,
            with: [with_u, with_v],
        };
        (bowl.added(own, self.place, track.reach), is_definite)
    }
}

/// The curvature that must be added to both squares of a symmetric form to make it definite, zero if it is so
/// already; and the form's least value for a unit vector after that.
fn lacking_curvature([n_uu, n_uv, n_vv]: [f64; 3], least_share: f64) -> (f64, f64) {
    let half = 0.5 * (n_uu - n_vv);
    let least = 0.5 * (n_uu + n_vv) - (half * half + n_uv * n_uv).sqrt();
    let size = n_uu.abs() + n_vv.abs() + n_uv.abs();
    if least > least_share * size {
        (0.0, least)
    } else {
        (2.0 * least_share * size - least, 2.0 * least_share * size)
    }
}

/// The function (g + t with) . x - x N x / 2.
struct Bowl {
    n: Matrix2<f64>,
    /// The least value of N for a unit vector.
    least: f64,
    /// Whether `least` is so small that rounding makes the inverse of N useless.
    is_level: bool,
    g: [f64; 2],
    with: [f64; 2],
}

impl Bowl {
    /// Upper bound of `own` plus this function, for |t| <= reach and x over the unit square seen from
    /// `place`.
    fn added(&self, own: Quadratic, place: [f64; 2], reach: f64) -> f64 {
        if self.is_level {
            return self.in_square(own, place, reach);
        }
        let det = self.n.determinant();
        let inverse = Matrix2::new(self.n.m22, -self.n.m12, -self.n.m12, self.n.m11) / det;
        let (g, with) = (Vector2::from(self.g), Vector2::from(self.with));
        let (bent_g, bent_with) = (inverse * g, inverse * with);
        let free = Quadratic {
            constant: own.constant + 0.5 * g.dot(&bent_g),
            linear: own.linear + with.dot(&bent_g),
            square: own.square + 0.5 * with.dot(&bent_with),
        };
        let mut largest = free.largest(reach);
        // Where the place is on a side and the function falls inward from that side for every t, the largest
        // value lies on that side.
        for (axis, at) in place.into_iter().enumerate() {
            let other = 1 - axis;
            let inward = match at {
                x if x <= 0.0 => 1.0,
                x if x >= 1.0 => -1.0,
                _ => continue,
            };
            let ratio = self.n.m12 / self.n[(other, other)];
            let rise = |t: f64, k: usize| self.g[k] + t * self.with[k];
            let falls =
                [reach, -reach].iter().all(|&t| inward * (rise(t, axis) - ratio * rise(t, other)) <= 0.0);
            let n = self.n[(other, other)];
            if falls {
                let on_side = Quadratic {
                    constant: own.constant + 0.5 * self.g[other] * self.g[other] / n,
                    linear: own.linear + self.g[other] * self.with[other] / n,
                    square: own.square + 0.5 * self.with[other] * self.with[other] / n,
                };
                largest = largest.min(on_side.largest(reach));
            }
        }
        let at_corner = place.iter().all(|x| *x <= 0.0 || *x >= 1.0);
        let falls_both = |t: f64| {
            (0..2).all(|axis| {
                let inward = if place[axis] <= 0.0 { 1.0 } else { -1.0 };
                let slope = inward * (self.g[axis] + t * self.with[axis]);
                slope <= 0.0
            })
        };
        // A concave function that falls along both sides from a corner is largest in the corner.
        if at_corner && falls_both(reach) && falls_both(-reach) {
            largest = largest.min(own.largest(reach));
        }
        // A nearly flat function may be largest far outside the square: then the bound within the square is
        // better.
        if largest > 0.0 { largest.min(self.in_square(own, place, reach)) } else { largest }
    }

    /// Upper bound of `own` plus this function over the square seen from `place`. `own` is taken without a
    /// downward bend. So the sum is convex in t, and largest at an end of the track.
    fn in_square(&self, own: Quadratic, place: [f64; 2], reach: f64) -> f64 {
        let at = |t: f64| {
            let g = [0, 1].map(|k| self.g[k] + t * self.with[k]);
            own.constant + t * own.linear + t * t * own.square.max(0.0) + self.largest_in_square(g, place)
        };
        if reach == 0.0 { at(0.0) } else { at(reach).max(at(-reach)) }
    }

    /// The largest value of g . x - x N x / 2 for x from -place to 1 - place.
    fn largest_in_square(&self, g: [f64; 2], place: [f64; 2]) -> f64 {
        let (low, high) = (place.map(|t| -t), place.map(|t| 1.0 - t));
        let value = |x: [f64; 2]| {
            let bent = self.n.m11 * x[0] * x[0] + 2.0 * self.n.m12 * x[0] * x[1] + self.n.m22 * x[1] * x[1];
            g[0] * x[0] + g[1] * x[1] - 0.5 * bent
        };
        let free = self.n.determinant().recip();
        let free =
            [free * (self.n.m22 * g[0] - self.n.m12 * g[1]), free * (self.n.m11 * g[1] - self.n.m12 * g[0])];
        if !self.is_level && (0..2).all(|k| (low[k]..=high[k]).contains(&free[k])) {
            return value(free);
        }
        let mut largest = f64::NEG_INFINITY;
        for axis in 0..2 {
            let other = 1 - axis;
            for side in [low[axis], high[axis]] {
                let top = (g[other] - self.n.m12 * side) / self.n[(other, other)];
                for along in [low[other], high[other], top.clamp(low[other], high[other])] {
                    let mut x = [side; 2];
                    x[other] = along;
                    largest = largest.max(value(x));
                }
            }
        }
        // Going from a place inside to a side, in the direction in which N is least, costs no more than this.
        if self.is_level { largest + self.least } else { largest }
    }
}

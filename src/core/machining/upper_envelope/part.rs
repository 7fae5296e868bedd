//! The section of one part of a patch with a plane. The section becomes a stretch if it is nearly straight.

use nalgebra::{Vector2, Vector3};

use super::{Accuracy, Stretch};
use crate::geometry::solve::bisect;
use crate::geometry::surface::patch::{DerivativeBounds, Patch};

/// Bisection steps between a place before the plane and one behind it; 60 reach the last bit.
const HALVINGS: usize = 60;

/// Largest number of Newton steps towards the plane; two or three are usual.
const NEWTON_LIMIT: usize = 20;

/// Rounding of a coordinate, as a share of the coordinates. A side that is this near to the plane lies in it.
const ROUNDING: f64 = 1e-13;

/// The result for the section of a part.
pub(super) enum Section {
    /// The plane does not meet the part.
    Missed,
    Met(Stretch),
    /// The part must be halved.
    Unknown,
}

/// Where the section of a part meets a side u = 0 or u = 1.
#[derive(Clone, Copy)]
enum Crossing {
    /// On the part, at this v.
    At(f64),
    /// Outside the part: at v < 0 (`Below`) or at v > 1 (`Above`).
    Below,
    Above,
}

/// An end of the section of a part: its u, and its x and z.
#[derive(Clone, Copy)]
struct End {
    u: f64,
    at: Vector2<f64>,
}

/// The section of a part with the plane at `y` mm.
pub(super) fn section<P: Patch>(patch: &P, y: f64, accuracy: Accuracy) -> Section {
    let bounds = patch.bounds();
    let rounding = ROUNDING * bounds.magnitude();
    if bounds.min.y > y + rounding || bounds.max.y < y - rounding {
        return Section::Missed;
    }
    let size = bounds.max - bounds.min;
    if size.amax() <= accuracy.width_mm.min(accuracy.height_mm) {
        return Section::Met(level(bounds.min.x, bounds.max.x, bounds.max.z));
    }
    let derivatives = patch.derivatives();
    if derivatives.dv.center.y.abs() >= derivatives.du.center.y.abs() {
        along_u(patch, &derivatives, y, rounding, accuracy)
    } else {
        let transposed = patch.transposed();
        along_u(&transposed, &transposed.derivatives(), y, rounding, accuracy)
    }
}

/// A stretch at one height.
fn level(from_x: f64, to_x: f64, z: f64) -> Stretch {
    Stretch { from: Vector2::new(from_x, z), to: Vector2::new(to_x, z) }
}

/// The section as a function of u. The part must be halved if y has no derivative of one sign along v over
/// the whole part.
fn along_u<P: Patch>(
    patch: &P,
    derivatives: &DerivativeBounds,
    y: f64,
    rounding: f64,
    accuracy: Accuracy,
) -> Section {
    let Some(bend) = Bend::over(derivatives) else { return Section::Unknown };
    if bend.aside() > accuracy.height_mm {
        return Section::Unknown;
    }
    let side = Sides { patch, y, rounding, sense: bend.sense };
    let Some([from, to]) = side.ends() else { return Section::Missed };
    match bend.stretch(from, to, accuracy) {
        Some(stretch) => Section::Met(stretch),
        None => Section::Unknown,
    }
}

/// The stretch between two points, with the smaller x first.
fn ordered(a: Vector2<f64>, b: Vector2<f64>) -> Stretch {
    if a.x <= b.x { Stretch { from: a, to: b } } else { Stretch { from: b, to: a } }
}

/// The sides of a part on which y grows or falls along v.
struct Sides<'a, P> {
    patch: &'a P,
    y: f64,
    rounding: f64,
    /// 1 where y grows along v, else -1.
    sense: f64,
}

impl<P: Patch> Sides<'_, P> {
    /// Where the section enters and leaves the part; `None` where it misses the part.
    fn ends(&self) -> Option<[End; 2]> {
        let crossings = [0.0, 1.0].map(|u| self.crossing(u));
        let on = |u: f64, crossing: Crossing, other: Crossing| match (crossing, other) {
            (Crossing::At(v), _) => Some(self.end(u, v)),
            (Crossing::Below, Crossing::Below) | (Crossing::Above, Crossing::Above) => None,
            (Crossing::Below, _) => Some(self.end(self.crossing_along(0.0), 0.0)),
            (Crossing::Above, _) => Some(self.end(self.crossing_along(1.0), 1.0)),
        };
        Some([on(0.0, crossings[0], crossings[1])?, on(1.0, crossings[1], crossings[0])?])
    }

    fn end(&self, u: f64, v: f64) -> End {
        let point = self.patch.jet(u, v).point;
        End { u, at: Vector2::new(point.x, point.z) }
    }

    /// How far the surface point is behind the plane, mm, with the sign that makes it grow along v.
    fn behind(&self, u: f64, v: f64) -> f64 {
        self.sense * (self.patch.jet(u, v).point.y - self.y)
    }

    fn crossing(&self, u: f64) -> Crossing {
        let (low, high) = (self.behind(u, 0.0), self.behind(u, 1.0));
        if low.abs() <= self.rounding {
            Crossing::At(0.0)
        } else if high.abs() <= self.rounding {
            Crossing::At(1.0)
        } else if low > 0.0 {
            Crossing::Below
        } else if high < 0.0 {
            Crossing::Above
        } else {
            Crossing::At(self.root(u, low / (low - high)))
        }
    }

    /// The v at which the plane is reached, by Newton's method kept between a place before the plane and one
    /// behind it.
    fn root(&self, u: f64, mut v: f64) -> f64 {
        let (mut before, mut behind) = (0.0, 1.0);
        for _ in 0..NEWTON_LIMIT {
            let jet = self.patch.jet(u, v);
            let off = self.sense * (jet.point.y - self.y);
            if off.abs() <= self.rounding {
                break;
            }
            if off < 0.0 {
                before = v
            } else {
                behind = v
            }
            let next = v - off / (self.sense * jet.dv.y);
            v = if next > before && next < behind { next } else { 0.5 * (before + behind) };
        }
        v
    }

    /// The u at which the plane meets the side of constant v. The ends of that side must lie on different
    /// sides of the plane.
    fn crossing_along(&self, v: f64) -> f64 {
        let is_behind = self.behind(0.0, v) > 0.0;
        let [same, other] = bisect([0.0, 1.0], HALVINGS, |u| (self.behind(u, v) > 0.0) == is_behind);
        0.5 * (same + other)
    }
}

/// How the section of a part bends, per unit of u.
struct Bend<'a> {
    derivatives: &'a DerivativeBounds,
    sense: f64,
    /// The least |S_y| along v, mm.
    least: f64,
    /// A bound of S_uu + 2 S_uv v' + S_vv v'^2, mm.
    across: f64,
}

impl<'a> Bend<'a> {
    /// `None` where y is not known to be monotone along v.
    fn over(derivatives: &'a DerivativeBounds) -> Option<Self> {
        let DerivativeBounds { du, dv, duu, duv, dvv } = derivatives;
        let least = dv.center.y.abs() - dv.radius;
        if least <= 0.0 {
            return None;
        }
        let slope = (du.center.y.abs() + du.radius) / least;
        let across = duu.reach() + 2.0 * duv.reach() * slope + dvv.reach() * slope * slope;
        Some(Self { derivatives, sense: dv.center.y.signum(), least, across })
    }

    /// How far the section leaves its chord on the surface, at most, mm. The section may leave the part by as
    /// much without being seen.
    fn aside(&self) -> f64 {
        self.across / 8.0 * self.derivatives.dv.reach() / self.least
    }

    /// Bound of the second derivative of the sum of `weights` times x and z, mm.
    fn of(&self, weights: Vector2<f64>) -> f64 {
        let along_v = &self.derivatives.dv;
        let sum = weights.x * along_v.center.x + weights.y * along_v.center.z;
        let by_v = sum.abs() + along_v.radius * weights.norm();
        self.across * Vector3::new(weights.x, weights.y, by_v / self.least).norm()
    }

    /// The chord between the ends, or a level stretch where the section is nearly upright. `None` where
    /// neither is as near to the section as `accuracy` asks for.
    fn stretch(&self, from: End, to: End, accuracy: Accuracy) -> Option<Stretch> {
        let way = to.at - from.at;
        let part = (to.u - from.u).abs();
        let height = |second: f64| second * part * part / 8.0;
        // x is monotone where its derivative differs from its mean by less than the mean itself.
        let rise = way.y / way.x;
        let along_x = self.of(Vector2::x());
        let is_monotone = way.x.abs() > 4.0 * height(along_x);
        if is_monotone && height(self.of(Vector2::new(-rise, 1.0))) <= accuracy.height_mm {
            return Some(ordered(from.at, to.at));
        }
        let beyond = height(along_x);
        let over = height(self.of(Vector2::y()));
        if way.x.abs() + 2.0 * beyond > 0.5 * accuracy.width_mm || over > accuracy.height_mm {
            return None;
        }
        // The top of an upright wall is at least this much wider on each side.
        let beyond = beyond.max(0.25 * accuracy.width_mm);
        let [low, high] = [from.at.x.min(to.at.x), from.at.x.max(to.at.x)];
        Some(level(low - beyond, high + beyond, from.at.y.max(to.at.y)))
    }
}

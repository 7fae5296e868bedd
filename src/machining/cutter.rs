//! Cutters as geometry: a flat disc with a rounded edge, turning about a vertical axis, below a shank of the
//! same radius.
//!
//! A ball has no flat, a flat end no rounding, a bull nose both. As a function of the distance d from the
//! axis the lower side lies h(d) above the tip: nothing up to the flat's radius, then c - sqrt(c^2 - (d -
//! r)^2) for a corner of radius c about a flat of radius r, and nothing at all beyond r + c. h is convex,
//! also as a function of d^2.

use nalgebra::{Matrix2, Vector2};

/// A cutter that has no other measures; mm.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cutter {
    /// Radius of the flat.
    flat: f64,
    /// Radius of the rounded edge.
    corner: f64,
}

/// A point of the lower side of a cutter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LowerPoint {
    /// Where it is, seen from the axis, mm.
    pub place: Vector2<f64>,
    /// Its height over the tip, mm.
    pub height: f64,
    /// The gradient of the height there.
    pub gradient: Vector2<f64>,
    /// The direction from the axis, of unit length.
    away: Vector2<f64>,
    /// The distance from the axis, mm.
    distance: f64,
    /// The slope away from the axis.
    slope: f64,
}

impl LowerPoint {
    /// The part of a vector of the plane that points away from the axis, mm.
    pub fn away_of(&self, v: &Vector2<f64>) -> f64 {
        self.away.dot(v)
    }

    /// The slope away from the axis.
    pub fn slope(&self) -> f64 {
        self.slope
    }

    /// The distance from the axis, mm.
    pub fn distance(&self) -> f64 {
        self.distance
    }

    /// The direction from the axis, of unit length.
    pub fn away(&self) -> Vector2<f64> {
        self.away
    }
}

/// A quadratic form of the plane by its values along a direction and across; 1/mm.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Form {
    away: Vector2<f64>,
    along: f64,
    across: f64,
}

impl Form {
    pub fn times(&self, v: &Vector2<f64>) -> Vector2<f64> {
        let along = self.away.dot(v);
        self.away * (self.along * along) + (v - self.away * along) * self.across
    }

    /// The largest value for a unit vector; both are zero or more.
    pub fn norm(&self) -> f64 {
        self.along.max(self.across)
    }

    fn mixed(&self, other: &Form, share: f64) -> Self {
        let mix = |a: f64, b: f64| share * a + (1.0 - share) * b;
        Self { away: self.away, along: mix(self.along, other.along), across: mix(self.across, other.across) }
    }
}

impl Cutter {
    /// A ball of `radius` mm.
    pub fn ball(radius: f64) -> Self {
        Self { flat: 0.0, corner: radius }
    }

    /// A cutter of `radius` mm whose edge is rounded by `corner` mm, at most the radius.
    pub fn bull_nose(radius: f64, corner: f64) -> Self {
        Self { flat: radius - corner, corner }
    }

    /// The cutter with `by` mm more all around: its tip is that much lower.
    pub fn enlarged(self, by: f64) -> Self {
        Self { corner: self.corner + by, ..self }
    }

    pub fn radius(&self) -> f64 {
        self.flat + self.corner
    }

    pub fn flat_radius(&self) -> f64 {
        self.flat
    }

    pub fn corner_radius(&self) -> f64 {
        self.corner
    }

    /// The height of the lower side over the tip at a distance from the axis, mm; infinite beyond the radius.
    pub fn height(&self, distance: f64) -> f64 {
        let out = distance - self.flat;
        if out <= 0.0 {
            0.0
        } else if out > self.corner {
            f64::INFINITY
        } else {
            // c - q without cancellation.
            out * out / (self.corner + self.depth(out))
        }
    }

    /// The depth of the corner below its centre, `out` mm beyond the flat.
    fn depth(&self, out: f64) -> f64 {
        ((self.corner - out) * (self.corner + out)).max(0.0).sqrt()
    }

    /// The slope of the lower side at a distance from the axis; it grows with the distance, and is infinite
    /// from the radius on.
    pub fn slope(&self, distance: f64) -> f64 {
        let out = distance - self.flat;
        if out <= 0.0 { 0.0 } else { out / self.depth(out) }
    }

    /// The second derivative of the height away from the axis; it grows with the distance.
    fn bend(&self, distance: f64) -> f64 {
        let out = distance - self.flat;
        if out < 0.0 || (out == 0.0 && self.flat > 0.0) {
            0.0
        } else {
            self.corner * self.corner / self.depth(out).powi(3)
        }
    }

    /// The point below or above a place that the cutter covers, with a finite slope.
    pub fn lower_point(&self, place: Vector2<f64>) -> Option<LowerPoint> {
        let distance = place.norm();
        let slope = self.slope(distance);
        if distance > self.radius() || !slope.is_finite() {
            return None;
        }
        let away = if distance > 0.0 { place / distance } else { Vector2::x() };
        Some(LowerPoint {
            place,
            height: self.height(distance),
            gradient: away * slope,
            away,
            distance,
            slope,
        })
    }

    /// The point at which the lower side has a gradient; on the flat, which has one everywhere, its rim.
    pub fn tangent_point(&self, gradient: Vector2<f64>) -> LowerPoint {
        let slope = gradient.norm();
        let away = if slope > 0.0 { gradient / slope } else { Vector2::x() };
        let rise = 1.0 / (1.0 + slope * slope).sqrt();
        let distance = self.flat + self.corner * slope * rise;
        LowerPoint {
            place: away * distance,
            height: self.corner * (1.0 - rise),
            gradient,
            away,
            distance,
            slope,
        }
    }

    /// How the tangent point moves with the gradient, mm.
    pub fn compliance(&self, point: &LowerPoint) -> Matrix2<f64> {
        let rise = 1.0 / (1.0 + point.slope * point.slope).sqrt();
        let along = self.corner * rise * rise * rise;
        let across = point.distance / point.slope;
        let out = point.away * point.away.transpose();
        if across.is_finite() { out * along + (Matrix2::identity() - out) * across } else { out * along }
    }

    /// The second derivatives of the height.
    pub fn curvature(&self, point: &LowerPoint) -> Form {
        let along = self.bend(point.distance);
        let across = if point.distance > 0.0 { point.slope / point.distance } else { along };
        Form { away: point.away, along, across }
    }

    /// Forms Q for which the height at p is at least that of the tangent plane at `point` and Q(p - point) /
    /// 2, for every p that is at least `least` mm (negative on the near side) farther out than the point; for
    /// the first of them anywhere.
    pub fn support_forms(&self, point: &LowerPoint, least: f64) -> [Form; 4] {
        // The height is convex as a function of the squared distance: its tangent there is a paraboloid.
        let round = if point.distance > 0.0 { point.slope / point.distance } else { self.bend(0.0) };
        let all = Form { away: point.away, along: round, across: round };
        // And h(|p|) is at least h of the part along `away`, and grows across it.
        let inner = point.distance + least.min(0.0);
        let across = if inner > 0.0 { self.slope(inner) / inner } else { 0.0 };
        let at_least = if inner > 0.0 { self.bend(inner.min(point.distance)) } else { 0.0 };
        let mean = if least < -1e-4 * self.radius() {
            let height = self.height(inner.max(0.0));
            2.0 * (height - point.height - point.slope * least) / (least * least)
        } else {
            0.0
        };
        let along = at_least.max(mean);
        let steep = Form { away: point.away, along, across: across.max(0.0) };
        [all, steep, all.mixed(&steep, 0.5), all.mixed(&steep, 0.9)]
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn cutters() -> [Cutter; 4] {
        [
            Cutter::ball(5.0),
            Cutter::bull_nose(5.0, 0.0),
            Cutter::bull_nose(5.0, 1.0),
            Cutter::bull_nose(3.0, 2.9),
        ]
    }

    proptest! {
        #[test]
        fn forms_support_the_lower_side(
            k in 0usize..4, d in 0.0f64..0.999, angle in 0.0f64..7.0, to in prop::array::uniform2(-1.0f64..1.0),
            by_slope in any::<bool>(), slope in 0.0f64..20.0,
        ) {
            let cutter = cutters()[k];
            let direction = Vector2::new(angle.cos(), angle.sin());
            let point = if by_slope {
                cutter.tangent_point(direction * slope)
            } else {
                cutter.lower_point(direction * (d * cutter.radius())).unwrap()
            };
            let p = Vector2::from(to) * cutter.radius();
            let way = p - point.place;
            let height = cutter.height(p.norm());
            for least in [point.away.dot(&way), point.away.dot(&way) - 0.3, -2.0 * cutter.radius()] {
                for (n, form) in cutter.support_forms(&point, least).iter().enumerate() {
                    if point.away.dot(&way) >= least || n == 0 {
                        let below = point.height + point.gradient.dot(&way) + 0.5 * way.dot(&form.times(&way));
                        prop_assert!(below <= height + 1e-9 * (1.0 + below.abs()), "{n} {below} {height}");
                    }
                }
            }
        }
    }

    #[test]
    fn tangent_points_have_the_gradient() {
        for cutter in cutters() {
            let point = cutter.tangent_point(Vector2::new(0.3, -0.4));
            assert!((cutter.height(point.place.norm() * (1.0 - 1e-15)) - point.height).abs() < 1e-9);
            if cutter.corner_radius() > 0.0 {
                let same = cutter.lower_point(point.place).unwrap();
                assert!((same.gradient - point.gradient).norm() < 1e-12);
                let inverse =
                    cutter.compliance(&point) * cutter.curvature(&point).times(&Vector2::new(1.0, 2.0));
                assert!((inverse - Vector2::new(1.0, 2.0)).norm() < 1e-12);
            }
        }
    }
}

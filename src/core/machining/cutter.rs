//! Cutters as geometry: a flat disc with a rounded edge turns about a vertical axis. Above it is a shank of
//! the same outer radius.
//!
//! Let r be the radius of the flat disc, and c the radius of its rounded edge (the corner). A ball cutter has
//! r = 0, a flat end has c = 0, and for a bull nose both are above zero. At the distance d from the axis, the
//! lower side of the cutter is at the height h(d) above the tip:
//! * h(d) = 0 for d <= r;
//! * h(d) = c - sqrt(c^2 - (d - r)^2) for r < d <= r + c;
//! * beyond r + c there is no lower side.
//!
//! h is a convex function of d, and also a convex function of d^2.

use nalgebra::{Matrix2, Vector2};

/// A cutter; all lengths are in mm.
///
/// # Example
/// ```
/// use toolpathd_core::machining::cutter::Cutter;
///
/// let ball = Cutter::ball(5.0);
/// assert_eq!((ball.height(3.0), ball.slope(3.0)), (1.0, 0.75));
///
/// // A flat of radius 3 mm inside an edge rounded with 2 mm.
/// let bull_nose = Cutter::bull_nose(5.0, 2.0);
/// assert_eq!([3.0, 5.0, 6.0].map(|distance| bull_nose.height(distance)), [0.0, 2.0, f64::INFINITY]);
/// ```
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
    /// The position in plan, relative to the axis, mm.
    pub place: Vector2<f64>,
    /// The height over the tip, mm.
    pub height: f64,
    /// The gradient of the lower side's height.
    pub gradient: Vector2<f64>,
    /// The unit vector in plan from the axis to the point.
    away: Vector2<f64>,
    /// The distance from the axis, mm.
    distance: f64,
    /// The slope of the lower side in the direction away from the axis.
    slope: f64,
}

impl LowerPoint {
    /// The component of `v` away from the axis, in the unit of `v`.
    pub fn away_of(&self, v: &Vector2<f64>) -> f64 {
        self.away.dot(v)
    }

    /// The slope of the lower side in the direction away from the axis.
    pub fn slope(&self) -> f64 {
        self.slope
    }

    /// The distance from the axis, mm.
    pub fn distance(&self) -> f64 {
        self.distance
    }

    /// The unit vector in plan from the axis to the point.
    pub fn away(&self) -> Vector2<f64> {
        self.away
    }
}

/// A quadratic form in plan, 1/mm. Its value is `along` for the unit vector `away`, and `across` for a unit
/// vector at right angles to `away`.
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

    /// The largest value for a unit vector, if `along` and `across` are zero or more.
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

    /// A cutter of `radius` mm with a corner radius of `corner` mm, at most `radius`.
    pub fn bull_nose(radius: f64, corner: f64) -> Self {
        Self { flat: radius - corner, corner }
    }

    /// The cutter enlarged by `by` mm on all sides. Its tip lies `by` mm lower.
    pub fn enlarged(self, by: f64) -> Self {
        Self { corner: self.corner + by, ..self }
    }

    /// The largest cutter that lies within the cutter wherever the cutter is moved by up to `by` mm. Its tip
    /// lies `by` mm higher. `None` where nothing does.
    pub fn reduced(self, by: f64) -> Option<Self> {
        let corner = (self.corner - by).max(0.0);
        let flat = self.flat - (by - self.corner).max(0.0);
        (flat >= 0.0 && flat + corner > 0.0).then_some(Self { flat, corner })
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

    /// How far the lower side lies below the corner circle's centre, mm, at `out` mm beyond the flat.
    fn depth(&self, out: f64) -> f64 {
        ((self.corner - out) * (self.corner + out)).max(0.0).sqrt()
    }

    /// The slope of the lower side at a distance from the axis. It grows with the distance, and is infinite
    /// from the radius outwards.
    pub fn slope(&self, distance: f64) -> f64 {
        let out = distance - self.flat;
        if out <= 0.0 { 0.0 } else { out / self.depth(out) }
    }

    /// The second derivative of the height away from the axis, 1/mm; it grows with the distance. No second
    /// derivative of the height in plan is larger.
    pub(super) fn bend(&self, distance: f64) -> f64 {
        let out = distance - self.flat;
        if out < 0.0 || (out == 0.0 && self.flat > 0.0) {
            0.0
        } else {
            self.corner * self.corner / self.depth(out).powi(3)
        }
    }

    /// The point of the lower side at `place`, a position in plan relative to the axis. `None` beyond the
    /// radius, and where the slope is infinite.
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

    /// The point at which the lower side has the given gradient. The whole flat has a zero gradient; a point
    /// of its rim stands for the flat.
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

    /// The derivative of the tangent point's place by the gradient, mm.
    pub fn compliance(&self, point: &LowerPoint) -> Matrix2<f64> {
        let rise = 1.0 / (1.0 + point.slope * point.slope).sqrt();
        let along = self.corner * rise * rise * rise;
        let across = point.distance / point.slope;
        let out = point.away * point.away.transpose();
        if across.is_finite() { out * along + (Matrix2::identity() - out) * across } else { out * along }
    }

    /// The second derivatives of the height at `point`, 1/mm.
    pub fn curvature(&self, point: &LowerPoint) -> Form {
        let along = self.bend(point.distance);
        let across = if point.distance > 0.0 { point.slope / point.distance } else { along };
        Form { away: point.away, along, across }
    }

    /// Forms Q that support the lower side from below: the height at p is at least the height of the tangent
    /// plane at `point`, plus Q(p - point) / 2. The first form supports every p. The others support each p
    /// that lies at least `least` mm farther out than the point, along `away`; a negative `least` admits
    /// places nearer to the axis.
    pub fn support_forms(&self, point: &LowerPoint, least: f64) -> [Form; 4] {
        // The height is a convex function of the squared distance. Its tangent in that variable is a
        // paraboloid below the height.
        let round = if point.distance > 0.0 { point.slope / point.distance } else { self.bend(0.0) };
        let all = Form { away: point.away, along: round, across: round };
        // h(|p|) is at least h of the component of p along `away`, and grows with the component across.
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

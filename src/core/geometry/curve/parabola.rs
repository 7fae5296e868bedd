//! A part of a parabola in space, given by the three control points of a quadratic Bezier curve.
//!
//! The length of the curve has a closed form. The place nearest to a point is an end of the curve, or lies at
//! a parameter that is a root of a cubic polynomial. The curvature is largest at the vertex of the parabola,
//! or, if the curve does not contain the vertex, at the end of the curve nearest to it.
//!
//! # Degenerate input
//! Three control points on one line give a straight motion. If the middle control point then lies beyond one
//! of the other two, the motion passes this end and turns back. Its length counts the way there and the way
//! back. Control points may coincide. Coordinates are refused if they are not finite, or if their fourth
//! powers overflow.

use nalgebra::{Point3, Vector3};

/// The most steps to a root, halvings and Newton steps together: halvings alone shrink an interval of length
/// one below its rounding.
const STEPS: usize = 64;

/// Why three points give no parabola.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum ParabolaError {
    #[error("a coordinate of the parabola is not finite, or so large that its square overflows")]
    NotFinite,
}

/// The quadratic Bezier curve of three control points, mm.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Parabola {
    start: Point3<f64>,
    control: Point3<f64>,
    end: Point3<f64>,
}

impl Parabola {
    /// # Errors
    /// When a coordinate is not finite, or too large for the fourth powers in the distance's cubic.
    pub fn new(start: Point3<f64>, control: Point3<f64>, end: Point3<f64>) -> Result<Self, ParabolaError> {
        let parabola = Self { start, control, end };
        let [b, a] = parabola.coefficients();
        let squares = b.norm_squared() + a.norm_squared();
        let is_finite = [start, control, end].iter().all(|p| p.iter().all(|x| x.is_finite()));
        // The cubic for the distance contains fourth powers.
        if is_finite && (squares * squares).is_finite() {
            Ok(parabola)
        } else {
            Err(ParabolaError::NotFinite)
        }
    }

    pub fn start(&self) -> Point3<f64> {
        self.start
    }

    /// The point where the tangents at both ends meet.
    pub fn control(&self) -> Point3<f64> {
        self.control
    }

    pub fn end(&self) -> Point3<f64> {
        self.end
    }

    /// The second difference A = start - 2 control + end, mm. It is half the second derivative by the
    /// parameter, and runs along the axis. A chord between parameters h apart leaves the curve by |A| h^2 / 4
    /// at equal parameters.
    pub fn bend(&self) -> Vector3<f64> {
        (self.start - self.control) + (self.end - self.control)
    }

    /// Half the first derivative by the parameter, at `t`.
    pub fn velocity(&self, t: f64) -> Vector3<f64> {
        (self.control - self.start) * (1.0 - t) + (self.end - self.control) * t
    }

    /// The point at the parameter `t`. The ends are returned exactly.
    pub fn at(&self, t: f64) -> Point3<f64> {
        if t <= 0.0 {
            return self.start;
        }
        if t >= 1.0 {
            return self.end;
        }
        let from = self.start + (self.control - self.start) * t;
        let to = self.control + (self.end - self.control) * t;
        from + (to - from) * t
    }

    /// The length, mm.
    pub fn length(&self) -> f64 {
        let [b, a] = self.coefficients();
        length(&b, &a)
    }

    /// The parameter at a fraction of the length.
    pub fn parameter_at(&self, fraction: f64) -> f64 {
        if !(fraction > 0.0 && fraction < 1.0) {
            return fraction.clamp(0.0, 1.0);
        }
        let [b, a] = self.coefficients();
        let wanted = fraction * length(&b, &a);
        // The part before t has the coefficients t B and t^2 A.
        let beyond = |t: f64| length(&(b * t), &(a * (t * t))) - wanted;
        root([0.0, 1.0], |t| (beyond(t), 2.0 * (b + a * t).norm()))
    }

    /// The point at the fraction `t` of the length. The ends are returned exactly.
    pub fn point_at(&self, t: f64) -> Point3<f64> {
        self.at(self.parameter_at(t))
    }

    /// The parameter of the point P nearest to `p`: 0, 1 or a root of the cubic (P - p) . P'. The places
    /// where the cubic is largest or smallest divide the range of the parameter. Each part has at most one
    /// root.
    pub fn nearest(&self, p: &Point3<f64>) -> f64 {
        let [b, a] = self.coefficients();
        let from = self.start - p;
        // (P - p) . P' / 2, as a cubic in t.
        let [c3, c2, c1, c0] =
            [a.norm_squared(), 3.0 * a.dot(&b), 2.0 * b.norm_squared() + from.dot(&a), from.dot(&b)];
        let value = |t: f64| ((c3 * t + c2) * t + c1) * t + c0;
        let slope = |t: f64| (3.0 * c3 * t + 2.0 * c2) * t + c1;
        let [first, second] = extremes(c3, c2, c1).map(|t| t.clamp(0.0, 1.0));
        let roots = [[0.0, first], [first, second], [second, 1.0]]
            .map(|between| root(between, |t| (value(t), slope(t))));
        let off = |t: f64| (self.at(t) - p).norm();
        roots.into_iter().chain([1.0]).fold(0.0, |best, t| if off(t) < off(best) { t } else { best })
    }

    /// The distance from `p` to the curve, mm.
    pub fn distance_to(&self, p: &Point3<f64>) -> f64 {
        (self.at(self.nearest(p)) - p).norm()
    }

    /// The largest scalar product of `direction` with a point of the curve.
    pub fn support(&self, direction: &Vector3<f64>) -> f64 {
        let ends = self.start.coords.dot(direction).max(self.end.coords.dot(direction));
        let [b, a] = self.coefficients().map(|v| v.dot(direction));
        // The scalar product grows at the start and falls at the end.
        if b > 0.0 && b + a < 0.0 { ends.max(self.start.coords.dot(direction) - b * (b / a)) } else { ends }
    }

    /// The part between the parameters `from` < `to`.
    pub fn part(&self, from: f64, to: f64) -> Parabola {
        let at = |t: f64| self.start + (self.control - self.start) * t;
        let on = |t: f64| self.control + (self.end - self.control) * t;
        let control =
            if (from, to) == (0.0, 1.0) { self.control } else { at(from) + (on(from) - at(from)) * to };
        Parabola { start: self.at(from), control, end: self.at(to) }
    }

    pub fn translated(&self, by: &Vector3<f64>) -> Parabola {
        Parabola { start: self.start + by, control: self.control + by, end: self.end + by }
    }

    /// The parameter of the least speed: that of the vertex, or of the end nearest to it.
    pub fn slowest(&self) -> f64 {
        let [b, a] = self.coefficients();
        let squared = a.norm_squared();
        if squared > 0.0 { (-b.dot(&a) / squared).clamp(0.0, 1.0) } else { 0.0 }
    }

    /// The largest value of the curvature |A x B| / (2 |B + t A|^3), 1/mm: zero on a straight motion,
    /// infinite if that turns back.
    pub fn largest_curvature(&self) -> f64 {
        let [b, a] = self.coefficients();
        let t = self.slowest();
        let speed = (b + a * t).norm();
        let turn = b.cross(&a).norm();
        if speed > 0.0 {
            turn / (2.0 * speed * speed * speed)
        } else if t > 0.0 && t < 1.0 {
            f64::INFINITY
        } else {
            0.0
        }
    }

    /// Vectors along the curve at its start and its end; zero if all three points are equal.
    pub fn tangents(&self) -> [Vector3<f64>; 2] {
        let chord = self.end - self.start;
        [self.control - self.start, self.end - self.control]
            .map(|tangent| if tangent == Vector3::zeros() { chord } else { tangent })
    }

    /// B, the vector from the start to the control point, and A as in [`Parabola::bend`]. The point at the
    /// parameter t is start + 2 t B + t^2 A, and the derivative there is 2 (B + t A).
    fn coefficients(&self) -> [Vector3<f64>; 2] {
        [self.control - self.start, self.bend()]
    }
}

/// The length of the curve with the coefficients B and A, mm.
///
/// Split B + t A into its part w along A and its part q across A, which does not depend on t. The length is
/// the integral of 2 sqrt(w^2 + q^2) over t: the difference of (w sqrt(w^2 + q^2) + q^2 asinh(w / q)) / |A|
/// between the two ends. It is computed as a sum of terms that are not negative, so nothing cancels if A is
/// small.
fn length(b: &Vector3<f64>, a: &Vector3<f64>) -> f64 {
    let bend = a.norm();
    let speeds = [b.norm(), (b + a).norm()];
    let sum = speeds[0] + speeds[1];
    if bend == 0.0 || sum == 0.0 {
        return sum;
    }
    // The coordinates along the axis at both ends, mirrored if needed so that the later one is farther from
    // the vertex.
    let first = b.dot(a) / bend;
    let along = if 2.0 * first + bend < 0.0 { [-first - bend, -first] } else { [first, first + bend] };
    let speeds = if 2.0 * first + bend < 0.0 { [speeds[1], speeds[0]] } else { speeds };
    let lean = along[0] + along[1];
    let q = a.cross(b).norm() / bend;
    // The difference of asinh(w / q), over |A|.
    let turned = if q * q == 0.0 {
        0.0
    } else if along[0] < 0.0 {
        ((along[1] / q).asinh() + (-along[0] / q).asinh()) / bend
    } else {
        let rate = (1.0 + lean / sum) / (along[0] + speeds[0]);
        // For a small argument the logarithm is the argument.
        let argument = bend * rate;
        if argument > f64::EPSILON { argument.ln_1p() / bend } else { rate }
    };
    sum / 2.0 + lean * (lean / sum) / 2.0 + q * q * turned
}

/// The roots of 3 a t^2 + 2 b t + c, the smaller first; zeros if there are none.
fn extremes(a: f64, b: f64, c: f64) -> [f64; 2] {
    let discriminant = b * b - 3.0 * a * c;
    if discriminant <= 0.0 {
        return [0.0; 2];
    }
    // Each root has two forms; this is the one in which nothing cancels.
    let sum = -(b + b.signum() * discriminant.sqrt());
    let [one, other] = [c / sum, sum / (3.0 * a)];
    if one <= other { [one, other] } else { [other, one] }
}

/// The root of a function that is monotone between two places; `at` returns its value and its slope. Without
/// a root, the end at which the value is nearer to zero.
fn root([mut low, mut high]: [f64; 2], at: impl Fn(f64) -> (f64, f64)) -> f64 {
    let (first, last) = (at(low).0, at(high).0);
    if first == 0.0 || first.signum() == last.signum() {
        return if first.abs() <= last.abs() { low } else { high };
    }
    let mut t = (low + high) / 2.0;
    for _ in 0..STEPS {
        let (value, slope) = at(t);
        if value == 0.0 {
            return t;
        }
        if value.signum() == first.signum() {
            low = t
        } else {
            high = t
        }
        let next = t - value / slope;
        let next = if next > low && next < high { next } else { (low + high) / 2.0 };
        if (next - t).abs() <= f64::EPSILON * (low + high) / 4.0 {
            return next;
        }
        t = next;
    }
    t
}

#[cfg(test)]
mod tests;

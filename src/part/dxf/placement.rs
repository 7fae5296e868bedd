//! Maps of the plane that keep lines: where blocks are placed, and how their curves are scaled.

/// How far the axes of a map may differ from equal and perpendicular ones, as a part of their length, and
/// still count as such. The value is thousands of units of rounding: room for rotations and nested blocks.
/// A circle becomes an ellipse whose axes differ by this part at most, and is then drawn as a circle.
const ROUNDING: f64 = 1e-12;

/// The point p goes to `x` p.x + `y` p.y + `shift`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Placement {
    pub x: [f64; 2],
    pub y: [f64; 2],
    pub shift: [f64; 2],
}

impl Placement {
    pub fn scaled(factor: f64) -> Self {
        Self { x: [factor, 0.0], y: [0.0, factor], shift: [0.0, 0.0] }
    }

    /// The plane of an entity whose normal points down: x is negated.
    pub fn seen_from_below() -> Self {
        Self { x: [-1.0, 0.0], y: [0.0, 1.0], shift: [0.0, 0.0] }
    }

    /// The map of a block: from its base point, by the scale, and a rotation in degrees, to a place.
    pub fn of_block(base: [f64; 2], scale: [f64; 2], degrees: f64, to: [f64; 2]) -> Self {
        let [cosine, sine] = cosine_and_sine(degrees);
        let turned = Self {
            x: [scale[0] * cosine, scale[0] * sine],
            y: [-scale[1] * sine, scale[1] * cosine],
            shift: [0.0, 0.0],
        };
        let base = turned.direction(base);
        Self { shift: [to[0] - base[0], to[1] - base[1]], ..turned }
    }

    pub fn point(&self, p: [f64; 2]) -> [f64; 2] {
        let direction = self.direction(p);
        [direction[0] + self.shift[0], direction[1] + self.shift[1]]
    }

    pub fn direction(&self, v: [f64; 2]) -> [f64; 2] {
        [self.x[0] * v[0] + self.y[0] * v[1], self.x[1] * v[0] + self.y[1] * v[1]]
    }

    /// This map after `first`.
    pub fn after(&self, first: &Self) -> Self {
        Self { x: self.direction(first.x), y: self.direction(first.y), shift: self.point(first.shift) }
    }

    pub fn is_mirrored(&self) -> bool {
        perp(self.x, self.y) < 0.0
    }

    /// Whether circles stay circles.
    pub fn keeps_circles(&self) -> bool {
        are_axes_of_a_circle(self.x, self.y)
    }

    pub fn is_finite(&self) -> bool {
        [self.x, self.y, self.shift].as_flattened().iter().all(|number| number.is_finite())
    }
}

/// Whether two vectors are as long as each other and perpendicular.
pub fn are_axes_of_a_circle(u: [f64; 2], v: [f64; 2]) -> bool {
    let [uu, vv, uv] = [dot(u, u), dot(v, v), dot(u, v)];
    (uu - vv).abs() <= ROUNDING * uu && uv.abs() <= ROUNDING * uu
}

pub fn dot(u: [f64; 2], v: [f64; 2]) -> f64 {
    u[0] * v[0] + u[1] * v[1]
}

/// Positive if `v` points to the left of `u`.
pub fn perp(u: [f64; 2], v: [f64; 2]) -> f64 {
    u[0] * v[1] - u[1] * v[0]
}

/// Exact for whole quarter turns.
pub fn cosine_and_sine(degrees: f64) -> [f64; 2] {
    let degrees = degrees.rem_euclid(360.0);
    match degrees {
        0.0 | 360.0 => [1.0, 0.0],
        90.0 => [0.0, 1.0],
        180.0 => [-1.0, 0.0],
        270.0 => [0.0, -1.0],
        _ => {
            let (sine, cosine) = degrees.to_radians().sin_cos();
            [cosine, sine]
        }
    }
}

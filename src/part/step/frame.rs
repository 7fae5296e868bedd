//! Frames of surfaces and curves, and the similarities that place copies of shapes.

use nalgebra::{Matrix3, Point3, Vector3};

/// An origin with three unit vectors at right angles. Right-handed in the file; a mirrored copy is
/// left-handed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Frame {
    /// mm.
    pub origin: Point3<f64>,
    pub x: Vector3<f64>,
    pub y: Vector3<f64>,
    pub z: Vector3<f64>,
}

impl Frame {
    /// The frame of an origin, a direction of z and a direction near x. Without `near`, and where `near` is
    /// along z, x is any direction at right angles. `None` if z has no direction.
    pub fn from_axis(origin: Point3<f64>, z: Vector3<f64>, near: Option<Vector3<f64>>) -> Option<Self> {
        let z = z.try_normalize(f64::MIN_POSITIVE)?;
        let flat = |v: Vector3<f64>| {
            let v = v.try_normalize(f64::MIN_POSITIVE)?;
            (v - z * v.dot(&z)).try_normalize(1e-9)
        };
        let x = near.and_then(flat).or_else(|| flat(Vector3::x())).or_else(|| flat(Vector3::y()))?;
        Some(Self { origin, x, y: z.cross(&x), z })
    }

    /// The coordinates of a point in the frame, mm.
    pub fn local(&self, point: &Point3<f64>) -> Vector3<f64> {
        let d = point - self.origin;
        Vector3::new(d.dot(&self.x), d.dot(&self.y), d.dot(&self.z))
    }

    /// The point with these coordinates in the frame, mm.
    pub fn point(&self, local: &Vector3<f64>) -> Point3<f64> {
        self.origin + self.vector(local)
    }

    pub fn vector(&self, local: &Vector3<f64>) -> Vector3<f64> {
        self.x * local.x + self.y * local.y + self.z * local.z
    }

    /// The unit vector at an angle from x towards y, radians.
    pub fn radial(&self, angle: f64) -> Vector3<f64> {
        let (sin, cos) = angle.sin_cos();
        self.x * cos + self.y * sin
    }

    fn matrix(&self) -> Matrix3<f64> {
        Matrix3::from_columns(&[self.x, self.y, self.z])
    }
}

/// A turn or mirroring, and a shift after it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Placement {
    /// The directions of the axes; at right angles and of unit length.
    pub turn: Matrix3<f64>,
    /// mm.
    pub shift: Vector3<f64>,
}

/// A scale, and a placement after it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Similarity {
    /// Above 0.
    pub scale: f64,
    pub placement: Placement,
}

impl Placement {
    pub fn identity() -> Self {
        Self { turn: Matrix3::identity(), shift: Vector3::zeros() }
    }

    pub fn is_mirror(&self) -> bool {
        self.turn.determinant() < 0.0
    }

    pub fn point(&self, point: &Point3<f64>) -> Point3<f64> {
        Point3::from(self.turn * point.coords + self.shift)
    }

    pub fn vector(&self, vector: &Vector3<f64>) -> Vector3<f64> {
        self.turn * vector
    }

    pub fn frame(&self, frame: &Frame) -> Frame {
        let [x, y, z] = [frame.x, frame.y, frame.z].map(|axis| self.turn * axis);
        Frame { origin: self.point(&frame.origin), x, y, z }
    }
}

impl Similarity {
    pub fn identity() -> Self {
        Self { scale: 1.0, placement: Placement::identity() }
    }

    /// The similarity that takes the frame `from` to the frame `to`, with a scale.
    pub fn between(from: &Frame, to: &Frame, scale: f64) -> Self {
        let turn = to.matrix() * from.matrix().transpose();
        let shift = to.origin.coords - turn * from.origin.coords * scale;
        Self { scale, placement: Placement { turn, shift } }
    }

    /// The similarity that applies `inner` first.
    pub fn after(&self, inner: &Self) -> Self {
        let (outer, inner_placement) = (&self.placement, &inner.placement);
        let turn = outer.turn * inner_placement.turn;
        let shift = outer.turn * inner_placement.shift * self.scale + outer.shift;
        Self { scale: self.scale * inner.scale, placement: Placement { turn, shift } }
    }
}

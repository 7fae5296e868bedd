//! One bicubic Bezier patch: evaluation, subdivision and bounds by its control net.

use nalgebra::{Point3, Vector3};

use super::Jet;

/// A control net `net[a][b]`, a along u, over the unit square; mm.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Patch {
    pub net: [[Vector3<f64>; 4]; 4],
}

/// An axis-aligned box, mm.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bounds {
    pub min: Vector3<f64>,
    pub max: Vector3<f64>,
}

impl Bounds {
    pub const EMPTY: Bounds = Bounds {
        min: Vector3::new(f64::INFINITY, f64::INFINITY, f64::INFINITY),
        max: Vector3::new(f64::NEG_INFINITY, f64::NEG_INFINITY, f64::NEG_INFINITY),
    };

    pub fn include(&mut self, p: &Vector3<f64>) {
        self.min = self.min.inf(p);
        self.max = self.max.sup(p);
    }

    pub fn union(&self, other: &Bounds) -> Bounds {
        Bounds { min: self.min.inf(&other.min), max: self.max.sup(&other.max) }
    }

    /// The largest absolute coordinate.
    pub fn magnitude(&self) -> f64 {
        self.min.amax().max(self.max.amax())
    }
}

impl Patch {
    /// The jet at (u, v) of the unit square.
    pub fn jet(&self, u: f64, v: f64) -> Jet {
        let (bu, bv) = (basis(u), basis(v));
        let mut sums = [Vector3::zeros(); 6];
        for (a, row) in self.net.iter().enumerate() {
            let mut along = [Vector3::zeros(); 3];
            for (order, sum) in along.iter_mut().enumerate() {
                let w = &bv[order];
                *sum = row[0] * w[0] + row[1] * w[1] + row[2] * w[2] + row[3] * w[3];
            }
            sums[0] += along[0] * bu[0][a];
            sums[1] += along[0] * bu[1][a];
            sums[2] += along[1] * bu[0][a];
            sums[3] += along[0] * bu[2][a];
            sums[4] += along[1] * bu[1][a];
            sums[5] += along[2] * bu[0][a];
        }
        let [point, du, dv, duu, duv, dvv] = sums;
        Jet { point: Point3::from(point), du, dv, duu, duv, dvv }
    }

    /// The point at the centre of the unit square.
    pub fn center(&self) -> Vector3<f64> {
        const W: [f64; 4] = [0.125, 0.375, 0.375, 0.125];
        let mut sum = Vector3::zeros();
        for (row, wu) in self.net.iter().zip(W) {
            sum += (row[0] * W[0] + row[1] * W[1] + row[2] * W[2] + row[3] * W[3]) * wu;
        }
        sum
    }

    /// The halves u <= 1/2 and u >= 1/2, each over a unit square again.
    pub fn split_u(&self) -> [Patch; 2] {
        let (mut low, mut high) = (*self, *self);
        for b in 0..4 {
            let column = [self.net[0][b], self.net[1][b], self.net[2][b], self.net[3][b]];
            let (l, h) = halves(&column);
            for a in 0..4 {
                low.net[a][b] = l[a];
                high.net[a][b] = h[a];
            }
        }
        [low, high]
    }

    /// The halves v <= 1/2 and v >= 1/2, each over a unit square again.
    pub fn split_v(&self) -> [Patch; 2] {
        let (mut low, mut high) = (*self, *self);
        for a in 0..4 {
            (low.net[a], high.net[a]) = halves(&self.net[a]);
        }
        [low, high]
    }

    /// The two halves across the direction in which the patch is longer.
    pub fn split(&self) -> [Patch; 2] {
        let [along_u, along_v] = self.extents();
        if along_u >= along_v { self.split_u() } else { self.split_v() }
    }

    /// Lengths of the control net along u and v, mm: the larger of the two boundary polygons' chords each way.
    pub fn extents(&self) -> [f64; 2] {
        let n = &self.net;
        [
            (n[3][0] - n[0][0]).norm().max((n[3][3] - n[0][3]).norm()),
            (n[0][3] - n[0][0]).norm().max((n[3][3] - n[3][0]).norm()),
        ]
    }

    /// A box that holds the patch: that of its control points.
    pub fn bounds(&self) -> Bounds {
        let mut bounds = Bounds::EMPTY;
        self.net.iter().flatten().for_each(|p| bounds.include(p));
        bounds
    }

    /// The least coordinate along `direction` over the control points, never above that of the patch.
    pub fn lowest_along(&self, direction: &Vector3<f64>) -> f64 {
        self.net.iter().flatten().map(|p| p.dot(direction)).fold(f64::INFINITY, f64::min)
    }
}

/// Cubic Bernstein values and their first and second derivatives at `t`.
fn basis(t: f64) -> [[f64; 4]; 3] {
    let s = 1.0 - t;
    [
        [s * s * s, 3.0 * s * s * t, 3.0 * s * t * t, t * t * t],
        [-3.0 * s * s, 3.0 * s * (s - 2.0 * t), 3.0 * t * (2.0 * s - t), 3.0 * t * t],
        [6.0 * s, 6.0 * (t - 2.0 * s), 6.0 * (s - 2.0 * t), 6.0 * t],
    ]
}

/// de Casteljau's halves of a cubic.
fn halves(p: &[Vector3<f64>; 4]) -> ([Vector3<f64>; 4], [Vector3<f64>; 4]) {
    let p01 = (p[0] + p[1]) * 0.5;
    let p12 = (p[1] + p[2]) * 0.5;
    let p23 = (p[2] + p[3]) * 0.5;
    let p012 = (p01 + p12) * 0.5;
    let p123 = (p12 + p23) * 0.5;
    let mid = (p012 + p123) * 0.5;
    ([p[0], p01, p012, mid], [mid, p123, p23, p[3]])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// x = u, y = v, z = u^3 v^2 - 2 u v as a Bezier net by blossoming.
    fn sample_patch() -> Patch {
        let u3 = [0.0, 0.0, 0.0, 1.0];
        let v2 = [0.0, 0.0, 1.0 / 3.0, 1.0];
        let t = [0.0, 1.0 / 3.0, 2.0 / 3.0, 1.0];
        let mut net = [[Vector3::zeros(); 4]; 4];
        for a in 0..4 {
            for b in 0..4 {
                net[a][b] = Vector3::new(t[a], t[b], u3[a] * v2[b] - 2.0 * t[a] * t[b]);
            }
        }
        Patch { net }
    }

    #[test]
    fn jet_is_that_of_the_polynomial() {
        let (u, v) = (0.3, 0.8);
        let jet = sample_patch().jet(u, v);
        let expected = [
            (jet.point.z, u * u * u * v * v - 2.0 * u * v),
            (jet.du.z, 3.0 * u * u * v * v - 2.0 * v),
            (jet.dv.z, 2.0 * u * u * u * v - 2.0 * u),
            (jet.duu.z, 6.0 * u * v * v),
            (jet.duv.z, 6.0 * u * u * v - 2.0),
            (jet.dvv.z, 2.0 * u * u * u),
        ];
        for (got, want) in expected {
            assert!((got - want).abs() < 1e-14, "{got} {want}");
        }
        assert!((jet.du.x - 1.0).abs() < 1e-15 && jet.duu.x.abs() < 1e-14);
    }

    #[test]
    fn halves_are_the_patch_again() {
        let patch = sample_patch();
        for (u, v) in [(0.1, 0.9), (0.5, 0.25), (0.75, 0.6)] {
            let [low, high] = patch.split_u();
            let half = if u < 0.5 { low.jet(2.0 * u, v) } else { high.jet(2.0 * u - 1.0, v) };
            assert!((half.point - patch.jet(u, v).point).norm() < 1e-15);
            let [low, high] = patch.split_v();
            let half = if v < 0.5 { low.jet(u, 2.0 * v) } else { high.jet(u, 2.0 * v - 1.0) };
            assert!((half.point - patch.jet(u, v).point).norm() < 1e-15);
        }
        assert!((patch.center() - patch.jet(0.5, 0.5).point.coords).norm() < 1e-15);
    }
}

//! Points of known surfaces, with noise that is the same in every run.

use nalgebra::Point3;

use crate::budget::Budget;
use crate::geometry::surface::point_fit::{Error, Fitted, OutlierChoice, PointFit};

/// Numbers from 0 to 1 that look random.
pub struct Numbers(u64);

impl Numbers {
    pub fn new(seed: u64) -> Self {
        Self(88_172_645_463_325_252 ^ seed.wrapping_mul(0x9E37_79B9_7F4A_7C15))
    }

    pub fn next(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// A number of the normal distribution with mean 0 and variance 1, by Box and Muller.
    pub fn normal(&mut self) -> f64 {
        let (radius, angle) = ((-2.0 * (1.0 - self.next()).ln()).sqrt(), std::f64::consts::TAU * self.next());
        radius * angle.cos()
    }
}

/// `n` points at random places from 0 to 100 mm; three corners of this square are among them.
pub fn scattered(n: usize, height: impl Fn(f64, f64) -> f64) -> Vec<Point3<f64>> {
    let mut numbers = Numbers::new(1);
    let corners = [[0.0, 0.0], [100.0, 0.0], [0.0, 100.0], [100.0, 100.0]];
    let place = |k: usize| match corners.get(k) {
        Some(corner) => *corner,
        None => [100.0 * numbers.next(), 100.0 * numbers.next()],
    };
    let at = |[x, y]: [f64; 2]| Point3::new(x, y, height(x, y));
    (0..n).map(place).map(at).collect()
}

/// A grid over a square of 100 mm, turned by an angle about the origin. The height is of the place before the
/// turn.
pub fn grid([n, m]: [usize; 2], angle: f64, height: impl Fn(f64, f64) -> f64) -> Vec<Point3<f64>> {
    let (sin, cos) = angle.sin_cos();
    let at = |i: usize, j: usize| {
        let (x, y) = (100.0 * i as f64 / (n - 1) as f64, 100.0 * j as f64 / (m - 1) as f64);
        Point3::new(cos * x - sin * y, sin * x + cos * y, height(x, y))
    };
    (0..n).flat_map(|i| (0..m).map(move |j| [i, j])).map(|[i, j]| at(i, j)).collect()
}

/// A wave of 2 mm, about 60 mm long.
pub fn wave(x: f64, y: f64) -> f64 {
    2.0 * (x / 10.0).sin() * (y / 12.0).cos() + 0.01 * x
}

/// The same points with normal noise of the standard deviation `sigma` in z.
pub fn noise(mut points: Vec<Point3<f64>>, sigma: f64) -> Vec<Point3<f64>> {
    let mut numbers = Numbers::new(2);
    points.iter_mut().for_each(|p| p.z += sigma * numbers.normal());
    points
}

pub fn fit_of(points: &[Point3<f64>], error: Error) -> PointFit {
    PointFit { points: points.to_vec(), error, outliers: OutlierChoice::Refuse }
}

/// The surface of points without mistakes.
pub fn fitted(points: &[Point3<f64>], error: Error) -> Fitted {
    fit_of(points, error).fitted(&Budget::unlimited()).unwrap()
}

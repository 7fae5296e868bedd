//! The plane of least squares through heights.

use nalgebra::{Matrix3, Vector3};

/// z = height + slopes . (place - center).
#[derive(Debug, Clone, Copy)]
pub struct Trend {
    center: [f64; 2],
    height: f64,
    slopes: [f64; 2],
}

impl Trend {
    /// The plane of places and heights, of which there is at least one. Level where they are on a line.
    pub fn of(samples: impl Iterator<Item = ([f64; 2], f64)> + Clone) -> Self {
        let first = samples.clone().next().map_or(0.0, |(_, z)| z);
        let mut sum = Vector3::zeros();
        let mut n = 0.0;
        for (place, z) in samples.clone() {
            sum += Vector3::new(place[0], place[1], z - first);
            n += 1.0;
        }
        let mean = sum / n;
        let mut moments = Matrix3::zeros();
        for (place, z) in samples {
            let from = Vector3::new(place[0], place[1], z - first) - mean;
            moments += from * from.transpose();
        }
        let (xx, xy, yy) = (moments[(0, 0)], moments[(0, 1)], moments[(1, 1)]);
        let (xz, yz) = (moments[(0, 2)], moments[(1, 2)]);
        let det = xx * yy - xy * xy;
        let slopes = [(xz * yy - yz * xy) / det, (yz * xx - xz * xy) / det];
        let slopes = if slopes.iter().all(|slope| slope.is_finite()) { slopes } else { [0.0; 2] };
        Self { center: [mean.x, mean.y], height: first + mean.z, slopes }
    }

    /// The height of the plane.
    pub fn at(&self, place: [f64; 2]) -> f64 {
        self.height + self.rise(place)
    }

    /// How far `z` is above the plane.
    pub fn above(&self, place: [f64; 2], z: f64) -> f64 {
        (z - self.height) - self.rise(place)
    }

    fn rise(&self, place: [f64; 2]) -> f64 {
        (0..2).map(|k| self.slopes[k] * (place[k] - self.center[k])).sum()
    }
}

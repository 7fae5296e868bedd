//! B-spline curves in space.

use nalgebra::{Point3, Vector3, Vector4};

use super::basis::{MAX_DEGREE, breaks, functions, span};

/// A B-spline curve, perhaps rational.
#[derive(Debug, Clone, PartialEq)]
pub struct SplineCurve {
    pub degree: usize,
    /// As many as control points and degree + 1.
    pub knots: Vec<f64>,
    /// In space, not multiplied by the weights, mm.
    pub control_points: Vec<Point3<f64>>,
    /// `None` makes all weights 1.
    pub weights: Option<Vec<f64>>,
    /// Whether the ends meet.
    pub is_closed: bool,
}

impl SplineCurve {
    /// The curve of valid knots. It is closed if its ends meet within 1e-7 of the length of its control
    /// polygon.
    pub fn new(
        degree: usize,
        knots: Vec<f64>,
        control_points: Vec<Point3<f64>>,
        weights: Option<Vec<f64>>,
    ) -> Self {
        let mut curve = Self { degree, knots, control_points, weights, is_closed: false };
        let [from, to] = curve.domain();
        let gap = (curve.jet(to).0 - curve.jet(from).0).norm();
        let length: f64 = curve.control_points.windows(2).map(|pair| (pair[1] - pair[0]).norm()).sum();
        curve.is_closed = gap <= 1e-7 * length;
        curve
    }

    /// The first and the last parameter.
    pub fn domain(&self) -> [f64; 2] {
        [self.knots[self.degree], self.knots[self.control_points.len()]]
    }

    pub fn breaks(&self) -> Vec<f64> {
        breaks(self.degree, &self.knots)
    }

    /// The control points times their weights, followed by the weights.
    pub fn homogeneous(&self) -> Vec<Vector4<f64>> {
        (0..self.control_points.len()).map(|k| self.lifted(k)).collect()
    }

    fn lifted(&self, k: usize) -> Vector4<f64> {
        let weight = self.weights.as_ref().map_or(1.0, |weights| weights[k]);
        (self.control_points[k].coords * weight).push(weight)
    }

    /// The point (mm) and the derivative (mm per unit of parameter) at `t` of the domain.
    pub fn jet(&self, t: f64) -> (Point3<f64>, Vector3<f64>) {
        let i = span(self.degree, &self.knots, t);
        let (values, slopes) = functions(self.degree, &self.knots, i, t);
        let mut sums = [Vector4::zeros(); 2];
        for k in 0..=self.degree.min(MAX_DEGREE) {
            let point = self.lifted(i - self.degree + k);
            sums[0] += point * values[k];
            sums[1] += point * slopes[k];
        }
        let [value, slope] = sums;
        let point = value.xyz() / value.w;
        (Point3::from(point), (slope.xyz() - point * slope.w) / value.w)
    }
}

//! The rectangle of points in plan: the frame whose sides the parameters of the surface run along.
//!
//! # Method
//! A rectangle of least area has a side along an edge of the convex hull. The rectangle along x and y is
//! taken where it is hardly larger; so points of a turned grid are framed along their rows, and other points
//! along the axes.

use nalgebra::{Point2, Vector2};

use super::system::Sample;

/// The rectangle along x and y is taken where its area is at most this many times the least area. A grid
/// that is turned by less than half a degree counts as not turned.
const HARDLY_LARGER: f64 = 1.02;

/// The most directions that are tried. A hull with more edges is nearly round, and all rectangles around it
/// nearly alike.
const MOST_DIRECTIONS: usize = 720;

/// A rectangle in plan, mm.
#[derive(Debug, Clone, PartialEq)]
pub struct Frame {
    /// The corner from which u and v grow.
    pub origin: Point2<f64>,
    /// The unit vectors along u and v, which turn counterclockwise; u is within 45 degrees of x.
    pub axes: [Vector2<f64>; 2],
    pub lengths: [f64; 2],
    /// The area of the convex hull of the points, mm^2.
    pub hull_area: f64,
}

impl Frame {
    /// The frame of at least one point.
    pub fn around(points: &[Point2<f64>]) -> Self {
        let center = points[0];
        let hull = hull(points.iter().map(|p| p - center).collect());
        let hull_area = 0.5 * edges(&hull).map(|(a, b)| a.perp(&b)).sum::<f64>();
        let along = |axis: Vector2<f64>| {
            let axes = [axis, Vector2::new(-axis.y, axis.x)];
            let ranges = axes.map(|axis| range(hull.iter().map(|p| p.dot(&axis))));
            (axes, ranges)
        };
        let area = |(_, ranges): &([Vector2<f64>; 2], [[f64; 2]; 2])| -> f64 {
            ranges.iter().map(|[low, high]| high - low).product()
        };
        let straight = along(Vector2::x());
        let stride = hull.len().div_ceil(MOST_DIRECTIONS).max(1);
        let turned = edges(&hull)
            .step_by(stride)
            .filter_map(|(a, b)| (b - a).try_normalize(0.0))
            .map(|edge| along(toward_x(edge)))
            .min_by(|a, b| area(a).total_cmp(&area(b)));
        let (axes, ranges) = match turned {
            Some(turned) if area(&straight) > HARDLY_LARGER * area(&turned) => turned,
            _ => straight,
        };
        let origin = center + axes[0] * ranges[0][0] + axes[1] * ranges[1][0];
        Self { origin, axes, lengths: ranges.map(|[low, high]| high - low), hull_area }
    }

    /// The place of a point in the frame, mm along u and v.
    pub fn place(&self, point: &Point2<f64>) -> [f64; 2] {
        let from = point - self.origin;
        self.axes.map(|axis| from.dot(&axis))
    }

    /// The longer side, mm.
    pub fn longest(&self) -> f64 {
        self.lengths[0].max(self.lengths[1])
    }

    /// The sides, as parts of the longer one.
    pub fn unit_lengths(&self) -> [f64; 2] {
        self.lengths.map(|side| side / self.longest())
    }

    /// A place of the frame, as parts of its sides.
    pub fn share(&self, place: [f64; 2]) -> [f64; 2] {
        [0, 1].map(|k| (place[k] / self.lengths[k]).clamp(0.0, 1.0))
    }

    /// Samples of full weight, of places in the frame and their heights.
    pub fn samples(&self, heights: impl Iterator<Item = ([f64; 2], f64)>) -> Vec<Sample> {
        heights.map(|(place, height)| Sample { place: self.share(place), height, weight: 1.0 }).collect()
    }

    /// The point at a place of the frame.
    pub fn point(&self, [u, v]: [f64; 2]) -> Point2<f64> {
        self.origin + self.axes[0] * u + self.axes[1] * v
    }
}

/// The direction, turned by quarters, that is nearest to x.
fn toward_x(edge: Vector2<f64>) -> Vector2<f64> {
    let turned = if edge.x.abs() >= edge.y.abs() { edge } else { Vector2::new(edge.y, -edge.x) };
    if turned.x < 0.0 { -turned } else { turned }
}

fn edges(hull: &[Vector2<f64>]) -> impl Iterator<Item = (Vector2<f64>, Vector2<f64>)> + '_ {
    (0..hull.len()).map(|k| (hull[k], hull[(k + 1) % hull.len()]))
}

/// The corners of the convex hull, counterclockwise, by Andrew's chains.
fn hull(mut points: Vec<Vector2<f64>>) -> Vec<Vector2<f64>> {
    points.sort_unstable_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    points.dedup();
    if points.len() < 3 {
        return points;
    }
    let chain = |points: &mut dyn Iterator<Item = Vector2<f64>>| {
        let mut chain: Vec<Vector2<f64>> = Vec::new();
        for p in points {
            while let [.., a, b] = chain[..]
                && (b - a).perp(&(p - a)) <= 0.0
            {
                chain.pop();
            }
            chain.push(p);
        }
        chain.pop();
        chain
    };
    let mut corners = chain(&mut points.iter().copied());
    corners.extend(chain(&mut points.iter().rev().copied()));
    corners
}

fn range(values: impl Iterator<Item = f64>) -> [f64; 2] {
    values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| [low.min(x), high.max(x)])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grid(angle: f64) -> Vec<Point2<f64>> {
        let (sin, cos) = angle.sin_cos();
        let at = |i: usize, j: usize| {
            let (x, y) = (i as f64, 0.5 * j as f64);
            Point2::new(7.0 + cos * x - sin * y, -3.0 + sin * x + cos * y)
        };
        (0..=8).flat_map(|i| (0..=6).map(move |j| at(i, j))).collect()
    }

    #[test]
    fn a_turned_grid_is_framed_along_its_rows() {
        for angle in [0.0, 0.3, -0.6, 0.7] {
            let frame = Frame::around(&grid(angle));
            assert!((frame.axes[0] - Vector2::new(angle.cos(), angle.sin())).norm() < 1e-12, "{frame:?}");
            assert!((frame.lengths[0] - 8.0).abs() < 1e-12 && (frame.lengths[1] - 3.0).abs() < 1e-12);
            assert!((frame.origin - Point2::new(7.0, -3.0)).norm() < 1e-12);
            assert!((frame.hull_area - 24.0).abs() < 1e-9);
        }
    }

    #[test]
    fn a_round_part_is_framed_along_x_and_y() {
        let at = |k: usize| Point2::new((0.1 * k as f64).cos(), (0.1 * k as f64).sin());
        let frame = Frame::around(&(0..63).map(at).collect::<Vec<_>>());
        assert_eq!(frame.axes, [Vector2::x(), Vector2::y()]);
    }

    #[test]
    fn points_on_a_line_have_a_frame_without_area() {
        let line: Vec<Point2<f64>> = (0..9).map(|k| Point2::new(k as f64, 2.0 * k as f64)).collect();
        let frame = Frame::around(&line);
        assert!(frame.lengths[0].min(frame.lengths[1]) < 1e-12, "{frame:?}");
        assert_eq!(Frame::around(&[Point2::new(1.0, 2.0)]).lengths, [0.0, 0.0]);
    }
}

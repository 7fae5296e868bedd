//! Arcs and lines through a sequence of points in a plane.
//!
//! # Method
//! Ju, section 4: an arc runs from a point to a later one, and grows while every point between lies within
//! the tolerance of it; the next arc starts where it ends. The arcs through two points P, Q are a family with
//! one parameter, the bulge b = tan(sweep / 4) (positive to the left of PQ). "The point X is within e of the
//! arc" is an interval of b in closed form: with L half the chord, (x, y) the point in the frame of the
//! chord's middle, dP and dQ its distances to the ends,
//! S = sqrt((dP^2 - e^2)(dQ^2 - e^2)) and k = x^2 + y^2 - L^2 - e^2,
//! b is in [2L(y - e)/(S - k), 2L(y + e)/(S - k)]; no constraint where dP <= e or dQ <= e.
//! So the paper's search for a radius is an intersection of intervals. The arc with the least largest error,
//! which the paper asks for, is the one that leaves the farthest points to its left and right equally far: every
//! signed distance falls as the bulge grows, so it is the root of a falling function.
//!
//! # Guarantees
//! Every point is within the tolerance of its element; the last point is reached. Between the points nothing
//! is promised here: the caller knows how far the true curve leaves its chords.
//!
//! # Degenerate input
//! Two points make a line. Coincident consecutive points are legal. Arcs of more than half a turn, and the
//! rare points with S <= k, for which the valid bulges are the complement of an interval, end the growth.
//!
//! # Cost
//! O(n log n) for n points: growth is tested at doubling lengths, then by halving, instead of point by point.
//!
//! # Differences from the paper
//! As printed the algorithm drops a tail of two points; here it becomes a line. Eq. 4 measures to the whole
//! circle, this to the arc. Growing by doubling may end an arc later than the first failure would, where a
//! longer arc is valid again; never earlier. An arc flatter than [`FLATTEST_MM`] is a line where a line fits;
//! no arc has a radius above [`LARGEST_RADIUS_MM`].
//!
//! # Reference
//! S. Y. Ju, "CL-Cartesian Machining along Approximated Circular Arcs", section 4, eq. 4.

mod space;

pub use space::{
    Continuity, Fit, FitError, Joints, Measure, Method, Piece, fit_in_space, polyline_deviation,
};

use nalgebra::Vector2;

/// Controls have run whole circles where an arc's height was lost in rounding.
pub const FLATTEST_MM: f64 = 1e-3;

/// Controls refuse, or run badly, arcs of larger radius.
pub const LARGEST_RADIUS_MM: f64 = 1e4;

/// Steps in the search for the best bulge; it takes five to ten.
const BULGE_STEPS: usize = 60;

/// A line or an arc that ends at the point with index `end` and starts where the one before ended.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Element {
    pub end: usize,
    pub shape: Shape,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Shape {
    Line,
    /// tan(sweep / 4), positive where the arc lies to the left of its chord (it then turns clockwise).
    Arc {
        bulge: f64,
    },
}

/// What elements may be.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shapes {
    LinesOnly,
    ArcsAndLines,
}

/// Elements from the first point to the last, each within `tolerance` mm of the points it passes.
pub fn greedy(points: &[Vector2<f64>], tolerance: f64, shapes: Shapes) -> Vec<Element> {
    let mut elements = Vec::new();
    let mut start = 0;
    while start + 1 < points.len() {
        let end = longest(points, start, tolerance, shapes);
        let shape = best_shape(&points[start..=end], tolerance, shapes);
        elements.push(Element { end, shape });
        start = end;
    }
    elements
}

/// The centre of the arc from `from` to `to` with this bulge.
pub fn center(from: Vector2<f64>, to: Vector2<f64>, bulge: f64) -> Vector2<f64> {
    let half = (to - from) * 0.5;
    let left = Vector2::new(-half.y, half.x);
    from + half + left * ((bulge * bulge - 1.0) / (2.0 * bulge))
}

/// The end of the longest element from `start`.
fn longest(points: &[Vector2<f64>], start: usize, tolerance: f64, shapes: Shapes) -> usize {
    let last = points.len() - 1;
    let fits = |end: usize| valid_bulges(&points[start..=end], tolerance, shapes).is_some();
    let (mut good, mut stride) = (start + 1, 1);
    let mut bad = loop {
        if good == last {
            return last;
        }
        let trial = (good + stride).min(last);
        if !fits(trial) {
            break trial;
        }
        good = trial;
        stride *= 2;
    };
    while bad - good > 1 {
        let trial = good + (bad - good) / 2;
        if fits(trial) {
            good = trial;
        } else {
            bad = trial;
        }
    }
    good
}

/// The shape with the least largest error through points that some shape fits.
fn best_shape(points: &[Vector2<f64>], tolerance: f64, shapes: Shapes) -> Shape {
    let Some(widest) = valid_bulges(points, tolerance, shapes) else { return Shape::Line };
    if points.len() == 2 || shapes == Shapes::LinesOnly {
        return Shape::Line;
    }
    let half_chord = 0.5 * (points[points.len() - 1] - points[0]).norm();
    let flattest = flattest_bulge(half_chord);
    let best = best_bulge(points, widest);
    let is_flat = best.abs() < flattest || best.abs() * half_chord < FLATTEST_MM;
    if is_flat && widest[0] <= 0.0 && widest[1] >= 0.0 {
        Shape::Line
    } else if best.abs() >= flattest {
        Shape::Arc { bulge: best }
    } else {
        Shape::Arc {
            bulge: if widest[1] >= flattest { flattest.max(widest[0]) } else { widest[1].min(-flattest) },
        }
    }
}

/// The bulge in `valid` with the least largest distance of a point from its circle, by regula falsi (the Illinois
/// variant), to rounding.
fn best_bulge(points: &[Vector2<f64>], valid: [f64; 2]) -> f64 {
    let ([mut low, mut high], mut side) = (valid, 0);
    let (mut above, mut below) = (unbalance(points, low), unbalance(points, high));
    if above <= 0.0 {
        return low;
    }
    if below >= 0.0 {
        return high;
    }
    for _ in 0..BULGE_STEPS {
        let trial = (low * below - high * above) / (below - above);
        if trial <= low || trial >= high {
            break;
        }
        let value = unbalance(points, trial);
        if value == 0.0 {
            return trial;
        }
        // The end that stays counts half, so that both ends move.
        if value > 0.0 {
            (low, above) = (trial, value);
            below *= if side == 1 { 0.5 } else { 1.0 };
            side = 1;
        } else {
            (high, below) = (trial, value);
            above *= if side == -1 { 0.5 } else { 1.0 };
            side = -1;
        }
    }
    if above < -below { low } else { high }
}

/// The sum of the largest and the least signed distance of the points from the circle with this bulge over the chord
/// from the first to the last; mm, positive to the left.
fn unbalance(points: &[Vector2<f64>], bulge: f64) -> f64 {
    let (from, to) = (points[0], points[points.len() - 1]);
    let half = (to - from) * 0.5;
    let l = half.norm();
    let (along, middle, b) = (half / l, from + half, bulge);
    let (mut least, mut largest) = (0.0f64, 0.0f64);
    for p in &points[1..points.len() - 1] {
        let d = p - middle;
        let (x, y) = (along.dot(&d), along.perp(&d));
        // |X - C| - r, with both times 2 |b|, so that it holds for a flat arc.
        let power = 2.0 * b * (x * x + y * y - l * l) + 2.0 * y * l * (1.0 - b * b);
        let distances = l * (1.0 + b * b) + (2.0 * b * x).hypot(2.0 * b * y + l * (1.0 - b * b));
        least = least.min(power / distances);
        largest = largest.max(power / distances);
    }
    least + largest
}

/// The bulge over this half chord, mm, of an arc of the largest radius.
fn flattest_bulge(half_chord: f64) -> f64 {
    let r = LARGEST_RADIUS_MM;
    // At radius r over half a chord h it is (r - sqrt(r^2 - h^2)) / h.
    half_chord / (r + (r * r - half_chord * half_chord).max(0.0).sqrt())
}

/// The bulges of the arcs from the first point to the last that pass within `tolerance` of all others.
fn valid_bulges(points: &[Vector2<f64>], tolerance: f64, shapes: Shapes) -> Option<[f64; 2]> {
    let (from, to) = (points[0], points[points.len() - 1]);
    let half = (to - from) * 0.5;
    let half_length = half.norm();
    if half_length == 0.0 {
        return (points.len() == 2).then_some([0.0, 0.0]);
    }
    let (along, middle) = (half / half_length, from + half);
    let mut valid: [f64; 2] = match shapes {
        Shapes::LinesOnly => [0.0, 0.0],
        Shapes::ArcsAndLines => [-1.0, 1.0],
    };
    let squared_tolerance = tolerance * tolerance;
    for p in &points[1..points.len() - 1] {
        let d = p - middle;
        let (x, y) = (along.dot(&d), along.perp(&d));
        let (to_from, to_to) = ((p - from).norm_squared(), (p - to).norm_squared());
        if to_from <= squared_tolerance || to_to <= squared_tolerance {
            continue;
        }
        let s = ((to_from - squared_tolerance) * (to_to - squared_tolerance)).sqrt();
        let k = x * x + y * y - half_length * half_length - squared_tolerance;
        if s - k <= 0.0 {
            return None;
        }
        let scale = 2.0 * half_length / (s - k);
        valid = [valid[0].max(scale * (y - tolerance)), valid[1].min(scale * (y + tolerance))];
        if valid[0] > valid[1] {
            return None;
        }
    }
    let flattest = flattest_bulge(half_length);
    let has_line = valid[0] <= 0.0 && valid[1] >= 0.0;
    (has_line || valid[1] >= flattest || valid[0] <= -flattest).then_some(valid)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::curve::{Arc, Curve, Direction, Line};
    use crate::geometry::plane::Plane;
    use nalgebra::{Point3, Vector3};
    use proptest::prelude::*;

    fn circle(radius: f64, from: f64, to: f64, n: usize) -> Vec<Vector2<f64>> {
        (0..n)
            .map(|i| {
                let a = from + (to - from) * i as f64 / (n - 1) as f64;
                Vector2::new(3.0 + radius * a.cos(), -7.0 + radius * a.sin())
            })
            .collect()
    }

    fn curve_of(from: Vector2<f64>, to: Vector2<f64>, shape: Shape) -> Curve {
        let point = |p: Vector2<f64>| Point3::from(Vector3::new(p.x, p.y, 0.0));
        match shape {
            Shape::Line => Curve::Line(Line { start: point(from), end: point(to) }),
            Shape::Arc { bulge } => {
                let direction = if bulge > 0.0 { Direction::Cw } else { Direction::Ccw };
                let c = point(center(from, to, bulge));
                Curve::Arc(Arc::new(Plane::Xy, direction, point(from), point(to), c).unwrap())
            }
        }
    }

    #[test]
    fn points_of_a_circle_are_one_arc_of_its_radius() {
        for (from, to) in [(0.3, 2.9), (2.9, 0.3), (1.0, 1.4)] {
            let points = circle(40.0, from, to, 200);
            let elements = greedy(&points, 1e-3, Shapes::ArcsAndLines);
            assert_eq!(elements.len(), 1);
            let Shape::Arc { bulge } = elements[0].shape else { panic!("a line") };
            let c = center(points[0], points[199], bulge);
            assert!((c - Vector2::new(3.0, -7.0)).norm() < 1e-10, "{c}");
        }
    }

    #[test]
    fn the_last_point_is_reached_by_a_line() {
        let mut points = circle(10.0, 0.0, 1.0, 20);
        points.push(points[19] + Vector2::new(5.0, 5.0));
        let elements = greedy(&points, 1e-4, Shapes::ArcsAndLines);
        assert_eq!(elements.last(), Some(&Element { end: 20, shape: Shape::Line }));
    }

    #[test]
    fn straight_points_are_one_line() {
        let points: Vec<_> = (0..50).map(|i| Vector2::new(i as f64, 2.0 * i as f64)).collect();
        for shapes in [Shapes::LinesOnly, Shapes::ArcsAndLines] {
            assert_eq!(greedy(&points, 1e-3, shapes), [Element { end: 49, shape: Shape::Line }]);
        }
    }

    #[test]
    fn the_count_follows_the_growth_law() {
        // One period of a sine: the integral of (|k'| / (72 sqrt 3 tol))^(1/3) ds, by the midpoint rule.
        let n = 4000;
        let x = |i: usize| std::f64::consts::TAU * i as f64 / n as f64;
        let points: Vec<_> = (0..=n).map(|i| Vector2::new(x(i), x(i).sin())).collect();
        let curvature = |x: f64| -x.sin() / (1.0 + x.cos().powi(2)).powf(1.5);
        for tolerance in [1e-4, 1e-6] {
            let law: f64 = (0..n)
                .map(|i| {
                    let speed = (1.0 + x(i).cos().powi(2)).sqrt();
                    let change = (curvature(x(i + 1)) - curvature(x(i))).abs() / (x(1) * speed);
                    (change / (72.0 * 3f64.sqrt() * tolerance)).cbrt() * speed * x(1)
                })
                .sum();
            let count = greedy(&points, tolerance, Shapes::ArcsAndLines).len() as f64;
            assert!(count >= law.floor() && count < 1.15 * law + 2.0, "{count} {law}");
        }
    }

    proptest! {
        #[test]
        fn every_point_is_within_the_tolerance(
            steps in prop::collection::vec((-1.0f64..1.0, -1.0f64..1.0), 2..60),
            exponent in -4i32..0,
        ) {
            let tolerance = 10f64.powi(exponent);
            let mut at = Vector2::zeros();
            let points: Vec<_> = steps.iter().map(|(a, b)| { at += Vector2::new(*a, 0.1 * b); at }).collect();
            let mut start = 0;
            for element in greedy(&points, tolerance, Shapes::ArcsAndLines) {
                let curve = curve_of(points[start], points[element.end], element.shape);
                for p in &points[start..=element.end] {
                    let distance = curve.distance_to(&Point3::new(p.x, p.y, 0.0));
                    prop_assert!(distance <= tolerance * (1.0 + 1e-6) + 1e-9, "{distance}");
                }
                start = element.end;
            }
            prop_assert_eq!(start, points.len() - 1);
        }
    }
}

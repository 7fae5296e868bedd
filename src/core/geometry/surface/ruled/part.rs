//! A part of a curve in space. It can be cut at a given fraction of its length.

use nalgebra::{Point3, Vector3};

use super::length;
use crate::geometry::bernstein::{derived, dot, lowest};
use crate::geometry::profile::{ControlPoint, Piece, Shape};

/// Half sweeps of arcs count as equal if they differ by less than this, radians. On an arc with a radius of
/// 1000 km that is about a micrometre.
const SAME_SWEEP: f64 = 1e-12;

/// A part of a piece, its length (mm), and the place of its piece.
#[derive(Debug, Clone, Copy)]
pub(super) struct Part {
    path: Path,
    pub(super) length: f64,
    pub(super) place: usize,
}

#[derive(Debug, Clone, Copy)]
enum Path {
    Line([Point3<f64>; 2]),
    /// A rational quadratic. The weight of its middle point is the cosine of `half_sweep`, radians.
    Arc {
        points: [Point3<f64>; 3],
        half_sweep: f64,
    },
    Cubic([Point3<f64>; 4]),
}

impl Part {
    /// The whole piece.
    pub(super) fn new(piece: &Piece<3>) -> Self {
        let (path, length) = match piece.shape {
            Shape::Line([a, b]) => (Path::Line([a, b]), (b - a).norm()),
            Shape::Arc { points, weight: _ } => {
                let [a, corner, b] = points;
                let half_chord = 0.5 * (b - a).norm();
                let height = (corner - nalgebra::center(&a, &b)).norm();
                // The tangents from the ends to `corner` are half_chord / cos(half_sweep) long, and height /
                // sin(half_sweep).
                let half_sweep = height.atan2(half_chord);
                let radius = half_chord * half_chord.hypot(height) / height;
                (Path::Arc { points, half_sweep }, 2.0 * half_sweep * radius)
            }
            Shape::Cubic(points) => (Path::Cubic(points), length::of_cubic(&points)),
        };
        Self { path, length, place: piece.place }
    }

    /// The parts before and after the point at a fraction of the length.
    pub(super) fn cut(&self, fraction: f64) -> [Self; 2] {
        let [before, after] = match &self.path {
            Path::Line([a, b]) => {
                let at = a + (b - a) * fraction;
                [Path::Line([*a, at]), Path::Line([at, *b])]
            }
            Path::Arc { points, half_sweep } => cut_arc(points, *half_sweep, fraction),
            Path::Cubic(points) => {
                let t = length::place_on_cubic(points, self.length, fraction);
                cut_cubic(points, t).map(Path::Cubic)
            }
        };
        let part = |path: Path, length: f64| Self { path, length, place: self.place };
        [part(before, self.length * fraction), part(after, self.length * (1.0 - fraction))]
    }

    /// Whether points of equal parameters on both parts are at equal fractions of their lengths.
    pub(super) fn runs_like(&self, other: &Self) -> bool {
        match (&self.path, &other.path) {
            (Path::Line(_), Path::Line(_)) => true,
            (Path::Arc { half_sweep: one, .. }, Path::Arc { half_sweep: other, .. }) => {
                (one - other).abs() <= SAME_SWEEP
            }
            _ => false,
        }
    }

    pub(super) fn control_points(&self) -> Vec<ControlPoint<3>> {
        self.shape().control_points()
    }

    /// The cubic, with the length as its parameter, that has the ends of the part and its unit tangents
    /// there.
    pub(super) fn cubic(&self) -> [Point3<f64>; 4] {
        let shape = self.shape();
        let [leaving, arriving] = shape.end_directions().map(|d| d * (self.length / (3.0 * d.norm())));
        [shape.start(), shape.start() + leaving, shape.end() - arriving, shape.end()]
    }

    fn shape(&self) -> Shape<3> {
        match &self.path {
            Path::Line(points) => Shape::Line(*points),
            Path::Arc { points, half_sweep } => Shape::Arc { points: *points, weight: half_sweep.cos() },
            Path::Cubic(points) => Shape::Cubic(*points),
        }
    }

    /// An upper bound of the distance between [`Part::cubic`] and the part at equal lengths, mm; infinite
    /// where no bound is found.
    ///
    /// The bound is D s^4 / 384, where s is the length of the part, and D the largest fourth derivative of
    /// the part by its length. For an arc of radius R, D is 1 / R^3. For a cubic c, D is at most 64 a^3 + 26
    /// a b, where a is max |c''| / min |c'|^2 and b is max |c'''| / min |c'|^3. To obtain this bound,
    /// differentiate c' / |c'| three times and bound every term.
    pub(super) fn cubic_error(&self) -> f64 {
        match &self.path {
            Path::Line(_) => 0.0,
            // The length to the fourth by 384 R^3, where R is the length by the sweep.
            Path::Arc { points: _, half_sweep } => self.length * (2.0 * half_sweep).powi(3) / 384.0,
            Path::Cubic(points) => {
                let first = derived(&points.map(|p| p.coords));
                let slowest = lowest(&dot(&first, &first));
                if slowest <= 0.0 {
                    return f64::INFINITY;
                }
                let second = derived(&first);
                let largest =
                    |vectors: &[Vector3<f64>]| vectors.iter().map(Vector3::norm).fold(0.0, f64::max);
                let a = largest(&second) / slowest;
                let b = largest(&derived(&second)) / (slowest * slowest.sqrt());
                let fourth = 64.0 * a * a * a + 26.0 * a * b;
                fourth * self.length.powi(4) / 384.0
            }
        }
    }
}

/// The arcs before and after the point at a fraction of the sweep. A is half the sweep before the point and B
/// half the sweep after it. The point is the sum of the control points times sin^2 B, 2 cos (A + B) sin A sin
/// B and sin^2 A, over the sum of these factors, sin^2 (A + B).
fn cut_arc([start, corner, end]: &[Point3<f64>; 3], half_sweep: f64, fraction: f64) -> [Path; 2] {
    let [before, after] = [half_sweep * fraction, half_sweep * (1.0 - fraction)];
    let whole = half_sweep.sin();
    let [by_start, by_end] = [after.sin() / whole, before.sin() / whole];
    let at = corner + (start - corner) * (by_start * by_start) + (end - corner) * (by_end * by_end);
    let tangent = |half: f64| half.tan() / half_sweep.tan();
    let first = [*start, start + (corner - start) * tangent(before), at];
    let second = [at, end + (corner - end) * tangent(after), *end];
    [Path::Arc { points: first, half_sweep: before }, Path::Arc { points: second, half_sweep: after }]
}

/// The parts before and after `t`, by the algorithm of de Casteljau.
fn cut_cubic([a, b, c, d]: &[Point3<f64>; 4], t: f64) -> [[Point3<f64>; 4]; 2] {
    let between = |p: &Point3<f64>, q: &Point3<f64>| p + (q - p) * t;
    let (ab, bc, cd) = (between(a, b), between(b, c), between(c, d));
    let (abc, bcd) = (between(&ab, &bc), between(&bc, &cd));
    let at = between(&abc, &bcd);
    [[*a, ab, abc, at], [at, bcd, cd, *d]]
}

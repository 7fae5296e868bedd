//! The shape of one piece of a profile: a line, an arc or a cubic.

use nalgebra::{Point, SVector};

/// The shape of a piece, by its control points in D dimensions, mm.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Shape<const D: usize> {
    Line([Point<f64, D>; 2]),
    /// A rational quadratic Bezier curve of a quarter turn at most. The weights of the outer points are 1.
    Arc {
        points: [Point<f64, D>; 3],
        weight: f64,
    },
    Cubic([Point<f64, D>; 4]),
}

/// A control point in space, and its weight.
pub type ControlPoint<const D: usize> = (Point<f64, D>, f64);

impl<const D: usize> Shape<D> {
    pub fn start(&self) -> Point<f64, D> {
        match self {
            Self::Line([start, ..]) | Self::Arc { points: [start, ..], .. } | Self::Cubic([start, ..]) => {
                *start
            }
        }
    }

    pub fn end(&self) -> Point<f64, D> {
        match self {
            Self::Line([.., end]) | Self::Arc { points: [.., end], .. } | Self::Cubic([.., end]) => *end,
        }
    }

    /// Moves the first control point. The move has to be no larger than rounding.
    pub(super) fn begin_at(&mut self, at: Point<f64, D>) {
        match self {
            Self::Line([start, ..]) | Self::Arc { points: [start, ..], .. } | Self::Cubic([start, ..]) => {
                *start = at
            }
        }
    }

    /// The control points in order, one more than the degree.
    pub fn control_points(&self) -> Vec<ControlPoint<D>> {
        match self {
            Self::Line(points) => points.map(|p| (p, 1.0)).to_vec(),
            Self::Arc { points: [start, corner, end], weight } => {
                vec![(*start, 1.0), (*corner, *weight), (*end, 1.0)]
            }
            Self::Cubic(points) => points.map(|p| (p, 1.0)).to_vec(),
        }
    }

    /// The directions at both ends, of any length; zero where a cubic has no speed.
    pub fn end_directions(&self) -> [SVector<f64, D>; 2] {
        match self {
            Self::Line([a, b]) => [b - a; 2],
            Self::Arc { points: [a, b, c], weight: _ } => [b - a, c - b],
            Self::Cubic([a, b, c, d]) => [b - a, d - c],
        }
    }

    /// The least and the largest value of a coordinate.
    pub fn range(&self, coordinate: usize) -> [f64; 2] {
        let at = |p: &Point<f64, D>| p[coordinate];
        let (mut low, mut high) =
            (at(&self.start()).min(at(&self.end())), at(&self.start()).max(at(&self.end())));
        // The derivative of a cubic is a quadratic. For an arc the numerator of the derivative is one.
        let turns = match self {
            Self::Line(_) => [None; 2],
            Self::Arc { points: [a, b, c], weight: w } => {
                roots([w * (at(b) - at(a)), 0.5 * (at(c) - at(a)), w * (at(c) - at(b))])
            }
            Self::Cubic([a, b, c, d]) => roots([at(b) - at(a), at(c) - at(b), at(d) - at(c)]),
        };
        for t in turns.into_iter().flatten() {
            let x = at(&self.point(t));
            (low, high) = (low.min(x), high.max(x));
        }
        [low, high]
    }

    /// The point at the parameter `t`, from 0 to 1.
    pub fn point(&self, t: f64) -> Point<f64, D> {
        let s = 1.0 - t;
        match self {
            Self::Line([a, b]) => a + (b - a) * t,
            Self::Arc { points: [a, b, c], weight } => {
                let shares = [s * s, 2.0 * s * t * weight, t * t];
                b + ((a - b) * shares[0] + (c - b) * shares[2]) / (shares[0] + shares[1] + shares[2])
            }
            Self::Cubic([a, b, c, d]) => {
                a + (b - a) * (3.0 * s * s * t) + (c - a) * (3.0 * s * t * t) + (d - a) * (t * t * t)
            }
        }
    }

    /// The shape of the mapped control points.
    pub fn mapped<const E: usize>(&self, map: impl Fn(Point<f64, D>) -> Point<f64, E>) -> Shape<E> {
        match self {
            Self::Line(points) => Shape::Line(points.map(map)),
            Self::Arc { points, weight } => Shape::Arc { points: points.map(map), weight: *weight },
            Self::Cubic(points) => Shape::Cubic(points.map(map)),
        }
    }
}

/// The parameters between 0 and 1 where the quadratic with these Bernstein coefficients changes its sign.
fn roots([a, b, c]: [f64; 3]) -> [Option<f64>; 2] {
    // a s^2 + 2 b s t + c t^2 with s = 1 - t.
    let root = (b * b - a * c).sqrt();
    if root.is_nan() {
        return [None; 2];
    }
    // With q of the same sign as b nothing cancels; t / s is -a / q or -q / c.
    let q = b + root.copysign(b);
    let share = |t: f64, s: f64| Some(t / (t + s)).filter(|t| *t > 0.0 && *t < 1.0);
    [share(-a, q), share(-q, c)]
}

//! Chains of Bezier pieces, polynomial or rational, of degree up to 7. Most designed curves become such a
//! chain.
//!
//! # Method
//! De Casteljau's algorithm gives points and derivatives. For a range of parameters inside a piece, it also
//! gives control points of just this part of the piece. A box about these control points contains the part
//! (`net`; `quotient` for rational pieces). Boxes that contain the derivatives are made in the same way.
//!
//! # Guarantees
//! * A box contains the exact values, because it is enlarged by a bound of all rounding errors.
//! * A box may be larger than the values need. If the range is halved, the excess becomes half as large or
//!   less.
//! * A chain is refused if a piece does not start where the previous piece ends, up to rounding.
//! * A parameter outside the domain counts as the nearest end of the domain.
//!
//! # Cost
//! O(p^2) for a point and O(p^3) for a box, where p is the degree, plus O(log n) to find one of n pieces.
//!
//! # Reference
//! G. Farin, *Curves and Surfaces for CAGD*, 5th ed., Morgan Kaufmann, 2002, chapters 5 and 13.

mod bezier;
mod net;
mod quotient;

pub use bezier::{Bezier, BezierError};

use nalgebra::{Point2, Vector2};

use self::net::Net;
use super::{Enclosure, LARGEST, PlaneCurve};
use crate::geometry::interval::Interval;

/// How far ends of neighbouring pieces may differ and still count as one point, as a part of the coordinates'
/// magnitude. The value is thousands of units of rounding: room for the errors of the computation that made
/// the control points.
const JOINT_ROUNDING: f64 = 1e-12;

/// Most pieces of a chain. A longer chain would not fit into a gigabyte. Within this limit 32 bits are enough
/// for an index of a control point.
pub const MAX_PIECES: usize = 1 << 24;

/// Why pieces make no chain.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum PiecewiseError {
    #[error("the curve has no pieces; it needs at least one")]
    Empty,
    #[error("the curve has more than {MAX_PIECES} pieces")]
    TooManyPieces,
    #[error("parameter {index} must be larger than the parameter before it and at most {LARGEST:e}")]
    Parameter { index: usize },
    #[error("piece {index} starts {gap_mm} mm from the end of the piece before it")]
    Gap { index: usize, gap_mm: f64 },
}

/// A continuous chain of Bezier pieces, each over its own range of the parameter.
#[derive(Debug, Clone, PartialEq)]
pub struct Piecewise {
    /// The parameters where pieces start and end: one more than the number of pieces.
    joints: Vec<f64>,
    pieces: Vec<Piece>,
    /// The control points of all pieces, one piece after the other. `weights` has entries for rational pieces
    /// only.
    points: Vec<[f64; 2]>,
    weights: Vec<f64>,
    /// The domain is divided into as many equal stretches as there are pieces. Entry k is the number of
    /// breaks before stretch k; the last entry is the number of all breaks.
    stretches: Vec<u32>,
    stretches_per_parameter: f64,
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct Piece {
    degree: u8,
    first_point: u32,
    first_weight: Option<u32>,
}

/// `$body` with the constant `$n` set to the number of control points of degree `$degree`. Loops of constant
/// length are several times faster.
macro_rules! by_degree {
    ($degree:expr, $n:ident => $body:expr) => {
        match $degree {
            1 => by_degree!($n = 2, $body),
            2 => by_degree!($n = 3, $body),
            3 => by_degree!($n = 4, $body),
            4 => by_degree!($n = 5, $body),
            5 => by_degree!($n = 6, $body),
            6 => by_degree!($n = 7, $body),
            _ => by_degree!($n = 8, $body),
        }
    };
    ($n:ident = $count:literal, $body:expr) => {{
        const $n: usize = $count;
        $body
    }};
}

impl Piecewise {
    /// The chain that starts at the parameter `start`. Each piece comes with the parameter at its end.
    ///
    /// # Errors
    /// When there are no pieces or too many, the parameters do not rise, or a piece does not start at the end
    /// of the piece before it.
    pub fn new(start: f64, pieces: impl IntoIterator<Item = (Bezier, f64)>) -> Result<Self, PiecewiseError> {
        let mut chain = Self {
            joints: vec![start],
            pieces: Vec::new(),
            points: Vec::new(),
            weights: Vec::new(),
            stretches: Vec::new(),
            stretches_per_parameter: 0.0,
        };
        if start.abs() > LARGEST || start.is_nan() {
            return Err(PiecewiseError::Parameter { index: 0 });
        }
        for (bezier, end) in pieces {
            chain.push(&bezier, end)?;
        }
        if chain.pieces.is_empty() {
            return Err(PiecewiseError::Empty);
        }
        chain.index_stretches();
        Ok(chain)
    }

    /// The pieces with the ranges of their parameters.
    pub fn pieces(&self) -> impl ExactSizeIterator<Item = (Bezier, [f64; 2])> + '_ {
        self.pieces.iter().enumerate().map(|(k, piece)| {
            let [start, count] = [piece.first_point as usize, piece.degree as usize + 1];
            let weights =
                piece.first_weight.map(|first| &self.weights[first as usize..first as usize + count]);
            let bezier = Bezier::stored(&self.points[start..start + count], weights);
            (bezier, [self.joints[k], self.joints[k + 1]])
        })
    }

    fn push(&mut self, bezier: &Bezier, end: f64) -> Result<(), PiecewiseError> {
        let index = self.pieces.len();
        if index == MAX_PIECES {
            return Err(PiecewiseError::TooManyPieces);
        }
        let span = end - self.joints[index];
        if !(span >= 1.0 / LARGEST && end.abs() <= LARGEST) {
            return Err(PiecewiseError::Parameter { index: index + 1 });
        }
        let first_point = self.points.len();
        self.points.extend(bezier.points().iter().map(|p| [p.x, p.y]));
        if first_point > 0 {
            let (before, start) = (self.points[first_point - 1], self.points[first_point]);
            let gap = (Point2::from(start) - Point2::from(before)).norm();
            let magnitude = bezier.points().iter().map(|p| p.coords.amax()).fold(0.0, f64::max);
            if gap > JOINT_ROUNDING * magnitude {
                return Err(PiecewiseError::Gap { index, gap_mm: gap });
            }
            self.points[first_point] = before;
        }
        let first_weight = bezier.weights().map(|weights| {
            let first = self.weights.len() as u32;
            self.weights.extend(weights);
            first
        });
        self.pieces.push(Piece {
            degree: bezier.degree() as u8,
            first_point: first_point as u32,
            first_weight,
        });
        self.joints.push(end);
        Ok(())
    }

    fn index_stretches(&mut self) {
        let n = self.pieces.len();
        let [start, end] = self.domain();
        self.stretches_per_parameter = n as f64 / (end - start);
        let mut stretches = vec![0u32; n + 1];
        for t in &self.joints[1..n] {
            stretches[self.stretch_of(*t) + 1] += 1;
        }
        for k in 0..n {
            stretches[k + 1] += stretches[k];
        }
        self.stretches = stretches;
    }

    /// The stretch that contains `t`. It never falls as `t` rises, because no step of its computation does.
    /// So breaks in earlier stretches are below `t`, and breaks in later stretches above.
    fn stretch_of(&self, t: f64) -> usize {
        let stretch = (t - self.joints[0]) * self.stretches_per_parameter;
        (stretch as usize).min(self.pieces.len() - 1)
    }

    /// The piece that contains `t`; at a break, the piece after it.
    fn piece_at(&self, t: f64) -> usize {
        let stretch = self.stretch_of(t);
        let [low, high] = [self.stretches[stretch] as usize, self.stretches[stretch + 1] as usize];
        low + self.breaks()[low..high].partition_point(|at| *at <= t)
    }

    /// The parameter of the piece, from 0 to 1, at `t`; exact to three units of rounding.
    fn local(&self, piece: usize, t: f64) -> f64 {
        ((t - self.joints[piece]) / self.span(piece)).clamp(0.0, 1.0)
    }

    fn span(&self, piece: usize) -> f64 {
        self.joints[piece + 1] - self.joints[piece]
    }

    fn control_points<const N: usize>(&self, piece: Piece) -> [[f64; 2]; N] {
        let first = piece.first_point as usize;
        let points = &self.points[first..first + N];
        std::array::from_fn(|k| points[k])
    }

    fn control_weights<const N: usize>(&self, first: u32) -> [f64; N] {
        let weights = &self.weights[first as usize..first as usize + N];
        std::array::from_fn(|k| weights[k])
    }

    fn piece_point<const N: usize>(&self, piece: Piece, u: f64) -> [f64; 2] {
        let points = self.control_points::<N>(piece);
        match piece.first_weight {
            None => Net::new(points).value(u),
            Some(first) => quotient::point(&points, &self.control_weights(first), u),
        }
    }

    fn piece_derivative<const N: usize>(&self, piece: Piece, u: f64, span: f64) -> [f64; 2] {
        let points = self.control_points::<N>(piece);
        match piece.first_weight {
            None => Net::new(points).derived(span).value(u),
            Some(first) => quotient::derivative(&points, &self.control_weights(first), u, span),
        }
    }

    fn piece_enclosure<const N: usize>(&self, piece: Piece, range: [f64; 2], span: f64) -> Enclosure {
        let points = self.control_points::<N>(piece);
        match piece.first_weight {
            None => {
                let net = Net::new(points);
                let first = net.derived(span);
                let second = if N > 2 { first.derived(span).hull(range) } else { [Interval::ZERO; 2] };
                Enclosure { point: net.hull(range), first: first.hull(range), second }
            }
            Some(first) => quotient::enclose(&points, &self.control_weights(first), range, span),
        }
    }
}

impl PlaneCurve for Piecewise {
    fn domain(&self) -> [f64; 2] {
        [self.joints[0], self.joints[self.pieces.len()]]
    }

    /// All inner joints, including joints where no derivative jumps.
    fn breaks(&self) -> &[f64] {
        &self.joints[1..self.pieces.len()]
    }

    fn point(&self, t: f64) -> Point2<f64> {
        if t >= self.domain()[1] {
            // The curve ends at the last control point. The last piece reaches that point only to rounding.
            return self.points.last().map_or(Point2::origin(), |p| Point2::from(*p));
        }
        let k = self.piece_at(t);
        let (piece, u) = (self.pieces[k], self.local(k, t));
        Point2::from(by_degree!(piece.degree, N => self.piece_point::<N>(piece, u)))
    }

    fn derivative(&self, t: f64) -> Vector2<f64> {
        let k = self.piece_at(t);
        let (piece, u, span) = (self.pieces[k], self.local(k, t), self.span(k));
        Vector2::from(by_degree!(piece.degree, N => self.piece_derivative::<N>(piece, u, span)))
    }

    /// If `from` equals `to`, the box of the point is some ten units of rounding wide, and contains the
    /// result of [`PlaneCurve::point`]. At a break, the derivatives are then those after the break.
    fn enclose(&self, from: f64, to: f64) -> Enclosure {
        let middle = 0.5 * from + 0.5 * to;
        // The middle of two neighbouring floating-point numbers is one of the two. If it is the upper one, it
        // may be the end of the piece; then `from` finds the piece.
        let k = self.piece_at(if middle < to { middle } else { from });
        let (piece, span) = (self.pieces[k], self.span(k));
        let range = [self.local(k, from), self.local(k, to)];
        by_degree!(piece.degree, N => self.piece_enclosure::<N>(piece, range, span))
    }
}

#[cfg(test)]
mod tests;

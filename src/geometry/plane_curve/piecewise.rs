//! Chains of Bezier pieces, polynomial or rational, of degree up to 7: what most designed curves come down
//! to.
//!
//! # Method
//! 1. A parameter finds its piece by a table of equal stretches of the domain, then by bisection in its
//!    stretch.
//! 2. Points and derivatives are de Casteljau's.
//! 3. Ranges: the control points of the part of the piece, and of its derivatives (`net`), or for a rational
//!    piece of its numerator and denominator (`quotient`), hold it in their hull.
//!
//! # Guarantees
//! Enclosures allow for every rounding by forward error bounds: that of a point is some ten units of rounding
//! of the coordinates' magnitude wide, and holds also what is told as the point there. The excess of
//! enclosures of points and first derivatives shrinks with the square of the range, as does that of second
//! derivatives of polynomial pieces; of rational ones with the range.
//!
//! # Degenerate input
//! The ends of neighbouring pieces that differ by rounding are made equal; farther apart they are refused.
//! Parameters outside the piece or the domain are those of its ends.
//!
//! # Cost
//! O(p^2) a point and O(p^3) an enclosure of degree p, and O(log n) for the piece where the parameters are
//! most uneven.
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

/// Ends of neighbouring pieces this close, in parts of the coordinates' magnitude, differ by the rounding of
/// what they were computed from: thousands of units of it.
const JOINT_ROUNDING: f64 = 1e-12;

/// Beyond this number of pieces a gigabyte does not hold them, and their control points could not be counted
/// in 32 bits.
pub const MAX_PIECES: usize = 1 << 24;

/// Why pieces make no chain.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum PiecewiseError {
    #[error("the curve has no pieces; it needs at least one")]
    Empty,
    #[error("the curve has more than {MAX_PIECES} pieces")]
    TooManyPieces,
    #[error(
        "parameter {index} is not larger than the parameter before it, not finite, or larger than {LARGEST:e}"
    )]
    Parameter { index: usize },
    #[error("piece {index} starts {gap_mm} mm from the end of the piece before it")]
    Gap { index: usize, gap_mm: f64 },
}

/// A continuous chain of Bezier pieces, each over its own range of the parameter.
#[derive(Debug, Clone, PartialEq)]
pub struct Piecewise {
    /// Where pieces start and end: one more than there are pieces.
    joints: Vec<f64>,
    pieces: Vec<Piece>,
    /// The control points of all pieces, one after the other; weights of the rational pieces only.
    points: Vec<[f64; 2]>,
    weights: Vec<f64>,
    /// For as many equal stretches of the domain as there are pieces, the number of breaks before each, and
    /// their number.
    stretches: Vec<u32>,
    stretches_per_parameter: f64,
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct Piece {
    degree: u8,
    first_point: u32,
    first_weight: Option<u32>,
}

/// `$body` with the constant `$n` set to the number of control points of degree `$degree`: loops of known
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
    /// The chain that starts at the parameter `start`, of pieces with the parameters at which they end.
    ///
    /// # Errors
    /// When there are no pieces or too many, the parameters do not rise, or a piece does not start where the
    /// one before it ends.
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

    /// The stretch that holds `t`. It does not fall as `t` rises, because no step of its computation does: so
    /// breaks of stretches before it are below `t`, and those of stretches after it above.
    fn stretch_of(&self, t: f64) -> usize {
        let stretch = (t - self.joints[0]) * self.stretches_per_parameter;
        (stretch as usize).min(self.pieces.len() - 1)
    }

    /// The piece that holds `t`; at a break the one after it.
    fn piece_at(&self, t: f64) -> usize {
        let stretch = self.stretch_of(t);
        let [low, high] = [self.stretches[stretch] as usize, self.stretches[stretch + 1] as usize];
        low + self.breaks()[low..high].partition_point(|at| *at <= t)
    }

    /// The parameter in units of the piece, 0 to 1, within three units of rounding.
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

    /// All inner joints, also those at which nothing jumps.
    fn breaks(&self) -> &[f64] {
        &self.joints[1..self.pieces.len()]
    }

    fn point(&self, t: f64) -> Point2<f64> {
        if t >= self.domain()[1] {
            // The end is the last control point, which the last piece reaches to rounding only.
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

    /// Of equal ends at a break the derivatives are those after it.
    fn enclose(&self, from: f64, to: f64) -> Enclosure {
        let middle = 0.5 * from + 0.5 * to;
        // The middle of neighbouring numbers is one of them, and the upper one may be the end of the piece.
        let k = self.piece_at(if middle < to { middle } else { from });
        let (piece, span) = (self.pieces[k], self.span(k));
        let range = [self.local(k, from), self.local(k, to)];
        by_degree!(piece.degree, N => self.piece_enclosure::<N>(piece, range, span))
    }
}

#[cfg(test)]
mod tests;

//! Moves, passes and the toolpath. A builder makes a toolpath move by move.

use nalgebra::Point3;

use super::units::FeedRate;
use crate::geometry::curve::{Arc, ArcError, Curve, Direction, Line, Parabola, ParabolaError};
use crate::geometry::plane::Plane;

/// The purpose of a feed move.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Role {
    Plunge,
    Ramp,
    LeadIn,
    Cut,
    Link,
    LeadOut,
}

/// One move, with the geometry from where the last one ended. Positions are those of the tool tip, mm.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Move {
    Rapid {
        line: Line,
    },
    /// `rate` is `None` where no feed was chosen. The move then has a length, but no time, and no program can
    /// hold it.
    Feed {
        along: Curve,
        rate: Option<FeedRate>,
        role: Role,
    },
    Dwell {
        seconds: f64,
    },
}

/// A connected run of moves, optionally on a level.
#[derive(Debug, Clone, PartialEq)]
pub struct Pass {
    level: Option<u32>,
    moves: Vec<Move>,
}

impl Pass {
    pub fn level(&self) -> Option<u32> {
        self.level
    }

    pub fn moves(&self) -> &[Move] {
        &self.moves
    }
}

/// A finished toolpath.
#[derive(Debug, Clone, PartialEq)]
pub struct Toolpath {
    start: Point3<f64>,
    passes: Vec<Pass>,
}

impl Toolpath {
    pub fn builder(start: Point3<f64>) -> Builder {
        Builder { at: start, start, passes: Vec::new() }
    }

    pub fn start(&self) -> Point3<f64> {
        self.start
    }

    pub fn passes(&self) -> &[Pass] {
        &self.passes
    }

    /// Every move in order.
    pub fn moves(&self) -> impl Iterator<Item = &Move> {
        self.passes.iter().flat_map(|pass| &pass.moves)
    }
}

/// Why a move cannot be added.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum PathError {
    #[error("a coordinate is not finite")]
    NotFinite,
    #[error("a curve does not start where the curve before it ends")]
    Apart,
    #[error("the dwell of {seconds} s is not a time of zero or more seconds")]
    BadDwell { seconds: f64 },
    #[error(transparent)]
    Arc(#[from] ArcError),
    #[error(transparent)]
    Parabola(#[from] ParabolaError),
}

/// Builds a toolpath move by move; what it returns keeps the promises of the module.
#[derive(Debug, Clone)]
pub struct Builder {
    at: Point3<f64>,
    start: Point3<f64>,
    passes: Vec<Pass>,
}

impl Builder {
    /// Where the tool is now.
    pub fn at(&self) -> Point3<f64> {
        self.at
    }

    pub fn begin_pass(&mut self, level: Option<u32>) {
        self.passes.push(Pass { level, moves: Vec::new() });
    }

    /// # Errors
    /// When `to` is not finite.
    pub fn rapid(&mut self, to: Point3<f64>) -> Result<(), PathError> {
        let line = self.line_to(to)?;
        self.push(Move::Rapid { line }, to);
        Ok(())
    }

    /// # Errors
    /// When `to` is not finite.
    pub fn line(
        &mut self,
        to: Point3<f64>,
        rate: impl Into<Option<FeedRate>>,
        role: Role,
    ) -> Result<(), PathError> {
        let along = Curve::Line(self.line_to(to)?);
        self.push(Move::Feed { along, rate: rate.into(), role }, to);
        Ok(())
    }

    /// An arc about the absolute `center`.
    ///
    /// # Errors
    /// When the points do not make an arc.
    pub fn arc(
        &mut self,
        to: Point3<f64>,
        center: Point3<f64>,
        (plane, direction): (Plane, Direction),
        rate: impl Into<Option<FeedRate>>,
        role: Role,
    ) -> Result<(), PathError> {
        let along = Curve::Arc(Arc::new(plane, direction, self.at, to, center)?);
        self.push(Move::Feed { along, rate: rate.into(), role }, to);
        Ok(())
    }

    /// The quadratic Bezier curve with the control point `control`.
    ///
    /// # Errors
    /// When a coordinate is not finite, or too large for its square.
    pub fn parabola(
        &mut self,
        to: Point3<f64>,
        control: Point3<f64>,
        rate: impl Into<Option<FeedRate>>,
        role: Role,
    ) -> Result<(), PathError> {
        let along = Curve::Parabola(Parabola::new(self.at, control, to)?);
        self.push(Move::Feed { along, rate: rate.into(), role }, to);
        Ok(())
    }

    /// A curve that starts where the tool is.
    ///
    /// # Errors
    /// When it starts elsewhere.
    pub fn follow(
        &mut self,
        along: Curve,
        rate: impl Into<Option<FeedRate>>,
        role: Role,
    ) -> Result<(), PathError> {
        if along.start() != self.at {
            return Err(PathError::Apart);
        }
        self.push(Move::Feed { along, rate: rate.into(), role }, along.end());
        Ok(())
    }

    /// # Errors
    /// When `seconds` is negative or not finite.
    pub fn dwell(&mut self, seconds: f64) -> Result<(), PathError> {
        if !(seconds.is_finite() && seconds >= 0.0) {
            return Err(PathError::BadDwell { seconds });
        }
        self.push(Move::Dwell { seconds }, self.at);
        Ok(())
    }

    pub fn finish(self) -> Result<Toolpath, PathError> {
        if !self.start.iter().all(|x| x.is_finite()) {
            return Err(PathError::NotFinite);
        }
        Ok(Toolpath { start: self.start, passes: self.passes })
    }

    fn line_to(&self, to: Point3<f64>) -> Result<Line, PathError> {
        if to.iter().all(|x| x.is_finite()) {
            Ok(Line { start: self.at, end: to })
        } else {
            Err(PathError::NotFinite)
        }
    }

    fn push(&mut self, step: Move, to: Point3<f64>) {
        if self.passes.is_empty() {
            self.begin_pass(None);
        }
        let last = self.passes.len() - 1;
        self.passes[last].moves.push(step);
        self.at = to;
    }
}

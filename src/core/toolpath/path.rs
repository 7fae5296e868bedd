//! Moves, passes and the toolpath. A builder makes a toolpath move by move.

mod drilled;
mod joined;
mod pass;

use nalgebra::{Point3, UnitVector3, Vector3};

pub use self::pass::{Pass, RotaryPositions};
use super::cycle::{Cycle, CycleError};
use super::rail::Rail;
use super::tool_axes::{ToolAxes, are_opposite};
use super::units::FeedRate;
use crate::geometry::curve::{Arc, ArcError, Curve, Direction, Line, Parabola, ParabolaError};
use crate::geometry::plane::Plane;

/// What a feed move is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, serde::Deserialize, utoipa::ToSchema))]
#[cfg_attr(feature = "wire", serde(rename_all = "snake_case"))]
pub enum Role {
    #[default]
    Cut,
    Plunge,
    Ramp,
    LeadIn,
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
    /// The tool turns about its resting tip. `seconds` is `None` where no feed was chosen.
    Turn {
        at: Point3<f64>,
        seconds: Option<f64>,
        role: Role,
    },
    Dwell {
        seconds: f64,
    },
}

/// A finished toolpath.
#[derive(Debug, Clone, PartialEq)]
pub struct Toolpath {
    start: Point3<f64>,
    passes: Vec<Pass>,
}

impl Toolpath {
    pub fn builder(start: Point3<f64>) -> Builder {
        Builder {
            at: start,
            axis: Vector3::z_axis(),
            next_axis: None,
            rotary: None,
            start,
            passes: Vec::new(),
            n_moves: 0,
            limit: usize::MAX,
        }
    }

    /// The toolpath without any move, at the origin.
    pub fn empty() -> Toolpath {
        Toolpath { start: Point3::origin(), passes: Vec::new() }
    }

    pub fn start(&self) -> Point3<f64> {
        self.start
    }

    pub fn passes(&self) -> &[Pass] {
        &self.passes
    }

    /// Whether the tool axis is straight up throughout, as on a machine with three axes.
    pub fn is_upright(&self) -> bool {
        self.passes.iter().all(|pass| pass.axes.is_up())
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
    #[error("the pause or turn of {seconds} s is not a time of zero or more seconds")]
    BadTime { seconds: f64 },
    #[error("the tool axis turns to the opposite direction, and there is no telling which way")]
    OppositeAxes,
    #[error("the toolpath has more than {limit} moves, the most that are allowed")]
    TooManyMoves { limit: usize },
    #[error(transparent)]
    Arc(#[from] ArcError),
    #[error(transparent)]
    Parabola(#[from] ParabolaError),
    #[error(transparent)]
    Cycle(#[from] CycleError),
}

/// Builds a toolpath move by move; what it returns keeps the promises of the module.
///
/// # Example
/// ```
/// use nalgebra::Point3;
/// use toolpathd_core::geometry::{curve::Direction, plane::Plane};
/// use toolpathd_core::toolpath::{PathError, Role, Toolpath, units::FeedRate};
///
/// let feed = FeedRate::from_mm_per_min(600.0).unwrap();
/// let mut builder = Toolpath::builder(Point3::new(0.0, 0.0, 2.0));
/// builder.line(Point3::new(0.0, 0.0, -1.0), feed, Role::Plunge).unwrap();
/// let (end, about) = (Point3::new(20.0, 0.0, -1.0), (Plane::Xy, Direction::Ccw));
/// builder.arc(end, Point3::new(10.0, 0.0, -1.0), about, feed, Role::Cut).unwrap();
/// // This centre is 5 mm from the start and 10 mm from the end.
/// let (wrong, center) = (Point3::new(35.0, 0.0, -1.0), Point3::new(25.0, 0.0, -1.0));
/// let refused = builder.arc(wrong, center, about, feed, Role::Cut);
/// assert!(matches!(refused, Err(PathError::Arc(_))));
/// assert_eq!((builder.at(), builder.finish().unwrap().moves().count()), (end, 2));
/// ```
#[derive(Debug, Clone)]
pub struct Builder {
    at: Point3<f64>,
    axis: UnitVector3<f64>,
    /// The axis at the end of the next move, where it differs.
    next_axis: Option<UnitVector3<f64>>,
    /// The positions of the rotary axes, where they are known.
    rotary: Option<[f64; 2]>,
    start: Point3<f64>,
    passes: Vec<Pass>,
    n_moves: usize,
    limit: usize,
}

impl Builder {
    /// The builder of a toolpath with at most `limit` moves. Without this call there is no limit.
    #[must_use]
    pub fn with_limit(mut self, limit: usize) -> Self {
        self.limit = limit;
        self
    }

    /// Refuses `n` more moves if there may not be as many, before the first of them is made.
    ///
    /// # Errors
    /// When there would be too many moves.
    pub fn check_room(&self, n: f64) -> Result<(), PathError> {
        let room = self.limit - self.n_moves;
        if n <= room as f64 { Ok(()) } else { Err(PathError::TooManyMoves { limit: self.limit }) }
    }

    /// Where the tool is now.
    pub fn at(&self) -> Point3<f64> {
        self.at
    }

    pub fn has_passes(&self) -> bool {
        !self.passes.is_empty()
    }

    /// Begins a pass with the tool axis as it is now.
    pub fn begin_pass(&mut self, level: Option<u32>) {
        self.begin_leaning_pass(level, self.axis);
    }

    /// Begins a pass with another tool axis. Unless it is the first pass, the tool turns about its tip.
    pub fn begin_leaning_pass(&mut self, level: Option<u32>, axis: UnitVector3<f64>) {
        self.axis = axis;
        self.passes.push(Pass {
            level,
            start: None,
            moves: Vec::new(),
            axes: ToolAxes::Fixed(axis),
            rails: Vec::new(),
            cycles: Vec::new(),
            rotary: self.rotary.map(|start| RotaryPositions { start, ends: Vec::new() }),
        });
    }

    /// Begins a pass at `start`, which the tool reaches on a way that is not known.
    pub fn begin_pass_apart(&mut self, start: Point3<f64>) {
        self.begin_pass(None);
        self.begin_apart(start);
    }

    /// The pass that has begun starts at `start`, which the tool reaches on a way that is not known.
    pub fn begin_apart(&mut self, start: Point3<f64>) {
        self.at = start;
        if let Some(pass) = self.passes.last_mut() {
            pass.start = Some(start);
        }
    }

    /// Number of moves of the pass.
    pub fn n_moves_of_pass(&self) -> usize {
        self.passes.last().map_or(0, |pass| pass.moves.len())
    }

    /// A rail stands for the last moves of the pass: all from `rail.moves.start` on.
    pub fn rail(&mut self, rail: Rail) {
        if let Some(pass) = self.passes.last_mut() {
            pass.rails.push(rail);
        }
    }

    /// During the next move the tool axis turns to `axis`.
    ///
    /// # Errors
    /// When that is opposite to the axis now.
    pub fn turn_next(&mut self, axis: UnitVector3<f64>) -> Result<(), PathError> {
        if are_opposite(&self.axis, &axis) {
            return Err(PathError::OppositeAxes);
        }
        self.next_axis = Some(axis);
        Ok(())
    }

    /// During the next move the rotary axes of the machine turn to these positions, radians. Before the first
    /// pass it tells where they start: without that the toolpath has no such positions.
    pub fn rotate_next(&mut self, rotary: [f64; 2]) {
        self.rotary = Some(rotary);
    }

    /// Forgets the turn of the next move. Returns the axis now and where it was to turn.
    pub fn take_turn(&mut self) -> Option<[UnitVector3<f64>; 2]> {
        self.next_axis.take().map(|to| [self.axis, to])
    }

    /// The tool turns to `axis` about its resting tip.
    ///
    /// # Errors
    /// When `seconds` is negative or not finite, or the axis is opposite to the axis now.
    pub fn turn(
        &mut self,
        axis: UnitVector3<f64>,
        seconds: Option<f64>,
        role: Role,
    ) -> Result<(), PathError> {
        if let Some(seconds) = seconds {
            check_time(seconds)?;
        }
        self.turn_next(axis)?;
        self.push(Move::Turn { at: self.at, seconds, role }, self.at)
    }

    /// # Errors
    /// When `to` is not finite, or there are too many moves, as with every move.
    pub fn rapid(&mut self, to: Point3<f64>) -> Result<(), PathError> {
        let line = self.line_to(to)?;
        self.push(Move::Rapid { line }, to)
    }

    /// A rapid, unless the tool is there already.
    ///
    /// # Errors
    /// When `to` is not finite.
    pub fn rapid_unless_there(&mut self, to: Point3<f64>) -> Result<(), PathError> {
        if self.at == to { Ok(()) } else { self.rapid(to) }
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
        self.push(Move::Feed { along, rate: rate.into(), role }, to)
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
        self.push(Move::Feed { along, rate: rate.into(), role }, to)
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
        self.push(Move::Feed { along, rate: rate.into(), role }, to)
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
        self.push(Move::Feed { along, rate: rate.into(), role }, along.end())
    }

    /// # Errors
    /// When `seconds` is negative or not finite.
    pub fn dwell(&mut self, seconds: f64) -> Result<(), PathError> {
        check_time(seconds)?;
        self.push(Move::Dwell { seconds }, self.at)
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

    fn push(&mut self, step: Move, to: Point3<f64>) -> Result<(), PathError> {
        if self.n_moves >= self.limit {
            return Err(PathError::TooManyMoves { limit: self.limit });
        }
        self.n_moves += 1;
        if self.passes.is_empty() {
            self.begin_pass(None);
        }
        if let Some(axis) = self.next_axis.take() {
            self.axis = axis;
        }
        let last = self.passes.len() - 1;
        let Pass { moves, axes, rotary, .. } = &mut self.passes[last];
        axes.push(moves.len(), self.axis);
        if let (Some(RotaryPositions { ends, .. }), Some(next)) = (rotary, self.rotary) {
            ends.push(next);
        }
        moves.push(step);
        self.at = to;
        Ok(())
    }
}

fn check_time(seconds: f64) -> Result<(), PathError> {
    if seconds.is_finite() && seconds >= 0.0 { Ok(()) } else { Err(PathError::BadTime { seconds }) }
}

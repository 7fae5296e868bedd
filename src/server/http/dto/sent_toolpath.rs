//! Toolpaths in requests: moves as other endpoints return them, and canned cycles.

mod cycle;
mod cycle_move;
mod moves;

use nalgebra::{Point3, Vector3};
use serde::Deserialize;
use utoipa::ToSchema;

pub use self::moves::SentMove as Move;
use super::axis::{self, AxisDirection};
use super::check::{MAX_MAGNITUDE_MM, Range, Violations};
use super::moves::{ArcMove, DwellMove, LineMove, ParabolaMove, RapidMove, TurnMove};
use super::point::{Coordinates, Point};
use super::toolpath::MAX_LEVEL;
use crate::http::decode::object;
use crate::http::error::FieldCode;
use crate::http::pointer::Pointer;
use toolpathd_core::geometry::curve::Arc;
use toolpathd_core::toolpath::Role;
use toolpathd_core::toolpath::cutting::CuttingRequest;
use toolpathd_core::toolpath::near_arc::{NearArc, near_arc};
use toolpathd_core::toolpath::path::{Builder, PathError, Toolpath};
use toolpathd_core::toolpath::tool_axes;
use toolpathd_core::toolpath::units::FeedRate;

/// Longest legal pause, s.
const MAX_DWELL_S: f64 = 86_400.0;

/// Moves of the tool's tip as other endpoints return them, and canned cycles. In mm. Each move starts where
/// the move before ended.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct SentToolpath {
    /// Where the tip stands before the first move, in mm.
    start: Point,
    /// The passes, in the order of cutting.
    #[serde(deserialize_with = "object::list")]
    passes: Vec<SentPass>,
}

/// Moves that belong together: one pass with the way to the pass.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
struct SentPass {
    /// A number of the depth level that the pass belongs to. The program does not depend on it.
    #[schema(maximum = 1_000_000)]
    level: Option<u32>,
    /// The tool axis at the start of the pass: three plain numbers without a unit. Where it differs from the
    /// axis before, the tool turns about its resting tip between the passes. Default: straight up,
    /// `[0, 0, 1]`; where moves have an `axis`, the axis before the pass, or else the axis of the first such
    /// move.
    #[schema(value_type = Option<AxisDirection>)]
    axis: Option<Coordinates<3>>,
    /// Where the tip stands before the first move of the pass, in mm, if the pass before ends elsewhere.
    /// Answers of `/v1/programs/read` have it. No program can be written of such a toolpath.
    start: Option<Point>,
    /// The moves, in order.
    moves: Vec<Move>,
}

/// Defaults and limits for reading moves.
pub struct ReadSettings<'a> {
    /// Gives the feeds of moves without a feed.
    pub cutting: Option<&'a CuttingRequest>,
    /// How far the radii of an arc may differ, and how far the arc may be moved to become exact, mm.
    pub arc_tolerance_mm: f64,
    /// Most moves of a toolpath.
    pub max_moves: usize,
    /// Whether a pass may begin where the way to it is not known.
    pub may_be_apart: bool,
}

/// A toolpath of the core, made from a request.
#[derive(Debug)]
pub struct Read {
    pub toolpath: Toolpath,
    /// Upper bound for the distance between the arcs in the request and the exact arcs in `toolpath`, mm.
    pub moved_mm: f64,
}

impl SentToolpath {
    /// The number of moves, with those for which cycles stand.
    pub fn n_moves(&self) -> usize {
        self.passes
            .iter()
            .flat_map(|pass| &pass.moves)
            .fold(0, |sum: usize, step| sum.saturating_add(step.count()))
    }

    /// The toolpath. `None` where it has violations, which `violations` then holds.
    pub fn convert(self, at: &Pointer, reading: &ReadSettings, violations: &mut Violations) -> Option<Read> {
        let moves = self.n_moves();
        let Self { start, passes } = self;
        let at_passes = at.field("passes");
        if moves > reading.max_moves {
            let detail = format!("the toolpath has {moves} moves; send at most {}", reading.max_moves);
            violations.add(&at_passes, FieldCode::LimitExceeded, detail);
            return None;
        }
        let before = violations.total();
        check_point(&start, || at.field("start"), violations);
        let builder = Toolpath::builder(start.into());
        let mut reader = Reader { builder, moved_mm: 0.0, reading, violations };
        for (k, SentPass { level, axis, start, moves }) in passes.into_iter().enumerate() {
            if let Some(level) = level.filter(|level| *level > MAX_LEVEL) {
                reader.violations.integer(&at_passes.index(k).field("level"), level, (0, MAX_LEVEL));
            }
            reader.begin_pass(level, axis, &moves, || at_passes.index(k));
            if let Some(start) = start {
                reader.goes_unseen(start, || at_passes.index(k).field("start"));
            }
            for (n, step) in moves.iter().enumerate() {
                reader.step(step, || at_passes.index(k).field("moves").index(n));
            }
        }
        let Reader { builder, moved_mm, violations, .. } = reader;
        let toolpath = builder.finish().ok()?;
        (violations.total() == before).then_some(Read { toolpath, moved_mm })
    }
}

/// Reads move by move. After a violation the tool still moves to the end of the illegal move, so that later
/// moves do not report the same fault again. The toolpath is thrown away in the end.
struct Reader<'a> {
    builder: Builder,
    moved_mm: f64,
    reading: &'a ReadSettings<'a>,
    violations: &'a mut Violations,
}

impl Reader<'_> {
    fn begin_pass(
        &mut self,
        level: Option<u32>,
        axis: Option<Coordinates<3>>,
        moves: &[Move],
        at: impl Fn() -> Pointer,
    ) {
        if let Some(axis) = axis {
            let axis = axis::unit(axis, &at().field("axis"), self.violations);
            return self.builder.begin_leaning_pass(level, axis.unwrap_or(Vector3::z_axis()));
        }
        let Some(first) = moves.iter().find_map(Move::axis) else {
            return self.builder.begin_leaning_pass(level, Vector3::z_axis());
        };
        if self.builder.has_passes() {
            return self.builder.begin_pass(level);
        }
        // A wrong axis is reported where the move is read.
        let axis = axis::unit(first, &at(), &mut Violations::default());
        self.builder.begin_leaning_pass(level, axis.unwrap_or(Vector3::z_axis()));
    }

    /// The tool is at `start`, on a way that is not known. No program can be written of such a toolpath.
    fn goes_unseen(&mut self, start: Point, at: impl Fn() -> Pointer) {
        check_point(&start, &at, self.violations);
        if self.reading.may_be_apart {
            return self.builder.begin_apart(start.into());
        }
        let detail =
            "the way to this place is not known, so no program can be written; send a rapid there instead";
        self.violations.add(&at(), FieldCode::Unsupported, detail);
    }

    /// The tool axis at the end of the next move.
    fn turn_next(&mut self, sent: Option<Coordinates<3>>, at: &impl Fn() -> Pointer) {
        let Some(sent) = sent else { return };
        let at = || at().field("axis");
        let Some(axis) = axis::unit(sent, &at(), self.violations) else { return };
        let added = self.builder.turn_next(axis);
        self.blame(added, at);
    }

    /// Reads one move. `at` builds the pointer for illegal moves only, because a toolpath has very many
    /// moves.
    fn step(&mut self, step: &Move, at: impl Fn() -> Pointer) {
        if !matches!(step, Move::Turn(_)) {
            self.turn_next(step.axis(), &at);
        }
        match step {
            Move::Rapid(RapidMove { to, .. }) => {
                check_point(to, || at().field("to"), self.violations);
                let added = self.builder.rapid((*to).into());
                self.blame(added, at);
            }
            Move::Line(LineMove { to, feed_mm_per_min, role, .. }) => {
                check_point(to, || at().field("to"), self.violations);
                let rate = self.feed(*feed_mm_per_min, *role, &at);
                self.line(to, rate, *role, at);
            }
            Move::Arc(arc) => self.arc(arc, at),
            Move::Parabola(ParabolaMove { to, control, feed_mm_per_min, role, .. }) => {
                check_point(to, || at().field("to"), self.violations);
                check_point(control, || at().field("control"), self.violations);
                let rate = self.feed(*feed_mm_per_min, *role, &at);
                let added = self.builder.parabola((*to).into(), (*control).into(), rate, *role);
                self.blame(added, at);
            }
            Move::Turn(TurnMove { axis: sent, seconds, role, .. }) => {
                self.check_seconds(seconds.unwrap_or(0.0), &at);
                let Some(axis) = axis::unit(*sent, &at().field("axis"), self.violations) else { return };
                if seconds.is_none() {
                    let detail = "send how many seconds the turn takes";
                    self.violations.add(&at().field("seconds"), FieldCode::FeedRequired, detail);
                }
                let added = self.builder.turn(axis, *seconds, *role);
                self.blame(added, || at().field("axis"));
            }
            Move::Cycle(cycle) => self.cycle(cycle, at),
            Move::Dwell(DwellMove { seconds, .. }) => {
                if self.check_seconds(*seconds, &at) {
                    let added = self.builder.dwell(*seconds);
                    self.blame(added, at);
                }
            }
        }
    }

    fn check_seconds(&mut self, seconds: f64, at: &impl Fn() -> Pointer) -> bool {
        let range = Range { min: 0.0, max: MAX_DWELL_S };
        let is_legal = (range.min..=range.max).contains(&seconds);
        if !is_legal {
            self.violations.number(&at().field("seconds"), seconds, range, "s");
        }
        is_legal
    }

    fn line(&mut self, to: &Point, rate: FeedRate, role: Role, at: impl Fn() -> Pointer) {
        let added = self.builder.line((*to).into(), rate, role);
        self.blame(added, at);
    }

    fn arc(&mut self, arc: &ArcMove, at: impl Fn() -> Pointer) {
        let &ArcMove { to, center, plane, direction, feed_mm_per_min, role, .. } = arc;
        check_point(&to, || at().field("to"), self.violations);
        check_point(&center, || at().field("center"), self.violations);
        let rate = self.feed(feed_mm_per_min, role, &at);
        let turn = (plane, direction);
        let (start, end) = (self.builder.at(), Point3::from(to));
        match near_arc(turn, start, end, center.into(), self.reading.arc_tolerance_mm) {
            Ok(NearArc { arcs, moved_mm }) => {
                self.moved_mm = self.moved_mm.max(moved_mm);
                let axes = self.builder.take_turn();
                let whole: f64 = arcs.iter().map(Arc::sweep).sum();
                let mut done = 0.0;
                for arc in arcs {
                    done += arc.sweep();
                    if let Some([from, to]) = axes {
                        // The turn was found possible before; its parts are smaller.
                        let turned = self.builder.turn_next(tool_axes::between(&from, &to, done / whole));
                        self.blame(turned, &at);
                    }
                    let added = self.builder.arc(arc.end(), arc.center(), turn, rate, role);
                    self.blame(added, &at);
                }
            }
            Err(error) => {
                self.violations.add(&at(), FieldCode::NoArc, error.to_string());
                self.line(&to, rate, role, at);
            }
        }
    }

    /// The feed of a move. An illegal or missing feed is reported and replaced by a default.
    fn feed(&mut self, own: Option<f64>, role: Role, at: &impl Fn() -> Pointer) -> FeedRate {
        let by_role = self.reading.cutting.map(|cutting| cutting.feed_of(role));
        match (own, by_role) {
            (Some(own), _) => {
                if !(Range::POSITIVE.min..=Range::POSITIVE.max).contains(&own) {
                    let at = at().field("feed_mm_per_min");
                    self.violations.number(&at, own, Range::POSITIVE, "mm/min");
                }
                FeedRate::from_mm_per_min(own).unwrap_or(FeedRate::DEFAULT_RAPID)
            }
            (None, Some(by_role)) => by_role,
            (None, None) => {
                let detail =
                    "the move has no `feed_mm_per_min` and the request has no `cutting`: send one of the two";
                self.violations.add(&at().field("feed_mm_per_min"), FieldCode::FeedRequired, detail);
                FeedRate::DEFAULT_RAPID
            }
        }
    }

    fn blame(&mut self, added: Result<(), PathError>, at: impl Fn() -> Pointer) {
        if let Err(error) = added {
            let code = match error {
                PathError::OppositeAxes | PathError::BadTime { .. } => FieldCode::OutOfRange,
                PathError::Cycle(_) => FieldCode::Conflict,
                _ => FieldCode::NoArc,
            };
            self.violations.add(&at(), code, error.to_string());
        }
    }
}

fn check_point(point: &Point, at: impl Fn() -> Pointer, violations: &mut Violations) {
    for (axis, value) in point.0.into_iter().enumerate().filter(|(_, x)| x.abs() > MAX_MAGNITUDE_MM) {
        violations.number(&at().index(axis), value, Range::COORDINATE, "mm");
    }
}

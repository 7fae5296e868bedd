//! Cutter compensation in the plane: the path of the centre beside the contour that a program states.
//!
//! # Method
//! 1. Each block waits until the next block in the plane is known. Blocks along the normal and pauses wait
//!    with it; they run where the two meet.
//! 2. At an inside corner the tool turns at the crossing of the two offset curves that is nearest to the
//!    corner. At an outside corner it goes round: by an arc about the corner, or along the prolonged
//!    tangents, as the control does.
//! 3. The first block leads from where the tool is to the offset start of the next block, or, on LinuxCNC, to
//!    the offset end of its own; there an arc may be the first block, too. The last block ends at right
//!    angles to its own end.
//!
//! # Guarantees
//! * The centre of the path is never nearer to a corner than the radius.
//! * A cutter that does not fit between two neighbouring blocks, or into an arc, is refused, as controls do.
//!   Blocks that are no neighbours are not looked at.

use nalgebra::{Point3, Vector2};
use toolpathd_core::geometry::curve::{Arc, Curve, Direction, Line as Segment};
use toolpathd_core::geometry::plane::Plane;
use toolpathd_core::toolpath::path::PathError;
use toolpathd_core::toolpath::units::FeedRate;

use super::contour::{Contour, crossing, normal};
use super::{Family, Fault, Side};
use crate::record::Record;

/// Blocks along the normal and pauses between two blocks in the plane.
pub(super) const MAX_BETWEEN: usize = 1000;

/// Sine of the angle between two blocks that count as tangent. The crossing of curves that are nearer to
/// tangent is lost in rounding.
const TANGENT: f64 = 1e-6;

/// Places that are nearer count as one, mm: intersections of offset curves come with rounding.
pub(super) const SAME_PLACE_MM: f64 = 1e-7;

/// Largest radius of the arc that leads to a contour, mm.
const MAX_ENTRY_RADIUS_MM: f64 = 1e5;

/// Compensation in force.
#[derive(Debug, Clone)]
pub struct Compensation {
    pub(super) side: Side,
    pub(super) radius_mm: f64,
    pub(super) plane: Plane,
    /// Where the tool really is.
    pub(super) tip: Point3<f64>,
    pub(super) waiting: Option<Waiting>,
    /// The tool stands beside the start of the first block.
    pub(super) is_beside: bool,
}

/// A block that waits for the next.
#[derive(Debug, Clone)]
pub(super) struct Waiting {
    step: Step,
    entry: Entry,
    pub(super) between: Vec<Between>,
}

/// Whether a block leads from where the tool is to the contour.
#[derive(Debug, Clone, Copy)]
enum Entry {
    No,
    Straight,
    /// The arc that the tool really runs up to the place beside the end of the block.
    Arc(Arc),
}

/// A move of the contour.
#[derive(Debug, Clone)]
pub(super) struct Step {
    pub(super) curve: Curve,
    pub(super) drive: Drive,
    pub(super) line: usize,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Drive {
    Rapid,
    Feed(FeedRate, Option<f64>),
}

/// What runs between two blocks in the plane.
#[derive(Debug, Clone)]
pub(super) enum Between {
    Along(Step),
    Pause(f64, usize),
}

/// Why the tool cannot go on, and the line of the block.
pub(super) type Failure = (usize, Fault);

/// How a control goes round outside corners, and how it begins.
#[derive(Debug, Clone, Copy)]
pub(super) struct Corners {
    are_round: bool,
    /// The first block ends beside its own end, else beside the start of the next.
    begins_along: bool,
    /// A rapid leads straight to the start of its own offset line.
    rapids_cut: bool,
}

impl Corners {
    pub(super) fn of(family: Family) -> Self {
        let is_linuxcnc = family == Family::LinuxCnc;
        Self { are_round: family != Family::Fanuc, begins_along: is_linuxcnc, rapids_cut: is_linuxcnc }
    }
}

impl Compensation {
    pub(super) fn add(&mut self, step: Step, corners: Corners, record: &mut Record) -> Result<(), Failure> {
        let is_along = {
            let [a, b, _] = self.plane.axes();
            let (start, end) = (step.curve.start(), step.curve.end());
            matches!(step.curve, Curve::Line(_))
                && (end[a] - start[a]).hypot(end[b] - start[b]) <= SAME_PLACE_MM
        };
        match &mut self.waiting {
            None if is_along => self.go_along(&step, record),
            Some(waiting) if is_along => {
                if waiting.between.len() >= MAX_BETWEEN {
                    return Err((step.line, Fault::TooManyMoves(MAX_BETWEEN)));
                }
                waiting.between.push(Between::Along(step));
                Ok(())
            }
            None => {
                let entry = match &step.curve {
                    _ if std::mem::take(&mut self.is_beside) => Entry::No,
                    Curve::Line(_) => Entry::Straight,
                    Curve::Arc(arc) if corners.begins_along => {
                        Entry::Arc(self.entry_arc(arc).map_err(|fault| (step.line, fault))?)
                    }
                    _ => return Err((step.line, Fault::CompensationByArc)),
                };
                self.waiting = Some(Waiting { step, entry, between: Vec::new() });
                Ok(())
            }
            Some(_) => {
                let Some(waiting) = self.waiting.take() else { return Ok(()) };
                self.turn_corner(waiting, &step, corners, record)?;
                self.waiting = Some(Waiting { step, entry: Entry::No, between: Vec::new() });
                Ok(())
            }
        }
    }

    /// The arc from where the tool is to the place beside the end of the contour's arc, in the same direction
    /// there.
    fn entry_arc(&self, arc: &Arc) -> Result<Arc, Fault> {
        let is_left = self.side == Side::Left;
        let leaves = Contour::new(&Curve::Arc(*arc), self.plane, is_left, self.radius_mm)?.leaves;
        let start = self.local(&self.tip);
        let end = self.local(&arc.end()) + normal(leaves, is_left) * self.radius_mm;
        let to_center = (self.local(&arc.center()) - end).normalize();
        let chord = start - end;
        let radius = chord.norm_squared() / (2.0 * chord.dot(&to_center));
        if !radius.is_finite() || radius.abs() > MAX_ENTRY_RADIUS_MM {
            return Err(Fault::CutterTooLarge);
        }
        let n = self.plane.axes()[2];
        let mut to = self.lifted(end);
        to[n] = arc.end()[n];
        let center = self.lifted(end + to_center * radius);
        Ok(Arc::with_center_near(self.plane, arc.direction(), self.tip, to, center)?)
    }

    /// The offset of a block that waits; the arc itself where it is the entry.
    fn own_contour(&self, waiting: &Waiting) -> Result<Contour, Failure> {
        match &waiting.entry {
            Entry::Arc(arc) => Contour::new(&Curve::Arc(*arc), self.plane, self.side == Side::Left, 0.0)
                .map_err(|fault| (waiting.step.line, fault)),
            _ => self.contour(&waiting.step),
        }
    }

    fn contour(&self, step: &Step) -> Result<Contour, Failure> {
        Contour::new(&step.curve, self.plane, self.side == Side::Left, self.radius_mm)
            .map_err(|fault| (step.line, fault))
    }

    /// Runs the block that waits up to its corner with the next, and goes round the corner.
    fn turn_corner(
        &mut self,
        waiting: Waiting,
        next: &Step,
        corners: Corners,
        record: &mut Record,
    ) -> Result<(), Failure> {
        let (first, second) = (self.own_contour(&waiting)?, self.contour(next)?);
        let corner = self.local(&waiting.step.curve.end());
        let is_left = self.side == Side::Left;
        let radius = self.radius_mm;
        let [beside_first, beside_second] =
            [first.leaves, second.begins].map(|way| corner + normal(way, is_left) * radius);
        let is_straight_entry = matches!(waiting.entry, Entry::Straight);
        if is_straight_entry && !corners.begins_along {
            self.run_to(&waiting, None, beside_second, record)?;
            return Ok(());
        }
        let (sine, cosine) = (first.leaves.perp(&second.begins), first.leaves.dot(&second.begins));
        let inward = if is_left { sine } else { -sine };
        let own = (!is_straight_entry).then_some(&first);
        if inward.abs() <= TANGENT && cosine > 0.0 {
            self.run_to(&waiting, own, beside_second, record)
        } else if inward > 0.0 {
            let at = crossing(&first, &second, corner).ok_or((next.line, Fault::CutterTooLarge))?;
            self.run_to(&waiting, own, at, record)
        } else {
            self.run_to(&waiting, own, beside_first, record)?;
            let is_rapid = next.drive == Drive::Rapid;
            if corners.are_round && !is_rapid {
                return self.round(corner, beside_second, next, record);
            }
            let mut ways = Vec::new();
            if is_rapid && corners.rapids_cut {
                // The chord of the arc is nearer to the corner than the radius, as on the control.
            } else if cosine >= 0.0 {
                ways.push(corner + (beside_first + beside_second - 2.0 * corner) / (1.0 + cosine));
            } else {
                ways.push(beside_first + first.leaves * radius);
                ways.push(beside_second - second.begins * radius);
            }
            ways.push(beside_second);
            for to in ways {
                let to = self.lifted(to);
                let curve = Curve::Line(Segment { start: self.tip, end: to });
                self.emit(curve, next.drive, next.line, record)?;
            }
            Ok(())
        }
    }

    /// An arc about a corner to `to`, at the feed of the next block.
    fn round(
        &mut self,
        corner: Vector2<f64>,
        to: Vector2<f64>,
        next: &Step,
        record: &mut Record,
    ) -> Result<(), Failure> {
        let direction = if self.side == Side::Left { Direction::Cw } else { Direction::Ccw };
        let (center, to) = (self.lifted(corner), self.lifted(to));
        let arc = Arc::with_center_near(self.plane, direction, self.tip, to, center);
        let arc = arc.map_err(|error| (next.line, Fault::Arc(error)))?;
        self.emit(Curve::Arc(arc), next.drive, next.line, record)
    }

    /// Runs a block to `end` in the plane, then what waits with it. `own` is the contour of the block, absent
    /// for the first block, which leads straight from where the tool is.
    fn run_to(
        &mut self,
        waiting: &Waiting,
        own: Option<&Contour>,
        end: Vector2<f64>,
        record: &mut Record,
    ) -> Result<(), Failure> {
        let Waiting { step, entry, between } = waiting;
        let [_, _, n] = self.plane.axes();
        let mut to = self.lifted(end);
        to[n] = step.curve.end()[n];
        let start = self.local(&self.tip);
        let too_large = (step.line, Fault::CutterTooLarge);
        let real = if let Entry::Arc(arc) = entry { Curve::Arc(*arc) } else { step.curve };
        let curve = match (&real, own) {
            (Curve::Arc(arc), Some(own)) => {
                let swept = own.swept(start, end).ok_or(too_large)?;
                if swept * own.radius_mm <= SAME_PLACE_MM {
                    Curve::Line(Segment { start: self.tip, end: to })
                } else {
                    let mut center = arc.center();
                    center[n] = self.tip[n];
                    let is_whole = (end - start).norm() <= SAME_PLACE_MM;
                    if is_whole {
                        let [a, b, _] = self.plane.axes();
                        (to[a], to[b]) = (self.tip[a], self.tip[b]);
                    }
                    let arc = Arc::with_center_near(self.plane, arc.direction(), self.tip, to, center);
                    Curve::Arc(arc.map_err(|error| (step.line, Fault::Arc(error)))?)
                }
            }
            (_, own) => {
                if own.is_some_and(|own| (end - start).dot(&own.begins) < -SAME_PLACE_MM) {
                    return Err(too_large);
                }
                Curve::Line(Segment { start: self.tip, end: to })
            }
        };
        self.emit(curve, step.drive, step.line, record)?;
        for own in between {
            match own {
                Between::Along(step) => self.go_along(step, record)?,
                Between::Pause(seconds, line) => {
                    record.dwell(*seconds, *line).map_err(|error| (*line, fault_of(error)))?;
                }
            }
        }
        Ok(())
    }

    /// A move along the normal, where the tool is.
    fn go_along(&mut self, step: &Step, record: &mut Record) -> Result<(), Failure> {
        let n = self.plane.axes()[2];
        let mut to = self.tip;
        to[n] = step.curve.end()[n];
        self.emit(Curve::Line(Segment { start: self.tip, end: to }), step.drive, step.line, record)
    }

    fn emit(&mut self, curve: Curve, drive: Drive, line: usize, record: &mut Record) -> Result<(), Failure> {
        let to = curve.end();
        match drive {
            Drive::Rapid => record.rapid(self.tip, to, line),
            Drive::Feed(rate, speed) => record.feed(curve, rate, speed, line),
        }
        .map_err(|error| (line, fault_of(error)))?;
        self.tip = to;
        Ok(())
    }

    /// Runs the block that waits to the place beside its end.
    pub(super) fn finish(&mut self, record: &mut Record) -> Result<(), Failure> {
        let Some(waiting) = self.waiting.take() else { return Ok(()) };
        let own = self.own_contour(&waiting)?;
        let corner = self.local(&waiting.step.curve.end());
        let beside = corner + normal(own.leaves, self.side == Side::Left) * self.radius_mm;
        let is_straight_entry = matches!(waiting.entry, Entry::Straight);
        self.run_to(&waiting, (!is_straight_entry).then_some(&own), beside, record)
    }

    fn local(&self, at: &Point3<f64>) -> Vector2<f64> {
        self.plane.to_local(at).xy()
    }

    /// A place of the plane at the height of the tool.
    fn lifted(&self, place: Vector2<f64>) -> Point3<f64> {
        let [a, b, _] = self.plane.axes();
        let mut to = self.tip;
        (to[a], to[b]) = (place.x, place.y);
        to
    }
}

fn fault_of(error: PathError) -> Fault {
    match error {
        PathError::Arc(error) => Fault::Arc(error),
        PathError::TooManyMoves { limit } => Fault::TooManyMoves(limit),
        _ => Fault::NotFinite,
    }
}

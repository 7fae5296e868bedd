//! The shapes of entities as lines and arcs in mm.
//!
//! Lines, and arcs under maps that keep circles, stay what they are. A conic is an ellipse, or a circle that
//! is scaled unevenly: it becomes a chain of rational quadratic pieces, and that chain arcs within the
//! tolerance, as splines do.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use nalgebra::{Point2, Vector2};
use toolpathd_core::budget::{Budget, Stopped};
use toolpathd_core::geometry::plane_curve::nurbs::Nurbs;
use toolpathd_core::geometry::plane_curve::piecewise::{Bezier, Piecewise};
use toolpathd_core::geometry::segment;
use toolpathd_core::geometry::spline::{EndCondition, derivatives_over};

use super::placement::{Placement, are_axes_of_a_circle, cosine_and_sine, perp};
use super::reasons;
use super::shape::{Shape, Tangents};
use crate::drawing::arcs;
use crate::fault::{Place, Unreadable};

/// The largest coordinate, mm: a thousand kilometres. Coordinates are rounded by 1e-7 mm there.
const LARGEST_MM: f64 = 1e9;

/// The largest bulge: an arc that lacks 4e-6 radians to a full turn.
const LARGEST_BULGE: f64 = 1e6;

/// How far the range of an ellipse may be from a full turn, radians, and count as one. Files round
/// parameters to 6 decimals at least.
const FULL_TURN: f64 = 1e-6;

/// How far the ends of a spline may lie apart, as a part of its largest coordinate, and count as one place.
const CLOSED: f64 = 1e-11;

/// A shape as lines and arcs.
#[derive(Debug, Clone, PartialEq)]
pub struct Drawn {
    /// x, y and the bulge to the next vertex, mm. A closed curve does not repeat its first vertex.
    pub vertices: Vec<[f64; 3]>,
    pub is_closed: bool,
    /// Whether the ends are points that the file has, and not computed from angles.
    pub has_written_ends: bool,
    pub deviation_mm: f64,
}

/// Why a shape is not drawn.
#[derive(Debug, Clone, PartialEq)]
pub enum Undrawn {
    LeftOut(&'static str),
    Refused(Unreadable),
}

impl From<Stopped> for Undrawn {
    fn from(stopped: Stopped) -> Self {
        Self::Refused(stopped.into())
    }
}

/// How shapes are drawn.
#[derive(Clone, Copy)]
pub struct Drafting<'a> {
    pub tolerance_mm: f64,
    /// The most vertices of a shape.
    pub vertex_limit: usize,
    pub budget: &'a Budget,
}

impl Drafting<'_> {
    /// # Errors
    /// When the shape is no curve, needs too many vertices, or the budget ends.
    pub fn draw(&self, shape: &Shape, placement: &Placement, place: Place) -> Result<Drawn, Undrawn> {
        let (vertices, is_closed, deviation_mm) = match shape {
            Shape::Line(ends) => (ends.map(|p| vertex(placement.point(p), 0.0)).to_vec(), false, 0.0),
            Shape::Polyline { vertices, is_closed } => {
                let (vertices, deviation_mm) = self.polyline(vertices, *is_closed, placement, place)?;
                (vertices, *is_closed, deviation_mm)
            }
            Shape::Circle { center, radius, is_mirrored } => {
                let (major, minor) = axes(*radius, *is_mirrored);
                self.conic(&Conic { center: *center, major, minor, start: 0.0, turn: TAU }, placement, place)?
            }
            Shape::Arc { center, radius, start, end, is_mirrored } => {
                self.arc((*center, *radius, *is_mirrored), [*start, *end], placement, place)?
            }
            Shape::Ellipse { center, major, minor, start, end } => {
                let turn = (end - start).rem_euclid(TAU);
                let is_full = !(FULL_TURN..=TAU - FULL_TURN).contains(&turn);
                let turn = if is_full { TAU } else { turn };
                let conic = Conic { center: *center, major: *major, minor: *minor, start: *start, turn };
                self.conic(&conic, placement, place)?
            }
            Shape::Nurbs(nurbs) => {
                self.check_points(nurbs.control_points.len(), place)?;
                self.spline(&nurbs_curve(nurbs, placement)?, place)?
            }
            Shape::Through { points, tangents } => {
                self.check_points(points.len(), place)?;
                self.spline(&curve_through(points, *tangents, placement)?, place)?
            }
        };
        let has_written_ends = matches!(shape, Shape::Line(_) | Shape::Polyline { .. });
        finished(Drawn { vertices, is_closed, has_written_ends, deviation_mm })
    }

    /// Refuses splines of too many points before they are computed.
    fn check_points(&self, n_points: usize, place: Place) -> Result<(), Undrawn> {
        self.budget.check()?;
        if n_points > self.vertex_limit {
            let detail = format!("a spline has more than {} points", self.vertex_limit);
            return Err(Undrawn::Refused(Unreadable::at(place, detail)));
        }
        Ok(())
    }

    fn arc(
        &self,
        (center, radius, is_mirrored): ([f64; 2], f64, bool),
        [start, end]: [f64; 2],
        placement: &Placement,
        place: Place,
    ) -> Result<(Vec<[f64; 3]>, bool, f64), Undrawn> {
        let degrees = (end - start).rem_euclid(360.0);
        let degrees = if degrees == 0.0 { 360.0 } else { degrees };
        let (major, minor) = axes(radius, is_mirrored);
        let turn = degrees.to_radians();
        let conic = Conic { center, major, minor, start: start.to_radians(), turn };
        if degrees == 360.0 || !placement.keeps_circles() {
            return self.conic(&conic, placement, place);
        }
        // Ends at whole quarter turns are exact.
        let at = |angle: f64| {
            let [cosine, sine] = cosine_and_sine(angle);
            placement.point(conic.at(cosine, sine))
        };
        let sign = if placement.is_mirrored() != is_mirrored { -1.0 } else { 1.0 };
        let vertices = match degrees <= 180.0 {
            true => vec![vertex(at(start), bulge(sign * turn)), vertex(at(end), 0.0)],
            false => {
                let half = bulge(0.5 * sign * turn);
                let middle = at(start + 0.5 * degrees);
                vec![vertex(at(start), half), vertex(middle, half), vertex(at(end), 0.0)]
            }
        };
        Ok((vertices, false, 0.0))
    }

    fn conic(
        &self,
        conic: &Conic,
        placement: &Placement,
        place: Place,
    ) -> Result<(Vec<[f64; 3]>, bool, f64), Undrawn> {
        let conic = conic.placed(placement);
        let is_closed = conic.turn == TAU;
        if are_axes_of_a_circle(conic.major, conic.minor) {
            let sign = perp(conic.major, conic.minor).signum();
            let n = if conic.turn > PI { 2 } else { 1 };
            let bulge = bulge(sign * conic.turn / f64::from(n));
            let mut vertices: Vec<_> =
                (0..n).map(|k| vertex(conic.at_part(f64::from(k) / f64::from(n)), bulge)).collect();
            if !is_closed {
                vertices.push(vertex(conic.at_part(1.0), 0.0));
            }
            return Ok((vertices, is_closed, 0.0));
        }
        let (mut vertices, _, deviation_mm) = self.spline(&conic.curve(is_closed)?, place)?;
        if is_closed {
            vertices.pop();
        }
        Ok((vertices, is_closed, deviation_mm))
    }

    fn spline(&self, curve: &Piecewise, place: Place) -> Result<(Vec<[f64; 3]>, bool, f64), Undrawn> {
        match arcs::of_curve(curve, self.tolerance_mm, self.vertex_limit, self.budget)? {
            Some(arcs) => Ok((arcs.vertices, false, arcs.deviation_mm)),
            None => Err(Undrawn::Refused(Unreadable::at(
                place,
                format!("the curves need more than {} arcs; use a larger tolerance", self.vertex_limit),
            ))),
        }
    }

    fn polyline(
        &self,
        vertices: &[[f64; 3]],
        is_closed: bool,
        placement: &Placement,
        place: Place,
    ) -> Result<(Vec<[f64; 3]>, f64), Undrawn> {
        let point = |v: &[f64; 3]| placement.point([v[0], v[1]]);
        if placement.keeps_circles() {
            let sign = if placement.is_mirrored() { -1.0 } else { 1.0 };
            return Ok((vertices.iter().map(|v| vertex(point(v), sign * v[2])).collect(), 0.0));
        }
        let mut drawn = Vec::with_capacity(vertices.len());
        let mut deviation_mm = 0.0f64;
        for (k, from) in vertices.iter().enumerate() {
            let next = vertices.get(k + 1).or_else(|| vertices.first().filter(|_| is_closed));
            let start = drawn.len();
            drawn.push(vertex(point(from), 0.0));
            let Some(next) = next else { break };
            if from[2] != 0.0 && from[..2] != next[..2] {
                let (arcs, _, deviation) = self.conic(&Conic::bulging(from, next), placement, place)?;
                drawn[start][2] = arcs.first().map_or(0.0, |first| first[2]);
                drawn.extend(arcs.iter().take(arcs.len().saturating_sub(1)).skip(1));
                deviation_mm = deviation_mm.max(deviation);
            }
            if drawn.len() > self.vertex_limit {
                let detail = format!("the curves need more than {} vertices", self.vertex_limit);
                return Err(Undrawn::Refused(Unreadable::at(place, detail)));
            }
        }
        Ok((drawn, deviation_mm))
    }
}

/// The points center + cos t major + sin t minor, for t from `start` to `start` + `turn`.
#[derive(Debug, Clone, Copy)]
struct Conic {
    center: [f64; 2],
    major: [f64; 2],
    minor: [f64; 2],
    start: f64,
    turn: f64,
}

impl Conic {
    /// The arc from a vertex of a polyline to the next.
    fn bulging(from: &[f64; 3], to: &[f64; 3]) -> Self {
        let [start, end] = [from, to].map(|v| Vector2::new(v[0], v[1]));
        // Core counts bulges positive to the left of the chord.
        let center = segment::center(start, end, -from[2]);
        let major = start - center;
        let side = from[2].signum();
        let turn = 4.0 * from[2].abs().atan();
        Self {
            center: center.into(),
            major: major.into(),
            minor: [-major.y * side, major.x * side],
            start: 0.0,
            turn,
        }
    }

    fn placed(&self, placement: &Placement) -> Self {
        Self {
            center: placement.point(self.center),
            major: placement.direction(self.major),
            minor: placement.direction(self.minor),
            ..*self
        }
    }

    fn at(&self, cosine: f64, sine: f64) -> [f64; 2] {
        [0, 1].map(|k| self.center[k] + (self.major[k] * cosine + self.minor[k] * sine))
    }

    fn at_part(&self, part: f64) -> [f64; 2] {
        let angle = self.start + part * self.turn;
        let quarters = angle / FRAC_PI_2;
        let [cosine, sine] = match quarters.fract() == 0.0 {
            true => cosine_and_sine(90.0 * quarters),
            false => [angle.cos(), angle.sin()],
        };
        self.at(cosine, sine)
    }

    /// The conic as rational quadratic pieces of at most a quarter turn.
    fn curve(&self, is_closed: bool) -> Result<Piecewise, Undrawn> {
        let n = (self.turn / FRAC_PI_2 - 1e-9).ceil().max(1.0);
        let half = 0.5 * self.turn / n;
        let ends: Vec<[f64; 2]> = (0..=n as usize)
            .map(|k| self.at_part(if is_closed && k == n as usize { 0.0 } else { k as f64 / n }))
            .collect();
        let pieces = (0..n as usize).map(|k| {
            let (sine, cosine) = (self.start + half * (2.0 * k as f64 + 1.0)).sin_cos();
            let middle = self.at(cosine / half.cos(), sine / half.cos());
            let points = [ends[k], middle, ends[k + 1]].map(Point2::from);
            check_near(&points)?;
            let piece = Bezier::rational(&points, &[1.0, half.cos(), 1.0]);
            piece.map(|piece| (piece, (k + 1) as f64)).map_err(|_| Undrawn::LeftOut(reasons::NO_CURVE))
        });
        let pieces: Vec<_> = pieces.collect::<Result<_, _>>()?;
        Piecewise::new(0.0, pieces).map_err(|_| Undrawn::LeftOut(reasons::NO_CURVE))
    }
}

/// The axes of a circle; a circle seen from below runs clockwise.
fn axes(radius: f64, is_mirrored: bool) -> ([f64; 2], [f64; 2]) {
    match is_mirrored {
        // The angle is counted from the axis that points to minus x.
        true => ([-radius, 0.0], [0.0, radius]),
        false => ([radius, 0.0], [0.0, radius]),
    }
}

fn bulge(turn: f64) -> f64 {
    // The tangent of an eighth of a full turn comes out below 1.
    if turn.abs() == PI { turn.signum() } else { (0.25 * turn).tan() }
}

fn vertex([x, y]: [f64; 2], bulge: f64) -> [f64; 3] {
    [x, y, bulge]
}

fn nurbs_curve(nurbs: &Nurbs, placement: &Placement) -> Result<Piecewise, Undrawn> {
    let control_points: Vec<Point2<f64>> =
        nurbs.control_points.iter().map(|p| placement.point([p.x, p.y]).into()).collect();
    check_near(&control_points)?;
    let placed = Nurbs { control_points, ..nurbs.clone() };
    placed.curve().map_err(|_| Undrawn::LeftOut(reasons::NO_CURVE))
}

/// The cubic through points with two continuous derivatives. Its parameter grows by the lengths of the
/// chords, so that tangents that are given have a length of one.
fn curve_through(
    points: &[[f64; 2]],
    tangents: Tangents,
    placement: &Placement,
) -> Result<Piecewise, Undrawn> {
    let points: Vec<Vector2<f64>> = points.iter().map(|p| placement.point(*p).into()).collect();
    check_near(&points.iter().map(|p| Point2::from(*p)).collect::<Vec<_>>())?;
    let steps: Vec<f64> = points.windows(2).map(|ends| (ends[1] - ends[0]).norm()).collect();
    if steps.iter().any(|step| *step <= 0.0) {
        return Err(Undrawn::LeftOut(reasons::NO_CURVE));
    }
    let ends = match tangents {
        Tangents::Free => EndCondition::NotAKnot,
        Tangents::Closed => EndCondition::Periodic,
        Tangents::Given(directions) => {
            let [start, end] = directions.map(|v| Vector2::from(placement.direction(v)).normalize());
            EndCondition::Clamped(start, end)
        }
    };
    let slopes = derivatives_over(&steps, &points, ends);
    let mut at = 0.0;
    let pieces = steps.iter().enumerate().map(|(k, step)| {
        let (from, to) = (points[k], points[k + 1]);
        let control = [from, from + slopes[k] * (step / 3.0), to - slopes[k + 1] * (step / 3.0), to];
        at += step;
        Bezier::polynomial(&control.map(Point2::from)).map(|piece| (piece, at))
    });
    let pieces: Vec<_> = pieces.collect::<Result<_, _>>().map_err(|_| Undrawn::LeftOut(reasons::NO_CURVE))?;
    Piecewise::new(0.0, pieces).map_err(|_| Undrawn::LeftOut(reasons::NO_CURVE))
}

/// Refuses points far from the origin: arcs near them would be rounding.
fn check_near(points: &[Point2<f64>]) -> Result<(), Undrawn> {
    match points.iter().all(|p| p.x.abs() <= LARGEST_MM && p.y.abs() <= LARGEST_MM) {
        true => Ok(()),
        false => Err(Undrawn::LeftOut(reasons::FAR)),
    }
}

/// Whether an arc has a circle, and stays near the origin if its ends do.
fn is_arc_near(from: &[f64; 3], to: &[f64; 3]) -> bool {
    // An arc of more than half a turn rises above its chord by half of its bulge times its chord.
    let bulge = from[2].abs();
    bulge <= 1.0
        || (bulge <= LARGEST_BULGE && bulge * f64::hypot(to[0] - from[0], to[1] - from[1]) <= LARGEST_MM)
}

/// The curve without pieces that have no length. A curve whose ends are one place is closed.
fn finished(mut drawn: Drawn) -> Result<Drawn, Undrawn> {
    if !drawn.vertices.as_flattened().iter().all(|x| x.abs() <= LARGEST_MM) {
        return Err(Undrawn::LeftOut(reasons::FAR));
    }
    let vertices = &mut drawn.vertices;
    for vertex in vertices.iter_mut() {
        // Minus zero becomes zero: both are one place.
        *vertex = vertex.map(|number| number + 0.0);
    }
    let is_same = |a: &[f64; 3], b: &[f64; 3]| a[..2] == b[..2];
    // Of vertices in one place the last remains, with the bulge of the piece that leaves the place.
    let mut kept: Vec<[f64; 3]> = Vec::with_capacity(vertices.len());
    for vertex in vertices.drain(..) {
        if kept.last().is_some_and(|last| is_same(last, &vertex)) {
            kept.pop();
        }
        kept.push(vertex);
    }
    if let [first, .., last] = kept.as_slice() {
        let magnitude = kept.iter().fold(0.0f64, |most, v| most.max(v[0].abs()).max(v[1].abs()));
        let gap = f64::hypot(last[0] - first[0], last[1] - first[1]);
        let is_computed_end = !drawn.has_written_ends && gap <= CLOSED * magnitude && kept.len() > 2;
        if is_same(first, last) || is_computed_end {
            kept.pop();
            drawn.is_closed = true;
        }
    }
    if let Some(last) = kept.last_mut().filter(|_| !drawn.is_closed) {
        // No piece leaves the end of an open curve.
        last[2] = 0.0;
    }
    if kept.len() < 2 {
        return Err(Undrawn::LeftOut(reasons::NO_LENGTH));
    }
    let next = kept.iter().cycle().skip(1);
    if !kept.iter().zip(next).all(|(from, to)| is_arc_near(from, to)) {
        return Err(Undrawn::LeftOut(reasons::FAR));
    }
    *vertices = kept;
    Ok(drawn)
}

//! Edges of level faces in plan, as lines and arcs.

use std::f64::consts::{PI, TAU};

use nalgebra::{Point2, Vector2};
use toolpathd_core::budget::{Budget, Stopped};
use toolpathd_core::geometry::plane_curve::nurbs::Nurbs;

use crate::drawing::{arcs, bulge};
use crate::step::curve::Curve;
use crate::step::frame::Frame;
use crate::step::model::Edge;
use crate::step::nurbs_form;

/// The most arcs of an edge. A longer chain is noise, and no control would run it.
const MOST_ARCS: usize = 100_000;

/// A circle lies in plan if the sine of the angle between its axis and z is less.
const UPRIGHT: f64 = 1e-6;

/// An edge in plan, in its direction.
#[derive(Debug, Clone, PartialEq)]
pub struct PlanEdge {
    /// x, y and the bulge to the next vertex, mm. The last vertex is the end of the edge, with no bulge.
    pub vertices: Vec<[f64; 3]>,
    pub deviation_mm: f64,
}

/// Why an edge has no plan.
#[derive(Debug, Clone, PartialEq)]
pub enum NoPlan {
    Stopped(Stopped),
    /// A clause.
    Reason(&'static str),
}

impl From<Stopped> for NoPlan {
    fn from(stopped: Stopped) -> Self {
        Self::Stopped(stopped)
    }
}

/// An edge in plan. Lines, polylines and level circles are exact; other curves become arcs within the
/// tolerance.
///
/// # Errors
/// The curve has no arcs within the tolerance, or the budget has ended.
pub fn plan(edge: &Edge, tolerance_mm: f64, budget: &Budget) -> Result<PlanEdge, NoPlan> {
    budget.check()?;
    let exact = match &edge.curve {
        Curve::Line { .. } => Some(chain([edge.from, edge.to].map(|t| place(edge, t)))),
        Curve::Polyline(_) => {
            let mut places = edge.curve.breaks([edge.from.min(edge.to), edge.from.max(edge.to)]);
            if edge.from > edge.to {
                places.reverse();
            }
            Some(chain(places.into_iter().map(|t| place(edge, t))))
        }
        Curve::Circle { frame, .. } if frame.z.xy().norm() <= UPRIGHT => Some(circle(edge, frame)),
        _ => None,
    };
    match exact {
        Some(vertices) => Ok(PlanEdge { vertices, deviation_mm: 0.0 }),
        None => arcs_of(edge, tolerance_mm, budget),
    }
}

/// The edge in the other direction.
pub fn reversed(edge: &PlanEdge) -> PlanEdge {
    PlanEdge { vertices: bulge::reversed(&edge.vertices, false), deviation_mm: edge.deviation_mm }
}

fn place(edge: &Edge, t: f64) -> [f64; 2] {
    let point = edge.curve.point(t);
    // Minus zero becomes zero.
    [point.x + 0.0, point.y + 0.0]
}

fn chain(places: impl IntoIterator<Item = [f64; 2]>) -> Vec<[f64; 3]> {
    places.into_iter().map(|[x, y]| [x, y, 0.0]).collect()
}

/// An arc, in parts of at most half a turn.
fn circle(edge: &Edge, frame: &Frame) -> Vec<[f64; 3]> {
    // The turn counts from x to y of the frame, which may be seen from below or mirrored.
    let side = frame.x.xy().perp(&frame.y.xy()).signum();
    let turn = (edge.to - edge.from).clamp(-TAU, TAU);
    let n = if turn.abs() > PI { 2 } else { 1 };
    let part = turn / f64::from(n);
    let bulge = if part.abs() == PI { part.signum() } else { (0.25 * part).tan() };
    let end = edge.from + turn;
    let mut vertices: Vec<[f64; 3]> = (0..n)
        .map(|k| {
            let [x, y] = place(edge, edge.from + part * f64::from(k));
            [x, y, side * bulge]
        })
        .collect();
    // A whole turn ends where it begins, to the last digit.
    let [x, y] = if turn.abs() == TAU { [vertices[0][0], vertices[0][1]] } else { place(edge, end) };
    vertices.push([x, y, 0.0]);
    vertices
}

fn arcs_of(edge: &Edge, tolerance_mm: f64, budget: &Budget) -> Result<PlanEdge, NoPlan> {
    let mut found = PlanEdge { vertices: Vec::new(), deviation_mm: 0.0 };
    for range in ranges(edge) {
        let curve = nurbs(&edge.curve, range).curve();
        let curve = curve.map_err(|_| NoPlan::Reason("its curve cannot be divided into arcs"))?;
        let arcs = arcs::of_curve(&curve, tolerance_mm, MOST_ARCS, budget)?;
        let arcs = arcs.ok_or(NoPlan::Reason("its curve needs more than 100000 arcs"))?;
        found.deviation_mm = found.deviation_mm.max(arcs.deviation_mm);
        found.vertices.pop();
        found.vertices.extend(arcs.vertices);
    }
    Ok(if edge.from > edge.to { reversed(&found) } else { found })
}

/// The range of an edge with growing parameters, divided where a closed spline begins again.
fn ranges(edge: &Edge) -> Vec<[f64; 2]> {
    let [from, to] = [edge.from.min(edge.to), edge.from.max(edge.to)];
    let (Some([start, end]), Some(period)) = (edge.curve.domain(), edge.curve.period()) else {
        return vec![[from, to]];
    };
    // The part from the start of the domain on; an edge goes round once at most.
    let turn = ((from - start) / period + nurbs_form::SNAP).floor() * period;
    let [from, to] = [(from - turn).max(start), (to - turn).min(end + period)];
    if to <= end + nurbs_form::SNAP * period {
        return vec![[from, to.min(end)]];
    }
    vec![[from, end], [start, to - period]]
}

/// A part of a curve in plan as a rational B-spline.
fn nurbs(curve: &Curve, range: [f64; 2]) -> Nurbs {
    let (degree, knots, points) = nurbs_form::curve(curve, range);
    let weights: Vec<f64> = points.iter().map(|point| point.w).collect();
    let is_rational = weights.iter().any(|weight| *weight != 1.0);
    let control_points =
        points.iter().map(|point| Point2::from(Vector2::new(point.x, point.y) / point.w)).collect();
    Nurbs { degree, knots, control_points, weights: is_rational.then_some(weights) }
}

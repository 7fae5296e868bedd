//! The path of the ball's centre, cut into pieces.

use nalgebra::{Point3, Vector3};

use crate::geometry::curve::{Arc, Curve, Line};
use crate::geometry::surface::patch::Bounds;

/// Arcs of a piece turn by no more than this, so that beyond an end means nearer to that end.
const LARGEST_SWEEP: f64 = std::f64::consts::FRAC_PI_2;

/// Pieces of one curve; a longer curve has longer pieces.
const PIECE_LIMIT: f64 = 1e5;

/// A line or a plane arc of the centre's path.
#[derive(Debug, Clone, Copy)]
pub(super) struct Piece {
    pub(super) curve: Curve,
    /// How far the true path may leave the curve, mm.
    pub(super) slack: f64,
}

/// The centre's path while the tip follows `tip`, `rise` mm below it, in pieces of at most `length` mm. A helix becomes chords of a
/// height of at most `chord_height` mm, which adds to the slack.
pub(super) fn pieces(
    tip: &Curve,
    rise: f64,
    length: f64,
    slack: f64,
    chord_height: f64,
) -> impl Iterator<Item = Piece> {
    let center = raised(tip, rise);
    let by_length = (center.length() / length).ceil();
    let (count, slack, is_helix) = match &center {
        Curve::Line(_) => (by_length, slack, false),
        Curve::Arc(arc) if arc.rise() == 0.0 => {
            (by_length.max((arc.sweep() / LARGEST_SWEEP).ceil()), slack, false)
        }
        Curve::Arc(arc) => {
            let chord_angle = (8.0 * chord_height / arc.radius()).sqrt().min(LARGEST_SWEEP);
            let count = (arc.sweep() / chord_angle).ceil().clamp(1.0, PIECE_LIMIT);
            // A chord and its arc, both rising evenly, part by no more than the arc's height at equal
            // fractions of the sweep, which exceeds the least distance.
            let angle = arc.sweep() / count;
            (count, slack + arc.radius() * (0.25 * angle * angle).min(2.0), true)
        }
    };
    let count = count.clamp(1.0, PIECE_LIMIT) as usize;
    (0..count).map(move |k| {
        let at = |k: usize| k as f64 / count as f64;
        let curve = match &center {
            Curve::Line(line) => {
                Curve::Line(Line { start: line.point_at(at(k)), end: line.point_at(at(k + 1)) })
            }
            Curve::Arc(arc) if is_helix => {
                Curve::Line(Line { start: arc.point_at(at(k)), end: arc.point_at(at(k + 1)) })
            }
            Curve::Arc(arc) => Curve::Arc(arc.part(at(k), at(k + 1))),
        };
        Piece { curve, slack }
    })
}

fn raised(curve: &Curve, by: f64) -> Curve {
    let up = Vector3::new(0.0, 0.0, by);
    match curve {
        Curve::Line(line) => Curve::Line(Line { start: line.start + up, end: line.end + up }),
        Curve::Arc(arc) => Curve::Arc(arc.translated(&up)),
    }
}

impl Piece {
    pub(super) fn length(&self) -> f64 {
        self.curve.length()
    }

    pub(super) fn halves(&self) -> [Piece; 2] {
        let part = |from: f64, to: f64| match &self.curve {
            Curve::Line(line) => Curve::Line(Line { start: line.point_at(from), end: line.point_at(to) }),
            Curve::Arc(arc) => Curve::Arc(arc.part(from, to)),
        };
        [part(0.0, 0.5), part(0.5, 1.0)].map(|curve| Piece { curve, slack: self.slack })
    }

    /// The largest coordinate along `direction` over the curve.
    pub(super) fn support(&self, direction: &Vector3<f64>) -> f64 {
        self.curve.support(direction)
    }

    /// A point of the curve at or near the least distance from `p`.
    pub(super) fn nearest(&self, p: &Vector3<f64>) -> Vector3<f64> {
        match &self.curve {
            Curve::Line(line) => {
                let along = line.end - line.start;
                let squared = along.norm_squared();
                let t = if squared > 0.0 { (p - line.start.coords).dot(&along) / squared } else { 0.0 };
                line.point_at(t.clamp(0.0, 1.0)).coords
            }
            Curve::Arc(arc) => nearest_on_arc(arc, p),
        }
    }

    /// Distance of `p` from the axis ray over `nearest`, or over an end of the piece if that is less; never
    /// below the distance to the swept set.
    pub(super) fn axis_distance(&self, p: &Vector3<f64>, nearest: &Vector3<f64>) -> f64 {
        [*nearest, self.curve.start().coords, self.curve.end().coords]
            .iter()
            .map(|c| {
                let mut d = p - c;
                d.z = d.z.min(0.0);
                d.norm()
            })
            .fold(f64::INFINITY, f64::min)
    }

    /// A box that holds every surface point the cutter of `radius` mm may touch.
    pub(super) fn reach(&self, radius: f64) -> Bounds {
        let reach = radius + self.slack;
        let mut bounds = Bounds { min: Vector3::zeros(), max: Vector3::zeros() };
        for c in 0..3 {
            let unit = Vector3::ith(c, 1.0);
            bounds.max[c] = self.support(&unit) + reach;
            bounds.min[c] = -self.support(&-unit) - reach;
        }
        bounds.max.z = f64::INFINITY;
        bounds
    }

    /// The largest absolute coordinate that bounds for the piece are computed from.
    pub(super) fn magnitude(&self) -> f64 {
        let ends = self.curve.start().coords.amax().max(self.curve.end().coords.amax());
        match &self.curve {
            Curve::Line(_) => ends,
            Curve::Arc(arc) => ends + arc.radius(),
        }
    }
}

fn nearest_on_arc(arc: &Arc, p: &Vector3<f64>) -> Vector3<f64> {
    let plane = arc.plane();
    let center = plane.to_local(&arc.center());
    let d = plane.to_local(&Point3::from(*p)) - center;
    let distance = d.xy().norm();
    if distance > 0.0 && arc.fraction_of_angle(d.y.atan2(d.x)).is_some() {
        let mut local = center;
        local.x += d.x * (arc.radius() / distance);
        local.y += d.y * (arc.radius() / distance);
        return plane.to_workpiece(&local).coords;
    }
    let (start, end) = (arc.start().coords, arc.end().coords);
    if (p - start).norm_squared() <= (p - end).norm_squared() { start } else { end }
}

//! The path of the point C of the cutter (defined in `solid`), cut into pieces: lines, and arcs of at most a
//! quarter turn.

use nalgebra::{Point3, Vector3};

use super::solid::Solid;
use crate::geometry::curve::{Arc, Curve, Line};
use crate::geometry::surface::patch::Bounds;

/// Largest sweep of an arc piece, radians. Up to this sweep, the nearest point for a place beyond an end of
/// the arc is that end.
const LARGEST_SWEEP: f64 = std::f64::consts::FRAC_PI_2;

/// Steps in the search for the place of the track at which a disc is nearest to a point.
const DISC_STEPS: usize = 2;

/// Largest number of pieces of one curve. A longer curve has longer pieces.
const PIECE_LIMIT: f64 = 1e5;

/// The curves for which bounds exist: a line, or an arc in its plane.
#[derive(Debug, Clone, Copy)]
pub(in crate::machining) enum PieceCurve {
    Line(Line),
    Arc(Arc),
}

/// A part of the centre's path.
#[derive(Debug, Clone, Copy)]
pub(in crate::machining) struct PathPiece {
    pub(in crate::machining) track: PieceCurve,
    /// How far the true path may leave the track, mm.
    pub(in crate::machining) slack: f64,
}

/// The path of the corner circle's centre, `rise` mm above the tip, while the tip follows `tip`. It is cut
/// into pieces of at most `length` mm. A helix or a parabola becomes chords with a height of about
/// `chord_height` mm. The distance of the chords from the curve is added to the slack.
pub(in crate::machining) fn pieces(
    tip: &Curve,
    rise: f64,
    length: f64,
    slack: f64,
    chord_height: f64,
) -> impl Iterator<Item = PathPiece> {
    let center = raised(tip, rise);
    let by_length = (center.length() / length).ceil();
    let limited = |count: f64| count.clamp(1.0, PIECE_LIMIT);
    let (count, slack) = match &center {
        Curve::Line(_) => (limited(by_length), slack),
        Curve::Arc(arc) if arc.rise() == 0.0 => {
            (limited(by_length.max((arc.sweep() / LARGEST_SWEEP).ceil())), slack)
        }
        Curve::Arc(arc) => {
            let chord_angle = (8.0 * chord_height / arc.radius()).sqrt().min(LARGEST_SWEEP);
            let count = limited((arc.sweep() / chord_angle).ceil());
            // At equal fractions of the sweep a helix and its chord are at the same height, and apart by no
            // more than this. Their least distance is no larger.
            let angle = arc.sweep() / count;
            (count, slack + arc.radius() * (0.25 * angle * angle).min(2.0))
        }
        Curve::Parabola(parabola) => {
            // At equal parameters one chord leaves the curve by `height`, and n chords leave it by
            // `height / n^2`.
            let height = parabola.bend().norm() / 4.0;
            let count = limited(by_length.max((height / chord_height).sqrt().ceil()));
            (count, slack + height / (count * count))
        }
    };
    (0..count as usize).map(move |k| {
        let [from, to] = [k, k + 1].map(|k| k as f64 / count);
        let chord = |at: &dyn Fn(f64) -> Point3<f64>| PieceCurve::Line(Line { start: at(from), end: at(to) });
        let track = match &center {
            Curve::Line(line) => chord(&|t| line.point_at(t)),
            Curve::Arc(arc) if arc.rise() == 0.0 => PieceCurve::Arc(arc.part(from, to)),
            Curve::Arc(arc) => chord(&|t| arc.point_at(t)),
            Curve::Parabola(parabola) => chord(&|t| parabola.at(t)),
        };
        PathPiece { track, slack }
    })
}

fn raised(curve: &Curve, by: f64) -> Curve {
    let up = Vector3::new(0.0, 0.0, by);
    match curve {
        Curve::Line(line) => Curve::Line(Line { start: line.start + up, end: line.end + up }),
        Curve::Arc(arc) => Curve::Arc(arc.translated(&up)),
        Curve::Parabola(parabola) => Curve::Parabola(parabola.translated(&up)),
    }
}

impl PieceCurve {
    pub(in crate::machining) fn start(&self) -> Vector3<f64> {
        match self {
            PieceCurve::Line(line) => line.start.coords,
            PieceCurve::Arc(arc) => arc.start().coords,
        }
    }

    pub(in crate::machining) fn end(&self) -> Vector3<f64> {
        match self {
            PieceCurve::Line(line) => line.end.coords,
            PieceCurve::Arc(arc) => arc.end().coords,
        }
    }

    /// The point at a fraction of the length.
    pub(in crate::machining) fn point_at(&self, t: f64) -> Vector3<f64> {
        match self {
            PieceCurve::Line(line) => line.point_at(t).coords,
            PieceCurve::Arc(arc) => arc.point_at(t).coords,
        }
    }
}

impl PathPiece {
    pub(in crate::machining) fn length(&self) -> f64 {
        match &self.track {
            PieceCurve::Line(line) => line.length(),
            PieceCurve::Arc(arc) => arc.length(),
        }
    }

    pub(in crate::machining) fn halves(&self) -> [PathPiece; 2] {
        let part = |from: f64, to: f64| match &self.track {
            PieceCurve::Line(line) => {
                PieceCurve::Line(Line { start: line.point_at(from), end: line.point_at(to) })
            }
            PieceCurve::Arc(arc) => PieceCurve::Arc(arc.part(from, to)),
        };
        [part(0.0, 0.5), part(0.5, 1.0)].map(|track| PathPiece { track, slack: self.slack })
    }

    /// The largest coordinate along `direction` over the track.
    pub(in crate::machining) fn support(&self, direction: &Vector3<f64>) -> f64 {
        match &self.track {
            PieceCurve::Line(line) => line.support(direction),
            PieceCurve::Arc(arc) => arc.support(direction),
        }
    }

    /// A point of the track. A level disc of radius `flat` mm about that point is at or near its least
    /// distance from `p`.
    pub(in crate::machining) fn nearest(&self, p: &Vector3<f64>, flat: f64) -> Vector3<f64> {
        let mut nearest = self.nearest_point(p);
        if flat > 0.0 {
            for _ in 0..DISC_STEPS {
                let off = (p - nearest).xy();
                let on_disc = off * (flat / off.norm().max(flat));
                // A point above the disc is beside the shank: its distance is measured in plan.
                let level = p.z.min(nearest.z);
                nearest = self.nearest_point(&Vector3::new(p.x - on_disc.x, p.y - on_disc.y, level));
            }
        }
        nearest
    }

    fn nearest_point(&self, p: &Vector3<f64>) -> Vector3<f64> {
        match &self.track {
            PieceCurve::Line(line) => {
                let along = line.end - line.start;
                let squared = along.norm_squared();
                let t = if squared > 0.0 { (p - line.start.coords).dot(&along) / squared } else { 0.0 };
                line.point_at(t.clamp(0.0, 1.0)).coords
            }
            PieceCurve::Arc(arc) => nearest_on_arc(arc, p),
        }
    }

    /// The largest depth of `p` in the cutter at `nearest` and at the ends of the piece, mm.
    pub(in crate::machining) fn depth(&self, solid: &Solid, p: &Vector3<f64>, nearest: &Vector3<f64>) -> f64 {
        let at = [*nearest, self.track.start(), self.track.end()];
        at.iter().map(|c| solid.depth(&(p - c))).fold(f64::NEG_INFINITY, f64::max)
    }

    /// The extent of the track along `m`, mm.
    pub(in crate::machining) fn spread(&self, m: &Vector3<f64>) -> f64 {
        self.support(m) + self.support(&-m)
    }

    /// A box that holds every surface point the cutter may touch.
    pub(in crate::machining) fn reach(&self, solid: &Solid) -> Bounds {
        let mut bounds = Bounds { min: Vector3::zeros(), max: Vector3::zeros() };
        for c in 0..3 {
            let unit = Vector3::ith(c, 1.0);
            let reach = self.slack + if c == 2 { solid.corner } else { solid.radius() };
            bounds.max[c] = self.support(&unit) + reach;
            bounds.min[c] = -self.support(&-unit) - reach;
        }
        bounds.max.z = f64::INFINITY;
        bounds
    }

    /// The largest absolute coordinate that bounds for the piece are computed from.
    pub(in crate::machining) fn magnitude(&self) -> f64 {
        let ends = self.track.start().amax().max(self.track.end().amax());
        match &self.track {
            PieceCurve::Line(_) => ends,
            PieceCurve::Arc(arc) => ends + arc.radius(),
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

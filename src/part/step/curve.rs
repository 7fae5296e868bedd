//! Curves in space: their points, and the parameter of a point.
//!
//! # Guarantees
//! Every curve is unbounded, or closed with a period, or has a domain. A parameter outside the domain of a
//! closed curve is taken round; outside the domain of an open one it is taken to the nearer end.

use std::f64::consts::TAU;

use nalgebra::{Point3, Vector3};

use super::frame::{Frame, Placement};
use super::spline_curve::SplineCurve;

/// Steps of Newton's method for the nearest parameter. It squares the error at each, from 1e-2 of a span.
const NEWTON_STEPS: usize = 30;

/// A curve. Angles and the parameters of splines are as in the file; lines and polylines count mm and
/// segments.
#[derive(Debug, Clone, PartialEq)]
pub enum Curve {
    /// `origin + t along`, with `along` of unit length.
    Line {
        origin: Point3<f64>,
        along: Vector3<f64>,
    },
    /// `origin + radius (cos t x + sin t y)`.
    Circle {
        frame: Frame,
        radius_mm: f64,
    },
    /// `origin + a cos t x + b sin t y`.
    Ellipse {
        frame: Frame,
        semi_axes_mm: [f64; 2],
    },
    /// `origin + a cosh t x + b sinh t y`.
    Hyperbola {
        frame: Frame,
        semi_axes_mm: [f64; 2],
    },
    /// `origin + f t^2 x + 2 f t y`.
    Parabola {
        frame: Frame,
        focal_mm: f64,
    },
    Spline(SplineCurve),
    /// At least 2 points, mm; `t` counts segments.
    Polyline(Vec<Point3<f64>>),
}

impl Curve {
    /// The point (mm) and the derivative (mm per unit of parameter).
    pub fn jet(&self, t: f64) -> (Point3<f64>, Vector3<f64>) {
        let planar = |frame: &Frame, [x, y]: [f64; 2], [dx, dy]: [f64; 2]| {
            (frame.origin + frame.x * x + frame.y * y, frame.x * dx + frame.y * dy)
        };
        match self {
            Self::Line { origin, along } => (origin + along * t, *along),
            Self::Circle { frame, radius_mm: r } => {
                let (sin, cos) = t.sin_cos();
                planar(frame, [r * cos, r * sin], [-r * sin, r * cos])
            }
            Self::Ellipse { frame, semi_axes_mm: [a, b] } => {
                let (sin, cos) = t.sin_cos();
                planar(frame, [a * cos, b * sin], [-a * sin, b * cos])
            }
            Self::Hyperbola { frame, semi_axes_mm: [a, b] } => {
                planar(frame, [a * t.cosh(), b * t.sinh()], [a * t.sinh(), b * t.cosh()])
            }
            Self::Parabola { frame, focal_mm: f } => {
                planar(frame, [f * t * t, 2.0 * f * t], [2.0 * f * t, 2.0 * f])
            }
            Self::Spline(spline) => spline.jet(self.inside(t)),
            Self::Polyline(points) => {
                let t = self.inside(t);
                let k = (t.max(0.0) as usize).min(points.len() - 2);
                let along = points[k + 1] - points[k];
                (points[k] + along * (t - k as f64), along)
            }
        }
    }

    pub fn point(&self, t: f64) -> Point3<f64> {
        self.jet(t).0
    }

    /// The period of a closed curve.
    pub fn period(&self) -> Option<f64> {
        match self {
            Self::Circle { .. } | Self::Ellipse { .. } => Some(TAU),
            Self::Spline(spline) if spline.is_closed => {
                let [from, to] = spline.domain();
                Some(to - from)
            }
            Self::Polyline(points) if points.first() == points.last() => Some((points.len() - 1) as f64),
            _ => None,
        }
    }

    /// The first and the last parameter of a spline or polyline.
    pub fn domain(&self) -> Option<[f64; 2]> {
        match self {
            Self::Spline(spline) => Some(spline.domain()),
            Self::Polyline(points) => Some([0.0, (points.len() - 1) as f64]),
            _ => None,
        }
    }

    /// The parameter in the domain that stands for `t`.
    fn inside(&self, t: f64) -> f64 {
        let Some([from, to]) = self.domain() else { return t };
        if (from..=to).contains(&t) {
            return t;
        }
        match self.period() {
            Some(period) => from + (t - from).rem_euclid(period).min(period),
            None => t.clamp(from, to),
        }
    }

    /// Parameters within [from, to] where the curve is not smooth, with both ends, growing.
    pub fn breaks(&self, [from, to]: [f64; 2]) -> Vec<f64> {
        let all = match self {
            Self::Spline(spline) => spline.breaks(),
            Self::Polyline(points) => (0..points.len()).map(|k| k as f64).collect(),
            Self::Circle { .. } | Self::Ellipse { .. } => {
                let n = ((to - from) / (TAU / 8.0)).ceil().clamp(1.0, 64.0);
                (0..n as usize).map(|k| from + (to - from) * k as f64 / n).collect()
            }
            _ => Vec::new(),
        };
        let turns: Vec<f64> = match (self.period(), self.domain()) {
            (Some(period), Some([start, _])) => {
                let first = ((from - start) / period).floor();
                let last = ((to - start) / period).floor().min(first + 4.0);
                (0..=(last - first) as usize).map(|k| (first + k as f64) * period).collect()
            }
            _ => vec![0.0],
        };
        let mut breaks = vec![from];
        let shifted = turns.iter().flat_map(|turn| all.iter().map(move |t| t + turn));
        // A break beside an end would make a span without length.
        let least = 1e-12 * (to - from).max(to.abs());
        breaks.extend(shifted.filter(|t| *t > from + least && *t < to - least));
        breaks.push(to);
        breaks.dedup();
        breaks
    }

    /// The parameter of the curve's point nearest to `point`, in the domain or in one turn from 0.
    pub fn nearest(&self, point: &Point3<f64>) -> f64 {
        match self {
            Self::Line { origin, along } => (point - origin).dot(along),
            Self::Circle { frame, .. } => {
                let local = frame.local(point);
                local.y.atan2(local.x)
            }
            Self::Ellipse { frame, semi_axes_mm: [a, b] } => {
                let local = frame.local(point);
                self.newton(point, (local.y / b).atan2(local.x / a))
            }
            Self::Hyperbola { frame, semi_axes_mm: [_, b] } => (frame.local(point).y / b).asinh(),
            Self::Parabola { frame, focal_mm } => frame.local(point).y / (2.0 * focal_mm),
            Self::Spline(_) | Self::Polyline(_) => {
                self.nearest_of(|p| (p - point).norm_squared(), |t| self.newton(point, t))
            }
        }
    }

    /// The best of the parameters that `refine` makes from samples of a spline or polyline.
    pub fn nearest_of(&self, distance: impl Fn(&Point3<f64>) -> f64, refine: impl Fn(f64) -> f64) -> f64 {
        let domain = self.domain().unwrap_or([0.0, TAU]);
        let breaks = self.breaks(domain);
        let per_span = match self {
            Self::Spline(spline) => 2 * spline.degree + 2,
            _ => 8,
        };
        let mut samples: Vec<(f64, f64)> = breaks
            .windows(2)
            .flat_map(|pair| {
                let step = (pair[1] - pair[0]) / per_span as f64;
                (0..=per_span).map(move |k| pair[0] + step * k as f64)
            })
            .map(|t| (distance(&self.point(t)), t))
            .collect();
        samples.sort_by(|a, b| a.0.total_cmp(&b.0));
        let best = |t: &f64| distance(&self.point(*t));
        let starts = samples.iter().take(4).map(|(_, t)| *t);
        let refined = starts.flat_map(|t| [t, refine(t)]).filter(|t| t.is_finite());
        refined.min_by(|a, b| best(a).total_cmp(&best(b))).unwrap_or(domain[0])
    }

    /// The parameter near `start` where the direction to `point` is at right angles to the curve.
    fn newton(&self, point: &Point3<f64>, start: f64) -> f64 {
        let mut t = start;
        for _ in 0..NEWTON_STEPS {
            let (at, along) = self.jet(t);
            let step = (point - at).dot(&along) / along.norm_squared();
            if !step.is_finite() {
                return start;
            }
            let mut next = t + step;
            if let (Some([from, to]), None) = (self.domain(), self.period()) {
                next = next.clamp(from, to);
            }
            let is_done = (next - t).abs() <= 1e-15 * t.abs().max(1e-3);
            t = next;
            if is_done {
                break;
            }
        }
        match self.domain() {
            Some(_) => self.inside(t),
            None => t,
        }
    }

    /// The curve moved by a placement, with the same parameters.
    pub fn placed(&self, by: &Placement) -> Self {
        let mut placed = self.clone();
        match &mut placed {
            Self::Line { origin, along } => (*origin, *along) = (by.point(origin), by.vector(along)),
            Self::Circle { frame, .. }
            | Self::Ellipse { frame, .. }
            | Self::Hyperbola { frame, .. }
            | Self::Parabola { frame, .. } => *frame = by.frame(frame),
            Self::Spline(SplineCurve { control_points: points, .. }) | Self::Polyline(points) => {
                points.iter_mut().for_each(|point| *point = by.point(point));
            }
        }
        placed
    }
}

//! Bounds of the derivatives of curves.
//!
//! # Method
//! Conics have closed forms. The derivatives of a B-spline are within the control polygons of their Bezier
//! pieces (`bezier_bounds`).

use nalgebra::{Vector3, Vector4};

use super::bezier_bounds::{Net, derivatives};
use crate::step::basis;
use crate::step::curve::Curve;
use crate::step::spline_curve::SplineCurve;

/// Parts of a knot span, so that the bounds of a part hold for little more than itself.
const PARTS: usize = 4;

/// Spans of a curve from which on a span is not divided further.
const MANY_SPANS: usize = 256;

/// A jump of the first derivative below this part of its size is rounding.
const NO_JUMP: f64 = 1e-9;

/// Bounds of the first and second derivative between two parameters.
#[derive(Debug, Clone, Copy)]
struct Bounded {
    from: f64,
    to: f64,
    derivatives: [f64; 2],
}

/// Bounds of the derivatives of one curve.
#[derive(Debug, Clone)]
pub struct CurveBounds {
    form: Form,
    period: Option<f64>,
    /// Parameters where the first derivative jumps, with how far at most, growing.
    jumps: Vec<(f64, f64)>,
}

#[derive(Debug, Clone)]
enum Form {
    /// The same bounds everywhere.
    Even([f64; 2]),
    Hyperbola([f64; 2]),
    Parabola(f64),
    Spans(Vec<Bounded>),
}

impl CurveBounds {
    pub fn new(curve: &Curve) -> Self {
        let (form, jumps) = match curve {
            Curve::Line { .. } => (Form::Even([1.0, 0.0]), Vec::new()),
            Curve::Circle { radius_mm, .. } => (Form::Even([*radius_mm; 2]), Vec::new()),
            Curve::Ellipse { semi_axes_mm: [a, b], .. } => (Form::Even([a.max(*b); 2]), Vec::new()),
            Curve::Hyperbola { semi_axes_mm, .. } => (Form::Hyperbola(*semi_axes_mm), Vec::new()),
            Curve::Parabola { focal_mm, .. } => (Form::Parabola(*focal_mm), Vec::new()),
            Curve::Polyline(points) => {
                let sides: Vec<Vector3<f64>> = points.windows(2).map(|pair| pair[1] - pair[0]).collect();
                let spans = sides.iter().enumerate().map(|(k, side)| Bounded {
                    from: k as f64,
                    to: k as f64 + 1.0,
                    derivatives: [side.norm(), 0.0],
                });
                let jump = |k: usize| (sides[k] - sides[(k + sides.len() - 1) % sides.len()]).norm();
                let jumps = (0..sides.len()).map(|k| (k as f64, jump(k))).collect();
                (Form::Spans(spans.collect()), jumps)
            }
            Curve::Spline(spline) => of_spline(spline),
        };
        Self { form, period: curve.period(), jumps }
    }

    /// The most of the first and the second derivative between two parameters, apart from jumps.
    pub fn over(&self, range: [f64; 2]) -> [f64; 2] {
        let [from, to] = [range[0].min(range[1]), range[0].max(range[1])];
        let farthest = from.abs().max(to.abs());
        match &self.form {
            Form::Even(bounds) => *bounds,
            Form::Hyperbola([a, b]) => {
                let (sinh, cosh) = (farthest.sinh(), farthest.cosh());
                [(a * sinh).hypot(b * cosh), (a * cosh).hypot(b * sinh)]
            }
            Form::Parabola(f) => [2.0 * f * farthest.hypot(1.0), 2.0 * f],
            Form::Spans(spans) => {
                let mut most = [0.0_f64; 2];
                for [from, to] in self.turns([from, to], spans[0].from) {
                    let first = spans.partition_point(|span| span.to <= from).min(spans.len() - 1);
                    let touched = spans[first..].iter().enumerate();
                    for (_, span) in touched.take_while(|(k, span)| *k == 0 || span.from < to) {
                        most = [0, 1].map(|k| most[k].max(span.derivatives[k]));
                    }
                }
                most
            }
        }
    }

    /// The sum of the jumps of the first derivative strictly between two parameters.
    pub fn jumps(&self, [from, to]: [f64; 2]) -> f64 {
        self.kinks([from.min(to), from.max(to)]).map(|(_, jump)| jump).sum()
    }

    /// The jumps strictly between two parameters.
    pub fn kinks(&self, range: [f64; 2]) -> impl Iterator<Item = (f64, f64)> {
        let start = match &self.form {
            Form::Spans(spans) => spans[0].from,
            _ => 0.0,
        };
        let least = 1e-12 * (range[1] - range[0]).abs();
        let [low, high] = [range[0] + least, range[1] - least];
        let mut found = Vec::new();
        if !self.jumps.is_empty() {
            let first = self.period.map_or(0.0, |period| ((range[0] - start) / period).floor());
            for turn in 0..if self.period.is_some() { 3 } else { 1 } {
                let shift = self.period.unwrap_or(0.0) * (first + f64::from(turn));
                let begin = self.jumps.partition_point(|(t, _)| t + shift <= low);
                let within = self.jumps[begin..].iter().take_while(|(t, _)| t + shift < high);
                found.extend(within.map(|(t, jump)| (t + shift, *jump)));
            }
        }
        found.into_iter()
    }

    /// The parts of a range in the turn that begins at `start`.
    fn turns(&self, [from, to]: [f64; 2], start: f64) -> Vec<[f64; 2]> {
        let Some(period) = self.period else { return vec![[from, to]] };
        let end = start + period;
        if to - from >= period {
            return vec![[start, end]];
        }
        let shift = ((from - start) / period).floor() * period;
        let [from, to] = [from - shift, to - shift];
        if to <= end { vec![[from, to]] } else { vec![[from, end], [start, to - period]] }
    }
}

/// The spans and jumps of a B-spline.
fn of_spline(spline: &SplineCurve) -> (Form, Vec<(f64, f64)>) {
    let breaks = spline.breaks();
    let parts = if breaks.len() > MANY_SPANS { 1 } else { PARTS };
    let points = spline.homogeneous();
    let mut spans = Vec::new();
    let mut ends = Vec::new();
    for pair in breaks.windows(2) {
        let i = basis::span(spline.degree, &spline.knots, pair[0]);
        let local = i - spline.degree..=i;
        let knots = &spline.knots[i - spline.degree..=i + spline.degree + 1];
        let (_, whole) = basis::part(spline.degree, knots, &points[local.clone()], [pair[0], pair[1]]);
        ends.push((whole.clone(), pair[1] - pair[0]));
        for [from, to] in parted([pair[0], pair[1]], parts) {
            let (_, piece) = basis::part(spline.degree, knots, &points[local.clone()], [from, to]);
            let net: Net = piece.into_iter().map(|p| vec![p]).collect();
            spans.push(Bounded { from, to, derivatives: derivatives(&net, to - from) });
        }
    }
    let n = ends.len();
    let first = usize::from(!spline.is_closed);
    let jumps = (first..n).filter_map(|k| {
        let (before, after) = (&ends[(k + n - 1) % n], &ends[k]);
        let (left, right) = (slope(before, true), slope(after, false));
        let jump = (right - left).norm();
        (jump > NO_JUMP * left.norm()).then_some((breaks[k], jump))
    });
    let jumps = jumps.collect();
    (Form::Spans(spans), jumps)
}

/// Parts of equal length.
pub fn parted([from, to]: [f64; 2], n: usize) -> impl Iterator<Item = [f64; 2]> {
    let place = move |k: usize| if k == n { to } else { from + (to - from) * k as f64 / n as f64 };
    (0..n).map(move |k| [place(k), place(k + 1)])
}

/// The derivative at an end of a Bezier piece.
fn slope((points, length): &(Vec<Vector4<f64>>, f64), is_end: bool) -> Vector3<f64> {
    let n = points.len();
    let [a, b] = if is_end { [points[n - 2], points[n - 1]] } else { [points[0], points[1]] };
    let at = if is_end { b } else { a };
    let change = (b - a) * ((n - 1) as f64 / length);
    (change.xyz() - at.xyz() / at.w * change.w) / at.w
}

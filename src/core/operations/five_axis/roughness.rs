//! Tells noise of poses from the shape of a path: by the third derivative of a spline through the poses.
//!
//! # Method
//! The third derivative of a cubic spline is constant in each span. Where the poses lie on a smooth path, its
//! jumps from span to span go on in one direction. Noise and rounding make it jump to and fro: the product of
//! a jump and the next one is then negative.
//!
//! # Cost
//! O(n) for n spans.

use super::rail::{Fitted, Point6};

/// Spans of which at least this part jumps to and fro are rough. Random noise has 3. A wave has less than
/// nothing from five poses to each wave on, and a line that becomes an arc has 0.4.
const ROUGH: f64 = 0.6;

/// Poses have noise if the spline through them has more than this multiple of the integral of the squared
/// third derivative that a spline beside them needs. The time of a motion grows with the sixth root: 5 %.
pub const NOISE: f64 = 1.34;

/// Whether the third derivative of a spline through poses jumps to and fro.
pub fn is_rough(spans: &[Fitted]) -> bool {
    roughness(spans) > ROUGH
}

/// The part of the integral of the squared third derivative that jumps to and fro.
fn roughness(spans: &[Fitted]) -> f64 {
    let jump = |k: usize| third(&spans[k + 1].span) - third(&spans[k].span);
    let to_and_fro = (0..spans.len().saturating_sub(2))
        .map(|k| -jump(k).dot(&jump(k + 1)) * spans[k + 1].span.length())
        .sum::<f64>();
    let own: f64 = spans.iter().map(|fitted| third(&fitted.span).norm_squared() * fitted.span.length()).sum();
    to_and_fro / own
}

/// The integral of the squared third derivative of tip and top, 1/mm3 for a parameter in mm.
pub fn jerk(spans: &[Fitted]) -> f64 {
    spans.iter().map(|fitted| of_span(&fitted.span)).sum()
}

fn of_span(span: &super::rail::Span) -> f64 {
    // The square of a parabola by Simpson's rule over two halves: exact for the cubics of splines through
    // poses, and near enough for quintics.
    const WEIGHTS: [f64; 5] = [1.0, 4.0, 2.0, 4.0, 1.0];
    let at = |k: usize| span.from + span.length() * (k as f64 / 4.0);
    let sum: f64 = (0..5).map(|k| WEIGHTS[k] * span.jet(at(k))[3].norm_squared()).sum();
    sum * span.length() / 12.0
}

fn third(span: &super::rail::Span) -> Point6 {
    span.jet(0.5 * (span.from + span.to))[3]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::spline::{EndCondition, derivatives_over};
    use crate::operations::five_axis::rail::{Source, Span};

    fn through(points: &[Point6]) -> Vec<Fitted> {
        let steps = vec![1.0; points.len() - 1];
        let slopes = derivatives_over(&steps, points, EndCondition::NotAKnot);
        let span = |k: usize| {
            let range = [k as f64, k as f64 + 1.0];
            Span::cubic(range, [points[k], slopes[k]], [points[k + 1], slopes[k + 1]])
        };
        (0..steps.len()).map(|k| Fitted { span: span(k), source: Source::Leg(k) }).collect()
    }

    fn wave(per_wave: f64, noise: f64) -> Vec<Fitted> {
        let point = |k: usize| {
            let k = k as f64;
            let y = 10.0 * (std::f64::consts::TAU * k / per_wave).sin() + noise * (12.9898 * k * k).sin();
            Point6::new(k, y, 0.0, 0.0, 0.0, 50.0)
        };
        through(&(0..100).map(point).collect::<Vec<_>>())
    }

    #[test]
    fn a_smooth_wave_is_not_rough_and_noise_is() {
        for per_wave in [5.0, 8.0, 12.0, 20.0, 40.0, 200.0] {
            assert!(roughness(&wave(per_wave, 0.0)) < 0.0, "{per_wave}");
            assert!(is_rough(&wave(per_wave, 3.0)), "{per_wave}");
        }
        assert!(is_rough(&wave(200.0, 1e-4)) && is_rough(&wave(40.0, 1e-2)));
    }

    #[test]
    fn lines_beside_an_arc_are_not_rough() {
        for n in [3, 6, 25] {
            let point = |k: i32| {
                let turn = f64::from(k) / f64::from(n);
                let (sin, cos) = turn.clamp(0.0, 1.0).sin_cos();
                let beyond = turn - turn.clamp(0.0, 1.0);
                Point6::new(sin + beyond * cos, 1.0 - cos + beyond * sin, 0.0, 0.0, 0.0, 50.0)
            };
            assert!(!is_rough(&through(&(-n..=2 * n).map(point).collect::<Vec<_>>())), "{n}");
        }
    }

    #[test]
    fn the_jerk_of_a_cubic_is_the_square_of_its_third_derivative_times_its_length() {
        let zero = Point6::zeros();
        let cube = Span::bezier([0.0, 2.0], [zero, zero, zero, Point6::repeat(8.0)]);
        let spans = [Fitted { span: cube, source: Source::Leg(0) }];
        assert!((jerk(&spans) - 6.0 * 36.0 * 2.0).abs() < 1e-9);
    }
}

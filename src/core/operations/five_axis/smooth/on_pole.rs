//! Spans that meet on a pole of the machine.

use crate::operations::five_axis::rail::Span;

/// Two spans that meet, with a continuous third derivative there. On a pole, the free angle has one
/// derivative less than the axis.
pub fn smooth_thrice(before: &Span, after: &Span) -> [Span; 2] {
    let (start, end) = (before.jet(before.from), after.jet(after.to));
    let [at, first, ..] = after.jet(after.from);
    let (h, g) = (before.length(), after.length());
    // The third derivatives of the two quintics at the joint, without the second derivative there.
    let third_before = (at - start[0]) * (60.0 / h.powi(3))
        - (start[1] * 24.0 + first * 36.0) / (h * h)
        - start[2] * (3.0 / h);
    let third_after =
        (end[0] - at) * (60.0 / g.powi(3)) - (first * 36.0 + end[1] * 24.0) / (g * g) + end[2] * (3.0 / g);
    let second = (third_after - third_before) / (9.0 / h + 9.0 / g);
    [
        Span::quintic([before.from, before.to], [start[0], start[1], start[2]], [at, first, second]),
        Span::quintic([after.from, after.to], [at, first, second], [end[0], end[1], end[2]]),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::operations::five_axis::rail::join;
    use nalgebra::Vector3;

    #[test]
    fn on_a_pole_three_derivatives_are_continuous() {
        let point = |x: f64, y: f64| join(Vector3::new(x, y, y * y), Vector3::new(y, x, 50.0));
        let before =
            Span::cubic([0.0, 2.0], [point(0.0, 0.0), point(1.0, 3.0)], [point(2.0, 1.0), point(0.5, 0.2)]);
        let after =
            Span::cubic([2.0, 2.7], [point(2.0, 1.0), point(0.5, 0.2)], [point(3.0, 1.0), point(1.0, 1.0)]);
        let [one, other] = smooth_thrice(&before, &after);
        let (left, right) = (one.jet(2.0), other.jet(2.0));
        for order in 0..4 {
            assert!((left[order] - right[order]).norm() < 1e-9, "{order}");
        }
        assert!((left[1] - before.jet(2.0)[1]).norm() < 1e-12);
        for order in 0..3 {
            assert!((one.jet(0.0)[order] - before.jet(0.0)[order]).norm() < 1e-9);
            assert!((other.jet(2.7)[order] - after.jet(2.7)[order]).norm() < 1e-9);
        }
    }
}

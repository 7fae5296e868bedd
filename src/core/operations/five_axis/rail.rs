//! Rails: the tip and the axis of the tool as polynomials of one parameter.
//!
//! A span is a polynomial of degree 5 with six coordinates: the tip, and the vector from the tip to the top
//! of the tool, which is the axis times the distance of the top. The direction of this vector is the axis.
//! So one span is a pair of rails with shared knots, as in the paper.

use nalgebra::{SVector, Vector3};

/// The tip, mm, and then the vector from the tip to the top, mm.
pub type Point6 = SVector<f64, 6>;

/// The value and the first three derivatives by the parameter.
pub type Jet = [Point6; 4];

/// The number of control points of a span.
const ORDER: usize = 6;

pub fn tip(p: &Point6) -> Vector3<f64> {
    p.fixed_rows::<3>(0).into_owned()
}

/// The vector from the tip to the top.
pub fn top(p: &Point6) -> Vector3<f64> {
    p.fixed_rows::<3>(3).into_owned()
}

pub fn join(tip: Vector3<f64>, top: Vector3<f64>) -> Point6 {
    Point6::new(tip.x, tip.y, tip.z, top.x, top.y, top.z)
}

/// One polynomial, over a range of the parameter.
#[derive(Debug, Clone, PartialEq)]
pub struct Span {
    pub from: f64,
    pub to: f64,
    /// Bernstein coefficients.
    pub control: [Point6; ORDER],
}

impl Span {
    pub fn line(from: f64, to: f64, start: Point6, end: Point6) -> Self {
        let at = |k: usize| start + (end - start) * (k as f64 / (ORDER - 1) as f64);
        Self { from, to, control: std::array::from_fn(at) }
    }

    /// The cubic with these values and first derivatives at its ends.
    pub fn cubic([from, to]: [f64; 2], start: [Point6; 2], end: [Point6; 2]) -> Self {
        let third = (to - from) / 3.0;
        Self::bezier([from, to], [start[0], start[0] + start[1] * third, end[0] - end[1] * third, end[0]])
    }

    /// The cubic with these Bernstein coefficients.
    pub fn bezier([from, to]: [f64; 2], own: [Point6; 4]) -> Self {
        // Degree 3 becomes degree 5: each coefficient is a mean of the four.
        let rows: [[f64; 4]; ORDER] = [
            [1.0, 0.0, 0.0, 0.0],
            [0.4, 0.6, 0.0, 0.0],
            [0.1, 0.6, 0.3, 0.0],
            [0.0, 0.3, 0.6, 0.1],
            [0.0, 0.0, 0.6, 0.4],
            [0.0, 0.0, 0.0, 1.0],
        ];
        let mean =
            |k: usize| own.iter().zip(rows[k]).fold(Point6::zeros(), |sum, (p, share)| sum + p * share);
        Self { from, to, control: std::array::from_fn(mean) }
    }

    /// The quintic with these values and first two derivatives at its ends.
    pub fn quintic([from, to]: [f64; 2], start: [Point6; 3], end: [Point6; 3]) -> Self {
        let h = to - from;
        let [p, v, a] = start;
        let [q, w, b] = end;
        let control = [
            p,
            p + v * (h / 5.0),
            p + v * (2.0 * h / 5.0) + a * (h * h / 20.0),
            q - w * (2.0 * h / 5.0) + b * (h * h / 20.0),
            q - w * (h / 5.0),
            q,
        ];
        Self { from, to, control }
    }

    pub fn length(&self) -> f64 {
        self.to - self.from
    }

    pub fn start(&self) -> Point6 {
        self.control[0]
    }

    pub fn end(&self) -> Point6 {
        self.control[ORDER - 1]
    }

    /// The value and the derivatives at a parameter.
    pub fn jet(&self, u: f64) -> Jet {
        let h = self.length();
        let t = ((u - self.from) / h).clamp(0.0, 1.0);
        // De Casteljau's triangle: the last rows hold the derivatives.
        let mut points = self.control;
        let mut rows = [[Point6::zeros(); 4]; 3];
        for left in (1..ORDER).rev() {
            if left <= 3 {
                rows[left - 1][..=left].copy_from_slice(&points[..=left]);
            }
            for k in 0..left {
                points[k] += (points[k + 1] - points[k]) * t;
            }
        }
        let [one, two, three] = rows;
        [
            points[0],
            (one[1] - one[0]) * (5.0 / h),
            (two[2] - two[1] * 2.0 + two[0]) * (20.0 / (h * h)),
            (three[3] - three[2] * 3.0 + three[1] * 3.0 - three[0]) * (60.0 / (h * h * h)),
        ]
    }

    /// The Taylor coefficients at a parameter: the derivative of order k divided by k!.
    pub fn taylor(&self, u: f64) -> [Point6; ORDER] {
        /// The binomial coefficients "k of 5".
        const OF_FIVE: [f64; ORDER] = [1.0, 5.0, 10.0, 10.0, 5.0, 1.0];
        let h = self.length();
        let t = ((u - self.from) / h).clamp(0.0, 1.0);
        // De Casteljau's triangle: the differences of order k of its row of k + 1 points.
        let mut points = self.control;
        let mut all = [Point6::zeros(); ORDER];
        for order in (0..ORDER).rev() {
            let mut row = points;
            for left in (0..order).rev() {
                for k in 0..=left {
                    row[k] = row[k + 1] - row[k];
                }
            }
            all[order] = row[0] * (OF_FIVE[order] / h.powi(order as i32));
            for k in 0..order {
                points[k] += (points[k + 1] - points[k]) * t;
            }
        }
        all
    }

    /// The two halves.
    pub fn halves(&self) -> [Self; 2] {
        self.split(0.5 * (self.from + self.to))
    }

    /// The parts before and after a parameter inside.
    pub fn split(&self, u: f64) -> [Self; 2] {
        let t = ((u - self.from) / self.length()).clamp(0.0, 1.0);
        let mut points = self.control;
        let (mut before, mut after) = (self.control, self.control);
        for left in (1..ORDER).rev() {
            for k in 0..left {
                points[k] += (points[k + 1] - points[k]) * t;
            }
            before[ORDER - left] = points[0];
            after[left - 1] = points[left - 1];
        }
        [Self { from: self.from, to: u, control: before }, Self { from: u, to: self.to, control: after }]
    }

    /// The same polynomial over another range of the same length.
    #[must_use]
    pub fn moved_to(&self, from: f64) -> Self {
        Self { from, to: from + self.length(), control: self.control }
    }
}

/// What a span replaces.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Source {
    /// A leg, or a part of it.
    Leg(usize),
    /// The corner at the start of this leg.
    Corner(usize),
    /// Parts of several legs, from the first to the last.
    Run([usize; 2]),
}

impl Source {
    /// The first and the last leg.
    pub fn legs(self) -> [usize; 2] {
        match self {
            Self::Leg(k) => [k, k],
            Self::Corner(k) => [k - 1, k],
            Self::Run(ends) => ends,
        }
    }

    /// The same in a path that has `count` legs before.
    #[must_use]
    pub fn after(self, count: usize) -> Self {
        match self {
            Self::Leg(k) => Self::Leg(k + count),
            Self::Corner(k) => Self::Corner(k + count),
            Self::Run(ends) => Self::Run(ends.map(|k| k + count)),
        }
    }
}

/// A span with what it replaces.
#[derive(Debug, Clone)]
pub struct Fitted {
    pub span: Span,
    pub source: Source,
}

/// Spans between two stops of the motion. Inside a piece the derivatives up to the second are continuous.
#[derive(Debug, Clone, Default)]
pub struct Piece {
    pub spans: Vec<Span>,
    /// What each span replaces.
    pub sources: Vec<Source>,
    /// The feed along each span, mm/s.
    pub feeds: Vec<f64>,
    pub is_rapid: bool,
}

impl Piece {
    pub fn new(fitted: impl IntoIterator<Item = Fitted>) -> Self {
        let (spans, sources) = fitted.into_iter().map(|Fitted { span, source }| (span, source)).unzip();
        Self { spans, sources, feeds: Vec::new(), is_rapid: false }
    }

    /// Whether the tip rests while the axis turns.
    pub fn rests(&self) -> bool {
        self.spans.iter().all(|span| tip(&span.start()) == tip(&span.end()))
    }

    /// The index of the span at a parameter. At a joint it is the span before.
    pub fn index_at(&self, u: f64) -> usize {
        self.spans.partition_point(|span| span.to < u).min(self.spans.len() - 1)
    }
}

/// Pieces one after the other. The parameter goes on from piece to piece.
#[derive(Debug, Clone, Default)]
pub struct Rail {
    pub pieces: Vec<Piece>,
}

impl Rail {
    pub fn spans(&self) -> impl Iterator<Item = &Span> {
        self.pieces.iter().flat_map(|piece| &piece.spans)
    }

    /// Lets the parameter run on from span to span.
    pub fn number(&mut self) {
        let mut from = 0.0;
        for span in self.pieces.iter_mut().flat_map(|piece| &mut piece.spans) {
            *span = span.moved_to(from);
            from = span.to;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn point(k: f64) -> Point6 {
        Point6::new(k, (1.3 * k).sin(), k * k, (0.7 * k).cos(), 0.2 * k, 50.0)
    }

    fn assert_near(a: Point6, b: Point6, within: f64) {
        assert!((a - b).norm() < within, "{a} {b}");
    }

    #[test]
    fn a_quintic_has_the_values_and_derivatives_it_was_given() {
        let (start, end) = ([point(0.0), point(1.0), point(2.0)], [point(3.0), point(4.0), point(5.0)]);
        let span = Span::quintic([2.0, 5.0], start, end);
        for k in 0..3 {
            assert_near(span.jet(2.0)[k], start[k], 1e-12);
            assert_near(span.jet(5.0)[k], end[k], 1e-12);
        }
    }

    #[test]
    fn a_cubic_has_the_values_and_slopes_it_was_given_and_a_constant_third_derivative() {
        let (start, end) = ([point(0.0), point(1.0)], [point(3.0), point(4.0)]);
        let span = Span::cubic([1.0, 3.0], start, end);
        for k in 0..2 {
            assert_near(span.jet(1.0)[k], start[k], 1e-12);
            assert_near(span.jet(3.0)[k], end[k], 1e-12);
        }
        assert_near(span.jet(1.0)[3], span.jet(2.7)[3], 1e-9);
    }

    #[test]
    fn derivatives_equal_differences() {
        let span = Span::quintic([0.0, 2.0], [point(0.0), point(1.0), point(2.0)], [point(3.0); 3]);
        let step = 1e-5;
        for u in [0.3, 1.0, 1.9] {
            let (before, at, after) = (span.jet(u - step), span.jet(u), span.jet(u + step));
            for k in 0..3 {
                assert_near((after[k] - before[k]) / (2.0 * step), at[k + 1], 1e-6);
            }
        }
    }

    #[test]
    fn taylor_coefficients_are_derivatives_by_factorials_and_give_the_values() {
        let span = Span::quintic([1.0, 3.0], [point(0.0), point(1.0), point(2.0)], [point(3.0); 3]);
        for u in [1.0, 1.7, 3.0] {
            let (about, jet) = (span.taylor(u), span.jet(u));
            for (k, factorial) in [1.0, 1.0, 2.0, 6.0].into_iter().enumerate() {
                assert_near(about[k] * factorial, jet[k], 1e-9);
            }
            let value = about.iter().rev().fold(Point6::zeros(), |sum, c| sum * (2.1 - u) + c);
            assert_near(value, span.jet(2.1)[0], 1e-9);
        }
    }

    #[test]
    fn parts_are_the_same_polynomial() {
        let span = Span::quintic([0.0, 2.0], [point(0.0), point(1.0), point(2.0)], [point(3.0); 3]);
        for (part, at) in span.split(0.7).iter().zip([0.4, 1.5]) {
            for k in 0..4 {
                assert_near(part.jet(at)[k], span.jet(at)[k], 1e-9);
            }
        }
    }
}

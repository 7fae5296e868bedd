//! The spline of least jerk whose distance from fit points is limited.
//!
//! # Method
//! Minimize the integral of the squared third derivative of a B-spline over control points c, such that each
//! value N c is in a ball about its fit point. The alternating direction method of multipliers divides this
//! into a banded linear system for c, whose matrix is factored once, and projections into balls. Tip and top
//! are independent of each other and share the matrix. Both are scaled so that their balls have the radius 1.
//!
//! Of a hundred fit points to a span or more, some are enough: those that the spline then misses join them,
//! until it misses none.
//!
//! # Cost
//! O(n) for n fit points that count in each iteration.
//!
//! # Reference
//! S. Boyd et al., *Distributed Optimization and Statistical Learning via the Alternating Direction Method of
//! Multipliers*, 2011, sections 3 and 5.

use nalgebra::SMatrix;

use crate::budget::{Budget, Stopped};
use crate::geometry::bspline;
use crate::operations::five_axis::banded_matrix::BandedMatrix;
use crate::operations::five_axis::rail::{Point6, Span};

const DEGREE: usize = 5;

/// Control points that matter for one value.
const WIDTH: usize = DEGREE + 1;

/// Iterations, and the first weight of the distances. Every few iterations the weight follows the residuals.
const ITERATIONS: usize = 200;
const FIRST_WEIGHT: f64 = 1e3;
const BETWEEN_WEIGHTS: usize = 15;

/// The weight follows if one residual is more than `UNBALANCED` times the other. It then changes by the
/// factor `WEIGHT_STEP`, as Boyd et al. do in section 3.4.1 with 10 and 2.
const UNBALANCED: f64 = 5.0;
const WEIGHT_STEP: f64 = 4.0;

/// Ends the iterations: values and their projections differ by less, as a part of the radius.
const NEAR: f64 = 2e-3;

/// A search is given up if, after `HOPEFUL` iterations, a value is still `HOPELESS` radii away from its ball.
const HOPEFUL: usize = 40;
const HOPELESS: f64 = 1.5;

/// Over-relaxation: Boyd et al. recommend 1.5 to 1.8 (section 3.4.3).
const RELAXATION: f64 = 1.6;

/// The weight of the ends, which are then replaced by the exact ones.
const END_WEIGHT: f64 = 1e7;

/// A place that the spline has to be near to.
#[derive(Debug, Clone, Copy)]
pub struct FitPoint {
    pub u: f64,
    pub at: Point6,
}

pub struct Problem<'a> {
    /// Distinct knots.
    pub knots: &'a [f64],
    pub fit_points: Vec<FitPoint>,
    pub ends: [Point6; 2],
    /// The largest distance of the tip and of the top, mm.
    pub radii: [f64; 2],
}

/// The six control points of a B-spline that matter for a span, as a matrix that gives its Bernstein points.
type Extraction = SMatrix<f64, 6, 6>;

/// The values of the basis at a fit point.
struct Row {
    first: usize,
    basis: [f64; WIDTH],
}

/// Fit points of a span: so many are enough to begin with, evenly spaced.
const ENOUGH: usize = 48;

/// Rounds in which the worst of all others join them, and the parts of a span of which each gives one.
const JOINING: usize = 12;
const PARTS: usize = 8;

/// A fit point joins if its distance is above this multiple of the radius.
const MISSED: f64 = 1.005;

impl Problem<'_> {
    /// The spline as by [`Problem::solve`]. Of many fit points, only those are searched with that the spline
    /// might miss.
    pub fn solve_with_few(&self, budget: &Budget) -> Result<Option<Vec<Span>>, Stopped> {
        let count = self.fit_points.len();
        if count <= 2 * ENOUGH * (self.knots.len() - 1) {
            return self.solve(budget);
        }
        let spans: Vec<usize> = self.fit_points.iter().map(|own| self.span_at(own.u)).collect();
        let mut is_chosen = vec![false; count];
        for of_span in spans.chunk_by(|a, b| a == b).scan(0, |from, of_span| {
            *from += of_span.len();
            Some(*from - of_span.len()..*from)
        }) {
            let each = of_span.len().div_ceil(ENOUGH);
            of_span.step_by(each).for_each(|k| is_chosen[k] = true);
        }
        let mut found = None;
        for _ in 0..JOINING {
            let chosen = self.fit_points.iter().zip(&is_chosen).filter(|(_, is)| **is).map(|(own, _)| *own);
            let few = Problem { fit_points: chosen.collect(), ..*self };
            let Some(spline) = few.solve(budget)? else { return Ok(None) };
            let misses = few.excess(&spline).iter().any(|excess| *excess > HOPELESS);
            let joined = !misses && self.join(&spline, &spans, &mut is_chosen);
            found = Some(spline);
            if !joined {
                break;
            }
        }
        Ok(found)
    }

    /// Chooses the fit points that a spline misses most, and says whether there were any.
    fn join(&self, spline: &[Span], spans: &[usize], is_chosen: &mut [bool]) -> bool {
        let scale = self.scales();
        let mut worst: Option<(usize, usize, f64)> = None;
        let mut joined = Vec::new();
        for (k, (own, span)) in self.fit_points.iter().zip(spans).enumerate() {
            let Span { from, to, .. } = spline[*span];
            let part = span * PARTS + ((own.u - from) / (to - from) * PARTS as f64) as usize;
            if worst.is_some_and(|(of, ..)| of != part) {
                joined.extend(worst.take());
            }
            let off = off(&spline[*span], own, &scale);
            if off > worst.map_or(MISSED, |(.., most)| most) {
                worst = Some((part, k, off));
            }
        }
        joined.extend(worst);
        let before = joined.iter().filter(|(_, k, _)| is_chosen[*k]).count();
        joined.iter().for_each(|(_, k, _)| is_chosen[*k] = true);
        joined.len() > before
    }

    /// The spans of the spline. It may miss fit points where the knots do not allow better; see
    /// [`Problem::excess`]. `None` where the numbers allow no solution.
    pub fn solve(&self, budget: &Budget) -> Result<Option<Vec<Span>>, Stopped> {
        let extractions = self.extractions();
        let size = self.knots.len() - 1 + DEGREE;
        let rows = self.rows(&extractions);
        let (jerk, near) = self.matrices(&extractions, &rows, size);
        let scale = self.scales();
        let scaled = |p: &Point6| -> [f64; 6] { std::array::from_fn(|k| p[k] / scale[k]) };
        let centres: Vec<[f64; 6]> = self.fit_points.iter().map(|fit_point| scaled(&fit_point.at)).collect();
        let ends = self.ends.map(|end| scaled(&end));

        let mut weight = FIRST_WEIGHT;
        let mut factor = jerk.plus(&near, weight);
        if !factor.factor() {
            return Ok(None);
        }
        let mut inside = centres.clone();
        let mut pull = vec![[0.0; 6]; centres.len()];
        let mut control = vec![[0.0; 6]; size];
        for iteration in 0..ITERATIONS {
            if iteration.is_multiple_of(BETWEEN_WEIGHTS) {
                budget.check()?;
            }
            control.fill([0.0; 6]);
            for ((row, z), y) in rows.iter().zip(&inside).zip(&pull) {
                for (k, basis) in row.basis.iter().enumerate() {
                    let at = &mut control[row.first + k];
                    for n in 0..6 {
                        at[n] += weight * basis * (z[n] - y[n]);
                    }
                }
            }
            for (k, end) in [(0, &ends[0]), (size - 1, &ends[1])] {
                for n in 0..6 {
                    control[k][n] += END_WEIGHT * end[n];
                }
            }
            factor.solve(&mut control);
            let (mut apart, mut moved) = (0.0_f64, 0.0_f64);
            for (k, row) in rows.iter().enumerate() {
                let value = row.value(&control);
                let mut goal = [0.0; 6];
                for n in 0..6 {
                    goal[n] = RELAXATION * value[n] + (1.0 - RELAXATION) * inside[k][n] + pull[k][n];
                }
                let next = into_balls(&goal, &centres[k]);
                for n in 0..6 {
                    pull[k][n] = goal[n] - next[n];
                    apart = apart.max((value[n] - next[n]).abs());
                    moved = moved.max((next[n] - inside[k][n]).abs());
                }
                inside[k] = next;
            }
            let is_hopeless = iteration >= HOPEFUL && apart > HOPELESS;
            if apart.max(moved) < NEAR || is_hopeless {
                break;
            }
            let is_unbalanced = apart > UNBALANCED * moved || moved > UNBALANCED * apart;
            if (iteration + 1).is_multiple_of(BETWEEN_WEIGHTS) && is_unbalanced {
                let change: f64 = if apart > moved { WEIGHT_STEP } else { WEIGHT_STEP.recip() };
                weight *= change;
                pull.iter_mut().for_each(|y| *y = y.map(|y| y / change));
                factor = jerk.plus(&near, weight);
                if !factor.factor() {
                    return Ok(None);
                }
            }
        }
        let mut points: Vec<Point6> =
            control.iter().map(|c| Point6::from_fn(|n, _| c[n] * scale[n])).collect();
        points[0] = self.ends[0];
        points[size - 1] = self.ends[1];
        let span = |(k, extraction): (usize, &Extraction)| Span {
            from: self.knots[k],
            to: self.knots[k + 1],
            control: std::array::from_fn(|row| (0..6).map(|n| points[k + n] * extraction[(row, n)]).sum()),
        };
        let mut spans: Vec<Span> = extractions.iter().enumerate().map(span).collect();
        // Rounding of the extraction must not move the ends.
        let last = spans.len() - 1;
        spans[0].control[0] = self.ends[0];
        spans[last].control[DEGREE] = self.ends[1];
        Ok(points.iter().flatten().all(|x| x.is_finite()).then_some(spans))
    }

    /// The largest distance of each span from its fit points, as a part of the radius.
    pub fn excess(&self, spans: &[Span]) -> Vec<f64> {
        let scale = self.scales();
        let mut excess = vec![0.0_f64; spans.len()];
        for fit_point in &self.fit_points {
            let k = self.span_at(fit_point.u);
            excess[k] = excess[k].max(off(&spans[k], fit_point, &scale));
        }
        excess
    }

    fn scales(&self) -> [f64; 6] {
        let [tip, top] = self.radii;
        [tip, tip, tip, top, top, top]
    }

    fn span_at(&self, u: f64) -> usize {
        self.knots.partition_point(|knot| *knot <= u).clamp(1, self.knots.len() - 1) - 1
    }

    fn extractions(&self) -> Vec<Extraction> {
        let (first, last) = (self.knots[0], self.knots[self.knots.len() - 1]);
        let mut knots = vec![first; DEGREE];
        knots.extend_from_slice(self.knots);
        knots.extend([last; DEGREE]);
        let size = self.knots.len() - 1 + DEGREE;
        bspline::spans(&knots, DEGREE, size)
            .map(|span| Extraction::from_fn(|row, column| span.extraction[(row, column)]))
            .collect()
    }

    fn rows(&self, extractions: &[Extraction]) -> Vec<Row> {
        let row = |fit_point: &FitPoint| {
            let k = self.span_at(fit_point.u);
            let t = (fit_point.u - self.knots[k]) / (self.knots[k + 1] - self.knots[k]);
            let bernstein = bernstein(t);
            let basis =
                std::array::from_fn(|n| (0..6).map(|row| bernstein[row] * extractions[k][(row, n)]).sum());
            Row { first: k, basis }
        };
        self.fit_points.iter().map(row).collect()
    }

    /// Two matrices: one for the jerk and the ends of the spline, one for the distances from the fit points.
    /// The parameter is scaled such that the mean length of a span is 1.
    fn matrices(
        &self,
        extractions: &[Extraction],
        rows: &[Row],
        size: usize,
    ) -> (BandedMatrix<WIDTH>, BandedMatrix<WIDTH>) {
        // Integrals of products of the Bernstein polynomials of degree 2.
        const GRAM: [[f64; 3]; 3] = [[0.2, 0.1, 1.0 / 30.0], [0.1, 2.0 / 15.0, 0.1], [1.0 / 30.0, 0.1, 0.2]];
        let count = extractions.len() as f64;
        let mean = (self.knots[self.knots.len() - 1] - self.knots[0]) / count;
        let mut jerk = BandedMatrix::zeros(size);
        for (k, extraction) in extractions.iter().enumerate() {
            let h = (self.knots[k + 1] - self.knots[k]) / mean;
            // Third differences of the Bernstein points by the control points.
            let third: [[f64; 6]; 3] = std::array::from_fn(|row| {
                std::array::from_fn(|n| {
                    extraction[(row + 3, n)] - 3.0 * extraction[(row + 2, n)] + 3.0 * extraction[(row + 1, n)]
                        - extraction[(row, n)]
                })
            });
            let factor = 3600.0 / h.powi(5);
            for a in 0..6 {
                for b in 0..=a {
                    let mut sum = 0.0;
                    for i in 0..3 {
                        for j in 0..3 {
                            sum += GRAM[i][j] * third[i][a] * third[j][b];
                        }
                    }
                    jerk.add(k + a, a - b, factor * sum);
                }
            }
        }
        jerk.add(0, 0, END_WEIGHT);
        jerk.add(size - 1, 0, END_WEIGHT);
        let mut near = BandedMatrix::zeros(size);
        for row in rows {
            for a in 0..6 {
                for b in 0..=a {
                    near.add(row.first + a, a - b, row.basis[a] * row.basis[b]);
                }
            }
        }
        (jerk, near)
    }
}

impl Row {
    fn value(&self, control: &[[f64; 6]]) -> [f64; 6] {
        let mut value = [0.0; 6];
        for (k, basis) in self.basis.iter().enumerate() {
            let at = &control[self.first + k];
            for n in 0..6 {
                value[n] += basis * at[n];
            }
        }
        value
    }
}

/// The distance of a span from a fit point, of tip or top, as a part of the radius.
fn off(span: &Span, fit_point: &FitPoint, scale: &[f64; 6]) -> f64 {
    let off = span.jet(fit_point.u)[0] - fit_point.at;
    let part = |n: usize| (0..3).map(|k| (off[n + k] / scale[n + k]).powi(2)).sum::<f64>().sqrt();
    part(0).max(part(3))
}

/// The nearest place in the balls of radius 1 about the tip and the top of a centre.
fn into_balls(at: &[f64; 6], centre: &[f64; 6]) -> [f64; 6] {
    let mut inside = *at;
    for from in [0, 3] {
        let square: f64 = (from..from + 3).map(|n| (at[n] - centre[n]).powi(2)).sum();
        if square > 1.0 {
            let length = square.sqrt();
            for n in from..from + 3 {
                inside[n] = centre[n] + (at[n] - centre[n]) / length;
            }
        }
    }
    inside
}

fn bernstein(t: f64) -> [f64; 6] {
    const CHOOSE: [f64; 6] = [1.0, 5.0, 10.0, 10.0, 5.0, 1.0];
    std::array::from_fn(|k| CHOOSE[k] * t.powi(k as i32) * (1.0 - t).powi(5 - k as i32))
}

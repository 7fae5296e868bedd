//! Gates: straight lines across a band. Between each gate and the next one, a chord joins their ends on each
//! edge of the band. A bound for the distance of the edge from this chord is computed.

use nalgebra::{Point2, Vector2};

use super::{Corridor, GATES_BETWEEN_CHECKS};
use crate::budget::{Budget, Stopped};
use crate::geometry::deviation::{Band, Measure};
use crate::geometry::plane_curve::{Enclosure, PlaneCurve};

/// Gates for each element with joints on the curve. The element's deviation is then some 4,000 times the
/// deviation of a chord between gates.
const GATES_AN_ELEMENT: usize = 64;

/// The most gates: all of them are in memory at once.
const MOST_GATES: usize = 2_000_000;

/// A jump of the tangent by more than this sine makes a corner.
const CORNER_SINE: f64 = 1e-9;

/// A line across the band at the parameter `t` of the curve.
#[derive(Debug, Clone, Copy)]
pub struct Gate {
    pub t: f64,
    pub point: Point2<f64>,
    /// The unit vector to the left of the curve along which the band is measured.
    pub across: Vector2<f64>,
    /// How far the edges of the band may lie from their chords to the next gate, mm.
    pub bulge_mm: f64,
}

impl Corridor {
    /// The corridor along successive elements; `None` if it would need too many gates.
    ///
    /// # Errors
    /// When the budget ends.
    pub fn new(
        curve: &impl PlaneCurve,
        ranges: &[[f64; 2]],
        band: Band,
        budget: &Budget,
    ) -> Result<Option<Self>, Stopped> {
        let (Some(first), Some(last)) = (ranges.first(), ranges.last()) else { return Ok(None) };
        let breaks = curve.breaks();
        let inside = breaks.partition_point(|t| *t <= first[0])..breaks.partition_point(|t| *t < last[1]);
        let breaks = breaks.get(inside).unwrap_or_default();
        if ranges.len() * GATES_AN_ELEMENT + breaks.len() > MOST_GATES {
            return Ok(None);
        }
        let mut parameters = breaks.to_vec();
        for [from, to] in ranges {
            let step = (to - from) / GATES_AN_ELEMENT as f64;
            parameters.extend((0..GATES_AN_ELEMENT).map(|k| from + step * k as f64));
            parameters.push(*to);
        }
        parameters.sort_by(f64::total_cmp);
        parameters.dedup();
        let mut gates = Vec::with_capacity(parameters.len());
        for (k, t) in parameters.iter().copied().enumerate() {
            if k.is_multiple_of(GATES_BETWEEN_CHECKS) {
                budget.check()?;
            }
            let across = match band.measure {
                Measure::Vertical => Vector2::y(),
                Measure::Normal => {
                    let along = curve.derivative(t);
                    Vector2::new(-along.y, along.x) / along.norm()
                }
            };
            let bulge_mm = parameters.get(k + 1).map_or(0.0, |next| bulge(curve, [t, *next], &band));
            gates.push(Gate { t, point: curve.point(t), across, bulge_mm });
        }
        let has_corner = breaks.iter().any(|t| curve.has_corner(*t, CORNER_SINE));
        Ok(Some(Self { gates, band, has_corner }))
    }
}

/// How far the edges of the band may lie from their chords over a range, mm.
fn bulge(curve: &impl PlaneCurve, [from, to]: [f64; 2], band: &Band) -> f64 {
    let Enclosure { first, second, .. } = curve.enclose(from, to);
    let width = to - from;
    match band.measure {
        // Two bounds: for a function whose slope varies by at most s, and for one whose second derivative is
        // at most c.
        Measure::Vertical => (0.25 * first[1].width() * width).min(0.125 * second[1].mag() * width * width),
        Measure::Normal => {
            let along = curve.derivative(0.5 * (from + to)).normalize();
            let [x, y] = first;
            let (ahead, aside) = (x * along.x + y * along.y, y * along.x - x * along.y);
            if ahead.lo() <= 0.0 {
                return f64::INFINITY;
            }
            // Beyond the centre of curvature the band folds, and gates do not bound it.
            let turn = first[0] * second[1] - first[1] * second[0];
            let widest = band.below_mm.max(band.above_mm);
            if turn.mag() * widest >= ahead.lo().powi(3) {
                return f64::INFINITY;
            }
            // The tangent differs from the tangent in the middle by at most this sine. The normals turn by
            // the same angle. That moves the edge along itself by the sine times the offset, and across
            // itself by the square of the sine.
            let sine = aside.mag() / ahead.lo();
            let speed = ahead.hi().hypot(aside.mag());
            let chord = (0.5 * speed * sine * width)
                .min(0.125 * second[0].mag().hypot(second[1].mag()) * width * width);
            chord + 3.0 * sine * sine * widest
        }
    }
}

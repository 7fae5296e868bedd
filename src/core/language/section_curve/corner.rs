//! A corner rounded by the arc that touches both lines of the corner.
//!
//! If the arc turns by at most a right angle, it is one rational quadratic curve, with the corner as its
//! middle control point. Otherwise it is two such curves, which meet on the bisector of the corner.

use nalgebra::Point;

use super::Fault;

/// A corner counts as straight if half of its turn (radians), or its tangent length as a part of the
/// coordinates' magnitude, is below this. The rounding of points on a line causes such turns.
const STRAIGHT: f64 = 1e-12;

/// A corner counts as a reversal if half the angle between its lines is below this, radians. Rounding may
/// then hide a full reversal, and the arc would be a billion times smaller than its tangents.
const REVERSED: f64 = 1e-9;

/// One rational quadratic: its control points, and the weight of the middle one. The other weights are 1.
pub(super) type Arc<const D: usize> = ([Point<f64, D>; 3], f64);

/// A rounded corner.
pub(super) struct Rounding<const D: usize> {
    /// The distance from the corner to the start and to the end of the arc, mm.
    pub(super) tangent: f64,
    /// The arc in parts of equal length, each at most a quarter turn.
    pub(super) arcs: Vec<Arc<D>>,
    /// The length of each part, mm.
    pub(super) length: f64,
}

/// The rounding of the corner `at` between two neighbouring points, by a radius above zero; `None` if the
/// corner has no turn.
///
/// R is the radius, and theta is the angle by which the curve turns. The arc touches each line at the
/// distance R tan(theta / 2) from the corner. The weight of the middle control point is cos(theta / 2). The
/// sum and the difference of the unit vectors along the two lines have the lengths 2 cos(theta / 2) and
/// 2 sin(theta / 2). From these lengths, cosine and sine stay accurate for small turns.
///
/// # Errors
/// When the lines fold back on each other.
pub(super) fn rounding<const D: usize>(
    [before, at, after]: [Point<f64, D>; 3],
    radius: f64,
) -> Result<Option<Rounding<D>>, Fault> {
    let [arriving, leaving] = [(at - before).normalize(), (after - at).normalize()];
    let [along, inward] = [(arriving + leaving) * 0.5, (leaving - arriving) * 0.5];
    let [cos, sin] = [along.norm(), inward.norm()];
    if cos < REVERSED {
        return Err(Fault::Reversal { radius_mm: radius });
    }
    let tangent = radius * sin / cos;
    let magnitude = [before, at, after].iter().map(|p| p.coords.amax()).fold(0.0, f64::max);
    if sin < STRAIGHT || tangent < STRAIGHT * magnitude {
        return Ok(None);
    }
    let [start, end] = [at - arriving * tangent, at + leaving * tangent];
    let half_turn = sin.atan2(cos);
    if half_turn <= 0.25 * std::f64::consts::PI + STRAIGHT {
        let arcs = vec![([start, at, end], cos)];
        return Ok(Some(Rounding { tangent, arcs, length: 2.0 * half_turn * radius }));
    }
    // `quarter` is R tan(theta / 4), `weight` is cos(theta / 4). The arc passes the corner at a distance of R
    // (1 / cos - 1).
    let quarter = radius * sin / (1.0 + cos);
    let weight = (0.5 * (1.0 + cos)).sqrt();
    let middle = at + inward * (radius * sin / ((1.0 + cos) * cos));
    let arcs = vec![
        ([start, start + arriving * quarter, middle], weight),
        ([middle, end - leaving * quarter, end], weight),
    ];
    Ok(Some(Rounding { tangent, arcs, length: half_turn * radius }))
}

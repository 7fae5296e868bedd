//! A corner rounded by the arc that touches both of its lines.
//!
//! With theta the turn and R the radius, the arc touches the lines R tan(theta / 2) from the corner. As a
//! rational quadratic its middle control point is the corner, with the weight cos(theta / 2); a turn of more
//! than a right angle takes two, which meet on the bisector. Half the sum and half the difference of the
//! lines' directions are cos(theta / 2) and sin(theta / 2) long: so no small turn is lost.

use nalgebra::Point;

use super::Fault;

/// The turn, in radians, and the tangent length, in parts of the coordinates' magnitude, below which a corner
/// is straight: what rounding makes of points on a line.
const STRAIGHT: f64 = 1e-12;

/// Half of what is missing to a full reversal, in radians, below which rounding may have made it: such an arc
/// would be a billion times smaller than its tangents.
const REVERSED: f64 = 1e-9;

/// One rational quadratic: control points in space, and the weight of the middle one; that of the others is
/// 1.
pub(super) type Arc<const D: usize> = ([Point<f64, D>; 3], f64);

/// A rounded corner.
pub(super) struct Rounding<const D: usize> {
    /// From the corner to where the arc starts and ends.
    pub(super) tangent: f64,
    /// The arc in parts of equal length, a quarter turn at most each.
    pub(super) arcs: Vec<Arc<D>>,
    /// The length of each part.
    pub(super) length: f64,
}

/// The rounding of the corner `at` between two other points, by a radius above zero; none where nothing
/// turns.
///
/// # Errors
/// When the lines lie on each other.
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
    // tan(theta / 4) and cos(theta / 4), and the distance of the arc from the corner, R (1 / cos - 1).
    let quarter = radius * sin / (1.0 + cos);
    let weight = (0.5 * (1.0 + cos)).sqrt();
    let middle = at + inward * (radius * sin / ((1.0 + cos) * cos));
    let arcs = vec![
        ([start, start + arriving * quarter, middle], weight),
        ([middle, end - leaving * quarter, end], weight),
    ];
    Ok(Some(Rounding { tangent, arcs, length: half_turn * radius }))
}

//! Rational Bezier pieces: points, derivatives, and boxes that contain the curve and its first two
//! derivatives over a range of parameters.
//!
//! # Method
//! The curve is the quotient of two polynomials, A and W. The control points of W are the weights. The
//! control points of A are those of the curve, each times its weight.
//! 1. Boxes of A, W and their derivatives over the range give a box of the curve, and one of each of its
//!    first two derivatives, over the range.
//! 2. The same computation at the middle of the range alone gives boxes that are as small as rounding
//!    permits.
//! 3. By the mean value theorem, the curve anywhere in the range differs from the curve at the middle by at
//!    most half the length of the range times a bound of the first derivative over the range. The curve's box
//!    of step 2 is enlarged by this difference. Now it contains the curve over the range, and is intersected
//!    with the curve's box of step 1.
//! 4. Step 3 is done for the first derivative in the same way, with the bound of the second derivative. The
//!    second derivative keeps its box of step 1.
//!
//! # Guarantees
//! A box may be larger than the values need. If the range is halved, the excess falls to a quarter for the
//! curve and its first derivative, and to a half for its second derivative.

use super::net::{Net, NetPart, UNIT};
use crate::geometry::interval::{Interval, outward};
use crate::geometry::plane_curve::Enclosure;

/// The point at `u` from 0 to 1, to rounding; mm.
pub(super) fn point<const N: usize>(points: &[[f64; 2]; N], weights: &[f64; N], u: f64) -> [f64; 2] {
    let origin = points[0];
    let [x, y, w] = about(points, weights, origin).value(u);
    [origin[0] + x / w, origin[1] + y / w]
}

/// The derivative at `u` from 0 to 1, to rounding, by a parameter that grows by `span` over the piece.
pub(super) fn derivative<const N: usize>(
    points: &[[f64; 2]; N],
    weights: &[f64; N],
    u: f64,
    span: f64,
) -> [f64; 2] {
    let net = about(points, weights, points[0]);
    let ([x, y, w], [dx, dy, dw]) = (net.value(u), net.derived(span).value(u));
    [(dx - x / w * dw) / w, (dy - y / w * dw) / w]
}

/// Encloses the curve over `range`, within 0 to 1, and its derivatives by a parameter that grows by `span`
/// over the piece. Points are counted from the point of the curve in the middle of the range. So they are
/// small, and little is lost in differences.
pub(super) fn enclose<const N: usize>(
    points: &[[f64; 2]; N],
    weights: &[f64; N],
    range: [f64; 2],
    span: f64,
) -> Enclosure {
    let middle = 0.5 * (range[0] + range[1]);
    let origin = point(points, weights, middle);
    let net = about(points, weights, origin);
    let derived = net.derived(span);
    let twice_derived = derived.derived(span);
    let at_middle = quotients(&net.at(middle), &derived.at(middle), &twice_derived.at(middle));
    let Enclosure { point, first, second } = if range[0] == range[1] {
        // The origin is the value of `point` there; the enclosure must contain it.
        Enclosure { point: at_middle.point.map(|x| x.hull(Interval::ZERO)), ..at_middle }
    } else {
        let over = quotients(&net.part(range), &derived.part(range), &twice_derived.part(range));
        let half = (range[1] - middle).max(middle - range[0]) + 4.0 * UNIT;
        // Room for the rounding of both ends and of the span.
        let half = Interval::around(0.0, half * span * (1.0 + 4.0 * UNIT));
        let near = |at: [Interval; 2], slope: [Interval; 2]| [0, 1].map(|c| at[c] + slope[c] * half);
        let met = |a: [Interval; 2], b: [Interval; 2]| [0, 1].map(|c| a[c].meet(b[c]));
        let first = met(over.first, near(at_middle.first, over.second));
        let point = met(over.point, near(at_middle.point, first));
        Enclosure { point, first, second: over.second }
    };
    let origin = origin.map(Interval::point);
    Enclosure { point: [point[0] + origin[0], point[1] + origin[1]], first, second }
}

/// The control points, counted from `origin` and times their weights, and the weights.
#[inline(always)]
fn about<const N: usize>(points: &[[f64; 2]; N], weights: &[f64; N], origin: [f64; 2]) -> Net<N, 3> {
    let homogeneous = |k: usize| {
        let ([x, y], w) = (points[k], weights[k]);
        [(x - origin[0]) * w, (y - origin[1]) * w, w]
    };
    // Two roundings: a difference and a product.
    Net::rounded(std::array::from_fn(homogeneous), 2.0)
}

/// The quotient C = A / W over a part, and its derivatives C' = (A' - C W') / W and C'' = (A'' - 2 C' W' - C
/// W'') / W. `part`, `first` and `second` are A and W and their first two derivatives over the same part.
fn quotients<const N: usize>(
    part: &NetPart<N, 3>,
    first: &NetPart<N, 3>,
    second: &NetPart<N, 3>,
) -> Enclosure {
    let [_, _, w] = part.hull();
    let by_w = Interval::point(1.0).div(w);
    let [dx, dy, dw] = first.hull();
    let [ddx, ddy, ddw] = if N > 2 { second.hull() } else { [Interval::ZERO; 3] };
    let point = control_hull(part);
    let first = [(dx - point[0] * dw) * by_w, (dy - point[1] * dw) * by_w];
    let twice = dw * 2.0;
    let second = [(ddx, 0), (ddy, 1)]
        .map(|(dd, c): (Interval, usize)| (dd - first[c] * twice - point[c] * ddw) * by_w);
    Enclosure { point, first, second }
}

/// A box that contains the control points A_k / W_k. It contains the quotient, too, because the W_k are above
/// zero.
#[inline(always)]
fn control_hull<const N: usize>(part: &NetPart<N, 3>) -> [Interval; 2] {
    let mut low = [f64::INFINITY; 2];
    let mut high = [f64::NEG_INFINITY; 2];
    let (mut least_weight, mut largest) = (f64::INFINITY, [0.0f64; 2]);
    for &[x, y, w] in part.points() {
        let quotient = [x / w, y / w];
        for c in 0..2 {
            low[c] = low[c].min(quotient[c]);
            high[c] = high[c].max(quotient[c]);
            largest[c] = largest[c].max(quotient[c].abs());
        }
        least_weight = least_weight.min(w);
    }
    let [ex, ey, ew] = part.error;
    let least_weight = least_weight - ew;
    if least_weight.is_nan() || least_weight <= 0.0 {
        return [Interval::ENTIRE; 2];
    }
    // |A / W - a / w| <= (|A - a| + |a / w| |W - w|) / W, and the quotient is rounded.
    let error = |e: f64, most: f64| (e + most * ew) / least_weight * (1.0 + 8.0 * UNIT) + 2.0 * UNIT * most;
    let error = [error(ex, largest[0]), error(ey, largest[1])];
    [0, 1].map(|c| outward(low[c] - error[c], high[c] + error[c]))
}

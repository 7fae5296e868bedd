//! A lower bound of the distance between a part of a patch and a piece of the centre's path.
//!
//! With (a, b, h) the coordinates of a surface point about the centre of a circle of radius r, h along its
//! normal, and q = a^2 + b^2, the squared distance to the circle is q + r^2 - 2 r sqrt(q) + h^2. The root is
//! concave, so sqrt(q) <= (q + c^2) / (2 c) for every c > 0, with equality at q = c^2; hence
//! distance^2 >= q (c - r) / c + r (r - c) + h^2,
//! a polynomial in the parameters of the part. With c taken at the part's centre the loss is of second order
//! in the change of q, and along the line of contact q is nearly constant.

use nalgebra::Vector3;

use super::path::Piece;
use crate::geometry::curve::{Arc, Curve, Direction, Line};
use crate::geometry::surface::Patch;

/// Rounding of a squared distance in parts of its largest term.
const ROUNDING: f64 = 1e-13;

/// One coordinate of a control net.
type Net = [[f64; 4]; 4];

/// How near a part is to a piece.
pub(super) struct Nearness {
    /// Never above the least distance, mm, but for the rounding of the coordinates, which is the caller's.
    pub(super) lowest_distance: f64,
    /// Whether the distance bends more along u than along v.
    pub(super) varies_along_u: bool,
}

pub(super) fn nearness(piece: &Piece, part: &Patch) -> Nearness {
    let squared = match &piece.curve {
        Curve::Line(line) => to_line(line, part),
        Curve::Arc(arc) => to_arc(arc, part),
    };
    let [bend_u, bend_v] = squared.bends;
    let lowest = squared.lowest - ROUNDING * squared.magnitude;
    Nearness { lowest_distance: lowest.max(0.0).sqrt(), varies_along_u: bend_u >= bend_v }
}

/// What the Bernstein coefficients of a squared distance say.
struct Squared {
    /// The least coefficient, mm^2.
    lowest: f64,
    /// The largest term of the sums, mm^2.
    magnitude: f64,
    /// The largest second differences along u and v, mm^2.
    bends: [f64; 2],
}

fn coordinate(part: &Patch, origin: &Vector3<f64>, axis: &Vector3<f64>) -> Net {
    part.net.map(|row| row.map(|p| (p - origin).dot(axis)))
}

fn all(net: &Net, holds: impl Fn(f64) -> bool) -> bool {
    net.iter().flatten().all(|x| holds(*x))
}

fn to_point(part: &Patch, point: &Vector3<f64>) -> Squared {
    let nets = [0, 1, 2].map(|c| coordinate(part, point, &Vector3::ith(c, 1.0)));
    sum_of_squares(&nets, [1.0; 3])
}

fn to_line(line: &Line, part: &Patch) -> Squared {
    let along = line.end - line.start;
    let length = along.norm();
    let Some(along) = along.try_normalize(0.0) else { return to_point(part, &line.start.coords) };
    let fraction = coordinate(part, &line.start.coords, &along);
    if all(&fraction, |t| t < 0.0) {
        return to_point(part, &line.start.coords);
    }
    if all(&fraction, |t| t > length) {
        return to_point(part, &line.end.coords);
    }
    let across = along.cross(&Vector3::ith(along.iamin(), 1.0)).normalize();
    let third = along.cross(&across);
    let nets = [across, third].map(|axis| coordinate(part, &line.start.coords, &axis));
    sum_of_squares(&nets, [1.0; 2])
}

fn to_arc(arc: &Arc, part: &Patch) -> Squared {
    let center = arc.center().coords;
    let [a, b, h] = arc.plane().axes().map(|c| coordinate(part, &center, &Vector3::ith(c, 1.0)));
    let local = |p: nalgebra::Point3<f64>| arc.plane().to_local(&p) - arc.plane().to_local(&arc.center());
    let (start, end) = (local(arc.start()), local(arc.end()));
    let sense = if arc.direction() == Direction::Ccw { 1.0 } else { -1.0 };
    // Beyond an end: behind the radius to it, and on its side of the bisector of both ends. The arc turns by
    // at most a quarter, so the nearest point of the arc is then that end.
    let each = |holds: &dyn Fn(f64, f64) -> bool| {
        a.iter().flatten().zip(b.iter().flatten()).all(|(a, b)| holds(*a, *b))
    };
    let turned = |from: &Vector3<f64>, a: f64, b: f64| sense * (from.x * b - from.y * a);
    let nearer_end = |a: f64, b: f64| (end.x - start.x) * a + (end.y - start.y) * b;
    if each(&|a, b| turned(&start, a, b) < 0.0 && nearer_end(a, b) < 0.0) {
        return to_point(part, &arc.start().coords);
    }
    if each(&|a, b| turned(&end, a, b) > 0.0 && nearer_end(a, b) > 0.0) {
        return to_point(part, &arc.end().coords);
    }
    let r = arc.radius();
    let at_center = part.center() - center;
    let [ia, ib, _] = arc.plane().axes();
    let c = at_center[ia].hypot(at_center[ib]);
    // Any c is right; at the arc's own centre, where every point of it is equally near, none is good.
    let c = c.max(1e-3 * r);
    let weight = (c - r) / c;
    let mut squared = sum_of_squares(&[a, b, h], [weight, weight, 1.0]);
    squared.lowest += r * (r - c);
    squared.magnitude += r * (r - c).abs();
    squared
}

/// The weighted sum of squares of bicubics, by its Bernstein coefficients of degree (6, 6).
fn sum_of_squares<const N: usize>(nets: &[Net; N], weights: [f64; N]) -> Squared {
    let mut sum = [[0.0; 7]; 7];
    for (net, weight) in nets.iter().zip(weights) {
        let mut scaled = *net;
        for (row, cu) in scaled.iter_mut().zip(BINOMIAL_3) {
            for (x, cv) in row.iter_mut().zip(BINOMIAL_3) {
                *x *= cu * cv;
            }
        }
        for i in 0..4 {
            // The product of rows i and k counts twice where they differ.
            for k in i..4 {
                let weight = if i == k { weight } else { 2.0 * weight };
                let target = &mut sum[i + k];
                for (x, j) in scaled[i].iter().zip(0..) {
                    for (y, l) in scaled[k].iter().zip(0..) {
                        target[j + l] += weight * x * y;
                    }
                }
            }
        }
    }
    let mut squared = Squared { lowest: f64::INFINITY, magnitude: 0.0, bends: [0.0; 2] };
    for (row, cu) in sum.iter_mut().zip(BINOMIAL_6) {
        for (x, cv) in row.iter_mut().zip(BINOMIAL_6) {
            *x /= cu * cv;
            squared.lowest = squared.lowest.min(*x);
            squared.magnitude = squared.magnitude.max(x.abs());
        }
    }
    let bend = |a: f64, b: f64, c: f64| (a - 2.0 * b + c).abs();
    for row in &sum {
        let bends = row.windows(3).map(|w| bend(w[0], w[1], w[2]));
        squared.bends[1] = bends.fold(squared.bends[1], f64::max);
    }
    for rows in sum.windows(3) {
        let bends = (0..7).map(|k| bend(rows[0][k], rows[1][k], rows[2][k]));
        squared.bends[0] = bends.fold(squared.bends[0], f64::max);
    }
    squared
}

const BINOMIAL_3: [f64; 4] = [1.0, 3.0, 3.0, 1.0];
const BINOMIAL_6: [f64; 7] = [1.0, 6.0, 15.0, 20.0, 15.0, 6.0, 1.0];

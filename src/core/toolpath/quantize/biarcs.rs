//! Bounds the distance between a parabola and the arcs that LinuxCNC runs in its place.
//!
//! A block of LinuxCNC can state a parabola as a quadratic spline. LinuxCNC divides the parameter range of
//! the parabola into twelve equal parts, and runs two arcs (a biarc) in place of each part.
//!
//! # Method
//! 1. Compute the arcs that LinuxCNC runs. The formulas here avoid the cancellation in LinuxCNC's formulas.
//! 2. For each part, find the point at which its two arcs meet, and the normal of the parabola through this
//!    point. Divide the part at this normal into two portions, and bound the distance of each portion from
//!    the circle of its arc.
//! 3. To each bound, add an allowance for the rounding in LinuxCNC's formulas. The largest sum is the result.
//!
//! # Guarantees
//! The result is an upper bound of the Frechet distance between the arcs and the parabola. There is no result
//! if the tangent turns by less than 1e-6 radians along a part, because LinuxCNC divides by the square of
//! this angle. There is no result either if the tangent turns by more than one radian along a part.
//!
//! # Reference
//! `NURBS_FEED` and `biarc` in LinuxCNC's `emccanon.cc`; K. M. Bolton, *Biarc curves*, Computer-Aided Design
//! 7, 1975.

use nalgebra::Vector2;

/// Parts into which the control divides a block.
const PARTS: u32 = 12;

/// The step of the parameter, to each side, over which the control takes tangents.
const DIFFERENCE: f64 = 1e-5;

/// The control runs an arc as a line where twice its chord times the sine of its angle at the start is below
/// this, in units of the program. That is eight times the height of the arc.
const STRAIGHT_UNITS: f64 = 1e-6;

/// Least turn of a part, radians. Its square is ten thousand times the rounding of a number.
const LEAST_TURN: f64 = 1e-6;

/// Largest turn of a part, radians. Up to it, arcs and parabola run along each other.
const LARGEST_TURN: f64 = 1.0;

/// Rounding of a coordinate in the control, as a share of the largest coordinate. It includes the few
/// products from which the coordinate is computed.
const ROUNDING: f64 = 1e-15;

/// Why there is no bound.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NotRun {
    TooStraight,
    TurnsTooFar,
}

/// An upper bound of the distance, mm, between a parabola and the path that the control runs for it. The
/// parabola goes from the origin through the control point `control` to `end`, mm. `reach` is the largest
/// coordinate in the program, mm, and `unit_mm` one unit of the program.
pub fn distance(control: &Vector2<f64>, end: &Vector2<f64>, reach: f64, unit_mm: f64) -> Result<f64, NotRun> {
    let parabola = Quadratic { b: *control, a: end - control * 2.0 };
    let mut farthest: f64 = 0.0;
    for k in 0..PARTS {
        let [from, to] = [k, k + 1].map(|k| f64::from(k) / f64::from(PARTS));
        farthest = farthest.max(parabola.distance([from, to], reach, unit_mm)?);
    }
    Ok(farthest)
}

/// The parabola 2 u b + u^2 a.
struct Quadratic {
    b: Vector2<f64>,
    a: Vector2<f64>,
}

impl Quadratic {
    fn at(&self, u: f64) -> Vector2<f64> {
        self.b * (2.0 * u) + self.a * (u * u)
    }

    /// Half the derivative, as the control computes it from differences: to both sides, and at an end of the
    /// block to one side only.
    fn velocity(&self, u: f64) -> Vector2<f64> {
        let (low, high) = ((u - DIFFERENCE).max(0.0), (u + DIFFERENCE).min(1.0));
        self.b + self.a * ((low + high) / 2.0)
    }

    /// The Bezier points of a part, seen from `origin`.
    fn seen_from(&self, origin: &Vector2<f64>, [from, to]: [f64; 2]) -> [Vector2<f64>; 3] {
        let middle = self.b * (from + to) + self.a * (from * to);
        [self.at(from), middle, self.at(to)].map(|p| p - origin)
    }

    fn distance(&self, [from, to]: [f64; 2], reach: f64, unit_mm: f64) -> Result<f64, NotRun> {
        let velocities = [from, to].map(|u| self.velocity(u));
        let slowest = velocities[0].norm().min(velocities[1].norm());
        // The control computes a tangent as the difference of two rounded points, divided by its length.
        let wrong = ROUNDING * reach / (DIFFERENCE * slowest);
        let [t0, t1] = velocities.map(|velocity| velocity / velocity.norm());
        let turn = t0.perp(&t1).atan2(t0.dot(&t1)).abs();
        // Where a velocity vanishes there is no direction, and the turn is not a number.
        if turn.is_nan() || turn < LEAST_TURN.max(8.0 * wrong) {
            return Err(NotRun::TooStraight);
        }
        if turn > LARGEST_TURN {
            return Err(NotRun::TurnsTooFar);
        }
        let (start, end) = (self.at(from), self.at(to));
        let chord = end - start;
        // The length along each tangent: the positive root of -|t1 - t0|^2 s^2 - 2 chord . (t0 + t1) s +
        // |chord|^2.
        let (square, half, rest) = ((t1 - t0).norm_squared(), chord.dot(&(t0 + t1)), chord.norm_squared());
        let reach_along = rest / (half + (half * half + square * rest).sqrt());
        let meet = (start + t0 * reach_along + end - t1 * reach_along) / 2.0;
        let along = (end - t1 * reach_along - meet).normalize();
        let split = self.normal_through(&meet, &along, [from, to]).ok_or(NotRun::TurnsTooFar)?;
        let first = self.to_arc([&start, &meet], &t0, [from, split], unit_mm);
        let second = self.to_arc([&meet, &end], &along, [split, to], unit_mm);
        let rounding = 2.0 * wrong * chord.norm() + 8.0 * ROUNDING * (reach + reach_along / turn);
        Ok(first.max(second) + rounding)
    }

    /// The parameter at which the parabola passes through the normal to `along` at `meet`.
    fn normal_through(&self, meet: &Vector2<f64>, along: &Vector2<f64>, [from, to]: [f64; 2]) -> Option<f64> {
        let (a, b, c) = (self.a.dot(along), self.b.dot(along), -meet.dot(along));
        // a u^2 + 2 b u + c rises over the part, from below zero to above it.
        let root = (b * b - a * c).max(0.0).sqrt();
        [-c / (b + root), -c / (b - root)].into_iter().find(|u| (from..=to).contains(u) && b + a * u > 0.0)
    }

    /// The largest distance, mm, of a part of the parabola from the arc that joins two points and starts
    /// along `tangent`.
    ///
    /// Let x be a point of the parabola seen from the arc's start, n the vector from there to the arc's
    /// centre, and r the arc's radius. The distance of x from the circle is (|x|^2 - 2 x . n) / (|x - n| +
    /// r). The numerator is a polynomial of the parameter, and its Bernstein coefficients bound it. The same
    /// bound shows that the denominator is near 2 r.
    fn to_arc(
        &self,
        [start, end]: [&Vector2<f64>; 2],
        tangent: &Vector2<f64>,
        part: [f64; 2],
        unit_mm: f64,
    ) -> f64 {
        let chord = end - start;
        let leaning = 2.0 * tangent.perp(&chord);
        let [x0, x1, x2] = self.seen_from(start, part);
        if leaning.abs() <= 2.0 * STRAIGHT_UNITS * unit_mm {
            // Near the limit the control may run an arc or a line. The arc is no higher than a quarter of the
            // limit.
            let across = chord.normalize();
            let farthest = [x0, x1, x2].iter().map(|x| across.perp(x).abs()).fold(0.0, f64::max);
            return farthest + STRAIGHT_UNITS * unit_mm / 4.0;
        }
        // From the start to the centre, along the normal.
        let radius = chord.norm_squared() / leaning;
        let to_center = Vector2::new(-tangent.y, tangent.x) * radius;
        let [l0, l1, l2] = [x0, x1, x2].map(|x| -2.0 * x.dot(&to_center));
        let bernstein = [
            x0.dot(&x0) + l0,
            x0.dot(&x1) + (l0 + l1) / 2.0,
            (2.0 * x1.dot(&x1) + x0.dot(&x2)) / 3.0 + (l0 + 4.0 * l1 + l2) / 6.0,
            x1.dot(&x2) + (l1 + l2) / 2.0,
            x2.dot(&x2) + l2,
        ];
        let numerator = bernstein.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
        // At first |x - n| is only known to be above zero. The bound from that shows that it is near the
        // radius.
        let crude = numerator / radius.abs();
        if crude < radius.abs() { numerator / (2.0 * radius.abs() - crude) } else { crude }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// The points of LinuxCNC's own arcs for a block, by its own formulas: `emccanon.cc`, `biarc` and `arc`.
    fn run(control: &Vector2<f64>, end: &Vector2<f64>) -> Vec<Vector2<f64>> {
        let point = |u: f64| control * (2.0 * u * (1.0 - u)) + end * (u * u);
        let tangent = |u: f64| {
            let (low, high) = ((u - 1e-5f64).max(0.0), (u + 1e-5f64).min(1.0));
            (point(high) - point(low)).normalize()
        };
        let mut points = vec![Vector2::zeros()];
        let mut arc = |from: Vector2<f64>, to: Vector2<f64>, along: Vector2<f64>| {
            let chord = to - from;
            let den = 2.0 * (chord.y * along.x - chord.x * along.y);
            for k in 1..=20 {
                let t = f64::from(k) / 20.0;
                if den.abs() <= 1e-6 {
                    points.push(from + chord * t);
                    continue;
                }
                let r = -chord.norm_squared() / den;
                let center = from + Vector2::new(along.y, -along.x) * r;
                let (s, e) = (from - center, to - center);
                let angle = s.perp(&e).atan2(s.dot(&e)) * t;
                points.push(center + nalgebra::Rotation2::new(angle) * s);
            }
        };
        for k in 0..12 {
            let (u0, u1) = (f64::from(k) / 12.0, f64::from(k + 1) / 12.0);
            let (p0, p4, ts, te) = (point(u0), point(u1), tangent(u0), tangent(u1));
            let v = p0 - p4;
            let (a, b, c) = (2.0 * (ts.dot(&te) - 1.0), 2.0 * v.dot(&(ts + te)), v.norm_squared());
            let root = (b * b - 4.0 * a * c).sqrt();
            let beta = ((-b - root) / 2.0 / a).max((-b + root) / 2.0 / a);
            let (p1, p3) = (p0 + ts * beta, p4 - te * beta);
            let p2 = (p1 + p3) / 2.0;
            arc(p0, p2, ts);
            arc(p2, p4, (p3 - p2).normalize());
        }
        points
    }

    fn farthest(points: &[Vector2<f64>], others: &[Vector2<f64>]) -> f64 {
        let to_line = |p: &Vector2<f64>, a: &Vector2<f64>, b: &Vector2<f64>| {
            let along = b - a;
            let t = ((p - a).dot(&along) / along.norm_squared()).clamp(0.0, 1.0);
            (p - a - along * t).norm()
        };
        let nearest = |p: &Vector2<f64>| {
            others.windows(2).map(|pair| to_line(p, &pair[0], &pair[1])).fold(f64::INFINITY, f64::min)
        };
        points.iter().map(nearest).fold(0.0, f64::max)
    }

    proptest! {
        #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

        #[test]
        fn the_arcs_of_linuxcnc_are_within_the_bound(
            control in prop::array::uniform2(-50.0..50.0f64), end in prop::array::uniform2(-50.0..50.0f64),
            flatness in prop_oneof![Just(1.0), 1e-6..1.0f64],
        ) {
            let end = Vector2::from(end);
            let control = end / 2.0 + (Vector2::from(control) - end / 2.0) * flatness;
            if let Ok(bound) = distance(&control, &end, 50.0, 1.0) {
                let own = run(&control, &end);
                let n = 6000;
                let curve: Vec<_> = (0..=n)
                    .map(|k| f64::from(k) / f64::from(n))
                    .map(|u| control * (2.0 * u * (1.0 - u)) + end * (u * u))
                    .collect();
                let found = farthest(&own, &curve);
                // The chords of the samples lie inside by up to |A| / (4 n^2).
                prop_assert!(found <= bound + 2e-6, "{found} {bound}");
                prop_assert!(bound <= 4.0 * found + 1e-5, "{found} {bound}");
            }
        }
    }

    #[test]
    fn parabolas_on_which_the_control_would_fail_are_refused() {
        let v = Vector2::new;
        assert_eq!(distance(&v(1.0, 0.0), &v(3.0, 0.0), 3.0, 1.0), Err(NotRun::TooStraight));
        assert_eq!(distance(&v(0.0, 0.0), &v(0.0, 0.0), 0.0, 1.0), Err(NotRun::TooStraight));
        assert_eq!(distance(&v(500.0, 1e-6), &v(1000.0, 0.0), 1000.0, 1.0), Err(NotRun::TooStraight));
        assert!(distance(&v(5.0, 0.01), &v(4.0, 0.0), 5.0, 1.0).is_err());
        // Less than a micrometre on an arch of 20 mm.
        assert!(distance(&v(10.0, 5.0), &v(20.0, 0.0), 20.0, 1.0).is_ok_and(|mm| mm < 0.001));
    }
}

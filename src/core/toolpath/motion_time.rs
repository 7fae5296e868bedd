//! Estimates the time that a machine with a limited acceleration needs for a toolpath.
//!
//! # Method
//! 1. Divide the toolpath into chains. A chain consists of consecutive moves that are all feed moves or all
//!    rapids. The machine is at rest between two chains and during dwells.
//! 2. Limit the speed within each move: by the feed of the move, and on curves also by the centripetal
//!    acceleration.
//! 3. Limit the speed at each joint of two moves: the sharper the corner, the lower the limit (Jeon's
//!    junction deviation of 0.01 mm, the default of Grbl).
//! 4. Lower the limits at the joints until the acceleration of the machine suffices to change, within each
//!    move, from the speed at its start to the speed at its end.
//! 5. Add up the shortest times of all moves between these speeds.
//!
//! # Guarantees
//! * The result is at least the length of the moves divided by their feeds, and falls as the acceleration
//!   grows. It does not change when a line or an arc is divided.
//! * The result is an estimate: one acceleration stands for all axes, and jerk is not limited.
//!
//! # Cost
//! O(n) for n moves: 0.05 microseconds each.
//!
//! # Reference
//! S. K. Jeon, "Improving Grbl: Cornering Algorithm", 2011; and Grbl's `planner.c`.

mod speed_stretch;

use nalgebra::Vector3;

use self::speed_stretch::SpeedStretch;
use super::path::{Move, Toolpath};
use super::units::{Acceleration, FeedRate};
use crate::geometry::curve::Curve;

/// How far the circle that stands for a corner leaves the corner, mm. A larger value allows higher speeds at
/// corners.
const JUNCTION_DEVIATION_MM: f64 = 0.01;

/// Seconds for `toolpath`, dwells included, on a machine that traverses at `rapid_feed`; `None` where a feed
/// move has no feed.
pub fn motion_time(toolpath: &Toolpath, rapid_feed: FeedRate, acceleration: Acceleration) -> Option<f64> {
    let a = acceleration.mm_per_s2();
    let mut chain = Chain::default();
    let mut seconds = 0.0;
    let starts = toolpath.passes().iter().flat_map(|pass| {
        let apart = pass.moves().len().min(usize::from(pass.start().is_some()));
        (0..pass.moves().len()).map(move |k| k < apart)
    });
    for (step, is_apart) in toolpath.moves().zip(starts) {
        if is_apart {
            seconds += chain.finish(a);
        }
        let (kind, curve, rate) = match step {
            Move::Rapid { line } => (Kind::Rapid, Curve::Line(*line), rapid_feed),
            Move::Feed { along, rate, .. } => (Kind::Feed, *along, (*rate)?),
            Move::Turn { seconds: own, .. } => {
                seconds += chain.finish(a) + (*own)?;
                continue;
            }
            Move::Dwell { seconds: pause } => {
                seconds += chain.finish(a) + pause;
                continue;
            }
        };
        if curve.length() == 0.0 {
            continue;
        }
        if chain.kind != Some(kind) {
            seconds += chain.finish(a);
            chain.kind = Some(kind);
        }
        speed_stretch::push(&mut chain.stretches, &curve, rate, a);
    }
    Some(seconds + chain.finish(a))
}

#[derive(Clone, Copy, PartialEq)]
enum Kind {
    Rapid,
    Feed,
}

/// Moves between two rests.
#[derive(Default)]
struct Chain {
    kind: Option<Kind>,
    stretches: Vec<SpeedStretch>,
}

impl Chain {
    /// Seconds from rest to rest; the chain is empty afterwards.
    fn finish(&mut self, acceleration: f64) -> f64 {
        let speeds = self.joint_speeds(acceleration);
        let seconds =
            |(stretch, ends): (&SpeedStretch, &[f64])| trapezoid(stretch, ends[0], ends[1], acceleration);
        let sum = self.stretches.iter().zip(speeds.windows(2)).map(seconds).sum();
        self.stretches.clear();
        sum
    }

    /// Squares of the speeds before, between and after the moves, mm2/s2. They are lowered backward along the
    /// chain, then forward. At the end they differ by at most 2 a l over a move of the length l, with the
    /// acceleration a.
    fn joint_speeds(&self, acceleration: f64) -> Vec<f64> {
        let moves = &self.stretches;
        let mut squares = vec![0.0; moves.len() + 1];
        for k in 1..moves.len() {
            let (before, after) = (&moves[k - 1], &moves[k]);
            let corner = acceleration * corner_radius_mm(&before.to, &after.from);
            squares[k] = corner.min(before.most).min(after.most);
        }
        for k in (1..moves.len()).rev() {
            squares[k] = squares[k].min(squares[k + 1] + 2.0 * acceleration * moves[k].length_mm);
        }
        for k in 1..moves.len() {
            squares[k] = squares[k].min(squares[k - 1] + 2.0 * acceleration * moves[k - 1].length_mm);
        }
        squares
    }
}

/// Radius of the circle that stands for the corner between two directions, mm; infinite where there is no
/// corner. The circle touches both moves and leaves the corner by d = [`JUNCTION_DEVIATION_MM`]. Its radius
/// is d sin(w / 2) / (1 - sin(w / 2)), where w is the angle between the moves (pi if they go straight on).
/// The square of the speed at the corner is at most the acceleration times this radius.
fn corner_radius_mm(before: &Vector3<f64>, after: &Vector3<f64>) -> f64 {
    let cosine = before.dot(after).clamp(-1.0, 1.0);
    // sin(w / 2) for the angle w between the way back and the way on.
    let sine = ((1.0 + cosine) / 2.0).sqrt();
    JUNCTION_DEVIATION_MM * sine / (1.0 - sine)
}

/// Seconds for one move. `entry` and `exit` are the squares of the speeds at its ends, mm2/s2.
fn trapezoid(stretch: &SpeedStretch, entry: f64, exit: f64, acceleration: f64) -> f64 {
    let &SpeedStretch { length_mm, most, .. } = stretch;
    let ends = entry.sqrt() + exit.sqrt();
    let peak = acceleration * length_mm + (entry + exit) / 2.0;
    if peak <= most {
        return (2.0 * peak.sqrt() - ends) / acceleration;
    }
    let speed = most.sqrt();
    let ramps_mm = (2.0 * most - entry - exit) / (2.0 * acceleration);
    (2.0 * speed - ends) / acceleration + (length_mm - ramps_mm) / speed
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{PI, SQRT_2, TAU};

    use nalgebra::Point3;
    use proptest::prelude::*;

    use super::*;
    use crate::geometry::curve::{Arc, Direction, Line, Parabola};
    use crate::geometry::plane::Plane;
    use crate::toolpath::measure::measure;
    use crate::toolpath::{Builder, Role};

    fn feed(mm_per_s: f64) -> FeedRate {
        FeedRate::from_mm_per_min(60.0 * mm_per_s).unwrap()
    }

    fn acceleration(value: f64) -> Acceleration {
        Acceleration::from_mm_per_s2(value).unwrap()
    }

    fn time(builder: &Builder, a: f64) -> f64 {
        motion_time(&builder.clone().finish().unwrap(), feed(100.0), acceleration(a)).unwrap()
    }

    fn line(builder: &mut Builder, to: [f64; 3], mm_per_s: f64) {
        builder.line(Point3::from(to), feed(mm_per_s), Role::Cut).unwrap();
    }

    fn close(a: f64, b: f64) {
        assert!((a - b).abs() <= 1e-12 * b, "{a} {b}");
    }

    #[test]
    fn a_line_is_a_triangle_or_a_trapezoid() {
        let mut short = Toolpath::builder(Point3::origin());
        line(&mut short, [4.0, 0.0, 0.0], 100.0);
        // It is at 63 mm/s halfway: 2 sqrt(l / a).
        close(time(&short, 1000.0), 2.0 * (4.0f64 / 1000.0).sqrt());
        let mut long = Toolpath::builder(Point3::origin());
        line(&mut long, [40.0, 0.0, 0.0], 100.0);
        // Two ramps of 5 mm in 0.1 s each, 30 mm between.
        close(time(&long, 1000.0), 0.5);
    }

    #[test]
    fn a_square_slows_down_at_each_corner() {
        let mut square = Toolpath::builder(Point3::origin());
        for to in [[10.0, 0.0, 0.0], [10.0, 10.0, 0.0], [0.0, 10.0, 0.0], [0.0, 0.0, 0.0]] {
            line(&mut square, to, 50.0);
        }
        let (a, l) = (1000.0, 10.0);
        let sine = SQRT_2 / 2.0;
        let corner = (a * 0.01 * sine / (1.0 - sine)).sqrt();
        // A side from v0 to v1 through 50 mm/s: ramps, and the rest at speed.
        let side = |v0: f64, v1: f64| {
            let ramps = (2.0 * 2500.0 - v0 * v0 - v1 * v1) / (2.0 * a);
            (100.0 - v0 - v1) / a + (l - ramps) / 50.0
        };
        close(time(&square, a), 2.0 * side(0.0, corner) + 2.0 * side(corner, corner));
    }

    #[test]
    fn a_circle_is_run_at_its_centripetal_speed() {
        let mut circle = Toolpath::builder(Point3::new(2.0, 0.0, 0.0));
        let about = (Plane::Xy, Direction::Ccw);
        circle.arc(circle.at(), Point3::origin(), about, feed(100.0), Role::Cut).unwrap();
        // sqrt(a r) = 44.7 mm/s is reached after 1 mm: v^2 / 2a = r / 2.
        let speed = 2000f64.sqrt();
        close(time(&circle, 1000.0), 2.0 * speed / 1000.0 + (2.0 * TAU - 2.0) / speed);
        // A helix is less curved: r / (r^2 + c^2) with the rise c of a radian.
        let mut helix = Toolpath::builder(Point3::new(2.0, 0.0, 0.0));
        let to = Point3::new(2.0, 0.0, 4.0 * PI);
        helix.arc(to, Point3::origin(), about, feed(100.0), Role::Cut).unwrap();
        let speed = 4000f64.sqrt();
        close(time(&helix, 1000.0), 2.0 * speed / 1000.0 + (TAU * 8f64.sqrt() - 4.0) / speed);
    }

    #[test]
    fn a_parabola_is_slow_near_its_vertex_alone() {
        for height in [0.0, 1e-6, 0.01, 1.0, 30.0] {
            let (start, control, end) =
                (Point3::origin(), [80.0, height, 0.0].into(), [0.0, height, 0.0].into());
            let parabola = Parabola::new(start, control, end).unwrap();
            let mut path = Toolpath::builder(start);
            path.parabola(end, control, feed(20.0), Role::Cut).unwrap();
            // The same curve as very many short lines. They slow down at each joint only as much as the small
            // turn there demands.
            let mut lines = Toolpath::builder(start);
            for k in 1..=2000 {
                lines.line(parabola.point_at(f64::from(k) / 2000.0), feed(20.0), Role::Cut).unwrap();
            }
            let (whole, by_lines) = (time(&path, 1000.0), time(&lines, 1000.0));
            let plain = parabola.length() / 20.0;
            assert!(whole >= plain && whole < 1.1 * plain, "{height}: {whole} {plain}");
            assert!((whole - by_lines).abs() < 0.05 * plain, "{height}: {whole} {by_lines}");
        }
    }

    #[test]
    fn without_a_feed_there_is_no_time() {
        let mut path = Toolpath::builder(Point3::origin());
        path.line(Point3::new(4.0, 0.0, 0.0), None, Role::Cut).unwrap();
        assert_eq!(motion_time(&path.finish().unwrap(), feed(100.0), acceleration(1.0)), None);
    }

    #[test]
    fn it_looks_ahead_over_many_moves() {
        // Moves of a hundredth of a millimetre to a standstill take the time of one line.
        let mut path = Toolpath::builder(Point3::origin());
        for k in 1..=1000 {
            line(&mut path, [0.01 * f64::from(k), 0.0, 0.0], 1000.0);
        }
        assert!((time(&path, 1000.0) - 2.0 * (10.0f64 / 1000.0).sqrt()).abs() < 1e-9);
    }

    #[test]
    fn it_rests_between_rapid_and_feed_and_at_a_dwell() {
        let mut path = Toolpath::builder(Point3::origin());
        path.rapid(Point3::new(4.0, 0.0, 0.0)).unwrap();
        line(&mut path, [8.0, 0.0, 0.0], 100.0);
        path.dwell(1.5).unwrap();
        line(&mut path, [8.0, 0.0, 0.0], 100.0);
        line(&mut path, [12.0, 0.0, 0.0], 100.0);
        close(time(&path, 1000.0), 6.0 * (4.0f64 / 1000.0).sqrt() + 1.5);
        assert_eq!(time(&Toolpath::builder(Point3::origin()), 1000.0), 0.0);
    }

    /// Lines, and half circles between them, each with a speed.
    fn hops() -> impl Strategy<Value = Vec<([f64; 3], f64, u8)>> {
        let to = prop::array::uniform3(-20.0..20.0f64);
        prop::collection::vec((to, 1.0..200.0f64, 0u8..4), 1..30)
    }

    /// The path; each move in `parts` equal parts.
    fn path(hops: &[([f64; 3], f64, u8)], parts: u32) -> Builder {
        let mut path = Toolpath::builder(Point3::origin());
        for (to, speed, kind) in hops {
            let (from, mut to) = (path.at(), Point3::from(*to));
            if *kind == 0 {
                path.rapid(to).unwrap();
                continue;
            }
            let center = Point3::new((from.x + to.x) / 2.0, (from.y + to.y) / 2.0, from.z);
            let turn = (Plane::Xy, Direction::Cw);
            to.z = if *kind == 1 { to.z } else { from.z };
            let curve = match Arc::with_center_near(turn.0, turn.1, from, to, center) {
                Ok(arc) if *kind > 1 => Curve::Arc(arc),
                _ => Curve::Line(Line { start: from, end: to }),
            };
            for k in 1..=parts {
                let end = curve.point_at(f64::from(k) / f64::from(parts));
                match &curve {
                    Curve::Line(_) | Curve::Parabola(_) => path.line(end, feed(*speed), Role::Cut).unwrap(),
                    Curve::Arc(arc) => {
                        path.arc(end, arc.center(), turn, feed(*speed), Role::Cut).unwrap();
                    }
                }
            }
        }
        path
    }

    proptest! {
        #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

        #[test]
        fn the_time_is_never_below_length_by_feed_and_falls_to_it(hops in hops()) {
            let path = path(&hops, 1);
            let plain = measure(&path.clone().finish().unwrap(), feed(100.0)).total_time_s.unwrap();
            let times = [1.0, 100.0, 1e4, 1e6, 1e12].map(|a| time(&path, a));
            prop_assert!(times.windows(2).all(|pair| pair[1] <= pair[0] * (1.0 + 1e-12)), "{times:?}");
            prop_assert!(times[4] >= plain * (1.0 - 1e-9));
            prop_assert!(times[4] <= plain * (1.0 + 1e-3) + 1e-3, "{} {plain}", times[4]);
        }

        #[test]
        fn dividing_moves_does_not_change_the_time(hops in hops(), parts in 2u32..6) {
            let (whole, divided) = (time(&path(&hops, 1), 1000.0), time(&path(&hops, parts), 1000.0));
            prop_assert!((whole - divided).abs() <= 1e-6 * whole, "{whole} {divided}");
        }
    }
}

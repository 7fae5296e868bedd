//! How far the tool strays from a straight motion while all axes move in step.
//!
//! # Method
//! While every axis moves at a constant speed from one position to another, the second derivatives of tip and
//! tool axis are bounded. A curve with the second derivative d leaves the chord of its ends by at most d / 8
//! at the same time. The tool axis has at most t^2 + 2 t w + w^2 sin a, where t and w are the turns of the
//! axes next to the tool and next to the workpiece, and a is its largest angle to the latter. A point that a
//! table turns by w, at the distance r of its centres, has at most w^2 r plus 2 w v for its own speed v. The
//! same bounds hold for the linear axes while the tip runs on a line and the angles turn in step.

use nalgebra::{Point3, Vector3};

use super::{AxisPositions, Machine};

/// How far a motion in step may leave the straight motion between its ends, at every moment.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Straying {
    /// The tip from its line, mm.
    pub tip_mm: f64,
    /// The tool axis from its great circle, radians.
    pub axis: f64,
}

impl Machine {
    /// Bounds of how far tip and axis leave the line and the great circle between their ends, while all axes
    /// move in step from one position to the other.
    pub fn straying(&self, from: &AxisPositions, to: &AxisPositions) -> Straying {
        let turns = [0, 1].map(|k| (to.rotary[k] - from.rotary[k]).abs());
        let bend = self.bend(turns, [from, to].map(|joints| Vector3::from(joints.linear_mm)));
        // The axis of the control and the axis of the toolpath both bend away from the chord of the ends. The
        // great circle of the toolpath bends no more than the motion of the control: hence twice its bend.
        let axis = self.axis_bend(turns, [from.rotary, to.rotary]) / 4.0;
        let axis = if axis < 1.0 { 2.0 * (0.5 * axis).asin() } else { std::f64::consts::PI };
        Straying { tip_mm: bend / 8.0, axis }
    }

    /// Bounds of the largest speeds of X, Y, Z (mm) and the rotary axes (radians), by the part of a motion
    /// from 0 to 1, while the tip runs on a line and the angles turn in step.
    pub fn ways(&self, tips: [Point3<f64>; 2], rotary: [[f64; 2]; 2]) -> [f64; 5] {
        const PARTS: u32 = 8;
        let turns = [0, 1].map(|k| rotary[1][k] - rotary[0][k]);
        let at = |n: u32| {
            let part = f64::from(n) / f64::from(PARTS);
            let angles = [0, 1].map(|k| rotary[0][k] + part * turns[k]);
            self.at(&(tips[0] + (tips[1] - tips[0]) * part), angles).linear_mm
        };
        let turns = turns.map(f64::abs);
        // Over a part, the speed differs from the mean by at most half the second derivative times the part.
        let beside = self.bend(turns, tips.map(|tip| tip.coords)) / f64::from(2 * PARTS);
        let mut ways = [0.0_f64; 3];
        for n in 0..PARTS {
            let [from, to] = [at(n), at(n + 1)];
            for k in 0..3 {
                ways[k] = ways[k].max((to[k] - from[k]).abs() * f64::from(PARTS) + beside);
            }
        }
        [ways[0], ways[1], ways[2], turns[0], turns[1]]
    }

    /// The bound of the second derivative of the tool axis by the part of a motion in step, by the turns of
    /// the two axes and their positions at both ends, radians.
    fn axis_bend(&self, turns: [f64; 2], ends: [[f64; 2]; 2]) -> f64 {
        let work = self.free_axis();
        let [of_tool, of_work] = [turns[1 - work], turns[work]];
        let sine = |rotary| self.tool_axis(rotary).cross(&self.lines[work].direction).norm();
        let largest = (ends.map(sine).into_iter().fold(f64::INFINITY, f64::min) + of_tool).min(1.0);
        of_tool * of_tool + 2.0 * of_tool * of_work + of_work * of_work * largest
    }

    /// The bound of the second derivative of a place by the part of a motion, mm, while it runs on a line
    /// between two places and turns by `turns` about the axes of the machine, radians.
    fn bend(&self, turns: [f64; 2], [start, end]: [Vector3<f64>; 2]) -> f64 {
        let heads = self.kind.heads();
        let of = |wants_head: bool| -> f64 {
            turns.iter().zip(heads).filter(|(_, is_head)| *is_head == wants_head).map(|(turn, _)| turn).sum()
        };
        let (table, head) = (of(false), of(true));
        let centres = self.lines.iter().zip(heads);
        let farthest = |wants_head: bool, from: [Vector3<f64>; 2]| -> f64 {
            let own: Vec<Vector3<f64>> = centres
                .clone()
                .filter(|(_, is_head)| *is_head == wants_head)
                .map(|(line, _)| line.point)
                .collect();
            let apart = own.windows(2).map(|pair| (pair[1] - pair[0]).norm()).sum::<f64>();
            let reach = |p: &Vector3<f64>| own.iter().map(|c| (p - c).norm()).fold(0.0, f64::max);
            apart + from.iter().map(reach).fold(0.0, f64::max)
        };
        let head_radius = if head > 0.0 { farthest(true, [Vector3::zeros(); 2]) } else { 0.0 };
        let speed = (end - start).norm() + head * head_radius;
        let bend = head * head * head_radius;
        let table_bend = if table > 0.0 {
            // A head moves the tip away from the linear position by at most twice its radius.
            let shift = if heads.contains(&true) { 2.0 * farthest(true, [Vector3::zeros(); 2]) } else { 0.0 };
            table * table * (farthest(false, [start, end]) + shift) + 2.0 * table * speed
        } else {
            0.0
        };
        bend + table_bend
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::machine::named::named;
    use crate::toolpath::pose::Pose;
    use crate::toolpath::tool_axes::angle_between;

    proptest! {
        #[test]
        fn the_tool_never_strays_farther_than_the_bound(
            k in 0usize..6,
            linear in [[-200.0..200.0, -200.0..200.0, -200.0..200.0], [-3.0..3.0, -3.0..3.0, -3.0..3.0f64]],
            rotary in [[-1.5..1.5, -3.0..3.0], [-0.2..0.2, -0.2..0.2f64]],
        ) {
            let machine = &named()[k];
            let from = AxisPositions { linear_mm: linear[0], rotary: rotary[0] };
            let along = |part: f64| AxisPositions {
                linear_mm: [0, 1, 2].map(|k| linear[0][k] + part * linear[1][k]),
                rotary: [0, 1].map(|k| rotary[0][k] + part * rotary[1][k]),
            };
            let bound = machine.straying(&from, &along(1.0));
            let ends = [0.0, 1.0].map(|part| machine.forward(&along(part)));
            for n in 0..=50 {
                let part = f64::from(n) / 50.0;
                let (own, straight) = (machine.forward(&along(part)), ends[0].between(&ends[1], part));
                let angle = angle_between(&own.axis, &straight.axis);
                prop_assert!((own.tip - straight.tip).norm() <= bound.tip_mm + 1e-10);
                prop_assert!(angle <= bound.axis + 1e-10);
            }
        }
    }

    proptest! {
        #[test]
        fn beside_the_pole_the_axis_strays_by_less_than_a_few_times_the_largest(
            k in 0usize..6,
            tilt in [-0.02..0.02, -0.02..0.02f64],
            turn in [-3.0..3.0, 0.2..1.0f64],
        ) {
            let machine = &named()[k];
            let work = machine.free_axis();
            let along = |part: f64| {
                let mut rotary = [0.0; 2];
                (rotary[1 - work], rotary[work]) = (tilt[0] + part * tilt[1], turn[0] + part * turn[1]);
                AxisPositions { linear_mm: [0.0; 3], rotary }
            };
            let bound = machine.straying(&along(0.0), &along(1.0)).axis;
            let ends = [0.0, 1.0].map(|part| machine.forward(&along(part)));
            let mut largest = 0.0_f64;
            for n in 0..=50 {
                let part = f64::from(n) / 50.0;
                let (own, straight) = (machine.forward(&along(part)), ends[0].between(&ends[1], part));
                largest = largest.max(angle_between(&own.axis, &straight.axis));
            }
            prop_assert!(largest <= bound + 1e-10);
            // A bound by the turns alone would be a quarter of their square.
            let far = tilt[0].abs() + tilt[1].abs();
            prop_assert!(bound <= 0.6 * far * (1.0 + turn[1]) * (1.0 + turn[1]));
        }

        #[test]
        fn no_axis_is_faster_than_its_way_under_tip_control(
            k in 0usize..6,
            tip in [[-200.0..200.0, -200.0..200.0, -200.0..200.0], [-3.0..3.0, -3.0..3.0, -3.0..3.0f64]],
            rotary in [[-1.5..1.5, -3.0..3.0], [-0.2..0.2, -0.2..0.2f64]],
        ) {
            let machine = &named()[k];
            let along = |part: f64| {
                let tip = [0, 1, 2].map(|k| tip[0][k] + part * tip[1][k]);
                machine.at(&tip.into(), [0, 1].map(|k| rotary[0][k] + part * rotary[1][k]))
            };
            let tips = [tip[0], [0, 1, 2].map(|k| tip[0][k] + tip[1][k])].map(Point3::from);
            let ways = machine.ways(tips, [along(0.0).rotary, along(1.0).rotary]);
            const PARTS: u32 = 50;
            for n in 0..PARTS {
                let [from, to] = [n, n + 1].map(|n| along(f64::from(n) / f64::from(PARTS)).linear_mm);
                for k in 0..3 {
                    let speed = (to[k] - from[k]).abs() * f64::from(PARTS);
                    prop_assert!(speed <= ways[k] + 1e-9);
                }
            }
        }
    }

    #[test]
    fn a_turning_table_strays_by_the_height_of_its_arc() {
        // 100 mm from the centre a turn by 0.1 radians has a chord height of r (1 - cos 0.05).
        let machine = &named()[0];
        let (axis, tip) = (Vector3::z_axis(), Point3::new(100.0, 0.0, 0.0));
        let from = machine.nearest(&Pose { tip, axis }, [0.0, 0.0]);
        let to = AxisPositions { rotary: [0.0, 0.1], ..from };
        let height = 100.0 * (1.0 - 0.05f64.cos());
        let bound = machine.straying(&from, &to).tip_mm;
        assert!(bound >= height && bound <= 1.01 * height, "{bound} {height}");
    }
}

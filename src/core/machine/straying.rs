//! How far the tool strays from a straight motion while all axes move in step.
//!
//! # Method
//! While every axis moves at a constant speed from one position to another, the second derivatives of tip and
//! tool axis are bounded. A curve with the second derivative d leaves the chord of its ends by at most d / 8
//! at the same time. With W the sum of the angles, the tool axis has at most W^2. A point that a table turns
//! by w, at the distance r of its centres, has at most w^2 r plus 2 w v for its own speed v.

use nalgebra::Vector3;

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
        let heads = self.kind.heads();
        let turns = [0, 1].map(|k| (to.rotary[k] - from.rotary[k]).abs());
        let of = |wants_head: bool| -> f64 {
            turns.iter().zip(heads).filter(|(_, is_head)| *is_head == wants_head).map(|(turn, _)| turn).sum()
        };
        let (table, head) = (of(false), of(true));
        let all = table + head;
        let [start, end] = [from, to].map(|joints| Vector3::from(joints.linear_mm));
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
        // The axis of the control and the axis of the toolpath both bend away from the chord of the ends. The
        // great circle of the toolpath bends no more than the motion of the control: hence twice its bend.
        let axis = all * all / 4.0;
        let axis = if axis < 1.0 { 2.0 * (0.5 * axis).asin() } else { std::f64::consts::PI };
        Straying { tip_mm: (bend + table_bend) / 8.0, axis }
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Point3;
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

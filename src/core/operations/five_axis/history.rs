//! The motion over time, for pictures: feed, acceleration and jerk of the tip, and the angles of the axis.

use nalgebra::Vector3;

use super::deviation::Deviation;
use super::motion::{ConstantFeed, differences};
use super::path::Path;
use super::{FiveAxisError, Job, Method, Plan, TimedPose, at_feed, rails};
use crate::budget::Budget;
use crate::toolpath::pose::Pose;

/// Values of one quantity with their times, s.
pub type Course = Vec<[f64; 2]>;

/// A motion over time.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct History {
    /// Speed, acceleration and jerk of the tip by differences of the samples: mm/s, mm/s2 and mm/s3.
    pub tip: [Course; 3],
    /// Names and angles, radians: of the rotary axes of the machine; without a machine of the tool axis, from
    /// Z toward X and toward Y.
    pub angles: [(String, Course); 2],
}

/// The motion along the given path at the feed, without limits and without ramps, and the motion of a plan.
/// Both start with the same positions of the axes.
///
/// # Errors
/// When the budget ends, and where the given path has no motion.
pub fn before_and_after(job: &Job, plan: &Plan, budget: &Budget) -> Result<[History; 2], FiveAxisError> {
    let given = Job { method: Method::Linear, limits: None, machine: None, ..job.clone() };
    let rails = rails(&given, &Path::new(&given.path, given.top_mm, Deviation::NONE)?, budget)?;
    let motion = ConstantFeed::new(&rails.rail);
    let period_s = given.period_s(motion.duration_s())?;
    let mut before = at_feed(None, &motion, period_s, budget)?;
    let start = plan.samples.first().and_then(|sample| sample.joints);
    if let Some((machine, start)) = job.machine.as_ref().zip(start) {
        let poses: Vec<Pose> = before.iter().map(|sample| sample.pose).collect();
        // Where the machine cannot follow, there are no angles.
        let joints = machine.follow(&poses, start.rotary).unwrap_or_default();
        for (sample, joints) in before.iter_mut().zip(joints) {
            sample.joints = Some(joints);
        }
    }
    Ok([History::of(job, &before, period_s), History::of(job, &plan.samples, plan.period_s)])
}

impl History {
    fn of(job: &Job, samples: &[TimedPose], period_s: f64) -> Self {
        let even = &samples[..samples.len().saturating_sub(1)];
        let mut rows: Vec<Vector3<f64>> = even.iter().map(|sample| sample.pose.tip.coords).collect();
        let tip = [1, 2, 3].map(|order| {
            rows = differences(&rows, period_s);
            // A difference belongs to the middle of the samples that it is made of.
            let at = |k: usize| (k as f64 + 0.5 * f64::from(order)) * period_s;
            rows.iter().enumerate().map(|(k, row)| [at(k), row.norm()]).collect()
        });
        let angles = [0, 1].map(|k| {
            let angle = |sample: &TimedPose| match job.machine {
                Some(_) => sample.joints.map(|joints| joints.rotary[k]),
                None => Some(sample.pose.axis[k].atan2(sample.pose.axis.z)),
            };
            let course = samples.iter().filter_map(|sample| Some([sample.t_s, angle(sample)?])).collect();
            let name = job.machine.as_ref().map(|machine| machine.rotary()[k].name.to_string());
            (name.unwrap_or_else(|| ["axis toward X", "axis toward Y"][k].to_owned()), course)
        });
        Self { tip, angles }
    }
}

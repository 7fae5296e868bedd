//! Toolpaths in answers.

use serde::{Serialize, Serializer};
use utoipa::ToSchema;

use super::axis::{AxisDirection, components};
use super::moves::Move;
use super::point::{Coordinates, Point};
use toolpathd_core::toolpath as core;
use toolpathd_core::toolpath::tool_axes::ToolAxes;

/// The moves of the tool's tip, in mm. Each move starts where the move before ended.
#[derive(Serialize, ToSchema)]
pub struct Toolpath {
    /// Where the tip stands before the first move, in mm.
    start: Point,
    /// The passes, in the order of cutting.
    #[serde(serialize_with = "write_passes")]
    #[schema(value_type = Vec<Pass>)]
    passes: core::Toolpath,
}

impl From<core::Toolpath> for Toolpath {
    fn from(passes: core::Toolpath) -> Self {
        Self { start: passes.start().into(), passes }
    }
}

/// Converts the moves one pass at a time while they are written, so that no second toolpath is held.
fn write_passes<S: Serializer>(toolpath: &core::Toolpath, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_seq(toolpath.passes().iter().map(Pass::from))
}

/// Moves that belong together: one pass with the way to the pass.
#[derive(Debug, Serialize, ToSchema)]
pub struct Pass {
    /// A number of the depth level that the pass belongs to. The program does not depend on it.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(maximum = 1_000_000)]
    level: Option<u32>,
    /// The tool axis at the start of the pass: three plain numbers without a unit. Where it differs from the
    /// axis before, the tool turns about its resting tip between the passes. Absent where the axis is
    /// straight up throughout.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(value_type = Option<AxisDirection>)]
    axis: Option<Coordinates<3>>,
    /// Where the tip stands before the first move of the pass, in mm, if the pass before ends elsewhere: the
    /// program goes there on a way that is not known. Only in answers of `/v1/programs/read`.
    #[serde(skip_serializing_if = "Option::is_none")]
    start: Option<Point>,
    /// The moves, in order.
    moves: Vec<Move>,
}

impl From<&core::Pass> for Pass {
    fn from(pass: &core::Pass) -> Self {
        let axes = pass.axes();
        let after = |k: usize| match axes {
            ToolAxes::Fixed(_) => None,
            ToolAxes::Turning { .. } => Some(axes.after(k)),
        };
        let moves = pass.moves().iter().enumerate().map(|(k, step)| Move::new(step, after(k)));
        Self {
            level: pass.level(),
            axis: (!axes.is_up()).then(|| components(&axes.start())),
            start: pass.start().map(Point::from),
            moves: moves.collect(),
        }
    }
}

/// Highest legal number of a level.
pub const MAX_LEVEL: u32 = 1_000_000;

#[cfg(test)]
mod tests {
    use nalgebra::Point3;
    use serde_json::json;

    use super::*;
    use toolpathd_core::geometry::{curve, plane};
    use toolpathd_core::toolpath::cutting::CuttingRequest;
    use toolpathd_core::toolpath::measure::measure_on;
    use toolpathd_core::toolpath::units::FeedRate;

    #[test]
    fn times_are_left_out_where_moves_have_no_feed() {
        let rate = FeedRate::from_mm_per_min(60.0);
        let cutting = CuttingRequest::at_feed(FeedRate::DEFAULT_RAPID).at_heights(0.0, 0.0);
        for (rate, times) in [(rate, [json!(3.0), json!(3.0)]), (None, [json!(null), json!(null)])] {
            let mut builder = core::Toolpath::builder(Point3::origin());
            builder.line(Point3::new(3.0, 0.0, 0.0), rate, core::Role::Cut).expect("a line");
            let measures = measure_on(&builder.finish().expect("a toolpath"), Some(&cutting));
            let measures = serde_json::to_value(measures).expect("JSON");
            assert_eq!(measures["cutting_length_mm"], 3.0);
            assert_eq!(["cutting_time_s", "total_time_s"].map(|name| measures[name].clone()), times);
            for name in ["cutting_time_s", "total_time_s", "time_with_acceleration_s"] {
                assert_eq!(measures.get(name).is_some(), rate.is_some(), "{name}");
            }
        }
    }

    #[test]
    fn moves_are_written_as_the_contract_names_them() {
        let rate = FeedRate::from_mm_per_min(800.0).expect("a feed");
        let mut builder = core::Toolpath::builder(Point3::new(10.0, 0.0, 5.0));
        builder.begin_pass(Some(2));
        builder.rapid(Point3::new(10.0, 0.0, 1.0)).expect("a rapid");
        builder.line(Point3::new(10.0, 0.0, 0.0), rate, core::Role::LeadIn).expect("a line");
        let (to, center) = (Point3::new(0.0, 10.0, 0.0), Point3::origin());
        let arc = (plane::Plane::Xy, curve::Direction::Ccw);
        builder.arc(to, center, arc, rate, core::Role::Cut).expect("an arc");
        let control = Point3::new(0.0, 5.0, 0.0);
        builder.parabola(Point3::new(5.0, 0.0, 0.0), control, rate, core::Role::Cut).expect("a parabola");
        builder.line(Point3::origin(), None, core::Role::Link).expect("a line");
        builder.dwell(0.5).expect("a dwell");
        let toolpath = Toolpath::from(builder.finish().expect("a toolpath"));
        assert_eq!(
            serde_json::to_value(&toolpath).expect("JSON"),
            json!({ "start": [10.0, 0.0, 5.0], "passes": [{ "level": 2, "moves": [
                { "kind": "rapid", "to": [10.0, 0.0, 1.0] },
                { "kind": "line", "to": [10.0, 0.0, 0.0], "feed_mm_per_min": 800.0, "role": "lead_in" },
                { "kind": "arc", "to": [0.0, 10.0, 0.0], "center": [0.0, 0.0, 0.0], "plane": "xy",
                  "direction": "ccw", "feed_mm_per_min": 800.0, "role": "cut" },
                { "kind": "parabola", "to": [5.0, 0.0, 0.0], "control": [0.0, 5.0, 0.0],
                  "feed_mm_per_min": 800.0, "role": "cut" },
                { "kind": "line", "to": [0.0, 0.0, 0.0], "role": "link" },
                { "kind": "dwell", "seconds": 0.5 },
            ] }] })
        );
    }
}

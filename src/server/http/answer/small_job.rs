//! Which jobs are small: half a second of work at most, by an estimate that costs microseconds.
//!
//! A small job may take the worker that is kept for small jobs, so an estimate that is far too low makes
//! other small jobs wait, and one that is too high makes this job wait for large ones. Neither changes an
//! answer.

use nalgebra::Point3;
use toolpathd_core::geometry::surface::source::Source;
use toolpathd_core::machining::wire_model::WireJob;
use toolpathd_core::operations::surface_milling::Spacing;
use toolpathd_core::operations::{
    arc_fitting, cutter_location, five_axis, interpolation, pocketing, surface_milling, surface_model,
};
use toolpathd_core::toolpath::tool::{Shape, Tool};

use crate::http::dto::dropping::DropJob;
use crate::http::dto::five_axis::SmoothJob;
use crate::http::dto::inspection::Inspection;
use crate::http::dto::modelling::ModelJob;
use crate::http::dto::program_reading::ProgramReading;
use crate::http::dto::program_writing::Writing;
use crate::http::dto::setup::JobWithSetup;
use crate::http::dto::verification::Verification;

/// Curves across patches that a processor computes in half a second: wires and passes of a ball cutter take
/// some 0.2 ms for each patch that they cross.
const BALL_CROSSINGS: f64 = 2_500.0;

/// The same for passes of other cutters, which take some 2 ms for each patch.
const OTHER_CROSSINGS: f64 = 250.0;

/// Points of a polyline whose arcs are found in half a second.
const FITTED_POINTS: usize = 4_000;

/// Places at which a cutter is dropped in half a second: the worst place of a bowl takes some milliseconds,
/// most take a hundredth of that.
const DROPPED_POINTS: usize = 1_000;

/// Poses that are joined in half a second, at some 2 ms for each.
const POSES: usize = 250;

/// The narrowest band of a small job, mm; a wider band needs fewer elements. Within this one, a curve takes a
/// few elements for each mm, and half a second in all.
const BAND_MM: f64 = 1e-4;

/// A job whose work can be estimated.
pub trait SmallJob {
    fn is_small(&self) -> bool;
}

impl<J: SmallJob> SmallJob for JobWithSetup<J> {
    fn is_small(&self) -> bool {
        self.job.is_small()
    }
}

impl SmallJob for arc_fitting::Job {
    fn is_small(&self) -> bool {
        self.points.len() <= FITTED_POINTS
    }
}

impl SmallJob for interpolation::Job {
    fn is_small(&self) -> bool {
        self.band.below_mm + self.band.above_mm >= BAND_MM
    }
}

impl SmallJob for pocketing::Job {
    /// Pockets of a usual size take longer than half a second.
    fn is_small(&self) -> bool {
        false
    }
}

impl SmallJob for Inspection {
    /// A short file may hold much: blocks that repeat, and curves that take long to fit.
    fn is_small(&self) -> bool {
        false
    }
}

impl SmallJob for Writing {
    /// A short body holds few moves.
    fn is_small(&self) -> bool {
        true
    }
}

impl SmallJob for ProgramReading {
    /// A short body may hold loops.
    fn is_small(&self) -> bool {
        !self.text.iter().any(|byte| b"#[LPKO".contains(&byte.to_ascii_uppercase()))
    }
}

impl SmallJob for Verification {
    /// A short body may hold a large stock.
    fn is_small(&self) -> bool {
        false
    }
}

impl SmallJob for SmoothJob {
    fn is_small(&self) -> bool {
        let five_axis::Job { path, .. } = &self.job;
        path.len() <= POSES
    }
}

impl SmallJob for DropJob {
    fn is_small(&self) -> bool {
        let cutter_location::Job { surface, points, .. } = &self.job;
        extent(surface).is_some() && points.len() <= DROPPED_POINTS
    }
}

impl SmallJob for ModelJob {
    fn is_small(&self) -> bool {
        let surface_model::Job { surface, wires, .. } = &self.job;
        let wires = wires.as_ref().map_or(0.0, |WireJob { pitch_mm, .. }| 1.0 / pitch_mm);
        extent(surface).is_some_and(|extent| extent.crossings(wires) <= BALL_CROSSINGS)
    }
}

impl SmallJob for surface_milling::Job {
    fn is_small(&self) -> bool {
        let Tool { shape, radius_mm, .. } = self.tool;
        let passes_per_mm = match self.spacing {
            Spacing::Stepover(stepover_mm) => 1.0 / stepover_mm,
            // The chord of a circle of the cutter's radius with this height.
            Spacing::ScallopHeight(height_mm) => 1.0 / (8.0 * radius_mm * height_mm).sqrt(),
            Spacing::WirePitch(pitch_mm) => 1.0 / pitch_mm,
        };
        let most = if shape == Shape::Ball { BALL_CROSSINGS } else { OTHER_CROSSINGS };
        extent(&self.surface).is_some_and(|extent| extent.crossings(passes_per_mm) <= most)
    }
}

/// How large a surface is.
struct Extent {
    /// The larger extent in x or y, mm.
    length_mm: f64,
    /// Patches along the side that has more of them.
    patches: usize,
}

impl Extent {
    /// The number of times that curves at a distance cross a patch.
    fn crossings(&self, curves_per_mm: f64) -> f64 {
        self.length_mm * curves_per_mm * self.patches as f64
    }
}

/// The extent of a surface whose data are points. `None` for swept and ruled surfaces: their patches are
/// known only when they are made.
fn extent(source: &Source) -> Option<Extent> {
    let of = |rows: usize, columns: usize, points: &mut dyn Iterator<Item = &Point3<f64>>| {
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for point in points {
            for k in 0..2 {
                low[k] = low[k].min(point[k]);
                high[k] = high[k].max(point[k]);
            }
        }
        let length_mm = (high[0] - low[0]).max(high[1] - low[1]);
        Some(Extent { length_mm, patches: rows.max(columns) })
    };
    let grid = |points: &[Vec<Point3<f64>>]| {
        of(points.len(), points.first().map_or(0, Vec::len), &mut points.iter().flatten())
    };
    match source {
        Source::PointGrid(source) => grid(&source.points),
        Source::Ferguson(source) => grid(&source.points),
        Source::Nurbs(source) => grid(&source.control_points),
        Source::NetGrid(source) => {
            let nets = &source.nets;
            let points = &mut nets.iter().flatten().flatten().flatten();
            of(nets.len(), nets.first().map_or(0, Vec::len), points)
        }
        Source::ParallelSweep(_) | Source::NormalSweep(_) | Source::Ruled(_) => None,
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;
    use toolpathd_core::budget::Budget;

    use super::*;
    use crate::config::Limits;
    use crate::http::decode::{IntoJob, job};
    use crate::http::dto::arc_fitting::FitRequest;
    use crate::http::dto::milling::MillRequest;
    use crate::http::dto::modelling::ModelRequest;

    fn is_small<T: IntoJob<Job: SmallJob>>(body: &serde_json::Value) -> bool {
        let job = job::<T>(body.to_string().as_bytes(), &Limits::DEFAULT, &Budget::unlimited());
        job.map(|sent| sent.job.is_small()).unwrap_or_else(|error| panic!("{}", error.detail()))
    }

    /// A wave of 60 mm by 60 mm.
    fn surface() -> serde_json::Value {
        let row = |i| (0..13).map(|j| [5 * i, 5 * j, (i * j) % 3]).collect::<Vec<_>>();
        json!({ "kind": "point_grid", "points": (0..13).map(row).collect::<Vec<_>>() })
    }

    fn milling(stepover_mm: f64, tool: serde_json::Value) -> bool {
        is_small::<MillRequest>(&json!({
            "surface": surface(), "tool": tool, "tolerance_mm": 0.01, "cutting": { "feed_mm_per_min": 800 },
            "strategy": { "kind": "cl_cartesian", "stepover_mm": stepover_mm },
        }))
    }

    #[test]
    fn the_spacing_of_passes_and_the_cutter_tell_how_much_work_milling_is() {
        let ball = json!({ "shape": "ball", "diameter_mm": 10 });
        let bull = json!({ "shape": "bull_nose", "diameter_mm": 10, "corner_radius_mm": 2 });
        assert!(milling(1.5, ball.clone()) && !milling(0.03, ball));
        assert!(milling(6.0, bull.clone()) && !milling(0.75, bull.clone()) && !milling(0.03, bull));
    }

    #[test]
    fn a_model_is_small_unless_its_wires_are_many_or_its_surface_is_swept() {
        let model = |pitch_mm: f64| {
            let wires = json!({ "pitch_mm": pitch_mm, "direction": "x" });
            is_small::<ModelRequest>(&json!({ "surface": surface(), "wires": wires }))
        };
        assert!(model(5.0) && !model(0.01));
        let swept = include_str!("../../../../openapi/examples/surfaces-model/parallel-sweep.json");
        assert!(!is_small::<ModelRequest>(&serde_json::from_str(swept).expect("JSON")));
    }

    #[test]
    fn the_number_of_points_tells_how_much_work_a_fit_is() {
        let fit = |n: usize| {
            let points: Vec<_> = (0..n).map(|k| [k, k % 2]).collect();
            is_small::<FitRequest>(&json!({ "polyline": points, "tolerance_mm": 0.01 }))
        };
        assert!(fit(100) && !fit(FITTED_POINTS + 1));
    }
}

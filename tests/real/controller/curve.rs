//! Checks a curve that is interpolated by parabolas: the control's path lies within the band of the curve.

use std::path::Path;

use nalgebra::{Point2, Point3};
use toolpathd_core::budget::Budget;
use toolpathd_core::geometry::deviation::{Band, Measure};
use toolpathd_core::operations::interpolation::{Job, Joints, Method, Source, Subdivision, plan};
use toolpathd_core::toolpath::cutting::CuttingRequest;
use toolpathd_core::toolpath::program::{Program, Resolution, Units};
use toolpathd_core::toolpath::units::FeedRate;
use toolpathd_post::{ProgramJob, dialect};

use crate::canon::{self, Motion};

/// Half the width of the band, mm.
const BAND_MM: f64 = 0.01;

/// Number of steps between the compared points of each motion.
const POINTS: usize = 200;

/// How much rounding to three decimals may add to a distance, mm.
const ROUNDING_MM: f64 = 0.0015;

/// The curve: y = 20 sin(x / 20), mm.
fn height(x: f64) -> f64 {
    20.0 * (x / 20.0).sin()
}

/// The distance of a point from the curve, mm, by ternary search within 1 mm of the point's x.
fn distance(p: Point2<f64>) -> f64 {
    let to = |x: f64| (p - Point2::new(x, height(x))).norm();
    let (mut low, mut high) = (p.x - 1.0, p.x + 1.0);
    while high - low > 1e-12 {
        let third = (high - low) / 3.0;
        if to(low + third) < to(high - third) { high -= third } else { low += third }
    }
    to(low)
}

/// Interprets the program of the curve. Returns as text the number of parabolas and the largest distance of a
/// point from the curve.
pub fn check(directory: &Path) -> Result<String, String> {
    let linuxcnc = dialect("linuxcnc").ok_or("no dialect")?;
    let feed = FeedRate::from_mm_per_min(600.0).ok_or("no feed")?;
    let resolution = Resolution { units: Units::Mm, decimals: 3 };
    let curve = Source::Graph { expression: "20*sin(x/20)".into(), domain: [0.0, 130.0] };
    let band = Band { below_mm: BAND_MM, above_mm: BAND_MM, measure: Measure::Normal };
    let job = Job {
        cutting: Some(CuttingRequest::at_feed(feed)),
        resolution,
        curves: linuxcnc.curves,
        ..Job::new(curve, Method::Parabolic, Subdivision::Least(Joints::OnCurve), band)
    };
    let plan = plan(&job, &Budget::unlimited()).map_err(|error| error.to_string())?;
    let program = Program::plain(resolution);
    let cutting = plan.cutting.ok_or("no conditions")?;
    let written = toolpathd_post::write(
        &plan.toolpath,
        &ProgramJob::plain(&program, &cutting, linuxcnc),
        &Budget::unlimited(),
    )
    .map_err(|error| error.to_string())?;
    let motions = canon::interpret(&written.text, directory, "curve")?;
    let (mut parabolas, mut farthest) = (0, 0.0f64);
    let mut end = Point3::origin();
    for motion in &motions {
        if let Motion::Parabola { curve, .. } = motion {
            parabolas += 1;
            for k in 0..=POINTS {
                farthest = farthest.max(distance(curve.at(k as f64 / POINTS as f64).xy()));
            }
            end = curve.end();
        }
    }
    if parabolas != plan.report.elements.len()
        || (end.xy() - Point2::new(130.0, height(130.0))).norm() > ROUNDING_MM
    {
        return Err(format!("{parabolas} parabolas end at {end}"));
    }
    if farthest > BAND_MM + ROUNDING_MM {
        return Err(format!("a point lies {farthest} mm from the curve"));
    }
    Ok(format!("{parabolas} parabolas, farthest point {farthest:.5} mm from the curve"))
}

//! Describes a surface: its patches, its bounding box, its largest concave curvature, and a wire model of it.
//!
//! # Method
//! 1. Build the surface from its data.
//! 2. Trace the wires of the requested wire model ([`wire_model`]).
//! 3. Find the bounding box by branch and bound on the control nets of the patches. Find the largest concave
//!    curvature in the same way.
//!
//! # Guarantees
//! * The box contains the surface. Each side of the box is at most [`BOUNDS_ACCURACY_MM`] mm away from the
//!   surface. It may be farther away if the surface touches this side along a whole curve.
//! * The curvature is an upper bound. It exceeds the true largest curvature by at most a hundredth, unless
//!   the search reaches its limit of work.
//!
//! # Cost
//! O(m + n) for m patches and n points of wires.

use nalgebra::{Point3, Vector3};

use crate::budget::{Budget, Stopped};
use crate::geometry::surface::any_surface::AnySurface;
use crate::geometry::surface::joints::{self, NotSmooth};
use crate::geometry::surface::source::{Source, SourceError};
use crate::geometry::surface::{BezierSurface, Patch, Surface, curvature};
use crate::machining::wire_model::{self, Wire, WireError, WireJob};

/// How far a side of the box may exceed the surface, mm, unless the surface touches that side along a whole
/// curve.
pub const BOUNDS_ACCURACY_MM: f64 = 1e-6;

#[derive(Debug, Clone, PartialEq)]
pub struct Job {
    pub surface: Source,
    pub wires: Option<WireJob>,
    /// A surface with more control points is refused.
    pub control_point_limit: usize,
}

#[derive(Debug, Clone, PartialEq)]
pub struct Model {
    /// The surface, with u and v as in its data.
    pub surface: AnySurface,
    /// The corners of the box around it, mm.
    pub bounds: [Point3<f64>; 2],
    pub wires: Option<Vec<Wire>>,
    /// The largest distance of the surface from the points that it interpolates, mm; `None` for data without
    /// such points.
    pub fit_deviation_max_mm: Option<f64>,
    /// Proved upper bound of the concave curvature, seen from above, 1/mm. It is negative if the surface is
    /// convex everywhere, and `None` if the surface has a place without a normal.
    pub curvature_max_concave_per_mm: Option<f64>,
    pub warnings: Vec<Warning>,
}

/// Something the caller should know that does not stop the model.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Warning {
    #[error("not-a-knot ends need 4 points along {direction}; there are {points}")]
    EndsReduced { direction: &'static str, points: usize },
    #[error("{0}")]
    NotSmooth(NotSmooth),
    #[error(
        "the surface has, or may have, a place without a normal, such as a pole: the report has no curvature"
    )]
    NoNormal,
}

#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum Error {
    #[error(transparent)]
    Stopped(#[from] Stopped),
    #[error(transparent)]
    Source(#[from] SourceError),
    #[error(transparent)]
    Wires(#[from] WireError),
    #[error("the patches have {needed} control points; at most {limit} are allowed")]
    TooManyControlPoints { needed: usize, limit: usize },
}

/// Models the surface.
///
/// # Errors
/// When the data make no surface, there are too many control points or wires, a wire cannot be traced, or the
/// budget stops.
pub fn model(job: &Job, budget: &Budget) -> Result<Model, Error> {
    let surface = job.surface.surface()?;
    let (needed, limit) = (surface.n_control_points(), job.control_point_limit);
    if needed > limit {
        return Err(Error::TooManyControlPoints { needed, limit });
    }
    let findings = match &surface {
        AnySurface::Bicubic(surface) => examine(surface, job, budget)?,
        AnySurface::Rational(surface) => examine(surface, job, budget)?,
        AnySurface::HighDegree(surface) => examine(surface, job, budget)?,
    };
    let Findings { bounds, wires, curvature, not_smooth } = findings;
    let reduced = job.surface.reduced_ends().into_iter();
    let warnings = reduced
        .map(|(direction, points)| Warning::EndsReduced { direction, points })
        .chain(not_smooth.map(Warning::NotSmooth))
        .chain(curvature.is_none().then_some(Warning::NoNormal))
        .collect();
    Ok(Model {
        fit_deviation_max_mm: job.surface.nodes().map(|points| fit_deviation(&surface, points)),
        bounds,
        wires,
        curvature_max_concave_per_mm: curvature,
        warnings,
        surface,
    })
}

struct Findings {
    bounds: [Point3<f64>; 2],
    wires: Option<Vec<Wire>>,
    curvature: Option<f64>,
    not_smooth: Option<NotSmooth>,
}

fn examine<P: Patch>(surface: &BezierSurface<P>, job: &Job, budget: &Budget) -> Result<Findings, Error> {
    let upward = surface.clone().upward();
    // The wires come first: a job that needs too many of them is refused before anything else is computed.
    budget.progress("wires", 0, 3);
    let wires = match &job.wires {
        None => None,
        Some(wires) if wires.runs_along_a_parameter() => Some(wire_model::wires(surface, wires, budget)?),
        Some(wires) => Some(wire_model::wires(&upward, wires, budget)?),
    };
    budget.progress("bounds", 1, 3);
    let not_smooth = match joints::examine(surface, &job.surface.loose_joints(), budget) {
        Ok(_) => None,
        Err(NotSmooth::Stopped(stopped)) => return Err(stopped.into()),
        Err(fault) => Some(fault),
    };
    let bounds = bounds(surface, budget)?;
    budget.progress("curvature", 2, 3);
    let curvature = curvature::most_concave(&upward, budget)?;
    Ok(Findings { bounds, wires, curvature, not_smooth })
}

fn bounds(surface: &BezierSurface<impl Patch>, budget: &Budget) -> Result<[Point3<f64>; 2], Stopped> {
    let (mut low, mut high) = (Point3::origin(), Point3::origin());
    for axis in 0..3 {
        let unit = Vector3::ith(axis, 1.0);
        high[axis] = surface.farthest_along(&unit, BOUNDS_ACCURACY_MM, budget)?;
        low[axis] = 0.0 - surface.farthest_along(&-unit, BOUNDS_ACCURACY_MM, budget)?;
    }
    Ok([low, high])
}

/// The largest distance of a grid of points from the places of the surface that should pass through them, mm.
fn fit_deviation(surface: &AnySurface, points: &[Vec<Point3<f64>>]) -> f64 {
    let rows = points.iter().enumerate();
    let deviations = rows.flat_map(|(i, row)| {
        row.iter().enumerate().map(move |(j, p)| (surface.jet(i as f64, j as f64).point - p).norm())
    });
    deviations.fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::surface::net_grid::NetGrid;
    use crate::geometry::surface::point_grid::{Ends, PointGrid, Twist};
    use crate::machining::wire_model::Along;

    fn grid(height: impl Fn(f64, f64) -> f64, ends: Ends, n: usize) -> Source {
        let row =
            |i: usize| (0..n).map(|j| Point3::new(i as f64, j as f64, height(i as f64, j as f64))).collect();
        Source::PointGrid(PointGrid { points: (0..n).map(row).collect(), twist: Twist::Spline, ends })
    }

    fn modelled(surface: Source, wires: Option<WireJob>) -> Model {
        model(&Job { surface, wires, control_point_limit: usize::MAX }, &Budget::unlimited()).unwrap()
    }

    #[test]
    fn a_bowl_is_described_by_its_closed_forms() {
        // z = 0.1 (x^2 + y^2) about (3, 3).
        let bowl = |x: f64, y: f64| 0.1 * ((x - 3.0).powi(2) + (y - 3.0).powi(2));
        let model = modelled(grid(bowl, Ends::NotAKnot, 7), None);
        let [low, high] = model.bounds;
        assert!((low - Point3::new(0.0, 0.0, 0.0)).norm() < 1e-5, "{low}");
        assert!((high - Point3::new(6.0, 6.0, 1.8)).norm() < 1e-5, "{high}");
        assert!(model.fit_deviation_max_mm.unwrap() < 1e-12);
        let curvature = model.curvature_max_concave_per_mm.unwrap();
        assert!((0.2..0.203).contains(&curvature), "{curvature}");
        assert_eq!((model.warnings, model.wires), (vec![], None));
    }

    #[test]
    fn concave_is_seen_from_above_whatever_the_order_of_the_points() {
        let dome = |x: f64, y: f64| -0.1 * ((x - 3.0).powi(2) + (y - 3.0).powi(2));
        let Source::PointGrid(mut source) = grid(dome, Ends::NotAKnot, 7) else { unreachable!() };
        source.points.reverse();
        let curvature = modelled(Source::PointGrid(source), None).curvature_max_concave_per_mm.unwrap();
        assert!(curvature < 0.0, "{curvature}");
    }

    #[test]
    fn too_many_control_points_are_refused_before_anything_is_computed() {
        let surface = grid(|x, y| x * y, Ends::NotAKnot, 5);
        let stopped = Budget::unlimited();
        stopped.cancel();
        let with_limit = |control_point_limit| {
            model(&Job { surface: surface.clone(), wires: None, control_point_limit }, &stopped)
        };
        assert_eq!(with_limit(255), Err(Error::TooManyControlPoints { needed: 256, limit: 255 }));
        assert_eq!(with_limit(256), Err(Error::Stopped(Stopped::Cancelled)));
    }

    #[test]
    fn wires_run_as_they_are_asked_for() {
        let source = grid(|x, _| 0.5 * x, Ends::Natural, 5);
        for (along, changing) in [(Along::U, 0), (Along::X, 0), (Along::V, 1), (Along::Y, 1)] {
            let job =
                WireJob { along, pitch_mm: 1.0, chord_height_mm: 0.01, wire_limit: 50, point_limit: 10_000 };
            let wires = modelled(source.clone(), Some(job)).wires.unwrap();
            for wire in &wires {
                let way = wire[wire.len() - 1] - wire[0];
                assert!((way[changing].abs() - 4.0).abs() < 1e-6, "{along:?} {way}");
                assert!(way[1 - changing].abs() < 1e-6, "{along:?} {way}");
            }
            // Wires along v are spaced along the slope, wires along y in plan.
            let spaces = if along == Along::V { 20f64.sqrt().ceil() } else { 4.0 };
            assert_eq!(wires.len(), spaces as usize + 1, "{along:?}");
        }
    }

    #[test]
    fn edges_and_poles_are_warnings() {
        let net = |slope: f64, x0: f64| {
            let at = |a: usize, b: usize| Point3::new(x0 + a as f64, b as f64, slope * a as f64);
            std::array::from_fn(|a| std::array::from_fn(|b| at(a, b)))
        };
        let roof = Source::NetGrid(NetGrid { nets: vec![vec![net(0.0, 0.0)], vec![net(1.0, 3.0)]] });
        let model = modelled(roof, None);
        assert!(
            matches!(model.warnings[..], [Warning::NotSmooth(NotSmooth::Edge { .. })]),
            "{:?}",
            model.warnings
        );
        let mut pole = net(0.2, 0.0);
        pole[0] = [Point3::new(0.0, 1.5, 0.0); 4];
        let model = modelled(Source::NetGrid(NetGrid { nets: vec![vec![pole]] }), None);
        assert_eq!(model.warnings, [Warning::NoNormal]);
        assert_eq!(model.curvature_max_concave_per_mm, None);
    }
}

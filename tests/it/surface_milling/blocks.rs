//! Passes over blocks run from end to end.
//!
//! The parts are plain, stepped and drafted blocks with round coordinates. The section planes are exactly one
//! cutter radius apart. Every cutter, both directions of section planes and every boundary are tried.

use nalgebra::Point3;
use toolpathd_core::budget::Budget;
use toolpathd_core::geometry::surface::net_grid::NetGrid;
use toolpathd_core::geometry::surface::point_grid::Ends;
use toolpathd_core::geometry::surface::source::Source;
use toolpathd_core::operations::surface_milling::{Boundary, Error, Job, SectionPlane, Warning, plan};
use toolpathd_core::toolpath::tool::{Shape, Tool};
use toolpathd_core::toolpath::{Move, Role};

use super::corruption::{HALF_LENGTH_MM, RADIUS_MM, extruded};
use super::jobs::{PLANES, heights, job};

const TOLERANCE_MM: f64 = 0.01;

/// With `boundary: past`, passes end this far beyond the edges, as a multiple of the cutter radius.
const PAST: f64 = 1.1;

/// Profiles with level ends, x and z in mm.
const PROFILES: [&[[f64; 2]]; 5] = [
    &[[0.0, 0.0], [60.0, 0.0]],
    &[[0.0, 0.0], [20.0, 0.0], [20.0, 15.0], [60.0, 15.0], [60.0, 0.0], [80.0, 0.0]],
    &[[0.0, 0.0], [20.0, 0.0], [20.0, 8.0], [40.0, 8.0], [40.0, 16.0], [60.0, 16.0]],
    &[[0.0, 0.0], [20.0, 0.0], [21.0, 20.0], [39.0, 20.0], [40.0, 0.0], [60.0, 0.0]],
    &[[0.0, 20.0], [20.0, 20.0], [20.0, 0.0], [48.0, 0.0], [48.0, 20.0], [60.0, 20.0]],
];

/// The planes that a job cuts. Each comes with the ranges of the coordinate along the plane that its passes
/// cover, mm.
fn covered(job: &Job, name: &str) -> Vec<(f64, Vec<[f64; 2]>)> {
    let plan = plan(job, &Budget::unlimited()).unwrap();
    let (across, along) = if job.plane == SectionPlane::Zx { (1, 0) } else { (0, 1) };
    let mut planes: Vec<(f64, Vec<[f64; 2]>)> = Vec::new();
    let mut is_cutting = false;
    for step in plan.toolpath.moves() {
        let Move::Feed { along: curve, role: Role::Cut, .. } = step else {
            is_cutting = false;
            continue;
        };
        let ends = [curve.start()[along], curve.end()[along]];
        let [low, high] = [ends[0].min(ends[1]), ends[0].max(ends[1])];
        let at = curve.start()[across];
        if planes.last().is_none_or(|(known, _)| (known - at).abs() > 1e-6) {
            planes.push((at, Vec::new()));
        }
        let passes = &mut planes.last_mut().unwrap().1;
        match passes.last_mut() {
            Some([from, to]) if is_cutting => (*from, *to) = (from.min(low), to.max(high)),
            _ => passes.push([low, high]),
        }
        is_cutting = true;
    }
    let is_told = plan.warnings.iter().any(|warning| matches!(warning, Warning::ShortPiecesLeftOut { .. }));
    assert!(!is_told, "{name}: pieces were left out: {:?} {planes:?}", plan.warnings);
    planes
}

#[test]
fn passes_over_blocks_run_from_end_to_end() {
    let shapes = [Shape::Ball, Shape::Flat, Shape::BullNose { corner_radius_mm: 1.5 }];
    for profile in PROFILES {
        let width = profile[profile.len() - 1][0];
        for shape in shapes {
            for plane in PLANES {
                for boundary in [Boundary::On, Boundary::Inside, Boundary::Past] {
                    let any = heights(4, [0.0, 1.0], Ends::Natural, |_, _| 0.0);
                    let job = Job {
                        surface: extruded(profile),
                        tool: Tool { shape, ..Tool::ball(RADIUS_MM) },
                        plane,
                        boundary,
                        ..job(any, 2.0 * RADIUS_MM, RADIUS_MM, TOLERANCE_MM, 3)
                    };
                    let margin = match boundary {
                        Boundary::Inside => RADIUS_MM,
                        Boundary::On => 0.0,
                        Boundary::Past => -PAST * RADIUS_MM,
                    };
                    let [x, y] = [[0.0, width], [-HALF_LENGTH_MM, HALF_LENGTH_MM]]
                        .map(|[low, high]| [low + margin, high - margin]);
                    let (across, along) = if plane == SectionPlane::Zx { (y, x) } else { (x, y) };
                    let name = format!("{profile:?} {shape:?} {plane:?} {boundary:?}");
                    let planes = covered(&job, &name);
                    let spaces = ((across[1] - across[0]) / RADIUS_MM - 1e-6).ceil() as usize;
                    let is_near = |a: f64, b: f64| (a - b).abs() <= TOLERANCE_MM;
                    assert_eq!(planes.len(), spaces + 1, "{name}: the number of planes is wrong: {planes:?}");
                    assert!(
                        is_near(planes[0].0, across[0]),
                        "{name}: the first plane is not at the boundary: {planes:?}"
                    );
                    assert!(
                        is_near(planes[spaces].0, across[1]),
                        "{name}: the last plane is not at the boundary: {planes:?}"
                    );
                    for (at, passes) in &planes {
                        let mut passes = passes.clone();
                        passes.sort_by(|a, b| a[0].total_cmp(&b[0]));
                        let is_joined = passes.windows(2).all(|pair| pair[1][0] - pair[0][1] <= TOLERANCE_MM);
                        let ends = [passes[0][0], passes[passes.len() - 1][1]];
                        assert!(
                            is_joined && is_near(ends[0], along[0]) && is_near(ends[1], along[1]),
                            "{name}: the passes at {at} do not run from end to end: {passes:?}"
                        );
                    }
                }
            }
        }
    }
}

#[test]
fn a_surface_that_shrinks_to_a_point_is_refused_as_nothing_to_cut() {
    let any = heights(4, [0.0, 1.0], Ends::Natural, |_, _| 0.0);
    for plane in PLANES {
        let surface = Source::NetGrid(point());
        let job = Job { surface, plane, allowance_mm: 0.25, ..job(any.clone(), 8.0, 2.0, 0.01, 3) };
        let refused = plan(&job, &Budget::unlimited());
        assert!(matches!(refused, Err(Error::NothingToCut)), "not refused as nothing to cut: {refused:?}");
    }
}

/// Two patches whose control points all coincide.
fn point() -> NetGrid {
    NetGrid { nets: vec![vec![[[Point3::origin(); 4]; 4]; 2]] }
}

//! The same part moved, turned, mirrored, with its points in another order, or measured with noise.

use nalgebra::{Point3, Vector3};
use toolpathd_core::geometry::surface::point_grid::{Ends, PointGrid};
use toolpathd_core::geometry::surface::source::Source;
use toolpathd_core::operations::surface_milling::{
    CutDirection, Engine, Error, Job, Report, SectionPlane, Spacing,
};

use super::jobs::{PLANES, die, grid_of, heights, job, points};
use super::spline::Spline;
use super::verdict::judge;
use crate::arc_fitting::inputs::Random;

/// The die with a coarser stepover, and with added heights that break its symmetries.
fn lopsided(plane: SectionPlane) -> Job {
    let mut job = Job { spacing: Spacing::Stepover(16.0), ..die(plane, CutDirection::Zigzag) };
    for point in points(&mut job) {
        point.z += 0.0004 * point.x * point.x + 0.02 * point.y;
    }
    job
}

fn mapped(job: &Job, plane: SectionPlane, map: impl Fn(&Point3<f64>) -> Point3<f64>) -> Job {
    let mut mapped = Job { plane, ..job.clone() };
    for point in points(&mut mapped) {
        *point = map(point);
    }
    mapped
}

fn renumbered(job: &Job, order: impl Fn(&[Vec<Point3<f64>>]) -> Vec<Vec<Point3<f64>>>) -> Job {
    let grid = grid_of(job);
    let surface = PointGrid { points: order(&grid.points), ..grid.clone() };
    Job { surface: Source::PointGrid(surface), ..job.clone() }
}

/// Judges `variant`, and fails if its report differs much from that of the `original`. Rounding and the
/// choice of the ends of elements may change the figures a little.
fn is_alike(original: &Report, variant: &Job) {
    let report = judge(variant).unwrap().0.report;
    assert_eq!(report.n_passes, original.n_passes, "another number of passes: {report:?} {original:?}");
    let near = |a: usize, b: usize| a.abs_diff(b) * 10 <= a.max(b);
    assert!(
        near(report.n_arcs + report.n_lines, original.n_arcs + original.n_lines),
        "another number of moves: {report:?} {original:?}"
    );
    assert!(
        near(report.n_cl_points, original.n_cl_points),
        "another number of CL points: {report:?} {original:?}"
    );
    let tolerance = variant.tolerance.mm();
    assert!((report.deviation_max_mm - original.deviation_max_mm).abs() < 0.3 * tolerance);
    assert!((report.gouge_max_mm - original.gouge_max_mm).abs() < 0.3 * tolerance);
}

#[test]
fn a_turned_or_mirrored_part_has_nearly_the_same_report() {
    for (plane, other) in [PLANES, [PLANES[1], PLANES[0]]].map(|p| (p[0], p[1])) {
        let job = lopsided(plane);
        let report = judge(&job).unwrap().0.report;
        is_alike(&report, &mapped(&job, other, |p| Point3::new(-p.y, p.x, p.z)));
        is_alike(&report, &mapped(&job, plane, |p| Point3::new(-p.x, p.y, p.z)));
        is_alike(&report, &mapped(&job, other, |p| Point3::new(p.y, p.x, p.z)));
    }
}

#[test]
fn turned_plates_and_a_bowl_are_cut_from_end_to_end() {
    for plane in PLANES {
        for degrees in [0.1f64, 10.0, 45.0] {
            let (sin, cos) = degrees.to_radians().sin_cos();
            let plate = job(heights(4, [0.0, 10.0], Ends::Natural, |x, _| 0.1 * x), 2.0, 2.0, 0.01, 3);
            let turned = |p: &Point3<f64>| Point3::new(cos * p.x - sin * p.y, sin * p.x + cos * p.y, p.z);
            judge(&mapped(&plate, plane, turned)).unwrap();
        }
        // The outermost CL points of a bowl are at its corners.
        let bowl = heights(4, [-5.0, 5.0], Ends::NotAKnot, |x, y| 0.01 * (x * x + y * y));
        judge(&Job { plane, ..job(bowl, 2.0, 2.0, 0.01, 3) }).unwrap();
    }
}

#[test]
fn a_sharp_corner_is_cut_up_to_its_tip() {
    // Just below its tip, the kite is 0.001 mm wide: too little to be cut.
    let corners = [[7.0, -2.0], [8.0, 0.0], [6.3, 0.0], [8.0, 8.0]];
    let square = heights(4, [0.0, 1.0], Ends::Natural, |_, _| 0.0);
    let kite = |p: &Point3<f64>| {
        let shares = [(1.0 - p.x) * (1.0 - p.y), p.x * (1.0 - p.y), (1.0 - p.x) * p.y, p.x * p.y];
        let [x, y] = [0, 1].map(|axis| (0..4).map(|k| shares[k] * corners[k][axis]).sum());
        Point3::new(x, y, 0.0)
    };
    let square = job(square, 2.5, 2.0, 0.01, 3);
    for engine in [Engine::Contact, Engine::OffsetSection] {
        let square = Job { engine, ..square.clone() };
        judge(&mapped(&square, SectionPlane::Zx, kite)).unwrap();
        judge(&mapped(&square, SectionPlane::Yz, |p| Point3::from(kite(p).coords.yxz()))).unwrap();
    }
}

#[test]
fn a_grid_in_another_order_has_nearly_the_same_report() {
    let transposed = |points: &[Vec<Point3<f64>>]| -> Vec<Vec<_>> {
        (0..points[0].len()).map(|j| points.iter().map(|row| row[j]).collect()).collect()
    };
    let rows = |points: &[Vec<_>]| points.iter().rev().cloned().collect::<Vec<_>>();
    let columns = |points: &[Vec<Point3<f64>>]| -> Vec<Vec<_>> {
        points.iter().map(|row| row.iter().rev().copied().collect()).collect()
    };
    for plane in PLANES {
        let job = lopsided(plane);
        let report = judge(&job).unwrap().0.report;
        is_alike(&report, &renumbered(&job, transposed));
        is_alike(&report, &renumbered(&job, rows));
        is_alike(&report, &renumbered(&job, columns));
        is_alike(&report, &renumbered(&job, |points| transposed(&rows(points))));
    }
}

#[test]
fn a_part_far_from_the_origin_has_nearly_the_same_report() {
    for plane in PLANES {
        let job = lopsided(plane);
        let report = judge(&job).unwrap().0.report;
        is_alike(&report, &mapped(&job, plane, |p| p + Vector3::new(1000.0, -2000.0, 300.0)));
    }
}

/// The least value of 1 - radius x curvature over dense samples within `reach` (mm) of `place` in x and y.
/// The offset folds where the value is zero or less.
fn least_room(job: &Job, place: Point3<f64>, reach: f64) -> f64 {
    let surface = Spline::through(grid_of(job));
    let size = surface.size();
    let mut least = f64::INFINITY;
    for i in 0..=400 {
        for j in 0..=400 {
            let jet = surface.jet([size[0] * f64::from(i) / 400.0, size[1] * f64::from(j) / 400.0]);
            if (jet.point - place).xy().norm() <= reach {
                least = least.min(1.0 - job.tool.radius_mm * jet.hollow());
            }
        }
    }
    least
}

/// The numbers of noisy copies of `job` that are cut, and that are refused because the ball does not fit.
fn cut_and_refused(job: &Job, amplitude_mm: f64, seeds: std::ops::Range<u64>) -> [usize; 2] {
    let mut counts = [0, 0];
    for seed in seeds {
        let mut random = Random::stream(seed);
        let mut noisy = Job { engine: Engine::OffsetSection, ..job.clone() };
        for point in points(&mut noisy) {
            for k in 0..3 {
                point[k] += random.between(-amplitude_mm, amplitude_mm);
            }
        }
        match judge(&noisy) {
            Ok(_) => {
                let room = least_room(&noisy, Point3::origin(), f64::INFINITY);
                assert!(
                    room > 0.0,
                    "seed {seed}: cut although the offset folds: 1 - radius x curvature is {room}"
                );
                counts[0] += 1;
            }
            Err(Error::OffsetFolds { at }) => {
                let room = least_room(&noisy, at, 0.5);
                assert!(
                    room < 0.02,
                    "seed {seed}: refused at {at}, where the offset does not fold: 1 - radius x curvature is {room}"
                );
                counts[1] += 1;
            }
            Err(other) => panic!("seed {seed}: refused for another reason: {other}"),
        }
    }
    counts
}

#[test]
fn noisy_points_are_cut_correctly_or_refused_where_the_ball_does_not_fit() {
    for plane in PLANES {
        // On a part of 80 mm the noise hardly bends the surface.
        let die = Job { spacing: Spacing::Stepover(16.0), ..die(plane, CutDirection::Zigzag) };
        assert_eq!(cut_and_refused(&die, 0.05, 1..3), [2, 0]);
        // On a part of 8 mm the noise bends the surface to about the radius of the ball.
        let surface = heights(9, [0.0, 8.0], Ends::NotAKnot, |x, y| 0.2 * x.sin() + 0.1 * y);
        let small = Job { plane, ..job(surface, 2.5, 2.0, 0.01, 3) };
        let mut counts = [0, 0];
        for first in (1..100).step_by(10) {
            let more = cut_and_refused(&small, 0.05, first..first + 10);
            counts = [0, 1].map(|k| counts[k] + more[k]);
            // Ten parts alike happen with one seed in some forty.
            if counts.iter().all(|count| *count > 0) {
                break;
            }
        }
        assert!(counts.iter().all(|count| *count > 0), "{} cut, {} refused", counts[0], counts[1]);
    }
}

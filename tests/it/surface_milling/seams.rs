//! Surfaces that are closed on themselves or end in a pole. Passes go over seams and poles as over any other
//! place: the material that they leave does not depend on where the seam is.

use std::f64::consts::{FRAC_1_SQRT_2, TAU};

use nalgebra::{Point3, Vector3};
use toolpathd_core::budget::Budget;
use toolpathd_core::geometry::curve::Curve;
use toolpathd_core::geometry::surface::any_surface::AnySurface;
use toolpathd_core::geometry::surface::ferguson::Ferguson;
use toolpathd_core::geometry::surface::net_grid::NetGrid;
use toolpathd_core::geometry::surface::nurbs::Nurbs;
use toolpathd_core::geometry::surface::point_grid::{Ends, PointGrid, Twist};
use toolpathd_core::geometry::surface::source::Source;
use toolpathd_core::geometry::surface::{Jet, Surface};
use toolpathd_core::operations::surface_milling::{Boundary, Engine, Job, Plan, SectionPlane, plan};
use toolpathd_core::toolpath::tool::{Shape, Tool};
use toolpathd_core::toolpath::units::{FeedRate, Tolerance};
use toolpathd_core::toolpath::{Move, Role};

/// Distance of the checked places along a path, mm.
const PATH_MM: f64 = 0.1;

/// Samples of a surface along u and v, for each patch.
const SAMPLES: usize = 24;

/// A profile in (distance from the axis, z), as a Bezier curve of degree 1 or 2 with weights.
#[derive(Clone)]
pub struct Profile {
    points: Vec<[f64; 2]>,
    weights: Vec<f64>,
}

pub fn cone() -> Profile {
    Profile { points: vec![[30.0, 0.0], [12.0, 9.0]], weights: vec![1.0; 2] }
}

pub fn funnel() -> Profile {
    Profile { points: vec![[12.0, 0.0], [30.0, 9.0]], weights: vec![1.0; 2] }
}

pub fn dome(radius: f64) -> Profile {
    let points = vec![[radius, 0.0], [radius, radius], [0.0, radius]];
    Profile { points, weights: vec![1.0, FRAC_1_SQRT_2, 1.0] }
}

pub fn pointed_cone() -> Profile {
    Profile { points: vec![[15.0, 0.0], [0.0, 6.0]], weights: vec![1.0; 2] }
}

/// The outer upper quarter of a torus.
pub fn quarter_torus() -> Profile {
    let points = vec![[20.0, 0.0], [20.0, 5.0], [15.0, 5.0]];
    Profile { points, weights: vec![1.0, FRAC_1_SQRT_2, 1.0] }
}

/// The surface of a profile revolved about the vertical axis through (`shift`, `shift`), with its seam at the
/// angle `turned`, as NURBS.
pub fn revolved(profile: &Profile, turned: f64, shift: f64) -> Source {
    let degree = profile.points.len() - 1;
    let corner = |k: usize| if k.is_multiple_of(2) { 1.0 } else { FRAC_1_SQRT_2 };
    let row = |k: usize| {
        // The last row is the first one to the last digit, as CAD systems write it.
        let (sin, cos) = (turned + TAU * (k % 8) as f64 / 8.0).sin_cos();
        let at =
            |[r, z]: &[f64; 2]| Point3::new(shift + r / corner(k) * cos, shift + r / corner(k) * sin, *z);
        profile.points.iter().map(at).collect()
    };
    Source::Nurbs(Nurbs {
        degree: [2, degree],
        knots: [
            vec![0.0, 0.0, 0.0, 1.0, 1.0, 2.0, 2.0, 3.0, 3.0, 4.0, 4.0, 4.0],
            [vec![0.0; degree + 1], vec![1.0; degree + 1]].concat(),
        ],
        control_points: (0..9).map(row).collect(),
        weights: Some((0..9).map(|k| profile.weights.iter().map(|w| w * corner(k)).collect()).collect()),
    })
}

/// The cone through rings of `n` points, of which the first is repeated at the end.
fn ring_grid(n: usize, turned: f64) -> PointGrid {
    let row = |k: usize| {
        let (sin, cos) = (turned + TAU * (k % n) as f64 / n as f64).sin_cos();
        (0..4)
            .map(|j| {
                let r = 30.0 - 6.0 * f64::from(j);
                Point3::new(r * cos, r * sin, 3.0 * f64::from(j))
            })
            .collect()
    };
    PointGrid { points: (0..=n).map(row).collect(), twist: Twist::Spline, ends: Ends::Usual }
}

/// The same cone with given tangents.
fn ferguson(n: usize, turned: f64) -> Source {
    let grid = ring_grid(n, turned);
    let step = TAU / n as f64;
    let around = |p: &Point3<f64>| Vector3::new(-p.y, p.x, 0.0) * step;
    let up =
        |p: &Point3<f64>| Vector3::new(-6.0 * p.x, -6.0 * p.y, 0.0) / p.x.hypot(p.y) + Vector3::z() * 3.0;
    let each = |f: &dyn Fn(&Point3<f64>) -> Vector3<f64>| {
        grid.points.iter().map(|row| row.iter().map(f).collect()).collect()
    };
    Source::Ferguson(Ferguson {
        tangents_u: each(&around),
        tangents_v: each(&up),
        points: grid.points.clone(),
        twists: None,
    })
}

/// The same cone as four bicubic patches. A cubic curve leaves a quarter of a circle by 0.03 % of its radius.
fn patches(turned: f64) -> Source {
    let reach = 4.0 / 3.0 * (2.0f64.sqrt() - 1.0);
    let net = |i: usize| {
        let [from, to] = [i, i + 1].map(|k| (turned + TAU * (k % 4) as f64 / 4.0).sin_cos());
        let around = [
            [from.1, from.0],
            [from.1 - reach * from.0, from.0 + reach * from.1],
            [to.1 + reach * to.0, to.0 - reach * to.1],
            [to.1, to.0],
        ];
        around.map(|[x, y]| {
            [0.0, 1.0, 2.0, 3.0].map(|b| Point3::new(x * (30.0 - 6.0 * b), y * (30.0 - 6.0 * b), 3.0 * b))
        })
    };
    Source::NetGrid(NetGrid { nets: (0..4).map(|i| vec![net(i)]).collect() })
}

pub fn job(surface: Source, tool: Tool, stepover_mm: f64) -> Job {
    let tolerance = Tolerance::from_mm(0.01).unwrap();
    Job::new(surface, tool, stepover_mm, tolerance, FeedRate::from_mm_per_min(1000.0).unwrap())
}

fn cutters(radius_mm: f64) -> [Tool; 3] {
    let corner_radius_mm = 0.4 * radius_mm;
    [Shape::Ball, Shape::Flat, Shape::BullNose { corner_radius_mm }]
        .map(|shape| Tool { shape, ..Tool::ball(radius_mm) })
}

/// The runs of cuts of a path: dense tips, in order.
pub fn runs(plan: &Plan) -> Vec<Vec<Point3<f64>>> {
    let mut runs: Vec<Vec<Point3<f64>>> = Vec::new();
    let mut is_open = false;
    for step in plan.toolpath.moves() {
        let Move::Feed { along, role: Role::Cut, .. } = step else {
            is_open = false;
            continue;
        };
        if !is_open {
            runs.push(Vec::new());
            is_open = true;
        }
        let n = (along.length() / PATH_MM).ceil().max(1.0) as usize;
        let run = runs.last_mut().unwrap();
        run.extend((0..=n).map(|k| along.point_at(k as f64 / n as f64)));
    }
    runs
}

/// The distance from a point to a cutter with its tip at `tip`, mm; negative inside.
fn distance(tool: &Tool, tip: &Point3<f64>, p: &Point3<f64>) -> f64 {
    let corner = match tool.shape {
        Shape::Ball => tool.radius_mm,
        Shape::Flat => 0.0,
        Shape::BullNose { corner_radius_mm } => corner_radius_mm,
        _ => unreachable!("mills are balls, flat ends and bull noses"),
    };
    let flat = tool.radius_mm - corner;
    let (r, z) = ((p - tip).xy().norm(), p.z - tip.z);
    match (r <= flat, z >= corner) {
        (true, _) => -z,
        (false, true) => r - tool.radius_mm,
        (false, false) => (r - flat).hypot(corner - z) - corner,
    }
}

/// Dense jets of a surface.
pub fn jets(source: &Source) -> Vec<Jet> {
    fn of(surface: &dyn Surface) -> Vec<Jet> {
        let [nu, nv] = surface.spans().map(|n| n * SAMPLES);
        let at = |k: usize| k as f64 / SAMPLES as f64;
        (0..=nu).flat_map(|i| (0..=nv).map(move |j| surface.jet(at(i), at(j)))).collect()
    }
    match source.surface().unwrap() {
        AnySurface::Bicubic(surface) => of(&surface),
        AnySurface::Rational(surface) => of(&surface),
        AnySurface::HighDegree(surface) => of(&surface),
    }
}

/// The largest distance from the cut material to those points of the surface that `counts`, mm, with its place.
pub fn left(job: &Job, plan: &Plan, counts: impl Fn(&Jet) -> bool) -> (f64, Point3<f64>) {
    let tips: Vec<Point3<f64>> = runs(plan).into_iter().flatten().collect();
    let cell = job.tool.radius_mm;
    let key = |p: &Point3<f64>| [p.x, p.y].map(|c| (c / cell).floor() as i64);
    let mut cells = std::collections::HashMap::<[i64; 2], Vec<Point3<f64>>>::new();
    tips.iter().for_each(|tip| cells.entry(key(tip)).or_default().push(*tip));
    let mut most = (0.0, Point3::origin());
    for jet in jets(&job.surface).iter().filter(|jet| counts(jet)) {
        let [x, y] = key(&jet.point);
        let near = (-2..=2).flat_map(|i| (-2..=2).map(move |j| [x + i, y + j]));
        let near = near.filter_map(|cell| cells.get(&cell)).flatten();
        let least = near.map(|tip| distance(&job.tool, tip, &jet.point)).fold(job.tool.radius_mm, f64::min);
        if least > most.0 {
            most = (least, jet.point);
        }
    }
    most
}

/// Where the seams lie: in a plane of passes, across planes, and at odd angles.
const TURNS: [f64; 3] = [0.0, TAU / 4.0, 0.37];

/// Plans the job with its seam at every angle, and checks that no angle leaves more than another.
fn leaves_the_same_wherever_the_seam_is(
    surface: impl Fn(f64) -> Source,
    tool: Tool,
    change: impl Fn(Job) -> Job,
) {
    let all: Vec<(f64, Point3<f64>)> = TURNS
        .iter()
        .map(|turned| {
            let job = change(job(surface(*turned), tool, 2.0));
            let plan = plan(&job, &Budget::unlimited()).unwrap();
            // Beside an edge that crosses the planes at an angle, passes end early.
            let clear = match job.boundary {
                Boundary::Past => 12.0..=30.0,
                Boundary::On => 15.0..=26.0,
                Boundary::Inside => 18.0..=23.0,
            };
            left(&job, &plan, |jet| clear.contains(&jet.point.x.hypot(jet.point.y)))
        })
        .collect();
    let least = all.iter().map(|(most, _)| *most).fold(f64::INFINITY, f64::min);
    for (turned, (most, at)) in TURNS.iter().zip(&all) {
        assert!(
            *most <= 1.15 * least + 0.01,
            "{tool:?}, seam at {turned}: {most} mm left at {at}, elsewhere {least}"
        );
    }
    // Passes 2 mm apart on a slope of 27 degrees.
    if tool.shape == Shape::Ball {
        let radius = tool.radius_mm;
        let across = 2.0 * 1.25f64.sqrt() / 2.0;
        let closed_form = radius - (radius * radius - across * across).sqrt();
        assert!((0.5 * closed_form..1.3 * closed_form + 0.01).contains(&least), "{least} {closed_form}");
    }
}

#[test]
fn passes_on_cones_and_funnels_do_not_depend_on_the_place_of_the_seam() {
    for profile in [cone(), funnel()] {
        let surface = |turned| revolved(&profile, turned, 0.0);
        for boundary in [Boundary::On, Boundary::Inside, Boundary::Past] {
            leaves_the_same_wherever_the_seam_is(surface, Tool::ball(3.0), |job| Job { boundary, ..job });
        }
        for tool in cutters(3.0) {
            let plane = SectionPlane::Yz;
            leaves_the_same_wherever_the_seam_is(surface, tool, |job| Job { plane, ..job });
        }
        leaves_the_same_wherever_the_seam_is(
            |turned| revolved(&profile, turned, 0.0),
            Tool::ball(3.0),
            |job| Job { engine: Engine::OffsetSection, ..job },
        );
    }
}

#[test]
fn passes_on_closed_grids_and_patches_do_not_depend_on_the_place_of_the_seam() {
    for boundary in [Boundary::On, Boundary::Inside, Boundary::Past] {
        let change = |job| Job { boundary, ..job };
        leaves_the_same_wherever_the_seam_is(patches, Tool::ball(3.0), change);
        leaves_the_same_wherever_the_seam_is(|turned| ferguson(24, turned), Tool::ball(3.0), change);
        let grid = |turned| Source::PointGrid(ring_grid(24, turned));
        leaves_the_same_wherever_the_seam_is(grid, Tool::ball(3.0), change);
    }
}

#[test]
fn the_cone_of_the_seam_in_the_plane_y_0_is_cut_in_whole_passes() {
    let job = Job { boundary: Boundary::On, ..job(revolved(&cone(), 0.0, 0.0), Tool::ball(3.0), 2.0) };
    for n in 20..40 {
        // Whatever the stepover, every pass goes from ring to ring.
        let job = Job {
            spacing: toolpathd_core::operations::surface_milling::Spacing::Stepover(65.0 / f64::from(n)),
            ..job.clone()
        };
        let plan = plan(&job, &Budget::unlimited()).unwrap();
        let runs = runs(&plan);
        for run in &runs {
            let y = run[0].y;
            let ends = [run[0], run[run.len() - 1]].map(|p| p.x);
            // The tip of a ball on the slope lies 1.34 mm farther out than the contact.
            let reach = |r: f64| (r * r - y * y).max(0.0).sqrt();
            let [outer, inner] = [30.0 + 1.3416, 12.0 + 1.3416].map(reach);
            let [far, near] = [ends[0].abs().max(ends[1].abs()), ends[0].abs().min(ends[1].abs())];
            assert!((far - outer).abs() < 0.05, "{n}: the pass at {y} ends at {far}, not at {outer}");
            assert!(
                (near - inner).abs() < 0.05 || inner == 0.0 && (near - outer).abs() < 0.05,
                "{n}: the pass at {y} begins at {near}, not at {inner}"
            );
        }
        let expected = runs.iter().filter(|run| run[0].y.abs() < 12.0 + 1.34).count();
        assert_eq!(expected % 2, 0, "{n}: an odd number of passes beside the hole");
    }
}

#[test]
fn a_dome_is_cut_over_its_seam_and_its_pole_up_to_the_outline() {
    for turned in [0.0, 0.4, TAU / 8.0, TAU / 4.0] {
        for (tool, shift) in cutters(3.0).into_iter().zip([0.0, 5.0, -3.0]) {
            let surface = revolved(&dome(10.0), turned, shift);
            let job = Job { boundary: Boundary::Inside, ..job(surface, tool, 1.0) };
            let plan = plan(&job, &Budget::unlimited()).unwrap();
            let runs = runs(&plan);
            let mut planes: Vec<f64> = runs.iter().map(|run| run[0].y - shift).collect();
            planes.dedup_by(|a, b| (*a - *b).abs() < 1e-9);
            assert_eq!(planes.len(), runs.len(), "{tool:?}: more than one pass in a plane");
            assert!(planes.windows(2).all(|pair| pair[1] - pair[0] <= 1.0 + 1e-9), "{planes:?}");
            for (run, y) in runs.iter().zip(&planes).filter(|(_, y)| y.abs() < 6.9) {
                let reach = (49.0 - y * y).sqrt();
                let ends = [run[0].x - shift, run[run.len() - 1].x - shift].map(f64::abs);
                assert!(
                    ends.iter().all(|end| (end - reach).abs() < 0.02),
                    "{tool:?} {y}: {ends:?} not {reach}"
                );
            }
            // A ball touches the sphere where the radius of its centre is longer by its own.
            let counts = |jet: &Jet| (jet.point - Point3::new(shift, shift, 0.0)).xy().norm() < 4.0;
            let (most, at) = left(&job, &plan, counts);
            // Twice the distance of the passes would leave four times as much under a ball and a bull nose.
            let most_left = if tool.shape == Shape::Flat { 0.2 } else { 0.1 };
            assert!(most < most_left, "{tool:?}, seam at {turned}: {most} mm left at {at}");
        }
    }
}

#[test]
fn a_pointed_cone_and_a_torus_are_cut_without_a_strip_left() {
    for turned in [0.0, 0.4, TAU / 4.0] {
        for (profile, boundary, clear) in [
            (pointed_cone(), Boundary::On, 0.0..=12.0),
            (pointed_cone(), Boundary::Inside, 0.0..=10.0),
            (quarter_torus(), Boundary::On, 15.6..=17.5),
        ] {
            for tool in cutters(2.0) {
                let job = Job { boundary, ..job(revolved(&profile, turned, 0.0), tool, 0.8) };
                let plan = plan(&job, &Budget::unlimited()).unwrap();
                let counts = |jet: &Jet| clear.contains(&jet.point.x.hypot(jet.point.y));
                let (most, at) = left(&job, &plan, counts);
                // A flat end leaves steps as high as the slope between two passes.
                let most_left = if tool.shape == Shape::Flat { 0.4 } else { 0.12 };
                assert!(most < most_left, "{tool:?} {boundary:?}, seam at {turned}: {most} mm left at {at}");
            }
        }
    }
}

#[test]
fn inside_no_move_at_feed_leaves_the_outline() {
    use toolpathd_core::operations::surface_milling::{Entry, Exit};
    let surface = revolved(&cone(), 0.3, 0.0);
    for (entry, exit) in [
        (Entry::Plunge, Exit::Arc { radius_mm: 8.0 }),
        (Entry::Arc { radius_mm: 5.0 }, Exit::Retract),
        (Entry::Ramp { slope: 0.1 }, Exit::Arc { radius_mm: 1.0 }),
    ] {
        let job =
            Job { boundary: Boundary::Inside, entry, exit, ..job(surface.clone(), Tool::ball(3.0), 2.0) };
        let plan = plan(&job, &Budget::unlimited()).unwrap();
        let feeds = plan.toolpath.moves().filter_map(|step| match step {
            Move::Feed { along, .. } => Some(along),
            _ => None,
        });
        for along in feeds {
            for k in 0..=50 {
                let tip = Curve::point_at(along, f64::from(k) / 50.0);
                let r = tip.x.hypot(tip.y);
                assert!((15.0 - 2e-3..27.0 + 2e-3).contains(&r), "{entry:?} {exit:?}: {r} at {tip}");
            }
        }
    }
}

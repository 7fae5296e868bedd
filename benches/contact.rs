//! CPU time for a metre of path by contact, for eight surfaces and three cutters of 6 mm, within 0.01 mm.
//!
//! `taskset -c 0 cargo bench --bench contact [-- SURFACE CUTTER]`
//!
//! Words of the command line choose rows whose names contain them. Only work of the first thread counts, so one
//! processor must do it all. The columns are CPU seconds of one thread
//! for a metre of cuts: the whole job, its points alone, and its certificate alone. The points are traced over
//! the planes of the passes, within the height of sections that a job begins with. The last column is the CPU
//! time of a drop in microseconds: drops on a grid of positions over the whole part.

use std::f64::consts::{FRAC_1_SQRT_2, PI};

use nalgebra::{Point3, Vector2};
use toolpathd_core::budget::Budget;
use toolpathd_core::geometry::curve::Curve;
use toolpathd_core::geometry::profile::{Piece, Profile, Shape as Piecewise};
use toolpathd_core::geometry::surface::any_surface::AnySurface;
use toolpathd_core::geometry::surface::net_grid::NetGrid;
use toolpathd_core::geometry::surface::normal_sweep::NormalSweep;
use toolpathd_core::geometry::surface::nurbs::Nurbs;
use toolpathd_core::geometry::surface::point_grid::{Ends, PointGrid, Twist};
use toolpathd_core::geometry::surface::ruled::Ruled;
use toolpathd_core::geometry::surface::source::Source;
use toolpathd_core::geometry::surface::{BezierSurface, Patch};
use toolpathd_core::machining::drop_cutter::{Contacts, TipSections};
use toolpathd_core::machining::gouge::{GougeProof, Penetration};
use toolpathd_core::machining::offset_section::{PlaneAt, Spacing};
use toolpathd_core::operations::surface_milling::{Job, plan};
use toolpathd_core::toolpath::tool::{Shape, Tool};
use toolpathd_core::toolpath::units::{FeedRate, Tolerance};
use toolpathd_core::toolpath::{Move, Role};

const TOLERANCE_MM: f64 = 0.01;

/// The height of sections over chords with which a job by contact begins, as a share of the tolerance.
const HEIGHT_SHARE: f64 = 0.06;

/// The share of the tolerance within which a job's certificate is sharp.
const GAP_SHARE: f64 = 0.02;

/// Drops each way.
const DROPS: usize = 60;

fn main() {
    let words: Vec<String> = std::env::args().skip(1).filter(|word| !word.starts_with("--")).collect();
    let is_chosen = |name: &str, word: usize| words.get(word).is_none_or(|word| name.contains(word.as_str()));
    println!("| surface | cutter | length, m | whole, s/m | points, s/m | certificate, s/m | us a drop |");
    println!("|---|---|--:|--:|--:|--:|--:|");
    for (name, source, stepover_mm) in surfaces() {
        for (cutter, shape) in [
            ("ball", Shape::Ball),
            ("bull nose", Shape::BullNose { corner_radius_mm: 1.0 }),
            ("flat", Shape::Flat),
        ] {
            if is_chosen(name, 0) && is_chosen(cutter, 1) {
                row(name, &source, stepover_mm, cutter, shape);
            }
        }
    }
}

fn row(name: &str, source: &Source, stepover_mm: f64, cutter: &str, shape: Shape) {
    let tolerance = Tolerance::from_mm(TOLERANCE_MM).unwrap();
    let feed = FeedRate::from_mm_per_min(1000.0).unwrap();
    let tool = Tool { shape, ..Tool::ball(3.0) };
    let job = Job::new(source.clone(), tool, stepover_mm, tolerance, feed);
    let before = cpu_s();
    let planned = plan(&job, &Budget::unlimited());
    let whole = cpu_s() - before;
    let planned = match planned {
        Ok(planned) => planned,
        Err(error) => return println!("| {name} | {cutter} | {error} after {whole:.1} s | | | | |"),
    };
    let (mut all, mut cuts, mut planes) = (Vec::new(), 0.0, Vec::new());
    for step in planned.toolpath.moves() {
        match step {
            Move::Feed { along, role, .. } => {
                if *role == Role::Cut {
                    cuts += along.length() / 1e3;
                    planes.push(along.start().y);
                }
                all.push(*along);
            }
            Move::Rapid { line } => all.push(Curve::Line(*line)),
            Move::Turn { .. } | Move::Dwell { .. } => {}
        }
    }
    planes.sort_by(f64::total_cmp);
    planes.dedup();
    let [points, certificate, drop] = match source.surface().unwrap() {
        AnySurface::Bicubic(surface) => steps(surface.upward(), &job, &planes, &all),
        AnySurface::Rational(surface) => steps(surface.upward(), &job, &planes, &all),
        AnySurface::HighDegree(surface) => steps(surface.upward(), &job, &planes, &all),
    };
    println!(
        "| {name} | {cutter} | {cuts:.2} | {:.3} | {:.3} | {:.3} | {:.1} |",
        whole / cuts,
        points / cuts,
        certificate / cuts,
        drop * 1e6
    );
}

/// CPU seconds of the points and of the certificate of all moves, and of one drop.
fn steps<P: Patch>(surface: BezierSurface<P>, job: &Job, planes: &[f64], moves: &[Curve]) -> [f64; 3] {
    let budget = Budget::unlimited();
    let spacing = Spacing { chord_height_mm: HEIGHT_SHARE * TOLERANCE_MM, step_length_mm: f64::INFINITY };
    let start = cpu_s();
    let contacts = Contacts::new(&surface, job.tool.cutter(), &budget).unwrap();
    let sections = TipSections::new(&contacts, 1, &budget).unwrap();
    for plane in planes {
        sections.chains(PlaneAt::new(*plane), spacing, &budget).unwrap();
    }
    let traced = cpu_s();
    let proof = GougeProof::new(&surface, &job.tool.cutter(), 0.0);
    let mut deepest = Penetration::NONE;
    for curve in moves {
        proof.penetrate(curve, 0.0, GAP_SHARE * TOLERANCE_MM, &mut deepest, &budget).unwrap();
    }
    let certified = cpu_s();
    let bounds = contacts.bounds();
    for k in 0..DROPS * DROPS {
        let share = Vector2::new((k / DROPS) as f64 + 0.5, (k % DROPS) as f64 + 0.5) / DROPS as f64;
        let at = bounds.min.xy() + (bounds.max - bounds.min).xy().component_mul(&share);
        contacts.drop(at, None, &budget).unwrap();
    }
    [traced - start, certified - traced, (cpu_s() - certified) / (DROPS * DROPS) as f64]
}

/// CPU time of this thread, s.
fn cpu_s() -> f64 {
    let times = std::fs::read_to_string("/proc/thread-self/schedstat").expect("Linux with its /proc");
    times.split_whitespace().next().and_then(|ns| ns.parse::<f64>().ok()).expect("nanoseconds") / 1e9
}

/// The surfaces, each with the distance of its passes, mm.
fn surfaces() -> Vec<(&'static str, Source, f64)> {
    vec![
        ("sine surface", sine(), 4.0),
        ("patches with kinks", kinks(), 4.0),
        ("weights 0.5 to 2", weights(), 4.0),
        ("bowl", bowl(), 4.0),
        ("torus", torus(), 4.0),
        ("ruled splines", ruled(), 3.0),
        ("sweep around an L", sweep(), 4.0),
        ("measured points", measured(), 10.0),
    ]
}

/// Numbers from 0 to 1 that look random.
struct Noise(u64);

impl Noise {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.next()
    }
}

fn grid(n: [usize; 2], pitch: f64, mut height: impl FnMut(f64, f64) -> f64) -> Source {
    let at = |k: usize| pitch * k as f64;
    let mut point = |i: usize, j: usize| Point3::new(at(i), at(j), height(at(i), at(j)));
    let points = (0..n[0]).map(|i| (0..n[1]).map(|j| point(i, j)).collect()).collect();
    Source::PointGrid(PointGrid { points, twist: Twist::Spline, ends: Ends::NotAKnot })
}

fn wave(x: f64, y: f64) -> f64 {
    10.0 * (PI * x / 40.0).sin() * (PI * y / 40.0).cos()
}

/// A wave of 20 mm through 15 x 15 points at 5 mm.
fn sine() -> Source {
    grid([15, 15], 5.0, wave)
}

/// 40 x 30 points at 2 mm of a flat wave, with noise of 2 um.
fn measured() -> Source {
    let mut noise = Noise(5);
    grid([40, 30], 2.0, |x, y| 0.3 * wave(x, y) + noise.between(-2e-3, 2e-3))
}

/// 4 x 4 bicubic nets of 15 mm that meet without a common tangent.
fn kinks() -> Source {
    let mut noise = Noise(1);
    let heights: Vec<Vec<f64>> =
        (0..13).map(|_| (0..13).map(|_| noise.between(0.0, 5.0)).collect()).collect();
    let point = |a: usize, b: usize| Point3::new(5.0 * a as f64, 5.0 * b as f64, heights[a][b]);
    let net =
        |i: usize, j: usize| std::array::from_fn(|a| std::array::from_fn(|b| point(3 * i + a, 3 * j + b)));
    Source::NetGrid(NetGrid { nets: (0..4).map(|i| (0..4).map(|j| net(i, j)).collect()).collect() })
}

/// 7 x 7 bicubic control points at 10 mm with heights of 0 to 8 mm and weights of 0.5 to 2.
fn weights() -> Source {
    let (n, mut noise) = (7, Noise(2));
    let mut points = vec![vec![Point3::origin(); n]; n];
    let mut weights = vec![vec![1.0; n]; n];
    for i in 0..n {
        for j in 0..n {
            points[i][j] = Point3::new(10.0 * i as f64, 10.0 * j as f64, noise.between(0.0, 8.0));
            weights[i][j] = 2f64.powf(noise.between(-1.0, 1.0));
        }
    }
    let knots = vec![0.0, 0.0, 0.0, 0.0, 1.0, 2.0, 3.0, 4.0, 4.0, 4.0, 4.0];
    Source::Nurbs(Nurbs {
        degree: [3, 3],
        knots: [knots.clone(), knots],
        control_points: points,
        weights: Some(weights),
    })
}

/// A circle about the z axis, in four quarters: place in plan and weight of each control point.
fn circle() -> [([f64; 2], f64); 9] {
    let corners = [[1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [-1.0, 1.0], [-1.0, 0.0], [-1.0, -1.0], [0.0, -1.0]];
    let corners = corners.into_iter().chain([[1.0, -1.0], [1.0, 0.0]]);
    let mut circle = [([0.0; 2], 1.0); 9];
    for (k, corner) in corners.enumerate() {
        circle[k] = (corner, if k % 2 == 1 { FRAC_1_SQRT_2 } else { 1.0 });
    }
    circle
}

/// A profile of quadratic arcs, as (radius, height, weight), turned about the z axis.
fn turned(profile: &[[f64; 3]], knots: Vec<f64>) -> Source {
    let circle = circle();
    let point = |([x, y], _): ([f64; 2], f64), [r, z, _]: [f64; 3]| Point3::new(r * x, r * y, z);
    let row = |on: &([f64; 2], f64)| profile.iter().map(|p| point(*on, *p)).collect();
    let of_row = |on: &([f64; 2], f64)| profile.iter().map(|p| on.1 * p[2]).collect();
    let around = vec![0.0, 0.0, 0.0, 1.0, 1.0, 2.0, 2.0, 3.0, 3.0, 4.0, 4.0, 4.0];
    Source::Nurbs(Nurbs {
        degree: [2, 2],
        knots: [around, knots],
        control_points: circle.iter().map(row).collect(),
        weights: Some(circle.iter().map(of_row).collect()),
    })
}

/// The lower part of a ball of radius 30 mm, up to 60 degrees from its bottom.
fn bowl() -> Source {
    let half = PI / 6.0;
    let (r, w) = (30.0, half.cos());
    let tip = [r * half.tan(), 0.0, w];
    let end = [r * (2.0 * half).sin(), r * (1.0 - (2.0 * half).cos()), 1.0];
    turned(&[[0.0, 0.0, 1.0], tip, end], vec![0.0, 0.0, 0.0, 1.0, 1.0, 1.0])
}

/// The upper half of a torus with a ring of radius 20 mm and a tube of radius 8 mm.
fn torus() -> Source {
    let (r, t, w) = (20.0, 8.0, FRAC_1_SQRT_2);
    let profile = [[r - t, 0.0, 1.0], [r - t, t, w], [r, t, 1.0], [r + t, t, w], [r + t, 0.0, 1.0]];
    turned(&profile, vec![0.0, 0.0, 0.0, 1.0, 1.0, 2.0, 2.0, 2.0])
}

fn chain<const D: usize>(shapes: Vec<Piecewise<D>>) -> Profile<D> {
    Profile::new(shapes.into_iter().enumerate().map(|(place, shape)| Piece { shape, place }))
}

/// A surface ruled between two cubics in space of four pieces each.
fn ruled() -> Source {
    let curve = |y: f64, heights: [f64; 13]| {
        let at = |k: usize| Point3::new(5.0 * k as f64, y + (k as f64).sin(), heights[k]);
        chain((0..4).map(|k| Piecewise::Cubic([0, 1, 2, 3].map(|m| at(3 * k + m)))).collect())
    };
    let first = [0.0, 1.0, 4.0, 6.0, 8.0, 7.0, 5.0, 3.0, 1.0, 0.0, -1.0, -1.0, 0.0];
    let second = [5.0, 4.0, 2.0, 1.0, 0.0, -1.0, 0.0, 1.0, 2.0, 5.0, 8.0, 9.0, 9.0];
    Source::Ruled(Ruled { first: curve(0.0, first), second: curve(40.0, second) })
}

/// A cubic carried around an L with rounded corners of radius 9 mm.
fn sweep() -> Source {
    let (w, r) = (FRAC_1_SQRT_2, 9.0);
    let line = |a: [f64; 2], b: [f64; 2]| Piecewise::Line([a.into(), b.into()]);
    let arc = |p: [[f64; 2]; 3]| Piecewise::Arc { points: p.map(Into::into), weight: w };
    let basic = chain(vec![
        line([0.0, 0.0], [20.0 - r, 0.0]),
        arc([[20.0 - r, 0.0], [20.0, 0.0], [20.0, r]]),
        line([20.0, r], [20.0, 40.0 - r]),
        arc([[20.0, 40.0 - r], [20.0, 40.0], [20.0 + r, 40.0]]),
        line([20.0 + r, 40.0], [40.0, 40.0]),
    ]);
    let drive = [[-5.0, 14.827], [-2.0, 13.566], [2.0, 10.093], [5.0, 16.696]];
    let drive = chain(vec![Piecewise::Cubic(drive.map(Into::into))]);
    let basic = basic.mapped(|p| Point3::new(p.x, p.y, 0.0));
    Source::NormalSweep(NormalSweep { basic, drive })
}

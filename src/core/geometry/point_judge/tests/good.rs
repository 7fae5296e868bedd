//! Grids of good points: free forms and sharp features, closed surfaces, uneven spacing, noise, rounding.

use std::f64::consts::{PI, TAU};

use nalgebra::{Point3, Rotation2, Vector2};

/// SplitMix64.
pub struct Random(pub u64);

impl Random {
    pub fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// A number between two others.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * (self.next() >> 11) as f64 / (1u64 << 53) as f64
    }

    /// A whole number from `low` on, below `high`.
    pub fn whole(&mut self, low: usize, high: usize) -> usize {
        low + (self.next() % (high - low) as u64) as usize
    }

    /// Noise of a measuring machine: a normal distribution.
    pub fn normal(&mut self) -> f64 {
        (-2.0 * self.between(1e-12, 1.0).ln()).sqrt() * (TAU * self.between(0.0, 1.0)).cos()
    }
}

type Height = Box<dyn Fn(Vector2<f64>) -> f64>;

/// A height over the plan, of a part of the size `size` measured at the distance `pitch`.
fn height(random: &mut Random, kind: usize, size: f64, pitch: f64) -> (&'static str, Height) {
    let center = Vector2::new(random.between(0.1, 0.9), random.between(0.1, 0.9)) * size;
    let angle = random.between(0.0, TAU);
    let across = Vector2::new(angle.cos(), angle.sin());
    let along = Vector2::new(-angle.sin(), angle.cos());
    let high = random.between(0.05, 0.5) * size;
    let radius = random.between(1.5, 6.0) * pitch;
    let slope = random.between(0.1, 4.0);
    match kind {
        0 => {
            let waves: Vec<(Vector2<f64>, f64, f64)> = (0..4)
                .map(|_| {
                    let angle = random.between(0.0, TAU);
                    let length = random.between(5.0, 40.0) * pitch;
                    let wave = Vector2::new(angle.cos(), angle.sin()) * (TAU / length);
                    (wave, random.between(0.0, TAU), random.between(0.0, 0.15) * length)
                })
                .collect();
            ("waves", Box::new(move |p| waves.iter().map(|(w, f, a)| a * (w.dot(&p) + f).sin()).sum()))
        }
        1 => ("step", Box::new(move |p| if (p - center).dot(&across) > 0.0 { high } else { 0.0 })),
        2 => ("ridge", Box::new(move |p| high - slope * (p - center).dot(&across).abs())),
        3 => ("cone", Box::new(move |p| high - slope * (p - center).norm())),
        4 => ("boss", Box::new(move |p| if (p - center).norm() < radius { high } else { 0.0 })),
        5 => (
            "block",
            Box::new(move |p| {
                let q = p - center;
                if q.dot(&across) > 0.0 && q.dot(&along) > 0.0 { high } else { 0.0 }
            }),
        ),
        6 => ("ball", Box::new(move |p| (radius * radius - (p - center).norm_squared()).max(0.0).sqrt())),
        7 => ("plane", Box::new(move |p| slope * p.dot(&across))),
        8 => (
            "bump",
            Box::new(move |p| high * (-(p - center).norm_squared() / (2.0 * pitch * pitch * 1.44)).exp()),
        ),
        9 => (
            "pyramid",
            Box::new(move |p| {
                let q = p - center;
                high - slope * q.dot(&across).abs().max(q.dot(&along).abs())
            }),
        ),
        10 => ("stairs", Box::new(move |p| high * 0.2 * ((p - center).dot(&across) / radius).floor())),
        11 => (
            "groove",
            Box::new(move |p| {
                let q = p - center;
                let depth = (radius - q.dot(&across).abs()).max(0.0);
                if q.dot(&along) > 0.0 { -slope * depth } else { 0.0 }
            }),
        ),
        12 => ("plateau", Box::new(move |p| (slope * (radius - (p - center).norm())).clamp(0.0, high))),
        _ => ("saddle", Box::new(move |p| (p - center).dot(&across) * (p - center).dot(&along) / size)),
    }
}

/// A good grid, and its name.
pub fn grid(seed: u64) -> (String, Vec<Vec<Point3<f64>>>) {
    let mut random = Random(seed.wrapping_mul(7919));
    let kind = random.whole(0, 18);
    let [rows, columns] = [random.whole(2, 36), random.whole(2, 36)];
    let (name, mut points) = if kind < 14 {
        relief(&mut random, kind, [rows, columns])
    } else {
        closed(&mut random, kind, [rows.max(5), columns.max(5)])
    };
    let noise = [0.0, 0.0001, 0.001, 0.004, 0.01][random.whole(0, 5)];
    let decimals = [2, 3, 4, 6, 17][random.whole(0, 5)];
    let scale = 10f64.powi(decimals);
    let poles = kind == 15;
    for p in points.iter_mut().flatten() {
        for x in p.iter_mut() {
            if !poles {
                *x += noise * random.normal();
            }
            if decimals < 17 {
                *x = (*x * scale).round() / scale;
            }
        }
    }
    if points.len() > 2 && random.whole(0, 2) == 1 {
        points.reverse();
    }
    (format!("{name} noise {noise} decimals {decimals}"), points)
}

fn relief(
    random: &mut Random,
    kind: usize,
    [rows, columns]: [usize; 2],
) -> (&'static str, Vec<Vec<Point3<f64>>>) {
    let pitches = [random.between(0.5, 20.0), random.between(0.5, 20.0)];
    let scatter = [0.0, 0.0, 0.004, 0.3, 0.8][random.whole(0, 5)];
    let places = |random: &mut Random, n: usize, pitch: f64| {
        let mut at = 0.0;
        let mut places = vec![0.0];
        for _ in 1..n {
            at += pitch * if scatter > 0.01 { (scatter * random.between(-1.0, 1.0)).exp() } else { 1.0 };
            places.push(at);
        }
        places
    };
    let (xs, ys) = (places(random, rows, pitches[0]), places(random, columns, pitches[1]));
    let size = xs[rows - 1].max(ys[columns - 1]);
    let (name, height) = height(random, kind, size, pitches[0].max(pitches[1]));
    let turn = Rotation2::new([0.0, 0.0, random.between(-PI, PI)][random.whole(0, 3)]);
    // Features run straight over the edges, so that no feature is measured by a single point there.
    let inner = |places: &[f64], x: f64| {
        let (n, margin) = (places.len(), (places.len() - 1).min(4) / 2);
        x.clamp(places[margin], places[n - 1 - margin])
    };
    let fine = if scatter == 0.004 { 0.004 } else { 0.0 };
    let points = xs.iter().map(|x| {
        ys.iter()
            .map(|y| {
                let p = Vector2::new(x + fine * random.normal(), y + fine * random.normal());
                let q = turn * p;
                let r = Vector2::new(inner(&xs, p.x), inner(&ys, p.y));
                let r = if kind == 0 || kind == 7 { p } else { r };
                Point3::new(q.x, q.y, height(r))
            })
            .collect()
    });
    (name, points.collect())
}

/// Tubes, spheres with poles, tori and discs in polar places.
fn closed(
    random: &mut Random,
    kind: usize,
    [rows, columns]: [usize; 2],
) -> (&'static str, Vec<Vec<Point3<f64>>>) {
    let radius = random.between(5.0, 50.0);
    let small = radius * random.between(0.1, 0.8);
    let length = random.between(5.0, 100.0);
    let part = |k: usize, n: usize| k as f64 / (n - 1) as f64;
    let is_upright = random.whole(0, 2) == 1;
    let point = |i: usize, j: usize| {
        let (u, v) = (part(i, rows), part(j, columns));
        let (cos, sin) = ((TAU * v).cos(), (TAU * v).sin());
        match kind {
            14 => {
                let r = radius * (1.0 + 0.2 * (3.0 * u).sin());
                if is_upright {
                    Point3::new(r * cos, r * sin, length * u)
                } else {
                    Point3::new(length * u, r * cos, r * sin)
                }
            }
            15 => {
                let (c, s) = ((0.5 * PI * u).cos(), (0.5 * PI * u).sin());
                Point3::new(radius * s * cos, radius * s * sin, radius * c)
            }
            16 => {
                let (c, s) = ((TAU * u).cos(), (TAU * u).sin());
                let r = radius + small * c;
                Point3::new(r * cos, r * sin, small * s)
            }
            _ => {
                let r = small + (radius - small) * u;
                Point3::new(r * cos, r * sin, 0.1 * r * (2.0 * TAU * v).sin())
            }
        }
    };
    let name = ["tube", "sphere", "torus", "disc"][kind - 14];
    (name, (0..rows).map(|i| (0..columns).map(|j| point(i, j)).collect()).collect())
}
